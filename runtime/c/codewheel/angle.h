/** @file
 * codewheel/angle.h - angles as fractions of a turn, in millidegrees and as float
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 *
 * Here an angle is a 32-bit fraction of a turn, where one turn is 2^32. It wraps around by itself,
 * so you can add, subtract and multiply angles without handling the end of a turn. The other
 * functions convert angles. Only _degrees and _radians use float.
 *
 *     const uint32_t angle = cw_angle(frame.position, counts_per_turn);
 *     const uint32_t rotor = cw_angle_electrical(angle, pole_pairs, offset);
 *     const int32_t park = cw_angle_q31(rotor);
 */
#ifndef CODEWHEEL_ANGLE_H
#define CODEWHEEL_ANGLE_H

#include <stdint.h>

#include "version.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/angle.h 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Return the position of the highest 1 in a nonzero number. */
static inline uint32_t cw_angle_highest_bit(uint64_t number)
{
    uint64_t remaining = number;
    uint32_t bit = 0U;
    if ((remaining >> 32U) != 0U) {
        remaining >>= 32U;
        bit += 32U;
    }
    if ((remaining >> 16U) != 0U) {
        remaining >>= 16U;
        bit += 16U;
    }
    if ((remaining >> 8U) != 0U) {
        remaining >>= 8U;
        bit += 8U;
    }
    if ((remaining >> 4U) != 0U) {
        remaining >>= 4U;
        bit += 4U;
    }
    if ((remaining >> 2U) != 0U) {
        remaining >>= 2U;
        bit += 2U;
    }
    return bit + (((remaining >> 1U) != 0U) ? 1U : 0U);
}

/**
 * Return the angle of a position within its turn, rounded down. Full turns are ignored. If steps is
 * a power of two, the function only shifts, and if steps is also a constant, the compiler removes
 * the other code. For any other number, the function divides bit by bit, with the same result on
 * every processor.
 *
 * @param position  position in counts
 * @param steps  counts per turn, from _counts_per_turn() in the encoder's header. For a linear
 *               motor, counts per magnetic period. Must be below 2^63
 * @return the angle, or 0 if steps is 0
 */
static inline uint32_t cw_angle(uint64_t position, uint64_t steps)
{
    uint64_t remainder = 0U;
    uint32_t angle = 0U;
    const uint32_t position_bits = 64U;
    const uint32_t appended_zeros = 32U;
    uint32_t bits_left;
    if (steps == 0U) {
        return 0U;
    }
    if ((steps & (steps - 1U)) == 0U) {
        const uint32_t bits = cw_angle_highest_bit(steps);
        uint64_t shifted = position;
        if (bits > 32U) {
            const uint32_t down = bits - 32U;
            shifted >>= down;
        } else {
            const uint32_t up = 32U - bits;
            shifted <<= up;
        }
        return (uint32_t)(shifted & UINT32_MAX);
    }
    /* Long division of the position with zeros appended. The quotient is the angle. */
    for (bits_left = position_bits + appended_zeros; bits_left > 0U; bits_left--) {
        remainder <<= 1U;
        if (bits_left > appended_zeros) {
            const uint32_t position_bit = (bits_left - appended_zeros) - 1U;
            remainder |= (position >> position_bit) & 1U;
        }
        angle <<= 1U;
        if (remainder >= steps) {
            remainder -= steps;
            angle |= 1U;
        }
    }
    return angle;
}

/**
 * Return the electrical angle of a motor.
 *
 * @param angle  mechanical angle
 * @param pole_pairs  pole pairs of the motor
 * @param offset  the result of this function with offset 0 while the field is at 0
 * @return angle * pole_pairs - offset
 */
static inline uint32_t cw_angle_electrical(uint32_t angle, uint32_t pole_pairs, uint32_t offset)
{
    return (angle * pole_pairs) - offset;
}

/** Return an angle as Q31, where -1 to below 1 means -180 to below 180 degrees. */
static inline int32_t cw_angle_q31(uint32_t angle)
{
    const uint32_t half = 0x80000000U;
    const uint32_t above = angle - half;
    return (angle < half) ? (int32_t)angle : ((int32_t)above - 0x7FFFFFFF - 1);
}

/** Return an angle as Q15, where -1 to below 1 means -180 to below 180 degrees. */
static inline int16_t cw_angle_q15(uint32_t angle)
{
    const uint32_t upper = angle >> 16U;
    int32_t parts = (int32_t)upper;
    if (parts >= 32768) {
        parts -= 65536;
    }
    return (int16_t)parts;
}

/** Return an angle in thousandths of a degree, rounded to nearest, 0 to 359,999. */
static inline uint32_t cw_angle_millidegrees(uint32_t angle)
{
    const uint32_t nearest = (uint32_t)((((uint64_t)angle * 360000U) + 0x80000000U) >> 32U);
    return (nearest < 360000U) ? nearest : 0U;
}

/**
 * Return an angle in degrees, from 0 to less than 360. Uses the upper 24 bits, the precision of a
 * float.
 */
static inline float cw_angle_degrees(uint32_t angle)
{
    const uint32_t upper = angle >> 8U;
    return (float)upper * (360.0F / 16777216.0F);
}

/** Return an angle in radians, -pi to below pi. Uses its upper 24 bits. */
static inline float cw_angle_radians(uint32_t angle)
{
    const uint32_t upper = angle >> 8U;
    int32_t parts = (int32_t)upper;
    if (parts >= 0x800000) {
        parts -= 0x1000000;
    }
    return (float)parts * (6.2831853F / 16777216.0F);
}

#ifdef __cplusplus
}
#endif

#endif
