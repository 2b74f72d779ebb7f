/*
 * What is claimed of runner.h, for any two steps, of no kind too, and whatever becomes of what it
 * asks for. That it does what lika_run() does is shown by the fuzzer and by the tests of procedures,
 * which all go through both.
 */
#include "@maker@/runner.h"

uint32_t nondet_number(void);
uint8_t nondet_byte(void);
int32_t nondet_error(void);
size_t nondet_size(void);

#define STEPS 2U
/* Of a step: a byte of which some bits are changed is read and written, a poll and a request go twice at most. */
#define ACCESSES 2U

static @maker@_step steps[STEPS];
static uint8_t room[STEPS];

/* The list, and the places for what it reads at the very end of their memory. */
static size_t any_steps(uint8_t **bytes, size_t *length)
{
    const size_t count = nondet_size();
    size_t at;
    __CPROVER_assume(count <= STEPS);
    *length = 0U;
    for (at = 0U; at < STEPS; at++) {
        @maker@_step step;
        __CPROVER_assume(step.times <= ACCESSES);
        steps[at] = step;
        if (at < count && step.kind == @MAKER@_STEP_READ) {
            (*length)++;
        }
    }
    *bytes = &room[STEPS - *length];
    return count;
}

/* What was asked for is done: what it reads into is there, and may hold anything after it. */
static void accessed(const @maker@_runner *runner, @maker@_todo todo)
{
    size_t at;
    if (todo == @MAKER@_TODO_WRITE) {
        return;
    }
    __CPROVER_assert(runner->length == 0U || __CPROVER_w_ok(runner->data, runner->length), "there is room for it");
    __CPROVER_assert(todo == @MAKER@_TODO_SEND || runner->length != 0U, "something is read");
    for (at = 0U; at < @MAKER@_REPLY_BYTES; at++) {
        if (at < runner->length) {
            runner->data[at] = nondet_byte();
        }
    }
}

/* Steps one after the other until the end, with waits that may last longer than they have to. */
void a_procedure(void)
{
    @maker@_runner runner;
    uint8_t *bytes;
    size_t length, round, reads = 0U, accesses = 0U;
    const size_t count = any_steps(&bytes, &length);
    uint32_t now = nondet_number();
    bool failed = false, ended = false;
    __CPROVER_assert(@maker@_runner_start(&runner, steps, count, bytes, length, now) == @MAKER@_OK, "its places fit");
    runner.poll_at_most = ACCESSES;
    runner.poll_pause_us = nondet_number();
    __CPROVER_assume(runner.poll_pause_us < 0x80000000U && steps[0].microseconds < 0x80000000U);
    __CPROVER_assume(steps[1].microseconds < 0x80000000U);
    for (round = 0U; round < 9U && !ended; round++) {
        const @maker@_todo todo = @maker@_runner_next(&runner, now);
        const bool before = runner.result != @MAKER@_OK;
        if (todo == @MAKER@_TODO_END) {
            ended = true;
        } else if (todo == @MAKER@_TODO_WAIT) {
            const uint32_t passed = nondet_number();
            __CPROVER_assert(runner.wait_us != 0U, "there is something to wait for");
            __CPROVER_assume(passed >= runner.wait_us && passed < 0x80000000U);
            now += passed;
        } else {
            const int32_t error = nondet_error();
            __CPROVER_assert(todo != @MAKER@_TODO_BUSY && runner.at < count, "a step of the list");
            __CPROVER_assert(!before || steps[runner.at].kind == @MAKER@_STEP_CLOSE, "after a fault it only closes");
            __CPROVER_assert(@maker@_runner_next(&runner, now) == @MAKER@_TODO_BUSY, "one thing at a time");
            reads += (error == 0 && steps[runner.at].kind == @MAKER@_STEP_READ) ? runner.length : 0U;
            accessed(&runner, todo);
            @maker@_runner_done(&runner, error, now);
            failed = failed || error != 0;
            accesses++;
        }
    }
    __CPROVER_assert(accesses <= STEPS * ACCESSES, "no more than the steps say");
    __CPROVER_assert(ended, "it ends");
    __CPROVER_assert(@maker@_runner_next(&runner, now) == @MAKER@_TODO_END, "and stays there");
    __CPROVER_assert(!failed || runner.result != @MAKER@_OK, "no fault is lost");
    __CPROVER_assert(runner.result == @MAKER@_OK || runner.failure.step < count, "the step that failed");
    __CPROVER_assert(runner.result != @MAKER@_OK || reads == length, "all was read");
}

/* Places that are none too few or too many: nothing is done at all. */
void places_that_do_not_fit(void)
{
    @maker@_runner runner;
    uint8_t *bytes;
    size_t length;
    const size_t count = any_steps(&bytes, &length);
    const size_t other = nondet_size();
    __CPROVER_assume(other != length);
    __CPROVER_assert(@maker@_runner_start(&runner, steps, count, bytes, other, 0U) == @MAKER@_FAULT_LENGTH, "is told");
    __CPROVER_assert(@maker@_runner_next(&runner, nondet_number()) == @MAKER@_TODO_END, "and it is over");
}

/* Told of an end that nobody waits for, it does nothing. */
void done_too_often(void)
{
    @maker@_runner runner;
    __CPROVER_assume(runner.doing == @MAKER@_TODO_END);
    const size_t at = runner.at;
    const uint32_t from = runner.from_us, pause = runner.pause_us;
    @maker@_runner_done(&runner, nondet_error(), nondet_number());
    __CPROVER_assert(runner.at == at && runner.from_us == from && runner.pause_us == pause, "nothing");
}
