/* 47 bits: 16 of revolutions, 23 of the position within one, nE, nW, CRC x^6 + x + 1 inverted. The last bit sent is bit 0. */
#include "hand.h"

int hand_biss47(uint64_t word, hand_biss *out)
{
    const uint32_t high = (uint32_t)(word >> 32);
    const uint32_t low = (uint32_t)word;

    if ((high >> 15) != 0U) {
        return HAND_LENGTH;
    }
    if (hand_remainder6(high, low) != 0x3FU) {
        return HAND_CRC;
    }
    out->multiturn = (uint16_t)((high << 1) | (low >> 31));
    out->singleturn = (low >> 8) & 0x7FFFFFU;
    out->error = (low & 0x80U) == 0U;
    out->warning = (low & 0x40U) == 0U;
    out->position = word >> 8;
    return HAND_OK;
}
