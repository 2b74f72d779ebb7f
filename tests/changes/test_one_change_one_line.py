"""A change and what follows from it are one line of ``diff``: a renaming, a width, a default."""

from __future__ import annotations

from codewheel.changes.families import compare
from pair import devices, diff_text

#: The CRC of the BiSS frame gets a name of its own, and the flag before it becomes two bits.
RENAMED_FLAG = (
    "- {name: error, active: low, makes_position: not_usable, when_active: an error}",
    "- {name: failure, active: low, makes_position: not_usable, when_active: an error}",
)
NEW_FLAG = (
    "          - {name: crc, crc: biss_6}\n",
    "          - {name: spare, bits: 2}\n          - {name: crc, crc: biss_6}\n",
)
RENAMED_FAULT = ("{name: fault, at: 0, active", "{name: alarm_bit, at: 0, active")
RENAMED_FAULT_OF_ALARM = (
    "group: status_field, field: fault, meaning",
    "group: status_field, field: alarm_bit, meaning",
)
WIDER_STATUS = (
    "          - {use: control_field}\n          - {use: status_field}\n",
    "          - {use: control_field}\n          - {name: station, bits: 8}\n          - {use: status_field}\n",
)


def lines(*edits: tuple[str, str]) -> list[str]:
    """Return rule and text of every change of the base."""
    return [f"{change.rule.name}: {change.text}" for change in compare(devices([]), devices(edits))]


def test_a_field_that_is_renamed_and_moved_is_a_renaming_and_nothing_else() -> None:
    # Before the new field, error was at bit 7 and the CRC at bits 5:0. Multiturn, singleturn, error and warning move.
    assert lines(RENAMED_FLAG, NEW_FLAG) == [
        "field-renamed: single_cycle_data: field error → failure (between the same fields)",
        "field-new: single_cycle_data: field spare is new, moves 4 fields, frame 2 bits longer",
    ]


def test_a_renamed_bit_of_a_group_keeps_its_bits_in_the_group() -> None:
    # The reply has a byte more before the status field: both fields of that, the position and the CRC move.
    assert lines(RENAMED_FAULT, RENAMED_FAULT_OF_ALARM, WIDER_STATUS) == [
        "field-new: reply: field station is new, moves 5 fields, frame 8 bits longer",
        "field-renamed: status_field: field fault → alarm_bit (the same bits)",
    ]


def test_a_renamed_field_that_is_also_wider_is_not_recognised() -> None:
    """Nothing proves that it is the same field, so the old name is gone and the new one is new."""
    wider = ("- {name: number, at: 31:0}", "- {name: count, at: 15:0}\n      - {name: rest, at: 31:16}")
    rules = {line.partition(":")[0] for line in lines(wider)}
    assert rules == {"field-new", "field-gone"}


def test_a_move_that_no_size_explains_is_a_change_of_its_own() -> None:
    text = diff_text(
        devices([]),
        devices(
            [("{name: address, low_bit: address_bit, bits: 7}", "{name: address, low_bit: address_bit + 1, bits: 6}")]
        ),
    )
    assert "lowest bit" in text


def test_the_padding_of_a_field_moves_the_fields_after_it() -> None:
    # The revolutions take four bytes instead of three, and only the CRC follows them.
    wider = ("bits: multiturn_bits, padded_to: 24", "bits: multiturn_bits, padded_to: 32")
    assert lines(wider) == [
        "field-width: reply: field multiturn: bits with padding 24 → 32, moves 1 field, frame 8 bits longer"
    ]


def test_the_impact_is_that_of_the_moves_too() -> None:
    """A new field alone only adds to the XML. If others move, a user of the XML reads other bits."""
    [change] = [change for change in compare(devices([]), devices([NEW_FLAG])) if change.rule.name == "field-new"]
    assert [impact.word for impact in change.rule.impacts] == ["behaviour", "breaking", "behaviour", "documentation"]


#: A second procedure that saves, and a cable next to the connector, on both sides.
SECOND_PROCEDURE = (
    "procedures:\n",
    """procedures:
  - name: save
    title: Save
    interface: biss
    steps:
      - {do: write, register: command, value: save}
      - {do: wait, at_least_ms: 40}
    result: All is saved.
    source: "6.4"
""",
)


def test_the_same_pause_in_several_procedures_is_one_line() -> None:
    longer = ("at_least_ms: 40}", "at_least_ms: 60}")
    longer_first = ("{do: wait, at_least_ms: 30, meaning", "{do: wait, at_least_ms: 50, meaning")
    both = ("{do: wait, at_least_ms: 30, meaning", "{do: wait, at_least_ms: 40, meaning")
    both_longer = ("{do: wait, at_least_ms: 40, meaning", "{do: wait, at_least_ms: 60, meaning")
    no_wait_of_register = ("    wait_at_least_ms: 30\n", "")
    before = devices([no_wait_of_register, SECOND_PROCEDURE, both])
    after = devices([no_wait_of_register, SECOND_PROCEDURE, both, longer, both_longer])
    texts = [change.text for change in compare(before, after)]
    assert texts == ["procedures save, set_preset: pause 40 ms → 60 ms"]
    # Other pauses are two changes.
    other = compare(before, devices([no_wait_of_register, SECOND_PROCEDURE, longer, longer_first]))
    assert len(other) == 2


def test_a_time_that_a_register_and_its_procedures_share_is_one_line() -> None:
    longer_wait = ("    wait_at_least_ms: 30\n", "    wait_at_least_ms: 50\n")
    longer_pause = ("{do: wait, at_least_ms: 30, meaning", "{do: wait, at_least_ms: 50, meaning")
    (line,) = lines(longer_wait, longer_pause)
    assert line.endswith(": delay after a write 30 ms → 50 ms, and so procedure set_preset: step 4")


def test_a_bit_that_moves_to_an_unused_one_is_one_line() -> None:
    """Names of unused bits are chosen by the reader, here by their bits."""
    spare = "      - {name: spare, at: 7:1, unused: 0}\n"
    rest = "      - {name: rest, at: 6:1, unused: 0}\n"
    before = (spare, f"{rest}      - {{name: spare_7, at: 7, unused: 0}}\n")
    after = (spare, f"{rest}      - {{name: spare_0, at: 0, unused: 0}}\n")
    moved = ("      - name: direction\n        at: 0\n", "      - name: direction\n        at: 7\n")
    changes = compare(devices([before]), devices([after, moved]))
    assert [(change.rule.name, change.text.partition(": ")[2]) for change in changes] == [
        ("field-moved", "field direction: lowest bit 0 → 7")
    ]


def test_long_texts_are_shown_from_their_first_difference() -> None:
    first = "Standard profile for linear encoders, data format Variant 0-24 (50 µm to 2 µm) or Variant 0-24+++"
    before = ("profile: Standard", f"profile: {first}")
    after = ("profile: Standard", f"profile: {first.replace('2 µm', '5 µm')}")
    (change,) = compare(devices([before]), devices([after]))
    assert "…(50 µm to 2 µm) or Variant 0-24+++ → …(50 µm to 5 µm) or Variant 0-24+++" in change.text


def test_another_type_in_c_is_part_of_another_width() -> None:
    narrower = [("- {name: number, at: 31:0}", "- {name: number, at: 15:0}")]
    narrower.append(("    address: 0x44\n    length: 4\n", "    address: 0x44\n    length: 2\n"))
    [change] = [change for change in compare(devices([]), devices(narrower)) if change.rule.name.startswith("field-")]
    assert change.rule.name == "field-width"
    assert change.text.startswith("serial: field number: bits 32 → 16")
    assert change.text.endswith(", in C uint32_t → uint16_t")
    # The variable in C must change, the other outputs only read other bits.
    assert [impact.word for impact in change.rule.impacts] == ["breaking", "behaviour", "behaviour", "documentation"]


def test_steps_that_use_a_register_with_another_name_and_length_do_not_change() -> None:
    same_lines = "    meaning: Opens the preset\n    interface: biss\n    address: 0x60\n    length: "
    old_register = f"  - name: preset_enable\n{same_lines}1\n"
    new_register = f"  - name: opener\n{same_lines}2\n    byte_order: high_byte_first\n"
    edits = (
        (old_register, new_register),
        ("opened_by: {register: preset_enable, value: enable}", "opened_by: {register: opener, value: enable}"),
        ("{do: write, register: preset_enable", "{do: write, register: opener"),
        (
            "        at: 7:0\n        values:\n          disable:",
            "        at: 15:0\n        values:\n          disable:",
        ),
    )
    assert lines(*edits) == [
        "register-gone: register 60h preset_enable is gone",
        "register-new: registers 60h to 61h opener is new",
    ]


def test_two_contacts_with_exchanged_signals_are_one_line() -> None:
    first, second = (
        ('{contact: "1", signal: Ground}', '{contact: "1", signal: Clock}'),
        (
            '{contact: "2", signal: Clock}',
            '{contact: "2", signal: Ground}',
        ),
    )
    assert lines(first, second) == ["contact: connector plug: contacts 1 and 2: signals Ground and Clock exchanged"]


def test_a_contact_affects_the_order_codes_of_all_interfaces_of_its_connector() -> None:
    two_interfaces = ("interfaces: [ssi]\n    contacts:", "interfaces: [ssi, biss]\n    contacts:")
    (change,) = compare(
        devices([two_interfaces]), devices([two_interfaces, ("signal: Ground}", "signal: not connected}")])
    )
    assert len(change.codes) == 8  # All codes are 12: 4 for each interface.
