# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Base classes of all encoders and of the frames that they send."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any, ClassVar, NoReturn, Protocol, TypeVar, cast, runtime_checkable

from .order_codes import OrderCode, checked
from .reports import Family, Interface, Report, Verdict

_Same = TypeVar("_Same", bound="Encoder")


class Frame(Protocol):
    """Frame that an encoder sends."""

    @property
    def reports(self) -> tuple[Report, ...]:
        """Encoder reports in this frame."""
        ...

    def encode(self) -> int | bytes:
        """Return the frame as it is sent."""
        ...


@runtime_checkable
class PositionFrame(Frame, Protocol):
    """Frame with a position. ``isinstance`` can check for it."""

    @property
    def position(self) -> int:
        """Raw position in counts. Check ``verdict`` before you use it."""
        ...

    @property
    def verdict(self) -> Verdict:
        """Verdict on the position."""
        ...

    @property
    def usable_position(self) -> int | None:
        """Position in counts, or None if it is not usable."""
        ...


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
        written_as_in: Document that uses the label's spelling of the order code, if it is not the usual one.
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
            wrong = sorted(parameters.keys() ^ set(self._parameters))
            raise TypeError(
                f"{type(self).__name__} takes {', '.join(self._parameters)}; missing or unknown: {', '.join(wrong)}"
            )
        self.__dict__.update(
            parameters,
            code=code,
            parts=parts,
            unlisted=unlisted,
            tail=tail,
            special_code=special_code,
            written_as_in=written_as_in,
        )

    @property
    def special(self) -> bool:
        """True if the label has a ``/Sxxx`` suffix."""
        return bool(self.special_code)

    def decode(self, frame: Any) -> Frame:
        """Decode a frame that the encoder sent. The class for each family and interface describes its frames."""
        raise NotImplementedError(f"the frames of {self.code} are not documented")

    def _key(self) -> tuple[object, ...]:
        """Return the key by which encoders are compared. Two labels may denote the same encoder."""
        values = (getattr(self, name) for name in self._parameters)
        return (type(self), self.code, self.parts, self.unlisted, self.special_code, *values)

    def _replaced(self: _Same, **changes: Any) -> _Same:
        """Return a copy with these attributes changed."""
        return _restored(type(self), {**self._state(), **changes})

    def _state(self) -> dict[str, Any]:
        names = ("code", "parts", "unlisted", "tail", "special_code", "written_as_in", *self._parameters)
        return {name: getattr(self, name) for name in names}

    def __eq__(self, other: object) -> bool:
        return self._key() == other._key() if isinstance(other, Encoder) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._key())

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), self._state())

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(f"encoders are immutable: '{name}' cannot be set")

    def __delattr__(self, name: str) -> NoReturn:
        raise AttributeError(f"encoders are immutable: '{name}' cannot be deleted")

    def __repr__(self) -> str:
        return f"<{self.code}{self.special_code}>"


def _restored(kind: type[_Same], state: dict[str, Any]) -> _Same:
    """Recreate an encoder from its attributes, for copying and unpickling."""
    return kind(**state)


def fact(module: str, name: str) -> object:
    """Return a table of facts of a module. The first access loads all tables."""
    package, _, family = module.rpartition(".")
    facts = import_module(f"{package}.facts.{family}") if name.isupper() else None
    if facts is None or name not in vars(facts):
        raise AttributeError(f"module '{module}' has no attribute '{name}'")
    return getattr(facts, name)


def looked_up(label: str, variants: Mapping[str, _Same], module: str) -> _Same:
    """Return the encoder of a family that belongs to a label. ``lookup`` of the module documents the arguments.

    Args:
        label: The text on the label.
        variants: The encoders of the family, by their listed order codes.
        module: Name of the family's module.

    Raises:
        OrderCodeError: There is no such order code.
        TypeError: ``label`` is not a string.
    """
    text = checked(label)
    if text in variants:
        return variants[text]
    codes = {code: variant.parts for code, variant in variants.items()}
    family = next(iter(variants.values())).family
    found = cast(OrderCode, fact(module, "ORDER_CODE")).read(text, family.name.upper(), codes)
    variant = next(item for item in variants.values() if item.parts == found.listed)
    if not (found.unlisted or found.tail or found.special or found.written_as_in):
        return variant
    return variant._replaced(
        code=found.code,
        parts=found.parts,
        unlisted=found.unlisted,
        tail=found.tail,
        special_code=found.special,
        written_as_in=found.written_as_in,
    )
