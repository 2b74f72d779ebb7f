"""Settings that an institute stores for the EL5042, reproduced from specs of its encoders in ``specs``.

The numbers were typed from paulscherrerinstitute/ecmccfg at commit 19fd09c, hardware/Encoders, and from
paulscherrerinstitute/ecmccomp at commit c97a6b0: its facts in encoders/ as EL5042_SDOS_BISS_C_ENC.cmd writes them.
Each is the value of a subindex of 0x80p8.
"""

from __future__ import annotations

from pathlib import Path

import file_readers as readers
import pytest
from codewheel.commands.cli import main

ENCODERS = Path(__file__).parents[2] / "specs"
DIRECTION = "choice: 01 is the counting direction, which depends on the mounting. 0 is the factory default"
SUPPLY = "choice: 50 is the factory default of 12. Writing it needs a code word in F008 first, which theirs lacks"
POLYNOMIAL = "theirs: it leaves 11 at its factory default, which is 67"

Values = dict[int, int]
#: Order code, name of the institute's file, its values, and the reason why ours has other values.
FILES: list[tuple[str, str, Values, dict[int, str]]] = [
    (
        "KCD-BC03B-1617",
        "ecmcEL5042-Encoder-Posital-KCD-BC03B-1617-XXXX-XXX.cmd",
        {0x02: 0, 0x03: 1, 0x12: 50, 0x13: 9, 0x14: 0, 0x15: 16, 0x16: 17, 0x17: 0, 0x18: 0},
        {0x12: SUPPLY, 0x11: POLYNOMIAL},
    ),
    (
        "KCD-BC03B-1617",
        "Encoder-Posital-KCD-BC03B-1617-BISS-C.cmd",
        {0x01: 0, 0x02: 0, 0x03: 1, 0x11: 67, 0x13: 9, 0x14: 0, 0x15: 16, 0x16: 17, 0x17: 0, 0x18: 0},
        {0x01: DIRECTION},
    ),
    (
        "LA11DCB2D0KB",
        "ecmcEL5042-Encoder-RLS-LA11DCB2D0KB.cmd",
        {0x02: 0, 0x03: 1, 0x11: 67, 0x13: 9, 0x14: 0, 0x15: 0, 0x16: 24, 0x17: 2, 0x18: 0},
        {0x13: "choice: 1 MHz here and 2.5 MHz in their other file. Ours takes the faster clock in use"},
    ),
    (
        "LA11DCB2D0KB",
        "ecmcEL5042-Encoder-RLS-LA11-24bit.cmd",
        {0x02: 0, 0x03: 1, 0x12: 50, 0x13: 3, 0x14: 0, 0x15: 0, 0x16: 26, 0x17: 0, 0x18: 0},
        {
            0x12: SUPPLY,
            0x11: POLYNOMIAL,
            0x16: "theirs: 26 bits here, 24 in their other file. Two of the 26 are zeros at this resolution",
            0x17: "theirs: no offset here, 2 in their other file. Without it, a count is a quarter of the step",
        },
    ),
    (
        "WDGA36E-06-1218-SIA",
        "ecmcEL5042-Encoder-Wachendorff-WDGA36E-06-1218-SIA-B01-CB8.cmd",
        {0x01: 0, 0x02: 0, 0x03: 1, 0x12: 50, 0x13: 17, 0x14: 0, 0x15: 18, 0x16: 12, 0x17: 0, 0x18: 1},
        {
            0x01: DIRECTION,
            0x02: "theirs: SSI mode needs 1. It writes 18 last, and the terminal then sets 02 itself",
            0x03: "theirs: SSI has no CRC, so 03 has no effect",
            0x11: "ours: SSI mode needs 0. The terminal sets it when 18 is written",
            0x12: "choice: their file has 10 V to 24 V, so 12 has no effect. It stays at its default",
        },
    ),
]


def generated_values(capsys: pytest.CaptureFixture[str], code: str) -> Values:
    assert main(["master", code, "--master", "beckhoff_el5042", "--format", "ecmc", "--specs", str(ENCODERS)]) == 0
    value_and_size_by_object = readers.ecmc(capsys.readouterr().out)
    assert {index for index, _ in value_and_size_by_object} == {0x8008}
    for (_, subindex), (_, byte_count) in value_and_size_by_object.items():
        assert byte_count == (4 if subindex == 0x11 else 1)
    return {subindex: value for (_, subindex), (value, _) in value_and_size_by_object.items()}


@pytest.mark.parametrize(("code", "name", "theirs", "why"), FILES, ids=[name for _, name, *_ in FILES])
def test_every_difference_is_explained(
    capsys: pytest.CaptureFixture[str], code: str, name: str, theirs: Values, why: dict[int, str]
) -> None:
    our_values = generated_values(capsys, code)
    subindexes = theirs.keys() | our_values.keys()
    different = {subindex for subindex in subindexes if theirs.get(subindex) != our_values.get(subindex)}
    assert different == set(why), name
    assert all(text.partition(":")[0] in ("theirs", "ours", "choice") for text in why.values())


@pytest.mark.slow
def test_the_encoders_are_sound(capsys: pytest.CaptureFixture[str]) -> None:
    """They pass check, and each states that it relies on files of a single institute."""
    assert main(["check", str(ENCODERS)]) == 0
    assert capsys.readouterr().out.splitlines()[-1].startswith("no problems in ")
    for name in ("posital/kcd", "rls/la11", "wachendorff/wdga"):
        text = (ENCODERS / f"{name}.yaml").read_text(encoding="utf-8")
        assert "from public files, not transcribed from a manual" in " ".join(text.replace("#", " ").split())
        assert "grade: uncorroborated" in text
