"""Words that cannot be names in C: keywords, and names of the headers that the generated headers include."""

from __future__ import annotations

#: The keywords of C up to C23, of C++ up to C++26 and its technical specifications, and of common compilers,
#: as far as they can be names in a spec.
_KEYWORDS = """
    alignas alignof and and_eq asm atomic_cancel atomic_commit atomic_noexcept auto bitand bitor bool break case
    catch char char16_t char32_t char8_t class co_await co_return co_yield compl concept const const_cast consteval
    constexpr constinit continue contract_assert decltype default delete do double dynamic_cast else enum explicit
    export extern false final float for fortran friend goto if import inline int long module mutable namespace new
    noexcept not not_eq nullptr operator or or_eq override private protected public reflexpr register
    reinterpret_cast requires restrict return short signed sizeof static static_assert static_cast struct switch
    synchronized template this thread_local throw true try typedef typeid typename typeof typeof_unqual union
    unsigned using virtual void volatile wchar_t while xor xor_eq
"""
#: Types and macros of the three headers that the generated ones include.
_SIZES = [f"{speed}{bits}" for speed in ("", "_least", "_fast") for bits in (8, 16, 32, 64)]
_SIZED_TYPES = " ".join(f"{sign}int{size}_t" for sign in ("", "u") for size in _SIZES)
_TYPES = (
    "intmax_t intptr_t max_align_t nullptr_t offsetof ptrdiff_t size_t uintmax_t uintptr_t unreachable " + _SIZED_TYPES
)
#: Object-like macros of compilers, and of headers of C, Windows, Qt, POSIX and small processors.
_MACROS = """
    assert bool cdecl complex emit environ errno far foreach forever fortran hpux huge hyper i386 i860 i960
    imaginary interface interrupt linux m68k math_errhandling max mc68000 min mips near noreturn pascal pdp11 pixel
    powerpc quad sgi signals signgam slots small sparc stdcall stderr stdin stdout sun timezone tzname ultrix unix
    vax vector vms
"""
#: Functions for double. avr-libc maps the names with an f at the end to them.
_DOUBLE_FUNCTIONS = """
    acos asin atan atan2 cbrt ceil copysign cos cosh exp fabs fdim floor fma fmax fmin fmod frexp hypot isfinite
    isinf isnan ldexp log log10 lrint lround pow round signbit sin sinh sqrt square strtod tan tanh trunc
"""
_MATH = " ".join(f"{name}f" for name in _DOUBLE_FUNCTIONS.split())
RESERVED = frozenset(f"{_KEYWORDS} {_TYPES} {_MACROS} {_MATH}".split())
