"""``codewheel show`` lists the fields of a register for a family as well as for an order code."""

from __future__ import annotations

import pytest
from codewheel.commands.cli import main


@pytest.mark.parametrize("subject", ["as5047p", "AS5047P"])
def test_fields_of_registers_are_shown(subject: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", subject]) == 0
    registers = capsys.readouterr().out.partition("\nRegisters\n")[2]
    assert "    bit 2 " in registers
