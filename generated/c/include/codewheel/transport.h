/** @file
 * codewheel/transport.h - register access and procedures through your own bus functions
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 */
#ifndef CODEWHEEL_TRANSPORT_H
#define CODEWHEEL_TRANSPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "result.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/transport.h 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* -- procedures -------------------------------------------------------------------------------- */

/** Kinds of procedure steps. */
typedef enum cw_step_kind {
    CW_STEP_WRITE = 1, /**< write value to the register byte at address */
    CW_STEP_WAIT = 2,  /**< wait at least the given number of microseconds */
    CW_STEP_SEND = 3,  /**< send the request in value. times is the number of requests */
    CW_STEP_READ = 4,  /**< read the register byte at address */
    CW_STEP_POLL = 5,  /**< read the byte at address until its bits under mask equal value */
    CW_STEP_CLOSE = 6, /**< like WRITE, to close registers that a WRITE to this address opened */
    CW_STEP_VERIFY = 7, /**< read the byte at address: its bits under mask must equal value */
    CW_STEP_MORE = 8 /**< the next byte of the register at address, in the same access */
} cw_step_kind;

/**
 * One step of a procedure. Members that the kind does not use are ignored. If mask is 0xFF, a whole
 * byte is written. Otherwise the byte is read first, and its bits outside the mask are written back
 * unchanged. If a register has one address for several bytes, as over SPI, MORE steps follow with
 * the other bytes, up to CW_STEP_BYTES in all, and one call reads or writes all bytes. One call
 * also reads READ steps at consecutive addresses, unless their times is 0, which means that each
 * register needs its own call. For SEND, address is the number of bytes in the reply. All bytes
 * must arrive, the first byte must equal the request, and if mask is 0xFF, the XOR of all bytes
 * must be 0. If address is 0, the reply is not checked.
 */
typedef struct cw_step {
    cw_step_kind kind; /**< kind of the step */
    uint16_t address; /**< address of the register byte, or for SEND the length of the reply */
    uint8_t mask; /**< bits that are written or compared */
    uint8_t value; /**< value to write, to compare with, or to send */
    uint16_t times; /**< SEND: number of requests. READ: 0 if it needs its own call, otherwise 1 */
    uint32_t microseconds; /**< minimum wait, or for SEND the minimum pause between requests */
} cw_step;

/** Return a step that writes the bits under mask of one register byte. */
static inline cw_step cw_step_write(uint16_t address, uint8_t mask, uint8_t value)
{
    const cw_step step = { CW_STEP_WRITE, address, mask, value, 1U, 0U };
    return step;
}

/** Return a step that waits at least this many microseconds. */
static inline cw_step cw_step_wait(uint32_t microseconds)
{
    const cw_step step = { CW_STEP_WAIT, 0U, 0U, 0U, 0U, microseconds };
    return step;
}

/** Return a step that sends a one-byte request several times and receives a reply each time. */
static inline cw_step cw_step_send(
    uint8_t value, uint16_t times, uint32_t microseconds, uint16_t reply, uint8_t mask)
{
    const cw_step step = { CW_STEP_SEND, reply, mask, value, times, microseconds };
    return step;
}

/** Return a step that reads one register byte. */
static inline cw_step cw_step_read(uint16_t address)
{
    const cw_step step = { CW_STEP_READ, address, 0xFFU, 0U, 1U, 0U };
    return step;
}

/** Return a step that reads a register in its own call, as over SPI. MORE steps can follow. */
static inline cw_step cw_step_read_one(uint16_t address)
{
    const cw_step step = { CW_STEP_READ, address, 0xFFU, 0U, 0U, 0U };
    return step;
}

/** Return a step that reads one register byte until its bits under mask equal value. */
static inline cw_step cw_step_poll(uint16_t address, uint8_t mask, uint8_t value)
{
    const cw_step step = { CW_STEP_POLL, address, mask, value, 1U, 0U };
    return step;
}

/** Return a step that reads one register byte and fails unless its bits under mask equal value. */
static inline cw_step cw_step_verify(uint16_t address, uint8_t mask, uint8_t value)
{
    const cw_step step = { CW_STEP_VERIFY, address, mask, value, 1U, 0U };
    return step;
}

/** Return the step for the next byte of a register whose bytes share one address. */
static inline cw_step cw_step_more(uint16_t address, uint8_t mask, uint8_t value)
{
    const cw_step step = { CW_STEP_MORE, address, mask, value, 1U, 0U };
    return step;
}

/** Return a step that closes the registers that an earlier step opened. */
static inline cw_step cw_step_close(uint16_t address, uint8_t mask, uint8_t value)
{
    const cw_step step = { CW_STEP_CLOSE, address, mask, value, 1U, 0U };
    return step;
}

/* -- transport --------------------------------------------------------------------------------- */

/**
 * Bus access functions, which you provide. Each receives the context member and returns 0, or your
 * own error number, which is passed on in the failure. Set a function to NULL if your bus does not
 * support it. Calls that need it then return UNSUPPORTED.
 *   read_registers   reads length bytes from consecutive register addresses, starting at address.
 *                    Over SPI, they are the bytes of the one register there, high byte first
 *   write_registers  writes length bytes in the same way
 *   wait_us          returns after at least this many microseconds
 *   send_request     sends this byte, which is a complete RS-485 request (its control field), and
 *                    receives a reply of length bytes. Return an error if fewer bytes arrive in
 *                    time. If length is 0, ignore the reply
 * A poll reads repeatedly until the encoder is done. No manual says how long a poll may take, so
 * you set the limit: at most poll_at_most readings, with poll_pause_us between them. If
 * poll_at_most is 0, the defaults CW_POLL_AT_MOST and CW_POLL_PAUSE_US apply.
 */
typedef struct cw_transport {
    void *context; /**< passed to each function unchanged */
    /** Read length bytes from consecutive register addresses. */
    int32_t (*read_registers)(void *context, uint16_t address, uint8_t *bytes, size_t length);
    /** Write length bytes to consecutive register addresses. */
    int32_t (*write_registers)(
        void *context, uint16_t address, const uint8_t *bytes, size_t length);
    /** Wait at least this long. */
    int32_t (*wait_us)(void *context, uint32_t microseconds);
    /** Send a request, and receive its reply. */
    int32_t (*send_request)(void *context, uint8_t request, uint8_t *reply, size_t length);
    uint32_t poll_at_most; /**< maximum number of readings per poll, or 0 for both defaults */
    uint32_t poll_pause_us; /**< pause between two readings of a poll */
} cw_transport;

#define CW_POLL_AT_MOST 1000U /**< default for poll_at_most */
#define CW_POLL_PAUSE_US 1000U /**< default for poll_pause_us */
#define CW_REPLY_BYTES 16U /**< longest reply that a step can check */
#define CW_STEP_BYTES 8U /**< maximum number of bytes in a register with one address */

/**
 * The step that failed, and the cause. It is set if the result is TRANSPORT, TIMEOUT, VERIFY or
 * UNSUPPORTED. It is also set if a reply caused the result CRC or CONSTANT, or if a step of an
 * unknown kind or with a reply of more than CW_REPLY_BYTES caused RANGE. All earlier steps were
 * carried out. Of the later steps, only those that close an opened register were carried out. An
 * error found before the first step, or in the bytes read, leaves this struct unchanged. Pass NULL
 * if you do not need it.
 */
typedef struct cw_failure {
    size_t step; /**< index of the step, from 0 */
    cw_step_kind kind; /**< kind of the step */
    /**
     * Operation that failed: READ, WRITE, WAIT or SEND if that transport function failed or is
     * missing, POLL if the awaited value did not appear, VERIFY if a byte read back differs from
     * the one written.
     */
    cw_step_kind call;
    uint16_t address; /**< address of its first register byte, or 0 if it has none */
    /** error number from the transport function, or for VERIFY the byte read, else 0 */
    int32_t error;
    /**
     * True if a register that a step opened could not be closed again. Close it before you do
     * anything else: call cw_run() with the closing step of the list, or cw_runner_close().
     */
    bool left_open;
} cw_failure;

/** Record the failure and return the result. */
CW_NODISCARD
static inline cw_result cw_failed(
    cw_result result, cw_step_kind call, uint16_t address, int32_t error,
    cw_failure *failure)
{
    if (failure != NULL) {
        failure->step = 0U;
        failure->kind = call;
        failure->call = call;
        failure->address = address;
        failure->error = error;
        failure->left_open = false;
    }
    return result;
}

/** Record the index of the step that failed and return the result. */
CW_NODISCARD
static inline cw_result cw_failed_at(
    cw_result result, size_t step, cw_failure *failure)
{
    if (failure != NULL) {
        failure->step = step;
    }
    return result;
}

/**
 * Read consecutive register bytes.
 *
 * @param transport  your bus access functions
 * @param address  address of the first byte
 * @param bytes  the bytes read, in ascending order of address
 * @param length  number of bytes
 * @param failure  details of the failure, or NULL
 * @return OK, TRANSPORT or UNSUPPORTED
 */
CW_NODISCARD
static inline cw_result cw_read(
    const cw_transport *transport, uint16_t address, uint8_t *bytes, size_t length,
    cw_failure *failure)
{
    int32_t error;
    if (transport->read_registers == NULL) {
        return cw_failed(CW_FAULT_UNSUPPORTED, CW_STEP_READ, address, 0, failure);
    }
    error = transport->read_registers(transport->context, address, bytes, length);
    if (error != 0) {
        return cw_failed(CW_FAULT_TRANSPORT, CW_STEP_READ, address, error, failure);
    }
    return CW_OK;
}

/**
 * Write consecutive register bytes.
 *
 * @param transport  your bus access functions
 * @param address  address of the first byte
 * @param bytes  the bytes to write, in ascending order of address
 * @param length  number of bytes
 * @param failure  details of the failure, or NULL
 * @return OK, TRANSPORT or UNSUPPORTED
 */
CW_NODISCARD
static inline cw_result cw_write(
    const cw_transport *transport, uint16_t address, const uint8_t *bytes, size_t length,
    cw_failure *failure)
{
    int32_t error;
    if (transport->write_registers == NULL) {
        return cw_failed(CW_FAULT_UNSUPPORTED, CW_STEP_WRITE, address, 0, failure);
    }
    error = transport->write_registers(transport->context, address, bytes, length);
    if (error != 0) {
        return cw_failed(CW_FAULT_TRANSPORT, CW_STEP_WRITE, address, error, failure);
    }
    return CW_OK;
}

/** Write one register byte. */
CW_NODISCARD
static inline cw_result cw_write_byte(
    const cw_transport *transport, uint16_t address, uint8_t byte,
    cw_failure *failure)
{
    return cw_write(transport, address, &byte, 1U, failure);
}

/** Wait at least this many microseconds. */
CW_NODISCARD
static inline cw_result cw_wait(
    const cw_transport *transport, uint32_t microseconds, cw_failure *failure)
{
    int32_t error;
    if (transport->wait_us == NULL) {
        return cw_failed(CW_FAULT_UNSUPPORTED, CW_STEP_WAIT, 0U, 0, failure);
    }
    error = transport->wait_us(transport->context, microseconds);
    if (error != 0) {
        return cw_failed(CW_FAULT_TRANSPORT, CW_STEP_WAIT, 0U, error, failure);
    }
    return CW_OK;
}

/**
 * Check that a reply begins with its request, and that the XOR of its masked bytes is 0.
 */
CW_NODISCARD
static inline cw_result cw_reply_check(
    uint8_t request, const uint8_t *reply, size_t length, uint8_t mask)
{
    uint8_t xor_of_bytes = 0U;
    size_t index;
    if (length == 0U) {
        return CW_OK;
    }
    for (index = 0U; index < length; index++) {
        xor_of_bytes ^= reply[index];
    }
    if ((xor_of_bytes & mask) != 0U) {
        return CW_FAULT_CRC;
    }
    return (reply[0] == request) ? CW_OK : CW_FAULT_CONSTANT;
}

/** Send the request of a step and check the reply. */
CW_NODISCARD
static inline cw_result cw_send(
    const cw_transport *transport, const cw_step *step, cw_failure *failure)
{
    uint8_t reply[CW_REPLY_BYTES] = {
        0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U
    };
    const size_t length = step->address;
    cw_result result;
    int32_t error;
    if (transport->send_request == NULL) {
        return cw_failed(CW_FAULT_UNSUPPORTED, CW_STEP_SEND, 0U, 0, failure);
    }
    if (length > sizeof(reply)) {
        return cw_failed(CW_FAULT_RANGE, CW_STEP_SEND, 0U, 0, failure);
    }
    error = transport->send_request(transport->context, step->value, reply, length);
    if (error != 0) {
        return cw_failed(CW_FAULT_TRANSPORT, CW_STEP_SEND, 0U, error, failure);
    }
    result = cw_reply_check(step->value, reply, length, step->mask);
    return (result == CW_OK) ? result : cw_failed(result, CW_STEP_SEND, 0U, 0, failure);
}

/** Return the number of bytes that a step accesses at once, including its MORE steps. */
static inline size_t cw_step_bytes(const cw_step *steps, size_t count)
{
    size_t bytes = 1U;
    while ((bytes < count) && (steps[bytes].kind == CW_STEP_MORE)) {
        bytes++;
    }
    return bytes;
}

/**
 * Replace the bits under the masks of a WRITE or CLOSE step. Return true if other bits stay
 * unchanged, so that the bytes must be read first.
 */
static inline bool cw_step_change(const cw_step *steps, uint8_t *bytes, size_t length)
{
    bool keeps_bits = false;
    size_t index;
    for (index = 0U; index < length; index++) {
        const uint32_t mask = steps[index].mask;
        keeps_bits = keeps_bits || (mask != 0xFFU);
        bytes[index] =
            (uint8_t)(((uint32_t)bytes[index] & ~mask) | ((uint32_t)steps[index].value & mask));
    }
    return keeps_bits;
}

/** Return the index of the first byte that differs from its step under the mask, or length. */
static inline size_t cw_step_differs(
    const cw_step *steps, const uint8_t *bytes, size_t length)
{
    size_t index = 0U;
    while ((index < length) &&
        (((uint32_t)bytes[index] & (uint32_t)steps[index].mask) == (uint32_t)steps[index].value)) {
        index++;
    }
    return index;
}

/** Carry out a WRITE or CLOSE step of length bytes. */
CW_NODISCARD
static inline cw_result cw_run_write(
    const cw_transport *transport, const cw_step *step, size_t length, cw_failure *failure)
{
    uint8_t bytes[CW_STEP_BYTES] = { 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U };
    if (cw_step_change(step, bytes, length)) {
        const cw_result result = cw_read(transport, step->address, bytes, length, failure);
        if (result != CW_OK) {
            return result;
        }
        (void)cw_step_change(step, bytes, length);
    }
    return cw_write(transport, step->address, bytes, length, failure);
}

/** Carry out a SEND step. */
CW_NODISCARD
static inline cw_result cw_run_send(
    const cw_transport *transport, const cw_step *step, cw_failure *failure)
{
    cw_result result = CW_OK;
    uint16_t sent;
    for (sent = 0U; (sent < step->times) && (result == CW_OK); sent++) {
        if ((sent != 0U) && (step->microseconds != 0U)) {
            result = cw_wait(transport, step->microseconds, failure);
        }
        if (result == CW_OK) {
            result = cw_send(transport, step, failure);
        }
    }
    return result;
}

/** Carry out a POLL or VERIFY step of length bytes. */
CW_NODISCARD
static inline cw_result cw_run_compare(
    const cw_transport *transport, const cw_step *step, size_t length, cw_failure *failure)
{
    const bool bounded = transport->poll_at_most != 0U;
    const uint32_t at_most = bounded ? transport->poll_at_most : CW_POLL_AT_MOST;
    const uint32_t pause_us = bounded ? transport->poll_pause_us : CW_POLL_PAUSE_US;
    uint32_t readings;
    for (readings = 0U; readings < at_most; readings++) {
        uint8_t bytes[CW_STEP_BYTES] = { 0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U };
        cw_result result = CW_OK;
        size_t differs;
        if ((readings != 0U) && (pause_us != 0U)) {
            result = cw_wait(transport, pause_us, failure);
        }
        if (result == CW_OK) {
            result = cw_read(transport, step->address, bytes, length, failure);
        }
        if (result != CW_OK) {
            return result;
        }
        differs = cw_step_differs(step, bytes, length);
        if (differs == length) {
            return CW_OK;
        }
        if (step->kind == CW_STEP_VERIFY) {
            return cw_failed(
                CW_FAULT_VERIFY, CW_STEP_VERIFY, step->address, (int32_t)bytes[differs], failure);
        }
    }
    return cw_failed(CW_FAULT_TIMEOUT, CW_STEP_POLL, step->address, 0, failure);
}

/**
 * Return true if there are steps, the READ steps return length bytes to the caller, and all MORE
 * steps belong to registers of up to CW_STEP_BYTES bytes.
 */
static inline bool cw_run_fits(const cw_step *steps, size_t count, size_t length)
{
    cw_step_kind kind = CW_STEP_WAIT;
    size_t reads = 0U;
    size_t bytes = 0U;
    size_t index;
    for (index = 0U; index < count; index++) {
        const bool is_more = steps[index].kind == CW_STEP_MORE;
        if (!is_more) {
            kind = steps[index].kind;
            bytes = 0U;
        }
        bytes++;
        if ((is_more && ((kind == CW_STEP_WAIT) || (kind == CW_STEP_SEND))) ||
            (bytes > CW_STEP_BYTES)) {
            return false;
        }
        reads += (kind == CW_STEP_READ) ? 1U : 0U;
    }
    return (count != 0U) && (reads == length);
}

/**
 * Return the number of leading steps that one call carries out. READ steps at consecutive addresses
 * are read together, unless their registers have one address each.
 */
static inline size_t cw_run_together(const cw_step *steps, size_t count)
{
    size_t steps_at_once = cw_step_bytes(steps, count);
    if ((steps_at_once != 1U) || (steps[0].kind != CW_STEP_READ) || (steps[0].times == 0U)) {
        return steps_at_once;
    }
    while ((steps_at_once < count) && (steps[steps_at_once].kind == CW_STEP_READ) &&
        (steps[steps_at_once].times != 0U) &&
        ((size_t)steps[steps_at_once].address == ((size_t)steps[0].address + steps_at_once))) {
        steps_at_once++;
    }
    /* If a MORE step follows, it belongs to the last READ, so that one is run on its own. */
    if ((steps_at_once < count) && (steps[steps_at_once].kind == CW_STEP_MORE)) {
        steps_at_once--;
    }
    return steps_at_once;
}

/** Carry out a step of any kind except READ, which accesses length bytes at once. */
CW_NODISCARD
static inline cw_result cw_run_step(
    const cw_transport *transport, const cw_step *step, size_t length,
    cw_failure *failure)
{
    switch (step->kind) {
    case CW_STEP_WRITE:
    case CW_STEP_CLOSE:
        return cw_run_write(transport, step, length, failure);
    case CW_STEP_WAIT:
        return cw_wait(transport, step->microseconds, failure);
    case CW_STEP_SEND:
        return cw_run_send(transport, step, failure);
    case CW_STEP_POLL:
    case CW_STEP_VERIFY:
        return cw_run_compare(transport, step, length, failure);
    case CW_STEP_READ:
    case CW_STEP_MORE:
    default:
        return cw_failed(CW_FAULT_RANGE, step->kind, step->address, 0, failure);
    }
}

/** Return the register address of a step, or 0 if it has none. */
static inline uint16_t cw_step_address(const cw_step *step)
{
    const bool none = (step->kind == CW_STEP_SEND) || (step->kind == CW_STEP_WAIT);
    return none ? 0U : step->address;
}

/**
 * Return true if a step closes registers that one of the first count steps opened. A failed step
 * counts too, since it may have reached the encoder.
 */
static inline bool cw_step_closes(
    const cw_step *steps, size_t count, const cw_step *step)
{
    size_t index;
    if (step->kind != CW_STEP_CLOSE) {
        return false;
    }
    for (index = 0U; index < count; index++) {
        if ((steps[index].kind == CW_STEP_WRITE) && (steps[index].address == step->address)) {
            return true;
        }
    }
    return false;
}

/**
 * Close the registers that were opened up to the failed step, by carrying out the later closing
 * steps. Return true on success. Return false on failure, or if the failed step is itself a closing
 * step.
 */
static inline bool cw_run_closing(
    const cw_transport *transport, const cw_step *steps, size_t count, size_t failed)
{
    bool is_closed = (failed < count) && (steps[failed].kind != CW_STEP_CLOSE);
    size_t index;
    for (index = failed + 1U; index < count; index++) {
        if (cw_step_closes(steps, failed + 1U, &steps[index])) {
            const size_t length = cw_step_bytes(&steps[index], count - index);
            const cw_result result = cw_run_write(transport, &steps[index], length, NULL);
            is_closed = (result == CW_OK) && is_closed;
        }
    }
    return is_closed;
}

/**
 * Carry out a list of steps in order, up to the first failure. After a failure, close opened
 * registers. READ steps at consecutive addresses are read in one call, unless times is 0.
 *
 * @param transport  your bus access functions
 * @param steps  the list, from a _steps() function of an encoder
 * @param count  number of steps
 * @param bytes  one byte for each READ step and each MORE step after it, in order. Meaningless
 *               after a failure
 * @param length  size of bytes, which must be the number of these steps
 * @param failure  details of the failed step, or NULL
 * @return OK, LENGTH (before the first step) if length is wrong, there are no steps or a MORE step
 *         does not belong to a register of up to CW_STEP_BYTES bytes, or the result of the step
 *         that failed
 */
CW_NODISCARD
static inline cw_result cw_run(
    const cw_transport *transport, const cw_step *steps, size_t count,
    uint8_t *bytes, size_t length, cw_failure *failure)
{
    size_t bytes_read = 0U;
    size_t index = 0U;
    if (!cw_run_fits(steps, count, length)) {
        return CW_FAULT_LENGTH;
    }
    while (index < count) {
        const cw_step *const step = &steps[index];
        cw_result result;
        const size_t steps_done = cw_run_together(step, count - index);
        if (step->kind == CW_STEP_READ) {
            result = cw_read(transport, step->address, &bytes[bytes_read], steps_done, failure);
            bytes_read += steps_done;
        } else {
            result = cw_run_step(transport, step, steps_done, failure);
        }
        if (result != CW_OK) {
            const bool closed = cw_run_closing(transport, steps, count, index);
            if (failure != NULL) {
                failure->kind = step->kind;
                failure->address = cw_step_address(step);
                failure->left_open = !closed;
            }
            return cw_failed_at(result, index, failure);
        }
        index += steps_done;
    }
    return CW_OK;
}

#ifdef __cplusplus
}
#endif

#endif
