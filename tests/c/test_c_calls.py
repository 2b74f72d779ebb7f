"""Every function that is defined is called: by headers, by the self-test, or by users, who are listed by name."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping

import pytest
from c_harness import devices_of
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.c.files import generate

pytestmark = pytest.mark.slow

#: Functions of the runtime for users, and functions for Gray excess, BCD and long parities, which no family here uses.
SHARED = {
    "angle": "electrical q31 q15 degrees radians millidegrees",
    "bits": "from_gray_excess to_gray_excess from_digits to_digits parities parity_64",
    "biss": "answer_decode master_init master_read master_write master_abort master_next master_next_late"
    " request_encode",
    "biss_slave": "slave_init slave_allow slave_give slave_stored slave_next",
    "transport": "step_send step_poll step_more step_read_one",
    "receive": "words16 words32 samples biss_receive biss_receive_cds ssi_receive ssi_repeats"
    " ask take take_any resume late reason",
    "channels": "biss_positions_agree",
    "receive_frame": "biss_receive_frame ssi_receive_frame",
    "runner": "start next done close",
    "spi": "start exchange bytes data store load",
    "tracker": "start restart add speed divided",
}
#: Functions of a family for users: functions of frames and registers, and constants of an order code and an interface.
FAMILY = re.compile(
    r"find_order_code|next_candidate|report_text|(read|write|take)_\w+"
    r"|(\w+_)?(encode|decode|is_expected|verdict|reports|position|set_\w+)|reg_\w+_(mask|shift|max)"
    r"|turns|degrees|micrometres|millimetres|(\w+_)?position_difference|clock_limit_hz|timeout_ns"
    r"|request_frame|reply_frame|frame_length"
)


def uncalled(files: Mapping[str, str]) -> list[tuple[str, str]]:
    """Return each function that occurs only in its definition, without comments, and the stem of its header."""
    code = {path: re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL) for path, text in files.items()}
    words = Counter(word for text in code.values() for word in re.findall(r"\w+", text))
    functions: list[tuple[str, str]] = []
    for path, text in code.items():
        if path.endswith(".h"):
            names = re.findall(r"^static inline [\w *]*?(\w+)\(", text, re.MULTILINE)
            stem = path.split("/")[-1].removesuffix(".h")
            functions += [(stem, name) for name in names if words[name] == 1]
    return functions


def functions_for_nobody(devices: tuple[Device, ...], files: Mapping[str, str]) -> list[str]:
    """Return those that users do not call either."""
    families = {device.name: device for device in devices}
    without_caller = []
    for header, name in uncalled(files):
        short = name.split("_", 1)[1]
        family, _, stem = header.partition("_")
        if family in families:
            short = short.removeprefix(f"{family}_{stem.split('_')[0]}_")
            device = families[family]
            named = {part.name for part in (*device.procedures, *device.parameters)}
            expected = FAMILY.fullmatch(short) or short in named
        else:
            expected = any(short.endswith(ending) for ending in SHARED[header].split())
        without_caller += [] if expected else [name]
    return without_caller


@pytest.fixture(scope="module")
def code() -> tuple[tuple[Device, ...], dict[str, str]]:
    devices = devices_of()
    files = generate(Library(devices))
    return devices, {path: text for path, text in files.items() if "/include/" in path or "/selftest/" in path}


@pytest.mark.slow
def test_what_nothing_calls_is_for_users(code: tuple[tuple[Device, ...], dict[str, str]]) -> None:
    devices, files = code
    assert len(uncalled(files)) > 100
    assert functions_for_nobody(devices, files) == []


@pytest.mark.slow
def test_a_function_without_a_caller_is_found(code: tuple[tuple[Device, ...], dict[str, str]]) -> None:
    devices, files = code
    path = next(path for path in files if path.endswith("/amm5_biss.h"))
    planted = files[path] + "static inline uint32_t lika_amm5_biss_left_over(uint32_t value)\n{\n    return value;\n}\n"
    assert functions_for_nobody(devices, files | {path: planted}) == ["lika_amm5_biss_left_over"]
