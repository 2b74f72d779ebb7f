"""``codewheel cloze``: write the texts of a spec with blanks in place of words that can reverse their meaning."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..say import count_with_unit
from .arguments import Parser, add_specs_option
from .terminal import CommandError

if TYPE_CHECKING:
    import argparse

EXAMPLES = ("codewheel cloze my_encoder",)


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = (
        "Write FAMILY.words.yaml next to the spec: its texts with gaps in place of words such as 'not', 'before' and "
        "'high'. A reader fills in the gaps from the manual, and check compares the words with the spec. The words of "
        "unchanged texts are kept."
    )
    parser.add_argument("family", metavar="FAMILY", help="a family name as shown by list")
    add_specs_option(parser, "")


def run(arguments: argparse.Namespace) -> int:
    """Write the sheet of a family without overlays, and print the number of gaps to fill in.

    For unchanged texts, the words in an existing sheet are kept.

    Raises:
        CommandError: The family does not exist (exit code 2), it has problems, or its sheet cannot be read (exit code
            1).
    """
    from ..language.problems import ProblemReport
    from ..language.schema_files import word_sheet_path
    from ..readings.cloze import as_lines, open_gaps, read_sheet, sheet
    from .facts import family_named
    from .read_specs import specs_to_judge
    from .terminal import error_after_printing

    paths = specs_to_judge(arguments.specs, "cloze FAMILY").paths
    loaded_family = family_named(arguments.family, paths)
    # ``plain`` is the family without its overlays, if it has any.
    family = loaded_family.plain or loaded_family
    report = ProblemReport()
    filled_sheet = read_sheet(family, report)
    if report:
        raise error_after_printing(report)
    old_entries = filled_sheet.data["texts"] if filled_sheet is not None else {}
    sheet_data = sheet(family.document, old_entries)
    spec_path = Path(family.document.file)
    sheet_path = word_sheet_path(spec_path)
    lines = [*as_lines(sheet_data, spec_path.name), ""]  # The empty line ends the last line with a newline.
    try:
        sheet_path.write_text("\n".join(lines), encoding="utf-8")
    except OSError as error:
        raise CommandError(f"cannot write {sheet_path}: {error.strerror or error}", 1) from None
    number_of_gaps = count_with_unit(open_gaps(sheet_data), "gap")
    number_of_texts = count_with_unit(len(sheet_data["texts"]), "text")
    print(f"written    {sheet_path.as_posix()}: {number_of_gaps} to fill, in {number_of_texts}")
    return 0
