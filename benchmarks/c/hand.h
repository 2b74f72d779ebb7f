/* Members and results of the hand-written decoders, the same as those of the generated ones. */
#ifndef HAND_H
#define HAND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Results of a receiver or a decoder, numbered as in codewheel/result.h. */
enum {
    HAND_OK = 0,
    HAND_LENGTH = 1,
    HAND_CRC = 2,
    HAND_CONSTANT = 3,
    HAND_RANGE = 4,
    HAND_LINE_HIGH = 8,
    HAND_LINE_LOW = 9
};

/* Verdicts on a position. It is stored unless it is not usable. */
enum { HAND_NOT_USABLE = 0, HAND_USABLE_WITH_WARNING = 2, HAND_USABLE = 3 };

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
    uint8_t encoder_id;
    uint16_t multiturn;
    bool busy;
    bool st_error;
    bool ps_error;
    bool mt_error;
    bool battery_alarm;
    uint64_t position;
    uint16_t unused;
} hand_reply;

int hand_biss46(uint64_t word, hand_biss *out);
int hand_biss47(uint64_t word, hand_biss *out);
int hand_rs485(const uint8_t *bytes, size_t length, hand_reply *out);

/* Four bytes as a number, the first one most significant. Cortex-M4 loads them at any address. */
static inline uint32_t hand_big_endian(const uint8_t *bytes)
{
#ifdef __ARM_FEATURE_UNALIGNED
    uint32_t word;
    __builtin_memcpy(&word, bytes, 4U);
    return __builtin_bswap32(word);
#else
    return ((uint32_t)bytes[0] << 24) | ((uint32_t)bytes[1] << 16) | ((uint32_t)bytes[2] << 8) | bytes[3];
#endif
}

/* The remainder of a BiSS word by x^6 + x + 1, which is 3Fh in a valid word, because the CRC is sent inverted. high has up to 28 bits. */
static inline uint32_t hand_remainder6(uint32_t high, uint32_t low)
{
    uint32_t v = low ^ high ^ (high << 3); /* x^32 = x^3 + 1 */
    v = (v & 0xFFFFFFU) ^ (v >> 24) ^ ((v >> 24) << 4);
    v = (v & 0xFFFU) ^ (v >> 12) ^ ((v >> 12) << 2);
    v = (v & 0x3FU) ^ (v >> 6) ^ ((v >> 6) << 1);
    return (v & 0x3FU) ^ (v >> 6) ^ ((v >> 6) << 1);
}

/* The XOR of 11 bytes, in the lowest 8 bits. */
static inline uint32_t hand_xor11(const uint8_t *bytes)
{
#ifdef __ARM_FEATURE_UNALIGNED
    uint32_t first;
    uint32_t second;
    uint32_t last;
    __builtin_memcpy(&first, bytes, 4U);
    __builtin_memcpy(&second, &bytes[4], 4U);
    __builtin_memcpy(&last, &bytes[7], 4U);
    first ^= second ^ (last >> 8); /* byte 7 is in both */
    first ^= first >> 16;
    return (first ^ (first >> 8)) & 0xFFU;
#else
    return (uint32_t)bytes[0] ^ bytes[1] ^ bytes[2] ^ bytes[3] ^ bytes[4] ^ bytes[5] ^ bytes[6] ^ bytes[7] ^ bytes[8] ^ bytes[9] ^ bytes[10];
#endif
}

#endif
