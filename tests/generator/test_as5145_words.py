"""All 262,144 SSI words of the AS5145, against the masks of a public driver and the words of the data sheet.

The driver is k3ng/k3ng_rotator_controller at commit 55d4f4c, libraries/hh12/hh12.cpp: it masks the status with 63 and
the angle with 262080, and tests 32 for OCF, 16 for COF, 8 for LIN, 4 for INCn and 2 for DECn. It does not read the
parity bit, which the data sheet calls the even parity of bits 1 to 17.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from codewheel.loading.library import load_library
from codewheel.targets import Library

pytestmark = pytest.mark.slow

SPECS = Path(__file__).resolve().parents[2] / "specs" / "ams"


def test_every_word(import_generated: Callable[[Library, str], tuple[Path, ModuleType]]) -> None:
    np: Any = pytest.importorskip("numpy")
    devices, report = load_library([SPECS / "as5145.yaml", SPECS / "manufacturer.yaml"])
    assert not report
    _, module = import_generated(Library(tuple(devices)), "ams_encoders")
    encoder: Any = module.lookup("AS5145B")
    words = np.arange(1 << 18, dtype=np.uint64)
    table = encoder.decode_many(words)
    count_of_ones = sum(words >> np.uint64(bit) & np.uint64(1) for bit in range(18))
    is_even = count_of_ones % np.uint64(2) == 0
    assert (table.ok == is_even).all()
    assert int(table.ok.sum()) == 131_072
    valid_words, status_of_valid = words[is_even], (words & np.uint64(63))[is_even]
    assert (table["position"][is_even] == (valid_words & np.uint64(262080)) >> np.uint64(6)).all()
    mask_by_flag = {"cordic_overflow": 16, "linearity_alarm": 8, "field_increasing": 4, "field_decreasing": 2}
    for name, mask in mask_by_flag.items():
        assert (table[name][is_even] == (status_of_valid & np.uint64(mask) != 0)).all(), name
    is_ready = status_of_valid & np.uint64(32) != 0
    assert (table["not_ready"][is_even] == ~is_ready).all()
    # Valid: OCF = 1, COF = 0, LIN = 0. Both bits of the field together are a warning.
    is_usable = is_ready & (status_of_valid & np.uint64(24) == 0)
    is_out_of_range = status_of_valid & np.uint64(6) == 6
    first_verdicts = [encoder.decode(int(word)).verdict.value for word in valid_words[:64]]
    expected = np.where(is_usable, np.where(is_out_of_range, "usable_with_warning", "usable"), "not_usable")
    assert first_verdicts == expected[:64].tolist()
    verdict_numbers = {
        name: table.verdict[is_even][expected == name] for name in ("usable", "usable_with_warning", "not_usable")
    }
    for name, column in verdict_numbers.items():
        assert len(set(column.tolist())) == 1, name
    assert len({int(column[0]) for column in verdict_numbers.values()}) == 3
