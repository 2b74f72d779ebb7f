# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads frames from binary, CSV and Parquet files in chunks. Loaded only by ``decode_file`` and related functions."""

from __future__ import annotations

import io
import sys
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from os import fspath
from pathlib import PurePath
from typing import Any, BinaryIO, Final, cast, get_args

from ..bulk.shape import FrameLayout
from ..bulk.words import WORDS, WordKind, rows_to_numbers
from ..errors import InputError, UsageError
from ..packages import load
from . import inputs
from .csv_text import read_csv_rows
from .inputs import FIRST, FileKind, FrameBatch, Source, StorageFormat, ValidFraction, check_form
from .parquet import read_parquet_batches

np: Any = load("numpy")

_FORMAT_BY_SUFFIX: Final[dict[str, FileKind]] = {
    ".csv": "csv",
    ".tsv": "csv",
    ".txt": "csv",
    ".parquet": "parquet",
    ".pq": "parquet",
}
#: What to do with files that are not read, by extension.
_ADVICE_BY_SUFFIX: Final = {
    **dict.fromkeys((".gz", ".bz2", ".xz", ".zst", ".zip"), "compressed files cannot be decoded: decompress the file"),
    **dict.fromkeys((".xls", ".xlsx", ".ods"), "spreadsheets cannot be decoded: save the table as CSV"),
}
#: First bytes of an Arrow file.
_ARROW_MARK: Final = b"ARROW1\0\0"


def find_kind(path: str) -> FileKind:
    """Return the format of a file according to its extension. Other extensions, or none, mean binary files.

    Raises:
        InputError: The extension is that of a compressed file or of a spreadsheet.
    """
    suffix = PurePath(path).suffix.lower()
    if suffix in _ADVICE_BY_SUFFIX:
        raise InputError(path, _ADVICE_BY_SUFFIX[suffix])
    return _FORMAT_BY_SUFFIX.get(suffix, "binary")


@contextmanager
def open_source(
    path: str, storage: StorageFormat, layout: FrameLayout, find_valid_fraction: ValidFraction
) -> Generator[Source, None, None]:
    """Open a file of frames, or standard input for ``-``.

    ``find_valid_fraction`` returns the fraction of valid frames, for the check of the first frames.

    Raises:
        UsageError: The frames do not fit into the words of the file, or the format cannot be read from standard input.
        InputError: The file does not have this format, or no column of frames.
        OSError: The file cannot be opened.
    """
    kind = storage.kind or find_kind(path)
    _check_words(kind, storage.word_form, layout)
    if path == "-":
        if kind == "parquet":
            raise UsageError("Parquet cannot be read from standard input; give a file")
        # A replaced standard input can lack ``buffer``. It is then binary itself.
        file = cast(BinaryIO, getattr(sys.stdin, "buffer", sys.stdin))
        standard_input = _choose_source(file, "standard input", None, kind, storage, layout, find_valid_fraction)
        with _close_after(standard_input) as source:
            yield source
        return
    with open(path, "rb") as file:
        # A pipe has no size.
        size = file.seek(0, io.SEEK_END) if file.seekable() else None
        if size is not None:
            file.seek(0)
        with _close_after(
            _choose_source(file, fspath(path), size, kind, storage, layout, find_valid_fraction)
        ) as source:
            yield source


def _check_words(kind: FileKind, word_form: WordKind, layout: FrameLayout) -> None:
    """Raise UsageError if frames of bits do not fit into the words of a file, or frames of bytes have a word form."""
    has_bytes = bool(layout.byte_count)
    if has_bytes:
        if word_form != "packed" and kind == "binary":
            raise UsageError(f"words are for frames of bits, but a frame of this encoder has {layout.byte_count} bytes")
        return
    if layout.bit_count > 64:
        raise UsageError(f"frames of {layout.bit_count} bits do not fit into words of 64")
    if kind == "binary" and word_form.endswith("32") and layout.bit_count > 32:
        raise UsageError(f"frames of {layout.bit_count} bits do not fit into words of 32")


@contextmanager
def _close_after(source: Source) -> Generator[Source, None, None]:
    """Yield the source, then close the generator of its parts before the file, even if the caller stops early."""
    try:
        yield source
    finally:
        source.batches.close()


def _choose_source(
    file: BinaryIO,
    file_name: str,
    size: int | None,
    kind: FileKind,
    storage: StorageFormat,
    layout: FrameLayout,
    find_valid_fraction: ValidFraction,
) -> Source:
    """Return the source of frames in a file of this kind.

    ``file_name`` is the name of the file in errors, and ``size`` its size in bytes, if known. ``find_valid_fraction``
    returns the fraction of valid frames.
    """
    if kind == "parquet":
        return read_parquet_batches(file, file_name, storage, layout)
    if kind == "csv":
        return read_csv_rows(file, file_name, size, storage, layout, find_valid_fraction)
    return Source(_read_binary(file, file_name, size, storage, layout, find_valid_fraction), size)


def _read_binary(
    file: BinaryIO,
    file_name: str,
    size: int | None,
    storage: StorageFormat,
    layout: FrameLayout,
    find_valid_fraction: ValidFraction,
) -> Generator[FrameBatch, None, None]:
    """Yield the frames of a binary file, and the number of bytes read.

    Frames of bytes are yielded as rows of bytes, and frames of bits as numbers. ``file_name`` is the name of the file
    in errors, and ``size`` its size in bytes, if known. With ``storage.cut``, an incomplete frame at the end is
    ignored. ``find_valid_fraction`` returns the fraction of valid frames.

    Raises:
        InputError: The first frames fit another form of words, the file ends within a frame, or it is an Arrow file.
    """
    has_bytes = bool(layout.byte_count)
    # Number of bytes that each frame occupies in the file.
    frame_bytes = layout.byte_count if has_bytes else _find_word_length(storage.word_form, layout)
    bytes_read = 0
    while data := _read(file, frame_bytes * inputs.CHUNK):
        is_first_block = not bytes_read
        if is_first_block and data.startswith(_ARROW_MARK):
            raise InputError(file_name, "Arrow files cannot be decoded: save the table as Parquet")
        if is_first_block and not has_bytes:
            _check_first_words(data, file_name, storage.word_form, layout, find_valid_fraction)
        # If the size is known, an incomplete frame is reported before any frame is decoded.
        if is_first_block and size is not None and size % frame_bytes and not storage.ignores_incomplete_frame:
            raise _incomplete_frame_error(file_name, size, frame_bytes)
        bytes_read += len(data)
        # Only the last block can end within a frame, which has these bytes.
        extra_bytes = len(data) % frame_bytes
        if extra_bytes and not storage.ignores_incomplete_frame:
            raise _incomplete_frame_error(file_name, bytes_read, frame_bytes)
        rows = np.frombuffer(data, np.uint8, count=len(data) - extra_bytes).reshape(-1, frame_bytes)
        frames = rows if has_bytes else rows_to_numbers(rows, storage.word_form)
        yield FrameBatch(frames, bytes_read)


def _check_first_words(
    data: bytes, file_name: str, word_form: WordKind, layout: FrameLayout, find_valid_fraction: ValidFraction
) -> None:
    """Raise InputError if far more of the first frames are valid in another form of words.

    ``data`` is the beginning of the file, and ``word_form`` the chosen form. ``find_valid_fraction`` returns the
    fraction of valid frames.
    """
    # This is enough for the first frames in every form, because no word has more than eight bytes.
    first_bytes = data[: 8 * FIRST]
    chosen_frames = _read_first_frames(first_bytes, word_form, layout)
    other_forms = (
        (f"--words {other_form}", _read_first_frames(first_bytes, other_form, layout))
        for other_form in _list_other_forms(word_form, layout)
    )
    check_form(file_name, chosen_frames, other_forms, find_valid_fraction)


def _incomplete_frame_error(file_name: str, size: int, frame_bytes: int) -> InputError:
    """Return the error for a file that ends within a frame, where ``size`` bytes are known or were read."""
    whole_frames, extra_bytes = divmod(size, frame_bytes)
    extra_text = "1 more byte follows" if extra_bytes == 1 else f"{extra_bytes} more bytes follow"
    problem = f"{whole_frames} complete frames of {frame_bytes} bytes end here, and {extra_text}"
    return InputError(
        file_name, f"{problem}; ignore the rest with --cut, or cut=True", place=f"offset {whole_frames * frame_bytes}"
    )


def _read(file: BinaryIO, size: int) -> bytes:
    """Return ``size`` bytes, or the rest of the file if it is shorter. A pipe delivers them in pieces."""
    data = file.read(size)
    if len(data) == size or not data:
        return data
    pieces = [data]
    missing_count = size - len(data)
    while missing_count and (data := file.read(missing_count)):
        pieces.append(data)
        missing_count -= len(data)
    return b"".join(pieces)


def _find_word_length(word_form: WordKind, layout: FrameLayout) -> int:
    """Return the number of bytes that a frame of bits occupies in the file, such as 3 for 20 bits in packed words."""
    word_bytes, _ = WORDS[word_form]
    # 0 stands for packed words, which have as many bytes as the bits need.
    return word_bytes or (layout.bit_count + 7) // 8


def _list_other_forms(word_form: WordKind, layout: FrameLayout) -> Iterator[WordKind]:
    """Yield the forms other than ``word_form`` that are wide enough for these frames."""
    for other_form in get_args(WordKind):
        word_bits = 8 * _find_word_length(other_form, layout)
        if other_form != word_form and word_bits >= layout.bit_count:
            yield other_form


def _read_first_frames(first_bytes: bytes, word_form: WordKind, layout: FrameLayout) -> Any:
    """Return the first frames of a file as numbers, at most 1000. The frames are read in the form ``word_form``."""
    word_bytes = _find_word_length(word_form, layout)
    count = min(len(first_bytes) // word_bytes, FIRST)
    rows = np.frombuffer(first_bytes, np.uint8, count=count * word_bytes).reshape(-1, word_bytes)
    return rows_to_numbers(rows, word_form)
