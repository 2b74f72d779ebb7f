"""Target of codewheel for Rust: a no_std crate for each manufacturer, with a module for each family."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, TypedDict

from codewheel.model import Device, Manufacturer, assert_never
from codewheel.plan.codec import characters
from codewheel.plan.description import describe
from codewheel.plan.limits import Refusal, refusals
from codewheel.plan.operations import Check, ConstantNumber, ParityOf, ReservedBits, ValueOfField
from codewheel.render import Templates, tests_for
from codewheel.say.layout import describe_crc
from codewheel.say.order_code import describe_order_code, describe_parameter
from codewheel.say.register import describe_value
from codewheel.targets import Library, Option, Options, Target, TargetProblem

from . import about, names, spelling, verdicts
from .family import Family, crc_name


class Crate(TypedDict):
    maker: Annotated[Manufacturer, "the manufacturer"]
    devices: Annotated[tuple[Device, ...], "the families"]
    edition: Annotated[str, "the edition of the language"]


class Module(TypedDict):
    device: Annotated[Device, "the family as the spec describes it"]
    family: Annotated[Family, "its types, functions and constants, with their plans and names"]
    scope: Annotated[spelling.Scope, "spells expressions over `variant`"]


def files(library: Library, options: Options) -> dict[str, str]:
    crate_files = {}
    for maker, devices in library.by_manufacturer():
        folder = f"rust/{maker.name.replace('_', '-')}-encoders"
        crate: Crate = {"maker": maker, "devices": devices, "edition": options["edition"]}
        for path, template in (("Cargo.toml", "Cargo.toml.jinja"), ("src/lib.rs", "lib.rs.jinja")):
            crate_files[f"{folder}/{path}"] = TEMPLATES.render(template, crate, library.own_templates)
        for device in devices:
            module: Module = {"device": device, "family": Family(device), "scope": spelling.Scope(device)}
            text = TEMPLATES.render("family.rs.jinja", module, library.own_templates)
            crate_files[f"{folder}/src/{names.snake(device.name)}.rs"] = text
    return crate_files


def problems(library: Library) -> Iterator[TargetProblem]:
    return (problem for device in library.devices for problem in Family(device).problems)


_WORDS = (about.doc, about.markdown, names.pascal, names.snake, characters, crc_name)
_TEXTS = (
    about.field_text,
    about.frame_text,
    about.register_text,
    describe_crc,
    describe_order_code,
    describe_parameter,
    describe_value,
)
TEMPLATES = Templates(
    Path(__file__).parent / "templates",
    values={"Cargo.toml.jinja": Crate, "lib.rs.jinja": Crate, "family.rs.jinja": Module},
    filters={item.__name__: item for item in (*_WORDS, *spelling.PIECES, *spelling.NUMBERS)},
    functions={"never": assert_never}
    | {item.__name__: item for item in (*_TEXTS, describe, refusals, verdicts.conditions)},
    tests=tests_for(Check, Refusal, ConstantNumber, ValueOfField, ParityOf, ReservedBits),
)
TARGET = Target(
    name="rust",
    summary="crates without the standard library, in Rust 1.56",
    files=files,
    problems=problems,
    options=(Option("edition", "the edition of the language", "2021", ("2018", "2021")),),
    templates=TEMPLATES,
)
