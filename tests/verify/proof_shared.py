"""Proofs of what all decoders share: the functions on bits of the shared header, and the CRC functions of the devices."""

from __future__ import annotations

from collections.abc import Iterable

from codewheel.model import Crc, Device

from proof import PRELUDE, UNDEFINED, Header, Proof

#: What is proved here, where the arguments are as their comments say.
FUNCTIONS = ("mask", "field", "signed", "fits_signed", "from_gray", "to_gray", "parity", "difference")
#: The longest run of bytes over which a CRC is proved.
BYTES = 12

_BITS = """\
typedef __int128 wide;
void gray(void)
{
    unsigned long long word = nondet_word();
    unsigned low = nondet_byte(), bits = nondet_byte();
    __CPROVER_assume(low + bits <= 64);
    unsigned long long plain = word, sum = 0;
    for (int i = 63; i >= 0; i--)
        if (i >= low && i < low + bits) {
            sum ^= (word >> i) & 1;
            plain = (plain & ~(1ULL << i)) | (sum << i);
        }
    __CPROVER_assert(@_from_gray(word, low, bits) == plain, "each bit is the sum of those from the top down to it");
    __CPROVER_assert(@_to_gray(plain, low, bits) == word, "and back");
}
void numbers(void)
{
    unsigned long long word = nondet_word();
    unsigned low = nondet_byte(), bits = nondet_byte();
    __CPROVER_assume(bits <= 64);
    __CPROVER_assert(@_mask(bits) == (unsigned long long)(((wide)1 << bits) - 1), "so many ones");
    __CPROVER_assert(@_field(word, low, bits) == (low < 64 ? (unsigned long long)((wide)(word >> low) & (((wide)1 << bits) - 1)) : 0), "the field");
    long long number = nondet_number();
    __CPROVER_assume(bits >= 1);
    __CPROVER_assert(@_fits_signed(number, bits) == (number >= -((wide)1 << (bits - 1)) && number < ((wide)1 << (bits - 1))), "fits");
    __CPROVER_assume((wide)word < ((wide)1 << bits));
    __CPROVER_assert(@_signed(word, bits) == ((word >> (bits - 1)) & 1 ? (wide)word - ((wide)1 << bits) : (wide)word), "two's complement");
}
void parity(void)
{
    unsigned value = (unsigned)nondet_word(), odd = 0;
    for (int i = 0; i < 32; i++) odd ^= (value >> i) & 1;
    __CPROVER_assert(@_parity(value) == odd, "1 where the number of ones is odd");
}
void difference(void)
{
    /* Every power of two; others are too hard to divide by, and stand in difference_of_bytes. */
    unsigned long long modulus = nondet_word(), now = nondet_word(), before = nondet_word();
    unsigned power = nondet_byte() & 63;
    __CPROVER_assume(modulus == 0 || modulus == (1ULL << power));
    long long moved = @_difference(now, before, modulus);
    if (modulus == 0) {
        __CPROVER_assert(moved == 0, "no modulus");
        return;
    }
    __CPROVER_assert(((now - before - (unsigned long long)moved) & (modulus - 1)) == 0, "from before to now");
    __CPROVER_assert((wide)2 * moved < (wide)modulus && (wide)2 * moved >= -(wide)modulus, "the shorter way, half way round backwards");
}
void difference_of_bytes(void)
{
    unsigned char modulus = nondet_byte(), now = nondet_byte(), before = nondet_byte();
    __CPROVER_assume(now < modulus && before < modulus);
    int moved = (int)@_difference(now, before, modulus), ahead = now - before;
    __CPROVER_assert(moved == ahead || moved == ahead + modulus || moved == ahead - modulus, "from before to now");
    __CPROVER_assert(2 * moved < modulus && 2 * moved >= -modulus, "the shorter way, half way round backwards");
}
void difference_of_anything(void) { (void)@_difference(nondet_word(), nondet_word(), nondet_word()); }
"""


def shared_proofs(maker: str) -> Iterable[Proof]:
    text = f'#include "{maker}/encoder.h"\n{PRELUDE}' + _BITS.replace("@", maker)
    for entry in ("gray", "numbers", "parity", "difference", "difference_of_bytes", "difference_of_anything"):
        yield Proof(f"{maker} {entry}", text, entry, 66, tuple(UNDEFINED))


def crc_proofs(device: Device, header: Header) -> Iterable[Proof]:
    """The CRC functions of a device against the shift register of the definition, over every length."""
    prefix = f"{device.manufacturer.name}_{device.name}"
    for crc in device.crcs:
        for function in header.functions.values():
            if function.name.removeprefix(f"{prefix}_crc_") not in (crc.name, f"{crc.name}_bits", f"{crc.name}_bytes"):
                continue
            kinds = [kind for kind, _ in function.arguments]
            text = f'#include "{maker_header(device)}"\n{PRELUDE}' + _crc(crc, function.name, kinds)
            yield Proof(f"{function.name} of every input", text, "crc", 8 * BYTES + 2, tuple(UNDEFINED))


def maker_header(device: Device) -> str:
    return f"{device.manufacturer.name}/{device.name}.h"


def _crc(crc: Crc, name: str, kinds: list[str]) -> str:
    if kinds == ["const uint8_t *", "size_t"]:
        given = f"uint8_t data[{BYTES}]; size_t length = nondet_size(); __CPROVER_assume(length <= {BYTES}); for (int i = 0; i < {BYTES}; i++) data[i] = nondet_byte();"
        call, rounds, before = f"{name}(data, length)", 8 * BYTES, "i / 8 < length"
        bit = f"(data[i / 8] >> ({'i % 8' if crc.refin else '7 - i % 8'})) & 1"
    elif kinds == ["uint64_t", "uint32_t"]:
        given = "unsigned long long data = nondet_word(); unsigned length = nondet_byte(); __CPROVER_assume(length <= 64);"
        call, rounds, before, bit = f"{name}(data, length)", 64, "63 - i < length", "(data >> (63 - i)) & 1"
    else:
        assert kinds == ["uint64_t"] and crc.init == 0, f"{name}: a CRC function of {kinds} has no proof yet"
        given = "unsigned long long data = nondet_word();"
        call, rounds, before, bit = f"{name}(data)", 64, "1", "(data >> (63 - i)) & 1"
    turned = f"unsigned long long turned = 0; for (int k = 0; k < {crc.width}; k++) turned |= ((r >> k) & 1) << ({crc.width - 1} - k); r = turned;" if crc.refout else ""
    return f"""void crc(void)
{{
    {given}
    unsigned long long r = {crc.init}ULL;
    for (int i = 0; i < {rounds}; i++)
        if ({before}) {{
            unsigned long long feedback = ((r >> {crc.width - 1}) ^ (unsigned long long)({bit})) & 1;
            r = (r << 1) & {crc.mask}ULL;
            for (int k = 0; k < {crc.width}; k++) r ^= (({crc.poly}ULL >> k) & feedback) << k;
        }}
    {turned}
    __CPROVER_assert({call} == (r ^ {crc.xorout}ULL), "the CRC of the definition");
}}
"""
