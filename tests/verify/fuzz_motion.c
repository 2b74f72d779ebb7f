/*
 * Fuzz target for the headers of motion: positions and times of any kind, an axis that moves within
 * its limit, of which no count may be lost, and all functions on angles with any number.
 */
#include "codewheel/angle.h"
#include "codewheel/tracker.h"
#include "fuzz.h"

/* Return true if all members are equal except refused, known and lost. */
static bool same(const cw_tracker *one, const cw_tracker *two)
{
    return one->at_us == two->at_us && one->elapsed_us == two->elapsed_us && one->limit == two->limit
        && one->boot_us == two->boot_us && one->lost_after_us == two->lost_after_us
        && one->refused_at_most == two->refused_at_most && one->modulus == two->modulus && one->raw == two->raw
        && one->position == two->position && one->moved == two->moved;
}

/* Any input: a refused frame changes only its count, and may cause the axis to be lost. */
static void anything(void)
{
    cw_tracker axis;
    uint32_t now = (uint32_t)take(4U);
    cw_tracker_config config = { 0U, 0U, 0U, 0U, 0U };
    config.modulus = take((take(1U) & 1U) * 7U);
    config.max_speed = (uint32_t)take(4U);
    config.boot_us = (uint32_t)take(2U);
    config.lost_after_us = (uint32_t)take(3U);
    config.lost_after_refused = (uint32_t)take(1U);
    cw_tracker_start(&axis, &config, now);
    while (left > 0U) {
        const cw_tracker before = axis;
        const uint64_t position = take(7U);
        cw_result result;
        now += (uint32_t)take(3U);
        if ((take(1U) & 31U) == 0U) {
            cw_tracker_restart(&axis, now);
            require(axis.known == 0U && axis.lost == 0U && axis.modulus == config.modulus && axis.limit == before.limit
                && axis.boot_us == config.boot_us, "a restart that forgets too much");
            result = cw_tracker_add(&axis, position, now);
            require(result == ((position == 0U && config.boot_us != 0U) ? CW_FAULT_RANGE : CW_OK), "the first");
            continue;
        }
        result = cw_tracker_add(&axis, position, now);
        if (result == CW_OK) {
            require(axis.known == 1U && axis.refused == 0U && axis.raw == position && axis.at_us == now && before.lost == 0U, "not taken in");
        } else {
            require(same(&before, &axis) && axis.refused == before.refused + 1U, "a refusal that changes something");
            require(result == CW_FAULT_LOST ? (axis.lost == 1U && axis.known == 0U)
                : (axis.lost == 0U && axis.known == before.known), "lost, and not said");
            require(result == CW_FAULT_LOST || before.lost == 0U, "a lost axis that is found");
        }
        (void)cw_tracker_speed(&axis);
    }
}

/* An axis within its limit, with an occasional frame far from it. */
static void followed(void)
{
    cw_tracker axis;
    const int64_t modulus = 1000000 + (int64_t)take(4U);
    const int64_t start = (int64_t)(take(4U) % (uint64_t)modulus);
    int64_t shaft = start;
    uint32_t now = (uint32_t)take(4U);
    const cw_tracker_config config = { (uint64_t)modulus, 1000000U, 0U, 0U, 0U };
    cw_tracker_start(&axis, &config, now);
    require(cw_tracker_add(&axis, (uint64_t)start, now) == CW_OK, "the first");
    while (left > 0U) {
        const uint32_t passed = (uint32_t)take(2U);
        const int64_t moved = ((int64_t)(take(3U) % (2U * (uint64_t)passed + 1U))) - (int64_t)passed;
        const uint32_t what = (uint32_t)take(1U);
        now += passed;
        shaft += moved;
        if (what < 32U) {
            /* The axis is lost, and the next position comes soon. The limit grows with the time. */
            const int64_t sent = (shaft + (modulus / 2)) % modulus;
            require(cw_tracker_add(&axis, (uint64_t)((sent < 0) ? sent + modulus : sent), now) == CW_FAULT_RANGE, "half a turn");
        }
        require(cw_tracker_add(&axis, (uint64_t)(((shaft % modulus) + modulus) % modulus), now) == CW_OK, "one in reach");
        require(axis.position == shaft, "a count that is lost");
    }
}

static void angles(void)
{
    const uint64_t position = take(8U);
    const uint64_t steps = take(8U) >> 1U;
    const uint32_t angle = cw_angle(position, steps);
    const float degrees = cw_angle_degrees(angle);
    const float radians = cw_angle_radians(angle);
    require(degrees >= 0.0F && degrees < 360.0F && radians >= -3.1415929F && radians < 3.1415929F, "past a turn");
    require(cw_angle_electrical(angle, 1U, angle) == 0U, "an offset that is not taken off");
    require(cw_angle_millidegrees(angle) < 360000U, "past a turn");
    require((uint32_t)cw_angle_q31(angle) == angle && (uint16_t)cw_angle_q15(angle) == (uint16_t)(angle >> 16U), "other bits");
    (void)cw_counts_per_second((int64_t)take(5U) - INT64_C(0x8000000000), (uint32_t)take(4U));
    (void)cw_counts_per_second((int64_t)position, (uint32_t)steps);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    input = data;
    left = size;
    switch (take(1U) % 3U) {
    case 0U:
        anything();
        break;
    case 1U:
        followed();
        break;
    default:
        angles();
        break;
    }
    return 0;
}
