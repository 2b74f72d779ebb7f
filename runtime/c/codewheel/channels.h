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
 * cw_biss_find_frame in receive.h finds the first word. The functions of each encoder decode the
 * words, each with its own CRC, and compare the positions in them: see ..._channels_receive in its
 * header.
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
 * Return whether two numbers differ by no more than a tolerance. The difference is taken the
 * shorter way around, since the lowest and the highest number are adjacent.
 *
 * @param first  the highest bits of one position
 * @param second  as many bits of the other position
 * @param bits  number of these bits, 1 to 64
 * @param tolerance  highest difference
 */
CW_CONSTEXPR
static inline bool cw_biss_positions_agree(
    uint64_t first, uint64_t second, uint32_t bits, uint64_t tolerance)
{
    const uint32_t unused = 64U - bits;
    const uint64_t mask = UINT64_MAX >> unused;
    const uint64_t up = (first - second) & mask;
    const uint64_t down = (second - first) & mask;
    return (up <= tolerance) || (down <= tolerance);
}

#ifdef __cplusplus
}
#endif

#endif
