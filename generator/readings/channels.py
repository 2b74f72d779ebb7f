"""Facts about frames that carry several data channels: their order, and the bits that are compared."""

from __future__ import annotations

from collections.abc import Iterator

from ..language.document import Path
from ..model import Biss, channel_frame
from ..say.names_and_evidence import bits
from .reading import CodeAndState, ComparedFact, FactClass, SpecReading


def channel_facts(reading: SpecReading, interface: Biss) -> Iterator[ComparedFact]:
    """Yield facts about a BiSS frame with several data channels: their order, and the bits that decoders compare.

    Channels are identified by their numbers: ``1, 2``.
    """
    frame = channel_frame(interface)
    if frame is None:
        return
    place: Path = ("interfaces", interface.name, "channels")
    yield ComparedFact(
        fact_class=FactClass.POSITION,
        key=("channels", "order"),
        value=", ".join(f"{layout.channel}" for layout in frame.layouts),
        description="order of the data channels in a frame",
        place=(*place, "order"),
    )
    for compared in frame.compared:
        bits_by_case: dict[CodeAndState, str] = {}
        for case, parameters in reading.cases(interface.name).items():
            field = compared.layout.place(parameters).field(compared.name)
            compared_bits = frame.compared_bits.value(parameters)
            # The highest bits of the field are compared.
            lowest_compared = field.high + 1 - compared_bits
            bits_by_case[case] = bits(field.high, lowest_compared)
        channel = compared.layout.channel or 0
        yield ComparedFact(
            fact_class=FactClass.POSITION,
            key=("channels", "compared", channel),
            value=bits_by_case,
            description=f"compared bits of data channel {channel}",
            place=(*place, "compared", compared.layout.name),
        )
