"""The browser target: a page and a script that decode frames and registers, with the data of each family.

Regular expressions come from ``order_codes``, in the notation of JavaScript.

The script contains the plans of all frames as tables, and the runtime. Other pages can embed the decoder box.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, TypedDict

from ...language.problems import LONGEST_QUOTE, join_words
from ...model import (
    UNEXPLAINED,
    Alternative,
    Answer,
    CodePart,
    Crc,
    Device,
    Fault,
    Interface,
    Spelling,
    Variant,
    Verdict,
)
from ...model.fields import KNOWN_CRCS
from ...model.layout import differ_in_length
from ...order_codes.labels import AFTER, LONGEST, NEAR
from ...order_codes.patterns import as_listed, expression_of_code
from ...plan.crcs import CoveredData, kinds_of_covered_data
from ...plan.frames import FrameDispatch, HeldParameter, dispatches, held_parameters
from ...plan.verdicts import reportings
from ...render import Templates, our_templates
from ...say import frame_texts, text_on_one_line
from ...say.names_and_evidence import (
    GRADES,
    describe_grade,
    differences_from_manual,
    field_at,
    lowest_grade,
    mark_in_lists,
)
from ...say.order_code import not_on_label
from ...say.text import PLAIN_STYLE, VERDICT_CLAUSES, escape
from ...why import LEAST_FAILED, MOST_FRAMES
from ...why.diagnosis import CERTAIN, LEAST_BITS
from ...why.doubts import CUT_OFF, LEFT_ALIGNED, READINGS
from ...why.exchanges import (
    ECHO_TEXT,
    FRAMES_TEXT,
    LEAST_BITS_OF_ECHO,
    LEAST_EVIDENCE,
    MOST_BYTES,
    WORD_ECHO_TEXT,
)
from ...why.explain import LEAST_CRC_BITS
from ...why.hypotheses import (
    ACTIVE,
    AFTER_COMMAND,
    IDLE,
    INVERTED_WITHOUT_PAIR,
    LEAST_EQUAL_BITS,
    MISTAKES,
    OTHER_CODE_WITHOUT_CRC,
    START_BITS,
    TEXTS,
    WITH_SECOND_MISTAKE,
)
from ...why.in_bytes import BYTE_VALUES, LEAST_BITS_OF_MESSAGE_CRC, MOST_ECHOED_BYTES
from ...why.other_crcs import CRCS_OF_16_BITS, POLYNOMIALS, OtherCrc, other_crcs_over_bits, other_crcs_over_bytes
from ...why.other_order_codes import MOST_CUT_BITS, MOST_STATES
from ...why.recordings import FRAME_INSIDE, FRAME_INSIDE_TEXT, LINES, LineMistakes, line_name
from .. import NO_OPTIONS, Library, Options, Target
from ..picture_elements import palette_css
from ..registry import licence_in, our_runtime
from .example_link import LinkedFrame, linked_frame
from .layouts import (
    Data,
    SharedParts,
    channel_data,
    expression_data,
    frame_data,
    json_number,
    optional_expression_data,
    register_data,
    script_json,
    without_empty,
)
from .messages import MESSAGES, PASTED


def label_grammar(device: Device) -> Data:
    """Return the spellings of the order codes of a family.

    ``written`` are the spellings on labels. The one of the manual's list comes first. ``wrong`` contains a regular
    expression for each of the ``parts`` that accepts any text for this part, to find a wrong part of a label.
    """
    order_code = device.order_code
    listed_spelling = as_listed(order_code)
    spellings = (listed_spelling, *order_code.also_written)
    return {
        "pattern": order_code.pattern,
        "written": [_spelling_data(device, spelling) for spelling in spellings],
        "wrong": [
            _javascript_pattern(expression_of_code(order_code, listed_spelling, part.name)) for part in order_code.parts
        ],
        "parts": [_part_data(part) for part in order_code.parts],
    }


def _part_data(part: CodePart) -> Data:
    """Return a part of the order code with its values.

    ``only_with`` contains the values of other parts with which the part can have unlisted values, and ``open`` is the
    regular expression for unlisted values.
    """
    values = [value.text for value in part.values]
    return without_empty(name=part.name, values=values, only_with=dict(part.open_only_with), open=part.open)


def _spelling_data(device: Device, spelling: Spelling) -> Data:
    """Return a spelling of labels: its regular expression, the document that uses it, and its own texts for values.

    For each part, ``values`` contains the value by its text in capitals: ``{"output": {"BC": "biss"}}``.
    """
    values_by_part: dict[str, dict[str, str]] = {}
    for part_value in spelling.values:
        values_by_part.setdefault(part_value.part, {})[part_value.text.upper()] = part_value.value
    return without_empty(
        label=_javascript_pattern(expression_of_code(device.order_code, spelling)),
        where=spelling.where,
        values=values_by_part,
    )


def _javascript_pattern(expression: str) -> str:
    """Return a regular expression for a whole label in the notation of JavaScript."""
    return javascript_pattern(f"^{expression}{AFTER}$")


def javascript_pattern(expression: str) -> str:
    """Return a regular expression in the notation of JavaScript, in which named groups begin with ``(?<``."""
    return expression.replace("(?P<", "(?<")


def family_data(device: Device) -> Data:
    """Return all data of a family for the script.

    ``given`` are the parameters that order codes set, ``derived`` the parameters computed from them, and ``held`` the
    parameters in registers. ``shared`` are the parts to which the indexes in ``interfaces`` refer.
    """
    parameter_names = [parameter.name for parameter in device.parameters if parameter.equals is None]
    interface_names = [interface.name for interface in device.interfaces]
    parameters_in_registers: list[HeldParameter] = []
    for holding_register in held_parameters(device):
        parameters_in_registers += holding_register.parameters
    shared = SharedParts()
    # This adds the parts of all frames and registers to ``shared``.
    interfaces = [_interface_data(device, interface, shared) for interface in device.interfaces]
    return without_empty(
        name=device.name,
        title=device.title,
        base=device.base,
        special=next((overlay.special for overlay in device.overlays if overlay.special), ""),
        special_codes=device.order_code.special,
        about=[PLAIN_STYLE.sentence(fact) for fact in (*not_on_label(device), *differences_from_manual(device))],
        evidence=PLAIN_STYLE.sentence(describe_grade(device)),
        mark=mark_in_lists(device),
        given=parameter_names,
        derived=[[name, expression_data(value)] for name, value in device.definitions.items()],
        held=[_held_parameter_data(device, parameter) for parameter in parameters_in_registers],
        alternatives=[_alternative_data(alternative) for alternative in device.alternatives],
        crcs={crc.name: _crc_data(device, crc) for crc in device.crcs},
        interfaces=interfaces,
        shared=shared.parts,
        labels=label_grammar(device),
        codes=[_order_code_row(variant, interface_names, parameter_names) for variant in device.variants],
    )


def _order_code_row(variant: Variant, interface_names: Sequence[str], parameter_names: Sequence[str]) -> list[Any]:
    """Return an order code, the index of its interface, and the values of its parameters: ``["X-24", 0, 24, 12]``."""
    values = (json_number(variant.parameters[name]) for name in parameter_names)
    return [variant.code, interface_names.index(variant.interface), *values]


def _held_parameter_data(device: Device, register_parameter: HeldParameter) -> Data:
    """Return a parameter that is read from a register: its place, its limits, and the values that its codes mean."""
    parameter = register_parameter.parameter
    return without_empty(
        name=parameter.name,
        meaning=parameter.meaning,
        at=field_at(device, parameter.read_from),
        min=parameter.min,
        max=parameter.max,
        values=sorted({row.value for row in parameter.by_code}),
    )


def _alternative_data(alternative: Alternative) -> Data:
    """Return a question that the manual leaves open, with its answers."""
    return without_empty(
        name=alternative.name,
        meaning=alternative.meaning,
        answers=[_answer_data(answer) for answer in alternative.answers],
        default=alternative.default,
    )


def _answer_data(answer: Answer) -> list[Any]:
    """Return an answer: its name, its meaning, and the parameters that it sets: ``["gray", "…", {"code": 1}]``."""
    return [answer.name, answer.meaning, {name: json_number(value) for name, value in answer.sets.items()}]


def _crc_data(device: Device, crc: Crc) -> Data:
    """Return the parameters of a CRC, and those of similar CRCs that people use by mistake.

    ``others`` are the similar CRCs over bits, and ``byte_others`` those over bytes. Each is left out if no such frame
    has the CRC.
    """
    covered_data = kinds_of_covered_data(device, crc)
    similar_crcs = {
        "others": other_crcs_over_bits(crc) if CoveredData.BITS in covered_data else (),
        "byte_others": other_crcs_over_bytes(crc) if CoveredData.BYTES in covered_data else (),
    }
    others = {name: _similar_crcs(crc, similar) for name, similar in similar_crcs.items()}
    return _crc_parameters(crc) | {"text": crc.polynomial} | without_empty(**others)


def _similar_crcs(crc: Crc, similar_crcs: Iterable[OtherCrc]) -> list[list[Any]]:
    """Return the mistake, its text, and the parameters of each similar CRC that differs from ``crc``."""
    return [[kind, text, _crc_parameters(similar)] for kind, text, similar in similar_crcs if similar != crc]


def _crc_parameters(crc: Crc) -> Data:
    """Return the parameters of a CRC in the notation of CRC catalogs, except those that are 0."""
    return without_empty(
        width=crc.width,
        poly=json_number(crc.poly),
        init=json_number(crc.init),
        refin=int(crc.refin),
        refout=int(crc.refout),
        xorout=json_number(crc.xorout),
    )


def _interface_data(device: Device, interface: Interface, shared: SharedParts) -> Data:
    """Return an interface with its frames and registers, whose parts are added to ``shared`` and replaced by indexes.

    ``exact`` contains the senders whose frames differ in length, so that a frame in bytes cannot be a longer frame
    without its leading zeros. ``told`` contains the fields whose value distinguishes frames (the selectors).
    """
    reporting_by_frame = reportings(device)
    frames: list[Data] = []
    for layout in interface.layouts:
        frames.append(frame_data(device, interface.name, layout, reporting_by_frame.get(layout.name)))
    registers = [register_data(device, register) for register in device.registers_over(interface.name)]
    return without_empty(
        name=interface.name,
        title=interface.title,
        line=line_name(interface),
        measure=_position_unit(device, interface),
        exact=[sender for sender in ("encoder", "master") if differ_in_length(interface.layouts, sender)],
        frames=list(map(shared.with_indexes, frames)),
        channels=channel_data(device, interface),
        told=[_dispatch_data(interface, dispatch) for dispatch in dispatches(interface.layouts)],
        registers=list(map(shared.with_indexes, registers)),
    )


def _position_unit(device: Device, interface: Interface) -> Data:
    """Return the unit of the position over an interface, or an empty dict if the manual gives none.

    If several fields form the position, ``part`` is the last one, which is the angle within a turn.
    """
    measurement = device.measurement_of(interface.name)
    if measurement is None:
        return {}
    joins = (join for layout in interface.layouts for join in layout.joins if join.name == measurement.position_name)
    return without_empty(
        of=measurement.position_name,
        part=next((join.fields[-1] for join in joins), ""),
        step_um=optional_expression_data(measurement.step_um),
        step_nm=optional_expression_data(measurement.step_nm),
        per_counts=optional_expression_data(measurement.per_counts),
        counts_per_turn=optional_expression_data(measurement.counts_per_turn),
        turns=optional_expression_data(measurement.turns),
    )


def _dispatch_data(interface: Interface, dispatch: FrameDispatch) -> Data:
    """Return the field by which the frames of a sender differ (the selector), and its values in each frame.

    ``pieces`` are the bits of bytes that form the field. A frame is ``[index of the layout, value, …]``. ``fallback``
    is the index of the frame for all other values, or -1.
    """
    indexes = {layout.name: index for index, layout in enumerate(interface.layouts)}
    return without_empty(
        sender=dispatch.sender,
        selector=dispatch.selector.name,
        pieces=[
            [bit_slice.byte, bit_slice.low_in_byte, bit_slice.mask, bit_slice.low_in_number]
            for bit_slice in dispatch.bits.bit_slices
        ],
        needs=dispatch.bytes_needed,
        frames=[[indexes[branch.layout.name], *map(json_number, branch.values)] for branch in dispatch.branches],
    ) | {"fallback": indexes[dispatch.fallback.name] if dispatch.fallback is not None else -1}


class Page(TypedDict):
    title: Annotated[str, "the manufacturers on one line"]
    codes: Annotated[int, "number of order codes"]
    example: Annotated[LinkedFrame, "an order code, and a valid frame if there is one"]
    table: Annotated[Data, "data of the script: messages, mistakes with a frame, and the families"]
    runtime: Annotated[Mapping[str, str], "the parts of the script that are the same for all encoders, by name"]
    palette: Annotated[str, "style sheet with the colours as custom properties"]


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return the page, the script and the README."""
    codes = [variant.code for device in library.devices for variant in device.variants]
    page: Page = {
        "title": join_words(text_on_one_line(manufacturer.title) for manufacturer, _ in library.by_manufacturer()),
        "codes": len(set(codes)),
        "example": linked_frame(library.devices),
        "table": script_table(library),
        "runtime": {path.stem: _code_without_comment(path) for path in our_runtime("browser").glob("*.js")},
        "palette": palette_css().rstrip("\n"),
    }
    file_names = ("README.md", "decode.html", "decode.js")
    files = {f"browser/{name}": TEMPLATES.render(f"{name}.jinja", page, library.own_templates) for name in file_names}
    return files | licence_in("browser")


def _code_without_comment(path: Path) -> str:
    """Return the code of a part of the script, without the comment at its top."""
    return path.read_text(encoding="utf-8").partition("\n\n")[2].rstrip("\n")


def script_table(library: Library) -> Data:
    """Return the data for the script: texts and tables that are the same for all families, and the families.

    ``worth`` are the verdicts in words, worst first, and ``said`` the messages. ``lines``, ``exchanges``, ``doubts``,
    ``inside`` and ``likely`` are for the explanation of frames that do not decode, or whose values look wrong.
    """
    return {
        "faults": [fault_code.value for fault_code in Fault],
        "worth": {verdict.value: VERDICT_CLAUSES[verdict] for verdict in Verdict},
        "unexplained": UNEXPLAINED,
        "said": MESSAGES,
        "notations": {"pasted": PASTED, "odd_blanks": frame_texts.ODD_BLANKS, "time": frame_texts.TIME}
        | dict(frame_texts.DIGITS),
        "limits": {"text": frame_texts.LONGEST, "quote": LONGEST_QUOTE, "label": LONGEST, "likeness": NEAR},
        "lines": {name: _line_data(line) for name, line in LINES.items()},
        "exchanges": {"most": MOST_BYTES, "least": LEAST_EVIDENCE, "echo": ECHO_TEXT, "frames": FRAMES_TEXT}
        | {"least_in_word": LEAST_BITS_OF_ECHO, "word_echo": WORD_ECHO_TEXT}
        | {"echoed": MOST_ECHOED_BYTES, "byte_values": BYTE_VALUES, "message_crc": LEAST_BITS_OF_MESSAGE_CRC},
        "doubts": READINGS,
        "left_aligned": LEFT_ALIGNED,
        "cut_off": CUT_OFF,
        "inside": [FRAME_INSIDE, FRAME_INSIDE_TEXT],
        "texts": dict(TEXTS),
        "start_bits": START_BITS,
        "polynomials": POLYNOMIALS,
        "likely": {"kinds": dict(MISTAKES), "idle": IDLE, "active": ACTIVE, "without_pair": INVERTED_WITHOUT_PAIR}
        | {"other_code_without_crc": OTHER_CODE_WITHOUT_CRC, "after_command": AFTER_COMMAND}
        | {"least_failed": LEAST_FAILED, "frames": MOST_FRAMES}
        | {"bits": LEAST_BITS, "equal_bits": LEAST_EQUAL_BITS, "certain": CERTAIN}
        | {"channel_crc_bits": LEAST_CRC_BITS, "with_second": WITH_SECOND_MISTAKE}
        | {"cut_bits": MOST_CUT_BITS, "states": MOST_STATES},
        "line": {"mark": GRADES[-1], "evidence": f"Evidence: {lowest_grade()}."},
        "known_crcs": [[json_number(known.polynomial), known.init, known.use] for known in KNOWN_CRCS],
        "byte_polynomials": [polynomial for polynomial in POLYNOMIALS if polynomial.bit_length() == 9],
        "crcs_of_16_bits": CRCS_OF_16_BITS,
        "families": [library.part(_family_data, device, NO_OPTIONS) for device in library.devices],
    }


def _line_data(line: LineMistakes) -> Data:
    """Return the mistakes with the bits around a frame, each as a list, with patterns in the notation of JavaScript."""
    offsets = [
        [
            offset.kind,
            offset.text,
            offset.bits_before,
            offset.missing_first_bits,
            offset.lost_last_bits,
            offset.bits_after,
        ]
        for offset in line.offsets
    ]
    recordings = [
        [pattern.kind, pattern.text, javascript_pattern(pattern.regular_expression), pattern.proof_groups]
        for pattern in line.recording_patterns
    ]
    incomplete = [
        [pattern.text, javascript_pattern(pattern.regular_expression)] for pattern in line.incomplete_patterns
    ]
    return {"slips": offsets, "recordings": recordings, "incomplete": incomplete}


def _family_data(device: Device, library: Library, options: Options) -> Data:
    """Return all data of a family. ``Library.part`` requires the arguments ``library`` and ``options``."""
    return family_data(device)


def sha256(part: str) -> str:
    """Return the expression that allows this inline part of a page in a Content-Security-Policy.

    It is the hash of the part in Base64, such as ``sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=``.
    """
    digest = hashlib.sha256(part.encode()).digest()
    return f"sha256-{base64.b64encode(digest).decode()}"


TEMPLATES = Templates(
    our_templates("browser"),
    values=dict.fromkeys(("README.md.jinja", "decode.html.jinja", "decode.js.jinja"), Page),
    filters={"script_json": script_json, "md": escape, "sha256": sha256},
)
TARGET = Target(
    name="browser",
    summary="a page that decodes frames without a server",
    files=generate,
    templates=TEMPLATES,
    family=_family_data,
)
