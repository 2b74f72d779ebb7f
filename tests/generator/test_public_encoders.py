"""The encoders from public files: their frames from real hardware, through the generated C and the generated Python."""

from __future__ import annotations

import ctypes
import subprocess
import sys
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import FrameExample
from codewheel.order_codes.parameters import RegisterError, with_registers

pytestmark = pytest.mark.slow

ENCODERS = Path(__file__).parents[2] / "specs"
#: Encoders with examples, each with its self-test in C.
TESTED = {
    "amt21": "cui_amt21_rs485",
    "aksim2": "rls_aksim2_spi",
    "amt22": "cui_amt22_spi",
    "ma732": "mps_ma732_spi",
    "mlx90363": "melexis_mlx90363_spi",
    "mt6835": "magntek_mt6835_spi",
    "orbis_serial": "rls_orbis_serial_rs485",
    "resolute": "renishaw_resolute_biss",
    "resolute_linear": "renishaw_resolute_linear_biss",
    "skm36": "sick_skm36_rs485",
    "tle5012b": "infineon_tle5012b_spi",
    "ts5700": "tamagawa_ts5700_rs485",
}
#: Classes of frames that ``decode`` of an encoder does not return, with their family.
OTHER = {
    ("ma732", "position_with_parity"): "ma732.PositionWithParity",
    ("mlx90363", "challenge_echo"): "mlx90363.ChallengeEcho",
    ("mlx90363", "get1_alpha"): "mlx90363.Get1Alpha",
    ("mlx90363", "nop"): "mlx90363.Nop",
}
#: Decodes a frame with a generated package. Arguments: package, order code, the class of the frame or nothing, frame,
#: and the expected values.
DECODE = """
import importlib, sys
package, code, kind, frame, *expected = sys.argv[1:]
decode = importlib.import_module(package).lookup(code).decode
if kind:
    family, name = kind.split(".")
    decode = getattr(importlib.import_module(f"{package}.{family}"), name).decode
found = decode(frame.removeprefix("0b") if frame.startswith("0b") else bytes.fromhex(frame))
values = dict(item.split("=") for item in expected)
assert {name: str(int(getattr(found, name))) for name in values} == values, found
"""


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("encoders")
    assert main(["generate", str(ENCODERS), "-o", str(out), "--target", "c", "--target", "python"]) == 0
    return out


@pytest.mark.exhaustive
def test_their_self_tests_in_c_pass(generated: Path, tmp_path: Path) -> None:
    sources = sorted(map(str, (generated / "c" / "selftest").glob("*.c")))
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1", "-shared", "-fPIC"]
    library = tmp_path / "selftest.so"
    subprocess.run(["gcc", *flags, f"-I{generated / 'c' / 'include'}", *sources, "-o", str(library)], check=True)
    tests = ctypes.CDLL(str(library))
    assert {name: getattr(tests, f"{prefix}_selftest")() for name, prefix in TESTED.items()} == dict.fromkeys(TESTED, 0)
    makers = [path.parent.name for path in ENCODERS.glob("*/manufacturer.yaml")]
    assert {name: getattr(tests, f"{name}_selftest")() for name in makers} == dict.fromkeys(makers, 0)


def test_python_decodes_their_frames(generated: Path) -> None:
    devices, report = load_library([ENCODERS])
    assert not report
    path = [
        str(generated / "python"),
        *map(str, (generated / "python").glob("*")),
        str(ENCODERS.parent / "runtime" / "python"),
    ]
    frames = 0
    for device in devices:
        vectors = [example for example in device.examples if example.name in device.evidence.vectors]
        for example in vectors[:: max(1, len(vectors) // 3)]:
            if isinstance(example, FrameExample):
                code = example.order_code or device.variants[0].code
                frame = f"0b{example.bits}" if example.bits else example.bytes.hex()
                expected = [f"{name}={int(value)}" for name, value in example.values.items()]
                kind = OTHER.get((device.name, example.layout), "")
                arguments = [f"{device.manufacturer.name}_encoders", code, kind, frame, *expected]
                subprocess.run(
                    [sys.executable, "-c", DECODE, *arguments], env={"PYTHONPATH": ":".join(path)}, check=True
                )
                frames += 1
    assert frames >= 9


def test_the_registers_of_an_ic_mhm_select_its_frame() -> None:
    """The example of iC-Haus for its library reads 12 + 1 + 1 + 6 bits. The data sheet has 20 bits in a field of 24."""
    devices, _ = load_library([ENCODERS])
    device = next(device for device in devices if device.name == "icmhm")
    (variant,) = device.variants
    (layout,) = device.interface("biss").layouts

    def widths(register_values: dict[int, int]) -> dict[str, int]:
        placed = layout.place(with_registers(device, variant, register_values).parameters)
        return {field.name: field.width for field in placed.fields}

    assert sum(widths({0x01: 0x40}).values()) == 20
    code_6 = {"singleturn": 10, "zeros_below": 2, "error": 1, "warning": 1, "crc": 6}
    assert widths({0x01: 0x60}) == code_6
    assert widths({0x01: 0x65, 0x0A: 0x40}) == {"zeros_above": 4, "multiturn": 20, **code_6, "life_counter": 6}
    with pytest.raises(RegisterError, match="does not hold a code of multiturn_bits; the codes are 0, 2, 4, 5, 6, 7"):
        widths({0x01: 0x01})


def test_each_grade_names_vectors_that_exist() -> None:
    """All published vectors are found: of replies, frames, an EEPROM, a table, check bits, and a capture."""
    devices, _ = load_library([ENCODERS])
    counts = {device.name: len(device.evidence.vectors) for device in devices}
    assert counts == {
        "acuro": 0, "aksim2": 1, "am36": 0, "amm5": 0, "amt21": 0, "amt22": 1, "as38": 0, "as5047p": 0, "as5048a": 0,
        "as5055a": 0, "as5145": 0, "as5147": 0, "asc85": 0, "bml_s1g": 0, "c58": 0, "dl100": 0, "dl1000": 0, "icmhm": 0,
        "icmn": 0, "icmr": 0, "icmu": 3, "icpvl": 0, "kcd": 0, "la11": 0, "ma600": 0, "ma730": 0, "ma732": 3,
        "mlx90363": 4, "msa213c": 0, "mt6701": 0, "mt6835": 0, "ocd": 0, "orbis": 0, "orbis_serial": 0, "resolute": 11,
        "resolute_linear": 11, "skm36": 9, "sma21": 0, "tle5012b": 0, "ts5700": 12, "wdga": 0,
    }  # fmt: skip
