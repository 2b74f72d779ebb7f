"""Each master states whether it reads a second data channel of a frame, and refuses a position in this channel."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from codewheel.loading.library import load_library
from codewheel.masters.order_code_facts import facts_of_order_code
from codewheel.masters.sheet import SettingsSheet, sheet, shipped_masters
from codewheel.targets import Library
from codewheel.targets.masters.files import generate

SPECS = Path(__file__).resolve().parents[1] / "specs"
ENCODERS = Path(__file__).resolve().parents[2] / "specs"
#: Masters whose documents have settings for several slaves or encoders of a frame.
WITH_CHANNELS = {"ic_mb", "ti_motor_control_sdk"}
GAP = "The description of this master covers a single data channel. Nothing reads 'safety_word' after it."


def layouts_in(text: str) -> tuple[str, str]:
    """Return the texts of the two layouts."""
    _, mark, both = text.partition("      - name: control_word")
    control, other_mark, safety = both.partition("      - name: safety_word")
    return mark + control, other_mark + safety.rstrip("\n")


def sheets(text: str, folder: Path) -> dict[str, SettingsSheet]:
    """Return the settings of each master for BiSS, by its name."""
    path = folder / "channels.yaml"
    path.write_text(text, encoding="utf-8")
    (device,), report = load_library([path, SPECS / "manufacturer.yaml"])
    assert not report
    facts = facts_of_order_code(device, device.variant("RXH"))
    return {master.name: sheet(master, facts) for master in shipped_masters() if "biss" in master.supported_interfaces}


def test_each_master_says_whether_it_takes_a_second_channel(tmp_path: Path) -> None:
    for name, settings in sheets((SPECS / "channels.yaml").read_text(encoding="utf-8"), tmp_path).items():
        gaps = [gap.reason for gap in settings.gaps]
        if settings.refusals:
            continue
        assert (GAP in gaps) is (name not in WITH_CHANNELS), name
        assert (settings.master.several_channels in settings.notes) is (name in WITH_CHANNELS), name


def test_masters_for_one_channel_refuse_a_position_in_the_second(tmp_path: Path) -> None:
    text = (SPECS / "channels.yaml").read_text(encoding="utf-8")
    head, control, safety = text.partition("      - name: control_word")[0], *layouts_in(text)
    text = f"{head}{safety}\n{control}"
    text = text.replace("order: [control_word, safety_word]", "order: [safety_word, control_word]")
    refusal = (
        "The description of this master covers a single data channel, but 'safety_word' is the first in the frame, and"
        " 'control_word' with the position follows it."
    )
    by_name = sheets(text, tmp_path)
    for name, settings in by_name.items():
        reasons = [reason.reason for reason in settings.refusals]
        assert (refusal in reasons) is (name not in WITH_CHANNELS), name
    assert len(by_name) > 10


@pytest.mark.parametrize("name", sorted(WITH_CHANNELS))
def test_a_frame_with_one_channel_has_no_such_note(name: str, tmp_path: Path) -> None:
    text = (SPECS / "channels.yaml").read_text(encoding="utf-8")
    start = text.index("    channels:\n")
    text = text[:start] + text[text.index("    layouts:\n") :]
    # Only the comparison of the channels depends on this parameter.
    text = re.sub(r", accurate_bits: [0-9]+|  accurate_bits: {.*}\n", "", text)
    settings = sheets(text, tmp_path)[name]
    assert settings.master.several_channels not in settings.notes


def test_a_file_is_written_for_order_codes_without_a_known_value() -> None:
    """With a life counter and without a known clock, the TI SDK has no value for its structure."""
    folder = ENCODERS / "ichaus"
    devices, report = load_library([folder / "icmr.yaml", folder / "manufacturer.yaml"])
    assert not report
    text = generate(Library(tuple(devices)))["masters/ti_motor_control_sdk/c_struct/icmr.h"]
    blocks = re.split(r"^// === ", text, flags=re.MULTILINE)[1:]
    blocks_without = [block for block in blocks if "#define" not in block]
    assert len(blocks) > len(blocks_without)
    assert [block.startswith("iC-MR-12-L") for block in blocks_without] == [True]
