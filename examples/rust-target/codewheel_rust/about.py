"""Documentation: the sentences of ``say`` on the parts of a device, as comments in Markdown for rustdoc."""

from __future__ import annotations

import re
from collections.abc import Iterable

from codewheel.model import Device, Field, Interface, Layout, Register, cite
from codewheel.say import layout, register, wrap_text
from codewheel.say.layout import field_place
from codewheel.say.names_and_evidence import title_of
from codewheel.say.text import Statement, Style

_MARKUP = re.compile(r"[\\`*<\[\]]")
_LIST = re.compile(r"^(\s*\d*)([-+#>.)])", re.MULTILINE)


def markdown(text: str) -> str:
    """Return text of a spec as text in Markdown."""
    return _MARKUP.sub(r"\\\g<0>", text)


_STYLE = Style(
    text=markdown,
    code=lambda text: f"`{text.replace('`', ' ')}`",
    ref=lambda ref: markdown(ref.title),
    cited=lambda sources: f"({markdown(cite(sources))})" if sources else "",
)


def doc(statements: Iterable[Statement | str] | Statement, indent: int = 0, mark: str = "///") -> str:
    """Return statements as a comment for rustdoc, each a paragraph."""
    lead = f"{' ' * indent}{mark} "
    listed = [statements] if isinstance(statements, Statement) else statements
    texts = [_STYLE.sentence(statement) if isinstance(statement, Statement) else statement for statement in listed]
    paragraphs = (_LIST.sub(r"\1\\\2", wrap_text(text, 100 - len(lead))) for text in texts)
    return "\n".join(f"{lead}{line}".rstrip() for line in "\n\n".join(paragraphs).split("\n"))


def frame_text(device: Device, interface: Interface, frame: Layout) -> list[Statement]:
    """Return the description of a frame."""
    return [layout.describe_head(interface, frame, title_of(frame)), *layout.describe_layout(device, interface, frame)]


def register_text(device: Device, described: Register) -> list[Statement]:
    """Return the description of a register."""
    return [
        register.describe_head(device, described, title_of(described)),
        *register.describe_register(device, described),
    ]


def field_text(device: Device, owner: Layout, described: Field) -> list[str]:
    """Return place and meaning of a field, in one paragraph."""
    text = _STYLE.paragraph(
        [Statement(tuple(field_place(owner, described))), *register.describe_field(device, described)]
    )
    return [text[0].upper() + text[1:]]
