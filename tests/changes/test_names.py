"""Names of generated files that go or change their value are listed with the changes and in the changelog."""

from __future__ import annotations

from codewheel.changes.names import name_changes

HEADER = """\
#ifndef ACME_ENC_BISS_H
#define ACME_ENC_BISS_H
#define ACME_ENC_BISS_VERSION "0.1.0" /**< semantic version */
#define ACME_ENC_BISS_REG_MODE_DEFAULT 0x20U /**< default */
#define ACME_ENC_BISS_REPLY_LENGTH 9U
#define ACME_ENC_BISS_READ(code, rx) \\
    read_((code), (rx))
#endif
"""
MODULE = '''\
"""The ENC."""

CLOCK_MAX_HZ = 10_000_000
_PRIVATE = 1


class _Status:
    overspeed: bool


class Status(_Status):
    """Status."""

    LIMIT = 3


def decode(data: bytes) -> Status: ...
'''


def texts(path: str, old: str, new: str | None) -> list[str]:
    after = {} if new is None else {path: new}
    return [change.text for change in name_changes({path: old}, after, ["enc", "enc_b"])]


def test_a_macro_that_goes_and_one_with_another_value() -> None:
    new = (
        HEADER.replace('"0.1.0"', '"0.2.0"')
        .replace("0x20U", "0x60U")
        .replace("#define ACME_ENC_BISS_REPLY_LENGTH 9U\n", "")
    )
    assert texts("c/include/acme/enc_biss.h", HEADER, new) == [
        "C macro ACME_ENC_BISS_REG_MODE_DEFAULT: 0x20U → 0x60U",
        "C macro ACME_ENC_BISS_REPLY_LENGTH is gone",
    ]


C_NAMES = """\
typedef enum acme_enc_mode {
    ACME_ENC_MODE_FAST = 0, /**< fast */
    ACME_ENC_MODE_SLOW = 1
} acme_enc_mode;
typedef struct acme_enc_reply {
    uint8_t speed; /**< speed */
    uint32_t position;
} acme_enc_reply;
static CW_CONST acme_enc ACME_ENC_A17 = { 17U }; /**< ENC-A17 */
static CW_CONST acme_enc ACME_ENC_A21 = { 21U }; /**< ENC-A21 */
static inline uint8_t acme_enc_crc(const uint8_t *bytes, size_t length)
{
    uint32_t crc = 0x00U; /* the start value */
    return (uint8_t)crc;
}

static inline bool acme_enc_reply_is_expected(
    const acme_enc_reply *reply)
{
    return true;
}
"""


def test_c_names_besides_macros() -> None:
    new = (
        C_NAMES.replace("    ACME_ENC_MODE_FAST = 0, /**< fast */\n", "")
        .replace("uint8_t speed", "uint16_t speed")
        .replace("static CW_CONST acme_enc ACME_ENC_A17 = { 17U }; /**< ENC-A17 */\n", "")
        .replace("0x00U; /* the start value */", "0xFFU;")
        .replace("acme_enc_reply_is_expected", "acme_enc_reply_is_right")
    )
    assert texts("c/include/acme/enc_biss.h", C_NAMES, new) == [
        "C enumerator ACME_ENC_MODE_FAST is gone",
        "C constant ACME_ENC_A17 is gone",
        "C member acme_enc_reply.speed: uint8_t speed → uint16_t speed",
        "C function acme_enc_crc has different code",
        "C function acme_enc_reply_is_expected is gone",
    ]
    assert texts("c/include/acme/enc_biss.h", C_NAMES, C_NAMES.replace("/* the start value */", "")) == []


def test_a_python_function_whose_code_differs() -> None:
    old = 'def crc(data: bytes) -> int:\n    """Return the CRC."""\n    return 0\n'
    path = "python/src/acme_encoders/enc.py"
    assert texts(path, old, old.replace("return 0", "return 1")) == ["Python function enc.crc has different code"]
    assert texts(path, old, old.replace("Return the CRC", "Compute the CRC")) == []


def test_another_comment_is_no_change() -> None:
    assert texts("c/include/acme/enc_biss.h", HEADER, HEADER.replace("default */", "factory default */")) == []


def test_python_names_of_a_module_and_its_classes() -> None:
    new = MODULE.replace("overspeed", "speed_limit").replace("10_000_000", "5_000_000").replace("_PRIVATE = 1\n", "")
    assert texts("python/src/acme_encoders/enc.py", MODULE, new) == [
        "Python name enc.CLOCK_MAX_HZ: 10000000 → 5000000",
        "Python name enc.Status.overspeed is gone",
    ]


def test_a_file_that_is_gone() -> None:
    assert texts("masters/some/enc.cfg", "clock", None) == ["file masters/some/enc.cfg is gone"]


def test_the_family_is_the_one_with_the_longest_name() -> None:
    path = "c/include/acme/enc_b_ssi.h"
    [change] = name_changes({path: "#define A 1\n"}, {path: "#define A 2\n"}, ["enc", "enc_b"])
    assert change.family == "enc_b"
