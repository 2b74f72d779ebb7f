# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Pairs SPI requests with the encoder's replies. It computes words and never drives pins."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple, Protocol

from .codec import Word, as_word
from .encoder import Encoder
from .frames.base import ByEncoder
from .frames.decoders import cached_decoder, raise_error


class Request(Protocol):
    """Frame that a master sends over SPI."""

    def encode(self) -> int:
        """Return the word."""
        ...


class Value(Protocol):
    """Value of a register."""

    def encode(self) -> bytes:
        """Return the bytes of the register."""
        ...


class Answer(NamedTuple):
    """Request with its reply.

    Attributes:
        request: Frame that the master sent.
        reply: Frame with which the encoder answered.
        register: Value of the register if the request was made by ``read`` or ``write`` and the reply contains it,
            otherwise None.
    """

    request: Any
    reply: Any
    register: Any


class _Sent(NamedTuple):
    """Request sent in a word of ``bits`` bits, with the class of the register that it reads or writes."""

    request: Any
    register: type | None
    bits: int


class Pipeline:
    """SPI requests that are waiting for their replies. Create it with ``pipeline()`` of an encoder.

    For each word, call ``ask`` (or ``read`` or ``write``), exchange the word on your bus, and call ``take`` with the
    word that you received.

    Args:
        encoder: The encoder.
        replies: Class of the reply to each request class.
        late: True if the encoder answers in the word after the request.
        read: Class of the request that reads a register, if there is one.
        write: Classes of the requests that write a register, one for each word.
        registers: Address and number of bytes of each class of registers.
    """

    def __init__(
        self,
        encoder: Encoder,
        replies: Mapping[type, Any],
        *,
        late: bool,
        read: Any = None,
        write: Sequence[Any] = (),
        registers: Mapping[type, tuple[int, int]],
    ) -> None:
        self._encoder = encoder
        self._has_late_replies = late
        self._replies = {
            request_class: cached_decoder(reply_class._make_decoder, encoder, raise_error)
            for request_class, reply_class in replies.items()
        }
        self._read_request_class = read
        self._write_request_classes = tuple(write)
        self._register_places = registers
        #: Request whose word was sent, until the word that was received with it is taken. Otherwise None.
        self._sent: _Sent | None = None
        #: Request before ``_sent``, to which a late reply belongs.
        self._request_before: _Sent | None = None
        #: Number of bits in the last word.
        self._bits = 0

    @property
    def bits(self) -> int:
        """Number of bits in the last word that ``ask``, ``read`` or ``write`` returned, or 0 before the first word."""
        return self._bits

    def ask(self, request: Request) -> int:
        """Return the word for a request, and remember the request until its reply arrives.

        Args:
            request: The frame. The encoder must answer requests of its class.

        Raises:
            TypeError: The encoder does not answer frames of this class.
            RangeError: A value does not fit its field.
            RuntimeError: The word that was received with the previous request has not been taken.
        """
        return self._start_request(request, None)

    def read(self, register: type) -> int:
        """Return the word that reads a register. Its answer contains the value in ``register``.

        Args:
            register: Class of the register.

        Raises:
            TypeError: The encoder has no such register over SPI, or no request that reads one.
            RuntimeError: The word that was received with the previous request has not been taken.
        """
        address, _ = self._find_address(register)
        return self._start_request(self._make_read_request(address), register)

    def write(self, value: Value) -> Iterator[int]:
        """Yield the words that write a register. Exchange and process each word before the next.

        Args:
            value: The value, an object of the register's class.

        Raises:
            TypeError: The encoder has no such register over SPI, or no request that writes one.
            RangeError: The value does not fit.
            RuntimeError: The word that was received with the previous request has not been taken.
        """
        address, _ = self._find_address(type(value))
        for request in self._make_write_requests(address, value.encode()):
            yield self._start_request(request, type(value))

    def bus(self, exchange: Callable[[int], int]) -> RegisterBus:
        """Return the bus argument of ``run``, the function that carries out a procedure of the manual.

        Args:
            exchange: Function that sends a word of ``bits`` bits over SPI, and returns the word that was received
                meanwhile.
        """
        return RegisterBus(self, exchange)

    def take(self, word: Word, *, bits: int | None = None) -> Answer | None:
        """Return the answer in a received word.

        Args:
            word: Word that was received while the last request was sent: a number whose most significant bit was first,
                or its bytes.
            bits: Number of bits received, if known. The number itself does not show missing bits.

        Returns:
            The answer. With late replies, it belongs to the request before the last one, and is None if there was no
            such request or its word had a different length.

        Raises:
            FrameError: The word is damaged. The pipeline stays in step: take the next word as usual.
            RuntimeError: No request has been sent since the last word was taken.
        """
        if self._sent is None:
            raise RuntimeError("no request has been sent since the last word was taken")
        # Late replies come one word later, so they belong to the request before the one that was just sent.
        answered_request = self._request_before if self._has_late_replies else self._sent
        word_bits = self._sent.bits
        self._request_before = self._sent
        self._sent = None
        number = as_word(word, word_bits, bits)
        # A word of a different length cannot contain a late reply.
        if answered_request is None or answered_request.bits != word_bits:
            return None
        request, register, _ = answered_request
        reply = self._replies[type(request)](number)
        # Some encoders answer a write without its value.
        has_value = register is not None and "data" in reply._fields
        register_value = self._decode_register(register, reply) if has_value else None
        return Answer(request, reply, register_value)

    def restart(self) -> None:
        """Forget all requests. Call this after the encoder has been switched off or a word has been lost."""
        self._sent = self._request_before = None

    def _make_read_request(self, address: int) -> Request:
        """Return the request that reads the register at an address.

        Raises TypeError if the encoder has no such request.
        """
        if self._read_request_class is None:
            raise TypeError(f"{self._encoder.code} has no request that reads a register")
        return self._fill_request(self._read_request_class, {"address": address})

    def _make_write_requests(self, address: int, data: bytes) -> Iterator[Request]:
        """Yield the requests that write bytes to the register at an address, one of each class that a write needs.

        A request has a field ``address``, a field ``data``, or both. Raises TypeError if the encoder has no such
        request.
        """
        values = {"address": address, "data": int.from_bytes(data, "big")}
        if not self._write_request_classes:
            raise TypeError(f"{self._encoder.code} has no request that writes a register")
        for request_class in self._write_request_classes:
            yield self._fill_request(request_class, values)

    def _fill_request(self, request_class: Any, values: Mapping[str, int]) -> Request:
        """Return a request with those of ``values`` that it has. A request of variable width also has the encoder."""
        fields: dict[str, Any] = {name: values[name] for name in request_class._fields if name in values}
        if "variant" in request_class._fields:
            fields["variant"] = self._encoder
        request: Request = request_class(**fields)
        return request

    def _start_request(self, request: Any, register: type | None) -> int:
        """Return the word for a request, and remember the request until its reply arrives.

        ``register`` is the class of the register that the request reads or writes, or None. Raises TypeError if the
        encoder does not answer the request, and RuntimeError if the word received with the previous request has not
        been taken.
        """
        if type(request) not in self._replies:
            request_names = ", ".join(kind.__name__ for kind in self._replies)
            raise TypeError(f"{self._encoder.code} answers {request_names}, not {type(request).__name__}")
        if self._sent is not None:
            raise RuntimeError("take the word that was received with the previous request first")
        word: int = request.encode()
        bits: int = request.frame_bits(*request._arguments())
        self._bits = bits
        self._sent = _Sent(request, register, bits)
        return word

    def _find_address(self, register: type) -> tuple[int, int]:
        """Return the address and the length in bytes of a register, given as its class.

        Raises TypeError for other classes.
        """
        if register not in self._register_places:
            register_names = ", ".join(kind.__name__ for kind in self._register_places) or "none"
            raise TypeError(
                f"'{getattr(register, '__name__', register)}' is not a register over SPI; these are: {register_names}"
            )
        return self._register_places[register]

    def _decode_register(self, register: Any, reply: Any) -> Any:
        """Return the register that a reply contains, as an object of the class ``register``."""
        _, byte_count = self._register_places[register]
        data = reply.data.to_bytes(byte_count, "big")
        decode: Any = register.decode
        return decode(data, self._encoder) if issubclass(register, ByEncoder) else decode(data)


class RegisterBus:
    """Registers over SPI, for ``run``. Create it with ``bus()`` of a pipeline.

    Each access sends its requests and receives their replies. Do not send other words meanwhile. Flags in the replies
    are not checked, so read back what you write.
    """

    def __init__(self, line: Pipeline, exchange: Callable[[int], int]) -> None:
        self._line = line
        self._exchange = exchange

    def read(self, address: int, length: int, /) -> bytes:
        """Return the bytes of the register at an address, most significant first.

        Raises:
            FrameError: A word is damaged.
        """
        read_request = self._line._make_read_request(address)
        answer = self._send_request(read_request)
        if self._line._has_late_replies:
            # Replies come one word late, so this answer belongs to an earlier request. The same request is sent again,
            # because the reply to the first one arrives with it.
            answer = self._send_request(read_request)
        data: int = answer.reply.data
        return data.to_bytes(length, "big")

    def write(self, address: int, data: bytes, /) -> None:
        """Write the register at an address. A late reply is taken with the next access.

        Raises:
            FrameError: A word is damaged.
        """
        for request in self._line._make_write_requests(address, data):
            self._send_request(request)

    def _send_request(self, request: Request) -> Any:
        """Send a request, and return the answer in the word that is received meanwhile.

        With late replies, this is the answer to the previous request.
        """
        word = self._line._start_request(request, None)
        received_word = self._exchange(word)
        return self._line.take(received_word)
