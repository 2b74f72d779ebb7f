/*
 * selftest/codewheel.c - check that the runtime works with this compiler and processor
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "codewheel/angle.h"
#include "codewheel/biss.h"
#include "codewheel/tracker.h"

/* Return 0 if all checks pass, else the number of the first one that failed, from 1. */
uint32_t cw_selftest(void);

/* Check read requests [TexasInstruments/motor-control-sdk: bissc_hex_control_commands.png]. */
static bool cw_words(void)
{
    static const struct {
        uint8_t address;
        uint32_t word;
    } known[] = {
        { 0x44U, 0x889B4000U },
        { 0x45U, 0x88BD4000U },
        { 0x46U, 0x88D74000U },
        { 0x47U, 0x88F14000U },
        { 0x60U, 0x8C174000U },
        { 0x67U, 0x8CE54000U },
        { 0x68U, 0x8D014000U },
        { 0x78U, 0x8F0B4000U },
        { 0x79U, 0x8F2D4000U },
        { 0x7AU, 0x8F474000U },
        { 0x7BU, 0x8F614000U },
        { 0x7CU, 0x8F934000U },
        { 0x7DU, 0x8FB54000U }
    };
    size_t index;
    for (index = 0U; index < (sizeof(known) / sizeof(known[0])); index++) {
        const cw_biss_request request = { 0U, known[index].address, false, 0U };
        uint32_t word = 0U;
        if ((cw_biss_request_encode(&request, &word) != CW_OK) || (word != known[index].word)) {
            return false;
        }
    }
    return true;
}

/* Check a tracker: from 35,990 of 36,000 to 20 is 30 counts ahead. Half a turn is out of reach. */
static bool cw_turns(void)
{
    static const cw_tracker_config config = { 36000U, 100000U, 0U, 0U, 2U };
    cw_tracker axis;
    cw_tracker_start(&axis, &config, 0xFFFFFF00U);
    return (cw_tracker_add(&axis, 35990U, 0xFFFFFF00U) == CW_OK) &&
        (cw_tracker_add(&axis, 20U, 744U) == CW_OK) && (axis.position == 36020) &&
        (cw_tracker_speed(&axis) == 30000) &&
        (cw_tracker_add(&axis, 18020U, 1744U) == CW_FAULT_RANGE) && (axis.position == 36020) &&
        (cw_tracker_add(&axis, 18020U, 1844U) == CW_FAULT_LOST) &&
        (cw_tracker_add(&axis, 20U, 1944U) == CW_FAULT_LOST) && (axis.known == 0U);
}

/* Check a quarter of a turn, computed by a shift and by division. */
static bool cw_angles(void)
{
    return (cw_angle(0x20000U, 0x80000U) == 0x40000000U) &&
        (cw_angle(45000U, 36000U) == 0x40000000U) &&
        (cw_angle_millidegrees(0x40000000U) == 90000U);
}

uint32_t cw_selftest(void)
{
    static bool (*const checks[])(void) = {
        cw_words,
        cw_turns,
        cw_angles
    };
    uint32_t index;
    for (index = 0U; index < (uint32_t)(sizeof(checks) / sizeof(checks[0])); index++) {
        if (!checks[index]()) {
            return index + 1U;
        }
    }
    return 0U;
}
