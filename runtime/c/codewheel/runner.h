/** @file
 * codewheel/runner.h - runs a procedure from a main loop or a task, without waiting
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 *
 * The steps come from a _steps() function in an encoder's header. The runner does not access the
 * encoder itself: it returns the next action, or when to call again.
 *
 *     cw_runner_start(&runner, steps, count, bytes, length, now_us);
 *
 *     switch (cw_runner_next(&runner, now_us)) {           in the main loop
 *     case READ:  start reading runner.length bytes from runner.address into runner.data. Over SPI,
 *                 they are the bytes of one register
 *     case WRITE: start writing runner.length bytes from runner.data to runner.address. Unless the
 *                 encoder has SPI, there is only one, which runner.byte holds too
 *     case SEND:  start sending the request runner.byte and receiving runner.length bytes of
 *                 reply into runner.data (0: ignore the reply)
 *     case WAIT:  call again in runner.wait_us microseconds or later. Until then the bus is free,
 *                 unless runner.bus_reserved is true, which means that no other request may be
 *                 sent. An encoder that you poll in the meantime may report that it is busy
 *     case BUSY:  call again when the access is over
 *     case END:   done: runner.result is the result, runner.failure the step that failed
 *     }
 *
 *     cw_runner_done(&runner, error, now_us);       after each access: 0, or your error number
 *
 * The runner does the same as cw_run(), in the same order. After a failure it closes the registers
 * that were opened, and then ends. Always keep calling _next() until END, since a register may be
 * open until then. now_us is a free-running 32-bit microsecond counter that wraps around. A wait
 * can be one tick too short, so use a counter with a short tick. There is no locking and nothing is
 * volatile: call the functions from one task, or make sure that no call can interrupt another.
 */
#ifndef CODEWHEEL_RUNNER_H
#define CODEWHEEL_RUNNER_H

#include "transport.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/runner.h 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Next action for the caller. */
typedef enum cw_todo {
    CW_TODO_END = 0,   /**< nothing to do: the procedure is over */
    CW_TODO_READ = 1,  /**< start reading registers */
    CW_TODO_WRITE = 2, /**< start writing a register byte */
    CW_TODO_SEND = 3,  /**< start sending a request */
    CW_TODO_WAIT = 4,  /**< call again later */
    CW_TODO_BUSY = 5   /**< finish the access in progress */
} cw_todo;

/** A procedure in progress. */
typedef struct cw_runner {
    cw_result result; /**< OK, or the first failure. Final at END */
    cw_failure failure; /**< the first failure. Has no meaning while result is OK */
    uint32_t wait_us; /**< WAIT: microseconds from now */
    uint16_t address; /**< READ, WRITE: address of the first register byte */
    uint8_t byte; /**< WRITE, SEND: the first byte to write, or the request */
    /** true between the requests of one step: send no other request, and do not poll */
    bool bus_reserved;
    uint8_t *data; /**< READ, SEND: buffer for the received bytes. WRITE: the bytes to write */
    size_t length; /**< number of bytes in data */
    /** maximum number of readings per poll, as in a transport. Set it after the start */
    uint32_t poll_at_most;
    uint32_t poll_pause_us; /**< pause between two readings of a poll */
    const cw_step *steps; /**< private */
    size_t count; /**< private: number of steps */
    size_t step_index; /**< private: index of the current step */
    size_t steps_begun; /**< private: after a failure, number of steps begun */
    uint8_t *next_byte; /**< private: address for the next byte read */
    cw_todo access; /**< private: access in progress, or END for none */
    uint32_t accesses_done; /**< private: accesses, requests or readings done for the step */
    uint32_t pause_us; /**< private: time to wait, counted from pause_start_us */
    uint32_t pause_start_us; /**< private: end of the last access */
    uint8_t step_bytes[CW_REPLY_BYTES]; /**< private: bytes to change or check, or a reply */
} cw_runner;

/**
 * Start a procedure. Call it before the first _next().
 *
 * @param runner  the procedure in progress
 * @param steps  the list of steps, which must remain valid until END
 * @param count  number of steps
 * @param bytes  buffer with one byte for each READ step and each MORE step after it. It must remain
 *               valid until END
 * @param length  size of bytes, which must be the number of these steps
 * @param now_us  current time
 * @return OK, or LENGTH if length is wrong, there are no steps or a MORE step does not belong to a
 *         register of up to CW_STEP_BYTES bytes. The runner is then at END
 */
CW_NODISCARD
static inline cw_result cw_runner_start(
    cw_runner *runner, const cw_step *steps, size_t count, uint8_t *bytes,
    size_t length, uint32_t now_us)
{
    const bool fits = cw_run_fits(steps, count, length);
    const cw_runner fresh = {
        fits ? CW_OK : CW_FAULT_LENGTH,
        { 0U, CW_STEP_WAIT, CW_STEP_WAIT, 0U, 0, false },
        0U, 0U, 0U, false, NULL, 0U, CW_POLL_AT_MOST, CW_POLL_PAUSE_US,
        steps, fits ? count : 0U, 0U, 0U, bytes, CW_TODO_END, 0U, 0U, now_us,
        { 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U }
    };
    *runner = fresh;
    return runner->result;
}

/** Advance past the MORE steps to the next one, or after a failure to the next that closes. */
static inline void cw_runner_advance(cw_runner *runner, size_t steps)
{
    const bool failed = runner->result != CW_OK;
    runner->step_index += steps;
    runner->accesses_done = 0U;
    while ((runner->step_index < runner->count) &&
        ((runner->steps[runner->step_index].kind == CW_STEP_MORE) ||
        (failed && !cw_step_closes(runner->steps, runner->steps_begun,
        &runner->steps[runner->step_index])))) {
        runner->step_index++;
    }
}

/**
 * Try again to close registers that are still open. Call it when the runner is at END and
 * failure.left_open is true, and then call _next() until END again. The result remains the first
 * failure, and left_open becomes false if closing succeeded.
 *
 * @param runner  the procedure in progress
 * @param now_us  current time
 * @return true if a register must be closed, false if none is open
 */
static inline bool cw_runner_close(cw_runner *runner, uint32_t now_us)
{
    const bool open = (runner->step_index >= runner->count) && runner->failure.left_open;
    if (open) {
        runner->failure.left_open = false;
        runner->pause_start_us = now_us;
        runner->step_index = 0U;
        cw_runner_advance(runner, 0U);
    }
    return open;
}

/**
 * Record a failure, unless there was an earlier one. If a closing step failed, set left_open too.
 */
static inline void cw_runner_fail(
    cw_runner *runner, cw_result result, cw_step_kind call, int32_t error)
{
    const cw_step *const step = &runner->steps[runner->step_index];
    if (runner->result == CW_OK) {
        runner->result = result;
        runner->steps_begun = runner->step_index + 1U;
        runner->failure.step = runner->step_index;
        runner->failure.kind = step->kind;
        runner->failure.call = call;
        runner->failure.address = cw_step_address(step);
        runner->failure.error = error;
    }
    runner->failure.left_open = runner->failure.left_open || (step->kind == CW_STEP_CLOSE);
    runner->pause_us = 0U;
    cw_runner_advance(runner, 1U);
}

/** Ask the caller to access registers or to send a request. */
static inline cw_todo cw_runner_ask(
    cw_runner *runner, cw_todo todo, uint16_t address, uint8_t *data, size_t length)
{
    runner->access = todo;
    runner->address = address;
    runner->data = data;
    runner->length = length;
    return todo;
}

/** Ask for the next access of a WRITE or CLOSE step, which is a read unless the mask is FFh. */
static inline cw_todo cw_runner_write(
    cw_runner *runner, const cw_step *step, size_t length)
{
    const bool keeps_bits = cw_step_change(step, runner->step_bytes, length);
    if (keeps_bits && (runner->accesses_done == 0U)) {
        return cw_runner_ask(runner, CW_TODO_READ, step->address, runner->step_bytes, length);
    }
    runner->byte = runner->step_bytes[0];
    return cw_runner_ask(runner, CW_TODO_WRITE, step->address, runner->step_bytes, length);
}

/**
 * Begin the current step. Return END if it fails or needs no access. A wait needs none, and it is
 * recorded.
 */
static inline cw_todo cw_runner_begin(cw_runner *runner)
{
    const cw_step *const step = &runner->steps[runner->step_index];
    const size_t length = cw_run_together(step, runner->count - runner->step_index);
    switch (step->kind) {
    case CW_STEP_WRITE:
    case CW_STEP_CLOSE:
        return cw_runner_write(runner, step, length);
    case CW_STEP_READ:
        return cw_runner_ask(runner, CW_TODO_READ, step->address, runner->next_byte, length);
    case CW_STEP_POLL:
    case CW_STEP_VERIFY:
        return cw_runner_ask(runner, CW_TODO_READ, step->address, runner->step_bytes, length);
    case CW_STEP_SEND:
        if (step->times == 0U) {
            cw_runner_advance(runner, 1U);
            return CW_TODO_END;
        }
        if (step->address > CW_REPLY_BYTES) {
            cw_runner_fail(runner, CW_FAULT_RANGE, CW_STEP_SEND, 0);
            return CW_TODO_END;
        }
        runner->byte = step->value;
        return cw_runner_ask(runner, CW_TODO_SEND, 0U, runner->step_bytes, step->address);
    case CW_STEP_WAIT:
        runner->pause_us = step->microseconds;
        cw_runner_advance(runner, 1U);
        return CW_TODO_END;
    case CW_STEP_MORE:
    default:
        cw_runner_fail(runner, CW_FAULT_RANGE, step->kind, 0);
        return CW_TODO_END;
    }
}

/**
 * Return what to do now. Call it as often as you like: once it has asked for an access, it returns
 * BUSY until you call cw_runner_done(). A wait begins when the previous access ends.
 *
 * @param runner  the procedure in progress
 * @param now_us  current time
 * @return the next action, or END once the procedure is over
 */
CW_NODISCARD
static inline cw_todo cw_runner_next(cw_runner *runner, uint32_t now_us)
{
    cw_todo todo = CW_TODO_END;
    if (runner->access != CW_TODO_END) {
        return CW_TODO_BUSY;
    }
    while (todo == CW_TODO_END) {
        const uint32_t elapsed_us = now_us - runner->pause_start_us;
        if (elapsed_us < runner->pause_us) {
            runner->wait_us = runner->pause_us - elapsed_us;
            return CW_TODO_WAIT;
        }
        if (runner->pause_us != 0U) {
            runner->pause_us = 0U;
            runner->pause_start_us = now_us;
        }
        if (runner->step_index >= runner->count) {
            return CW_TODO_END;
        }
        todo = cw_runner_begin(runner);
    }
    return todo;
}

/** Read again after a pause, up to the limit of a poll. */
static inline void cw_runner_read_again(cw_runner *runner)
{
    const bool bounded = runner->poll_at_most != 0U;
    runner->accesses_done++;
    if (runner->accesses_done >= (bounded ? runner->poll_at_most : CW_POLL_AT_MOST)) {
        cw_runner_fail(runner, CW_FAULT_TIMEOUT, CW_STEP_POLL, 0);
    } else {
        runner->pause_us = bounded ? runner->poll_pause_us : CW_POLL_PAUSE_US;
    }
}

/** Check the reply to a request: advance, or send again after a pause. */
static inline void cw_runner_check_reply(cw_runner *runner, const cw_step *step)
{
    const cw_result result =
        cw_reply_check(step->value, runner->step_bytes, runner->length, step->mask);
    runner->accesses_done++;
    runner->bus_reserved = runner->accesses_done < step->times;
    if (result != CW_OK) {
        runner->bus_reserved = false;
        cw_runner_fail(runner, result, CW_STEP_SEND, 0);
    } else if (runner->bus_reserved) {
        runner->pause_us = step->microseconds;
    } else {
        cw_runner_advance(runner, 1U);
    }
}

/** Continue the current step after its access succeeded. */
static inline void cw_runner_continue(cw_runner *runner, cw_todo finished)
{
    const cw_step *const step = &runner->steps[runner->step_index];
    size_t differing;
    switch (step->kind) {
    case CW_STEP_READ:
        runner->next_byte = &runner->next_byte[runner->length];
        cw_runner_advance(runner, runner->length);
        break;
    case CW_STEP_POLL:
    case CW_STEP_VERIFY:
        differing = cw_step_differs(step, runner->step_bytes, runner->length);
        if (differing == runner->length) {
            cw_runner_advance(runner, 1U);
        } else if (step->kind == CW_STEP_POLL) {
            cw_runner_read_again(runner);
        } else {
            cw_runner_fail(
                runner, CW_FAULT_VERIFY, CW_STEP_VERIFY, (int32_t)runner->step_bytes[differing]);
        }
        break;
    case CW_STEP_SEND:
        cw_runner_check_reply(runner, step);
        break;
    case CW_STEP_WRITE:
    case CW_STEP_CLOSE:
    case CW_STEP_WAIT:
    case CW_STEP_MORE:
    default:
        if (finished == CW_TODO_READ) {
            runner->accesses_done++;
        } else {
            cw_runner_advance(runner, 1U);
        }
        break;
    }
}

/**
 * Report the end of the access that _next() asked for. If there is no such access, nothing happens.
 *
 * The first error ends the procedure, and the closing steps follow immediately. Therefore, if there
 * is noise on the line, wait until it is gone and repeat the access before you report an error. You
 * may repeat READ and WRITE, since writing a value twice is harmless. A command may then be carried
 * out twice. A preset then takes effect twice, so keep the axis at rest. Do not repeat SEND, since
 * the requests of a step belong together. After a failure, use _close() to close what is still
 * open, and then start the whole procedure again.
 *
 * @param runner  the procedure in progress
 * @param error  0 if the access succeeded and the bytes received are in runner.data, otherwise your
 *               own error number, which is stored in runner.failure.error
 * @param now_us  current time
 */
static inline void cw_runner_done(cw_runner *runner, int32_t error, uint32_t now_us)
{
    const cw_todo finished = runner->access;
    if (finished == CW_TODO_END) {
        return;
    }
    runner->access = CW_TODO_END;
    runner->pause_start_us = now_us;
    if (error == 0) {
        cw_runner_continue(runner, finished);
    } else {
        cw_step_kind failed_kind = (finished == CW_TODO_READ) ? CW_STEP_READ : CW_STEP_WRITE;
        if (finished == CW_TODO_SEND) {
            failed_kind = CW_STEP_SEND;
        }
        runner->bus_reserved = false;
        cw_runner_fail(runner, CW_FAULT_TRANSPORT, failed_kind, error);
    }
}

#ifdef __cplusplus
}
#endif

#endif
