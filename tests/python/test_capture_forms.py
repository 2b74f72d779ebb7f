"""Captures as oscilloscopes, Saleae's exports and NumPy write them, and lines that are exchanged."""

from __future__ import annotations

import datetime
import random
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy
import pytest
from codewheel_runtime.captures import signal_text
from codewheel_runtime.captures.capture import Captures
from codewheel_runtime.errors import InputError, UsageError
from lines import Biss, Wave, biss_word
from test_capture_files import HERTZ, LAYOUT, POSITIONS, RATE, Writer, changes, read, saleae, saleae_csv, session, wave
from test_capture_lines import SERIAL, singleturn

STAMP = datetime.datetime(2026, 11, 28, 23, 59, 59, 999_990, datetime.timezone.utc)


def stamped(path: Path, line: Wave) -> Sequence[Path]:
    """Saleae's CSV with time stamps of ISO 8601, across midnight."""
    levels = [1, 1]
    rows = ["Time [s],MA,SLO"]
    base = int(STAMP.timestamp()) * 10**9 + 999_990_000
    for at, channel, level in [(0.0, 0, 1), *changes(line)]:
        levels[channel] = level
        seconds, nanoseconds = divmod(base + round(at * 1e9), 10**9)
        text = datetime.datetime.fromtimestamp(seconds, datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%S")
        rows.append(f"{text}.{nanoseconds:09d}+00:00,{levels[0]},{levels[1]}")
    path.write_text("\n".join(rows) + "\n")
    return [path]


def voltages(path: Path, line: Wave, head: str = "x-axis,1,2\nsecond,Volt,Volt\n") -> Sequence[Path]:
    """An oscilloscope: 3.3 V with noise of 0.2 V, and edges that take two samples."""
    source = random.Random(1)
    volts = numpy.array(line.samples(RATE)) * 3.3
    volts[1:] = (volts[1:] + volts[:-1]) / 2
    rows = [
        f"{row / HERTZ - 1e-6:.10e},{clock + source.uniform(-0.2, 0.2):.4f},{data + source.uniform(-0.2, 0.2):.4f}\n"
        for row, (clock, data) in enumerate(volts.tolist())
    ]
    path.write_text(head + "".join(rows))
    return [path]


def one_header(path: Path, line: Wave) -> Sequence[Path]:
    return voltages(path, line, "Time (s),CH1,CH2\n")


def quoted(path: Path, line: Wave) -> Sequence[Path]:
    """Edges with their times, and all cells in quotes, as spreadsheets can write them."""
    (csv_path,) = saleae_csv(path, line)
    rows = csv_path.read_text().splitlines()
    path.write_text("".join(",".join(f'"{cell.strip()}"' for cell in row.split(",")) + "\n" for row in rows))
    return [path]


def with_decimal_commas(path: Path, line: Wave) -> Sequence[Path]:
    """An oscilloscope with German settings: semicolons, decimal commas, milliseconds, and an empty line after units."""
    (csv_path,) = voltages(path, line, "")
    rows = [row.split(",") for row in csv_path.read_text().splitlines()]
    texts = [";".join((f"{float(time) * 1e3:.8f}", *volts)).replace(".", ",") for time, *volts in rows]
    path.write_text("\n".join(["Zeit;Kanal A;Kanal B", "(ms);(V);(V)", "", *texts]) + "\n")
    return [path]


def edges_with_decimal_commas(path: Path, line: Wave) -> Sequence[Path]:
    (csv_path,) = saleae_csv(path, line)
    path.write_text(csv_path.read_text().replace(",", ";").replace(".", ","))
    return [path]


def tektronix(path: Path, line: Wave) -> Sequence[Path]:
    """Settings in front of the names of the columns, and times in seconds without their unit."""
    settings = "Model,MSO24\nFirmware Version,1.2\nSample Interval,1e-08\n\n"
    return voltages(path, line, settings + "TIME,CH1,CH2\n")


def rigol(path: Path, line: Wave) -> Sequence[Path]:
    """Numbers of samples, and their distance in the header."""
    (csv_path,) = voltages(path, line, "")
    rows = [row.split(",")[1:] for row in csv_path.read_text().splitlines()]
    head = f"X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,0.0,{1 / HERTZ:.9e}\n"
    path.write_text(head + "".join(f"{number},{clock},{data},,\n" for number, (clock, data) in enumerate(rows)))
    return [path]


def channels_with_times(path: Path, line: Wave) -> Sequence[Path]:
    samples = numpy.array(line.samples(RATE), numpy.uint8)
    times = numpy.arange(len(samples)) / HERTZ
    numpy.savez(path.with_suffix(".npz"), time=times, MA=samples[:, 0], SLO=samples[:, 1])
    return [path.with_suffix(".npz")]


def voltages_of_numpy(path: Path, line: Wave) -> Sequence[Path]:
    volts = numpy.array(line.samples(RATE)) * 3.3 + numpy.random.default_rng(1).uniform(-0.2, 0.2, (1, 2))
    numpy.savez(path.with_suffix(".npz"), MA=volts[:, 0], SLO=volts[:, 1], fs=HERTZ)
    return [path.with_suffix(".npz")]


def numbered(path: Path, line: Wave) -> Sequence[Path]:
    path.write_text("Sample,MA,SLO\n" + "".join(f"{row},{c},{d}\n" for row, (c, d) in enumerate(line.samples(RATE))))
    return [path]


def numbered_without_names(path: Path, line: Wave) -> Sequence[Path]:
    path.write_text("".join(f"{row},{clock},{data}\n" for row, (clock, data) in enumerate(line.samples(RATE))))
    return [path]


def channels(path: Path, line: Wave) -> Sequence[Path]:
    samples = numpy.array(line.samples(RATE), numpy.uint8)
    numpy.savez_compressed(path.with_suffix(".npz"), SLO=samples[:, 1], MA=samples[:, 0], samplerate=HERTZ)
    return [path.with_suffix(".npz")]


def one_array(path: Path, line: Wave) -> Sequence[Path]:
    numpy.savez(path.with_suffix(".npz"), numpy.array(line.samples(RATE), numpy.uint8))
    return [path.with_suffix(".npz")]


FORMS: dict[str, tuple[Writer, dict[str, Any]]] = {
    "time stamps": (stamped, {}),
    "voltages": (voltages, {"clock": 1, "data": 2}),
    "voltages with a threshold": (voltages, {"clock": 1, "data": 2, "threshold": 1.2}),
    "voltages with one header": (one_header, {"clock": "CH1", "data": "CH2"}),
    "quoted cells": (quoted, {}),
    "voltages with decimal commas": (with_decimal_commas, {"clock": "Kanal A", "data": "Kanal B"}),
    "edges with decimal commas": (edges_with_decimal_commas, {}),
    "voltages after settings": (tektronix, {"clock": "CH1", "data": "CH2"}),
    "sample numbers with an increment": (rigol, {"clock": "CH1", "data": "CH2"}),
    "channels of NumPy with times": (channels_with_times, {}),
    "NumPy's voltages": (voltages_of_numpy, {}),
    "sample numbers": (numbered, {"rate": HERTZ}),
    "sample numbers without names": (numbered_without_names, {"rate": HERTZ, "clock": 1, "data": 2}),
    "channels of NumPy": (channels, {}),
    "one array of NumPy": (one_array, {"rate": HERTZ, "clock": 1, "data": 2}),
}


@pytest.mark.parametrize("block", [1 << 20, 4096])
@pytest.mark.parametrize("form", FORMS)
def test_every_form(form: str, block: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(signal_text, "_BLOCK", block)
    write, options = FORMS[form]
    line = wave()
    capture = read(write(tmp_path / "line.csv", line), **options)
    assert capture.table["position"].tolist() == POSITIONS
    assert capture.table.ok.all()
    assert capture.lost == ()
    starts = [at for before, at in zip([-40.0, *line.clock], line.clock, strict=False) if at - before > 20]
    offset = 1e-6 if form.startswith("voltages") else 0.0
    times = [at * RATE / HERTZ - offset for at in starts]
    assert capture.table["time"] == pytest.approx(times, abs=2.01 / HERTZ)


@pytest.mark.parametrize("head", ["Time (S)", "TIME [\N{GREEK SMALL LETTER MU}s]", "Time (Seconds)"])
def test_units_of_times_have_any_case(head: str, tmp_path: Path) -> None:
    unit = 1e6 if "\N{GREEK SMALL LETTER MU}" in head else 1.0
    rows = "".join(f"{row / HERTZ * unit:.9f},{ma},{slo}\n" for row, (ma, slo) in enumerate(wave().samples(RATE)))
    (tmp_path / "line.csv").write_text(f"{head},MA,SLO\n{rows}", encoding="utf-8")
    capture = read([tmp_path / "line.csv"])
    assert capture.table["position"].tolist() == POSITIONS
    usual = read(saleae_csv(tmp_path / "usual.csv", wave()))
    assert capture.table["time"] == pytest.approx(usual.table["time"], abs=2.01 / HERTZ)


def test_of_two_channels_the_other_one_is_the_remaining_line(tmp_path: Path) -> None:
    """The clock is chosen by its number, and the channels have no usual names."""
    path = tmp_path / "line.csv"
    rows = "".join(f"{row / HERTZ:.9f},{data},{clock}\n" for row, (clock, data) in enumerate(wave().samples(RATE)))
    path.write_text("time,x,y\n" + rows)
    assert read([path], clock=2).table["position"].tolist() == POSITIONS
    assert read([path], data="x").table["position"].tolist() == POSITIONS
    with pytest.raises(InputError, match=r"no channel 'z'; the channels are 'x', 'y'"):
        read([path], clock=2, data="z")


@pytest.mark.parametrize("write", [saleae_csv, saleae, session])
def test_exchanged_lines_are_named_once(write: Writer, tmp_path: Path) -> None:
    """MA on the data line and SLO on the clock."""
    paths = write(tmp_path / "line.capture", wave())
    options = {"clock": "SLO", "data": "MA"} if write is not saleae else {}
    message = "the clock and the data line are exchanged: no frame is valid, but 4 are if you exchange the two channels"
    with pytest.raises(InputError) as caught:
        read(paths[::-1], **options)
    assert str(caught.value).endswith(message)


def test_exchanged_lines_with_a_clock_that_never_pauses(tmp_path: Path) -> None:
    """Positions whose bits never rest."""
    line = Biss()
    for _ in range(3):
        line.cycle(biss_word(0x55555555), 40)
    with pytest.raises(InputError, match=r"the clock and the data line are exchanged"):
        read(saleae_csv(tmp_path / "line.csv", line.finish()), clock="SLO", data="MA")


def test_decode_capture_names_exchanged_lines(tmp_path: Path) -> None:
    (path,) = saleae_csv(tmp_path / "line.csv", wave())
    with pytest.raises(InputError, match=r"the clock and the data line are exchanged"):
        Captures("none").decode_capture(LAYOUT, path, tmp_path / "out.csv", clock="SLO", data="MA")
    assert not (tmp_path / "out.csv").exists()


def test_lines_without_a_valid_frame_are_not_called_exchanged(tmp_path: Path) -> None:
    line = Biss()
    for position in POSITIONS:
        line.cycle(biss_word(position) ^ 1, 40)
    capture = read(saleae_csv(tmp_path / "line.csv", line.finish()))
    assert len(capture.table) == len(POSITIONS)
    assert not capture.table.ok.any()


@pytest.mark.parametrize("channel", [True, 1.0, None])
def test_a_channel_is_a_name_or_a_number(tmp_path: Path, channel: Any) -> None:
    with pytest.raises(UsageError, match=r"^a channel is a name or a number from 1, got "):
        read(saleae_csv(tmp_path / "line.csv", wave()), clock=channel)


def test_one_channel_is_too_few(tmp_path: Path) -> None:
    (tmp_path / "line.csv").write_text("Time [s],MA\n0.0,1\n0.1,0\n")
    with pytest.raises(InputError, match=r"expected channels of a clock and a data line, got 'MA'$"):
        read([tmp_path / "line.csv"])


@pytest.mark.parametrize("shape", [(5, 2, 2), (5, 0)])
def test_an_array_of_numpy_without_rows_of_channels(tmp_path: Path, shape: tuple[int, ...]) -> None:
    numpy.savez(tmp_path / "line.npz", numpy.zeros(shape, numpy.uint8))
    with pytest.raises(InputError, match=r"line\.npz: expected whole numbers in one or two dimensions, got uint8"):
        read([tmp_path / "line.npz"])


def test_a_time_stamp_in_a_13th_month(tmp_path: Path) -> None:
    (tmp_path / "line.csv").write_text("Time,MA,SLO\n2024-13-01T00:00:00.1,1,1\n2024-13-01T00:00:00.2,0,1\n")
    with pytest.raises(InputError, match=r"line\.csv, from line 2: .*2024-13-01"):
        read([tmp_path / "line.csv"])


@pytest.mark.parametrize("name", ["rate", "rest", "baud", "threshold"])
def test_numbers_that_are_none(tmp_path: Path, name: str) -> None:
    paths = saleae_csv(tmp_path / "line.csv", wave())
    for wrong in ("10MHz", True, float("nan"), *([] if name == "threshold" else [0, -1.0])):
        with pytest.raises(UsageError, match=f"^{name} must be a number"):
            read(paths, **{name: wrong})


# Bytes of a serial line


def exports(positions: Sequence[int]) -> dict[str, str]:
    """Return the exports of Saleae's two programs: one byte a row, 40 microseconds apart."""
    new, old = "name,type,start_time,duration,data\n", "Time [s],Value,Parity Error,Framing Error\n"
    at = 0.0
    for position in positions:
        for byte in singleturn(position):
            new += f'"Async Serial","data",{at:.9f},0.000004,0x{byte:02X}\n'
            old += f"{at:.15f},0x{byte:02X},,\n"
            at += 4e-6
        at += 1e-3
    return {"new": new, "old": old}


@pytest.mark.parametrize("program", ["new", "old"])
def test_the_serial_export_of_saleae(generated_python: tuple[Path, ModuleType], tmp_path: Path, program: str) -> None:
    positions = [7000519, 1, 0x7FFFFF, 0x2AAAAA]
    (tmp_path / "bytes.csv").write_text(exports(positions)[program])
    lika: Any = generated_python[1]
    capture = lika.read_capture(SERIAL, tmp_path / "bytes.csv")
    assert capture.table["singleturn"].tolist() == positions
    assert capture.lost == ()
    # The reply begins one byte after the request.
    assert capture.table["time"][:2] == pytest.approx([4e-6, 1e-3 + 7 * 4e-6 + 4e-6], abs=1e-9)


@pytest.mark.parametrize("cell", ["A", "'4'", "0x100", "256", ""])
def test_a_cell_that_is_no_byte(generated_python: tuple[Path, ModuleType], tmp_path: Path, cell: str) -> None:
    (tmp_path / "bytes.csv").write_text(f"Time [s],Value,Parity Error,Framing Error\n0.0,{cell},,\n")
    lika: Any = generated_python[1]
    with pytest.raises(InputError, match=r"line 2: .* is not a byte: export with hexadecimal numbers"):
        lika.read_capture(SERIAL, tmp_path / "bytes.csv")
