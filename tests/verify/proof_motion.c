/*
 * Claims about tracker.h and angle.h, for every state and every number that a caller may pass. The
 * numbers of the claims are computed with 128 bits, so that nothing overflows.
 */
#include "codewheel/tracker.h"
#include "codewheel/angle.h"

typedef __int128 wide;
uint64_t nondet_word(void);
uint32_t nondet_number(void);

/* An axis as the functions leave it: if it has a position, that is one of the encoder. */
static cw_tracker any_axis(void)
{
    cw_tracker axis;
    axis.known = nondet_number();
    axis.lost = nondet_number();
    __CPROVER_assume(axis.known <= 1U && axis.lost <= 1U && axis.known + axis.lost < 2U);
    __CPROVER_assume(axis.modulus < (1ULL << 61));
    __CPROVER_assume(axis.modulus == 0U || axis.raw < axis.modulus);
    __CPROVER_assume(axis.raw < (1ULL << 61));
    __CPROVER_assume(axis.position > -(1LL << 61) && axis.position < (1LL << 61));
    return axis;
}

/* An accepted position is the one that was sent, at the stated distance from the one before. The time since then is a
 * constant, because a product of two arbitrary numbers is too hard.
 */
static void believed_after(uint32_t elapsed)
{
    cw_tracker axis = any_axis();
    const cw_tracker before = axis;
    const uint64_t position = nondet_word();
    const uint32_t now = before.at_us + elapsed;
    __CPROVER_assume(position < (1ULL << 61) && (axis.modulus == 0U || position < axis.modulus));
    if (cw_tracker_add(&axis, position, now) != CW_OK) return;
    __CPROVER_assert(axis.raw == position && axis.at_us == now && axis.refused == 0U && axis.known == 1U, "is taken in");
    __CPROVER_assert(axis.limit == before.limit && axis.modulus == before.modulus && axis.boot_us == before.boot_us
        && axis.lost_after_us == before.lost_after_us && axis.refused_at_most == before.refused_at_most, "what was set stays");
    __CPROVER_assert(before.lost == 0U && axis.lost == 0U, "never while the axis is lost");
    __CPROVER_assert(before.known == 0U || elapsed <= before.lost_after_us, "not after a silence");
    if (before.known == 0U) {
        __CPROVER_assert(axis.position == (int64_t)position && axis.moved == 0, "the first is as it was sent");
        __CPROVER_assert(position != 0U || elapsed >= before.boot_us, "no 0 while it starts up");
        return;
    }
    const int64_t moved = axis.moved, ahead = (int64_t)position - (int64_t)before.raw, whole = (int64_t)axis.modulus;
    __CPROVER_assert(axis.position == before.position + moved && axis.elapsed_us == elapsed, "how far, in what time");
    __CPROVER_assert(moved == ahead || moved == ahead + whole || moved == ahead - whole, "goes round whole times");
    __CPROVER_assert(whole == 0 || (2 * moved < whole && 2 * moved >= -whole), "the shorter way");
    const uint32_t reach_us = elapsed < CW_TRACKER_REACH_US ? elapsed : CW_TRACKER_REACH_US - 1U;
    __CPROVER_assert((moved < 0 ? -moved : moved) <= (int64_t)(((uint64_t)axis.limit * (reach_us / 16U + 1U)) >> 16),
        "no farther than the limit, however long ago");
}
void what_is_believed_at_once(void) { believed_after(0U); }
void what_is_believed_after_a_cycle(void) { believed_after(50U); }
void what_is_believed_after_a_while(void) { believed_after(524287U); }
void what_is_believed_after_a_silence(void) { believed_after(524288U); }
void what_is_believed_after_an_hour(void) { believed_after(3600000000U); }

/* Any input: a position that is not accepted is counted, and changes nothing else, except that the axis may be lost. */
static void refused_after(uint32_t elapsed)
{
    cw_tracker axis = any_axis();
    const cw_tracker before = axis;
    const uint64_t position = nondet_word();
    const uint32_t now = before.at_us + elapsed;
    const cw_result result = cw_tracker_add(&axis, position, now);
    if (result == CW_OK) return;
    __CPROVER_assert(axis.refused == before.refused + 1U, "is counted");
    __CPROVER_assert(axis.at_us == before.at_us && axis.limit == before.limit && axis.boot_us == before.boot_us
        && axis.lost_after_us == before.lost_after_us && axis.refused_at_most == before.refused_at_most
        && axis.elapsed_us == before.elapsed_us && axis.raw == before.raw && axis.position == before.position
        && axis.moved == before.moved && axis.modulus == before.modulus, "and nothing else");
    __CPROVER_assert(result == CW_FAULT_LOST ? (axis.known == 0U && axis.lost == 1U)
        : (result == CW_FAULT_RANGE && axis.known == before.known && axis.lost == 0U && before.lost == 0U),
        "lost is what it says");
    __CPROVER_assert(result != CW_FAULT_LOST || before.lost != 0U || before.known != 0U, "nothing is lost before the first");
    __CPROVER_assert((result == CW_FAULT_LOST) == (before.lost != 0U || (before.known != 0U
        && (elapsed > before.lost_after_us || axis.refused > before.refused_at_most))), "lost by what was set, and by nothing else");
}
void what_is_refused_after_a_cycle(void) { refused_after(50U); }
void what_is_refused_after_a_silence(void) { refused_after(524288U); }

/* If both limits are 0, an axis is never lost, and only a restart ends a loss. */
void what_was_lost(void)
{
    const cw_tracker_config never = { nondet_word(), nondet_number(), nondet_number(), 0U, 0U };
    cw_tracker axis;
    cw_tracker_start(&axis, &never, nondet_number());
    __CPROVER_assert(axis.lost_after_us == 0xFFFFFFFFU && axis.refused_at_most == 0xFFFFFFFFU, "never");
    axis = any_axis();
    __CPROVER_assume(axis.lost == 1U);
    __CPROVER_assert(cw_tracker_add(&axis, nondet_word(), nondet_number()) == CW_FAULT_LOST && axis.lost == 1U, "whatever comes");
    const uint32_t boot_us = axis.boot_us, now = nondet_number();
    cw_tracker_restart(&axis, now);
    __CPROVER_assert(axis.boot_us == boot_us, "the gate stays");
    __CPROVER_assert(cw_tracker_add(&axis, 1U, now) == CW_OK && axis.known == 1U, "and begins anew");
}

/* A number of counts that the speed allows is always accepted. */
static void allowed_after(uint32_t elapsed)
{
    cw_tracker axis;
    const uint32_t max_speed = nondet_number(), start = nondet_number();
    const uint64_t from = nondet_word(), to = nondet_word();
    __CPROVER_assume(from < (1ULL << 61) && to < (1ULL << 61));
    const uint64_t distance = from < to ? to - from : from - to;
    __CPROVER_assume(max_speed <= 4000000000U && distance < (1ULL << 42));
    __CPROVER_assume(distance * 1000000U <= (uint64_t)max_speed * elapsed);
    const cw_tracker_config config = { 0U, max_speed, 0U, 0U, 0U };
    cw_tracker_start(&axis, &config, start);
    __CPROVER_assert(cw_tracker_add(&axis, from, start) == CW_OK, "the first");
    __CPROVER_assert(cw_tracker_add(&axis, to, start + elapsed) == CW_OK, "and one in reach");
}
void what_the_speed_allows_in_a_cycle(void) { allowed_after(50U); }
void what_the_speed_allows_in_a_while(void) { allowed_after(524287U); }

void highest_bit(void)
{
    const uint64_t number = nondet_word();
    __CPROVER_assume(number != 0U);
    const uint32_t bit = cw_angle_highest_bit(number);
    __CPROVER_assert(bit < 64U && (number >> bit) == 1U, "the highest bit");
}

/* A power of two: the bits of the turn, at the upper end of 32. */
void angle_of_a_power_of_two(void)
{
    const uint64_t position = nondet_word();
    const uint32_t bits = nondet_number();
    __CPROVER_assume(bits < 63U);
    const wide rest = (wide)(position & ((1ULL << bits) - 1U));
    __CPROVER_assert(cw_angle(position, 1ULL << bits) == (uint32_t)((rest << 32) >> bits), "its angle");
}

void forms_of_an_angle(void)
{
    const uint32_t angle = nondet_number();
    __CPROVER_assert((uint32_t)cw_angle_q31(angle) == angle, "the same bits");
    __CPROVER_assert((uint16_t)cw_angle_q15(angle) == (uint16_t)(angle >> 16), "the same bits");
    __CPROVER_assert(cw_angle_millidegrees(angle) < 360000U, "less than a turn");
}
