"""Run lint, the README's commands in a clone, and each part of the longer evidence. Count what did not run.

The clone has no environment, so its ``make`` sets one up as on a user's machine. Files with tests that were skipped
there, for example because an optional package is missing, run again here, with the locked packages.

Exit codes: 0 if all ran and passed, 1 if something failed, 2 if something did not run. ``--allow-missing`` or
``CODEWHEEL_ALLOW_MISSING`` turns 2 into 0. The last line has the sum of pytest's own counts.
"""

from __future__ import annotations

import argparse
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

#: Seconds from the start to the last moment of a part, and the least that a part is started with.
DEADLINE, LEAST = 88 * 60, 60
#: Parts at a time. Most have a few long tests, and while the last of them runs, the other processors would wait.
LANES = 2
#: Frames of each layout, and seconds of each fuzzer. By themselves, the parts take up to a million, and 20 s.
SIZES = {"CODEWHEEL_FRAMES": "10000", "CODEWHEEL_FUZZ_SECONDS": "5"}
#: Reasons for which a test is skipped on a complete Debian 12.
KNOWN = re.compile(r"no Python 3\.\d+ here|root may read everything")


class Log:
    """Record of the parts that ran and of those that did not."""

    def __init__(self, missing: list[str]) -> None:
        self.failed = list[str]()
        self.not_run = [f"not installed: {name}" for name in missing]
        #: Files with tests that were skipped in the clone.
        self.skipped_files = set[str]()
        self.counts = Counter[str]()
        self.lock = threading.Lock()

    def read(self, command: str, line: str, in_clone: bool) -> None:
        """Take skipped tests and the closing counts from a line that pytest has written."""
        skipped = re.match(r"SKIPPED \[(\d+)\] (.*)", line)
        if skipped and not KNOWN.search(skipped[2]):
            file = re.match(r"tests/(?:\w+/)*test_\w+\.py", skipped[2])
            if in_clone and file:
                self.skipped_files.add(file[0])
            else:
                self.not_run.append(f"{skipped[1]} skipped in {command}: {skipped[2]}")
        if re.match(r"(=+ )?\d+ \w+(, \d+ \w+)* in [\d.]+s", line):
            self.counts.update({word: int(number) for number, word in re.findall(r"(\d+) ([a-z]+)", line)})

    def close(self, allow_missing: bool) -> int:
        """Print the failed parts and those that did not run, and return the exit code."""
        for title, lines in (("FAILED", self.failed), ("DID NOT RUN", self.not_run)):
            if lines:
                print(f"\n{title}: {len(lines)}", *lines, sep="\n  ")
        print(f"\n{self.counts['passed']} passed, {self.counts['failed']} failed, {self.counts['skipped']} skipped")
        if self.failed:
            return 1
        return 2 if self.not_run and not allow_missing else 0


def readme_commands() -> list[str]:
    """Return the commands with ``make`` that the README prints, in its order."""
    blocks = re.findall(r"^```\w*\n(.*?)^```", Path("README.md").read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    return [line for block in blocks for line in block.splitlines() if line.startswith("make ")]


def clone(folder: str) -> bool:
    """Clone the last commit into a folder. Return whether that was possible."""
    with tempfile.NamedTemporaryFile("w", suffix=".gitconfig") as settings:
        # The checkout may belong to another user, as in a container.
        settings.write("[safe]\n\tdirectory = *\n")
        settings.flush()
        variables = {**os.environ, "GIT_CONFIG_GLOBAL": settings.name}
        return subprocess.run(["git", "clone", "--quiet", ".", folder], env=variables, check=False).returncode == 0


def run(command: str, seconds: float, lines: list[str], folder: str = ".") -> int | None:
    """Run a command, collect its output, and return its exit code, or None if it was killed after this many seconds.

    In another folder than this one, the packages are not the locked ones.
    """
    variables = dict(os.environ)
    if folder != ".":
        variables.pop("CODEWHEEL_LOCKED", None)
    process = subprocess.Popen(
        ["sh", "-c", command],
        cwd=folder,
        env=variables,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    reader = threading.Thread(target=lines.extend, args=(process.stdout,), daemon=True)
    reader.start()
    try:
        return process.wait(seconds)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return None
    finally:
        reader.join(10)  # A program that left the group may keep the pipe open.


def case_parts() -> set[str]:
    """Return the parts without a file of their own: the cases that ``make test`` leaves out, by subject."""
    makefile = Path("Makefile")
    text = makefile.read_text(encoding="utf-8") if makefile.exists() else ""
    return {f"cases_{subject}" for subject in re.findall(r"^CASES_(\w+) =", text, re.MULTILINE)}


def parts() -> list[str]:
    """List the parts of ``make verify``. Each commit starts with another one, so that none is always the last."""
    files = Path("tests/verify").glob("test_*.py")
    file_parts = {re.sub("python_.*", "python", path.stem.removeprefix("test_")) for path in files}
    names = sorted(file_parts | case_parts())
    completed = subprocess.run(["git", "rev-list", "--count", "HEAD"], capture_output=True, text=True)
    first = int(completed.stdout or 0) % len(names)
    return [f"make verify-{name}" for name in names[first:] + names[:first]]


def take(command: str, deadline: float, log: Log, folder: str = ".") -> None:
    """Run a command if there is time for it, then print its output and record its result."""
    begun, lines = time.time(), list[str]()
    enough = deadline - begun >= LEAST
    with log.lock:
        print(f"== {command}", flush=True)
    code = run(command, deadline - begun, lines, folder) if enough else None
    with log.lock:
        for line in lines:
            print(line, end="")
            log.read(command, line, folder != ".")
        print(f"== {command}: {time.time() - begun:.0f} s", flush=True)
        if code is None:
            log.not_run.append(f"{command}: {'ended at the deadline' if enough else 'no time left'}")
        elif code != 0:
            log.failed.append(command)


def take_readme(deadline: float, log: Log) -> None:
    """Run the commands of the README in a clone without an environment, and the tests that it skipped here."""
    with tempfile.TemporaryDirectory() as folder:
        if not clone(folder):
            log.failed.append("git clone")
            return
        for command in readme_commands():
            take(command, deadline, log, folder)
    if log.skipped_files:
        take(f"make test TESTS='{' '.join(sorted(log.skipped_files))}'", deadline, log)


def main() -> int:
    parser = argparse.ArgumentParser(prog=".ci/run", description=__doc__)
    parser.add_argument("--allow-missing", action="store_true", help="accept what did not run")
    parser.add_argument("--started", type=float, default=time.time(), help=argparse.SUPPRESS)
    parser.add_argument("--missing", default="", help=argparse.SUPPRESS)
    options = parser.parse_args()
    os.environ.update(SIZES | os.environ)
    log = Log([name for name in options.missing.split(",") if name])
    deadline = options.started + DEADLINE
    take("make lint", deadline, log)
    take_readme(deadline, log)
    os.environ["PYTEST_XDIST_AUTO_NUM_WORKERS"] = str(max(1, (os.cpu_count() or 1) // LANES))
    with ThreadPoolExecutor(LANES) as lanes:
        list(lanes.map(lambda command: take(command, deadline, log), parts()))
    return log.close(options.allow_missing or bool(os.environ.get("CODEWHEEL_ALLOW_MISSING")))


if __name__ == "__main__":
    sys.exit(main())
