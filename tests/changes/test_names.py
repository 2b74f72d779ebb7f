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
