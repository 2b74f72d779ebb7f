"""The rules beyond the schema, for errors in specs whose single keys and values are all valid.

A rule is a function of the pruned data, the data as read, and the report of the document.
It adds problems under a stable name and never raises. To add a rule, write the function in the module of its subject,
list it here, and add a broken spec in ``tests/check/broken``.
"""

from __future__ import annotations

from . import (
    banks,
    bases,
    biss,
    contents,
    flags,
    meanings,
    names,
    order_code,
    parameters,
    printed,
    procedures,
    quantities,
    references,
    repeated,
    shapes,
    spi,
    values,
)
from .walk import Rule

#: Rules on order codes and parameters, on which every width depends. If they find an error, the build omits these.
FOUNDATIONS: tuple[Rule, ...] = (
    references.order_code_references,
    references.alternative_references,
    parameters.parameter_origin,
    parameters.alternative_use,
    references.expressions,
    order_code.parameter_cycle,
    order_code.order_code_pattern,
)

#: Rules on layouts, registers, groups and CRCs. One with an error cannot be built.
SHAPES: tuple[Rule, ...] = (
    shapes.layout_keys,
    values.crc_impossible,
)

#: Every rule, in the order of execution. The order is not visible, because problems are sorted by place.
RULES: tuple[Rule, ...] = (
    *FOUNDATIONS,
    *SHAPES,
    order_code.order_code_ambiguous,
    order_code.also_written,
    names.device_name,
    names.duplicate_name,
    names.duplicate_field,
    names.duplicate_selection,
    names.duplicate_address,
    names.value_clash,
    repeated.repeated_item,
    references.field_references,
    references.register_references,
    references.alarm_references,
    references.by_hand_references,
    references.procedure_references,
    references.example_references,
    references.erratum_references,
    references.connector_references,
    references.printed_references,
    references.device_references,
    bases.number_base,
    bases.typographic_quotes,
    contents.cited_place,
    banks.bank_named,
    banks.bank_selected,
    biss.biss_places,
    biss.biss_taken,
    biss.biss_byte_order,
    biss.biss_frame,
    biss.biss_control,
    references.unused_crc,
    spi.exchanges,
    procedures.step_access,
    procedures.step_waits,
    procedures.step_opens,
    procedures.argument_written,
    procedures.procedure_name,
    parameters.parameter_interface,
    parameters.units,
    meanings.printed_number,
    meanings.interface_named,
    meanings.value_words,
    printed.addresses,
    printed.labels,
    printed.default_lists,
    printed.writes,
    flags.makes_position_missing,
    flags.flag_sums,
    flags.alarm_name,
    values.value_too_wide,
    values.register_range,
    values.timing_bounds,
    values.clock_range,
    values.cable_order,
    values.dates,
    values.supply_range,
    values.timeout_mismatch,
    values.bad_source,
    shapes.byte_order_missing,
    shapes.step_shape,
    shapes.example_shape,
    shapes.example_arguments,
    shapes.measurement_shape,
    shapes.table_shape,
    quantities.quantity_text,
    quantities.quantity_repeated,
    quantities.column_units,
)
