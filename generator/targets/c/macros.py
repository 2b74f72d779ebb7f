"""Constants of a header: macros with their comments."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Layout, Timing
from ...model.record import dataclass
from ...say.interface import timing as said_of
from .style import S
from .types import number


@dataclass(frozen=True, slots=True)
class Macro:
    name: str
    value: str
    note: str = ""


def timing_macros(timing: Timing, stem: str) -> Iterator[Macro]:
    """Yield the bounds of a time in microseconds. The comment on the first one describes all of them."""
    note = S.sentence(said_of(timing))
    bounds = {"AT_LEAST": timing.at_least_us, "TYPICAL": timing.typical_us, "AT_MOST": timing.at_most_us}
    for bound, value in bounds.items():
        if value is not None:
            yield Macro(f"{stem}_{timing.name}_{bound}_US".upper(), number(value), note)
            note = f"see {timing.name} above"


def scale_macros(layout: Layout, stem: str) -> Iterator[Macro]:
    """Yield the numbers of each scale. They have 64 bits, so that no product overflows."""
    for field in layout.fields:
        scale, name = field.scale, f"{stem}_{field.name}".upper()
        if scale is not None:
            note = f"{field.name} in {scale.unit}: ({field.name} * NUMERATOR + OFFSET) / DENOMINATOR"
            yield Macro(f"{name}_NUMERATOR", f"INT64_C({scale.numerator})", note)
            offset = f"INT64_C({abs(scale.offset)})"
            yield Macro(f"{name}_OFFSET", f"(-{offset})" if scale.offset < 0 else offset)
            yield Macro(f"{name}_DENOMINATOR", f"INT64_C({scale.denominator})")
