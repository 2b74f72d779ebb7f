"""A misspelt part of a spec is one problem: rules about the missing part stay silent."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from codewheel.commands.new import device_text
from codewheel.language.check import check_document
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document

#: Parts to which the rest of a spec refers by name, so that more is reported. The measurement names the position.
REFERRED = {"parameters", "crcs", "interfaces", "registers", "field_groups"}
TEXTS = {like: device_text("my_encoder", "example", "d.json", like) for like in ("", "spi", "rs485")}
PARTS = [
    (like, part)
    for like, text in TEXTS.items()
    for part in re.findall(r"^(?:  (?=biss:|spi:|rs485:))?([a-z0-9_]+):", text, re.MULTILINE)
    if part not in REFERRED and (like, part) != ("spi", "measurement")
]


def test_all_templates_have_parts() -> None:
    assert {("", "biss"), ("spi", "spi"), ("rs485", "rs485"), ("", "procedures"), ("spi", "order_code")} <= {*PARTS}


@pytest.mark.parametrize(("like", "part"), PARTS)
def test_a_misspelt_part_is_one_problem(tmp_path: Path, like: str, part: str) -> None:
    misspelt = f"{part[:-1]}x"
    text = re.sub(rf"^( *){part}:", rf"\1{misspelt}:", TEXTS[like], count=1, flags=re.MULTILINE)
    (tmp_path / "my_encoder.yaml").write_text(text, encoding="utf-8")
    report = ProblemReport()
    document = read_document(tmp_path / "my_encoder.yaml", report, "my_encoder.yaml")
    if document is not None:
        check_document(document, report)
    ((rule, message),) = [(problem.rule, problem.message) for problem in report.problems]
    assert rule in ("unknown-key", "missing-key")
    assert misspelt in message
