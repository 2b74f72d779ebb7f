"""A program in Rust that calls everything in the module of a family, controlled by lines on standard input.

It answers each line with one line. Values are in decimal, words and bytes in hexadecimal, bytes after a mark:

    v NUMBER...     sets the parameters of the variant; answers all parameters
    d TYPE WIRE     decodes; answers the members, the runs of digits, the joins, and what encoding them again gives
    e TYPE VALUE... encodes
    s INDEX WIRE    identifies a frame and decodes it; answers its type
    h INDEX WIRE    updates the variant from a register; answers all parameters
    c INDEX WIRE... the CRC of bytes, or of a number with this many bits
    x TYPE WIRE     reads a received buffer; answers the position and its verdict
    o, f TEXT, r    all order codes; the interfaces that have this one; the constants of the registers

An error is answered by its name and that of the field.
"""

from __future__ import annotations

import subprocess
from collections.abc import Iterable, Iterator
from pathlib import Path

from codewheel.language.files import is_second
from codewheel.loading.library import load_library
from codewheel.model import Choice, Device, Flag, Layout, Text
from codewheel.plan.crcs import CoveredData, CrcFunction, CrcMethod
from codewheel.targets import Library
from codewheel_rust import TARGET
from codewheel_rust.family import Family, Struct, crc_name
from codewheel_rust.names import pascal, snake
from codewheel_rust.spelling import Scope
from working_tools import require

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PACKAGE = ROOT / "examples" / "rust-target"

#: Specs that are not for this target.
OTHERS = ("digits", "long_crc", "lowfirst", "gray_parity", "options", "crc_options", "icpvl", "long_names", "switched")
OTHERS += ("byte_orders",)


def _specs() -> Iterator[str]:
    """Yield the specs of the families that the target can express.

    It cannot express a CRC that is not whole bytes at the end of a frame in bytes, a parity bit over Gray code, digits
    that are sent separately, two byte orders in a frame whose fields move, or a flag that some order codes lack. The
    words of ``lowfirst`` have 64 bits, so no number is too long for them.
    """
    for folder in ("specs/ichaus", "specs/lika", "tests/specs", "tests/c/specs", "tests/rust/specs", "docs/example"):
        for path in sorted((ROOT / folder).rglob("*.yaml")):
            is_device = "\ndevice: " in path.read_text(encoding="utf-8")
            if is_device and not is_second(path) and path.stem not in OTHERS:
                yield path.relative_to(ROOT).as_posix()


#: The spec of every family. The made-up families use features that others do not.
SPECS = [*_specs()]
#: Content of a crate: the shipped families of a manufacturer, or one family.
CRATES = ["specs/lika", *(spec for spec in SPECS if not spec.startswith("specs/lika/"))]
LIBRARY = ("--crate-type", "rlib", "--crate-name", "encoders")


def rust_tool(name: str) -> str:
    """Return a tool of the version in a plain Debian, or else of another version. Skip the test if there is none."""
    return require([name], ["/usr/bin"])


def compiled(*command: str | Path) -> None:
    """Compile with any version. Further warnings of a newer one are not errors here, see tests/verify/test_rust.py."""
    completed = subprocess.run([rust_tool("rustc"), *command], capture_output=True, text=True, check=False)
    assert completed.returncode == 0, completed.stderr[:4000]


def write(devices: tuple[Device, ...], folder: Path, edition: str = "2021") -> Path:
    """Write the crate of families of one manufacturer. Return its main file."""
    for name, text in TARGET.files(Library(devices), {"edition": edition}).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    (main,) = folder.glob("rust/*/src/lib.rs")
    return main


class Workshop:
    """Builds each crate and program once. A program panics if a number overflows."""

    def __init__(self, folder: Path, *options: str) -> None:
        self._folder, self._options = folder, (*options, "-C", "overflow-checks=on")
        self._programs: dict[str, Program] = {}

    def program(self, spec: str) -> Program:
        """Return the program for the family of a spec."""
        if spec not in self._programs:
            folder = self._folder / str(len(self._programs))
            devices, report = load_library([ROOT / spec])
            assert not report
            kind = ("--edition", "2021", "--crate-type", "rlib", "--crate-name", "encoders", *self._options)
            compiled(*kind, "--out-dir", folder, write(devices, folder))
            self._programs[spec] = Program(devices[0], folder, self._options)
        return self._programs[spec]


class Program:
    """The program for a family, and the types of its frames and registers."""

    def __init__(self, device: Device, folder: Path, options: Iterable[str]) -> None:
        self.device, self.family = device, Family(device)
        self.structs = [*(struct for _, struct in self.family.frames), *self.family.registers]
        self._program, text = folder / device.name, folder / f"{device.name}.rs"
        text.write_text(self._source(), encoding="utf-8")
        library = folder / "libencoders.rlib"
        compiled("--edition", "2018", *options, "--extern", f"encoders={library}", "-o", self._program, text)

    def run(self, lines: Iterable[str]) -> list[str]:
        """Return the answer to each line."""
        text = "".join(f"{line}\n" for line in lines)
        completed = subprocess.run(
            [self._program], input=text, capture_output=True, text=True, timeout=900, check=False
        )
        assert completed.returncode == 0, completed.stderr[:2000]
        return completed.stdout.splitlines()

    def _source(self) -> str:
        """Return the harness with the types and functions of this device."""
        text = (HERE / "harness.rs").read_text(encoding="utf-8")
        for name, value in {**self._parameter_texts(), **self._frame_texts(), **self._family_texts()}.items():
            text = text.replace(f"@{name}@", value)
        return text

    def _parameter_texts(self) -> dict[str, str]:
        """Return the text for each mark of the harness that concerns the parameters of order codes."""
        scope = Scope(self.device)
        assignments, printed = [], []
        for parameter in self.device.parameters:
            member, is_open = f"variant.{snake(parameter.name)}", scope.is_open(parameter.name)
            if parameter.equals is None:
                assignments.append(f"{member} = {_SOME if is_open else 'number(words) as _'};")
            call = "()" if parameter.equals is not None else ""
            printed.append(f"{member}{call}{_SHOWN[is_open]}")
        return {"set": " ".join(assignments), "parameters": ", ".join(printed)}

    def _frame_texts(self) -> dict[str, str]:
        """Return the text for each mark of the harness that concerns frames."""
        dispatches = []
        for code, name, layouts in self.senders():
            dispatches.append(_TELL.format(code=code, type=name, arms=_layout_arms(name, layouts)))
        read_positions = []
        for index, struct in enumerate(self.structs):
            if struct.position_member:
                read_call = _READ.format(code=struct.code, type=_type(struct))
                read_positions.append(f'            "{index}" => {read_call},')
        return {
            "types": "".join(map(_implementation, self.structs)),
            "decode": _arms(f"decoded::<{_type(struct)}>(variant, words)" for struct in self.structs),
            "encode": _arms(f"encoded::<{_type(struct)}>(variant, words)" for struct in self.structs),
            "placed": _arms(f"told(<{_type(struct)} as Frame>::placed(variant))" for struct in self.structs),
            "dispatch": _arms(dispatches),
            "read": "\n".join(read_positions),
        }

    def _family_texts(self) -> dict[str, str]:
        """Return the text for each mark of the harness that concerns registers, CRCs and interfaces."""
        family = self.family
        codes = [*family.interfaces]
        takes = [
            _TAKE.format(code=pascal(effect.register.interface), name=effect.register.name) for effect in family.held
        ]
        return {
            "module": snake(self.device.name),
            "held": _arms(takes),
            "codes": "\n            ".join(_CODES.format(code=code) for code in codes),
            "found": ", ".join(_FOUND.format(code=code) for code in codes),
            "first": codes[0],
            "crcs": _arms(f'format!("{{:X}}", {crc_name(crc)}({_crc_arguments(crc)}))' for crc in family.crcs),
            "registers": ", ".join(map(_constants, family.registers)),
        }

    def senders(self) -> Iterator[tuple[str, str, list[Layout]]]:
        """Return the types of order codes, the types that hold any frame of one side, and their content."""
        for interface, dispatch in self.family.dispatches:
            layouts = [branch.layout for branch in dispatch.branches]
            layouts += [dispatch.fallback] if dispatch.fallback is not None else []
            yield pascal(interface.name), pascal(f"{interface.name}_from_{dispatch.sender}"), layouts


_SOME = "Some(number(words) as _)"
_SHOWN = (".to_string()", '.map_or("none".to_string(), |one| one.to_string())')
_TELL = (
    "told({type}::decode(&{code}(*variant), &bytes(words.next().unwrap()))"
    ".map(|frame| match frame {{ {arms} }}.to_string()))"
)
_CODES = (
    "{code}::ORDER_CODES.iter()"
    '.for_each(|(text, code)| shown.push(format!("{{}} {code} {{}}", text, parameters(&code.0))));'
)
_FOUND = '{code}::find(text).map_or("-", |_| "{code}")'
_READ = """told({type}::read(&{code}(*variant), &bytes(words.next().unwrap())).map(|(position, verdict)| {{
                format!("{{}} {{:?}}", position, verdict)
            }}))"""
_TAKE = """told({code}(*variant).with_{name}(&bytes(words.next().unwrap())).map(|taken| {{
            *variant = taken.0;
            parameters(variant)
        }}))"""


def _arms(answers: Iterable[str]) -> str:
    return "\n".join(f'            "{index}" => {answer},' for index, answer in enumerate(answers))


def _layout_arms(name: str, layouts: Iterable[Layout]) -> str:
    return ", ".join(f'{name}::{pascal(layout.name)}(_) => "{layout.name}"' for layout in layouts)


def _type(struct: Struct) -> str:
    return f"{_path(struct)}{pascal(struct.layout.name)}"


def _path(struct: Struct) -> str:
    return "registers::" if struct.register is not None else ""


def _crc_arguments(crc: CrcFunction) -> str:
    if crc.covered_data is CoveredData.BYTES:
        return "&bytes(words.next().unwrap())"
    bits = "" if crc.method is CrcMethod.FOLD else ", number(words) as u32"
    return f"word(words.next().unwrap()){bits}"


def _constants(struct: Struct) -> str:
    name, register = _type(struct), struct.register
    assert register is not None
    default = f"hex(&{name}::DEFAULT)" if register.default is not None else '"-"'
    parts = [f"{name}::{constant}" for constant in ("ADDRESS", "LENGTH", "READABLE", "WRITABLE")]
    parts += [default, *(f"{name}::{mask.upper()}_MASK" for mask in masks(struct))]
    return f'format!("{" ".join(["{}"] * len(parts))}", {", ".join(parts)})'


def masks(struct: Struct) -> dict[str, int]:
    """Return the masks of the fields of a register whose place in a word never changes."""
    fields = [part.field for part in struct.codec.decoded_fields]
    fixed = [field for field in fields if field.low.is_constant and field.width.is_constant]
    if struct.layout.widest > 64:
        return {}
    return {field.name: ((1 << field.widest) - 1) << field.low.constant for field in fixed}


def _implementation(struct: Struct) -> str:
    """Return code that reads and prints the members of a frame or register."""
    printed, parsed = [], []
    for field in (part.field for part in struct.codec.decoded_fields):
        name = snake(field.name)
        match field.kind:
            case Flag():
                printed.append(f"u8::from(self.{name}).to_string()")
                parsed.append(f"{name}: number(words) != 0")
            case Choice():
                printed.append(f"(self.{name} as u64).to_string()")
                type_ = f"{_path(struct)}{struct.type_of(field)}"
                parsed.append(f"{name}: {type_}::from_bits(number(words) as u64).unwrap()")
            case Text():
                printed.append(f"hex(&self.{name})")
                parsed.append(f"{name}: bytes(words.next().unwrap()).try_into().unwrap()")
            case _:
                printed.append(f"self.{name}.to_string()")
                parsed.append(f"{name}: number(words) as _")
    if struct.codec.reserved:
        printed.append("self.unused.to_string()")
        parsed.append("unused: number(words) as _")
    printed += [f"self.{snake(run.name)}().to_string()" for field in struct.layout.fields for run in field.runs]
    printed += [f"self.{snake(join.name)}(variant).to_string()" for join in struct.layout.joins]
    in_bytes = struct.codec.in_bytes
    text = (
        _IMPLEMENTATION.replace("@type@", _type(struct))
        .replace("@code@", struct.code)
        .replace("@shown@", ", ".join(printed))
    )
    text = text.replace("@wire@", "&bytes(wire)" if in_bytes else "word(wire)").replace("@given@", ", ".join(parsed))
    return text.replace("@sent@", "hex(&sent)" if in_bytes else 'format!("{:X}", sent)')


_IMPLEMENTATION = """
impl Frame for @type@ {
    fn taken(variant: &Variant, wire: &str) -> Result<Self, Fault> {
        Self::decode(&@code@(*variant), @wire@)
    }
    fn sent(&self, variant: &Variant) -> Result<String, Fault> {
        self.encode(&@code@(*variant)).map(|sent| @sent@)
    }
    fn shown(&self, variant: &Variant) -> String {
        let variant = &@code@(*variant);
        let shown: Vec<String> = vec![@shown@];
        shown.join(" ")
    }
    fn of(words: &mut Words) -> Self {
        Self { @given@ }
    }
    fn placed(variant: &Variant) -> Result<String, Fault> {
        let shown = |one: &(&str, u32, u32)| format!("{} {} {}", one.0, one.1, one.2);
        Ok(Self::fields(&@code@(*variant))?.iter().filter(|one| one.2 > 0).map(shown).collect::<Vec<_>>().join(","))
    }
}
"""
