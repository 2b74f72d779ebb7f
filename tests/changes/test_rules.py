"""Every rule of diff: a pair of specs for each, its exact output, and a check of its impact."""

from __future__ import annotations

import ast
import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
import yaml
from codewheel.changes.families import compare
from codewheel.changes.rules import OUTPUTS, RULES, Impact
from codewheel.commands.explain import explain
from codewheel.commands.terminal import CommandError
from codewheel.model import Device
from codewheel.model.members import PARTS_BY_CLASS, ModelPart
from codewheel.targets import Library
from codewheel.targets.registry import files_of, load_target
from exhaustive import mostly_exhaustive
from pair import Case, devices, diff_text, sides

_WITHOUT = {"before": [], "edits": [], "backwards": False}
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # The former is ten times as fast.
_LISTED = yaml.load((Path(__file__).parent / "cases.yaml").read_text(encoding="utf-8"), _LOADER)
CASES: list[Case] = [{**_WITHOUT, **case} for case in _LISTED]  # type: ignore[typeddict-item]
#: Rules with tests of their own, since they need two families or a member of the model that no rule covers.
_ELSEWHERE = {"family-gone", "family-new", "unforeseen"}
_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
_NAME = re.compile(r"\b[A-Za-z_]\w*")


def case_of(rule: str) -> Case:
    return next(case for case in CASES if case["rule"] == rule)


def test_every_rule_has_its_pair() -> None:
    assert {case["rule"] for case in CASES} | _ELSEWHERE == set(RULES)


@pytest.mark.one_in(8, "slow")
@pytest.mark.parametrize("case", CASES, ids=lambda case: case["rule"])
def test_what_is_printed(case: Case) -> None:
    text = diff_text(*sides(case))
    assert text == case["shown"].rstrip("\n")
    assert f"[{case['rule']}]" in text
    assert max(map(len, text.splitlines())) <= 80


@pytest.mark.slow
@pytest.mark.parametrize("case", mostly_exhaustive(CASES, *CASES[::10]), ids=lambda case: case["rule"])
def test_the_way_back(case: Case) -> None:
    """A new thing is gone in the opposite direction, and every change is noticed."""
    old, new = sides(case)
    forward = {change.rule.name for change in compare(old, new)}
    backward = {change.rule.name for change in compare(new, old)}
    assert backward
    kinds_forward = {name.rpartition("-")[0] for name in forward if name.endswith(("-gone", "-new"))}
    kinds_backward = {name.rpartition("-")[0] for name in backward if name.endswith(("-gone", "-new"))}
    assert kinds_forward == kinds_backward
    assert compare(old, old) == compare(new, new) == []


def test_families_that_come_and_go() -> None:
    original = devices([])
    other_family = devices(
        [("device: demo", "device: other"), ('"DEMO{size}', '"OTHER{size}'), ("DEMO17-", "OTHER17-")]
    )
    assert diff_text(original, (*original, *other_family)) == (
        "other\n"
        "  compatible     family other is new\n"
        "                 all 12 order codes; C, Python, XML [family-new]\n"
        "1 change: 1 compatible"
    )
    assert diff_text((*original, *other_family), original) == (
        "other\n"
        "  breaking       family other is gone\n"
        "                 all 12 order codes; C, Python, XML [family-gone]\n"
        "1 change: 1 breaking"
    )


def test_a_limit_is_held_against_the_old_one_at_the_new_numbers() -> None:
    """More bits allow more. This is reported for the bits, and does not hide that the limit allows less."""
    more = [(f"sets: {{singleturn_bits: {bits}}}", f"sets: {{singleturn_bits: {bits + 1}}}") for bits in (13, 17)]
    less = ("max: 2^position_bits - 1", "max: 2^position_bits - 2")
    words = [(f"meaning: {bits} bits", f"meaning: Size {bits}") for bits in (13, 17)]
    assert diff_text(devices(words), devices([*words, *more, less])) == (
        "demo\n"
        "  behaviour      singleturn_bits 13 → 14: frames ssi_word 13 → 14 bits,\n"
        "                 single_cycle_data 21 → 22 bits\n"
        "                 DEMO13…; C, Python, XML [parameter-of-code]\n"
        "  behaviour      singleturn_bits 17 → 18: frames ssi_word 17 → 18 bits,\n"
        "                 single_cycle_data 25 → 26 bits\n"
        "                 DEMO17…; C, Python, XML [parameter-of-code]\n"
        "  behaviour      registers 50h to 53h preset: maximum 2^position_bits - 1 →\n"
        "                 2^position_bits - 2\n"
        "                 all 4 BiSS order codes; C, Python, XML [limit-narrower]\n"
        "3 changes: 3 behaviour"
    )


def test_a_type_in_c_changes_with_the_widest_order_code() -> None:
    """A position of up to 17 + 12 bits is a uint32_t in C. With at most 13 + 3 bits, it is a uint16_t."""
    words = [("meaning: 17 bits", "meaning: Size 17")]
    fewer = [
        ("sets: {singleturn_bits: 17}", "sets: {singleturn_bits: 12}"),
        ("{multiturn_bits: 12}", "{multiturn_bits: 3}"),
    ]
    text = diff_text(devices(words), devices([*words, *fewer]))
    assert "  breaking       preset: number position: uint32_t → uint16_t\n" in text
    assert "  breaking       preset: field singleturn: uint32_t → uint16_t\n" in text
    assert "  breaking       preset: field multiturn: uint16_t → uint8_t\n" in text


def test_what_no_rule_knows(monkeypatch: pytest.MonkeyPatch) -> None:
    old, new = sides(case_of("register-moved"))
    part = PARTS_BY_CLASS["Register"]
    part_without_address = ModelPart(
        part.name, part.about, *(member for member in part.members if member.name != "address")
    )
    monkeypatch.setattr(
        "codewheel.changes.compare.PARTS_BY_CLASS", {**PARTS_BY_CLASS, "Register": part_without_address}
    )
    assert diff_text(old, new) == (
        "demo\n"
        "  behaviour      registers 50h to 53h preset: address 80 → 84\n"
        "                 all 4 BiSS order codes; C, Python, XML [unforeseen]\n"
        "1 change: 1 behaviour"
    )


def test_every_member_of_a_family_is_compared() -> None:
    """A new section of a family must be compared in ``walk``. Overlays and editions show in the facts that they
    change, samples and the hash of the spec follow from the others."""
    assert {member.name for member in fields(Device)} == set(
        """name title movement manufacturer manual documents lost_figures parameters order_code variants crcs interfaces
        registers alarms procedures timings connectors leds characteristics examples errata measurement inputs tables
        field_groups supply evidence alternatives times_read releases overlays base editions edition samples
        content_hash""".split()
    )


def _files_of(devices: Any, target: str) -> dict[str, str]:
    return dict(files_of(load_target(target), Library(tuple(devices)), {}))


def _c_code(text: str) -> list[str]:
    """Return the words and numbers of a header, without comments and texts."""
    return re.findall(r"\w+", re.sub(r'"[^"\n]*"', '""', _COMMENT.sub(" ", text)))


def _python_code(text: str) -> str:
    """Return a module without texts and informative numbers."""

    class Texts(ast.NodeTransformer):
        def visit_Constant(self, node: ast.Constant) -> ast.Constant:
            return ast.Constant("") if isinstance(node.value, str) else node

    return ast.dump(Texts().visit(ast.parse(text)))


@pytest.mark.slow
@pytest.mark.parametrize("case", mostly_exhaustive(CASES, *CASES[::20]), ids=lambda case: case["rule"])
def test_its_impact_is_true(case: Case) -> None:
    """Wording changes no statement, compatible changes keep every name, and reported names are names in the code."""
    old, new = sides(case)
    changes = compare(old, new)
    before, after = ((_files_of(families, "c"), _files_of(families, "python")) for families in (old, new))
    impacts = {}
    for index, output in enumerate(OUTPUTS):
        impacts[output] = max(change.rule.impacts[index] for change in changes)
    _check_impact_on_c(impacts["c"], before[0], after[0])
    modules = [_family_module(files[1]) for files in (before, after)]
    if not modules[1] or not any(name in after[1] for name in before[1] if name.endswith("/demo.py")):
        assert impacts["python"] is Impact.BREAKING
        return
    _check_impact_on_python(impacts["python"], *modules)
    for change in changes:
        if change.rule.name.endswith(("-gone", "-renamed")) and change.names:
            headers = "".join(text for name, text in before[0].items() if name.startswith("c/include/maker/demo_"))
            assert change.names["c"].removesuffix("…") in headers
            name = re.split(r"[.\[]", change.names["python"])[-1].strip('"]')
            assert re.search(rf"\b{name}\b", modules[0])
            assert name == "DataId" or not re.search(rf"(class|def) {name}\b", modules[1])


def _family_module(files: dict[str, str]) -> str:
    """Return the module of the family together with the module of its facts."""
    return "\n".join(text for name, text in sorted(files.items()) if name.endswith("/demo.py"))


def _check_impact_on_c(impact: Impact, before: dict[str, str], after: dict[str, str]) -> None:
    headers = sorted(name for name in before if name.endswith(".h"))
    if not after.keys() >= set(headers):
        assert impact is Impact.BREAKING
        return
    codes_before = [_c_code(before[name]) for name in headers]
    codes_after = [_c_code(after[name]) for name in headers]
    if impact <= Impact.DOCUMENTATION:
        assert list(map(sorted, codes_before)) == list(map(sorted, codes_after))
    elif impact is Impact.COMPATIBLE:
        assert _names_in(codes_before) <= _names_in(codes_after)


def _names_in(codes: list[list[str]]) -> set[str]:
    """Return the names in the words of headers."""
    return {name for code in codes for word in code for name in _NAME.findall(word)}


def _check_impact_on_python(impact: Impact, before: str, after: str) -> None:
    if impact <= Impact.DOCUMENTATION:
        assert sorted(_python_code(before).split()) == sorted(_python_code(after).split())
    elif impact is Impact.COMPATIBLE:
        assert _public_names(before) <= _public_names(after)


def _public_names(module: str) -> set[str]:
    """Return the top-level names of a module and the names of its classes' members."""
    names = set()
    for node in ast.parse(module).body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            names.add(node.name)
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names.add(node.target.id)
        if isinstance(node, ast.ClassDef):
            members = (statement.target for statement in node.body if isinstance(statement, ast.AnnAssign))
            names |= {f"{node.name}.{target.id}" for target in members if isinstance(target, ast.Name)}
    return {name for name in names if not name.startswith("_")}


@pytest.mark.slow
def test_explain() -> None:
    assert explain("register-gone") == (
        "register-gone: a register was removed.\n"
        "  C       breaking\n"
        "  Python  breaking\n"
        "  XML     breaking\n"
        "  pages   documentation\n"
        "  Its names in C and Python and its element in the XML no longer exist. Code\n"
        "  that uses them no longer builds."
    )
    assert all(rule.name in explain(None) for rule in RULES.values())
    assert max(map(len, explain(None).splitlines())) <= 80
    with pytest.raises(CommandError, match="there is no rule 'register-goen'; did you mean 'register-gone'"):
        explain("register-goen")
    with pytest.raises(CommandError, match="there is no rule 'unknown-kee'; did you mean 'unknown-key'"):
        explain("unknown-kee")
