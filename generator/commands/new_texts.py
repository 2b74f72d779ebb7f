"""Texts of the files that ``codewheel new`` writes, in sections."""

from __future__ import annotations

MANUFACTURER = """\
# yaml-language-server: $schema=@SCHEMA@
codewheel: 1
manufacturer: example                     # a short name, repeated in the devices' files
title: Name of the manufacturer
# biss_id: 0x0000                         # BiSS manufacturer ID, registers 7Eh and 7Fh, part of idbissXXXX.xml's name
source: Cover
"""

HEAD = """\
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
movement: @MOVEMENT@
# The sources of the facts below. The other grades are for encoders whose manual was not read as a whole.
evidence: {grade: manual, documents: {manual: all pages}}

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

"""

CODE = """\
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

"""

CRCS = """\
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

"""

BISS = """\
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

"""

REGISTERS = """\
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

"""

EXAMPLES_HEAD = """\
# ----------------------------------------------------------------------------------------------------- examples, errata

# Each worked example of the manual becomes a test of every output.
"""

EXAMPLE = """\
examples:
  - name: preset_register
    kind: register                        # frame, register, crc, procedure, measure
    register: preset
    order_code: @CODE@-17-SC
    bytes: "00 00 03 E8"
    values: {preset: 1000}
    source: "6.3"
  - name: position                        # a frame with its CRC shows whether poly, init and xorout are right
    kind: frame
    layout: single_cycle_data
    order_code: @CODE@-17-SC
    from: encoder
    bits: "@BITS@"
    values: {position: 1000}
    source: "6.2"

"""

ERRATA = """\
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

TURNS = """\
# ----------------------------------------------------------------------------------------------------------- order code

# Values set by the order code. Widths and limits below are expressions of these, such as 2^singleturn_bits - 1.
parameters:
  singleturn_bits: {meaning: Singleturn resolution, unit: bits, source: "1"}
  multiturn_bits: {meaning: Bits that count revolutions, unit: bits, source: "1"}
  position_bits: {meaning: Bits of the position, unit: bits, equals: multiturn_bits + singleturn_bits, source: "1"}

order_code:
  pattern: "@CODE@-{singleturn}-{turns}-{output}"
  source: Order code
  parts:
    - name: singleturn
      meaning: Singleturn resolution in bits
      values:
        "13": {meaning: "8,192 counts per turn", sets: {singleturn_bits: 13}}
        "17": {meaning: "131,072 counts per turn", sets: {singleturn_bits: 17}}
    - name: turns
      meaning: Number of revolutions
      values:
        "1": {meaning: Singleturn, sets: {multiturn_bits: 0}}
        "4096": {meaning: "Multiturn, 4,096 revolutions", sets: {multiturn_bits: 12}}
    - name: output
      meaning: Interface
      # open: "[A-Z]{2}"                  # regular expression for values the manual does not list
      values:
        @OUTPUT@

# Resolution of the position. For a linear encoder: step_um and modulus.
measurement: {of: position, counts_per_turn: 2^singleturn_bits, turns: 2^multiturn_bits, source: "1"}

"""

LENGTH = """\
# ----------------------------------------------------------------------------------------------------------- order code

# Values set by the order code. Widths and limits below are expressions of these, such as 2^position_bits - 1.
parameters:
  resolution_um: {meaning: Length of one step, unit: µm, source: "1"}
  position_bits: {meaning: Bits of the position, unit: bits, source: "1"}

order_code:
  pattern: "@CODE@-{resolution}-{output}"
  source: Order code
  parts:
    - name: resolution
      meaning: Resolution
      values:
        "1": {meaning: 1 µm, sets: {resolution_um: 1, position_bits: 24}}
        "5": {meaning: 5 µm, sets: {resolution_um: 5, position_bits: 22}}
    - name: output
      meaning: Interface
      # open: "[A-Z]{2}"                  # regular expression for values the manual does not list
      values:
        @OUTPUT@

# Resolution of the position. Leave it out if a step is not a whole number of micrometres.
measurement: {of: position, step_um: resolution_um, modulus: 2^position_bits, source: "1"}

"""

SSI = """\
# ----------------------------------------------------------------------------------------------------------- interfaces

interfaces:
  ssi:
    source: "5"
    clock: {min_hz: 100000, max_hz: 1000000, source: "5.1"}
    alignment: msb_left                   # or lsb_right
    output_code: binary                   # or gray, by_order_code
    timings:
      - {name: pause, symbol: Tp, meaning: Pause between two words, at_least_us: 20, source: "5.1"}
    layouts:
      - name: ssi_word
        printed_name: Structure of the position information
        from: encoder
        source: "5.2"
        # gray: {of: position}            # needed for Gray code; add 'when: PARAMETER' if only some order codes have it
        # In the order sent, most significant first.
        fields:
@FIELDS@          # An error bit after the position:
          # - {name: error, active: high, makes_position: not_usable, when_active: an error is active}
@JOIN@"""

RS485 = """\
# ----------------------------------------------------------------------------------------------------------- interfaces

# Parts that several frames share.
field_groups:
  - name: control_field
    bits: 8
    source: "7.3"
    fields:
      - {name: sync, at: 2:0, constant: 2, meaning: Start of a frame}
      - {name: data_id, at: 6:3, values_of: data_ids, meaning: "Type of the request, repeated in the reply"}
      - {name: parity, at: 7, parity_of: data_id}
  - name: status_field
    bits: 8
    source: "7.3"
    fields:
      - {name: status_info, at: 3:0, unused: 0}
      - {name: encoder_error, at: 4, active: high, makes_position: not_usable, when_active: the encoder has an error}
      - {name: alarm, at: 5, active: high, makes_position: usable_with_warning, when_active: an alarm is active}
      - {name: status_zero, at: 7:6, unused: 0}

interfaces:
  # Requests and replies like those of Tamagawa's T-format.
  rs485:
    source: "7"
    port: {baud: 2500000, data_bits: 8, parity: none, stop_bits: 1, flow_control: none, source: "7.1"}
    data_ids:
      - {name: singleturn, id: 0, control: 0x02, purpose: capture, meaning: Singleturn position, source: "7.3"}
      - {name: all_data, id: 3, control: 0x1A, purpose: capture, meaning: Position and revolutions, source: "7.3"}
      # purpose: read, write or reset for the other data IDs
    layouts:
      - name: data_request
        from: master
        carried_as: bytes
        byte_order: low_byte_first
        when: {data_id: [0, 3]}
        source: "7.2"
        fields: [{use: control_field}]
      - name: singleturn_reply
        from: encoder
        carried_as: bytes
        byte_order: low_byte_first
        when: {data_id: [0]}
        source: "7.2"
        # In the order sent.
        fields:
          - {use: control_field}
          - {use: status_field}
          - {name: singleturn, bits: singleturn_bits, padded_to: 24, unit: counts, meaning: Position in a revolution}
          - {name: crc, crc: rs485_8}
      - name: complete_reply
        from: encoder
        carried_as: bytes
        byte_order: low_byte_first
        when: {data_id: [3]}
        source: "7.2"
        fields:
          - {use: control_field}
          - {use: status_field}
          - {name: singleturn, bits: singleturn_bits, padded_to: 24, unit: counts, meaning: Position in a revolution}
          - {name: encoder_id, bits: 8, equals: 0x17, meaning: Encoder ID}
          - {name: multiturn, bits: multiturn_bits, padded_to: 24, unit: revolutions, meaning: Number of revolutions}
          - {name: alarms, bits: 8, unused: 0, meaning: Alarms}
          - {name: crc, crc: rs485_8}
        # The position of the measurement above, most significant first.
        join: {position: [multiturn, singleturn]}

"""

RS485_CRC = """\
# ----------------------------------------------------------------------------------------------------------------- CRCs

crcs:
  - name: rs485_8
    width: 8
    poly: 0x01                            # without the top bit: x^8 + 1 is 101h with it
    init: 0
    refin: true                           # least significant bit first
    refout: true
    xorout: 0
    source: "7.4"

"""

EXCHANGES = """\
# ----------------------------------------------------------------------------------------------------------------- CRCs

crcs:
  - name: xor_8
    width: 8
    poly: 0x01                            # without the top bit: x^8 + 1 is 101h with it
    init: 0
    refin: false                          # most significant bit first
    refout: false
    xorout: 0
    note: This is the XOR of the bytes.
    source: "7.4"

# ----------------------------------------------------------------------------------------------------------- interfaces

interfaces:
  rs485:
    source: "7"
    port: {baud: 115200, data_bits: 8, parity: none, stop_bits: 1, flow_control: none, source: "7.1"}
    # Which reply answers which request. The constants in a request distinguish it from the others.
    exchanges:
      - {request: position_request, reply: position_reply, purpose: position, source: "7.2"}
      - {request: temperature_request, reply: temperature_reply, purpose: other, source: "7.2"}
      - {request: reset_request, purpose: other, source: "7.2"}  # without a reply
    layouts:
      - name: position_request
        from: master
        byte_order: high_byte_first       # or low_byte_first
        source: "7.2"
        # In the order sent. A value that the reply repeats is a field with the same name in both.
        fields:
          - {name: address, bits: 8, default: 0x01, meaning: Address of the encoder}
          - {name: command, bits: 8, constant: 0x42}
          - {name: crc, crc: xor_8}
      - name: temperature_request
        from: master
        byte_order: high_byte_first
        source: "7.2"
        fields:
          - {name: address, bits: 8, default: 0x01, meaning: Address of the encoder}
          - {name: command, bits: 8, constant: 0x54}
          - {name: crc, crc: xor_8}
      - name: reset_request
        from: master
        byte_order: high_byte_first
        source: "7.2"
        note: Restarts the encoder.
        fields:
          - {name: address, bits: 8, default: 0x01, meaning: Address of the encoder}
          - {name: command, bits: 8, constant: 0x53}
          - {name: crc, crc: xor_8}
      - name: position_reply
        from: encoder
        byte_order: high_byte_first
        source: "7.3"
        fields:
          - {name: address, bits: 8, meaning: Address of the encoder}
          - {name: command, bits: 8, constant: 0x42}
          - {name: status, bits: 7, unused: 0}
          - {name: error, active: high, makes_position: not_usable, when_active: the encoder has an error}
          - {name: multiturn, bits: multiturn_bits, padded_to: 16, unit: revolutions, meaning: Number of revolutions}
          - {name: singleturn, bits: singleturn_bits, padded_to: 24, unit: counts, meaning: Position in a revolution}
          - {name: crc, crc: xor_8}
        # The position of the measurement above, most significant first.
        join: {position: [multiturn, singleturn]}
      - name: temperature_reply
        from: encoder
        byte_order: high_byte_first
        source: "7.3"
        fields:
          - {name: address, bits: 8, meaning: Address of the encoder}
          - {name: command, bits: 8, constant: 0x54}
          - {name: temperature, bits: 8, signed: true, unit: °C, meaning: Temperature of the encoder}
          - {name: crc, crc: xor_8}

"""

#: Fields of a position with revolutions, most significant first, and the position that they form.
MULTITURN = """\
          - {name: multiturn, bits: multiturn_bits, unit: revolutions, meaning: Number of revolutions}
          - {name: singleturn, bits: singleturn_bits, unit: counts, meaning: Position within one revolution}
"""
JOIN = """\
        # The position of the measurement above, most significant first.
        join: {position: [multiturn, singleturn]}
"""

SSI_EXAMPLE = """\
examples:
  - name: position
    kind: frame                           # frame, register, crc, procedure, measure
    layout: ssi_word
    order_code: @CODE@-13-4096-BG
    from: encoder
    bits: "0000000001010001111101000"     # 5 revolutions and 1000 counts
    values: {multiturn: 5, singleturn: 1000}
    source: "5.2"

"""

RS485_EXAMPLE = """\
examples:
  - name: complete_reply
    kind: frame                           # frame, register, crc, procedure, measure
    layout: complete_reply
    from: encoder
    order_code: @CODE@-17-4096-JP
    bytes: "1A 00 E8 03 00 17 05 00 00 00 E3"
    values: {multiturn: 5, singleturn: 1000}
    source: "7.2"

"""
EXCHANGES_EXAMPLES = """\
examples:
  - name: position_reply
    kind: frame                           # frame, register, crc, procedure, measure
    layout: position_reply
    from: encoder
    order_code: @CODE@-17-4096-RS
    bytes: "01 42 00 00 05 00 03 E8 AD"
    values: {address: 1, multiturn: 5, singleturn: 1000}
    source: "7.3"
  - name: position_request
    kind: frame
    layout: position_request
    from: master
    order_code: @CODE@-17-4096-RS
    bytes: "01 42 43"
    values: {address: 1}
    source: "7.2"

"""

#: Frames of the example over BiSS with counts 1000, no error and no warning: 17 bits, 24 bits, and 5 revolutions.
FRAME, LINEAR_FRAME = "0000000111110100011011010", "00000000000000111110100011011010"
MULTITURN_FRAME = "0000000001010000000111110100011110110"
#: The lines of the example over BiSS that they replace and follow.
POSITION = """\
          - {name: position, bits: singleturn_bits, unit: counts, meaning: Position within one revolution}
"""
LAST_FIELD = "          - {name: crc, crc: biss_6}\n"

SPI = """\
# ----------------------------------------------------------------------------------------------------------- order code

parameters: {}                            # values set by the order code, if there are any

order_code:
  pattern: "@CODE@-{output}"
  source: Order code
  parts:
    - name: output
      meaning: Interface
      values:
        SP: {meaning: SPI, interface: spi}

# Resolution of the position.
measurement: {of: position, counts_per_turn: 2^14, turns: 1, source: "1"}

# ----------------------------------------------------------------------------------------------------------- interfaces

interfaces:
  spi:
    source: "5"
    mode: 1                               # 0 and 1: the clock idles low. 1 and 3: data is taken on the second edge
    word_bits: 16                         # 8 to 64. An exchange with another length has its own word_bits
    reply: next_word                      # or same_word
    clock: {max_hz: 10000000, source: "5.1"}
    # Which reply answers which request. Leave this out if the encoder ignores the words of the master.
    exchanges:
      - {request: position_request, reply: position_reply, purpose: position}
      - {request: read_request, reply: register_reply, purpose: read}
      - {request: write_request, reply: register_reply, purpose: write}
      - {request: write_data, reply: register_reply, purpose: write}
    # Fields in the order sent, most significant first. Each layout has the word_bits of its exchange.
    layouts:
      - name: position_request
        from: master
        source: "5.2"
        fields:
          # Even parity. It covers all other fields of the word. For odd parity, add parity: odd.
          - {name: parity, parity_of: [read, address]}
          - {name: read, bits: 1, constant: 1, meaning: 1 to read and 0 to write}
          - {name: address, bits: 14, constant: 0x3FFF, meaning: Address of the position}
      - name: read_request
        from: master
        source: "5.2"
        fields:
          - {name: parity, parity_of: [read, address]}
          - {name: read, bits: 1, constant: 1, meaning: 1 to read and 0 to write}
          - {name: address, bits: 14, meaning: Address of the register}
      - name: write_request
        from: master
        source: "5.2"
        fields:
          - {name: parity, parity_of: [read, address]}
          - {name: read, bits: 1, constant: 0, meaning: 1 to read and 0 to write}
          - {name: address, bits: 14, meaning: Address of the register}
      - name: write_data
        from: master
        source: "5.2"
        fields:
          - {name: parity, parity_of: [zeros, data]}
          - {name: zeros, bits: 7, constant: 0}
          - {name: data, bits: 8, meaning: Value to write}
      - name: position_reply
        from: encoder
        source: "5.3"
        fields:
          - {name: parity, parity_of: [error, position]}
          - {name: error, active: high, makes_position: not_usable, when_active: the encoder reports an error}
          - {name: position, bits: 14, unit: counts, meaning: Position within one revolution}
          # Instead of the parity: a CRC that covers the fields before it. Describe it under crcs.
          # - {name: crc, crc: spi_8}
      - name: register_reply
        from: encoder
        source: "5.3"
        fields:
          - {name: parity, parity_of: [error, zeros, data]}
          - {name: error, active: high, when_active: the encoder reports an error}
          - {name: zeros, bits: 6, constant: 0}
          - {name: data, bits: 8, meaning: Value of the register}

# crcs:
#   - {name: spi_8, width: 8, poly: 0x07, init: 0, refin: false, refout: false, xorout: 0, source: "5.4"}

# ------------------------------------------------------------------------------------------------------------ registers

registers:
  - name: diagnostics
    printed_name: Diagnostics
    meaning: State of the sensor
    interface: spi
    address: 0x3FFC
    length: 1                             # bytes of the value. A register has a single address, whatever its length
    access: read_only                     # read_write, write_only
    other_bits: unspecified
    fields:
      - {name: field_weak, at: 7, active: high, when_active: the magnetic field is too weak}
      - {name: gain, at: 3:0, meaning: Value of the gain control}
    source: "6.1"

  - name: zero_position
    printed_name: Zero position
    meaning: Upper 8 bits of the position that becomes 0
    interface: spi
    address: 0x0016
    length: 1
    access: read_write
    default: 0
    source: "6.2"

procedures:
  - name: set_zero
    title: Set the zero position
    interface: spi
    arguments: [{name: position, of: zero_position, meaning: Upper 8 bits of the position that becomes 0}]
    steps:                                # each accesses a whole register
      - {do: write, register: zero_position, value: position, meaning: write the zero position}
      - {do: read, register: zero_position, meaning: check the value}
    source: "6.2"

"""

SPI_EXAMPLES = """\
examples:
  - name: position
    kind: frame                           # frame, register, crc, procedure, measure
    layout: position_reply
    order_code: @CODE@-SP
    from: encoder
    bits: "0000001111101000"              # 1000 counts, no error
    values: {position: 1000}
    source: "5.3"
  - name: read_diagnostics
    kind: frame
    layout: read_request
    order_code: @CODE@-SP
    from: master
    bits: "1111111111111100"
    values: {address: 0x3FFC}
    source: "5.2"

"""
