"""Frames and registers for the script of the page, with the results of the reference codec, and programs to run it."""

from __future__ import annotations

import html
import io
import json
import random
import re
import subprocess
import warnings
import zlib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.decode.decoding import NO_FRAME, DecodeRequest, Decoding
from codewheel.commands.decode.frames import FrameLine
from codewheel.loading.library import load_library
from codewheel.model import Device, Layout, PlacedLayout, Register, Variant, number_to_bytes
from codewheel.order_codes.labels import LabelMatch
from codewheel.reference import codec
from codewheel.reference.findings import findings
from codewheel.reference.registers import values_of_older_edition
from codewheel.say import quantity_text
from codewheel.targets import Library
from rust_frames import numbers
from test_c_codec import run_time_variants
from working_tools import require

HERE = Path(__file__).resolve().parent
#: Minimum number of frames of a layout for one order code.
_LEAST = 20
_BROWSER = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--allow-file-access-from-files")


def library_of(name: str) -> Library:
    """Return the family in a spec, given as its path from ``tests`` without the ending: ``../specs/ams/as5048a``."""
    path = HERE.parent / f"{name}.yaml"
    return Library(load_library([path, path.parent / "manufacturer.yaml"])[0])


@dataclass(frozen=True)
class Case:
    """A frame or register for one order code, with the present values of its registers."""

    device: Device
    variant: Variant
    placed: PlacedLayout
    register: Register | None = None

    @property
    def layout(self) -> Layout:
        return self.placed.layout

    @property
    def data(self) -> dict[str, Any]:
        names = [parameter.name for parameter in self.device.parameters if parameter.equals is None]
        return {
            "name": f"{self.device.name} {self.variant.code} {self.placed.name}",
            "family": self.device.name,
            "code": self.variant.code,
            "interface": self.variant.interface,
            "given": {name: str(self.variant.parameters[name]) for name in names},
            "sender": self.layout.sender,
            # Frames of bytes identify their layout themselves.
            "layout": "" if self.layout.in_bytes else self.layout.name,
            "register": self.register.name if self.register is not None else "",
        }

    def text(self, number: int, other_bits: int = 0) -> str:
        """Return a frame as people type it, with bits added or removed. A word may lack its leading zeros."""
        bits = self.placed.bits + other_bits
        if not self.layout.in_bytes and self._is_too_high(number, other_bits):
            return f"0x{number | 1 << bits - 1:X}"
        if not self.layout.in_bytes:
            return f"0b{number % (1 << bits):0{bits}b}" if number % 3 or other_bits else f"0x{number:X}"
        data = number_to_bytes(self.layout, number, self.placed.bits)
        data = (data + bytes(8))[: bits // 8]
        return data.hex(" ") if number % 2 else data.hex().upper()

    def decoded(self, number: int, other_bits: int = 0) -> codec.DecodedFrame:
        """Return the result of the reference for that text."""
        if not self.layout.in_bytes:
            bits = self.placed.bits + other_bits
            if self._is_too_high(number, other_bits):
                return codec.decode(self.device, self.placed, number | 1 << bits - 1)
            if number % 3 or other_bits:
                return codec.decode_bits(self.device, self.placed, number % (1 << bits), bits)
            return codec.decode(self.device, self.placed, number)
        data = number_to_bytes(self.layout, number, self.placed.bits) + bytes(8)
        data = data[: (self.placed.bits + other_bits) // 8]
        if self.register is not None:
            return codec.decode_placed(self.device, self.placed, data)
        return codec.decode_bytes(self.device, self.variant, self.layout.sender, data)

    @staticmethod
    def _is_too_high(number: int, other_bits: int) -> bool:
        """Return True if a word that is too long is written without its leading zeros."""
        return other_bits > 0 and number % 3 == 0

    def result_text(self, decoded: codec.DecodedFrame) -> str:
        """Return the whole result as one text."""
        report = findings(self.device, self.variant, decoded)
        strange = values_of_older_edition(self.device, decoded) if not decoded.problems else ()
        rows: list[Sequence[object]] = [(decoded.layout.name if decoded.layout is not None else "",)]
        rows += [("problem", problem.fault.value, problem.field, problem.message) for problem in decoded.problems]
        rows += [_field_row(field) for field in decoded.fields if field.name != codec.UNUSED or field.high >= 0]
        rows.append(("crc", decoded.crc.received, decoded.crc.computed) if decoded.crc is not None else ("no crc",))
        rows += [("report", report.field, report.meaning, report.remedy, report.source) for report in report.reports]
        rows.append(("verdict", report.verdict.value if report.verdict is not None else ""))
        rows += [("difference", difference.message) for difference in (*report.differences, *strange)]
        return "\n".join("\t".join(map(str, row)) for row in rows)


def _field_row(field: codec.DecodedField) -> Sequence[object]:
    amount = quantity_text(field.scale, int(field.value)) if field.scale is not None else ""
    return (field.name, field.raw, _value_text(field.value), field.unit, amount, field.meaning, field.high, field.low)


def _value_text(value: int | str | bool) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def cases(device: Device) -> Iterator[list[Case]]:
    """Return each frame and register, for all order codes that differ, and for some states of the registers."""
    layouts = [(interface.name, layout, None) for interface, layout in device.layouts()]
    layouts += [(register.interface, register.layout, register) for register in device.registers]
    for interface, layout, register in layouts:
        variants_and_states = (*device.variants, *run_time_variants(device))
        of_interface = [variant for variant in variants_and_states if variant.interface == interface]
        variants = {tuple(sorted(variant.parameters.items())): variant for variant in of_interface}
        yield [Case(device, variant, layout.place(variant.parameters), register) for variant in variants.values()]


def judged_by_command(case: Case, texts: Sequence[str], *, any_layout: bool = False) -> list[Any] | None:
    """Return the judgement of ``decode`` on several frames, or None if the page lacks a part of it.

    It has the common mistakes, the number of frames that fail, and whether all frames have the mistakes. With
    ``any_layout``, the user does not name the layout. The page does not know mistakes that name options of the command.
    """
    is_named = not any_layout and not case.layout.in_bytes
    request = DecodeRequest(
        device=case.device,
        match=LabelMatch(case.variant, unlisted=(), tail="", special=False),
        sender=case.layout.sender,
        layout=case.layout.name if is_named else None,
        register=None,
        as_json=False,
        register_differences=(),
        answers={},
    )
    decoding = Decoding(request)
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        decoding.run(FrameLine(number, "", text) for number, text in enumerate(texts, 1))
        mistakes, failed_count, are_in_all_frames = decoding.judge_frames()
    names_options = any("--choose" in mistake.text for mistake in mistakes)
    if decoding.code == NO_FRAME or names_options:
        return None
    rows = [[mistake.text, mistake.frames, str(mistake.one_in)] for mistake in mistakes]
    return [rows, failed_count, are_in_all_frames]


def disturbed_numbers(case: Case, count: int, random_: random.Random) -> Iterator[tuple[int, int]]:
    """Return this many numbers, valid and disturbed. Some of the frames get more or fewer bits."""
    size = 8 if case.layout.in_bytes else 1
    length_changes = [0] * 8 + ([-size, size] if case.placed.bits > size else [size])
    for number in numbers(case, max(count, _LEAST), random_):
        yield number, random_.choice(length_changes) if case.register is None else 0


def frames_with_checksums(case: Case, count: int, random_: random.Random) -> dict[str, Any]:
    """Return this many frames, each with a CRC-32 of the reference's result."""
    frames = [*disturbed_numbers(case, count, random_)]
    results = (case.result_text(case.decoded(*frame)) for frame in frames)
    expected = [f"{zlib.crc32(text.encode()):08x}" for text in results]
    return {**case.data, "frames": [case.text(*frame) for frame in frames], "expected": expected}


def program(name: str) -> str:
    """Return the path of a program that works. Otherwise, skip the test. The end of the run reports this."""
    try:
        return require([name])
    except pytest.skip.Exception as missing:
        warnings.warn(str(missing), stacklevel=2)
        raise


class Asker:
    """Run the script in Node or in a browser that is started once."""

    def __init__(self, folder: Path, script: str, program: str) -> None:
        self._folder, self._program = folder, program
        self._in_node = Path(program).name.startswith("node")
        (folder / "decode.js").write_text(script, encoding="utf-8")
        (folder / "harness.js").write_text((HERE / "harness.js").read_text(encoding="utf-8"), encoding="utf-8")

    def __call__(self, function: str, items: Iterable[dict[str, Any]], timeout: int = 580) -> list[Any]:
        """Return the results of a function of the harness for these items."""
        names = ["decode.js", "harness.js"]
        items = list(items)
        for place, argument in enumerate(items):
            call = f"(globalThis.answers ??= []).push(codewheelTests.{function}({json.dumps(argument)}));\n"
            (self._folder / f"case-{place}.js").write_text(call, encoding="utf-8")
            names.append(f"case-{place}.js")
        answers: list[Any] = json.loads(self._node(names, timeout) if self._in_node else self._page(names, timeout))
        assert len(answers) == len(items)
        return answers

    def _node(self, names: Sequence[str], timeout: int) -> str:
        run = "for (const name of NAMES) require('vm').runInThisContext(require('fs').readFileSync(name, 'utf8'));"
        code = f"{run.replace('NAMES', json.dumps(names))} console.log(JSON.stringify(answers));"
        return self._output([self._program, "-e", code], timeout)

    def _page(self, names: Sequence[str], timeout: int) -> str:
        scripts = "".join(f'<script src="{name}"></script>' for name in names)
        last = (
            "document.body.append(Object.assign(document.createElement('pre'), {textContent: JSON.stringify(answers)}))"
        )
        page = f'<!DOCTYPE html><meta charset="utf-8"><body>{scripts}<script>{last}</script>'
        (self._folder / "run.html").write_text(page, encoding="utf-8")
        out = self._output(
            [*browser(self._program, self._folder), "--dump-dom", (self._folder / "run.html").as_uri()], timeout
        )
        answer_element = re.search(r"<pre>(.*)</pre>", out, re.DOTALL)
        assert answer_element is not None, out[-2000:]
        return html.unescape(answer_element[1])

    def _output(self, command: list[str], timeout: int) -> str:
        completed = subprocess.run(
            command, cwd=self._folder, capture_output=True, text=True, timeout=timeout, check=False
        )
        assert completed.returncode == 0, completed.stderr[-2000:]
        return completed.stdout


def browser(program: str, folder: Path) -> list[str]:
    """Return the command that starts a browser with its own profile."""
    return [program, *_BROWSER, f"--user-data-dir={folder / 'profile'}"]
