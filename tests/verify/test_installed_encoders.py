"""The tool as installed in a fresh environment knows every encoder, and writes only what a user selects.

Each frame is printed or logged in a public source, which the spec cites with it.
"""

from __future__ import annotations

import os
import subprocess
import venv
from collections.abc import Callable
from pathlib import Path

import pytest
from codewheel.targets import Library

ROOT = Path(__file__).resolve().parents[2]
#: Arguments of decode, and lines of its output without the spaces in them.
FRAMES = [
    # SimpleFOC, Arduino-FOC-drivers, AS5047.cpp, readCorrectedAngle: the request for ANGLECOM.
    ("AS5047P 0xFFFF --from master", ["AS5047P, SPI, from the master", "no frame error"]),
    # ams, AS5055A data sheet, Figure 20: the command that reads the angle.
    ("AS5055A 0xFFFF --from master", ["AS5055A, SPI, from the master", "no frame error"]),
    # Tasssadar, as5055_test.c, c_automatic_gain_control_register.
    ("AS5055A 0xFFF0 --from master --layout read_request", ["address 0x3ff8"]),
    # kamocat, sigrok-dumps, renishaw_biss_1MHz.sr.
    ("RESOLUTE-32 0b1011000110011101101101011111000111010011", ["2979902961 counts", "the position is usable"]),
    # The output of poll_serial.
    ("AksIM2-18M 0b000000000000001100001000111101100100001111101011", ["multiturn 0x3 3", "position 0x23d9"]),
    # The AMT22 data sheet, example of the check bits.
    ("AMT22-14 0b0110000110101011", ["position 0x21ab"]),
    # The PSoC driver of the AMT21, _check_parity.
    ("AMT212B AB 61", ["8619 counts"]),
    # MPS, AN137, Table 1.
    ("MA732 0b10001100011000100 --layout position_with_parity", ["position 0x8c62"]),
    # Captured word of an MLX90363.
    ("MLX90363EDC-ABB-000-RE 2F B1 00 00 27 00 02 E1", ["position 0x312f"]),
    # HPMicro, README of the HIPERFACE sample.
    ("SKM36 40 42 00 27 25 51 51", ["multiturn 0x272 626", "singleturn 0x551 1361"]),
    # HPMicro, README of the Tamagawa sample.
    ("TS5700N8401 1A 20 13 82 6F 17 01 00 00 C1 13", ["singleturn 0x6f8213 7307795"]),
]


def _run(*command: str | Path, cwd: Path) -> str:
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    done = subprocess.run(
        [str(word) for word in command], cwd=cwd, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode in (0, 3), done.stdout + done.stderr
    return done.stdout


def _install(folder: Path) -> None:
    """Install a copy of the tracked files into an environment, as pip install . does in a clone."""
    clone = folder / "clone"
    _run("git", "clone", "--quiet", "--shared", ROOT, clone, cwd=folder)
    venv.create(folder / "venv", with_pip=True)
    _run(folder / "venv" / "bin" / "pip", "install", "--quiet", "--disable-pip-version-check", ".", cwd=clone)


@pytest.fixture(scope="module")
def installed(made_once: Callable[[str, Callable[[Path], object]], Path]) -> Path:
    """The folder with the programs of the environment."""
    return made_once("installed", _install) / "venv" / "bin"


@pytest.mark.parametrize(("arguments", "lines"), FRAMES, ids=[arguments.split()[0] for arguments, _ in FRAMES])
def test_it_decodes_frames_of_public_sources(installed: Path, tmp_path: Path, arguments: str, lines: list[str]) -> None:
    printed = " ".join(_run(installed / "codewheel", "decode", *arguments.split(), cwd=tmp_path).split())
    for line in lines:
        assert line in printed


def test_every_command_knows_every_encoder(installed: Path, tmp_path: Path, every_encoder: Library) -> None:
    tool = installed / "codewheel"
    listed = _run(tool, "list", cwd=tmp_path)
    for device in every_encoder.devices:
        assert f"\n{device.name:<8}  " in f"\n{listed}"
    assert "AS5047P magnetic position sensor (ams)" in _run(tool, "show", "AS5047P", cwd=tmp_path)
    assert "RESOLUTE-32" in _run(tool, "master", "RESOLUTE-32", cwd=tmp_path)
    assert "--position" in _run(tool, "simulate", "--help", cwd=tmp_path)


def test_a_user_of_one_encoder_gets_nothing_of_others(installed: Path, tmp_path: Path) -> None:
    _run(installed / "codewheel", "generate", "--packaged", "AS5047P", cwd=tmp_path)
    paths = [path for path in (tmp_path / "generated").rglob("*") if path.is_file()]
    assert len(paths) > 100
    assert [path for path in paths if b"lika" in path.read_bytes().lower()] == []
    assert [path for path in paths if "lika" in path.as_posix()] == []
    place = tmp_path / "packages"
    _run(installed / "pip", "install", "--quiet", "--no-deps", "--target", place, "generated/python", cwd=tmp_path)
    assert sorted(path.name for path in place.iterdir() if path.name.endswith("_encoders")) == ["ams_encoders"]
    assert [path for path in place.rglob("*") if path.is_file() and b"lika" in path.read_bytes().lower()] == []
