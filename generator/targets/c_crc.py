"""CRCs in C: without a table where the polynomial has two or three terms, with one where not; a macro chooses another form."""

from __future__ import annotations

from collections.abc import Sequence

from ..crc import fold_plan, reflect, table, word_table
from ..model import Crc, Device, FoldStep, cite
from ..words import sentence
from .c_source import Paragraph, errata_at, errata_text, mask, number, unsigned
from .c_views import CrcView


def fold_lines(steps: Sequence[FoldStep], bits: int, start: str, name: str = "v") -> list[str]:
    """The steps over the number ``start`` as code that leaves the remainder in a new local of 32 bits, ``name``.

    Small machines work in 32 bits and shift wider numbers slowly: the step that makes the number fit takes what is above and what is below
    its place out of the halves of the wide one.
    """
    lines: list[str] = []
    current = start
    for step in steps:
        left = max(step.shift, bits - step.shift + step.back)
        if current == name:
            lines.append(f"{name} = {fold_step(name, step)};")
        elif left > 32 or bits - step.shift > 32:
            lines.append(f"{'' if current == 'wide' else 'uint64_t '}wide = {fold_step(current, step)};")
            current = "wide"
        elif bits <= 32:
            lines += [f"uint32_t {name} = (uint32_t){current};", f"{name} = {fold_step(name, step)};"]
            current = name
        else:
            low = f"(uint32_t){current}" if step.shift == 32 else f"((uint32_t){current} & {mask(step.shift)})"
            back = f" ^ (high << {step.back}U)" if step.back else ""
            upper = f"(uint32_t)({current} >> 32U)"
            high = upper if step.shift == 32 else f"({upper} << {32 - step.shift}U) | ((uint32_t){current} >> {step.shift}U)"
            lines += [f"const uint32_t high = {high};", f"uint32_t {name} = {low} ^ high{back};"]
            current = name
        bits = left
    return lines if current == name else [*lines, f"const uint32_t {name} = (uint32_t){current};"]


def fold_step(name: str, step: FoldStep) -> str:
    shifted = f"({name} >> {step.shift}U)"
    back = f" ^ ({shifted} << {step.back}U)" if step.back else ""
    return f"({name} & {mask(step.shift)}) ^ {shifted}{back}"


def crc_body(crc: Crc) -> tuple[str, ...]:
    """A CRC of two or three terms over 64 bits: their remainder, moved up by the CRC's width, and the remainder of that."""
    lines = fold_lines(fold_plan(crc.width, crc.poly, 64), 64, "data")
    again = fold_plan(crc.width, crc.poly, 2 * crc.width)
    if 2 * crc.width <= 32:
        lines += [f"v <<= {crc.width}U;", *(f"v = {fold_step('v', step)};" for step in again)]
        return (*lines, f"return ({unsigned(crc.width)})(v ^ {number(crc.xorout, True)});")
    lines += [f"uint64_t raised = (uint64_t)v << {crc.width}U;", *(f"raised = {fold_step('raised', step)};" for step in again)]
    return (*lines, f"return ({unsigned(crc.width)})(raised ^ {number(crc.xorout, True)});")


def table_lines(values: Sequence[int], width: int) -> tuple[str, ...]:
    """The entries of a table as lines of an initialiser."""
    digits = 2 * ((width + 7) // 8)
    texts = [f"0x{value:0{digits}X}U" if width <= 32 else f"UINT64_C(0x{value:0{digits}X})" for value in values]
    in_a_line = {2: 12, 4: 8, 6: 8, 8: 6}.get(digits, 2)
    lines = [", ".join(texts[start : start + in_a_line]) for start in range(0, len(texts), in_a_line)]
    return (*(f"{line}," for line in lines[:-1]), lines[-1])


def table_step(crc: Crc, style: str, entry: str) -> tuple[str, ...]:
    """What takes the next byte into the register."""
    kind, width = unsigned(crc.width), crc.width
    byte = "(uint8_t)(data >> left)" if style == "bits" else "bytes[index]"
    if style == "bytes" and crc.refin:
        index, kept = f"crc ^ {byte}", "(crc >> 8U)"
    else:
        index = f"((uint32_t)crc << {8 - width}U) ^ {byte}" if width < 8 else f"crc ^ {byte}" if width == 8 else f"(crc >> {width - 8}U) ^ {byte}"
        kept = f"((crc & {mask(width - 8)}) << 8U)" if width > 8 else ""
    found = f"const {kind} found = {entry}((uint8_t)({index}));"
    return found, f"crc = ({kind})(found ^ {kept});" if width > 8 else "crc = found;"


def word_by_table(crc: Crc, bits: int, entry: str) -> list[str]:
    """The remainder ``v`` of a whole word, byte by byte as they are received."""
    count = (bits + 7) // 8
    if crc.width <= 8:
        lines = ["const uint32_t low = (uint32_t)word;", *(["const uint32_t high = (uint32_t)(word >> 32U);"] if count > 4 else [])]
        lines += [f"uint8_t v = (uint8_t){_byte(count - 1)};"]
        lines += [f"v = (uint8_t)({entry}(v) ^ (uint8_t){_byte(place)});" for place in range(count - 2, -1, -1)]
        return [*lines, *(f"v = (uint8_t)({fold_step('(uint32_t)v', step)});" for step in (fold_plan(crc.width, crc.poly, 8) if crc.width < 8 else ()))]
    whole = min(crc.width // 8, count)
    lines = ["const uint32_t low = (uint32_t)word;", *(["const uint32_t high = (uint32_t)(word >> 32U);"] if count - whole > 4 else [])]
    lines += [f"uint32_t v = (uint32_t)(word >> {8 * (count - whole)}U);" if count > whole else "uint32_t v = (uint32_t)word;"]
    for place in range(count - whole - 1, -1, -1):
        lines.append(f"v = {entry}((uint8_t)(v >> {crc.width - 8}U)) ^")
        lines.append(f"    ((v & {mask(crc.width - 8)}) << 8U) ^ (uint8_t){_byte(place)};")
    return lines


def _byte(place: int) -> str:
    """A byte of a word in its halves, which small machines take apart faster."""
    half, left = ("high", place - 4) if place > 3 else ("low", place)
    return f"({half} >> {8 * left}U)" if left else half


def word_by_bits(crc: Crc, bits: int) -> list[str]:
    """The remainder ``v`` of a whole word, bit by bit."""
    return [
        f"uint64_t left = word{f' << {64 - bits}U' if bits < 64 else ''};",
        "uint32_t v = 0U;",
        "uint32_t bit;",
        f"for (bit = 0U; bit < {bits}U; bit++) {{",
        f"    const uint32_t top = v >> {crc.width - 1}U;",
        f"    v = ((v & {mask(crc.width - 1)}) << 1U) | (uint32_t)(left >> 63U);",
        f"    v ^= (top != 0U) ? {number(crc.poly, True)} : 0U;",
        f"    left = (left & {mask(63)}) << 1U;",
        "}",
    ]


def divides_words(crc: Crc) -> bool:
    """Whether a word is sound when its CRC's polynomial divides it, so that it can be checked as it is."""
    return crc.init == 0 and not crc.refout and (crc.form == "fold" or crc.width >= 8) and crc.width <= 32


def crc_view(device: Device, crc: Crc, style: str, name: str) -> CrcView:
    """The function of a CRC over a string of bits (``fold``, ``bits``) or over bytes (``xor``, ``bytes``)."""
    parameters = f"width {crc.width}, polynomial {crc.poly:#x}, start {crc.init:#x}, final XOR {crc.xorout:#x}"
    reflected = ", input and output reflected" if crc.refin and crc.refout else ", input reflected" if crc.refin else ", output reflected" if crc.refout else ""
    about: list[Paragraph] = [f"CRC {crc.name}, {crc.polynomial} [{cite(crc.source)}]: {parameters}{reflected}.", sentence(crc.note)]
    about += {
        "fold": ["The argument holds the bits that the CRC covers, the last one sent in bit 0. Bits of 0 before them change nothing."],
        "bits": ["The argument holds the bits that the CRC covers, the last one sent in bit 0, and how many they are."],
        "xor": ["With this polynomial the CRC of whole bytes is their XOR."],
        "bytes": [],
    }[style]
    about += [errata_text(item) for item in errata_at(device, f"crcs.{crc.name}")]
    reflected_register = style == "bytes" and crc.refin
    in_words = any(layout.carried_as == "bits" and layout.crc_field is not None and layout.crc_field.crc == crc.name for _, layout in device.layouts())
    values: tuple[int, ...] = ()
    if style in ("bits", "bytes"):
        values = table(crc.width, crc.poly, reflected_register)
    elif style == "fold" and in_words:
        values = word_table(crc.width, crc.poly)
    return CrcView(
        name=name, type=unsigned(crc.width), style=style, about=tuple(about), crc=crc, wide=unsigned(max(crc.width, 8)), poly=number(crc.poly, True),
        init=number(crc.init, True), xorout=number(crc.xorout, True), mask=mask(crc.width), top_shift=number(crc.width - 1), width=number(crc.width),
        folds=crc_body(crc) if style == "fold" else (),
        table=table_lines(values, crc.width) if values else (),
        step=table_step(crc, style, f"{name}_entry") if style in ("bits", "bytes") else (),
        table_init=number(reflect(crc.init, crc.width) if reflected_register else crc.init, True),
        turned=crc.refout != reflected_register,
    )
