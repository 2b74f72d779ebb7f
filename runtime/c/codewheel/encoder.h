/** @file
 * codewheel/encoder.h - register access, reports and order codes of encoders
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 */
#ifndef CODEWHEEL_ENCODER_H
#define CODEWHEEL_ENCODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "version.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/encoder.h 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Texts that describe a report of an encoder. A member is empty if the manual has no such text. */
typedef struct cw_report_text {
    const char *name; /**< its name in these headers */
    const char *printed_name; /**< its name in the manual */
    const char *meaning; /**< its meaning */
    const char *remedy; /**< instructions for clearing it */
    const char *source; /**< section and page of the manual */
} cw_report_text;

/** Access of a master to a register. */
typedef enum cw_access {
    CW_ACCESS_READ_ONLY = 1,
    CW_ACCESS_WRITE_ONLY = 2,
    CW_ACCESS_READ_WRITE = 3
} cw_access;

/* -- order codes ------------------------------------------------------------------------------- */

/** Return a letter a to z in uppercase, or any other character unchanged. */
static inline char cw_capital(char letter)
{
    static const char capitals[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ";
    const uint8_t place = (uint8_t)letter;
    const uint8_t first = (uint8_t)'a';
    return ((letter >= 'a') && (letter <= 'z')) ? capitals[place - first] : letter;
}

/** Return true if the character is a digit. */
static inline bool cw_is_digit(char letter)
{
    return (letter >= '0') && (letter <= '9');
}

/** Return true if the character is a letter or a digit. */
static inline bool cw_is_letter_or_digit(char letter)
{
    const char capital = cw_capital(letter);
    return cw_is_digit(letter) || ((capital >= 'A') && (capital <= 'Z'));
}

/** Return the number of spaces with which a label begins. */
static inline size_t cw_label_spaces(const char *label)
{
    size_t count = 0U;
    while (label[count] == ' ') {
        count++;
    }
    return count;
}

/**
 * Return true if this text may follow an order code on a label. It can be empty, a hyphen with any
 * text, or /S with letters and digits (a special model, which may differ from the manual).
 */
static inline bool cw_label_ends(const char *label)
{
    size_t index = cw_label_spaces(label);
    char kind;
    if ((label[index] == '\0') || (label[index] == '-')) {
        return true;
    }
    if (label[index] != '/') {
        return false;
    }
    index += 1U + cw_label_spaces(&label[index + 1U]);
    kind = cw_capital(label[index]);
    if (kind != 'S') {
        return false;
    }
    index += 1U + cw_label_spaces(&label[index + 1U]);
    if (label[index] == '\0') {
        return false;
    }
    while (cw_is_letter_or_digit(label[index])) {
        index += 1U + cw_label_spaces(&label[index + 1U]);
    }
    return label[index] == '\0';
}

/**
 * Return the number of characters at the start of a label that match an order code, or 0 if they do
 * not match. Case and spaces are ignored. In the code, # matches a digit, ~ matches a digit or
 * nothing, @ matches a letter, and % matches a letter or a digit.
 */
static inline size_t cw_label_match(const char *label, const char *code)
{
    size_t matched = 0U;
    size_t index;
    for (index = 0U; code[index] != '\0'; index++) {
        const char pattern = code[index];
        if (pattern == ' ') {
            continue;
        }
        matched += cw_label_spaces(&label[matched]);
        const char letter = label[matched];
        const bool is_digit = cw_is_digit(letter);
        const bool is_alphanumeric = cw_is_letter_or_digit(letter);
        bool fits;
        switch (pattern) {
        case '#':
        case '~':
            fits = is_digit;
            break;
        case '@':
            fits = is_alphanumeric && !is_digit;
            break;
        case '%':
            fits = is_alphanumeric;
            break;
        default:
            fits = cw_capital(letter) == cw_capital(pattern);
            break;
        }
        if (fits) {
            matched++;
        } else if (pattern != '~') {
            return 0U;
        } else {
            /* No digit: ~ allows that. */
        }
    }
    matched += cw_label_spaces(&label[matched]);
    return cw_label_ends(&label[matched]) ? matched : 0U;
}

/** A pattern for labels, the index of its order code, and the parts that it leaves open. */
typedef struct cw_open_code {
    const char *pattern; /**< order code with # ~ @ % as in cw_label_match */
    uint16_t code; /**< index of the order code, or CW_NO_CODE */
    uint16_t unlisted; /**< bits of the parts that are left open */
} cw_open_code;

/** Index that means "no such order code". */
#define CW_NO_CODE 0xFFFFU

#ifdef __cplusplus
}
#endif

#endif
