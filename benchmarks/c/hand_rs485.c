/* AMM5's reply to data ID 3, 11 bytes: control 1Ah, status, three bytes of singleturn, encoder ID 23h, three of multiturn, alarms, XOR. */
#include "hand.h"

int hand_rs485(const uint8_t *bytes, size_t length, hand_reply *out)
{
    uint32_t crc = 0U;
    uint32_t singleturn;
    uint32_t multiturn;
    uint32_t flags;
    size_t index;

    if (length != 11U) {
        return HAND_LENGTH;
    }
    for (index = 0U; index < 11U; index++) {
        crc ^= bytes[index];
    }
    if (crc != 0U) {
        return HAND_CRC;
    }
    /* sync 010, bits of the status and alarms that are always 0, positions above 16 and 23 bits, encoder ID */
    if ((((bytes[0] & 0x07U) ^ 0x02U) | (bytes[1] & 0xCFU) | (bytes[4] & 0x80U) | (bytes[5] ^ 0x23U) | bytes[8] | (bytes[9] & 0x19U)) != 0U) {
        return HAND_CONSTANT;
    }
    /* data ID 3 in bits 6 to 3, its even parity in bit 7 */
    if (bytes[0] != 0x1AU) {
        return (((0x6996U >> (((uint32_t)bytes[0] >> 3) & 0x0FU)) & 1U) != ((uint32_t)bytes[0] >> 7)) ? HAND_CONSTANT : HAND_RANGE;
    }
    singleturn = (uint32_t)bytes[2] | ((uint32_t)bytes[3] << 8) | ((uint32_t)bytes[4] << 16);
    multiturn = (uint32_t)bytes[6] | ((uint32_t)bytes[7] << 8);
    flags = bytes[1];
    out->status_st_error = (flags & 0x10U) != 0U;
    out->status_other_error = (flags & 0x20U) != 0U;
    out->singleturn = singleturn;
    out->multiturn = (uint16_t)multiturn;
    flags = bytes[9];
    out->busy = (flags & 0x02U) != 0U;
    out->st_error = (flags & 0x04U) != 0U;
    out->ps_error = (flags & 0x20U) != 0U;
    out->mt_error = (flags & 0x40U) != 0U;
    out->battery_alarm = (flags & 0x80U) != 0U;
    out->position = ((uint64_t)multiturn << 23) | singleturn;
    return HAND_OK;
}
