/*
 * A driver of Zephyr against the emulator of its encoder, through stand-ins for Zephyr. Each line on standard input is
 * answered by one line:
 *
 *   p POSITION   sets the position, fetches, and prints the error, the result of channel_get, degrees and millionths
 *   f            fetches with an active flag, and prints the same
 *   e            fetches while the bus fails
 *   d            fetches while all received bits are disturbed
 *   m COUNTS     moves the shaft by this many counts between two words
 *   c            asks for other channels
 */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <zephyr/drivers/sensor.h>
#include <zephyr/drivers/spi_emul.h>
#include <zephyr/kernel.h>

#include HEADER

extern FRAME *EMUL_FRAME(const struct emul *target);
extern cw_result EMUL_SET_POSITION(const struct emul *target, POSITION_TYPE position);

static bool fails, disturbs;
static uint64_t position, movement;
static uint32_t waited_us;

bool spi_is_ready_dt(const struct spi_dt_spec *spec)
{
    return spec->config.operation == (SPI_WORD_SET(8U) | FLAGS);
}

int spi_transceive_dt(const struct spi_dt_spec *spec, const struct spi_buf_set *tx, const struct spi_buf_set *rx)
{
    const struct spi_emul_api *const api = emulated_encoder.bus_api;
    const int error = fails ? -ETIMEDOUT : api->io(&emulated_encoder, &spec->config, tx, rx);
    size_t at;
    for (at = 0U; disturbs && (at < rx->buffers[0].len); at++) {
        ((uint8_t *)rx->buffers[0].buf)[at] ^= 0xFFU;
    }
    position += movement;
    if (EMUL_SET_POSITION(&emulated_encoder, (POSITION_TYPE)position) != CW_OK) {
        puts("position refused");
    }
    return error;
}

int spi_read_dt(const struct spi_dt_spec *spec, const struct spi_buf_set *rx)
{
    return spi_transceive_dt(spec, NULL, rx);
}

void k_busy_wait(uint32_t us)
{
    waited_us += us;
}

static void fetch(void)
{
    const struct sensor_driver_api *const api = encoder.api;
    struct sensor_value value = {-1, -1};
    const int fetched = api->sample_fetch(&encoder, SENSOR_CHAN_ALL);
    const int got = api->channel_get(&encoder, SENSOR_CHAN_ROTATION, &value);
    printf("%s %s %" PRId32 " %" PRId32 " %" PRIu32 "\n", fetched ? strerror(-fetched) : "ok",
        got ? strerror(-got) : "ok", value.val1, value.val2, waited_us);
    waited_us = 0U;
}

int main(void)
{
    const struct sensor_driver_api *const api = encoder.api;
    struct sensor_value value;
    char line[80];
    if ((emulated_encoder.init(&emulated_encoder, NULL) != 0) || (encoder.init(&encoder) != 0)) {
        puts("not ready");
    }
    while (fgets(line, sizeof line, stdin) != NULL) {
        unsigned long long number = 0U;
        (void)sscanf(line + 1, "%llu", &number);
        switch (line[0]) {
        case 'p':
            position = number;
            (void)EMUL_SET_POSITION(&emulated_encoder, (POSITION_TYPE)position);
            fetch();
            break;
        case 'f':
            EMUL_FRAME(&emulated_encoder)->FLAG = true;
            fetch();
            EMUL_FRAME(&emulated_encoder)->FLAG = false;
            break;
        case 'e':
            fails = true;
            fetch();
            fails = false;
            break;
        case 'd':
            disturbs = true;
            fetch();
            disturbs = false;
            break;
        case 'm':
            movement = number;
            fetch();
            movement = 0U;
            break;
        default:
            printf("%s, %s\n", strerror(-api->sample_fetch(&encoder, SENSOR_CHAN_LIGHT)),
                strerror(-api->channel_get(&encoder, SENSOR_CHAN_LIGHT, &value)));
        }
    }
    return 0;
}
