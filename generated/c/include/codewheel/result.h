/** @file
 * codewheel/result.h - results of decoders and accesses, and usability of positions
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 */
#ifndef CODEWHEEL_RESULT_H
#define CODEWHEEL_RESULT_H

#include "version.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/result.h 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Marks functions whose result must be checked, so that compilers warn if it is ignored. To turn
 * the warnings off, define it as empty before including the first header.
 */
#ifndef CW_NODISCARD
#if defined(__cplusplus) && (__cplusplus >= 201703L)
#define CW_NODISCARD [[nodiscard]]
#elif defined(__STDC_VERSION__) && (__STDC_VERSION__ >= 202311L)
#define CW_NODISCARD [[nodiscard]]
#elif defined(__GNUC__)
#define CW_NODISCARD __attribute__((warn_unused_result))
#else
#define CW_NODISCARD
#endif
#endif

/**
 * Checks the pointers of functions that receive or track. By default it does nothing. To check
 * them, define it before including the first header, for example as assert(condition).
 */
#ifndef CW_ASSERT
#define CW_ASSERT(condition) ((void)0)
#endif

/**
 * Result of a decoder, an encoder or an access. If a frame has several errors, the result is the
 * first of them in this order. A function that does not return CW_OK leaves its outputs unchanged,
 * except for a cw_failure and for bytes that your transport stored. CW_OK means that the frame is
 * well formed. To find out if its position is usable, call its _verdict() function.
 */
typedef enum cw_result {
    CW_OK = 0,
    CW_FAULT_LENGTH = 1,        /**< wrong number of bits, bytes or array elements */
    CW_FAULT_CRC = 2,           /**< CRC error: the data were corrupted on the line */
    CW_FAULT_CONSTANT = 3,      /**< a fixed bit or a parity bit is wrong */
    CW_FAULT_RANGE = 4,         /**< a value is not in the manual or does not fit */
    CW_FAULT_TRANSPORT = 5,     /**< a transport function failed: see its error number */
    CW_FAULT_TIMEOUT = 6,       /**< a poll or a reply took too long */
    CW_FAULT_UNSUPPORTED = 7,   /**< the transport does not have a required function */
    CW_FAULT_LINE_HIGH = 8,     /**< data line always high: no answer or a cut wire */
    CW_FAULT_LINE_LOW = 9,      /**< data line low before the frame: busy or shorted */
    CW_FAULT_NO_START = 10,     /**< the acknowledge is longer than the buffer */
    CW_FAULT_REPEAT = 11,       /**< two readings of the position disagree */
    CW_FAULT_HEAD_MISSING = 12, /**< RS-485: the first byte of the reply is missing */
    CW_FAULT_LOST = 13,         /**< the tracker lost the axis and must be restarted */
    CW_FAULT_VERIFY = 14        /**< a register does not hold the value written to it */
} cw_result;

/**
 * Usability of the position in a valid frame, worst first. verdict >= CW_USABLE is true only if
 * the encoder reports neither an error nor a warning.
 */
typedef enum cw_verdict {
    CW_NOT_USABLE = 0,          /**< wrong, frozen, 0 or doubtful */
    CW_UNKNOWN = 1,             /**< the frame has no status bit */
    CW_USABLE_WITH_WARNING = 2, /**< usable, but needs attention */
    CW_USABLE = 3               /**< no error and no warning */
} cw_verdict;

#ifdef __cplusplus
}
#endif

#endif
