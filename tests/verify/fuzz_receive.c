/*
 * Fuzz target for the header of receivers: buffers of any content and of exactly their size, lines
 * that are drawn here and must be read back, and a serial line with noise.
 */
#include "codewheel/receive_frame.h"
#include "fuzz.h"
#include <string.h>

/* As bytes, in memory of exactly as many as the frame has, or as few as 16. */
static void frames(const uint8_t *rx, size_t size, size_t received, uint32_t bits)
{
    const size_t length = (bits > 128U) ? 16U : ((size_t)bits + 7U) / 8U;
    uint8_t *const frame = malloc(length + (length == 0U));
    uint8_t *const same = malloc(length + (length == 0U));
    memset(frame, 0x5A, length);
    memset(same, 0x5A, length);
    require(cw_biss_receive_frame_bits(rx, received, bits, frame, length) == CW_OK || memcmp(frame, same, length) == 0,
        "a fault that changes the frame");
    memset(frame, 0x5A, length);
    require(cw_biss_receive_frame(rx, size, bits, frame, length) == CW_OK || memcmp(frame, same, length) == 0,
        "a fault that changes the frame");
    memset(frame, 0x5A, length);
    require(cw_ssi_receive_frame(rx, size, bits, frame, length) == CW_OK || memcmp(frame, same, length) == 0,
        "a fault that changes the frame");
    free(frame);
    free(same);
}

static void anything(void)
{
    const uint32_t bits = (uint32_t)take(((take(1U) & 3U) == 0U) ? 4U : 1U);
    const uint8_t mask = (uint8_t)take(1U);
    const size_t size = left;
    uint8_t *const rx = malloc(size + (size == 0U));
    uint8_t *const made = malloc(size + (size == 0U));
    uint64_t word = 0x5AU;
    bool cds = false;
    memcpy(rx, input, size);
    require(cw_biss_receive(rx, size, bits, &word) == CW_OK || word == 0x5AU, "a fault that changes the word");
    word = 0x5AU;
    require(cw_ssi_receive(rx, size, bits, &word) == CW_OK || word == 0x5AU, "a fault that changes the word");
    (void)(cw_biss_receive_cds(rx, size, &cds) == CW_OK);
    word = 0x5AU;
    require(cw_biss_receive_bits(rx, size * 8U - (size != 0U ? bits % 8U : 0U), bits, &word) == CW_OK || word == 0x5AU,
        "a fault that changes the word");
    (void)(cw_biss_receive_cds_bits(rx, size * 8U - (size != 0U ? bits % 8U : 0U), &cds) == CW_OK);
    frames(rx, size, size * 8U - (size != 0U ? bits % 8U : 0U), bits);
    require(cw_received_samples(rx, size, mask, made) == (size + 7U) / 8U, "samples that are lost");
    require(cw_received_samples(rx, size, mask, rx) == (size + 7U) / 8U, "samples that are lost");
    require(memcmp(rx, made, (size + 7U) / 8U) == 0, "samples that are read otherwise in place");
    free(rx);
    free(made);
}

static void drawn(void)
{
    const uint32_t bits = 1U + (uint32_t)(take(1U) % 64U);
    const uint64_t sent = take(8U) & cw_mask(bits);
    const size_t rest = 1U + (size_t)(take(1U) % 9U);
    const size_t acknowledge = 1U + (size_t)(take(1U) % 60U);
    const bool ssi = (take(1U) & 1U) != 0U;
    const size_t first = ssi ? 1U : rest + acknowledge + 2U;
    /* A line of BiSS may end with the last bit of the word. */
    const size_t received = first + bits + (ssi ? 1U : (size_t)(take(1U) & 1U));
    const size_t size = (received + 7U) / 8U;
    uint8_t *const rx = calloc(size, 1U);
    uint64_t word = 0U;
    size_t at;
    for (at = 0U; at < (ssi ? 1U : rest); at++) {
        rx[at / 8U] |= (uint8_t)(0x80U >> (at % 8U));
    }
    if (!ssi) {
        rx[(first - 2U) / 8U] |= (uint8_t)(0x80U >> ((first - 2U) % 8U));
    }
    for (at = 0U; at < bits; at++) {
        if (((sent >> (bits - 1U - at)) & 1U) != 0U) {
            rx[(first + at) / 8U] |= (uint8_t)(0x80U >> ((first + at) % 8U));
        }
    }
    require((ssi ? cw_ssi_receive(rx, size, bits, &word) : cw_biss_receive_bits(rx, received, bits, &word)) == CW_OK && word == sent,
        "a line that is read as another word");
    free(rx);
}

static void serial(void)
{
    cw_rs485_line line;
    const uint8_t control = (uint8_t)take(1U);
    const size_t length = (size_t)(take(1U) % 16U);
    const size_t echo = (size_t)(take(1U) % 5U);
    const uint32_t now = (uint32_t)take(4U);
    const cw_result asked = cw_rs485_ask(&line, control, length, echo, now, (uint32_t)take(2U));
    require((asked == CW_OK) == (length != 0U && length <= CW_RECEIVE_RS485_BYTES), "a length that does not fit");
    require(asked != CW_OK || cw_rs485_reason(&line) == CW_FAULT_TIMEOUT, "a reason of a line that is new");
    while (asked == CW_OK && left > 0U) {
        if (cw_rs485_take(&line, (uint8_t)take(1U))) {
            require(line.count == length && line.bytes[0] == control && !cw_rs485_late(&line, now + 0x7FFFFFFFU), "a reply that is none");
            if ((take(1U) & 1U) != 0U) {
                cw_rs485_resume(&line);
                require(line.count < length && (line.count == 0U || line.bytes[0] == control), "a rest that begins otherwise");
            }
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    input = data;
    left = size;
    switch (take(1U) & 3U) {
    case 0U:
        anything();
        break;
    case 1U:
        drawn();
        break;
    case 2U:
        serial();
        break;
    default: {
        const uint64_t first = take(8U);
        const uint64_t second = take(8U);
        const uint64_t modulus = take(8U);
        (void)(cw_ssi_repeats(first, second, modulus, take(8U)) == CW_OK);
        break;
    }
    }
    return 0;
}
