/*
 * Fuzz target for the header of register access over BiSS: a master and a slave exchange bits over a
 * line that the input disturbs, and random words are decoded.
 */
#include "codewheel/biss_slave.h"
#include "fuzz.h"

static void words(void)
{
    const uint32_t word = take(4U);
    const uint32_t cds = take(4U);
    cw_biss_request request = { (uint8_t)take(1U), (uint8_t)take(1U), (take(1U) & 1U) != 0U, (uint8_t)take(1U) };
    uint32_t sent = 0U;
    uint8_t slaves = 0U;
    uint8_t value = 0x5AU;
    const cw_biss_outcome outcome = cw_biss_answer_decode(&request, cds, &slaves, &value);
    require(slaves <= 9U && (value == 0x5AU || (outcome == CW_BISS_DONE && !request.write)), "an answer that changes more than it says");
    (void)cw_biss_crc(word, cds);
    if (cw_biss_request_encode(&request, &sent) == CW_OK) {
        cw_biss_request back;
        require(cw_biss_request_decode(sent, &back) == CW_OK && back.id == request.id && back.address == request.address &&
            back.write == request.write && back.value == request.value, "a request that is read as something else");
    }
    if (cw_biss_request_decode(word, &request) == CW_OK) {
        require(cw_biss_request_encode(&request, &sent) == CW_OK && sent == word, "a word that is encoded as something else");
    }
}

/* The input: the request, then a byte for each frame, whose low bits disturb the line. */
static void conversation(void)
{
    cw_biss_master master;
    cw_biss_slave slave;
    uint8_t memory[128];
    const bool write = (take(1U) & 1U) != 0U;
    const uint8_t id = (uint8_t)(take(1U) & 0x09U);
    const uint8_t address = (uint8_t)take(1U);
    const size_t count = take(1U) % 70U;
    const uint16_t busy_limit = (uint16_t)(take(1U) % 8U);
    const uint32_t steps = take(2U) % 1100U;
    const bool late = (take(1U) & 1U) != 0U;
    bool waiting = false;
    uint8_t *const bytes = malloc(count + (count == 0U));
    bool disturbed = false;
    bool cds = false;
    cw_result begun;
    uint32_t frame;
    size_t at;
    for (at = 0U; at < sizeof memory; at++) {
        memory[at] = (uint8_t)(37U * at + 11U);
    }
    for (at = 0U; at < count; at++) {
        bytes[at] = (uint8_t)(91U * at + 5U);
    }
    cw_biss_master_init(&master);
    cw_biss_slave_init(&slave);
    require(cw_biss_slave_allow(&slave, 0U, 128U, true, true) == CW_OK, "all registers cannot be allowed");
    begun = write ? cw_biss_master_write(&master, id, address, bytes, count, busy_limit) : cw_biss_master_read(&master, id, address, bytes, count, busy_limit);
    for (frame = 0U; frame < steps; frame++) {
        const uint32_t noise = take(1U);
        bool cdm = waiting;
        if (late) {
            waiting = cw_biss_master_next_late(&master, cds);
        } else {
            cdm = cw_biss_master_next(&master, cds);
        }
        disturbed = disturbed || (noise & 0x1FU) != 0U;
        cdm = cdm != ((noise & 1U) != 0U);
        cds = cw_biss_slave_next(&slave, cdm, (noise & 2U) != 0U);
        cds = cds != ((noise & 4U) != 0U);
        require(slave.address < 128U, "a register that is none");
        if (slave.wants == CW_BISS_WANTS_BYTE && (noise & 8U) == 0U) {
            cw_biss_slave_give(&slave, memory[slave.address]);
        } else if (slave.wants == CW_BISS_WANTS_STORE && (noise & 8U) == 0U) {
            memory[slave.address] = slave.value;
            cw_biss_slave_stored(&slave);
        }
        if ((noise & 0x1FU) == 0x10U) {
            cw_biss_master_abort(&master);
        }
    }
    require(master.done <= count, "more bytes than were asked for");
    if (!disturbed && begun == CW_OK && steps > 47U + 14U * count) {
        require(id != 0U ? master.outcome == CW_BISS_NO_ANSWER : master.outcome == CW_BISS_DONE, "an undisturbed access that is not done");
        for (at = 0U; id == 0U && at < count; at++) {
            require(bytes[at] == memory[address + at] && bytes[at] == (uint8_t)(write ? 91U * at + 5U : 37U * (address + at) + 11U), "another byte than that of the register");
        }
    }
    free(bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    input = data;
    left = size;
    if ((take(1U) & 1U) != 0U) {
        words();
    } else {
        conversation();
    }
    return 0;
}
