"""The schemas, their messages, and the rest of a spec after its errors are cut out."""

from __future__ import annotations

import copy
import pathlib
import random
from collections.abc import Iterator
from typing import Any

import pytest
import yaml
from codewheel.language.check import check_document
from codewheel.language.document import Document
from codewheel.language.files import is_second, is_word_sheet
from codewheel.language.messages import KEYWORDS, PATTERNS, explain
from codewheel.language.problems import MAX_PROBLEMS, ProblemReport
from codewheel.language.read import read_document
from codewheel.language.schema_check import FileKind, check_schema
from codewheel.language.schemas import follows_schema, load_schema, schema_without_references
from codewheel.loading.device import build_device
from codewheel.model import Manufacturer
from jsonschema import Draft202012Validator

MAKER = Manufacturer("acme", "Acme", None, "acme_encoders", "0.0.0", ())
MINIMAL = pathlib.Path(__file__).parent / "ok" / "minimal.yaml"
EVERY = sorted((pathlib.Path(__file__).parents[2] / "specs").glob("*/*.yaml"))
SPECS = [path for path in EVERY if not (is_second(path) or is_word_sheet(path))]
KINDS = ("device", "manufacturer", "master")
SILENT = {"$schema", "$id", "$ref", "$defs", "title", "description", "properties", "items"}


def subschemas(schema: Any) -> Iterator[dict[str, Any]]:
    if isinstance(schema, dict):
        yield schema
        for key, value in schema.items():
            for subschema in value.values() if key in ("properties", "$defs") else (value,):
                yield from subschemas(subschema)


def read_spec(folder: pathlib.Path, text: str) -> tuple[Document, ProblemReport]:
    path = folder / "minimal.yaml"
    path.write_text(text, encoding="utf-8")
    report = ProblemReport()
    spec = read_document(path, report, path.name)
    assert spec is not None
    return spec, report


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_schema_is_one_and_each_keyword_has_words(kind: str) -> None:
    schema = load_schema(kind)
    Draft202012Validator.check_schema(schema)
    for subschema in subschemas(schema):
        assert set(subschema) <= KEYWORDS | SILENT
        pattern = subschema.get("pattern", "^$")
        # Patterns must match the whole text, as their anchors say.
        assert pattern.startswith("^")
        assert pattern.endswith("$")
        assert pattern == "^$" or pattern in PATTERNS


@pytest.mark.parametrize("kind", KINDS)
def test_every_property_has_a_description(kind: str) -> None:
    for subschema in subschemas(load_schema(kind)):
        for name, content in subschema.get("properties", {}).items():
            target = load_schema(kind)["$defs"][content["$ref"].split("/")[-1]] if "$ref" in content else {}
            assert "description" in content or "description" in target, name


def test_faults_are_cut_out_and_the_rest_keeps_its_lines(tmp_path: pathlib.Path) -> None:
    valid_register = '  - {name: %s, address: %d, length: 1, access: read_write, source: "6.3"}\n'
    broken_register = "  - {name: bad, address: 65, length: 1}\n"
    text = (
        MINIMAL.read_text()
        + broken_register
        + valid_register % ("one", 80)
        + broken_register
        + valid_register % ("two", 80)
    )
    spec, report = read_spec(tmp_path, text)
    checked = check_schema(spec, report)
    assert checked is not None
    assert [register["name"] for register in checked.data["registers"]] == ["bank", "one", "two"]
    last = text.splitlines().index((valid_register % ("two", 80)).rstrip()) + 1
    assert spec.position(("registers", 2, "name"))[0] == last
    assert check_document(spec, ProblemReport()) is not None


def test_misspelt_key_is_one_problem(tmp_path: pathlib.Path) -> None:
    spec, report = read_spec(tmp_path, MINIMAL.read_text().replace("alias", "").replace("poly:", "polly:"))
    check_document(spec, report)
    assert [problem.message for problem in report.problems] == ["unknown key 'polly'; did you mean 'poly'?"]


@pytest.mark.slow
def test_endless_problems_end(tmp_path: pathlib.Path) -> None:
    spec, report = read_spec(tmp_path, MINIMAL.read_text() + "".join(f"key_{index}: 1\n" for index in range(1000)))
    assert check_document(spec, report) is None
    assert len(report) == MAX_PROBLEMS + 1
    last = [problem for problem in report.problems if problem.rule == "too-many-problems"]
    assert [problem.message for problem in last] == [
        "there are more problems from here on; they are reported once these are fixed"
    ]


@pytest.mark.slow
def test_a_spec_full_of_faults_is_read_no_further_than_it_is_told(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    explained: list[object] = []

    def count_explanation(error: Any, kind: str) -> Any:
        explained.append(error)
        return explain(error, kind)

    monkeypatch.setattr("codewheel.language.schema_check.explain", count_explanation)
    spec, report = read_spec(
        tmp_path, MINIMAL.read_text() + "".join(f"  - {{name: r{index}, adress: {index}}}\n" for index in range(5000))
    )
    assert check_document(spec, report) is None
    assert len(report) == MAX_PROBLEMS + 1
    assert len(explained) < 3 * MAX_PROBLEMS


def paths_in(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if not isinstance(data, dict | list):
        return
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        yield (*path, key)
        yield from paths_in(value, (*path, key))


def damaged_copies(data: Any, seed: str) -> Iterator[Any]:
    """Yield copies of data in which random places are removed or replaced."""
    choose = random.Random(seed)
    spots = list(paths_in(data))
    junk: list[Any] = [None, -1, 2**70, 1.5, True, "", "x", "a.b", "é\n", [], ["x"], {}, {"name": "x"}, [{}], [[1]]]
    for _ in range(25):
        damaged_data = copy.deepcopy(data)
        for spot in choose.sample(spots, choose.randint(1, 3)):
            node: Any = damaged_data
            try:
                for step in spot[:-1]:
                    node = node[step]
                if choose.random() < 0.3:
                    del node[spot[-1]]
                else:
                    node[spot[-1]] = choose.choice(junk)
            except (KeyError, IndexError, TypeError):
                continue  # Earlier damage removed the place.
        yield damaged_data


EACH = pytest.mark.parametrize(
    "path",
    [MINIMAL, *(pytest.param(path, marks=pytest.mark.slow) for path in SPECS)],
    ids=lambda path: path.stem,
)


@pytest.mark.one_in(30, "exhaustive")
@EACH
def test_no_damage_makes_it_raise(path: pathlib.Path) -> None:
    """Remove or replace random places of a valid spec. The result is problems or a valid spec, never an exception."""
    sound = read_document(path, ProblemReport())
    assert sound is not None
    for data in damaged_copies(sound.data, path.stem):
        # It is checked as data. The marks come from the valid spec, since they only give places.
        damaged_spec, report = Document(path.name, sound.lines, data, sound.marks), ProblemReport()
        accepted = check_document(damaged_spec, report)
        if accepted is not None and "device" in accepted:
            build_device(accepted, MAKER, report.for_document(damaged_spec))
        for problem in report.problems[:50]:
            assert problem.format()


@pytest.mark.one_in(20, "exhaustive")
@EACH
def test_the_quick_test_agrees_with_jsonschema(path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It accepts each valid spec, so that jsonschema is not imported, and nothing that jsonschema rejects."""
    sound = read_document(path, ProblemReport())
    assert sound is not None
    kind = next(kind for kind in (FileKind.DEVICE, FileKind.MASTER, FileKind.MANUFACTURER) if kind.value in sound.data)
    shape = schema_without_references(kind.value)
    assert follows_schema(sound.data, shape)
    copies = [sound.data, *damaged_copies(sound.data, path.stem)]
    answers = [follows_schema(data, shape) for data in copies]
    monkeypatch.setattr("codewheel.language.schema_check.follows_schema", lambda value, schema: False)
    for data, answer in zip(copies, answers, strict=True):
        report = ProblemReport()
        check_schema(Document(path.name, sound.lines, data, sound.marks), report, kind)
        assert answer == (not report.problems)


class _Hexadecimal(yaml.SafeDumper):
    """Write integers in hexadecimal."""


_Hexadecimal.add_representer(
    int, lambda dumper, number: dumper.represent_scalar("tag:yaml.org,2002:int", f"{number:#x}")
)


def test_spec_written_by_a_machine(tmp_path: pathlib.Path) -> None:
    """Block style instead of flow style, with numbers as 0x: the same data, and the same check."""
    spec, _ = read_spec(tmp_path, MINIMAL.read_text())
    again, report = read_spec(tmp_path, yaml.dump(spec.data, Dumper=_Hexadecimal, sort_keys=False))
    check_document(again, report)
    assert report.problems == ()
