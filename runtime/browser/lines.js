// License 0BSD: use, modify and distribute this file without any condition.
// An encoder described in one line, with the same words and messages as on the command line.

/** Interfaces that a line can begin with. */
const LINE_INTERFACES = ["biss", "ssi", "spi", "rs485"];
const LINE_TITLES = { biss: "BiSS C-mode", ssi: "SSI", spi: "SPI", rs485: "RS-485" };
const LINE_EXAMPLE = "INTERFACE:FIELD,FIELD, such as biss:position=32,error,warning,crc=6:0x43";
/** Name and title of the layout of the frames from the encoder, by interface. */
const LINE_LAYOUT_NAMES = {
  biss: ["single_cycle_data", "Single cycle data"], ssi: ["ssi_word", "SSI word"],
  spi: ["position_word", "Position word"], rs485: ["reply", "Reply"],
};
/** Verdict of an active flag, by its effect. */
const LINE_EFFECT_VERDICTS = mergeByName({ error: "not_usable", warning: "usable_with_warning", status: "usable" });
/** Meaning of an active flag, by its verdict. */
const LINE_VERDICT_MEANINGS = {
  not_usable: "an error is active", usable_with_warning: "a warning is active", usable: "the bit is active",
};
/** Unit and meaning of the fields with a number that the measured position consists of, by name. */
const LINE_NUMBER_UNITS = mergeByName({
  position: ["counts", "Position"], singleturn: ["counts", "Position within one revolution"],
  multiturn: ["revolutions", "Number of revolutions"],
});
const LONGEST_LINE = 1000;
const MOST_LINE_FIELDS = 64;
/** Highest constant of a spec. */
const HIGHEST_CONSTANT = BigInt(Number.MAX_SAFE_INTEGER);
/** Fewest counts that are probably the highest count by mistake if all their bits are 1. */
const LEAST_SUSPICIOUS_COUNTS = 15n;

/** A text that is not a field or an option. The message says what would be right, and ``offset`` where it is. */
class LineError extends Error {
  constructor(message, offset = 0) {
    super(message);
    this.offset = offset;
  }
}

/** Return whether a text is meant as a line, because it has = or begins with an interface. */
const isLine = (text) => text.includes("=") || /^\s*(biss|ssi|spi|rs485)\s*[:,]/i.test(text);
/** Return the decimal, hexadecimal or binary number of at most 65 bits that a text is, otherwise null. */
function parseLineNumber(text) {
  return /^(0[xX][0-9A-Fa-f]{1,17}|0[bB][01]{1,65}|0|[1-9][0-9]{0,19})$/.test(text) ? BigInt(text) : null;
}

/** Return the width of a field in bits, from 1 to ``maxWidth``. */
function parseWidth(name, text, maxWidth = 64n) {
  const width = parseLineNumber(text);
  if (width === null || width < 1n || width > maxWidth) {
    throw new LineError(`${quoteText(text)} is not a width of '${name}'; write 1 to ${maxWidth}`, name.length + 1);
  }
  return Number(width);
}

/** Parse a field, such as position=32: {kind, name, bits, column} and members that depend on its kind. */
function parseLineField(text, column, interface_) {
  const equalsIndex = text.indexOf("=");
  if (!text.trim()) throw new LineError("a field is missing between two commas; remove one of them");
  const writtenName = (equalsIndex < 0 ? text : text.slice(0, equalsIndex)).trim();
  const values = equalsIndex < 0 ? [] : text.slice(equalsIndex + 1).split(":").map((value) => value.trim());
  if (!/^[A-Za-z][A-Za-z0-9_]{0,39}$/.test(writtenName)) {
    throw new LineError(
      `${quoteText(writtenName)} is not a name; use letters, digits and underscores, such as position=32`);
  }
  const name = writtenName.toLowerCase().split("_").filter(Boolean).join("_");
  if (name === "crc") return { ...parseCrc(values, interface_), column };
  if (name === "parity") return { ...parseParity(values), column };
  if (name === "zero" || name === "unused") {
    if (values.length !== 1) throw new LineError(`'${name}' takes only a width; write ${name}=2 for two bits`);
    return { kind: name, name, bits: parseWidth(name, values[0]), column };
  }
  if (values[0] === "low" || values[0] === "high") return { ...parseFlag(name, values), column };
  if (["error", "warning"].includes(name) && (!values.length || (values.length === 1 && values[0] === "1"))) {
    if (interface_ !== "biss") throw new LineError(`'${name}' has no active level; write ${name}=low or ${name}=high`);
    return { kind: "flag", name, bits: 1, level: "low", verdict: LINE_EFFECT_VERDICTS[name], column };
  }
  return { ...parseNumberField(name, values), column };
}

/** Parse a number or a constant. ``values`` are the texts after =, which colons separate. */
function parseNumberField(name, values) {
  if (!values.length || (values.length === 1 && !values[0])) {
    throw new LineError(`'${name}' has no width; write NAME=BITS for a number, NAME=low or NAME=high for a flag`);
  }
  if (name === "error" || name === "warning") {
    throw new LineError(`'${name}' is one bit; write ${name}=low or ${name}=high`, name.length + 1);
  }
  const width = parseWidth(name, values[0]);
  if (values.length === 1) return { kind: "number", name, bits: width };
  if (values.length === 2 && values[1] === "signed") return { kind: "number", name, bits: width, isSigned: true };
  const constant = parseLineNumber(values[1]);
  const valueOffset = name.length + values[0].length + 2;
  if (constant === null || values.length > 2) {
    const wrongText = quoteText(values.slice(1).join(":"));
    throw new LineError(
      `${wrongText} does not fit after a width; write signed, or the value of a constant`, valueOffset);
  }
  if (constant >> BigInt(width)) {
    throw new LineError(
      `${hex(constant)} does not fit into ${width} bits; write at most ${hex(ones(width))}`, valueOffset);
  }
  if (constant > HIGHEST_CONSTANT) {
    throw new LineError(
      `${hex(constant)} is too large; write at most ${hex(HIGHEST_CONSTANT)}, or two constants`, valueOffset);
  }
  if (name in LINE_NUMBER_UNITS) {
    throw new LineError(`'${name}' is not a constant; give the constant bits another name`, valueOffset);
  }
  return { kind: "constant", name, bits: width, value: constant };
}

/** Parse a flag: its active level, "low" or "high", and its effect. */
function parseFlag(name, values) {
  const effect = values[1] ?? (name in LINE_EFFECT_VERDICTS ? name : "status");
  if (values.length > 2 || !(effect in LINE_EFFECT_VERDICTS)) {
    const wrongText = quoteText(values.slice(1).join(":"));
    throw new LineError(`${wrongText} is not an effect of a flag; write error, warning or status`,
      name.length + values[0].length + 2);
  }
  return { kind: "flag", name, bits: 1, level: values[0], verdict: LINE_EFFECT_VERDICTS[effect] };
}

/** Parse a parity bit: even or odd. */
function parseParity(values) {
  if (values.length === 1 && (values[0] === "even" || values[0] === "odd")) {
    return { kind: "parity", name: "parity", bits: 1, isOdd: values[0] === "odd" };
  }
  throw new LineError("a parity bit is even or odd; write parity=even or parity=odd");
}

/** Words for the order of the bytes, with its name in the table. */
const BYTE_ORDER_WORDS = { low_byte_first: "little", high_byte_first: "big" };
/** Words for a CRC over bytes, and all words after the numbers of a CRC. */
const CRC_BYTES_WORDS = ["reflected", ...Object.keys(BYTE_ORDER_WORDS)];
const CRC_WORDS = ["inverted", "plain", ...CRC_BYTES_WORDS];
const CRC_WORDS_TEXT = ":inverted, :plain, :reflected, :low_byte_first or :high_byte_first";

/** Check the words after the numbers of a CRC: the interface and the width must allow each, and together. */
function checkCrcWords(words, width, interface_) {
  for (const word of words) {
    if (words.filter((other) => other === word).length > 1) {
      throw new LineError(`'${word}' is written twice; remove one of them`);
    }
    if (CRC_BYTES_WORDS.includes(word) && interface_ !== "rs485") {
      throw new LineError(`'${word}' is only for a CRC over RS-485, which consists of bytes; remove it`);
    }
    if (word in BYTE_ORDER_WORDS && width <= 8) {
      throw new LineError(`the CRC is one byte, so it has no byte order; remove '${word}'`);
    }
  }
  for (const [firstWord, secondWord] of [["inverted", "plain"], Object.keys(BYTE_ORDER_WORDS)]) {
    if (words.includes(firstWord) && words.includes(secondWord)) {
      throw new LineError(`'${firstWord}' and '${secondWord}' exclude each other; remove one of them`);
    }
  }
}

/** Parse a CRC: its width, its polynomial, and if they are there, its start value and words such as "inverted". */
function parseCrc(values, interface_) {
  if (values.length < 2) {
    throw new LineError("a CRC needs its width and polynomial; write crc=BITS:POLYNOMIAL, such as crc=6:0x43");
  }
  const width = parseWidth("crc", values[0], 32n);
  const crcNumbers = values.slice(1);
  const words = [];
  while (CRC_WORDS.includes(crcNumbers.at(-1))) words.push(crcNumbers.pop());
  checkCrcWords(words, width, interface_);
  const isInverted = words.includes("inverted") || (interface_ === "biss" && !words.includes("plain"));
  const polynomialOffset = "crc=".length + values[0].length + 1;
  if (crcNumbers.length < 1 || crcNumbers.length > 2) {
    throw new LineError(
      `write crc=BITS:POLYNOMIAL:START, and after it ${CRC_WORDS_TEXT} if needed`, polynomialOffset);
  }
  const poly = parseLineNumber(crcNumbers[0]);
  if (poly === null || !(poly & ONE) || poly > ones(width + 1)) {
    const remedy = `write an odd number of at most ${hex(ones(width + 1))}, with or without its top bit`;
    throw new LineError(
      `${quoteText(crcNumbers[0])} is not a polynomial of ${width} bits; ${remedy}`, polynomialOffset);
  }
  const init = crcNumbers.length > 1 ? parseLineNumber(crcNumbers[1]) : 0n;
  if (init === null || init > ones(width)) {
    throw new LineError(`${quoteText(crcNumbers[1])} is not a start value; write at most ${hex(ones(width))}`,
      polynomialOffset + crcNumbers[0].length + 1);
  }
  return {
    kind: "crc", name: "crc", bits: width, poly: poly & ones(width), init, isInverted,
    isReflected: words.includes("reflected"), order: BYTE_ORDER_WORDS[words.find((word) => word in BYTE_ORDER_WORDS)],
  };
}

// -- options

/** Return a clock frequency in Hz, or null if the text is not one of 1 Hz to 1 GHz. */
function parseHertz(text) {
  const match = /^([0-9]{1,12})([.][0-9]{1,6})?(|k|M)(?:Hz)?$/.exec(text);
  const hertz = match ? Number(match[1] + (match[2] ?? "")) * { "": 1, k: 1e3, M: 1e6 }[match[3]] : 0;
  return hertz >= 1 && hertz <= 1e9 ? Math.round(hertz) : null;
}

/** Return a number from 1 to 2^63 - 1, or null if the text is different. */
function parsePositive(text) {
  const number = parseLineNumber(text);
  return number && number < ONE << 63n ? number : null;
}

/** Return the hex digits of one to eight bytes, or null if the text is different. */
function parseRequest(text) {
  const digits = text.startsWith("0x") ? text.slice(2) : text;
  return /^([0-9A-Fa-f]{2}){1,8}$/.test(digits) && BigInt(`0x${digits}`) <= HIGHEST_CONSTANT ? digits : null;
}

/** Options that are a word, by that word: their interfaces, their member in the options of a line, and its value. */
const LINE_KEYWORDS = mergeByName({
  gray: [["biss", "ssi", "spi"], "isGray", true], binary: [LINE_INTERFACES, "isGray", false],
  left: [["ssi"], "alignment", "msb_left"], right: [["ssi"], "alignment", "lsb_right"],
  low_byte_first: [["spi", "rs485"], "order", "little"], high_byte_first: [["spi", "rs485"], "order", "big"],
});
/** Options with a value, by name: their interfaces, the function that parses the value or returns null, an example. */
const LINE_SETTINGS = mergeByName({
  clock: [["biss", "ssi", "spi"], parseHertz, "clock=1MHz"],
  mode: [["spi"], (text) => (/^[0-3]$/.test(text) ? Number(text) : null), "mode=1"],
  baud: [["rs485"], parsePositive, "baud=2500000"], request: [["rs485"], parseRequest, "request=1A"],
  counts: [LINE_INTERFACES, parsePositive, "counts=4096"], turns: [LINE_INTERFACES, parsePositive, "turns=4096"],
});
/** Join names as a list in words, such as "a, b and c". */
const joinNames = (names, conjunction = "and") =>
  (names.length > 1 ? `${names.slice(0, -1).join(", ")} ${conjunction} ${names.at(-1)}` : names[0]);

/** Parse an option and add it to ``options``, with its member as key. */
function setLineOption(options, text, interface_) {
  const equalsIndex = text.indexOf("=");
  const name = (equalsIndex < 0 ? text : text.slice(0, equalsIndex)).trim();
  const settingText = equalsIndex < 0 ? "" : text.slice(equalsIndex + 1).trim();
  const [keyword, setting] = [LINE_KEYWORDS[name], LINE_SETTINGS[name]];
  if (!keyword && !setting) {
    const allNames = joinNames([...Object.keys(LINE_KEYWORDS), ...Object.keys(LINE_SETTINGS)], "or");
    throw new LineError(`${quoteText(name)} is not an option; write ${allNames} (a field belongs after the colon)`);
  }
  const [interfaces] = keyword ?? setting;
  if (!interfaces.includes(interface_)) {
    throw new LineError(`'${name}' is not an option of ${interface_}, only of ${joinNames(interfaces)}; remove it`);
  }
  if (keyword) {
    if (equalsIndex >= 0) throw new LineError(`'${name}' has no value; write only ${name}`, name.length);
    return Object.assign(options, { [keyword[1]]: keyword[2] });
  }
  const settingValue = setting[1](settingText);
  if (settingValue === null) {
    throw new LineError(
      `${quoteText(settingText)} is not a value of '${name}'; write it like ${setting[2]}`, name.length + 1);
  }
  return Object.assign(options, { [name]: settingValue });
}

// -- the line

/** Return the parts of a text between commas, each with the column of its first character after blanks. */
function splitAtCommas(text, column) {
  let nextColumn = column;
  return text.split(",").map((piece) => {
    const pieceColumn = nextColumn + (piece.trim() ? piece.length - piece.trimStart().length : 0);
    nextColumn += piece.length + 1;
    return [pieceColumn, piece.trim()];
  });
}

/** Return {text, interface, options, fields, problems} of a line. A problem is [column, message], sorted by column. */
function parsedLine(untrimmedLine) {
  const lineText = untrimmedLine.trim();
  if (lineText.length > LONGEST_LINE) {
    return { problems: [[1, `the line is longer than ${LONGEST_LINE} characters; shorten it`]] };
  }
  const wrongIndex = lineText.search(/[^A-Za-z0-9_=:,. ]/);
  if (wrongIndex >= 0) {
    const [character] = lineText.slice(wrongIndex);
    return { problems: [[wrongIndex + 1, `'${character}' is not a character of a line; write ${LINE_EXAMPLE}`]] };
  }
  const problems = [];
  const [interface_, headLength] = parseInterface(lineText, problems);
  const options = {};
  const columns = {};
  for (const [column, piece] of splitAtCommas(lineText.slice(0, headLength), 1).slice(1)) {
    collectProblem(column, problems, () => {
      setLineOption(options, piece, interface_);
      columns[piece.split("=")[0].trim()] = column;
    });
  }
  const fieldsStart = headLength ? headLength + 1 : 0;
  const fields = fieldsStart <= lineText.length
    ? parseLineFields(lineText.slice(fieldsStart), fieldsStart + 1, interface_, problems) : [];
  if (fields.length) problems.push(
    ...checkLineFields(fields, interface_), ...checkLineOptions(options, columns, fields, interface_));
  return {
    text: lineText, interface: interface_, options, fields,
    problems: problems.sort(([column], [otherColumn]) => column - otherColumn),
  };
}

/** Call ``parse``, and add the problem to the list if it throws a ``LineError``. */
function collectProblem(column, problems, parse) {
  try {
    parse();
  } catch (error) {
    if (!(error instanceof LineError)) throw error;
    problems.push([column + error.offset, error.message]);
  }
}

/** Return the interface of a line and the length of its head, which is the interface and the options. */
function parseInterface(lineText, problems) {
  const colon = lineText.indexOf(":");
  const head = colon < 0 ? lineText : lineText.slice(0, colon);
  const firstWord = head.split(",")[0].trim();
  const interface_ = firstWord.toLowerCase();
  if (LINE_INTERFACES.includes(interface_)) {
    if (colon < 0) {
      problems.push([
        lineText.length + 1, `there is no colon after '${interface_}' and its options; write ${LINE_EXAMPLE}`]);
    }
    return [interface_, head.length];
  }
  if (firstWord.includes("=") || ["error", "warning", "position"].includes(interface_) || colon < 0) {
    problems.push([1, "the line does not begin with its interface; write biss:, ssi:, spi: or rs485: in front of it"]);
    return ["biss", 0];
  }
  problems.push([1, `${quoteText(firstWord)} is not an interface; write one of: ${LINE_INTERFACES.join(", ")}`]);
  return ["biss", head.length];
}

/** Parse the fields of a line, and add the problems to the list. */
function parseLineFields(text, column, interface_, problems) {
  const fields = [];
  if (!text.trim()) {
    problems.push([column, `the line has no fields; write ${LINE_EXAMPLE}`]);
    return fields;
  }
  const pieces = splitAtCommas(text, column);
  if (pieces.length > MOST_LINE_FIELDS) {
    problems.push([pieces[MOST_LINE_FIELDS][0], `write at most ${MOST_LINE_FIELDS} fields`]);
  }
  for (const [pieceColumn, piece] of pieces.slice(0, MOST_LINE_FIELDS)) {
    collectProblem(pieceColumn, problems, () => fields.push(parseLineField(piece, pieceColumn, interface_)));
  }
  return fields;
}

/** Return whether a field is zero or unused bits, whose names may occur twice. */
const isFiller = (field) => field.kind === "zero" || field.kind === "unused";
/** Return whether a field is the position or its part within one revolution. */
const isPosition = (field) => field.name === "position" || field.name === "singleturn";
/** Return the bits of all fields together. */
const sumFieldBits = (fields) => fields.reduce((sum, field) => sum + field.bits, 0);

/** Return the problems with the names and the order of the fields, and with their bits in all. */
function checkLineFields(fields, interface_) {
  const problems = [];
  const names = new Set();
  for (const field of fields) {
    const { name, column, kind } = field;
    if (!isFiller(field) && names.has(name)) problems.push([
      column, `a second field has the name '${name}'; rename one of them`]);
    names.add(name);
    if (kind === "crc" && field !== fields.at(-1)) problems.push([
      column, "the CRC must be the last field; move it to the end"]);
    if (kind === "crc" && interface_ === "rs485" && field.bits % 8) {
      problems.push([column, `the CRC has ${field.bits} bits; over RS-485, write whole bytes`]);
    }
    if (kind === "parity" && fields.every((other) => ["parity", "crc", "zero", "constant"].includes(other.kind))) {
      problems.push([column, "a parity bit needs other fields that change; add them"]);
    }
  }
  return [...problems, ...checkPositionFields(fields, interface_), ...checkLineLength(fields, interface_)];
}

/** Return the problems with the position and its two parts. */
function checkPositionFields(fields, interface_) {
  const lastIndexOf = (name) => fields.findLastIndex((field) => field.name === name);
  const [positionIndex, multiturnIndex, singleturnIndex] = ["position", "multiturn", "singleturn"].map(lastIndexOf);
  const problems = [];
  if (positionIndex >= 0 && (multiturnIndex >= 0 || singleturnIndex >= 0)) {
    problems.push([fields[positionIndex].column,
      "'position' is the whole position; write either it, or multiturn and singleturn"]);
  }
  if (multiturnIndex < 0) return problems;
  if (singleturnIndex < 0) problems.push([fields[multiturnIndex].column,
    "'multiturn' needs 'singleturn'; add singleturn=BITS"]);
  else if (multiturnIndex > singleturnIndex && interface_ !== "rs485") {
    problems.push([fields[multiturnIndex].column,
      "'multiturn' must be before 'singleturn'; swap the two, or write position=BITS"]);
  }
  return problems;
}

/** Return a list with the problem if the fields have too few or too many bits. */
function checkLineLength(fields, interface_) {
  const bitCount = sumFieldBits(fields);
  const [minBits, maxBits] = [
    interface_ === "spi" || interface_ === "rs485" ? 8 : 1, interface_ === "rs485" ? 1024 : 64];
  if (bitCount < minBits || bitCount > maxBits) {
    return [[fields[0].column, `the fields have ${bitCount} bits; write ${minBits} to ${maxBits}`]];
  }
  if (interface_ !== "rs485" || bitCount % 8 === 0) return [];
  return [[fields[0].column, `the fields have ${bitCount} bits; over RS-485, write whole bytes`]];
}

/** Return the problems of options with the fields. ``columns`` are the columns of the options, by name. */
function checkLineOptions(options, columns, fields, interface_) {
  return [
    ...(options.isGray ? checkGrayOption(options, columns, fields) : []),
    ...(options.counts || options.turns ? checkCountOptions(options, columns, fields) : []),
    ...checkByteOrder(options, fields, interface_),
  ];
}

/** Return the problems of Gray code with the fields. */
function checkGrayOption(options, columns, fields) {
  const positionFields = fields.filter(isPosition);
  const hasTurns = fields.some((field) => field.name === "multiturn");
  const problems = positionFields.length ? []
    : [[columns.gray ?? 1, "'gray' needs a position; add position=BITS, or remove gray"]];
  const [multiturnIndex, singleturnIndex] = ["multiturn", "singleturn"].map(
    (name) => fields.findIndex((field) => field.name === name));
  if (multiturnIndex >= 0 && singleturnIndex > multiturnIndex + 1) {
    problems.push([fields[singleturnIndex].column,
      "with gray, 'singleturn' must follow 'multiturn' directly; move the fields between them"]);
  }
  for (const { name, bits: width, column, isSigned } of positionFields) {
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

/** Return the problems of the counts and turns with the fields. */
function checkCountOptions(options, columns, fields) {
  const column = columns.counts ?? columns.turns ?? 1;
  const positionFields = fields.filter((field) => field.kind === "number" && field.name === "position");
  const problems = positionFields.length ? [] : [[column,
    "'counts' and 'turns' need a field 'position'; singleturn and multiturn already give them"]];
  const { counts = 0n, turns = 0n } = options;
  if (turns && !counts) problems.push([
    columns.turns ?? 1, "'turns' needs the counts per revolution; add counts=NUMBER"]);
  for (const [name, count] of [["counts", counts], ["turns", turns]]) {
    if (count >= LEAST_SUSPICIOUS_COUNTS && !(count & (count + ONE))) {
      problems.push([columns[name] ?? 1,
        `${count} is the highest value; including 0 there are ${count + ONE}, so write ${name}=${count + ONE}`]);
    }
  }
  for (const field of positionFields) {
    const mostCounts = ONE << BigInt(field.bits);
    if (counts * (turns || ONE) > mostCounts) {
      problems.push([column, `${counts} counts × ${turns || ONE} turns do not fit into ${field.bits} bits; `
        + `write at most ${mostCounts} counts in all`]);
    }
    if (field.isSigned) {
      problems.push([
        column, "a signed position has no counts in a line; remove counts, and add its range to the spec"]);
    }
  }
  return problems;
}

/** Return the problems of the byte order with the fields. */
function checkByteOrder(options, fields, interface_) {
  const problems = [];
  let bitOffset = 0;
  for (const field of fields) {
    const isWide = field.bits > 8 && !isFiller(field);
    if (interface_ === "rs485" && isWide && !options.order && !field.order) {
      problems.push([field.column,
        `the byte order of '${field.name}' is not known; write rs485,low_byte_first: or high_byte_first`]);
    }
    const isSplitIntoBytes = interface_ === "spi" && options.order === "little"
      && ["number", "constant"].includes(field.kind);
    if (isSplitIntoBytes && isWide && (bitOffset % 8 || field.bits % 8)) {
      problems.push([field.column,
        `'${field.name}' is not whole bytes, so low_byte_first cannot apply; add zero or unused bits`]);
    }
    if (isSplitIntoBytes && isWide && (field.isSigned || field.kind === "constant")) {
      problems.push([field.column,
        `'${field.name}' is signed or a constant, and cannot be sent low byte first; write its bytes`]);
    }
    bitOffset += field.bits;
  }
  return problems;
}

// -- the record

/** Omit members that are 0, empty or false, and return the others. */
const omitEmpty = (members) => Object.fromEntries(Object.entries(members).filter(
  ([, member]) => member && (typeof member !== "object" || Object.keys(member).length)));
/** Return a number as the table has it: as text if it is too large for a JavaScript number. */
const toTableNumber = (number) => (number <= BigInt(Number.MAX_SAFE_INTEGER) ? Number(number) : hex(number));

/**
 * List the fields as they are sent, each with a name of its own and its lowest bit ``low``.
 * A number sent low byte first is split into bytes.
 */
function listSentFields({ interface: interface_, options, fields }) {
  const fieldNames = new Set(fields.filter((field) => !isFiller(field)).map((field) => field.name));
  const isLowByteFirst = options.order === "little";
  const sentFields = [];
  const sentNames = new Set();
  for (const field of fields) {
    if (interface_ === "spi" && isLowByteFirst && field.kind === "number" && field.bits > 8) {
      for (let byteIndex = 0; byteIndex < field.bits / 8; byteIndex += 1) {
        sentFields.push({ kind: "byte", name: `${field.name}_byte_${byteIndex}`, of: field.name, bits: 8 });
      }
      continue;
    }
    let { name } = field;
    if (isFiller(field)) {
      name = `${field.name}_bits`;
      for (let index = 2; sentNames.has(name) || fieldNames.has(name); index += 1) name = `${field.name}_bits_${index}`;
    }
    sentNames.add(name);
    sentFields.push({ ...field, name });
  }
  const isLowBitFirst = interface_ === "rs485" && isLowByteFirst;
  const bitCount = sumFieldBits(fields);
  let bitOffset = 0;
  for (const field of sentFields) {
    field.low = isLowBitFirst ? bitOffset : bitCount - bitOffset - field.bits;
    bitOffset += field.bits;
  }
  return sentFields;
}

/** Add to each unused field its place among the unused bits. */
function placeUnusedBits(sentFields, interface_) {
  const unusedFields = sentFields.filter((field) => field.kind === "unused")
    .sort((field, other) => field.low - other.low);
  if (interface_ !== "rs485") {
    let bitOffset = 0;
    for (const field of unusedFields) {
      field.place = bitOffset;
      bitOffset += field.bits;
    }
    return;
  }
  const unusedBytes = [...new Set(unusedFields.flatMap(({ low, bits: width }) => {
    const firstByte = Math.floor(low / 8);
    return Array.from({ length: Math.floor((low + width - 1) / 8) - firstByte + 1 }, (_, index) => firstByte + index);
  }))].sort((first, second) => first - second);
  for (const field of unusedFields) field.place = 8 * unusedBytes.indexOf(Math.floor(field.low / 8)) + (field.low % 8);
}

/** Build the numbers that are joined from several fields: split numbers, and the position from its two parts. */
function buildJoins(sentFields) {
  const buildJoin = (name, partFields) => {
    let shift = 0;
    return { name, fields: partFields.map((field) => {
      const nameAndShift = [field.name, shift];
      shift += field.bits;
      return nameAndShift;
    }) };
  };
  const partsNamed = (name) => sentFields.filter(
    (field) => field.of === name || (field.kind === "number" && field.name === name));
  const splitNames = [...new Set(sentFields.map((field) => field.of).filter(Boolean))];
  const joins = splitNames.map((name) => buildJoin(name, partsNamed(name)));
  const [multiturnParts, singleturnParts] = [partsNamed("multiturn"), partsNamed("singleturn")];
  return multiturnParts.length && singleturnParts.length
    ? [...joins, buildJoin("position", [...singleturnParts, ...multiturnParts])] : joins;
}

/** Return whether a field has the same bits in every frame. */
const isConstant = (field) => field.kind === "zero" || field.kind === "constant";
/** Count the 1 bits in a number. */
const countOnes = (number) => number.toString(2).replaceAll("0", "").length;

/** Return the other fields of a parity bit that change, and whether their number of 1 bits must be odd with it. */
function findParityCoverage(field, sentFields) {
  const otherFields = sentFields.filter((other) => !["parity", "crc"].includes(other.kind));
  const constantOnes = otherFields.filter((other) => other.kind === "constant")
    .reduce((sum, constant) => sum + countOnes(constant.value), 0);
  return {
    covered: otherFields.filter((other) => !isConstant(other)), isOdd: (Number(field.isOdd) + constantOnes) % 2,
  };
}

/** Color of a field in the drawing of a frame, by kind. Other fields have the color of data. */
const LINE_COLOURS = { flag: "flag", zero: "fixed", constant: "fixed", crc: "check", parity: "check" };

/** Build the record of a field, as in the table. */
function buildFieldRecord(field, sentFields, hasPosition) {
  const { name, bits: width, low } = field;
  const colour = field.kind === "unused" && hasPosition ? "fixed" : LINE_COLOURS[field.kind] ?? "data";
  const record = { name, ...omitEmpty({ low }), width, colour };
  switch (field.kind) {
    case "flag":
      return { ...record, kind: field.level === "low" ? "not_flag" : "flag", on: LINE_VERDICT_MEANINGS[field.verdict] };
    case "zero": return { ...record, fixed: 0 };
    case "constant": return { ...record, fixed: toTableNumber(field.value) };
    case "unused": return hasPosition ? { ...record, unused: 0, place: field.place } : record;
    case "crc": return { ...record, crc: 1 };
    case "parity": {
      const { covered, isOdd } = findParityCoverage(field, sentFields);
      return { ...record, parity: covered.map((coveredField) => coveredField.name), odd: isOdd };
    }
    default: {
      const [unit, meaning] = LINE_NUMBER_UNITS[name] ?? [];
      return { ...record, ...omitEmpty({ kind: field.isSigned ? "signed" : "", meaning, unit }) };
    }
  }
}

/** Build the checks of constants and parity bits, and then the check of the highest position. */
function buildCheckRecords(sentFields, { counts = 0n, turns = ONE }) {
  const lowAndWidth = (field) => ({ ...omitEmpty({ low: field.low }), width: field.bits });
  const checks = sentFields.flatMap((field) => {
    const placeAndFault = { ...lowAndWidth(field), fault: "constant" };
    if (isConstant(field)) {
      return [{
        ...placeAndFault, values: [toTableNumber(field.value ?? 0n)], field: field.name, says: "constant", always: 1,
      }];
    }
    if (field.kind !== "parity") return [];
    const { covered, isOdd } = findParityCoverage(field, sentFields);
    return [{ ...placeAndFault, parity_of: covered.map((coveredField) => [coveredField.low, coveredField.bits]),
      ...omitEmpty({ odd: isOdd }), field: field.name,
      says: "parity", always: 1, of_names: covered.map((coveredField) => coveredField.name) }];
  });
  const limitedFields = sentFields.filter((field) => field.kind === "number" && field.name === "position" && counts
    && counts * turns <= ones(field.bits));
  return [...checks, ...limitedFields.map((field) => ({
    ...lowAndWidth(field), fault: "range", limit: toTableNumber(counts * turns - ONE), field: field.name,
    says: "too_high",
  }))];
}

/** Build the description of the measured position: its field, and its counts and revolutions. */
function buildMeasure({ fields, options }, joins) {
  const widthOf = (name) => fields.find((field) => field.kind === "number" && field.name === name)?.bits;
  const [singleturnBits, multiturnBits] = [widthOf("singleturn"), widthOf("multiturn")];
  if (singleturnBits === undefined && !options.counts) return {};
  const measuredName = multiturnBits !== undefined || singleturnBits === undefined ? "position" : "singleturn";
  const counts = singleturnBits === undefined ? options.counts : ONE << BigInt(singleturnBits);
  const revolutions = singleturnBits === undefined ? options.turns ?? ONE : ONE << BigInt(multiturnBits ?? 0);
  const lowestPart = joins.find((join) => join.name === measuredName)?.fields[0][0];
  return omitEmpty({
    of: measuredName, part: lowestPart, counts_per_turn: toTableNumber(counts), turns: toTableNumber(revolutions),
  });
}

/** Build the parameters of a CRC, and of similar CRCs that may be used by mistake. */
function buildCrcRecord({ bits: width, poly, init, isInverted, isReflected }, isOverBytes) {
  const parametersWith = (changes) => omitEmpty(Object.fromEntries(Object.entries({
    width: BigInt(width), poly, init, refin: BigInt(isReflected), refout: BigInt(isReflected), xorout: isInverted ? ones(width) : 0n, ...changes,
  }).map(([name, number]) => [name, toTableNumber(number)])));
  const ownParameters = parametersWith({});
  const otherXorout = isInverted ? 0n : ones(width);
  const isXorOfBytes = isOverBytes && width === 8 && poly === ONE && !init;
  const inversionText = `the CRC is ${isInverted ? "not " : ""}inverted`;
  const sameEffectText = isXorOfBytes ? `, or its start value is ${hex(ones(width) ^ init)} (the same here)` : "";
  const startValues = isXorOfBytes ? [] : listOtherStartValues(width, poly, init);
  const similarCrcs = [["crc_not_inverted", inversionText + sameEffectText, parametersWith({ xorout: otherXorout })],
    ...startValues.map((startValue) => [
      "start_value", `the start value of the CRC is ${hex(startValue)}`, parametersWith({ init: startValue })]),
    ...(isOverBytes ? buildOtherByteCrcs({ width, poly, isInverted, isReflected }, parametersWith)
      : [buildReversedPolynomial(width, poly, parametersWith)])];
  const powers = Array.from({ length: width }, (_, index) => width - 1 - index)
    .filter((power) => extractBits(poly, power, 1));
  const polynomialText = [width, ...powers].map((power) => ["1", "x"][power] ?? `x^${power}`).join(" + ");
  const isDifferent = ([, , crc]) => JSON.stringify(crc) !== JSON.stringify(ownParameters);
  return {
    ...ownParameters, text: polynomialText,
    ...omitEmpty({ [isOverBytes ? "byte_others" : "others"]: similarCrcs.filter(isDifferent) }),
  };
}

/** List all zeros, all ones, and the start values of known CRCs with the polynomial, without its own. */
function listOtherStartValues(width, poly, init) {
  const hasPolynomial = ([knownPolynomial]) => toBigInt(knownPolynomial) === (poly | (ONE << BigInt(width)));
  const startValues = new Set([
    0n, ones(width), ...TABLE.known_crcs.filter(hasPolynomial).map(([, knownInit]) => BigInt(knownInit))]);
  return [...startValues].filter((startValue) => startValue !== init)
    .sort((first, second) => (first < second ? -1 : 1));
}

/** Build the similar CRC whose polynomial is written in reverse: [kind, text, parameters]. */
function buildReversedPolynomial(width, poly, parametersWith) {
  const withTopBit = poly | (ONE << BigInt(width));
  const reversed = BigInt(`0b${[...withTopBit.toString(2)].reverse().join("")}`);
  return ["polynomial_reversed", `the polynomial is ${hex(reversed)}, written in reverse`,
    parametersWith({ poly: reversed & ones(width) })];
}

/** Build the similar CRCs over bytes with other polynomials, of which CRCs of 8 and 16 bits have usual ones. */
function buildOtherByteCrcs(crc, parametersWith) {
  if (crc.width === 16) return buildOtherCrcsOf16Bits(crc, parametersWith);
  return crc.width === 8 ? buildOtherBytePolynomials(parametersWith) : [];
}

/** Build usual CRCs of 16 bits that differ in more than the start value, and this one with the other bit order. */
function buildOtherCrcsOf16Bits({ poly, isInverted, isReflected }, parametersWith) {
  const reflectedIf = (isTrue) => ({ refin: BigInt(isTrue), refout: BigInt(isTrue) });
  const usualCrcs = TABLE.crcs_of_16_bits.map(([name, usualPoly, usualInit, isUsualReflected]) => {
    const usualPolynomial = toBigInt(usualPoly);
    const parameters = parametersWith({
      poly: usualPolynomial, init: toBigInt(usualInit), xorout: 0n, ...reflectedIf(isUsualReflected) });
    const differsInStartValue = usualPolynomial === poly && isUsualReflected === isReflected && !isInverted;
    return { mistake: ["other_polynomial", `the CRC is that of ${name}`, parameters], differsInStartValue };
  });
  const inOtherOrder = parametersWith(reflectedIf(!isReflected));
  const isUsual = usualCrcs.some(({ mistake }) => JSON.stringify(mistake[2]) === JSON.stringify(inOtherOrder));
  const orderText = isReflected ? "most" : "least";
  const others = usualCrcs.filter(({ differsInStartValue }) => !differsInStartValue).map(({ mistake }) => mistake);
  return isUsual ? others
    : [...others, ["crc_reversed", `the CRC is computed ${orderText} significant bit first`, inOtherOrder]];
}

/** Build the similar CRCs over bytes with the usual polynomials, in both bit orders. */
function buildOtherBytePolynomials(parametersWith) {
  return TABLE.byte_polynomials.flatMap((polynomial) => {
    const poly = toBigInt(polynomial) & 0xFFn;
    const text = `the polynomial is ${hex(toBigInt(polynomial))}`;
    return [["other_polynomial", `${text}, most significant bit first`,
      parametersWith({ poly, refin: 0n, refout: 0n })],
      ["other_polynomial", `${text}, least significant bit first`, parametersWith({ poly, refin: ONE, refout: ONE })]];
  });
}

/** Build the request of a line over RS-485, or one byte of any value. */
function buildRequestFrame(options) {
  const requestNumber = options.request && BigInt(`0x${options.request}`);
  const width = options.request ? 4 * options.request.length : 8;
  const fieldContent = options.request ? { colour: "fixed", fixed: toTableNumber(requestNumber) }
    : { meaning: "Request", colour: "data" };
  const check = {
    width, fault: "constant", values: [toTableNumber(requestNumber || 0n)], field: "request", says: "constant",
    always: 1,
  };
  return {
    name: "position_request", bits: width, order: "big", fields: [{ name: "request", width, ...fieldContent }],
    ...omitEmpty({ checks: options.request ? [check] : [] }), title: "Position request",
    source: options.request ? "line: fields" : "TODO not stated", sender: "master",
  };
}

/** List the place of the CRC in the bytes of a frame if its bytes have another order than the frame. */
function listExchangedBytes({ options, fields }) {
  const { kind, bits: width, order } = fields.at(-1);
  const byteCount = sumFieldBits(fields) / 8;
  return kind === "crc" && order && order !== (options.order ?? "big") ? [[byteCount - width / 8, byteCount]] : [];
}

/** Build the frame from the encoder. Its fields, checks and reports are records, which ``lineFamily`` numbers. */
function buildEncoderFrame(line) {
  const { interface: interface_, options, fields } = line;
  const sentFields = listSentFields(line);
  placeUnusedBits(sentFields, interface_);
  const hasPosition = fields.some(isPosition);
  const flags = sentFields.filter((field) => field.kind === "flag");
  const decidingFlags = hasPosition ? ["not_usable", "usable_with_warning"].flatMap(
    (verdict) => flags.filter((flag) => flag.verdict === verdict)) : [];
  const reportedFlags = flags.filter((flag) => !hasPosition || flag.verdict !== "usable");
  const joins = buildJoins(sentFields);
  const grayFields = sentFields.filter((field) => LINE_NUMBER_UNITS[field.name] || LINE_NUMBER_UNITS[field.of]);
  const lowestGrayBit = Math.min(...grayFields.map((field) => field.low));
  const [name, title] = LINE_LAYOUT_NAMES[interface_];
  return {
    name, bits: sumFieldBits(fields),
    ...omitEmpty({
      order: interface_ === "rs485" ? options.order ?? "big" : "",
      exchanged: listExchangedBytes(line),
      joins,
      speaks: decidingFlags.map((flag) => ({ verdict: flag.verdict, flag: flag.name })),
      gray: options.isGray ? { ...omitEmpty({ low: lowestGrayBit }), width: sumFieldBits(grayFields) } : {},
    }),
    ...(hasPosition ? { otherwise: decidingFlags.length ? "usable" : "unknown" } : {}),
    fields: sentFields.map((field) => buildFieldRecord(field, sentFields, hasPosition)),
    ...omitEmpty({
      checks: buildCheckRecords(sentFields, options), crc: fields.at(-1).kind === "crc" ? "line_crc" : "",
    }),
    title, source: "line: fields", sender: "encoder",
    ...omitEmpty({ tells: reportedFlags.map((flag) => (
      { report: flag.name, flag: flag.name, meaning: LINE_VERDICT_MEANINGS[flag.verdict] })) }),
  };
}

/** Return the record of the family that a line describes, like the records in the table. */
function lineFamily(line) {
  const { interface: interface_, options, fields } = line;
  const shared = [];
  const indexes = new Map();
  const indexOfRecord = (record) => {
    const key = JSON.stringify(record);
    if (!indexes.has(key)) indexes.set(key, shared.push(record) - 1);
    return indexes.get(key);
  };
  const encoderFrame = buildEncoderFrame(line);
  const joins = encoderFrame.joins ?? [];
  const frames = [...(interface_ === "rs485" ? [buildRequestFrame(options)] : []), encoderFrame];
  const indexedFrames = frames.map((layout) => ({ ...layout, ...Object.fromEntries(["fields", "checks", "tells"]
    .filter((name) => layout[name]).map((name) => [name, layout[name].map(indexOfRecord)])) }));
  const lineCrcField = fields.find((field) => field.kind === "crc");
  const lineName = interface_ === "ssi" ? `ssi_${options.alignment ?? "msb_left"}` : interface_;
  return {
    name: "one_line", title: "Encoder described in one line", mark: TABLE.line.mark, evidence: TABLE.line.evidence,
    ...omitEmpty({ crcs: lineCrcField ? { line_crc: buildCrcRecord(lineCrcField, interface_ === "rs485") } : {} }),
    interfaces: [{
      name: interface_, title: LINE_TITLES[interface_],
      ...omitEmpty({ line: interface_ === "rs485" ? "" : lineName, measure: buildMeasure(line, joins) }),
      frames: indexedFrames,
    }],
    shared,
    codes: [[line.text, 0]],
  };
}

/** Return the order code of a line. Throws ``UnknownCode`` with all problems of the line. */
function readLine(lineText) {
  const line = parsedLine(lineText);
  if (line.problems.length) {
    throw new UnknownCode(line.problems.map(([column, message]) => `column ${column}: ${message}`).join(". "), true);
  }
  const family = lineFamily(line);
  return {
    ...orderCodeOfRow(family, family.codes[0]), unlisted: [], tail: "", isSpecial: false, writtenAsIn: "",
    label: lineText,
  };
}
