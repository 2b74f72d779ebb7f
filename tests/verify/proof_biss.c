/*
 * Claims about register access over BiSS for the model checker CBMC. The possible states of a machine
 * are defined once, in _can_be. Each function is then proved to lead from such a state to another one,
 * for any bits on the line, without undefined behaviour. This covers any number of frames.
 */
#include "codewheel/biss_slave.h"

int nondet_int(void);
uint8_t nondet_byte(void);
uint16_t nondet_half(void);
uint32_t nondet_word(void);
size_t nondet_size(void);

static uint8_t into[CW_BISS_REGISTERS];
static const uint8_t from[CW_BISS_REGISTERS];

static bool either(void)
{
    return nondet_int() > 0;
}

static bool master_can_be(const cw_biss_master *master)
{
    const bool running = master->outcome == CW_BISS_RUNNING;
    const bool at_p = (master->phase == CW_BISS_PHASE_BYTE) && (master->bit_index == 12U);
    if (((unsigned)master->phase > 3U) || ((unsigned)master->outcome > 8U) || (master->zeros > CW_BISS_ZEROS)) {
        return false;
    }
    if (!running) {
        return master->phase == CW_BISS_PHASE_WAIT;
    }
    if ((master->request.id > 7U) || (master->done >= master->count) || (master->count > CW_BISS_REGISTERS)) {
        return false;
    }
    /* The remaining registers do not extend past 7Fh. While P is sent, the byte before it counts as done. */
    if ((master->request.address + (master->count - master->done) + (at_p ? 1 : 0)) > 0x80) {
        return false;
    }
    if (master->request.write ? (master->write_bytes != from) : (master->read_bytes != into)) {
        return false;
    }
    switch (master->phase) {
    case CW_BISS_PHASE_HEADER:
        return master->bit_index <= 17U;
    case CW_BISS_PHASE_START:
        return master->busy_frames <= master->busy_limit;
    case CW_BISS_PHASE_BYTE:
        return at_p || ((master->bit_index < 12U) && ((master->responses >> master->bit_index) == 0U));
    default:
        return master->bit_index == 0U;
    }
}

void one_more_bit_of_a_master(void)
{
    cw_biss_master master;
    master.outcome = (cw_biss_outcome)nondet_int();
    master.phase = (cw_biss_phase)nondet_int();
    master.request.write = either();
    __CPROVER_assume(master_can_be(&master));
    (void)cw_biss_master_next(&master, either());
    __CPROVER_assert(master_can_be(&master), "a master stays what it can be");
    cw_biss_master_abort(&master);
    __CPROVER_assert(master_can_be(&master) && (master.outcome != CW_BISS_RUNNING), "and can be given up");
}

/* The same for the machine whose bit is one frame late, which counts S and the bits after it differently. */
static bool late_master_can_be(const cw_biss_master *master)
{
    if (((unsigned)master->phase > 3U) || ((unsigned)master->outcome > 8U) || (master->zeros > CW_BISS_ZEROS)) {
        return false;
    }
    if (master->outcome != CW_BISS_RUNNING) {
        return master->phase == CW_BISS_PHASE_WAIT;
    }
    if ((master->request.id > 7U) || (master->done >= master->count) || (master->count > CW_BISS_REGISTERS)) {
        return false;
    }
    if ((master->request.address + (master->count - master->done)) > 0x80) {
        return false;
    }
    if (master->request.write ? ((master->write_bytes != from) || master->repeats_start) : (master->read_bytes != into)) {
        return false;
    }
    switch (master->phase) {
    case CW_BISS_PHASE_HEADER:
        return (master->bit_index <= 18U) && ((master->responses >> master->bit_index) == 0U);
    case CW_BISS_PHASE_BYTE:
        return (master->bit_index <= 12U) && ((master->responses >> master->bit_index) == 0U);
    default:
        return true;
    }
}

void one_more_bit_of_a_late_master(void)
{
    cw_biss_master master;
    uint8_t done;
    master.outcome = (cw_biss_outcome)nondet_int();
    master.phase = (cw_biss_phase)nondet_int();
    master.request.write = either();
    master.repeats_start = either();
    __CPROVER_assume(late_master_can_be(&master));
    done = master.done;
    (void)cw_biss_master_next_late(&master, either());
    __CPROVER_assert(late_master_can_be(&master), "a late master stays what it can be");
    __CPROVER_assert((master.done == done) || (master.done == (uint8_t)(done + 1U)), "a register is done once");
    cw_biss_master_abort(&master);
    __CPROVER_assert(late_master_can_be(&master) && (master.outcome != CW_BISS_RUNNING), "and can be given up");
}

void a_master_begins(void)
{
    cw_biss_master master;
    const uint8_t id = nondet_byte();
    const uint8_t address = nondet_byte();
    const size_t count = nondet_size();
    const bool fits = (id < 8U) && (address < 0x80U) && (count > 0U) && (count <= (size_t)(0x40U - (address % 0x40U)));
    cw_result result;
    cw_biss_master_init(&master);
    __CPROVER_assert(master_can_be(&master) && late_master_can_be(&master), "a master that is new");
    master.zeros = nondet_byte();
    __CPROVER_assume(master_can_be(&master));
    if (either()) {
        result = cw_biss_master_read(&master, id, address, into, count, nondet_half());
    } else {
        result = cw_biss_master_write(&master, id, address, from, count, nondet_half());
    }
    __CPROVER_assert(result == (fits ? CW_OK : CW_FAULT_RANGE), "what runs past the end is refused, and nothing else");
    __CPROVER_assert((!fits || late_master_can_be(&master)) && master_can_be(&master) && (fits == (master.outcome == CW_BISS_RUNNING)), "nothing begins that is refused");
}

static bool slave_can_be(const cw_biss_slave *slave)
{
    if (((unsigned)slave->phase > 3U) || ((unsigned)slave->wants > 2U) || (slave->zeros > CW_BISS_ZEROS) || (slave->current_address > 0x7FU)) {
        return false;
    }
    switch (slave->phase) {
    case CW_BISS_PHASE_HEADER:
        return (slave->bit_index <= 16U) && ((slave->received_bits >> slave->bit_index) == 0U);
    case CW_BISS_PHASE_BYTE:
        return (slave->bit_index <= 12U) && ((slave->received_bits >> slave->bit_index) == 0U);
    default:
        return true;
    }
}

void one_more_bit_of_a_slave(void)
{
    cw_biss_slave slave;
    cw_biss_wants before;
    slave.wants = (cw_biss_wants)nondet_int();
    slave.phase = (cw_biss_phase)nondet_int();
    slave.locked = either();
    slave.write = either();
    slave.is_byte_ready = either();
    __CPROVER_assume(slave_can_be(&slave));
    before = slave.wants;
    (void)cw_biss_slave_next(&slave, either(), either());
    __CPROVER_assert(slave_can_be(&slave), "a slave stays what it can be");
    if ((before == CW_BISS_WANTS_NOTHING) && (slave.wants == CW_BISS_WANTS_STORE)) {
        const uint32_t bits = ((uint32_t)slave.value << 4U) | cw_biss_crc(slave.value, 8U);
        __CPROVER_assert((slave.received_bits == bits) && (slave.address == slave.current_address), "only a byte whose CRC fits is stored");
    }
    if (either()) {
        cw_biss_slave_give(&slave, nondet_byte());
    } else {
        cw_biss_slave_stored(&slave);
    }
    __CPROVER_assert(slave_can_be(&slave), "and when it has what it wants");
}

void a_slave_begins(void)
{
    cw_biss_slave slave;
    cw_biss_slave_init(&slave);
    __CPROVER_assert(slave_can_be(&slave), "a slave that is new");
    slave.current_address = nondet_byte();
    __CPROVER_assume(slave.current_address < 0x80U);
    slave.write = either();
    __CPROVER_assert(!cw_biss_slave_is_allowed(&slave), "refuses every register");
}

void words(void)
{
    cw_biss_request request;
    cw_biss_request again;
    const uint32_t word = nondet_word();
    uint32_t made;
    uint8_t slaves;
    uint8_t value = 0x5AU;
    cw_biss_outcome outcome;
    if (cw_biss_request_decode(word, &request) == CW_OK) {
        __CPROVER_assert((cw_biss_request_encode(&request, &made) == CW_OK) && (made == word), "a word that is a request is made by it");
    }
    request.id = nondet_byte();
    request.address = nondet_byte();
    request.write = either();
    request.value = nondet_byte();
    if (cw_biss_request_encode(&request, &made) == CW_OK) {
        __CPROVER_assert(cw_biss_request_decode(made, &again) == CW_OK, "a request is a word");
        __CPROVER_assert(
            (again.id == request.id) && (again.address == request.address) && (again.write == request.write) && (again.value == request.value),
            "and comes back from it");
    }
    outcome = cw_biss_answer_decode(&request, nondet_word(), &slaves, &value);
    __CPROVER_assert(slaves <= 9U, "slaves are counted up to 9");
    __CPROVER_assert((value == 0x5AU) || ((outcome == CW_BISS_DONE) && !request.write), "no other answer has a value");
}
