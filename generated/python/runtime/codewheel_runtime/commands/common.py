# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Code shared by all commands: exit codes, the encoder selected by the arguments, and progress."""

from __future__ import annotations

import argparse
import shutil
import signal
import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager
from enum import Enum
from importlib import import_module
from time import monotonic
from types import FrameType
from typing import Any, Final, NoReturn, TextIO, get_type_hints

from ..encoder import Encoder
from ..reports import Interface

DONE, FAILED, USAGE, NOT_USABLE, INTERRUPTED = 0, 1, 2, 3, 130


class CommandFailed(Exception):
    """The command ends with this message and this exit code."""

    def __init__(self, message: object, code: int = FAILED) -> None:
        super().__init__(str(message))
        self.code = code


def distribution(package: str) -> str:
    """Return the name by which a package is installed."""
    return package.replace("_", "-")


def find_encoder(package: str, options: argparse.Namespace) -> Encoder:
    """Return the encoder selected by the arguments. Raises CommandFailed if they are wrong."""
    try:
        return _select_encoder(package, options)
    except ValueError as error:
        raise CommandFailed(error, USAGE) from None


def _select_encoder(package: str, options: argparse.Namespace) -> Encoder:
    """Return the encoder for the arguments of the command: order code, interface, registers and answers.

    Raises:
        ValueError: The label is not an order code, the encoder has a different interface, no registers affect its
            frames, or a register or an answer is not valid.
    """
    encoder: Encoder = import_module(package).lookup(str(options.order_code))
    if options.interface is not None and encoder.interface.value != options.interface:
        requested_interface = Interface(options.interface).title
        raise ValueError(f"{encoder.code} has the interface {encoder.interface.title}, not {requested_interface}")
    if options.register:
        # Only encoders with such registers have this method.
        change_registers: Callable[[dict[int, int]], Encoder] | None = getattr(encoder, "with_registers", None)
        if change_registers is None:
            raise ValueError(f"no register affects the frames of {encoder.code}")
        encoder = change_registers(dict(options.register))
    return _add_optional_answers(encoder, options)


def _add_optional_answers(encoder: Encoder, options: argparse.Namespace) -> Encoder:
    """Return the encoder with those chosen answers that belong to it, and remove them from ``options.choose``.

    These answers are the parameters of ``with_answers``, if the encoder has this method. If any of them is chosen, the
    others are set to their first value. If none is chosen, the encoder is returned unchanged. The remaining answers in
    ``options.choose`` are for the decoder of the frames.

    Raises:
        ValueError: A parameter does not have the chosen value.
    """
    with_answers: Callable[..., Encoder] | None = getattr(encoder, "with_answers", None)
    if with_answers is None:
        return encoder
    parameter_types: dict[str, Any] = get_type_hints(with_answers)
    # Each parameter has an enumeration of answers, whose first member is the default.
    answer_classes = {name: kind for name, kind in parameter_types.items() if name not in ("self", "return")}
    answers: dict[str, Any] = {name: next(iter(answer_class)) for name, answer_class in answer_classes.items()}
    encoder_choices = [(name, answer) for name, answer in options.choose if name in answer_classes]
    options.choose = [(name, answer) for name, answer in options.choose if name not in answer_classes]
    if not encoder_choices:
        return encoder
    for name, answer in encoder_choices:
        answers[name] = find_answer(name, answer, answer_classes[name])
    return with_answers(**answers)


def find_answer(name: str, answer: str, answer_class: type[Enum]) -> Enum:
    """Return the member of ``answer_class`` that ``--choose`` selects. Raises ValueError if there is no such answer."""
    for member in answer_class:
        if member.name.lower() == answer.lower():
            return member
    choices = " or ".join(f"--choose {name}={member.name.lower()}" for member in answer_class)
    raise ValueError(f"--choose {name}={answer} is not an answer: expected {choices}")


@contextmanager
def show_progress(package: str, source: str) -> Generator[Callable[[int, int | None, int], None] | None, None, None]:
    """Show progress on a terminal, and convert errors of long tasks to ``CommandFailed``, which is printed in one line.

    The context yields the function to call with the amount done, the total if known, and the number of frames. It
    yields None if standard error is not a terminal. ``source`` is the file to name if an error does not name a file.
    """
    from ..errors import InputError, UsageError

    progress = Progress(sys.stderr)
    try:
        with _InterruptOnTermination():
            yield progress.show if sys.stderr.isatty() else None
    except UsageError as error:
        raise CommandFailed(error, USAGE) from None
    except BrokenPipeError:
        # It is an OSError, but ``main`` handles it.
        raise
    except OSError as error:
        raise CommandFailed(f"{error.filename or source}: {error.strerror or error}") from None
    except ImportError as error:
        raise missing_package_error(error) from None
    except MemoryError:
        raise CommandFailed("not enough memory") from None
    except InputError as error:
        raise CommandFailed(error) from None
    finally:
        progress.clear()


#: Package names by module name, if the two differ.
_PACKAGE_BY_MODULE: Final = {"serial": "pyserial"}


def missing_package_error(error: ImportError) -> CommandFailed:
    """Return the error for a Python package that is not installed, with the command that installs it."""
    if not isinstance(error, ModuleNotFoundError) or not error.name:
        return CommandFailed(error)
    module = error.name.partition(".")[0]
    return CommandFailed(f"this needs {module}: pip install {_PACKAGE_BY_MODULE.get(module, module)}")


class _InterruptOnTermination:
    """Context in which SIGTERM raises KeyboardInterrupt, so that no incomplete file remains."""

    def __enter__(self) -> None:
        self._previous_handler = signal.getsignal(signal.SIGTERM)
        signal.signal(signal.SIGTERM, self._interrupt)

    def __exit__(self, *_: object) -> None:
        signal.signal(signal.SIGTERM, self._previous_handler)

    @staticmethod
    def _interrupt(number: int, frame: FrameType | None) -> NoReturn:
        raise KeyboardInterrupt


#: Number of characters of a progress bar.
_BAR_WIDTH: Final = 30


class Progress:
    """Progress bar on the last line of a terminal."""

    #: Highest number of updates per second.
    RATE: Final = 10

    def __init__(self, out: TextIO) -> None:
        self._out = out
        self._started = monotonic()
        self._last_shown = 0.0

    def show(self, done: int, total: int | None, frames: int) -> None:
        """Show the progress, at most ``RATE`` times per second. Without a total, there is no bar."""
        now = monotonic()
        if now - self._last_shown < 1 / self.RATE:
            return
        self._last_shown = now
        text = f"{frames:,} frames, {now - self._started:.0f} s"
        if total:
            fraction = min(done / total, 1.0)
            filled_width = round(_BAR_WIDTH * fraction)
            bar = f"{'#' * filled_width:<{_BAR_WIDTH}}"
            text = f"[{bar}] {fraction:4.0%} {text}"
        columns = shutil.get_terminal_size().columns
        # The whole line is replaced. Its last column stays empty, because some terminals would begin a new line.
        self._out.write(f"\r{text[: columns - 1]:<{columns - 1}}")
        self._out.flush()

    def clear(self) -> None:
        """Clear the line if any progress was shown."""
        if self._last_shown:
            self._out.write(f"\r{' ' * (shutil.get_terminal_size().columns - 1)}\r")
            self._out.flush()
