/** @file
 * codewheel/receive_frame.h - extracts frames of any length, as bytes, from received bits
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 * BiSS is a trademark of iC-Haus GmbH.
 *
 * The functions in receive.h return a frame of up to 64 bits as a word. The functions in this file
 * return bytes, for the decoder of a longer frame. The header of each encoder defines the lengths:
 *
 *   static uint8_t rx[ORDER_CODE_BISS_RX_BYTES];
 *   cw_biss_receive_frame(rx, sizeof rx, ORDER_CODE_BISS_BITS, frame, sizeof frame)
 *
 * Compiles as C99 and C++11. Needs no library and no allocation. Pointers must not be null. Not yet
 * tested on hardware.
 */
#ifndef CODEWHEEL_RECEIVE_FRAME_H
#define CODEWHEEL_RECEIVE_FRAME_H

#include "receive.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/receive_frame.h 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Store any number of bits as bytes. The last bit is bit 0 of the last byte, and the bits before
 * the first one are 0.
 */
CW_CONSTEXPR
static inline void cw_received_frame(
    const uint8_t *rx, size_t first, uint32_t bits, uint8_t *frame, size_t length)
{
    uint32_t bits_left = bits;
    for (size_t bytes_left = length; bytes_left > 0U; bytes_left--) {
        const uint32_t byte_bits = (bits_left < 8U) ? bits_left : 8U;
        bits_left -= byte_bits;
        const size_t byte_first = first + (size_t)bits_left;
        frame[bytes_left - 1U] = (uint8_t)cw_received_bits(rx, byte_first, byte_bits);
    }
}

/**
 * Extract single cycle data of any length as bytes, for a decoder that takes bytes. The rest is as
 * in cw_biss_receive_bits. A frame with fewer bits than its bytes has zeros before its first bit.
 *
 * @param rx  the received bits, packed into bytes
 * @param received  number of bits received, which need not fill whole bytes
 * @param bits  number of bits in the frame, ORDER_CODE_BISS_BITS
 * @param frame  the bytes of the frame, unchanged on error. It must not overlap rx
 * @param length  number of bytes in the frame, enough for all its bits
 * @return the results of cw_biss_receive_bits, and LENGTH if length is too short
 */
CW_NODISCARD
CW_CONSTEXPR
static inline cw_result cw_biss_receive_frame_bits(
    const uint8_t *rx, size_t received, uint32_t bits, uint8_t *frame, size_t length)
{
    CW_ASSERT((rx != NULL) && (frame != NULL));
    size_t first = 0U;
    const cw_result result = cw_biss_find_frame(rx, received, bits, &first);
    /* The length counts before the stop bit. */
    if (((result == CW_OK) || (result == CW_FAULT_CONSTANT)) && ((size_t)bits > (8U * length))) {
        return CW_FAULT_LENGTH;
    }
    if (result != CW_OK) {
        return result;
    }
    cw_received_frame(rx, first, bits, frame, length);
    return CW_OK;
}

/** Extract single cycle data as bytes from whole bytes. See cw_biss_receive_frame_bits. */
CW_NODISCARD
CW_CONSTEXPR
static inline cw_result cw_biss_receive_frame(
    const uint8_t *rx, size_t size, uint32_t bits, uint8_t *frame, size_t length)
{
    return cw_biss_receive_frame_bits(rx, 8U * size, bits, frame, length);
}

/**
 * Extract a word of any length as bytes, for a decoder that takes bytes. The rest is as in
 * cw_ssi_receive. A word with fewer bits than its bytes has zeros before its first bit.
 *
 * @param rx  the received bits, packed into bytes
 * @param size  number of bytes received
 * @param bits  number of bits of the word, ORDER_CODE_SSI_BITS
 * @param frame  the bytes of the word, unchanged on error. It must not overlap rx
 * @param length  number of bytes in the frame, enough for all its bits
 * @return the results of cw_ssi_receive, and LENGTH if length is too short
 */
CW_NODISCARD
CW_CONSTEXPR
static inline cw_result cw_ssi_receive_frame(
    const uint8_t *rx, size_t size, uint32_t bits, uint8_t *frame, size_t length)
{
    CW_ASSERT((rx != NULL) && (frame != NULL));
    const size_t after_word = (size_t)bits + 1U;
    if (((size_t)bits > (8U * length)) || (after_word >= (8U * size))) {
        return CW_FAULT_LENGTH;
    }
    if (cw_received_bit(rx, 0U) == 0U) {
        return CW_FAULT_LINE_LOW;
    }
    if (cw_received_bit(rx, after_word) != 0U) {
        size_t index = 1U;
        while ((index < after_word) && (cw_received_bit(rx, index) != 0U)) {
            index++;
        }
        return (index == after_word) ? CW_FAULT_LINE_HIGH : CW_FAULT_CONSTANT;
    }
    cw_received_frame(rx, 1U, bits, frame, length);
    return CW_OK;
}

#ifdef __cplusplus
}
#endif

#endif
