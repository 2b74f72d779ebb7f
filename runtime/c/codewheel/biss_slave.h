/** @file
 * codewheel/biss_slave.h - register access over BiSS C, for your own slave
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 * BiSS is a trademark of iC-Haus GmbH.
 *
 * This is for simulators, test benches and encoders. biss.h describes the control frames and cites
 * the sources.
 *
 * Compiles as C99 and C++11. Needs no library and no allocation. You provide the struct that holds
 * the state of a slave. Pointers must not be null. Not yet tested on hardware.
 */
#ifndef CODEWHEEL_BISS_SLAVE_H
#define CODEWHEEL_BISS_SLAVE_H

#include "biss.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/biss_slave.h 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Number of bytes with one bit per address. */
#define CW_BISS_ADDRESS_BYTES 16U

/** Action for which a slave waits. The slave is busy until then. */
typedef enum cw_biss_wants {
    CW_BISS_WANTS_NOTHING = 0, /**< none */
    CW_BISS_WANTS_BYTE = 1, /**< call _slave_give with the content of the register at address */
    CW_BISS_WANTS_STORE = 2 /**< store value at address, then call _slave_stored */
} cw_biss_wants;

/**
 * State of a slave. Initialize it with _slave_init, and use _slave_allow to set which registers may
 * be read and written. Then call _slave_next once in every BiSS frame, and check wants after each
 * call.
 *
 * To answer S in time, the slave asks for a byte before it is certain that the master will read it:
 * after W and, in a sequence, after P. A register that changes when it is read must tolerate this
 * early read.
 */
typedef struct cw_biss_slave {
    /** one bit per address, with address 0 in bit 0 of byte 0 */
    uint8_t readable[CW_BISS_ADDRESS_BYTES];
    uint8_t writable[CW_BISS_ADDRESS_BYTES]; /**< the same for writing */
    cw_biss_wants wants; /**< action that it waits for */
    uint8_t address; /**< register that the member wants refers to */
    uint8_t value;   /**< value to store there */
    uint8_t id;      /**< ID taken in the last control frame, or NO_ID */
    cw_biss_phase phase; /**< private */
    bool locked; /**< private: it has taken an ID in this control frame */
    bool write; /**< private: the master writes */
    bool is_byte_ready; /**< private: the byte of the current register was given */
    uint8_t current_address; /**< private: the register that the master accesses */
    uint8_t zeros; /**< private: number of zeros received in a row, up to 14 */
    uint8_t bit_index; /**< private: last bit received, counted from the S of its phase */
    uint32_t received_bits; /**< private: the CDM bits of this phase, the last in bit 0 */
    uint32_t bits_to_send; /**< private: DATA and CRC of a read */
} cw_biss_slave;

/** Initialize a slave. It rejects every register until you call _slave_allow. */
static inline void cw_biss_slave_init(cw_biss_slave *slave)
{
    size_t index;
    for (index = 0U; index < CW_BISS_ADDRESS_BYTES; index++) {
        slave->readable[index] = 0U;
        slave->writable[index] = 0U;
    }
    slave->wants = CW_BISS_WANTS_NOTHING;
    slave->address = 0U;
    slave->value = 0U;
    slave->id = CW_BISS_NO_ID;
    slave->phase = CW_BISS_PHASE_WAIT;
    slave->locked = false;
    slave->write = false;
    slave->is_byte_ready = false;
    slave->current_address = 0U;
    slave->zeros = 0U;
    slave->bit_index = 0U;
    slave->received_bits = 0U;
    slave->bits_to_send = 0U;
}

/**
 * Set the access of a master to a range of registers.
 *
 * @param slave  the slave
 * @param address  address of the first register
 * @param count  number of registers
 * @param read  true if the master may read them
 * @param write  true if the master may write them
 * @return OK, or RANGE if the registers go past 7Fh
 */
CW_NODISCARD
static inline cw_result cw_biss_slave_allow(
    cw_biss_slave *slave, uint8_t address, size_t count, bool read, bool write)
{
    size_t allowed;
    if ((address > CW_BISS_LAST_ADDRESS) ||
        (count > ((CW_BISS_LAST_ADDRESS + 1U) - (size_t)address))) {
        return CW_FAULT_RANGE;
    }
    for (allowed = address; allowed < ((size_t)address + count); allowed++) {
        const size_t byte = allowed / 8U;
        const size_t bit_index = allowed % 8U;
        const uint32_t bit = (uint32_t)1U << (uint32_t)bit_index;
        const uint32_t readable = slave->readable[byte] & (0xFFU ^ bit);
        const uint32_t writable = slave->writable[byte] & (0xFFU ^ bit);
        slave->readable[byte] = (uint8_t)(readable | (read ? bit : 0U));
        slave->writable[byte] = (uint8_t)(writable | (write ? bit : 0U));
    }
    return CW_OK;
}

/** Give a slave the content of the register that it asked for. Does nothing without a request. */
static inline void cw_biss_slave_give(cw_biss_slave *slave, uint8_t value)
{
    if (slave->wants == CW_BISS_WANTS_BYTE) {
        slave->wants = CW_BISS_WANTS_NOTHING;
        slave->is_byte_ready = true;
        slave->bits_to_send = cw_biss_byte_encode(value);
    }
}

/** Report that the value is stored. Does nothing unless the slave wants a value stored. */
static inline void cw_biss_slave_stored(cw_biss_slave *slave)
{
    if (slave->wants == CW_BISS_WANTS_STORE) {
        slave->wants = CW_BISS_WANTS_NOTHING;
    }
}

/** Return true if the current access to the current register is allowed. */
static inline bool cw_biss_slave_is_allowed(const cw_biss_slave *slave)
{
    const uint8_t *const allowed = slave->write ? slave->writable : slave->readable;
    const uint32_t bits = allowed[(slave->current_address & CW_BISS_LAST_ADDRESS) / 8U];
    return ((bits >> (slave->current_address % 8U)) & 1U) != 0U;
}

/** Request the byte of the current register, unless a previous write has not been stored yet. */
static inline void cw_biss_slave_fetch(cw_biss_slave *slave)
{
    if (!slave->write && !slave->is_byte_ready && (slave->wants == CW_BISS_WANTS_NOTHING)) {
        slave->wants = CW_BISS_WANTS_BYTE;
        slave->address = slave->current_address;
    }
}

/** Leave the control frame, since the rest of it does not concern this slave. */
static inline bool cw_biss_slave_leave(cw_biss_slave *slave, bool cds)
{
    slave->phase = CW_BISS_PHASE_WAIT;
    if (slave->wants == CW_BISS_WANTS_BYTE) {
        slave->wants = CW_BISS_WANTS_NOTHING;
    }
    return cds;
}

/** Begin with the current register, after W or P: fetch its byte and wait for S. */
static inline void cw_biss_slave_begin_register(cw_biss_slave *slave)
{
    slave->phase = CW_BISS_PHASE_START;
    slave->is_byte_ready = false;
    cw_biss_slave_fetch(slave);
}

/** Lock an ID: take the first IDL bit that no slave farther from the master has taken. */
static inline bool cw_biss_slave_lock(cw_biss_slave *slave, bool upstream)
{
    if (upstream || slave->locked || (slave->bit_index > CW_BISS_IDS)) {
        return upstream;
    }
    slave->locked = true;
    /* IDL8 only means that there are more slaves than IDs. */
    slave->id = (slave->bit_index < CW_BISS_IDS) ? slave->bit_index : CW_BISS_NO_ID;
    return true;
}

/** Steps 2 and 3, after S: return the CDS bit. */
static inline bool cw_biss_slave_header(cw_biss_slave *slave, bool cdm, bool upstream)
{
    cw_biss_request request;
    slave->received_bits = (slave->received_bits << 1U) | (cdm ? 1U : 0U);
    slave->bit_index++;
    if (slave->bit_index <= CW_BISS_CHECKED_BITS) {
        const bool cds = cw_biss_slave_lock(slave, upstream);
        if (slave->bit_index < CW_BISS_CHECKED_BITS) {
            return cds;
        }
        /* CTS, ID, ADR and CRC are complete. Check them as for a read, regardless of R W. */
        const uint32_t checked = slave->received_bits << CW_BISS_WORD_CRC_SHIFT;
        if (cw_biss_request_decode(checked | CW_BISS_READS, &request) != CW_OK) {
            return cw_biss_slave_leave(slave, cds);
        }
        if (request.id != slave->id) {
            return cw_biss_slave_leave(slave, cds);
        }
        slave->current_address = request.address;
        return cds;
    }
    if (slave->bit_index == (CW_BISS_CHECKED_BITS + 1U)) {
        return cdm;
    }
    slave->write = cdm;
    if (((slave->received_bits >> 1U) & 1U) == (cdm ? 1U : 0U)) {
        /* Neither 10 nor 01: echo it as received, so that the master sees the error. */
        return cw_biss_slave_leave(slave, cdm);
    }
    if (!cw_biss_slave_is_allowed(slave)) {
        return cw_biss_slave_leave(slave, !cdm);
    }
    cw_biss_slave_begin_register(slave);
    return cdm;
}

/** Step 4: answer S once the slave is done. */
static inline bool cw_biss_slave_start(cw_biss_slave *slave, bool cdm, bool upstream)
{
    if (!cdm) {
        return cw_biss_slave_leave(slave, upstream);
    }
    cw_biss_slave_fetch(slave);
    if (slave->wants != CW_BISS_WANTS_NOTHING) {
        return false;
    }
    slave->phase = CW_BISS_PHASE_BYTE;
    slave->bit_index = 0U;
    slave->received_bits = 0U;
    return true;
}

/** Steps 5 and 6: return the CDS bit of this frame, part of the byte and its CRC, or P. */
static inline bool cw_biss_slave_byte(cw_biss_slave *slave, bool cdm)
{
    slave->received_bits = (slave->received_bits << 1U) | (cdm ? 1U : 0U);
    slave->bit_index++;
    if (slave->bit_index > CW_BISS_BYTE_BITS) {
        const uint32_t next_address = (uint32_t)slave->current_address + 1U;
        const bool is_last = (next_address % CW_BISS_REGISTERS) == 0U;
        slave->current_address = is_last ? slave->current_address : (uint8_t)next_address;
        if (cdm || is_last || !cw_biss_slave_is_allowed(slave)) {
            return cw_biss_slave_leave(slave, true);
        }
        cw_biss_slave_begin_register(slave);
        return false;
    }
    if (!slave->write) {
        return ((slave->bits_to_send >> (CW_BISS_BYTE_BITS - slave->bit_index)) & 1U) != 0U;
    }
    if (slave->bit_index == CW_BISS_BYTE_BITS) {
        if (cw_biss_byte_decode((uint16_t)slave->received_bits, &slave->value) != CW_OK) {
            /* CRC error: do not store it. The master sees the error in the echoed bits. */
            return cw_biss_slave_leave(slave, cdm);
        }
        slave->wants = CW_BISS_WANTS_STORE;
        slave->address = slave->current_address;
    }
    return cdm;
}

/**
 * Return the CDS bit of this frame.
 *
 * @param slave  the slave
 * @param cdm  the CDM bit of the previous frame
 * @param upstream  the CDS bit received at SLI in this frame, from the next slave farther from the
 *                  master, or false if there is none
 * @return the CDS bit
 */
static inline bool cw_biss_slave_next(cw_biss_slave *slave, bool cdm, bool upstream)
{
    const bool ready = slave->zeros >= CW_BISS_ZEROS;
    slave->zeros = cw_biss_zeros(slave->zeros, cdm);
    if (slave->zeros >= CW_BISS_ZEROS) {
        return cw_biss_slave_leave(slave, upstream);
    }
    switch (slave->phase) {
    case CW_BISS_PHASE_HEADER:
        return cw_biss_slave_header(slave, cdm, upstream);
    case CW_BISS_PHASE_START:
        return cw_biss_slave_start(slave, cdm, upstream);
    case CW_BISS_PHASE_BYTE:
        return cw_biss_slave_byte(slave, cdm);
    case CW_BISS_PHASE_WAIT:
    default:
        if (!cdm || !ready) {
            return upstream;
        }
        slave->phase = CW_BISS_PHASE_HEADER;
        slave->bit_index = 0U;
        slave->received_bits = 0U;
        slave->id = CW_BISS_NO_ID;
        slave->locked = false;
        return cw_biss_slave_lock(slave, upstream);
    }
}

#ifdef __cplusplus
}
#endif

#endif
