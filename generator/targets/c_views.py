"""What the templates of the C target print: every name chosen, every expression and condition spelled."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ..model import Crc
from .c_source import Paragraph


@dataclass(frozen=True)
class Line:
    """A line of code and what is said about it."""

    code: str
    note: str = ""


@dataclass(frozen=True)
class Choice:
    """An enumeration, or where its numbers do not fit an int, a set of macros."""

    type: str
    about: str
    entries: tuple[Line, ...]
    names: Mapping[int, str]
    is_enum: bool


@dataclass(frozen=True)
class Check:
    """A condition under which a frame or value is refused, and for which fault."""

    condition: str
    fault: str
    note: str = ""


@dataclass(frozen=True)
class Setter:
    """A function that sets a number and the parts that it consists of."""

    name: str
    type: str
    member: str
    argument: str
    limit: str
    assignments: tuple[str, ...]
    about: str
    uses_variant: bool


@dataclass(frozen=True)
class CrcView:
    """A CRC in its forms.

    ``folds`` is the body without a table. ``table`` are the lines of the table, ``step`` takes in one byte with it, from ``table_init`` on;
    ``turned`` says that the register has then to be turned round. For a whole word ``word_table`` is the body with the table and
    ``word_bits`` the one bit by bit.
    """

    name: str
    type: str
    style: str
    about: tuple[Paragraph, ...]
    crc: Crc
    wide: str
    poly: str
    init: str
    xorout: str
    mask: str
    top_shift: str
    width: str
    folds: tuple[str, ...] = ()
    table: tuple[str, ...] = ()
    step: tuple[str, ...] = ()
    table_init: str = ""
    turned: bool = False
    word_table: tuple[str, ...] = ()
    word_bits: tuple[str, ...] = ()


@dataclass(frozen=True)
class CodecView:
    """A struct with its decoder and encoder, for a frame or a register."""

    name: str
    about: tuple[Paragraph, ...]
    members: tuple[Line, ...]
    carried_as: str
    length_macro: str
    length: int
    bits: str
    bits_largest: int
    uses_word: bool
    word_from_bytes: str
    bytes_from_word: tuple[str, ...]
    first_checks: tuple[Check, ...]
    locals: tuple[str, ...]
    decode_checks: tuple[Check, ...]
    fills: tuple[str, ...]
    encode_checks: tuple[Check, ...]
    puts: tuple[str, ...]
    crc_line: tuple[str, ...]
    decode_needs_variant: bool
    encode_needs_variant: bool
    setters: tuple[Setter, ...]
    expected: tuple[Line, ...]
    expected_checks: str
    expected_needs_variant: bool
    fold: CrcView | None


@dataclass(frozen=True)
class Function:
    """A small function of the variant; ``arguments`` are those that come after it."""

    name: str
    type: str
    arguments: str
    body: tuple[str, ...]
    about: str
    uses_variant: bool


@dataclass(frozen=True)
class Limits:
    """Least and greatest value of a register or of one of its meanings; macros where they are the same for all order codes, functions where not."""

    min: str = ""
    max: str = ""
    macros: tuple[Line, ...] = ()
    functions: tuple[Function, ...] = ()
    binding_min: bool = False
    binding_max: bool = False
    #: The least value where it is the same for all order codes.
    least: int | None = None

    def checks(self, name: str) -> Iterable[Check]:
        """Where ``name`` goes beyond them; a limit that its width implies is not checked."""
        if self.binding_min:
            yield Check(f"{name} < {self.min}", "RANGE")
        if self.binding_max:
            yield Check(f"{name} > {self.max}", "RANGE")


@dataclass(frozen=True)
class Mask:
    """Place of a field in the number that a register holds."""

    shift_macro: str
    mask_macro: str
    shift: str
    mask: str
    type: str
    variable: bool
    about: str


@dataclass(frozen=True)
class MeaningView:
    """One of the things that a register can mean."""

    about: tuple[Paragraph, ...]
    limits: Limits


@dataclass(frozen=True)
class AccessView:
    """The functions that read and write a register over a transport; an empty name where there is none. Without ``struct`` it is one byte."""

    read: str
    write: str
    read_about: tuple[Paragraph, ...]
    write_about: tuple[Paragraph, ...]
    type: str
    struct: str
    stem: str
    bank_address: str
    bank: str
    read_checks: tuple[Check, ...]
    write_checks: tuple[Check, ...]
    wait: str
    write_needs_variant: bool


@dataclass(frozen=True)
class RegisterView:
    about: tuple[Paragraph, ...]
    macros: tuple[Line, ...]
    masks: tuple[Mask, ...]
    limits: Limits
    meanings: tuple[MeaningView, ...]
    choices: tuple[Choice, ...]
    explained: tuple[Line, ...]
    codec: CodecView | None
    access: AccessView


@dataclass(frozen=True)
class Selector:
    """Functions that tell a frame by its selecting field."""

    function: str
    by_value: str
    field: str
    words: str
    sender: str
    cases: tuple[tuple[tuple[str, ...], str], ...]
    needs: int
    expression: str


@dataclass(frozen=True)
class InterfaceView:
    title: str
    about: tuple[Paragraph, ...]
    macros: tuple[Line, ...]
    choices: tuple[Choice, ...]
    controls: tuple[Line, ...]
    frames: tuple[Line, ...]
    frame_type: str
    frame_lengths: tuple[tuple[str, str], ...]
    selectors: tuple[Selector, ...]
    cable: tuple[tuple[str, str], ...]
    cable_function: str
    cable_about: tuple[Paragraph, ...]
    timeout_function: str
    timeout_about: tuple[Paragraph, ...]
    timeout_numerator: str
    timeout_type: str
    codecs: tuple[CodecView, ...]


@dataclass(frozen=True)
class StepGroup:
    """Steps of a procedure with arguments: a fixed one, or the bytes of the register that holds an argument."""

    code: str
    note: str = ""
    address: str = ""
    at: int = 0
    bytes: str = ""


@dataclass(frozen=True)
class ArgumentView:
    """An argument that fills a register: the struct and bytes of that register, and the function that sets them."""

    codec: CodecView
    value: str
    bytes: str
    set: str


@dataclass(frozen=True)
class ProcedureView:
    name: str
    about: tuple[Paragraph, ...]
    count_macro: str
    count: int
    rows: tuple[Line, ...]
    parameters: tuple[tuple[str, str], ...]
    filled: tuple[ArgumentView, ...]
    checks: tuple[Check, ...]
    groups: tuple[StepGroup, ...]
    has_loop: bool
    needs_variant: bool
    run: str
    run_about: tuple[Paragraph, ...]
    read_type: str
    read_members: tuple[Line, ...]
    read_bytes: int
    read_fills: tuple[str, ...]


@dataclass(frozen=True)
class AlarmView:
    about: tuple[Paragraph, ...]
    macros: tuple[Line, ...]


@dataclass(frozen=True)
class TakeView:
    """A function that takes parameters over into the variant from the bytes of a register."""

    name: str
    length: str
    about: str
    locals: tuple[str, ...]
    checks: tuple[Check, ...]
    fills: tuple[str, ...]
    bytes: str
    access: AccessView


@dataclass(frozen=True)
class IdentityView:
    """The registers that tell what an encoder is, and the functions that compare them; each check holds where an order code is out."""

    type: str
    function: str
    next: str
    read: str
    reads: tuple[tuple[str, AccessView], ...]
    connection: str
    title: str
    members: tuple[Line, ...]
    locals: tuple[str, ...]
    checks: tuple[Check, ...]
    uses_variant: bool
