"""CRCs in C: without a table where the polynomial has two or three terms, bit by bit where not."""

from __future__ import annotations

from collections.abc import Sequence

from ..crc import fold_plan
from ..model import Crc, Device, FoldStep, cite
from .c_source import Paragraph, errata_at, errata_text, mask, number, sentence, unsigned
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
    return CrcView(
        name=name, type=unsigned(crc.width), style=style, about=tuple(about), crc=crc, wide=unsigned(max(crc.width, 8)), poly=number(crc.poly, True),
        init=number(crc.init, True), xorout=number(crc.xorout, True), mask=mask(crc.width), top_shift=number(crc.width - 1), width=number(crc.width),
        folds=crc_body(crc) if style == "fold" else (),
    )
