// Licence 0BSD: use, modify and distribute this file without any condition.
// Parsing of frames and labels, and inference of order codes from a frame.

class FrameText extends Error {}

const NOTHING = "there is nothing to decode";

/** Hex bytes, in groups of whole bytes. */
function bytesIn(text) {
  const bytes = [];
  for (const piece of text.replace(/,/g, " ").split(/\s+/).filter(Boolean)) {
    const digits = piece.replace(/^0x/i, "");
    if (!/^[0-9a-f]+$/i.test(digits)) {
      throw new FrameText(`${piece} is not hex. Write the bytes as in: 02 00 12 34 00 24`);
    }
    const whole = digits !== piece && digits.length === 1 ? `0${digits}` : digits;
    if (whole.length % 2) throw new FrameText(`${piece} has an odd number of hex digits, but a byte has two`);
    bytes.push(...whole.match(/../g).map((byte) => parseInt(byte, 16)));
  }
  if (!bytes.length) throw new FrameText(NOTHING);
  return bytes;
}

/** One number: 0b with every digit, or 0x or hex bytes, which imply leading zeros. */
function numberIn(text) {
  let compact = text.replace(/[\s_]/g, "");
  if (/^0b[01]+$/i.test(compact)) return { number: BigInt(compact), bits: compact.length - 2, exact: true };
  const pieces = text.replace(/,/g, " ").split(/\s+/).filter(Boolean);
  if (pieces.length > 1 && pieces.every((piece) => /^(0x)?[0-9a-f]{2}$/i.test(piece))) {
    if (/^[01]+$/.test(pieces.join(""))) {
      throw new FrameText(`${text} can be bits or hex bytes. Write 0b or 0x in front`);
    }
    compact = "0x" + pieces.map((piece) => piece.slice(-2)).join("");
  }
  if (!/^0x[0-9a-f]+$/i.test(compact)) {
    throw new FrameText("write 0b and all bits in order of transmission, or 0x and hex digits, or several hex bytes");
  }
  const number = BigInt(compact);
  return { number, bits: bitLength(number), exact: false };
}

function checked(text) {
  const trimmed = text.trim();
  if (!trimmed) throw new FrameText(NOTHING);
  if (trimmed.length > 4096) throw new FrameText("this is longer than any frame or register");
  return trimmed;
}

/** The order code on a label: family, interface and parameters; null if it is unknown. */
function findCode(label) {
  const text = label.replace(/\s/g, "").toUpperCase();
  const special = (family) => family.special && text.endsWith(`/${family.special}`);
  const families = [...TABLE.families.filter(special), ...TABLE.families.filter((family) => !family.base)];
  for (const family of families) {
    const codes = [...family.codes].sort((one, other) => other[0].length - one[0].length);
    for (const row of codes) {
      const rest = /^(-.*?)?(\/S[A-Z0-9]+)?$/.exec(text.slice(row[0].length));
      if (text.startsWith(row[0].toUpperCase()) && rest) {
        return { ...ofRow(family, row), tail: rest[1] ?? "", isSpecial: rest[2] !== undefined };
      }
    }
  }
  return null;
}

function ofRow(family, [code, interface_, ...values]) {
  const given = named(Object.fromEntries((family.given ?? []).map((name, place) => [name, big(values[place])])));
  return { code, family, interface: family.interfaces[interface_], given };
}

/** The parameters of a code with the register contents ``held`` and the answers of the user. */
function parametersOf(found, held = {}, answers = {}) {
  const given = named(found.given, held);
  for (const item of found.family.alternatives ?? []) {
    const taken = item.answers.find(([name]) => name === answers[item.name]);
    for (const [name, one] of Object.entries(taken?.[2] ?? {})) given[name] = big(one);
  }
  return resolved(found.family, given);
}

function placedFor(found, layout, held, answers) {
  return { ...placed(found.family, layout, parametersOf(found, held, answers)), code: found.code };
}

/** The frame in a text for an order code. */
function decodeFrame(found, sender, text, held, answers) {
  const layouts = found.interface.frames.filter((item) => item.sender === sender);
  if (!layouts.length) {
    throw new FrameText(`the manual does not describe a frame from the ${sender} over ${found.interface.title}`);
  }
  const trimmed = checked(text);
  if (!layouts[0].bytes) return decodeBits(placedFor(found, layouts[0], held, answers), numberIn(trimmed));
  const bytes = bytesIn(trimmed);
  const told = toldApart(found.interface, sender, bytes);
  const made = told.layout ? decodeBytes(placedFor(found, told.layout, held, answers), bytes) : told;
  return { ...made, data: bytes };
}

/** A frame of bits; ``given`` is its text as a number. */
function decodeBits(at, given) {
  const hasOthers = given.exact && given.bits !== at.bits;
  return { ...(hasOthers ? otherLength(at, `${at.bits} bits`, given.bits) : decode(at, given.number)), given };
}

/** The frame of a sender that the selector in these bytes identifies, or the error if there is none. */
function toldApart(interface_, sender, bytes) {
  const told = (interface_.told ?? []).find((item) => item.sender === sender);
  if (!told) return { layout: interface_.frames.find((item) => item.sender === sender) };
  const fallback = interface_.frames[told.fallback];
  if (bytes.length < told.needs) {
    const message = said("too_few_bytes", counted(bytes.length, "byte"));
    return fallback ? { layout: fallback } : fault("length", "", message);
  }
  const found = told.pieces.reduce(
    (sum, [byte, right, mask, left]) => sum | (((bytes[byte] >> right) & mask) << left), 0);
  const place = told.frames.find(([, ...values]) => values.includes(found));
  if (place || fallback) return { layout: place ? interface_.frames[place[0]] : fallback };
  const upper = (number) => number.toString(16).toUpperCase();
  const choices = told.frames.flatMap(([, ...values]) => values).sort((one, other) => one - other).map(upper);
  return fault("range", told.selector, said("no_frame", told.selector, upper(found), choices.join(", ")));
}

const fault = (kind, field, message) => ({ ...nothing(null, 0n), problems: [{ fault: kind, field, message }] });

/** The bytes of a register, decoded. */
function decodeRegister(found, register, text, held, answers) {
  const bytes = bytesIn(checked(text));
  if (bytes.length !== register.length) {
    throw new FrameText(`'${register.name}' has ${counted(register.length, "byte")}; this has ${bytes.length}`);
  }
  return decodeBytes(placedFor(found, register, held, answers), bytes);
}

/** All order codes for which a text is a valid frame, grouped by the places of its fields. */
function inferred(text) {
  const groups = new Map();
  for (const family of TABLE.families.filter((item) => !item.base)) {
    for (const found of family.codes.map((row) => ofRow(family, row))) {
      for (const sender of ["encoder", "master"]) infer(groups, found, sender, text);
    }
  }
  return [...groups.values()];
}

function infer(groups, found, sender, text) {
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
