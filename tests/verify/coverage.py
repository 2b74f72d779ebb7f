"""Which lines and branches of the headers the tests of the C target reach, by the counters of clang.

The tests are run as they are; only ``gcc`` is another program for them, which compiles
what they link with counters in place of sanitizers. A header is known by its bytes, wherever a test has written it.
Counts of all programs are added up: a region or branch counts as reached when one has reached it.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

_SHIM = """#!/bin/sh
link=yes
for item; do
    case "$item" in -c | -S | -E | -fsyntax-only) link=no ;; esac
    [ "$previous" != -o ] || made=$item
    previous=$item
done
[ "$link" = yes ] || exec @gcc@ "$@"
for item; do
    shift
    case "$item" in -fsanitize* | -fno-sanitize* | -W* | -O*) ;; *) set -- "$@" "$item" ;; esac
done
echo "$made" >> "$COVERED_PROGRAMS"
exec @clang@ -w -O0 "-fprofile-instr-generate=$made.%1m.profraw" -fcoverage-mapping "$@"
"""

Place = tuple[str, int, int, int, int]


@dataclass
class Coverage:
    """How often each piece of code was reached, and each condition was true and false; by header, line and column."""

    regions: Counter[Place] = field(default_factory=Counter)
    true: Counter[Place] = field(default_factory=Counter)
    false: Counter[Place] = field(default_factory=Counter)
    functions: dict[Place, str] = field(default_factory=dict)

    def unreached(self) -> Iterable[tuple[Place, str, str]]:
        """Place, function and what is missing."""
        for place in sorted(self.regions):
            if self.regions[place] == 0:
                yield place, self.functions[place], "is not reached"
        for place in sorted(self.true):
            for counts, word in ((self.true, "true"), (self.false, "false")):
                if counts[place] == 0:
                    yield place, self.functions[place], f"is never {word}"


def run_tests(folder: Path, tests: Sequence[str], gcc: str, clang: str, root: Path) -> tuple[int, str]:
    """Runs tests with counters; their programs are listed in ``folder``. Gives pytest's status and what it said."""
    shims = folder / "shims"
    shims.mkdir(parents=True)
    (shims / "gcc").write_text(_SHIM.replace("@gcc@", gcc).replace("@clang@", clang), encoding="utf-8")
    (shims / "gcc").chmod(0o755)
    environment = {
        **os.environ,
        "PATH": f"{shims}{os.pathsep}{os.environ['PATH']}",
        "COVERED_PROGRAMS": str(folder / "programs"),
    }
    environment.pop("LLVM_PROFILE_FILE", None)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", f"--basetemp={folder / 'tests'}", *tests]
    done = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True)
    return done.returncode, done.stdout[-3000:]


def measured(folders: Iterable[Path], headers: Iterable[Path], llvm_profdata: str, llvm_cov: str) -> Coverage:
    """What the programs listed in ``folders`` have counted in these headers."""
    wanted = {_digest(path): path.name for path in headers}
    found = Coverage()
    for program in dict.fromkeys(
        line for folder in folders for line in (folder / "programs").read_text(encoding="utf-8").split("\n")
    ):
        if not program:
            continue
        raw = sorted(str(path) for path in Path(program).parent.glob(f"{Path(program).name}.*.profraw"))
        if raw:
            profile = f"{program}.profdata"
            subprocess.run([llvm_profdata, "merge", "-o", profile, *raw], check=True, capture_output=True)
            done = subprocess.run(
                [llvm_cov, "export", "-format=text", f"-instr-profile={profile}", program],
                check=True,
                capture_output=True,
                text=True,
            )
            _add(found, json.loads(done.stdout)["data"][0]["functions"], wanted, {})
    return found


def _add(
    found: Coverage, functions: Iterable[dict[str, list[list[int]]]], wanted: dict[str, str], known: dict[str, str]
) -> None:
    for function in functions:
        names = [_header(str(path), wanted, known) for path in function["filenames"]]
        shown = str(function["name"]).rpartition(":")[2]
        for line, column, end, last, count, file, _, kind in function["regions"]:
            if names[file] and kind == 0:
                place = names[file], line, column, end, last
                found.regions[place] += count
                found.functions[place] = shown
        for line, column, end, last, true, false, file, _, _ in function["branches"]:
            if names[file]:
                place = names[file], line, column, end, last
                found.true[place] += true
                found.false[place] += false
                found.functions[place] = shown


def _header(path: str, wanted: dict[str, str], known: dict[str, str]) -> str:
    """The header that this file is; empty for all other files."""
    if path not in known:
        known[path] = wanted.get(_digest(Path(path)), "") if path.endswith(".h") and Path(path).is_file() else ""
    return known[path]


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
