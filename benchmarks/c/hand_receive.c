/* From the buffer of a peripheral to a position, by hand for one encoder: AMM5A23/65KSC1 in 12 bytes, SSI with 39 bits, or a reply of AMM5A23/65KJP1. */
#include "hand.h"

/* Judge the 47 bits of a word at the top of 64 bits, and the stop bit after them. */
static inline int judge47(uint32_t upper, uint32_t lower, uint64_t *position)
{
    const uint32_t high = upper >> 17;
    const uint32_t low = (upper << 15) | (lower >> 17);

    if ((lower & 0x10000U) != 0U) {
        return HAND_NOT_USABLE;
    }
    /* nE and nW are 1 without an error and a warning. */
    if ((hand_remainder6(high, low) | (low & 0xC0U)) != 0xFFU) {
        return HAND_NOT_USABLE;
    }
    *position = ((uint64_t)(high >> 8) << 32) | (high << 24) | (low >> 8);
    return HAND_USABLE;
}

#ifdef __ARM_FEATURE_CLZ

static inline int hand_position47(const uint8_t *rx, uint64_t *position)
{
    const uint32_t head = hand_big_endian(rx);
    uint32_t rising = (head & ~(head >> 1)) << 1;
    uint32_t drop;
    uint32_t upper;
    uint32_t lower;

    if ((head & 0x80000000U) == 0U) {
        return HAND_NOT_USABLE;
    }
    if (rising != 0U) {
        /* The start bit is in the first 32 bits, and the word follows one bit after it. */
        drop = (uint32_t)__builtin_clz(rising) + 3U;
        rx += drop / 8U;
        drop %= 8U;
    } else {
        /* A later start bit leaves space for the word up to bit 47. */
        const uint32_t next = hand_big_endian(&rx[4]);
        rising = next & ~((head << 31) | (next >> 1));
        if ((rising >> 16) == 0U) {
            return HAND_NOT_USABLE;
        }
        drop = (uint32_t)__builtin_clz(rising) + 2U;
        rx += 4;
    }
    upper = hand_big_endian(rx);
    lower = hand_big_endian(&rx[4]);
    upper = (upper << drop) | ((lower >> 1) >> (31U - drop));
    return judge47(upper, lower << drop, position);
}

#else

static inline int hand_position47(const uint8_t *rx, uint64_t *position)
{
    uint_fast8_t byte = rx[0];
    uint_fast8_t rising = (uint_fast8_t)(byte & ~((byte >> 1) | 0x80U));
    uint_fast8_t at = 0U;
    uint_fast8_t drop = 2U;
    uint32_t upper;
    uint32_t lower;

    if (byte < 0x80U) {
        return HAND_NOT_USABLE;
    }
    /* The start bit leaves space for the word up to bit 47. */
    while (rising == 0U) {
        const uint_fast8_t before = (uint_fast8_t)(byte << 7);
        at++;
        if (at > 5U) {
            return HAND_NOT_USABLE;
        }
        byte = rx[at];
        rising = (uint_fast8_t)(byte & ~((byte >> 1) | before));
    }
    if (at > 4U) {
        at = 4U;
        drop += 8U;
    }
    if (rising < 0x10U) {
        rising = (uint_fast8_t)(rising << 4);
        drop += 4U;
    }
    if (rising < 0x40U) {
        rising = (uint_fast8_t)(rising << 2);
        drop += 2U;
    }
    if (rising < 0x80U) {
        drop++;
    }
#ifdef __AVR__
    /* An AVR shifts bit by bit. */
    if ((drop > 7U) && (at < 4U)) {
        at++;
        drop = (uint_fast8_t)(drop - 8U);
    }
    upper = hand_big_endian(&rx[at]);
    lower = hand_big_endian(&rx[at + 4U]);
    while (drop != 0U) {
        upper = (upper << 1) | (lower >> 31);
        lower <<= 1;
        drop--;
    }
#else
    upper = hand_big_endian(&rx[at]);
    lower = hand_big_endian(&rx[at + 4U]);
    upper = (upper << drop) | (lower >> (32U - drop));
    lower <<= drop;
#endif
    return judge47(upper, lower, position);
}

#endif

static inline int hand_samples47(const uint8_t *samples, uint8_t *rx, uint64_t *position)
{
    uint32_t byte;

    for (byte = 0U; byte < 12U; byte++) {
#ifdef __ARM_FEATURE_UNALIGNED
        uint32_t first;
        uint32_t then;
        __builtin_memcpy(&first, &samples[8U * byte], 4U);
        __builtin_memcpy(&then, &samples[(8U * byte) + 4U], 4U);
        first = ((first & 0x08080808U) << 4) | (then & 0x08080808U);
        rx[byte] = (uint8_t)(((first >> 3) * 0x08040201U) >> 24);
#else
        const uint8_t *const eight = &samples[8U * byte];
        uint32_t bits = eight[0] & 8U;
        bits = (bits << 1) | (eight[1] & 8U);
        bits = (bits << 1) | (eight[2] & 8U);
        bits = (bits << 1) | (eight[3] & 8U);
        bits = (bits << 1) | (eight[4] & 8U);
        bits = (bits << 1) | (eight[5] & 8U);
        bits = (bits << 1) | (eight[6] & 8U);
        bits = (bits << 1) | (eight[7] & 8U);
        rx[byte] = (uint8_t)(bits >> 3);
#endif
    }
    return hand_position47(rx, position);
}

static inline int hand_ssi39(const uint8_t *rx, uint64_t *word)
{
    const uint_fast8_t high = rx[0];
    uint32_t low;

    if (high < 0x80U) {
        return HAND_LINE_LOW;
    }
    low = hand_big_endian(&rx[1]);
    if ((rx[5] & 0x80U) != 0U) {
        return ((low == 0xFFFFFFFFU) && (high == 0xFFU)) ? HAND_LINE_HIGH : HAND_CONSTANT;
    }
    *word = ((uint64_t)(high & 0x7FU) << 32) | low;
    return HAND_OK;
}

/* Judge the flags of a reply of which at least one is active. */
static inline int verdict_of(uint32_t status, uint32_t alarms)
{
    if (((status & 0x10U) | (alarms & 0x66U)) != 0U) {
        return HAND_NOT_USABLE;
    }
    /* Bit 5 of the status combines alarms. It decides by itself if none of them explains it. */
    return (((status & 0x20U) != 0U) && ((alarms & 0x80U) == 0U)) ? HAND_NOT_USABLE : HAND_USABLE_WITH_WARNING;
}

static inline int hand_rs485_position(const uint8_t *bytes, uint64_t *position)
{
    uint32_t singleturn;
    uint32_t multiturn;
    int verdict = HAND_USABLE;

    if (hand_xor11(bytes) != 0U) {
        return HAND_NOT_USABLE;
    }
    if (((bytes[0] ^ 0x1AU) | (bytes[4] & 0x80U) | bytes[8]) != 0U) {
        return HAND_NOT_USABLE;
    }
    if ((bytes[1] | bytes[9]) != 0U) {
        verdict = verdict_of(bytes[1], bytes[9]);
        if (verdict == HAND_NOT_USABLE) {
            return verdict;
        }
    }
    singleturn = (uint32_t)bytes[2] | ((uint32_t)bytes[3] << 8) | ((uint32_t)bytes[4] << 16);
    multiturn = (uint32_t)bytes[6] | ((uint32_t)bytes[7] << 8);
    *position = ((uint64_t)multiturn << 23) | singleturn;
    return verdict;
}
