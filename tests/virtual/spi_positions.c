/* Reads positions over SPI with a pipeline of one word, and a register after every 100 of them. The words go to
 * standard output and come from standard input, as two bytes each. Fails if a position is missing or wrong. */
#include <stdio.h>
#include <stdlib.h>

#include "ams/as5047p_spi.h"
#include "ams/as5047p_spi_registers.h"
#include "codewheel/spi.h"

#define encoder AMS_AS5047P_SPI_AS5047P

static uint16_t exchange(uint16_t word)
{
    uint8_t bytes[2];
    cw_spi_bytes(word, bytes, sizeof(bytes));
    if ((fwrite(bytes, 1U, 2U, stdout) != 2U) || (fflush(stdout) != 0) || (fread(bytes, 1U, 2U, stdin) != 2U)) {
        exit(2);
    }
    return (uint16_t)cw_spi_data(bytes, sizeof(bytes));
}

int main(int count, char **arguments)
{
    const unsigned long wanted = (count > 1) ? strtoul(arguments[1], NULL, 10) : 0UL;
    const ams_as5047p_spi_position_request position_request = { 0U };
    const ams_as5047p_spi_read_request read_request = { AMS_AS5047P_SPI_REG_DIAAGC_ADDRESS };
    unsigned long seen = 0UL;
    unsigned long registers = 0UL;
    unsigned long words = 0UL;
    cw_spi_pipeline line;
    cw_spi_start(&line, AMS_AS5047P_SPI_REPLY_WORDS);
    while (seen < wanted) {
        const int reads = (words++ % 101UL) == 100UL;
        uint16_t word;
        cw_spi_asked answered;
        const cw_result result = reads ? ams_as5047p_spi_read_request_encode(encoder, &read_request, &word)
                                       : ams_as5047p_spi_position_request_encode(encoder, &position_request, &word);
        if (result != CW_OK) {
            return 3;
        }
        answered = reads ? cw_spi_exchange(&line, AMS_AS5047P_SPI_REQUEST_READ_REQUEST, read_request.address)
                         : cw_spi_exchange(&line, AMS_AS5047P_SPI_REQUEST_POSITION_REQUEST, 0U);
        word = exchange(word);
        if (answered.request == AMS_AS5047P_SPI_REQUEST_POSITION_REQUEST) {
            ams_as5047p_spi_position frame;
            if (ams_as5047p_spi_position_decode(encoder, word, &frame) != CW_OK) {
                return 4;
            }
            if (frame.error || (frame.position != ((seen * 7UL) % 16384UL))) {
                return 5;
            }
            seen++;
        } else if (answered.request == AMS_AS5047P_SPI_REQUEST_READ_REQUEST) {
            ams_as5047p_spi_register_reply reply;
            ams_as5047p_spi_reg_diaagc value;
            uint8_t bytes[AMS_AS5047P_SPI_REG_DIAAGC_LENGTH];
            if ((answered.address != 0x3FFCU)
                || (ams_as5047p_spi_register_reply_decode(encoder, word, &reply) != CW_OK)) {
                return 6;
            }
            cw_spi_bytes(reply.data, bytes, sizeof(bytes));
            if ((ams_as5047p_spi_reg_diaagc_decode(encoder, bytes, sizeof(bytes), &value) != CW_OK)
                || (value.agc != 0x80U) || !value.offset_loop || value.mag_low) {
                return 7;
            }
            registers++;
        } else if (words != 1UL) {
            return 8;
        }
    }
    return (registers >= ((wanted - 1UL) / 100UL)) ? 0 : 9;
}
