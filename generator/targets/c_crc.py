"""CRCs in C: without a table where the polynomial has two or three terms, bit by bit where not."""

from __future__ import annotations

from collections.abc import Sequence

from ..crc import fold_plan
from ..model import Crc, Device, FoldStep, cite
from .c_source import Paragraph, bracketed, errata_at, errata_text, mask, number, sentence, unsigned
from .c_views import CrcView


def fold_lines(steps: Sequence[FoldStep], bits: int, start: str) -> list[str]:
    """The steps as code that ends with the remainder in ``v``, a number of 32 bits: as soon as the value fits, so that small machines save work."""
    lines = [f"uint32_t v = (uint32_t){bracketed(start)};"] if bits <= 32 else [f"uint64_t wide = {start};", "uint32_t v;"]
    name = "v" if bits <= 32 else "wide"
    for step in steps:
        if name == "wide" and bits <= 32:
            name = "v"
            lines.append("v = (uint32_t)wide;")
        lines.append(fold_line(name, step))
        bits = max(step.shift, bits - step.shift + step.back)
    return lines if name == "v" else [*lines, "v = (uint32_t)wide;"]


def fold_line(name: str, step: FoldStep) -> str:
    shifted = f"({name} >> {step.shift}U)"
    back = f" ^ ({shifted} << {step.back}U)" if step.back else ""
    return f"{name} = ({name} & {mask(step.shift)}) ^ {shifted}{back};"


def crc_body(crc: Crc) -> tuple[str, ...]:
    """A CRC of two or three terms over 64 bits: their remainder, moved up by the CRC's width, and the remainder of that."""
    lines = fold_lines(fold_plan(crc.width, crc.poly, 64), 64, "data")
    again = fold_plan(crc.width, crc.poly, 2 * crc.width)
    if 2 * crc.width <= 32:
        lines += [f"v <<= {crc.width}U;", *(fold_line("v", step) for step in again)]
    else:
        lines += [f"wide = (uint64_t)v << {crc.width}U;", *(fold_line("wide", step) for step in again), "v = (uint32_t)wide;"]
    return (*lines, f"return ({unsigned(crc.width)})(v ^ {number(crc.xorout, True)});")


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
