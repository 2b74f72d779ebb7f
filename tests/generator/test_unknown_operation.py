"""An operation that an output does not know is refused by it, wherever it is matched, and never silently dropped."""

from __future__ import annotations

import ast
import importlib
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast, get_args

import pytest
from codewheel.loading.library import load_library
from codewheel.model import Fault, Field, Kind, Layout
from codewheel.plan import values
from codewheel.plan.codec import layout_plan_of
from codewheel.plan.frame_checks import bits_of
from codewheel.plan.limits import _field_refusals
from codewheel.plan.operations import FieldBits
from codewheel.targets import Library, Target
from codewheel_runtime.bulk import decode as bulk_decode
from codewheel_runtime.bulk import encode as bulk_encode
from codewheel_runtime.bulk.shape import Column, FrameLayout, list_column_types
from codewheel_runtime.frames import encode as frame_encode

ROOT = Path(__file__).parents[2]
#: Specs that between them have every operation, registers, examples and parameters that registers hold.
SPECS = (
    "tests/c/specs/edges.yaml",
    "tests/c/specs/shapes.yaml",
    "tests/c/specs/words.yaml",
    "tests/specs/words.yaml",
    "specs/lika/amm5.yaml",
)
#: Outputs, the package of each, and the module of its target.
OUTPUTS = {
    "c": ("codewheel.targets.c", "codewheel.targets.c.files"),
    "rust": ("codewheel_rust", "codewheel_rust"),
    "biss": ("codewheel.targets.biss", "codewheel.targets.biss.files"),
    "python": ("codewheel.targets.python", "codewheel.targets.python.files"),
    "browser": ("codewheel.plan.description", "codewheel.targets.browser.files"),
}
Place = tuple[str, str]
#: Functions that ask for one operation, by module and name: for texts, named values or signed numbers. They treat all
#: others alike, so another function of the same output must refuse an unknown operation.
ASKING = {
    "c": {
        ("about", "about_member"),
        ("decode", "fields_with_local"),
        ("device", "_is_read_twice"),
        ("encode", "_unsigned_bits_of_member"),
        ("encode", "member_as_number"),
        ("context", "__init__"),
        ("examples", "request_for_reply"),
        ("examples", "is_signed"),
        ("worked_examples", "printed_members"),
        ("registers", "_is_byte"),
        ("registers", "_fields_with_masks"),
        ("registers", "has_shift"),
        ("selftest", "_expected_member"),
        ("structs", "_check_supported"),
        ("structs", "member_declarator"),
        ("structs", "type_of"),
    },
    "rust": {("family", "width_problems")},
    # Its files say only whether a status bit is active low. They convert no values.
    "biss": {("data_channels", "_active_level")},
    "python": {
        ("codec", "_field_attributes"),
        ("codec", "usable_position"),
        ("decode", "_add_values"),
        ("decode", "_place_comment"),
        ("facts", "_field_record"),
        ("first_byte", "_codes_by_first_byte"),
        ("procedures", "members"),
        ("facts", "record_of_held_parameter"),
    },
    "browser": set[Place](),
}

TRUE = values.meaning_of


@dataclass(frozen=True)
class Unknown:
    """An operation that is in no union."""


def target_of(output: str) -> Target:
    target = importlib.import_module(OUTPUTS[output][1]).TARGET
    assert isinstance(target, Target)
    return target


@cache
def library(spec: str) -> Library:
    devices, report = load_library([ROOT / spec])
    assert devices
    assert not report
    return Library(devices)


def render(output: str) -> None:
    target = target_of(output)
    options = {option.name: option.default for option in target.options}
    for spec in SPECS:
        # Targets remember their results for a family, so each rendering needs its own families.
        assert target.files(Library(tuple(map(replace, library(spec).devices))), options)


def replace_meaning_of(monkeypatch: pytest.MonkeyPatch, output: str, meant: Callable[[Field, Place], object]) -> None:
    """Replace ``meaning_of`` everywhere. ``meant`` also gets the module and the function of the output that calls it.

    Calls from other packages get the true operation.
    """
    package = OUTPUTS[output][0]

    def meaning_by_caller(field: Field) -> object:
        frame = sys._getframe(1)
        # Comprehensions and the property ``meaning`` of the plan belong to the function that contains them.
        while frame.f_code.co_name.startswith("<") or frame.f_code.co_name == "meaning":
            assert frame.f_back is not None
            frame = frame.f_back
        module = str(frame.f_globals["__name__"])
        if not f"{module}.".startswith(f"{package}."):
            return TRUE(field)
        return meant(field, (module.removeprefix(f"{package}."), frame.f_code.co_name))

    for module in list(sys.modules.values()):
        if getattr(module, "meaning_of", None) is TRUE:
            monkeypatch.setattr(module, "meaning_of", meaning_by_caller)


@pytest.mark.slow
@pytest.mark.parametrize("output", OUTPUTS)
def test_an_unknown_operation_is_refused(output: str, monkeypatch: pytest.MonkeyPatch) -> None:
    target_of(output)
    places: set[Place] = set()
    with monkeypatch.context() as patch:

        def note_place(field: Field, place: Place) -> object:
            places.add(place)
            return TRUE(field)

        replace_meaning_of(patch, output, note_place)
        render(output)
    assert places > ASKING[output] or places == ASKING["biss"]
    for chosen in sorted(places - ASKING[output]):
        with monkeypatch.context() as patch:
            replace_meaning_of(
                patch, output, lambda field, place, chosen=chosen: Unknown() if place == chosen else TRUE(field)
            )
            with pytest.raises(AssertionError, match="no case for Unknown"):
                render(output)


@dataclass(frozen=True)
class UnknownCheck:
    """A check or refusal that is in no union."""

    field: Field
    bits: FieldBits
    fault = Fault.RANGE


def test_the_plan_decides_which_bits_of_an_unknown_operation_have_a_value(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a check in the plan, C and NumPy would accept bits without a value, such as digits above 9."""
    device = library(SPECS[0]).devices[0]
    monkeypatch.setattr("codewheel.plan.operations.meaning_of", lambda _: Unknown())
    with pytest.raises(AssertionError, match="no case for Unknown"):
        layout_plan_of(device, next(layout for _, layout in device.layouts()))


@pytest.mark.parametrize("output", ["c", "rust"])
def test_an_unknown_check_is_refused(output: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown_checks(layout: Layout) -> Iterator[UnknownCheck]:
        yield from (UnknownCheck(field, bits_of(layout, field)) for field in layout.data_fields)

    monkeypatch.setattr("codewheel.plan.frame_checks._checks_of_values", unknown_checks)
    with pytest.raises(AssertionError, match="no case for UnknownCheck"):
        render(output)


@pytest.mark.parametrize("output", ["c", "rust"])
def test_an_unknown_refusal_is_refused(output: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the code that prints it. A limit that depends on the order code is refused earlier, by the plan."""

    def unknown_checks(layout: Layout, field: Field) -> Iterator[UnknownCheck]:
        yield UnknownCheck(field, bits_of(layout, field))

    monkeypatch.setattr("codewheel.plan.limits._field_refusals", unknown_checks)
    monkeypatch.setattr("codewheel.targets.c.codec.depends_on_order_code", lambda _: False)
    with pytest.raises(AssertionError, match="no case for UnknownCheck"):
        render(output)


#: Decisions about a field that depend on its kind.
DECISIONS: dict[str, Callable[[Layout, Field], object]] = {
    "meaning": lambda layout, field: values.meaning_of(field),
    "refusals": lambda layout, field: list(_field_refusals(layout, field)),
}
#: Facts that every kind states, so that no module needs a list of kinds to know them.
FACTS_OF_KINDS = ("word", "role", "is_joinable", "value_at_rest", "makes_position", "digit_code")


@pytest.mark.parametrize("decision", DECISIONS)
def test_an_unknown_kind_is_refused(decision: str) -> None:
    devices, _ = load_library([ROOT / SPECS[0]])
    layout, field = next((layout, field) for _, layout in devices[0].layouts() for field in layout.fields)
    with pytest.raises(AssertionError, match="no case for Unknown"):
        DECISIONS[decision](layout, replace(field, kind=Unknown()))


@pytest.mark.parametrize("kind", get_args(Kind))
def test_every_kind_states_the_facts_of_kinds(kind: type) -> None:
    assert [name for name in FACTS_OF_KINDS if not hasattr(kind, name)] == []


LEVEL = Column("level", 0, 8, value_kind=cast("Any", "unknown"))
#: Parts of the Python runtime that go by the kind of a column.
INTERPRETERS: dict[str, Callable[[], object]] = {
    "types": lambda: list_column_types(FrameLayout(8, columns=(LEVEL,))),
    "encode": lambda: frame_encode._encode_field(SimpleNamespace(level=1), LEVEL),
    "decode_many": lambda: bulk_decode._write_field(cast("Any", None), LEVEL, {}),
    "encode_many": lambda: list(bulk_encode._encode_field({"level": [1]}, LEVEL, cast("Any", None))),
}


@pytest.mark.parametrize("part", INTERPRETERS)
def test_an_unknown_kind_of_column_is_refused(part: str) -> None:
    with pytest.raises(AssertionError, match="no case for 'unknown'"):
        INTERPRETERS[part]()


#: Outputs that look at no kind, the folder of the source of each, and the folder of its templates.
WITHOUT_KINDS = {
    "c": ("generator/targets/c", "templates/c"),
    "rust": ("examples/rust-target/codewheel_rust", "examples/rust-target/codewheel_rust/templates"),
    "biss": ("generator/targets/biss", "templates/biss"),
    "docs": ("generator/targets/docs", "templates/docs"),
}
_KINDS = {kind.__name__ for kind in get_args(Kind)} | {"Kind", "kinds"}
_MODEL = re.compile(r"(codewheel|\.*)\.?model(\.kinds)?")


def names_from_model(path: Path) -> set[str]:
    """Return the names that a module imports from the model."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and _MODEL.fullmatch(f"{'.' * node.level}{node.module or ''}"):
            names |= {alias.name for alias in node.names}
    return names


@pytest.mark.slow
@pytest.mark.parametrize("output", WITHOUT_KINDS)
def test_no_output_looks_at_kinds(output: str) -> None:
    source, templates = (ROOT / folder for folder in WITHOUT_KINDS[output])
    modules = {path: names_from_model(path) for path in source.rglob("*.py")}
    assert "Device" in set().union(*modules.values())
    assert {path.name: names & _KINDS for path, names in modules.items() if names & _KINDS} == {}
    test_names = (re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower() for name in _KINDS)
    attribute_pattern = r"\bfield\.kind\b|\.kind\.|\.number\.(signed|zero_means)\b"
    template_pattern = rf"\bis (not )?({'|'.join(test_names)})\b|{attribute_pattern}"
    pattern_by_file = dict.fromkeys(source.rglob("*.py"), attribute_pattern)
    pattern_by_file |= dict.fromkeys(templates.glob("*.jinja"), template_pattern)
    text_by_file = {path: path.read_text(encoding="utf-8") for path in pattern_by_file}
    assert [path.name for path, pattern in pattern_by_file.items() if re.search(pattern, text_by_file[path])] == []
