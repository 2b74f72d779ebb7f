/** @file
 * codewheel/spi.h - SPI requests and their replies
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 *
 * Many encoders answer a request in the next word. For each word, in this order:
 *
 *     1. encode a request: ..._encode(encoder, &request, &word)
 *     2. cw_spi_exchange(&line, ..._REQUEST_..., address) returns the request that is answered now
 *     3. exchange the word on your bus, as bytes from cw_spi_store
 *     4. get the word received with the ..._receive function of the reply to that request, and
 *        decode it, or ignore it if the request is CW_SPI_NONE
 *
 * If words of an encoder have several lengths, ..._receive returns CW_FAULT_LENGTH for a reply in a
 * word with a different number of bytes. It cannot distinguish 17 bits from 20. A late reply
 * needs a word of its own length, so send as many clocks as it has bits. If the bits do not fill
 * the bytes, the word is at their low end. On a bus that sends only whole bytes, it must
 * be at the high end: shift it up after cw_spi_store, and down before cw_spi_load.
 */
#ifndef CODEWHEEL_SPI_H
#define CODEWHEEL_SPI_H

#include <stddef.h>
#include <stdint.h>

#include "bits.h"
#include "result.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/spi.h 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define CW_SPI_NONE 0U /**< no request: the word received has no meaning */

/** A request, with the address of the register that it accesses, if any. */
typedef struct cw_spi_asked {
    uint32_t request; /**< an encoder's ..._REQUEST_ macro, or CW_SPI_NONE */
    uint32_t address; /**< your value for this request, such as the address of a register */
} cw_spi_asked;

/** The requests of one encoder that wait for their replies. */
typedef struct cw_spi_pipeline {
    uint32_t reply_words; /**< 1 if a reply is in the word after its request, 0 if in the same */
    cw_spi_asked before; /**< the last request */
} cw_spi_pipeline;

/**
 * Forget all requests: at the start, and after the encoder was off or a word was lost.
 *
 * @param line The pipeline.
 * @param reply_words The encoder's ..._REPLY_WORDS macro.
 */
static inline void cw_spi_start(cw_spi_pipeline *line, uint32_t reply_words)
{
    line->reply_words = reply_words;
    line->before.request = CW_SPI_NONE;
    line->before.address = 0U;
}

/**
 * Record the request that is sent now, and return the request that the word received at the same
 * time answers.
 *
 * @param line The pipeline.
 * @param request An encoder's ..._REQUEST_ macro.
 * @param address Your value for this request, which is returned with its reply.
 * @return The request that is answered. For the first word, it is CW_SPI_NONE if replies come one
 * word late.
 */
static inline cw_spi_asked cw_spi_exchange(
    cw_spi_pipeline *line, uint32_t request, uint32_t address)
{
    const cw_spi_asked before = line->before;
    line->before.request = request;
    line->before.address = address;
    return (line->reply_words != 0U) ? before : line->before;
}

/** Store a number as bytes, most significant first. */
static inline void cw_spi_bytes(uint64_t data, uint8_t *bytes, size_t length)
{
    uint64_t shifted = data;
    size_t bytes_left;
    for (bytes_left = length; bytes_left > 0U; bytes_left--) {
        bytes[bytes_left - 1U] = (uint8_t)(shifted & 0xFFU);
        shifted >>= 8U;
    }
}

/** Return the number in bytes, most significant first. */
CW_CONSTEXPR
static inline uint64_t cw_spi_data(const uint8_t *bytes, size_t length)
{
    uint64_t data = 0U;
    for (size_t index = 0U; index < length; index++) {
        data = (data << 8U) | bytes[index];
    }
    return data;
}

/**
 * Store a word as the bytes that a bus sends, most significant first.
 *
 * @param word The word.
 * @param bits Number of its bits, from the ..._bits function of its frame.
 * @param bytes The bytes, unchanged on error.
 * @param length Number of bytes that hold the bits.
 * @return CW_OK, or CW_FAULT_LENGTH if length does not match the word.
 */
CW_NODISCARD
static inline cw_result cw_spi_store(uint64_t word, uint32_t bits, uint8_t *bytes, size_t length)
{
    if (length != (((size_t)bits + 7U) / 8U)) {
        return CW_FAULT_LENGTH;
    }
    cw_spi_bytes(word, bytes, length);
    return CW_OK;
}

/**
 * Return the word in received bytes.
 *
 * The number of bytes does not show the number of bits: words of 17 bits and of 20 bits both have
 * three bytes. If your driver knows how many bits it exchanged, compare that number with bits
 * before this call. Otherwise, the _decode function rejects a longer word only if one of its
 * additional bits is 1.
 *
 * @param bytes The bytes, most significant first.
 * @param length Number of bytes received.
 * @param bits Number of bits of the reply, from the ..._bits function of its frame.
 * @param word The word, unchanged on error. The _decode function of the frame takes it.
 * @return CW_OK, or CW_FAULT_LENGTH if the number of bytes is wrong.
 */
CW_NODISCARD
CW_CONSTEXPR
static inline cw_result cw_spi_load(
    const uint8_t *bytes, size_t length, uint32_t bits, uint64_t *word)
{
    if (length != (((size_t)bits + 7U) / 8U)) {
        return CW_FAULT_LENGTH;
    }
    *word = cw_spi_data(bytes, length);
    return CW_OK;
}

#ifdef __cplusplus
}
#endif

#endif
