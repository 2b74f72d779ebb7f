"""BiSS files: an ``idbissXXXX.xml`` for each manufacturer with its validation, and a full description of each device.

Only the beginning of one idbiss file is public. Our file uses only the elements and attributes found there. Comments
mark every further interpretation as inferred. Facts with no publicly known place in the format are in the full
description, for which we have our own schema.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any, TypedDict

from lxml import etree

from ...dump.plain import device_dump, variant_dump
from ...dump.xml import XSD_NAME, schema_text, to_xml
from ...model import Alternative, Answer, Biss, Device, Manufacturer, Variant, answer_combinations
from ...order_codes.labels import LabelMatch
from ...order_codes.parameters import run_time_widths
from ...render import Templates, our_templates
from .. import NO_OPTIONS, Library, Option, Options, Target
from ..registry import licence_in, names_of_codes
from .data_channels import Node, ascii_text, channels_by_length, comment, comment_text, master_settings
from .identity import IdBits, data_lengths, device_bits, manufacturer_bits, only_crc, single_cycle_data

#: Size limit in bytes. It is far above the size of any DTD of this kind and prevents the reading of a wrong file.
_LARGEST_DTD = 1_000_000


class DtdError(ValueError):
    """A DTD cannot be used. The message gives the reason."""


class _OneFile(etree.Resolver):
    """A resolver that supplies the DTD for the DOCTYPE of our file, and rejects other files and the network.

    ``refused`` is the address of the first rejected file, or empty. ``answered`` is True after the DTD was supplied.
    """

    def __init__(self, path: str, text: bytes) -> None:
        super().__init__()
        self.path = path
        self.text = text
        self.rejected_address = ""
        self.has_sent_dtd = False

    def resolve(self, *request: Any, **_: Any) -> Any:
        """Return the DTD for the first request, which comes from our DOCTYPE, and an empty text for any other request.

        lxml calls this method with the address, the public ID and the context. The published type stubs do not declare
        the context.
        """
        address, public_id, context = request
        supply: Any = self.resolve_string
        if not self.has_sent_dtd:
            self.has_sent_dtd = True
            return supply(self.text, context, base_url=self.path)
        # The message names the first rejected file.
        self.rejected_address = self.rejected_address or address or public_id or "another file"
        return supply(b"", context)


def read_dtd(path: Path) -> bytes:
    """Return the text of a DTD.

    Raises:
        DtdError: The file cannot be read or is far too large.
    """
    try:
        with path.open("rb") as file:
            # One byte more than allowed shows that the file is too large.
            text = file.read(_LARGEST_DTD + 1)
    except OSError as error:
        raise DtdError(f"{path}: {error.strerror}") from None
    if len(text) > _LARGEST_DTD:
        raise DtdError(f"{path}: too large for a document type. Is this the right file?")
    return text


def validation_errors(document: str, name: str, dtd: bytes, dtd_name: str) -> list[str]:
    """Return the errors in ``document`` according to ``dtd``, each as ``file:line: message``.

    The document is ASCII text. Entities in it are not expanded. If the parser stops without logging an error, the only
    message has no line.

    Raises:
        DtdError: The DTD itself is invalid or refers to other files.
    """
    resolver = _OneFile(dtd_name, dtd)
    parser = etree.XMLParser(
        dtd_validation=True, load_dtd=True, no_network=True, resolve_entities=False, huge_tree=False
    )
    parser.resolvers.add(resolver)
    # The message of the parser if it stops, for when it has logged none.
    syntax_error = ""
    try:
        # Called for the errors that it logs. The document itself is not needed.
        etree.fromstring(document.encode("ascii"), parser, base_url=name)
    except etree.XMLSyntaxError as error:
        syntax_error = str(error.msg)
    if resolver.rejected_address:
        raise DtdError(
            f"{dtd_name}: refers to {resolver.rejected_address}. Other files and the network are not read. "
            "Put everything into one file"
        )
    located_messages = []
    for logged in parser.error_log:
        message = " ".join(logged.message.split())
        if logged.filename == dtd_name:
            raise DtdError(f"{dtd_name}:{logged.line}: {message}")
        located_messages.append(f"{name}:{logged.line}: {message}")
    if not located_messages and syntax_error:
        return [f"{name}: {syntax_error}"]
    return located_messages


_EACH = "each"
_BY_CODE = Option(
    "order-codes",
    "each: also write one file per order code, with numbers instead of expressions",
    "none",
    ("none", _EACH),
)


class Readme(TypedDict):
    identifiers: Annotated[list[str], "names of the idbiss files in code"]


class Identifier(TypedDict):
    notes: Annotated[list[str], "text of the first comment"]
    root: Annotated[Node, "element of the manufacturer, which contains those of its encoders"]
    left_out: Annotated[str, "a sentence about encoders that are not listed, or an empty string"]


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return the files for BiSS masters by path, or no files without devices.

    They are ``biss/idbissXXXX.xml`` for each manufacturer with a BiSS ID and an encoder that a master can identify,
    ``biss/<maker>-<device>/idbiss-<order code>.xml`` for each order code that a master can identify,
    ``biss/<maker>-<device>.xml`` with the full description of each family, its schema, a README and the license.

    With the option ``order-codes=each``, ``biss/<maker>-<device>/<order code>.xml`` describes each order code, with
    numbers instead of expressions.
    """
    files: dict[str, str] = {}
    identifiers = []
    for maker, devices in library.by_manufacturer():
        nodes, sentence_on_missing = _identified_nodes(devices)
        if maker.biss_id is not None and nodes:
            file_name = identifier_name(maker.biss_id)
            identifiers.append(f"`{file_name}`")
            files[f"biss/{file_name}"] = _render_identifier(
                maker,
                maker.biss_id,
                library,
                first_lines=[f"{maker.title}: encoders with a BiSS C interface."],
                nodes=nodes,
                left_out=sentence_on_missing,
            )
        for device in devices:
            files |= library.files_of(_files_of_family, device, options)
    if files:
        readme: Readme = {"identifiers": identifiers}
        files["biss/README.md"] = TEMPLATES.render("README.md.jinja", readme, library.own_templates)
        files |= {f"biss/{XSD_NAME}": schema_text()} | licence_in("biss")
    return files


def identifier_name(biss_id: int) -> str:
    """Return the name of the file that describes the encoders of a manufacturer."""
    return f"idbiss{biss_id:04X}.xml"


def _files_of_family(device: Device, library: Library, options: Options) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path of each file of a family, and a function that returns its text."""
    maker = device.manufacturer
    yield f"biss/{maker.name}-{device.name}.xml", lambda: to_xml(device_dump(device))
    if maker.biss_id is not None:
        yield from _single_encoder_files(maker.biss_id, device, library)
    if options.get(_BY_CODE.name, _BY_CODE.default) == _EACH:
        yield from _files_of_order_codes(f"biss/{maker.name}-{device.name}", device)


def _files_of_order_codes(folder: str, device: Device) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path of the description of each order code, and a function that returns its text."""
    names = names_of_codes(variant.code for variant in device.variants)
    for name, variant in zip(names, device.variants, strict=True):
        yield f"{folder}/{name}.xml", partial(_order_code_xml, device, variant)


def _order_code_xml(device: Device, variant: Variant) -> str:
    """Return the description of an order code, with numbers instead of expressions."""
    code_match = LabelMatch(variant, unlisted=(), tail="", special=False)
    return to_xml(variant_dump(device, code_match))


def _identified_nodes(devices: Sequence[Device]) -> tuple[list[Node], str]:
    """Return the elements of the families that a master can identify, and a sentence about those without a device ID.

    The sentence is empty if all families have an ID. Families without single cycle data are left out.
    """
    # A master cannot distinguish a special model or another edition from its family.
    families = [device for device in devices if device.find_interface(Biss) is not None and not device.base]
    nodes: list[Node] = []
    titles_without_id: list[str] = []
    for device in families:
        ids = device_bits(device)
        if not ids:
            titles_without_id.append(device.title)
            continue
        node = _device_element(device, ids)
        if node is not None:
            nodes.append(node)
    if not titles_without_id:
        return nodes, ""
    return nodes, f"Not listed, because the spec has no device ID: {', '.join(titles_without_id)}"


def _single_encoder_files(biss_id: int, device: Device, library: Library) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path of an idbiss file for each order code, and a function that returns its text.

    If the manual leaves questions about the places or widths of fields open, an order code has a file for each
    combination of answers. There are no files if a master cannot identify the family, or if it has no single cycle
    data.
    """
    ids = device_bits(device)
    layout = single_cycle_data(device)
    maker = device.manufacturer
    if not ids or layout is None:
        return
    open_questions = device.alternatives_of(layout)
    question_names = [question.name for question in open_questions]
    encoders: list[tuple[Variant, tuple[Answer, ...]]] = []
    for variant in device.variants_over(Biss.name):
        encoders += [(variant, answers) for answers, _ in answer_combinations(open_questions)]
    names = names_of_codes(_encoder_name(variant, answers) for variant, answers in encoders)
    for name, (variant, answers) in zip(names, encoders, strict=True):
        answers_by_question = dict(zip(question_names, answers, strict=True))
        text_function = partial(_encoder_xml, biss_id, device, variant, answers_by_question, library)
        yield f"biss/{maker.name}-{device.name}/idbiss-{name}.xml", text_function


def _encoder_xml(
    biss_id: int, device: Device, variant: Variant, answer_by_question: Mapping[str, Answer], library: Library
) -> str:
    """Return the idbiss file of an order code with these answers to its open questions."""
    maker = device.manufacturer
    encoder = _narrow_to_encoder(device, variant, answer_by_question)
    node = _device_element(encoder, device_bits(device), one_encoder=True)
    first_lines = [f"{maker.title}: {variant.code}.", _ONE_ENCODER_NOTE]
    questions = {question.name: question for question in device.alternatives}
    for question_name, answer in answer_by_question.items():
        first_lines.append(_about_answer(questions[question_name], answer))
    nodes = [node] if node is not None else []
    return _render_identifier(maker, biss_id, library, first_lines=first_lines, nodes=nodes)


def _encoder_name(variant: Variant, answers: Iterable[Answer]) -> str:
    """Return the order code and the names of the answers, such as ``X-24-wide``."""
    answer_names = [answer.name for answer in answers]
    return "-".join([variant.code, *answer_names])


def _narrow_to_encoder(device: Device, variant: Variant, answer_by_question: Mapping[str, Answer]) -> Device:
    """Return the device with only one order code, and only one answer to each question in ``answer_by_question``."""
    questions: list[Alternative] = []
    for question in device.alternatives:
        answer = answer_by_question.get(question.name)
        questions.append(replace(question, answers=(answer,)) if answer is not None else question)
    return replace(device, variants=(variant,), alternatives=tuple(questions))


def _about_answer(question: Alternative, answer: Answer) -> str:
    """Return the sentences on a question that the manual leaves open, and on the answer that a file is for."""
    return (
        f"The manual leaves {question.name} open ({question.meaning}). This file is for {answer.name}: "
        f"{answer.meaning}. There is a file for each answer."
    )


def _render_identifier(
    maker: Manufacturer,
    biss_id: int,
    library: Library,
    *,
    first_lines: Sequence[str],
    nodes: Sequence[Node],
    left_out: str = "",
) -> str:
    """Return the idbiss file with these encoders from one manufacturer.

    Its first comment is the warning, and ``first_lines`` begin the second one. ``left_out`` is a comment about encoders
    that the file does not contain, or empty.
    """
    root = Node(
        ids=(manufacturer_bits(biss_id),),
        label=maker.title,
        notes=(_MANUFACTURER_NOTE,),
        devices=tuple(nodes),
    )
    about_file = "\n".join([*first_lines, _ABOUT])
    trademarks = [f"Trademarks: {notice}" for notice in maker.trademarks]
    values: Identifier = {
        "notes": [_warning_comment(biss_id), about_file, *trademarks],
        "root": root,
        "left_out": left_out,
    }
    return TEMPLATES.render("idbiss.xml.jinja", values, library.own_templates)


def _warning_comment(biss_id: int) -> str:
    """Return the first comment of a file, which people should read before they install it."""
    return (
        f"No BiSS master is known to accept this file. A manufacturer may supply its own {identifier_name(biss_id)}. "
        "If you have it, install it in the master, and never replace it with this file."
    )


_MANUFACTURER_NOTE = (
    "Inferred: Range counts the bits of the 64-bit identity that device ID (78h to 7Dh) and manufacturer ID (7Eh, 7Fh) "
    "form, high byte first: "
    "bit 63 is the highest of 78h, bit 0 the lowest of 7Fh. The public example has Range only for the 16-bit profile "
    "ID.\n"
    "Inferred: a Device inside a Device refines it, so that all Id on the way down must match, and the SCDS on the way "
    "describe one data channel.\n"
    "Inferred: Label of a Device names the manufacturer, and inside it the device after a comma. The public example "
    "has Label only for profiles."
)


_ABOUT = (
    "Structure inferred from the public opening of profilebiss.xml. Not validated against idbiss.dtd, which is not "
    "public, and not yet tested with a master. Only elements and attributes from that opening are used. Each "
    "further interpretation is marked as inferred.\n"
    "Everything without a publicly known place in the format is in the full description of each device, biss/*.xml."
)
_ONE_ENCODER_NOTE = (
    "For one order code. Masters identify the encoder by the IDs below, which it can share with other order codes of "
    "its family. A master cannot distinguish them, so give it a single file of a family."
)


def _device_element(device: Device, ids: tuple[IdBits, ...], *, one_encoder: bool = False) -> Node | None:
    """Return the element of a family, or of one encoder, or None without single cycle data.

    ``ids`` are the bits that identify it. The element contains another one with the data length, unless order codes
    differ in the length, or registers of the family change it.
    """
    layout = single_cycle_data(device)
    if layout is None:
        return None
    lengths = data_lengths(device, layout)
    crc = only_crc(device, layout, lengths)
    manual = device.manual
    is_length_changing = not one_encoder and bool(run_time_widths(device, layout))
    settings_comment = master_settings(device, layout, crc=crc, lengths=lengths, ids=ids, one_encoder=one_encoder)
    return Node(
        ids=ids,
        label=f", {device.title}",
        label_position=1,
        notes=(f"{device.title}; manual {manual.title}, revision {manual.revision}.",),
        notes_of_data=(settings_comment,),
        crc_polynomial=f"0x{crc.poly_with_top_bit:02X}" if crc is not None else "",
        devices=() if is_length_changing else channels_by_length(device, layout, ids, lengths),
    )


TEMPLATES = Templates(
    our_templates("biss"),
    values={"README.md.jinja": Readme, "idbiss.xml.jinja": Identifier},
    filters={"comment": comment, "comment_text": comment_text, "ascii_text": ascii_text},
    autoescape=True,
)
TARGET = Target(
    name="biss",
    summary="idbissXXXX.xml for BiSS masters, and a full description of each family in XML",
    files=generate,
    options=(_BY_CODE,),
    templates=TEMPLATES,
    family=_files_of_family,
)
