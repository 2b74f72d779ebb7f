"""Find the text of the page layout in a manual: page numbers and running heads."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import chain, pairwise

_PAGE_NUMBER = re.compile(
    r"[\s\-]*\d{1,4}[\s\-]*|(?:page|pag\.?|seite)\s+\d{1,4}(?:\s*(?:of|di|/)\s*\d{1,4})?", re.IGNORECASE
)
#: Least number of times that a line is printed to be a running head, and the longest such line.
LEAST_REPETITIONS, LONGEST_HEAD = 4, 120
#: Number of lines at the top or bottom of a page, and the least share of the lines of a running head that are there.
_EDGE_LINES, _LEAST_HEAD_SHARE = 4, 0.8
#: The same with a form feed between pages, which shows where they end.
_PAGE_EDGE = 2
#: Least part of a text that page numbers span. The numbers of steps or of the rows of a table span less.
_LEAST_PAGE_SPREAD = 0.5
#: Least usual number of lines on a page, and largest factor by which a page is longer or shorter than usual.
_SHORT_PAGE, _LARGEST_PAGE_FACTOR = 12, 2
#: Largest step between two page numbers that are found. The first page of a chapter often has no page number.
_PAGE_STEP = 3


def without_digits(line: str) -> str:
    """Return a line with # for each number, so that running heads with different pages are equal."""
    return re.sub(r"\d+", "#", line.strip())


def find_lines_of_page_numbers(lines: Sequence[str]) -> set[int]:
    """Return the indices of lines that contain only a page number, or an empty set if there are fewer than 4.

    The page numbers are the longest series of numbers that increase by 1 to 3.
    """
    # For each page: the lines of the longest series that ends with it.
    series_by_last_page: dict[int, list[int]] = {}
    for index, line in enumerate(lines):
        is_only_page = _PAGE_NUMBER.fullmatch(line) is not None
        number_match = re.search(r"\d{1,4}", line) if is_only_page else None
        if number_match is None:
            continue
        page = int(number_match[0])
        previous_pages = [page - step for step in range(1, _PAGE_STEP + 1)]
        previous_series = max((series_by_last_page.get(previous, []) for previous in previous_pages), key=len)
        # The same number can be on several lines, such as in a table. The longest series that ends with it counts.
        known_series = series_by_last_page.get(page, [])
        series_by_last_page[page] = max(known_series, [*previous_series, index], key=len)
    longest_series = max(series_by_last_page.values(), key=len, default=[])
    return set(longest_series) if len(longest_series) >= LEAST_REPETITIONS else set()


def find_lines_of_running_heads(lines: Sequence[str], headings: set[int]) -> set[int]:
    """Return the indices of the lines of running heads, which are printed on many pages.

    The lines of a running head differ only in their numbers. They contain increasing page numbers, occur at regular
    distances, or are close to such lines. Rows of tables can also repeat, but without these properties.
    """
    indices_by_head: dict[str, list[int]] = {}
    for index, line in enumerate(lines):
        if len(line) <= LONGEST_HEAD and index not in headings:
            indices_by_head.setdefault(without_digits(line), []).append(index)
    heads_with_page: set[str] = set()
    running_heads: set[str] = set()
    for head, indices in _spread_heads(indices_by_head, len(lines)).items():
        if _counts_pages([lines[index] for index in indices]):
            heads_with_page.add(head)
        if _is_regular(indices):
            running_heads.add(head)
    lines_with_page = sorted(chain.from_iterable(indices_by_head[head] for head in heads_with_page))
    counts_at_edges = _count_near_pages(lines, lines_with_page)
    for head, indices in indices_by_head.items():
        is_mostly_at_edges = counts_at_edges[head] >= _LEAST_HEAD_SHARE * len(indices)
        if len(indices) >= LEAST_REPETITIONS and is_mostly_at_edges:
            running_heads.add(head)
    return set(chain.from_iterable(indices_by_head[head] for head in running_heads | heads_with_page))


def _spread_heads(indices_by_head: Mapping[str, list[int]], line_count: int) -> dict[str, list[int]]:
    """Return the lines that are printed at least 4 times, the first and the last at least half of the text apart.

    ``indices_by_head`` contains the indices of each line, without its numbers, in ascending order.
    """
    spread_heads: dict[str, list[int]] = {}
    for head, indices in indices_by_head.items():
        is_spread = indices[-1] - indices[0] >= _LEAST_PAGE_SPREAD * line_count
        if len(indices) >= LEAST_REPETITIONS and is_spread:
            spread_heads[head] = indices
    return spread_heads


def _count_near_pages(lines: Sequence[str], lines_with_page: Sequence[int]) -> Counter[str]:
    """Return for each line how many page numbers it is printed near, at most 4 lines before or after."""
    counts: Counter[str] = Counter()
    last_edge: int | None = None
    for index in lines_with_page:
        # If two page numbers are close together, they are at the same edge, whose lines are counted once.
        if last_edge is None or index - last_edge > _EDGE_LINES:
            lines_at_edge = lines[max(index - _EDGE_LINES, 0) : index + _EDGE_LINES + 1]
            counts.update({without_digits(line) for line in lines_at_edge})
            last_edge = index
    return counts


def _is_regular(indices: Sequence[int]) -> bool:
    """Return whether a line is printed at regular distances, like a line that is on each page.

    At least 80 % of the distances are between half and twice the median distance, which is at least 12 lines.
    """
    distances = sorted(following - previous for previous, following in pairwise(indices))
    median_index = len(distances) // 2
    usual_distance = distances[median_index]
    shortest_usual = usual_distance / _LARGEST_PAGE_FACTOR
    longest_usual = usual_distance * _LARGEST_PAGE_FACTOR
    distances_near_usual = [distance for distance in distances if shortest_usual <= distance <= longest_usual]
    are_mostly_near_usual = len(distances_near_usual) >= _LEAST_HEAD_SHARE * len(distances)
    return usual_distance >= _SHORT_PAGE and are_mostly_near_usual


def find_heads_at_edges(pages: Sequence[Sequence[str]]) -> set[str]:
    """Return the lines, with # for numbers, that occur at least 4 times at the edges of pages, and mostly there.

    An edge is the first or last 2 lines of a page. At least 80 % of the occurrences must be there.
    """
    counts_anywhere: Counter[str] = Counter()
    counts_at_edges: Counter[str] = Counter()
    for page in pages:
        top = page[:_PAGE_EDGE]
        below_top = page[_PAGE_EDGE:]
        # On a short page, the bottom does not contain lines of the top again.
        bottom = below_top[-_PAGE_EDGE:]
        counts_anywhere.update(map(without_digits, page))
        counts_at_edges.update(map(without_digits, (*top, *bottom)))
    heads: set[str] = set()
    for head, count in counts_at_edges.items():
        is_mostly_at_edges = count >= _LEAST_HEAD_SHARE * counts_anywhere[head]
        if count >= LEAST_REPETITIONS and is_mostly_at_edges:
            heads.add(head)
    return heads


def without_edges(pages: Sequence[Sequence[str]], heads: Collection[str]) -> Iterator[Sequence[str]]:
    """Yield the lines of each page, without page numbers and running heads among its first and last two."""
    for page in pages:
        first_bottom_index = len(page) - _PAGE_EDGE
        remaining_lines: list[str] = []
        for index, line in enumerate(page):
            is_at_edge = not _PAGE_EDGE <= index < first_bottom_index
            is_head_or_page = without_digits(line) in heads or bool(_PAGE_NUMBER.fullmatch(line))
            if not is_at_edge or not is_head_or_page:
                remaining_lines.append(line)
        yield remaining_lines


def _counts_pages(lines: Sequence[str]) -> bool:
    """Return whether the numbers in lines increase from line to line like page numbers.

    Numbers that are the same in all lines are ignored, but at least one must change: ``Manual 1.2 page 3`` and
    ``Manual 1.2 page 4``.
    """
    numbers_by_line = [list(map(int, re.findall(r"\d{1,4}", line))) for line in lines]
    # The first numbers of all lines, the second numbers of all lines, and so on.
    columns = zip(*numbers_by_line, strict=False)
    changing_columns = [column for column in columns if len(set(column)) > 1]
    return bool(changing_columns) and all(map(_do_increase, changing_columns))


def _do_increase(numbers: Sequence[int]) -> bool:
    return all(number < following for number, following in pairwise(numbers))
