"""``tracker.h`` and ``angle.h``: unwrapped positions, plausibility, speeds and angles.

Expected values are computed with Python's own integers and fractions, from the comments of the headers.
"""

from __future__ import annotations

import ctypes
import math
import random
import shutil
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import pytest
from c_harness import MadeOnce, compile_c
from motion_harness import LOST, OK, RANGE, Config, Tracker, compile_motion, motion_of

pytestmark = pytest.mark.slow

#: AMM5 with 17 bits, with 23 bits and 65,536 revolutions, one turn of 36,000 counts, SMA21 of 50 um, 5,000 mm long,
#: a prime, the minimum, and a position that never wraps around.
MODULI = (1 << 17, 1 << 39, 36_000, 100_000, 1_000_000_007, 2, 3, 0)
#: AMM5 6.1: 6,000 rpm with 23 bits, in counts per second.
FAST = 100 << 23


@pytest.fixture(scope="module")
def motion(include: Path, made_once: MadeOnce) -> ctypes.CDLL:
    return motion_of(made_once("motion", lambda folder: compile_motion(include, folder)))


def started_tracker(
    motion: ctypes.CDLL,
    modulus: int,
    max_speed: int = 0xFFFFFFFF,
    boot: int = 0,
    now: int = 0,
    lost: tuple[int, int] = (0, 0),
) -> Tracker:
    """Return a started tracker. ``lost`` contains the microseconds and the refusals after which the axis is lost."""
    tracker = Tracker(*[0x5A5A5A5A] * 13)
    config = Config(modulus, max_speed, boot, *lost)
    motion.tracker_start(ctypes.byref(tracker), ctypes.byref(config), now & 0xFFFFFFFF)
    return tracker


def restart(motion: ctypes.CDLL, tracker: Tracker, now: int) -> None:
    motion.tracker_restart(ctypes.byref(tracker), now & 0xFFFFFFFF)


def add(motion: ctypes.CDLL, tracker: Tracker, position: int, now: int) -> int:
    return int(motion.tracker_add(ctypes.byref(tracker), position, now & 0xFFFFFFFF))


def members(tracker: Tracker) -> tuple[int, ...]:
    """Return everything except the number of refused frames."""
    return tuple(getattr(tracker, name) for name, *_ in Tracker._fields_ if name != "refused")


# -- unwrapping


def test_a_turn_forward_and_back(motion: ctypes.CDLL) -> None:
    """With 17 bits, the step from 131,071 to 0 is one count forwards, and from 0 to 131,071 one count backwards."""
    tracker = started_tracker(motion, 1 << 17)
    steps = []
    for now, position in enumerate((131_070, 131_071, 0, 1, 0, 131_071)):
        assert add(motion, tracker, position, 1000 * now) == OK
        steps.append((tracker.position, tracker.moved))
    assert steps == [(131070, 0), (131071, 1), (131072, 1), (131073, 1), (131072, -1), (131071, -1)]


def test_a_turn_that_is_no_power_of_two(motion: ctypes.CDLL) -> None:
    """With 36,000 counts, the step from 35,990 to 20 is 30 forwards, and half a turn counts as backwards."""
    tracker = started_tracker(motion, 36_000)
    positions = []
    for now, position in enumerate((35_990, 20, 35_990, 17_990, 35_990)):
        assert add(motion, tracker, position, 1_000_000 * now) == OK
        positions.append(tracker.position)
    assert positions == [35_990, 36_020, 35_990, 17_990, -10]


def shorter(counts: int, modulus: int) -> int:
    """Return the shorter way round. If both are equally long, it is backwards."""
    if not modulus:
        return counts
    forward = counts % modulus
    return forward if 2 * forward < modulus else forward - modulus


def walk(seed: str, modulus: int, frames: int) -> Iterator[tuple[int, int, int]]:
    """Yield time, true position and limit of an axis that moves as far as it can, or less, between frames."""
    random_ = random.Random(f"{seed} {modulus}")
    max_speed = random_.choice([1000, 131_072, FAST])
    reach = (modulus - 1) // 2 if modulus else 1 << 40
    now, true = random_.getrandbits(32), random_.randrange(modulus or 1 << 40)
    for _ in range(frames):
        yield now, true, max_speed
        elapsed = random_.choice([0, 1, 17, 50, 1000, 20_000, 500_000])
        now += elapsed
        far = min(max_speed * elapsed // 1_000_000, reach)
        true += random_.choice([-far, far, random_.randint(-far, far)])


@pytest.mark.parametrize("modulus", MODULI)
def test_no_turn_is_lost_or_gained(modulus: int, motion: ctypes.CDLL) -> None:
    """20,000 frames: the time wraps around now and then, and every speed up to the limit is accepted."""
    tracker, offset, first, before = Tracker(), 0, True, (0, 0)
    for now, true, max_speed in walk("sound", modulus, 20_000):
        raw = true % modulus if modulus else true % (1 << 64)
        if first:
            tracker = started_tracker(motion, modulus, max_speed, 0, now)
            offset, first, before = raw - true, False, (now, true)
        assert add(motion, tracker, raw, now) == OK
        assert tracker.position == true + offset
        assert (tracker.moved, tracker.elapsed_us) == (true - before[1], now - before[0])
        assert (tracker.known, tracker.refused) == (1, 0)
        before = now, true


@pytest.mark.parametrize("modulus", [modulus for modulus in MODULI if not 0 < modulus < 1000])
def test_a_frame_that_is_too_far_changes_nothing(modulus: int, motion: ctypes.CDLL) -> None:
    """Each valid frame is followed by some that are farther than 1.3 percent and 16 us allow."""
    random_ = random.Random(modulus)
    tracker, refused = Tracker(), 0
    for index, (now, true, max_speed) in enumerate(walk("faults", modulus, 3_000)):
        raw = true % modulus if modulus else true % (1 << 64)
        if not index:
            tracker = started_tracker(motion, modulus, max_speed, 0, now)
        assert add(motion, tracker, raw, now) == OK
        for count in range(1, random_.randint(1, 3) + 1):
            after = random_.randrange(500)
            farthest = math.ceil(max_speed * 1.0133 * (after + 16) / 1_000_000)
            outlier = random_.choice([random_.randrange(modulus or 1 << 63), raw ^ 1 << random_.randrange(40), 0])
            if abs(shorter(outlier - raw, modulus)) <= farthest or outlier >= (modulus or 1 << 63):
                break
            state = members(tracker)
            assert add(motion, tracker, outlier, now + after) == RANGE
            assert tracker.refused == count
            assert members(tracker) == state
            refused += 1
    assert refused > 50


def test_an_absurd_position_is_not_believed(motion: ctypes.CDLL) -> None:
    tracker = started_tracker(motion, 36_000, 1_000_000)
    assert add(motion, tracker, 5, 0) == OK
    for position in (1 << 40, (1 << 63) + 5, 1 << 63, 72_000 + 17_000):
        assert add(motion, tracker, position, 100) == RANGE
    assert (tracker.position, tracker.refused) == (5, 4)


# -- plausibility


@pytest.mark.parametrize("max_speed", [1, 2, 4, 15, 33, 63, 999, 131_072, 5_000_000, FAST, 4_000_000_000])
@pytest.mark.parametrize("elapsed", [0, 1, 15, 16, 62, 1000, 65_535, 65_536, 502_873, 524_287])
def test_the_limit_is_the_speed_and_a_little_more(max_speed: int, elapsed: int, motion: ctypes.CDLL) -> None:
    """Everything that the speed allows is accepted, and nothing beyond 1.3 percent and 16 us more."""
    at_least = max_speed * elapsed // 1_000_000
    at_most = math.ceil(Fraction(max_speed * 10133 * (elapsed + 16), 10_000 * 1_000_000))
    for sign in (1, -1):
        tracker = started_tracker(motion, 0, max_speed)
        assert add(motion, tracker, 1 << 40, 0) == OK
        assert add(motion, tracker, (1 << 40) + sign * (at_most + 1), elapsed) == RANGE
        assert add(motion, tracker, (1 << 40) + sign * at_least, elapsed) == OK


def test_without_a_speed_the_limit_does_not_start_again(motion: ctypes.CDLL) -> None:
    """4,294,967,295 counts per second and 1/16 more do not fit into 32 bits."""
    for max_speed in (0xFFFFFFFF, 0xF0F0F0F1, 0xF0F0F0F0):
        tracker = started_tracker(motion, 0, max_speed)
        assert tracker.limit >= 0xFFFFFFFE


@pytest.mark.parametrize("modulus", [0, 1 << 39, 1 << 41])
def test_time_alone_never_makes_a_refused_position_plausible(modulus: int, motion: ctypes.CDLL) -> None:
    """An axis at 1,000,000,000 with at most 1,000,000 counts per second, and an encoder that restarts and sends zeros.

    The limit grows for 2^19 us. After an hour of zeros, half a second before the time wraps around, they are still
    refused.
    """
    tracker = started_tracker(motion, modulus, 1_000_000, 100_000, 7)
    assert add(motion, tracker, 1_000_000_000, 7) == OK
    state = members(tracker)
    for now in (*range(107, 2_000_000, 100_000), 524_294, 524_295, 524_296, 60_000_000, (1 << 32) - 500_000):
        assert add(motion, tracker, 0, 7 + now) == RANGE
    assert members(tracker) == state
    # A position within the limit, which grows for half a second, is accepted.
    assert add(motion, tracker, 1_000_500_000, 60_000_000) == OK
    assert (tracker.position, tracker.moved, tracker.elapsed_us) == (1_000_500_000, 500_000, 59_999_993)


@pytest.mark.parametrize("silence", [1, 2_000, 524_288, 3_000_000_000])
def test_lost_after_a_silence(silence: int, motion: ctypes.CDLL) -> None:
    """No position is accepted for longer than this time. A plausible one does not end the loss, nor does time."""
    tracker = started_tracker(motion, 1 << 23, 1000, 0, 0xFFFFFF00, (silence, 0))
    assert add(motion, tracker, 100, 0xFFFFFF00 + 5_000_000) == OK, "nothing is lost before the first"
    at = 0xFFFFFF00 + 5_000_000
    assert add(motion, tracker, 100, at + silence) == OK, "just in time"
    assert add(motion, tracker, 100, at + 2 * silence + 1) == LOST
    assert (tracker.known, tracker.lost, tracker.position, tracker.refused) == (0, 1, 100, 1)
    state = members(tracker)
    assert [add(motion, tracker, 100, at + 2 * silence + later) for later in (1, 2, 1_000_000, 1 << 31)] == [LOST] * 4
    assert (members(tracker), tracker.refused) == (state, 5)
    restart(motion, tracker, at)
    assert (tracker.known, tracker.lost, tracker.refused) == (0, 0, 0)
    assert add(motion, tracker, 4_000_000, at + 10_000_000) == OK
    assert (tracker.known, tracker.position) == (1, 4_000_000)


@pytest.mark.parametrize("limit", [1, 2, 7])
def test_lost_after_so_many_refused(limit: int, motion: ctypes.CDLL) -> None:
    """Only refusals in a row count, and an accepted position resets the number. Zeros during start-up do not count."""
    tracker = started_tracker(motion, 1 << 23, 1000, 5_000, 0, (0, limit))
    assert [add(motion, tracker, 0, now) for now in range(20)] == [RANGE] * 20
    assert add(motion, tracker, 100, 20) == OK
    for _ in range(3):
        assert [add(motion, tracker, 4_000_000, 21) for _ in range(limit - 1)] == [RANGE] * (limit - 1)
        assert add(motion, tracker, 100, 22) == OK
    assert [add(motion, tracker, 4_000_000, 23) for _ in range(limit)] == [RANGE] * (limit - 1) + [LOST]
    assert (tracker.known, tracker.lost, tracker.position, tracker.refused) == (0, 1, 100, limit)
    assert [add(motion, tracker, 100, now) for now in (24, 1_000_000)] == [LOST] * 2


def test_the_gate_of_the_start_holds_after_a_restart(motion: ctypes.CDLL) -> None:
    """The encoder loses its supply: zeros until the axis is lost, a restart, and then more zeros."""
    tracker = started_tracker(motion, 1 << 39, FAST, 2_000, 0, (0, 3))
    assert [add(motion, tracker, 77 << 30, now) for now in (0, 100)] == [OK, OK]
    assert [add(motion, tracker, 0, now) for now in (200, 300, 400, 500)] == [RANGE, RANGE, LOST, LOST]
    restart(motion, tracker, 600)
    assert [add(motion, tracker, 0, now) for now in (700, 1_500, 2_599)] == [RANGE] * 3
    assert add(motion, tracker, 78 << 30, 2_599) == OK
    assert tracker.position == 78 << 30


def test_a_preset_lets_the_count_begin_anew(motion: ctypes.CDLL) -> None:
    """The value of the preset is the first position. Without the restart, it would be refused."""
    tracker = started_tracker(motion, 1 << 23, 1000, boot=10_000)
    assert add(motion, tracker, 4_000_000, 0) == OK
    assert add(motion, tracker, 5, 100) == RANGE
    restart(motion, tracker, 200)
    assert (tracker.known, tracker.refused, tracker.moved, tracker.elapsed_us) == (0, 0, 0, 0)
    assert (tracker.modulus, tracker.limit) == (1 << 23, 1000 + 63)
    assert add(motion, tracker, 5, 300) == OK
    assert (tracker.known, tracker.position, tracker.at_us) == (1, 5, 300)
    assert add(motion, tracker, (1 << 23) - 1, 20_300) == OK
    assert (tracker.position, tracker.moved, tracker.elapsed_us) == (-1, -6, 20_000)
    # A preset to 0 is accepted after the time in which a 0 may not be a position.
    restart(motion, tracker, 20_400)
    assert [add(motion, tracker, 0, now) for now in (20_500, 30_399, 30_400)] == [RANGE, RANGE, OK]


def test_zeros_at_the_start_are_not_believed(motion: ctypes.CDLL) -> None:
    """AMM5 7.4.3: while BUSY, all position data are 0. The start is 100 us before the time wraps around."""
    tracker = started_tracker(motion, 1 << 39, FAST, 2000, 0xFFFFFF9C)
    assert [add(motion, tracker, 0, now) for now in (0xFFFFFF9C, 0, 1000, 1899)] == [RANGE] * 4
    assert (tracker.known, tracker.refused, tracker.position) == (0, 4, 0)
    assert add(motion, tracker, 77, 1899) == OK
    assert (tracker.known, tracker.refused, tracker.position) == (1, 0, 77)
    assert add(motion, tracker, 0, 1999) == OK, "once a position is known, 0 is one as any"
    late = started_tracker(motion, 1 << 39, FAST, 2000, 0xFFFFFF9C)
    assert [add(motion, late, 0, now) for now in (1899, 1900)] == [RANGE, OK], "a shaft may stand at 0"
    assert started_tracker(motion, 8).boot_us == 0
    assert add(motion, started_tracker(motion, 8), 0, 0) == OK


# -- speed


@pytest.mark.parametrize(
    ("counts", "elapsed", "speed"),
    [(0, 5, 0), (1, 1, 1_000_000), (-1, 3, -333_333), (FAST, 1_000_000, FAST), (-7, 0, 0), (1 << 43, 1, 10**6 << 43)],
)
def test_a_speed_by_hand(counts: int, elapsed: int, speed: int, motion: ctypes.CDLL) -> None:
    expected = speed if abs(speed) < 1 << 63 else speed - (1 << 64)
    assert motion.counts_per_second(counts, elapsed) == motion.counts_per_second_divided(counts, elapsed) == expected


def test_speeds(motion: ctypes.CDLL) -> None:
    random_ = random.Random("speeds")
    for _ in range(5_000):
        counts = random_.randint(-(1 << random_.randrange(43)), 1 << random_.randrange(43))
        elapsed = random_.randint(1, (1 << random_.randint(1, 32)) - 1)
        expected = abs(counts) * 1_000_000 // elapsed * (1 if counts >= 0 else -1)
        assert motion.counts_per_second(counts, elapsed) == expected
        assert motion.counts_per_second_divided(counts, elapsed) == expected


def test_the_speed_of_an_axis(motion: ctypes.CDLL) -> None:
    tracker = started_tracker(motion, 1 << 17)
    for position, now in ((131_000, 5), (60, 1005)):
        assert add(motion, tracker, position, now) == OK
    assert motion.tracker_speed(ctypes.byref(tracker)) == 132_000


# -- angles


@pytest.mark.parametrize(
    ("position", "steps", "angle"),
    [
        (0, 8, 0),
        (1, 8, 1 << 29),
        (9, 8, 1 << 29),
        (3, 4, 3 << 30),
        (9_000, 36_000, 1 << 30),
        (36_000 * 5 + 12_000, 36_000, (1 << 32) // 3),
        ((1 << 39) - 1, 1 << 23, 0xFFFFFE00),
        (7, 1, 0),
        (7, 0, 0),
        ((5 << 33) + 12, 1 << 33, 6),
        (1, 1 << 32, 1),
    ],
)
def test_an_angle_by_hand(position: int, steps: int, angle: int, motion: ctypes.CDLL) -> None:
    assert motion.angle(position, steps) == angle


def test_angles_of_any_number_of_steps(motion: ctypes.CDLL) -> None:
    random_ = random.Random("angles")
    for index in range(4_000):
        steps = 1 << random_.randrange(63) if index % 2 else random_.randint(1, 1 << random_.randint(1, 62))
        position = random_.getrandbits(64) >> random_.randrange(64)
        assert motion.angle(position, steps) == (position % steps << 32) // steps
    assert [motion.angle_highest_bit(1 << bit | bit) for bit in range(3, 64)] == list(range(3, 64))


def test_what_follows_from_an_angle(motion: ctypes.CDLL) -> None:
    random_ = random.Random("forms")
    edges = [0, 1, 0x7FFFFFFF, 0x80000000, 0x80000001, 0xFFFFFF00, 0xFFFFFFFF, 0x7FFF, 0x10000, 0x7FFFFFFF & ~0xFFFF]
    for angle in [*edges, *(random_.getrandbits(32) for _ in range(3_000))]:
        turn = Fraction(angle, 1 << 32)
        signed = angle - (1 << 32 if angle >= 1 << 31 else 0)
        assert motion.angle_q31(angle) == signed
        assert motion.angle_q15(angle) == signed >> 16
        assert motion.angle_millidegrees(angle) == math.floor(turn * 360_000 + Fraction(1, 2)) % 360_000
        degrees = motion.angle_degrees(angle)
        assert 0 <= degrees < 360
        assert abs(degrees - turn * 360) < 5e-5
        radians = motion.angle_radians(angle)
        assert -3.1415928 <= radians < 3.1415926
        assert abs(radians - Fraction(signed, 1 << 31) * Fraction(math.pi)) < 1e-6


@pytest.mark.parametrize("steps", [1 << 17, 1 << 23, 36_000])
def test_the_field_of_a_motor(steps: int, motion: ctypes.CDLL) -> None:
    """With seven pole pairs, the field turns seven times as fast, and one turn of the shaft returns it to its start."""
    random_ = random.Random(steps)
    for _ in range(1_000):
        position, offset = random_.randrange(steps), random_.getrandbits(32)
        angle = motion.angle_electrical(motion.angle(position, steps), 7, offset)
        expected = Fraction(7 * position, steps) - Fraction(offset, 1 << 32)
        difference = (expected - Fraction(angle, 1 << 32)) % 1
        assert difference < Fraction(7, 1 << 32)


# -- mistakes that the tests must find

FAULTS = {
    "modulus not added": ("tracker.h", "forward += modulus;", "forward += modulus - 1U;"),
    "low half of the limit": ("tracker.h", "& 0xFFFFU) * units) >> 16U", "& 0xFFFFU) * units) >> 17U"),
    "limit twice": ("tracker.h", "> (2U * reach)", "> (3U * reach)"),
    "time of a refused frame": (
        "tracker.h",
        "    if ((moved + reach) >",
        "    tracker->at_us = now_us;\n    if ((moved + reach) >",
    ),
    "no gate": ("tracker.h", "(position == 0U) &&", "(position == 1U) &&"),
    "reach that grows on": ("tracker.h", "units > (CW_TRACKER_REACH_US / 16U)", "units == 0U"),
    "silence": ("tracker.h", "elapsed_us > tracker->lost_after_us", "elapsed_us >= tracker->lost_after_us"),
    "silence that ends": ("tracker.h", "if (tracker->lost != 0U) {", "if (tracker->lost > 1U) {"),
    "how many refused": ("tracker.h", "lost_after_refused - 1U", "lost_after_refused"),
    "a silence without a limit": ("tracker.h", "== 0U) ? 0xFFFFFFFFU : config", "== 1U) ? 0xFFFFFFFFU : config"),
    "speed": ("tracker.h", "if (remainder >= elapsed_us)", "if (remainder > elapsed_us)"),
    "shift of an angle": ("angle.h", "up = 32U - bits", "up = 33U - bits"),
    "bits of a position": ("angle.h", "if (bits_left > appended_zeros)", "if (bits_left > (appended_zeros + 1U))"),
    "nearest": ("angle.h", "+ 0x80000000U) >> 32U", ") >> 32U"),
    "half a turn": ("angle.h", "- 0x7FFFFFFF - 1", "- 0x7FFFFFFF"),
    "offset": ("angle.h", ") - offset", ") + offset"),
}


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_seen(fault: str, include: Path, tmp_path: Path) -> None:
    header, sound, planted = FAULTS[fault]
    shutil.copytree(include, tmp_path / "include")
    path = tmp_path / "include" / "codewheel" / header
    text = path.read_text(encoding="ascii")
    assert text.count(sound) == 1
    path.write_text(text.replace(sound, planted), encoding="ascii")
    compile_motion(tmp_path / "include", tmp_path)
    broken, failed_checks = motion_of(tmp_path), 0
    for check in (
        lambda: test_a_turn_forward_and_back(broken),
        lambda: [test_no_turn_is_lost_or_gained(modulus, broken) for modulus in (1 << 17, 36_000)],
        lambda: [test_a_frame_that_is_too_far_changes_nothing(modulus, broken) for modulus in (1 << 17, 36_000)],
        lambda: [test_the_limit_is_the_speed_and_a_little_more(FAST, elapsed, broken) for elapsed in (1000, 65_536)],
        lambda: test_time_alone_never_makes_a_refused_position_plausible(1 << 39, broken),
        lambda: test_lost_after_a_silence(2_000, broken),
        lambda: test_lost_after_so_many_refused(2, broken),
        lambda: test_zeros_at_the_start_are_not_believed(broken),
        lambda: test_speeds(broken),
        lambda: test_angles_of_any_number_of_steps(broken),
        lambda: test_what_follows_from_an_angle(broken),
        lambda: test_the_field_of_a_motor(36_000, broken),
    ):
        try:
            check()
        except AssertionError:
            failed_checks += 1
    assert failed_checks


@pytest.mark.slow
def test_the_result_of_the_tracker_may_be_left(include: Path, tmp_path: Path) -> None:
    """A result of the tracker may be ignored, because the tracker stores it."""
    code = """#include "lika/amm5_biss.h"
#include "codewheel/tracker.h"
int main(void)
{
    const lika_amm5_biss encoder = LIKA_AMM5_BISS_A23_65KSC1;
    static cw_tracker axis;
    const cw_tracker_config config = { lika_amm5_biss_modulus(encoder), 838860800U, 0U, 0U, 0U };
    cw_tracker_start(&axis, &config, 0U);
    cw_tracker_add(&axis, 5U, 50U);
    return (axis.position == 5) ? 0 : 1;
}
"""
    compile_c(["gcc", "-std=c99", "-Wunused-result"], code, tmp_path, include)
