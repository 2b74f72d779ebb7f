/* From the buffer of a peripheral to a word, by hand for one encoder: AMM5A23/65KSC1 in 12 bytes, or SSI with 39 bits. */
#include "hand.h"

static uint32_t big_endian(const uint8_t *bytes)
{
    uint32_t word;
    __builtin_memcpy(&word, bytes, 4U);
    return __builtin_bswap32(word);
}

/* Bits a to a + 31, of which the first is bit 31 of words[0]. */
static uint32_t bits_from(const uint32_t *words, uint32_t a)
{
    const uint32_t left = a & 31U;
    const uint32_t high = words[a >> 5] << left;
    return (left != 0U) ? (high | (words[(a >> 5) + 1U] >> (32U - left))) : high;
}

int hand_receive47(const uint8_t *rx, hand_biss *out)
{
    /* The rest and the acknowledge are in the first 32 bits, since they are shorter. */
    const uint32_t words[4] = { big_endian(rx), big_endian(&rx[4]), big_endian(&rx[8]), 0U };
    const uint32_t rest = (words[0] == 0xFFFFFFFFU) ? 32U : (uint32_t)__builtin_clzl(~words[0]);
    uint32_t start;
    uint32_t high;
    uint32_t low;
    if ((rest == 0U) || (rest == 32U) || ((words[0] << rest) == 0U)) {
        return HAND_LENGTH;
    }
    start = rest + (uint32_t)__builtin_clzl(words[0] << rest) + 2U;
    /* 47 bits of the word, and the stop bit. */
    high = bits_from(words, start);
    low = bits_from(words, start + 16U);
    if ((low & 1U) != 0U) {
        return HAND_CONSTANT;
    }
    return hand_biss47(((uint64_t)(high >> 17) << 32) | (high << 15) | (low >> 1), out);
}

int hand_samples47(const uint8_t *samples, uint8_t *rx, hand_biss *out)
{
    uint32_t byte;
    for (byte = 0U; byte < 12U; byte++) {
        uint32_t first;
        uint32_t then;
        __builtin_memcpy(&first, &samples[8U * byte], 4U);
        __builtin_memcpy(&then, &samples[(8U * byte) + 4U], 4U);
        rx[byte] = (uint8_t)((((((first >> 3) & 0x01010101U) << 4) | ((then >> 3) & 0x01010101U)) * 0x08040201U) >> 24);
    }
    return hand_receive47(rx, out);
}

int hand_ssi39(const uint8_t *rx, uint64_t *word)
{
    const uint32_t high = big_endian(rx);
    const uint32_t low = ((uint32_t)rx[4] << 8) | rx[5];
    if ((high >> 31) == 0U) {
        return HAND_LENGTH;
    }
    if ((low & 0x80U) != 0U) {
        return HAND_CONSTANT;
    }
    *word = ((uint64_t)((high & 0x7FFFFFFFU) >> 24) << 32) | (high << 8) | (low >> 8);
    return HAND_OK;
}
