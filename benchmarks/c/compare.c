/* Compares the hand-written code with ours on the host. Prints the first difference, and returns 0 if there is none. */
#include <stdio.h>
#include <string.h>

#include "ams/as5048a_spi.h"
#include "bench/biss46_biss.h"
#include "codewheel/receive.h"
#include "lika/amm5_biss.h"
#include "lika/amm5_rs485.h"
#include "magntek/mt6835_spi.h"

#include "hand_biss46.c"
#include "hand_biss47.c"
#include "hand_receive.c"
#include "hand_rs485.c"
#include "hand_spi.c"

enum { TURNS = 200000 };
/* A position that no frame holds. */
#define UNTOUCHED UINT64_C(0xAAAAAAAAAAAAAAAA)

static uint64_t seed = 1U;
static unsigned long accepted;

static uint64_t arbitrary(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return seed;
}

static bool one_in(uint32_t number)
{
    return (arbitrary() >> 32) % number == 0U;
}

static int differs(const char *part, long ours, long hand)
{
    printf("%s: %ld by ours, %ld by hand\n", part, ours, hand);
    return 1;
}

/* Return a valid word of the lowest bits, in one of four with a wrong bit, and without active flags in one of two. */
static uint64_t biss_word(uint32_t bits)
{
    uint64_t word = (arbitrary() & cw_mask(bits - 6U)) << 6U;
    if (one_in(2U)) {
        word |= 0xC0U;
    }
    word |= lika_amm5_biss_crc(word);
    return one_in(4U) ? (word ^ ((uint64_t)1U << (arbitrary() % 64U))) : word;
}

static int compare_biss_words(void)
{
    const uint64_t word46 = biss_word(46U);
    const uint64_t word47 = biss_word(47U);
    bench_biss46_biss_frame ours46;
    lika_amm5_biss_frame ours47;
    hand_biss hand;
    int result = bench_biss46_biss_decode(BENCH_BISS46_BISS_B38SC, cw_word_of(word46, 46U), &ours46);
    int by_hand = hand_biss46(word46, &hand);
    if (result != by_hand) {
        return differs("biss46", result, by_hand);
    }
    if (result == 0 && (ours46.multiturn != hand.multiturn || ours46.singleturn != hand.singleturn || ours46.error != hand.error
        || ours46.warning != hand.warning || ours46.position != hand.position)) {
        return differs("biss46, position", (long)ours46.position, (long)hand.position);
    }
    result = lika_amm5_biss_decode(LIKA_AMM5_BISS_A23_65KSC1, cw_word_of(word47, 47U), &ours47);
    by_hand = hand_biss47(word47, &hand);
    if (result != by_hand) {
        return differs("biss47", result, by_hand);
    }
    if (result == 0 && (ours47.multiturn != hand.multiturn || ours47.singleturn != hand.singleturn || ours47.error != hand.error
        || ours47.warning != hand.warning || ours47.position != hand.position)) {
        return differs("biss47, position", (long)ours47.position, (long)hand.position);
    }
    return 0;
}

static void set_bit(uint8_t *rx, size_t at, uint32_t bit)
{
    if (at < 96U) {
        rx[at / 8U] = (uint8_t)((rx[at / 8U] & ~(0x80U >> (at % 8U))) | ((bit != 0U) ? (0x80U >> (at % 8U)) : 0U));
    }
}

/* Fill a buffer with rest, acknowledge, start, CDS, word, and a stop bit. Some of them do not fit. */
static void fill_biss(uint8_t *rx)
{
    const uint64_t word = biss_word(47U);
    const size_t fall = (size_t)(arbitrary() % (one_in(4U) ? 50U : 20U));
    const size_t start = fall + (size_t)(arbitrary() % 40U);
    size_t at;
    for (at = 0U; at < 96U; at++) {
        set_bit(rx, at, (at < fall || at >= start) ? 1U : 0U);
    }
    set_bit(rx, start + 1U, one_in(2U));
    for (at = 0U; at < 47U; at++) {
        set_bit(rx, start + 2U + at, (uint32_t)(word >> (46U - at)) & 1U);
    }
    set_bit(rx, start + 49U, one_in(8U));
    if (one_in(50U)) {
        memset(rx, one_in(2U) ? 0xFF : 0, 12U);
    }
    if (one_in(20U)) {
        rx[arbitrary() % 12U] ^= (uint8_t)arbitrary();
    }
}

static int compare_biss_buffers(void)
{
    uint8_t rx[12];
    uint8_t packed[12];
    uint8_t samples[96];
    uint64_t ours = UNTOUCHED;
    uint64_t hand = UNTOUCHED;
    uint64_t from_samples = UNTOUCHED;
    size_t at;
    int verdict;
    int by_hand;
    fill_biss(rx);
    for (at = 0U; at < 96U; at++) {
        samples[at] = (uint8_t)((arbitrary() & 0xF7U) | (cw_received_bit(rx, at) << 3U));
    }
    verdict = lika_amm5_biss_read(LIKA_AMM5_BISS_A23_65KSC1, rx, 12U, &ours);
    by_hand = hand_position47(rx, &hand);
    if (verdict != by_hand || ours != hand) {
        return differs("BiSS buffer", verdict, by_hand);
    }
    by_hand = hand_samples47(samples, packed, &from_samples);
    if (verdict != by_hand || ours != from_samples || memcmp(rx, packed, 12U) != 0) {
        return differs("samples", verdict, by_hand);
    }
    accepted += (verdict == CW_USABLE);
    return 0;
}

static int compare_ssi(void)
{
    uint8_t rx[6];
    uint64_t ours = UNTOUCHED;
    uint64_t hand = UNTOUCHED;
    int result;
    int by_hand;
    size_t at;
    for (at = 0U; at < 6U; at++) {
        rx[at] = one_in(8U) ? 0xFFU : (uint8_t)arbitrary();
    }
    if (one_in(16U)) {
        memset(rx, 0xFF, 6U);
        if (one_in(2U)) {
            rx[arbitrary() % 6U] ^= (uint8_t)(1U << (arbitrary() % 8U));
        }
    }
    result = cw_ssi_receive(rx, 6U, 39U, &ours);
    by_hand = hand_ssi39(rx, &hand);
    return (result != by_hand || ours != hand) ? differs("SSI", result, by_hand) : 0;
}

/* Fill a reply with valid fixed bits and often without active flags, and sometimes disturb a byte. */
static void fill_reply(uint8_t *bytes)
{
    size_t at;
    for (at = 0U; at < 10U; at++) {
        bytes[at] = (uint8_t)arbitrary();
    }
    bytes[0] = one_in(4U) ? bytes[0] : 0x1AU;
    bytes[1] &= (uint8_t)(one_in(2U) ? 0U : (0x20U | arbitrary()));
    bytes[4] &= 0x7FU;
    bytes[8] = 0U;
    bytes[9] &= (uint8_t)(one_in(2U) ? 0U : (one_in(2U) ? 0xC0U : arbitrary()));
    if (one_in(8U)) {
        bytes[arbitrary() % 10U] ^= (uint8_t)(1U << (arbitrary() % 8U));
    }
    bytes[10] = lika_amm5_rs485_crc_rs485_8(bytes, 10U);
    if (one_in(8U)) {
        bytes[arbitrary() % 11U] ^= (uint8_t)(1U << (arbitrary() % 8U));
    }
}

static bool replies_agree(const lika_amm5_rs485_complete_reply *ours, const hand_reply *hand)
{
    return ours->status_st_error == hand->status_st_error && ours->status_other_error == hand->status_other_error
        && ours->singleturn == hand->singleturn && ours->encoder_id == hand->encoder_id && ours->multiturn == hand->multiturn
        && ours->busy == hand->busy && ours->st_error == hand->st_error && ours->ps_error == hand->ps_error
        && ours->mt_error == hand->mt_error && ours->battery_alarm == hand->battery_alarm && ours->position == hand->position
        && ours->unused == hand->unused;
}

static int compare_replies(void)
{
    uint8_t bytes[11];
    lika_amm5_rs485_complete_reply ours;
    hand_reply hand;
    uint64_t our_position = UNTOUCHED;
    uint64_t hand_position = UNTOUCHED;
    const size_t length = one_in(16U) ? 10U : 11U;
    int result;
    int by_hand;
    fill_reply(bytes);
    result = lika_amm5_rs485_complete_reply_decode(LIKA_AMM5_RS485_A23_65KJP1, bytes, length, &ours);
    by_hand = hand_rs485(bytes, length, &hand);
    if (result != by_hand || (result == 0 && !replies_agree(&ours, &hand))) {
        return differs("RS-485", result, by_hand);
    }
    result = LIKA_AMM5_RS485_READ_BYTES(A23_65KJP1, bytes, 11U, &our_position);
    by_hand = hand_rs485_position(bytes, &hand_position);
    accepted += (result == CW_USABLE);
    return (result != by_hand || our_position != hand_position) ? differs("RS-485 position", result, by_hand) : 0;
}

static int compare_mt6835(void)
{
    uint64_t word = (arbitrary() & UINT64_C(0xFFFFFFFFFF00)) & ~(uint64_t)(one_in(2U) ? 0x700U : 0U);
    uint32_t ours = 0xAAAAAAAAU;
    uint32_t hand = 0xAAAAAAAAU;
    int verdict;
    int by_hand;
    word |= magntek_mt6835_spi_crc_crc_8(word >> 8U, 24U);
    if (one_in(4U)) {
        word ^= (uint64_t)1U << (arbitrary() % 64U);
    }
    verdict = magntek_mt6835_spi_angle_position(MAGNTEK_MT6835_SPI_MT6835, word, &ours);
    by_hand = hand_mt6835_position(word, &hand);
    accepted += (verdict == CW_USABLE);
    return (verdict != by_hand || ours != hand) ? differs("MT6835", verdict, by_hand) : 0;
}

static int compare_as5048a(uint16_t word)
{
    uint16_t ours = 0xAAAAU;
    uint16_t hand = 0xAAAAU;
    const int verdict = ams_as5048a_spi_position_position(AMS_AS5048A_SPI_AS5048A, word, &ours);
    const int by_hand = hand_as5048a_position(word, &hand);
    return (verdict != by_hand || ours != hand) ? differs("AS5048A", verdict, by_hand) : 0;
}

int main(void)
{
    uint32_t turn;
    int wrong = 0;
    for (turn = 0U; turn < TURNS && wrong == 0; turn++) {
        wrong = compare_biss_words() || compare_biss_buffers() || compare_ssi() || compare_replies() || compare_mt6835();
    }
    for (turn = 0U; turn < 0x10000U && wrong == 0; turn++) {
        wrong = compare_as5048a((uint16_t)turn);
    }
    if (wrong == 0 && accepted < TURNS / 4) {
        printf("only %lu frames were accepted\n", accepted);
        wrong = 1;
    }
    return wrong;
}
