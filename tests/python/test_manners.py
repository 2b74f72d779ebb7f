"""Conventions of Python packages: frames are values, errors name their frame, and modules begin with a list."""

from __future__ import annotations

import ast
import copy
import pickle
import random
import re
import sys
from collections.abc import Mapping
from typing import Any

import pytest
from codewheel.reference import codec
from test_agreement import FAMILIES, Case, Family, arguments_of, cases, families, family, values_of

__all__ = ["families", "family"]

#: Number of lines of a screen.
SCREEN = 40


# The first screen


#: Modules that belong to no family.
SHARED = {"biss"}


def modules(files: Mapping[str, str]) -> dict[str, str]:
    module_path = re.compile(r"python/lika_encoders/([a-z]\w+)\.py")
    matches = {match[1]: match[0] for match in map(module_path.fullmatch, files) if match is not None}
    return {name: files[path] for name, path in matches.items() if name not in SHARED}


def names_in(text: str) -> set[str]:
    """Return the names in the contents of a module, which must fit on its first screen."""
    screen = "\n".join(text.splitlines()[:SCREEN])
    listed = re.search(r"\nContents:\n(.*?)\n\n", screen, re.DOTALL)
    assert listed is not None
    groups = re.split(r"\n    (?=\S)", "\n" + listed[1])
    return {name for group in groups if group for name in re.findall(r"\w+", group.partition(": ")[2])}


@pytest.mark.slow
def test_the_first_screen_names_all_that_a_module_holds(files: Mapping[str, str]) -> None:
    """This does not use ``__all__``, which comes from the same list, but the names in the module."""
    assert set(modules(files)) == {"am36", "amm5", "asc85", "sma21"}
    for name, text in modules(files).items():
        tree = ast.parse(text)
        names = {node.name for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        for node in tree.body:
            if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                names.add(node.target.id)
        facts = ast.parse(files[f"python/lika_encoders/facts/{name}.py"])
        names |= {node.target.id for node in facts.body if isinstance(node, ast.AnnAssign)}  # type: ignore[union-attr]
        assert names_in(text) == {public for public in names if not public.startswith("_")}, name


# Frames are values


def one_of_each(family: Family) -> list[tuple[Case, Any]]:
    """Return a frame or register of each class."""
    source = random.Random(family.device.name)
    examples: dict[str, tuple[Case, Any]] = {}
    for case in cases(family):
        if case.view.__name__ not in examples:
            number = codec.encode(case.family.device, case.placed, values_of(case, "random", source))
            examples[case.view.__name__] = (case, case.view.decode(case.carried(number), *arguments_of(case)))
    return [*examples.values()]


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES, indirect=True)
def test_frames_are_values(family: Family) -> None:
    frames = one_of_each(family)
    assert frames
    for case, frame in frames:
        for again in (pickle.loads(pickle.dumps(frame)), copy.copy(frame), copy.deepcopy(frame)):
            assert (again, type(again), hash(again)) == (frame, type(frame), hash(frame))
        if not hasattr(type(frame), "_fields"):
            # A single choice is an enumeration, and is shown as such.
            assert repr(frame).startswith(f"<{type(frame).__name__}.")
            continue
        names = frame._fields
        members = ", ".join(f"{name}={getattr(frame, name)!r}" for name in names)
        assert repr(frame) == f"{type(frame).__name__}({members})"
        assert case.variant.code in repr(frame) or "variant" not in names
        # Frames of different classes with equal values are not equal.
        subclass_frame = type("Other", (type(frame),), {})(*frame)
        assert frame not in (tuple(frame), subclass_frame)
        assert len({frame, tuple(frame), type(frame)(*frame)}) == 2


@pytest.mark.slow
def test_match_takes_a_frame_by_class_and_keyword(families: dict[str, Family]) -> None:
    amm5 = families["amm5"].module
    encoder = amm5.lookup("AMM5A23/65KJP1")

    def kind_or_count(frame: object) -> object:
        match frame:
            case amm5.MultiturnReply():
                return "multiturn"
            case amm5.SingleturnReply(singleturn=0):
                return "zero"
            case amm5.SingleturnReply(singleturn=count, status_st_error=False):
                return count
            case _:
                return None

    assert kind_or_count(encoder.decode(bytes.fromhex("02 00 15 CD 5B 81"))) == 6016277
    assert kind_or_count(tuple(encoder.decode(bytes.fromhex("02 00 15 CD 5B 81")))) is None


# Errors name their frame


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES, indirect=True)
def test_errors_say_which_frame_of_which_encoder(family: Family) -> None:
    """For each interface, and also after passing through another process."""
    interfaces = set()
    for case in cases(family):
        in_bytes = case.layout.carried_as == "bytes"
        if case.register is not None or case.layout.sender != "encoder" or (case.answers and in_bytes):
            continue
        damaged: Any = b"\x00" if in_bytes else (1 << case.placed.bits) | 1
        alternatives = family.device.alternatives_of(case.layout)
        with pytest.raises(ValueError) as caught:
            case.encoder.decode(
                damaged,
                **{alternative.name: answer for alternative, answer in zip(alternatives, case.answers, strict=True)},
            )
        for error in (caught.value, pickle.loads(pickle.dumps(caught.value))):
            assert (error.frame, error.order_code, error.encoder) == (damaged, case.variant.code, case.encoder)
            assert isinstance(error.hint, str)
            assert str(error)
        interfaces.add(case.variant.interface)
    assert interfaces == {variant.interface for variant in family.device.variants}


@pytest.mark.slow
def test_a_hint_names_the_mistake(families: dict[str, Family]) -> None:
    """A frame with swapped wires arrives with each bit inverted. Its CRC is correct once they are inverted again."""
    encoder = families["amm5"].module.lookup("AMM5A21/65KSC1")
    with pytest.raises(ValueError) as caught:
        encoder.decode(0x55BCD15E2 ^ (1 << 45) - 1)
    assert "inverted" in caught.value.hint or "swapped" in caught.value.hint


# Documentation of the package


@pytest.mark.slow
def test_importing_it_says_nothing(families: dict[str, Family], capsys: pytest.CaptureFixture[str]) -> None:
    """A library writes to its logger, and leaves the output to the program."""
    import logging

    assert logging.getLogger("codewheel_runtime").handlers == []
    assert logging.getLogger("codewheel_runtime").level == logging.NOTSET
    assert sys.modules["lika_encoders"].__doc__
    assert capsys.readouterr() == ("", "")
