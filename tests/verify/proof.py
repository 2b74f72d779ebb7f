"""Requirements of a proof by CBMC: the header as text, the parameters of all order codes, and the run.

CBMC is a model checker. A harness is a C file whose functions claim something about arbitrary values with
``__CPROVER_assert``. The parameters of the variant are also arbitrary, but restricted to those of the order codes and
to the possible contents of registers, so that one proof covers all of them.
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

from codewheel.model import Alternative, Device, Variant, choices
from codewheel.model.expressions import Expression

#: All kinds of undefined behaviour that the checker knows, except overflow of floating point.
UNDEFINED = (
    "--bounds-check --pointer-check --pointer-overflow-check --pointer-primitive-check"
    " --signed-overflow-check --undefined-shift-check --div-by-zero-check"
).split()
#: For a loop that carries only an arbitrary index from one round to the next:
#: a few rounds from any start cover all of them.
PARTLY = "--no-unwinding-assertions"
#: Seconds of processor time, far above those of any proof here. A run that does not end is not a proof.
#: The load of the machine does not matter.
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
    def read(cls, *texts: str) -> Header:
        text = re.sub(r"/\*.*?\*/", "", "\n".join(texts), flags=re.DOTALL)
        options = tuple(
            dict.fromkeys(item for item in re.findall(r"^#ifdef (\w+)$", text, re.MULTILINE) if item != "__cplusplus")
        )
        # Without any of the macros that a header checks.
        text = re.sub(
            r"^#ifdef \w+\n(.*?)(?:^#else\n(.*?))?^#endif\n",
            lambda found: found[2] or "",
            text,
            flags=re.DOTALL | re.MULTILINE,
        )
        functions = {}
        for found in re.finditer(
            r"^static inline ([^;{}]*?)(\w+)\(([^{}]*?)\)\n\{\n(.*?)^\}", text, re.DOTALL | re.MULTILINE
        ):
            given = " ".join(found[3].split())
            arguments = [
                re.fullmatch(r"(.*?)(\w+)", item.strip()) for item in given.split(",") if item.strip() != "void"
            ]
            pairs = tuple((item[1].strip(), item[2]) for item in arguments if item)
            functions[found[2]] = Function(found[2], " ".join(found[1].split()), pairs, found[4])
        structs = {
            found[1]: tuple(
                Member(item[1].strip(), item[2], int(item[3] or 0))
                for item in re.finditer(r"([\w ]+[ *])(\w+)(?:\[(\d+)\])?;", found[2])
            )
            for found in re.finditer(r"^typedef struct (\w+) \{\n(.*?)^\} \1;", text, re.DOTALL | re.MULTILINE)
        }
        return cls(functions, structs, options)

    def member(self, struct: str, name: str) -> Member:
        """Return the member for a name of the spec. A reserved word has a trailing underscore."""
        return next(item for item in self.structs[struct] if item.name in (name, name + "_"))

    def anything(self, struct: str, name: str) -> str:
        """Return lines that declare a struct in which every member can have any value of its type."""
        lines = f"    {struct} {name};\n"
        for item in self.structs.get(struct, ()):
            if item.type in ("bool", "_Bool") and not item.count:
                lines += f"    {name}.{item.name} = nondet_bool();\n"
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
    """Return an expression over parameters as in the reference: plain signed numbers of 64 bits."""
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
    def of(cls, device: Device, interface: str, used: Iterable[str]) -> Variants:
        """Return those of all order codes of an interface, or of all interfaces if it is empty.

        ``used`` names parameters. Those from which they follow are added.
        """
        definitions = {item.name: item.equals for item in device.parameters if item.equals is not None}
        names: list[str] = []

        def add(name: str) -> None:
            expression = definitions.get(name)
            for other in expression.parameters if expression is not None else ():
                add(other)
            if name not in names:
                names.append(name)

        for name in used:
            add(name)
        variants: Sequence[Variant] = [
            item for item in device.variants if item.interface == interface or not interface
        ] or device.variants
        held = {item.name: item for item in device.run_time_parameters}
        answered_by = [item for item in device.alternatives if not set(names).isdisjoint(item.answers[0].sets)]
        asked = tuple(item for item in answered_by if not item.default)
        answered = {name for item in asked for name in item.answers[0].sets}
        fixed = [item for item in names if item not in definitions and item not in held and item not in answered]
        optional = [item for item in answered_by if item.default]
        found = {
            tuple({**item.parameters, **chosen}[name] for name in fixed)
            for item in variants
            for _, chosen in choices(optional)
        }
        ranges = {
            name: (held[name].min or 0, held[name].largest if (most := held[name].max) is None else most)
            for name in names
            if name in held
        }
        combinations = tuple(dict(zip(fixed, item, strict=True)) for item in sorted(found))
        return cls(device, tuple(names), combinations, ranges, asked)

    def fixed(self, values: Mapping[str, int]) -> Variants:
        """Return the same with these fixed values of the registers at run time."""
        return replace(
            self,
            ranges={
                name: (values[name], values[name]) if name in values else both for name, both in self.ranges.items()
            },
        )

    @property
    def count(self) -> int:
        """Return the number of sets of parameters that one proof covers."""
        count = len(self.combinations)
        for low, high in self.ranges.values():
            count *= high - low + 1
        for item in self.alternatives:
            count *= len(item.answers)
        return count

    @property
    def answers(self) -> str:
        """Return the answers as arguments, passed after the variant."""
        return "".join(f"answer_{item.name}, " for item in self.alternatives)

    def declare(self, prefix: str, header: Header) -> str:
        """Return C that gives ``variant`` and the parameters ``p_…`` any allowed values.

        Members of the variant that do not matter may have any value.
        """
        definitions = {item.name: item.equals for item in self.device.parameters if item.equals is not None}
        lines = "".join(f"static long long p_{name};\n" for name in self.names)
        lines += "".join(f"static {prefix}_{item.name} answer_{item.name};\n" for item in self.alternatives)
        lines += f"""static {prefix} variant;
static void any_variant(void)
{{
    {prefix} anything;
    variant = anything;
"""
        lines += "".join(f"    p_{name} = nondet_number();\n" for name in self.names if name not in definitions)
        if self.combinations and self.combinations[0]:
            sets = (" && ".join(f"p_{name} == {value}" for name, value in item.items()) for item in self.combinations)
            choices = " ||\n        ".join(f"({item})" for item in sets)
            lines += f"    __CPROVER_assume({choices});\n"
        for item in self.alternatives:
            lines += f"    answer_{item.name} = ({prefix}_{item.name})nondet_number();\n"
            cases = (
                " && ".join(
                    [f"answer_{item.name} == {prefix.upper()}_{item.name.upper()}_{answer.name.upper()}"]
                    + [f"p_{name} == {value}" for name, value in answer.sets.items() if name in self.names]
                )
                for answer in item.answers
            )
            lines += f"    __CPROVER_assume({' || '.join(f'({case})' for case in cases)});\n"
        answered = {name for item in self.alternatives for name in item.answers[0].sets}
        lines += "".join(
            f"    __CPROVER_assume(p_{name} >= {low} && p_{name} <= {high});\n"
            for name, (low, high) in self.ranges.items()
        )
        for name in self.names:
            equals = definitions.get(name)
            if equals is not None:
                lines += f"    p_{name} = {in_c(equals)};\n"
            elif name not in answered:
                member = header.member(f"{prefix}", name)
                lines += f"    variant.{member.name} = ({member.type})p_{name};\n"
        return lines + "}\n"


@dataclass(frozen=True)
class Proof:
    """A function of a harness whose claims must hold, with the number of sets of parameters and their subject.

    If ``reached``, a claim must fail instead, which shows that the other claims are reachable.
    """

    name: str
    harness: str
    entry: str
    unwind: int = 66
    options: tuple[str, ...] = ()
    covers: int = 0
    of: str = ""
    reached: bool = False


@dataclass(frozen=True)
class Result:
    proof: Proof
    proved: bool
    words: str


def limited(command: Sequence[str]) -> list[str]:
    """Return the command with the limit, which applies to it and to each program that it starts."""
    return ["sh", "-c", f'ulimit -c 0; ulimit -t {LIMIT_S}; exec "$@"', "sh", *command]


class Told(NamedTuple):
    """Number of proofs of a subject, number of failures, and number of sets of parameters."""

    what: str
    proofs: int
    failed: int
    covered: int

    def __str__(self) -> str:
        return f"{self.what}: {self.proofs} proofs, {self.failed} failed" + (
            f", over {self.covered} sets of parameters" if self.covered else ""
        )


@dataclass(frozen=True)
class Checker:
    cbmc: str
    solver: str

    def prove(self, proof: Proof, include: Path, folder: Path) -> Result:
        """Run one proof on the headers below ``include``."""
        command = [self.cbmc, "harness.c", "--function", proof.entry, "-I", str(include), "--unwind", str(proof.unwind)]
        command += [] if PARTLY in proof.options else ["--unwinding-assertions"]
        command += ["--stop-on-fail", "--slice-formula", "--external-sat-solver", self.solver, *proof.options]
        with tempfile.TemporaryDirectory(dir=folder) as own:
            Path(own, "harness.c").write_text(proof.harness, encoding="utf-8")
            done = subprocess.run(
                limited(command), capture_output=True, text=True, cwd=own, env={**os.environ, "TMPDIR": own}
            )
        holds = done.returncode == 0 and "VERIFICATION SUCCESSFUL" in done.stdout
        refuted = (
            done.returncode == 10 and "VERIFICATION FAILED" in done.stdout and "unwinding assertion" not in done.stdout
        )
        proved = refuted if proof.reached else holds
        silent = f"no result, ended with {done.returncode}; the limit is {LIMIT_S} s of processor time"
        why = "REFUTED" if refuted else "never reached" if holds else silent
        told = (done.stdout + done.stderr).splitlines()
        told = told[next((at for at, line in enumerate(told) if line.startswith("Violated")), 0) :]
        return Result(proof, proved, proof.name if proved else f"{proof.name}: {why}\n" + "\n".join(told[-12:]))

    def prove_all(self, proofs: Sequence[tuple[Proof, Path]], folder: Path) -> list[Result]:
        """Run several proofs at once, one per processor, each on the headers below its own path."""
        with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
            return list(pool.map(lambda both: self.prove(both[0], both[1], folder), proofs))
