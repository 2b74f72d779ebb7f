"""Lines and branches of the headers that the tests of the C target reach, counted by clang.

The tests run unchanged. Only ``gcc`` is replaced by a program that compiles with counters instead of sanitizers. A
header is identified by its bytes, wherever a test has written it. The counts of all programs are added, so a region or
branch counts as reached if any program has reached it.
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
    """Counts of each piece of code, and of true and false for each condition, by header, line and column."""

    regions: Counter[Place] = field(default_factory=Counter)
    true: Counter[Place] = field(default_factory=Counter)
    false: Counter[Place] = field(default_factory=Counter)
    functions: dict[Place, str] = field(default_factory=dict)

    def unreached(self) -> Iterable[tuple[Place, str, str]]:
        """Place, function and missing part."""
        for place in sorted(self.regions):
            if self.regions[place] == 0:
                yield place, self.functions[place], "is not reached"
        for place in sorted(self.true):
            for counts, word in ((self.true, "true"), (self.false, "false")):
                if counts[place] == 0:
                    yield place, self.functions[place], f"is never {word}"


def run_tests(folder: Path, tests: Sequence[str], gcc: str, clang: str, root: Path) -> tuple[int, str]:
    """Run tests with counters. Their programs are listed in ``folder``. Return pytest's exit status and output."""
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
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", f"--basetemp={folder / 'tests'}"]
    # Also the cases that only the longer evidence runs.
    command += ["-m", "", *tests]
    completed = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True)
    return completed.returncode, completed.stdout[-3000:]


def read_coverage(folders: Iterable[Path], headers: Iterable[Path], llvm_profdata: str, llvm_cov: str) -> Coverage:
    """Return the counts of the programs listed in ``folders`` for these headers."""
    expected = {_digest(path): path.name for path in headers}
    coverage = Coverage()
    listed = "\n".join((folder / "programs").read_text(encoding="utf-8") for folder in folders)
    for program in dict.fromkeys(listed.split("\n")):
        if not program:
            continue
        raw = sorted(str(path) for path in Path(program).parent.glob(f"{Path(program).name}.*.profraw"))
        if raw:
            profile = f"{program}.profdata"
            subprocess.run([llvm_profdata, "merge", "-o", profile, *raw], check=True, capture_output=True)
            completed = subprocess.run(
                [llvm_cov, "export", "-format=text", f"-instr-profile={profile}", program],
                check=True,
                capture_output=True,
                text=True,
            )
            _add(coverage, json.loads(completed.stdout)["data"][0]["functions"], expected, {})
    return coverage


def _add(
    coverage: Coverage,
    functions: Iterable[dict[str, list[list[int]]]],
    wanted: dict[str, str],
    headers_by_path: dict[str, str],
) -> None:
    for function in functions:
        header_by_file_index = [_header(str(path), wanted, headers_by_path) for path in function["filenames"]]
        function_name = str(function["name"]).rpartition(":")[2]
        for line, column, last_line, last_column, count, file_index, _, kind in function["regions"]:
            if header_by_file_index[file_index] and kind == 0:
                source_range = header_by_file_index[file_index], line, column, last_line, last_column
                coverage.regions[source_range] += count
                coverage.functions[source_range] = function_name
        for line, column, last_line, last_column, true, false, file_index, _, _ in function["branches"]:
            if header_by_file_index[file_index]:
                source_range = header_by_file_index[file_index], line, column, last_line, last_column
                coverage.true[source_range] += true
                coverage.false[source_range] += false
                coverage.functions[source_range] = function_name


def _header(path: str, wanted: dict[str, str], headers_by_path: dict[str, str]) -> str:
    """Return the header with the content of this file, or an empty string for any other file."""
    if path not in headers_by_path:
        is_header = path.endswith(".h") and Path(path).is_file()
        headers_by_path[path] = wanted.get(_digest(Path(path)), "") if is_header else ""
    return headers_by_path[path]


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
