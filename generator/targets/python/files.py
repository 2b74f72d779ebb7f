"""The files of the Python target, and the filters, tests and functions of its templates.

A layout becomes a NamedTuple with ``decode`` and ``encode``. A register of one choice becomes an IntEnum with the same
methods. A procedure becomes a function that returns its steps. Their operations come from the plan, the statements from
the templates, and names and expressions from this package.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from posixpath import relpath
from runpy import run_path
from typing import Annotated, TypedDict

from ...model import Device, Manufacturer, Rs485, Spi, first_or_raise
from ...plan import operations, steps
from ...plan.limits import Refusal
from ...render import Templates, our_templates, tests_for
from ...say import text_on_one_line
from ...say.text import as_sentence
from .. import NO_OPTIONS, Library, Options, Target, has_biss, main_manufacturer
from ..registry import copied_files, licence_in, our_runtime
from .bits import place_in_bytes, purpose_of_constant
from .docstrings import describe_answer, describe_crc, describe_value, docstring
from .line_breaks import break_lines
from .literals import PythonExpression, coded, constant, grouped, literal, mask, quoted, table_statement
from .module import Enumeration, Module
from .names import (
    BISS,
    FACTS,
    PACKAGE,
    SHAPES,
    STANDARD,
    Imports,
    OpenQuestion,
    byte_order,
    encoder_name,
    imports_of,
    interface_name,
    names_of,
)
from .readme import ReadmeExample, first_example, virtual_examples


def _format_operand(value: PythonExpression) -> str:
    """Return an operand, in parentheses unless it is a name, a number or a call."""
    return value.operand


FILTERS: Mapping[str, Callable[..., object]] = {
    "broken": break_lines,
    "byte_order": byte_order,
    "coded": coded,
    "encoder": encoder_name,
    "grouped": grouped,
    "interface": interface_name,
    "mask": mask,
    "names_of": names_of,
    "operand": _format_operand,
    "place_in_bytes": place_in_bytes,
    "purpose": purpose_of_constant,
    "sentence": as_sentence,
}
FUNCTIONS: Mapping[str, Callable[..., object]] = {
    "constant": constant,
    "docstring": docstring,
    "literal": literal,
    "describe_crc": describe_crc,
    "describe_answer": describe_answer,
    "describe_value": describe_value,
    "quoted": quoted,
    "table": table_statement,
}
TESTS = tests_for(
    operations.Check,
    Refusal,
    steps.PlannedStep,
    steps.FixedNumber,
    steps.AsNumber,
    steps.OutsideArgumentLimits,
    steps.Undecodable,
    Enumeration,
)


#: Files that each package contains once, next to its folder and in it.
_PROJECT_FILES = ("README.md", "pyproject.toml")
#: Guides next to the README. A package has the guide of the live line only if one of its interfaces has a section in
#: it.
_LIVE_LINE = "live-line"
_GUIDE_NAMES = (_LIVE_LINE, "files-and-captures", "test-without-an-encoder")
_PACKAGE_FILES = ("__init__", "_codes")
#: Source files that are copied: the runtime with its package, and files that every manufacturer's package needs.
RUNTIME = our_runtime("python")
_PROJECT_FOLDER = RUNTIME / "project"
#: Characters that Markdown interprets.
_MARKDOWN_CHARACTERS = "\\`*_{}[]<>#|!&"
#: The folder of the runtime in the output.
_RUNTIME_FOLDER = "python/runtime"


class ReadmeExamples(TypedDict):
    start: Annotated[ReadmeExample, "the first example of the README"]
    shown_family: Annotated[Module, "the module whose family the README shows in full, that of the first example"]
    virtual: Annotated[dict[str, ReadmeExample], "an example for a virtual encoder for each interface"]
    biss_procedure: Annotated[ReadmeExample | None, "an example of a procedure over BiSS, if there is one"]
    spi: Annotated[ReadmeExample | None, "an example of a position over SPI, if there is one"]


class Package(ReadmeExamples):
    header: Annotated[str, "the comment at the top of each file, with its origin and licence"]
    package: Annotated[str, "the name to import"]
    distribution: Annotated[str, "the name to install"]
    title: Annotated[str, "the manufacturer's name on one line"]
    maker: Annotated[Manufacturer, "the manufacturer"]
    notices: Annotated[list[str], "notices on trademarks"]
    modules: Annotated[list[Module], "the module of each family"]
    questions: Annotated[list[tuple[Module, OpenQuestion]], "the questions that manuals leave open, with their modules"]
    guides: Annotated[list[str], "the names of the guides next to the README, without .md"]
    families: Annotated[list[str], "the names of all family modules"]
    specials: Annotated[list[tuple[str, str]], "the modules of special models, and the suffixes of their order codes"]
    biss: Annotated[tuple[str, ...], "the name of the module for all BiSS encoders, if there is one"]
    rs485: Annotated[bool, "whether one of the encoders has RS-485"]
    has_spi: Annotated[bool, "whether one of the encoders answers requests over SPI"]
    runtime: Annotated[str, "the version of the runtime that the package needs, as major and minor number"]
    shared: Annotated[str, "the folder of the runtime, from that of the package"]
    neighbours: Annotated[list[str], "the folders of the other manufacturers' packages, from that of the package"]
    public: Annotated[list[str], "the names of all public modules"]
    identified: Annotated[list[str], "the modules of families that can be identified by registers"]


class Family(TypedDict):
    header: Annotated[str, "the comment at the top of each file, with its origin and licence"]
    package: Annotated[str, "the name of the package to import"]
    module: Annotated[Module, "the family, with the parts, names and expressions of its module"]
    imports: Annotated[Imports, "the modules to import from, in groups, and the names"]
    facts: Annotated[list[str], "the names of its fact tables, in order"]
    offers: Annotated[list[str], "its public names, in order"]


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return the runtime and the files of every manufacturer's package, by path.

    The package of the main manufacturer is in ``python``, and each other package in a folder below it.
    """
    files = _runtime_files(_RUNTIME_FOLDER)
    manufacturers = library.by_manufacturer()
    first_manufacturer = main_manufacturer([manufacturer for manufacturer, _ in manufacturers])
    folders = {
        manufacturer.name: _folder_of_package(manufacturer, is_main=manufacturer is first_manufacturer)
        for manufacturer, _ in manufacturers
    }
    for manufacturer, devices in manufacturers:
        folder = folders[manufacturer.name]
        files |= licence_in(folder)
        for path, file_text in _package_files(manufacturer, devices, library, folders).items():
            files[f"{folder}/{path}"] = file_text
    return files


def _folder_of_package(maker: Manufacturer, *, is_main: bool) -> str:
    """Return the folder of a manufacturer's package in the output."""
    return "python" if is_main else f"python/{maker.python_package}"


def _runtime_files(folder: str) -> dict[str, str]:
    """Return the files of the runtime that all packages share, by path. ``folder`` is its folder in the output."""
    files = {f"{folder}/{name}": (RUNTIME / name).read_text(encoding="utf-8") for name in (*_PROJECT_FILES, "setup.py")}
    return files | licence_in(folder) | copied_files(RUNTIME / "codewheel_runtime", f"{folder}/codewheel_runtime")


def runtime_version() -> str:
    """Return the major and minor number of the runtime's version. A package needs at least this runtime."""
    version: str = run_path(str(RUNTIME / "codewheel_runtime" / "version.py"))["__version__"]
    return version[: version.rindex(".")]


def _package_files(
    maker: Manufacturer, devices: tuple[Device, ...], library: Library, folders: Mapping[str, str]
) -> dict[str, str]:
    """Return the files of a manufacturer's package, by their path in it."""
    package = maker.python_package
    biss = (BISS,) if has_biss(devices) else ()
    values = _package_values(maker, devices, folders, biss)
    user_templates = library.own_templates
    project_files = (*_PROJECT_FILES, *(f"{guide}.md" for guide in values["guides"]))
    files = {name: TEMPLATES.render(f"{name}.jinja", values, user_templates) for name in project_files}
    for name in _PACKAGE_FILES:
        files[f"{package}/{name}.py"] = TEMPLATES.render(f"{name}.py.jinja", values, user_templates)
    files["setup.py"] = (_PROJECT_FOLDER / "setup.py").read_text(encoding="utf-8")
    files |= copied_files(_PROJECT_FOLDER / "package", package)
    # The copied folder contains the module for BiSS.
    if not biss:
        del files[f"{package}/{BISS}.py"]
    for device in devices:
        files |= library.files_of(_files_of_family, device, NO_OPTIONS)
    return files


def _package_values(
    maker: Manufacturer, devices: tuple[Device, ...], folders: Mapping[str, str], biss: tuple[str, ...]
) -> Package:
    """Return the values of the templates of a package."""
    folder = folders[maker.name]
    modules = [Module(device) for device in devices]
    rs485 = any(device.find_interface(Rs485) for device in devices)
    has_spi = any(_has_spi_requests(device) for device in devices)
    has_live_line = rs485 or has_spi or bool(biss)
    return {
        **_readme_examples(modules),
        "package": maker.python_package,
        "distribution": maker.distribution,
        "title": text_on_one_line(maker.title),
        "maker": maker,
        "notices": [text_on_one_line(trademark) for trademark in maker.trademarks],
        "header": _header_comment(f"the specifications of {text_on_one_line(maker.title)}'s encoders"),
        "modules": modules,
        "questions": _open_questions(modules),
        "guides": [guide for guide in _GUIDE_NAMES if has_live_line or guide != _LIVE_LINE],
        "families": [module.name for module in modules],
        "specials": _special_models(modules),
        "biss": biss,
        "rs485": rs485,
        "has_spi": has_spi,
        "runtime": runtime_version(),
        "shared": relpath(_RUNTIME_FOLDER, folder),
        "neighbours": _paths_to_other_packages(maker, folders),
        "public": sorted([*(module.name for module in modules), *biss]),
        "identified": [module.name for module in modules if module.identities and not module.device.base],
    }


def _has_spi_requests(device: Device) -> bool:
    """Return whether the encoders of a family answer requests over SPI."""
    spi = device.find_interface(Spi)
    return spi is not None and bool(spi.exchanges)


def _paths_to_other_packages(maker: Manufacturer, folders: Mapping[str, str]) -> list[str]:
    """Return the paths of the other manufacturers' packages from that of ``maker``, for pip.

    ``folders`` are the folders of all packages in the output, by the names of their manufacturers.
    """
    folder = folders[maker.name]
    # pip would interpret a path without a dot as the name of a package.
    path_prefix = "./" if folder == "python" else ""
    other_folders = [other_folder for name, other_folder in folders.items() if name != maker.name]
    return [f"{path_prefix}{relpath(other_folder, folder)}" for other_folder in other_folders]


def _readme_examples(modules: list[Module]) -> ReadmeExamples:
    """Return the examples of the README and the guides, from the family of the first example where possible."""
    start = first_example([module.readme for module in modules])
    shown_family = _family_of(start.code, modules)
    shown_family_first = sorted(modules, key=lambda module: module is not shown_family)
    return {
        "start": start,
        "shown_family": shown_family,
        "virtual": virtual_examples([module.readme for module in shown_family_first]),
        "biss_procedure": _first_biss_example(shown_family_first),
        "spi": _first_spi_example(modules),
    }


def _family_of(order_code: str, modules: Iterable[Module]) -> Module:
    """Return the module of the family with this order code."""
    families = (module for module in modules if _has_order_code(module, order_code))
    return first_or_raise(families, f"family with the order code '{order_code}'")


def _has_order_code(module: Module, order_code: str) -> bool:
    """Return whether the family of a module lists this order code."""
    return any(variant.code == order_code for variant in module.device.variants)


def _open_questions(modules: Iterable[Module]) -> list[tuple[Module, OpenQuestion]]:
    """Return the questions that the manuals leave open, each after the module of its family."""
    modules_and_questions: list[tuple[Module, OpenQuestion]] = []
    for module in modules:
        modules_and_questions += [(module, question) for question, _ in module.alternatives]
    return modules_and_questions


def _special_models(modules: Iterable[Module]) -> list[tuple[str, str]]:
    """Return the module of each special model, with the suffixes of its order codes."""
    modules_and_suffixes: list[tuple[str, str]] = []
    for module in modules:
        for overlay in module.device.overlays:
            if overlay.special:
                modules_and_suffixes.append((module.name, overlay.special))
    return modules_and_suffixes


def _first_spi_example(modules: Iterable[Module]) -> ReadmeExample | None:
    """Return the first example of a position over SPI, or None without any."""
    for module in modules:
        if module.spi_example is not None:
            return module.spi_example
    return None


def _first_biss_example(modules: Iterable[Module]) -> ReadmeExample | None:
    """Return the first example of a procedure over BiSS, or None without any."""
    for module in modules:
        for example in module.readme.procedure_examples:
            if example.interface == "biss":
                return example
    return None


def _files_of_family(device: Device, library: Library, options: Options) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path of each module of a family, and a function that returns its text."""
    package = device.manufacturer.python_package
    module = Module(device)
    for folder, template in (("", "device"), ("facts/", "facts"), ("_shapes/", "shapes")):
        text = partial(_module_text, module, package, template, library.own_templates)
        yield f"{package}/{folder}{module.name}.py", text


def _module_text(module: Module, package: str, template: str, user_templates: Path | None) -> str:
    """Return the text of a module of a family, with imports of the names that it uses."""
    family: Family = {
        "header": _header_comment(f"the specification of {text_on_one_line(module.device.title)}"),
        "package": package,
        "module": module,
        "imports": [],
        "facts": module.fact_names,
        "offers": sorted({name for _, names in module.contents for name in names}),
    }
    names_by_device_module = {f"..{module.name}": [name for name in family["offers"] if name not in module.fact_names]}
    names_by_import_module = {"device": PACKAGE, "facts": FACTS, "shapes": {**SHAPES, **names_by_device_module}}[
        template
    ]
    # The first rendering shows which names the module uses, the second one imports them.
    text_without_imports = TEMPLATES.render(f"{template}.py.jinja", {**family, "imports": []}, user_templates)
    values: Family = {**family, "imports": imports_of(text_without_imports, STANDARD, names_by_import_module)}
    return TEMPLATES.render(f"{template}.py.jinja", values, user_templates)


def _header_comment(source: str) -> str:
    """Return the comment at the top of a file, which says what it is generated from, and its license."""
    licence = "# Licence 0BSD: you may use, change and distribute this file without any condition."
    return f"# Generated by codewheel from {source}.\n{licence}"


def _toml_string(text: str) -> str:
    """Return ``text`` as a TOML string."""
    return '"' + text_on_one_line(text).replace("\\", "\\\\").replace('"', '\\"') + '"'


def _escape_markdown(text: str) -> str:
    """Return text of a spec, escaped for Markdown."""
    return text_on_one_line(text).translate({ord(character): f"\\{character}" for character in _MARKDOWN_CHARACTERS})


_GUIDE_FILES = tuple(f"{guide}.md" for guide in _GUIDE_NAMES)
_PACKAGE_TEMPLATES = (*_PROJECT_FILES, *_GUIDE_FILES, *(f"{name}.py" for name in _PACKAGE_FILES))
TEMPLATES = Templates(
    our_templates("python"),
    values={
        "device.py.jinja": Family,
        "facts.py.jinja": Family,
        "shapes.py.jinja": Family,
        **{f"{name}.jinja": Package for name in _PACKAGE_TEMPLATES},
    },
    filters=FILTERS,
    tests=TESTS,
    functions={**FUNCTIONS, "toml": _toml_string, "markdown": _escape_markdown},
)
TARGET = Target(
    name="python",
    summary="an installable, typed package for each manufacturer, and the runtime that they share",
    files=generate,
    templates=TEMPLATES,
    family=_files_of_family,
)
