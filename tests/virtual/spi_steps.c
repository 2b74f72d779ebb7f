/* Sets the zero position over SPI. The words go to standard output and come from standard input, as six bytes each.
 * With an argument, the runner carries out the steps, otherwise cw_run(). */
#include <stdio.h>
#include <stdlib.h>

#include "infineon/tle5012b_spi_procedures.h"

#include "codewheel/runner.h"
#include "codewheel/spi.h"

#define WORD 6U

#define encoder INFINEON_TLE5012B_SPI_TLE5012B

static uint64_t exchange(uint64_t word)
{
    uint8_t bytes[WORD];
    cw_spi_bytes(word, bytes, WORD);
    if ((fwrite(bytes, 1U, WORD, stdout) != WORD) || (fflush(stdout) != 0) || (fread(bytes, 1U, WORD, stdin) != WORD)) {
        exit(2);
    }
    return cw_spi_data(bytes, WORD);
}

static int32_t read_register(void *context, uint16_t address, uint8_t *bytes, size_t length)
{
    const infineon_tle5012b_spi_read_request request = { (uint8_t)address, 0U };
    infineon_tle5012b_spi_register_reply reply;
    uint64_t word;
    (void)context;
    if ((infineon_tle5012b_spi_read_request_encode(encoder, &request, &word) != CW_OK)
        || (infineon_tle5012b_spi_register_reply_decode(encoder, exchange(word), &reply) != CW_OK)) {
        return 1;
    }
    cw_spi_bytes(reply.data, bytes, length);
    return 0;
}

static int32_t write_register(void *context, uint16_t address, const uint8_t *bytes, size_t length)
{
    const infineon_tle5012b_spi_write_request request = { (uint8_t)address, (uint16_t)cw_spi_data(bytes, length), 0U };
    infineon_tle5012b_spi_write_reply reply;
    uint64_t word;
    (void)context;
    if ((infineon_tle5012b_spi_write_request_encode(encoder, &request, &word) != CW_OK)
        || (infineon_tle5012b_spi_write_reply_decode(encoder, exchange(word), &reply) != CW_OK)) {
        return 1;
    }
    return 0;
}

static int run_at_once(void)
{
    const cw_transport transport = { NULL, read_register, write_register, NULL, NULL, 0U, 0U };
    infineon_tle5012b_spi_set_zero_read held;
    if (infineon_tle5012b_spi_set_zero(&transport, encoder, 0x760U, &held, NULL) != CW_OK) {
        return 3;
    }
    return ((held.mod_3[0] == 0x76U) && (held.mod_3[1] == 0x00U)) ? 0 : 4;
}

static int run_step_by_step(void)
{
    cw_step steps[INFINEON_TLE5012B_SPI_SET_ZERO_STEPS_COUNT];
    uint8_t held[2];
    cw_runner runner;
    cw_todo todo;
    size_t count = 0U;
    if ((infineon_tle5012b_spi_set_zero_steps(encoder, 0x760U, steps, INFINEON_TLE5012B_SPI_SET_ZERO_STEPS_COUNT, &count)
            != CW_OK)
        || (cw_runner_start(&runner, steps, count, held, sizeof(held), 0U) != CW_OK)) {
        return 5;
    }
    while ((todo = cw_runner_next(&runner, 0U)) != CW_TODO_END) {
        const int32_t error = (todo == CW_TODO_READ) ? read_register(NULL, runner.address, runner.data, runner.length)
                                                     : write_register(NULL, runner.address, runner.data, runner.length);
        cw_runner_done(&runner, error, 0U);
    }
    return ((runner.result == CW_OK) && (held[0] == 0x76U) && (held[1] == 0x00U)) ? 0 : 6;
}

int main(int count, char **arguments)
{
    (void)arguments;
    return (count > 1) ? run_step_by_step() : run_at_once();
}
