"""Value change dumps: the edges of their signals, and times that are not numbers or go back."""

from __future__ import annotations

import io

import pytest
from codewheel_runtime.captures.signal_text import read_vcd_signals
from codewheel_runtime.captures.signals import Edges, SignalNames
from codewheel_runtime.errors import InputError

HEADER = '$timescale 1 ns $end\n$var wire 1 ! MA $end\n$var wire 1 " SLO $end\n$enddefinitions $end\n'


def edges(changes: str) -> list[Edges]:
    file = io.BytesIO((HEADER + changes).encode())
    return list(read_vcd_signals(file, "line.vcd", SignalNames("MA", "SLO")).edges)


def test_edges_of_each_signal() -> None:
    # MA is 1 and SLO is 0 at 10 ns. MA falls at 20 ns and rises at 40 ns, SLO rises at 30 ns. The bus is left out.
    (part,) = edges('#10\n1!\n0"\nb1 1!\n#20\n0!\n#30\n1"\n1"\n#40\n1!\n#50\n')
    assert part.levels == (1, 0)
    assert [times.tolist() for times in part.times] == [[20.0, 40.0], [30.0]]
    assert (part.begin, part.end) == (10.0, 50.0)


@pytest.mark.parametrize("time", ["#abc", "#", "#-5", "#1.5", "#" + "9" * 19])
@pytest.mark.parametrize("before", ["", "#0\n1!\n"], ids=["first", "later"])
def test_times_that_are_no_numbers(before: str, time: str) -> None:
    with pytest.raises(InputError, match=f"the time '{time}' is not a number of at most 18 digits"):
        edges(f"{before}{time}\n0!\n#9\n1!\n")


def test_times_that_go_back() -> None:
    with pytest.raises(InputError, match="the time '#19' is out of order"):
        edges("#20\n1!\n#19\n0!\n")
