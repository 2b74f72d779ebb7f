"""Chromium without a window, controlled over a pipe with its DevTools protocol."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

#: The name under which it is installed.
CHROMIUM = next(filter(shutil.which, ("chromium", "chromium-browser", "google-chrome")), "chromium")
#: Addresses that a page may request.
_OWN = ("file://", "data:", "about:")
_FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--remote-debugging-pipe",
    "--no-first-run",
    "--disable-background-networking",
)


def _started(command: Sequence[str]) -> tuple[subprocess.Popen[bytes], int, int]:
    """The browser, with the pipes to write to and to read from."""
    to_browser, write = os.pipe()
    read, from_browser = os.pipe()
    # Chromium reads from 3 and writes to 4, whatever these are in this process.
    source, target = (fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (to_browser, from_browser))
    placed = ["bash", "-c", f'exec 3<&{source} 4>&{target} {source}<&- {target}>&-; exec "$@"', "bash", *command]
    nothing = subprocess.DEVNULL
    started = subprocess.Popen(placed, pass_fds=(source, target), stdout=nothing, stderr=nothing)
    for end in (to_browser, from_browser, source, target):
        os.close(end)
    return started, write, read


class Browser:
    """One page of one browser. ``complaints`` lists the errors of its console and requests since the last ``open``."""

    def __init__(self, profile: Path) -> None:
        self._process, self._write, answers = _started([CHROMIUM, *_FLAGS, f"--user-data-dir={profile}"])
        self._input = os.fdopen(answers, "rb")
        self._buffer, self._count, self._session = b"", 0, ""
        self.complaints: list[str] = []
        self._loaded = False
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")

    def __enter__(self) -> Browser:
        return self

    def __exit__(
        self, _kind: type[BaseException] | None, _error: BaseException | None, _at: TracebackType | None
    ) -> None:
        self._session = ""
        self.call("Browser.close")
        self._process.wait(timeout=20)
        os.close(self._write)
        self._input.close()

    def call(self, method: str, **parameters: Any) -> Any:
        """Return the browser's answer to a command of the protocol."""
        self._count += 1
        message: dict[str, Any] = {"id": self._count, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self._count:
                assert "error" not in answer, f"{method}: {answer['error']}"
                return answer["result"]
            self._hear(answer)

    def look(self, width: int, dark: bool = False, height: int = 900) -> None:
        """Set the width of the window, and the reader's preferences."""
        self.call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600
        )
        preferred = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[preferred])

    def open(self, url: str) -> None:
        """Open a page and wait until it is loaded."""
        self.complaints.clear()
        self.call("Page.navigate", url=url)
        self.wait()

    def wait(self) -> None:
        """Wait until the page is loaded."""
        while not self._loaded:
            self._hear(self._next())
        self._loaded = False

    def run(self, script: str) -> Any:
        """Return the value of a JavaScript expression in the page. Wait if it is a promise."""
        done = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in done, done["exceptionDetails"]
        return done["result"].get("value")

    def _next(self) -> Mapping[str, Any]:
        while b"\0" not in self._buffer:
            piece = self._input.read1(1 << 20)
            assert piece, "the browser has gone"
            self._buffer += piece
        message, _, self._buffer = self._buffer.partition(b"\0")
        decoded: Mapping[str, Any] = json.loads(message)
        return decoded

    def _hear(self, event: Mapping[str, Any]) -> None:
        parameters = event.get("params", {})
        match event.get("method"):
            case "Page.loadEventFired":
                self._loaded = True
            case "Network.requestWillBeSent" if not parameters["request"]["url"].startswith(_OWN):
                self.complaints.append(f"asks for {parameters['request']['url']}")
            case "Network.loadingFailed":
                self.complaints.append(f"a request failed: {parameters['errorText']}")
            case "Runtime.exceptionThrown":
                details = parameters["exceptionDetails"]
                self.complaints.append(details.get("exception", {}).get("description", details["text"]))
            case "Runtime.consoleAPICalled" if parameters["type"] in ("error", "warning"):
                self.complaints.append(f"console: {parameters['args']}")
            case "Log.entryAdded" if parameters["entry"]["level"] in ("error", "warning"):
                self.complaints.append(f"log: {parameters['entry']['text']}")
