// Licence 0BSD: use, modify and distribute this file without any condition.
// Order codes as people write them, with the same help as on the command line.

/** A text that is not an order code; the message names the wrong part. ``isClose`` is as in the Python code. */
class UnknownCode extends Error {
  constructor(message, isClose) {
    super(message);
    this.isClose = isClose;
  }
}

const MAX_LABEL_LENGTH = TABLE.limits.label;
const removeBlanks = (text) => text.replace(/\s/g, "");
const compileRegex = (source) => new RegExp(source, "i");
const findListedValue = (part, text) => part.values.find((listed) => listed.toUpperCase() === text.toUpperCase());
const fillPattern = (pattern, texts) => pattern.replace(/\{(\w+)\}/g, (_, name) => texts[name]);

/** The order code on a label: family, interface and parameters. Throws ``UnknownCode`` with help. */
function readLabel(label) {
  if (isLine(label)) return readLine(label);
  const text = removeBlanks(label).toUpperCase();
  const special = (family) => family.special && text.endsWith(`/${family.special}`);
  let closeError = null;
  let best = null;
  for (const family of [...TABLE.families.filter(special), ...TABLE.families.filter((listedFamily) => !listedFamily.base)]) {
    try {
      const reading = readLabelOfFamily(family, label);
      // What is a tail after the code of one family can be a part of the code of another one.
      if (!best || reading.tail.length < best.tail.length) best = reading;
    } catch (error) {
      if (!(error instanceof UnknownCode)) throw error;
      if (error.isClose) closeError = closeError ?? error;
    }
  }
  if (best) return best;
  throw closeError ?? new UnknownCode(describeUnknownLabel(label), false);
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

function readLabelOfFamily(family, label) {
  if (label.length > MAX_LABEL_LENGTH) {
    throw new UnknownCode(said("too_long", label.slice(0, 20), label.length, MAX_LABEL_LENGTH), true);
  }
  const code = removeBlanks(label).toUpperCase();
  for (const spelling of family.labels.written) {
    const match = compileRegex(spelling.label).exec(code);
    if (match) return { ...resolveOrderCode(family, spelling, match.groups, code), label };
  }
  throw explainWrongPart(family, code);
}

function resolveOrderCode(family, spelling, groups, code) {
  const { parts, pattern } = family.labels;
  const texts = named(Object.fromEntries(parts.map(({ name }) => {
    const listedText = spelling.values?.[name]?.[groups[name].toUpperCase()];
    return [name, listedText ?? groups[name]];
  })));
  const values = named(Object.fromEntries(parts.map((part) => [part.name, findListedValue(part, texts[part.name])])));
  const row = findFittingRow(family, values);
  if (!row) throw new UnknownCode(describeClash(family, code, texts, values), true);
  const unlisted = parts.map((part) => part.name).filter((name) => values[name] === undefined);
  const listedCode = orderCodeOfRow(family, row);
  return {
    ...listedCode,
    code: unlisted.length ? fillPattern(pattern, named(texts, omitUndefined(values))) : listedCode.code,
    unlisted,
    tail: groups.tail_ ?? "",
    isSpecial: groups.special_ !== undefined,
    writtenAsIn: spelling.where ?? "",
  };
}

const omitUndefined = (values) => Object.fromEntries(Object.entries(values).filter(([, listed]) => listed !== undefined));

/** The first listed code with these parts, where undefined stands for a value that is not listed. */
function findFittingRow(family, values) {
  const open = family.labels.parts.filter((part) => values[part.name] === undefined);
  const isAllowed = ([otherPart, allowed]) => values[otherPart] === undefined || allowed.includes(values[otherPart]);
  if (!open.every((part) => Object.entries(part.only_with ?? {}).every(isAllowed))) return undefined;
  return family.codes.find((row) => {
    const rowValues = partsOfRow(family, row);
    return Object.entries(values).every(([name, wanted]) => wanted === undefined || wanted === rowValues[name]);
  });
}

const partsByRow = new Map();

function partsOfRow(family, row) {
  if (!partsByRow.has(row)) {
    const { groups } = compileRegex(family.labels.written[0].label).exec(removeBlanks(row[0]));
    const listed = family.labels.parts.map((part) => [part.name, findListedValue(part, groups[part.name])]);
    partsByRow.set(row, named(Object.fromEntries(listed)));
  }
  return partsByRow.get(row);
}

function describeClash(family, code, texts, values) {
  const names = family.labels.parts.filter((part) => part.values.some(
    (candidate) => findFittingRow(family, named(values, { [part.name]: candidate })))).map((part) => part.name);
  const namedParts = names.map((name) => `${name} '${values[name] ?? texts[name]}'`).join(" and ") || "its parts";
  return said("cannot_be_combined", code, namedParts, listNearestCodes([family], code));
}

/** The error about a text with one missing or unlisted part, or about a text that is far from every code. */
function explainWrongPart(family, code) {
  const { parts, wrong } = family.labels;
  const candidates = parts.flatMap((part, index) => {
    const groups = compileRegex(wrong[index]).exec(code)?.groups;
    if (!groups || !hasOtherText(groups, part, code)) return [];
    const unlisted = parts.filter((other) => other !== part && findListedValue(other, groups[other.name]) === undefined);
    return [{ part, given: groups[part.name], rank: 2 * unlisted.length + (groups[part.name] ? 1 : 0) }];
  });
  if (!candidates.length) {
    return new UnknownCode(said("not_of_family", code, family.name.toUpperCase(), listNearestCodes([family], code)), false);
  }
  const { part, given } = candidates.reduce((best, candidate) => (candidate.rank < best.rank ? candidate : best));
  const words = given ? said("has_part", part.name, given) : said("has_no_part", part.name);
  return new UnknownCode(said("wrong_part", code, words, part.values.join(", "), listNearestCodes([family], code)), true);
}

/** Whether a label has letters or digits of the family, apart from a wrong part and the tail. */
function hasOtherText(groups, part, code) {
  const partText = groups[part.name];
  const ownText = code.slice(0, code.length - (groups.tail_ ?? "").length - (groups.special_ ?? "").length);
  return partText === "" || /[A-Z0-9]/i.test(ownText.replace(partText, ""));
}

function describeUnknownLabel(text) {
  const family = TABLE.families.find((known) => known.name === text.trim().toLowerCase());
  if (family) return said("family", text, family.codes[0][0]);
  const near = listNearestCodes(TABLE.families, text, TABLE.limits.likeness);
  return said("unknown", text) + (near ? said("nearest", near) : "");
}

/** The three most similar codes, as a list in words. */
function listNearestCodes(families, text, least = 0) {
  const pieces = text.toUpperCase().split("-");
  const likeness = (code) => computeSimilarity(code, pieces.slice(0, code.split("-").length).join("-"));
  return families.flatMap((family) => family.codes.map((row) => [likeness(row[0]), row[0]]))
    .sort(([ratio], [otherRatio]) => otherRatio - ratio).slice(0, 3).filter(([ratio]) => ratio >= least)
    .map(([, code]) => code).join(", ");
}

/** The similarity of two texts from 0 to 1, as difflib.SequenceMatcher computes it. */
function computeSimilarity(text, otherText) {
  const matched = (from, to, low, high) => {
    let [best, size, bestInOther] = [0, 0, 0];
    let lengths = new Map();
    for (let place = from; place < to; place += 1) {
      const next = new Map();
      for (let otherPlace = low; otherPlace < high; otherPlace += 1) {
        if (text[place] !== otherText[otherPlace]) continue;
        const length = (lengths.get(otherPlace - 1) ?? 0) + 1;
        next.set(otherPlace, length);
        if (length > size) [best, bestInOther, size] = [place - length + 1, otherPlace - length + 1, length];
      }
      lengths = next;
    }
    return size ? size + matched(from, best, low, bestInOther) + matched(best + size, to, bestInOther + size, high) : 0;
  };
  const total = text.length + otherText.length;
  return total ? (2 * matched(0, text.length, 0, otherText.length)) / total : 1;
}

function orderCodeOfRow(family, [code, interface_, ...values]) {
  const given = named(Object.fromEntries((family.given ?? []).map((name, index) => [name, big(values[index])])));
  return { code, family, interface: family.interfaces[interface_], given };
}
