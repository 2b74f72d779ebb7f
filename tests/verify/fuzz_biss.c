/*
 * What libFuzzer calls for the header of register access over BiSS: a master and a slave that talk
 * to each other over a line that the input disturbs, and words at random.
 */
#include "@maker@/biss.h"
#include "fuzz.h"

static void words(void)
{
    const uint32_t word = take(4U);
    const uint32_t cds = take(4U);
    @maker@_biss_request request = { (uint8_t)take(1U), (uint8_t)take(1U), (take(1U) & 1U) != 0U, (uint8_t)take(1U) };
    uint32_t sent = 0U;
    uint8_t slaves = 0U;
    uint8_t value = 0x5AU;
    const @maker@_biss_outcome outcome = @maker@_biss_answer_decode(&request, cds, &slaves, &value);
    require(slaves <= 9U && (value == 0x5AU || (outcome == @MAKER@_BISS_DONE && !request.write)), "an answer that changes more than it says");
    (void)@maker@_biss_crc(word, cds);
    if (@maker@_biss_request_encode(&request, &sent) == @MAKER@_OK) {
        @maker@_biss_request back;
        require(@maker@_biss_request_decode(sent, &back) == @MAKER@_OK && back.id == request.id && back.address == request.address &&
            back.write == request.write && back.value == request.value, "a request that is read as something else");
    }
    if (@maker@_biss_request_decode(word, &request) == @MAKER@_OK) {
        require(@maker@_biss_request_encode(&request, &sent) == @MAKER@_OK && sent == word, "a word that is encoded as something else");
    }
}

/* The input: what is asked for, then a byte for each frame, whose low bits disturb the line. */
static void conversation(void)
{
    @maker@_biss_master master;
    @maker@_biss_slave slave;
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
    @maker@_result begun;
    uint32_t frame;
    size_t at;
    for (at = 0U; at < sizeof memory; at++) {
        memory[at] = (uint8_t)(37U * at + 11U);
    }
    for (at = 0U; at < count; at++) {
        bytes[at] = (uint8_t)(91U * at + 5U);
    }
    @maker@_biss_master_init(&master);
    @maker@_biss_slave_init(&slave);
    require(@maker@_biss_slave_allow(&slave, 0U, 128U, true, true) == @MAKER@_OK, "all registers cannot be allowed");
    begun = write ? @maker@_biss_master_write(&master, id, address, bytes, count, busy_limit) : @maker@_biss_master_read(&master, id, address, bytes, count, busy_limit);
    for (frame = 0U; frame < steps; frame++) {
        const uint32_t noise = take(1U);
        bool cdm = waiting;
        if (late) {
            waiting = @maker@_biss_master_next_late(&master, cds);
        } else {
            cdm = @maker@_biss_master_next(&master, cds);
        }
        disturbed = disturbed || (noise & 0x1FU) != 0U;
        cdm = cdm != ((noise & 1U) != 0U);
        cds = @maker@_biss_slave_next(&slave, cdm, (noise & 2U) != 0U);
        cds = cds != ((noise & 4U) != 0U);
        require(slave.address < 128U, "a register that is none");
        if (slave.wants == @MAKER@_BISS_WANTS_BYTE && (noise & 8U) == 0U) {
            @maker@_biss_slave_give(&slave, memory[slave.address]);
        } else if (slave.wants == @MAKER@_BISS_WANTS_STORE && (noise & 8U) == 0U) {
            memory[slave.address] = slave.value;
            @maker@_biss_slave_stored(&slave);
        }
        if ((noise & 0x1FU) == 0x10U) {
            @maker@_biss_master_abort(&master);
        }
    }
    require(master.done <= count, "more bytes than were asked for");
    if (!disturbed && begun == @MAKER@_OK && steps > 47U + 14U * count) {
        require(id != 0U ? master.outcome == @MAKER@_BISS_NO_ANSWER : master.outcome == @MAKER@_BISS_DONE, "an undisturbed access that is not done");
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
