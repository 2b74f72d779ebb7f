"""Simulated encoder: its position, flags, supply and registers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from pathlib import Path
from time import monotonic

from ..model import (
    Biss,
    Field,
    Flag,
    Layout,
    Measurement,
    PlacedField,
    PlacedLayout,
    Variant,
    channel_frame,
)
from ..order_codes.parameters import with_answers
from ..reference import codec
from .faults import Faults, Position
from .find_order_code import find_order_code
from .memory import Memory

#: Seconds without supply after a restart, and until an encoder that reports this is ready.
OFF_S = 0.02
READY_S = 0.01


class VirtualEncoder:
    """Encoder of an order code.

    ``Rs485Line``, ``BissLine``, ``SsiLine`` and ``SpiLine`` send its position in frames.

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
        self.device, match = find_order_code(order_code, tuple(specs), edition)
        self.answers = dict(choose or {})
        self._check_answers(match.variant)
        self.variant = with_answers(self.device, match.variant, self.answers)
        #: Layouts as placed for a variant, by name.
        self._placed_for = self.variant
        self._placed_layouts: dict[str, PlacedLayout] = {}
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
        return self._count_positions(self._position_layout)

    @property
    def lowest(self) -> int:
        """Lowest position in that frame. It is negative if the position is signed."""
        return self._find_lowest_position(self._position_layout)

    @property
    def counts_per_turn(self) -> int:
        """Number of positions in one turn, or 0 if the position is not an angle."""
        measurement = self._find_measurement(self._position_layout)
        per_turn = measurement.counts_per_turn if measurement is not None else None
        return per_turn.value(self.variant.parameters) if per_turn is not None else 0

    def _count_positions(self, layout: Layout | None) -> int:
        """Return the number of positions in frames with this layout.

        Without a measurement, all values of the position fields count.
        """
        measurement = self._find_measurement(layout)
        total = measurement.total if measurement is not None else None
        if total is not None:
            return total.value(self.variant.parameters)
        return 1 << sum(placed_field.width for placed_field in self._position_fields(layout))

    def _find_lowest_position(self, layout: Layout | None) -> int:
        """Return the lowest position in frames with this layout.

        It is 0 unless the position is a single signed field. Without a highest position, half of them are negative.
        """
        fields = self._position_fields(layout)
        if len(fields) != 1 or not fields[0].field.number.signed:
            return 0
        measurement = self._find_measurement(layout)
        if measurement is not None and measurement.highest is not None:
            highest = measurement.highest.value(self.variant.parameters)
            return highest - self._count_positions(layout) + 1
        return -(self._count_positions(layout) // 2)

    def _find_measurement(self, layout: Layout | None) -> Measurement | None:
        """Return the unit and range of the position in frames with this layout."""
        if layout is None:
            return self.device.measurement_of(self.variant.interface)
        return self.device.measurement_in(self.variant.interface, layout)

    def position_names(self) -> frozenset[str]:
        """Return the names of the fields that form the position or a part of it."""
        return self.device.position_names(self.variant.interface)

    def position_now(self) -> int:
        """Return the position that the encoder currently sends, which is 0 while it reports that it is not ready."""
        if self._reports_not_ready():
            return 0
        return self._wrap_into(self._position_layout, self.raw_position() + self._offset)

    def _reports_not_ready(self) -> bool:
        """Return whether the encoder is busy and reports that, so that it has no position."""
        return self.is_busy() and self.reports_busy

    def _wrap_into(self, layout: Layout | None, count: int) -> int:
        """Return the position in frames with this layout for a count, which can be outside their range."""
        lowest = self._find_lowest_position(layout)
        return lowest + (count - lowest) % self._count_positions(layout)

    def parts_now(self, layout: Layout | None = None) -> dict[str, int]:
        """Return the bits of each field of the current position: ``{"multiturn": 3, "singleturn": 1024}``.

        They are the bits in frames with ``layout`` if it has the position, and else in the first frame with one. They
        are 0 while the encoder reports that it is not ready.
        """
        if layout is None or not self._carries_position(layout):
            layout = self._position_layout
        remaining_bits = 0
        if not self._reports_not_ready():
            remaining_bits = self._wrap_into(layout, self.raw_position() + self._offset)
        # From the least significant field on.
        bits_by_field: dict[str, int] = {}
        for placed_field in reversed(self._position_fields(layout)):
            bits_by_field[placed_field.name] = remaining_bits & placed_field.mask
            remaining_bits >>= placed_field.width
        return bits_by_field

    def raw_position(self) -> int:
        """Return the current position without presets and resets."""
        if callable(self.position):
            return int(self.position(self._read_clock()))
        return int(self.position)

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
        for name in names:
            if name not in self._flag_names:
                known_names = ", ".join(sorted(self._flag_names)) or "none"
                raise ValueError(f"{self.variant.code} has no flag '{name}'; it has: {known_names}")
        self.flags.update(names)

    def clear_flag(self, *names: str) -> None:
        """Deactivate alarms or flags."""
        self.flags.difference_update(names)

    def reset(self, procedure: str) -> None:
        """Carry out a reset: clear its alarms, and set the parts of the position that its name contains to 0.

        For example, the ``procedure`` named ``reset_multiturn`` sets the field ``multiturn`` to 0.
        """
        self.flags -= {alarm.name for alarm in self.device.alarms if procedure in alarm.cleared_by}
        # The position of another frame may be wider, so it stays as it is unless a part of it is reset.
        fields = self._position_fields(self._position_layout)
        if not any(placed_field.name in procedure for placed_field in fields):
            return
        position = self._wrap_into(self._position_layout, self.raw_position() + self._offset)
        # Lowest bit of the field in the position, and after the loop, the number of bits of the position.
        low_bit = 0
        for placed_field in reversed(fields):
            if placed_field.name in procedure:
                position &= ~(placed_field.mask << low_bit)
            low_bit += placed_field.width
        position_mask = (1 << low_bit) - 1
        self.set_position(position & position_mask)  # as an unsigned number

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
        return self._read_clock() < self._busy_until

    @property
    def reports_busy(self) -> bool:
        """True if a flag in frames shows that the encoder is busy."""
        return bool(self._not_ready_flags)

    @cached_property
    def _alarms_in_registers(self) -> frozenset[str]:
        return frozenset(alarm.name for alarm in self.device.alarms if alarm.register)

    def frame(self, layout: Layout, request_values: Mapping[str, int | str | bool] | None = None) -> int:
        """Return a frame with the current values as one number. The request determines ``request_values``."""
        self._instant = self.clock()  # ``_read_clock`` returns it for all fields.
        try:
            return codec.encode(self.device, self.place(layout), self._collect_values(layout, request_values or {}))
        finally:
            self._instant = None

    def frame_of_another(self, layout: Layout, request_values: Mapping[str, int | str | bool]) -> int:
        """Return the frame that a second encoder of this kind sends, whose shaft is half of all positions away."""
        distance = self._count_positions(layout) // 2
        self._offset += distance
        try:
            return self.frame(layout, request_values)
        finally:
            self._offset -= distance

    def place(self, layout: Layout) -> PlacedLayout:
        """Return a layout for this encoder with its current registers. A write to these can replace ``variant``."""
        if self._placed_for is not self.variant:
            self._placed_for = self.variant
            self._placed_layouts = {}
        if layout.name not in self._placed_layouts:
            self._placed_layouts[layout.name] = layout.place(self.variant.parameters)
        return self._placed_layouts[layout.name]

    def layouts(self, sender: str) -> tuple[Layout, ...]:
        """Return the frames that the encoder or the master sends on this interface."""
        layouts = self.device.interface(self.variant.interface).layouts
        return tuple(layout for layout in layouts if layout.sender == sender)

    def needs_answer(self, layout: Layout) -> bool:
        """Return whether a question about this layout is open."""
        return any(alternative.name not in self.answers for alternative in self.device.alternatives_of(layout))

    def is_active(self, field: Field) -> bool:
        """Return whether a flag is active.

        It is if it is set, if a flag that it sums up is set, or if it reports that the encoder is busy. The flag with
        the name of the BiSS error flag is also active while an alarm in a register is.
        """
        assert isinstance(field.kind, Flag)
        if field.name in self.flags or any(name in self.flags for name in field.kind.sums_up):
            return True
        if self.is_busy() and self._not_ready_flags & {field.name, *field.kind.sums_up}:
            return True
        # The first BiSS flag is the error flag. It reports alarms whose own flags are only in registers.
        error_flag = next(iter(Biss.flags))
        has_error_in_register = not self.flags.isdisjoint(self._alarms_in_registers)
        return field.name == error_flag and has_error_in_register

    def _read_clock(self) -> float:
        """Return the time. The time does not advance while a frame is built, so that its fields are consistent."""
        return self.clock() if self._instant is None else self._instant

    def _collect_values(
        self, layout: Layout, request_values: Mapping[str, int | str | bool]
    ) -> dict[str, int | str | bool]:
        """Return the value of each field that carries data, from the first source that has a value.

        The sources are the request, the position, the active flags, and the documented value.
        """
        position_bits = self.parts_now(layout) | self._compared_parts(layout)
        values: dict[str, int | str | bool] = {}
        for placed_field in self.place(layout).fields:
            name = placed_field.name
            field = placed_field.field
            if not field.carries_data:
                continue
            documented_value = field.documented(self.variant.parameters)
            if name in request_values:
                values[name] = request_values[name]
            elif name in position_bits:
                values[name] = _number_from_bits(placed_field, position_bits[name] & placed_field.mask)
            elif isinstance(field.kind, Flag):
                values[name] = self.is_active(field)
            elif documented_value is not None:
                values[name] = documented_value
            else:
                values[name] = field.kind.value_at_rest
        return values

    def _compared_parts(self, layout: Layout) -> dict[str, int]:
        """Return the bits of the field that a master compares with the position in another data channel, by its name.

        The map is empty for a layout without such a field, and for the layout with the position itself.
        """
        frame = channel_frame(self.device.interface(self.variant.interface))
        position_layout = self._position_layout
        if frame is None or position_layout is None or layout is position_layout:
            return {}
        name_by_layout = {compared.layout.name: compared.name for compared in frame.compared}
        are_both_compared = {layout.name, position_layout.name} <= name_by_layout.keys()
        if not are_both_compared:
            return {}
        name, position_name = name_by_layout[layout.name], name_by_layout[position_layout.name]
        width = self.place(layout).field(name).width
        position_width = self.place(position_layout).field(position_name).width
        position_bits = self.parts_now(position_layout)[position_name]
        # The highest bits of both fields agree. A wider field has additional zeros after them.
        if position_width >= width:
            return {name: position_bits >> (position_width - width)}
        return {name: position_bits << (width - position_width)}

    @property
    def _position_layout(self) -> Layout | None:
        """The first frame with a position."""
        for layout in self.layouts("encoder"):
            if self._carries_position(layout):
                return layout
        return None

    @property
    def _position_name(self) -> str:
        return self.device.position_name(self.variant.interface)

    def _carries_position(self, layout: Layout) -> bool:
        """Return whether a layout contains the position, as a join of several fields or as one field."""
        name = self._position_name
        is_joined = layout.names_in(name) != (name,)
        return is_joined or self.place(layout).find_field(name) is not None

    def _position_fields(self, layout: Layout | None) -> tuple[PlacedField, ...]:
        """Return the fields that form the position in frames with a layout, most significant first."""
        if layout is None:
            return ()
        return tuple(self.place(layout).find_fields(layout.names_in(self._position_name)))

    @cached_property
    def _not_ready_flags(self) -> set[str]:
        """Flags of alarms that do not latch. They are active while the encoder is not ready."""
        non_latching_alarms = [alarm.name for alarm in self.device.alarms if alarm.latch is False]
        return {name for name in non_latching_alarms if name in self._flag_names}

    @cached_property
    def _flag_names(self) -> frozenset[str]:
        """Names of the flags in the frames and registers of the encoder."""
        frame_layouts = self.layouts("encoder")
        register_layouts = [register.layout for register in self.device.registers_over(self.variant.interface)]
        names: set[str] = set()
        for layout in (*frame_layouts, *register_layouts):
            flags = [field for field in layout.fields if isinstance(field.kind, Flag)]
            names.update(flag.name for flag in flags if self._may_send(flag))
        return frozenset(names)

    def _may_send(self, field: Field) -> bool:
        """Return whether the encoder sends a field now, or with other values in its registers."""
        run_time_names = {parameter.name for parameter in self.device.run_time_parameters}
        needed_names = self.device.needed_parameters(field.width.parameters)
        return field.width.value(self.variant.parameters) > 0 or not run_time_names.isdisjoint(needed_names)

    def _check_answers(self, variant: Variant) -> None:
        """Check that each answer belongs to a question, and that each question about a position has an answer.

        Raises:
            ValueError: An answer is unknown or missing.
        """
        options: list[str] = []
        for alternative in self.device.alternatives:
            options += [f"{alternative.name}={answer.name}" for answer in alternative.answers]
        for name, answer_name in self.answers.items():
            chosen_option = f"{name}={answer_name}"
            if chosen_option not in options:
                options_text = " or ".join(options) or "none"
                raise ValueError(f"'{chosen_option}' answers no question of {variant.code}; write {options_text}")
        for layout in self.device.interface(variant.interface).layouts:
            if self.device.sends_position(variant.interface, layout):
                self._check_choices(layout)

    def _check_choices(self, layout: Layout) -> None:
        """Raise a ValueError if a question about a layout has no answer."""
        for alternative in self.device.alternatives_of(layout):
            if alternative.name not in self.answers:
                options = " or ".join(f"{alternative.name}={answer.name}" for answer in alternative.answers)
                raise ValueError(f"{alternative.meaning}: choose {options}")


def _number_from_bits(placed_field: PlacedField, bits: int) -> int:
    """Return the number that the bits of a field represent: -1 for 0b111 in a signed field of 3 bits."""
    sign_bit = bits >> (placed_field.width - 1)
    if placed_field.field.number.signed and sign_bit:
        return bits - (1 << placed_field.width)
    return bits
