"""``--choose``: the user's answers to questions that the manual leaves open."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence

from ..language.problems import quoted, visible
from ..model import Alternative, Device, Layout, Variant
from ..order_codes.reduction import for_interface, reduced_to_codes
from .terminal import Stop


class UndecidedError(ValueError):
    """A frame cannot be decoded until the user answers a question. The message lists the question and all answers."""


def answers_of(device: Device, variant: Variant, pairs: Sequence[str]) -> dict[str, str]:
    """Return pairs such as ``eeprom_address=as_printed`` as answers by the names of their alternatives.

    Raises:
        Stop: This order code has no such alternative or answer, or an alternative has two. The exit code is 2.
    """
    reduced_device = reduced_to_codes(for_interface(device, variant.interface), [variant.code])
    alternatives = {alternative.name: alternative for alternative in reduced_device.alternatives}
    answers: dict[str, str] = {}
    for pair in pairs:
        name, _, answer = pair.partition("=")
        if not alternatives:
            raise Stop(f"{variant.code} has nothing to choose", 2)
        if name not in alternatives:
            choices = " or ".join(option for alternative in alternatives.values() for option in _options(alternative))
            raise Stop(f"{variant.code} has no choice {quoted(visible(name))}; write {choices}", 2)
        if answer not in (answer.name for answer in alternatives[name].answers):
            choices = " or ".join(_options(alternatives[name]))
            raise Stop(f"{quoted(name)} has no answer {quoted(visible(answer))}; write {choices}", 2)
        if answers.setdefault(name, answer) != answer:
            raise Stop(f"{quoted(name)} is chosen twice, as {quoted(answers[name])} and as {quoted(answer)}", 2)
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
    """Return the questions to answer before a frame of this layout can be used, or an empty string if there are none.

    ``predicate`` is the predicate of the message about the action that needs the answers.
    """
    unanswered = [alternative for alternative in device.alternatives_of(layout) if alternative.name not in answers]
    if not unanswered:
        return ""
    questions = " ".join(_question(alternative) for alternative in unanswered)
    return f"{quoted(layout.name)} {predicate} until you decide. {questions}".removesuffix(".")


def _question(alternative: Alternative) -> str:
    return f"{alternative.meaning}: add {' or '.join(_explained_options(alternative))}."


def _options(alternative: Alternative) -> Iterator[str]:
    return (f"--choose {alternative.name}={answer.name}" for answer in alternative.answers)


def _explained_options(alternative: Alternative) -> Iterator[str]:
    for option, answer in zip(_options(alternative), alternative.answers, strict=True):
        yield f"{option} ({answer.meaning})"
