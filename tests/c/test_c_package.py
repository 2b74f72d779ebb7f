"""The C folder as a package: its files can be read by their tools for any spec, and its example programs run."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from c_harness import RUNTIME, WARNINGS
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.c.comments import without_special_characters
from codewheel.targets.c.files import generate
from working_tools import require

HOSTILE = "x */ \" ' \\ ${HOME} $(shell) #{} ; ]] %s {{ 1 }}: - @a@\n\t é ??/"

#: The output of each program for the worked examples in the manuals:
#: AM36 6.5, AMM5 6.4, ASC85 6.4, SMA21 4.1, 6.4, 6.6.2 and 7.3.3.
#: The EEPROM of an iC-MU is in appendix B of the report that its spec cites.
#: The reply to the AMM5 was printed by another T-format receiver (20 C7 D1 6A 5E: 6AD1C7h is 7,000,519).
PRINTED = {
    "am36_biss": [
        "Preset 50h: 00 00 01 86 A0\n  position: 100000\n",
        "Information per revolution 4Bh: 10 00 00\n  steps: 1048576\n",
        "Number of revolutions 4Eh: 00 00\n  revolutions: 65536\n",
        (
            "  counting_direction: 0 (0 CW, 1 CCW)\n  output_code: 1 (0 Gray, 1 Binary)\n"
            "  enable_preset: 0 (0 Enable, 1 Disable)\n"
        ),
    ],
    "am36_ssi": ["singleturn: 249109\n", f"that is {249109 / 2**19 * 360:.3f} degrees\n"],
    "amm5_biss": [
        "Preset 11h: 00 30 24 F4 00 00 00\n",
        "  position: 1000003\n",
        "Serial number 44h: 0A E8 69 EE\n  serial: 183003630\n  year: 18\n  week: 30\n  number: 3630\n",
    ],
    "amm5_rs485": [
        "singleturn: 7000519\n  report status_other_error: BUSY flag",
        "  the position is not usable\n1000 us: send 02\n1150 us: disturbed\n",
        "1300 us: send 02\n1450 us: no reply\n1600 us: send 02\nSingleturn reply\n",
        "Reset all errors\n3600 us: send BA\n3650 us: send BA\n",
        "4050 us: send BA\n6060 us: done\n",
    ],
    "amm5_ssi": ["singleturn: 6016277\n", f"that is {6016277 / 2**23 * 360:.3f} degrees\n"],
    "asc85_biss": [
        "Profile ID 42h: 28 1A\n",
        "Serial number 44h: 0A 35 2C 0E\n  serial: 171256846\n",
        "  name: AS85\n",
    ],
    "asc85_ssi": ["position: 22793493\n", f"that is {22793493 / 2**25 * 360:.3f} degrees\n"],
    "icmu_biss": [
        f"DEV_ID 78h: 4D 55 07 00 00 00\n  device_id: {0x4D5507000000}\n",
        f"MFG_ID 7Eh: 69 43\n  manufacturer_id: {0x6943}\n",
    ],
    "sma21_biss": [
        "  write 50: 00\n  write 51: 01\n  write 52: 86\n  write 53: A0\n  write 48: 02\n  wait 30000 us\n",
        "position: 123\n",
        "that is 6.150 mm\n",
    ],
    "sma21_rs485": ["position: 5517840\n", "4030 us: send DA\n4040 us: done\n"],
    **{f"{name}_biss_dma": [] for name in ("am36", "amm5", "asc85", "sma21")},
    "sma21_ssi": ["position: 1569\n", "that is 1.569 mm\n"],
}


def written(folder: Path, devices: tuple[Device, ...]) -> Path:
    for name, text in generate(Library(devices)).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder / "c"


def compile_and_run(root: Path, name: str) -> tuple[int, str]:
    """Compile an example with warnings as errors, and detect undefined behaviour. Return its exit status and output."""
    program = root / name
    command = [
        "gcc",
        "-std=c99",
        *WARNINGS,
        "-Wno-cast-qual",
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover=all",
        f"-I{root}/include",
    ]
    require(command)
    compilation = subprocess.run(
        [*command, str(root / "examples" / f"{name}.c"), "-o", str(program)], capture_output=True, text=True
    )
    assert compilation.returncode == 0, compilation.stderr[:3000]
    completed = subprocess.run([str(program)], capture_output=True, text=True, timeout=60)
    return completed.returncode, completed.stdout + completed.stderr


@pytest.fixture(scope="module")
def package(c_devices: tuple[Device, ...], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("package"), c_devices)


@pytest.mark.slow
def test_there_is_a_program_for_every_interface(package: Path) -> None:
    assert sorted(path.stem for path in (package / "examples").glob("*.c")) == sorted(PRINTED)


@pytest.mark.slow
@pytest.mark.parametrize("name", PRINTED)
def test_a_program_prints_what_the_manual_prints(name: str, package: Path) -> None:
    status, text = compile_and_run(package, name)
    assert status == 0
    for part in PRINTED[name]:
        assert part in text


@pytest.mark.slow
def test_a_program_names_a_driver_that_is_released_too_late(package: Path, tmp_path: Path) -> None:
    """The first byte of every reply is lost, because the simulated port begins to receive at the second byte."""
    shutil.copytree(package, tmp_path / "c")
    path = tmp_path / "c" / "examples" / "amm5_rs485.c"
    text = path.read_text(encoding="ascii")
    for whole, cut in (("    taken = 0U;\n", "    taken = 1U;\n"), ("(polls == 3U) ? 0U", "(polls == 3U) ? 1U")):
        assert text.count(whole) == 1
        text = text.replace(whole, cut)
    path.write_text(text, encoding="ascii")
    status, output = compile_and_run(tmp_path / "c", "amm5_rs485")
    assert status == 1
    # The third poll is the one that the simulated line loses completely.
    whys = re.findall(r"us: (first byte of the reply missing: is the driver released too late\?|no reply)", output)
    assert [why[:2] for why in whys[:4]] == ["fi", "fi", "no", "fi"]


@pytest.mark.slow
def test_a_program_looks_at_the_error_bit(package: Path) -> None:
    """Convert the position of a made-up frame of AMM5 to degrees, but not if its error bit is 0."""
    path = package / "examples" / "amm5_biss.c"
    text = path.read_text(encoding="ascii")
    assert f"that is {1821973 / 2**21 * 360:.3f} degrees" in compile_and_run(package, "amm5_biss")[1]
    (made_up,) = re.findall(r"return cw_word_of\(UINT64_C\((0x[0-9A-F]+)\),", text)
    faulty = package / "examples" / "amm5_biss_faulty.c"
    # Both bits are 0, and the 6-bit CRC matches these 39 bits.
    data = int(made_up, 16) >> 8 << 2
    faulty.write_text(text.replace(made_up, f"0x{data << 6 | crc_of(data, 39):X}"), encoding="ascii")
    try:
        status, printed = compile_and_run(package, "amm5_biss_faulty")
    finally:
        faulty.unlink()
    assert status == 0
    assert "the position is not usable" in printed
    assert "degrees" not in printed


def crc_of(data: int, bits: int) -> int:
    """Return the CRC x^6 + x + 1, sent inverted, bit by bit."""
    crc = 0
    for bit in range(bits - 1, -1, -1):
        crc ^= (data >> bit & 1) << 5
        crc = (crc << 1 ^ (0x03 if crc & 0x20 else 0)) & 0x3F
    return crc ^ 0x3F


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bits22", "words", "tv62"])
def test_programs_of_other_devices_run(name: str, every_device: Mapping[str, Device], tmp_path: Path) -> None:
    root = written(tmp_path, (every_device[name],))
    programs = [path.stem for path in (root / "examples").glob("*.c")]
    assert len(programs) == len(every_device[name].interfaces)
    for program in programs:
        assert compile_and_run(root, program)[0] == 0


def test_the_lines_fit_and_are_ascii(package: Path) -> None:
    for path in package.rglob("*"):
        if path.is_file() and path.suffix in (".c", ".txt", ".cmake", ".pc", ".yml", ".json"):
            lines = path.read_text(encoding="ascii").splitlines()
            too_long = [line for line in lines if path.suffix == ".c" and len(line) > 100 and "http" not in line]
            assert too_long == []
            assert [line for line in lines if line != line.rstrip()] == []


def poisoned(device: Device) -> Device:
    """A device whose texts are hostile."""
    maker = replace(device.manufacturer, title=HOSTILE, trademarks=(HOSTILE,))
    registers = tuple(replace(register, printed_name=HOSTILE) for register in device.registers)
    procedures = tuple(replace(procedure, title=HOSTILE) for procedure in device.procedures)
    return replace(device, title=HOSTILE, manufacturer=maker, registers=registers, procedures=procedures)


@pytest.mark.slow
@pytest.mark.parametrize("hostile", [False, True])
def test_the_manifests_are_what_their_readers_expect(
    hostile: bool, c_devices: tuple[Device, ...], tmp_path: Path
) -> None:
    devices = tuple(map(poisoned, c_devices)) if hostile else c_devices
    root = written(tmp_path, devices)
    library = json.loads((root / "library.json").read_text())
    assert (library["name"], library["version"], library["license"]) == ("lika-encoders", "0.1.0", "0BSD")
    assert library["build"] == {"includeDir": "include", "srcFilter": "-<*>"}
    assert all((root / "include" / name).is_file() for name in library["headers"])
    include = root / "include"
    assert {path.name for path in include.iterdir()} == {"codewheel", "ichaus", "lika"}
    shared = {path.name for path in (include / "codewheel").iterdir()}
    assert {path.name for path in (RUNTIME / "codewheel").iterdir()} == shared
    assert {*library["headers"]} == {path.relative_to(include).as_posix() for path in include.glob("*/*")}
    assert {f"lika/{name}.h" for name in ("amm5_biss", "amm5_ssi", "amm5_rs485", "asc85_biss")} < {*library["headers"]}
    files = [root / example["base"] / name for example in library["examples"] for name in example["files"]]
    assert all(path.is_file() for path in files)
    module = yaml.safe_load((root / "zephyr" / "module.yml").read_text())
    assert module == {"name": "lika-encoders", "build": {"cmake": "zephyr", "kconfig": "zephyr/Kconfig"}}
    assert (root / module["build"]["cmake"] / "CMakeLists.txt").is_file()
    assert (root / module["build"]["kconfig"]).is_file()
    kconfig = (root / "zephyr" / "Kconfig").read_text()
    assert re.fullmatch(r'config LIKA_ENCODERS\n\tbool "[A-Za-z0-9 .,:/+&-]+"\n\thelp\n(\t  .+\n)+', kconfig)
    assert "CONFIG_LIKA_ENCODERS" in (root / "zephyr" / "CMakeLists.txt").read_text()
    if hostile:
        assert compile_and_run(root, "amm5_biss")[0] == 0


@pytest.mark.slow
def test_several_manufacturers_share_a_package(every_device: Mapping[str, Device], tmp_path: Path) -> None:
    root = written(tmp_path, (every_device["amm5"], every_device["tv62"]))
    assert compile_and_run(root, "amm5_biss")[0] == compile_and_run(root, "tv62_ssi")[0] == 0


@pytest.mark.slow
@pytest.mark.parametrize(("main", "folder"), [((), "acme-lika"), (("lika",), "lika"), (("acme", "lika"), "acme-lika")])
def test_names_of_a_package_of_several(main: tuple[str, ...], folder: str, every_device: Mapping[str, Device]) -> None:
    """The folder has the name of the main manufacturer, or else of all. Builds find it by each manufacturer's name."""
    amm5, tv62 = every_device["amm5"], every_device["tv62"]
    lika = replace(amm5.manufacturer, main="lika" in main)
    acme = replace(tv62.manufacturer, name="acme", title="Acme", version="2.0.0", main="acme" in main)
    files = generate(Library((replace(amm5, manufacturer=lika), replace(tv62, manufacturer=acme))))
    assert json.loads(files["c/library.json"])["name"] == f"{folder}-encoders"
    names = {folder, "acme", "lika"}
    paths = set()
    for name in names:
        cmake = f"c/share/cmake/{name}-encoders/{name}-encoders-config"
        paths |= {f"c/share/pkgconfig/{name}-encoders.pc", f"{cmake}.cmake", f"{cmake}-version.cmake"}
    assert {path for path in files if path.startswith("c/share")} == paths
    assert "Description: Headers for encoders by Acme\nVersion: 2.0.0\n" in files["c/share/pkgconfig/acme-encoders.pc"]
    for name in names:
        assert f"add_library({name}::encoders ALIAS {folder}-encoders)" in files["c/CMakeLists.txt"]
    called = re.findall(r"(\w+)_selftest\(\) == 0U", files["c/CMakeLists.txt"])
    assert called == (["lika", "acme"] if folder == "lika" else ["acme", "lika"])
    assert all(f"uint32_t {name}_selftest(void);\n" in files["c/selftest/selftest.h"] for name in called)


def test_without_any_device_there_is_no_package() -> None:
    assert generate(Library(())) == {}


@pytest.mark.parametrize(
    ("text", "expected"),
    [("Lika Electronic", "Lika Electronic"), (HOSTILE, "x / HOME shell s 1 : - a e /"), ("a\nb", "a b")],
)
def test_nothing_in_a_bare_text_means_anything(text: str, expected: str) -> None:
    assert without_special_characters(text) == expected
