"""Captures of BiSS frames with two data channels, of a made-up encoder with the words of BiSS Safety."""

from __future__ import annotations

import random
from typing import Any

import pytest
from codewheel.targets import Library
from five_engines import Import, load_made
from lines import Biss
from test_channels import CONFIGURATIONS, VERDICTS, Case, random_case

numpy: Any = pytest.importorskip("numpy")
pytestmark = pytest.mark.slow


@pytest.mark.parametrize("code", CONFIGURATIONS)
@pytest.mark.parametrize("rate", [2.4, 8])
def test_each_frame_has_all_channels(code: str, rate: float, import_generated: Import) -> None:
    random_ = random.Random(code)
    cases = [random_case(code, random_) for _ in range(60)]
    layout = _layout(code, import_generated)
    capture = layout.read_capture(_samples(cases, rate), clock=1, data=2, rate=rate)
    assert (capture.lost, len(capture.times)) == ((), len(cases))
    table = capture.table
    for index, case in enumerate(cases):
        assert bool(table.fault[index]) == bool(case.fault)
        if not case.fault:
            assert (VERDICTS[table.verdict[index]], int(table.position[index])) == (case.verdict, case.position)
            assert int(table.channels[1]["life"][index]) == case.life
    assert (numpy.diff(capture.times) > CONFIGURATIONS[code].bits).all()


def test_a_frame_without_its_second_channel_is_lost(import_generated: Import) -> None:
    case = random_case("RSH", random.Random(1))
    bits = CONFIGURATIONS["RSH"].bits
    line = Biss()
    line.cycle(case.number, bits)
    line.cycle(case.number, bits, clocks=50)
    samples = numpy.array(line.finish().samples(8), numpy.uint8)
    capture = _layout("RSH", import_generated).read_capture(samples, clock=1, data=2, rate=8)
    assert len(capture.table) == 1
    assert [lost.reason for lost in capture.lost] == [f"the clock stops after 44 of {bits} bits"]


def test_a_capture_of_an_idle_line_has_no_frames(import_generated: Import) -> None:
    line = Biss()
    line.cycle(0, 3, clocks=3)
    samples = numpy.array(line.finish().samples(8), numpy.uint8)
    capture = _layout("RSH", import_generated).read_capture(samples, clock=1, data=2, rate=8)
    assert (len(capture.table), len(capture.times), len(capture.lost)) == (0, 0, 1)


def _layout(code: str, import_generated: Import) -> Any:
    package: Any = import_generated(Library((load_made("channels"),)), "test_encoders")[1]
    return package.lookup(code).channels()


def _samples(cases: list[Case], rate: float) -> Any:
    line = Biss()
    for case in cases:
        line.cycle(case.number, CONFIGURATIONS[case.code].bits)
    return numpy.array(line.finish().samples(rate), numpy.uint8)
