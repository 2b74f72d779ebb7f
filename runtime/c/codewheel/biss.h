/** @file
 * codewheel/biss.h - register access over BiSS C, for your own master
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 * BiSS is a trademark of iC-Haus GmbH.
 *
 * You do not need this header if you have a ready-made BiSS master, or if you only read positions,
 * which the headers of the encoders decode. See biss_slave.h for the slave's side.
 *
 * A BiSS frame carries one bit of control data each way: CDM from the master, the inverse of the
 * level of MA during the timeout, and CDS from the slave, after the start bit. The bits of
 * successive frames form a control frame, which reads or writes registers:
 *
 *     step  CDM                          CDS, the response to these bits
 *     1     at least 14 zeros            0
 *     2     S = 1, CTS = 1, ID2..0,      IDL0..15: each slave takes the first bit that is still 0
 *           ADR6..0, CRC3..0             as its ID, and there are 8 IDs
 *     3     R W: 10 to read, 01 to write the same R W, or W inverted to reject the register
 *     4     S = 1                        S = 1, or 0 while the slave is busy: the master repeats S
 *     5     writing: DATA7..0, CRC3..0   DATA7..0, CRC3..0: the value read, or the bits received
 *           reading: 12 zeros
 *     6     P = 0                        P = 0, or 1 to reject the next register
 *     7     S = 1 as in 4 for the next register, or 0: the end
 *
 * CDS is sent early in a frame and CDM at its end, so the response to a bit comes in the next
 * frame. The CRC is x^4 + x + 1 with initial value 0, and it is sent inverted. It covers CTS, ID
 * and ADR, or a data byte. No CRC covers S, R, W, P and IDL. Therefore:
 *  - A write that no slave understood looks like a rejected one: the bits R and W are echoed as 00.
 *  - If the slave's S bit is lost on its way to the master, the two stay out of step by one bit. A
 *    value read in this state has a wrong CRC. A value that is written is not stored, but if its
 *    CRC ends in 0, which is true of half of all values, it is echoed as if it had been stored. If
 *    CDM is one frame late, this happens only if the slave is busy and CDS is corrupted at the same
 *    time. Therefore, read back what you write before a command uses it, as the VERIFY steps of
 *    procedures do.
 *  - An incomplete byte can be stored. If a write is aborted within a byte, the slave can store the
 *    bits sent so far, followed by zeros, if their CRC is 0 (one in 68 combinations of bit position
 *    and value). Write such a register again, and take special care if any value in it starts an
 *    action.
 *
 * Source: "BiSS Interface, Protocol Description (BiSS C)", Rev C6, iC-Haus, pages 9 to 14 and 18.
 * Three details come from two published masters: the CRC covers CTS, each response comes in the
 * frame described above, and P comes before another S. The masters are lenzencoders/BISS-C
 * (BiSS_C_Master/lib/BiSS_C_Master) and TexasInstruments/motor-control-sdk
 * (source/position_sense/bissc). Two details are inferred: the end of a chain that has ID 0, and
 * the reaction of a slave to a corrupted byte or to R W = 00 or 11. Not yet tested on hardware.
 * Commands (CTS = 0) are not supported: the slave ignores them.
 *
 * Compiles as C99 and C++11. Needs no library and no allocation. You provide the struct that holds
 * the state of a master. Pointers must not be null.
 */
#ifndef CODEWHEEL_BISS_H
#define CODEWHEEL_BISS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "result.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/biss.h 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* -- words ------------------------------------------------------------------------------------- */

/** Number of zeros that must precede a control frame. The same number also ends one at any time. */
#define CW_BISS_ZEROS 14U
/** Number of IDs for slaves. The only slave, or the last in a chain, whose SLI is 0, has ID 0. */
#define CW_BISS_IDS 8U
/** IDL0, the first of the 16 responses in which slaves take their IDs. */
#define CW_BISS_IDL0 0x8000U
/** Address of the last register. */
#define CW_BISS_LAST_ADDRESS 0x7FU
/** Number of registers that one control frame can reach: 00h to 3Fh or 40h to 7Fh. */
#define CW_BISS_REGISTERS 64U
/** Value used as the ID of a slave that has none. */
#define CW_BISS_NO_ID 0xFFU
/** Number of bits of CTS, ID and ADR, before their CRC. */
#define CW_BISS_HEAD_BITS 11U
/** Number of bits from CTS to W: CTS, ID, ADR, CRC, R and W. */
#define CW_BISS_HEADER_BITS 17U
/** Number of bits of CTS, ID, ADR and CRC, after which R and W follow. */
#define CW_BISS_CHECKED_BITS 15U
/** Number of bits of DATA. */
#define CW_BISS_DATA_BITS 8U
/** Number of bits of DATA and CRC. */
#define CW_BISS_BYTE_BITS 12U
/** Number of bits of CRC, by which the bits before it are shifted. */
#define CW_BISS_CRC_BITS 4U

/** CTS in CTS, ID and ADR: access to a register. */
#define CW_BISS_CTS 0x400U
/** Place of ID in CTS, ID and ADR. */
#define CW_BISS_ID_SHIFT 7U
/** R W to read. */
#define CW_BISS_RW_READ 0x2U
/** R W to write. */
#define CW_BISS_RW_WRITE 0x1U

/** Place of CTS, ID and ADR in a request word. */
#define CW_BISS_WORD_HEAD_SHIFT 21U
/** Place of their CRC in a request word. */
#define CW_BISS_WORD_CRC_SHIFT 17U
/** Place of R W in a request word. */
#define CW_BISS_WORD_RW_SHIFT 15U
/** Place of DATA and CRC in a request word. */
#define CW_BISS_WORD_BYTE_SHIFT 2U
/** R, W and S in the word of a read request. */
#define CW_BISS_READS 0x00014000U
/** R, W and S in the word of a write request. */
#define CW_BISS_WRITES 0x0000C000U

/** Place of IDL0 to IDL15 in the word of responses. */
#define CW_BISS_CDS_IDL_SHIFT 16U
/** Place of R W in the word of responses. */
#define CW_BISS_CDS_RW_SHIFT 14U
/** Place of S in the word of responses. */
#define CW_BISS_CDS_START_SHIFT 13U
/** Place of DATA and CRC in the word of responses. */
#define CW_BISS_CDS_BYTE_SHIFT 1U

/** Access to one register. */
typedef struct cw_biss_request {
    uint8_t id;      /**< ID of the slave, 0 to 7 */
    uint8_t address; /**< register address, 00h to 7Fh */
    bool write;      /**< true to write, false to read */
    uint8_t value;   /**< value to write, or 0 for a read */
} cw_biss_request;

/** State or outcome of an access. */
typedef enum cw_biss_outcome {
    CW_BISS_IDLE = 0,      /**< no access requested yet */
    CW_BISS_RUNNING = 1,   /**< in progress */
    CW_BISS_DONE = 2,      /**< all bytes read or written */
    CW_BISS_REFUSED = 3,   /**< register protected or not implemented, or write not understood */
    CW_BISS_NO_ANSWER = 4, /**< no slave has this ID, or CDS never changes */
    CW_BISS_BUSY = 5,      /**< the slave was busy for more frames than allowed */
    CW_BISS_BAD_CRC = 6,   /**< CRC error in the byte read */
    CW_BISS_BAD_ECHO = 7,  /**< R W or a byte was echoed changed (the byte may be stored) */
    CW_BISS_ABORTED = 8    /**< aborted by the caller */
} cw_biss_outcome;

/** Return the CRC of 1 to 32 bits of control data, with the highest bit sent first. */
static inline uint32_t cw_biss_crc(uint32_t value, uint32_t bits)
{
    uint32_t crc = 0U;
    uint32_t bits_left;
    for (bits_left = (bits < 32U) ? bits : 32U; bits_left > 0U; bits_left--) {
        const uint32_t feedback = ((crc >> 3U) ^ (value >> (bits_left - 1U))) & 1U;
        crc = ((crc << 1U) & 0xFU) ^ ((feedback != 0U) ? 0x3U : 0U); /* 3h: x + 1 */
    }
    return crc ^ 0xFU;
}

/** Return the 12 bits of a data byte and its CRC. */
static inline uint16_t cw_biss_byte_encode(uint8_t value)
{
    const uint32_t crc = cw_biss_crc(value, CW_BISS_DATA_BITS);
    return (uint16_t)(((uint32_t)value << CW_BISS_CRC_BITS) | crc);
}

/**
 * Decode a data byte.
 *
 * @param bits  the byte and its CRC, 12 bits
 * @param value  the byte
 * @return OK, LENGTH if there are more than 12 bits, or CRC if the CRC is wrong
 */
CW_NODISCARD
static inline cw_result cw_biss_byte_decode(uint16_t bits, uint8_t *value)
{
    const uint32_t word = bits;
    const uint32_t data = word >> CW_BISS_CRC_BITS;
    if (word > 0xFFFU) {
        return CW_FAULT_LENGTH;
    }
    if (cw_biss_crc(data, CW_BISS_DATA_BITS) != (word & 0xFU)) {
        return CW_FAULT_CRC;
    }
    *value = (uint8_t)data;
    return CW_OK;
}

/** Return CTS, ID2..0, ADR6..0, CRC3..0, R and W of a request, with W in bit 0. */
static inline uint32_t cw_biss_header(const cw_biss_request *request)
{
    const uint32_t id = (uint32_t)request->id << CW_BISS_ID_SHIFT;
    const uint32_t head = CW_BISS_CTS | id | request->address;
    const uint32_t crc = cw_biss_crc(head, CW_BISS_HEAD_BITS);
    const uint32_t checked = (head << CW_BISS_CRC_BITS) | crc;
    return (checked << 2U) | (request->write ? CW_BISS_RW_WRITE : CW_BISS_RW_READ);
}

/**
 * Encode the bits that a master sends after the first S. TI's masters use the same layout.
 *
 * @param request  the access
 * @param word  the bits, with the first one in bit 31: CTS, ID2..0, ADR6..0, CRC3..0, R, W, S, then
 *              DATA7..0 and CRC3..0 or 12 zeros, P, and one more zero
 * @return OK, or RANGE if the ID or address is out of range or a read request has a value
 */
CW_NODISCARD
static inline cw_result cw_biss_request_encode(const cw_biss_request *request, uint32_t *word)
{
    if ((request->id >= CW_BISS_IDS) || (request->address > CW_BISS_LAST_ADDRESS)
        || (!request->write && (request->value != 0U))) {
        return CW_FAULT_RANGE;
    }
    *word = (cw_biss_header(request) << CW_BISS_WORD_RW_SHIFT) | (CW_BISS_READS & CW_BISS_WRITES);
    if (request->write) {
        *word |= (uint32_t)cw_biss_byte_encode(request->value) << CW_BISS_WORD_BYTE_SHIFT;
    }
    return CW_OK;
}

/**
 * Decode a request word.
 *
 * @param word  the word, in the format of _request_encode
 * @param request  the access
 * @return OK, CRC if one of the CRCs is wrong, or CONSTANT if CTS or S is 0, R W is neither 10 nor
 *         01, or a bit that must be zero is not
 */
CW_NODISCARD
static inline cw_result cw_biss_request_decode(uint32_t word, cw_biss_request *request)
{
    const uint32_t head = word >> CW_BISS_WORD_HEAD_SHIFT;
    const uint32_t crc = (word >> CW_BISS_WORD_CRC_SHIFT) & 0xFU;
    const uint16_t byte = (uint16_t)((word >> CW_BISS_WORD_BYTE_SHIFT) & 0xFFFU);
    const uint32_t access = word & (CW_BISS_READS | CW_BISS_WRITES);
    const bool write = access == CW_BISS_WRITES;
    const uint32_t zeros = word & (write ? 0x3U : 0x3FFFU);
    uint8_t value = 0U;
    if (cw_biss_crc(head, CW_BISS_HEAD_BITS) != crc) {
        return CW_FAULT_CRC;
    }
    if (write && (cw_biss_byte_decode(byte, &value) != CW_OK)) {
        return CW_FAULT_CRC;
    }
    if ((head < CW_BISS_CTS) || (!write && (access != CW_BISS_READS)) || (zeros != 0U)) {
        return CW_FAULT_CONSTANT;
    }
    request->id = (uint8_t)((head >> CW_BISS_ID_SHIFT) & 0x7U);
    request->address = (uint8_t)(head & CW_BISS_LAST_ADDRESS);
    request->write = write;
    request->value = value;
    return CW_OK;
}

/** Return the number of slaves with an ID, at most 9, from IDL0 (bit 15) to IDL15 (bit 0). */
static inline uint8_t cw_biss_slaves(uint32_t idl)
{
    uint8_t slaves = 0U;
    uint32_t id_bit = CW_BISS_IDL0;
    while ((slaves <= CW_BISS_IDS) && ((idl & id_bit) != 0U)) {
        slaves++;
        id_bit >>= 1U;
    }
    return slaves;
}

/**
 * Evaluate the first 18 responses of a control frame, from IDL0 in bit 17 to W in bit 0. Return
 * RUNNING if the slave participates, otherwise REFUSED, NO_ANSWER or BAD_ECHO.
 */
static inline cw_biss_outcome cw_biss_echo(const cw_biss_request *request, uint32_t responses)
{
    const uint32_t echo = responses & 0x3U;
    const uint32_t expected = request->write ? CW_BISS_RW_WRITE : CW_BISS_RW_READ;
    const uint32_t refused = expected ^ 0x1U;
    const uint32_t id_shift = CW_BISS_HEADER_BITS - (request->id & 0x7U);
    const uint32_t id_taken = (responses >> id_shift) & 1U;
    const bool is_cds_stuck = (responses & 0x3FFFFU) == 0x3FFFFU;
    if (is_cds_stuck || (id_taken == 0U)) {
        return CW_BISS_NO_ANSWER;
    }
    if (echo == expected) {
        return CW_BISS_RUNNING;
    }
    if (echo == refused) {
        return CW_BISS_REFUSED;
    }
    return (echo == 0U) ? CW_BISS_NO_ANSWER : CW_BISS_BAD_ECHO;
}

/** Evaluate the 12 responses to DATA and CRC. Return DONE, BAD_CRC or BAD_ECHO. */
static inline cw_biss_outcome cw_biss_data(
    const cw_biss_request *request, uint32_t responses, uint8_t *value)
{
    if (request->write) {
        const uint32_t sent = cw_biss_byte_encode(request->value);
        return (responses == sent) ? CW_BISS_DONE : CW_BISS_BAD_ECHO;
    }
    if (cw_biss_byte_decode((uint16_t)responses, value) != CW_OK) {
        return CW_BISS_BAD_CRC;
    }
    return CW_BISS_DONE;
}

/**
 * Decode the response to a whole word. This is for masters that send the word of a request before
 * they evaluate the response. Such a master cannot wait for a busy slave.
 *
 * @param request  the access
 * @param cds  the CDS bits of the 32 frames that sent the word, the first in bit 31: IDL0..15, R,
 *             W, S, DATA7..0, CRC3..0, P
 * @param slaves  number of slaves, or 9 if more than 8
 * @param value  the byte read, unchanged unless the outcome is DONE
 * @return DONE, REFUSED, NO_ANSWER, BUSY, BAD_CRC or BAD_ECHO
 */
static inline cw_biss_outcome cw_biss_answer_decode(
    const cw_biss_request *request, uint32_t cds, uint8_t *slaves, uint8_t *value)
{
    const cw_biss_outcome echo = cw_biss_echo(request, cds >> CW_BISS_CDS_RW_SHIFT);
    *slaves = cw_biss_slaves(cds >> CW_BISS_CDS_IDL_SHIFT);
    if (echo != CW_BISS_RUNNING) {
        return echo;
    }
    if (((cds >> CW_BISS_CDS_START_SHIFT) & 1U) == 0U) {
        return CW_BISS_BUSY;
    }
    return cw_biss_data(request, (cds >> CW_BISS_CDS_BYTE_SHIFT) & 0xFFFU, value);
}

/* -- master and slave -------------------------------------------------------------------------- */

/** Part of a control frame. */
typedef enum cw_biss_phase {
    CW_BISS_PHASE_WAIT = 0,   /**< outside a control frame: waits for 14 zeros, then for S */
    CW_BISS_PHASE_HEADER = 1, /**< steps 2 and 3 */
    CW_BISS_PHASE_START = 2,  /**< step 4 */
    CW_BISS_PHASE_BYTE = 3    /**< steps 5 and 6 */
} cw_biss_phase;

/** Return the number of consecutive zeros after one more bit, up to 14. */
static inline uint8_t cw_biss_zeros(uint8_t zeros, bool cdm)
{
    if (cdm) {
        return 0U;
    }
    return (zeros < CW_BISS_ZEROS) ? (uint8_t)(zeros + 1U) : zeros;
}

/* -- master ------------------------------------------------------------------------------------ */

/**
 * State of a master. Initialize it with _master_init, begin an access with _master_read or
 * _master_write, then call _master_next or _master_next_late once in every BiSS frame until the
 * outcome is no longer RUNNING. Keep calling the function while frames continue, so that it counts
 * the zeros required between two accesses. An access to one register takes at most 46 frames. Each
 * further register takes 14 more, and each frame in which the slave is busy adds one.
 *
 * The diagram shows when to call each function, and when its bit must be on MA. The header of each
 * encoder gives the times.
 *
 *              CDS        last clock            CDS        last clock
 *   frame n  ---|--- data ---|--timeout---|  n+1 |--- data ---|--timeout---|
 *   _next       [ call ......]  CDM on MA
 *   _next_late                [ call ........................]  CDM on MA
 *
 *   _master_next       Call it as soon as CDS is received, so that MA can stay at the inverse of
 *                      the bit from its last clock on. Use it with an FPGA, or with pins driven by
 *                      software.
 *   _master_next_late  Call it once the frame is in memory. Use it with SPI and DMA. Its bit
 *                      belongs to the next frame. If the SPI mode sends it (see
 *                      _master_next_late), set the mode before that frame begins.
 * If the bit is sent one frame late, every access with _master_next fails.
 *
 * The functions of a transport (transport.h) return when the access is complete. To implement them,
 * run frames in a loop until then. Access the registers 00h to 3Fh separately from the registers
 * 40h to 7Fh.
 */
typedef struct cw_biss_master {
    cw_biss_outcome outcome; /**< state or outcome of the access */
    uint8_t slaves; /**< number of slaves with an ID (9: more than 8), known after the header */
    uint8_t done; /**< number of bytes read or written */
    cw_biss_phase phase; /**< private */
    cw_biss_request request; /**< private: access to the current register */
    uint8_t *read_bytes; /**< private: the caller's buffer for a read */
    const uint8_t *write_bytes; /**< private: the caller's bytes for a write */
    uint8_t count; /**< private: number of registers */
    uint8_t zeros; /**< private: number of zeros sent in a row, up to 14 */
    uint8_t bit_index; /**< private: last bit sent, counted from the S of its phase or from DATA7 */
    bool repeats_start; /**< private: with CDM one frame late, repeat S until the slave responds */
    uint16_t busy_frames; /**< private: frames in a row in which the slave was busy */
    uint16_t busy_limit; /**< private: maximum number of busy frames */
    uint32_t bits_to_send; /**< private: the bits of this phase, the last in bit 0 */
    uint32_t responses; /**< private: the CDS bits of this phase, the last in bit 0 */
} cw_biss_master;

/** Initialize a master. */
static inline void cw_biss_master_init(cw_biss_master *master)
{
    master->outcome = CW_BISS_IDLE;
    master->slaves = 0U;
    master->done = 0U;
    master->phase = CW_BISS_PHASE_WAIT;
    master->request.id = 0U;
    master->request.address = 0U;
    master->request.write = false;
    master->request.value = 0U;
    master->read_bytes = NULL;
    master->write_bytes = NULL;
    master->count = 0U;
    master->zeros = 0U;
    master->bit_index = 0U;
    master->repeats_start = false;
    master->busy_frames = 0U;
    master->busy_limit = 0U;
    master->bits_to_send = 0U;
    master->responses = 0U;
}

/** Begin an access. Common part of _master_read and _master_write. */
CW_NODISCARD
static inline cw_result cw_biss_master_begin(
    cw_biss_master *master, const cw_biss_request *request, size_t count, uint16_t busy_limit)
{
    uint32_t word = 0U;
    const cw_result result = cw_biss_request_encode(request, &word);
    if (result != CW_OK) {
        return result;
    }
    if ((count == 0U) || (count > (CW_BISS_REGISTERS - (request->address % CW_BISS_REGISTERS)))) {
        return CW_FAULT_RANGE;
    }
    master->outcome = CW_BISS_RUNNING;
    master->slaves = 0U;
    master->done = 0U;
    master->phase = CW_BISS_PHASE_WAIT;
    master->request = *request;
    master->count = (uint8_t)count;
    master->bit_index = 0U;
    master->repeats_start = false;
    master->busy_frames = 0U;
    master->busy_limit = busy_limit;
    master->bits_to_send = word >> CW_BISS_WORD_RW_SHIFT;
    master->responses = 0U;
    return CW_OK;
}

/**
 * Start reading registers. An access in progress is aborted.
 *
 * @param master  the master
 * @param id  ID of the slave
 * @param address  address of the first register
 * @param bytes  buffer for the bytes read, which must remain valid until the access is complete
 * @param count  number of registers
 * @param busy_limit  maximum number of frames in a row in which the slave may be busy. Choose the
 *                    number that takes 20 ms
 * @return OK, or RANGE if there is no such ID or address or the registers go past 3Fh or 7Fh.
 *         Nothing is sent then
 */
CW_NODISCARD
static inline cw_result cw_biss_master_read(
    cw_biss_master *master, uint8_t id, uint8_t address, uint8_t *bytes, size_t count,
    uint16_t busy_limit)
{
    const cw_biss_request request = { id, address, false, 0U };
    const cw_result result = cw_biss_master_begin(master, &request, count, busy_limit);
    if (result == CW_OK) {
        master->read_bytes = bytes;
        master->write_bytes = NULL;
    }
    return result;
}

/**
 * Start writing registers. An access in progress is aborted.
 *
 * @param master  the master
 * @param id  ID of the slave
 * @param address  address of the first register
 * @param bytes  the bytes to write, which must remain valid until the access is complete
 * @param count  number of registers
 * @param busy_limit  maximum number of frames in a row in which the slave may be busy. Choose the
 *                    number that takes 20 ms
 * @return OK, or RANGE if there is no such ID or address or the registers go past 3Fh or 7Fh.
 *         Nothing is sent then
 */
CW_NODISCARD
static inline cw_result cw_biss_master_write(
    cw_biss_master *master, uint8_t id, uint8_t address, const uint8_t *bytes,
    size_t count, uint16_t busy_limit)
{
    const cw_biss_request request = { id, address, true, 0U };
    const cw_result result = cw_biss_master_begin(master, &request, count, busy_limit);
    if (result == CW_OK) {
        master->read_bytes = NULL;
        master->write_bytes = bytes;
    }
    return result;
}

/**
 * Abort the access in progress. The remaining bits are sent as 0. Call it if a frame had no CDS,
 * since the slave may have advanced by a bit that the master has not seen. Then begin the access
 * again. An aborted write may have stored a different value: see the top of this file.
 */
static inline void cw_biss_master_abort(cw_biss_master *master)
{
    if (master->outcome == CW_BISS_RUNNING) {
        master->outcome = CW_BISS_ABORTED;
    }
    master->phase = CW_BISS_PHASE_WAIT;
}

/** End the access and return the first zero after it. */
static inline bool cw_biss_master_end(cw_biss_master *master, cw_biss_outcome outcome)
{
    master->outcome = outcome;
    master->phase = CW_BISS_PHASE_WAIT;
    return false;
}

/** Return the bit to send now, if the bit with this index is in bit 0. */
static inline bool cw_biss_master_bit(const cw_biss_master *master, uint32_t last_index)
{
    return ((master->bits_to_send >> (last_index - master->bit_index)) & 1U) != 0U;
}

/** Record the response to the last bit sent. */
static inline void cw_biss_master_response(cw_biss_master *master, bool cds)
{
    master->responses = (master->responses << 1U) | (cds ? 1U : 0U);
}

/** Begin steps 5 and 6 and return DATA7. */
static inline bool cw_biss_master_begin_byte(cw_biss_master *master)
{
    master->phase = CW_BISS_PHASE_BYTE;
    master->bit_index = 0U;
    master->responses = 0U;
    master->bits_to_send = 0U;
    if (master->request.write) {
        master->request.value = master->write_bytes[master->done];
        master->bits_to_send = cw_biss_byte_encode(master->request.value);
    }
    return cw_biss_master_bit(master, CW_BISS_BYTE_BITS - 1U);
}

/** Store a byte that was read, and count a byte that was read or written. */
static inline void cw_biss_master_end_byte(cw_biss_master *master, uint8_t value)
{
    if (!master->request.write) {
        master->read_bytes[master->done] = value;
    }
    master->done++;
}

/** Steps 2 and 3: return the bits from CTS to W after S, then S once the slave has answered R W. */
static inline bool cw_biss_master_header(cw_biss_master *master, bool cds)
{
    cw_biss_outcome echo;
    cw_biss_master_response(master, cds);
    master->bit_index++;
    if (master->bit_index <= CW_BISS_HEADER_BITS) {
        return cw_biss_master_bit(master, CW_BISS_HEADER_BITS);
    }
    master->slaves = cw_biss_slaves(master->responses >> 2U);
    echo = cw_biss_echo(&master->request, master->responses);
    if (echo != CW_BISS_RUNNING) {
        return cw_biss_master_end(master, echo);
    }
    master->phase = CW_BISS_PHASE_START;
    master->busy_frames = 0U;
    return true;
}

/** Step 4: return S until the slave has answered it, and then DATA7. */
static inline bool cw_biss_master_start(cw_biss_master *master, bool cds)
{
    if (!cds) {
        if (master->busy_frames >= master->busy_limit) {
            return cw_biss_master_end(master, CW_BISS_BUSY);
        }
        master->busy_frames++;
        return true;
    }
    return cw_biss_master_begin_byte(master);
}

/** Steps 5 to 7: return the rest of DATA and CRC, then P, then S if another register follows. */
static inline bool cw_biss_master_byte(cw_biss_master *master, bool cds)
{
    cw_biss_outcome outcome;
    uint8_t value = 0U;
    if (master->bit_index == CW_BISS_BYTE_BITS) {
        if (cds) {
            return cw_biss_master_end(master, CW_BISS_REFUSED);
        }
        master->phase = CW_BISS_PHASE_START;
        master->busy_frames = 0U;
        master->request.address++;
        return true;
    }
    cw_biss_master_response(master, cds);
    master->bit_index++;
    if (master->bit_index < CW_BISS_BYTE_BITS) {
        return cw_biss_master_bit(master, CW_BISS_BYTE_BITS - 1U);
    }
    outcome = cw_biss_data(&master->request, master->responses, &value);
    if (outcome != CW_BISS_DONE) {
        return cw_biss_master_end(master, outcome);
    }
    cw_biss_master_end_byte(master, value);
    /* Ignore the response to the last P: it concerns a register that was not requested. */
    if (master->done == master->count) {
        return cw_biss_master_end(master, outcome);
    }
    return false;
}

/**
 * Return the CDM bit of this frame. MA carries its inverse during the timeout.
 *
 * @param master  the master
 * @param cds  the CDS bit received in this frame
 * @return the CDM bit
 */
static inline bool cw_biss_master_next(cw_biss_master *master, bool cds)
{
    bool cdm = false;
    switch (master->phase) {
    case CW_BISS_PHASE_HEADER:
        cdm = cw_biss_master_header(master, cds);
        break;
    case CW_BISS_PHASE_START:
        cdm = cw_biss_master_start(master, cds);
        break;
    case CW_BISS_PHASE_BYTE:
        cdm = cw_biss_master_byte(master, cds);
        break;
    case CW_BISS_PHASE_WAIT:
    default:
        cdm = (master->outcome == CW_BISS_RUNNING) && (master->zeros >= CW_BISS_ZEROS);
        master->phase = cdm ? CW_BISS_PHASE_HEADER : CW_BISS_PHASE_WAIT;
        break;
    }
    master->zeros = cw_biss_zeros(master->zeros, cdm);
    return cdm;
}

/* -- master, one frame late -------------------------------------------------------------------- */

/**
 * With SPI and DMA, the SPI mode sends the CDM bit: the mode of a frame determines the level of MA
 * after it. Both modes sample at the rising edge and receive the same bits:
 *
 *           rest    the clocks of the frame   timeout   rest
 *   CDM 0   1 1 1   0 1 0 1 0 1 ... 0 1 0 1   1 1 1 1    1 1 1   SPI mode 3
 *   CDM 1   1 1 0   1 0 1 0 1 0 ... 1 0 1 0   0 0 0 0    1 1 1   SPI mode 0
 *   pin     GPIO    SPI ...............................  GPIO
 *
 * At rest, the pin of MA is a GPIO output at 1. Set the mode, assign the pin to the SPI and start
 * DMA. When the timeout after the last clock is over, assign the pin to the GPIO again. No action
 * is required during the timeout, so the clock can be as fast as the SPI and the cable allow.
 * Changing the level after the last clock is too late, since the timeout begins with that clock
 * and can be as short as 1.5 clocks. Further clocks that fill the buffer after the stop bit delay
 * the timeout. Only the level after the last clock matters.
 *
 * lenzencoders/BISS-C uses both modes and switches the pin in this way on an STM32G4
 * (biss_c_master_hal). The effect of clocks after the stop bit is inferred. It is not known whether
 * an encoder treats the return to 1 as the first edge of the next frame. Its acknowledge would
 * then come one clock earlier, which cw_biss_receive tolerates, and its position would be as old
 * as that edge.
 */

/** Number of frames until the first S of an access is answered, including the zeros before it. */
#define CW_BISS_LATE_FRAMES 35U

/**
 * Abandon this attempt and begin the next one, since the slave is busy but the bit after S has
 * already been sent.
 */
static inline bool cw_biss_late_restart(cw_biss_master *master)
{
    const uint32_t busy_frames = (uint32_t)master->busy_frames + CW_BISS_LATE_FRAMES;
    if (master->busy_frames >= master->busy_limit) {
        return cw_biss_master_end(master, CW_BISS_BUSY);
    }
    if (master->repeats_start) {
        master->busy_frames++;
        return true;
    }
    master->busy_frames =
        (busy_frames < master->busy_limit) ? (uint16_t)busy_frames : master->busy_limit;
    master->repeats_start = !master->request.write;
    master->phase = CW_BISS_PHASE_WAIT;
    master->bits_to_send = cw_biss_header(&master->request);
    return false;
}

/** Return DATA7 before the slave's answer to S is known. */
static inline bool cw_biss_late_data(cw_biss_master *master)
{
    const bool data7 = cw_biss_master_begin_byte(master);
    return master->repeats_start || data7;
}

/** Return the bits of steps 2 and 3, then S, then DATA7 once the slave has answered R W. */
static inline bool cw_biss_late_header(cw_biss_master *master, bool cds)
{
    cw_biss_outcome echo;
    if (master->bit_index > 0U) {
        cw_biss_master_response(master, cds);
    }
    master->bit_index++;
    if (master->bit_index <= CW_BISS_HEADER_BITS) {
        return cw_biss_master_bit(master, CW_BISS_HEADER_BITS);
    }
    if (master->bit_index == (CW_BISS_HEADER_BITS + 1U)) {
        return true;
    }
    master->slaves = cw_biss_slaves(master->responses >> 2U);
    echo = cw_biss_echo(&master->request, master->responses);
    if (echo != CW_BISS_RUNNING) {
        return cw_biss_master_end(master, echo);
    }
    return cw_biss_late_data(master);
}

/** Return the rest of DATA and CRC, then P, then S if another register follows. */
static inline bool cw_biss_late_byte(cw_biss_master *master, bool cds)
{
    cw_biss_outcome outcome;
    uint8_t value = 0U;
    if (master->bit_index == 0U) {
        if (!cds) {
            return cw_biss_late_restart(master);
        }
        master->busy_frames = 0U;
    } else {
        cw_biss_master_response(master, cds);
    }
    master->bit_index++;
    if (master->bit_index < CW_BISS_BYTE_BITS) {
        return cw_biss_master_bit(master, CW_BISS_BYTE_BITS - 1U);
    }
    if (master->bit_index == CW_BISS_BYTE_BITS) {
        return false;
    }
    outcome = cw_biss_data(&master->request, master->responses, &value);
    if (outcome != CW_BISS_DONE) {
        return cw_biss_master_end(master, outcome);
    }
    cw_biss_master_end_byte(master, value);
    if (master->done == master->count) {
        return cw_biss_master_end(master, outcome);
    }
    master->request.address++;
    master->phase = CW_BISS_PHASE_START;
    return true;
}

/**
 * Return the CDM bit of the next frame. This is for SPI and DMA, where a frame is in memory only
 * when it is over. Use it in place of _master_next for all frames of an access. The CDM bit of the
 * very first frame is 0.
 *
 * The response to a bit is then received when the next bit is already being sent. So this master
 * sends the bit after S on the assumption that the slave is not busy. If the slave is busy, zeros
 * follow, which store nothing, and the access restarts at the same register. A write is repeated
 * until the slave is ready. A read repeats S until the slave answers it, and the last S takes the
 * place of DATA7. It is inferred that a slave ignores that bit during a read. An access to one
 * register takes 47 frames, each further register takes 14 more, and each restart takes 35 more.
 * With a busy limit of 0, the access does not restart.
 *
 * @param master  the master
 * @param cds  the CDS bit in the frame just received
 * @return the CDM bit of the next frame
 */
static inline bool cw_biss_master_next_late(cw_biss_master *master, bool cds)
{
    bool cdm = false;
    switch (master->phase) {
    case CW_BISS_PHASE_HEADER:
        cdm = cw_biss_late_header(master, cds);
        break;
    case CW_BISS_PHASE_START:
        /* This is the response to P. */
        if (cds) {
            cdm = cw_biss_master_end(master, CW_BISS_REFUSED);
        } else {
            cdm = cw_biss_late_data(master);
        }
        break;
    case CW_BISS_PHASE_BYTE:
        cdm = cw_biss_late_byte(master, cds);
        break;
    case CW_BISS_PHASE_WAIT:
    default:
        cdm = (master->outcome == CW_BISS_RUNNING) && (master->zeros >= CW_BISS_ZEROS);
        master->phase = cdm ? CW_BISS_PHASE_HEADER : CW_BISS_PHASE_WAIT;
        master->bit_index = 0U;
        master->responses = 0U;
        break;
    }
    master->zeros = cw_biss_zeros(master->zeros, cdm);
    return cdm;
}

#ifdef __cplusplus
}
#endif

#endif
