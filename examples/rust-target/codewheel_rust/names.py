"""Names by the rules of Rust, and words that cannot be names."""

from __future__ import annotations

import re

from codewheel.model import Device
from codewheel.targets import TargetProblem

Place = tuple[str, ...]
#: Reserved words of Rust.
KEYWORDS = frozenset(
    "abstract as async await become box break const continue crate do dyn else enum extern false final fn for if impl"
    " in let loop macro match mod move mut override priv pub ref return self static struct super trait true try type"
    " typeof unsafe unsized use virtual where while yield".split()
)
#: Names that every module declares or relies on.
OF_MODULE = tuple("Crc Err Fault None Ok Option Result Some Variant Verdict".split())
#: Names that every type of order codes has.
OF_CODE = ("ORDER_CODES", "find")
#: Names that every type of a frame or register has.
OF_STRUCT = ("bits", "decode", "encode", "fields", "read", "receive", "verdict")


def snake(name: str) -> str:
    """Return the name of a module, member or function. A name in a spec never ends in an underscore."""
    return f"{name}_" if name in KEYWORDS else name


def pascal(name: str) -> str:
    """Return the name of a type or of one of its values."""
    text = "".join(part[0].upper() + part[1:] for part in name.split("_"))
    return "Itself" if text == "Self" else text


def constant(text: str) -> str:
    """Return the name of a constant for any text: ``AMM5A17_1BG1`` for ``AMM5A17/1BG1``."""
    name = re.sub(r"[^A-Z0-9]+", "_", text.upper()).strip("_")
    return name if name[:1].isalpha() else f"N{name}"


class Names:
    """The names of one scope. A name that is given out twice is a problem of the spec."""

    def __init__(self, device: Device, reserved_words: tuple[str, ...] = ()) -> None:
        self._device = device
        self._places: dict[str, Place] = dict.fromkeys(reserved_words, ())
        self.problems: list[TargetProblem] = []

    def give(self, name: str, *place: str) -> str:
        if (other_place := self._places.get(name)) is not None:
            where = "something on line {line}" if other_place else "something that every module has"
            message = f"this would be called {name} in Rust, as {where}. Rename it"
            self.problems.append(TargetProblem(self._device, "rust-name", place, message, other_place))
        self._places.setdefault(name, place)
        return name
