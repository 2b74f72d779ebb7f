# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Counts unrequested replies, and uses them to detect a second device."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from .link_errors import SecondDeviceError
from .replies import FoundReply, PendingRequest, split_replies
from .session_requests import SessionRequests, format_hex

#: Number of replies with which extra replies are compared.
_RECENT_REPLIES = 32
#: Number of extra replies with new values that indicate a second device. One or two can have other causes. If they
#: are so late that they are read before the next request, fewer are sufficient.
_FOREIGN_REPLIES, _LATE_FOREIGN_REPLIES = 3, 2
#: Number of consecutive requests that must each receive exactly one reply before a second device is ruled out.
_ONE_REPLY_REQUESTS_NEEDED = 2


@dataclass(slots=True)
class Statistics:
    """Counters of a session.

    Attributes:
        requests: Requests that were sent, including repeated requests and requests of other kinds.
        replies: Requests that received a valid reply.
        failures: Requests that did not.
        late_replies: Replies that arrived after their request had failed.
        extra_replies: Unrequested replies, such as second copies.
        conflicts: Requests that received two different replies. They are included in the failures.
    """

    requests: int = 0
    replies: int = 0
    failures: int = 0
    late_replies: int = 0
    extra_replies: int = 0
    conflicts: int = 0


class ReplyCounter:
    """Counts the replies on the line of one session.

    Attributes:
        statistics: Counters for the user.
        unanswered: Number of requests whose reply can still arrive.
        recent_replies: Replies to the last requests. Extra replies are compared with them.
        requests_with_one_reply: Number of consecutive requests that received exactly one reply, since the last other
            reply.
    """

    def __init__(self, requests: SessionRequests, *, has_time_to_settle: bool) -> None:
        self.statistics = Statistics()
        self.unanswered = 0
        self.recent_replies: deque[bytes] = deque(maxlen=_RECENT_REPLIES)
        self.requests_with_one_reply = 0
        self._requests = requests
        #: Without a time to settle, one copy can cause several replies with other values.
        self._finds_second_device = has_time_to_settle
        #: Number of extra replies with other values.
        self._foreign_replies = 0

    def count_others(self, found_reply: FoundReply, received: bytes) -> None:
        """Count the replies that arrived together with a reply.

        Raises SecondDeviceError if a second device seems to answer.
        """
        self.requests_with_one_reply = 0
        extra_count = self.count_extra(len(found_reply.other_replies))
        # One of the unknown replies of this kind is the reply to this request, so all but one are foreign.
        unknown_replies = {*found_reply.same_request, found_reply.reply}.difference(self.recent_replies)
        foreign_replies = [*self._list_foreign(found_reply.other_requests), *sorted(unknown_replies)[1:]]
        # Late replies to failed requests are not extra replies.
        self._count_foreign(foreign_replies[:extra_count], received, _FOREIGN_REPLIES)

    def count_discarded(self, data: bytes, last_request: PendingRequest | None) -> None:
        """Count the replies in discarded bytes, which arrived without a request.

        Raises SecondDeviceError if a second device seems to answer. Two consecutive requests that received exactly
        one reply show that there is no such device, so the count of its replies is reset.
        """
        replies = split_replies(data, last_request, self._requests.kinds) if last_request is not None else []
        if replies:
            self.requests_with_one_reply = 0
        # The reply of a second device to one request can arrive after the reply to the next one.
        if self.requests_with_one_reply >= _ONE_REPLY_REQUESTS_NEEDED:
            self._foreign_replies = 0
        extra_count = self.count_extra(len(replies))
        foreign_replies = self._list_foreign(replies)[:extra_count]
        self._count_foreign(foreign_replies, data, _LATE_FOREIGN_REPLIES)

    def count_extra(self, count: int) -> int:
        """Count replies that are not used, and return how many of them are extra replies.

        The first replies, up to the number of unanswered requests, are late replies to these requests. The rest are
        extra.
        """
        late_count = min(count, self.unanswered)
        extra_count = count - late_count
        self.unanswered -= late_count
        self.statistics.late_replies += late_count
        self.statistics.extra_replies += extra_count
        return extra_count

    def _list_foreign(self, replies: Sequence[bytes]) -> list[bytes]:
        """Return the replies that differ from all of the last replies to requests.

        They may come from a second device.
        """
        return [reply for reply in replies if reply not in self.recent_replies]

    def _count_foreign(self, replies: Sequence[bytes], received: bytes, limit: int) -> None:
        """Count replies that may come from a second device. Raise SecondDeviceError if there are ``limit`` of them.

        ``received`` are all bytes that arrived, for the error. No error is raised if the line has no time to settle.
        """
        self._foreign_replies += len(replies)
        if replies and self._foreign_replies >= limit and self._finds_second_device:
            count = self._foreign_replies
            code = self._requests.encoder.code
            text = f"{count} extra replies with other values came from the line to {code}, the last one"
            advice = "check whether a second device on the line answers, too"
            raise SecondDeviceError(f"{text} {format_hex(replies[-1])}; {advice}", received)
