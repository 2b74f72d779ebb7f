"""Rule for clocks and baud rates that are in kHz, MHz, kbaud or Mbaud by mistake."""

from __future__ import annotations

from ..problems import DocumentReport
from ..second_reading import is_second
from .walk import Spec, mapping

#: No encoder has such a low limit in Hz. The highest limits in kHz, of SPI, are still below.
_LOWEST_MAXIMUM_HZ = 50_000
#: The lowest clock in Hz of an encoder whose highest clock is plausible.
_LOWEST_MINIMUM_HZ = 1_000
#: The lowest standard baud rate. Rates in kbaud and Mbaud that do not look like one are below it.
_LOWEST_BAUD = 300
#: Below this number, a unit of MHz is more likely than kHz.
_LIKELY_MEGA = 50
#: Standard baud rates that are not whole numbers of kbaud.
_STANDARD_BAUDS = (9600, 19_200, 38_400, 57_600, 115_200, 230_400, 460_800, 921_600)


def plausible_rate(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no clock or baud rate is too low for an encoder, unless a note of the interface mentions it."""
    if is_second(report.document.file):  # It repeats printed facts, without the notes that may explain them.
        return
    for kind, interface in mapping(spec, "interfaces").items():
        if "note" in interface:
            continue
        clock, path = mapping(interface, "clock"), ("interfaces", kind, "clock")
        highest_hz = clock.get("max_hz", _LOWEST_MAXIMUM_HZ)
        if highest_hz < _LOWEST_MAXIMUM_HZ:
            _report_rate(highest_hz, "max_hz", "Hz", (*path, "max_hz"), report)
        elif 0 < clock.get("min_hz", 0) < _LOWEST_MINIMUM_HZ:
            _report_rate(clock["min_hz"], "min_hz", "Hz", (*path, "min_hz"), report)
        baud = mapping(interface, "port").get("baud", _LOWEST_BAUD)
        if baud < _LOWEST_BAUD:
            _report_rate(baud, "baud", "baud", ("interfaces", kind, "port", "baud"), report)


def _report_rate(rate: int, key: str, unit: str, path: tuple[str, ...], report: DocumentReport) -> None:
    prefix, factor = ("M", 1_000_000) if rate < _LIKELY_MEGA else ("k", 1000)
    standard_rates = (standard for standard in _STANDARD_BAUDS if unit == "baud" and standard // 1000 == rate)
    likely_rate = next(standard_rates, rate * factor)
    problem = f"'{key}' is {rate} {unit}, which is implausible; if the manual means {rate} {prefix}{unit}"
    remedy = f"write {likely_rate}. If the number is right, say so in a 'note' of the interface"
    report.add("implausible-rate", path, f"{problem}, {remedy}")
