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

/** Action that a slave waits for. The slave is busy until then. */
typedef enum cw_biss_wants {
    CW_BISS_WANTS_NOTHING = 0, /**< none */
    CW_BISS_WANTS_BYTE = 1, /**< call _slave_give with the content of the register at address */
    CW_BISS_WANTS_STORE = 2 /**< store value at address, then call _slave_stored */
} cw_biss_wants;

/**
 * State of a slave. Initialise it with _slave_init, and use _slave_allow to set which registers may
 * be read and written. Then call _slave_next once in every BiSS frame, and check wants after each
 * call.
 *
 * To answer S in time, the slave asks for a byte before it is certain that the master will read it:
 * after W and, in a sequence, after P. A register that changes when it is read must tolerate that.
 */
typedef struct cw_biss_slave {
    uint8_t readable[16]; /**< one bit per address, with address 0 in bit 0 of byte 0 */
    uint8_t writable[16]; /**< the same for writing */
    cw_biss_wants wants; /**< action that it waits for */
    uint8_t address; /**< register to which the member wants refers */
    uint8_t value;   /**< value to store there */
    uint8_t id;      /**< ID taken in the last control frame, or NO_ID */
    cw_biss_phase phase; /**< private */
    bool locked; /**< private */
    bool write; /**< private */
    bool given; /**< private */
    uint8_t current; /**< private: the register that the master accesses */
    uint8_t zeros; /**< private */
    uint8_t at; /**< private: index of the last bit received, from the S of its phase */
    uint32_t received; /**< private */
    uint32_t sending; /**< private */
} cw_biss_slave;

/** Initialise a slave. It refuses every register until you call _slave_allow. */
static inline void cw_biss_slave_init(cw_biss_slave *slave)
{
    size_t at;
    for (at = 0U; at < 16U; at++) {
        slave->readable[at] = 0U;
        slave->writable[at] = 0U;
    }
    slave->wants = CW_BISS_WANTS_NOTHING;
    slave->address = 0U;
    slave->value = 0U;
    slave->id = CW_BISS_NO_ID;
    slave->phase = CW_BISS_PHASE_WAIT;
    slave->locked = false;
    slave->write = false;
    slave->given = false;
    slave->current = 0U;
    slave->zeros = 0U;
    slave->at = 0U;
    slave->received = 0U;
    slave->sending = 0U;
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
    size_t at;
    if ((address > 0x7FU) || (count > (0x80U - (size_t)address))) {
        return CW_FAULT_RANGE;
    }
    for (at = address; at < ((size_t)address + count); at++) {
        const size_t place = at % 8U;
        const uint32_t bit = (uint32_t)1U << (uint32_t)place;
        const uint32_t readable = slave->readable[at / 8U] & (0xFFU ^ bit);
        const uint32_t writable = slave->writable[at / 8U] & (0xFFU ^ bit);
        slave->readable[at / 8U] = (uint8_t)(readable | (read ? bit : 0U));
        slave->writable[at / 8U] = (uint8_t)(writable | (write ? bit : 0U));
    }
    return CW_OK;
}

/** Give a slave the content of the register it wants. Does nothing unless it wants a byte. */
static inline void cw_biss_slave_give(cw_biss_slave *slave, uint8_t value)
{
    if (slave->wants == CW_BISS_WANTS_BYTE) {
        slave->wants = CW_BISS_WANTS_NOTHING;
        slave->given = true;
        slave->sending = cw_biss_byte_encode(value);
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
static inline bool cw_biss_slave_may(const cw_biss_slave *slave)
{
    const uint8_t *const allowed = slave->write ? slave->writable : slave->readable;
    return (((uint32_t)allowed[(slave->current & 0x7FU) / 8U] >> (slave->current % 8U)) & 1U) != 0U;
}

/** Request the byte of the current register, unless a previous write has not been stored yet. */
static inline void cw_biss_slave_fetch(cw_biss_slave *slave)
{
    if (!slave->write && !slave->given && (slave->wants == CW_BISS_WANTS_NOTHING)) {
        slave->wants = CW_BISS_WANTS_BYTE;
        slave->address = slave->current;
    }
}

/** Leave the control frame, since the rest of it does not concern this slave. */
static inline bool cw_biss_slave_leaves(cw_biss_slave *slave, bool cds)
{
    slave->phase = CW_BISS_PHASE_WAIT;
    if (slave->wants == CW_BISS_WANTS_BYTE) {
        slave->wants = CW_BISS_WANTS_NOTHING;
    }
    return cds;
}

/** Begin with the current register, after W or P: fetch its byte and wait for S. */
static inline void cw_biss_slave_awaits(cw_biss_slave *slave)
{
    slave->phase = CW_BISS_PHASE_START;
    slave->given = false;
    cw_biss_slave_fetch(slave);
}

/** Lock an ID: take the first IDL bit that no slave farther from the master has taken. */
static inline bool cw_biss_slave_lock(cw_biss_slave *slave, bool upstream)
{
    if (upstream || slave->locked || (slave->at > CW_BISS_IDS)) {
        return upstream;
    }
    slave->locked = true;
    /* IDL8 only means that there are more slaves than IDs. */
    slave->id = (slave->at < CW_BISS_IDS) ? slave->at : CW_BISS_NO_ID;
    return true;
}

/** Steps 2 and 3, after S: return the CDS bit. */
static inline bool cw_biss_slave_header(cw_biss_slave *slave, bool cdm, bool upstream)
{
    cw_biss_request request;
    slave->received = (slave->received << 1U) | (cdm ? 1U : 0U);
    slave->at++;
    if (slave->at <= 15U) {
        const bool cds = cw_biss_slave_lock(slave, upstream);
        if (slave->at < 15U) {
            return cds;
        }
        /* CTS, ID, ADR and CRC are complete. Check them as for a read, regardless of R W. */
        if (cw_biss_request_decode(
                (slave->received << 17U) | CW_BISS_READS, &request) != CW_OK) {
            return cw_biss_slave_leaves(slave, cds);
        }
        if (request.id != slave->id) {
            return cw_biss_slave_leaves(slave, cds);
        }
        slave->current = request.address;
        return cds;
    }
    if (slave->at == 16U) {
        return cdm;
    }
    slave->write = cdm;
    if (((slave->received >> 1U) & 1U) == (cdm ? 1U : 0U)) {
        /* Neither 10 nor 01: send it back as received, so that the master sees it. */
        return cw_biss_slave_leaves(slave, cdm);
    }
    if (!cw_biss_slave_may(slave)) {
        return cw_biss_slave_leaves(slave, !cdm);
    }
    cw_biss_slave_awaits(slave);
    return cdm;
}

/** Step 4: answer S once the slave is done. */
static inline bool cw_biss_slave_start(cw_biss_slave *slave, bool cdm, bool upstream)
{
    if (!cdm) {
        return cw_biss_slave_leaves(slave, upstream);
    }
    cw_biss_slave_fetch(slave);
    if (slave->wants != CW_BISS_WANTS_NOTHING) {
        return false;
    }
    slave->phase = CW_BISS_PHASE_BYTE;
    slave->at = 0U;
    slave->received = 0U;
    return true;
}

/** Steps 5 and 6: return the CDS bit of the byte, then of P. */
static inline bool cw_biss_slave_byte(cw_biss_slave *slave, bool cdm)
{
    slave->received = (slave->received << 1U) | (cdm ? 1U : 0U);
    slave->at++;
    if (slave->at > 12U) {
        const bool last = (slave->current & 0x3FU) == 0x3FU;
        slave->current = last ? slave->current : (uint8_t)(slave->current + 1U);
        if (cdm || last || !cw_biss_slave_may(slave)) {
            return cw_biss_slave_leaves(slave, true);
        }
        cw_biss_slave_awaits(slave);
        return false;
    }
    if (!slave->write) {
        return ((slave->sending >> (12U - slave->at)) & 1U) != 0U;
    }
    if (slave->at == 12U) {
        if (cw_biss_byte_decode((uint16_t)slave->received, &slave->value) != CW_OK) {
            /* CRC error: do not store it. The master sees it from the bits sent back. */
            return cw_biss_slave_leaves(slave, cdm);
        }
        slave->wants = CW_BISS_WANTS_STORE;
        slave->address = slave->current;
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
        return cw_biss_slave_leaves(slave, upstream);
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
        slave->at = 0U;
        slave->received = 0U;
        slave->id = CW_BISS_NO_ID;
        slave->locked = false;
        return cw_biss_slave_lock(slave, upstream);
    }
}

#ifdef __cplusplus
}
#endif

#endif
