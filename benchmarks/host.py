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
    words, replies = [], []
    for index in range(FRAMES):
        turns, angle = (index * 37) & 0xFFF, (index * 7919) & 0x3FFFFF
        words.append(word(frame, turns, angle) if frame.is_word else 0)
        replies.append(words[-1].to_bytes(6, "big") if frame.is_word else reply(turns, angle))
    length = len(covered(frame))
    rows = ",\n".join("{ " + ", ".join(map(str, data)) + " }" for data in replies)
    sources = []
    for index, candidate in enumerate(candidates):
        call = (
            candidate.call.replace("sizeof bytes", f"{len(replies[0])}U")
            .replace("sizeof covered", f"{length}U")
            .replace("covered", "bytes")
        )
        path = folder / f"host_{index}.c"
        # Decoder and loop are in one unit, so that the compiler can inline the decoder.
        path.write_text(f"""#include <stdint.h>
#include <stddef.h>
{candidate.source}
{"" if "covered" in candidate.globals else candidate.globals}
extern const uint64_t words[{FRAMES}];
extern const uint8_t replies[{FRAMES}][{len(replies[0])}];
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
""")
        sources.append(path)
    runs = "".join(f"unsigned run_{index}(void);\n" for index in range(len(candidates)))
    table = ", ".join(f"run_{index}" for index in range(len(candidates)))
    main = folder / "host_main.c"
    main.write_text(f"""#define _POSIX_C_SOURCE 199309L
#include <stdint.h>
#include <stdio.h>
#include <time.h>
{runs}
const uint64_t words[{FRAMES}] = {{ {", ".join(f"UINT64_C({value:#x})" for value in words)} }};
const uint8_t replies[{FRAMES}][{len(replies[0])}] = {{
{rows}
}};
int main(void)
{{
    static unsigned (*const runs[])(void) = {{ {table} }};
    static double best[{len(candidates)}];
    volatile unsigned sum = 0U;
    unsigned turn, index, times;
    for (turn = 0U; turn < {TURNS}U; turn++) {{
        for (index = 0U; index < {len(candidates)}U; index++) {{
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
    for (index = 0U; index < {len(candidates)}U; index++) {{
        printf("%f\\n", best[index]);
    }}
    return 0;
}}
""")
    objects = []
    for path in (*sources, main):
        # Each candidate is in its own unit, because the peers' helpers have the same names.
        target = path.with_suffix(".o")
        subprocess.run(
            ["cc", "-std=c11", "-O2", "-w", *(f"-I{item}" for item in include), "-c", str(path), "-o", str(target)],
            check=True,
            timeout=120,
        )
        objects.append(str(target))
    for made in objects[:-1]:
        subprocess.run(
            ["objcopy", f"--keep-global-symbol=run_{Path(made).stem.removeprefix('host_')}", made],
            check=True,
            timeout=60,
        )
    subprocess.run(["cc", *objects, "-o", str(folder / "host")], check=True, timeout=60)
    printed = subprocess.run(
        [str(folder / "host")], check=True, capture_output=True, text=True, timeout=300
    ).stdout.split()
    return {candidate.name: float(value) for candidate, value in zip(candidates, printed, strict=True)}
