"""The target for Zephyr: its drivers against their emulators, its bindings in edtlib and its settings in kconfiglib.

No Zephyr is built here. The headers in ``include`` replace its own.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import kconfiglib
import pytest
import yaml
from c_harness import write
from codewheel.loading.library import load_library
from codewheel.model import Device, Flag, Spi, Verdict
from codewheel.targets import Library
from codewheel.targets.c.names import c_name
from codewheel_zephyr import TARGET
from codewheel_zephyr.driver import Driver, drivers_of
from devicetree import edtlib
from exhaustive import mostly_exhaustive
from working_tools import require

pytestmark = pytest.mark.slow
HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PACKAGE = ROOT / "examples" / "zephyr-target"
FOLDERS = ("ams", "ichaus", "lika", "magntek", "rls")
#: Results of the functions of a driver.
OK, NO_DATA, NOT_USABLE = "ok", "No data available", "Input/output error"
OUT_OF_RANGE = "Numerical result out of range"
PAUSE_US, LARGEST_MOVEMENT = 25, 100


def devices() -> Iterator[Device]:
    for folder in FOLDERS:
        yield from load_library([ROOT / "specs" / folder])[0]


DRIVERS = {driver.stem: driver for device in devices() for driver in drivers_of(device)}
#: One for each bus: BiSS, SSI without and with a CRC, and SPI with the reply in the next and in the same word.
FIRST = ("amm5_biss", "am36_ssi", "mt6701_ssi", "as5048a_spi", "mt6835_spi", "orbis_spi")


@pytest.fixture(scope="session")
def zephyr(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder with the headers of all drivers, and with their modules."""
    folder = tmp_path_factory.mktemp("zephyr")
    all_devices = tuple(devices())
    write(folder, all_devices)
    for name, text in TARGET.files(Library(all_devices), {}).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder


def module_of(driver: Driver, zephyr: Path) -> Path:
    return zephyr / "zephyr" / f"{driver.device.manufacturer.name}-encoders"


def error_flag(driver: Driver, index: int) -> str:
    """Return the member for a flag of an order code that makes the position unusable on its own, or an empty string."""
    parameters = driver.view.variants.rows[index].variant.parameters
    layout = driver.frame.struct.layout
    sent = {field.name for field in layout.place(parameters).fields if field.width}
    for field in layout.fields:
        if (
            field.name in sent
            and isinstance(field.kind, Flag)
            and field.kind.makes_position is Verdict.NOT_USABLE
            and not field.kind.only_while
        ):
            return c_name(field.name)
    return ""


def compiled(driver: Driver, index: int, zephyr: Path, folder: Path) -> Path:
    """Compile the driver and the emulator of an order code."""
    drivers = module_of(driver, zephyr) / "drivers"
    prefix = f"{driver.device.manufacturer.name}_encoder"
    definitions = {
        f"CONFIG_{prefix.upper()}_EMUL": "1",
        "ENUM_IDX_order_code": str(index),
        "PROP_pause_us": str(PAUSE_US),
        "PROP_largest_movement": str(LARGEST_MOVEMENT),
        "HEADER": f'"{driver.header}"',
        "FRAME": driver.frame.type,
        "FLAG": error_flag(driver, index) or driver.member,
        "POSITION_TYPE": driver.position_type,
        "EMUL_FRAME": f"{driver.prefix}_emul_frame",
        "EMUL_SET_POSITION": f"{driver.prefix}_emul_set_position",
        "FLAGS": _mode_flags(driver),
    }
    sources = [drivers / f"{name}.c" for name in ("encoder", f"encoder_{driver.bus}", driver.stem)]
    program = folder / f"{driver.stem}_{index}"
    command = [*"gcc -std=c11 -Wall -Wextra -Werror -fsanitize=address,undefined".split(), "-o", program]
    command += [f"-D{name}={value}" for name, value in definitions.items()]
    command += [f"-I{include}" for include in (HERE / "include", zephyr / "c" / "include", drivers)]
    require(["gcc"])
    completed = subprocess.run(
        [*command, *sources, HERE / "read_positions.c"], capture_output=True, text=True, check=False
    )
    assert completed.returncode == 0, completed.stderr[:4000]
    return program


def _mode_flags(driver: Driver) -> str:
    """Return the flags of Zephyr for the SPI mode in the spec. BiSS and SSI use mode 3."""
    interface = driver.view.context.interface
    mode = interface.mode if isinstance(interface, Spi) else 3
    return ("0U", "SPI_MODE_CPHA", "SPI_MODE_CPOL", "(SPI_MODE_CPOL | SPI_MODE_CPHA)")[mode]


def answers(program: Path, lines: list[str]) -> list[str]:
    text = "".join(f"{line}\n" for line in lines)
    return subprocess.run([program], input=text, capture_output=True, text=True, check=True).stdout.splitlines()


def expected(driver: Driver, index: int, position: int) -> str:
    """Return the answer to a position that is usable. Degrees of revolutions have to fit into 32 bits."""
    parameters = driver.view.variants.rows[index].variant.parameters
    measurement = driver.device.measurement_of(driver.bus)
    assert measurement is not None
    counts = measurement.counts_per_turn.value(parameters)
    if position // counts >= (1 << 31) // 360:
        return f"{OK} {OUT_OF_RANGE} -1 -1"
    millionths = position * 360_000_000 // counts
    return f"{OK} {OK} {millionths // 1_000_000} {millionths % 1_000_000}"


def positions(driver: Driver, index: int) -> list[int]:
    parameters = driver.view.variants.rows[index].variant.parameters
    layout = driver.frame.struct.layout.place(parameters)
    joined = {join.name: join.fields for join in driver.frame.struct.layout.joins}
    names = joined.get(driver.frame.position_member, (driver.frame.position_member,))
    bits = sum(field.width for field in layout.fields if field.name in names)
    return [0, 1, *([1000] if bits > 10 else []), (1 << bits) - 1 - LARGEST_MOVEMENT, (1 << bits) // 3]


@pytest.mark.parametrize("stem", mostly_exhaustive(DRIVERS, *FIRST))
def test_a_driver_reads_the_positions_of_its_emulator(stem: str, zephyr: Path, tmp_path: Path) -> None:
    driver = DRIVERS[stem]
    failed = f"{NOT_USABLE} {NO_DATA} -1 -1"
    for index in sorted({0, len(driver.codes) - 1}):
        program = compiled(driver, index, zephyr, tmp_path)
        for position in positions(driver, index):
            lines = [f"p {position}", "e", "d", f"p {position}", "c"]
            usable = expected(driver, index, position)
            results = [usable, f"Connection timed out {NO_DATA} -1 -1", failed, usable]
            if error_flag(driver, index):
                lines.append("f")
            printed = answers(program, lines)
            assert [line.rpartition(" ")[0] for line in printed[:4]] == results
            assert printed[4] == "Operation not supported, Operation not supported"
            assert [line.rpartition(" ")[0] for line in printed[5:]] == ([failed] if error_flag(driver, index) else [])


def test_two_words_without_a_crc_must_agree(zephyr: Path, tmp_path: Path) -> None:
    program = compiled(DRIVERS["am36_ssi"], 0, zephyr, tmp_path)
    printed = answers(program, ["p 1000", f"m {LARGEST_MOVEMENT}", "p 1000", f"m {LARGEST_MOVEMENT + 1}"])
    usable = [expected(DRIVERS["am36_ssi"], 0, position) for position in (1000, 1000 + LARGEST_MOVEMENT, 1000)]
    assert printed == [*(f"{answer} {PAUSE_US}" for answer in usable), f"{NOT_USABLE} {NO_DATA} -1 -1 {PAUSE_US}"]


# -- bindings

#: What the bindings include of Zephyr.
INCLUDED = {
    "sensor-device.yaml": {"properties": {"friendly-name": {"type": "string"}}},
    "spi-device.yaml": {
        "on-bus": "spi",
        "properties": {
            "compatible": {"type": "string-array", "required": True},
            "reg": {"type": "array", "required": True},
            "spi-max-frequency": {"type": "int", "required": True},
        },
    },
    "bus.yaml": {"description": "A bus", "compatible": "test,spi", "bus": "spi"},
}
TREE = """/dts-v1/;
/ {{
    #address-cells = <1>;
    #size-cells = <0>;
    bus@0 {{
        compatible = "test,spi";
        reg = <0>;
        #address-cells = <1>;
        #size-cells = <0>;
        encoder@0 {{
            compatible = "{compatible}";
            reg = <0>;
            spi-max-frequency = <1000000>;
            {properties}
        }};
    }};
}};
"""


@pytest.fixture(scope="session")
def bindings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("bindings")
    for name, binding in INCLUDED.items():
        (folder / name).write_text(yaml.safe_dump(binding), encoding="utf-8")
    return folder


def encoder_node(driver: Driver, properties: str, zephyr: Path, bindings: Path, folder: Path) -> edtlib.Node:
    (folder / "tree.dts").write_text(TREE.format(compatible=driver.compatible, properties=properties), encoding="utf-8")
    own_bindings = module_of(driver, zephyr) / "dts" / "bindings"
    tree = edtlib.EDT(str(folder / "tree.dts"), [str(bindings), str(own_bindings)])
    return tree.get_node("/bus@0/encoder@0")


@pytest.mark.parametrize("stem", DRIVERS)
def test_an_order_code_has_its_place_in_the_binding(stem: str, zephyr: Path, bindings: Path, tmp_path: Path) -> None:
    """The driver uses this place as the index of its order codes."""
    driver = DRIVERS[stem]
    more = "pause-us = <25>; largest-movement = <100>;" if driver.is_read_twice else ""
    for index, (code, _) in enumerate(driver.codes):
        node = encoder_node(driver, f'order-code = "{code}"; {more}', zephyr, bindings, tmp_path)
        assert (node.props["order-code"].val, node.props["order-code"].enum_index) == (code, index)
    with pytest.raises(edtlib.EDTError, match="order-code"):
        encoder_node(driver, f'order-code = "X"; {more}', zephyr, bindings, tmp_path)
    if more:
        with pytest.raises(edtlib.EDTError, match="pause-us"):
            encoder_node(driver, f'order-code = "{code}";', zephyr, bindings, tmp_path)


# -- settings


def test_a_driver_is_on_if_the_tree_has_its_encoder(
    zephyr: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    driver = DRIVERS["amm5_biss"]
    switches = "".join(
        f"config {name}\n\tdef_bool y\n\n" for name in ("SENSOR", "SPI", "DT_HAS_LIKA_AMM5_BISS_ENABLED")
    )
    (tmp_path / "Kconfig").write_text(
        f'{switches}config EMUL\n\tbool "Emulators"\n\nsource "{module_of(driver, zephyr) / "Kconfig"}"\n',
        encoding="utf-8",
    )
    monkeypatch.setenv("KCONFIG_WARN_UNDEF", "n")
    settings = kconfiglib.Kconfig(str(tmp_path / "Kconfig"), warn_to_stderr=False)
    names = ("LIKA_ENCODER_DRIVERS", "LIKA_AMM5_BISS", "LIKA_AMM5_SSI", "LIKA_ENCODER_EMUL")
    assert [settings.syms[name].str_value for name in names] == ["y", "y", "n", "n"]
    settings.syms["EMUL"].set_value("y")
    assert settings.syms["LIKA_ENCODER_EMUL"].str_value == "y"
    assert settings.warnings == []


def test_cmake_compiles_each_file_of_a_module(zephyr: Path) -> None:
    for module in (zephyr / "zephyr").iterdir():
        text = (module / "CMakeLists.txt").read_text(encoding="utf-8")
        sources = list((module / "drivers").glob("*.c"))
        assert sources
        assert all(f"drivers/{path.name}" in text for path in sources)
        settings = (module / "Kconfig").read_text(encoding="utf-8")
        assert all(
            f"config {word[7:]}\n" in settings
            for word in text.replace("(", " ").replace(")", " ").split()
            if word.startswith("CONFIG_")
        )


@pytest.mark.exhaustive
def test_it_is_installed_and_generates(tmp_path: Path) -> None:
    """The command of the README, with the package as its user installs it."""
    ignored = shutil.ignore_patterns("__pycache__", "build", "*.egg-info")
    shutil.copytree(PACKAGE, tmp_path / "source", ignore=ignored)
    installing = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"]
    subprocess.run([*installing, "--target", tmp_path / "site", tmp_path / "source"], check=True)
    readme = (PACKAGE / "README.md").read_text(encoding="utf-8")
    (arguments,) = re.findall(r"^codewheel (.*)$", readme, re.MULTILINE)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "site")}
    command = [sys.executable, "-m", "codewheel", *arguments.split()]
    subprocess.run(command, cwd=tmp_path, env=environment, check=True, capture_output=True)
    assert (tmp_path / "out" / "c" / "include" / "lika" / "amm5_biss.h").is_file()
    assert (tmp_path / "out" / "zephyr" / "lika-encoders" / "drivers" / "amm5_biss.c").is_file()


def test_it_is_small() -> None:
    paths = [PACKAGE / "pyproject.toml", *PACKAGE.rglob("*.py"), *PACKAGE.rglob("*.jinja")]
    ours = [path for path in paths if not {"build", "__pycache__"} & set(path.parts)]
    assert sum(len(path.read_text(encoding="utf-8").splitlines()) for path in ours) <= 700
