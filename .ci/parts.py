"""Run lint, the tests and each part of the longer evidence, two parts at a time, and count what did not run.

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
        self.counts = Counter[str]()
        self.lock = threading.Lock()

    def read(self, part: str, line: str) -> None:
        """Take skipped tests and the closing counts from a line that pytest has written."""
        skipped = re.match(r"SKIPPED \[(\d+)\] (.*)", line)
        if skipped and not KNOWN.search(skipped[2]):
            self.not_run.append(f"{skipped[1]} skipped in make {part}: {skipped[2]}")
        if re.match(r"(=+ )?\d+ \w+(, \d+ \w+)* in [\d.]+s", line):
            self.counts.update({word: int(number) for number, word in re.findall(r"(\d+) ([a-z]+)", line)})

    def close(self, allow_missing: bool) -> int:
        """Print the failed parts and those that did not run, and return the exit code."""
        for title, lines in (("FAILED", self.failed), ("DID NOT RUN", self.not_run)):
            if lines:
                print(f"\n{title}: {len(lines)}", *lines, sep="\n  ")
        print(f"\n{self.counts['passed']} passed, {self.counts['failed']} failed, {self.counts['skipped']} skipped")
        return 1 if self.failed else 2 if self.not_run and not allow_missing else 0


def run(part: str, seconds: float, lines: list[str]) -> int | None:
    """Make a part, collect its output, and return its exit code, or None if it was killed after this many seconds."""
    made = subprocess.Popen(
        ["make", part],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    reader = threading.Thread(target=lines.extend, args=(made.stdout,), daemon=True)
    reader.start()
    try:
        return made.wait(seconds)
    except subprocess.TimeoutExpired:
        os.killpg(made.pid, signal.SIGKILL)
        made.wait()
        return None
    finally:
        reader.join(10)  # A program that left the group may keep the pipe open.


def parts() -> list[str]:
    """List the parts of ``make verify``. Each commit starts with another one, so that none is always the last."""
    files = Path("tests/verify").glob("test_*.py")
    found = sorted({re.sub("python_.*", "python", path.stem.removeprefix("test_")) for path in files})
    done = subprocess.run(["git", "rev-list", "--count", "HEAD"], capture_output=True, text=True)
    first = int(done.stdout or 0) % len(found)
    return [f"verify-{name}" for name in found[first:] + found[:first]]


def take(part: str, deadline: float, log: Log) -> None:
    """Run a part if there is time for it, then print its output and record its result."""
    begun, lines = time.time(), list[str]()
    enough = deadline - begun >= LEAST
    with log.lock:
        print(f"== make {part}", flush=True)
    code = run(part, deadline - begun, lines) if enough else None
    with log.lock:
        for line in lines:
            print(line, end="")
            log.read(part, line)
        print(f"== make {part}: {time.time() - begun:.0f} s", flush=True)
        if code is None:
            log.not_run.append(f"make {part}: {'ended at the deadline' if enough else 'no time left'}")
        elif code != 0:
            log.failed.append(f"make {part}")


def main() -> int:
    parser = argparse.ArgumentParser(prog=".ci/run", description=__doc__)
    parser.add_argument("--allow-missing", action="store_true", help="accept what did not run")
    parser.add_argument("--started", type=float, default=time.time(), help=argparse.SUPPRESS)
    parser.add_argument("--missing", default="", help=argparse.SUPPRESS)
    given = parser.parse_args()
    os.environ.update(SIZES | os.environ)
    log = Log([name for name in given.missing.split(",") if name])
    deadline = given.started + DEADLINE
    for part in ("lint", "test"):
        take(part, deadline, log)
    os.environ["PYTEST_XDIST_AUTO_NUM_WORKERS"] = str(max(1, (os.cpu_count() or 1) // LANES))
    with ThreadPoolExecutor(LANES) as lanes:
        list(lanes.map(lambda part: take(part, deadline, log), parts()))
    return log.close(given.allow_missing or bool(os.environ.get("CODEWHEEL_ALLOW_MISSING")))


if __name__ == "__main__":
    sys.exit(main())
