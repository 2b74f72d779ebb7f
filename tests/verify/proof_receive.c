/*
 * Claims about receivers for the model checker CBMC. For any bytes in a buffer, a reader stays inside
 * it and finds the word on the line, which is read here once more bit by bit. A serial line stays in a
 * possible state for any input.
 */
#include "codewheel/receive_frame.h"

int nondet_int(void);
uint8_t nondet_byte(void);
uint32_t nondet_word(void);
uint64_t nondet_wide(void);
size_t nondet_size(void);

/* Some bits of rest and acknowledge, and a word of some bits, so that every position within a byte occurs. */
#define SIZE 2U

static uint8_t rx[SIZE];
static size_t size;
static size_t received; /* bits, at most 8 * size */

static void any_buffer(void)
{
    size_t at;
    for (at = 0U; at < SIZE; at++) {
        rx[at] = nondet_byte();
    }
    size = nondet_size();
    __CPROVER_assume(size <= SIZE);
    received = nondet_size();
    __CPROVER_assume(received <= (8U * size));
}

static unsigned bit(size_t place)
{
    return (rx[place / 8U] >> (7U - (place % 8U))) & 1U;
}

/* Return the index of the first such bit from this one on, or the end if there is none. */
static size_t next(size_t place, unsigned wanted)
{
    while ((place < received) && (bit(place) != wanted)) {
        place++;
    }
    return place;
}

void a_frame_of_biss(void)
{
    const uint32_t bits = nondet_word();
    uint64_t word = 0x5AU;
    cw_result result;
    size_t low;
    size_t start;
    uint64_t expected = 0U;
    size_t at;
    any_buffer();
    low = next(0U, 0U);
    start = next(low, 1U);
    result = cw_biss_receive_bits(rx, received, bits, &word);
    __CPROVER_assert((result == CW_OK) || (word == 0x5AU), "a fault leaves the word as it was");
    __CPROVER_assert((result == CW_FAULT_LINE_HIGH) == (low == received), "never low");
    __CPROVER_assert((result == CW_FAULT_LINE_LOW) == ((received != 0U) && (low == 0U)), "low before the frame");
    if ((low == 0U) || (low == received)) {
        return;
    }
    __CPROVER_assert((result == CW_FAULT_NO_START) == (start == received), "no start");
    if (start == received) {
        return;
    }
    if ((bits > 64U) || ((start + 2U + bits) > received)) {
        __CPROVER_assert(result == CW_FAULT_LENGTH, "too few bits");
        return;
    }
    const bool wrong = ((start + 2U + bits) < received) && (bit(start + 2U + bits) != 0U);
    __CPROVER_assert(result == (wrong ? CW_FAULT_CONSTANT : CW_OK), "the stop bit, if there is one");
    for (at = start + 2U; at < (start + 2U + bits); at++) {
        expected = (2U * expected) + bit(at);
    }
    __CPROVER_assert((result != CW_OK) || (word == expected), "the word");
}

/* The start bit in up to 9 bytes, so that two words and a part of a third occur: the first 1 after a 0. */
void a_start_bit(void)
{
    uint8_t line[9];
    const size_t bits = nondet_size();
    const size_t any = nondet_size();
    size_t at;
    size_t found;
    __CPROVER_assume((bits <= (8U * sizeof line)) && (any < bits));
    for (at = 0U; at < sizeof line; at++) {
        line[at] = nondet_byte();
    }
    found = cw_biss_start(line, bits);
    if (found < bits) {
        __CPROVER_assert((found > 0U) && (cw_received_bit(line, found) == 1U) && (cw_received_bit(line, found - 1U) == 0U),
            "a 1 after a 0");
    }
    if ((any != 0U) && (any < found)) {
        __CPROVER_assert(cw_received_bit(line, any) <= cw_received_bit(line, any - 1U), "none before it");
    }
    if (found >= bits) {
        __CPROVER_assert(found == (bits + cw_received_bit(line, bits - 1U)), "none at all, and no 0 either");
    }
}

/* A bit of a buffer, or 0 after its end. */
static uint32_t bit_or_zero(const uint8_t *data, size_t count, size_t place)
{
    return (place < (8U * count)) ? cw_received_bit(data, place) : 0U;
}

/* Up to 57 bits anywhere in 8 or 9 bytes, and zeros after their end, which is also that of the buffer. */
void a_word_in_eight_bytes(void)
{
    const size_t count = nondet_size();
    const size_t first = nondet_size();
    const uint32_t bits = nondet_word();
    uint8_t buffer[9];
    const uint8_t *data;
    uint32_t high, low;
    uint64_t found;
    size_t at;
    __CPROVER_assume((count >= 8U) && (count <= sizeof buffer) && (bits >= 1U) && (bits <= 57U));
    __CPROVER_assume(first < (8U * count));
    for (at = 0U; at < sizeof buffer; at++) {
        buffer[at] = nondet_byte();
    }
    data = &buffer[sizeof buffer - count];
    cw_received_halves(data, count, first, &high, &low);
    found = cw_received_highest(high, low, bits);
    at = nondet_size();
    __CPROVER_assume(at < 64U);
    __CPROVER_assert(((found >> at) & 1U) == ((at < bits) ? bit_or_zero(data, count, (first + bits) - 1U - at) : 0U),
        "each bit of the word");
}

/* A frame in eight bytes, with the start bit at any position in them: its word, and the stop bit after it. */
void a_frame_in_eight_bytes(void)
{
    const uint32_t bits = nondet_word();
    const size_t count = nondet_size();
    uint8_t line[8];
    uint64_t word = 0x5AU;
    cw_result result;
    size_t at;
    for (at = 0U; at < sizeof line; at++) {
        line[at] = nondet_byte();
    }
    __CPROVER_assume((bits <= 64U) && (count > 56U) && (count <= 64U));
    result = cw_biss_receive_bits(line, count, bits, &word);
    __CPROVER_assert((result == CW_OK) || (word == 0x5AU), "an error leaves the word as it was");
    const size_t after = cw_biss_start(line, count) + 2U + (size_t)bits;
    if ((cw_received_bit(line, 0U) == 0U) || (after > count)) {
        __CPROVER_assert(result != CW_OK, "no frame");
        return;
    }
    const bool stopped = (after == count) || (cw_received_bit(line, after) == 0U);
    __CPROVER_assert(result == (stopped ? CW_OK : CW_FAULT_CONSTANT), "the stop bit, if there is one");
    at = nondet_size();
    __CPROVER_assume(at < 64U);
    __CPROVER_assert(!stopped || (((word >> at) & 1U) == ((at < bits) ? cw_received_bit(line, after - 1U - at) : 0U)),
        "each bit of the word");
}

/* Up to 64 bits from any position within a byte, in a buffer that ends with the last of them. */
void a_word_over_nine_bytes(void)
{
    const size_t first = nondet_size();
    const uint32_t bits = nondet_word();
    uint8_t buffer[9];
    uint64_t found;
    size_t at;
    __CPROVER_assume((first < 8U) && (bits <= 64U));
    for (at = 0U; at < sizeof buffer; at++) {
        buffer[at] = nondet_byte();
    }
    found = cw_received_bits(buffer, first, bits);
    at = nondet_size();
    __CPROVER_assume(at < 64U);
    __CPROVER_assert(((found >> at) & 1U) == ((at < bits) ? cw_received_bit(buffer, (first + bits) - 1U - at) : 0U),
        "each bit of the word");
}

/* Up to 64 bits of SSI, in a buffer that ends with the last of them. */
void a_word_of_ssi_in_nine_bytes(void)
{
    const uint32_t bits = nondet_word();
    uint8_t buffer[9];
    const uint8_t *data;
    uint64_t found;
    size_t at;
    __CPROVER_assume(bits <= 64U);
    for (at = 0U; at < sizeof buffer; at++) {
        buffer[at] = nondet_byte();
    }
    data = &buffer[(sizeof buffer - 1U) - (bits / 8U)];
    found = cw_ssi_word(data, bits);
    at = nondet_size();
    __CPROVER_assume(at < 64U);
    __CPROVER_assert(((found >> at) & 1U) == ((at < bits) ? cw_received_bit(data, bits - at) : 0U),
        "each bit of the word");
}

void a_frame_in_whole_bytes(void)
{
    const uint32_t bits = nondet_word();
    uint64_t word = 0x5AU, same = 0x5AU;
    bool cds = false, again = false;
    any_buffer();
    received = 8U * size;
    __CPROVER_assert(cw_biss_receive(rx, size, bits, &word) == cw_biss_receive_bits(rx, received, bits, &same)
        && word == same, "the frame");
    __CPROVER_assert(cw_biss_receive_cds(rx, size, &cds) == cw_biss_receive_cds_bits(rx, received, &again)
        && cds == again, "and its CDS");
}

void its_cds(void)
{
    bool cds = false;
    cw_result result;
    size_t start;
    any_buffer();
    start = next(next(0U, 0U), 1U);
    result = cw_biss_receive_cds_bits(rx, received, &cds);
    __CPROVER_assert((result == CW_FAULT_LENGTH) == ((start + 1U) >= received), "where there is one");
    __CPROVER_assert((result == CW_OK) || (result == CW_FAULT_LENGTH) || (bit(0U) == 0U), "after a line at rest");
    __CPROVER_assert((result != CW_OK) || (bit(0U) != 0U), "which is high");
    __CPROVER_assert((result != CW_OK) || (cds == (bit(start + 1U) != 0U)), "the bit after start");
}

void a_word_of_ssi(void)
{
    const uint32_t bits = nondet_word();
    uint64_t word = 0x5AU;
    uint64_t expected = 0U;
    bool ones = true;
    cw_result result;
    size_t at;
    any_buffer();
    result = cw_ssi_receive(rx, size, bits, &word);
    __CPROVER_assert((result == CW_OK) || (word == 0x5AU), "a fault leaves the word as it was");
    if ((bits > 64U) || ((bits + 2U) > (8U * size))) {
        __CPROVER_assert(result == CW_FAULT_LENGTH, "too few bits");
        return;
    }
    for (at = 1U; at <= bits; at++) {
        expected = (2U * expected) + bit(at);
        ones = ones && (bit(at) != 0U);
    }
    if (bit(0U) == 0U) {
        __CPROVER_assert(result == CW_FAULT_LINE_LOW, "low before the word");
    } else if (bit(bits + 1U) != 0U) {
        __CPROVER_assert(result == (ones ? CW_FAULT_LINE_HIGH : CW_FAULT_CONSTANT), "high after the word");
    } else {
        __CPROVER_assert((result == CW_OK) && (word == expected), "the word");
    }
}

/* Any number of bits as bytes: each bit is at its place from the end, and the rest is 0. */
void bits_as_bytes(void)
{
    uint8_t frame[4];
    const size_t length = nondet_size();
    const size_t first = nondet_size();
    const uint32_t bits = nondet_word();
    const size_t any = nondet_size();
    any_buffer();
    __CPROVER_assume((length <= sizeof frame) && (bits <= (8U * length)) && (bits <= (8U * SIZE)));
    __CPROVER_assume((first <= (8U * SIZE)) && ((first + bits) <= (8U * SIZE)) && (any < (8U * length)));
    cw_received_frame(rx, first, bits, frame, length);
    __CPROVER_assert(((frame[(length - 1U) - (any / 8U)] >> (any % 8U)) & 1U)
        == ((any < bits) ? bit((first + bits) - 1U - any) : 0U), "each bit");
}

/* A frame in bytes has the result of the same frame as a word, and the same bits, while a word can have them. */
void a_frame_of_biss_as_bytes(void)
{
    const uint32_t bits = nondet_word();
    const size_t length = nondet_size();
    uint8_t frame[2] = { 0x5AU, 0xA5U };
    uint64_t word = 0x5AA5U;
    cw_result result;
    any_buffer();
    __CPROVER_assume(length <= sizeof frame);
    result = cw_biss_receive_frame_bits(rx, received, bits, frame, length);
    __CPROVER_assert((result == CW_OK) || ((frame[0] == 0x5AU) && (frame[1] == 0xA5U)), "a fault leaves the frame as it was");
    if (bits <= (8U * length)) {
        __CPROVER_assert(result == cw_biss_receive_bits(rx, received, bits, &word), "the same result");
        __CPROVER_assert((result != CW_OK) || (length != 2U) || (((frame[0] * 256U) + frame[1]) == word), "and the same bits");
        __CPROVER_assert((result != CW_OK) || (length != 1U) || (frame[0] == word), "in one byte too");
    } else {
        __CPROVER_assert((result == CW_FAULT_LENGTH) || (result == cw_biss_receive_bits(rx, received, bits, &word)),
            "too long, unless the line has no start");
        __CPROVER_assert(result != CW_OK, "nothing beyond the frame");
    }
}

void a_frame_as_bytes_from_whole_bytes(void)
{
    const uint32_t bits = nondet_word();
    uint8_t frame[2] = { 0x5AU, 0xA5U };
    uint8_t same[2] = { 0x5AU, 0xA5U };
    any_buffer();
    __CPROVER_assert(cw_biss_receive_frame(rx, size, bits, frame, 2U)
        == cw_biss_receive_frame_bits(rx, 8U * size, bits, same, 2U), "the result");
    __CPROVER_assert((frame[0] == same[0]) && (frame[1] == same[1]), "the frame");
}

void a_word_of_ssi_as_bytes(void)
{
    const uint32_t bits = nondet_word();
    const size_t length = nondet_size();
    uint8_t frame[2] = { 0x5AU, 0xA5U };
    uint64_t word = 0x5AA5U;
    cw_result result;
    any_buffer();
    __CPROVER_assume(length <= sizeof frame);
    result = cw_ssi_receive_frame(rx, size, bits, frame, length);
    __CPROVER_assert((result == CW_OK) || ((frame[0] == 0x5AU) && (frame[1] == 0xA5U)), "a fault leaves the frame as it was");
    if (bits > (8U * length)) {
        __CPROVER_assert(result == CW_FAULT_LENGTH, "too long for its bytes");
        return;
    }
    __CPROVER_assert(result == cw_ssi_receive(rx, size, bits, &word), "the same result");
    __CPROVER_assert((result != CW_OK) || (length != 2U) || (((frame[0] * 256U) + frame[1]) == word), "and the same bits");
    __CPROVER_assert((result != CW_OK) || (length != 1U) || (frame[0] == word), "in one byte too");
}

void two_readings(void)
{
    const uint64_t first = nondet_wide();
    const uint64_t second = nondet_wide();
    const uint64_t modulus = nondet_wide();
    const uint64_t most = nondet_wide();
    const cw_result result = cw_ssi_repeats(first, second, modulus, most);
    const uint64_t apart = (first > second) ? (first - second) : (second - first);
    if ((modulus != 0U) && ((first >= modulus) || (second >= modulus))) {
        __CPROVER_assert(result == CW_FAULT_RANGE, "positions are below their modulus");
    } else {
        const bool near = (apart <= most) || ((modulus != 0U) && ((modulus - apart) <= most));
        __CPROVER_assert(result == (near ? CW_OK : CW_FAULT_REPEAT), "the shorter way");
    }
}

void other_shapes(void)
{
    const uint16_t halves[2] = { (uint16_t)(nondet_word() & 0xFFFFU), (uint16_t)(nondet_word() & 0xFFFFU) };
    const uint32_t words[2] = { nondet_word(), nondet_word() };
    const uint8_t mask = nondet_byte();
    uint8_t samples[16];
    uint8_t made[8];
    size_t at;
    cw_received_words16(halves, 2U, made);
    __CPROVER_assert(((made[2] * 256U) + made[3]) == halves[1], "two bytes of each word");
    cw_received_words32(words, 2U, made);
    __CPROVER_assert(((((((made[4] * 256ULL) + made[5]) * 256U) + made[6]) * 256U) + made[7]) == words[1], "four bytes of each word");
    for (at = 0U; at < 16U; at++) {
        samples[at] = nondet_byte();
    }
    at = nondet_size();
    __CPROVER_assume(at < 16U);
    size = nondet_size();
    __CPROVER_assume(size <= 16U);
    __CPROVER_assert(cw_received_samples(samples, size, mask, rx) == ((size + 7U) / 8U), "bytes for all of them");
    __CPROVER_assert((at >= size) || (bit(at) == (((samples[at] & mask) != 0U) ? 1U : 0U)), "a bit of each sample");
    __CPROVER_assert((at < size) || (at >= (8U * ((size + 7U) / 8U))) || (bit(at) == 1U), "and ones after them");
}

static bool line_can_be(const cw_rs485_line *line)
{
    return (line->length <= CW_RECEIVE_RS485_BYTES) && (line->count <= line->length)
        && ((line->count == 0U) || (line->bytes[0] == line->control));
}

void one_more_byte_of_a_line(void)
{
    cw_rs485_line line;
    const uint8_t byte = nondet_byte();
    size_t before;
    bool whole;
    __CPROVER_assume(line_can_be(&line));
    before = line.count;
    whole = cw_rs485_take(&line, byte);
    __CPROVER_assert(line_can_be(&line), "a line stays what it can be");
    __CPROVER_assert(!whole || ((line.count == line.length) && (line.count == (before + 1U)) && (line.bytes[before] == byte)),
        "whole with this byte");
    before = line.count;
    cw_rs485_resume(&line);
    __CPROVER_assert(line_can_be(&line) && ((line.count < before) || (before == 0U)), "and looks on behind the first byte");
}

/* First bytes that are not the start of a reply are reported as such, whatever follows them. */
void a_reply_without_its_first_byte(void)
{
    cw_rs485_line line;
    const uint8_t control = nondet_byte();
    const uint8_t first = nondet_byte();
    cw_result reason;
    if (cw_rs485_ask(&line, control, 4U, 0U, 0U, 1U) != CW_OK) {
        return;
    }
    __CPROVER_assert(cw_rs485_reason(&line) == CW_FAULT_TIMEOUT, "nothing came");
    __CPROVER_assume(first != control);
    (void)cw_rs485_take(&line, first);
    __CPROVER_assert(cw_rs485_reason(&line) == CW_FAULT_HEAD_MISSING, "one byte");
    (void)cw_rs485_take(&line, nondet_byte());
    (void)cw_rs485_take(&line, nondet_byte());
    reason = cw_rs485_reason(&line);
    __CPROVER_assert(reason == CW_FAULT_HEAD_MISSING, "three of four bytes");
}

void a_line_that_waits(void)
{
    cw_rs485_line line;
    const uint32_t now = nondet_word();
    const uint32_t later = nondet_word();
    const uint32_t most = nondet_word();
    const size_t length = nondet_size();
    const cw_result result = cw_rs485_ask(&line, nondet_byte(), length, nondet_size(), now, most);
    __CPROVER_assert(
        result == (((length == 0U) || (length > CW_RECEIVE_RS485_BYTES)) ? CW_FAULT_LENGTH : CW_OK), "what there is room for");
    if (result == CW_OK) {
        __CPROVER_assert(line_can_be(&line), "a line that is new");
        __CPROVER_assert(cw_rs485_late(&line, later) == ((((1ULL << 32U) + later - now) % (1ULL << 32U)) > most), "time that runs over");
    }
}
