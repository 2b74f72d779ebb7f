/** @file
 * codewheel/bits.h - bits of a frame, and differences of positions
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 */
#ifndef CODEWHEEL_BITS_H
#define CODEWHEEL_BITS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "version.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/bits.h 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif

/* With C++17, decoders and constants can be used at compile time. */
#if defined(__cplusplus) && (__cplusplus >= 201703L)
#define CW_CONSTEXPR constexpr /**< marks a function that C++17 can call at compile time */
#define CW_CONST constexpr /**< marks a constant, of use at compile time in C++17 */
#else
#define CW_CONSTEXPR /**< marks a function that C++17 can call at compile time */
#define CW_CONST const /**< marks a constant, of use at compile time in C++17 */
#endif

#ifdef __cplusplus
/** The size of an array in bytes. A pointer, or an array of another size, does not compile. */
#define CW_SIZE_OF(array, bytes) \
    (sizeof(array) + (0U * sizeof(&(array) - *static_cast<uint8_t (**)[bytes]>(nullptr))))
#else
/** The size of an array in bytes. A pointer, or an array of another size, does not compile. */
#define CW_SIZE_OF(array, bytes) \
    (sizeof(array) + (0U * sizeof(&(array) - (uint8_t (*)[bytes])&(array))))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* -- words ------------------------------------------------------------------------------------- */

/** A received word with the number of its bits, for decoders of words with several lengths. */
typedef struct cw_word {
    uint64_t value;  /**< the last bit sent is bit 0, and the bits above the word are 0 */
    uint32_t length; /**< number of bits received */
} cw_word;

#if !defined(__SDCC) /* it cannot return structures */
/** Return a word of this many bits, for a master that gives you a number. */
CW_CONSTEXPR
static inline cw_word cw_word_of(uint64_t value, uint32_t length)
{
    const cw_word word = { value, length };
    return word;
}
#endif

/* -- bits -------------------------------------------------------------------------------------- */

/** Return a mask with the lowest 0 to 64 bits set. */
CW_CONSTEXPR
static inline uint64_t cw_mask(uint32_t bits)
{
    return (bits < 64U) ? (((uint64_t)1U << bits) - 1U) : UINT64_MAX;
}

/** Return word >> low. On small processors this is faster than a plain shift. */
CW_CONSTEXPR
static inline uint64_t cw_above(uint64_t word, uint32_t low)
{
    if (low > 63U) {
        return 0U;
    }
    if (low > 31U) {
        const uint32_t upper = (uint32_t)(word >> 32U) >> (low - 32U);
        return upper;
    }
    return word >> low;
}

/** Return the field of a word that starts at bit low. */
CW_CONSTEXPR
static inline uint64_t cw_field(uint64_t word, uint32_t low, uint32_t bits)
{
    return cw_above(word, low) & cw_mask(bits);
}

/** Return the value of a two's complement number of this many bits. */
CW_CONSTEXPR
static inline int64_t cw_signed(uint64_t value, uint32_t bits)
{
    const uint64_t largest = cw_mask(bits);
    const uint64_t below = largest - value;
    return (value > (largest >> 1U)) ? (-(int64_t)below - 1) : (int64_t)value;
}

/** Return true if a number fits in this many bits in two's complement. In 0 bits, only 0 fits. */
CW_CONSTEXPR
static inline bool cw_fits_signed(int64_t value, uint32_t bits)
{
    const uint64_t half = cw_mask(bits) >> 1U;
    const int64_t most = (int64_t)half;
    const int64_t below_zero = (bits != 0U) ? (int64_t)1 : (int64_t)0;
    return (value <= most) && (value >= (-most - below_zero));
}

/** Convert the field that starts at bit low from Gray code to binary and return the word. */
CW_CONSTEXPR
static inline uint64_t cw_from_gray(uint64_t word, uint32_t low, uint32_t bits)
{
    uint64_t v = cw_field(word, low, bits);
    v ^= v >> 32U;
    v ^= v >> 16U;
    v ^= v >> 8U;
    v ^= v >> 4U;
    v ^= v >> 2U;
    v ^= v >> 1U;
    return (low < 64U) ? ((word & ~(cw_mask(bits) << low)) | (v << low)) : word;
}

/** Convert the field that starts at bit low from binary to Gray code and return the word. */
CW_CONSTEXPR
static inline uint64_t cw_to_gray(uint64_t word, uint32_t low, uint32_t bits)
{
    const uint64_t v = cw_field(word, low, bits);
    return (low < 64U) ? (word ^ ((v >> 1U) << low)) : word;
}

/** Return the word with another number in a field. Bits of value that do not fit are cut off. */
CW_CONSTEXPR
static inline uint64_t cw_with_field(uint64_t word, uint32_t low, uint32_t bits, uint64_t value)
{
    const uint64_t mask = cw_mask(bits);
    return (low < 64U) ? ((word & ~(mask << low)) | ((value & mask) << low)) : word;
}

/** Convert the field that starts at bit low from Gray excess to binary, which is less by excess. */
CW_CONSTEXPR
static inline uint64_t cw_from_gray_excess(
    uint64_t word, uint32_t low, uint32_t bits, uint64_t excess)
{
    const uint64_t sum = cw_from_gray(word, low, bits);
    return cw_with_field(sum, low, bits, cw_field(sum, low, bits) - excess);
}

/** Convert the field that starts at bit low from binary to Gray excess, with excess added. */
CW_CONSTEXPR
static inline uint64_t cw_to_gray_excess(
    uint64_t word, uint32_t low, uint32_t bits, uint64_t excess)
{
    const uint64_t sum = cw_field(word, low, bits) + excess;
    return cw_to_gray(cw_with_field(word, low, bits, sum), low, bits);
}

/** Return true if 64 bits have room for a field of bits bits, and for the codes of base digits. */
CW_CONSTEXPR
static inline bool cw_digits_fit(uint32_t bits, uint32_t digit_bits, uint32_t base)
{
    return (bits <= 64U) && (digit_bits != 0U) && (base != 0U) && (base <= (64U / digit_bits));
}

/**
 * Return the digit with this code, or base if there is none. The lowest bits of codes are the code
 * of digit 0.
 */
CW_CONSTEXPR
static inline uint32_t cw_digit(uint64_t code, uint32_t digit_bits, uint32_t base, uint64_t codes)
{
    uint32_t digit = cw_digits_fit(0U, digit_bits, base) ? 0U : base;
    while ((digit < base) && (cw_field(codes, digit * digit_bits, digit_bits) != code)) {
        digit++;
    }
    return digit;
}

/**
 * Convert the field that starts at bit low from separate digits to a number and return the word.
 *
 * If the bits of a digit are the code of no digit, all bits of the field are then 1, which is above
 * the highest number.
 */
CW_CONSTEXPR
static inline uint64_t cw_from_digits(
    uint64_t word, uint32_t low, uint32_t bits, uint32_t digit_bits, uint32_t base, uint64_t codes)
{
    const uint64_t digits = cw_field(word, low, bits);
    uint64_t number = 0U;
    uint64_t weight = 1U;
    if (!cw_digits_fit(bits, digit_bits, base)) {
        return word;
    }
    for (uint32_t place = 0U; place < bits; place += digit_bits) {
        const uint64_t code = cw_field(digits, place, digit_bits);
        const uint32_t digit = cw_digit(code, digit_bits, base, codes);
        if (digit == base) {
            number = cw_mask(bits);
            break;
        }
        number += digit * weight;
        weight *= base;
    }
    return cw_with_field(word, low, bits, number);
}

/**
 * Convert the field at bit low from a number to separate digits and return the word.
 *
 * Weights are subtracted, because some compilers do not support 64-bit division.
 */
CW_CONSTEXPR
static inline uint64_t cw_to_digits(
    uint64_t word, uint32_t low, uint32_t bits, uint32_t digit_bits, uint32_t base, uint64_t codes)
{
    uint64_t number = cw_field(word, low, bits);
    uint64_t digits = 0U;
    if (!cw_digits_fit(bits, digit_bits, base)) {
        return word;
    }
    /* The highest digit can have fewer bits. */
    const uint32_t count = ((bits + digit_bits) - 1U) / digit_bits;
    for (uint32_t digits_left = count; digits_left > 0U; digits_left--) {
        uint64_t weight = 1U;
        uint32_t digit = 0U;
        for (uint32_t lower = 1U; lower < digits_left; lower++) {
            weight *= base;
        }
        while (((digit + 1U) < base) && (number >= weight)) {
            number -= weight;
            digit++;
        }
        const uint32_t place = (digits_left - 1U) * digit_bits;
        digits |= cw_field(codes, digit * digit_bits, digit_bits) << place;
    }
    return cw_with_field(word, low, bits, digits);
}

/** Return 1 if the number of 1 bits is odd, 0 if it is even. */
CW_CONSTEXPR
static inline uint32_t cw_parity(uint32_t value)
{
    uint32_t v = value;
    v ^= v >> 16U;
    v ^= v >> 8U;
    v ^= v >> 4U;
    return (0x6996U >> (v & 0x0FU)) & 1U; /* bit n of 6996h is the parity of n */
}

/** Return 1 if the number of 1 bits is odd, 0 if it is even, for numbers of up to 64 bits. */
CW_CONSTEXPR
static inline uint32_t cw_parity_64(uint64_t value)
{
    return cw_parity((uint32_t)value ^ (uint32_t)(value >> 32U));
}

/** Return the parity of the even-numbered bits in bit 0, and of the odd-numbered bits in bit 1. */
CW_CONSTEXPR
static inline uint32_t cw_parities(uint32_t value)
{
    uint32_t v = value;
    v ^= v >> 16U;
    v ^= v >> 8U;
    v ^= v >> 4U;
    v ^= v >> 2U;
    return v & 3U;
}

/* -- positions --------------------------------------------------------------------------------- */

/**
 * Return the distance that a position has moved, taking the shorter way around.
 *
 * @param now  the new position
 * @param before  the earlier position
 * @param modulus  counts after which the position wraps around to 0
 * @return the distance, from -modulus / 2 to below modulus / 2, or 0 if modulus is 0
 */
CW_CONSTEXPR
static inline int64_t cw_difference(uint64_t now, uint64_t before, uint64_t modulus)
{
    if (modulus == 0U) {
        return 0;
    }
    const uint64_t start = before % modulus;
    uint64_t forward = now % modulus;
    if (forward < start) {
        forward += modulus - start;
    } else {
        forward -= start;
    }
    const uint64_t backward = modulus - forward;
    return (forward < backward) ? (int64_t)forward : -(int64_t)backward;
}

#ifdef __cplusplus
}
#endif

#endif
