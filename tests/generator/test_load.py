"""Loading of manufacturers and several families."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.commands.outputs import load_for_targets, targets_named

MINIMAL = (Path(__file__).parents[1] / "check" / "ok" / "minimal.yaml").read_text()
MAKER = 'codewheel: 1\nmanufacturer: acme\ntitle: Acme\nsource: "1"\n'


def problem_texts(folder: Path, **files: str) -> list[str]:
    for name, text in files.items():
        (folder / f"{name}.yaml").write_text(text)
    problems = load_for_targets([folder], targets_named())[1].problems
    return [f"{Path(problem.file).name}:{problem.line}: {problem.rule}: {problem.message}" for problem in problems]


def test_a_manufacturer_file_beside_the_device_is_found(tmp_path: Path) -> None:
    (tmp_path / "manufacturer.yaml").write_text(MAKER)
    (tmp_path / "minimal.yaml").write_text(MINIMAL)
    devices, report = load_for_targets([tmp_path / "minimal.yaml"], targets_named())
    assert not report
    assert [device.manufacturer.title for device in devices] == ["Acme"]


def test_a_missing_manufacturer_file(tmp_path: Path) -> None:
    assert problem_texts(tmp_path, minimal=MINIMAL) == [
        "minimal.yaml:3: undefined-reference: there is no manufacturer file for 'acme'"
    ]


def test_a_broken_manufacturer_file_is_told_once(tmp_path: Path) -> None:
    assert problem_texts(tmp_path, minimal=MINIMAL, manufacturer=MAKER.replace("title: Acme\n", "")) == [
        "manufacturer.yaml:1: missing-key: 'title' is missing; a manufacturer file needs it"
    ]


def test_two_manufacturer_files_of_one_name(tmp_path: Path) -> None:
    messages = problem_texts(tmp_path, minimal=MINIMAL, manufacturer=MAKER, another=MAKER.replace("Acme", "Acme Ltd"))
    assert messages == ["manufacturer.yaml:2: duplicate-name: there is a different manufacturer file for 'acme'"]


def test_two_equal_manufacturer_files(tmp_path: Path) -> None:
    """Each folder of specs of one manufacturer can be used alone, and all of them together."""
    assert problem_texts(tmp_path, minimal=MINIMAL, manufacturer=MAKER, another=f"# The same facts\n{MAKER}") == []


def test_an_order_code_of_two_families(tmp_path: Path) -> None:
    messages = problem_texts(
        tmp_path, minimal=MINIMAL, other=MINIMAL.replace("device: minimal", "device: other"), manufacturer=MAKER
    )
    assert messages == ["other.yaml:11: order-code-ambiguous: the order code MIN12SC also belongs to 'minimal'"]


def test_two_manufacturers_whose_files_would_overwrite_each_other(tmp_path: Path) -> None:
    first, second = (
        MAKER + "biss_id: 0x4142\npython_package: encoders\n",
        MAKER.replace("acme", "zenith") + "python_package: encoders\nbiss_id: 0x4142\n",
    )
    assert problem_texts(tmp_path, minimal=MINIMAL, acme=first, zenith=second) == [
        "zenith.yaml:5: duplicate-name: 'acme' also has the Python package 'encoders'; rename one of the two",
        (
            "zenith.yaml:6: duplicate-name: 'acme' also has the BiSS manufacturer ID 0x4142, "
            "which names the file idbiss4142.xml"
        ),
    ]


@pytest.mark.parametrize(("name", "user"), [("json", "Python"), ("codewheel_runtime", "codewheel")])
def test_a_package_with_a_name_that_is_taken(tmp_path: Path, name: str, user: str) -> None:
    assert problem_texts(tmp_path, minimal=MINIMAL, manufacturer=MAKER + f"python_package: {name}\n") == [
        (
            f"manufacturer.yaml:5: not-allowed: 'python_package' cannot be '{name}': {user} uses that name; "
            f"write '{name}_encoders'"
        )
    ]


IDENTITY = (
    "  - {name: manufacturer_id, address: 0x7E, length: 2, byte_order: high_byte_first, access: read_only,"
    ' source: "6.3", fields: [{name: id, bits: 16, EQUALS}]}\n'
)


@pytest.mark.parametrize(
    ("equals", "hex_bytes"),
    [("text: ascii, equals: XX", "58, 58"), ("equals: 0x4241", "42, 41"), ("text: ascii, equals: AB", "")],
)
def test_the_biss_id_of_the_maker_and_of_the_register(tmp_path: Path, equals: str, hex_bytes: str) -> None:
    """0x4142 is "AB". The same bytes in reverse order are another manufacturer."""
    messages = problem_texts(
        tmp_path, minimal=MINIMAL + IDENTITY.replace("EQUALS", equals), manufacturer=MAKER + "biss_id: 0x4142\n"
    )
    line = len(MINIMAL.splitlines()) + 1
    message = (
        f"'manufacturer_id' equals {hex_bytes} at 7Eh and 7Fh, but 'biss_id' in the manufacturer file is 0x4142; "
        "one of the two is wrong"
    )
    assert messages == ([f"minimal.yaml:{line}: biss-id-mismatch: {message}"] if hex_bytes else [])


def test_an_example_of_a_register_that_is_wrong(tmp_path: Path) -> None:
    """The rules about the register report it, and the one about the BiSS ID does not raise."""
    identity = IDENTITY.replace("bits: 16, EQUALS", "at: 47:16")
    example = (
        "examples:\n  - {name: read, kind: register, register: manufacturer_id, order_code: MIN12SC,"
        ' bytes: "41 42", values: {id: 16706}, source: "6.3"}\n'
    )
    messages = problem_texts(tmp_path, minimal=MINIMAL + identity + example, manufacturer=MAKER + "biss_id: 0x4142\n")
    assert messages
    assert not any("biss-id-mismatch" in message for message in messages)


@pytest.mark.parametrize(("read", "hex_bytes"), [("41 42", ""), ("42 41", "42, 41"), ("41 43", "41, 43")])
def test_the_biss_id_of_the_maker_and_of_an_example(tmp_path: Path, read: str, hex_bytes: str) -> None:
    identity = IDENTITY.replace(", EQUALS", "")
    value = int(read.replace(" ", ""), 16)
    example = (
        f"examples:\n  - {{name: read, kind: register, register: manufacturer_id, order_code: MIN12SC,"
        f' bytes: "{read}", values: {{id: {value}}}, source: "6.3"}}\n'
    )
    messages = problem_texts(tmp_path, minimal=MINIMAL + identity + example, manufacturer=MAKER + "biss_id: 0x4142\n")
    line = len((MINIMAL + identity + example).splitlines())
    message = (
        f"'read' has {hex_bytes} at 7Eh and 7Fh, but 'biss_id' in the manufacturer file is 0x4142; "
        "one of the two is wrong"
    )
    assert messages == ([f"minimal.yaml:{line}: biss-id-mismatch: {message}"] if hex_bytes else [])
