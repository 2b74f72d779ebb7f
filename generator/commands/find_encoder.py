"""The encoder that the user asks about: found by its order code or family, or described in one line, with his answers.

Families that the cache contains are not loaded again.
"""

from __future__ import annotations

import shlex
import sys
from collections.abc import Container, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ..cache import Cache
from ..one_line.line import EncoderLine, LineError
from ..one_line.parse import is_line, parse_line
from ..say import count_with_unit, first_of
from .cli import bytes_by_address
from .families_in_specs import families_for, has_family, has_same_spec, in_requested_edition
from .terminal import CommandError, error_after_printing

if TYPE_CHECKING:
    import argparse

    from ..language.problems import ProblemReport
    from ..model import Alternative, Device, Layout, Variant
    from ..order_codes.labels import LabelMatch
    from .read_specs import Specs

#: Hint for an unknown order code.
WITHOUT_SPEC = "To describe an encoder without a spec, write it in one line, such as ssi:position=25,error=low"
#: End of the help of an order code.
OR_A_LINE = ", or the encoder in one line, such as biss:position=32,error,warning,crc=6:0x43"


def encoder_in_line(text: str) -> tuple[Device, LabelMatch]:
    """Return the device that a line describes, and the line as its order code.

    Raises:
        CommandError: The line has problems, which are printed. The exit code is 2.
    """
    from ..one_line.spec import device_of_line

    try:
        return device_of_line(text)
    except LineError as error:
        raise line_problems(error) from None


def checked_line(text: str) -> EncoderLine:
    """Return a line whose spec has no problems.

    Raises:
        CommandError: The line has problems, which are printed. The exit code is 2.
    """
    # Called for its error only, because the parser does not find all problems.
    encoder_in_line(text)
    return parse_line(text)


def line_problems(error: LineError) -> CommandError:
    """Print all problems of a line to standard error, and return the ``CommandError`` to raise."""
    from ..language.document import excerpt, visible

    for column, message in error.problems:
        print(f"column {column}: {visible(message)}", *excerpt(error.text, column), sep="\n", file=sys.stderr)
    return CommandError(f"{count_with_unit(len(error.problems), 'problem')} in the line", 2)


def refuse_line(text: str, action: str) -> None:
    """Check that a text is not an encoder in one line. ``action`` is why it must not be: ``has no editions``.

    Raises:
        CommandError: It is a line. The exit code is 2.
    """
    if is_line(text):
        raise CommandError(f"a line {action}; to write it as a spec: {command_for_spec(text)}", 2)


def command_for_spec(text: str) -> str:
    """Return the command that writes a line as a spec."""
    return f"codewheel new my_encoder --line {shlex.quote(text.strip())}"


#: Most files in a message.
_MOST_FILES = 8


class FoundEncoder(NamedTuple):
    """A family, the order code in it (None if the family was named), and the specs in which it was found."""

    device: Device
    code_match: LabelMatch | None
    paths: Sequence[Path]


def find_order_code(specs: Specs, text: str, cache: Cache) -> tuple[Device, LabelMatch, Sequence[Path]]:
    """Return the family of an order code, its match with the variant, and the specs among which it was found.

    The user's specs come before the packaged ones. If the text of the specs does not show which families are possible,
    all of them are loaded, and specs with problems are skipped with a message.

    Raises:
        CommandError: The code does not exist (exit code 2), or no valid spec has it and others have problems (exit
            code 1).
    """
    found_encoder = _find_in_groups(specs, text, cache, accepts_family=False)
    if found_encoder.code_match is None:  # Only a name is found without a match.
        raise _unknown_code_error([found_encoder.device], text)
    return found_encoder.device, found_encoder.code_match, found_encoder.paths


def find_requested(
    arguments: argparse.Namespace, specs: Specs, cache: Cache
) -> tuple[Device, LabelMatch, dict[int, int]]:
    """Return the family and match of ``ORDER-CODE`` in ``--edition``, and the bytes of ``--register`` by address.

    With ``--edition registers``, registers from which the edition was inferred are left out.

    Raises:
        CommandError: As for ``find_order_code``, a byte is malformed, or the edition is not known. The exit code is
            then 2.
    """
    device, code_match, paths = find_order_code(specs, arguments.order_code, cache)
    register_bytes = bytes_by_address(arguments.register)
    if arguments.edition is None:
        return device, code_match, register_bytes
    refuse_line(arguments.order_code, "has no editions")
    device_in_edition, match_in_edition, remaining_bytes = in_requested_edition(
        device,
        code_match,
        specs=paths,
        wanted_edition=arguments.edition,
        text=arguments.order_code,
        register_bytes=register_bytes,
    )
    return device_in_edition, match_in_edition or code_match, remaining_bytes


def find_family_or_code(specs: Specs, text: str, cache: Cache) -> FoundEncoder:
    """Return a family named ``text`` without a match, or the result of ``find_order_code`` for the order code.

    Raises:
        CommandError: As for ``find_order_code``.
    """
    return _find_in_groups(specs, text, cache, accepts_family=True)


def _find_in_groups(specs: Specs, text: str, cache: Cache, *, accepts_family: bool) -> FoundEncoder:
    """Return the family or order code from the first group of specs that contains it.

    The groups are the user's specs and the packaged ones. If another group also contains it, with a different spec, a
    message says that it is not used.

    Without ``accepts_family``, the text must be an order code, or an encoder in one line, which needs no specs.
    """
    if is_line(text):
        device, match_of_line = encoder_in_line(text)
        return FoundEncoder(device, match_of_line, paths=())
    reports_with_problems: list[ProblemReport] = []
    for index, paths in enumerate(specs.groups):
        family_and_code, report = _find_in_group(paths, text, cache, accepts_family=accepts_family)
        if report is not None:
            reports_with_problems.append(report)
        if family_and_code is None:
            continue
        device, code_match = family_and_code
        _refuse_hidden(device, reports_with_problems)
        for report in reports_with_problems:
            _print_skipped_files(report)
        for unused_paths in specs.groups[index + 1 :]:
            has_other_spec = not has_same_spec(paths, unused_paths, device.name)
            if has_other_spec and _group_has(unused_paths, device.name, text, cache, accepts_family=accepts_family):
                print(f"codewheel: {text} is in your specs and in the packaged ones; yours are used", file=sys.stderr)
        return FoundEncoder(device, code_match, paths)
    raise _no_such_encoder(specs, text, cache, accepts_family=accepts_family)


def _group_has(paths: Sequence[Path], family: str, text: str, cache: Cache, *, accepts_family: bool) -> bool:
    """Return True if a group of specs contains this family, or the order code or family that ``text`` names."""
    if has_family(paths, family):
        return True
    family_and_code, _ = _find_in_group(paths, text, cache, accepts_family=accepts_family)
    return family_and_code is not None


def _find_in_group(
    paths: Sequence[Path], text: str, cache: Cache, *, accepts_family: bool
) -> tuple[tuple[Device, LabelMatch | None] | None, ProblemReport | None]:
    """Return the family and match from one group of specs, or None, and the report with problems of the group, or None.

    The match is None if the text is the name of the family. There is also no report if only the possible families were
    read.
    """
    possible_families = families_for(paths, text, cache)
    if possible_families is not None:
        # If specs share an order code by mistake, all must be loaded to report it.
        matches = _all_matches(possible_families, text, accepts_family=accepts_family)
        if not matches:
            return None, None
        if len(matches) == 1:
            return matches[0], None
    from ..loading.library import load_valid

    devices, report = load_valid(paths)
    # Without problems, the report is false.
    return _best_match(devices, text, accepts_family=accepts_family), report or None


def _best_match(
    devices: Sequence[Device], text: str, *, accepts_family: bool
) -> tuple[Device, LabelMatch | None] | None:
    """Return the family with this name, or else the order code that matches most characters of the text, or None."""
    matches = _all_matches(devices, text, accepts_family=accepts_family)
    return min(matches, key=_suffix_length, default=None)


def _suffix_length(family_and_code: tuple[Device, LabelMatch | None]) -> int:
    """Return the number of characters after the order code, or 0 for the name of a family."""
    _, code_match = family_and_code
    return len(code_match.tail) if code_match is not None else 0


def _all_matches(
    devices: Sequence[Device], text: str, *, accepts_family: bool
) -> list[tuple[Device, LabelMatch | None]]:
    """Return each family that has the order code ``text``, with its match.

    If ``accepts_family`` allows names and a family has this name, return only this family, with None instead of a
    match.
    """
    from ..order_codes.labels import UnknownOrderCode
    from ..order_codes.labels import find_code as match_of

    if accepts_family:
        family = _family_named(devices, text)
        if family is not None:
            return [(family, None)]
    matches: list[tuple[Device, LabelMatch | None]] = []
    for device in _candidate_families(devices, text):
        with suppress(UnknownOrderCode):
            matches.append((device, match_of(device, text)))
    return matches


def _refuse_hidden(device: Device, reports_with_problems: Iterable[ProblemReport]) -> None:
    """Refuse a packaged family if the user also has a spec of it, which was skipped because it has problems.

    The packaged spec would be used without the user's changes.

    Raises:
        CommandError: There is such a file. The exit code is 1.
    """
    for report in reports_with_problems:
        # A file is named after its family.
        names_of_faulty_families = {Path(file).stem for file in report.faulty_files}
        if device.name in names_of_faulty_families:
            raise error_after_printing(report)


def _print_skipped_files(report: ProblemReport) -> None:
    # Each file once, in the order of its first problem.
    files = list(dict.fromkeys(problem.file for problem in report.problems))
    number_of_problems = count_with_unit(len(report), "problem")
    listed_files = first_of(files, _MOST_FILES)
    print(f"codewheel: skipped, with {number_of_problems}: {listed_files}; run codewheel check", file=sys.stderr)


def _no_such_encoder(specs: Specs, text: str, cache: Cache, *, accepts_family: bool) -> CommandError:
    """Return the error if no group contains the text: the problems of the specs, or a message about the text."""
    from ..language.files import packaged_families
    from ..loading.library import load_valid

    devices: list[Device] = []
    for paths in specs.groups:
        group_devices, report = load_valid(paths)
        if report:
            return error_after_printing(report)
        devices += group_devices
    packaged_match = None
    if not specs.packaged:
        packaged_match, _ = _find_in_group(packaged_families(), text, cache, accepts_family=accepts_family)
    # The other commands also accept an encoder in one line.
    reason = _unknown_code_error(devices, text, suggests_line=not accepts_family and packaged_match is None)
    if packaged_match is None:
        return reason
    return CommandError(f"{reason}; the packaged specs have it, so leave out the names of specs", reason.code)


def find_among(devices: Sequence[Device], text: str) -> tuple[Device, LabelMatch]:
    """Return the family and match of an order code among ``devices``: the match with the shortest tail.

    Raises:
        CommandError: There is no such code. The exit code is 2.
    """
    best_match = _best_match(devices, text, accepts_family=False)
    if best_match is not None:
        device, code_match = best_match
        if code_match is not None:
            return device, code_match
    raise _unknown_code_error(devices, text)


def _candidate_families(devices: Sequence[Device], text: str) -> list[Device]:
    """Return the families that may have the order code ``text``: first special models with its suffix, then all others.

    Other special models and older editions are left out, because their order codes are also those of a family.
    """
    label = "".join(text.split()).upper()
    special_models = [device for device in devices if _is_special_model(device, label)]
    # Only special models and older editions have a base.
    families = [device for device in devices if not device.base]
    return [*special_models, *families]


def _is_special_model(device: Device, label: str) -> bool:
    """Return whether a device is a special model, and a label ends with its suffix, such as ``/S123``."""
    suffixes = [f"/{overlay.special}" for overlay in device.overlays if overlay.special]
    return label.endswith(tuple(suffixes))


def _unknown_code_error(devices: Sequence[Device], text: str, *, suggests_line: bool = False) -> CommandError:
    """Return the error for an unknown code, with the most helpful message.

    The message is the first of these that applies: the text is a file, it is the name of a family, it differs in a
    certain part from a known code, or the most similar codes are these. With ``suggests_line``, the last one also
    explains how to describe an encoder without a spec.
    """
    from ..language.files import SUFFIXES
    from ..order_codes import labels
    from ..order_codes.labels import NEAR, closest_reason, family_with_name, nearest_codes

    if Path(text).suffix in SUFFIXES:
        return CommandError(f"'{text}' is not an order code; give a spec as --specs {text}", 2)
    device = family_with_name(devices, text)
    if device is not None:
        example = device.variants[0].code
        message = labels.family_instead_of_code(text, example)
        return CommandError(f"{message} (codewheel show {device.name} explains them)", 2)
    reason = closest_reason(_candidate_families(devices, text), text)
    if reason is not None:
        return CommandError(reason, 2)
    similar_codes = nearest_codes(devices, text, NEAR)
    remedy = "; codewheel list shows the known patterns"
    if similar_codes:
        remedy = labels.nearest_codes_hint(", ".join(similar_codes))
    if suggests_line:
        remedy += f". {WITHOUT_SPEC}"
    return CommandError(labels.unknown_code(text) + remedy, 2)


def _family_named(devices: Sequence[Device], text: str) -> Device | None:
    """Return the family of this name, or None."""
    name = text.strip().lower()
    for device in devices:
        if device.name == name:
            return device
    return None


# -- questions that the manual leaves open


class UndecidedError(ValueError):
    """A frame cannot be decoded until the user answers a question. The message lists the question and all answers."""


def answers_of(device: Device, variant: Variant, pairs: Sequence[str]) -> dict[str, str]:
    """Return pairs such as ``adf_layout=as_printed`` as ``{"adf_layout": "as_printed"}``.

    Each pair consists of an alternative, which is a question that the manual leaves open for this order code, and the
    answer that the user chose.

    Raises:
        CommandError: This order code does not have the alternative or answer, or an alternative has two answers. The
            exit code is 2.
    """
    from ..language.document import visible
    from ..language.problems import quoted
    from ..order_codes.reduction import for_interface, reduced_to_codes

    reduced_device = reduced_to_codes(for_interface(device, variant.interface), [variant.code])
    alternatives = {alternative.name: alternative for alternative in reduced_device.alternatives}
    answers: dict[str, str] = {}
    for pair in pairs:
        question, _, answer_name = pair.partition("=")
        if not alternatives:
            raise CommandError(f"{variant.code} has nothing to choose", 2)
        if question not in alternatives:
            options: list[str] = []
            for alternative in alternatives.values():
                options += _choose_options(alternative)
            problem = f"{variant.code} has no choice {quoted(visible(question))}"
            raise CommandError(f"{problem}; write {' or '.join(options)}", 2)
        known_answers = [answer.name for answer in alternatives[question].answers]
        if answer_name not in known_answers:
            options = _choose_options(alternatives[question])
            problem = f"{quoted(question)} has no answer {quoted(visible(answer_name))}"
            raise CommandError(f"{problem}; write {' or '.join(options)}", 2)
        previous_answer = answers.setdefault(question, answer_name)
        if previous_answer != answer_name:
            both_answers = f"as {quoted(previous_answer)} and as {quoted(answer_name)}"
            raise CommandError(f"{quoted(question)} is chosen twice, {both_answers}", 2)
    return answers


def refuse_undecided(device: Device, layout: Layout, answers: Container[str]) -> None:
    """Refuse to decode a frame while a question about it is open.

    Raises:
        UndecidedError: The layout needs an answer that is not among ``answers``.
    """
    message = describe_open_questions(device, layout, answers)
    if message:
        raise UndecidedError(message)


def describe_open_questions(
    device: Device, layout: Layout, answers: Container[str], predicate: str = "cannot be decoded"
) -> str:
    """Return a message with the questions of a layout that ``answers`` does not answer, or "" if there are none.

    ``answers`` contains the names of the answered questions. ``predicate`` follows the name of the layout in the
    message: ``'position' cannot be decoded until you decide. …``
    """
    from ..language.problems import quoted

    unanswered = [alternative for alternative in device.alternatives_of(layout) if alternative.name not in answers]
    if not unanswered:
        return ""
    questions = " ".join(map(_question_with_options, unanswered))
    return f"{quoted(layout.name)} {predicate} until you decide. {questions}".removesuffix(".")


def _question_with_options(alternative: Alternative) -> str:
    """Return a question, and the option for each answer with its meaning."""
    options = zip(_choose_options(alternative), alternative.answers, strict=True)
    explained_options = [f"{option} ({answer.meaning})" for option, answer in options]
    return f"{alternative.meaning}: add {' or '.join(explained_options)}."


def _choose_options(alternative: Alternative) -> list[str]:
    """Return the option for each answer, such as ``--choose adf_layout=as_printed``."""
    return [f"--choose {alternative.name}={answer.name}" for answer in alternative.answers]
