"""Simulated encoder: its position, flags, supply and registers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from pathlib import Path
from time import monotonic

from ..model import Biss, Field, Flag, Layout, Measurement, PlacedField, PlacedLayout, Variant, channel_frame
from ..order_codes.parameters import with_answers
from ..reference import codec
from .memory import Memory
from .simulation_options import Faults, Position, find_order_code

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
        specs: Paths of specs to use. By default, those shipped with codewheel.

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
        specs: Iterable[str | Path] = (),
    ) -> None:
        self.device, label_match = find_order_code(order_code, tuple(map(Path, specs)), edition)
        self.answers = dict(choose or {})
        self._check_answers(label_match.variant)
        self.variant = with_answers(self.device, label_match.variant, self.answers)
        #: Layouts as placed for a variant, by name.
        self._variant_of_placed_layouts = self.variant
        self._placed_layouts: dict[str, PlacedLayout] = {}
        self.position = position
        self.faults = Faults(self.variant.interface, faults, seed)
        self.flags: set[str] = set()
        self._offset = 0
        self._off_until = self._busy_until = 0.0
        self._frame_time: float | None = None
        started = monotonic()
        self.clock = clock or (lambda: monotonic() - started)
        self.memory = Memory(self, registers or {})

    @property
    def counts(self) -> int:
        """Number of positions in the first frame with a position."""
        return self._count_positions(self._position_layout)

    @property
    def lowest(self) -> int:
        """Lowest position in the first frame with a position. It is negative if the position is signed."""
        return self._find_lowest_position(self._position_layout)

    @property
    def counts_per_turn(self) -> int:
        """Number of positions in one turn, or 0 if the position is not an angle."""
        measurement = self._find_measurement(self._position_layout)
        if measurement is None or measurement.counts_per_turn is None:
            return 0
        return measurement.counts_per_turn.value(self.variant.parameters)

    def _count_positions(self, layout: Layout | None) -> int:
        """Return the number of different positions that frames with this layout can contain.

        If the manual does not give it, every value of the position bits is a position.
        """
        measurement = self._find_measurement(layout)
        if measurement is not None and measurement.total is not None:
            return measurement.total.value(self.variant.parameters)
        position_bits = sum(placed_field.width for placed_field in self._position_fields(layout))
        return 1 << position_bits

    def _find_lowest_position(self, layout: Layout | None) -> int:
        """Return the lowest position in frames with this layout.

        It is 0 unless the position is a single signed field. If the manual does not give the highest position, half of
        the positions are negative.
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
        """Return the unit and range of the position in frames with this layout, or None if the manual gives neither.

        Without a layout, return those of the interface.
        """
        if layout is None:
            return self.device.measurement_of(self.variant.interface)
        return self.device.measurement_in(self.variant.interface, layout)

    def position_names(self) -> frozenset[str]:
        """Return the names of the fields that form the position or a part of it."""
        return self.device.position_names(self.variant.interface)

    def position_now(self) -> int:
        """Return the position that the encoder currently sends, which is 0 while it reports that it is busy."""
        if self._reports_not_ready():
            return 0
        return self._wrap_into(self._position_layout, self.raw_position() + self._offset)

    def _reports_not_ready(self) -> bool:
        """Return whether the encoder is busy and has a flag to report this. It then sends no position."""
        return self.is_busy() and self.reports_busy

    def _wrap_into(self, layout: Layout | None, count: int) -> int:
        """Wrap a count into the range of the position in frames with this layout, and return it."""
        lowest = self._find_lowest_position(layout)
        return lowest + (count - lowest) % self._count_positions(layout)

    def parts_now(self, layout: Layout | None = None) -> dict[str, int]:
        """Return the bits of each field of the current position: ``{"multiturn": 3, "singleturn": 1024}``.

        The fields are those of ``layout`` or, if it does not contain the position, those of the first frame that does.
        All bits are 0 while the encoder reports that it is busy.
        """
        if layout is None or not self._carries_position(layout):
            layout = self._position_layout
        remaining_bits = 0
        if not self._reports_not_ready():
            remaining_bits = self._wrap_into(layout, self.raw_position() + self._offset)
        bits_by_field: dict[str, int] = {}
        least_significant_first = reversed(self._position_fields(layout))
        for placed_field in least_significant_first:
            bits_by_field[placed_field.name] = remaining_bits & placed_field.mask
            remaining_bits >>= placed_field.width
        return bits_by_field

    def raw_position(self) -> int:
        """Return the current position of the shaft, without the effect of presets and resets."""
        if callable(self.position):
            return int(self.position(self._frame_time_or_now()))
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
        """Execute a reset procedure: clear the alarms that it clears, and set parts of the position to 0.

        These parts are the fields whose names are in the name of the procedure: ``reset_multiturn`` sets the field
        ``multiturn`` to 0.
        """
        self.flags -= {alarm.flag_name for alarm in self.device.alarms if procedure in alarm.cleared_by}
        fields = self._position_fields(self._position_layout)
        resets_position = any(placed_field.name in procedure for placed_field in fields)
        if not resets_position:
            # The position is not set below, because other frames may contain more of its bits.
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
        """Switch the supply off and on again. Register values that were not saved are lost."""
        self._off_until = self.clock() + OFF_S
        self.memory.restart()
        self.be_busy(OFF_S + READY_S)

    def be_busy(self, seconds: float) -> None:
        """Make the encoder busy for at least this time."""
        self._busy_until = max(self._busy_until, self.clock() + seconds)

    def is_off(self) -> bool:
        """Return whether the encoder is powered off."""
        return self.clock() < self._off_until

    def is_busy(self) -> bool:
        """Return whether the encoder is busy, after power-on or during a reset."""
        return self._frame_time_or_now() < self._busy_until

    @property
    def reports_busy(self) -> bool:
        """True if the encoder has a flag that shows that it is busy."""
        return bool(self._not_ready_flags)

    @cached_property
    def _alarms_in_registers(self) -> frozenset[str]:
        """Names of the flags of alarms that a register reports."""
        return frozenset(alarm.flag_name for alarm in self.device.alarms if alarm.register)

    def frame(self, layout: Layout, request_values: Mapping[str, int | str | bool] | None = None) -> int:
        """Return a frame with the current values as one number.

        ``request_values`` are the values of fields that depend on the request of the master, by name.
        """
        self._frame_time = self.clock()  # All fields of the frame use this time.
        try:
            values = self._collect_values(layout, request_values or {})
            return codec.encode(self.device, self.place(layout), values)
        finally:
            self._frame_time = None

    def frame_of_another(self, layout: Layout, request_values: Mapping[str, int | str | bool]) -> int:
        """Return the frame of a second encoder of this kind, whose position differs by half of all positions."""
        distance = self._count_positions(layout) // 2
        self._offset += distance
        try:
            return self.frame(layout, request_values)
        finally:
            self._offset -= distance

    def place(self, layout: Layout) -> PlacedLayout:
        """Return the positions and widths of the fields of a layout, for the current parameters of the encoder."""
        # A write to a register can change parameters, and then replaces ``variant``.
        if self._variant_of_placed_layouts is not self.variant:
            self._variant_of_placed_layouts = self.variant
            self._placed_layouts = {}
        if layout.name not in self._placed_layouts:
            self._placed_layouts[layout.name] = layout.place(self.variant.parameters)
        return self._placed_layouts[layout.name]

    def layouts(self, sender: str) -> tuple[Layout, ...]:
        """Return the layouts of the frames that ``sender`` sends over the interface: ``encoder`` or ``master``."""
        layouts = self.device.interface(self.variant.interface).layouts
        return tuple(layout for layout in layouts if layout.sender == sender)

    def needs_answer(self, layout: Layout) -> bool:
        """Return whether the manual leaves a question about this layout open to which the user gave no answer."""
        return any(alternative.name not in self.answers for alternative in self.device.alternatives_of(layout))

    def is_active(self, field: Field) -> bool:
        """Return whether a flag is active now.

        It is active if it or a flag that it combines (``sums_up``) is set, or reports that the encoder is busy. The
        error flag of BiSS is also active while an alarm that a register reports is set.
        """
        assert isinstance(field.kind, Flag)
        own_and_combined_names = {field.name, *field.kind.sums_up}
        if own_and_combined_names & self.flags:
            return True
        if self.is_busy() and own_and_combined_names & self._not_ready_flags:
            return True
        # The first BiSS flag is the error flag.
        error_flag = next(iter(Biss.flags))
        has_error_in_register = not self.flags.isdisjoint(self._alarms_in_registers)
        return field.name == error_flag and has_error_in_register

    def _frame_time_or_now(self) -> float:
        """Return the time. The time does not advance while a frame is built, so that its fields are consistent."""
        return self.clock() if self._frame_time is None else self._frame_time

    def _collect_values(
        self, layout: Layout, request_values: Mapping[str, int | str | bool]
    ) -> dict[str, int | str | bool]:
        """Return the current value of each field of a frame that carries data, by its name.

        A value comes from the first of these sources that has it: the request, the position, the active flags, and the
        manual. A field without any of them has a valid value, such as 0.
        """
        position_bits = self.parts_now(layout) | self._bits_of_compared_field(layout)
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
                bits_that_fit = position_bits[name] & placed_field.mask
                values[name] = _number_from_bits(placed_field, bits_that_fit)
            elif isinstance(field.kind, Flag):
                values[name] = self.is_active(field)
            elif documented_value is not None:
                values[name] = documented_value
            else:
                values[name] = field.kind.value_at_rest
        return values

    def _bits_of_compared_field(self, layout: Layout) -> dict[str, int]:
        """Return the bits of the field in ``layout`` that a master compares with the position in another data channel.

        The key is the name of the field. The map is empty for a layout without such a field, and for the layout with
        the position itself.
        """
        frame_of_channels = channel_frame(self.device.interface(self.variant.interface))
        position_layout = self._position_layout
        if frame_of_channels is None or position_layout is None or layout is position_layout:
            return {}
        name_by_layout = {
            compared_field.layout.name: compared_field.name for compared_field in frame_of_channels.compared
        }
        are_both_compared = {layout.name, position_layout.name} <= name_by_layout.keys()
        if not are_both_compared:
            return {}
        field_name = name_by_layout[layout.name]
        position_field_name = name_by_layout[position_layout.name]
        width = self.place(layout).field(field_name).width
        position_width = self.place(position_layout).field(position_field_name).width
        position_bits = self.parts_now(position_layout)[position_field_name]
        # The highest bits of both fields are equal. In the wider field, the position is followed by zeros.
        if width > position_width:
            return {field_name: position_bits << (width - position_width)}
        return {field_name: position_bits >> (position_width - width)}

    @property
    def _position_layout(self) -> Layout | None:
        """The first layout that contains the position, or None if no frame does."""
        for layout in self.layouts(sender="encoder"):
            if self._carries_position(layout):
                return layout
        return None

    @property
    def _position_name(self) -> str:
        """Name of the field or joined number that is the position."""
        return self.device.position_name(self.variant.interface)

    def _carries_position(self, layout: Layout) -> bool:
        """Return whether a layout contains the position, either as one field or as several that form one number."""
        name = self._position_name
        consists_of_several_fields = layout.field_names_of(name) != (name,)
        return consists_of_several_fields or self.place(layout).find_field(name) is not None

    def _position_fields(self, layout: Layout | None) -> tuple[PlacedField, ...]:
        """Return the fields that form the position in frames with a layout, most significant first.

        The tuple is empty without a layout.
        """
        if layout is None:
            return ()
        field_names = layout.field_names_of(self._position_name)
        return tuple(self.place(layout).find_fields(field_names))

    @cached_property
    def _not_ready_flags(self) -> set[str]:
        """Names of the flags of alarms that the manual describes as not latching. They are active while it is busy."""
        non_latching_alarms = {alarm.flag_name for alarm in self.device.alarms if alarm.latch is False}
        return non_latching_alarms & self._flag_names

    @cached_property
    def _flag_names(self) -> frozenset[str]:
        """Names of the flags in the frames and registers of the encoder."""
        frame_layouts = self.layouts(sender="encoder")
        register_layouts = [register.layout for register in self.device.registers_over(self.variant.interface)]
        names: set[str] = set()
        for layout in (*frame_layouts, *register_layouts):
            flags = [field for field in layout.fields if isinstance(field.kind, Flag)]
            names.update(flag.name for flag in flags if self._may_send(flag))
        return frozenset(names)

    def _may_send(self, field: Field) -> bool:
        """Return whether the encoder sends a field now, or could send it with different values in its registers."""
        is_sent_now = field.width.value(self.variant.parameters) > 0
        run_time_names = {parameter.name for parameter in self.device.run_time_parameters}
        needed_names = self.device.needed_parameters(field.width.parameters)
        depends_on_registers = not run_time_names.isdisjoint(needed_names)
        return is_sent_now or depends_on_registers

    def _check_answers(self, variant: Variant) -> None:
        """Check that each answer belongs to a question, and that questions about frames with a position have answers.

        Raises:
            ValueError: An answer is unknown or missing.
        """
        possible_options: list[str] = []
        for alternative in self.device.alternatives:
            possible_options += [f"{alternative.name}={answer.name}" for answer in alternative.answers]
        for question_name, answer_name in self.answers.items():
            chosen_option = f"{question_name}={answer_name}"
            if chosen_option not in possible_options:
                options_text = " or ".join(possible_options) or "none"
                raise ValueError(f"'{chosen_option}' answers no question of {variant.code}; write {options_text}")
        for layout in self.device.interface(variant.interface).layouts:
            if self.device.sends_position(variant.interface, layout):
                self._check_choices(layout)

    def _check_choices(self, layout: Layout) -> None:
        """Raise a ``ValueError`` if the user has not answered a question that the manual leaves open about a layout."""
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
