"""First hits of labels, addresses, names and words that people type into the search, opened as files in Chromium."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import quote

import pytest
from chromium import Browser

#: Typed label, the code of the first hit, and the end of its link.
LABELS = """
AMM5A21/65KSC1              | AMM5A21/65KSC1  | amm5/AMM5A21-65KSC1.html
amm5a21/65ksc1              | AMM5A21/65KSC1  | amm5/AMM5A21-65KSC1.html
AMM5A21-65KSC1              | AMM5A21/65KSC1  | amm5/AMM5A21-65KSC1.html
AMM5A21 / 65KSC1            | AMM5A21/65KSC1  | amm5/AMM5A21-65KSC1.html
AMM5A21/65KSC1-K            | AMM5A21/65KSC1  | amm5/AMM5A21-65KSC1.html
AMM5A21/65KSC1/S123         | AMM5A21/65KSC1  | amm5/AMM5A21-65KSC1.html
AMM5A21/65KSC1-K/S123       | AMM5A21/65KSC1  | amm5/AMM5A21-65KSC1.html
AMM5B23/65KJP1              | AMM5B23/65KJP1  | amm5/AMM5A23-65KJP1.html
AM3616/4096SC1              | AM3616/4096-I7  | am36/AM3616-4096-I7.html
AMC3619/4096BG2             | AMC3619/4096-BG | am36/AM3619-4096-BG.html
AMC3619/4096-I7             | AMC3619/4096-I7 | am36/AM3619-4096-I7.html
AM3617/4096-I7              | AM3617/4096-I7  | am36/AM3616-4096-I7.html
SMA21-SC4-0050              | SMA21-SC4-0050  | sma21/SMA21-SC1-0050.html
sma21-jp1-0001              | SMA21-JP1-0001  | sma21/SMA21-JP1-0001.html
ASC8525/SC2                 | ASC8525/SC2     | asc85/ASC8525-SC1.html
ASC8525/SC2-X               | ASC8525/SC2     | asc85/ASC8525-SC1.html
AMM5A17/1BG                 | AMM5A17/1BG1    | amm5/AMM5A17-1BG1.html
asc8520                     | ASC8520/BG1     | asc85/ASC8520-BG1.html
AMM5A19                     | AMM5A17/1BG1    | amm5/AMM5A17-1BG1.html
AMM5A19/65KSC1              | AMM5A17/65KSC1  | amm5/AMM5A17-65KSC1.html
SMA21-JP1-0051              | SMA21-JP1-0050  | sma21/SMA21-JP1-0050.html
"""
#: Typed address or name, the first hit, and the end of its link.
NAMES = """
11h                         | 11h                   | amm5/biss-registers.html#register-preset
0x11                        | 0x11                  | #register-preset
13H                         | 13h                   | #register-preset
77h                         | 77h                   | #register-command
0x5a                        | 0x5A                  | asc85/biss-registers.html#register-diagnostic_data
59h                         | 59h                   | sma21/biss-registers.html#register-position_check
0x56                        | 0x56                  | am36/biss-registers.html#register-singleturn_bits_used
preset                      | Preset                | am36/biss-registers.html#register-preset
AMM5 preset                 | Preset                | amm5/biss-registers.html#register-preset
preset_setting_enable       | preset_setting_enable | #register-preset_setting_enable
serial number               | Serial number         | am36/biss-registers.html#register-serial_number
ALMC                        | ALMC                  | #group-alarm_field
MEM BUSY                    | MEM BUSY              | #group-address_of_request
Battery alarm               | Battery alarm         | #alarm-battery_alarm
mt error                    | MT error              | #alarm-mt_error
busy flag                   | BUSY flag             | #alarm-busy
Overspeed                   | Overspeed             | #alarm-overspeed
Low amplitude error         | Low amplitude error   | #alarm-low_amplitude_error
EE_1                        | EE_1                  | #group-status_field
biss_6                      | biss_6                | #crc-biss_6
amm5                        | AMM5A and AMM5B absolute kit encoders | docs/amm5.html
"""
#: Typed words, the first hit, and the end of its link. A code among them is the encoder that they are about.
WORDS = """
pinout                          | Wiring              | am36/biss-wiring.html#wiring
wiring                          | Wiring              | am36/biss-wiring.html#wiring
wire colours                    | Wiring              | am36/biss-wiring.html#wiring
supply voltage                  | Wiring              | am36/biss-wiring.html#wiring
AMM5A21/65KSC1 pinout           | Wiring              | amm5/AMM5A21-65KSC1.html#wiring
pinout AMM5A21/65KSC1-K         | Wiring              | amm5/AMM5A21-65KSC1.html#wiring
SMA21-JP1-0050 wiring           | Wiring              | sma21/SMA21-JP1-0050.html#wiring
AMM5A21/65KSC1 cable length     | Clock and cable     | amm5/AMM5A21-65KSC1.html#clock-and-cable
ASC8525/BG1 cable length        | Clock and cable     | asc85/ASC8525-BG1.html#clock-and-cable
AMM5A21/65KSC1 clock            | Clock and cable     | amm5/AMM5A21-65KSC1.html#clock-and-cable
AM3616/4096-I7 frame time       | Clock and cable     | am36/AM3616-4096-I7.html#clock-and-cable
AMM5A23/65KJP1 baud             | Baud rate and times | amm5/AMM5A23-65KJP1.html#baud-rate-and-times
baud rate                       | Clocks, ports and codes | #clocks-ports-and-codes
timeout                         | Times               | am36/biss.html#times
time-out                        | Times               | am36/biss.html#times
monoflop                        | Times               | am36/biss.html#times
zero                            | Input: Zero setting/Preset | am36/biss-procedures.html#input-zero-settingpreset
home                            | Input: Zero setting/Preset | am36/biss-procedures.html#input-zero-settingpreset
offset                          | 50h to 53h Preset / Offset | sma21/biss-registers.html#50h-to-53h-preset--offset
biss timeout                    | AM36: BiSS C-mode   | am36/biss.html
AM3616/4096-I7 timeout          | Times and numbers   | am36/AM3616-4096-I7.html#timings
how to zero my encoder          | 50h to 54h Preset   | am36/biss-registers.html#50h-to-54h-preset
which bit is the error bit biss | The error bit is always set | docs/encoder/questions-error-bit.html
AMM5A21/65KSC1 new edition      | Errata              | amm5/AMM5A21-65KSC1.html#errata
AMM5A23/65KSC1 beckhoff         | Beckhoff AX5000     | settings.html#code=AMM5A23%2F65KSC1&master=beckhoff_ax5000
AMM5A23/65KBG1 siemens          | Siemens TM PosInput | settings.html#code=AMM5A23%2F65KBG1&master=siemens_posinput
AMM5A21/65KSC1 c2000            | TI C2000 PM_bissc   | settings.html#code=AMM5A21%2F65KSC1&master=ti_c2000
AMM5A21/65KSC1 set zero         | What to send        | amm5/AMM5A21-65KSC1.html#what-to-send
AMM5A23/65KJP1 set zero         | What to send        | amm5/AMM5A23-65KJP1.html#what-to-send
ASC8525/BG1 set zero            | What to send        | asc85/ASC8525-BG1.html#what-to-send
AM3616/4096-I7 preset bytes     | What to send        | am36/AM3616-4096-I7.html#what-to-send
AMM5A23/65KJP1 request byte     | What to send        | amm5/AMM5A23-65KJP1.html#what-to-send
AMM5A21/65KSC1 save             | What to send        | amm5/AMM5A21-65KSC1.html#what-to-send
AMM5A23/65KJP1 save             | What to send        | amm5/AMM5A23-65KJP1.html#what-to-send
reset                           | reset errors        | amm5/rs485-procedures.html#procedure-reset_errors
checksum                        | CRC biss_6          | am36/biss.html#crc-biss_6
polynomial                      | CRC biss_6          | am36/biss.html#crc-biss_6
x^6                             | CRC biss_6          | am36/biss.html#crc-biss_6
AMM5A21/65KSC1 polynomial       | Frame               | amm5/AMM5A21-65KSC1.html#frame
AMM5A21/65KSC1 error bit        | Frame               | amm5/AMM5A21-65KSC1.html#frame
SMA21-JP1-0050 error bit        | Frame               | sma21/SMA21-JP1-0050.html#frame
blink                           | LEDs                | amm5/biss-wiring.html#leds
blinking LED                    | LEDs                | amm5/biss-wiring.html#leds
AMM5A21/65KSC1 blinking LED     | LEDs                | amm5/AMM5A21-65KSC1.html#leds
ASC8525/BG1 blinking LED        | LEDs                | asc85/ASC8525-BG1.html#leds
battery                         | Battery alarm       | amm5/rs485-procedures.html#alarm-battery_alarm
replace battery                 | Battery replacement without error | hardware.html#battery-replacement-without-error
counting direction              | counting direction  | am36/biss-procedures.html#input-counting_direction
2500000                         | AMM5: RS-485        | amm5/rs485.html
2,500,000                       | AMM5: RS-485        | amm5/rs485.html
4.3.2                           | LEDs                | amm5/biss-wiring.html#leds
usable                          | Usable or not       | docs/usable-or-not.html
glossary                        | Glossary            | docs/glossary-of-terms.html
which encoder                   | Which encoder is it? | docs/which-encoder.html
mutants                         | Mutants             | docs/trust/mutants.html
"""
#: As a technician types them: whole questions, typos, plurals, numbers, and labels with and without separators.
TYPED = """
AMM5A21/65KSC1 S/N 1234         | AMM5A21/65KSC1      | amm5/AMM5A21-65KSC1.html
Lika AMM5A21/65KSC1 SN1234      | AMM5A21/65KSC1      | amm5/AMM5A21-65KSC1.html
SMA21-JP1-0050 No. 10/2019      | SMA21-JP1-0050      | sma21/SMA21-JP1-0050.html
AMM5A21/65KSC1 1234             | AMM5A21/65KSC1      | amm5/AMM5A21-65KSC1.html
AMM5A21/65KSC1 serial number    | 44h to 47h Serial number | amm5/AMM5A21-65KSC1.html#register-serial_number
C2000                           | TI C2000 PM_bissc   | am36-biss-masters.html#ti-c2000-pm_bissc
AMM5 novanta                    | Novanta (Ingenia) drives | amm5-biss-masters.html#novanta-ingenia-drives
zero position                   | Input: Zero setting/Preset | am36/biss-procedures.html#input-zero-settingpreset
AMM5A21/65KSC1 zero position    | What to send        | amm5/AMM5A21-65KSC1.html#what-to-send
how do I set zero               | Input: Zero setting/Preset | am36/biss-procedures.html#input-zero-settingpreset
m12 pinout | M12 8-pin connector, A-coded, male | am36/biss-wiring.html#m12-8-pin-connector-a-coded-male
led red blinking                | LEDs                | amm5/biss-wiring.html#leds
AMM5A21/65KSC1 max cable length 10 MHz | Clock and cable | amm5/AMM5A21-65KSC1.html#clock-and-cable
AMM5A21/65KSC1 0x43             | Frame               | amm5/AMM5A21-65KSC1.html#frame
crc poly                        | CRC biss_6          | am36/biss.html#crc-biss_6
asc8525bg1                      | ASC8525/BG1         | asc85/ASC8525-BG1.html
smA21jp10050                    | SMA21-JP1-0050      | sma21/SMA21-JP1-0050.html
AMM5B23 65KJP1                  | AMM5B23/65KJP1      | amm5/AMM5A23-65KJP1.html
AM3616/4096-I7/S55              | AM3616/4096-I7      | am36/AM3616-4096-I7.html
SMA21-JP1-0050-M1               | SMA21-JP1-0050      | sma21/SMA21-JP1-0050.html
AMM5A21/65KSC1 SSI pinout       | Wiring              | amm5/AMM5A21-65KSC1.html#wiring
conector | M12 8-pin connector, A-coded, male | am36/biss-wiring.html#m12-8-pin-connector-a-coded-male
wirring                         | Wiring              | am36/biss-wiring.html#wiring
presset                         | Preset              | am36/biss-registers.html#register-preset
polinomial                      | CRC biss_6          | am36/biss.html#crc-biss_6
checksums                       | CRC biss_6          | am36/biss.html#crc-biss_6
batteries                       | Battery alarm       | amm5/rs485-procedures.html#battery-alarm
dead battery                    | Battery alarm       | amm5/rs485-procedures.html#battery-alarm
wire colors                     | Wiring              | am36/biss-wiring.html#wiring
clock frequency                 | Clocks, ports and codes | docs/compare-encoders.html#clocks-ports-and-codes
how fast                        | Times               | am36/biss.html#times
startup time                    | Times               | msa213c/biss.html#times
power consumption               | Wiring              | am36/biss-wiring.html#wiring
5v                              | T12 cable           | sma21/rs485-wiring.html#t12-cable
rs485 baud                      | AMM5: RS-485        | amm5/rs485.html
2.5 Mbit                        | Clocks, ports and codes | #clocks-ports-and-codes
gray code                       | Gray code or binary | docs/encoder/questions-gray-or-binary.html
counting direction reverse      | The position counts backwards | docs/encoder/questions-counts-backwards.html
factory reset                   | Load and save the default parameters | #load-and-save-the-default-parameters
crc wrong                       | The BiSS CRC is always wrong | docs/encoder/questions-crc-always-wrong.html
crc fails                       | The BiSS CRC is always wrong | docs/encoder/questions-crc-always-wrong.html
nE bit                          | Deciding bits       | amm5-verdicts.html#deciding-bits
AMM5A21/65KSC1 how long is a frame | Frame            | amm5/AMM5A21-65KSC1.html#frame
AMM5A21/65KSC1 which bit says error | Frame           | amm5/AMM5A21-65KSC1.html#frame
tape                            | Tape length, travel and number of positions | -travel-and-number-of-positions
mounting                        | Characteristics, mounting, safety | am36/hardware.html#characteristics-mounting-safety
acknowledge                     | Acknowledge         | spi.html#acknowledge
siemens                         | Siemens TM PosInput | docs/am36-ssi-masters.html#siemens-tm-posinput
arduino                         | Five minutes: an encoder in your firmware | docs/firmware/start-firmware.html
"""


def rows(table: str) -> list[tuple[str, ...]]:
    return [tuple(map(str.strip, line.split("|"))) for line in table.splitlines() if line]


#: The first hit.
FIRST = """(() => {
  const hit = document.querySelector("#search-results li a");
  return hit ? [hit.textContent, hit.getAttribute("href")] : ["", ""];
})()"""
SHOWN = 'document.getElementById("search-results").innerText'


def test_there_are_enough() -> None:
    assert len(rows(LABELS)) >= 20
    assert len(rows(WORDS)) >= 40
    assert len(rows(TYPED)) >= 40


@pytest.mark.slow
@pytest.mark.parametrize(
    ("typed", "expected_name", "ends"), rows(LABELS) + rows(NAMES) + rows(WORDS) + rows(TYPED), ids=lambda cell: cell
)
def test_first_hit(site: Path, browser: Browser, typed: str, expected_name: str, ends: str) -> None:
    browser.open(f"{(site / 'search.html').as_uri()}?q={quote(typed)}")
    name, target = browser.run(FIRST)
    assert (name, target[-len(ends) :]) == (expected_name, ends)
    page, _, anchor = target.partition("#")
    # What follows the page of settings is the input of its form.
    assert not anchor or "=" in anchor or f'id="{anchor}"' in (site / page).read_text(encoding="utf-8")
    assert browser.complaints == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("typed", "words"),
    [
        ("AMM5A19", "'AMM5A19' has singleturn '19'; valid values: 17, 21, 23"),
        ("AMM5A19/65KSC1 pinout", "'AMM5A19/65KSC1' has singleturn '19'; valid values: 17, 21, 23"),
        ("AM3616/4096SC1", "The label is written as in edition 1.1 of the manual"),
        ("AMM5A21/65KSC1/S123", "An encoder whose order code ends in /Sxxx"),
        ("zzzz", "Nothing found"),
        ("presset", "Showing results for preset."),
        ("ASC8525/BG1 biss clock", "ASC8525/BG1 has SSI, not BiSS C-mode."),
        ("pinout", "Type the label as well"),
    ],
)
def test_help_for_a_label(site: Path, browser: Browser, typed: str, words: str) -> None:
    browser.open(f"{(site / 'search.html').as_uri()}?q={quote(typed)}")
    assert words in browser.run(SHOWN)


@pytest.mark.slow
def test_results_are_grouped_around_the_order_code(site: Path, browser: Browser) -> None:
    browser.open(f"{(site / 'search.html').as_uri()}?q={quote('AMM5A21/65KSC1 preset')}")
    groups = browser.run('[...document.querySelectorAll("#search-results h2")].map((item) => item.textContent)')
    family = "AMM5A and AMM5B absolute kit encoders"
    assert groups == ["AMM5A21/65KSC1", "Names and addresses", f"{family}, this interface", family, "Other encoders",
                      "General"]  # fmt: skip
    snippets = browser.run('document.querySelectorAll("#search-results .snippet mark").length')
    assert snippets > 5


@pytest.mark.slow
def test_words_typed_on_a_page_are_about_its_encoder(site: Path, browser: Browser) -> None:
    """Type into the search on the page of an order code, and press Enter."""
    browser.open((site / "generated/docs/sma21/SMA21-JP1-0050.html").as_uri())
    browser.run('document.querySelector("header input[type=search]").value = "pinout"; 0')
    browser.run('document.querySelector("header form").submit()')
    browser.wait()
    assert browser.run(FIRST)[1].endswith("sma21/SMA21-JP1-0050.html#wiring")


@pytest.mark.slow
def test_by_the_keyboard_alone(site: Path, browser: Browser) -> None:
    """The key / puts the cursor into the box on every page, and Enter searches."""
    browser.look(375)
    browser.open((site / "generated/docs/amm5/AMM5A21-65KSC1.html").as_uri())
    for key in ("/", *"ALMC"):
        browser.call("Input.dispatchKeyEvent", type="keyDown", text=key, key=key)
        browser.call("Input.dispatchKeyEvent", type="keyUp", key=key)
    assert browser.run("document.activeElement.name + ': ' + document.activeElement.value") == "q: ALMC"
    browser.call("Input.dispatchKeyEvent", type="keyDown", text="\r", key="Enter", windowsVirtualKeyCode=13)
    browser.wait()
    assert browser.run(FIRST)[0] == "ALMC"
