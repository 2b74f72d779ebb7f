"""``codewheel new``: write a spec that passes ``check``, to be filled in from a manual, and find values not filled in.

The spec is an example, or describes the encoder in a line.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass
from functools import partial
from importlib import resources
from keyword import iskeyword
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .cli import Parser, a_path
from .terminal import CommandError

if TYPE_CHECKING:
    import argparse

EXAMPLES = (
    "codewheel new my_encoder",
    "codewheel new my_encoder -o specs/my_encoder.yaml",
    "codewheel new bench_encoder --line biss:position=32,error,warning,crc=6:0x43",
)
_FAMILY_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
#: Most characters of the name of a family, and most characters of an invalid name that a message shows.
_LONGEST_NAME, _SHOWN_CHARACTERS = 40, 60
#: Encoders to start from. The rotary ones count revolutions, except over SPI.
LIKE = ("biss", "ssi", "rs485", "rs485-exchanges", "spi", "linear")
#: Function that returns the text of a spec for a family, its manufacturer, and the path of the schema.
DeviceText = Callable[[str, str, str], str]
#: Manufacturer and schema in the templates.
_TEMPLATE_MANUFACTURER = "example"
_SCHEMA_IN_TEMPLATES = "../../generator/language/{}.schema.json"


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = "Write a commented spec that passes check, to be filled in from a manual."
    parser.add_argument("name", metavar="NAME", help="name of the family: lowercase letters, digits and underscores")
    parser.add_argument(
        "-o",
        dest="output",
        type=a_path,
        metavar="FILE",
        help="output file, or - to print it (default: NAME.yaml in this folder)",
    )
    parser.add_argument(
        "--line",
        metavar="LINE",
        help="write the encoder that this line describes, such as biss:position=32,error,warning,crc=6:0x43, and mark "
        "what it does not state",
    )
    parser.add_argument(
        "--like",
        choices=LIKE,
        default="",
        help="kind of encoder: a multiturn encoder with this interface (SPI: singleturn), or a linear one with BiSS. "
        "rs485 is for the T-format, and rs485-exchanges is for other requests",
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the spec, and print the names of the files. With ``-o -``, only print the spec.

    Raises:
        CommandError: The name or the line is not valid (exit code 2), or a file exists or cannot be written (exit code
            1).
    """
    if arguments.line is not None and arguments.like:
        raise CommandError("--line and --like describe two encoders; leave one of them out", 2)
    if arguments.line is None:
        text_of: DeviceText = partial(device_text, like=arguments.like)
    else:
        text_of = _text_writer_for_line(arguments.line)
    try:
        if arguments.output == Path("-"):
            _refuse_invalid_name(arguments.name)
            print(text_of(arguments.name, _TEMPLATE_MANUFACTURER, "device.schema.json"), end="")
            return 0
        for written_file in write_spec(arguments.name, arguments.output, text_of=text_of):
            print(f"written    {written_file.as_posix()}")
    except NameRefused as error:
        raise CommandError(str(error), 2) from None
    except NotWritten as error:
        raise CommandError(str(error), 1) from None
    return 0


def _text_writer_for_line(line_text: str) -> DeviceText:
    """Return the function that writes the encoder in a line as a spec.

    Raises:
        CommandError: The line has problems. The exit code is 2.
    """
    from ..one_line.spec import spec_text
    from .find_encoder import checked_line

    return partial(spec_text, checked_line(line_text))


class NameRefused(ValueError):
    """The name is not valid for a family."""


class NotWritten(OSError):
    """A file already exists or cannot be written. The message is one line."""


def write_spec(name: str, output: Path | None, like: str = "", text_of: DeviceText | None = None) -> list[Path]:
    """Write the spec, and next to it the manufacturer file and the schemas for an editor if they are missing.

    Args:
        name: The family's name.
        output: The file, or a folder for it. By default, ``name.yaml`` in the current folder.
        like: One of ``LIKE``, or empty for a singleturn encoder over BiSS.
        text_of: Returns the text of the spec. By default, the text of the example.

    Returns:
        The files that were written.

    Raises:
        NameRefused: The name is not valid for a family, or the file has another one.
        NotWritten: A file already exists or cannot be written.
    """
    _refuse_invalid_name(name)
    file_name = f"{name}.yaml"
    spec_path = output or Path(file_name)
    if spec_path.is_dir():
        spec_path = spec_path / file_name
    if spec_path.name != file_name:
        raise NameRefused(
            f"the file of a spec has its family's name: {spec_path.with_name(file_name)}, not {spec_path}"
        )
    manufacturer_file = spec_path.with_name("manufacturer.yaml")
    text_of = text_of or partial(device_text, like=like)
    folder = spec_path.parent
    manufacturer = _manufacturer_name(manufacturer_file)
    schema_of_spec = _schema_reference(folder, "device")
    text_by_path = {spec_path: text_of(name, manufacturer, schema_of_spec)}
    if not manufacturer_file.exists():
        schema_of_manufacturer = _schema_reference(folder, "manufacturer")
        text_by_path[manufacturer_file] = manufacturer_text(schema_of_manufacturer)
    for schema_kind in ("device", "manufacturer"):
        schema_copy = spec_path.with_name(f"{schema_kind}.schema.json")
        if not _in_one_checkout(folder, schema_kind) and not schema_copy.exists():
            text_by_path[schema_copy] = _schema_of_tool(schema_kind).read_text(encoding="utf-8")
    return list(_write_new_files(text_by_path))


def _refuse_invalid_name(name: str) -> None:
    """Check the name of a family.

    Raises:
        NameRefused: The name is not valid, or something else in the tool or in generated files has this name.
    """
    from ..language.rules.repetitions import RESERVED_FAMILY_NAMES

    if not _is_valid_name(name):
        rule = "use lowercase letters, digits and underscores"
        start_of_name = name[:_SHOWN_CHARACTERS]
        raise NameRefused(f"'{start_of_name}' is not a valid family name; {rule}, such as {_suggested_name(name)}")
    if name in RESERVED_FAMILY_NAMES:
        raise NameRefused(f"'{name}' is the name of {RESERVED_FAMILY_NAMES[name]}; choose another name for the family")


def _write_new_files(text_by_path: dict[Path, str]) -> Iterator[Path]:
    """Write each file, which must not exist, and yield its path. The first failure ends it.

    Raises:
        NotWritten: A file already exists or cannot be written.
    """
    for path, text in text_by_path.items():
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open("x", encoding="utf-8", newline="\n") as file:
                file.write(text)
        except FileExistsError as error:
            raise NotWritten(f"{error.filename} already exists and is not overwritten") from None
        except OSError as error:
            raise NotWritten(f"cannot write {path}: {error.strerror or error}") from None
        yield path


def _is_valid_name(name: str) -> bool:
    """Return whether a family can have this name, apart from names that the tool or generated files use.

    It cannot be a keyword of Python, or ``manufacturer``, the file next to the spec.
    """
    is_reserved = iskeyword(name) or name == "manufacturer"
    return _FAMILY_NAME.fullmatch(name) is not None and len(name) <= _LONGEST_NAME and not is_reserved


def _suggested_name(name: str) -> str:
    """Return the name in lowercase with underscores instead of other characters: ``my_encoder`` for ``My-Encoder``.

    If a family cannot have that name, or it is the given one, return an example.
    """
    from ..language.rules.repetitions import RESERVED_FAMILY_NAMES

    with_underscores = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
    suggestion = with_underscores[:_LONGEST_NAME]
    is_free = suggestion != name and suggestion not in RESERVED_FAMILY_NAMES
    return suggestion if is_free and _is_valid_name(suggestion) else "encoder_1"


def _manufacturer_name(path: Path) -> str:
    """Return the name of the manufacturer in a file, or the template's name if it has no valid one."""
    from ..language.problems import ProblemReport
    from ..language.read import read_document

    document = read_document(path, ProblemReport()) if path.is_file() else None
    if document is None:
        return _TEMPLATE_MANUFACTURER
    name = document.data.get("manufacturer")
    is_name = isinstance(name, str) and re.fullmatch(r"[a-z][a-z0-9]*", name)
    return str(name) if is_name else _TEMPLATE_MANUFACTURER


def _schema_of_tool(kind: str) -> Path:
    """Return the path of the JSON Schema of a spec (``device``) or a manufacturer file (``manufacturer``)."""
    return Path(str(resources.files("codewheel.language") / f"{kind}.schema.json"))


def _in_one_checkout(folder: Path, kind: str) -> bool:
    """Return whether the folder and the tool's schema are in the same git checkout.

    If they are, a spec can refer to the schema by a relative path, which is the same in every clone. The schema of an
    installed tool is in no checkout.
    """
    schema = _schema_of_tool(kind).resolve()
    if "site-packages" in schema.parts:
        return False
    real_folder = folder.resolve()
    for parent in (real_folder, *real_folder.parents):
        # The innermost checkout with the folder counts.
        is_checkout = (parent / ".git").exists()
        if is_checkout:
            return schema.is_relative_to(parent)
    return False


def _schema_reference(folder: Path, kind: str) -> str:
    """Return the path of the schema for a spec in ``folder``: a relative path to the tool's schema, or its copy.

    ``kind`` is ``device`` or ``manufacturer``. The copy is next to the spec, so its path is only its name.
    """
    if not _in_one_checkout(folder, kind):
        return f"{kind}.schema.json"
    return Path(os.path.relpath(_schema_of_tool(kind), folder)).as_posix()


def manufacturer_text(schema: str) -> str:
    """Return the text of a manufacturer file."""
    schema_in_template = _SCHEMA_IN_TEMPLATES.format("manufacturer")
    return _template_text("manufacturer").replace(schema_in_template, schema)


def device_text(name: str, manufacturer: str, schema: str, like: str = "") -> str:
    """Return the text of a spec of the family ``name``: a template, with this name, its manufacturer and its schema.

    ``like`` is one of ``LIKE``, or empty for a singleturn encoder over BiSS.
    """
    spec_text = _template_text(like or "biss-singleturn")
    schema_in_template = _SCHEMA_IN_TEMPLATES.format("device")
    spec_text = spec_text.replace(schema_in_template, schema)
    spec_text = spec_text.replace(f"manufacturer: {_TEMPLATE_MANUFACTURER}\n", f"manufacturer: {manufacturer}\n")
    order_code = name.replace("_", "-").upper()
    return spec_text.replace("MY-ENCODER", order_code).replace("my_encoder", name)


def _template_text(name: str) -> str:
    """Return a template. Each is a whole valid spec of ``my_encoder``, so that editors check it with the schema."""
    from ..render import our_templates

    return (our_templates("new") / f"{name}.yaml").read_text(encoding="utf-8")


# -- values that still come from a template, in which they have the word TODO


@dataclass(frozen=True, slots=True)
class Placeholder:
    """A value that still comes from the template. ``name`` is the name of the fact in its spec."""

    file: str
    line: int
    column: int
    name: str


def placeholders_in(files: Iterable[str]) -> Iterator[Placeholder]:
    """Yield the placeholders in these specs, spec by spec in the order of their lines. A repeated file counts once."""
    for file in dict.fromkeys(files):
        path = Path(file)
        if path.is_file() and b"TODO" in path.read_bytes():
            yield from _placeholders_of(path)


def _placeholders_of(path: Path) -> Iterator[Placeholder]:
    """Yield the placeholders in a spec. A file that cannot be read contains none."""
    from ..language.problems import ProblemReport
    from ..language.read import read_document
    from ..language.rules.walk import placeholder_name, placeholder_paths

    document = read_document(path, ProblemReport())
    if document is None:
        return
    placeholders = []
    for path_in_spec in placeholder_paths(document.data):
        line, column = document.position(path_in_spec)
        name = placeholder_name(document.data, path_in_spec)
        placeholders.append(Placeholder(file=document.file, line=line, column=column, name=name))
    yield from sorted(placeholders, key=lambda placeholder: (placeholder.line, placeholder.column))


def placeholders_data(files: Iterable[str]) -> list[dict[str, Any]]:
    """Return the placeholders in these specs in the form that ``check --json`` prints."""
    return [asdict(placeholder) for placeholder in placeholders_in(files)]


def placeholder_lines(files: Iterable[str]) -> list[str]:
    """Return a line with the number of placeholders, and one for each. Empty if there are none."""
    lines = [f"  {placeholder.file}:{placeholder.line}: {placeholder.name}" for placeholder in placeholders_in(files)]
    if not lines:
        return []
    return [f"{_counted_placeholders(len(lines))} (each has the word TODO):", *lines]


def placeholder_line(files: Iterable[str]) -> str:
    """Return one line with the number of placeholders and the first one, or an empty string if there are none."""
    placeholders = list(placeholders_in(files))
    if not placeholders:
        return ""
    first_placeholder = placeholders[0]
    place = f"{first_placeholder.file}:{first_placeholder.line}"
    count_text = _counted_placeholders(len(placeholders))
    return f"{count_text}, the first at {place}; codewheel check lists them"


def _counted_placeholders(number: int) -> str:
    return "1 value is still from the template" if number == 1 else f"{number} values are still from the template"
