"""Load devices from the specs at some paths, with all problems in one report, and select some of their order codes."""

from __future__ import annotations

import keyword
import sys
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ..cache import NO_CACHE, Cache, content_of
from ..language.check import check_document
from ..language.document import Document
from ..language.files import family_files, packaged_families, spec_files
from ..language.problems import ProblemReport, join_words
from ..language.read import read_document, read_specs
from ..model import Device, Manufacturer
from .device import build_device
from .history import check_editions, errata_of_other_editions, family_in_edition, read_counts, read_history
from .manufacturer_rules import check_shared_facts
from .overlays import Family as Family
from .overlays import apply_overlays, is_overlay, overlays_beside
from .spec_parts import build_manufacturer
from .stored import store_device, stored_device

#: Names that the Python package of a manufacturer cannot have.
_RESERVED_PACKAGE_NAMES = ("codewheel", "codewheel_runtime", "runtime")


def load_library(paths: Sequence[Path] | None = None) -> tuple[tuple[Device, ...], ProblemReport]:
    """Load every device that the specs at ``paths`` describe, sorted by name, and report all problems.

    Args:
        paths: Files and folders. By default, these are the specs that ship with the tool.

    Returns:
        The devices, which are only valid if the report is empty, and the report.
    """
    families, report = load_families(paths)
    return tuple(family.device for family in families), report


def load_valid(paths: Sequence[Path] | None = None) -> tuple[tuple[Device, ...], ProblemReport]:
    """Load only the devices that are valid, even if other specs have problems.

    A valid device is also left out if an invalid device has the same name or one of its order codes.
    """
    all_families, report = load_families(paths)
    valid_families = families_without_problems(all_families, report)
    broken_devices = [family.device for family in all_families if family not in valid_families]
    valid_devices = (family.device for family in valid_families)
    return tuple(device for device in valid_devices if not _shares_with_any(device, broken_devices)), report


def families_without_problems(families: Iterable[Family], report: ProblemReport) -> list[Family]:
    """Return the families whose files have no problem so far."""
    faulty = report.faulty_files
    return [family for family in families if faulty.isdisjoint(family.files)]


def _shares_with_any(device: Device, other_devices: Iterable[Device]) -> bool:
    """Return whether a device cannot be distinguished from one of the others by its name and order codes."""
    return any(_have_common_name(device, other_device) for other_device in other_devices)


def _have_common_name(first: Device, second: Device) -> bool:
    """Return whether two devices share a name or an order code, so that they cannot be distinguished."""
    # Special models and other editions share order codes with their family, and are distinguished by name.
    is_derived = bool(first.base or second.base)
    if is_derived or first.name == second.name:
        return first.name == second.name
    order_codes_of_first = {variant.code for variant in first.variants}
    return any(variant.code in order_codes_of_first for variant in second.variants)


def load_families(
    paths: Sequence[Path] | None = None,
    cache: Cache = NO_CACHE,
    prepare: Callable[[Document], object] | None = None,
    others: Sequence[Family] | None = None,
) -> tuple[list[Family], ProblemReport]:
    """Load all families from the specs at ``paths``, with the files that each one comes from, and report all problems.

    A device is not built again if all files of its family have the same content as when it was built without problems.
    The device then comes from ``others`` or from the cache.

    Args:
        paths: Files and folders. By default, these are the specs that ship with the tool.
        cache: Holds devices from earlier runs, and receives new ones.
        prepare: Called with each document before it is checked. It returns true if it changed the document. The family
            of a changed document is not stored.
        others: Families that were loaded before. If given, even if empty, the families in the result contain the
            content of their files.
    """
    paths = packaged_families() if paths is None else paths
    report = ProblemReport()
    needs_contents = bool(cache) or others is not None
    contents_before = contents(paths) if needs_contents else {}
    available_devices = _devices_by_file(contents_before, others or (), cache)
    documents = _read_documents(paths, report)
    edited_files = {document.file for document in documents if prepare is not None and prepare(document)}
    contents_after = contents(paths) if needs_contents else {}
    # A file that changed while the specs were read is neither taken from the cache nor stored.
    unchanged_contents = {
        file: content for file, content in contents_before.items() if contents_after.get(file) == content
    }
    reusable_devices = {file: device for file, device in available_devices.items() if file in unchanged_contents}
    families = families_of(documents, report, reusable_devices)
    for index, family in enumerate(families):
        if family.files.isdisjoint(edited_files):
            families[index] = _add_content(family, unchanged_contents, reusable_devices, report, cache)
    return families, report


def _devices_by_file(
    contents_of_files: Mapping[str, Sequence[bytes | str]], families: Iterable[Family], cache: Cache
) -> dict[str, Device]:
    """Return the devices that were already built from files with the same content, by the path of the spec.

    They come from ``families`` or from the cache.
    """
    device_by_content = {tuple(family.content): family.device for family in families if family.content}
    device_by_file: dict[str, Device] = {}
    for file, content in contents_of_files.items():
        device = device_by_content.get(tuple(content)) or stored_device(cache, content)
        if device is not None:
            device_by_file[file] = device
    return device_by_file


def _read_documents(paths: Sequence[Path], report: ProblemReport) -> list[Document]:
    """Read the specs at ``paths``, and the files that they need: packaged specs, manufacturer files and overlays."""
    documents = read_specs(paths, report)
    # If there are only overlays, they apply to the specs that ship with the tool.
    if documents and all(map(is_overlay, documents)):
        documents += read_specs(_packaged_specs_for(documents), report)
    documents += _missing_manufacturers(documents, report)
    read_paths = {Path(document.file).resolve() for document in documents}
    overlays = (path for path in overlays_beside(documents) if path.resolve() not in read_paths)
    return documents + read_specs(overlays, report)


def _packaged_specs_for(overlays: Sequence[Document]) -> list[Path]:
    """Return the specs that ship with the tool and that overlays change.

    If an overlay names an unknown family, all specs are returned, so that the message can suggest a family.
    """
    spec_path_by_family = {spec_path.stem: spec_path for spec_path in spec_files(packaged_families())}
    overlaid_names = sorted({str(overlay.data.get("of")) for overlay in overlays})
    are_all_packaged = set(overlaid_names) <= spec_path_by_family.keys()
    if not are_all_packaged:
        return packaged_families()
    return [spec_path_by_family[name] for name in overlaid_names]


def _is_storable(family: Family) -> bool:
    """Return whether a family can be cached, because it only depends on the files from which its key is computed.

    Families with overlays and families of other editions depend on more files.
    """
    files_of_key = set(map(str, family_files(Path(family.document.file))))
    return family.without_overlays is None and not family.device.base and family.files <= files_of_key


def is_clean(family: Family, report: ProblemReport) -> bool:
    """Return whether no problem was reported in the files on which a family depends."""
    all_files = {*family.files, *map(str, family_files(Path(family.document.file)))}
    return report.faulty_files.isdisjoint(all_files)


def _add_content(
    family: Family,
    contents_of_files: Mapping[str, Sequence[bytes | str]],
    cached_devices: Mapping[str, Device],
    report: ProblemReport,
    cache: Cache,
) -> Family:
    """Return a family with the content of its files, and store its device in the cache if it is new there.

    The family is returned unchanged if a file has a problem or changed while it was read, or if it cannot be cached.
    ``contents_of_files`` contains the content of all files of a family by the path of its spec.
    """
    file = family.document.file
    if file not in contents_of_files or not _is_storable(family) or not is_clean(family, report):
        return family
    if file not in cached_devices:
        store_device(cache, contents_of_files[file], family.device)
    return replace(family, content=contents_of_files[file])


def contents(paths: Sequence[Path]) -> dict[str, list[bytes | str]]:
    """Return the content of all files on which each family depends, by the path of its spec.

    The content of a family is a list of the names and bytes of its files. Its key in the cache is computed from it.
    """
    existing_specs = (path for path in spec_files(paths) if path.is_file())
    return {str(path): content_of(family_files(path)) for path in existing_specs}


def _check_documents(
    documents: Sequence[Document], report: ProblemReport, valid_files: Container[str]
) -> list[tuple[Document, dict[str, Any] | None]]:
    """Return each document with its checked data, or None if it is not valid. ``valid_files`` are not checked again."""
    documents_and_data: list[tuple[Document, dict[str, Any] | None]] = []
    for document in documents:
        is_known_valid = document.file in valid_files
        data_or_none = document.data if is_known_valid else check_document(document, report)
        documents_and_data.append((document, data_or_none))
    return documents_and_data


def families_of(
    documents: Sequence[Document],
    report: ProblemReport,
    cached_devices: Mapping[str, Device] = MappingProxyType({}),
) -> list[Family]:
    """Return the families that documents describe, with their overlays applied, sorted by name.

    Problems are added to ``report``. Documents that are not valid and devices that cannot be built are left out.
    ``cached_devices`` contains devices that were built before without problems, by the path of their specs. They are
    not built again.
    """
    overlays = [document for document in documents if is_overlay(document)]
    documents = [document for document in documents if not is_overlay(document)]
    documents_and_data = _check_documents(documents, report, cached_devices)
    manufacturers = _manufacturers_by_name(documents_and_data, report)
    manufacturer_files = [document for document in documents if "device" not in document.data]
    families: list[Family] = []
    for document, data in documents_and_data:
        if data is None or "device" not in data:
            continue
        files_of_manufacturer = _files_of_manufacturer(data["manufacturer"], manufacturer_files)
        if not files_of_manufacturer:
            _report_missing_manufacturer(document, manufacturers, report)
        manufacturer = manufacturers.get(data["manufacturer"]) or _placeholder_manufacturer(data["manufacturer"])
        device = cached_devices.get(document.file) or _build_device(document, data, manufacturer, report)
        if device is None:
            continue
        earlier_devices = [family.device for family in families]
        _compare_with_others(device, earlier_devices, document, report)
        files = frozenset((document.file, *files_of_manufacturer))
        families.append(Family(device=device, document=document, files=files))
    check_shared_facts(documents, report)
    families.sort(key=lambda family: family.device.name)
    if not overlays:
        return families
    rebuild_device = partial(_rebuild_device, manufacturers)
    return apply_overlays(families, overlays, rebuild_device, report)


def _files_of_manufacturer(name: str, manufacturer_files: Sequence[Document]) -> list[str]:
    """Return the paths of the files that describe a manufacturer, valid or not. Usually, there is one."""
    return [document.file for document in manufacturer_files if str(document.data.get("manufacturer")) == name]


def _report_missing_manufacturer(
    document: Document, manufacturers: Mapping[str, Manufacturer], report: ProblemReport
) -> None:
    """Report that no file describes the manufacturer in a spec. A spec without one is already reported."""
    if "manufacturer" not in document.data:
        return
    hint = ""
    if manufacturers:
        hint = f"; known: {join_words(sorted(manufacturers))}; use the same name in both files"
    message = f"there is no manufacturer file for '{document.data['manufacturer']}'{hint}"
    report.add("undefined-reference", document, ("manufacturer",), message)


def _build_device(
    document: Document, device_data: dict[str, Any], manufacturer: Manufacturer, report: ProblemReport
) -> Device | None:
    """Return the device that a spec describes, or None if it cannot be built.

    Files next to the spec contain the number of readings and the releases of the device. The changes of other editions
    of the manual are added as errata.
    """
    device = build_device(device_data, manufacturer, report.for_document(document))
    if device is None:
        return None
    check_editions(device_data, device, report.for_document(document))
    spec_path = Path(document.file)
    edition_notes = tuple(errata_of_other_editions(device_data))
    times_read = read_counts(spec_path, report)
    releases = read_history(spec_path, report)
    return replace(device, times_read=times_read, releases=releases, errata=(*device.errata, *edition_notes))


def in_edition(family: Family, revision: str, report: ProblemReport) -> Family | None:
    """Return a family as a different edition of its manual describes it, or None if it cannot be built.

    Problems are added to ``report``.
    """
    manufacturers = {family.device.manufacturer.name: family.device.manufacturer}
    return family_in_edition(family, revision, partial(_rebuild_device, manufacturers), report)


def _rebuild_device(
    manufacturers: Mapping[str, Manufacturer], document: Document, report: ProblemReport
) -> Device | None:
    """Return the device of a document that overlays or an edition changed, or None if it is not valid."""
    data = check_document(document, report)
    if data is None:
        return None
    name = data["manufacturer"]
    manufacturer = manufacturers.get(name) or _placeholder_manufacturer(name)
    return build_device(data, manufacturer, report.for_document(document))


def _manufacturers_by_name(
    documents_and_data: Sequence[tuple[Document, dict[str, Any] | None]], report: ProblemReport
) -> dict[str, Manufacturer]:
    """Return the manufacturers that valid manufacturer files describe, by name.

    Different files for the same manufacturer are reported, as are names that two manufacturers share.
    """
    manufacturer_by_name: dict[str, Manufacturer] = {}
    first_data_by_name: dict[str, dict[str, Any]] = {}
    for document, data in documents_and_data:
        is_manufacturer_file = data is not None and "device" not in data and "manufacturer" in data
        if data is None or not is_manufacturer_file:
            continue
        # Several folders may have equal files, so that each folder can be used alone.
        first_data = first_data_by_name.setdefault(data["manufacturer"], data)
        if first_data != data:
            message = f"there is a different manufacturer file for '{data['manufacturer']}'"
            report.add("duplicate-name", document, ("manufacturer",), message)
        manufacturer = build_manufacturer(data)
        _check_manufacturer(manufacturer, manufacturer_by_name.values(), document, report)
        manufacturer_by_name[manufacturer.name] = manufacturer
    return manufacturer_by_name


def _placeholder_manufacturer(manufacturer_name: str) -> Manufacturer:
    """Return a placeholder for a manufacturer without a file, so that the device can still be checked."""
    package = f"{manufacturer_name}_encoders"
    return Manufacturer(
        name=manufacturer_name, title="", biss_id=None, python_package=package, version="0.0.0", trademarks=()
    )


def _check_manufacturer(
    manufacturer: Manufacturer, others: Iterable[Manufacturer], document: Document, report: ProblemReport
) -> None:
    """Check that no other manufacturer has the same Python package or BiSS ID, and that no package name is reserved."""
    package_name = manufacturer.python_package
    package_path = ("python_package",) if "python_package" in document.data else ("manufacturer",)
    is_name_of_python = package_name in sys.stdlib_module_names or keyword.iskeyword(package_name)
    if package_name in _RESERVED_PACKAGE_NAMES or is_name_of_python:
        name_user = "codewheel" if package_name in _RESERVED_PACKAGE_NAMES else "Python"
        problem = f"'python_package' cannot be '{package_name}': {name_user} uses that name"
        report.add("not-allowed", document, package_path, f"{problem}; write '{package_name}_encoders'")
    biss_id = manufacturer.biss_id
    for other_manufacturer in others:
        if other_manufacturer.name == manufacturer.name:
            continue
        if other_manufacturer.python_package == package_name:
            message = f"'{other_manufacturer.name}' also has the Python package '{package_name}'; rename one of the two"
            report.add("duplicate-name", document, package_path, message)
        if biss_id is not None and other_manufacturer.biss_id == biss_id:
            message = f"'{other_manufacturer.name}' also has the BiSS manufacturer ID {biss_id:#06x}"
            message += f", which names the file idbiss{biss_id:04X}.xml"
            report.add("duplicate-name", document, ("biss_id",), message)


def _missing_manufacturers(documents: Sequence[Document], report: ProblemReport) -> list[Document]:
    """Read the manufacturer files next to specs that are not among the documents."""
    read_paths = {Path(document.file).resolve() for document in documents}
    folders = sorted({Path(document.file).parent for document in documents if "device" in document.data})
    missing_documents: list[Document] = []
    for folder in folders:
        manufacturer_path = folder / "manufacturer.yaml"
        if manufacturer_path.resolve() in read_paths or not manufacturer_path.is_file():
            continue
        document = read_document(manufacturer_path, report)
        if document is not None:
            missing_documents.append(document)
    return missing_documents


def _compare_with_others(
    device: Device, other_devices: Sequence[Device], document: Document, report: ProblemReport
) -> None:
    """Report a device whose name another device has, and the first of its order codes that another device has."""
    if any(other_device.name == device.name for other_device in other_devices):
        report.add("duplicate-name", document, ("device",), f"there is another spec for '{device.name}'")
    device_by_code: dict[str, Device] = {}
    for other_device in other_devices:
        device_by_code.update((variant.code, other_device) for variant in other_device.variants)
    for variant in device.variants:
        if variant.code in device_by_code:
            message = f"the order code {variant.code} also belongs to '{device_by_code[variant.code].name}'"
            report.add("order-code-ambiguous", document, ("order_code", "pattern"), message)
            return
