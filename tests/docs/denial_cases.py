"""Specs for which each denial about an encoder is true, and specs that contradict it.

A case is two functions without arguments. Each returns the text that the outputs print: the first for a spec for which
the denial is true, the second for a spec with the one fact that contradicts it. All specs are small changes of the
fictional encoder in docs/example.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from types import MappingProxyType
from typing import Any

from codewheel.commands.new import write_spec
from codewheel.loading.library import load_library
from codewheel.masters.encoder_facts import cable_table
from codewheel.masters.order_code_facts import facts_of_order_code
from codewheel.masters.text import facts_in_words
from codewheel.model import (
    Alarm,
    Biss,
    Characteristic,
    Choice,
    Clock,
    CodePart,
    Contact,
    ControlField,
    DataId,
    Device,
    Erratum,
    Exchange,
    Field,
    Flag,
    Input,
    Interface,
    Layout,
    LayoutRange,
    Led,
    LedState,
    Network,
    Number,
    Overlay,
    Port,
    Register,
    Release,
    Rs485,
    SendStep,
    SpelledValue,
    Spelling,
    TimesRead,
    Timing,
    Unused,
    Value,
    Verdict,
    WriteStep,
)
from codewheel.model.expressions import Expression
from codewheel.say import commands_and_alarms, layout, names_and_evidence, order_code, register
from codewheel.say import commands_and_alarms as hardware_input
from codewheel.say import errata as erratum
from codewheel.say import layout as crc
from codewheel.say import layout as measurement
from codewheel.say import names_and_evidence as origin
from codewheel.say import order_code as interface
from codewheel.say import order_code as timing
from codewheel.say import register as field
from codewheel.say.text import PLAIN_STYLE, Statement
from codewheel.targets import Library
from codewheel.targets.c.files import generate as generate_c
from codewheel.targets.docs import (
    bytes_to_send,
    cross_family_pages,
    family_pages,
    layout_pictures,
    order_code_tables,
    page_pictures,
    timing_pictures,
    verdict_page,
    wiring_tables,
)
from codewheel.targets.docs import verdict_table as frame_facts
from codewheel.targets.docs.links_and_errata import ErrataLinks
from codewheel.targets.docs.verdict_table import verdict_table
from codewheel.targets.registry import load_target

EXAMPLE = Path(__file__).resolve().parents[2] / "docs" / "example"
Printed = Callable[[], str]
#: Cases by name, and the names of those that generate whole outputs.
CASES: dict[str, tuple[Printed, Printed]] = {}
SLOW: set[str] = set()


def case(name: str, true: Printed, false: Printed, is_slow: bool = False) -> None:
    assert name not in CASES, name
    CASES[name] = (true, false)
    if is_slow:
        SLOW.add(name)


# -- the encoder and its changes


@cache
def tv62() -> Device:
    devices, frame_texts = load_library([EXAMPLE])
    assert not frame_texts
    return devices[0]


def interface_of(name: str, device: Device | None = None) -> Interface:
    return (device or tv62()).interface(name)


def biss() -> Biss:
    kind = tv62().find_interface(Biss)
    assert kind is not None
    return kind


def with_interface(changed: Interface, device: Device | None = None, **changes: Any) -> Device:
    """Return the device with an interface instead of the interface with the same name."""
    device = device or tv62()
    interfaces = {present.name: present for present in device.interfaces} | {changed.name: changed}
    return replace(device, interfaces=tuple(interfaces.values()), **changes)


def without_parts(**changes: Any) -> Device:
    """Return the encoder without registers, procedures, texts and errata, with these changes."""
    nothing: dict[str, Any] = dict.fromkeys(
        ("registers", "procedures", "alarms", "inputs", "characteristics", "connectors", "leds"), ()
    )
    return replace(tv62(), **(nothing | changes))


def with_kind(layout: Layout, kind: Any, *names: str) -> Layout:
    """Return the layout with this kind instead of the kind of the fields with these names."""
    fields = {present.name: present for present in layout.fields}
    fields |= {name: replace(fields[name], kind=kind) for name in names}
    return replace(layout, fields=tuple(fields.values()))


def spec_only(device: Device) -> Device:
    """Return the device as if no manual had been read as a whole."""
    return replace(device, evidence=replace(device.evidence, grade="corroborated"))


def printed(statements: Iterable[Statement]) -> str:
    return "\n".join(line for statement in statements for line in PLAIN_STYLE.lines(statement))


def generated_text(target: str, *devices: Device) -> str:
    """Return all files of a target as one text, without pictures."""
    files = load_target(target).files(Library(devices))
    return "\n".join(text for name, text in files.items() if not name.endswith(".svg"))


def generated_text_of(target: str, device: Callable[[], Device]) -> str:
    return generated_text(target, device())


def input_pin(**changes: Any) -> Input:
    pin = Input(name="mode", meaning="Selects the filter", source=())
    return replace(pin, **changes)


def a_timing(meaning: str, only_codes: str = "") -> Timing:
    return Timing(name="delay", meaning=meaning, at_least_us=5, source=(), only=only_codes)


def a_text(name: str, value: str) -> Characteristic:
    return Characteristic(name=name, value=value, source=())


def a_field(kind: Any, **changes: Any) -> Field:
    return replace(Field("flag", kind, Expression(0), Expression(1), 1), **changes)


# -- what to send


def sending_text(kind: str, device: Device) -> str:
    sending_interface = interface_of(kind, device)
    variants = device.variants_over(kind) or device.variants
    sending = bytes_to_send.sending_section(device, device, sending_interface, variants[0], lambda *_, **__: "")
    return "\n".join((*sending.facts, *(" ".join(row) for row in sending.commands)))


def settings_register() -> Register:
    return replace(tv62().register("control"), bank=None)


def t_format(*ids: DataId, **changes: Any) -> Device:
    port = Port(baud=2500000, data_bits=8, parity="none", stop_bits=1, flow_control="none", source=())
    parts: dict[str, Any] = {"layouts": (), "timings": (), "note": "", "source": (), "measurement": None}
    kind = Rs485(port=port, data_ids=ids, memory_access=(), exchanges=(), **parts)
    return without_parts(interfaces=(*tv62().interfaces, kind), **changes)


RESET = DataId(name="reset_errors", id=7, control=0xBA, purpose="reset", meaning="Reset all errors", source=())
CAPTURE = DataId(name="position", id=0, control=0x02, purpose="capture", meaning="Read the position", source=())
ZERO = DataId(name="set_zero", id=6, control=0x32, purpose="write", meaning="Set it to zero", source=())
STORE = DataId(name="store", id=6, control=0x32, purpose="write", meaning="Store the settings", source=())


def command_only() -> Device:
    """Return the encoder with one command register, whose commands change no position."""
    command = tv62().register("command")
    values = (Value("restart", 1, "", MappingProxyType({}), "Start up again", ()),)
    restart_only = with_kind(command.layout, Choice(values), command.layout.fields[0].name)
    run = replace(
        tv62().procedure("set_preset"),
        name="restart",
        title="Start up again",
        arguments=(),
        steps=(WriteStep(register="command", value_name="restart", value=1),),
    )
    return without_parts(registers=(replace(command, layout=restart_only),), procedures=(run,))


def command_only_and(*registers: Register) -> Device:
    device = command_only()
    return replace(device, registers=(*device.registers, *registers))


case(
    "ssi_commands",
    lambda: sending_text("ssi", without_parts()),
    lambda: sending_text("ssi", without_parts(inputs=(input_pin(),))),
)
case(
    "ssi_registers",
    lambda: sending_text("ssi", without_parts()),
    lambda: sending_text("ssi", without_parts(registers=(replace(settings_register(), interface="ssi"),))),
)
case(
    "biss_commands",
    lambda: sending_text("biss", without_parts()),
    lambda: sending_text("biss", without_parts(registers=(tv62().register("command"),))),
)
case(
    "biss_commands_settings",
    lambda: sending_text("biss", without_parts()),
    lambda: sending_text("biss", without_parts(registers=(settings_register(),))),
)
case(
    "biss_commands_input",
    lambda: sending_text("biss", without_parts()),
    lambda: sending_text("biss", without_parts(inputs=(input_pin(),))),
)
case(
    "biss_commands_spec",
    lambda: sending_text("biss", without_parts()),
    lambda: sending_text("biss", spec_only(without_parts())),
)
case(
    "biss_commands_of_spec",
    lambda: sending_text("biss", spec_only(without_parts())),
    lambda: sending_text("biss", spec_only(without_parts(registers=(tv62().register("command"),)))),
)
case(
    "biss_writable",
    lambda: sending_text("biss", without_parts(inputs=(input_pin(),))),
    lambda: sending_text("biss", without_parts(inputs=(input_pin(),), registers=(settings_register(),))),
)
CONTROL = ControlField("command", "", 2, (), "", "Broadcast command", ())
case(
    "biss_commands_control",
    lambda: sending_text("biss", without_parts()),
    lambda: sending_text("biss", with_interface(replace(biss(), control_data=(CONTROL,)), without_parts())),
)
case(
    "biss_commands_left_out",
    lambda: sending_text("biss", without_parts()),
    lambda: sending_text("biss", without_parts(evidence=replace(tv62().evidence, left_out=("The registers.",)))),
)
case(
    "biss_preset",
    lambda: sending_text("biss", command_only()),
    lambda: sending_text("biss", command_only_and(settings_register())),
)
case("biss_preset_command", lambda: sending_text("biss", command_only()), lambda: sending_text("biss", tv62()))
case(
    "rs485_preset",
    lambda: sending_text("rs485", t_format(CAPTURE, RESET)),
    lambda: sending_text("rs485", t_format(CAPTURE, RESET, ZERO)),
)
case(
    "rs485_preset_input",
    lambda: sending_text("rs485", t_format(CAPTURE)),
    lambda: sending_text("rs485", t_format(CAPTURE, inputs=(input_pin(meaning="Sets the position to 0"),))),
)
case(
    "rs485_save",
    lambda: sending_text("rs485", t_format(CAPTURE, RESET)),
    lambda: sending_text("rs485", t_format(CAPTURE, RESET, STORE)),
)

# -- facts that a manual does not state


def speed_text(kind: str, device: Device) -> str:
    return "\n".join(wiring_tables.speed_section(device, device, interface_of(kind, device), None).facts)


def record_row(label: str, device: Device) -> str:
    """Return one row of the facts for masters."""
    return dict(facts_in_words(facts_of_order_code(device, device.variants[0])))[label]


REPLY = a_timing("Time from the request until the encoder answers")
case(
    "reply_time",
    lambda: speed_text("biss", without_parts()),
    lambda: speed_text("biss", with_interface(replace(interface_of("biss"), timings=(REPLY,)), without_parts())),
)
case(
    "reply_time_text",
    lambda: speed_text("biss", without_parts()),
    lambda: speed_text("biss", without_parts(characteristics=(a_text("processing", "Response time of at most 5 µs"),))),
)
case(
    "cable_length",
    lambda: speed_text("rs485", t_format(CAPTURE)),
    lambda: speed_text(
        "rs485",
        t_format(CAPTURE, characteristics=(a_text("cable_length", "At most 100 m"), a_text("reply_time", "5 µs"))),
    ),
)
case(
    "supply",
    lambda: wiring_tables.no_supply(without_parts(), interface_of("biss")),
    lambda: wiring_tables.no_supply(
        without_parts(characteristics=(a_text("supply", "+5 V DC"),)), interface_of("biss")
    ),
)
case(
    "supply_master",
    lambda: record_row("Supply", template("ssi")),
    lambda: record_row("Supply", replace(template("ssi"), characteristics=(a_text("supply", "+5 V DC"),))),
    is_slow=True,
)
case(
    "pause_master",
    lambda: record_row("Pause", template("ssi", *NO_TIMES)),
    lambda: record_row("Pause", template("ssi", *ONLY_PAUSE)),
    is_slow=True,
)
case(
    "cable_clock",
    lambda: cable_table(tv62(), biss()).sentence_on_clock(20_000_000),
    lambda: cable_table(tv62(), biss()).sentence_on_clock(1_000_000),
)

ONE_LED = Led(name="power", title="Power", states=(LedState(state="on", meaning="Supply is on"),), source=())
case(
    "leds",
    lambda: wiring_tables.no_leds(without_parts(), without_parts(), interface_of("biss")),
    lambda: wiring_tables.no_leds(without_parts(leds=(ONE_LED,)), without_parts(), interface_of("biss")),
)
case(
    "leds_text",
    lambda: wiring_tables.no_leds(without_parts(), without_parts(), interface_of("biss")),
    lambda: wiring_tables.no_leds(
        without_parts(characteristics=(a_text("lamp", "A LED lights up"),)), without_parts(), interface_of("biss")
    ),
)
case(
    "leds_of_code",
    lambda: wiring_tables.no_leds(without_parts(leds=(ONE_LED,)), without_parts(), interface_of("biss")),
    lambda: wiring_tables.no_leds(without_parts(leds=(ONE_LED,)), without_parts(leds=(ONE_LED,)), interface_of("biss")),
)


def without_timeout(*timings: Timing) -> str:
    kind = replace(biss(), timeouts=(), timings=timings)
    wave = timing_pictures.timing_diagram(with_interface(kind), kind)
    assert wave is not None
    return wave.text


case("timeout", without_timeout, lambda: without_timeout(a_timing("Timeout after a frame")))

# -- verdicts and flags of a frame


def with_flag(kind: Any, *more: Field) -> Device:
    """Return the encoder with this flag in place of the alarm of its SSI word."""
    word = interface_of("ssi").layouts[0]
    return with_interface(replace(interface_of("ssi"), layouts=(with_kind(word, kind, "alarm"),)))


def frame_text(device: Device) -> str:
    variant = device.variants_over("ssi")[0]
    layout = interface_of("ssi", device).layouts[0]
    facts = frame_facts.frame_facts(device, layout, variant)
    _, rows = verdict_table(device, device, layout, variant)
    return "\n".join([*(": ".join(pair) for pair in facts), *(" | ".join(row) for row in rows)])


def verdict_rows(device: Device) -> str:
    page = verdict_page.page_values(device)
    return "\n".join(" | ".join(row) for rows in (page["decides_rows"], page["report_rows"]) for row in rows)


ERROR, IRRELEVANT = Flag(makes_position=Verdict.NOT_USABLE), Flag(makes_position=Verdict.USABLE)
case("confirms", lambda: frame_text(with_flag(IRRELEVANT)), lambda: frame_text(with_flag(ERROR)))
case("none_of_the_bits", lambda: frame_text(with_flag(ERROR)), lambda: frame_text(with_flag(IRRELEVANT)))
case("not_usable", lambda: frame_text(with_flag(ERROR)), lambda: frame_text(with_flag(IRRELEVANT)))


def unused_frame_text(value: int) -> str:
    kind = Unused(value) if value else Number()
    data = interface_of("biss").layouts[0]
    layouts = (with_kind(data, kind, "warning"), *interface_of("biss").layouts[1:])
    device = with_interface(replace(interface_of("biss"), layouts=layouts))
    facts = frame_facts.frame_facts(device, interface_of("biss", device).layouts[0], device.variants_over("biss")[0])
    return "\n".join(": ".join(pair) for pair in facts)


case("not_used", lambda: unused_frame_text(1), lambda: unused_frame_text(0))


def alarm_with(**changes: Any) -> Alarm:
    nothing: dict[str, Any] = {"printed_name": "", "names": MappingProxyType({}), "group": "flags", "register": ""}
    flag_facts = {"field": "alarm", "meaning": "", "detected": "", "below_mv": None, "latch": None, "implemented": True}
    more = {"remedy": "", "cleared_by": (), "source": ()}
    return Alarm(**({"name": "alarm"} | nothing | flag_facts | more | changes))


def reported_row(**changes: Any) -> str:
    device = with_flag(ERROR)
    word = interface_of("ssi", device).layouts[0]
    fields = {present.name: present for present in word.fields}
    fields["alarm"] = replace(fields["alarm"], group="flags")
    flags_word = replace(word, fields=tuple(fields.values()))
    device = with_interface(replace(interface_of("ssi", device), layouts=(flags_word,)), device)
    errors = verdict_rows(replace(device, alarms=(alarm_with(**changes),)))
    return "\n".join(line for line in errors.splitlines() if "`alarm`" in line)


case("remedy", reported_row, lambda: reported_row(cleared_by=("set_preset",)))
case("remedy_text", reported_row, lambda: reported_row(remedy="Turn it off"))


def without_position() -> Device:
    return replace(tv62(), interfaces=tuple(replace(present, layouts=()) for present in tv62().interfaces))


case("no_frame", lambda: verdict_rows(without_position()), lambda: verdict_rows(tv62()))
case("no_field_decides", lambda: verdict_rows(with_flag(Number())), lambda: verdict_rows(tv62()))
case(
    "none_of_these",
    lambda: verdict_rows(tv62()),
    lambda: verdict_rows(replace(with_flag(Number()), interfaces=(interface_of("ssi", with_flag(Number())),))),
)

# -- statements that repeat a member of the spec

case(
    "alarm_implemented",
    lambda: printed(commands_and_alarms.alarm_facts(tv62(), alarm_with(group="", implemented=False))),
    lambda: printed(commands_and_alarms.alarm_facts(tv62(), alarm_with(group=""))),
)
case("alarm_row_implemented", lambda: alarm_row(False), lambda: alarm_row(True))
case("field_implemented", lambda: field_rules(a_field(Flag(), implemented=False)), lambda: field_rules(a_field(Flag())))
case("powers", lambda: field_rules(a_field(Number(power_of_two=True))), lambda: field_rules(a_field(Number())))
case("affects", lambda: field_rules(a_field(IRRELEVANT)), lambda: field_rules(a_field(ERROR)))
case("affects_not_usable", lambda: field_rules(a_field(ERROR)), lambda: field_rules(a_field(IRRELEVANT)))
case(
    "only_flag",
    lambda: field_rules(a_field(Flag(only="A-x", only_while="multiturn_bits"))),
    lambda: field_rules(a_field(Flag())),
)
case(
    "input_needs",
    lambda: printed(hardware_input.input_facts(tv62(), input_pin(needs="control.filter"))),
    lambda: printed(hardware_input.input_facts(tv62(), input_pin())),
)
case(
    "input_unused",
    lambda: printed(hardware_input.input_facts(tv62(), input_pin(when_unused="0 V"))),
    lambda: printed(hardware_input.input_facts(tv62(), input_pin())),
)
case("one_slave", lambda: network_text(False), lambda: network_text(True))
case("no_reply", lambda: exchange_text(""), lambda: exchange_text("answer"))
case("gaps", lambda: gaps_text("zero"), lambda: gaps_text(""))
case(
    "only",
    lambda: printed(names_and_evidence.order_codes_text("A-x")),
    lambda: printed(names_and_evidence.order_codes_text("")),
)
case(
    "only_timing",
    lambda: PLAIN_STYLE.sentence(timing.describe_timing(a_timing("Pause", "A-x"))),
    lambda: PLAIN_STYLE.sentence(timing.describe_timing(a_timing("Pause"))),
)
case(
    "open_part",
    lambda: printed(order_code.open_values(open_part("[0-9]+"))),
    lambda: printed(order_code.open_values(open_part(""))),
)
case(
    "open_value",
    lambda: printed(order_code.open_values(open_part("17"))),
    lambda: printed(order_code.open_values(open_part("17|18"))),
)
case(
    "special_model",
    lambda: printed(origin.differences_from_manual(special_model("S123"))),
    lambda: printed(origin.differences_from_manual(special_model(""))),
)
case(
    "edition",
    lambda: printed(origin.differences_from_manual(replace(tv62(), edition="1.0"))),
    lambda: printed(origin.differences_from_manual(tv62())),
)
case("succession", lambda: succession_text(True), lambda: succession_text(False))
case("read_only", lambda: access_text("read_only"), lambda: access_text("read_write"))
case("write_only", lambda: access_text("write_only"), lambda: access_text("read_write"))
case("opened_by", lambda: opened_text("bank"), lambda: opened_text(""))
case(
    "reported_not_implemented",
    lambda: commands_and_alarms.meaning(a_field(ERROR, implemented=False), None),
    lambda: commands_and_alarms.meaning(a_field(ERROR), None),
)
case(
    "unused_bits",
    lambda: names_and_evidence.deciding_value(replace(a_field(Unused(3)), widest=2)),
    lambda: names_and_evidence.deciding_value(a_field(ERROR)),
)
case(
    "crc_inverted",
    lambda: crc.crc_inverted(replace(tv62().crcs[0], xorout=0)),
    lambda: crc.crc_inverted(tv62().crcs[0]),
)
case(
    "evidence_hardware", lambda: grade_text("corroborated"), lambda: grade_text("corroborated, no hardware frame seen")
)
case("evidence_no_hardware", lambda: grade_text("corroborated, no hardware frame seen"), lambda: grade_text("quoted"))
case("evidence_single", lambda: grade_text("uncorroborated"), lambda: grade_text("quoted"))
case("contact_only", lambda: contact_text("A-x"), lambda: contact_text(""))
case("then_nothing", lambda: spelling_text(".*"), lambda: spelling_text(""))
case("times_read_decided", lambda: times_read(decided=2), lambda: times_read(decided=0))
case("times_read_once", lambda: times_read(once=2), lambda: times_read(once=0))
case("no_field", lambda: run_names(True), lambda: run_names(False))


def field_rules(placed_field: Field) -> str:
    return printed(field.describe_field_rules(tv62(), placed_field))


def alarm_row(implemented: bool) -> str:
    device = replace(tv62(), alarms=(replace(tv62().alarms[0], implemented=implemented),))
    return "\n".join(" ".join(row) for row in cross_family_pages.alarms_page_values([device])["alarm_rows"])


def network_text(several: bool) -> str:
    kind = replace(biss(), network=Network(topology="point_to_point", multiple_slaves=several, source=()))
    return printed(interface.describe_settings(tv62(), kind))


def exchange_text(reply: str) -> str:
    return PLAIN_STYLE.sentence(interface.describe_exchange(Exchange("ask", None, reply, "other", ())))


def gaps_text(value: str) -> str:
    word = replace(interface_of("ssi").layouts[0], gaps=value)
    return printed(layout.describe_layout(tv62(), interface_of("ssi"), word))


def open_part(pattern: str) -> CodePart:
    return CodePart("cable", "Length of the cable", pattern, (), ())


def special_model(suffix: str) -> Device:
    return replace(tv62(), base="tv62", overlays=(Overlay("change", "A change", suffix),))


def succession_text(alone: bool) -> str:
    step = SendStep(data_id="reset", request=b"\xba", times=10, microseconds=40, in_succession=alone)
    return PLAIN_STYLE.sentence(commands_and_alarms.describe_step(tv62(), step))


def access_text(word: str) -> str:
    return register.describe_access(replace(tv62().register("control"), access=word))


def opened_text(by: str) -> str:
    control = replace(tv62().register("control"), opened_by=by, opened_by_value="position" if by else "")
    return printed(register.describe_register_facts(tv62(), control))


def grade_text(word: str) -> str:
    return PLAIN_STYLE.sentence(
        names_and_evidence.describe_grade(replace(tv62(), evidence=replace(tv62().evidence, grade=word)))
    )


def contact_text(codes: str) -> str:
    connector = replace(tv62().connectors[0], contacts=(Contact(contact="1", signal="0 V", only=codes),))
    return page_pictures.connector_text(connector) + page_pictures.connector_picture(connector)


def spelling_text(then: str) -> str:
    spelling = Spelling("TV62 {turns}", "the data sheet", (SpelledValue("turns", "S", "S"),), then, ())
    code = replace(tv62().order_code, also_written=(spelling,))
    return "\n".join(" ".join(row) for row in order_code_tables.spelling_rows(replace(tv62(), order_code=code)))


def times_read(decided: int = 0, once: int = 0) -> str:
    counts = TimesRead(twice=10, explained=0, decided=decided, once=once, derived=0)
    rows = family_pages.manual_values(replace(tv62(), times_read=counts))["manual_rows"]
    return "\n".join(" ".join(row) for row in rows)


def run_names(has_gap: bool) -> str:
    word = interface_of("ssi").layouts[0]
    fields = tuple(present for present in word.fields if not (has_gap and present.name == "alarm"))
    placed = replace(word, fields=fields).place(tv62().variants_over("ssi")[0].parameters)
    return " ".join(run.name for run in layout_pictures.runs_of_layout(placed))


# -- errata


def an_erratum(**changes: Any) -> Erratum:
    return replace(
        Erratum(
            "bit_order",
            "The bits are swapped",
            "bit 1",
            "bit 2",
            "The table",
            "open",
            "wrong_data",
            ("registers.control",),
            (),
        ),
        **changes,
    )


def summary(*errata: Erratum) -> str:
    badges = ErrataLinks(replace(tv62(), errata=errata))
    badges("registers.bank")
    return badges.count_by_status()


def errata_page(*errata: Erratum) -> str:
    page = family_pages.errata_values(replace(tv62(), errata=errata))
    sections = [(kind, section) for kind, of_kind in page["errata_by_kind"] for section in of_kind]
    texts = (" ".join((kind, section["summary"], *section["cells"])) for kind, section in sections)
    return "\n".join((page["errata_summary"], *texts))


case("errata_none", summary, lambda: summary(an_erratum()))
case("errata_none_here", lambda: summary(an_erratum()), lambda: summary(an_erratum(affects=("registers.bank",))))
case("errata_page_none", errata_page, lambda: errata_page(an_erratum()))
case("errata_open", lambda: errata_page(an_erratum()), lambda: errata_page(an_erratum(status="settled")))
case(
    "erratum_only",
    lambda: printed([erratum.describe_erratum(an_erratum(only="A-x"))]),
    lambda: printed([erratum.describe_erratum(an_erratum())]),
)
case(
    "erratum_unknown",
    lambda: printed([erratum.describe_erratum(an_erratum(edition="before 1.1", used="not known"))]),
    lambda: printed([erratum.describe_erratum(an_erratum(edition="before 1.1"))]),
)
case(
    "erratum_left_out",
    lambda: printed([erratum.describe_erratum(an_erratum(edition="before 1.1", used="left out"))]),
    lambda: printed([erratum.describe_erratum(an_erratum(edition="before 1.1"))]),
)
case("severity_missing", lambda: errata_page(an_erratum(severity="omission")), lambda: errata_page(an_erratum()))
case("severity_wording", lambda: errata_page(an_erratum(severity="wording")), lambda: errata_page(an_erratum()))


# -- whole outputs of the specs that ``codewheel new`` writes

EXAMPLES = "\nexamples:"


@cache
def template(like: str, *changes: tuple[str, str]) -> Device:
    """Return the encoder of a spec that ``new`` writes, without its examples, with texts of the spec replaced."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "acme18.yaml"
        write_spec("acme18", path, like)
        text = path.read_text("utf-8").partition(EXAMPLES)[0]
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new, 1)
        path.write_text(text, "utf-8")
        devices, frame_texts = load_library([Path(folder)])
    assert not frame_texts, "\n".join(problem.format() for problem in frame_texts.problems)
    return devices[0]


@cache
def generated(target: str, like: str, *changes: tuple[str, str]) -> str:
    return generated_text(target, template(like, *changes))


def output(target: str, like: str, *changes: tuple[str, str]) -> Printed:
    return partial(generated, target, like, *changes)


JOIN = "        join: {position: [multiturn, singleturn]}\n"
CRC = """crcs:
  - {name: crc_6, width: 6, poly: 0x03, init: 0, refin: false, refout: false, xorout: 0, source: "5"}

interfaces:"""
WITH_CRC = (("interfaces:", CRC), (JOIN, f"          - {{name: crc, crc: crc_6}}\n{JOIN}"))
WITH_PARITY = ((JOIN, f"          - {{name: parity, parity_of: [multiturn, singleturn]}}\n{JOIN}"),)
BOTH = (*WITH_PARITY, *WITH_CRC)
ERROR_BIT = ((JOIN, f"          - {{name: error, active: high, makes_position: not_usable}}\n{JOIN}"),)
HARMLESS_BIT = ((JOIN, f"          - {{name: note, active: high, makes_position: usable}}\n{JOIN}"),)
MORE = "\ninterfaces:"
A_TABLE = """
tables:
  - {name: pins, title: Pins, columns: [A], units: [""], rows: [[B]], source: "4"}

interfaces:"""
REVOLUTIONS = "      meaning: Number of revolutions\n"
OPEN_TWO, OPEN_ANY = ((REVOLUTIONS, f"{REVOLUTIONS}      open: '{pattern}'\n") for pattern in ("[0-9]{2}", "[0-9]+"))
RESET_ID = "{name: reset_errors, id: 7, control: 0xBA, purpose: reset, meaning: Reset all errors, source: '7.3'}"
RESET_PROCEDURE = """procedures:
  - name: reset_errors
    title: Reset all errors
    interface: rs485
    steps:
      - {do: send, data_id: reset_errors, times: 10, every_at_least_us: 40%s}
    source: '7.3'

interfaces:"""
WITH_RESET = (
    ("      - {name: all_data", f"      - {RESET_ID}\n      - {{name: all_data"),
    ("data_id: [0, 3]", "data_id: [0, 3, 7]"),
    ("data_id: [0]", "data_id: [0, 7]"),
)
RESET_ALONE = (*WITH_RESET, ("interfaces:", RESET_PROCEDURE % ", in_succession: true"))
RESET_SHARED = (*WITH_RESET, ("interfaces:", RESET_PROCEDURE % ""))
ZERO_BIT = (
    (
        "interfaces:",
        """alternatives:
  - name: zero_bit
    meaning: A 0 after the position
    values:
      sent: {meaning: It is sent, sets: {zero_bits: 1}, source: "5"}
      left_out: {meaning: It is left out, sets: {zero_bits: 0}, source: "5"}
    source: "5"

interfaces:""",
    ),
    (
        "  position_bits:",
        "  zero_bits: {meaning: Zeros, unit: bits, alternative: zero_bit, source: '5'}\n  position_bits:",
    ),
    (JOIN, f"          - {{name: zero, bits: zero_bits, constant: 0}}\n{JOIN}"),
)
NO_SINGLETURN = ('        "1": {meaning: Singleturn, sets: {multiturn_bits: 0}}\n', "")
MOUNTING = "\ncharacteristics:\n  - {name: mounting, value: 1. A 2. B 3. C 4. D, source: '1'%s}\ninterfaces:"
BY_HAND_ONLY, BY_HAND = (MORE, MOUNTING % ", only: ACME18-13-..."), (MORE, MOUNTING % "")
ONLY_PAUSE = (("- {name: pause, symbol: Tp,", "- {name: gap, symbol: Tg,"),)
NO_TIMES = (
    ("    timings:\n", ""),
    ('      - {name: pause, symbol: Tp, meaning: Pause between two words, at_least_us: 20, source: "TODO 5.1"}\n', ""),
)

for name, target, like, true, false in (
    ("no_crc", "c", "ssi", (), WITH_CRC),
    ("no_status", "c", "ssi", HARMLESS_BIT, ERROR_BIT),
    ("no_status_page", "c", "ssi", HARMLESS_BIT, ERROR_BIT),
    ("ssi_without_crc", "c", "ssi", (), WITH_CRC),
    ("ssi_word_in_readme", "c", "ssi", (), WITH_CRC),
    ("ssi_word_in_header", "c", "ssi", (), WITH_CRC),
    ("ssi_word_in_example", "c", "ssi", (), WITH_CRC),
    ("parity_alone", "c", "ssi", WITH_PARITY, BOTH),
    ("python_no_status", "python", "ssi", HARMLESS_BIT, ERROR_BIT),
    ("unlisted_part", "c", "ssi", (), (OPEN_TWO,)),
    (
        "pins",
        "docs",
        "ssi",
        (),
        ((MORE, "\ncharacteristics: [{name: shaft, value: 12 mm, source: '1'}]\ninterfaces:"),),
    ),
    (
        "pins_table",
        "docs",
        "ssi",
        (),
        (
            (
                MORE,
                A_TABLE,
            ),
        ),
    ),
    ("open_part_of_label", "c", "ssi", (OPEN_TWO,), ()),
    ("known_values", "c", "ssi", (OPEN_ANY,), ()),
    ("send_alone", "c", "rs485", RESET_ALONE, RESET_SHARED),
    ("alternative", "c", "ssi", ZERO_BIT, ()),
    ("alternative_docs", "docs", "ssi", ZERO_BIT, ()),
    ("alternative_python", "python", "ssi", ZERO_BIT, ()),
    ("missing_field", "python", "ssi", (), (NO_SINGLETURN,)),
    ("steps_only_with", "docs", "ssi", (BY_HAND_ONLY,), (BY_HAND,)),
):
    case(name, output(target, like, *true), output(target, like, *false), is_slow=True)


def single_headers(*changes: tuple[str, str]) -> str:
    """Return the single header of the first order code over SSI."""
    device = template("ssi", *changes)
    options = {"only": device.variants[0].code, "form": "single"}
    return "\n".join(generate_c(Library((device,)), options).values())


case("pause_single", partial(single_headers, *NO_TIMES), single_headers, is_slow=True)


def without_ids() -> Device:
    """Return the encoder without the registers that identify it, which hold text."""
    registers = tuple(present for present in tv62().registers if not present.name.endswith("_id"))
    return replace(tv62(), registers=registers)


def with_flags(kind: Any) -> Device:
    """Return the encoder with this kind in place of the error and the warning of its BiSS frame."""
    data = interface_of("biss").layouts[0]
    layouts = (with_kind(data, kind, "error", "warning"), *interface_of("biss").layouts[1:])
    return with_interface(replace(interface_of("biss"), layouts=layouts))


def of_one_interface() -> Device:
    kind = replace(interface_of("ssi"), measurement=tv62().measurement)
    return with_interface(kind, measurement=None)


def with_ssi_parameters() -> Device:
    return replace(tv62(), parameters=tuple(replace(parameter, interface="ssi") for parameter in tv62().parameters))


def with_code(**changes: Any) -> Device:
    return replace(tv62(), order_code=replace(tv62().order_code, **changes))


RELEASE = Release("0.1.0", "", "1.1", ())
SPELLED = (Spelling("TV62 {turns}", "the data sheet", (SpelledValue("turns", "S", "S"),), "", ()),)
ONE_CODE = [variant for variant in tv62().variants if variant.interface == "biss"][:1]
for name, target, true_device, false_device in (
    ("no_length", "biss", tv62, lambda: replace(tv62(), variants=tuple(ONE_CODE))),
    ("shared_ids", "biss", tv62, without_ids),
    ("always_1", "biss", lambda: with_flags(Unused(1)), tv62),
    ("no_status_bits", "biss", lambda: with_flags(Number()), tv62),
    ("no_terminator", "c", tv62, without_ids),
    ("made_up", "c", lambda: template("ssi"), tv62),
    (
        "only_over",
        "python",
        with_ssi_parameters,
        tv62,
    ),
    ("no_measurement", "python", of_one_interface, tv62),
    ("figures", "docs", tv62, lambda: replace(tv62(), lost_figures=())),
    ("release", "docs", tv62, lambda: replace(tv62(), releases=(RELEASE,))),
    ("spellings", "docs", lambda: with_code(also_written=SPELLED), tv62),
):
    case(
        name,
        partial(generated_text_of, target, true_device),
        partial(generated_text_of, target, false_device),
        is_slow=True,
    )

# A manufacturer without any encoder that can be identified has no file.
case(
    "no_device_id",
    lambda: generated_text("biss", tv62(), replace(without_ids(), name="tv63")),
    lambda: generated_text("biss", tv62(), replace(tv62(), name="tv63")),
    is_slow=True,
)

# -- limits and ranges


def clock_text(min_hz: int | None, max_hz: int | None) -> str:
    """Return the words for a clock at which encoders are read at 1 MHz."""
    return interface.clock_words(Clock(min_hz=min_hz, max_hz=max_hz, used_hz=(1_000_000,), source=()))


case("clock_limits", lambda: clock_text(None, None), lambda: clock_text(100_000, 2_000_000))
case("lowest_clock", lambda: clock_text(None, 2_000_000), lambda: clock_text(100_000, 2_000_000))
case("highest_clock", lambda: clock_text(100_000, None), lambda: clock_text(100_000, 2_000_000))
case(
    "clock_not_stated",
    lambda: interface.clock_words(Clock(source=())),
    lambda: interface.clock_words(Clock(max_hz=2_000_000, source=())),
)


def range_text(wraps: bool) -> str:
    """Return the sentence about the range of the position in a layout."""
    modulus = Expression.parse(1 << 24) if wraps else None
    return PLAIN_STYLE.phrase(measurement.describe_position_range(LayoutRange(modulus=modulus, wraps=wraps)))


case("never_wraps", lambda: range_text(wraps=False), lambda: range_text(wraps=True))
