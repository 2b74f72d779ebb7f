/** @file
 * codewheel/receive.h - extracts the frame from the bytes that SPI, DMA or a serial port received
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 * BiSS is a trademark of iC-Haus GmbH.
 *
 * Received bits are packed into bytes, with the first bit in bit 7 of the first byte. An SPI
 * peripheral that receives the most significant bit first stores them in this way.
 * cw_received_words16, _words32 and _samples convert wider SPI words and samples. The header of
 * each encoder defines the lengths:
 *
 *   static uint8_t rx[ORDER_CODE_BISS_RX_BYTES];
 *   cw_biss_receive(rx, sizeof rx, ORDER_CODE_BISS_BITS, &word)
 *
 * The result indicates the cause: LINE_HIGH means a cut cable or no supply, LINE_LOW an encoder
 * that is still busy or a short circuit, NO_START and LENGTH a buffer that is too short, CONSTANT a
 * frame that is shorter or longer than expected, and HEAD_MISSING an RS-485 driver that is released
 * too late. These functions do not check the word itself. Its decoder does that.
 *
 * Compiles as C99 and C++11. Needs no library and no allocation. You provide the struct that holds
 * the state of a line. Pointers must not be null. Not yet tested on hardware.
 */
#ifndef CODEWHEEL_RECEIVE_H
#define CODEWHEEL_RECEIVE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "bits.h"
#include "result.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/receive.h 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* -- bits -------------------------------------------------------------------------------------- */

/** Return a received bit, 0 or 1. Bit 0 was received first. */
CW_CONSTEXPR
static inline uint32_t cw_received_bit(const uint8_t *rx, size_t place)
{
    const uint32_t byte = rx[place / 8U];
    const size_t shift = 7U - (place % 8U);
    return (byte >> shift) & 1U;
}

/** Marks functions that are about as short as a call to them. */
#ifdef __GNUC__
#define CW_INLINE __attribute__((always_inline))
#else
#define CW_INLINE
#endif

/** Return 4 bytes as a number. The first one is the most significant. */
CW_CONSTEXPR
CW_INLINE
static inline uint32_t cw_received_4_bytes(const uint8_t *rx)
{
#if defined(__GNUC__) && defined(__ARM_FEATURE_UNALIGNED) && \
    (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)
#if defined(__cplusplus) && (__cplusplus >= 201703L) /* no compiler evaluates memcpy */
    if (!__builtin_is_constant_evaluated())
#endif
    {
        uint32_t loaded = 0U;
        (void)__builtin_memcpy(&loaded, rx, 4U);
        return __builtin_bswap32(loaded);
    }
#endif
    return ((uint32_t)rx[0] << 24U) | ((uint32_t)rx[1] << 16U) | ((uint32_t)rx[2] << 8U) |
        (uint32_t)rx[3];
}

/** Return the number of zeros above the highest 1 of a number, which must not be 0. */
CW_CONSTEXPR
static inline uint32_t cw_received_zeros(uint32_t value)
{
#if defined(__GNUC__) && defined(__ARM_FEATURE_CLZ)
    return (uint32_t)__builtin_clz(value);
#else
    uint32_t shifted = value;
    uint32_t zeros = 0U;
    while (shifted < 0x1000000U) {
        shifted = (shifted << 4U) << 4U; /* SDCC 4.2 miscompiles <<= 8 for STM8 */
        zeros += 8U;
    }
    if (shifted < 0x10000000U) {
        shifted <<= 4U;
        zeros += 4U;
    }
    while (shifted < 0x80000000U) {
        shifted <<= 1U;
        zeros++;
    }
    return zeros;
#endif
}

/** Return up to 64 bits as a number. The bit at first is the most significant one. */
CW_CONSTEXPR
static inline uint64_t cw_received_bits(const uint8_t *rx, size_t first, uint32_t bits)
{
    /* Work on two halves, since small processors are slow at shifting 64 bits. */
    const size_t end = first + (size_t)bits;
    const uint32_t bits_before = (uint32_t)first & 7U;
    size_t index = first / 8U;
    uint32_t high = 0U;
    uint32_t low = 0U;
    uint32_t byte = 0xFFU;
    if (bits == 0U) {
        return 0U;
    }
    const size_t last = (end - 1U) / 8U;
    byte = (byte >> bits_before) & (uint32_t)rx[index];
    while (index < last) {
        high = (high << 8U) | (low >> 24U);
        low = (low << 8U) | byte;
        index++;
        byte = rx[index];
    }
    /* Use 1 to 8 bits of the last byte. A word of up to 64 bits can be spread over 9 bytes. */
    const size_t last_bits = end - (8U * last);
    const uint32_t bits_in_last = (uint32_t)last_bits;
    high = (high << bits_in_last) | (low >> (32U - bits_in_last));
    low = (low << bits_in_last) | (byte >> (8U - bits_in_last));
    return ((uint64_t)high << 32U) | low;
}

/**
 * Load 64 bits of a buffer in two halves. The bit at first becomes the most significant one, and
 * the 56 bits after it follow. Bits after the end of the buffer are 0.
 *
 * @param rx  the buffer
 * @param size  number of bytes in it, at least 8
 * @param first  index of the first bit, which must be in the buffer
 * @param upper  the half with the first bit
 * @param lower  the other half
 */
CW_CONSTEXPR
static inline void cw_received_halves(
    const uint8_t *rx, size_t size, size_t first, uint32_t *upper, uint32_t *lower)
{
    /* Take 8 bytes starting with the first bit, or the last 8, and drop earlier bits. */
    const size_t wanted_end = (first / 8U) + 8U;
    const size_t end = (wanted_end > size) ? size : wanted_end;
    const size_t bits_before = (first + 64U) - (8U * end);
    uint32_t high = cw_received_4_bytes(&rx[end - 8U]);
    uint32_t low = cw_received_4_bytes(&rx[end - 4U]);
    uint32_t shift = (uint32_t)bits_before;
    if (shift > 31U) {
        high = low;
        low = 0U;
        shift -= 32U;
    }
    *upper = (high << shift) | ((low >> 1U) >> (31U - shift));
    *lower = low << shift;
}

/** Return the top 1 to 63 bits of a 64-bit value, which is given as two 32-bit halves. */
CW_CONSTEXPR
static inline uint64_t cw_received_highest(uint32_t high, uint32_t low, uint32_t bits)
{
    if (bits > 32U) {
        const uint32_t unused = 64U - bits;
        const uint32_t upper = high >> unused;
        return ((uint64_t)upper << 32U) | (low >> unused) | ((high << 1U) << (31U - unused));
    }
    return high >> (32U - bits);
}

/** Convert 16-bit SPI words, each received most significant bit first, to 2 * count bytes. */
static inline void cw_received_words16(const uint16_t *words, size_t count, uint8_t *rx)
{
    CW_ASSERT((words != NULL) && (rx != NULL));
    size_t index;
    for (index = 0U; index < count; index++) {
        rx[2U * index] = (uint8_t)((uint32_t)words[index] >> 8U);
        rx[(2U * index) + 1U] = (uint8_t)((uint32_t)words[index] & 0xFFU);
    }
}

/** Convert 32-bit SPI words, each received most significant bit first, to 4 * count bytes. */
static inline void cw_received_words32(const uint32_t *words, size_t count, uint8_t *rx)
{
    CW_ASSERT((words != NULL) && (rx != NULL));
    size_t index;
    for (index = 0U; index < (4U * count); index++) {
        const size_t shift = 24U - (8U * (index % 4U));
        rx[index] = (uint8_t)((words[index / 4U] >> shift) & 0xFFU);
    }
}

/**
 * Return one bit of each of 8 samples, with the first sample in bit 7.
 *
 * @param samples  the samples
 * @param pin_bit  number of the bit in each sample, 0 to 7
 */
static inline uint32_t cw_received_8_samples(const uint8_t *samples, uint32_t pin_bit)
{
    /* Compilers merge each expression into one load if the processor has a load of this width. */
    const uint32_t first = (uint32_t)samples[0] | ((uint32_t)samples[1] << 8U) |
        ((uint32_t)samples[2] << 16U) | ((uint32_t)samples[3] << 24U);
    const uint32_t second = (uint32_t)samples[4] | ((uint32_t)samples[5] << 8U) |
        ((uint32_t)samples[6] << 16U) | ((uint32_t)samples[7] << 24U);
    uint32_t bits = ((first >> pin_bit) & 0x01010101U) << 4U;
    bits |= (second >> pin_bit) & 0x01010101U;
    /* Sample n is now bit 8n + 4, or bit 8n - 32. Copy it to bit 31 - n, which is free. */
    bits |= bits << 9U;
    bits |= bits << 18U;
    return bits >> 24U;
}

/** Return the index of the only bit in a mask, as the sum of the powers of two in it. */
static inline uint32_t cw_received_pin_bit(uint32_t mask)
{
    uint32_t bit = 0U;
    if (mask > 0x0FU) { /* bits 4 to 7 */
        bit = 4U;
    }
    if ((mask & 0xCCU) != 0U) { /* bits 2, 3, 6 and 7 */
        bit += 2U;
    }
    if ((mask & 0xAAU) != 0U) { /* bits 1, 3, 5 and 7 */
        bit++;
    }
    return bit;
}

/**
 * Pack samples of the data line into bytes. The last byte is padded with ones, which cannot be
 * mistaken for the 0 after a word. For BiSS, pass count to cw_biss_receive_bits, which ignores
 * the padding.
 *
 * @param samples  one byte per clock, as DMA copies them from a port
 * @param count  number of samples
 * @param mask  bit of the pin in each sample
 * @param rx  the packed bits. May be the same array as samples
 * @return number of bytes in rx, (count + 7) / 8
 */
static inline size_t cw_received_samples(
    const uint8_t *samples, size_t count, uint8_t mask, uint8_t *rx)
{
    CW_ASSERT((samples != NULL) && (rx != NULL));
    const size_t size = (count / 8U) + (((count % 8U) != 0U) ? 1U : 0U);
    const uint32_t pin = mask;
    const uint32_t pin_bit = cw_received_pin_bit(pin);
    size_t whole_bytes = 0U;
    size_t byte;
    if (pin == ((uint32_t)1U << pin_bit)) {
        whole_bytes = count / 8U;
    }
    for (byte = 0U; byte < whole_bytes; byte++) {
        rx[byte] = (uint8_t)cw_received_8_samples(&samples[8U * byte], pin_bit);
    }
    /* The remaining bytes, or all bytes if the mask has several bits or none. */
    for (byte = whole_bytes; byte < size; byte++) {
        uint32_t bits = 0U;
        size_t index;
        for (index = 8U * byte; index < ((8U * byte) + 8U); index++) {
            const bool is_padding = index >= count;
            bits = (bits << 1U) |
                ((is_padding || (((uint32_t)samples[index] & pin) != 0U)) ? 1U : 0U);
        }
        rx[byte] = (uint8_t)bits;
    }
    return size;
}

/* -- BiSS C ------------------------------------------------------------------------------------ */

/**
 * Return the index of the start bit, which is the first 1 after a 0. If there is none, return
 * received, or received + 1 if there is no 0 either.
 */
CW_CONSTEXPR
static inline size_t cw_biss_start(const uint8_t *rx, size_t received)
{
    uint32_t previous = 0x80000000U; /* the bit before the next one, in bit 31 */
    size_t index = 0U;
    while ((index + 32U) <= received) {
        const uint32_t bits = cw_received_4_bytes(&rx[index / 8U]);
        const uint32_t not_rising = previous | (bits >> 1U);
        /* SDCC 4.2 miscompiles & ~ for STM8. */
        const uint32_t rising = (bits | not_rising) ^ not_rising;
        if (rising != 0U) {
            return index + (size_t)cw_received_zeros(rising);
        }
        previous = (bits & 1U) << 31U;
        index += 32U;
    }
    while (index < received) {
        const uint32_t bit = cw_received_bit(rx, index);
        if ((bit != 0U) && (previous == 0U)) {
            return index;
        }
        previous = bit << 31U;
        index++;
    }
    return (previous == 0U) ? received : (received + 1U);
}

/**
 * Extract the word of single cycle data from the bits received on SLO, one bit for each clock:
 *
 *   1 1 ...      0 0 0 ...     1       CDS   D ... D nE nW CRC   0      0 or 1 ...
 *   rest, delay  acknowledge   start         the word            stop   ignored
 *
 * MA is high at rest. The encoder changes SLO after the rising edge of MA, so both SPI modes with
 * CPOL = 1 receive the same bits. Mode 3 samples at the rising edge, and mode 2 samples half a
 * clock earlier, at the falling edge. Both work with any cable, since the start bit shows the
 * delay.
 *
 *   MA      1 1 1 0 1 0 1 0 1 0 1
 *   SLO     1 1 1 1 1 1 a a b b c    each rising edge outputs the next bit
 *   mode 3        ^   ^   ^   ^      CPOL = 1, CPHA = 1: 1 1 a b
 *   mode 2      ^   ^   ^   ^        CPOL = 1, CPHA = 0: 1 1 a b
 *
 * Register access switches between modes 3 and 0, which both sample at the rising edge: see biss.h.
 * The buffer must hold at least one idle bit before the acknowledge, and the whole word, so its
 * length limits how long the acknowledge may be. The stop bit is checked if it was
 * received. Receive it if you can, since it reveals a frame of a different length. Wait until the
 * timeout is over before you start the next frame: a master that keeps clocking sees SLO rise
 * without a frame. Do not pause that long between two bytes, since the pause would end the frame.
 *
 * A corrupted acknowledge or start bit shifts the word. The decoder's 6-bit CRC misses one in 64
 * such words. Only a limit on the movement of the position detects it.
 *
 * @param rx  the received bits, packed into bytes
 * @param received  number of bits received, which need not fill whole bytes
 * @param bits  number of bits of the word, ORDER_CODE_BISS_BITS
 * @param word  the word, for its decoder
 * @return
 *   OK         the word is complete.
 *   LINE_LOW   the first bit is 0: a short circuit, or the previous timeout is not over.
 *   LINE_HIGH  there is no 0: no encoder, no supply, or no clock.
 *   NO_START   there is no 1 after the acknowledge: it is longer than the buffer.
 *   LENGTH     the start bit is so late that the word does not fit.
 *   CONSTANT   the stop bit is 1: the frame has a different length or was corrupted.
 */
CW_NODISCARD
CW_CONSTEXPR
static inline cw_result cw_biss_receive_bits(
    const uint8_t *rx, size_t received, uint32_t bits, uint64_t *word)
{
    CW_ASSERT((rx != NULL) && (word != NULL));
    const size_t start = cw_biss_start(rx, received);
    const size_t first = start + 2U;
    const size_t stop = first + (size_t)bits;
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
    if ((received < 57U) || (bits == 0U) || (bits > 56U)) {
        if (bits > 64U) {
            return CW_FAULT_LENGTH;
        }
        if ((stop < received) && (cw_received_bit(rx, stop) != 0U)) {
            return CW_FAULT_CONSTANT;
        }
        *word = cw_received_bits(rx, first, bits);
        return CW_OK;
    }
    /* Load the word and the stop bit at once. A stop bit after the buffer is 0. */
    uint32_t high = 0U;
    uint32_t low = 0U;
    cw_received_halves(rx, (received + 7U) / 8U, first, &high, &low);
    const uint32_t half = (bits > 31U) ? low : high;
    if (((half & (0x80000000U >> (bits % 32U))) != 0U) && (stop < received)) {
        return CW_FAULT_CONSTANT;
    }
    *word = cw_received_highest(high, low, bits);
    return CW_OK;
}

/**
 * Find the frame in the bits received on SLO, for frames of any length. See cw_biss_receive_bits,
 * which also extracts a word of at most 64 bits.
 *
 * @param rx  the received bits, packed into bytes
 * @param received  number of bits received, which need not fill whole bytes
 * @param bits  number of bits of the frame, between the CDS bit and the stop bit
 * @param first  index of the first bit of the frame, unchanged on error
 * @return OK, or LINE_LOW, LINE_HIGH, NO_START, LENGTH or CONSTANT like cw_biss_receive_bits
 */
CW_NODISCARD
CW_CONSTEXPR
static inline cw_result cw_biss_find_frame(
    const uint8_t *rx, size_t received, uint32_t bits, size_t *first)
{
    CW_ASSERT((rx != NULL) && (first != NULL));
    const size_t start = cw_biss_start(rx, received);
    const size_t data_index = start + 2U;
    const size_t frame_end = data_index + (size_t)bits;
    /* The same checks as in the receiver of one word. A shared function would make it longer. */
    if (start > received) {
        return CW_FAULT_LINE_HIGH;
    }
    if (cw_received_bit(rx, 0U) == 0U) {
        return CW_FAULT_LINE_LOW;
    }
    if (start == received) {
        return CW_FAULT_NO_START;
    }
    if (frame_end > received) {
        return CW_FAULT_LENGTH;
    }
    if ((frame_end < received) && (cw_received_bit(rx, frame_end) != 0U)) {
        return CW_FAULT_CONSTANT;
    }
    *first = data_index;
    return CW_OK;
}

/** Extract the word of single cycle data from whole bytes. See cw_biss_receive_bits. */
CW_NODISCARD
CW_CONSTEXPR
static inline cw_result cw_biss_receive(
    const uint8_t *rx, size_t size, uint32_t bits, uint64_t *word)
{
    return cw_biss_receive_bits(rx, 8U * size, bits, word);
}

/**
 * Extract the CDS bit, for register access with biss.h. Extract it from every frame, even if the
 * CRC of its word is wrong, since the slave advances by one bit with every frame.
 *
 * @param rx  the received bits, packed into bytes
 * @param received  number of bits received, which need not fill whole bytes
 * @param cds  the CDS bit, unchanged on error
 * @return OK, LINE_LOW as in cw_biss_receive_bits, or LENGTH if there is no CDS bit. On any error,
 *         abort the access in progress
 */
CW_NODISCARD
CW_CONSTEXPR
static inline cw_result cw_biss_receive_cds_bits(const uint8_t *rx, size_t received, bool *cds)
{
    CW_ASSERT((rx != NULL) && (cds != NULL));
    const size_t cds_index = cw_biss_start(rx, received) + 1U;
    if (cds_index >= received) {
        return CW_FAULT_LENGTH;
    }
    /* While the timeout before this frame lasts, the bit after a 1 need not be CDS. */
    if (cw_received_bit(rx, 0U) == 0U) {
        return CW_FAULT_LINE_LOW;
    }
    *cds = cw_received_bit(rx, cds_index) != 0U;
    return CW_OK;
}

/** Extract the CDS bit from whole bytes. See cw_biss_receive_cds_bits. */
CW_NODISCARD
CW_CONSTEXPR
static inline cw_result cw_biss_receive_cds(const uint8_t *rx, size_t size, bool *cds)
{
    return cw_biss_receive_cds_bits(rx, 8U * size, cds);
}

/* -- SSI --------------------------------------------------------------------------------------- */

/**
 * Return up to 64 bits as a number. Since they begin at bit 1, this needs no general shift.
 *
 * @param rx  the buffer, which must hold the bits
 * @param bits  number of bits
 */
CW_CONSTEXPR
static inline uint64_t cw_ssi_word(const uint8_t *rx, uint32_t bits)
{
    const size_t last = (size_t)bits / 8U;
    const uint32_t bits_in_last = (bits % 8U) + 1U;
    uint32_t upper = 0U;
    uint32_t lower = 0U;
    uint32_t byte = 0x7FU & (uint32_t)rx[0];
    size_t index = 0U;
    if (last == 3U) {
        return (cw_received_4_bytes(rx) & 0x7FFFFFFFU) >> (8U - bits_in_last);
    }
    if (last > 3U) {
        lower = cw_received_4_bytes(rx) & 0x7FFFFFFFU;
        byte = rx[4];
        index = 4U;
    }
    while (index < last) {
        upper = (upper << 8U) | (lower >> 24U);
        lower = (lower << 8U) | byte;
        index++;
        byte = rx[index];
    }
    /* Use 1 to 8 bits of the last byte. */
    upper = (upper << bits_in_last) | (lower >> (32U - bits_in_last));
    lower = (lower << bits_in_last) | (byte >> (8U - bits_in_last));
    return ((uint64_t)upper << 32U) | lower;
}

/**
 * Extract the word from the bits received on the data line, one bit for each clock:
 *
 *   1        D ... D    0      0 or 1 ...
 *   stored   the word   after  ignored
 *
 * The first clock edge stores the position, and the next one outputs the most significant bit. A
 * word of n bits takes n + 1 clocks, and this function needs one more for the 0 after it. The clock
 * must be high at rest. Sample at its rising edge (SPI mode 3) or at its falling edge (mode 2).
 * There is no CRC, and no start bit that shows a delay. Keep the delay of the cable below one clock
 * period, or below half a period in mode 2.
 *
 * @param rx  the received bits, packed into bytes
 * @param size  number of bytes
 * @param bits  number of bits of the word, ORDER_CODE_SSI_BITS
 * @param word  the word, for its decoder
 * @return
 *   OK         the word is complete.
 *   LENGTH     the buffer is too short for the word.
 *   LINE_LOW   the first bit is 0: a short circuit, or too short a pause before the clock.
 *   LINE_HIGH  all bits are 1: no encoder, no supply, or no clock.
 *   CONSTANT   the bit after the word is 1: the word is longer or was corrupted.
 */
CW_NODISCARD
CW_CONSTEXPR
static inline cw_result cw_ssi_receive(
    const uint8_t *rx, size_t size, uint32_t bits, uint64_t *word)
{
    CW_ASSERT((rx != NULL) && (word != NULL));
    if ((bits > 64U) || (((size_t)bits + 2U) > (8U * size))) {
        return CW_FAULT_LENGTH;
    }
    if (cw_received_bit(rx, 0U) == 0U) {
        return CW_FAULT_LINE_LOW;
    }
    const uint64_t received = cw_ssi_word(rx, bits);
    if (cw_received_bit(rx, (size_t)bits + 1U) != 0U) {
        return (received == cw_mask(bits)) ? CW_FAULT_LINE_HIGH : CW_FAULT_CONSTANT;
    }
    *word = received;
    return CW_OK;
}

/**
 * Check that two positions agree. Decode them from words that you read in immediate succession.
 * This is the only check for a word without a CRC. It cannot detect an error that affects both
 * words.
 *
 * You can compare the first two BiSS frames in the same way.
 *
 * @param first  the first position
 * @param second  the second position
 * @param modulus  the encoder's _modulus(), even if the axis never moves that far, or 0 if there is
 *                 none
 * @param at_most  maximum number of counts that the axis can move, in either direction, during one
 *                 word and one pause
 * @return OK, RANGE if a position is not below the modulus, or REPEAT if the positions disagree and
 *         must be read again
 */
CW_NODISCARD
CW_CONSTEXPR
static inline cw_result cw_ssi_repeats(
    uint64_t first, uint64_t second, uint64_t modulus, uint64_t at_most)
{
    const uint64_t higher = (first > second) ? first : second;
    const uint64_t distance = higher - ((first > second) ? second : first);
    if (modulus != 0U) {
        if (higher >= modulus) {
            return CW_FAULT_RANGE;
        }
        if ((modulus - distance) <= at_most) {
            return CW_OK;
        }
    }
    return (distance <= at_most) ? CW_OK : CW_FAULT_REPEAT;
}

/* -- RS-485 ------------------------------------------------------------------------------------ */

/**
 * Length of the longest reply in bytes. If an encoder sends longer ones, define it in the whole
 * program, before including this header.
 */
#ifndef CW_RECEIVE_RS485_BYTES
#define CW_RECEIVE_RS485_BYTES 16U
#endif

/**
 * A reply that arrives byte by byte, from an interrupt or from a ring buffer that DMA fills:
 *
 *   cw_rs485_ask(&line, control, length, 0U, now_us, 200U);    and send the request
 *   if (cw_rs485_take(&line, byte)) {                          for each byte received
 *       if (REPLY_decode(ENCODER, line.bytes, line.length, &reply) != CW_OK) {
 *           cw_rs485_resume(&line);
 *       }
 *   }
 *   if (cw_rs485_late(&line, now_us)) {                        regularly: ask again, and
 *   }                                                          cw_rs485_reason says why
 *
 * Release the line immediately, since the reply can come a few microseconds after the request. The
 * manuals give no time. The value is inferred from another encoder with the same format, for which
 * the driver in vedderb/bldc notes 3 us. A byte at 2.5 MBd takes 4 us, so a driver that is released
 * by a task or a slow interrupt cuts off the first byte of every reply. Have the UART switch the
 * driver (hardware driver enable), or release it in the transmit-complete interrupt, which occurs
 * after the last stop bit. The transmit-register-empty interrupt is one byte too early. Enable the
 * receiver before the last byte of the request has been sent. If it then receives bytes of the
 * request, pass their number to _ask as echo.
 *
 * A reply begins with the control byte of its request. Bytes before that are dropped. If the
 * decoder rejects the bytes, _resume searches them for a later start of the reply, so a corrupted
 * byte before it does no harm. Without _resume, a rejected reply still counts as complete, and
 * _late never returns true. See the polling program in examples/ for each encoder with RS-485.
 */
typedef struct cw_rs485_line {
    uint8_t bytes[CW_RECEIVE_RS485_BYTES]; /**< the reply, complete once _take returns true */
    uint8_t control;     /**< private: first byte of the reply */
    size_t length;       /**< number of bytes in a complete reply */
    uint32_t dropped;    /**< bytes dropped since _ask, before a reply began */
    size_t count;        /**< private: reply bytes received so far */
    size_t echo;         /**< private: echo bytes not yet received */
    uint32_t since_us;   /**< private: time of _ask */
    uint32_t at_most_us; /**< private: timeout */
} cw_rs485_line;

/**
 * Start waiting for the reply to a request. Call it just before you send the request.
 *
 * @param line  the reply and its state
 * @param control  control byte of the request, which is also the first byte of the reply
 * @param length  number of bytes in the reply
 * @param echo  number of request bytes that the receiver receives before the reply, or 0 if it
 *              receives none
 * @param now_us  current time, from a 32-bit microsecond counter that wraps around
 * @param at_most_us  maximum time until the reply is complete. No manual says how soon an encoder
 *                    answers. The request and the reply themselves take ten bit times per byte
 * @return OK, or LENGTH if length is 0 or longer than the buffer
 */
CW_NODISCARD
static inline cw_result cw_rs485_ask(
    cw_rs485_line *line, uint8_t control, size_t length, size_t echo, uint32_t now_us,
    uint32_t at_most_us)
{
    CW_ASSERT(line != NULL);
    if ((length == 0U) || (length > CW_RECEIVE_RS485_BYTES)) {
        return CW_FAULT_LENGTH;
    }
    line->length = length;
    line->dropped = 0U;
    line->count = 0U;
    line->echo = echo;
    line->control = control;
    line->since_us = now_us;
    line->at_most_us = at_most_us;
    return CW_OK;
}

/**
 * Add a received byte of a reply that can begin with any byte, because the encoder does not repeat
 * the first byte of the request. Return true if it completes the reply. Bytes after that are
 * dropped. Nothing marks the start of such a reply, so _resume does not help: if the decoder
 * rejects it, leave the line idle for at_most_us and ask again. Stray bytes can look like a short
 * reply with valid check bits. Empty the receiver before each request, and use the reply only if
 * no other byte follows it within a few byte times.
 */
static inline bool cw_rs485_take_any(cw_rs485_line *line, uint8_t byte)
{
    CW_ASSERT(line != NULL);
    if (line->echo != 0U) {
        line->echo--;
        return false;
    }
    if (line->count == line->length) {
        return false;
    }
    line->bytes[line->count] = byte;
    line->count++;
    return line->count == line->length;
}

/** Add a received byte. Return true if it completes the reply. Bytes after that are dropped. */
static inline bool cw_rs485_take(cw_rs485_line *line, uint8_t byte)
{
    CW_ASSERT(line != NULL);
    if ((line->echo == 0U) && (line->count == 0U) && (byte != line->control)) {
        line->dropped += (line->dropped < CW_RECEIVE_RS485_BYTES) ? 1U : 0U;
        return false;
    }
    return cw_rs485_take_any(line, byte);
}

/** Resume after the decoder has rejected a reply: search for another start after its first byte. */
static inline void cw_rs485_resume(cw_rs485_line *line)
{
    CW_ASSERT(line != NULL);
    const size_t count = line->count;
    size_t start = 1U;
    size_t index;
    while ((start < count) && (line->bytes[start] != line->control)) {
        start++;
    }
    for (index = start; index < count; index++) {
        line->bytes[index - start] = line->bytes[index];
    }
    line->count = count - ((start < count) ? start : count);
}

/**
 * Return true if the timeout has passed and the reply is not complete, because none arrived or
 * because the decoder rejected it. Keep the result of the decoder for the second case. Leave the
 * line idle for at_most_us before you ask again, so that a late reply is not mistaken for the next
 * one.
 */
static inline bool cw_rs485_late(const cw_rs485_line *line, uint32_t now_us)
{
    CW_ASSERT(line != NULL);
    /* Compute now - since in 64 bits, without the wraparound that checkers warn about. */
    const uint64_t elapsed_us = ((((uint64_t)1U << 32U) + now_us) - line->since_us) & 0xFFFFFFFFU;
    return (elapsed_us > line->at_most_us) && (line->count != line->length);
}

/**
 * Return the reason why there is no reply. Call it once _late returns true. If a decoder rejected
 * a reply in the meantime, the result of the decoder is the reason instead.
 *
 * @param line  the reply and its state
 * @return
 *   OK            there is a reply.
 *   TIMEOUT       nothing arrived: no supply, a cut cable, or the request was not received.
 *   HEAD_MISSING  the bytes did not begin with the control byte. If every request ends like this,
 *                 the driver is released too late or the receiver enabled too late, and the first
 *                 byte of the reply is lost: see cw_rs485_line.
 *                 Otherwise the baud rate is wrong, or the byte was corrupted.
 *   LENGTH        the reply began but is not complete: a byte was lost, or at_most_us is too short.
 */
CW_NODISCARD
static inline cw_result cw_rs485_reason(const cw_rs485_line *line)
{
    CW_ASSERT(line != NULL);
    if (line->count == line->length) {
        return CW_OK;
    }
    if (line->dropped != 0U) {
        return CW_FAULT_HEAD_MISSING;
    }
    return (line->count != 0U) ? CW_FAULT_LENGTH : CW_FAULT_TIMEOUT;
}

#ifdef __cplusplus
}
#endif

#endif
