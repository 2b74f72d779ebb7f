"""``codewheel new``: write a commented spec that passes ``check``, to be filled in from a manual."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from importlib import resources
from keyword import iskeyword
from pathlib import Path

from ..language.problems import Report
from ..language.read import read_document
from ..language.rules.names import TAKEN

_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
_LONGEST_NAME = 40


class NameRefused(ValueError):
    """The name is not valid for a family."""


class NotWritten(OSError):
    """A file already exists or cannot be written. The message is one line."""


def write_spec(name: str, output: Path | None) -> list[Path]:
    """Write the spec, and next to it the manufacturer file and the schemas for an editor if they are missing.

    Args:
        name: The family's name.
        output: The file, or a folder for it. By default, ``name.yaml`` in the current folder.

    Returns:
        The files that were written.

    Raises:
        NameRefused: The name is not valid for a family, or the file has another one.
        NotWritten: A file already exists or cannot be written.
    """
    if not _NAME.fullmatch(name) or len(name) > _LONGEST_NAME or iskeyword(name) or name == "manufacturer":
        raise NameRefused(
            f"'{name[:60]}' is not a valid family name; use lowercase letters, digits and underscores, such as"
            f" {_suggested(name)}"
        )
    if name in TAKEN:
        raise NameRefused(f"'{name}' is the name of {TAKEN[name]}; choose another name for the family")
    path = output or Path(f"{name}.yaml")
    path = path / f"{name}.yaml" if path.is_dir() else path
    if path.name != f"{name}.yaml":
        raise NameRefused(f"the file of a spec has its family's name: {path.with_name(name + '.yaml')}, not {path}")
    manufacturer = path.with_name("manufacturer.yaml")
    files = {path: device_text(name, _manufacturer(manufacturer), _schema_path(path.parent, "device"))}
    if not manufacturer.exists():
        files[manufacturer] = manufacturer_text(_schema_path(path.parent, "manufacturer"))
    for kind in ("device", "manufacturer"):
        copy = path.with_name(f"{kind}.schema.json")
        if not _in_one_checkout(path.parent, kind) and not copy.exists():
            files[copy] = _schema(kind).read_text(encoding="utf-8")
    return list(_written(files))


def _written(files: dict[Path, str]) -> Iterator[Path]:
    for path, text in files.items():
        try:
            with path.open("x", encoding="utf-8", newline="\n") as file:
                file.write(text)
        except FileExistsError:
            raise NotWritten(f"{path} already exists and is not overwritten") from None
        except OSError as error:
            raise NotWritten(f"cannot write {path}: {error.strerror or error}") from None
        yield path


def _suggested(name: str) -> str:
    made = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")[:_LONGEST_NAME]
    return made if _NAME.fullmatch(made) and made != name else "encoder_1"


def _manufacturer(path: Path) -> str:
    document = read_document(path, Report()) if path.is_file() else None
    found = document.data.get("manufacturer") if document is not None else None
    return found if isinstance(found, str) and re.fullmatch(r"[a-z][a-z0-9]*", found) else "example"


def _schema(kind: str) -> Path:
    return Path(str(resources.files("codewheel.language") / f"{kind}.schema.json"))


def _in_one_checkout(folder: Path, kind: str) -> bool:
    """Return whether a clone with the spec also has the tool's schema: both are in one checkout, outside a venv."""
    here = folder.resolve()
    top = next((place for place in (here, *here.parents) if (place / ".git").exists()), None)
    schema = _schema(kind).resolve()
    return top is not None and schema.is_relative_to(top) and "site-packages" not in schema.parts


def _schema_path(folder: Path, kind: str) -> str:
    """Return the schema's path relative to the spec: the tool's own, or the copy next to the spec."""
    if not _in_one_checkout(folder, kind):
        return f"{kind}.schema.json"
    return Path(os.path.relpath(_schema(kind), folder)).as_posix()


def manufacturer_text(schema: str) -> str:
    """Return the text of a manufacturer file."""
    return _MANUFACTURER.replace("@SCHEMA@", schema)


def device_text(name: str, manufacturer: str, schema: str) -> str:
    """Return the text of a spec of the family ``name``."""
    made = _DEVICE.replace("@SCHEMA@", schema).replace("@MANUFACTURER@", manufacturer)
    return made.replace("@CODE@", name.replace("_", "-").upper()).replace("@NAME@", name)


_MANUFACTURER = """\
# yaml-language-server: $schema=@SCHEMA@
codewheel: 1
manufacturer: example                     # a short name, repeated in the devices' files
title: Name of the manufacturer
# biss_id: 0x0000                         # BiSS manufacturer ID, registers 7Eh and 7Fh, part of idbissXXXX.xml's name
source: Cover
"""

_DEVICE = """\
# yaml-language-server: $schema=@SCHEMA@
#
# @CODE@, from edition 1.0 of the manual. Everything below is an example that passes "codewheel check". Replace it with
# the facts of the manual, in the manual's order. docs/spec-language.md explains every key, and editors complete them
# using the schema named in the first line. A copy of the schema next to the spec belongs to codewheel: delete it after
# an update, and "codewheel new" writes it again.
#
# Sources are the section and page of the manual, as in "6.2 p.25". Cite a page only if the contents, the index or a
# cross-reference proves it.

codewheel: 1
device: @NAME@                            # the same as the file's name
manufacturer: @MANUFACTURER@
title: @CODE@ absolute encoder
movement: rotary                          # or linear

manual:
  title: @CODE@ user's guide
  revision: "1.0"                         # quoted, or 1.10 becomes 1.1
  # date: 2024-01-31
  language: en                            # language of the edition that the sources cite
  history:
    - {revision: "1.0", changes: First issue.}

# Public documents that sources cite by a key, as in "prot: p.7".
# documents:
#   prot: {title: "BiSS Interface, Protocol Description (BiSS C)"}

# ----------------------------------------------------------------------------------------------------------- order code

# Values set by the order code. Widths and limits below are expressions of these, such as 2^singleturn_bits - 1.
parameters:
  singleturn_bits: {meaning: Singleturn resolution, unit: bits, source: "1"}
  # Held in a register at run time instead of set by the order code:
  # used_bits: {meaning: Number of bits in use, read_from: resolution.bits, min: 1, max: 17, source: "6"}

order_code:
  pattern: "@CODE@-{singleturn}-{output}"
  source: Order code
  parts:
    - name: singleturn
      meaning: Singleturn resolution in bits
      values:
        "13": {meaning: "8,192 counts per turn", sets: {singleturn_bits: 13}}
        "17": {meaning: "131,072 counts per turn", sets: {singleturn_bits: 17}}
    - name: output
      meaning: Interface
      # open: "[A-Z]{2}"                  # regular expression for values the manual does not list
      values:
        SC: {meaning: BiSS C-mode, interface: biss}

# Resolution of the position. For a linear encoder: step_um and modulus.
measurement: {of: position, counts_per_turn: 2^singleturn_bits, turns: 1, source: "1"}

# ----------------------------------------------------------------------------------------------------------------- CRCs

crcs:
  - name: biss_6
    width: 6
    poly: 0x03                            # without the top bit: x^6 + x + 1 is 43h with it
    init: 0
    refin: false                          # most significant bit first
    refout: false
    xorout: 0x3F                          # sent inverted
    source: "6.2"

# ----------------------------------------------------------------------------------------------------------- interfaces

interfaces:
  # ssi:
  #   source: "5"
  #   clock: {min_hz: 100000, max_hz: 1000000, source: "5.1"}
  #   alignment: msb_left                 # or lsb_right
  #   layouts:
  #     - name: ssi_word
  #       from: encoder
  #       source: "5.2"
  #       fields: [{name: position, bits: singleturn_bits, unit: counts}]
  biss:
    source: "6"
    clock: {min_hz: 200000, max_hz: 10000000, source: "6.1"}
    layouts:
      - name: single_cycle_data
        printed_name: Single Cycle Data
        from: encoder
        source: "6.2"
        # In the order sent, most significant first.
        fields:
          - {name: position, bits: singleturn_bits, unit: counts, meaning: Position within one revolution}
          - {name: error, active: low, makes_position: not_usable, when_active: an error is active}
          - {name: warning, active: low, makes_position: usable_with_warning, when_active: a warning is active}
          # Reserved bits with the value in the manual. Other values are reported, but the frame is accepted.
          # - {name: spare, bits: 2, unused: 0}
          # Fixed bits, such as the zeros above a position. A frame with other values is rejected.
          # - {name: zero, bits: 1, constant: 0}
          - {name: crc, crc: biss_6}

# ------------------------------------------------------------------------------------------------------------ registers

registers:
  - name: command
    printed_name: Command
    meaning: Saves the parameters
    interface: biss
    address: 0x48
    length: 1
    access: write_only                    # read_only, read_write
    fields:
      - name: function
        at: 7:0                           # high bit first, bit 0 is the least significant
        values:
          save: {value: 1, printed_name: Save parameters, meaning: Saves what was written}
    source: "6.3"

  - name: preset
    printed_name: Preset
    meaning: New value for the current position
    interface: biss
    address: 0x50
    length: 4
    access: read_write
    byte_order: high_byte_first           # or low_byte_first, for two bytes or more
    default: 0
    min: 0
    max: 2^singleturn_bits - 1
    source: "6.3"

procedures:
  - name: set_preset
    title: Set and save a preset
    interface: biss
    arguments: [{name: position, of: preset, meaning: New value for the current position}]
    steps:
      - {do: write, register: preset, value: position, meaning: write the four preset registers}
      - {do: write, register: command, value: save, meaning: keep it after power-off}
      - {do: wait, at_least_ms: 30, meaning: EEPROM writing time}
    source: "6.3"

# ----------------------------------------------------------------------------------------------------- examples, errata

# Each worked example of the manual becomes a test of every output.
examples:
  - name: preset_register
    kind: register                        # frame, register, crc, procedure, measure
    register: preset
    order_code: @CODE@-17-SC
    bytes: "00 00 03 E8"
    values: {preset: 1000}
    source: "6.3"

# Errors and contradictions in the manual. Do not correct anything without an entry here.
# errata:
#   - name: preset_length
#     source: "6.3"
#     printed: The manual's own words.
#     used: The correction in the spec.
#     why: The manual's own evidence, or arithmetic.
#     status: settled                     # open if only hardware or the manufacturer could decide
#     severity: wrong_data                # or wrong_limit, omission, wording: the effect on someone who copies it
#     affects: [registers.preset]
"""
