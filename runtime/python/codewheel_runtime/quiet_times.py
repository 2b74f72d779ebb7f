# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Times for which a line must be quiet after a reply, so that no other reply to an earlier request follows."""

from __future__ import annotations

from collections import deque

from .facts import Port
from .replies import PendingRequest

#: Seconds to wait for more bytes after a reply that follows other bytes.
_QUIET_S = 0.002
#: Seconds within which an encoder begins to reply, for the default of ``settle_s``. The manuals state no reply time.
_TURNAROUND_S = 0.00025
#: Number of replies whose times are kept.
_REPLY_TIMES = 16


class QuietTimes:
    """Quiet times of one session.

    Args:
        port: Settings of the serial port.
        settle_s: Time in seconds that the user has chosen, or None for the default.
    """

    def __init__(self, port: Port, settle_s: float | None) -> None:
        self._settle_s = settle_s
        # A byte has one start bit.
        bits_per_byte = 1 + port.data_bits + (port.parity != "none") + port.stop_bits
        #: Time of a byte on the line, and durations of the last replies, in seconds.
        self._byte_s = bits_per_byte / port.baud
        self._reply_times: deque[float] = deque(maxlen=_REPLY_TIMES)

    def record_reply(self, seconds: float) -> None:
        """Record the time from the beginning of a request to the end of its reply."""
        self._reply_times.append(seconds)

    def find_quiet_time(self, received: bytes, reply: bytes, pending: PendingRequest) -> float:
        """Return the time in seconds for which the line must be quiet after a reply.

        This is the settling time. It is at least 2 ms, unless the reply comes first and cannot be part of an echo.
        """
        # If this is an extra reply to an earlier request, the reply to this request follows within the settling time.
        settle_s = self.find_settle_time(pending)
        longer_time_s = max(settle_s, _QUIET_S)
        # Such a reply repeats the first byte of its request. Other replies can begin with any byte.
        begins_like_request = pending.kind.repeats_first
        # After other bytes, part of a longer reply can look like a reply by chance.
        if not begins_like_request or not received.startswith(reply):
            return longer_time_s
        # If the line carries an echo, the reply follows the request. It begins with the first byte of the request.
        echo_and_first_byte = pending.data + pending.data[:1]
        may_be_echo = received.startswith(echo_and_first_byte)
        return longer_time_s if may_be_echo else settle_s

    def find_settle_time(self, pending: PendingRequest) -> float:
        """Return the time in seconds after which no other reply to an earlier request follows.

        This is the time that the user has chosen. By default, it is the time that the request and the reply take at the
        baud rate, or the usual time of the last replies if that is longer.
        """
        if self._settle_s is not None:
            return self._settle_s
        sent_bytes = len(pending.data) + pending.kind.length
        reply_s: float = _TURNAROUND_S + self._byte_s * sent_bytes
        if not self._reply_times:
            return reply_s
        # Few replies that were much slower than the others do not count. Three in four replies took this long or less.
        times = sorted(self._reply_times)
        third_quartile = times[3 * len(times) // 4]
        return max(reply_s, third_quartile)
