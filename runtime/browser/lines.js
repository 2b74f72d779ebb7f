// Licence 0BSD: use, modify and distribute this file without any condition.
// An encoder described in one line, with the same words and messages as on the command line.

const LINE_INTERFACES = ["biss", "ssi", "spi", "rs485"];
const LINE_TITLES = { biss: "BiSS C-mode", ssi: "SSI", spi: "SPI", rs485: "RS-485" };
const LINE_EXAMPLE = "INTERFACE:FIELD,FIELD, such as biss:position=32,error,warning,crc=6:0x43";
const LINE_LAYOUT_NAMES = {
  biss: ["single_cycle_data", "Single cycle data"], ssi: ["ssi_word", "SSI word"],
  spi: ["position_word", "Position word"], rs485: ["reply", "Reply"],
};
const LINE_EFFECT_VERDICTS = named({ error: "not_usable", warning: "usable_with_warning", status: "usable" });
const LINE_VERDICT_MEANINGS = {
  not_usable: "an error is active", usable_with_warning: "a warning is active", usable: "the bit is active",
};
const LINE_NUMBER_UNITS = named({
  position: ["counts", "Position"], singleturn: ["counts", "Position within one revolution"],
  multiturn: ["revolutions", "Number of revolutions"],
});
const MAX_LINE_LENGTH = 1000;
const MAX_LINE_FIELDS = 64;

/** A text that is not a field or an option. The message says what would be right, and ``offset`` where it is. */
class LinePartError extends Error {
  constructor(message, offset = 0) {
    super(message);
    this.offset = offset;
  }
}

const isLine = (text) => text.includes("=") || /^\s*(biss|ssi|spi|rs485)\s*[:,]/i.test(text);
const quoteLineText = (text) => (text.length > TABLE.limits.quote ? `'${text.slice(0, TABLE.limits.quote - 3)}...'` : `'${text}'`);
const formatHex = (number) => `0x${number.toString(16)}`;

/** The decimal, hexadecimal or binary number of at most 65 bits that a text is, otherwise null. */
function parseLineNumber(text) {
  return /^(0[xX][0-9A-Fa-f]{1,17}|0[bB][01]{1,65}|0|[1-9][0-9]{0,19})$/.test(text) ? BigInt(text) : null;
}

function parseWidth(name, text, widest = 64n) {
  const width = parseLineNumber(text);
  if (width === null || width < 1n || width > widest) {
    throw new LinePartError(`${quoteLineText(text)} is not a width of '${name}'; write 1 to ${widest}`, name.length + 1);
  }
  return Number(width);
}

function parseLineField(text, column, interface_) {
  const at = text.indexOf("=");
  if (!text.trim()) throw new LinePartError("a field is missing between two commas; remove one of them");
  const given = (at < 0 ? text : text.slice(0, at)).trim();
  const values = at < 0 ? [] : text.slice(at + 1).split(":").map((value) => value.trim());
  if (!/^[A-Za-z][A-Za-z0-9_]{0,39}$/.test(given)) {
    throw new LinePartError(`${quoteLineText(given)} is not a name; use letters, digits and underscores, such as position=32`);
  }
  const name = given.toLowerCase().split("_").filter(Boolean).join("_");
  if (name === "crc") return { ...parseCrc(values, interface_), column };
  if (name === "parity") return { ...parseParity(values), column };
  if (name === "zero" || name === "unused") {
    if (values.length !== 1) throw new LinePartError(`'${name}' takes only a width; write ${name}=2 for two bits`);
    return { kind: name, name, bits: parseWidth(name, values[0]), column };
  }
  if (values[0] === "low" || values[0] === "high") return { ...parseFlag(name, values), column };
  if (["error", "warning"].includes(name) && (!values.length || (values.length === 1 && values[0] === "1"))) {
    if (interface_ !== "biss") throw new LinePartError(`'${name}' has no active level; write ${name}=low or ${name}=high`);
    return { kind: "flag", name, bits: 1, level: "low", verdict: LINE_EFFECT_VERDICTS[name], column };
  }
  return { ...parseNumberField(name, values), column };
}

function parseNumberField(name, values) {
  if (!values.length || (values.length === 1 && !values[0])) {
    throw new LinePartError(`'${name}' has no width; write NAME=BITS for a number, NAME=low or NAME=high for a flag`);
  }
  if (name === "error" || name === "warning") {
    throw new LinePartError(`'${name}' is one bit; write ${name}=low or ${name}=high`, name.length + 1);
  }
  const width = parseWidth(name, values[0]);
  if (values.length === 1) return { kind: "number", name, bits: width };
  if (values.length === 2 && values[1] === "signed") return { kind: "number", name, bits: width, isSigned: true };
  const number = parseLineNumber(values[1]);
  const place = name.length + values[0].length + 2;
  if (number === null || values.length > 2) {
    const wrong = quoteLineText(values.slice(1).join(":"));
    throw new LinePartError(`${wrong} does not fit after a width; write signed, or the value of a constant`, place);
  }
  if (number >> BigInt(width)) {
    throw new LinePartError(`${formatHex(number)} does not fit into ${width} bits; write at most ${formatHex(ones(width))}`, place);
  }
  if (name in LINE_NUMBER_UNITS) {
    throw new LinePartError(`'${name}' is not a constant; give the constant bits another name`, place);
  }
  return { kind: "constant", name, bits: width, value: number };
}

function parseFlag(name, values) {
  const effect = values[1] ?? (name in LINE_EFFECT_VERDICTS ? name : "status");
  if (values.length > 2 || !(effect in LINE_EFFECT_VERDICTS)) {
    const wrong = quoteLineText(values.slice(1).join(":"));
    throw new LinePartError(`${wrong} is not an effect of a flag; write error, warning or status`,
      name.length + values[0].length + 2);
  }
  return { kind: "flag", name, bits: 1, level: values[0], verdict: LINE_EFFECT_VERDICTS[effect] };
}

function parseParity(values) {
  if (values.length === 1 && (values[0] === "even" || values[0] === "odd")) {
    return { kind: "parity", name: "parity", bits: 1, isOdd: values[0] === "odd" };
  }
  throw new LinePartError("a parity bit is even or odd; write parity=even or parity=odd");
}

function parseCrc(values, interface_) {
  if (values.length < 2) {
    throw new LinePartError("a CRC needs its width and polynomial; write crc=BITS:POLYNOMIAL, such as crc=6:0x43");
  }
  const width = parseWidth("crc", values[0], 32n);
  const numbers = values.slice(1);
  let isInverted = interface_ === "biss";
  if (["inverted", "plain"].includes(numbers.at(-1))) isInverted = numbers.pop() === "inverted";
  const place = "crc=".length + values[0].length + 1;
  if (numbers.length < 1 || numbers.length > 2) {
    throw new LinePartError("write crc=BITS:POLYNOMIAL:START, with :inverted or :plain after it if needed", place);
  }
  const poly = parseLineNumber(numbers[0]);
  if (poly === null || !(poly & ONE) || poly > ones(width + 1)) {
    const right = `write an odd number of at most ${formatHex(ones(width + 1))}, with or without its top bit`;
    throw new LinePartError(`${quoteLineText(numbers[0])} is not a polynomial of ${width} bits; ${right}`, place);
  }
  const init = numbers.length > 1 ? parseLineNumber(numbers[1]) : 0n;
  if (init === null || init > ones(width)) {
    throw new LinePartError(`${quoteLineText(numbers[1])} is not a start value; write at most ${formatHex(ones(width))}`,
      place + numbers[0].length + 1);
  }
  return { kind: "crc", name: "crc", bits: width, poly: poly & ones(width), init, isInverted };
}

// -- options

function parseHertz(text) {
  const match = /^([0-9]{1,12})([.][0-9]{1,6})?(|k|M)(?:Hz)?$/.exec(text);
  const hertz = match ? Math.round(Number(match[1] + (match[2] ?? "")) * { "": 1, k: 1e3, M: 1e6 }[match[3]]) : 0;
  return hertz > 0 && hertz <= 1e9 ? hertz : null;
}

function parsePositive(text) {
  const number = parseLineNumber(text);
  return number && number < ONE << 63n ? number : null;
}

function parseRequest(text) {
  const digits = text.startsWith("0x") ? text.slice(2) : text;
  return /^([0-9A-Fa-f]{2}){1,8}$/.test(digits) ? digits : null;
}

const LINE_KEYWORDS = named({
  gray: [["biss", "ssi", "spi"], "isGray", true], binary: [LINE_INTERFACES, "isGray", false],
  left: [["ssi"], "alignment", "msb_left"], right: [["ssi"], "alignment", "lsb_right"],
  low_byte_first: [["spi", "rs485"], "order", "little"], high_byte_first: [["spi", "rs485"], "order", "big"],
});
const LINE_SETTINGS = named({
  clock: [["biss", "ssi", "spi"], parseHertz, "clock=1MHz"],
  mode: [["spi"], (text) => (/^[0-3]$/.test(text) ? Number(text) : null), "mode=1"],
  baud: [["rs485"], parsePositive, "baud=2500000"], request: [["rs485"], parseRequest, "request=1A"],
  counts: [LINE_INTERFACES, parsePositive, "counts=4096"], turns: [LINE_INTERFACES, parsePositive, "turns=4096"],
});
const joinNames = (names, last = "and") => (names.length > 1 ? `${names.slice(0, -1).join(", ")} ${last} ${names.at(-1)}` : names[0]);

function setLineOption(options, text, interface_) {
  const at = text.indexOf("=");
  const name = (at < 0 ? text : text.slice(0, at)).trim();
  const given = at < 0 ? "" : text.slice(at + 1).trim();
  const [word, setting] = [LINE_KEYWORDS[name], LINE_SETTINGS[name]];
  if (!word && !setting) {
    const every = joinNames([...Object.keys(LINE_KEYWORDS), ...Object.keys(LINE_SETTINGS)], "or");
    throw new LinePartError(`${quoteLineText(name)} is not an option; write ${every} (a field belongs after the colon)`);
  }
  const [interfaces] = word ?? setting;
  if (!interfaces.includes(interface_)) {
    throw new LinePartError(`'${name}' is not an option of ${interface_}, only of ${joinNames(interfaces)}; remove it`);
  }
  if (word) {
    if (at >= 0) throw new LinePartError(`'${name}' has no value; write only ${name}`, name.length);
    return Object.assign(options, { [word[1]]: word[2] });
  }
  const value_ = setting[1](given);
  if (value_ === null) {
    throw new LinePartError(`${quoteLineText(given)} is not a value of '${name}'; write it like ${setting[2]}`, name.length + 1);
  }
  return Object.assign(options, { [name]: value_ });
}

// -- the line

/** The parts of a text between commas, each with the column of its first character that is not a space. */
function splitAtCommas(text, column) {
  let next = column;
  return text.split(",").map((piece) => {
    const place = next + (piece.trim() ? piece.length - piece.trimStart().length : 0);
    next += piece.length + 1;
    return [place, piece.trim()];
  });
}

/** The interface, options and fields of a line, or its problems, each with its column. */
function parsedLine(given) {
  const text = given.trim();
  if (text.length > MAX_LINE_LENGTH) {
    return { problems: [[1, `the line is longer than ${MAX_LINE_LENGTH} characters; shorten it`]] };
  }
  const wrong = text.search(/[^A-Za-z0-9_=:,. ]/);
  if (wrong >= 0) {
    const [character] = text.slice(wrong);
    return { problems: [[wrong + 1, `'${character}' is not a character of a line; write ${LINE_EXAMPLE}`]] };
  }
  const problems = [];
  const [interface_, end] = parseInterface(text, problems);
  const options = {};
  const columns = {};
  for (const [column, piece] of splitAtCommas(text.slice(0, end), 1).slice(1)) {
    collectProblem(column, problems, () => {
      setLineOption(options, piece, interface_);
      columns[piece.split("=")[0].trim()] = column;
    });
  }
  const start = end ? end + 1 : 0;
  const fields = start <= text.length ? parseLineFields(text.slice(start), start + 1, interface_, problems) : [];
  if (fields.length) problems.push(...checkLineFields(fields, interface_), ...checkLineOptions(options, columns, fields, interface_));
  return { text, interface: interface_, options, fields, problems: problems.sort(([one], [other]) => one - other) };
}

function collectProblem(column, problems, read) {
  try {
    read();
  } catch (error) {
    if (!(error instanceof LinePartError)) throw error;
    problems.push([column + error.offset, error.message]);
  }
}

function parseInterface(text, problems) {
  const colon = text.indexOf(":");
  const head = colon < 0 ? text : text.slice(0, colon);
  const word = head.split(",")[0].trim();
  const interface_ = word.toLowerCase();
  if (LINE_INTERFACES.includes(interface_)) {
    if (colon < 0) {
      problems.push([text.length + 1, `there is no colon after '${interface_}' and its options; write ${LINE_EXAMPLE}`]);
    }
    return [interface_, head.length];
  }
  if (word.includes("=") || ["error", "warning", "position"].includes(interface_) || colon < 0) {
    problems.push([1, "the line does not begin with its interface; write biss:, ssi:, spi: or rs485: in front of it"]);
    return ["biss", 0];
  }
  problems.push([1, `${quoteLineText(word)} is not an interface; write one of: ${LINE_INTERFACES.join(", ")}`]);
  return ["biss", head.length];
}

function parseLineFields(text, column, interface_, problems) {
  const fields = [];
  if (!text.trim()) {
    problems.push([column, `the line has no fields; write ${LINE_EXAMPLE}`]);
    return fields;
  }
  const pieces = splitAtCommas(text, column);
  if (pieces.length > MAX_LINE_FIELDS) {
    problems.push([pieces[MAX_LINE_FIELDS][0], `write at most ${MAX_LINE_FIELDS} fields`]);
  }
  for (const [place, piece] of pieces.slice(0, MAX_LINE_FIELDS)) {
    collectProblem(place, problems, () => fields.push(parseLineField(piece, place, interface_)));
  }
  return fields;
}

const isFiller = (field) => field.kind === "zero" || field.kind === "unused";
const isPosition = (field) => field.name === "position" || field.name === "singleturn";
const sumFieldBits = (fields) => fields.reduce((sum, field) => sum + field.bits, 0);

function checkLineFields(fields, interface_) {
  const problems = [];
  const names = new Set();
  for (const field of fields) {
    const { name, column, kind } = field;
    if (!isFiller(field) && names.has(name)) problems.push([column, `a second field has the name '${name}'; rename one of them`]);
    names.add(name);
    if (kind === "crc" && field !== fields.at(-1)) problems.push([column, "the CRC must be the last field; move it to the end"]);
    if (kind === "crc" && interface_ === "rs485" && field.bits % 8) {
      problems.push([column, `the CRC has ${field.bits} bits; over RS-485, write whole bytes`]);
    }
    if (kind === "parity" && fields.every((one) => ["parity", "crc", "zero", "constant"].includes(one.kind))) {
      problems.push([column, "a parity bit needs other fields that change; add them"]);
    }
  }
  return [...problems, ...checkPositionFields(fields, interface_), ...checkLineLength(fields, interface_)];
}

function checkPositionFields(fields, interface_) {
  const last = (name) => fields.findLastIndex((field) => field.name === name);
  const [position, turns, inTurn] = ["position", "multiturn", "singleturn"].map(last);
  const problems = [];
  if (position >= 0 && (turns >= 0 || inTurn >= 0)) {
    problems.push([fields[position].column,
      "'position' is the whole position; write either it, or multiturn and singleturn"]);
  }
  if (turns < 0) return problems;
  if (inTurn < 0) problems.push([fields[turns].column, "'multiturn' needs 'singleturn'; add singleturn=BITS"]);
  else if (turns > inTurn && interface_ !== "rs485") {
    problems.push([fields[turns].column,
      "'multiturn' must be before 'singleturn'; swap the two, or write position=BITS"]);
  }
  return problems;
}

function checkLineLength(fields, interface_) {
  const length = sumFieldBits(fields);
  const [fewest, most] = [interface_ === "spi" || interface_ === "rs485" ? 8 : 1, interface_ === "rs485" ? 1024 : 64];
  if (length < fewest || length > most) {
    return [[fields[0].column, `the fields have ${length} bits; write ${fewest} to ${most}`]];
  }
  if (interface_ !== "rs485" || length % 8 === 0) return [];
  return [[fields[0].column, `the fields have ${length} bits; over RS-485, write whole bytes`]];
}

function checkLineOptions(options, columns, fields, interface_) {
  return [
    ...(options.isGray ? checkGrayOption(options, columns, fields) : []),
    ...(options.counts || options.turns ? checkCountOptions(options, columns, fields) : []),
    ...checkByteOrder(options, fields, interface_),
  ];
}

function checkGrayOption(options, columns, fields) {
  const positions = fields.filter(isPosition);
  const hasTurns = fields.some((field) => field.name === "multiturn");
  const problems = positions.length ? [] : [[columns.gray ?? 1, "'gray' needs a position; add position=BITS, or remove gray"]];
  const [turns, inTurn] = ["multiturn", "singleturn"].map((name) => fields.findIndex((field) => field.name === name));
  if (turns >= 0 && inTurn > turns + 1) {
    problems.push([fields[inTurn].column,
      "with gray, 'singleturn' must follow 'multiturn' directly; move the fields between them"]);
  }
  for (const { kind, column } of fields) {
    if (kind === "parity") problems.push([column, "a parity over Gray code is not supported; write its bit as unused=1"]);
  }
  for (const { name, bits: width, column, isSigned } of positions) {
    if (width === 1 && !hasTurns) {
      problems.push([column, `'${name}' has one bit, which is the same in Gray code; remove gray`]);
    }
    if (isSigned) problems.push([column, `'${name}' is signed, and Gray code is not; remove one of the two`]);
  }
  const counts = options.counts ?? 0n;
  if (counts & (counts - ONE)) {
    problems.push([columns.counts ?? 1, `Gray code with ${counts} counts (Gray excess) is not supported; `
      + "remove gray and counts, and convert the number in your program"]);
  }
  return problems;
}

function checkCountOptions(options, columns, fields) {
  const column = columns.counts ?? columns.turns ?? 1;
  const positions = fields.filter((field) => field.kind === "number" && field.name === "position");
  const problems = positions.length ? [] : [[column,
    "'counts' and 'turns' need a field 'position'; singleturn and multiturn already give them"]];
  const { counts = 0n, turns = 0n } = options;
  if (turns && !counts) problems.push([columns.turns ?? 1, "'turns' needs the counts per revolution; add counts=NUMBER"]);
  for (const field of positions) {
    const most = ONE << BigInt(field.bits);
    if (counts * (turns || ONE) > most) {
      problems.push([column, `${counts} counts × ${turns || ONE} turns do not fit into ${field.bits} bits; `
        + `write at most ${most} counts in all`]);
    }
    if (field.isSigned) {
      problems.push([column, "a signed position has no counts in a line; remove counts, and add its range to the spec"]);
    }
  }
  return problems;
}

function checkByteOrder(options, fields, interface_) {
  const problems = [];
  let place = 0;
  for (const field of fields) {
    const isWide = field.bits > 8 && !isFiller(field);
    if (interface_ === "rs485" && isWide && !options.order) {
      problems.push([field.column,
        `the byte order of '${field.name}' is not known; write rs485,low_byte_first: or high_byte_first`]);
    }
    const isSplit = interface_ === "spi" && options.order === "little" && ["number", "constant"].includes(field.kind);
    if (isSplit && isWide && (place % 8 || field.bits % 8)) {
      problems.push([field.column,
        `'${field.name}' is not whole bytes, so low_byte_first cannot apply; add zero or unused bits`]);
    }
    if (isSplit && isWide && (field.isSigned || field.kind === "constant")) {
      problems.push([field.column,
        `'${field.name}' is signed or a constant, and cannot be sent low byte first; write its bytes`]);
    }
    place += field.bits;
  }
  return problems;
}

// -- the record

/** Members that are not 0, empty or false. */
const omitEmptyMembers = (members) => Object.fromEntries(Object.entries(members).filter(
  ([, one]) => one && (typeof one !== "object" || Object.keys(one).length)));
const toTableNumber = (number) => (number <= BigInt(Number.MAX_SAFE_INTEGER) ? Number(number) : formatHex(number));

/** The fields as they are sent, each with a name of its own and its lowest bit. A number sent low byte first is split. */
function listSentFields({ interface: interface_, options, fields }) {
  const taken = new Set(fields.filter((field) => !isFiller(field)).map((field) => field.name));
  const isLow = options.order === "little";
  const sent = [];
  const used = new Set();
  for (const field of fields) {
    if (interface_ === "spi" && isLow && field.kind === "number" && field.bits > 8) {
      for (let index = 0; index < field.bits / 8; index += 1) {
        sent.push({ kind: "byte", name: `${field.name}_byte_${index}`, of: field.name, bits: 8 });
      }
      continue;
    }
    let { name } = field;
    if (isFiller(field)) {
      name = `${field.name}_bits`;
      for (let number = 2; used.has(name) || taken.has(name); number += 1) name = `${field.name}_bits_${number}`;
    }
    used.add(name);
    sent.push({ ...field, name });
  }
  const isFromLow = interface_ === "rs485" && isLow;
  const length = sumFieldBits(fields);
  let place = 0;
  for (const field of sent) {
    field.low = isFromLow ? place : length - place - field.bits;
    place += field.bits;
  }
  return sent;
}

/** Adds to each unused field its place among the unused bits. */
function placeUnusedBits(sent, interface_) {
  const unused = sent.filter((field) => field.kind === "unused").sort((one, other) => one.low - other.low);
  if (interface_ !== "rs485") {
    let place = 0;
    for (const field of unused) {
      field.place = place;
      place += field.bits;
    }
    return;
  }
  const bytes = [...new Set(unused.flatMap(({ low, bits: width }) => {
    const first = Math.floor(low / 8);
    return Array.from({ length: Math.floor((low + width - 1) / 8) - first + 1 }, (_, index) => first + index);
  }))].sort((one, other) => one - other);
  for (const field of unused) field.place = 8 * bytes.indexOf(Math.floor(field.low / 8)) + (field.low % 8);
}

function buildJoins(sent) {
  const join = (name, parts) => {
    let shift = 0;
    return { name, fields: parts.map((field) => {
      const row = [field.name, shift];
      shift += field.bits;
      return row;
    }) };
  };
  const parts = (name) => sent.filter((field) => field.of === name || (field.kind === "number" && field.name === name));
  const split = [...new Set(sent.map((field) => field.of).filter(Boolean))];
  const joins = split.map((name) => join(name, parts(name)));
  const [turns, inTurn] = [parts("multiturn"), parts("singleturn")];
  return turns.length && inTurn.length ? [...joins, join("position", [...inTurn, ...turns])] : joins;
}

const isConstant = (field) => field.kind === "zero" || field.kind === "constant";
const onesIn = (number) => number.toString(2).replaceAll("0", "").length;

/** The other fields of a parity bit that change, and whether their number of ones must be odd with it. */
function findParityCoverage(field, sent) {
  const others = sent.filter((one) => !["parity", "crc"].includes(one.kind));
  const constants = others.filter((one) => one.kind === "constant").reduce((sum, one) => sum + onesIn(one.value), 0);
  return { covered: others.filter((one) => !isConstant(one)), isOdd: (Number(field.isOdd) + constants) % 2 };
}

const LINE_COLOURS = { flag: "flag", zero: "fixed", constant: "fixed", crc: "check", parity: "check" };

function buildFieldRecord(field, sent, hasPosition) {
  const { name, bits: width, low } = field;
  const colour = field.kind === "unused" && hasPosition ? "fixed" : LINE_COLOURS[field.kind] ?? "data";
  const data = { name, ...omitEmptyMembers({ low }), width, colour };
  switch (field.kind) {
    case "flag":
      return { ...data, kind: field.level === "low" ? "not_flag" : "flag", on: LINE_VERDICT_MEANINGS[field.verdict] };
    case "zero": return { ...data, fixed: 0 };
    case "constant": return { ...data, fixed: toTableNumber(field.value) };
    case "unused": return hasPosition ? { ...data, unused: 0, place: field.place } : data;
    case "crc": return { ...data, crc: 1 };
    case "parity": {
      const { covered, isOdd } = findParityCoverage(field, sent);
      return { ...data, parity: covered.map((one) => one.name), odd: isOdd };
    }
    default: {
      const [unit, meaning] = LINE_NUMBER_UNITS[name] ?? [];
      return { ...data, ...omitEmptyMembers({ kind: field.isSigned ? "signed" : "", meaning, unit }) };
    }
  }
}

/** The checks of constants and parity bits, and then that of the highest position. */
function buildCheckRecords(sent, { counts = 0n, turns = ONE }) {
  const placeOf = (field) => ({ ...omitEmptyMembers({ low: field.low }), width: field.bits });
  const checks = sent.flatMap((field) => {
    const place = { ...placeOf(field), fault: "constant" };
    if (isConstant(field)) {
      return [{ ...place, values: [toTableNumber(field.value ?? 0n)], field: field.name, says: "constant", always: 1 }];
    }
    if (field.kind !== "parity") return [];
    const { covered, isOdd } = findParityCoverage(field, sent);
    return [{ ...place, parity_of: covered.map((one) => [one.low, one.bits]), ...omitEmptyMembers({ odd: isOdd }), field: field.name,
      says: "parity", always: 1, of_name: covered.map((one) => one.name).join(", ") }];
  });
  const limited = sent.filter((field) => field.kind === "number" && field.name === "position" && counts
    && counts * turns <= ones(field.bits));
  return [...checks, ...limited.map((field) => ({
    ...placeOf(field), fault: "range", limit: toTableNumber(counts * turns - ONE), field: field.name, says: "too_high",
  }))];
}

function buildMeasure({ fields, options }, joins) {
  const width = (name) => fields.find((field) => field.kind === "number" && field.name === name)?.bits;
  const [inTurn, turns] = [width("singleturn"), width("multiturn")];
  if (inTurn === undefined && !options.counts) return {};
  const of = turns !== undefined || inTurn === undefined ? "position" : "singleturn";
  const counts = inTurn === undefined ? options.counts : ONE << BigInt(inTurn);
  const revolutions = inTurn === undefined ? options.turns ?? ONE : ONE << BigInt(turns ?? 0);
  const part = joins.find((join) => join.name === of)?.fields[0][0];
  return omitEmptyMembers({ of, part, counts_per_turn: toTableNumber(counts), turns: toTableNumber(revolutions) });
}

/** Parameters of a CRC, and those of similar CRCs that may be used by mistake. */
function buildCrcRecord({ bits: width, poly, init, isInverted }, isOverBytes) {
  const parameters = (changes) => omitEmptyMembers(Object.fromEntries(Object.entries({
    width: BigInt(width), poly, init, refin: 0n, refout: 0n, xorout: isInverted ? ones(width) : 0n, ...changes,
  }).map(([name, number]) => [name, toTableNumber(number)])));
  const own = parameters({});
  const xorout = isInverted ? 0n : ones(width);
  const isXor = isOverBytes && width === 8 && poly === ONE;
  const change = `the CRC is ${isInverted ? "not " : ""}inverted`;
  const same = isXor ? `, or its start value is ${formatHex(ones(width) ^ init)} (the same here)` : "";
  const starts = isXor ? [] : listOtherStartValues(width, poly, init);
  const others = [["crc_not_inverted", change + same, parameters({ xorout })],
    ...starts.map((start) => ["start_value", `the start value of the CRC is ${formatHex(start)}`, parameters({ init: start })]),
    ...(isOverBytes ? buildOtherBytePolynomials(parameters) : [buildReversedPolynomial(width, poly, parameters)])];
  const powers = Array.from({ length: width }, (_, index) => width - 1 - index).filter((power) => bits(poly, power, 1));
  const text = [width, ...powers].map((power) => ["1", "x"][power] ?? `x^${power}`).join(" + ");
  const isDifferent = ([, , crc]) => JSON.stringify(crc) !== JSON.stringify(own);
  return { ...own, text, ...omitEmptyMembers({ [isOverBytes ? "byte_others" : "others"]: others.filter(isDifferent) }) };
}

/** All zeros, all ones, and the start values of known CRCs with the polynomial, except that of the CRC itself. */
function listOtherStartValues(width, poly, init) {
  const isSame = ([known]) => big(known) === (poly | (ONE << BigInt(width)));
  const starts = new Set([0n, ones(width), ...TABLE.known_crcs.filter(isSame).map(([, known]) => BigInt(known))]);
  return [...starts].filter((start) => start !== init).sort((one, other) => (one < other ? -1 : 1));
}

function buildReversedPolynomial(width, poly, parameters) {
  const top = poly | (ONE << BigInt(width));
  const backwards = BigInt(`0b${[...top.toString(2)].reverse().join("")}`);
  return ["polynomial_reversed", `the polynomial is ${formatHex(backwards)}, written in reverse`,
    parameters({ poly: backwards & ones(width) })];
}

function buildOtherBytePolynomials(parameters) {
  return TABLE.byte_polynomials.flatMap((polynomial) => {
    const poly = big(polynomial) & 0xFFn;
    const text = `the polynomial is ${formatHex(big(polynomial))}`;
    return [["other_polynomial", `${text}, most significant bit first`, parameters({ poly })],
      ["other_polynomial", `${text}, least significant bit first`, parameters({ poly, refin: ONE, refout: ONE })]];
  });
}

/** The request of a line over RS-485, or one byte of any value. */
function buildRequestFrame(options) {
  const request = options.request && BigInt(`0x${options.request}`);
  const width = options.request ? 4 * options.request.length : 8;
  const content = options.request ? { colour: "fixed", fixed: toTableNumber(request) } : { meaning: "Request", colour: "data" };
  const check = { width, fault: "constant", values: [toTableNumber(request || 0n)], field: "request", says: "constant", always: 1 };
  return {
    name: "position_request", bits: width, order: "big", fields: [{ name: "request", width, ...content }],
    ...omitEmptyMembers({ checks: options.request ? [check] : [] }), title: "Position request",
    source: options.request ? "line: fields" : "TODO not stated", sender: "master",
  };
}

function buildEncoderFrame(line) {
  const { interface: interface_, options, fields } = line;
  const sent = listSentFields(line);
  placeUnusedBits(sent, interface_);
  const hasPosition = fields.some(isPosition);
  const flags = sent.filter((field) => field.kind === "flag");
  const speaking = hasPosition ? ["not_usable", "usable_with_warning"].flatMap(
    (verdict) => flags.filter((flag) => flag.verdict === verdict)) : [];
  const told = flags.filter((flag) => !hasPosition || flag.verdict !== "usable");
  const joins = buildJoins(sent);
  const coded = sent.filter((field) => LINE_NUMBER_UNITS[field.name] || LINE_NUMBER_UNITS[field.of]);
  const lowest = Math.min(...coded.map((field) => field.low));
  const [name, title] = LINE_LAYOUT_NAMES[interface_];
  return {
    name, bits: sumFieldBits(fields),
    ...omitEmptyMembers({
      order: interface_ === "rs485" ? options.order ?? "big" : "",
      joins,
      speaks: speaking.map((flag) => ({ verdict: flag.verdict, flag: flag.name })),
      gray: options.isGray ? { ...omitEmptyMembers({ low: lowest }), width: sumFieldBits(coded) } : {},
    }),
    ...(hasPosition ? { otherwise: speaking.length ? "usable" : "unknown" } : {}),
    fields: sent.map((field) => buildFieldRecord(field, sent, hasPosition)),
    ...omitEmptyMembers({ checks: buildCheckRecords(sent, options), crc: fields.at(-1).kind === "crc" ? "line_crc" : "" }),
    title, source: "line: fields", sender: "encoder",
    ...omitEmptyMembers({ tells: told.map((flag) => ({ report: flag.name, flag: flag.name, meaning: LINE_VERDICT_MEANINGS[flag.verdict] })) }),
  };
}

/** The record of the family that a line describes, like those of the table. */
function lineFamily(line) {
  const { interface: interface_, options, fields } = line;
  const shared = [];
  const indexes = new Map();
  const index = (item) => {
    const key = JSON.stringify(item);
    if (!indexes.has(key)) indexes.set(key, shared.push(item) - 1);
    return indexes.get(key);
  };
  const frame = buildEncoderFrame(line);
  const joins = frame.joins ?? [];
  const frames = [...(interface_ === "rs485" ? [buildRequestFrame(options)] : []), frame];
  const indexed = frames.map((item) => ({ ...item, ...Object.fromEntries(["fields", "checks", "tells"]
    .filter((name) => item[name]).map((name) => [name, item[name].map(index)])) }));
  const crc = fields.find((field) => field.kind === "crc");
  const lineName = interface_ === "ssi" ? `ssi_${options.alignment ?? "msb_left"}` : interface_;
  return {
    name: "one_line", title: "Encoder described in one line", mark: TABLE.line.mark, evidence: TABLE.line.evidence,
    ...omitEmptyMembers({ crcs: crc ? { line_crc: buildCrcRecord(crc, interface_ === "rs485") } : {} }),
    interfaces: [{
      name: interface_, title: LINE_TITLES[interface_],
      ...omitEmptyMembers({ line: interface_ === "rs485" ? "" : lineName, measure: buildMeasure(line, joins) }), frames: indexed,
    }],
    shared,
    codes: [[line.text, 0]],
  };
}

/** The encoder of a line. Throws ``UnknownCode`` with all problems of the line. */
function readLine(text) {
  const line = parsedLine(text);
  if (line.problems.length) {
    throw new UnknownCode(line.problems.map(([column, message]) => `column ${column}: ${message}`).join(". "), true);
  }
  const family = lineFamily(line);
  return { ...orderCodeOfRow(family, family.codes[0]), unlisted: [], tail: "", isSpecial: false, writtenAsIn: "", label: text };
}
