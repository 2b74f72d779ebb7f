// Licence 0BSD: use, modify and distribute this file without any condition.
// Decoding and encoding of frames and registers by the table.

/** A layout with the places of its fields for an order code, without fields of 0 bits. */
function placed(family, layout, parameters) {
  const at = (item) => Number(value(item, parameters));
  const explained = (field) => (!field.only || parameters[field.only] ? field
    : { ...field, on: TABLE.unexplained, off: "", meaning: "" });
  const fields = (layout.fields ?? []).map((place) => explained(family.shared[place]))
    .map((field) => ({ field, name: field.name, low: at(field.low), width: at(field.width) }))
    .filter((item) => item.width > 0);
  const gray = layout.gray && (!layout.gray.when || parameters[layout.gray.when]) ? layout.gray : null;
  const holds = (only) => !only || Boolean(parameters[only.parameter]) === Boolean(only.holds);
  return {
    family, layout, parameters, fields, name: layout.name, bits: at(layout.bits),
    crc: layout.crcs ? layout.crcs[fields.find((item) => item.field.crc)?.name] : layout.crc,
    gray: gray && { low: at(gray.low), width: at(gray.width), excess: value(gray.excess ?? 0, parameters) },
    joins: (layout.joins ?? []).map((join) => ({
      name: join.name,
      parts: join.fields.map(([part, low]) => ({ item: fields.find((one) => one.name === part), low: at(low) })),
    })),
    checks: (layout.checks ?? []).map((place) => family.shared[place])
      .map((check) => ({ check, low: at(check.low), width: at(check.width),
        limit: check.limit === undefined ? undefined : value(check.limit, parameters),
        lowest: value(check.lowest ?? 0, parameters),
        of: check.parity_of?.map(([first, size]) => ({ low: at(first), width: at(size) })) }))
      .filter((item) => item.width > 0),
    tells: (layout.tells ?? []).map((place) => family.shared[place]).filter((item) => holds(item.only)),
    speaks: (layout.speaks ?? []).filter((item) => holds(item.only) && holds(item.chosen)),
  };
}

/** The decoded number: fields, CRC, errors, reports and verdict. */
function decode(at, number) {
  if (number >> BigInt(at.bits)) return otherLength(at, `${at.bits} bits`, bitLength(number));
  const found = nothing(at, number);
  const plain = fromGray(at, number);
  found.fields = at.fields.flatMap((item) => fieldsOf(item, number, plain));
  found.crc = crcOf(at, number);
  if (found.crc && found.crc.received !== found.crc.computed) {
    const words = said("crc", hex(found.crc.received, 2), hex(found.crc.computed, 2));
    found.problems.push({ fault: "crc", field: found.crc.field, message: words });
  }
  found.problems.push(...at.checks.flatMap((item) => problemOf(item, number, plain)));
  const rank = (problem) => TABLE.faults.indexOf(problem.fault);
  found.problems.sort((one, other) => rank(one) - rank(other));
  found.fields.push(...at.joins.map((join) => joined(join, number, plain)));
  if (!found.problems.length) tell(found);
  return found;
}

const nothing = (at, number) => ({
  at, number, fields: [], crc: null, problems: [], reports: [], differences: [], verdict: null,
});

function otherLength(at, needed, count) {
  const found = nothing(at, 0n);
  found.problems.push({ fault: "length", field: "", message: said("length", at.name, needed, count) });
  return found;
}

/** A frame or register of bytes. */
function decodeBytes(at, bytes) {
  if (8 * bytes.length !== at.bits) return otherLength(at, counted(at.bits / 8, "byte"), bytes.length);
  return decode(at, numberOf(at.layout.order, bytes));
}

function fromGray(at, number) {
  if (!at.gray) return number;
  const plain = plainOf(bits(number, at.gray.low, at.gray.width)) - at.gray.excess;
  return withGray(at, number, plain);
}

/** The number with other bits in the place of those in Gray code. */
function withGray(at, number, changed) {
  const { low, width } = at.gray;
  return (number & ~(ones(width) << BigInt(low))) | (BigInt.asUintN(width, changed) << BigInt(low));
}

/** The number that a number in Gray code stands for. */
function plainOf(gray) {
  let plain = gray;
  for (let rest = gray >> ONE; rest; rest >>= ONE) plain ^= rest;
  return plain;
}

function toGray(at, number) {
  if (!at.gray) return number;
  const sum = BigInt.asUintN(at.gray.width, bits(number, at.gray.low, at.gray.width) + at.gray.excess);
  return withGray(at, number, sum ^ (sum >> ONE));
}

/** A field in readable form with its runs of digits; ``raw`` is the transmitted value. */
function fieldsOf(item, number, plain) {
  const { field, low, width } = item;
  const sent = bits(plain, low, width);
  const entry = {
    name: field.name, raw: bits(number, low, width), value: sent, unit: field.unit ?? "",
    scale: field.scale, meaning: field.meaning ?? "", high: low + width - 1, low, colour: field.colour,
    ...meantBy(field, sent, width),
  };
  const runs = (field.runs ?? []).map(([name, divisor, modulus, meaning = ""]) => {
    const part = (sent / big(divisor)) % big(modulus);
    return { ...entry, name, raw: part, value: part, unit: "", scale: undefined, meaning };
  });
  return [entry, ...runs];
}

function meantBy(field, raw, width) {
  switch (field.kind) {
    case "flag":
    case "not_flag": {
      const active = (raw === 0n) === (field.kind === "not_flag");
      return { value: active, meaning: (active ? field.on : field.off) || field.meaning || "" };
    }
    case "choice": {
      const named = field.values.find((entry) => big(entry[0]) === raw);
      return named ? { value: named[1], meaning: named[2] || field.meaning || "" } : {};
    }
    case "signed":
      return { value: BigInt.asIntN(width, raw) };
    case "text": {
      const codes = bytesOf("big", raw, width / 8);
      return { value: String.fromCharCode(...codes) };
    }
    case "digits":
    case undefined:
      return { value: raw || big(field.zero_means) };
    default:
      throw new TypeError(`unknown kind ${field.kind}`);
  }
}

function joined(join, number, plain) {
  const parts = join.parts.filter((part) => part.item);
  const sum = (source) => parts.reduce(
    (whole, { item, low }) => whole | (bits(source, item.low, item.width) << BigInt(low)), 0n);
  const names = parts.map((part) => part.item.name).reverse().join(" and ");
  const meaning = join.parts.length > 1 ? said("as_one_number", names) : "";
  return { name: join.name, raw: sum(number), value: sum(plain), unit: "", meaning, high: -1, low: -1 };
}

const crcField = (at) => at.fields.find((item) => item.field.crc);

function crcOf(at, number) {
  if (!at.crc) return null;
  const crc = at.family.crcs[at.crc];
  const field = crcField(at);
  const received = bits(number, field.low, field.width);
  return { crc, field: field.name, received, computed: computedBy(crc, at, number) };
}

/** The CRC with these parameters over the bits of a frame that its CRC covers. */
function computedBy(crc, at, number) {
  const { width } = crcField(at);
  const [low, count] = at.layout.crc_of ?? [width, at.bits - width];
  if (!at.layout.order || width % 8) return crcOfBits(crc, number >> BigInt(low), count);
  return crcOfBytes(crc, bytesOf(at.layout.order, number, at.bits / 8).slice(0, -width / 8));
}

function problemOf(item, number, plain) {
  const { check, low, width, limit, lowest, of } = item;
  const sent = bits(of ? number : plain, low, width);
  const found = check.says === "outside" ? BigInt.asIntN(width, sent) : sent;
  const right = of ? [parityOf(number, of, check)]
    : (check.values ?? []).map((one) => big(one) & ones(width));
  const holds = limit === undefined ? right.includes(found) : found >= lowest && found <= limit;
  if (holds) return [];
  const words = {
    constant: () => said("constant", check.field, hex(found), hex(right[0])),
    parity: () => said("parity", check.field, found, check.of_name, right[0]),
    no_value: () => said("no_value", check.field, hex(found)),
    of_other_frame: () => said("of_other_frame", check.field, found.toString(16).toUpperCase()),
    too_high: () => said("too_high", check.field, found, limit),
    outside: () => said("outside", `${check.field} ${found}`, lowest, limit),
    digits: () => said("digits", check.field, found, check.most),
  };
  return [{ fault: check.fault, field: check.field, message: words[check.says]() }];
}

/** The reports and the verdict of a valid frame or register. */
function tell(found) {
  const { at, number } = found;
  const plain = fromGray(at, number);
  const active = new Set(at.fields.filter((item) => speaks(item, bits(plain, item.low, item.width)))
    .map((item) => item.name));
  const applies = ({ flag, when }) => (when ? when.every((pair) => matches(found, pair)) : active.has(flag));
  found.reports = at.tells.filter(applies);
  if (at.layout.otherwise) {
    const worst = at.speaks.find((item) =>
      applies(item) && !(item.unless ?? []).some((name) => active.has(name)));
    found.verdict = worst ? worst.verdict : at.layout.otherwise;
    if (!judges(at) && found.verdict !== "not_usable") found.verdict = "unknown";
  }
  found.differences = [...at.fields.flatMap((item) => differenceOf(found, item)), ...strangeIn(found)];
}

/** Whether frames of the order code have bits that say whether the position is usable, if others have. */
function judges({ layout, parameters }) {
  return layout.judging_bits === undefined || value(layout.judging_bits, parameters) > 0;
}

/** Whether a flag is active, or unused bits differ from the manual. */
function speaks({ field, width }, raw) {
  if ("unused" in field) return raw !== (big(field.unused) & ones(width));
  return field.kind === "flag" ? raw !== 0n : field.kind === "not_flag" && raw === 0n;
}

/** Whether a flag is active (1) or inactive (0), or another field has this value. */
function matches({ at, number }, [name, wanted]) {
  const item = at.fields.find((one) => one.name === name);
  const raw = item && bits(fromGray(at, number), item.low, item.width);
  return Boolean(item) && (isFlag(item.field) ? speaks(item, raw) === (wanted === 1) : raw === big(wanted));
}

const isFlag = ({ kind }) => kind === "flag" || kind === "not_flag";

function differenceOf(found, { field }) {
  if (field.equals === undefined || found.at.layout.sender === "master") return [];
  const entry = found.fields.find((one) => one.name === field.name);
  const isText = typeof field.equals === "string";
  const has = isText ? entry.value : entry.raw;
  const wanted = isText ? field.equals : value(field.equals[0], found.at.parameters);
  if (has === wanted) return [];
  const [shown, right] = [has, wanted].map((one) => (isText ? `"${one}"` : hex(one, 2)));
  const name = field.printed || field.name;
  return [found.at.layout.sender
    ? said("other_value", name, shown, right) : said("other_content", name, shown, found.at.code, right)];
}

function strangeIn(found) {
  return (found.at.layout.strange ?? []).flatMap(([run, low, high, words]) => {
    const entry = found.fields.find((one) => one.name === run);
    return entry && (entry.raw < big(low) || entry.raw > big(high)) ? [filled(words, entry.raw)] : [];
  });
}

/** The names and values of the fields that together hold a number. Excess bits go to the highest field. */
function splitInto(parts, number) {
  const top = Math.max(...parts.map((one) => one.low + (one.item?.width ?? 0)));
  return parts.filter((one) => one.item).map(({ item, low }) => {
    const isOpen = low + item.width === top || number < 0n;
    return [item.name, isOpen ? number >> BigInt(low) : bits(number, low, item.width)];
  });
}

class Refusal extends Error {}

/** The number whose fields have these values: numbers, booleans and texts by name. */
function encode(at, values) {
  const parities = at.fields.filter((item) => item.field.parity);
  let number = at.fields.reduce((sum, item) => sum | (rawOf(item, values) << BigInt(item.low)), 0n);
  number = toGray(at, number);
  parities.forEach((item) => {
    const of = at.fields.filter((one) => item.field.parity.includes(one.name));
    number |= parityOf(number, of, item.field) << BigInt(item.low);
  });
  if (at.crc) number |= computedBy(at.family.crcs[at.crc], at, number) << BigInt(crcField(at).low);
  for (const problem of decode(at, number).problems) throw new Refusal(problem.message);
  return number;
}

/** Whether the user provides the value of a field. All others are derived. */
const isGiven = ({ field }) => !["crc", "parity", "fixed", "unused"].some((name) => name in field);

function rawOf(item, values) {
  const { field, width } = item;
  if ("fixed" in field) return big(field.fixed) & ones(width);
  if (!isGiven(item)) return big(field.unused) & ones(width);
  const given = values[field.name];
  if (field.kind === "flag" || field.kind === "not_flag") return BigInt(given === (field.kind === "flag"));
  if (field.kind === "text") return rawOfText(item, given);
  const raw = field.zero_means && given === big(field.zero_means) ? 0n : BigInt.asUintN(width, given);
  if (meantBy({ ...field, kind: field.kind === "signed" ? "signed" : undefined }, raw, width).value !== given) {
    throw new Refusal(said("too_wide", field.name, given, width));
  }
  if (field.power_of_two && given & (given - ONE)) throw new Refusal(said("no_power_of_two", field.name, given));
  return raw;
}

function rawOfText({ field, width }, given) {
  const codes = [...given].map((one) => one.codePointAt(0));
  if (codes.length !== width / 8 || codes.some((code) => code > 255)) {
    throw new Refusal(said("too_wide", field.name, `"${given}"`, width));
  }
  return numberOf("big", codes);
}

/** Rejects a number outside the limits of its register. */
function refuseOutside(at, number, limits) {
  if (!limits || (limits.low === null && limits.high === null)) return;
  const entries = decode(at, number).fields;
  const found = limits.of ? entries.find((one) => one.name === limits.of).value : number;
  const bound = (item) => (item === null ? null : value(item, at.parameters));
  const [low, high] = [bound(limits.low), bound(limits.high)];
  if ((low !== null && found < low) || (high !== null && found > high)) {
    throw new Refusal(said("outside", found, low ?? "the lowest value", high ?? "the highest value"));
  }
}

/** The fields that together hold the only number of a register, such as a position. */
function partsOfNumber(at) {
  const [join] = at.joins;
  return join ? join.parts : at.fields.filter(isGiven).map((item) => ({ item, low: 0 }));
}

/** The bytes of a register that holds one number, such as a position, in hex. */
function bytesOfNumber(at, number, limits) {
  return bytesFor(at, named(Object.fromEntries(splitInto(partsOfNumber(at), number))), limits);
}

/** The highest number that a register can hold within its limits. */
function highestNumber(at, limits) {
  const tops = partsOfNumber(at).filter((one) => one.item)
    .map(({ item, low }) => low + item.width - (item.field.kind === "signed" ? 1 : 0));
  const [fits, limit] = [ones(Math.max(...tops)), limits?.high ?? null];
  const allowed = limit === null ? fits : value(limit, at.parameters);
  return allowed < fits ? allowed : fits;
}

/** The bytes of a register with these values, in hex. */
function bytesFor(at, values, limits) {
  const number = encode(at, values);
  refuseOutside(at, number, limits);
  return shownBytes(bytesOf(at.layout.order, number, at.layout.length));
}

const shownBytes = (bytes) => bytes.map((byte) => byte.toString(16).toUpperCase().padStart(2, "0")).join(" ");
