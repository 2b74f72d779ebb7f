"""Names of a spec with another meaning in generated Python: the package imports, every codec and function works."""

from __future__ import annotations

import ast
import builtins
import json
import keyword
import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from codewheel.loading.library import load_library
from codewheel.model import Choice, Decimal, Device, Flag, Layout, Number, Variant, number_to_bytes
from codewheel.reference.bits_and_values import join_value, to_binary
from codewheel.reference.codec import encode
from codewheel.targets import Library
from codewheel.targets.python import names
from codewheel.targets.python.files import generate
from codewheel_runtime.frames import descriptions
from exhaustive import mostly_exhaustive
from hostile_specs import BISS_CLOCK, HEAD, Item, crc, digits, flag, layout_of, sums

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
NAME = re.compile(r"[a-z][a-z0-9]*(?:_[a-z0-9]+)*")
#: Names of the made-up spec itself, which must differ from the words.
_OWN = re.compile(r"own_\w+|crc_own|from_own_position|own")


def words(folder: Path) -> list[str]:
    """Return every identifier of a package for the spec below, every member of the runtime's classes, and of Python."""
    identifiers = {*keyword.kwlist, *dir(builtins), *dir(tuple), *dir(dict)}
    identifiers |= {*names.VARIANT_NAMES, *names.CLASS_NAMES, *names.LOCAL_NAMES, *names.PROCEDURE_NAMES}
    for name, text in generate(Library(_devices(["own_one", "own_two"], folder))).items():
        tree: ast.AST = ast.parse(text) if name.endswith(".py") else ast.Module([], [])
        inside = "/runtime/" in name
        nodes = list(ast.walk(tree))
        if inside:
            classes = [node for node in nodes if isinstance(node, ast.ClassDef)]
            nodes = [node for class_node in classes for node in class_node.body]
        identifiers |= {word for node in nodes for word in _identifiers(node)}
    # BiSS defines the meaning of error and warning.
    names_of_specs = filter(NAME.fullmatch, identifiers - {"error", "warning"})
    accepted = {name for name in names_of_specs if not _OWN.fullmatch(name)}
    return sorted(accepted | {"from_own_position", "own_preset_limits", "crc_own", "crc_own_of_bits"})


def _identifiers(node: ast.AST) -> Iterator[str]:
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name) | ast.arg(arg=name) | ast.keyword(arg=str(name)):
            yield name
        case ast.FunctionDef(name=name) | ast.ClassDef(name=name) | ast.AnnAssign(target=ast.Name(id=name)):
            yield name
        case ast.Assign(targets=targets):
            yield from (target.id for target in targets if isinstance(target, ast.Name))
        case ast.alias(name=name, asname=alias):
            yield (alias or name).partition(".")[0]
        case ast.Constant(value=str(name)):
            yield name  # Slots, members of __all__, and keys.


def hostile(words: list[str]) -> Item:
    """Return a spec with each word as a field in every role, a joined number, a parameter and an argument."""
    layouts = [layout for index, word in enumerate(words) for layout in _layouts(index, word)]
    sets = {size: {"own_bits": size, **dict.fromkeys(words[::2], size)} for size in (3, 5)}
    sizes = {str(size): {"interface": "biss", "sets": parameters} for size, parameters in sets.items()}
    return {
        **HEAD,
        "parameters": {
            "own_bits": {"meaning": "Width"},
            "own_gray": {"meaning": "Gray", "read_from": "own_setting.own_gray", "min": 0, "max": 1},
            **{word: {"meaning": "A word"} for word in words[::2]},
            **sums(words[1::2], words[::2]),
        },
        "order_code": {
            "pattern": "H{size}",
            "source": "1",
            "parts": [{"name": "size", "meaning": "Size", "values": sizes}],
        },
        "crcs": [crc("own", width=6, poly=7, xorout=1), crc("own_8", width=8, poly=7, xorout=1)],
        "interfaces": {"biss": {"source": "1", "clock": BISS_CLOCK, "layouts": layouts}},
        "measurement": {"of": words[0], "counts_per_turn": "2^own_bits", "turns": 1, "source": "1"},
        "registers": _registers(words),
        "procedures": [_procedure(index, word) for index, word in enumerate(words)],
    }


def _layouts(index: int, word: str) -> Iterator[Item]:
    """Return a layout for each role that a field of this name can have."""
    check = {"name": "own_crc", "crc": "own"}
    high, low = {"name": "own_high", "bits": 4}, {"name": "own_low", "bits": 4}
    wide = {"name": word, "bits": "own_bits"}
    choice = {"name": word, "bits": 6, "values": {"one": {"value": 1}, "two": {"value": 2}}}
    yield layout_of(f"own_choice_{index}", choice, flag("own_flag", "low"), check)
    yield layout_of(f"own_digits_{index}", digits(word, "own_high", "own_low"), check)
    steps = {"name": "own_steps", "bits": 4, "zero_means": 16}
    yield layout_of(f"own_sign_{index}", {**wide, "signed": True}, steps)
    join = {"own_position": [word, "own_low"]}
    gray = {"of": "own_position", "when": "own_gray"}
    yield layout_of(f"own_join_{index}", wide, low, flag("own_flag", "high"), join=join, gray=gray)
    join = {word: ["own_high", "own_low"]}
    yield layout_of(f"own_number_{index}", high, low, flag("own_flag", "high"), join=join)
    join = {"own_position": ["own_high", "own_low"]}
    yield layout_of(f"own_beside_{index}", high, low, {"name": word, "bits": 6}, join=join)
    fields = ({**wide, "padded_to": 16}, {"name": "own_crc", "crc": "own_8"})
    yield layout_of(f"own_bytes_{index}", *fields, carried_as="bytes", byte_order="low_byte_first")
    # The first word is a measurement and not a flag. No field may have the name of the number of all unused bits.
    reporting_flag = {"name": word if index else "own_told", "active": "low", "makes_position": "not_usable"}
    summed = {
        "name": "own_flag",
        "active": "high",
        "makes_position": "not_usable",
        "sums_up": [reporting_flag["name"]],
    }
    spare = [] if word == "unused" else [{"name": "own_spare", "bits": 3, "unused": 5}]
    join = {"own_position": ["own_high", "own_low"]}
    yield layout_of(f"own_told_{index}", high, low, reporting_flag, summed, *spare, check, join=join)


def _registers(words: list[str]) -> list[Item]:
    register = {"length": 1, "access": "read_write", "source": "1"}
    modes = {"name": "own_mode", "at": "1:0", "values": {"one": {"value": 1}, "two": {"value": 2}}}
    setting = {"default": 1, "other_bits": "zero", "fields": [modes, {"name": "own_gray", "at": 2}]}
    limits: list[Item] = [
        {"name": "own_preset", "when": "own_setting.own_mode", "is": "one", "max": "2^own_bits - 1"},
        {"name": "own_offset", "when": "own_setting.own_mode", "is": "two", "max": 9},
    ]
    return [
        {**register, "name": "own_setting", "address": 0x3C, **setting},
        {**register, "name": "own_number", "address": 0x3D},
        *(_preset(index, word, limits) | register for index, word in enumerate(words)),
    ]


def _preset(index: int, word: str, limits: list[Item]) -> Item:
    fields = [{"name": word, "at": "6:0"}, {"name": "own_top", "at": 7}]
    return {"name": f"own_preset_{index}", "address": index, "meanings": limits, "fields": fields}


def _procedure(index: int, word: str) -> Item:
    return {
        "name": f"own_set_{index}",
        "title": "Set",
        "interface": "biss",
        "source": "1",
        "arguments": [
            {"name": word, "of": f"own_preset_{index}", "as": "own_preset"},
            {"name": "own_other", "of": "own_number"},
        ],
        "steps": [
            {"do": "write", "register": f"own_preset_{index}", "field": word, "value": word},
            {"do": "write", "register": "own_number", "value": "own_other"},
        ],
    }


def _devices(words: list[str], folder: Path) -> tuple[Device, ...]:
    shutil.copy(ROOT / "tests" / "specs" / "manufacturer.yaml", folder)
    (folder / "hostile.yaml").write_text(json.dumps(hostile(words), indent=1), encoding="utf-8")
    devices, report = load_library([folder / "hostile.yaml"])
    assert [problem.format() for problem in report.problems] == []
    return devices


@pytest.mark.parametrize("part", mostly_exhaustive(range(16), 0))
def test_no_name_of_a_spec_is_one_that_the_package_has(
    part: int, tmp_path: Path, import_generated: Callable[..., Any]
) -> None:
    (tmp_path / "words").mkdir()
    words_of_part = words(tmp_path / "words")[part::16]
    assert len(words_of_part) > 15
    # A word has eight layouts, and an interface at most 256.
    # The packages have nearly equal sizes, because a single word would leave a parameter of the spec unused.
    package_count = -(-len(words_of_part) // 32)
    for index in range(package_count):
        _check_package(words_of_part[index::package_count], tmp_path / str(index), import_generated)


def _check_package(hostile_words: list[str], folder: Path, import_generated: Callable[..., Any]) -> None:
    folder.mkdir()
    devices = _devices(hostile_words, folder)
    package = import_generated(Library(devices), "test_encoders")[1]
    module = package.hostile
    for variant in devices[0].variants[-1:]:
        encoder = package.lookup(variant.code)
        for _, layout in devices[0].layouts():
            _check_round_trip(devices[0], layout, variant, module, encoder)
        for index, word in enumerate(hostile_words):
            steps = getattr(module, f"own_set_{index}")(encoder, 5, 9)
            assert len(steps) == 2, word
            with pytest.raises(ValueError):
                getattr(module, f"own_set_{index}")(encoder, 2 ** variant.parameters["own_bits"], 9)
        assert encoder.turns(3) > 0
        # Some of its frames have signed positions, so their ranges differ.
        kinds = [kind for kind in descriptions.find_kinds(encoder) if hasattr(kind, "usable_position")]
        assert kinds
        assert {encoder.range_of(kind).unwrap(0, 1) for kind in kinds} == {1}


def _check_round_trip(device: Device, layout: Layout, variant: Variant, module: Any, encoder: Any) -> None:
    """A frame of the model decodes to the model's numbers and encodes to the same frame.

    This also holds for a register built from a joined number.
    """
    values_by_kind: dict[type, int | str | bool] = {Choice: "two", Flag: True, Decimal: 1234}
    values: dict[str, int | str | bool] = {}
    for field in layout.data_fields:
        # A position of 32 counts in two fields of 4 bits has at most a 1 in the high one.
        number_value = 1 if field.name == "own_high" else 3
        values[field.name] = values_by_kind.get(type(field.kind), number_value)
    placed = layout.place(variant.parameters)
    number = encode(device, placed, values)
    wire = number_to_bytes(layout, number, placed.bits) if layout.carried_as == "bytes" else number
    frame_class = getattr(module, "".join(part.title() for part in layout.name.split("_")))
    frame = frame_class.decode(wire, encoder) if "variant" in frame_class._fields else frame_class.decode(wire)
    assert frame.encode() == wire
    for field in layout.data_fields:
        if isinstance(field.kind, Number):
            assert _attribute_of(frame, field.name) == values[field.name], (layout.name, field.name)
    assert len(frame.reports) == (2 if layout.name.startswith("own_told") else 0), layout.name
    for join in layout.joins:
        whole = join_value(placed, join, to_binary(placed, number))
        assert _attribute_of(frame, join.name) == whole
        joined = {f"{name}_" if f"{name}_" in frame_class._fields else name for name in join.fields}
        other_members = {name: getattr(frame, name) for name in frame_class._fields if name not in joined}
        build = getattr(frame_class, f"from_{join.name}", None)
        if not callable(build):
            build = getattr(frame_class, f"from_{join.name}_")
        assert build(**other_members, **{_argument_name(build, join.name): whole}) == frame


def _argument_name(build: Any, name: str) -> str:
    names: tuple[str, ...] = build.__func__.__code__.co_varnames[1:]
    return name if name in names else f"{name}_"


def _attribute_of(frame: Any, name: str) -> Any:
    """Return the attribute with this name, or with a trailing underscore."""
    return getattr(frame, f"{name}_") if f"{name}_" in dir(frame) else getattr(frame, name)
