/* AMM5's reply to data ID 3, 11 bytes: control 1Ah, status, three bytes of singleturn, encoder ID, three of multiturn, alarms, XOR. */
#include "hand.h"

/* The error of a reply whose fixed bits are wrong. */
static int wrong_constant(const uint8_t *bytes)
{
    if (((bytes[0] & 0x07U) != 0x02U) || ((bytes[4] & 0x80U) != 0U) || (bytes[8] != 0U)) {
        return HAND_CONSTANT;
    }
    /* data ID in bits 6 to 3, its even parity in bit 7 */
    return (((0x6996U >> (((uint32_t)bytes[0] >> 3) & 0x0FU)) & 1U) != ((uint32_t)bytes[0] >> 7)) ? HAND_CONSTANT : HAND_RANGE;
}

int hand_rs485(const uint8_t *bytes, size_t length, hand_reply *out)
{
    uint32_t singleturn;
    uint32_t multiturn;
    uint32_t status;
    uint32_t alarms;

    if (length != 11U) {
        return HAND_LENGTH;
    }
    if (hand_xor11(bytes) != 0U) {
        return HAND_CRC;
    }
    /* data ID 3 with sync and parity, and the bits above both positions */
    if (((bytes[0] ^ 0x1AU) | (bytes[4] & 0x80U) | bytes[8]) != 0U) {
        return wrong_constant(bytes);
    }
    singleturn = (uint32_t)bytes[2] | ((uint32_t)bytes[3] << 8) | ((uint32_t)bytes[4] << 16);
    multiturn = (uint32_t)bytes[6] | ((uint32_t)bytes[7] << 8);
    status = bytes[1];
    alarms = bytes[9];
    out->status_st_error = (status & 0x10U) != 0U;
    out->status_other_error = (status & 0x20U) != 0U;
    out->singleturn = singleturn;
    out->encoder_id = bytes[5];
    out->multiturn = (uint16_t)multiturn;
    out->busy = (alarms & 0x02U) != 0U;
    out->st_error = (alarms & 0x04U) != 0U;
    out->ps_error = (alarms & 0x20U) != 0U;
    out->mt_error = (alarms & 0x40U) != 0U;
    out->battery_alarm = (alarms & 0x80U) != 0U;
    out->position = ((uint64_t)multiturn << 23) | singleturn;
    out->unused = (uint16_t)((status | (alarms << 8)) & 0x19CFU);
    return HAND_OK;
}
