"""The schema of ``show --json``, which is computed from the table of members."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest
from codewheel.dump.plain import device_dump
from codewheel.dump.schema import main, schema_of_device_data
from codewheel.model import Device


def test_the_schema_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    assert json.loads(capsys.readouterr().out) == schema_of_device_data()


def test_the_schema_is_written_and_accepts_a_family(tmp_path: Path, amm5: Device) -> None:
    file = tmp_path / "show.schema.json"
    assert main([str(file)]) == 0
    schema = json.loads(file.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    checker = jsonschema.Draft202012Validator(schema)
    dump = json.loads(json.dumps(device_dump(amm5)))
    assert checker.is_valid(dump)
    assert not checker.is_valid(dump | {"more": 1})


@pytest.mark.parametrize("arguments", [["one", "two"], ["--help"]])
def test_other_arguments_are_refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    assert capsys.readouterr().err == "usage: python -m codewheel.dump.schema [FILE]\n"
