"""The files that BiSS and SSI masters load, for each order code or in bulk.

The description of a master lists its file formats. A format is a row of ``FILE_FORMATS`` and a template with its name.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Annotated, NamedTuple, TypedDict

from ...language.keys_of_masters import FILE_FORMATS
from ...language.problems import join_words
from ...masters.encoder_facts import EncoderFacts
from ...masters.groups import GroupSheets, sheets_of
from ...masters.places_and_writing import SettingPlace, YamlMapping
from ...masters.sheet import Master, SettingsSheet, shipped_masters
from ...masters.text import cited, condition_text
from ...model import Device
from ...model.record import dataclass
from ...render import Templates, our_templates
from ...say import text_on_one_line, wrap_text
from ...say.names_and_evidence import grade_below_manual, titled_in_lists
from ...say.text import PLAIN_STYLE
from ...say.text import escape as escape_markdown
from .. import NO_OPTIONS, Library, Option, Options, Target
from ..registry import licence_in, names_of_codes
from .contents import Channel, Content, content_of_file

_TEXT_WIDTH = 120
_ONE_FILE_EACH = "each"
_ORDER_CODES_OPTION = Option(
    "order-codes",
    "each: one file per order code; bulk: one file with all order codes, as comments",
    "bulk",
    ("bulk", _ONE_FILE_EACH),
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


def _identifier(order_code: str) -> str:
    """Return the order code as an identifier, such as ``_24_X`` for ``24-X``."""
    return re.sub(r"\W|^(?=\d)", "_", order_code, flags=re.ASCII)


def _further_entries(file_rule: YamlMapping, file_content: Content) -> YamlMapping:
    """Return the fixed entries of a file, such as a version, without those that a setting writes."""
    written_keys = {file_value.key for file_value in file_content.file_values}
    return {key: value for key, value in file_rule.get("also", {}).items() if key not in written_keys}


def file_text(
    device: Device,
    order_codes: Sequence[str],
    sheet: SettingsSheet,
    *,
    file_rule: YamlMapping,
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
        file_rule: Entry of ``files`` in the description of the master.
        master_device: Device of the master.
        library: The library, for the user's templates.
        is_short: Leaves out the text that all order codes of a family share.
        file_content: The content of the file, if it is known already.
    """
    file_content = file_content or content_of_file(sheet, file_rule, master_device)
    format_title = FILE_FORMATS[file_rule["format"]].title
    first_paragraphs: list[str] = []
    if not is_short:
        first_paragraphs.append(f"{master_device} with {', '.join(order_codes)}. For {format_title}.")
        first_paragraphs += _paragraphs_on_origin(device, [sheet], file_rule, master_device)
    own_templates = library.own_templates if library is not None else None
    values: MasterFile = {
        "head": [*first_paragraphs, *_paragraphs_on_content(file_content, is_short)],
        "content": file_content,
        "channels": file_content.channels[:1] if is_short else file_content.channels,
        "name": _identifier(order_codes[0]),
        "device": master_device,
        "also": _further_entries(file_rule, file_content),
        "line": file_rule.get("line", ""),
    }
    return TEMPLATES.render(f"{file_rule['format']}.jinja", values, own_templates)


def _paragraphs_on_origin(
    device: Device, sheets: Sequence[SettingsSheet], file_rule: YamlMapping, master_device: str
) -> Iterator[str]:
    """Yield the paragraphs on the evidence for a file: the manual, the cited documents of the master, and the tests."""
    manual = device.manual
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
    reader = FILE_FORMATS[file_rule["format"]].reader
    reader_sentence = f"Read by {reader}, see docs/master/master-files.md." if reader else "Not yet read by its tool."
    yield f"Not yet tested on hardware. {reader_sentence} Form of the file: {cited(file_rule['source'])}."


def _places_on_device(sheet: SettingsSheet, master_device: str) -> Iterator[SettingPlace]:
    """Yield the locations of all settings on a device."""
    for setting in sheet.settings:
        yield from (place for place in setting.places if place.device == master_device)


def _paragraphs_on_content(file_content: Content, is_short: bool) -> Iterator[str]:
    """Yield the paragraphs on values that are derived, that are only a start, or that the file leaves out.

    Unless ``is_short`` is True, the conditions on writing follow.
    """
    derived_names = _names_with_mark(file_content, "derived")
    if derived_names:
        yield f"Derived, not stated in a document: {join_words(derived_names)}."
    initial_names = _names_with_mark(file_content, "start with")
    if initial_names:
        initial_values = join_words(initial_names)
        yield f"Only a value to start with, because the highest clock of the encoder is not known: {initial_values}."
    for sentence in file_content.omissions:
        yield f"Not in this file: {sentence}"
    if not is_short:
        yield from file_content.conditions


def _names_with_mark(file_content: Content, mark: str) -> list[str]:
    """Return the names of the values that have a mark, such as ``derived``, each once."""
    names = [file_value.name for file_value in file_content.file_values if mark in file_value.mark]
    return list(dict.fromkeys(names))


def comment(paragraphs: Sequence[str], prefix: str) -> str:
    """Return paragraphs as a comment whose lines begin with ``prefix``, which is ``<!--`` in XML."""
    if prefix == "<!--":
        safe_paragraphs = map(comment_text, paragraphs)
        lines = [wrap_text(paragraph, _TEXT_WIDTH, prefix="       ", first="     ") for paragraph in safe_paragraphs]
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
    for file_value in file_content.file_values:
        pattern = pattern.replace(f"{{{file_value.key}}}", file_value.value_text)
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
    files_option = options.get(_ORDER_CODES_OPTION.name, _ORDER_CODES_OPTION.default)
    masters = shipped_masters()
    interface_sheets = sheets_of(device, masters)
    for index, master in enumerate(masters):
        # The sheets of a group of order codes are in the order of the masters.
        usable_sheets = list(_usable_sheets(interface_sheets, index))
        for file_rule in master.files:
            # Each device once, in the order of the sheets.
            master_devices: dict[str, None] = {}
            for sheet_of_codes in usable_sheets:
                master_devices |= dict.fromkeys(sheet_of_codes.sheet.devices_with(file_rule))
            for master_device in master_devices:
                file_of_codes = _FileOfCodes(
                    path_start=_start_of_path(master, file_rule, master_device),
                    device=device,
                    sheets=[codes for codes in usable_sheets if master_device not in codes.sheet.unusable_devices],
                    file_rule=file_rule,
                    master_device=master_device,
                    library=library,
                )
                if files_option == _ONE_FILE_EACH:
                    yield from _file_of_each_order_code(file_of_codes)
                else:
                    suffix = FILE_FORMATS[file_rule["format"]].suffix
                    yield f"{file_of_codes.path_start}{device.name}{suffix}", partial(_bulk_text, file_of_codes)


def _start_of_path(master: Master, file_rule: YamlMapping, master_device: str) -> str:
    """Return the folder and the beginning of the names of files, such as ``masters/acme/c_struct/m100-``.

    If the master has only one device, the names have no such beginning, and the result is only the folder.
    """
    folder = f"masters/{master.name}/{file_rule['format']}/"
    if len(master.devices) == 1:
        return folder
    (device_name,) = names_of_codes([master_device])
    return f"{folder}{device_name}-"


def _usable_sheets(interface_sheets: Sequence[GroupSheets], master_index: int) -> Iterator[_SheetOfCodes]:
    """Yield the settings of a master, each with the facts and the order codes that share them.

    Order codes that the master cannot read are left out. ``master_index`` is the index of the master in the list of
    all masters.
    """
    for group_sheets in interface_sheets:
        _, sheets = group_sheets.sheets[master_index]
        for sheet, group in zip(sheets, group_sheets.groups, strict=True):
            if not sheet.refusals:
                yield _SheetOfCodes(sheet=sheet, facts=group.facts, order_codes=group.codes)


def _format_page(library: Library, files: Iterable[str]) -> str:
    """Return the README, which lists the formats of masters. Formats without a path in ``files`` are left out."""
    folders: set[str] = set()
    for path in files:
        folder, _, _ = path.rpartition("/")
        folders.add(folder.removeprefix("masters/"))
    rows: list[dict[str, str]] = []
    for master in shipped_masters():
        rows += [_index_row(master, file_rule["format"]) for file_rule in master.files]
    values: Index = {
        "families": [escape_markdown(titled_in_lists(device)) for device in library.devices],
        "rows": [row for row in rows if row["folder"] in folders],
    }
    return TEMPLATES.render("README.md.jinja", values, library.own_templates)


def _index_row(master: Master, format_name: str) -> dict[str, str]:
    """Return the row of the README for a format of a master, with its folder and the program that reads it."""
    file_format = FILE_FORMATS[format_name]
    return {
        "master": master.title,
        "format": format_name,
        "folder": f"{master.name}/{format_name}",
        "title": file_format.title,
        "reader": file_format.reader,
    }


class _SheetOfCodes(NamedTuple):
    """Settings of order codes for a master, with the facts that these order codes share."""

    sheet: SettingsSheet
    facts: EncoderFacts
    order_codes: Sequence[str]


@dataclass(frozen=True, slots=True)
class _FileOfCodes:
    """File of a master for a family, or the files for its order codes. Their paths begin with ``path_start``.

    ``file_rule`` is the entry of ``files`` in the description of the master, and ``master_device`` is its device.
    """

    path_start: str
    device: Device
    sheets: Sequence[_SheetOfCodes]
    file_rule: YamlMapping
    master_device: str
    library: Library

    def text(
        self,
        order_codes: Sequence[str],
        sheet: SettingsSheet,
        is_short: bool = False,
        file_content: Content | None = None,
    ) -> str:
        """Return the text for order codes that have these settings. If ``is_short``, it lacks what all codes share."""
        return file_text(
            self.device,
            order_codes,
            sheet,
            file_rule=self.file_rule,
            master_device=self.master_device,
            library=self.library,
            is_short=is_short,
            file_content=file_content,
        )


def _file_of_each_order_code(files: _FileOfCodes) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path of a file for each order code, and a function that returns its text.

    Each path has the order code, and the answers to questions that the manual leaves open.
    """
    suffix = FILE_FORMATS[files.file_rule["format"]].suffix
    labels: list[str] = []
    text_functions: list[Callable[[], str]] = []
    for sheet_of_codes in files.sheets:
        for order_code in sheet_of_codes.order_codes:
            labels.append(_code_and_answers(order_code, sheet_of_codes.facts))
            text_functions.append(partial(files.text, [order_code], sheet_of_codes.sheet))
    for name, text_function in zip(names_of_codes(labels), text_functions, strict=True):
        yield f"{files.path_start}{name}{suffix}", text_function


def _code_and_answers(code: str, facts: EncoderFacts) -> str:
    """Return an order code with the answers to open questions, joined by hyphens."""
    return "-".join((code, *facts.answers.values()))


def _bulk_text(bulk_file: _FileOfCodes) -> str:
    """Return the text of a bulk file. Order codes with the same content and the same answers share a block."""
    sheets_by_content: dict[tuple[Content, tuple[tuple[str, str], ...]], list[_SheetOfCodes]] = {}
    for sheet_of_codes in bulk_file.sheets:
        file_content = content_of_file(sheet_of_codes.sheet, bulk_file.file_rule, bulk_file.master_device)
        answers = tuple(sheet_of_codes.facts.answers.items())
        sheets_by_content.setdefault((file_content, answers), []).append(sheet_of_codes)
    blocks = [_block(bulk_file, file_content, sheets) for (file_content, _), sheets in sheets_by_content.items()]
    first_sheets = [sheets[0].sheet for sheets in sheets_by_content.values()]
    head = _bulk_head(bulk_file, first_sheets)
    return _joined_blocks(blocks, head, FILE_FORMATS[bulk_file.file_rule["format"]].comment)


def _block(bulk_file: _FileOfCodes, file_content: Content, sheets: Sequence[_SheetOfCodes]) -> _Block:
    """Return the block of order codes that share the content of their file and the answers to open questions."""
    first_sheet = sheets[0]
    order_codes = [order_code for sheet_of_codes in sheets for order_code in sheet_of_codes.order_codes]
    title = ", ".join(order_codes)
    if first_sheet.facts.answers:
        chosen_answers = " and ".join(f"{question}={answer}" for question, answer in first_sheet.facts.answers.items())
        title += f" with {chosen_answers}"
    block_text = bulk_file.text(order_codes, first_sheet.sheet, is_short=True, file_content=file_content)
    return _Block(title, block_text)


def _bulk_head(bulk_file: _FileOfCodes, sheets: Sequence[SettingsSheet]) -> list[str]:
    """Return the paragraphs at the top of a bulk file: its purpose, its origin, and the conditions of writing.

    ``sheets`` are the settings in the file.
    """
    device, file_rule, master_device = bulk_file.device, bulk_file.file_rule, bulk_file.master_device
    format_title = FILE_FORMATS[file_rule["format"]].title
    # Each condition once, in the order of the sheets.
    conditions: dict[str, None] = {}
    for sheet in sheets:
        conditions |= dict.fromkeys(map(condition_text, sheet.writing))
    return [
        f"{master_device} with the order codes of {device.title}. For {format_title}.",
        *_paragraphs_on_origin(device, sheets, file_rule, master_device),
        *conditions,
        "Each block is for the first channel. A file that codewheel prints for one order code has all channels.",
    ]


class _Block(NamedTuple):
    """Part of a bulk file for order codes with the same content."""

    title: str
    text: str


def _joined_blocks(blocks: Sequence[_Block], head: Sequence[str], comment_prefix: str) -> str:
    """Return a bulk file with these blocks as comments, or in XML as children of one element.

    ``head`` are the paragraphs of the comment at its top. The lines of comments begin with ``comment_prefix``.
    """
    if comment_prefix == "<!--":
        xml_head = comment([*head, "Copy the element below your order code into a file of its own."], "<!--")
        elements = []
        for block in blocks:
            title_comment = comment([block.title], "<!--")
            elements.append(f"\n{title_comment}\n{_without_declaration(block.text)}")
        return f'<?xml version="1.0" encoding="UTF-8"?>\n{xml_head}\n<files>{"".join(elements)}</files>\n'
    advice = f"Copy the lines below your order code and remove the first {comment_prefix} of each line."
    lines = [comment([*head, advice], comment_prefix)]
    for block in blocks:
        lines += ["", comment([f"=== {block.title}"], comment_prefix)]
        lines += [f"{comment_prefix} {line}".rstrip() for line in block.text.splitlines()]
    return "\n".join(lines) + "\n"


def _without_declaration(text: str) -> str:
    """Return the text of an XML file without its declaration, ``<?xml … ?>``."""
    if not text.startswith("<?xml"):
        return text
    _, _, text_after_declaration = text.partition("?>\n")
    return text_after_declaration


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
