/* The lower limit: extracts the fields of a frame and checks none of them. */
#include "hand.h"

int floor_biss46(uint64_t word, hand_biss *out);
int floor_biss47(uint64_t word, hand_biss *out);
int floor_rs485(const uint8_t *bytes, size_t length, hand_reply *out);

int floor_biss46(uint64_t word, hand_biss *out)
{
    const uint32_t low = (uint32_t)word;

    out->multiturn = (uint16_t)(word >> 34);
    out->singleturn = (uint32_t)(word >> 8) & 0x3FFFFFFU;
    out->error = (low & 0x80U) == 0U;
    out->warning = (low & 0x40U) == 0U;
    out->position = word >> 8;
    return HAND_OK;
}

int floor_biss47(uint64_t word, hand_biss *out)
{
    const uint32_t low = (uint32_t)word;

    out->multiturn = (uint16_t)(word >> 31);
    out->singleturn = (low >> 8) & 0x7FFFFFU;
    out->error = (low & 0x80U) == 0U;
    out->warning = (low & 0x40U) == 0U;
    out->position = word >> 8;
    return HAND_OK;
}

int floor_rs485(const uint8_t *bytes, size_t length, hand_reply *out)
{
    const uint32_t singleturn = (uint32_t)bytes[2] | ((uint32_t)bytes[3] << 8) | ((uint32_t)bytes[4] << 16);
    const uint32_t multiturn = (uint32_t)bytes[6] | ((uint32_t)bytes[7] << 8);

    (void)length;
    out->status_st_error = (bytes[1] & 0x10U) != 0U;
    out->status_other_error = (bytes[1] & 0x20U) != 0U;
    out->singleturn = singleturn;
    out->encoder_id = bytes[5];
    out->multiturn = (uint16_t)multiturn;
    out->busy = (bytes[9] & 0x02U) != 0U;
    out->st_error = (bytes[9] & 0x04U) != 0U;
    out->ps_error = (bytes[9] & 0x20U) != 0U;
    out->mt_error = (bytes[9] & 0x40U) != 0U;
    out->battery_alarm = (bytes[9] & 0x80U) != 0U;
    out->position = ((uint64_t)multiturn << 23) | singleturn;
    out->unused = (uint16_t)((bytes[1] | ((uint32_t)bytes[9] << 8)) & 0x19CFU);
    return HAND_OK;
}
