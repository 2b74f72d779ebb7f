"""The names defined in a spec, and the report of a reference to a name that does not exist."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence

from ...model import INTERFACES
from ..document import Path
from ..problems import DocumentReport, nearest_choice, quoted, suggest_word
from ..schema_check import value_at
from ..written_parts import WrittenSpec
from .parts import bits_of, by_name, by_part_name, named_values

_NAME_PATTERN = re.compile("[a-z][a-z0-9]*(_[a-z0-9]+)*")


class NameResolver:
    """The names that a spec defines, by kind, and the report of references to undefined names.

    A name counts as defined even if its part is otherwise invalid. ``groups``, ``registers`` and ``procedures`` contain
    the parts by name.
    """

    def __init__(self, spec: WrittenSpec, report: DocumentReport) -> None:
        self._report = report
        whole_spec = spec.with_invalid_parts
        interfaces = list(whole_spec.interfaces.data)
        self.parameter_names = whole_spec.names_in("parameters")
        # Names that are themselves misspelt: unknown interfaces, and names that the schema check rejected.
        self._broken = {name for name in interfaces if name not in INTERFACES}
        for path in report.faults():
            # A part in a list has its name under 'name', one in a map is a key itself.
            name = value_at(whole_spec.data, path) if path[-1] == "name" else path[-1]
            if isinstance(name, str) and not _NAME_PATTERN.fullmatch(name):
                self._broken.add(name)
        self.groups = by_name(whole_spec.field_groups)
        self.registers = by_name(whole_spec.registers)
        self.procedures = by_name(whole_spec.procedures)
        self._known: Mapping[str, Collection[str]] = {
            "CRC": by_part_name(whole_spec.crcs),
            "erratum": by_name(whole_spec.errata),
            "field group": self.groups,
            "interface": interfaces,
            "parameter": self.parameter_names,
            "procedure": self.procedures,
            "register": self.registers,
        }

    def refer(self, path: Path, kind: str, name: str, known_names: Collection[str] | None = None) -> None:
        """Report the name at ``path`` if it does not exist: if it is not among ``known_names``.

        By default, these are all names of its kind in the spec. ``kind`` is the kind in the message, such as
        ``register``, or ``field of 'preset' called`` with ``known_names``. If one of the known names is itself
        misspelt, which is reported already, ``name`` may be the correct spelling. Then the place is only marked as
        faulty, unless another known name is similar.
        """
        choices = self._known[kind] if known_names is None else known_names
        if name in choices:
            return
        has_broken_choice = not self._broken.isdisjoint(choices)
        intact_choices = [choice for choice in choices if choice not in self._broken]
        if has_broken_choice and not nearest_choice(name, intact_choices):
            self._report.mark(path)
            return
        problem = f"there is no {kind} {quoted(name)}{suggest_word(name, choices)}"
        self._report.add("undefined-reference", path, problem, cause=name)

    def report_problem(self, path: Path, problem: str) -> None:
        """Report a problem with the name at ``path``, which exists."""
        self._report.add("undefined-reference", path, problem)

    def refer_if_given(
        self, path: Path, kind: str, name: str | None, known_names: Collection[str] | None = None
    ) -> None:
        """Report the name at ``path`` if it does not exist. A missing name, which is None or empty, is accepted."""
        if name:
            self.refer(path, kind, name, known_names)

    def refer_to_each(
        self, path: Path, kind: str, names: Sequence[str], known_names: Collection[str] | None = None
    ) -> None:
        """Report each name in the list at ``path`` that does not exist."""
        for index, name in enumerate(names):
            self.refer((*path, index), kind, name, known_names)

    def refer_to_bit(self, path: Path, bit_path: str) -> None:
        """Report ``bit_path``, written as ``register.field``, unless both exist."""
        name, _, field = bit_path.partition(".")
        self.refer(path, "register", name)
        if name in self.registers:
            self.refer(path, f"field of {quoted(name)} called", field, self.bits(name))

    def bits(self, register: str) -> list[str]:
        """Return the names allowed after the dot in ``register.field``: the fields of a register, or its own name."""
        return bits_of(self.registers[register], self.groups)

    def values(self, register: str, field: str = "") -> list[str]:
        """Return the names of values of a register, or of one of its fields."""
        return named_values(self.registers[register], self.groups, field)
