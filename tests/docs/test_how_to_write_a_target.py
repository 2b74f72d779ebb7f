"""The target on the page, installed as its user would install it."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/extend/how-to-write-a-target.md").read_text(encoding="utf-8")
BLOCKS = dict(re.findall(r"^`([^`\n]+)` .*?:\n\n```\w+\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE))


@pytest.fixture(scope="module")
def site(made_once: Callable[[str, Callable[[Path], object]], Path]) -> Path:
    """Return the folder where the package is installed."""
    return made_once("plc", installed) / "site"


def installed(folder: Path) -> None:
    assert set(BLOCKS) == {"pyproject.toml", "codewheel_plc/__init__.py", "codewheel_plc/templates/table.csv.jinja"}
    for name, text in BLOCKS.items():
        (folder / "source" / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / "source" / name).write_text(text, encoding="utf-8")
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"]
    completed = subprocess.run(
        [*command, "--target", str(folder / "site"), str(folder / "source")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert completed.returncode == 0, completed.stdout + completed.stderr


def run(site: Path, cwd: Path, *arguments: str, module: str = "codewheel") -> tuple[int, str, str]:
    completed = subprocess.run(
        [sys.executable, "-m", module, *arguments],
        cwd=cwd,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(site)},
    )
    return completed.returncode, completed.stdout, completed.stderr


def test_its_commands(site: Path, tmp_path: Path) -> None:
    assert run(site, tmp_path, "new", "my_encoder")[0] == 0
    block = re.search(r"^```\n(codewheel .*?)^```", PAGE, re.DOTALL | re.MULTILINE)
    assert block is not None
    for line in block[1].splitlines():
        code, _, err = run(site, tmp_path, *shlex.split(line)[1:])
        assert (code, err) == (0, ""), line
    table = (tmp_path / "generated/plc/my_encoder.csv").read_text(encoding="utf-8").splitlines()
    assert '"preset";80;4' in table
    assert all(line.count(";") == 2 for line in table)
    assert run(site, tmp_path, "generate", "my_encoder.yaml", "--target", "plc")[0] == 0
    assert '"preset",80,4' in (tmp_path / "generated/plc/my_encoder.csv").read_text(encoding="utf-8")
    assert not (tmp_path / "generated/c").exists()


def test_help_and_wrong_options(site: Path, tmp_path: Path) -> None:
    help_text = " ".join(run(site, tmp_path, "generate", "--help")[1].split())
    assert "plc tables of registers for a PLC --option plc.separator=comma|semicolon: separator" in help_text
    code, _, err = run(
        site, tmp_path, "generate", "--packaged", "icmu", "--target", "plc", "--option", "plc.separator=tab"
    )
    assert (code, err) == (2, "codewheel: 'plc.separator' cannot be 'tab'; it can be: comma, semicolon\n")


def test_its_problems(site: Path) -> None:
    spec_lines = (ROOT / "specs/lika/sma21.yaml").read_text(encoding="utf-8").splitlines()
    name_index = next(index for index, line in enumerate(spec_lines) if "name: device_id" in line)
    length_index = next(index for index in range(name_index, len(spec_lines)) if "length: 6" in spec_lines[index])
    column = spec_lines[length_index].index("length: 6") + len("length: ") + 1
    place = f"specs/lika/sma21.yaml:{length_index + 1}:{column}"
    code, printed, _ = run(site, ROOT, "check", "specs/lika/sma21.yaml", "--target", "plc")
    assert code == 1
    assert f"{place}: plc-length: 'device_id' has 6 bytes, and a number of the PLC has 4\n" in printed


@pytest.mark.exhaustive
def test_templates_of_its_user(site: Path, tmp_path: Path) -> None:
    assert run(site, tmp_path, "new", "my_encoder")[0] == 0
    own_templates = tmp_path / "house/plc"
    own_templates.mkdir(parents=True)
    template = own_templates / "table.csv.jinja"
    command = ("generate", "my_encoder.yaml", "--target", "plc", "--templates", "house")
    template.write_text('name{{ separator }}address{{ separator }}length\n{% include "shipped/table.csv.jinja" %}')
    assert run(site, tmp_path, *command)[0] == 0
    table = (tmp_path / "generated/plc/my_encoder.csv").read_text(encoding="utf-8")
    assert table.startswith("name,address,length\n")
    assert '"preset",80,4\n' in table
    template.write_text("first\n{{ sepaator }}")
    message = "codewheel: house/plc/table.csv.jinja:2: 'sepaator' is undefined\n"
    assert run(site, tmp_path, *command)[2] == message
    template.rename(own_templates / "tables.csv.jinja")
    code, _, err = run(site, tmp_path, *command)
    assert code == 2
    assert "no output uses house/plc/tables.csv.jinja; did you mean 'plc/table.csv.jinja'?\n" in err
    assert run(site, tmp_path, "generate", "my_encoder.yaml", "--target", "c", "--templates", "house")[0] == 0


@pytest.mark.exhaustive
def test_its_own_tests(site: Path, tmp_path: Path) -> None:
    tests = re.findall(r"^```python\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)[-1]
    (tmp_path / "test_plc.py").write_text(tests, encoding="utf-8")
    code, out, err = run(site, tmp_path, "-q", "-p", "no:cacheprovider", "test_plc.py", module="pytest")
    assert code == 0, out + err
    assert "1 passed" in out
