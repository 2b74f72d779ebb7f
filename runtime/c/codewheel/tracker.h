/** @file
 * codewheel/tracker.h - unwraps positions, checks that they are plausible, and measures speed
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 *
 *     static cw_tracker axis;
 *
 *     cw_tracker_start(&axis, &config, now_us);          before the first frame
 *     cw_tracker_add(&axis, frame.position, now_us);     for each valid and usable frame
 *     cw_tracker_restart(&axis, now_us);                 after each preset, and to leave LOST
 *
 * axis.position is the last accepted position in counts. It continues across the wrap, where the
 * encoder's position returns to 0. It is valid only while axis.known is 1.
 *
 * A position that the axis cannot have reached is rejected. If too many positions are rejected in a
 * row, or if none is accepted for too long, the axis is LOST: axis.known is 0, axis.lost is 1, and
 * every position is rejected until you call _restart. A LOST axis may be anywhere, so bring the
 * machine to a safe state first, and check or home the position afterwards. You set both limits in
 * the configuration. If you set neither, the axis is never LOST, but a position out of reach is
 * still rejected, so watch axis.refused.
 *
 * The tracker uses only integers, no division and no allocation. Times are in microseconds, from a
 * 32-bit counter that wraps around. A gap of 2^32 us or more (71 minutes) looks like a short gap.
 * Pass the time at which the encoder sampled the position, which is the start of the frame:
 * timestamps taken at the end of the frame add jitter to the speed. Times must not go backwards: an
 * earlier time counts as a gap of more than an hour.
 */
#ifndef CODEWHEEL_TRACKER_H
#define CODEWHEEL_TRACKER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "result.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/tracker.h 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Limits of an axis. They depend on the machine, not on the encoder. A member that you omit from an
 * initializer is 0. For max_speed, 0 means that the axis never moves.
 */
typedef struct cw_tracker_config {
    /** counts after which the position wraps around to 0, from _modulus(), or 0 */
    uint64_t modulus;
    uint32_t max_speed; /**< highest speed in counts per second, or UINT32_MAX if unknown */
    /** time after start or restart during which a first position of 0 is rejected */
    uint32_t boot_us;
    uint32_t lost_after_us; /**< LOST if no position was accepted for longer than this (0: never) */
    uint32_t lost_after_refused; /**< LOST after this many consecutive rejections (0: never) */
} cw_tracker_config;

/** State of an axis. Read the members, but let only the functions write them. */
typedef struct cw_tracker {
    uint32_t known; /**< 1 if position is valid, 0 before the first position and while LOST */
    uint32_t lost; /**< 1 while LOST, until _restart */
    uint32_t at_us; /**< time of the last accepted position, or of the start */
    uint32_t refused; /**< positions rejected since the last accepted one */
    uint32_t elapsed_us; /**< time between the last two accepted positions */
    uint32_t limit; /**< private: maximum number of counts per 2^20 us */
    uint32_t boot_us; /**< private: as in the configuration */
    uint32_t lost_after_us; /**< private: 2^32 - 1: never */
    uint32_t refused_at_most; /**< private: lost_after_refused - 1 */
    uint64_t modulus; /**< private: as in the configuration */
    uint64_t raw; /**< last accepted position as the encoder sent it */
    int64_t position; /**< the same, unwrapped. Equals raw for the first position */
    int64_t moved; /**< counts between the last two accepted positions */
} cw_tracker;

/**
 * Time after which the reach no longer grows. The reach grows with the time since the last accepted
 * position, up to 2^19 us. An axis that moves unobserved for longer can move farther than this.
 */
#define CW_TRACKER_REACH_US 524288U

/**
 * Restart the axis. The next position is then treated as the first one, and boot_us starts again.
 * Call it after a preset, or anything else that moves the encoder's zero, once the encoder has
 * applied it, even if only in part. Discard the frame that was in progress, and do not let an
 * interrupt add a position during the call. It is also the only way out of LOST. After a preset to
 * 0, the position of an axis at rest is known only after boot_us.
 *
 * @param tracker  the axis
 * @param now_us  current time
 */
static inline void cw_tracker_restart(cw_tracker *tracker, uint32_t now_us)
{
    CW_ASSERT(tracker != NULL);
    tracker->known = 0U;
    tracker->lost = 0U;
    tracker->at_us = now_us;
    tracker->refused = 0U;
    tracker->elapsed_us = 0U;
    tracker->moved = 0;
}

/**
 * Set the limits of an axis and restart it. Call it before the first frame, and after a change of
 * resolution or of a limit. The modulus need not be a power of two. The tracker accepts steps up to
 * 1.3 percent larger than max_speed allows, with the time rounded up to 16 us and the result to a
 * whole count. An encoder may send 0 while it starts up. Set boot_us to cover that time, or to 0 if
 * a flag in the frame reports it. Once the axis can move half of the modulus within the time since
 * the last accepted position, any position is within reach, and turns can be missed. To make the
 * axis LOST before that, set lost_after_us below 500,000 * modulus / max_speed.
 *
 * @param tracker  the axis
 * @param config  the limits, which are copied
 * @param now_us  current time
 */
static inline void cw_tracker_start(
    cw_tracker *tracker, const cw_tracker_config *config, uint32_t now_us)
{
    CW_ASSERT((tracker != NULL) && (config != NULL));
    /* 1/16 more per 2^20 us is 1.3 percent more than max_speed, which is per second. A 16th rounded
       down is too little if max_speed is below 64. */
    const uint32_t margin =
        (config->max_speed >> 4U) + (((config->max_speed & 0xFU) != 0U) ? 1U : 0U);
    tracker->limit = (config->max_speed > (0xFFFFFFFFU - margin)) ?
        0xFFFFFFFFU : (config->max_speed + margin);
    tracker->boot_us = config->boot_us;
    tracker->lost_after_us = (config->lost_after_us == 0U) ? 0xFFFFFFFFU : config->lost_after_us;
    tracker->refused_at_most = config->lost_after_refused - 1U;
    tracker->modulus = config->modulus;
    tracker->raw = 0U;
    tracker->position = 0;
    cw_tracker_restart(tracker, now_us);
}

/**
 * Return the difference of two positions, taking the shorter way around. A step of half the
 * modulus counts as backwards. Negative differences are in two's complement. Adding or subtracting
 * the modulus once is enough, so no division is needed.
 */
static inline uint64_t cw_tracker_shorter(uint64_t difference, uint64_t modulus)
{
    uint64_t forward = difference;
    uint64_t backward;
    if ((forward >> 63U) != 0U) {
        forward += modulus;
    }
    backward = forward - modulus;
    return (((forward + backward) >> 63U) == 0U) ? backward : forward;
}

/** Return the maximum number of counts the shaft can move in this time. It is below 2^31. */
static inline uint32_t cw_tracker_reach(uint32_t limit, uint32_t elapsed_us)
{
    /* limit * units / 2^16 without a 64-bit product, which small processors do not have. */
    uint32_t units = (elapsed_us >> 4U) + 1U;
    if (units > (CW_TRACKER_REACH_US / 16U)) {
        units = CW_TRACKER_REACH_US / 16U;
    }
    return ((limit >> 16U) * units) + (((limit & 0xFFFFU) * units) >> 16U);
}

/** Mark the axis as lost and return LOST. */
CW_NODISCARD
static inline cw_result cw_tracker_lose(cw_tracker *tracker)
{
    tracker->known = 0U;
    tracker->lost = 1U;
    return CW_FAULT_LOST;
}

/**
 * Add a position. The first position is accepted without a check: if its CRC is short or missing,
 * compare two readings first (cw_ssi_repeats).
 *
 * @param tracker  the axis
 * @param position  position of a valid and usable frame, in counts. Cast a signed position to
 *                  uint64_t
 * @param now_us  start of that frame
 * @return
 *   OK     accepted, the members are updated.
 *   RANGE  rejected: position out of reach, or a 0 during boot_us. Only refused changes.
 *   LOST   rejected, like every position until _restart. The members known and lost indicate this,
 *          refused keeps counting, and the other members keep the last accepted position.
 */
static inline cw_result cw_tracker_add(
    cw_tracker *tracker, uint64_t position, uint32_t now_us)
{
    CW_ASSERT(tracker != NULL);
    const uint32_t elapsed_us = now_us - tracker->at_us;
    uint32_t reach;
    uint64_t moved;
    uint64_t counted;
    tracker->refused++;
    if (tracker->lost != 0U) {
        return CW_FAULT_LOST;
    }
    if (tracker->known == 0U) {
        if ((position == 0U) && (elapsed_us < tracker->boot_us)) {
            return CW_FAULT_RANGE;
        }
        tracker->known = 1U;
        tracker->raw = position;
        tracker->position = (int64_t)position;
    } else if (elapsed_us > tracker->lost_after_us) {
        return cw_tracker_lose(tracker);
    } else {
        /* Compare the position with the previous one. */
    }
    moved = cw_tracker_shorter(position - tracker->raw, tracker->modulus);
    reach = cw_tracker_reach(tracker->limit, elapsed_us);
    if ((moved + reach) > (2U * reach)) {
        return (tracker->refused > tracker->refused_at_most) ?
            cw_tracker_lose(tracker) : CW_FAULT_RANGE;
    }
    tracker->raw = position;
    counted = (uint64_t)tracker->position + moved;
    tracker->position = (int64_t)counted;
    tracker->at_us = now_us;
    tracker->moved = (int64_t)moved;
    tracker->elapsed_us = elapsed_us;
    tracker->refused = 0U;
    return CW_OK;
}

/**
 * Return a speed in counts per second, rounded toward 0. It is exact up to 9.2e12 counts. The
 * function divides bit by bit, which takes some microseconds on a small processor. Call it when you
 * need the speed, not for every frame.
 *
 * @param counts  counts that the axis moved
 * @param elapsed_us  time that the movement took
 * @return counts per second, or 0 if elapsed_us is 0
 */
static inline int64_t cw_counts_per_second(int64_t counts, uint32_t elapsed_us)
{
    const uint64_t distance = (counts < 0) ? (0U - (uint64_t)counts) : (uint64_t)counts;
    uint64_t quotient = distance * 1000000U;
    uint64_t remainder = 0U;
    uint32_t bit;
    if (elapsed_us == 0U) {
        return 0;
    }
    for (bit = 0U; bit < 64U; bit++) {
        remainder = (remainder << 1U) | (quotient >> 63U);
        quotient <<= 1U;
        if (remainder >= elapsed_us) {
            remainder -= elapsed_us;
            quotient |= 1U;
        }
    }
    if (counts < 0) {
        quotient = 0U - quotient;
    }
    return (int64_t)quotient;
}

/**
 * Return the same result as cw_counts_per_second(), computed with the compiler's division. It is
 * faster on a processor that divides in hardware, even if only 32 bits at a time. On a 32-bit
 * processor the division is a library function of some 800 bytes.
 *
 * @param counts  counts that the axis moved
 * @param elapsed_us  time that the movement took
 * @return counts per second, or 0 if elapsed_us is 0
 */
static inline int64_t cw_counts_per_second_divided(int64_t counts, uint32_t elapsed_us)
{
    uint64_t speed = (counts < 0) ? (0U - (uint64_t)counts) : (uint64_t)counts;
    if (elapsed_us == 0U) {
        return 0;
    }
    speed = (speed * 1000000U) / elapsed_us;
    if (counts < 0) {
        speed = 0U - speed;
    }
    return (int64_t)speed;
}

/**
 * Return the speed between the last two accepted positions, in counts per second. With frames close
 * together, a single count makes a large difference. For a steadier speed, keep an earlier position
 * and at_us, and pass the differences to cw_counts_per_second().
 */
static inline int64_t cw_tracker_speed(const cw_tracker *tracker)
{
    CW_ASSERT(tracker != NULL);
    return cw_counts_per_second(tracker->moved, tracker->elapsed_us);
}

#ifdef __cplusplus
}
#endif

#endif
