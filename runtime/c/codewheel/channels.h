/** @file
 * codewheel/channels.h - BiSS frames with several data channels, one directly after the other
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 * BiSS is a trademark of iC-Haus GmbH.
 *
 *   1 1 ...      0 0 0 ...     1       CDS   first word   second word   0      0 or 1 ...
 *   rest, delay  acknowledge   start         the channels               stop   ignored
 *
 * The functions of each encoder decode the words, each with its own CRC, and compare the positions
 * in them: see ..._channels_read in its header.
 *
 * Compiles as C99 and C++11. Needs no library and no allocation. Pointers must not be null. Not yet
 * tested on hardware.
 */
#ifndef CODEWHEEL_CHANNELS_H
#define CODEWHEEL_CHANNELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "receive.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/channels.h 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Find the data channels in the bits received on SLO. See cw_biss_receive_bits, which does the same
 * for a frame with a single word.
 *
 * @param rx  the received bits, packed into bytes
 * @param received  number of bits received, which need not fill whole bytes
 * @param bits  number of bits of all channels together
 * @param first  index of the first bit of the first channel
 * @return OK, or LINE_LOW, LINE_HIGH, NO_START, LENGTH or CONSTANT like cw_biss_receive_bits
 */
CW_NODISCARD
CW_CONSTEXPR
static inline cw_result cw_biss_receive_channels(
    const uint8_t *rx, size_t received, uint32_t bits, size_t *first)
{
    CW_ASSERT((rx != NULL) && (first != NULL));
    const size_t start = cw_biss_start(rx, received);
    const size_t stop = start + 2U + (size_t)bits;
    if (start > received) {
        return CW_FAULT_LINE_HIGH;
    }
    if (cw_received_bit(rx, 0U) == 0U) {
        return CW_FAULT_LINE_LOW;
    }
    if (start == received) {
        return CW_FAULT_NO_START;
    }
    if (stop > received) {
        return CW_FAULT_LENGTH;
    }
    if ((stop < received) && (cw_received_bit(rx, stop) != 0U)) {
        return CW_FAULT_CONSTANT;
    }
    *first = start + 2U;
    return CW_OK;
}

/**
 * Return whether two numbers differ by no more than a tolerance. The difference is taken the
 * shorter way around, since the lowest and the highest number are adjacent.
 *
 * @param number  the highest bits of one position
 * @param other  as many bits of the other position
 * @param bits  number of these bits, 1 to 64
 * @param tolerance  highest difference
 */
CW_CONSTEXPR
static inline bool cw_biss_positions_agree(
    uint64_t number, uint64_t other, uint32_t bits, uint64_t tolerance)
{
    const uint32_t unused = 64U - bits;
    const uint64_t mask = UINT64_MAX >> unused;
    const uint64_t up = (number - other) & mask;
    const uint64_t down = (other - number) & mask;
    return (up <= tolerance) || (down <= tolerance);
}

#ifdef __cplusplus
}
#endif

#endif
