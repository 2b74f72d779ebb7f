/* From the buffer of a peripheral to a word, by hand for one encoder: AMM5A23/65KSC1 in 12 bytes, or SSI with 39 bits. */
#include "hand.h"

static uint32_t big_endian(const uint8_t *bytes)
{
    uint32_t word;
    __builtin_memcpy(&word, bytes, 4U);
    return __builtin_bswap32(word);
}

int hand_receive47(const uint8_t *rx, hand_biss *out)
{
    /* The rest and the acknowledge end within the first 32 bits. */
    const uint32_t head = big_endian(rx);
    const uint32_t rising = head & ~((head >> 1) | 0x80000000U);
    uint32_t first;
    uint64_t word;
    if (((head >> 31) == 0U) || (rising == 0U)) {
        return HAND_LENGTH;
    }
    first = (uint32_t)__builtin_clzl(rising) + 2U;
    word = ((uint64_t)big_endian(&rx[first / 8U]) << 32) | big_endian(&rx[(first / 8U) + 4U]);
    word <<= first % 8U;
    if ((word & 0x10000U) != 0U) {
        return HAND_CONSTANT;
    }
    return hand_biss47(word >> 17, out);
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
