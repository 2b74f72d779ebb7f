/* Common parts of everything that libFuzzer calls: the input, read from its beginning, and the assertions. */
#ifndef FUZZ_H
#define FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static const uint8_t *input;
static size_t left;

/* Return this many bytes as a number, or as many as are left. */
static inline uint64_t take(size_t count)
{
    uint64_t value = 0U;
    while (count > 0U && left > 0U) {
        value = (value << 8U) | *input++;
        left--;
        count--;
    }
    return value;
}

static inline void require(bool holds, const char *what)
{
    if (!holds) {
        fprintf(stderr, "%s\n", what);
        abort();
    }
}

#endif
