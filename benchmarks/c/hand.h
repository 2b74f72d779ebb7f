/* Members and results of the hand-written decoders, the same as those of the generated ones. */
#ifndef HAND_H
#define HAND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { HAND_OK = 0, HAND_LENGTH = 1, HAND_CRC = 2, HAND_CONSTANT = 3, HAND_RANGE = 4 };

typedef struct hand_biss {
    uint16_t multiturn;
    uint32_t singleturn;
    bool error;
    bool warning;
    uint64_t position;
} hand_biss;

typedef struct hand_reply {
    bool status_st_error;
    bool status_other_error;
    uint32_t singleturn;
    uint16_t multiturn;
    bool busy;
    bool st_error;
    bool ps_error;
    bool mt_error;
    bool battery_alarm;
    uint64_t position;
} hand_reply;

int hand_biss46(uint64_t word, hand_biss *out);
int hand_biss47(uint64_t word, hand_biss *out);
int hand_receive47(const uint8_t *rx, hand_biss *out);
int hand_samples47(const uint8_t *samples, uint8_t *rx, hand_biss *out);
int hand_ssi39(const uint8_t *rx, uint64_t *word);
int hand_rs485(const uint8_t *bytes, size_t length, hand_reply *out);

#endif
