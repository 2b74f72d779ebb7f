/*
 * Fuzz target for the header of procedures without waiting: any steps, carried out by the function
 * that waits and by the runner, with an encoder that answers both with the same bytes and errors. Both
 * must do the same, in the same order, and return the same.
 */
#include "codewheel/runner.h"
#include "fuzz.h"
#include <string.h>

#define STEPS 6U
#define LOG 4096U

/* The requests as numbers. A wait is the sum of successive waits. */
typedef struct record {
    uint64_t told[LOG];
    size_t count;
    const uint8_t *script;
    size_t left;
} record;

static void tell(record *to, uint64_t what)
{
    require(to->count < LOG, "a procedure that does not end");
    to->told[to->count] = what;
    to->count++;
}

static uint8_t scripted(record *from)
{
    if (from->left == 0U) {
        return 0U;
    }
    from->left--;
    return *from->script++;
}

static int32_t ends(record *from)
{
    const uint8_t byte = scripted(from);
    return (byte < 0xF0U) ? 0 : (int32_t)byte;
}

static int32_t on_read(void *context, uint16_t address, uint8_t *bytes, size_t length)
{
    size_t at;
    tell(context, ((uint64_t)1U << 60U) | ((uint64_t)address << 16U) | length);
    for (at = 0U; at < length; at++) {
        bytes[at] = scripted(context);
    }
    return ends(context);
}

static int32_t on_write(void *context, uint16_t address, const uint8_t *bytes, size_t length)
{
    size_t at;
    tell(context, ((uint64_t)2U << 60U) | ((uint64_t)address << 16U) | length);
    for (at = 0U; at < length; at++) {
        tell(context, bytes[at]);
    }
    return ends(context);
}

static int32_t on_wait(void *context, uint32_t microseconds)
{
    record *const to = context;
    if (microseconds == 0U) {
        return 0;
    }
    if (to->count != 0U && (to->told[to->count - 1U] >> 60U) == 3U) {
        to->told[to->count - 1U] += microseconds;
        return 0;
    }
    tell(to, ((uint64_t)3U << 60U) | microseconds);
    return 0;
}

static int32_t on_send(void *context, uint8_t request, uint8_t *reply, size_t length)
{
    size_t at;
    tell(context, ((uint64_t)4U << 60U) | ((uint64_t)request << 16U) | length);
    for (at = 0U; at < length; at++) {
        /* Often a valid reply: the request, and its exclusive-or. */
        const uint8_t byte = scripted(context);
        reply[at] = (byte < 0xC0U) ? ((at == 0U || at + 1U == length) ? request : 0U) : byte;
    }
    return ends(context);
}

/* Step the runner to its end. Return the time at the end. */
static uint32_t carry_out(record *to, cw_runner *runner, uint32_t now)
{
    cw_todo todo;
    while ((todo = cw_runner_next(runner, now)) != CW_TODO_END) {
        int32_t error = 0;
        if (todo == CW_TODO_WAIT) {
            (void)on_wait(to, runner->wait_us);
            now += runner->wait_us;
            continue;
        }
        require(cw_runner_next(runner, now) == CW_TODO_BUSY, "two things at a time");
        if (todo == CW_TODO_READ) {
            error = on_read(to, runner->address, runner->data, runner->length);
        } else if (todo == CW_TODO_WRITE) {
            require(runner->byte == runner->data[0], "the first byte");
            error = on_write(to, runner->address, runner->data, runner->length);
        } else {
            error = on_send(to, runner->byte, runner->data, runner->length);
        }
        cw_runner_done(runner, error, now);
    }
    return now;
}

/* Open registers are closed without a request, and if none is open, nothing happens. The error stays the same. */
static void close_again(record *to, cw_runner *runner, uint32_t now)
{
    const cw_failure before = runner->failure;
    const cw_result result = runner->result;
    size_t told = to->count;
    require(cw_runner_close(runner, now) == before.left_open, "closes what is not open");
    (void)carry_out(to, runner, now);
    require(runner->result == result && runner->failure.step == before.step, "closing hides the fault");
    require(before.left_open || to->count == told, "something is done though nothing is open");
    for (; told < to->count; told++) {
        require((to->told[told] >> 60U) != 4U, "closing sends a request");
    }
}

static cw_result waiting_for_nothing(
    record *to, const cw_step *steps, size_t count, uint8_t *bytes, size_t length,
    uint32_t at_most, uint32_t pause, cw_failure *failure)
{
    cw_runner runner;
    uint32_t now = 0xFFFFF000U;
    size_t told;
    if (cw_runner_start(&runner, steps, count, bytes, length, now) != CW_OK) {
        require(cw_runner_next(&runner, now) == CW_TODO_END, "a start that failed goes on");
        return runner.result;
    }
    runner.poll_at_most = at_most;
    runner.poll_pause_us = pause;
    now = carry_out(to, &runner, now);
    *failure = runner.failure;
    told = to->count;
    close_again(to, &runner, now);
    to->count = told;
    return runner.result;
}

/* Return true if a step checks a byte that can never match, because its value has bits outside the mask. */
static bool is_compared(const cw_step *step)
{
    return step->kind == CW_STEP_POLL || step->kind == CW_STEP_VERIFY || step->kind == CW_STEP_MORE;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static record waited;
    static record stepped;
    cw_step steps[STEPS];
    cw_failure first = { 0U, CW_STEP_WAIT, CW_STEP_WAIT, 0U, 0, false };
    cw_failure second = first;
    cw_result results[2];
    uint8_t *bytes[2];
    size_t count;
    size_t length;
    size_t at;
    bool is_read = false;
    input = data;
    left = size;
    count = (size_t)(take(1U) % (STEPS + 1U));
    for (at = 0U; at < count; at++) {
        const uint8_t kind = (uint8_t)take(1U);
        steps[at].kind = (cw_step_kind)(1U + (kind % 8U));
        steps[at].address = (uint16_t)(take(1U) % 24U);
        steps[at].mask = (uint8_t)take(1U);
        steps[at].value = (uint8_t)(take(1U) & (is_compared(&steps[at]) ? steps[at].mask : 0xFFU));
        steps[at].times = (uint16_t)(take(1U) % 4U);
        steps[at].microseconds = (uint32_t)take(2U);
    }
    length = ((take(1U) & 15U) == 0U) ? 1U : 0U;
    for (at = 0U; at < count; at++) {
        is_read = (steps[at].kind == CW_STEP_MORE) ? is_read : (steps[at].kind == CW_STEP_READ);
        length += is_read ? 1U : 0U;
    }
    waited.script = input;
    waited.left = left;
    waited.count = 0U;
    stepped = waited;
    for (at = 0U; at < 2U; at++) {
        bytes[at] = calloc(length + (length == 0U), 1U);
    }
    {
        const uint32_t pause = (uint32_t)size * 3U;
        const cw_transport bus = { &waited, on_read, on_write, on_wait, on_send, 3U, pause };
        results[0] = cw_run(&bus, steps, count, bytes[0], length, &first);
        results[1] = waiting_for_nothing(&stepped, steps, count, bytes[1], length, 3U, pause, &second);
    }
    require(results[0] == results[1], "another result");
    /* The function that waits also waits after the last access. */
    while (waited.count != 0U && (waited.told[waited.count - 1U] >> 60U) == 3U) {
        waited.count--;
    }
    while (stepped.count != 0U && (stepped.told[stepped.count - 1U] >> 60U) == 3U) {
        stepped.count--;
    }
    require(waited.count == stepped.count, "more of one than of the other");
    require(memcmp(waited.told, stepped.told, waited.count * sizeof(waited.told[0])) == 0, "another access");
    if (results[0] == CW_OK) {
        require(memcmp(bytes[0], bytes[1], length) == 0, "other bytes are read");
    } else if (results[0] != CW_FAULT_LENGTH) {
        require(first.step == second.step && first.kind == second.kind && first.call == second.call
            && first.address == second.address && first.error == second.error && first.left_open == second.left_open,
            "another failure");
    }
    free(bytes[0]);
    free(bytes[1]);
    return 0;
}
