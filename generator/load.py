"""From paths to the library: read, check and build every spec, with all problems in one report."""

from __future__ import annotations

import keyword
import sys
from collections.abc import Iterable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from .build import build_device
from .build_facts import build_manufacturer
from .check import check_document
from .model import Device, Manufacturer
from .problems import Report, listed
from .read import Document, read_document, read_specs
from .targets import BUILT_IN, Library, problems_of


def packaged_specs() -> Path:
    """The folder of the specs that ship with the tool; in an editable install, the checkout's ``specs``."""
    return Path(str(resources.files("codewheel.specs")))


def packaged_masters() -> Path:
    """The folder of the descriptions of masters that ship with the tool."""
    return packaged_specs() / "masters"


def _packaged_families() -> list[Path]:
    """The folders of the specs that describe encoders."""
    return sorted(path for path in packaged_specs().iterdir() if path.is_dir() and path != packaged_masters() and any(path.glob("*.yaml")))


def load_library(
    paths: Sequence[Path] = (), targets: Iterable[str] = tuple(BUILT_IN)
) -> tuple[tuple[Device, ...], Report]:
    """Every device that the specs at ``paths`` describe, in order of name, and everything that is wrong with them.

    Args:
        paths: Files and folders; without any, the specs that ship with the tool.
        targets: The outputs that are asked whether they can express the devices.

    Returns:
        The devices, to be used only when the report is empty, and the report.
    """
    devices, _, report = _load(paths, targets)
    return devices, report


def load_sound(paths: Sequence[Path] = ()) -> tuple[tuple[Device, ...], Report]:
    """Like ``load_library``, but the devices are those that can be used although something else is wrong: their own files have no problem."""
    devices, files, report = _load(paths, ())
    faulty = {problem.file for problem in report.problems}
    sound = [device for device in devices if faulty.isdisjoint(files[id(device)])]
    broken = [device for device in devices if not faulty.isdisjoint(files[id(device)])]
    return tuple(device for device in sound if not any(_share(device, other) for other in broken)), report


def _share(one: Device, other: Device) -> bool:
    """Whether two devices have one name or order code, so that neither can be told from the other."""
    codes = {item.code for item in one.variants}
    return one.name == other.name or any(item.code in codes for item in other.variants)


def _load(
    paths: Sequence[Path], targets: Iterable[str]
) -> tuple[tuple[Device, ...], dict[int, set[str]], Report]:
    """The devices, the files that each comes from by its identity, and the report."""
    report = Report()
    documents = read_specs(paths or _packaged_families(), report)
    documents += _missing_manufacturers(documents, report)
    checked = [(document, check_document(document, report)) for document in documents]
    makers: dict[str, Manufacturer] = {}
    for document, data in checked:
        if data is not None and "device" not in data and "manufacturer" in data:
            if data["manufacturer"] in makers:
                report.add("duplicate-name", document, ("manufacturer",), f"there is another manufacturer file for '{data['manufacturer']}'")
            built = build_manufacturer(data)
            _check_manufacturer(built, makers.values(), document, report)
            makers[built.name] = built
    # A manufacturer file with problems of its own is there all the same.
    broken = {str(document.data.get("manufacturer")) for document in documents if "device" not in document.data}
    devices: list[Device] = []
    files: dict[int, set[str]] = {}
    for document, data in checked:
        if data is None or "device" not in data:
            continue
        maker = makers.get(data["manufacturer"])
        if maker is None and data["manufacturer"] not in broken and "manufacturer" in document.data:
            known = f"; known: {listed(sorted(makers))}" if makers else ""
            report.add("undefined-reference", document, ("manufacturer",), f"there is no manufacturer file for '{data['manufacturer']}'{known}")
        device = build_device(data, maker or _unknown_manufacturer(data["manufacturer"]), report.for_document(document))
        if device is None:
            continue
        _compare_with_others(device, devices, document, report)
        devices.append(device)
        makers_files = (item for item in documents if "device" not in item.data)
        of_maker = {item.file for item in makers_files if item.data.get("manufacturer") == data["manufacturer"]}
        files[id(device)] = {document.file, *of_maker}
    devices.sort(key=lambda item: item.name)
    sound = _sound_documents(checked, report)
    _ask_targets(targets, [device for device in devices if device.name in sound], sound, report)
    return tuple(devices), files, report


def _unknown_manufacturer(name: str) -> Manufacturer:
    """Stands for a manufacturer of whom no file tells; what is wrong with the device itself can be told all the same."""
    package = f"{name}_encoders"
    return Manufacturer(name=name, title="", biss_id=None, python_package=package, version="0.0.0", trademarks=())


def _sound_documents(
    checked: Sequence[tuple[Document, dict[str, Any] | None]], report: Report
) -> dict[str, Document]:
    """The documents of the families in which nothing is wrong up to now, their manufacturer included."""
    faulty = {problem.file for problem in report.problems}
    sound = [(document, data) for document, data in checked if data is not None and document.file not in faulty]
    makers = {data["manufacturer"] for _, data in sound if "device" not in data and "manufacturer" in data}
    return {data["device"]: document for document, data in sound if "device" in data and data["manufacturer"] in makers}


def _ask_targets(
    targets: Iterable[str], devices: Sequence[Device], documents: Mapping[str, Document], report: Report
) -> None:
    """What a target cannot do is said here, where line and column are known, and not when it writes."""
    library = Library(tuple(devices))
    for name in targets:
        for problem in problems_of(name, library):
            document = documents[problem.device.name]
            where = f" on line {document.position(problem.other)[0]}" if problem.other else ""
            report.add(problem.rule, document, problem.place, problem.message(where))


def _check_manufacturer(maker: Manufacturer, others: Iterable[Manufacturer], document: Document, report: Report) -> None:
    """A manufacturer's files are named after it alone, and its Python package hides no module of Python's own."""
    package = maker.python_package
    path = ("python_package",) if "python_package" in document.data else ("manufacturer",)
    if package in sys.stdlib_module_names or keyword.iskeyword(package):
        report.add("not-allowed", document, path, f"'python_package' cannot be '{package}': that is a name of Python's own; take '{package}_encoders'")
    for other in others:
        if other.name == maker.name:
            continue
        if other.python_package == package:
            report.add("duplicate-name", document, path, f"the Python package '{package}' is that of '{other.name}' as well; each has its own")
        if maker.biss_id is not None and other.biss_id == maker.biss_id:
            wrong = f"the BiSS manufacturer ID {maker.biss_id:#06x} is that of '{other.name}' as well; it names the file idbiss{maker.biss_id:04X}.xml"
            report.add("duplicate-name", document, ("biss_id",), wrong)


def _missing_manufacturers(documents: Sequence[Document], report: Report) -> list[Document]:
    """The manufacturer files that lie beside device files which were given alone."""
    given = {Path(document.file).resolve() for document in documents}
    folders = sorted({Path(document.file).parent for document in documents if "device" in document.data})
    beside = [folder / "manufacturer.yaml" for folder in folders]
    found = (read_document(path, report) for path in beside if path.resolve() not in given and path.is_file())
    return [document for document in found if document is not None]


def _compare_with_others(device: Device, others: Sequence[Device], document: Document, report: Report) -> None:
    """Families have names of their own, and no order code belongs to two."""
    if any(other.name == device.name for other in others):
        report.add("duplicate-name", document, ("device",), f"there is another spec for '{device.name}'")
    codes = {variant.code: other for other in others for variant in other.variants}
    for variant in device.variants:
        if variant.code in codes:
            wrong = f"the order code {variant.code} belongs to '{codes[variant.code].name}' as well"
            report.add("order-code-ambiguous", document, ("order_code", "pattern"), wrong)
            return
