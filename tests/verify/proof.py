"""Requirements of a proof by CBMC: the header as text, the parameters of all order codes, and the run.

CBMC is a model checker. A harness is a C file whose functions claim something about arbitrary values with
``__CPROVER_assert``. The parameters of the variant are also arbitrary, but restricted to the parameters of the order
codes and to the possible contents of registers, so that one proof covers all of them.
"""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

from codewheel.model import Alternative, Device, Variant, answer_combinations
from codewheel.model.expressions import Expression

#: All kinds of undefined behaviour that the checker knows, except overflow of floating point.
UNDEFINED = (
    "--bounds-check --pointer-check --pointer-overflow-check --pointer-primitive-check"
    " --signed-overflow-check --undefined-shift-check --div-by-zero-check"
).split()
#: For a loop that carries only an arbitrary index from one round to the next:
#: a few rounds from any start cover all of them.
PARTLY = "--no-unwinding-assertions"
#: Seconds of processor time, far above the time of any proof here. A run that does not end is not a proof. The load of
#: the machine does not matter.
LIMIT_S = 900


@dataclass(frozen=True)
class Function:
    name: str
    type: str
    arguments: tuple[tuple[str, str], ...]
    body: str


@dataclass(frozen=True)
class Member:
    type: str
    name: str
    count: int


@dataclass(frozen=True)
class Header:
    """The functions and structs of a header, found in its text alone.

    ``options`` are macros that a user may define to select other code.
    """

    functions: Mapping[str, Function]
    structs: Mapping[str, tuple[Member, ...]]
    options: tuple[str, ...] = ()

    @classmethod
    def parse(cls, *texts: str) -> Header:
        text = re.sub(r"/\*.*?\*/", "", "\n".join(texts), flags=re.DOTALL)
        macros = dict.fromkeys(re.findall(r"^#ifdef (\w+)$", text, re.MULTILINE))
        options = tuple(macro for macro in macros if macro != "__cplusplus")
        # Without any of the macros that a header checks.
        text = re.sub(
            r"^#ifdef \w+\n(.*?)(?:^#else\n(.*?))?^#endif\n",
            lambda match: match[2] or "",
            text,
            flags=re.DOTALL | re.MULTILINE,
        )
        functions = {}
        for match in re.finditer(
            r"^static inline ([^;{}]*?)(\w+)\(([^{}]*?)\)\n\{\n(.*?)^\}", text, re.DOTALL | re.MULTILINE
        ):
            argument_text = " ".join(match[3].split())
            parts = [part.strip() for part in argument_text.split(",")]
            arguments = [re.fullmatch(r"(.*?)(\w+)", part) for part in parts if part != "void"]
            pairs = tuple((argument[1].strip(), argument[2]) for argument in arguments if argument)
            functions[match[2]] = Function(match[2], " ".join(match[1].split()), pairs, match[4])
        structs = {}
        for struct in re.finditer(r"^typedef struct (\w+) \{\n(.*?)^\} \1;", text, re.DOTALL | re.MULTILINE):
            members = re.finditer(r"([\w ]+[ *])(\w+)(?:\[(\d+)\])?;", struct[2])
            structs[struct[1]] = tuple(Member(member[1].strip(), member[2], int(member[3] or 0)) for member in members)
        return cls(functions, structs, options)

    def member(self, struct: str, name: str) -> Member:
        """Return the member for a name of the spec. A reserved word has a trailing underscore."""
        return next(member for member in self.structs[struct] if member.name in (name, name + "_"))

    def anything(self, struct: str, name: str) -> str:
        """Return lines that declare a struct in which every member can have any value of its type."""
        lines = f"    {struct} {name};\n"
        for member in self.structs.get(struct, ()):
            if member.type in ("bool", "_Bool") and not member.count:
                lines += f"    {name}.{member.name} = nondet_bool();\n"
        return lines


PRELUDE = """\
_Bool nondet_bool(void);
long long nondet_number(void);
unsigned long long nondet_word(void);
unsigned char nondet_byte(void);
__CPROVER_size_t nondet_size(void);
void *malloc(__CPROVER_size_t size);
"""


def in_c(expression: Expression) -> str:
    """Return an expression over parameters as the reference computes it: with plain signed numbers of 64 bits."""
    return "(" + expression.render(prefix="p_", power="(1LL << {})", suffix="LL") + ")"


@dataclass(frozen=True)
class Variants:
    """The relevant parameters, and all values that they can have together."""

    device: Device
    names: tuple[str, ...]
    combinations: tuple[Mapping[str, int], ...]
    ranges: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    alternatives: tuple[Alternative, ...] = ()

    @classmethod
    def of_interface(cls, device: Device, interface: str, used: Iterable[str]) -> Variants:
        """Return the parameters of all order codes of an interface, or of all interfaces if it is empty.

        ``used`` names parameters. Parameters from which they follow are added.
        """
        definitions = _definitions(device)
        names = _with_needed(used, definitions)
        of_interface = [variant for variant in device.variants if variant.interface == interface or not interface]
        variants: Sequence[Variant] = of_interface or device.variants
        at_run_time = {parameter.name: parameter for parameter in device.run_time_parameters}
        deciding = [question for question in device.alternatives if not set(names).isdisjoint(question.answers[0].sets)]
        undecided = tuple(question for question in deciding if not question.default)
        answered = {name for question in undecided for name in question.answers[0].sets}
        fixed = [name for name in names if name not in definitions and name not in at_run_time and name not in answered]
        optional = [question for question in deciding if question.default]
        fixed_values = set()
        for variant in variants:
            for _, chosen in answer_combinations(optional):
                values = {**variant.parameters, **chosen}
                fixed_values.add(tuple(values[name] for name in fixed))
        ranges = {}
        for name in names:
            if name in at_run_time:
                parameter = at_run_time[name]
                ranges[name] = (parameter.min or 0, parameter.largest if parameter.max is None else parameter.max)
        combinations = tuple(dict(zip(fixed, values, strict=True)) for values in sorted(fixed_values))
        return cls(device=device, names=tuple(names), combinations=combinations, ranges=ranges, alternatives=undecided)

    def fixed(self, values: Mapping[str, int]) -> Variants:
        """Return the same with these fixed values of the registers at run time."""
        ranges = dict(self.ranges)
        ranges |= {name: (value, value) for name, value in values.items() if name in ranges}
        return replace(self, ranges=ranges)

    @property
    def count(self) -> int:
        """Return the number of sets of parameters that one proof covers."""
        count = len(self.combinations)
        for low, high in self.ranges.values():
            count *= high - low + 1
        for alternative in self.alternatives:
            count *= len(alternative.answers)
        return count

    @property
    def answers(self) -> str:
        """Return the answers as arguments, passed after the variant."""
        return "".join(f"answer_{alternative.name}, " for alternative in self.alternatives)

    def declare(self, prefix: str, header: Header) -> str:
        """Return C that sets ``variant`` and the parameters ``p_…`` to any allowed values.

        Members of the variant that do not matter may have any value.
        """
        definitions = _definitions(self.device)
        lines = "".join(f"static long long p_{name};\n" for name in self.names)
        questions = [alternative.name for alternative in self.alternatives]
        lines += "".join(f"static {prefix}_{name} answer_{name};\n" for name in questions)
        lines += f"""static {prefix} variant;
static void any_variant(void)
{{
    {prefix} anything;
    variant = anything;
"""
        lines += "".join(f"    p_{name} = nondet_number();\n" for name in self.names if name not in definitions)
        if self.combinations and self.combinations[0]:
            choices = " ||\n        ".join(f"({_are_equal(combination)})" for combination in self.combinations)
            lines += f"    __CPROVER_assume({choices});\n"
        for alternative in self.alternatives:
            lines += self._assume_answer(prefix, alternative)
        answered = {name for alternative in self.alternatives for name in alternative.answers[0].sets}
        for name, (low, high) in self.ranges.items():
            lines += f"    __CPROVER_assume(p_{name} >= {low} && p_{name} <= {high});\n"
        for name in self.names:
            equals = definitions.get(name)
            if equals is not None:
                lines += f"    p_{name} = {in_c(equals)};\n"
            elif name not in answered:
                member = header.member(f"{prefix}", name)
                lines += f"    variant.{member.name} = ({member.type})p_{name};\n"
        return lines + "}\n"

    def _assume_answer(self, prefix: str, alternative: Alternative) -> str:
        """Return C that gives an alternative any answer, and the parameters that it sets the answer's values."""
        answer_name = f"answer_{alternative.name}"
        cases = []
        for answer in alternative.answers:
            constant = f"{prefix}_{alternative.name}_{answer.name}".upper()
            sets = [f"p_{name} == {value}" for name, value in answer.sets.items() if name in self.names]
            cases.append(" && ".join([f"{answer_name} == {constant}", *sets]))
        assumed = " || ".join(f"({case})" for case in cases)
        return f"    {answer_name} = ({prefix}_{alternative.name})nondet_number();\n    __CPROVER_assume({assumed});\n"


def _definitions(device: Device) -> dict[str, Expression]:
    """Return the parameters that follow from others, with their expressions."""
    return {parameter.name: parameter.equals for parameter in device.parameters if parameter.equals is not None}


def _with_needed(used: Iterable[str], definitions: Mapping[str, Expression]) -> list[str]:
    """Return these parameters, each after the parameters from which it follows."""
    names: list[str] = []

    def add(name: str) -> None:
        expression = definitions.get(name)
        for needed in expression.parameters if expression is not None else ():
            add(needed)
        if name not in names:
            names.append(name)

    for name in used:
        add(name)
    return names


def _are_equal(values: Mapping[str, int]) -> str:
    return " && ".join(f"p_{name} == {value}" for name, value in values.items())


@dataclass(frozen=True)
class Proof:
    """A function of a harness whose claims must hold, with the number of sets of parameters and their subject.

    If ``reached``, a claim must fail instead, which shows that the other claims are reachable.
    """

    name: str
    harness: str
    function: str
    unwind: int = 66
    options: tuple[str, ...] = ()
    covers: int = 0
    subject: str = ""
    reached: bool = False


@dataclass(frozen=True)
class Result:
    proof: Proof
    proved: bool
    words: str


def limited(command: Sequence[str]) -> list[str]:
    """Return the command with the limit, which applies to it and to each program that it starts."""
    return ["sh", "-c", f'ulimit -c 0; ulimit -t {LIMIT_S}; exec "$@"', "sh", *command]


class ProofCount(NamedTuple):
    """Number of proofs of a subject, number of failures, and number of sets of parameters."""

    subject: str
    proofs: int
    failed: int
    covered: int

    def __str__(self) -> str:
        return f"{self.subject}: {self.proofs} proofs, {self.failed} failed" + (
            f", over {self.covered} sets of parameters" if self.covered else ""
        )


@dataclass(frozen=True)
class Checker:
    cbmc: str
    solver: str

    def prove(self, proof: Proof, include: Path, folder: Path) -> Result:
        """Run one proof on the headers below ``include``."""
        command = [
            self.cbmc,
            "harness.c",
            "--function",
            proof.function,
            "-I",
            str(include),
            "--unwind",
            str(proof.unwind),
        ]
        command += [] if PARTLY in proof.options else ["--unwinding-assertions"]
        command += ["--stop-on-fail", "--slice-formula", "--external-sat-solver", self.solver, *proof.options]
        with tempfile.TemporaryDirectory(dir=folder) as work_folder:
            Path(work_folder, "harness.c").write_text(proof.harness, encoding="utf-8")
            completed = subprocess.run(
                limited(command),
                capture_output=True,
                text=True,
                cwd=work_folder,
                env={**os.environ, "TMPDIR": work_folder},
            )
        holds = completed.returncode == 0 and "VERIFICATION SUCCESSFUL" in completed.stdout
        refuted = (
            completed.returncode == 10
            and "VERIFICATION FAILED" in completed.stdout
            and "unwinding assertion" not in completed.stdout
        )
        proved = refuted if proof.reached else holds
        silent = f"no result, ended with {completed.returncode}; the limit is {LIMIT_S} s of processor time"
        unproved = "never reached" if holds else silent
        why = "REFUTED" if refuted else unproved
        log_lines = (completed.stdout + completed.stderr).splitlines()
        log_lines = log_lines[next((at for at, line in enumerate(log_lines) if line.startswith("Violated")), 0) :]
        return Result(proof, proved, proof.name if proved else f"{proof.name}: {why}\n" + "\n".join(log_lines[-12:]))

    def prove_all(self, proofs: Sequence[tuple[Proof, Path]], folder: Path) -> list[Result]:
        """Run several proofs at once, one per processor, each on the headers below its own path."""
        with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
            return list(pool.map(lambda pair: self.prove(pair[0], pair[1], folder), proofs))
