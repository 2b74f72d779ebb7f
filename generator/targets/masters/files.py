"""The files that BiSS and SSI masters load, for each order code or in bulk.

The description of a master lists its file formats. A format is a row of ``FILE_FORMATS`` and a template with its name.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Annotated, TypedDict

from ...language.master_items import FILE_FORMATS
from ...language.problems import join_words
from ...masters.groups import GroupSheets, sheets_of
from ...masters.places import SettingPlace
from ...masters.record import EncoderFacts
from ...masters.sheet import Master, SettingsSheet, shipped_masters
from ...masters.text import cited, condition_text
from ...model import Device
from ...render import Templates, our_templates
from ...say.evidence import grade_below_manual, titled_in_lists
from ...say.markdown import escape as escape_markdown
from ...say.plain_text import text_on_one_line, wrap_text
from ...say.text import PLAIN_STYLE
from .. import NO_OPTIONS, Library, Option, Options, Target
from ..registry import licence_in, names_of_codes
from .entries import Channel, Content, YamlMapping, content_of_file

_TEXT_WIDTH = 120
_ONE_FILE_EACH = "each"
_ORDER_CODES_OPTION = Option(
    "order-codes", "each: a file that the tool loads for each order code", "bulk", ("bulk", _ONE_FILE_EACH)
)


class MasterFile(TypedDict):
    head: Annotated[list[str], "paragraphs of the comment at the top"]
    content: Annotated[Content, "values to write, and those left out"]
    channels: Annotated[Sequence[Channel], "channels to write: all of them, or the first in a bulk file"]
    name: Annotated[str, "order code as an identifier"]
    device: Annotated[str, "device of the master"]
    also: Annotated[Mapping[str, int | str], "further keys that the tool needs, with their values"]
    line: Annotated[str, "pattern of the command line, or empty"]


class Index(TypedDict):
    families: Annotated[list[str], "titles of the families"]
    rows: Annotated[list[dict[str, str]], "masters and formats that have files, with folder, tool and reader"]


def file_text(
    device: Device,
    order_codes: Sequence[str],
    sheet: SettingsSheet,
    rule: YamlMapping,
    master_device: str,
    library: Library | None = None,
    is_short: bool = False,
    file_content: Content | None = None,
) -> str:
    """Return the file for a master and for order codes that have the same settings.

    Args:
        device: The family.
        order_codes: The order codes. Names in the file are based on the first one.
        sheet: The settings.
        rule: Entry of ``files`` in the description of the master.
        master_device: Device of the master.
        library: The library, for the user's templates.
        is_short: True to leave out the text that all order codes of a family share.
        file_content: The content of the file, if it is known already.
    """
    if file_content is None:
        file_content = content_of_file(sheet, rule, master_device)
    written_keys = {file_value.key for file_value in file_content.entries}
    head = list(_paragraphs_on_content(file_content, is_short))
    if not is_short:
        head = [*_first_paragraphs(device, order_codes, sheet, rule, master_device), *head]
    values: MasterFile = {
        "head": head,
        "content": file_content,
        "channels": file_content.channels[:1] if is_short else file_content.channels,
        "name": re.sub(r"\W|^(?=\d)", "_", order_codes[0], flags=re.ASCII),
        "device": master_device,
        "also": {key: value for key, value in rule.get("also", {}).items() if key not in written_keys},
        "line": rule.get("line", ""),
    }
    return TEMPLATES.render(f"{rule['format']}.jinja", values, library.own_templates if library is not None else None)


def _first_paragraphs(
    device: Device, order_codes: Sequence[str], sheet: SettingsSheet, rule: YamlMapping, master_device: str
) -> Iterator[str]:
    """Yield the purpose of the file, and the origin of its values."""
    format_ = FILE_FORMATS[rule["format"]]
    yield f"{master_device} with {', '.join(order_codes)}. For {format_.title}."
    yield from _paragraphs_on_origin(device, [sheet], rule, master_device)


def _paragraphs_on_origin(
    device: Device, sheets: Sequence[SettingsSheet], rule: YamlMapping, master_device: str
) -> Iterator[str]:
    """Yield the paragraphs on the evidence for a file: the manual, the cited documents of the master, and the tests."""
    format_, manual = FILE_FORMATS[rule["format"]], device.manual
    yield f"From the spec of {device.title}, manual {manual.title}, revision {manual.revision}."
    yield from map(PLAIN_STYLE.sentence, grade_below_manual(device))
    cited_keys: set[str] = set()
    for sheet in sheets:
        for place in _places_on_device(sheet, master_device):
            # A source is like "manual: 3.2; data sheet: page 4".
            cited_keys.update(re.split(r"[;:]\s*", place.source))
    documents = [document for document in sheets[0].master.documents if document.key in cited_keys]
    cited_documents = "; ".join(f"{document.key}: {document.title}" for document in documents)
    yield f"From the documents of the master: {cited_documents}."
    reader = "Not yet read by its tool."
    if format_.reader:
        reader = f"Read by {format_.reader}, see docs/master/master-files.md."
    yield f"Not yet tested on hardware. {reader} Form of the file: {cited(rule['source'])}."


def _places_on_device(sheet: SettingsSheet, master_device: str) -> Iterator[SettingPlace]:
    """Yield the locations of all settings on a device."""
    for setting in sheet.settings:
        yield from (place for place in setting.places if place.device == master_device)


def _paragraphs_on_content(file_content: Content, is_short: bool) -> Iterator[str]:
    """Yield the paragraphs on values that are derived, that are only a start, or that the file leaves out.

    Unless ``is_short`` is True, the conditions on writing follow.
    """
    derived = _names_with_mark(file_content, "derived")
    if derived:
        yield f"Derived, not stated in a document: {join_words(derived)}."
    starts = _names_with_mark(file_content, "start with")
    if starts:
        initial_values = join_words(starts)
        yield f"Only a value to start with, because the highest clock of the encoder is not known: {initial_values}."
    for sentence in file_content.left_out:
        yield f"Not in this file: {sentence}"
    if not is_short:
        yield from file_content.conditions


def _names_with_mark(file_content: Content, mark: str) -> list[str]:
    """Return the names of the values that have a mark, such as ``derived``, each once."""
    return list(dict.fromkeys(file_value.name for file_value in file_content.entries if mark in file_value.mark))


def comment(paragraphs: Sequence[str], prefix: str) -> str:
    """Return paragraphs as a comment whose lines begin with ``prefix``, which is ``<!--`` in XML."""
    if prefix == "<!--":
        lines = [
            wrap_text(comment_text(paragraph), _TEXT_WIDTH, prefix="       ", first="     ") for paragraph in paragraphs
        ]
        return "\n".join(["<!--", *lines, "-->"])
    if prefix == "//":
        # A backslash at the end of a line would continue it.
        paragraphs = [paragraph.replace("\\", "/") for paragraph in paragraphs]
    lines = [wrap_text(paragraph, _TEXT_WIDTH, prefix=f"{prefix}   ", first=f"{prefix} ") for paragraph in paragraphs]
    return "\n".join(lines)


def comment_text(text: object) -> str:
    """Return a text in a form that is safe in a comment on one line in XML or C.

    It does not end the comment, and it has no double hyphens, which XML does not allow.
    """
    comment_line = text_on_one_line(text).replace("*/", "* /")
    # One pass leaves two adjacent hyphens if there were three.
    while "--" in comment_line:
        comment_line = comment_line.replace("--", "- -")
    return comment_line


def fill_pattern(pattern: str, file_content: Content) -> str:
    """Return a pattern in which each key in braces is replaced by its value, so that ``-b {bits}`` becomes ``-b 24``.

    The keys and values are those of the first channel.
    """
    for file_value in file_content.entries:
        pattern = pattern.replace(f"{{{file_value.key}}}", file_value.word)
    return pattern


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return the files for masters by path, with a README and the license.

    By default, ``masters/<master>/<format>/<device>-<family>`` is a bulk file with the files for all order codes of a
    family. They are comments in it, or elements in XML, so that no tool loads the wrong one by accident. With the
    option ``order-codes=each``, each order code has a file that the tool loads.
    """
    files: dict[str, str] = {}
    for device in library.devices:
        files |= library.files_of(_files_of_family, device, options)
    return files | {"masters/README.md": _format_page(library, files)} | licence_in("masters")


def _files_of_family(device: Device, library: Library, options: Options) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path of each file of a family, and a function that returns its text."""
    is_one_file_each = options.get(_ORDER_CODES_OPTION.name, _ORDER_CODES_OPTION.default) == _ONE_FILE_EACH
    files_of_device = _file_of_each_order_code if is_one_file_each else _bulk_file
    masters = shipped_masters()
    interface_sheets = sheets_of(device, masters)
    for index, master in enumerate(masters):
        # The sheets of a group of order codes are in the order of the masters.
        usable_sheets = list(_usable_sheets(interface_sheets, index))
        for rule in master.files:
            master_devices: dict[str, None] = {}
            for sheet, _, _ in usable_sheets:
                master_devices |= dict.fromkeys(sheet.devices_with(rule))
            for master_device in master_devices:
                start = _start_of_path(master, rule, master_device)
                sheets = []
                for sheet, record, order_codes in usable_sheets:
                    if master_device not in sheet.unusable_devices:
                        sheets.append((sheet, record, order_codes))
                yield from files_of_device(start, device, sheets, rule, master_device, library)


def _start_of_path(master: Master, rule: YamlMapping, master_device: str) -> str:
    """Return the folder and the beginning of the names of files, such as ``masters/acme/c_struct/m100-``.

    If the master has only one device, the names have no such beginning, and the result is only the folder.
    """
    folder = f"masters/{master.name}/{rule['format']}/"
    if len(master.devices) == 1:
        return folder
    (device_name,) = names_of_codes([master_device])
    return f"{folder}{device_name}-"


def _usable_sheets(interface_sheets: Sequence[GroupSheets], master_index: int) -> Iterator[SheetOfCodes]:
    """Yield the settings of a master, each with the record and the order codes that share them.

    Order codes that the master cannot read are left out. ``master_index`` is the index of the master in the list of
    all masters.
    """
    for group_sheets in interface_sheets:
        _, sheets = group_sheets.sheets[master_index]
        for sheet, group in zip(sheets, group_sheets.groups, strict=True):
            if not sheet.refusals:
                yield sheet, group.record, group.codes


def _format_page(library: Library, files: Iterable[str]) -> str:
    """Return the README, which lists the formats of masters. Formats without a path in ``files`` are left out."""
    folders = {path.rpartition("/")[0].removeprefix("masters/") for path in files}
    rows: list[dict[str, str]] = []
    for master in shipped_masters():
        rows += [_index_row(master, rule["format"]) for rule in master.files]
    values: Index = {
        "families": [escape_markdown(titled_in_lists(device)) for device in library.devices],
        "rows": [row for row in rows if row["folder"] in folders],
    }
    return TEMPLATES.render("README.md.jinja", values, library.own_templates)


def _index_row(master: Master, format_name: str) -> dict[str, str]:
    """Return the row of the README for a format of a master, with its folder and the program that reads it."""
    format_ = FILE_FORMATS[format_name]
    return {
        "master": master.title,
        "format": format_name,
        "folder": f"{master.name}/{format_name}",
        "title": format_.title,
        "reader": format_.reader,
    }


#: The settings of order codes, with the record and the codes that share them.
SheetOfCodes = tuple[SettingsSheet, EncoderFacts, Sequence[str]]


def _file_of_each_order_code(
    start: str, device: Device, sheets: Sequence[SheetOfCodes], rule: YamlMapping, master_device: str, library: Library
) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path of a file for each order code, and a function that returns its text.

    Each path is ``start``, the order code, and the answers to questions that the manual leaves open.
    """
    suffix = FILE_FORMATS[rule["format"]].suffix
    labels: list[str] = []
    text_functions: list[Callable[[], str]] = []
    for sheet, record, order_codes in sheets:
        for order_code in order_codes:
            labels.append(_code_and_answers(order_code, record))
            text_functions.append(partial(file_text, device, [order_code], sheet, rule, master_device, library))
    for name, text_function in zip(names_of_codes(labels), text_functions, strict=True):
        yield f"{start}{name}{suffix}", text_function


def _code_and_answers(code: str, record: EncoderFacts) -> str:
    """Return an order code with the answers to open questions, joined by hyphens."""
    return "-".join((code, *record.answers.values()))


def _bulk_file(
    start: str, device: Device, sheets: Sequence[SheetOfCodes], rule: YamlMapping, master_device: str, library: Library
) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path of the one file for all order codes, and a function that returns its text."""
    path = f"{start}{device.name}{FILE_FORMATS[rule['format']].suffix}"
    yield path, partial(_bulk_text, device, sheets, rule, master_device, library)


def _bulk_text(
    device: Device, sheets: Sequence[SheetOfCodes], rule: YamlMapping, master_device: str, library: Library
) -> str:
    """Return the text of a bulk file. Order codes with the same content and the same answers share a block."""
    codes_by_content: dict[tuple[Content, Sequence[tuple[str, str]]], list[str]] = {}
    sheet_by_content: dict[tuple[Content, Sequence[tuple[str, str]]], SettingsSheet] = {}
    for sheet, record, codes in sheets:
        content_and_answers = (content_of_file(sheet, rule, master_device), tuple(record.answers.items()))
        codes_by_content.setdefault(content_and_answers, []).extend(codes)
        sheet_by_content.setdefault(content_and_answers, sheet)
    blocks = []
    for (file_content, answers), codes in codes_by_content.items():
        choices = " and ".join(f"{name}={answer}" for name, answer in answers)
        title = f"{', '.join(codes)} with {choices}" if choices else ", ".join(codes)
        sheet = sheet_by_content[file_content, answers]
        block = file_text(device, codes, sheet, rule, master_device, library, is_short=True, file_content=file_content)
        blocks.append((title, block))
    return _joined_blocks(device, blocks, list(sheet_by_content.values()), rule, master_device)


def _joined_blocks(
    device: Device,
    blocks: Sequence[tuple[str, str]],
    sheets: Sequence[SettingsSheet],
    rule: YamlMapping,
    master_device: str,
) -> str:
    """Return a bulk file with these blocks as comments, or in XML as children of one element.

    A block is a title and the text of a file. ``sheets`` are the settings in the file, from which the documents and
    conditions in the comment at the top are taken.
    """
    format_ = FILE_FORMATS[rule["format"]]
    head = [
        f"{master_device} with the order codes of {device.title}. For {format_.title}.",
        *_paragraphs_on_origin(device, sheets, rule, master_device),
    ]
    conditions: dict[str, None] = {}
    for sheet in sheets:
        conditions |= dict.fromkeys(map(condition_text, sheet.writing))
    head += conditions
    head.append(
        "Each block is for the first channel. A file that codewheel prints for one order code has all channels."
    )
    if format_.comment == "<!--":
        head.append("Copy the element below your order code into a file of its own.")
        elements = "".join(f"\n{comment([title], '<!--')}\n{_without_declaration(text)}" for title, text in blocks)
        return f'<?xml version="1.0" encoding="UTF-8"?>\n{comment(head, "<!--")}\n<files>{elements}</files>\n'
    head.append(f"Copy the lines below your order code and remove the first {format_.comment} of each line.")
    lines = [comment(head, format_.comment)]
    for title, text in blocks:
        lines += ["", comment([f"=== {title}"], format_.comment)]
        lines += [f"{format_.comment} {line}".rstrip() for line in text.splitlines()]
    return "\n".join(lines) + "\n"


def _without_declaration(text: str) -> str:
    """Return the text of an XML file without its declaration."""
    return text.partition("?>\n")[2] if text.startswith("<?xml") else text


TEMPLATES = Templates(
    our_templates("masters"),
    values={"README.md.jinja": Index, **{f"{name}.jinja": MasterFile for name in FILE_FORMATS}},
    filters={"comment": comment, "filled": fill_pattern, "note": comment_text},
)
TARGET = Target(
    name="masters",
    summary="files that BiSS and SSI masters load",
    files=generate,
    options=(_ORDER_CODES_OPTION,),
    templates=TEMPLATES,
    family=_files_of_family,
)
