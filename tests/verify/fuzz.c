/*
 * The functions that libFuzzer calls. This follows the text of the batch program (batch.py), with the
 * calls of the header's functions inserted (fuzz.py).
 */
#include "fuzz.h"
#include <string.h>

static size_t feed(uint8_t *to, size_t count) { (void)to; (void)count; return 0U; }
static void emit(const uint8_t *from, size_t count) { (void)from; (void)count; }

static char *text(void)
{
    const size_t length = (size_t)(take(1U) % 40U);
    char *const made = malloc(length + 1U);
    size_t index;
    for (index = 0U; index < length; index++) {
        made[index] = (char)take(1U);
    }
    made[length] = '\0';
    return made;
}

static int32_t fuzzed_error(void)
{
    const uint64_t byte = take(1U);
    return byte > 0xE0U ? (int32_t)byte - 0xF0 : 0;
}

static int32_t fuzzed_read(void *context, uint16_t address, uint8_t *bytes, size_t length)
{
    size_t index;
    (void)context;
    (void)address;
    for (index = 0U; index < length; index++) {
        bytes[index] = (uint8_t)take(1U);
    }
    return fuzzed_error();
}

static int32_t fuzzed_write(void *context, uint16_t address, const uint8_t *bytes, size_t length)
{
    size_t index;
    volatile uint8_t seen = 0U;
    (void)context;
    (void)address;
    for (index = 0U; index < length; index++) {
        seen = bytes[index];
    }
    (void)seen;
    return fuzzed_error();
}

static int32_t fuzzed_wait(void *context, uint32_t microseconds)
{
    (void)context;
    (void)microseconds;
    return fuzzed_error();
}

static int32_t fuzzed_send(void *context, uint8_t request, uint8_t *reply, size_t length)
{
    (void)context;
    size_t at;
    for (at = 0U; at < length; at++) {
        reply[at] = (uint8_t)take(1U);
    }
    if (length > 1U && (take(1U) & 3U) != 0U) {
        /* A valid reply, as most are. */
        reply[0] = request;
        reply[length - 1U] = 0U;
        for (at = 0U; at + 1U < length; at++) {
            reply[length - 1U] ^= reply[at];
        }
    }
    return fuzzed_error();
}

static inline const cw_transport *fuzzed_transport(void)
{
    static cw_transport made;
    const uint64_t missing = take(1U);
    made.context = NULL;
    made.read_registers = (missing & 0xC0U) == 0xC0U ? NULL : fuzzed_read;
    made.write_registers = (missing & 0x30U) == 0x30U ? NULL : fuzzed_write;
    made.wait_us = (missing & 0x0CU) == 0x0CU ? NULL : fuzzed_wait;
    made.send_request = (missing & 0x03U) == 0x03U ? NULL : fuzzed_send;
    made.poll_at_most = (uint32_t)(take(1U) % 8U);
    made.poll_pause_us = (uint32_t)take(1U);
    return &made;
}
@calls@
static void (*const calls[])(const @prefix@ *variant) = { @rows@ };
static const uint8_t exact[] = { @exact@ };
static const uint8_t may_be_refused[] = { @refuse@ };
static const uint8_t as_bits[] = { @bits@ };
static const char *const bools[] = { @bools@ };

#define CODECS (sizeof codecs / sizeof codecs[0])

static void require_of(int holds, const char *what, size_t number)
{
    if (!holds) {
        fprintf(stderr, "codec %lu: %s\n", (unsigned long)number, what);
        abort();
    }
}

/* Decode a record of exactly its length. The answer has the same length as that of the batch. */
static uint8_t *answer_of(const codec *chosen, const @prefix@ *variant, const uint8_t *bytes, size_t length, int bits)
{
    uint8_t *const record = malloc(1U + (bits ? 8U : length));
    uint8_t *const answer = calloc(1U, chosen->answer);
    size_t index;
    record[0] = (uint8_t)length;
    for (index = 0U; index < (bits ? 8U : length); index++) {
        record[1U + index] = index < length ? bytes[index] : 0U;
    }
    chosen->decode(variant, record, &answer[1]);
    free(record);
    return answer;
}

static void check_codec(size_t number, const @prefix@ *variant)
{
    const codec *const chosen = &codecs[number];
    const size_t sent = chosen->encoded - 1U;
    const size_t length = as_bits[number] ? 8U : left < 20U ? left : 20U;
    uint8_t given[20] = { 0 };
    uint8_t *answer;
    size_t index;
    for (index = 0U; index < length; index++) {
        given[index] = (uint8_t)take(1U);
    }
    answer = answer_of(chosen, variant, given, length, as_bits[number]);
    require_of((answer[0] & 0x80U) == 0U, "a fault changed the struct", number);
    if (answer[0] == 0U) {
        const uint8_t again = answer[1U + chosen->members];
        uint8_t *const encoded = &answer[2U + chosen->members];
        require_of(again == 0U || (may_be_refused[number] && again == (uint8_t)CW_FAULT_RANGE), "what was decoded is not encoded", number);
        if (again == 0U) {
            uint8_t *const second = answer_of(chosen, variant, encoded, sent, as_bits[number]);
            require_of(memcmp(answer, second, chosen->answer) == 0, "encoding and decoding again gives something else", number);
            require_of(!exact[number] || (length == sent && memcmp(given, encoded, sent) == 0), "encoding again gives other bits", number);
            free(second);
        }
    }
    free(answer);
}

/* An encoded record is decoded to the same values. */
static void check_members(size_t number, const @prefix@ *variant)
{
    const codec *const chosen = &codecs[number];
    uint8_t *const given = malloc(chosen->members);
    uint8_t *const encoded = calloc(1U, chosen->encoded);
    size_t index;
    for (index = 0U; index < chosen->members; index++) {
        given[index] = (uint8_t)(take(1U) & (bools[number][index] == '1' ? 1U : 0xFFU));
    }
    chosen->encode(variant, given, &encoded[1]);
    if (encoded[0] == 0U) {
        uint8_t *const answer = answer_of(chosen, variant, &encoded[1], chosen->encoded - 1U, as_bits[number]);
        require_of(answer[0] == 0U && memcmp(&answer[1], given, chosen->members) == 0, "what was encoded is decoded as something else", number);
        free(answer);
    } else {
        for (index = 1U; index < chosen->encoded; index++) {
            require_of(encoded[index] == 0U, "a fault changed the bytes", number);
        }
    }
    free(encoded);
    free(given);
}

static void check_label(void)
{
    char *const label = text();
    uint32_t unlisted = 77U;
    const @prefix@_order_code *const found = @prefix@_find_order_code(label, &unlisted);
    size_t count;
    const @prefix@_order_code *const codes = @prefix@_order_codes(&count);
    if (found != NULL) {
        require_of(found >= codes && found < codes + count, "an order code that is not in the table", 0U);
        /* A label may have spaces anywhere. In a family with other spellings, it need not look like the code. */
        if (unlisted == 0U && !@spelled@) {
            size_t at = 0U;
            size_t index;
            for (index = 0U; found->text[index] != '\0'; index++) {
                while (label[at] == ' ') {
                    at++;
                }
                require_of(cw_capital(label[at]) == cw_capital(found->text[index]), "the label does not begin with the order code", at);
                at++;
            }
        }
    }
    free(label);
}

/* The variant of an order code, sometimes with possible contents of its registers. */
static void take_over(@prefix@ *variant)
{
    (void)variant;
@takers@}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    @prefix@ variant;
    size_t count;
    const @prefix@_order_code *const codes = @prefix@_order_codes(&count);
    size_t chosen;
    uint64_t how;
    (void)work;
    input = data;
    left = size;
    chosen = (size_t)take(1U);
    variant = codes[(size_t)take(1U) % count].variant;
    if (chosen == 0xFFU) {
        check_label();
        return 0;
    }
    how = take(1U);
    if ((how & 0x0FU) == 0x0FU) {
        take_over(&variant);
    }
    if (chosen < CODECS) {
        if ((how & 0x10U) != 0U) {
            check_members(chosen, &variant);
        } else {
            check_codec(chosen, &variant);
        }
        return 0;
    }
    calls[(chosen - CODECS + 256U * (size_t)(how & 1U)) % (sizeof calls / sizeof calls[0])](&variant);
    return 0;
}
