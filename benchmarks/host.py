"""Measure nanoseconds per frame on this machine. Candidates take turns in one program, and the best turn counts."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path

from candidates import Candidate, Frame, covered, reply, word

FRAMES, TURNS, TIMES = 256, 60, 400


def nanoseconds(
    frame: Frame, candidates: Sequence[Candidate], include: Sequence[Path], folder: Path
) -> dict[str, float]:
    """Return the time for one frame by the name of the candidate."""
    words, replies = samples(frame)
    sources = []
    for index, candidate in enumerate(candidates):
        sources.append(folder / f"host_{index}.c")
        sources[-1].write_text(candidate_source(frame, candidate, index, len(replies[0])))
    main = folder / "host_main.c"
    main.write_text(main_source(words, replies, len(candidates)))
    compile_options = ["-std=c11", "-O2", "-w", *(f"-I{path}" for path in include)]
    objects = []
    for source in (*sources, main):
        # Each candidate is in its own unit, because the peers' helpers have the same names.
        objects.append(str(source.with_suffix(".o")))
        command = ["cc", *compile_options, "-c", str(source), "-o", objects[-1]]
        subprocess.run(command, check=True, timeout=120)
    for index, object_file in enumerate(objects[:-1]):
        subprocess.run(["objcopy", f"--keep-global-symbol=run_{index}", object_file], check=True, timeout=60)
    program = str(folder / "host")
    subprocess.run(["cc", *objects, "-o", program], check=True, timeout=60)
    printed = subprocess.run([program], check=True, capture_output=True, text=True, timeout=300).stdout.split()
    return {candidate.name: float(value) for candidate, value in zip(candidates, printed, strict=True)}


def samples(frame: Frame) -> tuple[list[int], list[bytes]]:
    """Return different frames as words and as bytes. The words of a frame of bytes are 0."""
    words, replies = [], []
    for index in range(FRAMES):
        turns, angle = (index * 37) & 0xFFF, (index * 7919) & 0x3FFFFF
        words.append(word(frame, turns, angle) if frame.is_word else 0)
        replies.append(words[-1].to_bytes(6, "big") if frame.is_word else reply(turns, angle))
    return words, replies


def candidate_source(frame: Frame, candidate: Candidate, index: int, length: int) -> str:
    """Return C code with a candidate and a loop over all frames.

    Both are in one unit, so that the compiler can inline the decoder.
    """
    call = candidate.call.replace("sizeof bytes", f"{length}U")
    call = call.replace("sizeof covered", f"{len(covered(frame))}U").replace("covered", "bytes")
    return f"""#include <stdint.h>
#include <stddef.h>
{candidate.source}
{"" if "covered" in candidate.globals else candidate.globals}
extern const uint64_t words[{FRAMES}];
extern const uint8_t replies[{FRAMES}][{length}];
unsigned run_{index}(void);
unsigned run_{index}(void)
{{
    unsigned sum = 0U;
    unsigned at;
    for (at = 0U; at < {FRAMES}U; at++) {{
        const uint64_t word = words[at];
        const uint8_t *const bytes = replies[at];
        (void)word;
        (void)bytes;
        sum += (unsigned)({call});
        {"" if "&out" not in candidate.call else "sum += (unsigned)out.multiturn + (unsigned)out.singleturn;"}
    }}
    return sum;
}}
"""


def main_source(words: Sequence[int], replies: Sequence[bytes], count: int) -> str:
    """Return the program that calls this many candidates in turn, and prints the best time of each."""
    declarations = "".join(f"unsigned run_{index}(void);\n" for index in range(count))
    return f"""#define _POSIX_C_SOURCE 199309L
#include <stdint.h>
#include <stdio.h>
#include <time.h>
{declarations}
const uint64_t words[{FRAMES}] = {{ {", ".join(f"UINT64_C({value:#x})" for value in words)} }};
const uint8_t replies[{FRAMES}][{len(replies[0])}] = {{
{_rows(replies)}
}};
{_turns(count)}"""


def _rows(replies: Sequence[bytes]) -> str:
    rows = [", ".join(map(str, data)) for data in replies]
    return ",\n".join(f"{{ {row} }}" for row in rows)


def _turns(count: int) -> str:
    table = ", ".join(f"run_{index}" for index in range(count))
    return f"""int main(void)
{{
    static unsigned (*const runs[])(void) = {{ {table} }};
    static double best[{count}];
    volatile unsigned sum = 0U;
    unsigned turn, index, times;
    for (turn = 0U; turn < {TURNS}U; turn++) {{
        for (index = 0U; index < {count}U; index++) {{
            struct timespec from, to;
            double took;
            clock_gettime(CLOCK_MONOTONIC, &from);
            for (times = 0U; times < {TIMES}U; times++) {{
                sum += runs[index]();
            }}
            clock_gettime(CLOCK_MONOTONIC, &to);
            took = (double)(to.tv_sec - from.tv_sec) * 1e9 + (double)(to.tv_nsec - from.tv_nsec);
            took /= {TIMES}.0 * {FRAMES}.0;
            if (turn == 0U || took < best[index]) {{
                best[index] = took;
            }}
        }}
    }}
    for (index = 0U; index < {count}U; index++) {{
        printf("%f\\n", best[index]);
    }}
    return 0;
}}
"""
