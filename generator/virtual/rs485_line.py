"""RS-485 interface of a virtual encoder: requests of a master, and the replies to them."""

from __future__ import annotations

from bisect import insort
from collections.abc import Mapping
from operator import itemgetter
from typing import NamedTuple

from ..model import (
    DataId,
    Flag,
    Layout,
    Procedure,
    Rs485,
    SendStep,
    WaitStep,
    number_to_bytes,
)
from ..reference import codec
from .encoder import VirtualEncoder
from .simulation_options import BUSY_S

#: Seconds after which the rest of an incomplete request is discarded.
GAP_S = 0.005
#: Durations in seconds: a line fault, and an EEPROM access for one byte.
OUTAGE_S = 0.02
EEPROM_S = 0.003
#: Maximum number of replies that wait for a master that does not read them.
_MOST_REPLIES = 1000
#: Tolerance in seconds of the interval between the requests of a reset.
_TOLERANCE_S = 1e-9
#: Shortest and longest delay in seconds of a late reply.
_LATE_BY_S = (0.005, 0.04)


class _RequestFormat(NamedTuple):
    """The layout of a request and of its reply, or None if there is no reply. ``data_id`` is None without data IDs."""

    layout: Layout
    data_id: DataId | None
    reply: Layout | None


class _ReceivedRequest(NamedTuple):
    """A request of ``length`` bytes, with the values of its fields, its data ID, and the layout of its reply.

    If ``values`` is None, the bytes are not a valid request and are discarded.
    """

    length: int
    values: dict[str, int | str | bool] | None
    data_id: DataId | None
    reply: Layout | None


class _SentResets(NamedTuple):
    """The reset requests that came last: their first byte, their number, and the time of the last one in seconds."""

    control: int
    request_count: int
    last_time: float


#: No reset request has come. No request has the first byte -1.
_NO_RESETS = _SentResets(control=-1, request_count=0, last_time=0.0)


class Rs485Line:
    """RS-485 line with one encoder.

    Args:
        encoder: The encoder.

    Raises:
        ValueError: The encoder has a different interface.
    """

    def __init__(self, encoder: VirtualEncoder) -> None:
        interface = encoder.device.interface(encoder.variant.interface)
        if not isinstance(interface, Rs485):
            raise ValueError(f"{encoder.variant.code} has the interface {interface.short}, not RS-485")
        self.encoder, self.interface = encoder, interface
        self._data_id_by_control = {data_id.control: data_id for data_id in interface.data_ids}
        #: Bytes of a request that is not complete, and the time at which the last of them came.
        self._received_bytes = b""
        self._received_at = 0.0
        #: The fault "low" or "high" of the line, and its end.
        self._line_fault = ""
        self._line_fault_until = 0.0
        #: Replies with the times at which they arrive, in order, and the time of the last reply without extra replies.
        self._arrivals: list[tuple[float, bytes]] = []
        self._last_reply_due = 0.0
        self._sent_resets = _NO_RESETS
        self._eeprom: dict[int, int] = {}
        self._memory_busy_until = 0.0

    def receive(self, data: bytes) -> None:
        """Receive bytes from the master, and answer each complete and valid request."""
        now = self.encoder.clock()
        is_after_pause = now - self._received_at > GAP_S
        if is_after_pause:
            self._received_bytes = b""  # An incomplete request is discarded.
        self._received_at = now
        self._received_bytes += data
        while self._received_bytes:
            request = self._first_request()
            if request is None:
                return
            request_bytes = self._received_bytes[: request.length]
            self._received_bytes = self._received_bytes[request.length :]
            if request.values is not None and not self.encoder.is_off():
                self._answer_request(request.data_id, request_bytes, request.values, request.reply)

    def _first_request(self) -> _ReceivedRequest | None:
        """Return the request at the start of the received bytes, or None if it is still incomplete.

        If no request begins there, the result is one byte to discard.
        """
        has_data_ids = bool(self._data_id_by_control)
        request_formats = self._formats_by_data_id() if has_data_ids else self._formats_of_exchanges()
        longest_byte_count = 0
        for request_format in request_formats:
            placed_layout = self.encoder.place(request_format.layout)
            byte_count = placed_layout.bits // 8
            longest_byte_count = max(longest_byte_count, byte_count)
            if len(self._received_bytes) < byte_count:
                continue
            decoded = codec.decode_placed(self.encoder.device, placed_layout, self._received_bytes[:byte_count])
            values = None if decoded.problems else decoded.values
            is_accepted = values is not None and self._is_for_this_encoder(request_format.layout, values)
            # The data ID alone identifies the request. An invalid request with a data ID is discarded as a whole.
            if has_data_ids or is_accepted:
                return _ReceivedRequest(byte_count, values, data_id=request_format.data_id, reply=request_format.reply)
        is_incomplete = len(self._received_bytes) < longest_byte_count
        if is_incomplete:
            return None
        return _ReceivedRequest(length=1, values=None, data_id=None, reply=None)

    def _formats_by_data_id(self) -> list[_RequestFormat]:
        """Return the format of the request that the first received byte identifies by its data ID.

        The list is empty if no data ID has this byte, or if the manual leaves open how to decode the request and the
        user gave no answer.
        """
        data_id = self._data_id_by_control.get(self._received_bytes[0])
        layout = self._layout_with(data_id, sender="master") if data_id is not None else None
        if data_id is None or layout is None or self.encoder.needs_answer(layout):
            return []
        reply = self._layout_with(data_id, sender="encoder")
        return [_RequestFormat(layout, data_id, reply=reply)]

    def _formats_of_exchanges(self) -> list[_RequestFormat]:
        """Return the formats of all requests of the interface, which has no data IDs."""
        layout_by_name = {layout.name: layout for layout in self.interface.layouts}
        formats: list[_RequestFormat] = []
        for exchange in self.interface.exchanges:
            reply = layout_by_name.get(exchange.reply)
            formats.append(_RequestFormat(layout_by_name[exchange.request], data_id=None, reply=reply))
        return formats

    @staticmethod
    def _is_for_this_encoder(layout: Layout, values: Mapping[str, int | str | bool]) -> bool:
        """Return whether a request is addressed to this encoder.

        Fields such as the address must have their factory default. A field without a default can have any value.
        """
        for field in layout.fields:
            if field.default is not None and field.default != values.get(field.name):
                return False
        return True

    def due(self) -> float | None:
        """Return the time in seconds at which the next bytes reach the master, or None if no bytes are pending."""
        if not self._arrivals:
            return None
        due, _ = self._arrivals[0]
        return due

    def send(self) -> bytes:
        """Return the bytes that have reached the master since the last call."""
        now = self.encoder.clock()
        arrived_replies = [reply for due, reply in self._arrivals if due <= now]
        del self._arrivals[: len(arrived_replies)]
        return b"".join(arrived_replies)

    def _layout_with(self, data_id: DataId, sender: str) -> Layout | None:
        """Return the first layout of the sender that is valid for this data ID, or None if there is none.

        The selector field of a layout contains the data ID. A layout without a selector is valid for all data IDs.
        """
        for layout in self.encoder.layouts(sender):
            if not layout.selector or data_id.id in layout.selects:
                return layout
        return None

    def _answer_request(
        self, data_id: DataId | None, request: bytes, values: dict[str, int | str | bool], layout: Layout | None
    ) -> None:
        """Execute a request, and schedule its reply with this layout. A fault can corrupt, delay or suppress it."""
        encoder = self.encoder
        faults = self.encoder.faults
        now = encoder.clock()
        fault = faults.draw()
        if fault == "busy":
            encoder.be_busy(BUSY_S)
            self._memory_busy_until = max(self._memory_busy_until, now + BUSY_S)
        if fault in ("low", "high"):
            self._line_fault, self._line_fault_until = fault, now + OUTAGE_S
        reply, other_reply = self._compute_replies(data_id, values, layout, is_second=fault == "second")
        if fault == "restart":
            encoder.restart()
            return
        is_silent = encoder.is_busy() and not encoder.reports_busy
        if reply and not is_silent:
            reply_bytes = faults.damaged(fault, reply, request)
            if now < self._line_fault_until:
                # A line that stays high is idle, so no bytes arrive.
                zeros = bytes(len(reply))
                reply_bytes = zeros if self._line_fault == "low" else b""
            delay = faults.random.uniform(*_LATE_BY_S) if fault == "late" else 0.0
            # Replies arrive in the order of the requests, but an extra reply can arrive before or after the next one.
            self._last_reply_due = max(now + delay, self._last_reply_due)
            self._schedule_bytes(self._last_reply_due, reply_bytes)
            if fault in ("repeated", "second"):
                extra_reply = reply if fault == "repeated" else other_reply
                self._schedule_bytes(self._last_reply_due + faults.gap_s(), extra_reply)
        if fault == "brownout":
            encoder.restart()

    def _schedule_bytes(self, due: float, data: bytes) -> None:
        """Schedule bytes that reach the master at the given time. If too many wait to be read, the oldest are lost."""
        insort(self._arrivals, (due, data), key=itemgetter(0))  # sorted by time
        del self._arrivals[:-_MOST_REPLIES]

    def _compute_replies(
        self,
        data_id: DataId | None,
        values: dict[str, int | str | bool],
        reply_layout: Layout | None,
        *,
        is_second: bool,
    ) -> tuple[bytes, bytes]:
        """Execute a request, and return the reply of the encoder and the reply of a second encoder.

        Both replies are the same unless ``is_second`` is true. If there is no layout for the reply, or the manual
        leaves open how to encode it, both are empty, and the request is ignored.
        """
        if reply_layout is None or self.encoder.needs_answer(reply_layout):
            return b"", b""
        request_values = {name: value for name, value in values.items() if name != codec.UNUSED}
        if data_id is not None and data_id.purpose in ("read", "write"):
            memory_values = self._access_memory(data_id, reply_layout, request_values)
            if memory_values is None:
                return b"", b""
            request_values |= memory_values
        frame = self.encoder.frame(reply_layout, request_values)
        other_frame = self.encoder.frame_of_another(reply_layout, request_values) if is_second else frame
        bit_count = self.encoder.place(reply_layout).bits
        if data_id is not None:
            self._count_reset_request(data_id)
        return number_to_bytes(reply_layout, frame, bit_count), number_to_bytes(reply_layout, other_frame, bit_count)

    def _access_memory(
        self, data_id: DataId, layout: Layout, request_values: dict[str, int | str | bool]
    ) -> dict[str, int | bool] | None:
        """Read or write a byte of the EEPROM unless it is busy, and return the values of the reply: busy flag and data.

        The first flag of the reply, if it has any, reports a busy EEPROM. Return None if the EEPROM is busy and the
        reply has no flag.
        """
        now = self.encoder.clock()
        sent_fields = [placed_field.field for placed_field in self.encoder.place(layout).fields]
        flag_names = [field.name for field in sent_fields if isinstance(field.kind, Flag)]
        busy_flag = flag_names[0] if flag_names else ""
        is_busy = now < self._memory_busy_until
        if is_busy:
            return {busy_flag: True, "data": 0} if busy_flag else None
        address = int(request_values["address"])
        if data_id.purpose == "write":
            self._eeprom[address] = int(request_values["data"])
            self._memory_busy_until = now + EEPROM_S
        data = self._eeprom.get(address, 0xFF)
        return {busy_flag: False, "data": data} if busy_flag else {"data": data}

    def _count_reset_request(self, data_id: DataId) -> None:
        """Count a request if it belongs to a reset, and execute the reset after the last request that it needs.

        A request that belongs to no reset restarts the count.
        """
        for procedure in self.encoder.device.procedures:
            for step in procedure.steps:
                if isinstance(step, SendStep) and step.request == bytes([data_id.control]):
                    is_complete = self._count_and_compare(data_id.control, step)
                    if is_complete:
                        self._execute_reset(data_id, procedure)
                    return
        self._sent_resets = _NO_RESETS

    def _count_and_compare(self, control: int, step: SendStep) -> bool:
        """Count a request of a reset, and return whether the master has sent it as many times as the reset needs.

        A request that is sent too soon after the previous one restarts the count.
        """
        now = self.encoder.clock()
        earlier_resets = self._sent_resets
        shortest_interval = step.microseconds / 1e6 - _TOLERANCE_S
        is_too_soon = now - earlier_resets.last_time < shortest_interval
        continues_count = earlier_resets.control == control and not is_too_soon
        request_count = earlier_resets.request_count + 1 if continues_count else 1
        is_complete = request_count >= step.times
        remaining_count = 0 if is_complete else request_count
        self._sent_resets = _SentResets(control, remaining_count, last_time=now)
        return is_complete

    def _execute_reset(self, data_id: DataId, procedure: Procedure) -> None:
        """Reset the encoder. If it has a busy flag, it is then busy for the longest wait time of the procedure."""
        self.encoder.reset(data_id.name)
        waits_us = [step.microseconds for step in procedure.steps if isinstance(step, WaitStep)]
        if self.encoder.reports_busy:
            self.encoder.be_busy(max(waits_us, default=0) / 1e6)
