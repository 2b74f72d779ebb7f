"""``--choose``: answers to questions that the manual leaves open."""

from __future__ import annotations

from collections.abc import Container, Sequence

from ..language.document import visible
from ..language.problems import quoted
from ..model import Alternative, Device, Layout, Variant
from ..order_codes.reduction import for_interface, reduced_to_codes
from .terminal import CommandError


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
    message = open_questions(device, layout, answers)
    if message:
        raise UndecidedError(message)


def open_questions(
    device: Device, layout: Layout, answers: Container[str], predicate: str = "cannot be decoded"
) -> str:
    """Return a message with the questions of a layout that ``answers`` does not answer, or "" if there are none.

    ``answers`` contains the names of the answered questions. ``predicate`` follows the name of the layout in the
    message: ``'position' cannot be decoded until you decide. …``
    """
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
