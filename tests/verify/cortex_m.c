/*
 * The smallest start-up code of a Cortex-M under QEMU, with input and output by semihosting: the
 * debugger calls of Arm's "Semihosting for AArch32 and AArch64". The program comes before this text,
 * as work(). The last functions are those that newlib's stdio needs.
 */
extern uint32_t stack_top;
extern uint32_t data_start, data_end, data_image, bss_start, bss_end;

static uint32_t semihosting(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static uint32_t opened(uint32_t mode)
{
    const struct { const char *name; uint32_t mode; uint32_t length; } file = { ":tt", mode, 3U };
    return semihosting(0x01U, &file);
}

/* Read or write this many bytes of a file, and return how many were left. */
static size_t moved(uint32_t operation, uint32_t file, const void *bytes, size_t count)
{
    const struct { uint32_t file; const void *bytes; uint32_t count; } block = { file, bytes, count };
    return semihosting(operation, &block);
}

static uint32_t input;
static uint32_t output;
static uint8_t read_ahead[512];
static size_t ready;
static size_t taken;

static size_t feed(uint8_t *to, size_t count)
{
    size_t done;
    for (done = 0U; done < count; done++) {
        if (taken == ready) {
            taken = 0U;
            ready = sizeof read_ahead - moved(0x06U, input, read_ahead, sizeof read_ahead);
            if (ready == 0U) {
                break;
            }
        }
        to[done] = read_ahead[taken++];
    }
    return done;
}

static void emit(const uint8_t *from, size_t count)
{
    (void)moved(0x05U, output, from, count);
}

/* Stop the machine: 0x20026 is the end of a program, and 0x20023 an error while it ran. */
static __attribute__((noreturn)) void leave(bool well)
{
    (void)semihosting(0x18U, (const void *)(well ? 0x20026U : 0x20023U));
    for (;;) {
    }
}

static void fault(void)
{
    leave(false);
}

void reset(void);
void reset(void)
{
    uint32_t *to;
    const uint32_t *from = &data_image;
    for (to = &data_start; to < &data_end; to++) {
        *to = *from++;
    }
    for (to = &bss_start; to < &bss_end; to++) {
        *to = 0U;
    }
    input = opened(1U);
    output = opened(5U);
    leave(work() == 0);
}

int _read(int file, char *to, int count);
int _read(int file, char *to, int count)
{
    (void)file;
    return (int)feed((uint8_t *)to, (size_t)count);
}

int _write(int file, const char *from, int count);
int _write(int file, const char *from, int count)
{
    (void)file;
    emit((const uint8_t *)from, (size_t)count);
    return count;
}

void _exit(int status);
void _exit(int status)
{
    leave(status == 0);
}

__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    &stack_top, (const void *)reset, (const void *)fault, (const void *)fault, (const void *)fault, (const void *)fault, (const void *)fault
};
