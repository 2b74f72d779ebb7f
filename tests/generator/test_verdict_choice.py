"""The warning bit of the AMM5 over BiSS has two causes, and the user can say which one it is taken for.

The manual lists for nW = 0 (6.2.1): "It indicates that an error has occurred in the magnetic multiturn system", and
"The battery charge level is low. You are required to replace the battery as soon as possible". After the replacement
with only the warning active, "the absolute position of the encoder is retained" (4.3.1). For nE = 0: "The battery is
spent. The encoder cannot operate". Without a choice, the worse of the two causes applies.

The CRC of the frames is computed here: polynomial x^6 + x + 1, sent inverted (6.2.1).
"""

from __future__ import annotations

import json
import subprocess
from itertools import product
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from browser_harness import Asker, program
from codewheel.commands.cli import main
from codewheel.model import Device
from codewheel.order_codes.labels import find_code
from codewheel.order_codes.parameters import with_answers
from codewheel.reference import codec
from codewheel.reference.findings import findings
from codewheel.targets import Library
from codewheel.targets.browser.files import generate as browser_files
from codewheel.targets.c.files import generate as c_files
from working_tools import require

MULTITURN, SINGLETURN = "AMM5A21/65KSC1", "AMM5A21/1SC1"
POSITION = 1_000_003
EITHER, BATTERY = "either_cause", "low_battery"
#: Verdict for the levels of nE and nW, with each answer. Both bits are active at 0.
WANTED = {
    (1, 1): {EITHER: "usable", BATTERY: "usable"},
    (1, 0): {EITHER: "not_usable", BATTERY: "usable_with_warning"},
    (0, 1): {EITHER: "not_usable", BATTERY: "not_usable"},
    (0, 0): {EITHER: "not_usable", BATTERY: "not_usable"},
}
#: Without a battery, the manual does not say what the bit means.
WANTED_WITHOUT_BATTERY = {
    (1, 1): "usable",
    (1, 0): "usable_with_warning",
    (0, 1): "not_usable",
    (0, 0): "not_usable",
}
IN_C = ("not_usable", "unknown", "usable_with_warning", "usable")
CASES = [(levels, answer) for levels, answer in product(WANTED, (EITHER, BATTERY))]


def crc_6(number: int, bits: int) -> int:
    remainder = 0
    for place in reversed(range(bits)):
        feedback = (number >> place & 1) ^ remainder >> 5
        remainder = (remainder << 1 & 0x3F) ^ 0x03 * feedback
    return remainder ^ 0x3F


def frame(levels: tuple[int, int], position_bits: int) -> int:
    error, warning = levels
    data = POSITION << 2 | error << 1 | warning
    return data << 6 | crc_6(data, position_bits + 2)


def test_the_frame_with_both_levels_at_1_is_the_one_in_the_readme() -> None:
    assert frame((1, 1), 37) == 0xF4243D3


@pytest.mark.parametrize(("levels", "answer"), CASES)
def test_the_reference(amm5: Device, levels: tuple[int, int], answer: str) -> None:
    variant = with_answers(amm5, find_code(amm5, MULTITURN).variant, {"warning_cause": answer})
    placed = amm5.layout("single_cycle_data").place(variant.parameters)
    frame_findings = findings(amm5, variant, codec.decode(amm5, placed, frame(levels, 37)))
    assert frame_findings.verdict is not None
    assert frame_findings.verdict.value == WANTED[levels][answer]
    verdicts = {report.field: report.makes_position for report in frame_findings.reports}
    if "warning" in verdicts:
        warning_verdict = verdicts["warning"]
        assert warning_verdict is not None
        assert warning_verdict.value == WANTED[1, 0][answer]


def test_every_frame_is_decoded_without_a_choice(amm5: Device) -> None:
    variant, layout = find_code(amm5, MULTITURN).variant, amm5.layout("single_cycle_data")
    assert amm5.alternatives_of(layout) == ()
    assert [alternative.name for alternative in amm5.verdict_alternatives(layout)] == ["warning_cause"]
    for levels, wanted in WANTED.items():
        decoded = codec.decode(amm5, layout.place(variant.parameters), frame(levels, 37))
        verdict = findings(amm5, variant, decoded).verdict
        assert verdict is not None
        assert verdict.value == wanted[EITHER]


def decode(capsys: pytest.CaptureFixture[str], code: str, number: int, *more: str) -> tuple[int, str]:
    status = main(["decode", code, f"{number:#x}", *more])
    return status, capsys.readouterr().out


@pytest.mark.parametrize(("levels", "answer"), CASES)
def test_decode(capsys: pytest.CaptureFixture[str], levels: tuple[int, int], answer: str) -> None:
    chosen = ("--choose", f"warning_cause={answer}")
    status, out = decode(capsys, MULTITURN, frame(levels, 37), *chosen, "--json")
    decoded = json.loads(out)
    assert decoded["verdict"] == WANTED[levels][answer]
    assert status == (3 if decoded["verdict"] == "not_usable" else 0)
    assert decoded["alternatives"] == ({} if levels[1] else {"warning_cause": answer})


def test_decode_says_which_reading_applies(capsys: pytest.CaptureFixture[str]) -> None:
    _, out = decode(capsys, MULTITURN, frame((1, 0), 37))
    words = " ".join(out.split())
    assert "decoded with warning_cause = either_cause: An error in the magnetic multiturn system" in words
    assert "this is the default; for a different reading, add --choose warning_cause=low_battery" in words
    _, out = decode(capsys, MULTITURN, frame((1, 0), 37), "--choose", "warning_cause=low_battery")
    words = " ".join(out.split())
    assert "decoded with warning_cause = low_battery: Only a low battery" in words
    assert "this is the default" not in words
    _, out = decode(capsys, MULTITURN, frame((1, 1), 37))
    assert "warning_cause" not in out


def test_a_singleturn_encoder_has_nothing_to_choose(capsys: pytest.CaptureFixture[str]) -> None:
    for levels, wanted in WANTED_WITHOUT_BATTERY.items():
        _, out = decode(capsys, SINGLETURN, frame(levels, 21), "--json")
        decoded = json.loads(out)
        assert (decoded["verdict"], decoded["alternatives"]) == (wanted, {})
    assert main(["decode", SINGLETURN, "0", "--choose", "warning_cause=low_battery"]) == 2
    assert f"{SINGLETURN} has nothing to choose" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize(("code", "bits"), [(MULTITURN, 37), (SINGLETURN, 21)])
def test_python(generated_python: tuple[Path, ModuleType], code: str, bits: int) -> None:
    """Single frames, and many frames at once. Encoders with both answers can be used side by side."""
    package: Any = generated_python[1]
    first = package.lookup(code)
    order = [*package.Verdict]
    frames = [frame(levels, bits) for levels in WANTED]
    assert first.low_battery_only == 0
    for answer in package.amm5.WarningCause:
        encoder = first.with_answers(warning_cause=answer)
        decoded = [encoder.decode(number) for number in frames]
        verdicts = [decoded_frame.verdict for decoded_frame in decoded]
        assert [verdict.value for verdict in verdicts] == expected_verdicts(bits, answer.name.lower())
        assert [order[index] for index in encoder.decode_many(frames).verdict] == verdicts
        for decoded_frame in decoded:
            assert (decoded_frame.usable_position is None) == (decoded_frame.verdict is package.Verdict.NOT_USABLE)
            worst = min((report.makes_position for report in decoded_frame.reports), key=order.index, default=order[-1])
            assert worst is decoded_frame.verdict
    assert [first.decode(number).verdict.value for number in frames] == expected_verdicts(bits, EITHER)
    with pytest.raises(
        TypeError, match=r"warning_cause must be WarningCause\.EITHER_CAUSE or WarningCause\.LOW_BATTERY"
    ):
        first.with_answers(warning_cause="low_battery")


def expected_verdicts(bits: int, answer: str) -> list[str]:
    return [WANTED[levels][answer] if bits == 37 else WANTED_WITHOUT_BATTERY[levels] for levels in WANTED]


C_PROGRAM = """
#include <stdio.h>
#include "lika/amm5_biss.h"
int main(void)
{
    static const uint64_t words[] = { @words@ };
    lika_amm5_biss variant = LIKA_AMM5_BISS_@code@;
    uint8_t answer;
    size_t place;
    for (answer = 0U; answer < 2U; ++answer) {
        variant.low_battery_only = answer;
        for (place = 0U; place < sizeof(words) / sizeof(*words); ++place) {
            uint64_t position = 5U;
            const cw_word word = cw_word_of(words[place], lika_amm5_biss_bits(variant));
            const cw_verdict verdict = lika_amm5_biss_position(variant, word, &position);
            printf("%d %d\\n", (int)verdict, (int)position);
        }
    }
    return LIKA_AMM5_BISS_@code@.low_battery_only;
}
"""


@pytest.mark.slow
@pytest.mark.parametrize(("code", "bits"), [("A21_65KSC1", 37), ("A21_1SC1", 21)])
def test_c(amm5: Device, tmp_path: Path, code: str, bits: int) -> None:
    """The order codes keep the default. A copy of an order code has the answer in its member."""
    require(["gcc"])
    for path, text in c_files(Library((amm5,))).items():
        target = tmp_path / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
    words = ", ".join(f"UINT64_C({frame(levels, bits):#x})" for levels in WANTED)
    source = tmp_path / "program.c"
    source.write_text(C_PROGRAM.replace("@words@", words).replace("@code@", code), encoding="utf-8")
    build = ["gcc", "-std=c99", "-Wall", "-Wextra", "-Werror", f"-I{tmp_path / 'c' / 'include'}", str(source), "-o"]
    subprocess.run([*build, str(tmp_path / "program")], check=True)
    done = subprocess.run([str(tmp_path / "program")], capture_output=True, text=True, check=True)
    wanted = [verdict for answer in (EITHER, BATTERY) for verdict in expected_verdicts(bits, answer)]
    lines = [f"{IN_C.index(verdict)} {5 if verdict == 'not_usable' else POSITION}" for verdict in wanted]
    assert done.stdout.splitlines() == lines


@pytest.mark.slow
def test_the_browser(amm5: Device, tmp_path: Path) -> None:
    node = Asker(tmp_path, browser_files(Library((amm5,)))["browser/decode.js"], program("node"))
    requests: list[dict[str, object]] = []
    for levels, answer in CASES:
        request = {"code": MULTITURN, "sender": "encoder", "text": f"{frame(levels, 37):#x}"}
        requests.append({**request, "answers": {"warning_cause": answer}})
    verdicts = [decoded["verdict"] for decoded in node("values", requests)]
    assert verdicts == [WANTED[levels][answer] for levels, answer in CASES]
    unanswered = [{**request, "answers": {}} for request in requests]
    verdicts = [decoded["verdict"] for decoded in node("values", unanswered)]
    assert verdicts == [WANTED[levels][EITHER] for levels, _ in CASES]


def test_the_pages_state_the_question_and_both_answers(pages: dict[str, str]) -> None:
    page = pages["docs/amm5/AMM5A21-65KSC1.md"]
    lines = page.splitlines()
    with_answer = "- [With `low_battery`](#alternative-warning_cause): ▲ usable with a warning if `warning` is 0."
    assert with_answer in lines
    error = next(line for line in lines if "`error`</small> | 0 |" in line)
    warning = next(line for line in lines if "`warning`</small> | 0 |" in line)
    assert "| ✕ **not usable** |" in error
    assert "| ✕ **not usable** |" in warning
    assert '<a id="alternative-warning_cause"></a>' in page
    assert "warning_cause" not in pages["docs/amm5/AMM5A21-1SC1.md"]
    usable = pages["docs/amm5-verdicts.md"].splitlines()
    deciding = [line for line in usable if "#alternative-warning_cause" in line]
    assert ["`either_cause` (the default) | ✕ **not usable**" in line for line in deciding] == [True, False]
    assert ["`low_battery` | ▲ usable with a warning" in line for line in deciding] == [False, True]


@pytest.mark.slow
def test_a_second_reading_with_the_verdicts_exchanged_is_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    specs = Path(__file__).parents[2] / "specs" / "lika"
    for name in ("manufacturer.yaml", "amm5.yaml", "amm5.second.yaml"):
        (tmp_path / name).write_text((specs / name).read_text(encoding="utf-8"), encoding="utf-8")
    second = tmp_path / "amm5.second.yaml"
    text = second.read_text(encoding="utf-8")
    indent = " " * 12
    stated = f"not_usable\n{indent}makes_position_if: {{low_battery_only: usable_with_warning}}"
    exchanged = f"usable_with_warning\n{indent}makes_position_if: {{low_battery_only: not_usable}}"
    assert text.count(stated) == 1
    second.write_text(text.replace(stated, exchanged), encoding="utf-8")
    assert main(["check", str(tmp_path)]) == 1
    printed = " ".join(capsys.readouterr().out.split())
    assert "readings-disagree: verdict with the other answer of " in printed
