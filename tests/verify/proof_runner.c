/*
 * Claims about runner.h, for any two steps, also of invalid kinds, and any results of its accesses.
 * The fuzzer and the tests of procedures, which use both, show that it does the same as cw_run().
 */
#include "codewheel/runner.h"

uint32_t nondet_number(void);
uint8_t nondet_byte(void);
int32_t nondet_error(void);
size_t nondet_size(void);

#define STEPS 2U
#define ACCESSES 2U

static cw_step steps[STEPS];
static uint8_t room[STEPS];

/* Return whether the byte of a step is read. A MORE step belongs to the access before it. */
static bool is_read(size_t at)
{
    while (at != 0U && steps[at].kind == CW_STEP_MORE) {
        at--;
    }
    return steps[at].kind == CW_STEP_READ;
}

/* Return whether the byte of a MORE step belongs to a register. */
static bool belongs(size_t at)
{
    while (at != 0U && steps[at].kind == CW_STEP_MORE) {
        at--;
    }
    return steps[at].kind != CW_STEP_MORE && steps[at].kind != CW_STEP_WAIT && steps[at].kind != CW_STEP_SEND;
}

/* Any list, and the space for what it reads at the very end of its memory. */
static size_t listed(uint8_t **bytes, size_t *length)
{
    const size_t count = nondet_size();
    size_t at;
    __CPROVER_assume(count != 0U && count <= STEPS);
    *length = 0U;
    for (at = 0U; at < STEPS; at++) {
        cw_step step;
        __CPROVER_assume(step.times <= ACCESSES);
        __CPROVER_assume(step.address <= ACCESSES || step.address > CW_REPLY_BYTES || step.kind != CW_STEP_SEND);
        steps[at] = step;
        if (at < count && is_read(at)) {
            (*length)++;
        }
    }
    *bytes = &room[STEPS - *length];
    return count;
}

/* Return whether every MORE step belongs to a register. */
static bool is_whole(size_t count)
{
    size_t at;
    for (at = 0U; at < count; at++) {
        if (steps[at].kind == CW_STEP_MORE && !belongs(at)) {
            return false;
        }
    }
    return true;
}

/* A list whose further bytes all belong to registers. */
static size_t any_steps(uint8_t **bytes, size_t *length)
{
    const size_t count = listed(bytes, length);
    __CPROVER_assume(is_whole(count));
    return count;
}

/* Return the maximum number of accesses of a step. A change of some bits of a byte reads and writes it. Other steps
 * repeat as often as they say. */
static uint32_t most_of(const cw_step *step)
{
    const bool changes = step->kind == CW_STEP_WRITE || step->kind == CW_STEP_CLOSE;
    return (changes || step->kind == CW_STEP_POLL) ? ACCESSES : (step->kind == CW_STEP_SEND && step->times != 0U)
        ? step->times : 1U;
}

/* Return the number of bytes that the steps from this one on read. */
static size_t reads_from(size_t first, size_t count)
{
    size_t at, reads = 0U;
    for (at = 0U; at < STEPS; at++) {
        reads += (at >= first && at < count && is_read(at)) ? 1U : 0U;
    }
    return reads;
}

/* Invariant between two calls: a step of the list or its end, after an error one that closes, and exactly enough space
 * for the bytes that are still to be read. */
static bool is_sound(const cw_runner *runner, size_t count)
{
    const bool well = runner->result == CW_OK;
    return runner->steps == steps && runner->count == count && runner->step_index <= count && runner->steps_begun <= count
        && (!well || runner->next_byte == &room[STEPS - reads_from(runner->step_index, count)])
        && (well || runner->step_index == count || steps[runner->step_index].kind == CW_STEP_CLOSE)
        && (runner->step_index == count || steps[runner->step_index].kind != CW_STEP_MORE)
        && (well || runner->failure.step < runner->steps_begun)
        && (runner->step_index == count || runner->accesses_done < most_of(&steps[runner->step_index]));
}

/* One action after the other, from any valid state, with any result: the state is valid again, and nearer to the end.
 * This covers a list of any length. */
void a_round(void)
{
    cw_runner runner;
    uint8_t *bytes;
    size_t length;
    const size_t count = any_steps(&bytes, &length);
    const uint32_t now = nondet_number();
    __CPROVER_assert(cw_runner_start(&runner, steps, count, bytes, length, now) == CW_OK, "its places fit");
    __CPROVER_assert(is_sound(&runner, count), "it begins soundly");
    runner.poll_at_most = ACCESSES;
    runner.result = (cw_result)(nondet_byte() % 10U);
    runner.step_index = nondet_size();
    runner.steps_begun = nondet_size();
    runner.failure.step = nondet_size();
    runner.accesses_done = nondet_number();
    runner.pause_us = nondet_number();
    runner.step_bytes[0] = nondet_byte();
    runner.step_bytes[1] = nondet_byte();
    __CPROVER_assume(runner.step_index <= count);
    runner.next_byte = &room[STEPS - reads_from(runner.step_index, count)];
    __CPROVER_assume(is_sound(&runner, count));
    const cw_runner before = runner;
    const cw_todo todo = cw_runner_next(&runner, now);
    __CPROVER_assert(before.result == CW_OK || runner.result == before.result, "the first fault is kept");
    __CPROVER_assert(is_sound(&runner, count), "it is sound while something is under way");
    if (todo == CW_TODO_END) {
        __CPROVER_assert(runner.step_index == count, "all is done");
        __CPROVER_assert(runner.result != CW_OK || runner.next_byte == &room[STEPS], "and all is read");
        return;
    }
    if (todo == CW_TODO_WAIT) {
        __CPROVER_assert(runner.wait_us != 0U && runner.wait_us <= runner.pause_us, "there is something to wait for");
        return;
    }
    __CPROVER_assert(todo != CW_TODO_BUSY && runner.step_index < count, "a step of the list");
    __CPROVER_assert(cw_runner_next(&runner, now) == CW_TODO_BUSY, "one thing at a time");
    if (todo != CW_TODO_WRITE && runner.length != 0U) {
        __CPROVER_assert(__CPROVER_w_ok(runner.data, runner.length), "there is room for it");
        __CPROVER_havoc_slice(runner.data, runner.length);
    }
    const size_t at = runner.step_index;
    const uint32_t round = runner.accesses_done;
    const int32_t error = nondet_error();
    cw_runner_done(&runner, error, now);
    __CPROVER_assert(error == 0 || runner.result != CW_OK, "no fault is lost");
    __CPROVER_assert(runner.step_index > at || runner.accesses_done > round, "it is nearer to the end");
    __CPROVER_assert(is_sound(&runner, count), "it is sound again");
}

/* If there is too little or too much space, nothing is done. */
void places_that_do_not_fit(void)
{
    cw_runner runner;
    uint8_t *bytes;
    size_t length;
    const size_t count = any_steps(&bytes, &length);
    const size_t other = nondet_size();
    __CPROVER_assume(other != length);
    __CPROVER_assert(cw_runner_start(&runner, steps, count, bytes, other, 0U) == CW_FAULT_LENGTH, "a wrong length is refused");
    __CPROVER_assert(cw_runner_next(&runner, nondet_number()) == CW_TODO_END, "and it is over");
}

/* Further bytes without a register are refused before anything is done. */
void bytes_of_nothing(void)
{
    cw_runner runner;
    uint8_t *bytes;
    size_t length;
    const size_t count = listed(&bytes, &length);
    __CPROVER_assume(!is_whole(count));
    __CPROVER_assert(cw_runner_start(&runner, steps, count, bytes, length, 0U) == CW_FAULT_LENGTH, "it is refused");
    __CPROVER_assert(cw_runner_next(&runner, nondet_number()) == CW_TODO_END, "and it is over");
}

/* A list without steps was not carried out. */
void no_steps(void)
{
    cw_runner runner;
    __CPROVER_assert(cw_runner_start(&runner, steps, 0U, room, 0U, 0U) == CW_FAULT_LENGTH, "a wrong length is refused");
    __CPROVER_assert(cw_runner_next(&runner, nondet_number()) == CW_TODO_END, "and it is over");
    __CPROVER_assert(runner.result == CW_FAULT_LENGTH, "and stays told");
}

/* At the end, with or without an open register: a register that is closed was open, and the first error stays the
 * same. */
void closing_again(void)
{
    cw_runner runner;
    uint8_t *bytes;
    size_t length;
    const size_t count = any_steps(&bytes, &length);
    __CPROVER_assert(cw_runner_start(&runner, steps, count, bytes, length, 0U) == CW_OK, "its places fit");
    runner.result = (cw_result)(1U + (nondet_byte() % 9U));
    runner.step_index = nondet_size();
    runner.steps_begun = nondet_size();
    runner.failure.step = nondet_size();
    runner.failure.left_open = nondet_byte() != 0U;
    __CPROVER_assume(runner.step_index <= count && is_sound(&runner, count));
    const cw_runner before = runner;
    const bool again = cw_runner_close(&runner, nondet_number());
    __CPROVER_assert(again == (before.step_index == count && before.failure.left_open), "where something is open, at the end");
    __CPROVER_assert(runner.result == before.result && is_sound(&runner, count), "the first fault is kept");
    __CPROVER_assert(again || runner.step_index == before.step_index, "else it does nothing");
    if (again) {
        __CPROVER_assert(!runner.failure.left_open, "nothing failed yet");
        for (size_t at = 0U; at < STEPS; at++) {
            const bool closes = at < count && cw_step_closes(steps, runner.steps_begun, &steps[at]);
            __CPROVER_assert(at >= runner.step_index || !closes, "the first that closes");
        }
    }
}

/* A report of a result that nothing waits for has no effect. */
void done_too_often(void)
{
    cw_runner runner;
    uint8_t *bytes;
    size_t length;
    const size_t count = any_steps(&bytes, &length);
    const uint32_t now = nondet_number();
    __CPROVER_assert(cw_runner_start(&runner, steps, count, bytes, length, now) == CW_OK, "its places fit");
    cw_runner_done(&runner, nondet_error(), nondet_number());
    __CPROVER_assert(runner.step_index == 0U && runner.pause_start_us == now && runner.result == CW_OK, "nothing");
}
