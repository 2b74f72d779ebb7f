/* Decodes, judges and encodes one frame of each interface. Prints a line for each. */
#include "ams/as5047p_spi.h"
#include "ams/as5047p_spi_registers.h"
#include "ams/as5047p_spi_simulate.h"
#include "codewheel/spi.h"
#include "lika/am36_ssi.h"
#include "lika/am36_ssi_simulate.h"
#include "lika/amm5_biss.h"
#include "lika/amm5_biss_simulate.h"
#include "lika/amm5_rs485.h"
#include "lika/amm5_rs485_simulate.h"
#include <stdio.h>
#include <stdlib.h>

static void check(cw_result result)
{
    if (result != CW_OK) {
        printf("result %d\n", (int)result);
        exit(1);
    }
}

static void biss(uint64_t number)
{
    const lika_amm5_biss encoder = LIKA_AMM5_BISS_A21_65KSC1;
    const cw_word word = cw_word_of(number, LIKA_AMM5_BISS_A21_65KSC1_BITS);
    const cw_word disturbed = cw_word_of(number ^ 0x100U, LIKA_AMM5_BISS_A21_65KSC1_BITS);
    lika_amm5_biss_frame frame;
    uint64_t position = 0U;
    uint64_t again = 0U;
    const cw_verdict verdict = lika_amm5_biss_position(encoder, word, &position);
    const cw_result damaged = lika_amm5_biss_decode(encoder, disturbed, &frame);
    check(lika_amm5_biss_decode(encoder, word, &frame));
    check(lika_amm5_biss_encode(encoder, &frame, &again));
    printf("biss %d %llu %d %llX\n", (int)verdict, (unsigned long long)position, (int)damaged, (unsigned long long)again);
}

static void ssi(uint64_t number)
{
    const cw_word word = cw_word_of(number, LIKA_AM36_SSI_AM3616_4096_GG_BITS);
    const lika_am36_ssi encoder = LIKA_AM36_SSI_AM3616_4096_GG;
    lika_am36_ssi_frame frame;
    uint32_t position = 0U;
    uint64_t again = 0U;
    const cw_verdict verdict = lika_am36_ssi_position(encoder, word, &position);
    check(lika_am36_ssi_decode(encoder, word, &frame));
    check(lika_am36_ssi_encode(encoder, &frame, &again));
    printf("ssi %d %lu %u %llX\n", (int)verdict, (unsigned long)position, (unsigned)frame.multiturn,
           (unsigned long long)again);
}

static void rs485(const uint8_t *bytes)
{
    const lika_amm5_rs485 encoder = LIKA_AMM5_RS485_A23_65KJP1;
    const lika_amm5_rs485_data_request request = { LIKA_AMM5_RS485_DATA_ID_SINGLETURN };
    lika_amm5_rs485_singleturn_reply reply;
    uint8_t sent[1] = { 0U };
    uint8_t damaged[6];
    uint8_t again[6] = { 0U };
    size_t at;
    for (at = 0U; at < sizeof(damaged); at++) {
        damaged[at] = bytes[at];
    }
    damaged[2] ^= 1U;
    check(lika_amm5_rs485_data_request_encode(encoder, &request, sent, sizeof(sent)));
    printf("rs485 %02X %d", (unsigned)sent[0],
           (int)lika_amm5_rs485_singleturn_reply_decode(encoder, damaged, sizeof(damaged), &reply));
    check(lika_amm5_rs485_singleturn_reply_decode(encoder, bytes, 6U, &reply));
    check(lika_amm5_rs485_singleturn_reply_encode(encoder, &reply, again, sizeof(again)));
    printf(" %d %lu ", (int)lika_amm5_rs485_singleturn_reply_verdict(encoder, &reply), (unsigned long)reply.singleturn);
    for (at = 0U; at < sizeof(again); at++) {
        printf("%02X", (unsigned)again[at]);
    }
    printf("\n");
}

static void spi(const uint8_t *received, const uint8_t *diaagc)
{
    const ams_as5047p_spi encoder = AMS_AS5047P_SPI_AS5047P;
    const ams_as5047p_spi_position_request request = { 0U };
    ams_as5047p_spi_position reply;
    ams_as5047p_spi_reg_diaagc gain;
    uint8_t sent[2] = { 0U, 0U };
    uint16_t word = 0U;
    uint16_t again = 0U;
    check(ams_as5047p_spi_read_request_encode(
        encoder, &(ams_as5047p_spi_read_request){ AMS_AS5047P_SPI_REG_DIAAGC_ADDRESS }, &word));
    check(cw_spi_store(word, 16U, sent, sizeof(sent)));
    printf("spi %02X%02X", (unsigned)sent[0], (unsigned)sent[1]);
    check(ams_as5047p_spi_position_request_encode(encoder, &request, &word));
    printf(" %X", (unsigned)word);
    check(ams_as5047p_spi_position_receive(encoder, received, 2U, &word));
    printf(" %d", (int)ams_as5047p_spi_position_decode(encoder, (uint16_t)(word ^ 1U), &reply));
    check(ams_as5047p_spi_position_decode(encoder, word, &reply));
    check(ams_as5047p_spi_position_encode(encoder, &reply, &again));
    printf(" %u %d %X", (unsigned)reply.position, (int)ams_as5047p_spi_position_verdict(encoder, &reply),
           (unsigned)again);
    check(ams_as5047p_spi_reg_diaagc_decode(encoder, diaagc, 2U, &gain));
    printf(" %d %u\n", (int)gain.offset_loop, (unsigned)gain.agc);
}

int main(void)
{
    static const uint8_t reply[] = { 0x02U, 0x20U, 0xC7U, 0xD1U, 0x6AU, 0x5EU };
    static const uint8_t angle[] = { 0x92U, 0x34U };
    static const uint8_t diaagc[] = { 0x01U, 0x80U };
    biss(UINT64_C(0xF4243D3));
    biss(UINT64_C(0xF424355));
    ssi(UINT64_C(0x186A3) ^ (UINT64_C(0x186A3) >> 1U));
    rs485(reply);
    spi(angle, diaagc);
    return 0;
}
