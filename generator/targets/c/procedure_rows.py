"""The parts of a procedure in C: its steps as rows of a list, its arguments, and the members for the bytes read."""

from __future__ import annotations

from ...model.record import dataclass
from ...plan.steps import ArgumentRefusal, CheckedArgument, PlannedStep
from .expressions import CExpression, CNumber
from .registers import RegisterCode

ZERO = CNumber(0)


@dataclass(frozen=True, slots=True)
class StepRow:
    """A step at ``index`` of the list: an access to one byte of a register, a wait, or a request.

    ``address`` is an expression with the macro of the register. ``mask`` and ``value`` are the bits of the byte that
    the step writes, waits for, or compares. ``continues_previous`` is True if the byte is accessed together with the
    byte of the previous step. ``note`` is the comment.
    """

    index: int
    operation: PlannedStep
    note: str
    address: str = ""
    mask: int = 0
    value: CExpression = ZERO
    continues_previous: bool = False


@dataclass(frozen=True, slots=True)
class FilledRegister:
    """A register whose struct the function fills with an argument of the procedure.

    ``local`` and ``bytes`` are the local variables for the struct and for the bytes that it encodes to.
    """

    code: RegisterCode
    argument: str
    member: str
    local: str
    bytes: str

    @property
    def needs_setter(self) -> bool:
        """True if other members repeat the value, so that a ``_set_`` function must set all of them."""
        return self.code.codec is not None and self.member in self.code.codec.set_names


@dataclass(frozen=True, slots=True)
class WholeRegister:
    """A register that an argument of the procedure sets as one number.

    ``values`` are its bytes as C expressions. ``bytes`` and ``local`` are the local variables for the bytes and for the
    struct that they decode to.
    """

    code: RegisterCode
    local: str
    bytes: str
    values: tuple[CExpression, ...]


@dataclass(frozen=True, slots=True)
class FilledRows:
    """The steps that write all bytes of a filled register, or with the ``kind`` ``verify``, read them back.

    ``index`` is that of the first step in the list.
    """

    index: int
    kind: str
    register: FilledRegister
    note: str


@dataclass(frozen=True, slots=True)
class ArgumentCode:
    """An argument of a procedure, with its C type and name, its comment, and the reasons to reject its value."""

    checked: CheckedArgument
    type: str
    name: str
    about: str
    refusals: tuple[ArgumentRefusal, ...]


@dataclass(frozen=True, slots=True)
class ReadMember:
    """A member of the struct with the bytes read: ``length`` of these bytes, from index ``first`` on."""

    name: str
    first: int
    length: int
    note: str
