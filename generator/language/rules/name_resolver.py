"""The names defined in a spec, and the report of a reference to a name that does not exist."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence

from ...model import INTERFACES
from ..document import Path
from ..problems import DocumentReport, nearest_choice, quoted, suggest_word
from ..schema_check import value_at
from ..written_parts import WrittenSpec
from .parts import bit_names, by_name, by_part_name, value_names_of_register

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
        self._misspelt_names = {name for name in interfaces if name not in INTERFACES}
        for path in report.faults():
            # A part in a list has its name under 'name', one in a map is a key itself.
            name = value_at(whole_spec.data, path) if path[-1] == "name" else path[-1]
            if isinstance(name, str) and not _NAME_PATTERN.fullmatch(name):
                self._misspelt_names.add(name)
        self.groups = by_name(whole_spec.field_groups)
        self.registers = by_name(whole_spec.registers)
        self.procedures = by_name(whole_spec.procedures)
        self._names_by_noun: Mapping[str, Collection[str]] = {
            "CRC": by_part_name(whole_spec.crcs),
            "erratum": by_name(whole_spec.errata),
            "field group": self.groups,
            "interface": interfaces,
            "parameter": self.parameter_names,
            "procedure": self.procedures,
            "register": self.registers,
        }

    def check_name(self, path: Path, noun: str, name: str, *, known_names: Collection[str] | None = None) -> None:
        """Report the name at ``path`` if it does not exist: if it is not among ``known_names``.

        By default, these are all names of its kind in the spec. ``noun`` is its kind in the message, such as
        ``register``, or ``field of 'preset' called`` with ``known_names``. If one of the known names is itself
        misspelt, which is reported already, ``name`` may be the correct spelling. Then the place is only marked as
        faulty, unless another known name is similar.
        """
        choices = self._names_by_noun[noun] if known_names is None else known_names
        if name in choices:
            return
        has_misspelt_choice = not self._misspelt_names.isdisjoint(choices)
        correct_choices = [choice for choice in choices if choice not in self._misspelt_names]
        if has_misspelt_choice and not nearest_choice(name, correct_choices):
            self._report.mark(path)
            return
        problem = f"there is no {noun} {quoted(name)}{suggest_word(name, choices)}"
        self._report.add("undefined-reference", path, problem, cause=name)

    def report_problem(self, path: Path, problem: str) -> None:
        """Report a problem with the name at ``path``, which exists."""
        self._report.add("undefined-reference", path, problem)

    def check_optional_name(
        self, path: Path, noun: str, name: str | None, *, known_names: Collection[str] | None = None
    ) -> None:
        """Report the name at ``path`` if it does not exist. A missing name, which is None or empty, is accepted."""
        if name:
            self.check_name(path, noun, name, known_names=known_names)

    def check_each_name(
        self, path: Path, noun: str, names: Sequence[str], *, known_names: Collection[str] | None = None
    ) -> None:
        """Report each name in the list at ``path`` that does not exist."""
        for index, name in enumerate(names):
            self.check_name((*path, index), noun, name, known_names=known_names)

    def check_bit_path(self, path: Path, bit_path: str) -> None:
        """Report ``bit_path``, written as ``register.field``, unless both exist."""
        register_name, _, field_name = bit_path.partition(".")
        self.check_name(path, "register", register_name)
        if register_name in self.registers:
            noun = f"field of {quoted(register_name)} called"
            self.check_name(path, noun, field_name, known_names=self.bit_names(register_name))

    def bit_names(self, register_name: str) -> list[str]:
        """Return the names allowed after the dot in ``register.field``: the fields of a register, or its own name."""
        return bit_names(self.registers[register_name], self.groups)

    def value_names(self, register_name: str, field_name: str = "") -> list[str]:
        """Return the names of values of a register, or of one of its fields."""
        return value_names_of_register(self.registers[register_name], self.groups, field_name)
