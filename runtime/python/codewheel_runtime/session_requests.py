# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Requests of an encoder over RS-485, with their bytes and the decoders of their replies."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, IntEnum
from functools import partial
from importlib import import_module
from typing import Any, cast, get_args

from .bulk.shape import FrameLayout, holds
from .encoder import Encoder, Exchanged, Frame
from .errors import FrameError
from .frames.decoders import cached_decoder, raise_error
from .frames.descriptions import find_any_layout
from .link_errors import LinkError
from .replies import PendingRequest, ReplyKind

__all__ = ["SessionRequests", "format_hex", "load_rs485_facts"]


class SessionRequests:
    """Requests of one encoder.

    Each request either has a data ID or is a frame with its own class.

    Attributes:
        encoder: The encoder, with RS-485.
        exchanges: Requests without data IDs, with their replies. Empty if the requests have data IDs.
        kinds: Kinds of requests with data IDs, by the first byte.
        captures: Kinds of requests that capture a position.
        position_kind: First of these whose reply contains the position, or None.
    """

    def __init__(self, encoder: Encoder) -> None:
        self.encoder = encoder
        self.exchanges = encoder.exchanges()
        self.kinds = {} if self.exchanges else _find_request_kinds(encoder)
        self.captures = [kind for kind in self.kinds.values() if kind.purpose == "capture"]
        self.position_kind = next((kind for kind in self.captures if kind.has_position), None)

    def make_position_request(self) -> Any:
        """Return the request for the position with factory defaults: its byte, or an object of its class.

        Raises:
            LinkError: A value of the request has no default, or no reply contains the position.
        """
        if self.position_kind is not None:
            return bytes([self.position_kind.control])
        for exchange in self.exchanges:
            if exchange.purpose == "position":
                without_default = [name for name in exchange.request._fields if name not in exchange.defaults]
                if without_default:
                    arguments = ", ".join(f"{name}=..." for name in without_default)
                    raise LinkError(f"{self.encoder.code} needs a request: {exchange.request.__name__}({arguments})")
                return exchange.request(**exchange.defaults)
        raise LinkError(f"no reply of {self.encoder.code} contains the whole position")

    def prepare(self, request: Any) -> PendingRequest:
        """Return a request with its bytes and the data needed to find and decode its reply.

        ``request`` is bytes, an object of the encoder's module, or a member of its ``DataId``. Raises LinkError if the
        encoder does not have the request.
        """
        if self.exchanges:
            return self._prepare_exchange(request)
        answers: dict[str, object] = {}
        if isinstance(request, IntEnum):
            # A data ID: the request is its control byte. An unknown data ID has none.
            data = bytes(kind.control for kind in self.kinds.values() if kind.id == request)
        elif isinstance(request, (bytes, bytearray)):
            data = bytes(request)
        elif not hasattr(request, "_fields"):
            # Neither a request nor its bytes.
            data = b""
        else:
            data = request.encode()
            for name in request._fields:
                value = getattr(request, name)
                # Answers to open questions, which the reply needs too.
                if isinstance(value, Enum) and not isinstance(value, IntEnum):
                    answers[name] = value
        request_kind = self.kinds.get(data[0]) if data else None
        if request_kind is None:
            requests = ", ".join(f"{kind.control:02X} ({kind.name})" for kind in self.kinds.values())
            request_text = format_hex(data) or repr(request)
            raise LinkError(f"{self.encoder.code} has no request '{request_text}'; its requests are {requests}")
        decode = cast(Callable[..., Frame], self.encoder.decode)
        return PendingRequest(request, data, request_kind, partial(decode, **answers), answers)

    def _prepare_exchange(self, object_or_bytes: Any) -> PendingRequest:
        """Return a request of an encoder without data IDs, with the data needed to find and decode its reply.

        ``object_or_bytes`` is an object of the class of a request, or the bytes of a request. The bytes are decoded as
        each kind of request in turn, until one fits. Raises LinkError if they do not match any request, or if the
        encoder does not answer the request.
        """
        # Empty if the request is an object. Empty bytes fit no kind of request either.
        request_bytes = bytes(object_or_bytes) if isinstance(object_or_bytes, (bytes, bytearray)) else b""
        for exchange in self.exchanges:
            # The request as an object, or None if the bytes are not a request of this kind.
            request: Any = _decode_request(exchange, request_bytes) if request_bytes else object_or_bytes
            if type(request) is not exchange.request:
                continue
            name = exchange.request.__name__
            if exchange.reply is None:
                raise LinkError(f"{self.encoder.code} does not answer {name}: send its bytes with 'send'")
            layout = find_any_layout(exchange.reply, self.encoder)
            sent_bytes = request.encode()
            kind = ReplyKind(
                name=name,
                control=sent_bytes[0],
                id=0,
                purpose=exchange.purpose,
                length=layout.byte_count,
                has_position=exchange.purpose == "position",
                flags=(),
                repeats_first=exchange.repeats_first,
            )
            decode = cached_decoder(exchange.reply._make_decoder, self.encoder, raise_error)
            return PendingRequest(request, sent_bytes, kind, decode)
        requests = ", ".join(exchange.request.__name__ for exchange in self.exchanges)
        request_text = format_hex(request_bytes) or f"{object_or_bytes!r}"
        raise LinkError(f"{self.encoder.code} has no request '{request_text}'; its requests are {requests}")

    def find_difference(self, pending: PendingRequest, frame: Frame) -> str:
        """Describe how a reply differs from the values in its request, or return an empty string if it does not.

        Fields and joined numbers that both contain, such as an address, are compared. Answers to open questions are
        ignored.
        """
        fields = getattr(pending.request, "_fields", ())
        joins = find_any_layout(pending.request.__class__, self.encoder).joins if fields else ()
        for name in (*fields, *(join.name for join in joins)):
            if name in pending.answers:
                continue
            reply_value = getattr(frame, name, None)
            sent_value = getattr(pending.request, name)
            if reply_value is not None and reply_value != sent_value:
                return f"the reply of {self.encoder.code} has {name} {reply_value}, but {sent_value} was sent"
        return ""


def _decode_request(exchange: Exchanged, data: bytes) -> Any:
    """Return the request with these bytes as an object, or None if they are not a request of this kind."""
    try:
        return exchange.request.decode(data)
    except FrameError:
        return None


def _find_request_kinds(encoder: Encoder) -> dict[int, ReplyKind]:
    """Return the requests of an encoder with data IDs, by their first byte.

    This is the control byte of their data ID.
    """
    module: Any = import_module(type(encoder).__module__)
    reply_classes = get_args(module.Reply) or (module.Reply,)
    replies = [(reply_class, find_any_layout(reply_class, encoder)) for reply_class in reply_classes]
    kinds: dict[int, ReplyKind] = {}
    for data_id in load_rs485_facts(encoder).data_ids:
        # Of several classes of replies, the first one that may begin with this byte is the reply.
        fitting_replies = [(reply_class, layout) for reply_class, layout in replies if _may_begin(layout, data_id)]
        if not fitting_replies:
            continue
        reply_class, layout = fitting_replies[0]
        kinds[data_id.control] = ReplyKind(
            name=data_id.name,
            control=data_id.control,
            id=data_id.id,
            purpose=data_id.purpose.value,
            length=layout.byte_count,
            has_position=bool(layout.position) and hasattr(reply_class, "usable_position"),
            flags=tuple(column.name for column in layout.columns if column.value_kind == "flag"),
        )
    return kinds


def _may_begin(layout: FrameLayout, data_id: Any) -> bool:
    """Return whether a reply with this layout can begin with the control byte of a data ID.

    The constants in its first byte must match the control byte, and a data ID field must allow this data ID.
    """
    for check in layout.checks:
        is_in_first_byte = check.lowest_bit + check.width <= 8
        if is_in_first_byte and not holds(data_id.control, check):
            return False
    for column in layout.columns:
        begins_in_first_byte = column.lowest_bit < 8
        allowed_values = column.allowed_values
        if begins_in_first_byte and allowed_values and data_id.id not in allowed_values:
            return False
    return True


def load_rs485_facts(encoder: Encoder) -> Any:
    """Return the facts about the RS-485 interface of an encoder."""
    return import_module(type(encoder).__module__).RS485


def format_hex(data: bytes) -> str:
    """Return bytes as text, such as ``1A 2B``."""
    return data.hex(" ").upper()
