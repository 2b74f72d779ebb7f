/*
 * two_encoders.c - encoders of two manufacturers in one program, with one BiSS master
 *
 * SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 *
 * The AMM5 is a product of Lika Electronic. The TV62 is the fictional encoder of this project's
 * manual. Both headers include the same runtime, so the results, the verdicts, the bus functions and
 * the master are the same for both:
 *
 *   codewheel generate specs/lika docs/example/tolvarn -o out
 *   cc -std=c99 -Iout/c/include examples/two-manufacturers/two_encoders.c -o two_encoders
 *
 * The program runs on any computer, since it simulates both encoders as slaves in a chain. The
 * manual of the AMM5 describes only point-to-point wiring. If an encoder must be alone on its line,
 * switch the line instead of the ID.
 */
#include <stdio.h>

#include "codewheel/biss_slave.h"
#include "lika/amm5_biss.h"
#include "lika/amm5_biss_registers.h"
#include "lika/amm5_biss_simulate.h"
#include "tolvarn/tv62_biss.h"
#include "tolvarn/tv62_biss_registers.h"
#include "tolvarn/tv62_biss_simulate.h"

#define amm5 LIKA_AMM5_BISS_A21_1SC1
#define tv62 TOLVARN_TV62_BISS_M17_B1

/* IDs in the chain: ID 0 is the slave farthest from the master. */
#define AMM5_ID 0U
#define TV62_ID 1U
/* Frames in which a slave may be busy. */
#define BUSY_FRAMES 100U

static cw_biss_master master;

/* -- simulated encoders ------------------------------------------------------------------------ */

static cw_biss_slave slaves[2];
static uint8_t registers[2][128];
static bool cdm;

/* Run one frame: both slaves see the last CDM bit, and the master sees the CDS of the nearest. */
static void run_frame(void)
{
    bool cds = false;
    size_t id;
    for (id = 0U; id < 2U; id++) {
        cds = cw_biss_slave_next(&slaves[id], cdm, cds);
        cw_biss_slave_give(&slaves[id], registers[id][slaves[id].address]);
    }
    cdm = cw_biss_master_next(&master, cds);
}

static bool simulate(void)
{
    static const lika_amm5_biss_reg_serial_number serial = { 212600042U, 21U, 26U, 42U };
    static const tolvarn_tv62_biss_reg_serial_number number = { 123456U };
    bool ready = true;
    size_t id;
    for (id = 0U; id < 2U; id++) {
        cw_biss_slave_init(&slaves[id]);
        ready = ready && (cw_biss_slave_allow(&slaves[id], 0U, 128U, true, false) == CW_OK);
    }
    return ready &&
        (lika_amm5_biss_reg_serial_number_encode(amm5, &serial,
            &registers[AMM5_ID][LIKA_AMM5_BISS_REG_SERIAL_NUMBER_ADDRESS],
            LIKA_AMM5_BISS_REG_SERIAL_NUMBER_LENGTH) == CW_OK) &&
        (tolvarn_tv62_biss_reg_serial_number_encode(tv62, &number,
            &registers[TV62_ID][TOLVARN_TV62_BISS_REG_SERIAL_NUMBER_ADDRESS],
            TOLVARN_TV62_BISS_REG_SERIAL_NUMBER_LENGTH) == CW_OK);
}

/* -- one bus for both -------------------------------------------------------------------------- */

/* Read registers of the slave whose ID is the context, with the one master. */
static int32_t bus_read(void *context, uint16_t address, uint8_t *bytes, size_t length)
{
    const uint8_t id = *(const uint8_t *)context;
    if (cw_biss_master_read(&master, id, (uint8_t)address, bytes, length, BUSY_FRAMES) != CW_OK) {
        return -1;
    }
    while (master.outcome == CW_BISS_RUNNING) {
        run_frame();
    }
    return (master.outcome == CW_BISS_DONE) ? 0 : (int32_t)master.outcome;
}

static cw_result show_serial_numbers(cw_failure *failure)
{
    static uint8_t ids[2] = { AMM5_ID, TV62_ID };
    const cw_transport to_amm5 = { &ids[AMM5_ID], bus_read, NULL, NULL, NULL, 0U, 0U };
    const cw_transport to_tv62 = { &ids[TV62_ID], bus_read, NULL, NULL, NULL, 0U, 0U };
    lika_amm5_biss_reg_serial_number serial;
    tolvarn_tv62_biss_reg_serial_number number;
    cw_result result = lika_amm5_biss_read_serial_number(&to_amm5, amm5, &serial, failure);
    if (result == CW_OK) {
        printf("AMM5: year %u, week %u, number %lu\n", (unsigned)serial.year,
            (unsigned)serial.week, (unsigned long)serial.number);
        result = tolvarn_tv62_biss_read_serial_number(&to_tv62, tv62, &number, failure);
    }
    if (result == CW_OK) {
        printf("TV62: number %lu\n", (unsigned long)number.serial_number);
    }
    return result;
}

/* -- one comparison of verdicts ---------------------------------------------------------------- */

static const char *words_of(cw_verdict verdict)
{
    static const char *const words[] = {
        "not usable", "unknown", "usable with a warning", "usable"
    };
    return words[verdict];
}

/* Decode a frame of each encoder. Return the worse verdict, or NOT_USABLE if one is not valid. */
static cw_verdict show_positions(uint64_t amm5_word, uint64_t tv62_word)
{
    lika_amm5_biss_frame first;
    tolvarn_tv62_biss_position_data second;
    cw_verdict worse = CW_NOT_USABLE;
    cw_result result = lika_amm5_biss_decode(
        amm5, cw_word_of(amm5_word, lika_amm5_biss_bits(amm5)), &first);
    if (result == CW_OK) {
        result = tolvarn_tv62_biss_position_data_decode(
            tv62, cw_word_of(tv62_word, tolvarn_tv62_biss_position_data_bits(tv62)), &second);
    }
    if (result == CW_OK) {
        const cw_verdict one = lika_amm5_biss_verdict(amm5, &first);
        const cw_verdict other = tolvarn_tv62_biss_position_data_verdict(tv62, &second);
        worse = (one < other) ? one : other;
        printf("AMM5: position %lu, %s\n", (unsigned long)first.position, words_of(one));
        printf("TV62: position %lu, %s\n", (unsigned long)second.position, words_of(other));
    }
    return worse;
}

/* Encode the frames that the encoders would send: the AMM5 with its warning active. */
static bool frames(uint64_t *amm5_word, uint64_t *tv62_word)
{
    lika_amm5_biss_frame first = { 0U, 0U, false, true, 0U };
    tolvarn_tv62_biss_position_data second = { 0U, 0U, false, false, 1U, 0U };
    return (lika_amm5_biss_set_position(amm5, 1000503U, &first) == CW_OK) &&
        (lika_amm5_biss_encode(amm5, &first, amm5_word) == CW_OK) &&
        (tolvarn_tv62_biss_position_data_set_position(tv62, 70001U, &second) == CW_OK) &&
        (tolvarn_tv62_biss_position_data_encode(tv62, &second, tv62_word) == CW_OK);
}

int main(void)
{
    cw_failure failure = { 0U, CW_STEP_READ, CW_STEP_READ, 0U, 0, false };
    uint64_t amm5_word = 0U;
    uint64_t tv62_word = 0U;
    cw_biss_master_init(&master);
    if (!simulate() || !frames(&amm5_word, &tv62_word)) {
        return 1;
    }
    if (show_serial_numbers(&failure) != CW_OK) {
        printf("register %02Xh: error %ld\n", (unsigned)failure.address, (long)failure.error);
        return 1;
    }
    printf("both: %s\n", words_of(show_positions(amm5_word, tv62_word)));
    return 0;
}
