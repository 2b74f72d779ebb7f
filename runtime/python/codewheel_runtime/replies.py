# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Finds the replies to a request over RS-485 in the bytes that arrived."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from .errors import CrcError, FrameError

__all__ = ["FoundReply", "PendingRequest", "ReplyKind", "compute_xor", "find_error", "find_reply", "split_replies"]


class ReplyKind(NamedTuple):
    """Kind of request, and its reply.

    ``control`` is the first byte of the request, ``id`` is its data ID or 0, and ``length`` is the number of bytes in
    the reply. ``flags`` are the names of the flags in the reply. ``repeats_first`` is True if the reply also
    begins with ``control``.
    """

    name: str
    control: int
    id: int
    purpose: str
    length: int
    has_position: bool
    flags: tuple[str, ...]
    repeats_first: bool = True


class PendingRequest(NamedTuple):
    """Request that is waiting for a reply: the request, its bytes on the line, its kind, and the reply decoder.

    ``answers`` are the answers to open questions that the decoder needs, by name.
    """

    request: Any
    data: bytes
    kind: ReplyKind
    decode: Callable[[bytes], Any]
    answers: Mapping[str, object] = MappingProxyType({})


class FoundReply(NamedTuple):
    """Reply to a request, and the other replies that arrived with it.

    Attributes:
        reply: Last reply to the request.
        same_request: Other replies to a request of the same kind.
        other_requests: Replies to requests of other kinds.
    """

    reply: bytes
    same_request: tuple[bytes, ...] = ()
    other_requests: tuple[bytes, ...] = ()

    @property
    def other_replies(self) -> tuple[bytes, ...]:
        """All replies except the one in ``reply``."""
        return self.same_request + self.other_requests

    @property
    def is_ambiguous(self) -> bool:
        """True if the replies to requests of this kind differ, so that the right one is unknown."""
        return any(other != self.reply for other in self.same_request)


def find_reply(received: bytes, pending: PendingRequest, kinds: Mapping[int, ReplyKind]) -> FoundReply | None:
    """Return the reply to a request in the received bytes, or None if they contain no valid reply.

    The reply has the length and the first byte of its kind, and contains no errors. Any bytes, such as an echo, may
    precede it, but only complete replies may follow it. If several places match, the last one is the reply. ``kinds``
    are the kinds of requests by their first byte.
    """
    if not pending.kind.repeats_first:
        return _find_reply_without_mark(received, pending)
    length = pending.kind.length
    # The last one comes first, because an echo and a reply can look like a reply and one more byte.
    for start in reversed(range(len(received) - length + 1)):
        reply = received[start : start + length]
        is_valid = reply[0] == pending.kind.control and find_error(reply, pending) is None
        if not is_valid:
            continue
        following_bytes = received[start + length :]
        later_replies = split_replies(following_bytes, pending, kinds)
        has_other_bytes_after = sum(map(len, later_replies)) != len(following_bytes)
        if has_other_bytes_after:
            continue
        earlier_bytes = received[:start]
        if len(pending.data) == length:
            # The echo of a write can look like a reply to it.
            earlier_bytes = earlier_bytes.removeprefix(pending.data)
        extra_replies = split_replies(earlier_bytes, pending, kinds) + later_replies
        # The first byte of a reply shows its request.
        to_same_request = tuple(extra for extra in extra_replies if extra[0] == pending.kind.control)
        to_other_requests = tuple(extra for extra in extra_replies if extra[0] != pending.kind.control)
        return FoundReply(reply, to_same_request, to_other_requests)
    return None


def _find_reply_without_mark(received: bytes, pending: PendingRequest) -> FoundReply | None:
    """Return the reply to a request whose reply can begin with any byte, or None.

    The received bytes, with or without a leading echo of the request, must be exactly one reply or several adjacent
    replies. If there are several, the last one is the reply, and the others are in ``same_request``.
    """
    length = pending.kind.length
    without_echo = received.removeprefix(pending.data)
    for candidate in (received, without_echo):
        if len(candidate) == length and find_error(candidate, pending) is None:
            return FoundReply(candidate)
    for candidate in (received, without_echo):
        replies = split_replies(candidate, pending, kinds={})
        if replies and len(replies) * length == len(candidate):
            return FoundReply(replies[-1], same_request=tuple(replies[:-1]))
    return None


def split_replies(data: bytes, pending: PendingRequest, kinds: Mapping[int, ReplyKind]) -> list[bytes]:
    """Return the complete replies without an error in ``data``, in order. Bytes between them are skipped.

    ``kinds`` contains the kind of reply by its first byte. A reply that begins with another byte can only be a reply to
    ``pending``.
    """
    replies: list[bytes] = []
    start = 0
    while start < len(data):
        kind = kinds.get(data[start], pending.kind)
        reply = data[start : start + kind.length]
        may_begin_here = not kind.repeats_first or data[start] == kind.control
        if may_begin_here and len(reply) == kind.length and find_error(reply, pending) is None:
            replies.append(reply)
            start += kind.length
        else:
            start += 1
    return replies


def find_error(reply: bytes, pending: PendingRequest) -> FrameError | None:
    """Return the error of a reply to ``pending``, or None if the reply is valid.

    If its fields cannot be decoded without an answer to an open question, only its last byte, the CRC, is checked.
    """
    try:
        pending.decode(reply)
    except FrameError as error:
        return error
    except TypeError:
        # The last byte is the XOR of all others.
        difference = compute_xor(reply)
        return CrcError(reply[-1], reply[-1] ^ difference) if difference else None
    return None


def compute_xor(data: bytes) -> int:
    """Return the XOR of all bytes, which is 0 for a reply with a valid CRC."""
    value = 0
    for byte in data:
        value ^= byte
    return value
