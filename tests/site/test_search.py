"""What stands first when one types an order code, an address or a name into the search, opened as files in Chromium."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import quote

import pytest
from chromium import Browser

#: What is typed, what stands first, and what its link ends in. Codes, addresses and names are those of the manuals.
QUERIES = """
AMM5A21/65KSC1          | AMM5A21/65KSC1            | amm5/AMM5A21-65KSC1.html
amm5a21/65ksc1          | AMM5A21/65KSC1            | amm5/AMM5A21-65KSC1.html
AMM5A21-65KSC1          | AMM5A21/65KSC1            | amm5/AMM5A21-65KSC1.html
AMM5B23/65KJP1          | AMM5B23/65KJP1            | amm5/AMM5A23-65KJP1.html
AMM5A17/1BG             | AMM5A17/1BG1              | amm5/AMM5A17-1BG1.html
SMA21-SC4-0050          | SMA21-SC4-0050            | sma21/SMA21-SC1-0050.html
sma21-jp1-0001          | SMA21-JP1-0001            | sma21/SMA21-JP1-0001.html
AMC3619/4096-I7         | AMC3619/4096-I7           | am36/AM3619-4096-I7.html
ASC8525/SC2             | ASC8525/SC2               | asc85/ASC8525-SC1.html
asc8520                 | ASC8520/BG1               | asc85/ASC8520-BG1.html
11h                     | AMM5.11h                  | #register-preset
0x11                    | AMM5.0x11                 | #register-preset
13H                     | AMM5.13h                  | #register-preset
77h                     | AMM5.77h                  | #register-command
0x5a                    | ASC85.0x5A                | #register-diagnostic_data
59h                     | SMA21.59h                 | #register-position_check
0x56                    | AM36.0x56                 | #register-singleturn_bits_used
preset                  | AM36.Preset               | #register-preset
AMM5 preset             | AMM5.Preset               | #register-preset
preset_setting_enable   | AMM5.preset_setting_enable| #register-preset_setting_enable
serial number           | AM36.Serial number        | #register-serial_number
ALMC                    | AMM5.ALMC                 | #group-alarm_field
MEM BUSY                | AMM5.MEM BUSY             | #group-address_of_request
Battery alarm           | AMM5.Battery alarm        | #alarm-battery_alarm
mt error                | AMM5.MT error             | #alarm-mt_error
busy flag               | AMM5.BUSY flag            | #alarm-busy
Overspeed               | SMA21.Overspeed           | #alarm-overspeed
Low amplitude error     | SMA21.Low amplitude error | #alarm-low_amplitude_error
EE_1                    | AMM5.EE_1                 | #group-status_field
biss_6                  | AM36.biss_6               | #crc-biss_6
mutants                 | Mutants                   | docs/mutants.html
"""
ROWS = [tuple(cell.strip() for cell in line.split("|")) for line in QUERIES.strip().splitlines()]
#: Waits for the first hit.
FIRST = """new Promise(done => {
  const look = () => {
    const hit = document.querySelector("#search-results li a");
    if (hit) done([hit.textContent, hit.getAttribute("href")]); else setTimeout(look, 10);
  };
  look();
})"""


def test_there_are_thirty() -> None:
    assert len(ROWS) >= 30


@pytest.mark.slow
@pytest.mark.parametrize(("typed", "shown", "ends"), ROWS, ids=lambda cell: cell)
def test_first_hit(site: Path, browser: Browser, typed: str, shown: str, ends: str) -> None:
    browser.open(f"{(site / 'search.html').as_uri()}?q={quote(typed)}")
    name, target = browser.run(FIRST)
    assert name == shown
    assert ends in target
    page, _, anchor = target.partition("#")
    assert not anchor or f'id="{anchor}"' in (site / page).read_text(encoding="utf-8")
    assert browser.complaints == []


@pytest.mark.slow
def test_by_the_keyboard_alone(site: Path, browser: Browser) -> None:
    """A stroke of / and the box has the keyboard, on whatever page; Enter searches."""
    browser.look(375)
    browser.open((site / "generated/docs/amm5/AMM5A21-65KSC1.html").as_uri())
    for key in ("/", *"ALMC"):
        browser.call("Input.dispatchKeyEvent", type="keyDown", text=key, key=key)
        browser.call("Input.dispatchKeyEvent", type="keyUp", key=key)
    assert browser.run("document.activeElement.name + ': ' + document.activeElement.value") == "q: ALMC"
    browser.call("Input.dispatchKeyEvent", type="keyDown", text="\r", key="Enter", windowsVirtualKeyCode=13)
    browser.wait()
    assert browser.run(FIRST)[0] == "AMM5.ALMC"
