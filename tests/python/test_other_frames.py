"""The command of a package names the other frames that a frame can be, and decodes long frames."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from codewheel.loading.library import load_library
from codewheel.targets import Library
from codewheel_runtime.commands.main import main

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
ENCODERS = ROOT / "specs"
TURNS = "another frame: TurnsReply (decode it with the class in cui_encoders.amt21)"


def package_of(folder: Path, import_generated: Callable[..., Any], name: str) -> str:
    devices, report = load_library([folder])
    assert not report
    import_generated(Library(devices), f"{name}_encoders")
    return f"{name}_encoders"


@pytest.mark.parametrize(
    ("maker", "arguments", "code", "ending"),
    [
        ("cui", "AMT212B AB61", 0, f"\n\nThis can also be {TURNS}\n"),
        ("cui", "AMT212B AB62", 1, "k0 must be 0x0, got 0x1\n"),
        ("sick", "SKM36 40 42 00 27 25 51 51", 0, "reports          none\n"),
        (
            "sick",
            "SKM36 40 52 00 00 00 00 12",
            1,
            "got 0x52. This can be another frame: TypeLabelReply (decode it with the class in sick_encoders.skm36)\n",
        ),
        ("ams", "AS5047P 0x0123", 0, "RegisterReply (decode it with the class in ams_encoders.as5047p)\n"),
    ],
)
def test_other_frames_that_it_can_be(
    maker: str,
    arguments: str,
    code: int,
    ending: str,
    import_generated: Callable[..., Any],
    capsys: pytest.CaptureFixture[str],
) -> None:
    package = package_of(ENCODERS / maker, import_generated, maker)
    assert main(package, ["decode", *arguments.split()]) == code
    captured = capsys.readouterr()
    assert (captured.out + captured.err).endswith(ending)


def test_hex_bytes_of_a_long_frame(
    tmp_path: Path, import_generated: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("long.yaml", "manufacturer.yaml"):
        (tmp_path / name).write_bytes((ROOT / "tests" / "specs" / name).read_bytes())
    package = package_of(tmp_path, import_generated, "test")
    number = 5 << 38 | 1000 << 6 | 3
    assert main(package, ["decode", "LS", *number.to_bytes(9, "big").hex(" ").split()]) == 0
    values = dict(line.split() for line in capsys.readouterr().out.splitlines())
    assert (values["multiturn"], values["singleturn"], values["status"]) == ("5", "1000", "3")
