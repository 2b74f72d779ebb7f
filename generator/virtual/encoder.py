"""Simulated encoder: its position, flags, supply and registers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cache, cached_property
from pathlib import Path
from time import monotonic

from ..language.problems import Report
from ..loading.editions import revision_for
from ..loading.library import Family, in_edition, load_families, sound_families
from ..model import (
    Biss,
    Choice,
    Constant,
    CrcValue,
    Decimal,
    Device,
    Field,
    Flag,
    Layout,
    Measurement,
    Number,
    Parity,
    PlacedField,
    PlacedLayout,
    Text,
    Unused,
    Variant,
    assert_never,
)
from ..one_line.encoder import device_of_line
from ..one_line.parse import is_line
from ..order_codes.labels import Match, UnknownOrderCode, find
from ..order_codes.parameters import with_answers
from ..reference import codec
from .faults import Faults, Position
from .memory import Memory

#: Seconds without supply after a restart, and until an encoder that reports this is ready.
OFF_S = 0.02
READY_S = 0.01


class VirtualEncoder:
    """Encoder of an order code.

    ``Rs485Line``, ``BissLine`` and ``SsiLine`` send its position in frames.

    Args:
        order_code: Order code, as on the label, or the encoder in one line.
        position: Position in counts, or a function of the time in seconds that returns it.
        choose: Answers to questions that the manual leaves open, by name.
        registers: Initial bytes of registers, by name.
        faults: Faults by name, each with a rate per reply, such as ``flip:1e-3``.
        seed: Seed of the random faults.
        clock: Function that returns the time in seconds. By default, the time since the encoder was created.
        edition: Revision of the manual. By default, that of the spec.
        specs: Specs to use. By default, those shipped with codewheel.

    Attributes:
        device: The family.
        flags: Names of the active flags and alarms. Change them with ``set_flag`` and ``clear_flag``.
        memory: The registers.
        faults: The faults, and the number of times that each was injected.

    Raises:
        ValueError: There is no such order code, edition, register, answer or fault, the interface cannot have this
            fault, or an answer is missing.
    """

    def __init__(
        self,
        order_code: str,
        position: Position = 0,
        *,
        choose: Mapping[str, str] | None = None,
        registers: Mapping[str, bytes] | None = None,
        faults: Iterable[str] = (),
        seed: int = 0,
        clock: Callable[[], float] | None = None,
        edition: str = "",
        specs: Iterable[Path] = (),
    ) -> None:
        self.device, match = _find_code(order_code, tuple(specs), edition)
        self.answers = dict(choose or {})
        self._check_answers(match.variant)
        self.variant = with_answers(self.device, match.variant, self.answers)
        self._placed: tuple[Variant, dict[str, PlacedLayout]] = (self.variant, {})
        self.position = position
        self.faults = Faults(self.variant.interface, faults, seed)
        self.flags: set[str] = set()
        self._offset = 0
        self._off_until = self._busy_until = 0.0
        self._instant: float | None = None
        started = monotonic()
        self.clock = clock or (lambda: monotonic() - started)
        self.memory = Memory(self, registers or {})

    @property
    def counts(self) -> int:
        """Number of positions in the first frame with a position."""
        return self._counts(self._position_layout)

    @property
    def lowest(self) -> int:
        """Lowest position in that frame. It is negative if the position is signed."""
        return self._lowest(self._position_layout)

    @property
    def counts_per_turn(self) -> int:
        """Number of positions in one turn, or 0 if the position is not an angle."""
        measurement = self._measurement(self._position_layout)
        per_turn = measurement.counts_per_turn if measurement is not None else None
        return per_turn.value(self.variant.parameters) if per_turn is not None else 0

    def _counts(self, layout: Layout | None) -> int:
        """Return the number of positions in frames with this layout."""
        measurement = self._measurement(layout)
        total = measurement.total if measurement is not None else None
        if total is not None:
            return total.value(self.variant.parameters)
        return 1 << sum(placed_field.width for placed_field in self._fields(layout))

    def _lowest(self, layout: Layout | None) -> int:
        """Return the lowest position in frames with this layout."""
        fields = self._fields(layout)
        if len(fields) != 1 or not fields[0].field.number.signed:
            return 0
        measurement = self._measurement(layout)
        if measurement is not None and measurement.highest is not None:
            return measurement.highest.value(self.variant.parameters) - self._counts(layout) + 1
        return -(self._counts(layout) // 2)

    def _measurement(self, layout: Layout | None) -> Measurement | None:
        """Return the unit and range of the position in frames with this layout."""
        if layout is None:
            return self.device.measurement_of(self.variant.interface)
        return self.device.measurement_in(self.variant.interface, layout)

    def position_names(self) -> frozenset[str]:
        """Return the names of the fields that form the position or a part of it."""
        return self.device.position_names(self.variant.interface)

    def position_now(self) -> int:
        """Return the position that the encoder currently sends."""
        return 0 if self.is_busy() and self._not_ready else self._wrapped(self.raw_position() + self._offset)

    def _wrapped(self, position: int) -> int:
        """Return the position that the encoder sends for a count."""
        return self._wrapped_in(self._position_layout, position)

    def _wrapped_in(self, layout: Layout | None, position: int) -> int:
        """Return the position that frames with this layout contain for a count."""
        lowest = self._lowest(layout)
        return lowest + (position - lowest) % self._counts(layout)

    def parts_now(self, layout: Layout | None = None) -> dict[str, int]:
        """Return the bits of each field of the current position in frames with a layout, by default the first one."""
        if layout is None or not self._carries_position(layout):
            layout = self._position_layout
        is_away = self.is_busy() and self._not_ready
        count = 0 if is_away else self._wrapped_in(layout, self.raw_position() + self._offset)
        values = dict[str, int]()
        for placed_field in reversed(self._fields(layout)):
            values[placed_field.name] = count & placed_field.mask
            count >>= placed_field.width
        return values

    def raw_position(self) -> int:
        """Return the current position without presets and resets."""
        return int(self.position(self._now()) if callable(self.position) else self.position)

    def set_position(self, value: int) -> None:
        """Report ``value`` at the current shaft position, as a preset or reset does."""
        self._offset = value - self.raw_position()

    def add_offset(self, value: int) -> None:
        """Report the shaft position plus ``value``."""
        self._offset = value

    def set_flag(self, *names: str) -> None:
        """Activate alarms or flags.

        Raises:
            ValueError: There is no such alarm or flag.
        """
        flag_names = self._flags
        for name in names:
            if name not in flag_names:
                known_names = ", ".join(sorted(flag_names)) or "none"
                raise ValueError(f"{self.variant.code} has no flag '{name}'; it has: {known_names}")
        self.flags.update(names)

    def clear_flag(self, *names: str) -> None:
        """Deactivate alarms or flags."""
        self.flags.difference_update(names)

    def reset(self, procedure: str) -> None:
        """Carry out a reset: clear its alarms, and set the parts of the position that its name contains to 0."""
        self.flags -= {alarm.name for alarm in self.device.alarms if procedure in alarm.cleared_by}
        # The position of another frame may be wider, so it stays as it is unless a part of it is reset.
        if not any(name in procedure for name, _ in self._parts()):
            return
        low = 0
        value = self._wrapped(self.raw_position() + self._offset)
        for name, width in reversed(self._parts()):
            if name in procedure:
                value &= ~(((1 << width) - 1) << low)
            low += width
        self.set_position(value & (1 << low) - 1)

    def restart(self) -> None:
        """Switch the supply off and on again. Registers that were not saved are lost."""
        self._off_until = self.clock() + OFF_S
        self.memory.restart()
        self.be_busy(OFF_S + READY_S)

    def be_busy(self, seconds: float) -> None:
        """Be busy for a time."""
        self._busy_until = max(self._busy_until, self.clock() + seconds)

    def is_off(self) -> bool:
        """Return whether the encoder is powered off."""
        return self.clock() < self._off_until

    def is_busy(self) -> bool:
        """Return whether the encoder is busy, after power-on or during a reset."""
        return self._now() < self._busy_until

    @property
    def reports_busy(self) -> bool:
        """True if a flag in frames shows that the encoder is busy."""
        return bool(self._not_ready)

    @cached_property
    def _in_registers(self) -> frozenset[str]:
        return frozenset(alarm.name for alarm in self.device.alarms if alarm.register)

    def frame(self, layout: Layout, request_values: Mapping[str, int | str | bool] | None = None) -> int:
        """Return a frame with the current values as one number. The request determines ``request_values``."""
        self._instant = self.clock()
        try:
            return codec.encode(self.device, self.place(layout), self._values(layout, request_values or {}))
        finally:
            self._instant = None

    def frame_of_another(self, layout: Layout, request_values: Mapping[str, int | str | bool]) -> int:
        """Return the frame that a second encoder of this kind sends, whose shaft is half of all positions away."""
        distance = self._counts(layout) // 2
        self._offset += distance
        try:
            return self.frame(layout, request_values)
        finally:
            self._offset -= distance

    def place(self, layout: Layout) -> PlacedLayout:
        """Return a layout for this encoder with its current registers."""
        if self._placed[0] is not self.variant:
            self._placed = (self.variant, {})
        if layout.name not in self._placed[1]:
            self._placed[1][layout.name] = layout.place(self.variant.parameters)
        return self._placed[1][layout.name]

    def layouts(self, sender: str) -> tuple[Layout, ...]:
        """Return the frames that the encoder or the master sends on this interface."""
        layouts = self.device.interface(self.variant.interface).layouts
        return tuple(layout for layout in layouts if layout.sender == sender)

    def needs_answer(self, layout: Layout) -> bool:
        """Return whether a question about this layout is open."""
        return any(alternative.name not in self.answers for alternative in self.device.alternatives_of(layout))

    def is_active(self, field: Field) -> bool:
        """Return whether a flag is active."""
        assert isinstance(field.kind, Flag)
        if field.name in self.flags or any(name in self.flags for name in field.kind.sums_up):
            return True
        if self.is_busy() and self._not_ready & {field.name, *field.kind.sums_up}:
            return True
        # Over BiSS, an error in a register also sets the error flag of the frame.
        return (
            bool(self.flags) and field.name == next(iter(Biss.flags)) and not self.flags.isdisjoint(self._in_registers)
        )

    def _now(self) -> float:
        """Return the time. It does not advance while a frame is built, so that its fields are consistent."""
        return self.clock() if self._instant is None else self._instant

    def _values(self, layout: Layout, request_values: Mapping[str, int | str | bool]) -> dict[str, int | str | bool]:
        values: dict[str, int | str | bool] = {}
        parts = self.parts_now(layout)
        for placed_field in self.place(layout).fields:
            field = placed_field.field
            if not field.carries_data:
                continue
            documented = field.documented(self.variant.parameters)
            if placed_field.name in request_values:
                values[placed_field.name] = request_values[placed_field.name]
            elif placed_field.name in parts:
                values[placed_field.name] = _number(placed_field, parts[placed_field.name] & placed_field.mask)
            elif isinstance(field.kind, Flag):
                values[placed_field.name] = self.is_active(field)
            elif documented is not None:
                values[placed_field.name] = documented
            else:
                values[placed_field.name] = _value_at_rest(field)
        return values

    def _parts(self) -> tuple[tuple[str, int], ...]:
        """Return the fields that form the position with their widths, most significant first."""
        return tuple((placed_field.name, placed_field.width) for placed_field in self._fields(self._position_layout))

    @property
    def _position_layout(self) -> Layout | None:
        """The first frame with a position."""
        return next(filter(self._carries_position, self.layouts("encoder")), None)

    def _carries_position(self, layout: Layout) -> bool:
        measurement = self.device.measurement_of(self.variant.interface)
        name = measurement.of if measurement is not None else "position"
        return layout.names_in(name) != (name,) or self.place(layout).find_field(name) is not None

    def _fields(self, layout: Layout | None) -> tuple[PlacedField, ...]:
        """Return the fields that form the position in frames with a layout, most significant first."""
        if layout is None:
            return ()
        measurement = self.device.measurement_of(self.variant.interface)
        name = measurement.of if measurement is not None else "position"
        return tuple(self.place(layout).find_fields(layout.names_in(name)))

    @cached_property
    def _not_ready(self) -> set[str]:
        """Alarms that do not latch: active while the encoder is not ready."""
        return {alarm.name for alarm in self.device.alarms if alarm.latch is False and alarm.name in self._flags}

    @cached_property
    def _flags(self) -> frozenset[str]:
        layouts = [
            *self.layouts("encoder"),
            *(register.layout for register in self.device.registers_over(self.variant.interface)),
        ]
        fields = (field for layout in layouts for field in layout.fields)
        return frozenset(field.name for field in fields if isinstance(field.kind, Flag) and self._may_send(field))

    def _may_send(self, field: Field) -> bool:
        """Return whether the encoder sends a field, or would send it with other values in its registers."""
        run_time_names = {parameter.name for parameter in self.device.run_time_parameters}
        needed_names = self.device.needed_parameters(field.width.parameters)
        return field.width.value(self.variant.parameters) > 0 or not run_time_names.isdisjoint(needed_names)

    def _check_answers(self, variant: Variant) -> None:
        alternatives = self.device.alternatives
        pairs = [(alternative.name, answer.name) for alternative in alternatives for answer in alternative.answers]
        for name, text in self.answers.items():
            if (name, text) not in pairs:
                options = " or ".join(map("=".join, pairs)) or "none"
                raise ValueError(f"'{name}={text}' answers no question of {variant.code}; write {options}")
        for layout in self.device.interface(variant.interface).layouts:
            if self.device.tells_position(variant.interface, layout):
                self._check_choices(layout)

    def _check_choices(self, layout: Layout) -> None:
        """Check that each question about a layout has an answer."""
        for alternative in self.device.alternatives_of(layout):
            if alternative.name not in self.answers:
                options = " or ".join(f"{alternative.name}={answer.name}" for answer in alternative.answers)
                raise ValueError(f"{alternative.meaning}: choose {options}")


def _number(placed_field: PlacedField, bits: int) -> int:
    """Return the number that the bits of a field stand for."""
    return (
        bits - (1 << placed_field.width)
        if placed_field.field.number.signed and bits >> placed_field.width - 1
        else bits
    )


def _value_at_rest(field: Field) -> int:
    """Return the value of a field that has no other source: that of the bits 0 if they are valid."""
    match field.kind:
        case Choice(values):
            return values[0].value
        case Number(power_of_two=True):
            return 1
        case Number(zero_means=number):
            return number
        case Flag() | Decimal() | Text() | Constant() | Unused() | CrcValue() | Parity():
            return 0
        case _:
            assert_never(field.kind)


@cache
def _families(specs: tuple[Path, ...]) -> tuple[Family, ...]:
    families, report = load_families(specs or None)
    valid_families = tuple(sound_families(families, report))
    if not valid_families:
        raise ValueError("\n".join(problem.format() for problem in report.shown) or "there are no specs")
    return valid_families


def _is_special(device: Device, text: str) -> bool:
    """Return whether the text of an order code contains that of a special model of the family."""
    return any(overlay.special and overlay.special in text for overlay in device.overlays)


def _find_code(text: str, specs: tuple[Path, ...], edition: str) -> tuple[Device, Match]:
    if is_line(text):
        if edition:
            raise ValueError("an encoder in one line has no editions; leave the edition out")
        return device_of_line(text)
    reason = ""
    special_families = [family for family in _families(specs) if _is_special(family.device, text)]
    for family in (*special_families, *(family for family in _families(specs) if not family.device.base)):
        try:
            match = find(family.device, text)
        except UnknownOrderCode as error:
            reason = str(error) if error.close or not reason else reason
            continue
        if not edition:
            return family.device, match
        report = Report()
        family_in_edition = in_edition(family, revision_for(family.device, edition), report)
        if family_in_edition is None or report:
            raise ValueError("\n".join(problem.format() for problem in report.shown))
        return family_in_edition.device, find(family_in_edition.device, text)
    raise ValueError(reason)
