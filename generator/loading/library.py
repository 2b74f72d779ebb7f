"""Load the library from paths with all problems in one report, and reduce it to what a user names."""

from __future__ import annotations

import keyword
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ..cache import NO_CACHE, Cache, content_of
from ..language.check import check_document
from ..language.document import Document
from ..language.files import family_files, packaged_families, spec_files
from ..language.problems import ProblemReport, join_words, nearest_choice
from ..language.read import read_document, read_specs
from ..model import Device, Manufacturer, Variant
from ..order_codes.reduction import for_codes
from .device import build_device
from .editions import check_editions, edition_of, errata_of_other_editions
from .evidence import read_counts, read_history
from .from_mapping import build_manufacturer
from .overlays import Family as Family
from .overlays import apply_overlays, is_overlay, overlays_beside
from .repeated_facts import check_shared_facts
from .samples import sample_frames
from .stored import store_device, stored_device

#: Names of Python packages, and of the folder next to them, that do not belong to a manufacturer.
_RESERVED_PACKAGE_NAMES = ("codewheel", "codewheel_runtime", "runtime")


def load_library(paths: Sequence[Path] | None = None) -> tuple[tuple[Device, ...], ProblemReport]:
    """Load every device described by the specs at ``paths``, sorted by name, and report all problems.

    Args:
        paths: Files and folders. Default: the specs that ship with the tool.

    Returns:
        The devices, valid only if the report is empty, and the report.
    """
    families, report = load_families(paths)
    return tuple(family.device for family in families), report


def load_sound(paths: Sequence[Path] | None = None) -> tuple[tuple[Device, ...], ProblemReport]:
    """Load only the devices that are valid, even if other specs have problems.

    A valid device is also left out if an invalid device has the same name or one of its order codes.
    """
    families, report = load_families(paths)
    valid_families = sound_families(families, report)
    broken_devices = [family.device for family in families if family not in valid_families]
    valid_devices = (family.device for family in valid_families)
    return tuple(device for device in valid_devices if not _shares_with_any(device, broken_devices)), report


def sound_families(families: Iterable[Family], report: ProblemReport) -> list[Family]:
    """Return the families whose files have no problem so far."""
    faulty = report.faulty_files
    return [family for family in families if faulty.isdisjoint(family.files)]


def _shares_with_any(device: Device, other_devices: Iterable[Device]) -> bool:
    """Return True if a device cannot be distinguished from one of the others by its name and order codes."""
    return any(_have_common_name(device, other_device) for other_device in other_devices)


def _have_common_name(first: Device, second: Device) -> bool:
    """Return True if two devices share a name or order code, so that they cannot be distinguished."""
    if first.base or second.base:  # These share order codes with their base family and are distinguished by name.
        return first.name == second.name
    codes = {variant.code for variant in first.variants}
    has_common_code = any(variant.code in codes for variant in second.variants)
    return first.name == second.name or has_common_code


def load_families(
    paths: Sequence[Path] | None = None,
    cache: Cache = NO_CACHE,
    prepare: Callable[[Document], object] | None = None,
    others: Sequence[Family] | None = None,
) -> tuple[list[Family], ProblemReport]:
    """Load all families, like ``load_library``, with the spec and the files of each device.

    A device is not built again if all files of its family have the same content as when it was built without problems.
    The device then comes from ``others`` or from the cache.

    Args:
        paths: Files and folders. Default: the specs that ship with the tool.
        cache: Holds devices of earlier runs, and receives new ones.
        prepare: Called with each document before it is checked. If its result is true, it changed the document, whose
            family is not stored.
        others: Families that were loaded before. If given, even if empty, the resulting families have their content.
    """
    paths = packaged_families() if paths is None else paths
    report = ProblemReport()
    needs_contents = bool(cache) or others is not None
    contents_before = contents(paths) if needs_contents else {}
    # The content of its files is the key of a device: with the same content, it would be built in the same way.
    known_devices = {tuple(family.content): family.device for family in others or () if family.content}
    stored_devices: dict[str, Device | None] = {}
    for file, content in contents_before.items():
        stored_devices[file] = known_devices.get(tuple(content)) or stored_device(cache, content)
    documents = _read_documents(paths, report)
    edited_files = {document.file for document in documents if prepare is not None and prepare(document)}
    contents_after = contents(paths) if needs_contents else {}
    # A file that changed while the specs were read is neither taken from the cache nor stored.
    unchanged = {file: content for file, content in contents_before.items() if contents_after.get(file) == content}
    cached_devices = {file: device for file in unchanged if (device := stored_devices[file]) is not None}
    families = families_of(documents, report, cached_devices)
    for index, family in enumerate(families):
        if family.files.isdisjoint(edited_files):
            families[index] = _add_content(family, unchanged, cached_devices, report, cache)
    return families, report


def _read_documents(paths: Sequence[Path], report: ProblemReport) -> list[Document]:
    """Read the specs at ``paths``, and the files that they need: packaged specs, manufacturers and overlays."""
    documents = read_specs(paths, report)
    # Overlays alone apply to the specs that ship with the tool.
    if documents and all(map(is_overlay, documents)):
        documents += read_specs(_packaged_specs_for(documents), report)
    documents += _missing_manufacturers(documents, report)
    read_paths = {Path(document.file).resolve() for document in documents}
    overlays = (path for path in overlays_beside(documents) if path.resolve() not in read_paths)
    return documents + read_specs(overlays, report)


def _packaged_specs_for(overlays: Sequence[Document]) -> list[Path]:
    """Return the packaged specs that overlays change, or all of them if an overlay names no packaged family."""
    specs_by_family = {spec.stem: spec for spec in spec_files(packaged_families())}
    overlaid_names = sorted({str(overlay.data.get("of")) for overlay in overlays})
    are_all_packaged = set(overlaid_names) <= specs_by_family.keys()
    if not are_all_packaged:
        return packaged_families()
    return [specs_by_family[name] for name in overlaid_names]


def _is_storable(family: Family) -> bool:
    """Return True if a family depends only on the files in the key of its cache entry.

    Families with overlays and families of other editions depend on more files.
    """
    files_of_key = set(map(str, family_files(Path(family.document.file))))
    return family.plain is None and not family.device.base and family.files <= files_of_key


def is_clean(family: Family, report: ProblemReport) -> bool:
    """Return True if no problem was reported in any file on which a family depends."""
    all_files = {*family.files, *map(str, family_files(Path(family.document.file)))}
    return report.faulty_files.isdisjoint(all_files)


def _add_content(
    family: Family,
    contents_of_files: Mapping[str, Sequence[bytes | str]],
    cached_devices: Mapping[str, Device],
    report: ProblemReport,
    cache: Cache,
) -> Family:
    """Return a family with the content of its files, and store its device if it is new.

    The family is returned unchanged if a file has a problem or changed while it was read, or if it cannot be stored.
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

    The content of a family is the list of the names and bytes of its files, which is its key in the cache.
    """
    existing_specs = (path for path in spec_files(paths) if path.is_file())
    return {str(path): content_of(family_files(path)) for path in existing_specs}


def families_of(
    documents: Sequence[Document],
    report: ProblemReport,
    cached_devices: Mapping[str, Device] = MappingProxyType({}),
) -> list[Family]:
    """Build the families of documents with their overlays applied, sorted by name.

    Problems are added to ``report``. Documents without valid data are left out, and devices that cannot be built.
    ``cached_devices`` contains devices, by the path of their specs, that were built before and had no problems. These
    devices are not checked again.
    """
    overlays = [document for document in documents if is_overlay(document)]
    documents = [document for document in documents if not is_overlay(document)]
    # Each document with its checked data, or None if it is not valid.
    checked: list[tuple[Document, dict[str, Any] | None]] = []
    for document in documents:
        is_known_valid = document.file in cached_devices
        checked.append((document, document.data if is_known_valid else check_document(document, report)))
    makers = _manufacturers_by_name(checked, report)
    manufacturer_files = [document for document in documents if "device" not in document.data]
    families: list[Family] = []
    for document, data in checked:
        if data is None or "device" not in data:
            continue
        maker = _manufacturer_of(document, data, makers, manufacturer_files, report)
        device = cached_devices.get(document.file) or _build_device(document, data, maker, report)
        if device is None:
            continue
        _compare_with_others(device, [family.device for family in families], document, report)
        maker_name = data["manufacturer"]
        files_of_maker = {spec.file for spec in manufacturer_files if spec.data.get("manufacturer") == maker_name}
        families.append(Family(device, document, frozenset({document.file, *files_of_maker})))
    check_shared_facts(documents, report)
    plain = sorted(families, key=lambda family: family.device.name)
    return apply_overlays(plain, overlays, partial(_rebuild_device, makers), report) if overlays else plain


def _manufacturer_of(
    document: Document,
    device_data: Mapping[str, Any],
    makers: Mapping[str, Manufacturer],
    manufacturer_files: Sequence[Document],
    report: ProblemReport,
) -> Manufacturer:
    """Return the manufacturer of a spec, or a stand-in if it is not in ``makers``.

    Report that its file is missing. A file with problems has been reported, and so has a spec without the key.
    """
    name = device_data["manufacturer"]
    # A file with problems is not in ``makers``.
    has_file = any(str(file.data.get("manufacturer")) == name for file in manufacturer_files)
    if name not in makers and not has_file and "manufacturer" in document.data:
        hint = f"; known: {join_words(sorted(makers))}; use the same name in both files" if makers else ""
        message = f"there is no manufacturer file for '{name}'{hint}"
        report.add("undefined-reference", document, ("manufacturer",), message)
    return makers.get(name) or _stand_in_for_manufacturer(name)


def _build_device(
    document: Document, device_data: dict[str, Any], maker: Manufacturer, report: ProblemReport
) -> Device | None:
    """Return the device of a spec, or None if it cannot be built.

    The device gets the counts of readings and the releases from the files next to the spec, and the other editions as
    errata.
    """
    device = build_device(device_data, maker, report.for_document(document))
    if device is None:
        return None
    check_editions(device_data, device, report.for_document(document))
    spec = Path(document.file)
    edition_notes = tuple(errata_of_other_editions(device_data))
    counts = read_counts(spec, report)
    releases = read_history(spec, report)
    return replace(device, times_read=counts, releases=releases, errata=(*device.errata, *edition_notes))


def in_edition(family: Family, revision: str, report: ProblemReport) -> Family | None:
    """Return a family in another edition of its manual, or None if it cannot be built. Add problems to ``report``."""
    maker = family.device.manufacturer
    return edition_of(family, revision, partial(_rebuild_device, {maker.name: maker}), report)


def _rebuild_device(makers: Mapping[str, Manufacturer], document: Document, report: ProblemReport) -> Device | None:
    """Build the device of a document derived from a spec that was already built, or return None if it is not valid."""
    data = check_document(document, report)
    if data is None:
        return None
    maker = makers.get(data["manufacturer"]) or _stand_in_for_manufacturer(data["manufacturer"])
    return build_device(data, maker, report.for_document(document))


def _manufacturers_by_name(
    checked: Sequence[tuple[Document, dict[str, Any] | None]], report: ProblemReport
) -> dict[str, Manufacturer]:
    """Return the manufacturers of all valid manufacturer files, by name.

    Report files of the same manufacturer that differ, and names that clash.
    """
    makers: dict[str, Manufacturer] = {}
    first_data_by_name: dict[str, dict[str, Any]] = {}
    for document, data in checked:
        if data is not None and "device" not in data and "manufacturer" in data:
            # Several folders may have the same file, so that each of them can be used alone.
            first_data = first_data_by_name.setdefault(data["manufacturer"], data)
            if first_data != data:
                message = f"there is a different manufacturer file for '{data['manufacturer']}'"
                report.add("duplicate-name", document, ("manufacturer",), message)
            maker = build_manufacturer(data)
            _check_manufacturer(maker, makers.values(), document, report)
            makers[maker.name] = maker
    return makers


def _stand_in_for_manufacturer(manufacturer_name: str) -> Manufacturer:
    """Return a stand-in for a manufacturer without a file, so that the device can still be checked."""
    package = f"{manufacturer_name}_encoders"
    return Manufacturer(
        name=manufacturer_name, title="", biss_id=None, python_package=package, version="0.0.0", trademarks=()
    )


def _check_manufacturer(
    maker: Manufacturer, other_makers: Iterable[Manufacturer], document: Document, report: ProblemReport
) -> None:
    """Check that names derived from a manufacturer are unique, and that its package hides no standard module."""
    package = maker.python_package
    path = ("python_package",) if "python_package" in document.data else ("manufacturer",)
    is_name_of_python = package in sys.stdlib_module_names or keyword.iskeyword(package)
    if package in _RESERVED_PACKAGE_NAMES or is_name_of_python:
        name_user = "codewheel" if package in _RESERVED_PACKAGE_NAMES else "Python"
        report.add(
            "not-allowed",
            document,
            path,
            f"'python_package' cannot be '{package}': {name_user} uses that name; write '{package}_encoders'",
        )
    for other_maker in other_makers:
        if other_maker.name == maker.name:
            continue
        if other_maker.python_package == package:
            report.add(
                "duplicate-name",
                document,
                path,
                f"the Python package '{package}' is also that of '{other_maker.name}'; rename one",
            )
        if maker.biss_id is not None and other_maker.biss_id == maker.biss_id:
            message = f"the BiSS manufacturer ID {maker.biss_id:#06x} is also that of '{other_maker.name}'"
            message += f"; it names the file idbiss{maker.biss_id:04X}.xml"
            report.add("duplicate-name", document, ("biss_id",), message)


def _missing_manufacturers(documents: Sequence[Document], report: ProblemReport) -> list[Document]:
    """Return the manufacturer files next to device files that are not among the documents."""
    read_paths = {Path(document.file).resolve() for document in documents}
    folders = sorted({Path(document.file).parent for document in documents if "device" in document.data})
    missing_documents: list[Document] = []
    for folder in folders:
        path = folder / "manufacturer.yaml"
        if path.resolve() in read_paths or not path.is_file():
            continue
        document = read_document(path, report)  # None if nothing in the file can be used.
        if document is not None:
            missing_documents.append(document)
    return missing_documents


def _compare_with_others(
    device: Device, other_devices: Sequence[Device], document: Document, report: ProblemReport
) -> None:
    """Report a name that another family has, and the first order code that another family has."""
    if any(other_device.name == device.name for other_device in other_devices):
        report.add("duplicate-name", document, ("device",), f"there is another spec for '{device.name}'")
    devices_by_code: dict[str, Device] = {}
    for other_device in other_devices:
        devices_by_code.update((variant.code, other_device) for variant in other_device.variants)
    for variant in device.variants:
        if variant.code in devices_by_code:
            message = f"the order code {variant.code} also belongs to '{devices_by_code[variant.code].name}'"
            report.add("order-code-ambiguous", document, ("order_code", "pattern"), message)
            return


class UnknownName(ValueError):
    """A name matches no order code, interface or family. The message lists those that exist."""


def narrowed_to(devices: Sequence[Device], only: str) -> tuple[Device, ...]:
    """Return the devices with the order codes that ``only`` names, or all of them if it is empty.

    ``only`` is a list of names with commas: of order codes, interfaces, families, or of a family with one of its
    interfaces, such as ``x_24_ssi``. Devices without such an order code are left out.

    Raises:
        UnknownName: A name matches no order code, interface or family.
    """
    words = [word.strip() for word in only.split(",") if word.strip()]
    if not words:
        return tuple(devices)
    known_names: set[str] = set()
    for device in devices:
        for variant in device.variants:
            known_names.update(_names_of_code(device, variant))
    for word in words:
        if word.upper() not in known_names:
            raise UnknownName(_unknown_message(devices, word))
    wanted_names = {word.upper() for word in words}
    narrowed_devices = []
    for device in devices:
        codes = {variant.code for variant in device.variants if wanted_names & set(_names_of_code(device, variant))}
        # A device without a wanted order code is left out.
        if codes:
            narrowed_device = for_codes(device, codes)
            # Frames that programs and pages show come from one of the remaining order codes.
            narrowed_devices.append(replace(narrowed_device, samples=sample_frames(narrowed_device)))
    return tuple(narrowed_devices)


def _names_of_code(device: Device, variant: Variant) -> tuple[str, ...]:
    """Return the names by which ``only`` can select an order code, in upper case.

    These are the order code, the interface, the family, and the family with the interface, such as ``X_24_SSI``.
    """
    family = device.name.upper()
    kind = variant.interface.upper()
    return variant.code.upper(), kind, family, f"{family}_{kind}"


def _yield_suggestions(devices: Sequence[Device]) -> Iterator[str]:
    """Yield the families, the families with their interfaces, and the interfaces, for suggestions."""
    for device in devices:
        yield device.name
        yield from (f"{device.name}_{interface.name}" for interface in device.interfaces)
    yield from sorted({interface.name for device in devices for interface in device.interfaces})


def _unknown_message(devices: Sequence[Device], word: str) -> str:
    """Return the message about an unknown name, with the nearest name or else those that are valid.

    If the word begins with the name of a family, the order codes of this family are valid, otherwise all names.
    """
    families_of_word = [device for device in devices if word.upper().startswith(device.name.upper())]
    codes_of_families = [variant.code for device in families_of_word for variant in device.variants]
    codes_in_lower_case = [code.lower() for code in codes_of_families]
    nearest_name = nearest_choice(word, [*_yield_suggestions(devices), *codes_of_families, *codes_in_lower_case])
    first_code = next((variant.code for device in devices for variant in device.variants), "")
    valid_names = codes_of_families or [f"order codes, such as {first_code}", *_yield_suggestions(devices)]
    hint = f"did you mean '{nearest_name}'?" if nearest_name else f"valid are {', '.join(valid_names)}"
    return f"there is no order code, interface or family '{word}'; {hint}"
