"""Specs at the limits of rules: each rule accepts the last valid value, and rejects the first invalid value.

``broken`` has one spec for each rule, well beyond its limit. Here each pair differs by one.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.language.check import check_document
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document

BASE = (Path(__file__).parent / "ok" / "minimal.yaml").read_text(encoding="utf-8")
CLOCK = "clock: {min_hz: 200000, max_hz: 10000000,"
CRC = "poly: 0x03, init: 0,"
CODE_OF_16 = '"16": {sets: {position_bits: 16}}'
INTERFACE = "        SC: {interface: biss}\n"
MANUAL = 'manual: {title: Minimal encoder, revision: "1.0", language: en}'
LAYOUTS = "    layouts:\n"
BANK = '  - {name: bank, address: 0x40, length: 1, access: read_write, source: "6.3"}\n'
REGISTER = '  - {{name: other, address: {}, length: {}, access: {}, byte_order: high_byte_first, source: "6.3"}}\n'
SPEED = (
    "  - {{name: speed, address: 0x50, length: 1, access: read_write, source: '6.3', fields: "
    "[{{name: speed, at: 3:0, {}}}], other_bits: zero}}\n"
)
FAST = '\n    note: "It runs at 12,000,000 baud."'
STORE = "write, register: command, field: command, value: store"
GO = "write, register: command, field: command, value: go"
WRITE = "write, register: preset, value: preset"
Change = tuple[str, str]


def rs485(baud: int, keys: str = "") -> Change:
    """Return the change that adds a serial interface with this rate."""
    text = f"""  rs485:
    source: "6"{keys}
    port: {{baud: {baud}, data_bits: 8, parity: none, stop_bits: 1, source: "6"}}
    layouts:
      - {{name: reply, from: encoder, byte_order: low_byte_first, source: "6", fields: [{{name: position, bits: 16}}]}}
registers:
"""
    return "registers:\n", text


def serial_bit(sender: str) -> Change:
    """Return the change that adds a serial interface with a bit that is called an error."""
    old, new = rs485(1_000_000)
    request = f"{{name: bit, from: {sender}, byte_order: low_byte_first, source: '6', fields: [{{name: error, bits: 1}}"
    return old, new.replace("registers:", f"      - {request}, {{name: fill, bits: 7}}]}}\nregisters:")


def signals(name: str) -> Change:
    return LAYOUTS, f"    signals: {name} lines\n{LAYOUTS}"


def lost_figures(numbers: str) -> list[Change]:
    """Return the changes that list these figures as lost, and add a text about Figure 3."""
    lost = f'lost_figures: [{{content: "Figures {numbers}", source: "6"}}]\nregisters:\n'
    return [(LAYOUTS, f"    note: See Figure 3.\n{LAYOUTS}"), ("registers:\n", lost)]


def timeout(rule: str) -> Change:
    return LAYOUTS, f'    timeout: {{{rule}, source: "6"}}\n{LAYOUTS}'


def follows_clock(half_periods: int, clock_hz: int, timeout_ns: int) -> Change:
    printed = f"printed: [{{clock_hz: {clock_hz}, timeout_ns: {timeout_ns}}}]"
    return timeout(f"rule: follows_clock, half_clock_periods: {half_periods}, {printed}")


def timing(bounds: str) -> Change:
    return LAYOUTS, f'    timings: [{{name: pause, {bounds}, meaning: Pause, source: "6"}}]\n{LAYOUTS}'


def supply(low: int, high: int) -> Change:
    return "crcs:\n", f'supply: {{min_mv: {low}, max_mv: {high}, source: "2"}}\ncrcs:\n'


def history(first: str, second: str, own: str) -> Change:
    text = f"""manual:
  title: Minimal encoder
  revision: "1.1"
  date: {own}
  language: en
  history: [{{revision: "1.0", date: {first}, changes: A}}, {{revision: "1.1", date: {second}, changes: B}}]"""
    return MANUAL, text


def register(address: int, length: int, access: str = "read_write") -> Change:
    return BANK, BANK + REGISTER.format(f"{address:#04x}", length, access)


def noted(text: str) -> Change:
    return BANK, BANK.replace("source:", f"note: {text}, source:")


def note_of_crc(text: str) -> Change:
    return "xorout: 0x3F,", f"xorout: 0x3F, note: The manual prints {text}.,"


def steps(limit: str) -> Change:
    field = "fields: [{name: steps, at: 7:0, zero_means: 256}]"
    return (
        BANK,
        f'{BANK}  - {{name: steps, address: 0x50, length: 1, access: read_write, {limit}, source: "6", {field}}}\n',
    )


def bytes_in_order(length: str) -> Change:
    return BANK, f'{BANK}  - {{name: number, address: 0x50, {length}, access: read_write, source: "6.3"}}\n'


def speed(field: str) -> Change:
    return BANK, BANK + SPEED.format(field)


def in_bank(address: int, length: int) -> list[Change]:
    register_in_bank = REGISTER.format(f"{address:#04x}, bank: 1", length, "read_write")
    return [(BANK, BANK + register_in_bank), (LAYOUTS, f"    bank_select: bank\n{LAYOUTS}")]


def procedure(*steps: str) -> Change:
    """Return the change that adds a procedure, and registers for a command with a wait and for an opened number."""
    text = """  - {name: key, address: 0x48, length: 1, access: read_write, source: "6.3", fields: [{name: key, at: 7:0,
     values: {locked: {value: 0}, unlocked: {value: 90}}}]}
  - {name: preset, address: 0x50, length: 1, access: read_write, source: "6.3",
     opened_by: {register: key, value: unlocked}}
  - {name: command, address: 0x51, length: 1, access: read_write, wait_at_least_ms: 10, source: "6.3",
     fields: [{name: run, at: 0, active: high}, {name: command, at: 7:1, values: {store: {value: 1}, go: {value: 2}}}]}
procedures:
  - name: store_it
    title: Store it
    interface: biss
    source: "6"
    arguments: [{name: preset, of: preset}]
    steps:
      - {do: write, register: preset, value: preset}
"""
    return BANK, BANK + text + "".join(f"      - {{do: {step}}}\n" for step in steps)


def open_part(expression: str) -> Change:
    part = "    - name: serial\n      meaning: Serial number\n"
    part += f'      open: "{expression}"\n      values: {{S: {{meaning: None}}}}\n'
    return "crcs:\n", f"{part}crcs:\n"


#: Changes that the rule accepts, changes that it refuses, the rule, and a part of its message.
LIMITS: dict[str, tuple[list[list[Change]], list[list[Change]], str, str]] = {
    "start of a CRC of 6 bits": (
        [[(CRC, "poly: 0x03, init: 0x3F,")]],
        [[(CRC, "poly: 0x03, init: 0x40,")]],
        "crc-impossible",
        "'init' is 0x40, which does not fit into 6 bits",
    ),
    "polynomial of 6 bits with its top bit": (
        [[(CRC, "poly: 0x3F, init: 0,")], [(CRC, "poly: 0x1, init: 0,")]],
        [[(CRC, "poly: 0x43, init: 0,")]],
        "crc-impossible",
        "the polynomial 0x43 does not fit into 6 bits; omit the top bit: 0x3",
    ),
    "polynomial of 8 bits": (
        [],
        [[(CRC, "poly: 0x83, init: 0,")]],
        "crc-impossible",
        "the polynomial 0x83 does not fit into 6 bits$",
    ),
    "even polynomial": ([], [[(CRC, "poly: 0x02, init: 0,")]], "crc-impossible", "the polynomial 0x2 is even"),
    # 10,000,000 / 200 is 50,000, below which 49 is more likely to be MHz than kHz.
    "highest clock": (
        [[(CLOCK, "clock: {min_hz: 50000, max_hz: 50000,")]],
        [[(CLOCK, "clock: {min_hz: 49, max_hz: 49999,")]],
        "implausible-rate",
        "if the manual means 49999 kHz, write 49999000",
    ),
    "highest clock in MHz": (
        [],
        [[(CLOCK, "clock: {min_hz: 1, max_hz: 49,")]],
        "implausible-rate",
        "if the manual means 49 MHz, write 49000000",
    ),
    "highest clock in kHz": (
        [],
        [[(CLOCK, "clock: {min_hz: 1, max_hz: 50,")]],
        "implausible-rate",
        "if the manual means 50 kHz, write 50000",
    ),
    "lowest clock": (
        [[(CLOCK, "clock: {min_hz: 1000, max_hz: 10000000,")], [(CLOCK, "clock: {max_hz: 10000000,")]],
        [[(CLOCK, "clock: {min_hz: 999, max_hz: 10000000,")]],
        "implausible-rate",
        "'min_hz' is 999 Hz, which is implausible; if the manual means 999 kHz, write 999000",
    ),
    "highest baud rate": (
        [[rs485(10_000_000)], [rs485(12_000_000, FAST)]],
        [[rs485(12_000_000)], [rs485(12_000_000, FAST.replace("12,000,000", "1,200,000"))]],
        "implausible-rate",
        "say in a 'note' of the interface that it is 12000000 baud$",
    ),
    "standards of lines": (
        [[signals(name)] for name in ("RS-644", "RS-485", "TIA-899")],
        [[signals(name)] for name in ("RS-458", "RS 899")],
        "unknown-standard",
        "is not a known standard; expected one such as RS-422 or RS-485",
    ),
    "figures in a text": (
        [lost_figures("1 to 3"), lost_figures("1 to 99999999999, 3")],
        [lost_figures("1 to 2"), lost_figures("1 to 99999999999")],
        "figure-number",
        "'lost_figures' has no Figure 3; correct the number, or add the figure$",
    ),
    "lowest baud rate": ([[rs485(300)]], [[rs485(299)]], "implausible-rate", "'baud' is 299 baud"),
    "rates near a standard baud rate": (
        [],
        [[rs485(115)]],
        "implausible-rate",
        "if the manual means 115 kbaud, write 115200",
    ),
    "baud rate that is not a standard one": (
        [],
        [[rs485(116)]],
        "implausible-rate",
        "if the manual means 116 kbaud, write 116000",
    ),
    "order of the limits of a clock": (
        [[(CLOCK, "clock: {min_hz: 200000, max_hz: 200000,")]],
        [[(CLOCK, "clock: {min_hz: 200001, max_hz: 200000,")]],
        "clock-range",
        "'min_hz' (200001) is above 'max_hz' (200000)",
    ),
    "supply": (
        [[supply(5000, 5000)], [supply(4999, 5000)]],
        [[supply(5001, 5000)]],
        "supply-range",
        "'min_mv' (5001) is above 'max_mv' (5000)",
    ),
    "order of the bounds of a timing": (
        [[timing("at_least_us: 5, typical_us: 5, at_most_us: 5")], [timing("at_least_us: 5, at_most_us: 5")]],
        [[timing("at_least_us: 6, typical_us: 6, at_most_us: 5")]],
        "timing-order",
        "'at_most_us' (5) is less than 'typical_us' (6)",
    ),
    "typical value below the lowest": (
        [],
        [[timing("at_least_us: 6, typical_us: 5")]],
        "timing-order",
        "'typical_us' (5) is less than 'at_least_us' (6)",
    ),
    # 3 half periods at 10 MHz are 3 / 2 x 100 ns.
    "timeout of whole nanoseconds": (
        [[follows_clock(3, 10_000_000, 150)]],
        [[follows_clock(3, 10_000_000, 149)], [follows_clock(3, 10_000_000, 151)]],
        "timeout-mismatch",
        "3 half periods at 10000000 Hz are 150 ns, not ",
    ),
    # 3 half periods at 7 MHz are 214.28 ns.
    "timeout rounded to nanoseconds": (
        [[follows_clock(3, 7_000_000, 214)]],
        [[follows_clock(3, 7_000_000, 213)], [follows_clock(3, 7_000_000, 215)]],
        "timeout-mismatch",
        "3 half periods at 7000000 Hz are 214 ns, not ",
    ),
    # A half period at 8 MHz is 62.5 ns, which may be rounded up or down.
    "timeout between two nanoseconds": (
        [[follows_clock(1, 8_000_000, 62)], [follows_clock(1, 8_000_000, 63)]],
        [[follows_clock(1, 8_000_000, 61)], [follows_clock(1, 8_000_000, 64)]],
        "timeout-mismatch",
        "1 half periods at 8000000 Hz are 63 ns, not ",
    ),
    # 2 half periods at 200 kHz are 5 us.
    "timeout at the lowest clock": (
        [[follows_clock(2, 200_000, 5000)]],
        [[follows_clock(2, 199_999, 5000)]],
        "timeout-mismatch",
        "the clock is 200000 to 10000000 Hz, so there is no timeout at 199999 Hz",
    ),
    "timeout at the highest clock": (
        [[follows_clock(2, 10_000_000, 100)]],
        [[follows_clock(2, 10_000_001, 100)]],
        "timeout-mismatch",
        "the clock is 200000 to 10000000 Hz, so there is no timeout at 10000001 Hz",
    ),
    "limit of a timeout that follows the clock": (
        [[timeout("rule: follows_clock, typical_ns: 150")], [timeout("rule: follows_clock, at_most_ns: 2500")]],
        [[timeout("rule: follows_clock")]],
        "timeout-mismatch",
        "a timeout that depends on the clock needs 'half_clock_periods'",
    ),
    "limit of a fixed timeout": (
        [[timeout("rule: fixed, typical_ns: 150")], [timeout("rule: fixed, at_most_ns: 2500")]],
        [[timeout("rule: fixed")]],
        "timeout-mismatch",
        "a fixed timeout needs 'at_most_ns' or 'typical_ns'",
    ),
    "order of revisions": (
        [[history("2020-05-04", "2020-05-04", "2020-05-04")], [history("2020-05-03", "2020-05-04", "2020-05-04")]],
        [[history("2020-05-04", "2020-05-03", "2020-05-03")]],
        "date",
        "revision 1.1 is dated 2020-05-03, before revision 1.0, dated 2020-05-04",
    ),
    "days of February": (
        [[history("2020-02-29", "2020-05-04", "2020-05-04")]],
        [[history("2019-02-29", "2020-05-04", "2020-05-04")]],
        "date",
        "'2019-02-29' is not a valid date",
    ),
    # BiSS has registers at 42h to 47h and from 78h (BiSS C protocol description, register map).
    "before the serial number": (
        [[register(0x3F, 1)], [register(0x48, 1)], [register(0x77, 1)]],
        [[register(0x43, 1)]],
        "biss-protocol",
        "'other' is at 43h, but BiSS has 'profile_id' at 42h and 43h",
    ),
    "end of the serial number": (
        [[register(0x44, 4, "read_only")], [register(0x47, 1, "read_only")]],
        [[register(0x47, 1)], [register(0x44, 1)]],
        "biss-protocol",
        "h, but BiSS has 'serial_number' at 44h to 47h",
    ),
    "across the end of the serial number": (
        [],
        [[register(0x47, 2, "read_only")]],
        "biss-protocol",
        "'other' is at 47h to 48h, but BiSS has 'serial_number' at 44h to 47h",
    ),
    "across the start of the device identifier": (
        [[register(0x76, 2)], [register(0x78, 6, "read_only")]],
        [[register(0x76, 3, "read_only")]],
        "biss-protocol",
        "'other' is at 76h to 78h, but BiSS has 'device_id' at 78h to 7Dh",
    ),
    "end of the device identifier": (
        [],
        [[register(0x7D, 1)]],
        "biss-protocol",
        "'other' is at 7Dh, but BiSS has 'device_id' at 78h to 7Dh",
    ),
    "start of the manufacturer identifier": (
        [[register(0x7E, 2, "read_only")]],
        [[register(0x7E, 1)], [register(0x7F, 1)]],
        "biss-protocol",
        "h, but BiSS has 'manufacturer_id' at 7Eh and 7Fh",
    ),
    # A bank has 64 registers.
    "last register of a bank": (
        [in_bank(0x3F, 1), in_bank(0x3E, 2)],
        [in_bank(0x3F, 2), in_bank(0x40, 1)],
        "register-range",
        "'other' extends to 0x40, but a bank of BiSS ends at 0x3f",
    ),
    "value of a field of 4 bits": (
        [[speed("values: {fast: {value: 15}}")], [speed("constant: 0xF")]],
        [[speed("values: {fast: {value: 16}}")]],
        "value-too-wide",
        "the value 'fast' is 0x10, which does not fit into 4 bits",
    ),
    "constant of 4 bits": ([], [[speed("constant: 0x10")]], "value-too-wide", "'constant' is 0x10, which does not fit"),
    # 100 mm are 3.937 in. A repetition may differ by a hundredth, or by its last digit.
    "length in inches": (
        [[noted("100 mm is 3.90 in")], [noted("100 mm is 3.9 in")], [noted("100 mm is 3.97 in")]],
        [[noted("100 mm is 3.89 in")], [noted("100 mm is 3.98 in")]],
        "quantity-text",
        "100 mm is 3.937 in, not 3.",
    ),
    # 20 degrees Celsius are 68 degrees Fahrenheit, or 36 as a difference.
    "temperature in Fahrenheit": (
        [[noted("20 °C is 68 °F")], [noted("20 °C is 36 °F")], [noted("20 °C is 36.5 °F")]],
        [[noted("20 °C is 36.6 °F")], [noted("20 °C is 66 °F")]],
        "quantity-text",
        "20 °C is 68 °F, not ",
    ),
    # A CRC of 6 bits has a polynomial of 7 bits, 40h to 7Fh, that ends in + 1.
    "polynomial in a note": (
        [[note_of_crc(text)] for text in ("x^6 + x + 1", "x^8 + x^2 + 1", "x^6 + x^2", "0x43", "0x44", "0x81", "0x3F")],
        [[note_of_crc(text)] for text in ("x^6 + x^2 + 1", "0x45", "0x7F", "0x41")],
        "printed-number",
        "but 'poly' is 0x3, or 0x43 with its top bit",
    ),
    "number for which zero stands": (
        [[steps("max: 255")], [steps("max: 256")]],
        [[steps("max: 254")]],
        "limit-does-not-fit",
        "zero stands for 256, which is above 'max' (254)",
    ),
    "overlapping registers": (
        [[register(0x3E, 2)], [register(0x41, 1)]],
        [[register(0x3E, 3)], [register(0x40, 1)]],
        "duplicate-address",
        "",
    ),
    "registers of several bytes": (
        [[register(0x50, 1, "read_write, note: x")], [bytes_in_order("length: 1")]],
        [[bytes_in_order("length: 2")]],
        "byte-order-missing",
        "",
    ),
    "bit of a master's request": (
        [[serial_bit("master")]],
        [[serial_bit("encoder")]],
        "plain-bit",
        "'error'",
    ),
    "wait after a command": (
        [
            [procedure(STORE, "wait, at_least_ms: 10", GO, "wait, at_least_ms: 10")],
            [procedure(STORE, "wait, at_least_ms: 4", "wait, at_least_ms: 6", GO)],
            [procedure(STORE, "poll, register: command, field: run, until: 0", GO)],
            [procedure(STORE)],
            [procedure(STORE, "read, register: key")],
        ],
        [
            [procedure(STORE, "wait, at_least_ms: 9", GO)],
            [procedure(STORE, "wait, at_least_ms: 4", "wait, at_least_ms: 5", GO)],
            [procedure(STORE, "wait, at_least_ms: 9")],
            [procedure(STORE, GO, "wait, at_least_ms: 10")],
            [procedure(STORE, GO, "poll, register: command, field: run, until: 0")],
        ],
        "wait-too-short",
        "'command' needs a wait of 10 ms after a write, but ",
    ),
    "register that another one opens": (
        [
            [procedure()],
            [procedure("write, register: key, value: unlocked", WRITE)],
            [procedure("write, register: key, value: locked", "write, register: key, value: unlocked", WRITE)],
            [procedure("write, register: key, value: preset", WRITE)],
            [procedure("write, register: key, value: locked", "read, register: preset")],
            [procedure(WRITE, "write, register: key, value: locked")],
        ],
        [
            [procedure("write, register: key, value: locked", WRITE)],
            [procedure("write, register: key, value: unlocked", "write, register: key, value: locked", WRITE)],
        ],
        "not-opened",
        "'preset' must be unlocked by writing 'unlocked' to 'key', but 'locked' was written there",
    ),
    "repetitions of an open part": (
        [[open_part("[0-9]+[A-Z]+[0-9]+"), ("{output}", "{output}{serial}")]],
        [[open_part("[0-9]+[A-Z]+[0-9]+[A-Z]+"), ("{output}", "{output}{serial}")]],
        "order-code-pattern",
        "is not a valid regular expression: more than three repetitions",
    ),
}


def problems(folder: Path, changes: list[Change]) -> list[tuple[str, str]]:
    """Return the rules and messages of all problems in the base spec with these changes."""
    text = BASE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    (folder / "minimal.yaml").write_text(text, encoding="utf-8")
    report = ProblemReport()
    document = read_document(folder / "minimal.yaml", report, "minimal.yaml")
    assert document is not None
    check_document(document, report)
    return [(problem.rule, problem.message) for problem in report.problems]


VALID = [(name, index) for name, (valid, _, _, _) in LIMITS.items() for index in range(len(valid))]
INVALID = [(name, index) for name, (_, invalid, _, _) in LIMITS.items() for index in range(len(invalid))]


@pytest.mark.parametrize(("name", "index"), VALID)
def test_the_last_valid_value_is_accepted(tmp_path: Path, name: str, index: int) -> None:
    valid, _, rule, _ = LIMITS[name]
    # The serial interface has no order code and no request.
    is_serial = any("rs485" in new for _, new in valid[index])
    of_rs485 = {"order-code-pattern", "rs485-exchange"} if is_serial else set()
    assert [problem for problem in problems(tmp_path, valid[index]) if problem[0] not in of_rs485] == []
    assert rule not in of_rs485


@pytest.mark.parametrize(("name", "index"), INVALID)
def test_the_first_invalid_value_is_refused(tmp_path: Path, name: str, index: int) -> None:
    _, invalid, rule, words = LIMITS[name]
    messages = [message for named_rule, message in problems(tmp_path, invalid[index]) if named_rule == rule]
    assert len(messages) == 1
    assert words.rstrip("$") in messages[0]
    assert not words.endswith("$") or messages[0].endswith(words[:-1])
