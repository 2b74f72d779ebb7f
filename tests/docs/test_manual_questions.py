"""Open questions and contradictions of the manuals are shown where a reader of the pages needs them."""

from __future__ import annotations

from collections.abc import Mapping

import pytest
from codewheel.model import Device


@pytest.mark.parametrize(
    ("family", "erratum", "is_open", "printed", "affected"),
    [
        # 4.1.3 and 4.1.4 have A and B without a sign; SMA21 4.2 has A (REQ+ / SD+).
        ("amm5", "rs485_polarity", True, "without + or -", "connectors.rs485_connector"),
        # Neither 7.2 has a time between request and reply.
        ("amm5", "rs485_reply_time", True, "not the time between", "interfaces.rs485.data_ids"),
        ("sma21", "rs485_reply_time", True, "not the time between", "interfaces.rs485.data_ids"),
        # 5.3: at least 20 µs and Tp > 20 µs, or 16 µs in SMA21.
        ("amm5", "ssi_pause", True, "Tp > 20 µs", "interfaces.ssi.pause"),
        ("sma21", "ssi_pause", True, "Tp > 16 µs", "interfaces.ssi.pause"),
        # The English and the Italian AMM5 1.9.
        ("amm5", "busy_detection", True, "quando l'alimentazione è on", "alarms.busy"),
        ("amm5", "cable_drain_wire", True, "drain wire", "characteristics.cable_shield"),
        ("amm5", "preset_at_standstill", False, "attivare", "procedures.store_preset"),
        ("amm5", "preset_save_and_activate", False, "contemporaneamente", "procedures.set_preset"),
    ],
)
def test_a_question_is_an_erratum(
    devices: Mapping[str, Device], family: str, erratum: str, is_open: bool, printed: str, affected: str
) -> None:
    (listed_erratum,) = [candidate for candidate in devices[family].errata if candidate.name == erratum]
    assert (listed_erratum.status == "open") == is_open
    assert printed in listed_erratum.printed
    assert affected in listed_erratum.affects


def test_revolutions_while_off(pages: Mapping[str, str]) -> None:
    """AM36, 6.5, 4Eh: 2,047 revolutions. This applies by default, since the default is 65,536, and after a restore."""
    limit = "2,047 revolutions"
    assert limit in pages["docs/am36/hardware.md"]
    # The first lines of the pages of the interface and of an order code.
    assert limit in pages["docs/am36/biss.md"].split("## ")[0]
    assert limit in pages["docs/am36/AM3616-4096-I7.md"].split("## ")[0]
    assert limit not in pages["docs/am36/AM3616-4096-BG.md"].split("## ")[0]
    procedures_page = pages["docs/am36/biss-procedures.md"]
    restore = procedures_page.split('<a id="procedure-restore_defaults"></a>')[1].split("<a id=")[0]
    assert limit in " ".join(restore.split())
