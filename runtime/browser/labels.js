// Licence 0BSD: use, modify and distribute this file without any condition.
// Order codes as people write them, with the same help as on the command line.

/** A text that is not an order code; the message names the wrong part. ``isClose`` is as in the Python code. */
class UnknownCode extends Error {
  constructor(message, isClose) {
    super(message);
    this.isClose = isClose;
  }
}

const LONGEST_LABEL = TABLE.limits.label;
const withoutBlanks = (text) => text.replace(/\s/g, "");
const regexOf = (source) => new RegExp(source, "i");
const listedValue = (part, text) => part.values.find((one) => one.toUpperCase() === text.toUpperCase());
const filledPattern = (pattern, texts) => pattern.replace(/\{(\w+)\}/g, (_, name) => texts[name]);

/** The order code on a label: family, interface and parameters. Throws ``UnknownCode`` with help. */
function readLabel(label) {
  if (isLine(label)) return readLine(label);
  const text = withoutBlanks(label).toUpperCase();
  const special = (family) => family.special && text.endsWith(`/${family.special}`);
  let first = null;
  let found = null;
  for (const family of [...TABLE.families.filter(special), ...TABLE.families.filter((one) => !one.base)]) {
    try {
      const here = readFor(family, label);
      // What is a tail after the code of one family can be a part of the code of another one.
      if (!found || here.tail.length < found.tail.length) found = here;
    } catch (error) {
      if (!(error instanceof UnknownCode)) throw error;
      if (error.isClose) first = first ?? error;
    }
  }
  if (found) return found;
  throw first ?? new UnknownCode(unknownLabel(label), false);
}

/** The order code on a label, or null if it is unknown. */
function findCode(label) {
  try {
    return readLabel(label);
  } catch (error) {
    if (!(error instanceof UnknownCode)) throw error;
    return null;
  }
}

function readFor(family, label) {
  if (label.length > LONGEST_LABEL) {
    throw new UnknownCode(said("too_long", label.slice(0, 20), label.length, LONGEST_LABEL), true);
  }
  const code = withoutBlanks(label).toUpperCase();
  for (const written of family.labels.written) {
    const match = regexOf(written.label).exec(code);
    if (match) return { ...resolvedCode(family, written, match.groups, code), label };
  }
  throw wrongPart(family, code);
}

function resolvedCode(family, written, groups, code) {
  const { parts, pattern } = family.labels;
  const given = named(Object.fromEntries(parts.map(({ name }) => {
    const own = written.values?.[name]?.[groups[name].toUpperCase()];
    return [name, own ?? groups[name]];
  })));
  const known = named(Object.fromEntries(parts.map((part) => [part.name, listedValue(part, given[part.name])])));
  const row = fittingRow(family, known);
  if (!row) throw new UnknownCode(clash(family, code, given, known), true);
  const unlisted = parts.map((part) => part.name).filter((name) => known[name] === undefined);
  const found = ofRow(family, row);
  return {
    ...found,
    code: unlisted.length ? filledPattern(pattern, named(given, definedOf(known))) : found.code,
    unlisted,
    tail: groups.tail_ ?? "",
    isSpecial: groups.special_ !== undefined,
    writtenAsIn: written.where ?? "",
  };
}

const definedOf = (known) => Object.fromEntries(Object.entries(known).filter(([, one]) => one !== undefined));

/** The first listed code with these parts, where undefined stands for a value that is not listed. */
function fittingRow(family, known) {
  const open = family.labels.parts.filter((part) => known[part.name] === undefined);
  const isAllowed = ([other, allowed]) => known[other] === undefined || allowed.includes(known[other]);
  if (!open.every((part) => Object.entries(part.only_with ?? {}).every(isAllowed))) return undefined;
  return family.codes.find((row) => {
    const own = partsOf(family, row);
    return Object.entries(known).every(([name, one]) => one === undefined || one === own[name]);
  });
}

const partsOfCodes = new Map();

function partsOf(family, row) {
  if (!partsOfCodes.has(row)) {
    const { groups } = regexOf(family.labels.written[0].label).exec(withoutBlanks(row[0]));
    const listed = family.labels.parts.map((part) => [part.name, listedValue(part, groups[part.name])]);
    partsOfCodes.set(row, named(Object.fromEntries(listed)));
  }
  return partsOfCodes.get(row);
}

function clash(family, code, given, known) {
  const names = family.labels.parts.filter((part) => part.values.some(
    (one) => fittingRow(family, named(known, { [part.name]: one })))).map((part) => part.name);
  const listed = names.map((name) => `${name} '${known[name] ?? given[name]}'`).join(" and ") || "its parts";
  return said("cannot_be_combined", code, listed, nearest([family], code));
}

/** The error about a text with one missing or unlisted part, or about a text that is far from every code. */
function wrongPart(family, code) {
  const { parts, wrong } = family.labels;
  const found = parts.flatMap((part, place) => {
    const groups = regexOf(wrong[place]).exec(code)?.groups;
    if (!groups || !hasMoreThan(groups, part, code)) return [];
    const unlisted = parts.filter((other) => other !== part && listedValue(other, groups[other.name]) === undefined);
    return [{ part, given: groups[part.name], rank: 2 * unlisted.length + (groups[part.name] ? 1 : 0) }];
  });
  if (!found.length) {
    return new UnknownCode(said("not_of_family", code, family.name.toUpperCase(), nearest([family], code)), false);
  }
  const { part, given } = found.reduce((best, one) => (one.rank < best.rank ? one : best));
  const words = given ? said("has_part", part.name, given) : said("has_no_part", part.name);
  return new UnknownCode(said("wrong_part", code, words, part.values.join(", "), nearest([family], code)), true);
}

/** Whether a label has letters or digits of the family, apart from a wrong part and the tail. */
function hasMoreThan(groups, part, code) {
  const given = groups[part.name];
  const own = code.slice(0, code.length - (groups.tail_ ?? "").length - (groups.special_ ?? "").length);
  return given === "" || /[A-Z0-9]/i.test(own.replace(given, ""));
}

function unknownLabel(text) {
  const family = TABLE.families.find((one) => one.name === text.trim().toLowerCase());
  if (family) return said("family", text, family.codes[0][0]);
  const near = nearest(TABLE.families, text, TABLE.limits.likeness);
  return said("unknown", text) + (near ? said("nearest", near) : "");
}

/** The three most similar codes, as a list in words. */
function nearest(families, text, least = 0) {
  const pieces = text.toUpperCase().split("-");
  const likeness = (code) => similarity(code, pieces.slice(0, code.split("-").length).join("-"));
  return families.flatMap((family) => family.codes.map((row) => [likeness(row[0]), row[0]]))
    .sort(([one], [other]) => other - one).slice(0, 3).filter(([ratio]) => ratio >= least)
    .map(([, code]) => code).join(", ");
}

/** The similarity of two texts from 0 to 1, as difflib.SequenceMatcher computes it. */
function similarity(one, other) {
  const matched = (from, to, low, high) => {
    let [best, size, at] = [0, 0, 0];
    let lengths = new Map();
    for (let i = from; i < to; i += 1) {
      const next = new Map();
      for (let j = low; j < high; j += 1) {
        if (one[i] !== other[j]) continue;
        const length = (lengths.get(j - 1) ?? 0) + 1;
        next.set(j, length);
        if (length > size) [best, at, size] = [i - length + 1, j - length + 1, length];
      }
      lengths = next;
    }
    return size ? size + matched(from, best, low, at) + matched(best + size, to, at + size, high) : 0;
  };
  const total = one.length + other.length;
  return total ? (2 * matched(0, one.length, 0, other.length)) / total : 1;
}

function ofRow(family, [code, interface_, ...values]) {
  const given = named(Object.fromEntries((family.given ?? []).map((name, place) => [name, big(values[place])])));
  return { code, family, interface: family.interfaces[interface_], given };
}
