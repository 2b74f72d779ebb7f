/* Prints the cycles of one call on an AVR through the serial port: those of entry() minus those of the same call to a function that only returns. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

void entry(void);
void entry_of_nothing(void);
void check(void);
void nothing(void);
extern volatile int good;

/* The arguments do not matter. */
__attribute__((naked)) void nothing(void)
{
    __asm__("ret");
}

static void say(uint16_t number)
{
    uint16_t unit;
    for (unit = 10000U; unit != 0U; unit /= 10U) {
        while ((UCSR0A & (1U << UDRE0)) == 0U) {
        }
        UDR0 = (uint8_t)('0' + (number / unit) % 10U);
    }
    UDR0 = '\n';
}

int main(void)
{
    uint16_t before;
    uint16_t nothing;
    uint16_t all;
    UCSR0B = 1U << TXEN0;
    TCCR1A = 0U;
    TCCR1B = 1U;
    before = TCNT1;
    entry_of_nothing();
    nothing = (uint16_t)(TCNT1 - before);
    before = TCNT1;
    entry();
    all = (uint16_t)(TCNT1 - before);
    check();
    /* A return takes four cycles. */
    say((good != 0) ? (uint16_t)(all - nothing + 4U) : 0U);
    cli();
    sleep_mode();
    return 0;
}
