"""The rules beyond the schema, for errors in specs whose single keys and values are all valid.

A rule is a function of the pruned data, the data as read, and the report of the document.
It adds problems under a stable name and never raises. To add a rule, write the function in the module of its subject,
list it here, and add a broken spec in ``tests/check/broken``.
"""

from __future__ import annotations

from . import (
    agreement,
    biss,
    bits,
    connectors,
    left_behind,
    names,
    order_code,
    parameters,
    position_verdicts,
    printed_twice,
    procedures,
    quantities,
    requests,
    shapes,
    sources,
    values,
    words,
)
from . import procedures as banks
from . import procedures as saving
from . import values as bases
from . import values as clocks
from .order_code import order_code_references
from .parts import Rule
from .references import (
    alarm_references,
    alternative_references,
    by_hand_references,
    connector_references,
    device_references,
    erratum_references,
    evidence_references,
    example_references,
    expressions,
    field_references,
    printed_references,
    procedure_references,
    register_references,
    unused_crc,
)
from .walk import Rule as RuleOnData


def _on_data(rule: RuleOnData) -> Rule:
    """Return a rule that gets plain data instead of the parts of a spec."""
    return lambda spec, raw, report: rule(spec.data, raw.data, report)


#: Rules on order codes and parameters, on which every width depends. If they find an error, the build omits these.
FOUNDATIONS: tuple[Rule, ...] = (
    _on_data(order_code_references),
    _on_data(alternative_references),
    _on_data(parameters.parameter_origin),
    _on_data(parameters.alternative_use),
    position_verdicts.default_answers,
    position_verdicts.verdicts_by_answer,
    _on_data(expressions),
    _on_data(order_code.parameter_cycle),
    _on_data(order_code.order_code_pattern),
)

#: Rules on layouts, registers, groups and CRCs. One with an error cannot be built.
SHAPES: tuple[Rule, ...] = (
    shapes.layout_keys,
    position_verdicts.combinations,
    values.crc_impossible,
    values.field_count,
)

#: Every rule, in the order of execution. The order is not visible, because problems are sorted by place.
RULES: tuple[Rule, ...] = (
    *FOUNDATIONS,
    *SHAPES,
    _on_data(order_code.order_code_ambiguous),
    _on_data(order_code.also_written),
    names.device_name,
    names.duplicate_name,
    names.duplicate_title,
    names.duplicate_field,
    names.duplicate_selection,
    names.duplicate_address,
    names.value_clash,
    _on_data(printed_twice.repeated_item),
    _on_data(field_references),
    _on_data(register_references),
    _on_data(alarm_references),
    _on_data(by_hand_references),
    _on_data(procedure_references),
    _on_data(example_references),
    _on_data(erratum_references),
    _on_data(connector_references),
    _on_data(printed_references),
    _on_data(device_references),
    bases.number_base,
    bases.typographic_quotes,
    _on_data(sources.cited_place),
    _on_data(evidence_references),
    _on_data(sources.evidence),
    _on_data(sources.limit_source),
    banks.bank_named,
    banks.bank_selected,
    biss.biss_places,
    biss.biss_taken,
    biss.biss_byte_order,
    biss.biss_frame,
    biss.biss_control,
    _on_data(unused_crc),
    requests.exchanges,
    requests.requests_that_write,
    requests.requests,
    procedures.step_access,
    procedures.step_waits,
    procedures.step_opens,
    procedures.argument_written,
    procedures.procedure_name,
    saving.saved_before_written,
    _on_data(parameters.parameter_interface),
    _on_data(parameters.units),
    _on_data(sources.revision_in_history),
    _on_data(sources.open_quotation),
    _on_data(printed_twice.printed_number),
    _on_data(printed_twice.interface_named),
    _on_data(printed_twice.value_words),
    _on_data(printed_twice.addresses),
    _on_data(printed_twice.labels),
    _on_data(printed_twice.default_lists),
    _on_data(printed_twice.writes),
    connectors.signal_twice,
    connectors.incomplete_pair,
    connectors.connector_and_cable,
    bits.makes_position_missing,
    position_verdicts.value_verdicts,
    position_verdicts.report_names,
    bits.plain_bits,
    bits.error_usable,
    bits.flag_sums,
    bits.alarm_name,
    bits.output_code,
    bits.gray_named,
    values.value_too_wide,
    values.register_range,
    values.timing_bounds,
    values.clock_range,
    clocks.plausible_rate,
    values.cable_order,
    values.dates,
    values.supply_range,
    values.timeout_mismatch,
    values.bad_source,
    shapes.byte_order_missing,
    procedures.step_shape,
    shapes.example_shape,
    shapes.example_arguments,
    shapes.measurement_shape,
    shapes.position_range_shape,
    _on_data(quantities.table_shape),
    _on_data(quantities.quantity_text),
    _on_data(quantities.quantity_repeated),
    _on_data(quantities.time_repeated),
    _on_data(quantities.column_units),
    _on_data(agreement.misspelt_name),
    _on_data(agreement.number_in_meaning),
    _on_data(agreement.polynomial_in_note),
    _on_data(agreement.unused_bits),
    _on_data(agreement.access_repeated),
    _on_data(agreement.zero_within_limits),
    _on_data(agreement.requests_repeated),
    _on_data(agreement.table_repeated),
    _on_data(quantities.conversions),
    words.threshold_words,
    words.latch_words,
    words.level_words,
    words.name_and_meaning,
    words.wires_named,
    _on_data(printed_twice.repeated_text),
    _on_data(left_behind.start_values),
    _on_data(left_behind.defaults),
    _on_data(left_behind.order_codes_in_texts),
)
