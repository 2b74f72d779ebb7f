/*
 * Random buffers through receive.h and through receive_by_bits.h: prints how many were compared, how
 * many of them held a frame, and how many differ in a result or a word.
 */
#include "receive_by_bits.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST 24U
/* Bytes of the longest frame. */
#define LONGEST 16U

static uint64_t state = 88172645463325252ULL;

static uint32_t any(uint32_t below)
{
    state ^= state << 13U;
    state ^= state >> 7U;
    state ^= state << 17U;
    return (uint32_t)(state >> 32U) % below;
}

static void put(uint8_t *rx, size_t at, uint32_t bit)
{
    const uint8_t mask = (uint8_t)(0x80U >> (at % 8U));
    rx[at / 8U] = (uint8_t)((bit != 0U) ? (rx[at / 8U] | mask) : (rx[at / 8U] & ~(uint32_t)mask));
}

static unsigned long frames, differing;

/* As bytes, a frame has the result and the bits that bit-by-bit reception has, also beyond 64 bits. */
static bool as_bytes(const uint8_t *rx, size_t size, size_t received, uint32_t bits)
{
    uint8_t *const made = (uint8_t *)calloc(LONGEST, 1U);
    uint8_t same[LONGEST] = { 0U };
    bool equal = cw_biss_receive_frame_bits(rx, received, bits, made, LONGEST)
        == by_bits_biss_receive_frame_bits(rx, received, bits, same, LONGEST);
    equal = equal && (memcmp(made, same, LONGEST) == 0);
    equal = equal && (cw_ssi_receive_frame(rx, size, bits, made, LONGEST)
        == by_bits_ssi_receive_frame(rx, size, bits, same, LONGEST));
    equal = equal && (memcmp(made, same, LONGEST) == 0);
    free(made);
    return equal;
}

/* In memory of exactly this size, so that a sanitizer detects an access beyond it. */
static void compare(const uint8_t *bytes, size_t size, size_t received, uint32_t bits, uint8_t mask)
{
    uint8_t *const rx = (uint8_t *)malloc(size + (size == 0U));
    uint8_t made[MOST], other[MOST];
    uint64_t word = 0x5AU, same = 0x5AU;
    bool cds = false, also = false;
    cw_result result;
    bool equal;
    memcpy(rx, bytes, size);
    result = cw_biss_receive_bits(rx, received, bits, &word);
    equal = (result == by_bits_biss_receive_bits(rx, received, bits, &same)) && (word == same);
    frames += (result == CW_OK) ? 1U : 0U;
    result = cw_biss_receive_cds_bits(rx, received, &cds);
    equal = equal && (result == by_bits_biss_receive_cds_bits(rx, received, &also)) && (cds == also);
    word = same;
    result = cw_ssi_receive(rx, size, bits, &word);
    equal = equal && (result == by_bits_ssi_receive(rx, size, bits, &same)) && (word == same);
    equal = equal && as_bytes(rx, size, received, bits);
    memset(made, 0, sizeof made);
    memset(other, 0, sizeof other);
    equal = equal && (cw_received_samples(rx, size, mask, made) == by_bits_received_samples(rx, size, mask, other))
        && (memcmp(made, other, sizeof made) == 0);
    (void)cw_received_samples(rx, size, mask, rx);
    equal = equal && (memcmp(rx, made, (size + 7U) / 8U) == 0);
    differing += equal ? 0U : 1U;
    free(rx);
}

int main(int count, char **given)
{
    const unsigned long most = (count > 1) ? strtoul(given[1], NULL, 10) : 1000UL;
    unsigned long turn;
    uint32_t bits, offset;
    for (turn = 0U; turn < most; turn++) {
        uint8_t rx[MOST];
        size_t size = any(MOST + 1U), at, received;
        uint32_t kind = any(4U);
        for (at = 0U; at < MOST; at++) {
            rx[at] = (uint8_t)any(256U);
        }
        bits = any((any(4U) == 0U) ? 131U : 67U);
        if (kind != 0U) {
            /* Rest, acknowledge and start, so that most of the buffers hold a frame. */
            const size_t rest = 1U + any(12U), low = rest + 1U + any(24U);
            for (at = 0U; at < low; at++) {
                put(rx, at, (at < rest) ? 1U : 0U);
            }
            put(rx, low, 1U);
            if (kind != 1U) {
                put(rx, low + 2U + bits, 0U);
            }
        }
        received = (any(2U) == 0U) ? (8U * size) : any((uint32_t)(8U * size) + 1U);
        compare(rx, size, received, bits, (uint8_t)((any(2U) == 0U) ? (1U << any(8U)) : any(256U)));
    }
    /* Every word of 58 to 64 bits at every offset in a byte, with random bits in it and around it. */
    for (offset = 0U; offset < 8U; offset++) {
        for (bits = 58U; bits <= 64U; bits++) {
            for (turn = 0U; turn < 200U; turn++) {
                uint8_t rx[10];
                size_t at;
                for (at = 0U; at < sizeof rx; at++) {
                    rx[at] = (uint8_t)any(256U);
                }
                differing += (cw_received_bits(rx, offset, bits) != by_bits_received_bits(rx, offset, bits)) ? 1U : 0U;
            }
        }
    }
    printf("%lu %lu %lu\n", most, frames, differing);
    return 0;
}
