# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Base classes of all encoders and of the frames that they send."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final, NamedTuple, NoReturn, Protocol, TypeVar, cast, runtime_checkable

from .codec import PositionRange, shorten
from .error_handlers import ErrorHandler as ErrorHandler
from .error_handlers import raise_frame_error as raise_frame_error
from .error_handlers import return_frame_error as return_frame_error
from .errors import FamilyError, FrameError, InterfaceError
from .order_codes import OrderCode, check_label
from .reports import Family, Interface, Report, Verdict

if TYPE_CHECKING:
    from .bulk.table import Table
    from .facts import Clock, Timeout

_Same = TypeVar("_Same", bound="Encoder")
#: Names of the procedures for each interface.
_Procedures = Mapping[Interface, tuple[str, ...]]
_NO_PROCEDURES: Final[_Procedures] = MappingProxyType({})


class Frame(Protocol):
    """Frame that an encoder sends."""

    @property
    def reports(self) -> tuple[Report, ...]:
        """Encoder reports in this frame."""
        ...

    def encode(self) -> int | bytes:
        """Return the frame as it is sent."""
        ...

    def to_dict(self) -> dict[str, Any]:
        """Return the frame as plain values for JSON."""
        ...


if TYPE_CHECKING:

    @runtime_checkable
    class PositionFrame(Frame, Protocol):
        """Frame with a position. All such frames have this base class, so ``isinstance`` is fast."""

        @property
        def position(self) -> int:
            """Raw position in counts. Check ``verdict`` before you use the position."""
            ...

        @property
        def verdict(self) -> Verdict:
            """Verdict on the position."""
            ...

        @property
        def usable_position(self) -> int | None:
            """Position in counts, or None if it is not usable."""
            ...

    class Positioned:
        """Base class of all frames with a position."""

        __slots__ = ()

else:

    class PositionFrame:
        """Frame with a position. All such frames have this base class, so ``isinstance`` is fast."""

        __slots__ = ()

    # Type checkers compare members, and would reject this base next to a NamedTuple.
    Positioned = PositionFrame


class Exchanged(NamedTuple):
    """Request with its reply.

    Attributes:
        request: Class of the request.
        reply: Class of the reply, or None if the encoder does not answer.
        purpose: ``position`` if the reply contains the position, otherwise ``other``.
        repeats_first: True if the reply begins with the first byte of the request.
        defaults: Factory defaults of values in the request, such as the address of the encoder, by name.
    """

    request: Any
    reply: Any
    purpose: str
    repeats_first: bool
    defaults: Mapping[str, int]


class Encoder:
    """Encoder of any family, as its order code describes it. Immutable.

    Attributes:
        family: Family of the encoder.
        interface: Interface of the encoder.
        code: Order code, without any text that follows it on the label.
        parts: Parts of the order code.
        unlisted: Names of the parts whose values the manual does not list.
        tail: Text that followed the order code on the label.
        special_code: Ending ``/Sxxx`` of the label, or empty.
        written_as_in: Document that uses the label's spelling of the order code, if it is not the usual spelling.
    """

    family: ClassVar[Family]
    interface: ClassVar[Interface]
    #: Names of the parameters that the family adds.
    _parameters: ClassVar[tuple[str, ...]] = ()

    code: str
    parts: tuple[str, ...]
    unlisted: tuple[str, ...]
    tail: str
    special_code: str
    written_as_in: str
    #: Functions that decode frames of this encoder.
    _decoders: dict[object, Any]

    def __init__(
        self,
        code: str,
        parts: tuple[str, ...],
        *,
        unlisted: tuple[str, ...] = (),
        tail: str = "",
        special_code: str = "",
        written_as_in: str = "",
        **parameters: int,
    ) -> None:
        if parameters.keys() != set(self._parameters):
            expected = ", ".join(self._parameters)
            missing_or_unknown = parameters.keys() ^ set(self._parameters)
            unmatched = ", ".join(sorted(missing_or_unknown))
            raise TypeError(f"{type(self).__name__} takes {expected}; missing or unknown: {unmatched}")
        # Encoders are immutable: setting an attribute would raise an error.
        self.__dict__.update(
            parameters,
            code=code,
            parts=parts,
            unlisted=unlisted,
            tail=tail,
            special_code=special_code,
            written_as_in=written_as_in,
            _decoders={},
        )

    def __init_subclass__(cls, **keywords: Any) -> None:
        """Replace ``decode`` and ``try_decode`` with a ``_BoundDecoder`` in classes that make decoders."""
        super().__init_subclass__(**keywords)
        if "_get_decoder" in vars(cls):
            for name in ("decode", "try_decode"):
                setattr(cls, name, _BoundDecoder(name, vars(cls)[name]))

    def exchanges(self) -> tuple[Exchanged, ...]:
        """Return the RS-485 requests and their replies, unless the requests have data IDs."""
        return ()

    @property
    def special(self) -> bool:
        """True if the label has a ``/Sxxx`` suffix."""
        return bool(self.special_code)

    @property
    def clock(self) -> Clock | None:
        """Clock limits of this order code. None over RS-485."""
        facts = self._facts()
        return getattr(facts, "clock", None)

    @property
    def timeout(self) -> Timeout | None:
        """Timeout after a BiSS frame, for this order code. None over other interfaces, or if it is not known."""
        facts = self._facts()
        return getattr(facts, "timeout", None)

    def _facts(self) -> Any:
        """Return the facts about the interface for this order code, such as ``SsiFacts``."""
        # The generated class of the family's encoders knows the family.
        family_class = next(base_class for base_class in type(self).__mro__ if "family" in vars(base_class))
        facts: Any = load_fact(family_class.__module__, self.interface.name)
        return facts.for_code(self.code)

    def decode(self, frame: Any, *arguments: Any, **answers: Any) -> Frame:
        """Decode a frame that the encoder sent. The class for each family and interface describes its frames.

        Args:
            frame: Bytes, or a number or a string of 0 and 1 if the frame consists of bits.
            arguments, answers: Further arguments of the class for the family and the interface.

        Returns:
            The frame. It is a :class:`PositionFrame` if it contains a position.

        Raises:
            FrameError: The frame is damaged or does not belong to this encoder. The subclass indicates the error.
            TypeError: ``frame`` does not have the type of this encoder's frames, or an answer is missing.
            NotImplementedError: The class of the encoder describes no frames.
        """
        raise NotImplementedError(f"the frames of {self.code} are not documented")

    def try_decode(self, frame: Any, *arguments: Any, **answers: Any) -> Frame | FrameError:
        """Decode a frame like ``decode``, but return a frame error instead of raising it.

        Args:
            frame, arguments, answers: See ``decode``.

        Returns:
            The frame, or the error.

        Raises:
            TypeError, NotImplementedError: See ``decode``.
        """
        raise NotImplementedError(f"the frames of {self.code} are not documented")

    def decode_many(self, *frames: Any, **answers: Any) -> Table:
        """Decode many frames into columns. Needs NumPy.

        Args:
            frames: The frames, as numbers or rows of bytes. If the encoder sends several kinds, their class is the
                second argument.
            answers: Answers to the questions that the manual leaves open.

        Returns:
            The columns. An error in a frame is not raised, but recorded in the column ``fault``.

        Raises:
            NotImplementedError: The class of the encoder describes no frames.
        """
        raise NotImplementedError(f"the frames of {self.code} are not documented")

    def unwrap(self, previous: int, position: int, /) -> int:
        """Return the count nearest to ``previous`` that corresponds to ``position``.

        Args:
            previous: Result of the previous call. On the first call, pass the first position.
            position: Position in a frame, in counts.

        Returns:
            The count, which continues when the position wraps around.

        Raises:
            RangeError: The encoder does not have this position.
            ValueError: The manual does not say where the position wraps around.
        """
        raise ValueError(f"the manual does not say where the position of {self.code} wraps around")

    def range_of(self, kind: type[Any], /) -> PositionRange:
        """Return the range of the positions in frames of one class.

        Args:
            kind: Class of the frames.

        Raises:
            TypeError: Frames of this class have no position.
            ValueError: The manual does not say where the position wraps around.
        """
        if not hasattr(kind, "usable_position"):
            raise TypeError(f"frames of the class {getattr(kind, '__name__', kind)} have no position")
        return self._range_in(kind._frame_name(self))

    def _range_in(self, frame: str, /) -> PositionRange:
        """Raise ValueError, because the manual of this family does not say where the position wraps around.

        Other families override this method and return the range of the positions in a frame of this name.
        """
        raise ValueError(f"the manual does not say where the position of {self.code} wraps around")

    def _position_ranges(self) -> Mapping[str, PositionRange]:
        """Return the range of positions in each frame by name, or an empty one if all frames have the same range."""
        return {}

    def _hint(self, frame: object) -> str:
        """Return the common mistake that would explain an invalid frame, or an empty string."""
        from .causes import hint

        return hint(self, frame)

    def _comparison_key(self) -> tuple[object, ...]:
        """Return the values that are compared for equality.

        ``unlisted`` are the names of parts whose values the manual does not list, and ``special_code`` is the suffix
        ``/Sxxx``. The text on the label is omitted, because two labels can denote the same encoder.
        """
        parameter_values = (getattr(self, name) for name in self._parameters)
        return (type(self), self.code, self.parts, self.unlisted, self.special_code, *parameter_values)

    def _with_changes(self: _Same, **changes: Any) -> _Same:
        """Return a copy of the encoder with other values for these attributes."""
        return _restore(type(self), {**self._list_attributes(), **changes})

    def _list_attributes(self) -> dict[str, Any]:
        """Return the attributes from which an encoder can be recreated, by name."""
        names = ("code", "parts", "unlisted", "tail", "special_code", "written_as_in", *self._parameters)
        return {name: getattr(self, name) for name in names}

    def __eq__(self, other: object) -> bool:
        return self._comparison_key() == other._comparison_key() if isinstance(other, Encoder) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._comparison_key())

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (type(self), self._list_attributes())

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(f"encoders are immutable: '{name}' cannot be set")

    def __delattr__(self, name: str) -> NoReturn:
        raise AttributeError(f"encoders are immutable: '{name}' cannot be deleted")

    def __repr__(self) -> str:
        return f"<{self.code}{self.special_code}>"


class SerialEncoder(Encoder):
    """Encoder with RS-485, which a serial port can reach. Type checkers reject others for ``open_encoder``."""


class _BoundDecoder:
    """Descriptor for the method ``decode`` or ``try_decode``. The first access replaces it by the encoder's decoder.

    The decoder is a function, so it is equally fast in a variable, in ``map``, in another thread and as a method.
    """

    def __init__(self, name: str, method: Any) -> None:
        self._name, self._method = name, method
        self.__doc__ = method.__doc__

    def __get__(self, encoder: Any, kind: object = None) -> Any:
        """Return the decoder for an encoder, or the method itself if it is accessed on the class."""
        if encoder is None:
            return self._method
        handle_error: ErrorHandler = raise_frame_error if self._name == "decode" else return_frame_error
        decode = encoder._get_decoder(handle_error)
        decode.__doc__ = self._method.__doc__
        # Python's messages about arguments contain this name.
        decode.__qualname__ = self._method.__qualname__
        # Later accesses find it there, before this descriptor.
        encoder.__dict__[self._name] = decode
        return decode


def _restore(encoder_class: type[_Same], state: dict[str, Any]) -> _Same:
    """Return an encoder with these attributes, for copying and unpickling.

    Pickles contain the name of this function.
    """
    return encoder_class(**state)


def load_fact(module: str, name: str) -> object:
    """Return a table of facts, such as ``SSI``, of a family's module. Their names are in capitals.

    It is in the package ``facts``, next to the module.

    Raises:
        AttributeError: There is no such table.
    """
    package, _, family = module.rpartition(".")
    # Other names do not need the module of facts, which takes time to load.
    facts = import_module(f"{package}.facts.{family}") if name.isupper() else None
    if facts is None or name not in vars(facts):
        raise AttributeError(f"module '{module}' has no attribute '{name}'")
    return getattr(facts, name)


def look_up(label: str, listed_encoders: Mapping[str, _Same], module: str) -> _Same:
    """Return the encoder with this label from a family.

    Args:
        label: The text on the label.
        listed_encoders: The encoders of the family, by their listed order codes.
        module: Name of the family's module.

    Raises:
        OrderCodeError: There is no such order code.
        TypeError: ``label`` is not a string.
    """
    text = check_label(label)
    if text in listed_encoders:
        return listed_encoders[text]
    # The label is not a listed code, but it can have a tail, a suffix, unlisted values or another spelling.
    parts_by_code = {code: encoder.parts for code, encoder in listed_encoders.items()}
    family = next(iter(listed_encoders.values())).family
    order_code = cast(OrderCode, load_fact(module, "ORDER_CODE"))
    parsed_label = order_code.read(text, family.name.upper(), parts_by_code)
    # The encoder of the listed code that fits best is changed where the label differs: for the label X-24-TAIL, the
    # encoder of X-24 gets the tail "-TAIL".
    listed_encoder = next(encoder for encoder in listed_encoders.values() if encoder.parts == parsed_label.listed)
    has_changes = parsed_label.unlisted or parsed_label.tail or parsed_label.special or parsed_label.written_as_in
    if not has_changes:
        return listed_encoder
    return listed_encoder._with_changes(
        code=parsed_label.code,
        parts=parsed_label.parts,
        unlisted=parsed_label.unlisted,
        tail=parsed_label.tail,
        special_code=parsed_label.special,
        written_as_in=parsed_label.written_as_in,
    )


def wrong_encoder_error(
    encoder: object,
    family_class: type[Encoder],
    interface: Interface,
    procedures: _Procedures = _NO_PROCEDURES,
) -> Exception:
    """Return the error for an encoder that belongs to a different family or does not have the interface ``interface``.

    ``family_class`` is the class of all encoders of the family. ``procedures`` lists the procedures for each interface,
    for suggestions in the message. The error is a TypeError if ``encoder`` is not an encoder.
    """
    if isinstance(encoder, family_class):
        encoder_interface = encoder.interface
        suggestion = ""
        if encoder_interface in procedures:
            suggestion = f". Procedures over {encoder_interface.title}: {', '.join(procedures[encoder_interface])}"
        return InterfaceError(encoder.code, encoder_interface, interface, suggestion)
    if isinstance(encoder, Encoder):
        return FamilyError(encoder.code, encoder.family.name, family_class.family.name)
    return not_an_encoder_error(encoder)


def not_an_encoder_error(value: object) -> TypeError:
    """Return the error for a value that is not an encoder, such as the text of an order code."""
    return TypeError(f"expected an encoder, got {shorten(value)}; lookup() returns one for an order code")


def check_encoder(
    encoder: object,
    family_class: type[Encoder],
    interface: Interface,
    procedures: _Procedures = _NO_PROCEDURES,
) -> None:
    """Raise an error if the encoder belongs to a different family or does not have the interface ``interface``.

    ``family_class`` is the class of all encoders of the family. ``procedures`` lists the procedures for each interface.
    The message suggests them to callers of a procedure.
    """
    if not isinstance(encoder, family_class) or encoder.interface is not interface:
        raise wrong_encoder_error(encoder, family_class, interface, procedures)
