"""Configuration files in the drive's own software: ``ingenialink`` loads them into a ``virtual-drive``."""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterator
from importlib import resources
from pathlib import Path
from typing import Any

import pytest
from codewheel.masters.groups import records_of
from codewheel.masters.record import Record
from codewheel.masters.sheet import Master, sheet
from codewheel.targets import Library
from codewheel.targets.masters.files import file_text

pytestmark = pytest.mark.slow


#: Dictionary of the drive, its maximum of position bits, and the registers that it lacks.
DRIVES = [("virtual_drive.xdf", 32, set[str]()), ("virtual_drive_v3.0.xdf", 40, {"FBK_BISS1_SSI1_WAIT_CYCLES"})]


@pytest.fixture(scope="module", params=[item[0] for item in DRIVES])
def servo(request: pytest.FixtureRequest) -> Iterator[Any]:
    """A drive with a dictionary from its package, on a free port."""
    network = pytest.importorskip("ingenialink.ethernet.network", reason="ingenialink is not installed")
    drive = pytest.importorskip("virtual_drive.core", reason="virtual-drive is not installed")
    dictionary = str(resources.files("virtual_drive") / "resources" / request.param)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    running = drive.VirtualDrive(port, dictionary)
    running.start()
    connection = network.EthernetNetwork()
    found = connection.connect_to_slave("127.0.0.1", dictionary, port)
    found.most, found.lacks = next(item[1:] for item in DRIVES if item[0] == request.param)
    yield found
    connection.disconnect_from_slave(found)
    running.stop()


def test_a_drive_takes_the_configuration(
    servo: Any, tmp_path: Path, library: Library, masters: dict[str, Master], record_of: Callable[[str], Record]
) -> None:
    """Every value that the drive holds afterwards is that of the page. Frame size and position bits were typed."""
    configuration = pytest.importorskip("ingenialink.configuration_file").ConfigurationFile
    master = masters["novanta"]
    rule = master.files[0]
    typed = {"AMM5A17/1SC1": (25, 17), "SMA21-SC1-0002": (32, 24), "SMA21-SC1-0050": (32, 24)}
    seen = 0
    for device in library.devices:
        for told in (item for interface in device.interfaces for item in records_of(device, interface)):
            made = sheet(master, told)
            if made.refusals:
                continue
            path = tmp_path / "encoder.xcf"
            path.write_text(file_text(device, [told.code], made, rule, master.devices[0].name), encoding="utf-8")
            assert len(configuration.load_from_xcf(str(path)).registers) == 8
            if (told.numbers["position_bits"] or 0) + (told.numbers["padding_left"] or 0) > servo.most:
                with pytest.raises(Exception, match="POS_BITS"):
                    servo.load_configuration(str(path), strict=True)
                continue
            servo.load_configuration(str(path), strict=not servo.lacks)
            for item in made.settings:
                if item.places[0].symbol not in servo.lacks:
                    assert servo.read(item.places[0].symbol, subnode=1) == item.value, (told.code, item.name)
            if told.code in typed:
                held = [servo.read(f"FBK_BISS1_SSI1_{name}", subnode=1) for name in ("FRAME_SIZE", "POS_BITS")]
                assert tuple(held) == typed[told.code]
            seen += 1
    # Of the iC-MU, the 36 with at most 28 position bits.
    assert seen == (76 if servo.most == 32 else 86)


def test_a_wrong_register_is_reported(
    servo: Any, tmp_path: Path, library: Library, masters: dict[str, Master], record_of: Callable[[str], Record]
) -> None:
    """With a register that the drive lacks, its software does not report success."""
    device = next(item for item in library.devices if item.name == "amm5")
    master = masters["novanta"]
    text = file_text(device, ["AMM5A17/1SC1"], sheet(master, record_of("AMM5A17/1SC1")), master.files[0], master.title)
    path = tmp_path / "encoder.xcf"
    path.write_text(text.replace("FRAME_SIZE", "FRAME_LENGTH"), encoding="utf-8")
    with pytest.raises(Exception, match="FRAME_LENGTH"):
        servo.load_configuration(str(path), strict=True)
