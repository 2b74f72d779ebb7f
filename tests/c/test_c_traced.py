"""Each header names the version of the runtime and the hash of the content of its spec."""

from __future__ import annotations

import re
from pathlib import Path

from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.c.files import generate
from codewheel.targets.c.header_text import runtime_version

SPECS = Path(__file__).resolve().parents[1] / "specs"
TRACED = re.compile(r"Runtime (\d+)\.(\d+)\. Spec (\w+), content hash ([0-9a-f]{8})\.")


def device_of(folder: Path, spec: str) -> Device:
    for manufacturer in SPECS.glob("*.yaml"):
        if "device:" not in manufacturer.read_text(encoding="utf-8"):
            (folder / manufacturer.name).write_text(manufacturer.read_text(encoding="utf-8"), encoding="utf-8")
    (folder / "bits22.yaml").write_text(spec, encoding="utf-8")
    devices, report = load_library([folder / "bits22.yaml"])
    assert not report.problems
    return devices[0]


def test_only_the_content_of_a_spec_changes_its_hash(tmp_path: Path) -> None:
    spec = (SPECS / "bits22.yaml").read_text(encoding="utf-8")
    same = device_of(tmp_path, spec).content_hash
    assert device_of(tmp_path, f"# A comment.\n{spec}\n# Another one.\n").content_hash == same
    changed = re.sub(r"(title: )(.*)", r"\1Other", spec, count=1)
    assert changed != spec
    assert device_of(tmp_path, changed).content_hash != same


def test_each_header_names_runtime_and_spec(tmp_path: Path) -> None:
    device = device_of(tmp_path, (SPECS / "bits22.yaml").read_text(encoding="utf-8"))
    expected = (*map(str, runtime_version()), "bits22", device.content_hash)
    for options in ({}, {"form": "single"}, {"only": "T22SC"}):
        files = generate(Library((device,)), options)
        headers = [path for path in files if (path.endswith((".h", ".hpp")) and "/bits22" in path) or "t22sc" in path]
        assert headers
        for path in headers:
            if "selftest" not in path:
                assert TRACED.findall(files[path]) == [expected], path
