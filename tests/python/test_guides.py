"""The README and the guides of every package: their length, their examples, and that they are handed over."""

from __future__ import annotations

import doctest
import re
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from inspect import signature
from pathlib import Path, PurePosixPath
from posixpath import normpath
from typing import Any

import pytest
from codewheel.targets import Library
from codewheel.targets.python.files import generate
from python_path import new_packages

README_LINES, GUIDE_LINES = 350, 200
LIVE, FILES, TEST = "live-line.md", "files-and-captures.md", "test-without-an-encoder.md"
GUIDES = ("README.md", LIVE, FILES, TEST)
#: The name of the port in the examples, which is the last part of its path.
PLACEHOLDER_PORT = re.compile(r"[^\"\s]*ttyUSB0")


@pytest.fixture(scope="module")
def output(every_encoder: Library, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The packages of all manufacturers, with their runtime."""
    folder = tmp_path_factory.mktemp("guides")
    for name, text in generate(every_encoder).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder / "python"


def package_folders(output: Path) -> list[Path]:
    """Return the folder of each manufacturer's package."""
    folders = {path.parent for path in output.rglob("setup.py")}
    return sorted(folders - {output / "runtime"})


def pages(folder: Path) -> Iterator[Path]:
    """Yield the README of a package and its guides."""
    for name in GUIDES:
        if (folder / name).is_file():
            yield folder / name


def python_blocks(page: Path) -> list[str]:
    return re.findall(r"```+python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.slow
def test_pages_are_short(output: Path) -> None:
    folders = package_folders(output)
    assert len(folders) > 10
    for folder in folders:
        for page in pages(folder):
            limit = README_LINES if page.name == "README.md" else GUIDE_LINES
            assert len(page.read_text(encoding="utf-8").splitlines()) <= limit, page


@pytest.mark.slow
def test_every_example_runs(output: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.syspath_prepend(output / "runtime")
    example_pages = {FILES: 0, TEST: 0, LIVE: 0, "README.md": 0}
    with new_packages():
        for folder in package_folders(output):
            monkeypatch.syspath_prepend(folder)
            for page in pages(folder):
                text = "\n".join(python_blocks(page))
                test = doctest.DocTestParser().get_doctest(text, {}, f"{folder.name}/{page.name}", str(page), 0)
                result = doctest.DocTestRunner().run(test)
                assert result.failed == 0, f"{page}\n{capsys.readouterr().out}"
                example_pages[page.name] += bool(test.examples)
    assert example_pages[FILES] == example_pages[TEST] == len(package_folders(output))
    assert min(example_pages.values()) > 5


@pytest.mark.slow
def test_calls_in_the_text_have_all_arguments(output: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A call such as ``icmr.Tmp.decode(frame, encoder)`` in a sentence is not run, because its frame is any frame."""
    monkeypatch.syspath_prepend(output / "runtime")
    call_count = 0
    with new_packages():
        for folder in package_folders(output):
            monkeypatch.syspath_prepend(folder)
            calls = re.findall(r"`(\w+)\.(\w+)\.decode\((.+?)\)`", (folder / "README.md").read_text(encoding="utf-8"))
            for module_name, class_name, arguments in calls:
                package = next(path.parent.name for path in folder.glob(f"*/{module_name}.py"))
                frame_class = getattr(import_module(f"{package}.{module_name}"), class_name)
                signature(frame_class.decode).bind(*arguments.split(", "))
                call_count += 1
    assert call_count >= 5


@pytest.mark.slow
def test_frames_with_data_channels_are_explained(output: Path) -> None:
    """The README of a manufacturer whose encoders send several data channels shows how a whole frame is decoded."""
    readmes = {folder: (folder / "README.md").read_text(encoding="utf-8") for folder in package_folders(output)}
    explaining = [folder.name for folder, text in readmes.items() if "encoder.channels().decode(" in text]
    assert explaining == ["ichaus_encoders"]


@pytest.mark.slow
def test_every_live_example_runs(
    output: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    virtual_encoder: Callable[..., Any],
) -> None:
    """The programs of the README and the guides, on a virtual encoder instead of the port that they name."""
    monkeypatch.syspath_prepend(output / "runtime")
    runs = 0
    with new_packages():
        for folder in package_folders(output):
            monkeypatch.syspath_prepend(folder)
            for page in pages(folder):
                for block in python_blocks(page):
                    if PLACEHOLDER_PORT.search(block):
                        (code,) = set(re.findall(r'(?:lookup\(|ttyUSB0", )"([^"]+)"', block))
                        served = virtual_encoder(code, 77)
                        exec(PLACEHOLDER_PORT.sub(served.port, block).replace("range(100)", "range(3)"), {})
                        assert set(capsys.readouterr().out.split()) == {"77"}, page
                        runs += 1
                    elif "def test_" in block:
                        names: dict[str, Any] = {}
                        exec(block, names)
                        names["test_lost_replies"](virtual_encoder)
                        runs += 1
    assert runs >= 4 * 3


@pytest.mark.slow
def test_a_guide_has_only_the_interfaces_of_the_package(every_encoder: Library, output: Path) -> None:
    lines = {
        "rs485": ("RS-485", "open_encoder"),
        "biss": ("RegisterBus", "BissLine"),
        "spi": ("SpiLine",),
        "ssi": ("SsiLine",),
    }
    for manufacturer, devices in every_encoder.by_manufacturer():
        folder = output if manufacturer.main else output / manufacturer.python_package
        interfaces = {interface.name for device in devices for interface in device.interfaces}
        text = "".join(page.read_text(encoding="utf-8") for page in pages(folder) if page.name in (LIVE, TEST))
        for interface in lines.keys() - interfaces:
            for word in lines[interface]:
                assert word not in text, (folder.name, word)
        if not interfaces & {"rs485", "biss", "spi"}:
            assert not (folder / LIVE).exists(), folder.name
        if interfaces & {"rs485", "biss"}:
            assert (folder / LIVE).is_file(), folder.name


def missing_link_targets(texts: Mapping[str, str]) -> list[tuple[str, str]]:
    """Return each page of a package with a link to a file that the package lacks, and the target of the link."""
    missing_targets: list[tuple[str, str]] = []
    for page, text in texts.items():
        folder = PurePosixPath(page).parent
        is_guide = PurePosixPath(page).name in GUIDES and f"{folder}/setup.py" in texts
        targets = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text) if is_guide else []
        missing_targets += [(page, target) for target in targets if normpath(folder / target) not in texts]
    return missing_targets


def test_every_link_to_a_guide_has_its_target(files: Mapping[str, str]) -> None:
    assert missing_link_targets(files) == []
    page = "python/README.md"
    without_guide = {path: text for path, text in files.items() if path != f"python/{LIVE}"}
    assert (page, LIVE) in missing_link_targets(without_guide)


@pytest.mark.slow
def test_every_link_of_every_manufacturer_has_its_target(every_encoder: Library) -> None:
    assert missing_link_targets(generate(every_encoder)) == []


@pytest.mark.slow
def test_wheel_and_source_archive_have_the_guides(output: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "build", "--quiet", "--no-isolation", "--outdir", str(tmp_path), str(output)]
    completed = subprocess.run(command, capture_output=True, text=True, check=False)
    assert completed.returncode == 0, completed.stderr
    guides = {"README.md", LIVE, FILES, TEST}
    with zipfile.ZipFile(next(tmp_path.glob("*.whl"))) as wheel:
        documents = {Path(name).name for name in wheel.namelist() if "/share/doc/lika-encoders/" in name}
        metadata = next(wheel.read(name) for name in wheel.namelist() if name.endswith("/METADATA"))
    assert documents == guides
    assert b"\nAuthor: the codewheel authors\n" in metadata
    assert b"\nProject-URL: Manufacturer, https://www.lika.biz\n" in metadata
    with tarfile.open(next(tmp_path.glob("*.tar.gz"))) as archive:
        assert guides <= {Path(name).name for name in archive.getnames()}
