"""Configuration files in the drive's own software: ``ingenialink`` loads them into a ``virtual-drive``."""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterator
from importlib import resources
from itertools import chain
from pathlib import Path
from typing import Any

import pytest
from codewheel.masters.encoder_facts import EncoderFacts
from codewheel.masters.groups import facts_of_order_codes
from codewheel.masters.sheet import Master, sheet
from codewheel.targets import Library
from codewheel.targets.masters.files import file_text

pytestmark = pytest.mark.slow


#: Dictionary of the drive, its maximum of position bits, and the registers that it lacks.
DRIVES = [("virtual_drive.xdf", 32, set[str]()), ("virtual_drive_v3.0.xdf", 40, {"FBK_BISS1_SSI1_WAIT_CYCLES"})]


@pytest.fixture(scope="module", params=[drive[0] for drive in DRIVES])
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
    connected = connection.connect_to_slave("127.0.0.1", dictionary, port)
    limits = {name: drive_limits for name, *drive_limits in DRIVES}
    connected.max_position_bits, connected.missing_registers = limits[request.param]
    yield connected
    connection.disconnect_from_slave(connected)
    running.stop()


def test_a_drive_takes_the_configuration(
    servo: Any, tmp_path: Path, library: Library, masters: dict[str, Master], record_of: Callable[[str], EncoderFacts]
) -> None:
    """Every value that the drive then holds equals the page's. Frame size and position bits were typed."""
    configuration = pytest.importorskip("ingenialink.configuration_file").ConfigurationFile
    master = masters["novanta"]
    rule = master.files[0]
    typed = {"AMM5A17/1SC1": (25, 17), "SMA21-SC1-0002": (32, 24), "SMA21-SC1-0050": (32, 24)}
    loaded_count = 0
    for device in library.devices:
        records = chain.from_iterable(facts_of_order_codes(device, interface) for interface in device.interfaces)
        for record in records:
            settings_sheet = sheet(master, record)
            if settings_sheet.refusals:
                continue
            path = tmp_path / "encoder.xcf"
            path.write_text(
                file_text(device, [record.code], settings_sheet, file_rule=rule, master_device=master.devices[0].name),
                encoding="utf-8",
            )
            assert len(configuration.load_from_xcf(str(path)).registers) == 8
            if (record.numbers["position_bits"] or 0) + (record.numbers["padding_left"] or 0) > servo.max_position_bits:
                with pytest.raises(Exception, match="POS_BITS"):
                    servo.load_configuration(str(path), strict=True)
                continue
            servo.load_configuration(str(path), strict=not servo.missing_registers)
            for setting in settings_sheet.settings:
                if setting.places[0].symbol not in servo.missing_registers:
                    assert servo.read(setting.places[0].symbol, subnode=1) == setting.value, (record.code, setting.name)
            if record.code in typed:
                read_back = [servo.read(f"FBK_BISS1_SSI1_{name}", subnode=1) for name in ("FRAME_SIZE", "POS_BITS")]
                assert tuple(read_back) == typed[record.code]
            loaded_count += 1
    # Of the iC-MU, the 36 with at most 28 position bits.
    assert loaded_count == (76 if servo.max_position_bits == 32 else 86)


def test_a_wrong_register_is_reported(
    servo: Any, tmp_path: Path, library: Library, masters: dict[str, Master], record_of: Callable[[str], EncoderFacts]
) -> None:
    """With a register that the drive lacks, its software does not report success."""
    device = next(device for device in library.devices if device.name == "amm5")
    master = masters["novanta"]
    text = file_text(
        device,
        ["AMM5A17/1SC1"],
        sheet(master, record_of("AMM5A17/1SC1")),
        file_rule=master.files[0],
        master_device=master.title,
    )
    path = tmp_path / "encoder.xcf"
    path.write_text(text.replace("FRAME_SIZE", "FRAME_LENGTH"), encoding="utf-8")
    with pytest.raises(Exception, match="FRAME_LENGTH"):
        servo.load_configuration(str(path), strict=True)
