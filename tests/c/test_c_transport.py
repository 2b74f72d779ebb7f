"""Registers by name and procedures through a transport: accesses, results, and contents of a failure.

Every record is written by hand from the manuals, with the sections next to each procedure. A line is ``STEP: ACCESS``.
If an access is only a part of its step, the kind of the step is before the colon, and its address if the access has
none.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import pytest
from c_harness import FAMILIES, views_of
from codewheel.model import Device
from transport_harness import (
    CLOSE,
    CONSTANT,
    CRC,
    LENGTH,
    MORE,
    OK,
    POLL,
    RANGE,
    READ,
    SEND,
    TIMEOUT,
    TRANSPORT,
    UNSUPPORTED,
    UNTOUCHED,
    VERIFY,
    VERIFY_STEP,
    WAIT,
    WRITE,
    Encoder,
    Machine,
)

KINDS = {"w": WRITE, "wait": WAIT, "send": SEND, "r": READ}
KINDS |= {"write": WRITE, "poll": POLL, "close": CLOSE, "verify": VERIFY_STEP}
#: Addresses of commands: AM36 and SMA21 48h, AMM5 77h. 40h opens AMM5's preset.
COMMANDS, OPENS = ("w 48", "w 77"), "w 40"


@dataclass(frozen=True)
class Case:
    """A procedure, the registers before it, and the accesses that the encoder sees."""

    family: str
    code: str
    procedure: str
    record: str
    arguments: tuple[int, ...] = ()
    before: tuple[tuple[int, int], ...] = ()
    #: Successive values of 60h when it is read.
    status: tuple[int, ...] = ()
    reads: str = ""

    @property
    def lines(self) -> list[tuple[str, tuple[int, int, int, int]]]:
        """Each access, and the step, kind, call and address that are reported if it fails."""
        accesses = []
        for line in (line.strip() for line in self.record.strip().splitlines()):
            match = re.fullmatch(r"(\d+)(?: (\w+))?(?: ([0-9A-F]{2}))?: ((\w+)(?: ([0-9A-F]+))?.*)", line)
            assert match is not None, line
            step, kind, place, access, verb, first = match.groups()
            address = place or (first if verb in ("r", "w") else "0")
            accesses.append((access, (int(step), KINDS[kind or verb], KINDS[verb], int(address, 16))))
        return accesses

    def closing(self, failed: int) -> tuple[list[str], bool]:
        """Return the accesses that close the open register after this failure, and True if it stays open."""
        at = next((index for index, (_, failure) in enumerate(self.lines) if failure[1] == CLOSE), -1)
        return ([self.lines[at][0]] if failed < at else []), failed == at

    def encoder(self) -> Encoder:
        encoder = Encoder()
        for address, value in self.before:
            encoder.memory[address] = value
        if self.status:
            statuses = list(self.status)

            def answer(address: int) -> None:
                if address == 0x60:
                    encoder.memory[0x60] = statuses.pop(0)

            encoder.before_read = answer
            encoder.polls = (9, 250)
        return encoder


def ten_times(request: str, first: int = 0) -> str:
    """Ten requests, 40 us from one to the next (AMM5 7.4.2, SMA21 7.3.3.2)."""
    return f"\n{first} send: wait 40\n".join([f"{first}: send {request}"] * 10)


CASES = [
    # AMM5 6.4: the example of the manual, 1,000,003 with 21 bits. 30 ms after each command.
    Case(
        "amm5",
        "AMM5A21/65KSC1",
        "set_preset",
        """
        0: w 40 01
        1: w 11 00
        2: w 12 30
        3: w 13 24
        4: w 14 F4
        5: w 15 00
        6: w 16 00
        7: w 17 00
        8 verify: r 11 1
        9 verify: r 12 1
        10 verify: r 13 1
        11 verify: r 14 1
        12 verify: r 15 1
        13 verify: r 16 1
        14 verify: r 17 1
        15 close: w 40 00
        16: w 77 01
        17: wait 30000
        18: w 77 02
        19: wait 30000""",
        (1000003,),
    ),
    Case(
        "amm5",
        "AMM5A21/65KSC1",
        "store_preset",
        """
        0: w 40 01
        1: w 11 00
        2: w 12 30
        3: w 13 24
        4: w 14 F4
        5: w 15 00
        6: w 16 00
        7: w 17 00
        8 verify: r 11 1
        9 verify: r 12 1
        10 verify: r 13 1
        11 verify: r 14 1
        12 verify: r 15 1
        13 verify: r 16 1
        14 verify: r 17 1
        15 close: w 40 00
        16: w 77 01
        17: wait 30000""",
        (1000003,),
    ),
    Case("amm5", "AMM5A21/65KSC1", "save_parameters", "0: w 77 01\n1: wait 30000"),
    Case("amm5", "AMM5A21/65KSC1", "activate_preset", "0: w 77 02\n1: wait 30000"),
    # AMM5 7.3.1 has the control fields, 7.4.2 the times.
    Case("amm5", "AMM5A23/65KJP1", "reset_singleturn_and_multiturn", ten_times("C2") + "\n1: wait 18000"),
    Case("amm5", "AMM5A23/65KJP1", "reset_multiturn_and_errors", ten_times("62") + "\n1: wait 2000"),
    Case("amm5", "AMM5A23/65KJP1", "reset_errors", ten_times("BA") + "\n1: wait 2000"),
    # AM36 6.5: 60h is the manual's example of the configuration, 100,000 its example of the preset. Bit 2 of 49h at 0
    # enables the preset.
    Case(
        "am36",
        "AM3616/4096-I7",
        "set_configuration",
        "0: w 49 60\n1 verify: r 49 1\n2: w 48 01\n3: wait 30000",
        (0x60,),
    ),
    Case(
        "am36",
        "AM3616/4096-I7",
        "set_preset",
        """
        0 write: r 49 1
        0: w 49 60
        1: w 50 00
        2: w 51 00
        3: w 52 01
        4: w 53 86
        5: w 54 A0
        6 verify: r 49 1
        7 verify: r 50 1
        8 verify: r 51 1
        9 verify: r 52 1
        10 verify: r 53 1
        11 verify: r 54 1
        12: w 48 02
        13: wait 30000""",
        (100000,),
        ((0x49, 0x64),),
    ),
    Case(
        "am36",
        "AM3616/4096-I7",
        "store_preset",
        """
        0 write: r 49 1
        0: w 49 20
        1: w 50 00
        2: w 51 00
        3: w 52 01
        4: w 53 86
        5: w 54 A0
        6 verify: r 49 1
        7 verify: r 50 1
        8 verify: r 51 1
        9 verify: r 52 1
        10 verify: r 53 1
        11 verify: r 54 1
        12: w 48 01
        13: wait 30000""",
        (100000,),
        ((0x49, 0x20),),
    ),
    Case("am36", "AM3616/4096-I7", "save_parameters", "0: w 48 01\n1: wait 30000"),
    Case("am36", "AM3616/4096-I7", "activate_preset", "0: w 48 02\n1: wait 30000"),
    Case("am36", "AM3616/4096-I7", "restore_defaults", "0: w 48 04\n1: wait 30000"),
    # 4,096 = 001000h in 4Bh to 4Dh. 65,536 revolutions are written as 00 00. 1,000 = 3E8h.
    Case(
        "am36",
        "AM3616/4096-I7",
        "set_resolution",
        """
        0: w 4B 00
        1: w 4C 10
        2: w 4D 00
        3: w 4E 00
        4: w 4F 00
        5 verify: r 4B 1
        6 verify: r 4C 1
        7 verify: r 4D 1
        8 verify: r 4E 1
        9 verify: r 4F 1
        10: w 48 01
        11: wait 30000
        12 write: r 49 1
        12: w 49 20
        13: w 50 00
        14: w 51 00
        15: w 52 00
        16: w 53 03
        17: w 54 E8
        18 verify: r 49 1
        19 verify: r 50 1
        20 verify: r 51 1
        21 verify: r 52 1
        22 verify: r 53 1
        23 verify: r 54 1
        24: w 48 02
        25: wait 30000
        26: r 56 2""",
        (4096, 65536, 1000),
        ((0x49, 0x24), (0x56, 12), (0x57, 16)),
        reads="0C 10",
    ),
    Case(
        "am36",
        "AM3616/4096-I7",
        "identify",
        """
        0: r 7E 2
        2: r 78 6
        8: r 42 2
        10: r 55 1
        11: r 44 4
        15: r 56 2""",
        reads="7E 7F 78 79 7A 7B 7C 7D 42 43 55 44 45 46 47 56 57",
    ),
    # ASC85 6.4: commands 00 to 06 in 60h, status bits 0 (position), 1 (absolute data), 2 (bus busy),
    # 7 (configuration completed).
    Case(
        "asc85",
        "ASC8525/SC1",
        "request_position",
        """
        0: w 60 00
        1 poll: r 60 1
        1 poll 60: wait 250
        1 poll: r 60 1
        2: r 61 4""",
        status=(0xFE, 0x01),
        reads="61 62 63 64",
    ),
    Case(
        "asc85",
        "ASC8525/SC1",
        "save_configuration",
        """
        0: w 60 01
        1 poll: r 60 1
        1 poll 60: wait 250
        1 poll: r 60 1
        2: r 69 1""",
        status=(0x04, 0xFB),
        reads="69",
    ),
    Case(
        "asc85",
        "ASC8525/SC1",
        "read_absolute_data",
        """
        0: w 60 02
        1 poll: r 60 1
        1 poll 60: wait 250
        1 poll: r 60 1
        1 poll 60: wait 250
        1 poll: r 60 1
        2: r 69 1""",
        status=(0x01, 0xFD, 0x02),
        reads="69",
    ),
    Case(
        "asc85",
        "ASC8525/SC1",
        "software_reset",
        """
        0: w 60 03
        1 poll: r 60 1
        1 poll 60: wait 250
        1 poll: r 60 1
        2: r 69 1""",
        status=(0x7F, 0x80),
        reads="69",
    ),
    Case(
        "asc85",
        "ASC8525/SC1",
        "verify_configuration",
        "0: w 60 04\n1 poll: r 60 1\n2: r 69 1",
        status=(0x00,),
        reads="69",
    ),
    Case("asc85", "ASC8525/SC1", "simulate_error", "0: w 60 05\n1: r 60 1", status=(0x40,), reads="40"),
    Case("asc85", "ASC8525/SC1", "clear_simulated_error", "0: w 60 06\n1: r 60 1", status=(0x00,), reads="00"),
    # Reading out the position resets the messages.
    Case(
        "asc85",
        "ASC8525/SC1",
        "reset_errors",
        "0: r 69 1\n1: r 5A 1\n2: r 61 4\n6: r 69 1",
        reads="69 5A 61 62 63 64 69",
    ),
    Case(
        "asc85",
        "ASC8525/SC1",
        "identify",
        "0: r 7E 2\n2: r 78 6\n8: r 42 6",
        reads="7E 7F 78 79 7A 7B 7C 7D 42 43 44 45 46 47",
    ),
    # SMA21 6.4 and 6.6: 60h and 100,000 are the manual's examples.
    # In 49h bit 2 at 0 enables, bit 1 selects preset (0) or offset (1).
    Case(
        "sma21",
        "SMA21-SC1-0050",
        "set_configuration",
        "0: w 49 60\n1 verify: r 49 1\n2: w 48 01\n3: wait 30000",
        (0x60,),
    ),
    Case(
        "sma21",
        "SMA21-SC1-0050",
        "set_preset",
        """
        0: w 50 00
        1: w 51 01
        2: w 52 86
        3: w 53 A0
        4 verify: r 50 1
        5 verify: r 51 1
        6 verify: r 52 1
        7 verify: r 53 1
        8: w 48 02
        9: wait 30000""",
        (100000,),
    ),
    Case(
        "sma21",
        "SMA21-SC1-0050",
        "select_preset",
        """
        0 write: r 49 1
        0: w 49 62
        1 write: r 49 1
        1: w 49 60
        2 verify: r 49 1
        3 verify: r 49 1
        4: w 48 01
        5: wait 30000""",
        (),
        ((0x49, 0x66),),
    ),
    Case(
        "sma21",
        "SMA21-SC1-0050",
        "set_offset",
        """
        0 write: r 49 1
        0: w 49 20
        1 write: r 49 1
        1: w 49 22
        2 verify: r 49 1
        3 verify: r 49 1
        4: w 48 01
        5: wait 30000
        6: w 50 00
        7: w 51 00
        8: w 52 00
        9: w 53 64
        10 verify: r 50 1
        11 verify: r 51 1
        12 verify: r 52 1
        13 verify: r 53 1
        14: w 48 02
        15: wait 30000""",
        (100,),
        ((0x49, 0x24),),
    ),
    Case("sma21", "SMA21-SC1-0050", "save_parameters", "0: w 48 01\n1: wait 30000"),
    Case("sma21", "SMA21-SC1-0050", "restore_defaults", "0: w 48 04\n1: wait 30000"),
    Case(
        "sma21",
        "SMA21-SC1-0050",
        "identify",
        "0: r 7E 2\n2: r 78 6\n8: r 42 6",
        reads="7E 7F 78 79 7A 7B 7C 7D 42 43 44 45 46 47",
    ),
    # SMA21 7.3.1 has the control fields.
    Case("sma21", "SMA21-JP1-0005", "reset_errors", ten_times("DA")),
    Case("sma21", "SMA21-JP1-0005", "reset_position", ten_times("7A")),
]


@pytest.fixture(params=["at once", "step by step"])
def tested_machines(
    request: pytest.FixtureRequest, machines: Callable[[str], Machine], stepped_machines: Callable[[str], Machine]
) -> Callable[[str], Machine]:
    """Procedures that wait and those in a main loop do the same."""
    return stepped_machines if request.param == "step by step" else machines


def case_name(case: Case) -> str:
    return f"{case.family}-{case.procedure}"


def test_every_procedure_is_here(every_device: Mapping[str, Device]) -> None:
    tested_procedures = sorted((case.family, case.procedure) for case in CASES)
    devices = [(name, every_device[name]) for name in FAMILIES]
    assert tested_procedures == sorted((name, listed.name) for name, device in devices for listed in device.procedures)
    assert len(tested_procedures) == 33


@pytest.mark.one_in(5, "exhaustive")
@pytest.mark.parametrize("case", CASES, ids=case_name)
def test_a_procedure_does_what_the_manual_says(case: Case, tested_machines: Callable[[str], Machine]) -> None:
    answer = tested_machines(case.family).run(case.procedure, case.code, case.arguments, case.encoder())
    assert answer.record == [access for access, _ in case.lines]
    assert (answer.result, answer.failure) == (OK, UNTOUCHED)
    assert answer.data == bytes.fromhex(case.reads)


@pytest.mark.parametrize("case", CASES, ids=case_name)
def test_every_access_that_fails_is_told(case: Case, tested_machines: Callable[[str], Machine]) -> None:
    machine = tested_machines(case.family)
    for index, (_, failure) in enumerate(case.lines):
        if machine.stepped and failure[2] == WAIT:
            continue
        encoder = case.encoder()
        encoder.fail_at, encoder.error = index, -1000 - index
        answer = machine.run(case.procedure, case.code, case.arguments, encoder)
        closing, left_open = case.closing(index)
        accesses = [access for access, _ in case.lines[: index + 1]]
        assert answer.record == [*accesses, *closing], "after a failure nothing is done but closing"
        assert (answer.result, answer.failure, answer.data) == (TRANSPORT, (*failure, -1000 - index), b"")
        assert answer.left_open == left_open


VERIFIED = [case for case in CASES if " verify: " in case.record]


def test_what_is_saved_or_activated_is_read_back() -> None:
    """AM36 6.3, AMM5 6.4, SMA21 6.4: this applies to everything that writes a value, not only to commands."""
    assert sorted(case_name(case) for case in VERIFIED) == [
        *(f"am36-{name}" for name in ("set_configuration", "set_preset", "set_resolution", "store_preset")),
        *(f"amm5-{name}" for name in ("set_preset", "store_preset")),
        *(f"sma21-{name}" for name in ("select_preset", "set_configuration", "set_offset", "set_preset")),
    ]


@pytest.mark.parametrize("case", VERIFIED, ids=case_name)
def test_a_disturbed_value_is_never_saved(case: Case, tested_machines: Callable[[str], Machine]) -> None:
    """In each byte that is written whole, each bit is inverted. The command that depends on it is not sent."""
    disturbed_bits = 0
    for index, (access, failure) in enumerate(case.lines):
        is_first_byte_of_write = index == 0 or case.lines[index - 1][1][:2] != (failure[0], WRITE)
        if not access.startswith("w ") or access.startswith((*COMMANDS, OPENS)) or not is_first_byte_of_write:
            continue
        for bit in range(8):
            encoder = case.encoder()
            encoder.disturbed = {index: 1 << bit}
            answer = tested_machines(case.family).run(case.procedure, case.code, case.arguments, encoder)
            address, read_back = int(access.split()[1], 16), int(access.split()[2], 16) ^ 1 << bit
            verifications = [line for line in case.lines[index:] if line[1][1] == VERIFY_STEP]
            verification = next(line for line in verifications if line[1][3] == address)
            verification_index = case.lines.index(verification, index)
            closing_accesses = ["w 40 00"] if case.family == "amm5" else []
            assert answer.record == [*(line for line, _ in case.lines[: verification_index + 1]), *closing_accesses]
            assert not [line for line in answer.record[index:] if line.startswith(COMMANDS)]
            assert (answer.result, answer.left_open) == (VERIFY, False)
            assert answer.failure == (verification[1][0], VERIFY_STEP, VERIFY_STEP, address, read_back)
            disturbed_bits += 1
    assert disturbed_bits >= 8 or case.procedure == "select_preset"


def test_a_field_that_was_not_stored_is_seen(tested_machines: Callable[[str], Machine]) -> None:
    """SMA21 6.4: bit 2 of 49h enables the preset, and bit 1 selects it. The other bits do not matter."""
    case = next(case for case in CASES if case_name(case) == "sma21-select_preset")
    for place, bit, step in ((1, 0x04, 2), (3, 0x02, 3)):
        encoder = case.encoder()
        encoder.disturbed = {place: bit}
        answer = tested_machines("sma21").run(case.procedure, case.code, (), encoder)
        assert (answer.result, answer.failure[:4]) == (VERIFY, (step, VERIFY_STEP, VERIFY_STEP, 0x49))
        assert not [line for line in answer.record if line.startswith(COMMANDS)]


@pytest.mark.parametrize("case", CASES, ids=case_name)
def test_a_function_that_is_missing_is_told(case: Case, tested_machines: Callable[[str], Machine]) -> None:
    functions = {"read_registers": "r", "write_registers": "w", "wait_us": "wait", "send_request": "send"}
    for name, verb in functions.items():
        if tested_machines(case.family).stepped and verb == "wait":
            continue
        encoder = case.encoder()
        encoder.missing = frozenset((name,))
        answer = tested_machines(case.family).run(case.procedure, case.code, case.arguments, encoder)
        at = next((index for index, (access, _) in enumerate(case.lines) if access.split()[0] == verb), None)
        if at is None:
            assert (answer.result, answer.failure) == (OK, UNTOUCHED)
            continue
        assert (answer.result, answer.failure) == (UNSUPPORTED, (*case.lines[at][1], 0))
        # A register that was opened is closed, unless there is no function for this either.
        closing = case.closing(at)[0] if verb != "w" else []
        assert answer.record == [*(access for access, _ in case.lines[:at]), *closing]


@pytest.mark.parametrize("case", CASES, ids=case_name)
def test_who_does_not_ask_is_not_told(case: Case, tested_machines: Callable[[str], Machine]) -> None:
    if not case.arguments:
        assert (
            tested_machines(case.family).run_without_failure(case.procedure, case.code, Encoder(fail_at=0, error=1))
            == TRANSPORT
        )


def test_the_presets_are_those_that_open_something() -> None:
    """AMM5 6.4 p.35: Preset setting enable opens the Preset registers, and closes them before saving."""
    closing = {(case.family, case.procedure) for case in CASES if case.closing(0)[0]}
    assert closing == {("amm5", "set_preset"), ("amm5", "store_preset")}


def test_what_cannot_be_closed_is_told(tested_machines: Callable[[str], Machine]) -> None:
    """The bus fails from the third of the Preset registers on. Closing is tried once and also fails."""
    encoder = Encoder(fail_at=3, error=-9, fail_on=True)
    answer = tested_machines("amm5").run("set_preset", "AMM5A21/65KSC1", (1000003,), encoder)
    assert answer.record == ["w 40 01", "w 11 00", "w 12 30", "w 13 24", "w 40 00"]
    assert (answer.result, answer.failure, answer.left_open) == (TRANSPORT, (3, WRITE, WRITE, 0x13, -9), True)
    assert encoder.memory[0x40] == 0, "where only the answer was lost, it is closed"


@pytest.mark.parametrize(
    ("family", "code", "procedure", "length", "pause"),
    [
        # AMM5 7.3.2: the reply to data IDs 7, C and F has six bytes. SMA21 7.3.2: to data IDs B and F seven.
        ("amm5", "AMM5A23/65KJP1", "reset_errors", 6, "wait 2000"),
        ("amm5", "AMM5A23/65KJP1", "reset_singleturn_and_multiturn", 6, "wait 18000"),
        ("sma21", "SMA21-JP1-0005", "reset_errors", 7, ""),
    ],
)
def test_a_reply_that_is_not_one_ends_the_requests(
    family: str, code: str, procedure: str, length: int, pause: str, tested_machines: Callable[[str], Machine]
) -> None:
    """A disturbed byte is a CRC error. A reply to another request is not accepted as a reply to this request."""
    machine = tested_machines(family)
    for number in (0, 3, 9):
        for byte in range(length):
            answer = machine.run(procedure, code, (), Encoder(spoilt={(number, byte): 0x20}))
            assert (answer.result, answer.failure) == (CRC, (0, SEND, SEND, 0, 0))
            assert len([line for line in answer.record if line.startswith("send")]) == number + 1
            assert pause not in answer.record or not pause
        to_another = machine.run(procedure, code, (), Encoder(spoilt={(number, 0): 0x20, (number, length - 1): 0x20}))
        assert (to_another.result, to_another.failure) == (CONSTANT, (0, SEND, SEND, 0, 0))
    longer = Encoder(spoilt={(0, length): 0xFF, (10, 0): 0xFF})
    assert machine.run(procedure, code, (), longer).result == OK, "as long as the reply is, and no more requests"


def test_a_poll_gives_up(tested_machines: Callable[[str], Machine]) -> None:
    """Bit 7 of 60h never becomes 1. With a limit of three readings, the transport sees three, and two pauses."""
    encoder = Encoder(polls=(3, 700))
    encoder.before_read = lambda address: encoder.memory.__setitem__(0x60, 0x7F)
    answer = tested_machines("asc85").run("software_reset", "ASC8525/SC1", (), encoder)
    assert answer.record == ["w 60 03", "r 60 1", "wait 700", "r 60 1", "wait 700", "r 60 1"]
    assert (answer.result, answer.failure, answer.data) == (TIMEOUT, (1, POLL, POLL, 0x60, 0), b"")


def test_a_poll_without_a_bound_has_that_of_the_header(tested_machines: Callable[[str], Machine]) -> None:
    encoder = Encoder()
    encoder.before_read = lambda address: encoder.memory.__setitem__(0x60, 0x00)
    answer = tested_machines("asc85").run("request_position", "ASC8525/SC1", (), encoder)
    assert answer.result == TIMEOUT
    assert answer.record.count("r 60 1") == 1000
    assert answer.record.count("wait 1000") == 999


def test_a_poll_without_a_pause_does_not_wait(tested_machines: Callable[[str], Machine]) -> None:
    encoder = Encoder(polls=(2, 0), missing=frozenset(("wait_us",)))
    encoder.before_read = lambda address: encoder.memory.__setitem__(0x60, 0x00)
    answer = tested_machines("asc85").run("request_position", "ASC8525/SC1", (), encoder)
    assert (answer.result, answer.record) == (TIMEOUT, ["w 60 00", "r 60 1", "r 60 1"])


@pytest.mark.parametrize(
    ("family", "code", "procedure", "arguments"),
    [
        ("amm5", "AMM5A21/65KSC1", "set_preset", (1 << 37,)),
        ("am36", "AM3616/4096-I7", "set_resolution", (4095, 1, 0)),
        ("am36", "AM3616/4096-I7", "set_resolution", (4096, 0, 0)),
        ("sma21", "SMA21-SC1-0001", "set_offset", (1,)),
    ],
)
def test_a_wrong_argument_touches_nothing(
    family: str, code: str, procedure: str, arguments: tuple[int, ...], tested_machines: Callable[[str], Machine]
) -> None:
    answer = tested_machines(family).run(procedure, code, arguments)
    assert (answer.result, answer.failure, answer.record) == (RANGE, UNTOUCHED, [])


# -- registers by name

#: The worked examples of the manuals: family, order code, register, address, its bytes.
EXAMPLES = [
    ("amm5", "AMM5A21/65KSC1", "preset", 0x11, "00 30 24 F4 00 00 00"),
    ("amm5", "AMM5A21/65KSC1", "serial_number", 0x44, "0A E8 69 EE"),
    ("amm5", "AMM5A21/65KSC1", "manufacturer_id", 0x7E, "4C 69"),
    ("am36", "AM3616/4096-I7", "configuration", 0x49, "60"),
    ("am36", "AM3616/4096-I7", "number_of_revolutions", 0x4E, "00 00"),
    ("am36", "AM3616/4096-I7", "singleturn_bits_used", 0x56, "14"),
    ("asc85", "ASC8525/SC1", "profile_id", 0x42, "28 1A"),
    ("sma21", "SMA21-SC1-0050", "preset_offset", 0x50, "00 01 86 A0"),
    ("sma21", "SMA21-SC1-0050", "absolute_resolution", 0x4D, "32"),
]


@pytest.mark.parametrize(("family", "code", "register", "address", "text"), EXAMPLES)
def test_a_register_is_read_by_name(
    family: str, code: str, register: str, address: int, text: str, machines: Callable[[str], Machine]
) -> None:
    data = bytes.fromhex(text)
    encoder = Encoder()
    encoder.memory[address : address + len(data)] = data
    answer = machines(family).read(register, code, encoder)
    assert (answer.result, answer.data, answer.failure) == (OK, data, UNTOUCHED)
    assert answer.record == [f"r {address:02X} {len(data)}"]
    failed = machines(family).read(register, code, Encoder(fail_at=0, error=77))
    assert (failed.result, failed.failure, failed.data) == (TRANSPORT, (0, READ, READ, address, 77), b"")


WRITTEN_BY_NAME = ("preset", "configuration", "number_of_revolutions", "preset_offset")


@pytest.mark.parametrize(
    ("family", "code", "register", "address", "text"),
    [example for example in EXAMPLES if example[2] in WRITTEN_BY_NAME],
)
def test_a_register_is_written_by_name(
    family: str, code: str, register: str, address: int, text: str, machines: Callable[[str], Machine]
) -> None:
    answer = machines(family).write(register, code, bytes.fromhex(text), Encoder())
    assert (answer.result, answer.failure, answer.record) == (OK, UNTOUCHED, [f"w {address:02X} {text}"])
    failed = machines(family).write(register, code, bytes.fromhex(text), Encoder(fail_at=0, error=77))
    assert (failed.result, failed.failure) == (TRANSPORT, (0, WRITE, WRITE, address, 77))


def test_a_command_is_followed_by_its_pause(machines: Callable[[str], Machine]) -> None:
    """AMM5 6.4 p.39: at least 30 ms from a command to the next function."""
    answer = machines("amm5").write("command", "AMM5A21/65KSC1", b"\x02", Encoder())
    assert (answer.result, answer.record) == (OK, ["w 77 02", "wait 30000"])
    failed = machines("amm5").write("command", "AMM5A21/65KSC1", b"\x02", Encoder(fail_at=1, error=5))
    assert (failed.result, failed.failure) == (TRANSPORT, (0, WAIT, WAIT, 0, 5))


def test_values_that_the_manual_does_not_list_are_refused(machines: Callable[[str], Machine]) -> None:
    answer = machines("amm5").write("command", "AMM5A21/65KSC1", b"\x03", Encoder())
    assert (answer.result, answer.record, answer.failure) == (RANGE, [], UNTOUCHED)
    # A preset in which a bit is 1 that is always 0 is not valid.
    encoder = Encoder()
    encoder.memory[0x17] = 0x80
    read = machines("amm5").read("preset", "AMM5A21/65KSC1", encoder)
    assert (read.result, read.data, read.failure) == (CONSTANT, b"", UNTOUCHED)


@pytest.mark.parametrize("family", FAMILIES)
def test_there_is_a_function_for_every_access(family: str, machines: Callable[[str], Machine]) -> None:
    machine = machines(family)
    for register in machine.device.registers:
        assert machine.has(f"read_{register.name}") == (register.access != "write_only")
        assert machine.has(f"write_{register.name}") == (register.access != "read_only" and not register.reserved)


@pytest.mark.parametrize(("name", "banks"), [("tv62", {1, 2}), ("banks", {0, 2})])
def test_a_register_in_a_bank_has_it_selected_first(
    name: str, banks: set[int], machines: Callable[[str], Machine]
) -> None:
    """The bank is selected in 40h, before the banked registers in the guide, and after them in a data sheet."""
    machine = machines(name)
    banked = [register for register in machine.device.registers if register.bank is not None]
    assert {register.bank for register in banked} == banks
    code = next(variant.code for variant in machine.device.variants if variant.interface == "biss")
    for register in banked:
        answer = machine.read(register.name, code, Encoder(memory=bytearray(128)))
        assert answer.record == [f"w 40 {register.bank:02X}", f"r {register.address:02X} {register.length}"]


# -- identification and run-time state

IDENTITIES = {
    # The registers of the identity, in the order of its members.
    "amm5": [("78", 6), ("7E", 2)],
    "am36": [("42", 2), ("55", 1), ("78", 6), ("7E", 2)],
    "sma21": [("42", 2), ("4D", 1), ("55", 1), ("58", 1), ("78", 6), ("7E", 2)],
}


@pytest.mark.parametrize("family", IDENTITIES)
def test_the_identity_is_read_whole(family: str, machines: Callable[[str], Machine]) -> None:
    machine, registers = machines(family), IDENTITIES[family]
    answer = machine.identity(Encoder())
    assert (answer.result, answer.record) == (OK, [f"r {address} {length}" for address, length in registers])
    starts = [(int(address, 16), length) for address, length in registers]
    assert answer.data == b"".join(bytes(range(start, start + length)) for start, length in starts)
    for index, (address, _) in enumerate(registers):
        failed = machine.identity(Encoder(fail_at=index, error=-7))
        assert (failed.result, failed.failure, failed.data) == (
            TRANSPORT,
            (index, READ, READ, int(address, 16), -7),
            b"",
        )


def test_the_state_is_read_and_taken_over(machines: Callable[[str], Machine]) -> None:
    """AM36 6.5: 56h and 57h hold the bits in use, and bit 5 of 49h is the code.

    4Bh is the information per revolution and 4Eh the number of revolutions. Their product bounds the preset.
    """
    machine = machines("am36")
    encoder = Encoder()
    contents = {0x56: 12, 0x57: 4, 0x4B: 0, 0x4C: 0x10, 0x4D: 0, 0x4E: 0, 0x4F: 16, 0x49: 0x20}
    for address, value in contents.items():
        encoder.memory[address] = value
    answer = machine.state("AM3616/4096-I7", encoder)
    assert answer.result == OK
    assert set(answer.record) == {"r 56 1", "r 57 1", "r 4B 3", "r 4E 2", "r 49 1"}
    (view,) = (view for view in views_of(machine.device) if view.read_state)
    names = [parameter.name for parameter in view.device.set_parameters]
    numbers = [int.from_bytes(answer.data[at : at + 8], "little") for at in range(0, 8 * len(names), 8)]
    values = dict(zip(names, numbers, strict=True))
    assert (
        values["used_singleturn_bits"],
        values["used_multiturn_bits"],
        values["used_information"],
        values["used_revolutions"],
        values["output_code"],
    ) == (12, 4, 4096, 16, 1)
    before = machine.state("AM3616/4096-I7", Encoder(fail_at=0, error=1))
    for index in range(5):
        failed = machine.state("AM3616/4096-I7", Encoder(memory=bytearray(encoder.memory), fail_at=index, error=3))
        assert failed.result == TRANSPORT
        assert failed.failure[0] == index
        assert failed.failure[4] == 3
        assert failed.data == before.data, "after a fault the variant is as it was"
    # 40 bits per revolution are more than the encoder has.
    encoder.memory[0x56] = 40
    encoder.record.clear()
    assert machine.state("AM3616/4096-I7", encoder).data == before.data


# -- user-defined lists


def test_a_list_of_ones_own(tested_machines: Callable[[str], Machine]) -> None:
    machine = tested_machines("amm5")
    answer = machine.steps(
        [
            (WRITE, 0x10, 0xF0, 0xA0, 1, 0),
            (READ, 0x10, 0xFF, 0, 1, 0),
            (READ, 0x12, 0xFF, 0, 1, 0),
            (SEND, 0, 0xFF, 0x55, 2, 0),
            (SEND, 1, 0, 0x56, 1, 0),
        ],
        2,
        Encoder(spoilt={(0, 0): 1}),
    )
    assert (answer.result, answer.data) == (OK, b"\xa0\x12")
    assert answer.record == ["r 10 1", "w 10 A0", "r 10 1", "r 12 1", "send 55", "send 55", "send 56"]


def test_a_list_that_reads_another_number_of_bytes_does_nothing(tested_machines: Callable[[str], Machine]) -> None:
    for room in (0, 1, 3):
        answer = tested_machines("amm5").steps(
            [(WRITE, 0x10, 0xFF, 0, 1, 0), (READ, 0x10, 0xFF, 0, 1, 0), (READ, 0x11, 0xFF, 0, 1, 0)], room, Encoder()
        )
        assert (answer.result, answer.record, answer.failure) == (LENGTH, [], UNTOUCHED)


def test_a_kind_that_does_not_exist_is_refused(tested_machines: Callable[[str], Machine]) -> None:
    answer = tested_machines("amm5").steps([(WAIT, 0, 0, 0, 0, 9), (9, 0x21, 0, 0, 0, 0)], 0, Encoder())
    assert (answer.result, answer.record, answer.failure) == (RANGE, ["wait 9"], (1, 9, 9, 0x21, 0))


def test_a_reply_longer_than_any_is_refused(tested_machines: Callable[[str], Machine]) -> None:
    answer = tested_machines("amm5").steps([(SEND, 17, 0, 0x55, 1, 0)], 0, Encoder())
    assert (answer.result, answer.record, answer.failure) == (RANGE, [], (0, SEND, SEND, 0, 0))
    assert tested_machines("amm5").steps([(SEND, 16, 0xFF, 0x55, 1, 0)], 0, Encoder()).result == OK


@pytest.mark.parametrize(
    ("fails", "accesses"),
    [
        # The write that failed may have arrived, so its register is closed as well. Others stay untouched.
        (0, ["w 20 01", "w 20 00"]),
        (1, ["w 20 01", "w 21 05", "w 20 00", "w 21 00"]),
        (2, ["w 20 01", "w 21 05", "w 20 00", "w 21 00"]),
        (3, ["w 20 01", "w 21 05", "w 20 00", "w 22 07", "w 21 00"]),
        (4, ["w 20 01", "w 21 05", "w 20 00", "w 22 07", "w 21 00"]),
    ],
)
def test_a_list_of_ones_own_closes(fails: int, accesses: list[str], tested_machines: Callable[[str], Machine]) -> None:
    steps = [
        (WRITE, 0x20, 0xFF, 1, 1, 0),
        (WRITE, 0x21, 0xFF, 5, 1, 0),
        (CLOSE, 0x20, 0xFF, 0, 1, 0),
        (WRITE, 0x22, 0xFF, 7, 1, 0),
        (CLOSE, 0x21, 0xFF, 0, 1, 0),
    ]
    answer = tested_machines("amm5").steps(steps, 0, Encoder(fail_at=fails, error=1))
    assert answer.record == accesses
    assert answer.result == TRANSPORT
    assert answer.left_open == (fails in (2, 4))


def test_all_that_is_open_is_tried(tested_machines: Callable[[str], Machine]) -> None:
    """The bus fails from the third access on. Closing is tried for both registers."""
    steps = [
        (WAIT, 0x20, 0, 0, 0, 1),
        (WRITE, 0x20, 0xFF, 1, 1, 0),
        (WRITE, 0x21, 0xFF, 5, 1, 0),
        (WRITE, 0x22, 0xFF, 7, 1, 0),
        (CLOSE, 0x20, 0xFF, 0, 1, 0),
        (CLOSE, 0x21, 0xFF, 0, 1, 0),
    ]
    answer = tested_machines("amm5").steps(steps, 0, Encoder(fail_at=2, error=1, fail_on=True))
    assert [access for access in answer.record if access.startswith("w ")][-2:] == ["w 20 00", "w 21 00"]
    assert (answer.result, answer.left_open) == (TRANSPORT, True)


def test_a_list_without_steps_is_not_carried_out(tested_machines: Callable[[str], Machine]) -> None:
    """A count that is not yet set must not look like a successful reset."""
    answer = tested_machines("amm5").steps([], 0, Encoder())
    assert (answer.result, answer.record) == (LENGTH, [])


def test_a_request_that_is_sent_no_times_is_none(tested_machines: Callable[[str], Machine]) -> None:
    answer = tested_machines("amm5").steps([(SEND, 0, 0, 0x55, 0, 0), (WRITE, 0x20, 0xFF, 1, 1, 0)], 0, Encoder())
    assert (answer.result, answer.record) == (OK, ["w 20 01"])


# -- registers that have one address for several bytes


def test_all_bytes_of_a_register_are_accessed_at_once(tested_machines: Callable[[str], Machine]) -> None:
    steps = [
        (WRITE, 0x10, 0xFF, 0x01, 1, 0),
        (MORE, 0x10, 0xFF, 0x92, 1, 0),
        (WRITE, 0x10, 0xF0, 0x30, 1, 0),
        (MORE, 0x10, 0x0F, 0x04, 1, 0),
        (POLL, 0x10, 0x00, 0x00, 1, 0),
        (MORE, 0x10, 0xFF, 0x94, 1, 0),
        (VERIFY_STEP, 0x10, 0xFF, 0x31, 1, 0),
        (MORE, 0x10, 0x80, 0x80, 1, 0),
        (READ, 0x10, 0xFF, 0, 0, 0),
        (MORE, 0x10, 0xFF, 0, 0, 0),
        (CLOSE, 0x10, 0xFF, 0, 1, 0),
        (MORE, 0x10, 0xFF, 0, 1, 0),
    ]
    answer = tested_machines("amm5").steps(steps, 2, Encoder())
    assert (answer.result, answer.data) == (OK, b"\x31\x94")
    assert answer.record == ["w 10 01 92", "r 10 2", "w 10 31 94", "r 10 2", "r 10 2", "r 10 2", "w 10 00 00"]


def test_a_later_byte_that_differs_is_reported(tested_machines: Callable[[str], Machine]) -> None:
    """After a failure, a closing step writes all bytes of its register."""
    steps = [
        (WRITE, 0x10, 0xFF, 1, 1, 0),
        (MORE, 0x10, 0xFF, 2, 1, 0),
        (VERIFY_STEP, 0x10, 0xFF, 1, 1, 0),
        (MORE, 0x10, 0xFF, 3, 1, 0),
        (WRITE, 0x12, 0xFF, 1, 1, 0),
        (MORE, 0x12, 0xFF, 1, 1, 0),
        (CLOSE, 0x10, 0xFF, 4, 1, 0),
        (MORE, 0x10, 0xFF, 5, 1, 0),
    ]
    answer = tested_machines("amm5").steps(steps, 0, Encoder())
    assert answer.record == ["w 10 01 02", "r 10 2", "w 10 04 05"]
    assert answer.failure == (2, VERIFY_STEP, VERIFY_STEP, 0x10, 2)
    assert not answer.left_open


@pytest.mark.parametrize(
    ("steps", "accesses"),
    [
        ([(READ, 0x10, 1), (READ, 0x11, 1), (READ, 0x12, 1)], ["r 10 3"]),
        ([(READ, 0x10, 0), (READ, 0x11, 0), (READ, 0x12, 0)], ["r 10 1", "r 11 1", "r 12 1"]),
        ([(READ, 0x10, 1), (READ, 0x11, 0), (READ, 0x12, 1)], ["r 10 1", "r 11 1", "r 12 1"]),
        ([(READ, 0x10, 1), (READ, 0x11, 1), (MORE, 0x11, 1)], ["r 10 1", "r 11 2"]),
        ([(READ, 0x10, 1), (MORE, 0x10, 1), (READ, 0x11, 1)], ["r 10 2", "r 11 1"]),
    ],
)
def test_registers_with_one_address_are_read_on_their_own(
    steps: list[tuple[int, int, int]], accesses: list[str], tested_machines: Callable[[str], Machine]
) -> None:
    answer = tested_machines("amm5").steps([(kind, at, 0xFF, 0, times, 0) for kind, at, times in steps], 3, Encoder())
    assert (answer.result, answer.record) == (OK, accesses)


@pytest.mark.parametrize("kinds", [[MORE], [WAIT, MORE], [SEND, MORE], [WRITE, *[MORE] * 8]])
def test_bytes_that_belong_to_no_register_are_refused(
    kinds: list[int], tested_machines: Callable[[str], Machine]
) -> None:
    """Nothing is written, because a number without some of its bytes would be another number."""
    steps = [(kind, 0x10, 0xFF, 0, 1, 0) for kind in [*kinds, WRITE]]
    answer = tested_machines("amm5").steps([(WRITE, 0x20, 0xFF, 0, 1, 0), *steps][kinds == [MORE] :], 0, Encoder())
    assert (answer.result, answer.record, answer.failure) == (LENGTH, [], UNTOUCHED)
