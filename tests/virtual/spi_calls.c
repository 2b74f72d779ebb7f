/* Carries out lists of steps and prints each call, with only the headers of the runtime. The first argument is the name
 * of a list. With another one, the runner carries it out, otherwise cw_run(). The last line is the result. */
#include <stdio.h>
#include <string.h>

#include "codewheel/runner.h"

#include "spi_list.h"

#define MOST 16U

static void call(const char *name, uint16_t address, const uint8_t *bytes, size_t length)
{
    size_t index;
    printf("%s %02X:", name, (unsigned)address);
    for (index = 0U; index < length; index++) {
        printf(" %02X", (unsigned)bytes[index]);
    }
    printf("\n");
}

/* MOD_3 of a TLE5012B holds 760h in bits 15 to 4 after it was written. */
static uint8_t memory[2] = { 0xFEU, 0x70U };

static int32_t read_register(void *context, uint16_t address, uint8_t *bytes, size_t length)
{
    size_t index;
    (void)context;
    for (index = 0U; index < length; index++) {
        bytes[index] = memory[index % sizeof(memory)];
    }
    call("read", address, bytes, length);
    return 0;
}

static int32_t write_register(void *context, uint16_t address, const uint8_t *bytes, size_t length)
{
    size_t index;
    (void)context;
    for (index = 0U; index < length; index++) {
        memory[index % sizeof(memory)] = bytes[index];
    }
    call("write", address, bytes, length);
    return 0;
}

static int32_t wait_us(void *context, uint32_t microseconds)
{
    (void)context;
    printf("wait %u\n", (unsigned)microseconds);
    return 0;
}

static size_t listed(const char *name, cw_step *steps)
{
    size_t count = 0U;
    size_t index;
    const size_t longest = 8U;
    if (strcmp(name, "set zero") == 0) {
        return set_zero_steps(steps, MOST);
    }
    if (strcmp(name, "neighbours") == 0) {
        steps[count++] = cw_step_read(0x10U);
        steps[count++] = cw_step_read(0x11U);
    } else if (strcmp(name, "neighbours on their own") == 0) {
        steps[count++] = cw_step_read_one(0x10U);
        steps[count++] = cw_step_read_one(0x11U);
    } else if (strcmp(name, "one of them on its own") == 0) {
        steps[count++] = cw_step_read(0x10U);
        steps[count++] = cw_step_read_one(0x11U);
        steps[count++] = cw_step_read(0x12U);
    } else if (strcmp(name, "a longer neighbour") == 0) {
        steps[count++] = cw_step_read(0x10U);
        steps[count++] = cw_step_read(0x11U);
        steps[count++] = cw_step_more(0x11U, 0xFFU, 0U);
        steps[count++] = cw_step_read(0x13U);
    } else if (strcmp(name, "further bytes of nothing") == 0) {
        steps[count++] = cw_step_more(0x10U, 0xFFU, 1U);
        steps[count++] = cw_step_write(0x10U, 0xFFU, 2U);
    } else if (strcmp(name, "further bytes of a wait") == 0) {
        steps[count++] = cw_step_write(0x10U, 0xFFU, 1U);
        steps[count++] = cw_step_wait(5U);
        steps[count++] = cw_step_more(0x10U, 0xFFU, 2U);
    } else if (strcmp(name, "further bytes of a request") == 0) {
        steps[count++] = cw_step_write(0x10U, 0xFFU, 1U);
        steps[count++] = cw_step_send(0x5AU, 1U, 0U, 0U, 0U);
        steps[count++] = cw_step_more(0x10U, 0xFFU, 2U);
    } else if ((strcmp(name, "8 bytes") == 0) || (strcmp(name, "9 bytes") == 0)) {
        steps[count++] = cw_step_write(0x10U, 0xFFU, 0U);
        for (index = 1U; index < (longest + ((name[0] == '9') ? 1U : 0U)); index++) {
            steps[count++] = cw_step_more(0x10U, 0xFFU, (uint8_t)index);
        }
    } else {
        /* none */
    }
    return count;
}

static size_t reads(const cw_step *steps, size_t count)
{
    cw_step_kind kind = CW_STEP_WAIT;
    size_t found = 0U;
    size_t index;
    for (index = 0U; index < count; index++) {
        kind = (steps[index].kind == CW_STEP_MORE) ? kind : steps[index].kind;
        found += (kind == CW_STEP_READ) ? 1U : 0U;
    }
    return found;
}

static cw_result step_by_step(const cw_step *steps, size_t count, uint8_t *bytes, size_t length)
{
    cw_runner runner;
    cw_todo todo;
    if (cw_runner_start(&runner, steps, count, bytes, length, 0U) != CW_OK) {
        return runner.result;
    }
    while ((todo = cw_runner_next(&runner, 0U)) != CW_TODO_END) {
        const int32_t error = (todo == CW_TODO_READ) ? read_register(NULL, runner.address, runner.data, runner.length)
                                                     : write_register(NULL, runner.address, runner.data, runner.length);
        cw_runner_done(&runner, error, 0U);
    }
    return runner.result;
}

int main(int count, char **arguments)
{
    const cw_transport transport = { NULL, read_register, write_register, wait_us, NULL, 0U, 0U };
    cw_step steps[MOST];
    uint8_t bytes[MOST];
    const size_t length = listed(arguments[1], steps);
    const size_t room = reads(steps, length);
    const cw_result result = (count > 2) ? step_by_step(steps, length, bytes, room)
                                         : cw_run(&transport, steps, length, bytes, room, NULL);
    call("bytes", 0U, bytes, (result == CW_OK) ? room : 0U);
    printf("%d\n", (int)result);
    return 0;
}
