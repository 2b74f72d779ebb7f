/* 46 bits: 12 of revolutions, 26 of the position within one, nE, nW, CRC x^6 + x + 1 inverted. The last bit sent is bit 0. */
#include "hand.h"

int hand_biss46(uint64_t word, hand_biss *out)
{
    const uint32_t high = (uint32_t)(word >> 32);
    const uint32_t low = (uint32_t)word;
    const uint32_t h = (high << 8) | (low >> 24);
    uint32_t v;

    if ((high >> 14) != 0U) {
        return HAND_LENGTH;
    }
    v = (low & 0xFFFFFFU) ^ h ^ (h << 4); /* x^24 = x^4 + 1 */
    v = (v & 0xFFFU) ^ (v >> 12) ^ ((v >> 12) << 2);
    v = (v & 0x3FU) ^ (v >> 6) ^ ((v >> 6) << 1);
    v = (v & 0x3FU) ^ (v >> 6) ^ ((v >> 6) << 1);
    if (v != 0x3FU) {
        return HAND_CRC;
    }
    out->multiturn = (uint16_t)(high >> 2);
    out->singleturn = (uint32_t)(word >> 8) & 0x3FFFFFFU;
    out->error = (low & 0x80U) == 0U;
    out->warning = (low & 0x40U) == 0U;
    out->position = word >> 8;
    return HAND_OK;
}
