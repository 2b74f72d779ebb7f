"""The names that a header declares at file scope, the parts of the spec that they come from, and clashes of names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ...language.problems import Path
from ...model import Device, Layout
from .reserved import c_name

_WORDS = {
    "alarms": "the alarm",
    "alternatives": "the alternative",
    "crcs": "the CRC",
    "device": "the family",
    "layouts": "the layout",
    "order_code": "the order code",
    "parameters": "the parameter",
    "parts": "the part of the order code",
    "procedures": "the procedure",
    "registers": "the register",
    "timings": "the timing",
}


#: A name at file scope, and the part of the spec that it comes from, empty for names that every header has.
#: Each part of a header lists its names in ``declared()``.
Declared = tuple[str, Path]


@dataclass(frozen=True)
class Clash:
    """Two parts of a spec with the same name in C. ``other`` is empty for names that every header has."""

    name: str
    path: Path
    other: Path

    def message(self, where: str = "") -> str:
        """Return the problem and its fix. ``where`` gives the place of the other part, as in `` on line 5``."""
        if not self.other:
            return f"its C name {self.name} is already used by the headers; rename it"
        return f"its C name {self.name} is also that of {called(self.other)}{where}; rename one of the two"


def called(path: Path) -> str:
    """Describe a part of the spec in words."""
    kind = next((step for step in reversed(path) if step in _WORDS), path[0])
    return f"{_WORDS.get(str(kind), str(kind))} '{path[-1]}'" if path[-1] != kind else _WORDS.get(str(kind), str(kind))


class Names:
    """The names of one header. A name belongs to the first part that declares it. Any other part is a clash."""

    def __init__(self, declared: Iterable[Declared]) -> None:
        self.paths: dict[str, Path] = {}
        self.clashes: list[Clash] = []
        for name, path in declared:
            if name not in self.paths:
                self.paths[name] = path
            elif path:
                self.clashes.append(Clash(name, path, self.paths[name]))
            else:
                self.clashes.append(Clash(name, self.paths[name], ()))


#: Names in encoder.h, without the prefix of the manufacturer.
_ENCODER_H = """
    ACCESS_READ_ONLY ACCESS_READ_WRITE ACCESS_WRITE_ONLY ENCODER_H FAULT_CONSTANT FAULT_CRC FAULT_LENGTH
    FAULT_HEAD_MISSING FAULT_LINE_HIGH FAULT_LINE_LOW FAULT_LOST FAULT_NO_START FAULT_RANGE FAULT_REPEAT FAULT_TIMEOUT
    FAULT_TRANSPORT FAULT_UNSUPPORTED FAULT_VERIFY GENERATION INTERFACE_BISS INTERFACE_NONE INTERFACE_RS485
    INTERFACE_SSI NODISCARD NOT_USABLE NO_CODE OK POLL_AT_MOST POLL_PAUSE_US REPLY_BYTES STEP_CLOSE STEP_POLL
    STEP_READ STEP_SEND STEP_VERIFY STEP_WAIT STEP_WRITE UNKNOWN USABLE USABLE_WITH_WARNING VERSION above access capital
    difference failed failed_at failure field fits_signed from_gray interface is_digit is_letter_or_digit label_ends
    label_match mask open_code parity read reply_check report_text result run run_closing run_poll run_reads run_send
    run_step run_together run_verify run_write send signed step step_address step_close step_closes step_kind
    step_poll step_read step_send step_verify step_wait step_write to_gray transport verdict wait write write_byte
"""
#: Names in receive.h, in the same way.
_RECEIVE_H = """
    RECEIVE_H RECEIVE_RS485_BYTES biss_receive biss_receive_bits biss_receive_cds biss_receive_cds_bits received_bit
    received_bits received_samples received_words16 received_words32 rs485_ask rs485_late rs485_line rs485_reason
    rs485_resume rs485_take ssi_receive ssi_repeats
"""
#: Names in runner.h, tracker.h and angle.h, in the same way.
_USE_H = """
    ANGLE_H RUNNER_H TODO_BUSY TODO_END TODO_READ TODO_SEND TODO_WAIT TODO_WRITE TRACKER_H TRACKER_REACH_US
    angle angle_degrees angle_electrical angle_highest_bit angle_millidegrees angle_q15 angle_q31 angle_radians
    counts_per_second runner runner_accessed runner_advance runner_ask runner_begin runner_close runner_done
    runner_fail runner_next runner_polled runner_sent runner_start runner_write todo tracker tracker_add
    tracker_config tracker_lose tracker_reach tracker_restart tracker_shorter tracker_speed tracker_start
"""
#: Names in biss.h, without that prefix and ``biss_``.
_BISS_H = """
    ABORTED BAD_CRC BAD_ECHO BUSY DONE H IDLE IDS LATE_FRAMES NO_ANSWER NO_ID PHASE_BYTE PHASE_HEADER PHASE_START
    PHASE_WAIT READS REFUSED REGISTERS RUNNING WANTS_BYTE WANTS_NOTHING WANTS_STORE WRITES ZEROS answer_decode
    byte_decode byte_encode crc data echo header late_busy late_byte late_first late_header master master_abort
    master_begin master_byte master_ends master_header master_init master_next master_next_late master_read
    master_start master_write outcome phase request request_decode request_encode slave slave_allow slave_awaits
    slave_byte slave_fetch slave_give slave_header slave_init slave_leaves slave_lock slave_may slave_next slave_start
    slave_stored slaves wants zeros
"""


def shared_names(prefix: str, with_biss: bool) -> Iterator[str]:
    """Yield the names in the headers that the families of a manufacturer share. Macros are in uppercase."""
    names = [*_ENCODER_H.split(), *_RECEIVE_H.split(), *_USE_H.split()]
    names += [f"biss_{name}" for name in _BISS_H.split() if with_biss]
    for name in names:
        yield f"{prefix}_{name}".upper() if name.removeprefix("biss_").isupper() else f"{prefix}_{name}"


def inner_names(device: Device) -> Iterator[tuple[str, Path]]:
    """Yield the C names of members, arguments and locals, and the part of the spec that each comes from."""
    for parameter in device.parameters:
        yield c_name(parameter.name), ("parameters", parameter.name)
    places: list[tuple[Path, Layout]] = [
        (("interfaces", interface.name, "layouts", layout.name), layout) for interface, layout in device.layouts()
    ]
    places += [(("registers", register.name), register.layout) for register in device.registers]
    for path, layout in places:
        yield from ((c_name(field.name), path) for field in layout.fields)
        yield from ((c_name(run.name), path) for field in layout.fields for run in field.runs)
        yield from ((c_name(join.name), path) for join in layout.joins)
    for register in device.registers:
        yield c_name(register.name), ("registers", register.name)
    for procedure in device.procedures:
        yield from ((c_name(item.name), ("procedures", procedure.name)) for item in procedure.arguments)


def clashes(headers: Iterable[tuple[Device, Names]], shared: Iterable[str]) -> Iterator[tuple[Device, Clash]]:
    """Yield every clash within these headers, with the ``shared`` names, and between families."""
    taken: dict[str, Path] = dict.fromkeys(shared, ())
    for device, names in headers:
        for clash in names.clashes:
            yield device, clash
        for name, path in names.paths.items():
            if name in taken:
                yield device, Clash(name, path or ("device",), taken[name])
            taken[name] = ("device", device.name)
        for name, path in inner_names(device):
            if name in taken:
                yield device, Clash(name, path, ())
