"""Proofs of the code that all decoders share: bit functions of the shared header, and CRC functions of the devices."""

from __future__ import annotations

from collections.abc import Iterable

from c_harness import included
from codewheel.model import Crc, Device
from codewheel.targets.c.device import DeviceView
from proof import PRELUDE, UNDEFINED, Header, Proof
from proof_reference import shift_in, shifted_out

#: Functions of bits.h that are proved here, with arguments that obey their comments.
FUNCTIONS = ("mask", "field", "signed", "fits_signed", "from_gray", "to_gray", "parity", "parities", "difference")
FUNCTIONS += ("with_field", "from_gray_excess", "to_gray_excess", "digit", "from_digits", "to_digits")
#: The longest run of bytes over which a CRC is proved.
BYTES = 12
#: Number of powers of two in one proof of a difference.
POWERS = 8

_BITS = """\
typedef __int128 wide;
/* Gray code of a number: each bit is the sum of the bit and the one above it.
   As that gives back every word, the other way is its inverse. */
static unsigned long long in_gray(unsigned long long plain, unsigned low, unsigned bits)
{
    unsigned long long gray = plain;
    for (int i = 0; i < 63; i++)
        if (i >= low && i + 1 < low + bits) gray ^= ((plain >> (i + 1)) & 1) << i;
    return gray;
}
void to_gray(void)
{
    unsigned long long word = nondet_word();
    unsigned low = nondet_byte(), bits = nondet_byte();
    __CPROVER_assume(low + bits <= 64);
    __CPROVER_assert(cw_to_gray(word, low, bits) == in_gray(word, low, bits),
        "each bit is the sum of it and the one above");
}
void from_gray(void)
{
    unsigned long long word = nondet_word();
    unsigned low = nondet_byte(), bits = nondet_byte();
    __CPROVER_assume(low + bits <= 64);
    __CPROVER_assert(in_gray(cw_from_gray(word, low, bits), low, bits) == word,
        "the number of which this is the Gray code");
}
/* The excess is added to and subtracted from the field alone, modulo the numbers that fit into it. */
void gray_excess(void)
{
    unsigned long long word = nondet_word(), excess = nondet_word();
    unsigned low = nondet_byte(), bits = nondet_byte();
    __CPROVER_assume(low + bits <= 64 && bits >= 1);
    unsigned long long ones = (unsigned long long)(((wide)1 << bits) - 1);
    unsigned long long plain = cw_from_gray(word, low, bits), less = cw_from_gray_excess(word, low, bits, excess);
    __CPROVER_assert((less & ~(ones << low)) == (word & ~(ones << low)), "other bits are as they were");
    __CPROVER_assert((((less >> low) + excess) & ones) == ((plain >> low) & ones), "the number less the excess");
    __CPROVER_assert(cw_to_gray_excess(less, low, bits, excess) == word, "the inverse");
}
/* In BCD, the number of up to two digits is the sum of the digits by their weights, unless one of them is above 9. */
void digits(void)
{
    unsigned long long word = nondet_word(), number = 0, weight = 1;
    unsigned low = nondet_byte(), bits = nondet_byte();
    _Bool is_valid = 1;
    __CPROVER_assume(low + bits <= 64 && bits >= 1 && bits <= 8);
    unsigned long long ones = (1ULL << bits) - 1;
    for (unsigned place = 0; place < 8; place += 4) {
        unsigned digit = place < bits ? (unsigned)(((word >> low) & ones) >> place) & 15U : 0U;
        is_valid = is_valid && digit <= 9;
        number += digit * weight;
        weight *= 10;
    }
    unsigned long long converted = cw_from_digits(word, low, bits, 4, 10, 0x9876543210);
    __CPROVER_assert((converted & ~(ones << low)) == (word & ~(ones << low)), "other bits are as they were");
    __CPROVER_assert(((converted >> low) & ones) == (is_valid ? number : ones), "the number, or all ones");
    __CPROVER_assert(!is_valid || cw_to_digits(converted, low, bits, 4, 10, 0x9876543210) == word, "the inverse");
}
void numbers(void)
{
    unsigned long long word = nondet_word();
    unsigned low = nondet_byte(), bits = nondet_byte();
    __CPROVER_assume(bits <= 64);
    __CPROVER_assert(cw_mask(bits) == (unsigned long long)(((wide)1 << bits) - 1), "so many ones");
    __CPROVER_assert(cw_field(word, low, bits)
        == (low < 64 ? (unsigned long long)((wide)(word >> low) & (((wide)1 << bits) - 1)) : 0), "the field");
    long long number = nondet_number();
    __CPROVER_assert(cw_fits_signed(number, 0) == (number == 0), "only 0 fits in no bits");
    __CPROVER_assume(bits >= 1);
    __CPROVER_assert(cw_fits_signed(number, bits)
        == (number >= -((wide)1 << (bits - 1)) && number < ((wide)1 << (bits - 1))), "fits");
    __CPROVER_assume((wide)word < ((wide)1 << bits));
    __CPROVER_assert(cw_signed(word, bits) == ((word >> (bits - 1)) & 1 ? (wide)word - ((wide)1 << bits) : (wide)word),
        "two's complement");
}
void parity(void)
{
    unsigned value = (unsigned)nondet_word(), parities[2] = { 0, 0 };
    for (int i = 0; i < 32; i++) parities[i % 2] ^= (value >> i) & 1;
    __CPROVER_assert(cw_parity(value) == (parities[0] ^ parities[1]), "1 where the number of ones is odd");
    unsigned long long word = nondet_word();
    unsigned parity = 0;
    for (int i = 0; i < 64; i++) parity ^= (unsigned)(word >> i) & 1;
    __CPROVER_assert(cw_parity_64(word) == parity, "the same for 64 bits");
    __CPROVER_assert(cw_parities(value) == (parities[0] | (parities[1] << 1)), "that of even bits and of odd bits");
}
#ifdef POWER
/* Some of the powers of two; other numbers of 64 bits are too hard to divide by. */
void difference(void)
{
    for (unsigned power = POWER; power < POWER + @powers@; power++) {
        unsigned long long modulus = 1ULL << power, now = nondet_word(), before = nondet_word();
        long long moved = cw_difference(now, before, modulus);
        __CPROVER_assert(((now - before - (unsigned long long)moved) & (modulus - 1)) == 0, "from before to now");
        __CPROVER_assert((wide)2 * moved < (wide)modulus && (wide)2 * moved >= -(wide)modulus,
            "the shorter way, half way round backwards");
    }
}
#endif
void difference_without_modulus(void)
{
    __CPROVER_assert(cw_difference(nondet_word(), nondet_word(), 0) == 0, "does not move");
}
void difference_of_bytes(void)
{
    unsigned char modulus = nondet_byte(), now = nondet_byte(), before = nondet_byte();
    __CPROVER_assume(now < modulus && before < modulus);
    int moved = (int)cw_difference(now, before, modulus), ahead = now - before;
    __CPROVER_assert(moved == ahead || moved == ahead + modulus || moved == ahead - modulus, "from before to now");
    __CPROVER_assert(2 * moved < modulus && 2 * moved >= -modulus, "the shorter way, half way round backwards");
}
void difference_of_anything(void) { (void)cw_difference(nondet_word(), nondet_word(), nondet_word()); }
"""


def shared_proofs() -> Iterable[Proof]:
    text = f'#include "codewheel/bits.h"\n{PRELUDE}' + _BITS.replace("@powers@", str(POWERS))
    for function in (
        "to_gray",
        "from_gray",
        "gray_excess",
        "digits",
        "numbers",
        "parity",
        "difference_without_modulus",
        "difference_of_bytes",
        "difference_of_anything",
    ):
        rounds = 66
        options = tuple(UNDEFINED)
        if function == "digits":
            # There are at most two digits, and each is one of ten codes.
            rounds = 12
            options += ("--unwindset", "cw_from_digits.0:3,cw_to_digits.0:3,cw_to_digits.2:3")
        yield Proof(f"cw {function}", harness=text, function=function, unwind=rounds, options=options)
    for power in range(0, 64, POWERS):
        options = (f"-DPOWER={power}", *UNDEFINED)
        yield Proof(f"cw difference by 2^{power} and on", harness=text, function="difference", options=options)


def crc_proofs(device: Device, header: Header) -> Iterable[Proof]:
    """Prove the CRC functions of a device against the shift register of the definition, for every length."""
    prefix = DeviceView(device).prefix
    for crc in device.crcs:
        for function in header.functions.values():
            if function.name.removeprefix(f"{prefix}_crc_") not in (crc.name, f"{crc.name}_bits", f"{crc.name}_bytes"):
                continue
            kinds = [kind for kind, _ in function.arguments]
            text = f"{included(device)}{PRELUDE}" + _crc(crc, function.name, kinds)
            name, rounds = f"{function.name} of every input", 8 * BYTES + 2
            yield Proof(name, harness=text, function="crc", unwind=rounds, options=tuple(UNDEFINED))
            if crc.is_xor:
                # The form for processors that load words from any address.
                options = ("-D__ARM_FEATURE_UNALIGNED", *UNDEFINED)
                yield Proof(f"{name} in words", harness=text, function="crc", unwind=rounds, options=options)


def _crc(crc: Crc, name: str, kinds: list[str]) -> str:
    if kinds == ["const uint8_t *", "size_t"]:
        data_setup = f"uint8_t data[{BYTES}]; for (int i = 0; i < {BYTES}; i++) data[i] = nondet_byte();"
        data_setup += f" size_t length = nondet_size(); __CPROVER_assume(length <= {BYTES});"
        call, rounds, before = f"{name}(data, length)", 8 * BYTES, "i / 8 < length"
        bit = f"(data[i / 8] >> ({'i % 8' if crc.refin else '7 - i % 8'})) & 1"
    else:
        assert kinds == ["uint64_t"], f"{name}: a CRC function of {kinds} has no proof yet"
        assert crc.init == 0, f"{name}: a CRC function of {kinds} has no proof yet"
        data_setup = "unsigned long long data = nondet_word();"
        call, rounds, before, bit = f"{name}(data)", 64, "1", "(data >> (63 - i)) & 1"
    shift, turn = "\n            ".join(shift_in(crc, bit)), "\n    ".join(shifted_out(crc))
    return f"""void crc(void)
{{
    {data_setup}
    unsigned long long shift_register = {crc.init}ULL;
    for (int i = 0; i < {rounds}; i++)
        if ({before}) {{
            {shift}
        }}
    {turn}
    __CPROVER_assert({call} == (shift_register ^ {crc.xorout}ULL), "the CRC of the definition");
}}
"""
