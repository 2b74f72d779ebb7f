/* receive.h bit by bit, as in the first version of the runtime: the reference for reception by bytes and words. */
#ifndef RECEIVE_BY_BITS_H
#define RECEIVE_BY_BITS_H

#include "codewheel/receive_frame.h"

static inline uint64_t by_bits_received_bits(const uint8_t *rx, size_t first, uint32_t bits)
{
    /* Work on two halves, since small processors are slow at shifting 64 bits. */
    const size_t end = first + (size_t)bits;
    uint32_t high = 0U;
    uint32_t low = 0U;
    size_t at;
    for (at = first; at < end; at++) {
        high = ((high & 0x7FFFFFFFU) << 1U) | (low >> 31U);
        low = ((low & 0x7FFFFFFFU) << 1U) | cw_received_bit(rx, at);
    }
    return ((uint64_t)high << 32U) | low;
}

static inline size_t by_bits_received_samples(
    const uint8_t *samples, size_t count, uint8_t mask, uint8_t *rx)
{
    const size_t size = (count / 8U) + (((count % 8U) != 0U) ? 1U : 0U);
    size_t byte;
    for (byte = 0U; byte < size; byte++) {
        uint32_t bits = 0U;
        size_t at;
        for (at = 8U * byte; at < ((8U * byte) + 8U); at++) {
            bits = (bits << 1U) | (((at >= count) ||
                (((uint32_t)samples[at] & mask) != 0U)) ? 1U : 0U);
        }
        rx[byte] = (uint8_t)bits;
    }
    return size;
}

static inline cw_result by_bits_biss_receive_bits(
    const uint8_t *rx, size_t received, uint32_t bits, uint64_t *word)
{
    const size_t end = received;
    size_t at = 0U;
    size_t first;
    while ((at < end) && (cw_received_bit(rx, at) != 0U)) {
        at++;
    }
    if (at == end) {
        return CW_FAULT_LINE_HIGH;
    }
    if (at == 0U) {
        return CW_FAULT_LINE_LOW;
    }
    while ((at < end) && (cw_received_bit(rx, at) == 0U)) {
        at++;
    }
    if (at == end) {
        return CW_FAULT_NO_START;
    }
    first = at + 2U;
    if ((bits > 64U) || ((first + (size_t)bits) > end)) {
        return CW_FAULT_LENGTH;
    }
    if (((first + (size_t)bits) < end) && (cw_received_bit(rx, first + (size_t)bits) != 0U)) {
        return CW_FAULT_CONSTANT;
    }
    *word = by_bits_received_bits(rx, first, bits);
    return CW_OK;
}

/* Shift each bit into the end of the frame. */
static inline void by_bits_received_frame(const uint8_t *rx, size_t first, uint32_t bits, uint8_t *frame, size_t length)
{
    size_t at, byte;
    for (byte = 0U; byte < length; byte++) {
        frame[byte] = 0U;
    }
    for (at = first; at < (first + bits); at++) {
        for (byte = 0U; byte < length; byte++) {
            const uint32_t next = ((byte + 1U) < length) ? ((uint32_t)frame[byte + 1U] >> 7U) : cw_received_bit(rx, at);
            frame[byte] = (uint8_t)((((uint32_t)frame[byte] << 1U) | next) & 0xFFU);
        }
    }
}

static inline cw_result by_bits_biss_receive_frame_bits(
    const uint8_t *rx, size_t received, uint32_t bits, uint8_t *frame, size_t length)
{
    uint64_t none;
    size_t first = 0U;
    const cw_result result = by_bits_biss_receive_bits(rx, received, 0U, &none);
    if ((result != CW_OK) && (result != CW_FAULT_CONSTANT)) {
        return result;
    }
    while (cw_received_bit(rx, first) != 0U) {
        first++;
    }
    while (cw_received_bit(rx, first) == 0U) {
        first++;
    }
    first += 2U;
    if ((bits > (8U * length)) || ((first + bits) > received)) {
        return CW_FAULT_LENGTH;
    }
    if (((first + bits) < received) && (cw_received_bit(rx, first + bits) != 0U)) {
        return CW_FAULT_CONSTANT;
    }
    by_bits_received_frame(rx, first, bits, frame, length);
    return CW_OK;
}

static inline cw_result by_bits_biss_receive_cds_bits(const uint8_t *rx, size_t received, bool *cds)
{
    const size_t end = received;
    size_t at = 0U;
    while ((at < end) && (cw_received_bit(rx, at) != 0U)) {
        at++;
    }
    while ((at < end) && (cw_received_bit(rx, at) == 0U)) {
        at++;
    }
    if ((at + 1U) >= end) {
        return CW_FAULT_LENGTH;
    }
    if (cw_received_bit(rx, 0U) == 0U) {
        return CW_FAULT_LINE_LOW;
    }
    *cds = cw_received_bit(rx, at + 1U) != 0U;
    return CW_OK;
}

static inline cw_result by_bits_ssi_receive(
    const uint8_t *rx, size_t size, uint32_t bits, uint64_t *word)
{
    uint64_t found;
    if ((bits > 64U) || (((size_t)bits + 2U) > (8U * size))) {
        return CW_FAULT_LENGTH;
    }
    if (cw_received_bit(rx, 0U) == 0U) {
        return CW_FAULT_LINE_LOW;
    }
    found = by_bits_received_bits(rx, 1U, bits);
    if (cw_received_bit(rx, (size_t)bits + 1U) != 0U) {
        return (found == cw_mask(bits)) ? CW_FAULT_LINE_HIGH : CW_FAULT_CONSTANT;
    }
    *word = found;
    return CW_OK;
}

static inline cw_result by_bits_ssi_receive_frame(
    const uint8_t *rx, size_t size, uint32_t bits, uint8_t *frame, size_t length)
{
    uint32_t ones = 0U;
    if ((bits > (8U * length)) || (((size_t)bits + 2U) > (8U * size))) {
        return CW_FAULT_LENGTH;
    }
    if (cw_received_bit(rx, 0U) == 0U) {
        return CW_FAULT_LINE_LOW;
    }
    if (cw_received_bit(rx, (size_t)bits + 1U) != 0U) {
        while ((ones < bits) && (cw_received_bit(rx, (size_t)ones + 1U) != 0U)) {
            ones++;
        }
        return (ones == bits) ? CW_FAULT_LINE_HIGH : CW_FAULT_CONSTANT;
    }
    by_bits_received_frame(rx, 1U, bits, frame, length);
    return CW_OK;
}

#endif
