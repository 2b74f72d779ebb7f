// Licence 0BSD: use, modify and distribute this file without any condition.
// Parsing of frames and labels, and inference of order codes from a frame.

class FrameText extends Error {}

/** Most bits of a frame over BiSS, SSI and SPI. */
const MAX_FRAME_BITS = 128;
const MAX_QUOTE_LENGTH = TABLE.limits.quote;
const quoteText = (text) => (text.length <= MAX_QUOTE_LENGTH ? `'${text}'` : `'${text.slice(0, MAX_QUOTE_LENGTH - 3)}...'`);

/** Spellings of programs and logs, and their replacement. The command line has the same list. */
const PASTED_SPELLINGS = [
  [/\bb(?=['"])/g, ""],
  [/\\x([0-9A-Fa-f]{2})/g, " 0x$1 "],
  [/[[\](){}<>"',;:]/g, " "],
  [/(?<![0-9A-Za-z])([0-9A-Fa-f]{2})-(?=[0-9A-Fa-f]{2}(?![0-9A-Za-z]))/g, "$1 "],
  [/(?<![0-9A-Za-z])(?:0[xX])?([0-9A-Fa-f]+)[hH](?![0-9A-Za-z])/g, "0x$1"],
  [/(?<![0-9A-Za-z])(0[xXbB][0-9A-Fa-f_]+)[uUlL]+(?![0-9A-Za-z])/g, "$1"],
];
/** A time in front of a frame: with a decimal point, a unit, or hours, minutes and seconds. */
const LEADING_TIME = new RegExp("^\\[?((?:[0-9]{4}-[0-9]{2}-[0-9]{2}[T ])?[0-9]{1,2}:[0-9]{2}:[0-9]{2}(?:[.,][0-9]+)?Z?"
  + "|[0-9]+[.][0-9]+(?: ?(?:s|ms|us|µs))?|[0-9]+ ?(?:s|ms|us|µs))\\]?[ \\t,;]+(?=[^ \\t])");

/** The frames in a text, one per line. Comments after # and empty lines are skipped. */
function linesOf(input) {
  return input.split(/\r\n|\r|\n/).flatMap((line, place) => {
    const kept = line.split("#")[0].trim();
    const time = LEADING_TIME.exec(kept);
    const text = time ? kept.slice(time[0].length) : kept;
    return text ? [{ number: place + 1, time: time ? time[1] : "", text }] : [];
  });
}

/** The text of a frame without brackets, quotes and other marks of the program that it was copied from. */
function checked(text) {
  if (text.length > TABLE.limits.text) throw new FrameText(said("frame_too_long"));
  const plain = PASTED_SPELLINGS.reduce((made, [pattern, other]) => made.replace(pattern, other), text).trim();
  if (!plain) throw new FrameText(said("frame_empty"));
  return plain;
}

/** Hex bytes, in pieces of whole bytes. */
function bytesIn(text) {
  return text.split(/\s+/).flatMap((piece) => {
    const digits = piece.replace(/^0x/i, "");
    if (!/^[0-9a-f]+$/i.test(digits)) throw new FrameText(said("not_hex", quoteText(piece)));
    const whole = digits !== piece && digits.length === 1 ? `0${digits}` : digits;
    if (whole.length === 1) throw new FrameText(said("one_digit", quoteText(piece), digits));
    if (whole.length % 2) throw new FrameText(said("odd", quoteText(piece)));
    return whole.match(/../g).map((byte) => parseInt(byte, 16));
  });
}

/**
 * One number of ``size`` bits: 0b with all leading zeros, or 0x or hex bytes, which imply them. If ``exact``, bytes do not.
 */
function numberIn(text, size, exact) {
  let compact = text.replace(/[\s_]/g, "");
  if (/^0b[01]+$/i.test(compact)) return makeReceivedNumber(compact, compact.length - 2, true);
  const pieces = text.split(/\s+/);
  if (pieces.length > 1 && pieces.every((piece) => /^(0x)?[0-9a-f]{2}$/i.test(piece))) {
    if (/^[01]+$/.test(pieces.join(""))) throw new FrameText(said("bits_or_bytes", quoteText(text)));
    compact = "0x" + pieces.map((piece) => piece.slice(-2)).join("");
    const bits = 8 * pieces.length;
    if (exact && (bits < size || bits >= size + 8)) return makeReceivedNumber(compact, bits, true);
  }
  if (/^0x[0-9a-f]+$/i.test(compact)) {
    return { ...makeReceivedNumber(compact, bitLength(BigInt(compact)), false), written: 4 * (compact.length - 2) };
  }
  const meanings = pieces.length === 1 ? listMeanings(compact, size) : [];
  // As a decimal or hexadecimal number, this many digits would not fit.
  if (meanings.length === 1 && compact.length === size && /^[01]+$/.test(compact)) {
    return makeReceivedNumber(`0b${compact}`, size, true);
  }
  const remedy = meanings.length ? said("write_one_of", meanings.join(", ")) : said("write_number", size);
  throw new FrameText(said("no_bits", quoteText(text), size, remedy));
}

/** A number with its bits. If not ``exact``, it may have more. ``written`` counts the bits of all digits. */
const makeReceivedNumber = (text, bits, exact) => ({ number: BigInt(text), bits, exact, written: bits });

/** The possible meanings of digits without a prefix, as numbers of at most ``size`` bits. The command line does the same. */
function listMeanings(digits, size) {
  const fits = (number) => number >> BigInt(size) === 0n;
  const decimal = /^(0|[1-9][0-9]{0,39})$/.test(digits) && fits(BigInt(digits));
  const hexadecimal = /^[0-9a-f]{1,40}$/i.test(digits) && fits(BigInt(`0x${digits}`));
  return [
    ...(decimal ? [said("if_decimal", `0x${BigInt(digits).toString(16).toUpperCase()}`)] : []),
    ...(hexadecimal ? [said("if_hex", digits)] : []),
    ...(/^[01]{1,96}$/.test(digits) ? [said("if_bits", digits)] : []),
  ];
}

/** The message about a text that is not a valid frame of any order code: how to write it, if that is the reason. */
function notOfAnyCode(text) {
  let plain;
  try {
    plain = checked(text);
  } catch (error) {
    if (error instanceof FrameText) return error.message;
    throw error;
  }
  const isRead = (read) => {
    try {
      read(plain, MAX_FRAME_BITS);
      return true;
    } catch (error) {
      if (error instanceof FrameText) return false;
      throw error;
    }
  };
  const meanings = /^[0-9a-f]+$/i.test(plain) ? listMeanings(plain, MAX_FRAME_BITS).join(", ") : "";
  const remedy = meanings ? said("write_one_of", meanings) : said("write_any");
  if (!isRead(numberIn) && !isRead(bytesIn)) return said("no_order_code", quoteText(plain), remedy);
  return `this frame is not valid for any order code${meanings ? `. ${remedy}` : ""}`;
}

/** The bytes of a frame that is sent as bits, from 0b and every bit. */
function bytesFromBits(at, text) {
  const digits = text.slice(2).replaceAll("_", "");
  const size = at.bits - (at.layout.fill ?? 0);
  if (digits.length !== size) {
    throw new FrameText(said("no_bits", quoteText(text), size, said("write_bits", size, at.bits / 8)));
  }
  return digits.padStart(at.bits, "0").match(/.{8}/g).map((byte) => parseInt(byte, 2));
}

/** The parameters of a code with the register contents ``held`` and the answers of the user. */
function computeParameters(found, held = {}, answers = {}) {
  const given = named(found.given, held);
  for (const item of found.family.alternatives ?? []) {
    const taken = item.answers.find(([name]) => name === answers[item.name]);
    for (const [name, one] of Object.entries(taken?.[2] ?? {})) given[name] = big(one);
  }
  return resolveParameters(found.family, given);
}

function placedFor(found, layout, held, answers) {
  return { ...placed(found.family, layout, computeParameters(found, held, answers)), code: found.code };
}

/** The frame in a text for an order code; ``what`` is its sender, with the name of the frame where that is needed. */
function decodeFrame(found, what, text, held, answers) {
  const [sender, name] = what.split(":");
  const layouts = found.interface.frames.filter((item) => item.sender === sender && (!name || item.name === name));
  if (!layouts.length) {
    throw new FrameText(`the spec does not describe a frame from the ${sender} over ${found.interface.title}`);
  }
  const [over, trimmed] = [found.interface, checked(text)];
  const whole = sender === "encoder" && !name ? decodeChannels(found, trimmed, held, answers) : null;
  if (whole) return { ...whole, over };
  if (!layouts[0].order) {
    const at = placedFor(found, layouts[0], held, answers);
    return { ...decodeBits(at, numberIn(trimmed, at.bits, found.interface.exact?.includes(sender))), over };
  }
  const isOfBits = over.name !== "rs485" && /^0b[01_]+$/i.test(trimmed);
  const bytes = isOfBits ? bytesFromBits(placedFor(found, layouts[0], held, answers), trimmed) : bytesIn(trimmed);
  const told = name ? { layout: layouts[0] } : identifyLayout(found.interface, sender, bytes);
  const made = told.layout ? decodeBytes(placedFor(found, told.layout, held, answers), bytes) : told;
  return { ...made, data: bytes, over, label: found, sender };
}

/** The placed layouts of the other frames that a text can be, if nothing in a frame identifies it. */
function otherFrames(found, sender, text, decoded, held, answers) {
  const { frames, told = [] } = found.interface;
  const isTold = told.some((item) => item.sender === sender);
  if (!decoded.at || isTold) return [];
  const hasOtherLength = decoded.problems.some((item) => item.fault === "length");
  return frames.filter((item) => item.sender === sender && item !== decoded.at.layout
    && !item.order === !decoded.at.layout.order && !item.asks?.some((name) => !(name in answers))).flatMap((item) => {
    try {
      const { at, problems } = decodeFrame(found, `${sender}:${item.name}`, text, held, answers);
      // Hex digits imply leading zeros, so without this, a short frame would be valid as a long one.
      return !problems.length && (hasOtherLength || at.bits === decoded.at.bits) ? [at] : [];
    } catch (error) {
      if (error instanceof FrameText) return [];
      throw error;
    }
  });
}

/** A frame of bits; ``given`` is its text as a number. */
function decodeBits(at, given) {
  const hasOthers = given.exact && given.bits !== at.bits;
  return { ...(hasOthers ? otherLength(at, `${at.bits} bits`, given.bits) : decode(at, given.number)), given };
}

/** The frame of a sender that the selector in these bytes identifies, or the error if there is none. */
function identifyLayout(interface_, sender, bytes) {
  const told = (interface_.told ?? []).find((item) => item.sender === sender);
  if (!told) return { layout: interface_.frames.find((item) => item.sender === sender) };
  const fallback = interface_.frames[told.fallback];
  if (bytes.length < told.needs) {
    const message = said("too_few_bytes", counted(bytes.length, "byte"));
    return fallback ? { layout: fallback } : makeFailedFrame("length", "", message);
  }
  const found = told.pieces.reduce(
    (sum, [byte, right, mask, left]) => sum | (((bytes[byte] >> right) & mask) << left), 0);
  const place = told.frames.find(([, ...values]) => values.includes(found));
  if (place || fallback) return { layout: place ? interface_.frames[place[0]] : fallback };
  const upper = (number) => number.toString(16).toUpperCase();
  const choices = told.frames.flatMap(([, ...values]) => values).sort((one, other) => one - other).map(upper);
  return makeFailedFrame("range", told.selector, said("no_frame", told.selector, upper(found), choices.join(", ")));
}

const makeFailedFrame = (kind, field, message) => ({ ...createEmptyResult(null, 0n), problems: [{ fault: kind, field, message }] });

/** The bytes of a register, decoded. */
function decodeRegister(found, register, text, held, answers) {
  const bytes = bytesIn(checked(text));
  if (bytes.length !== register.length) {
    const [needed, given] = [counted(register.length, "byte"), counted(bytes.length, "byte")];
    throw new FrameText(said("register_length", register.name, needed, given));
  }
  return decodeBytes(placedFor(found, register, held, answers), bytes);
}

/** All order codes for which a text is a valid frame, grouped by the places of its fields. */
function inferred(text) {
  const groups = new Map();
  for (const family of TABLE.families.filter((item) => !item.base)) {
    for (const found of family.codes.map((row) => orderCodeOfRow(family, row))) {
      for (const sender of ["encoder", "master"]) addIfValid(groups, found, sender, text);
    }
  }
  return [...groups.values()];
}

function addIfValid(groups, found, sender, text) {
  let decoded;
  try {
    decoded = decodeFrame(found, sender, text);
  } catch (error) {
    if (error instanceof FrameText) return;
    throw error;
  }
  if (decoded.problems.length) return;
  const { at } = decoded;
  const places = at.fields.map((item) => [item.name, item.low, item.width]);
  const key = JSON.stringify([found.family.name, at.name, at.gray !== null, places]);
  const { family, interface: over } = found;
  if (!groups.has(key)) groups.set(key, { decoded, sender, over, family, codes: [] });
  groups.get(key).codes.push(found.code);
}
