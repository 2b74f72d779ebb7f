"""``codewheel new``: a commented spec that passes ``check``, to be filled beside a manual."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from importlib import resources
from keyword import iskeyword
from pathlib import Path

from ..spec.problems import Report
from ..spec.read import read_document
from ..spec.rules.names import TAKEN

_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
_LONGEST_NAME = 40


class NameRefused(ValueError):
    """The name cannot be that of a family."""


class NotWritten(OSError):
    """A file is there already, or cannot be written; the message is one line."""


def write_spec(name: str, output: Path | None) -> list[Path]:
    """Write the spec, and beside it a manufacturer file and the schemas for an editor where there are none.

    Args:
        name: The family's name.
        output: The file, or a folder for it; without it, ``name.yaml`` in the current folder.

    Returns:
        The files that were written.

    Raises:
        NameRefused: The name cannot be that of a family, or the file has another one.
        NotWritten: A file is there already, or cannot be written.
    """
    if not _NAME.fullmatch(name) or len(name) > _LONGEST_NAME or iskeyword(name) or name == "manufacturer":
        raise NameRefused(
            f"'{name[:60]}' cannot be a family's name; write small letters, digits and underscores, such as"
            f" {_suggested(name)}"
        )
    if name in TAKEN:
        raise NameRefused(f"'{name}' is the name of {TAKEN[name]}; give the family another")
    path = output or Path(f"{name}.yaml")
    path = path / f"{name}.yaml" if path.is_dir() else path
    if path.name != f"{name}.yaml":
        raise NameRefused(f"a spec is named like its family: {path.with_name(name + '.yaml')}, not {path}")
    maker = path.with_name("manufacturer.yaml")
    files = {path: device_text(name, _manufacturer(maker), _schema_path(path.parent, "device"))}
    if not maker.exists():
        files[maker] = manufacturer_text(_schema_path(path.parent, "manufacturer"))
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
            raise NotWritten(f"{path} is there already; nothing is overwritten") from None
        except OSError as error:
            raise NotWritten(f"{path} cannot be written: {error.strerror or error}") from None
        yield path


def _suggested(name: str) -> str:
    made = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")[:_LONGEST_NAME]
    return made if _NAME.fullmatch(made) and made != name else "encoder_1"


def _manufacturer(path: Path) -> str:
    document = read_document(path, Report()) if path.is_file() else None
    found = document.data.get("manufacturer") if document is not None else None
    return found if isinstance(found, str) and re.fullmatch(r"[a-z][a-z0-9]*", found) else "maker"


def _schema(kind: str) -> Path:
    return Path(str(resources.files("codewheel.spec") / f"{kind}.schema.json"))


def _in_one_checkout(folder: Path, kind: str) -> bool:
    """Whether a clone of the spec has the tool's own schema too: both lie in one checkout, outside environments."""
    here = folder.resolve()
    top = next((place for place in (here, *here.parents) if (place / ".git").exists()), None)
    schema = _schema(kind).resolve()
    return top is not None and schema.is_relative_to(top) and "site-packages" not in schema.parts


def _schema_path(folder: Path, kind: str) -> str:
    """Where an editor finds the schema, seen from the spec: the tool's own, or the copy beside the spec."""
    if not _in_one_checkout(folder, kind):
        return f"{kind}.schema.json"
    return Path(os.path.relpath(_schema(kind), folder)).as_posix()


def manufacturer_text(schema: str) -> str:
    """A manufacturer file."""
    return _MANUFACTURER.replace("@SCHEMA@", schema)


def device_text(name: str, manufacturer: str, schema: str) -> str:
    """A spec of the family ``name``."""
    made = _DEVICE.replace("@SCHEMA@", schema).replace("@MANUFACTURER@", manufacturer)
    return made.replace("@CODE@", name.replace("_", "-").upper()).replace("@NAME@", name)


_MANUFACTURER = """\
# yaml-language-server: $schema=@SCHEMA@
codewheel: 1
manufacturer: maker                       # a short name; the devices' files give it as well
title: Name of the manufacturer
# biss_id: 0x0000                         # the BiSS manufacturer ID, registers 7Eh and 7Fh; names idbissXXXX.xml
source: Cover
"""

_DEVICE = """\
# yaml-language-server: $schema=@SCHEMA@
#
# @CODE@, from the manual's edition 1.0. Everything below is an example that passes "codewheel check"; replace it by
# what the manual says, in the manual's order. docs/spec-language.md explains every key, and an editor that reads the
# first line completes them by the schema that it names. A copy of the schema beside the spec is codewheel's: after an
# update delete it, and "codewheel new" writes it afresh.
#
# Sources: section and page of the manual, as in "6.2 p.25". A page only where contents, index or a cross-reference
# proves it.

codewheel: 1
device: @NAME@                            # the same as the file's name
manufacturer: @MANUFACTURER@
title: @CODE@ absolute encoder
movement: rotary                          # or linear

manual:
  title: @CODE@ user's guide
  revision: "1.0"                         # in quotes, or 1.10 becomes 1.1
  # date: 2024-01-31
  language: en                            # the language of the edition that sources refer to
  history:
    - {revision: "1.0", changes: First issue.}

# Public documents that sources cite by a key, as in "prot: p.7".
# documents:
#   prot: {title: "BiSS Interface, Protocol Description (BiSS C)"}

# ----------------------------------------------------------------------------------------------------------- order code

# What an order code decides. Widths and limits below are sums of these, such as 2^singleturn_bits - 1.
parameters:
  singleturn_bits: {meaning: Singleturn resolution, unit: bits, source: "1"}
  # Held by a register at run time instead of set by the order code:
  # used_bits: {meaning: Bits as set, read_from: resolution.bits, min: 1, max: 17, source: "6"}

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
      # open: "[A-Z]{2}"                  # what the manual leaves open, as a regular expression; taken as unlisted
      values:
        SC: {meaning: BiSS C-mode, interface: biss}

# What a position counts. For a length: step_um and modulus.
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
        # In the order in which they are sent; the first is the most significant.
        fields:
          - {name: position, bits: singleturn_bits, unit: counts, meaning: Position within one revolution}
          - {name: error, active: low, makes_position: not_usable, when_active: an error is active}
          - {name: warning, active: low, makes_position: usable_with_warning, when_active: a warning is active}
          # Bits of a status that are not used, at the value that the manual has; others are reported, not refused.
          # - {name: spare, bits: 2, unused: 0}
          # Bits that prove the frame, such as the zeros above a position; with others it is refused.
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
        at: 7:0                           # high bit first; bit 0 is the least significant
        values:
          save: {value: 1, printed_name: Save parameters, meaning: Saves what was written}
    source: "6.3"

  - name: preset
    printed_name: Preset
    meaning: Value that the present position is to get
    interface: biss
    address: 0x50
    length: 4
    access: read_write
    byte_order: high_byte_first           # or low_byte_first; from two bytes on
    default: 0
    min: 0
    max: 2^singleturn_bits - 1
    source: "6.3"

procedures:
  - name: set_preset
    title: Set and save a preset
    interface: biss
    arguments: [{name: position, of: preset, meaning: Value that the present position is to get}]
    steps:
      - {do: write, register: preset, value: position, meaning: write the four preset registers}
      - {do: write, register: command, value: save, meaning: keep it over power-off}
      - {do: wait, at_least_ms: 30, meaning: EEPROM writing time}
    source: "6.3"

# ----------------------------------------------------------------------------------------------------- examples, errata

# Each worked example of the manual; it becomes a test of every output.
examples:
  - name: preset_register
    kind: register                        # frame, register, crc, procedure, measure
    register: preset
    order_code: @CODE@-17-SC
    bytes: "00 00 03 E8"
    values: {preset: 1000}
    source: "6.3"

# Where the manual errs or contradicts itself; nothing is corrected without an entry.
# errata:
#   - name: preset_length
#     source: "6.3"
#     printed: What the manual prints.
#     used: What the spec says instead.
#     why: The manual's own evidence, or arithmetic.
#     status: settled                     # open where only hardware or the maker could decide
#     severity: wrong_data                # wrong_limit, omission, wording: what a reader who copies it gets
#     affects: [registers.preset]
"""
