// License 0BSD: use, modify and distribute this file without any condition.
// Order codes as people write them, with the same help as on the command line.

/** A text that is not an order code; the message names the wrong part. ``isClose`` is as in the Python code. */
class UnknownCode extends Error {
  constructor(message, isClose) {
    super(message);
    this.isClose = isClose;
  }
}

const LONGEST_LABEL = TABLE.limits.label;
/** Remove all spaces and other blanks from a text, such as a byte order mark. */
const removeBlanks = (text) => text.replace(ODD_BLANKS, "").replace(/\s/g, "");
/** Compile a regular expression of the table, for letters of either case. */
const compileRegex = (source) => new RegExp(source, "i");
/** Return the listed value of a part that equals a text except for case, if any. */
const findListedValue = (part, text) => part.values.find(
  (listedText) => listedText.toUpperCase() === text.toUpperCase());
/** Fill the texts of the parts into the pattern of an order code, at the names of the parts in braces. */
const fillPattern = (pattern, texts) => pattern.replace(/\{(\w+)\}/g, (_, name) => texts[name]);

/** Return the order code on a label: family, interface and parameters. Throws ``UnknownCode`` with help. */
function readLabel(label) {
  if (isLine(label)) return readLine(label);
  const text = removeBlanks(label).toUpperCase();
  const endsWithSpecial = (family) => family.special && text.endsWith(`/${family.special}`);
  const labelName = removeMarks(label);
  const reasons = [];
  let bestReading = null;
  for (const family of [
    ...TABLE.families.filter(endsWithSpecial), ...TABLE.families.filter((listedFamily) => !listedFamily.base),
  ]) {
    try {
      const reading = readLabelOfFamily(family, label);
      // The tail of one family's code can be a part of another family's code.
      if (!bestReading || reading.tail.length < bestReading.tail.length) bestReading = reading;
    } catch (error) {
      if (!(error instanceof UnknownCode)) throw error;
      const nameLength = labelName.startsWith(nameWithoutMarks(family)) ? nameWithoutMarks(family).length : 0;
      const length = Math.max(nameLength, lengthBeforeParts(family));
      if (error.isClose || nameLength) reasons.push({ error, length });
    }
  }
  if (bestReading) return bestReading;
  const namedFamily = TABLE.families.find((family) => nameWithoutMarks(family) === labelName);
  if (namedFamily) throw new UnknownCode(messageFor("family", label, namedFamily.codes[0][0]), false);
  if (reasons.length) throw reasons.reduce((best, reason) => (isBetterReason(reason, best) ? reason : best)).error;
  throw new UnknownCode(describeUnknownLabel(label), false);
}

/** Return whether a reason is of a family that is more like the label than that of another reason. */
const isBetterReason = (reason, other) => reason.length > other.length
  || (reason.length === other.length && reason.error.isClose && !other.error.isClose);

/** Return the letters and digits of a label: ``xy24`` of ``X-Y24``. */
const removeMarks = (label) => removeBlanks(label).toLowerCase().replace(/[^a-z0-9]/g, "");

/** Return the name of a family without the marks between its words. */
const nameWithoutMarks = (family) => family.name.replaceAll("_", "");

/** Count the letters and digits in front of the first part of the pattern: 2 for ``X-Y-{bits}``. */
const lengthBeforeParts = (family) => family.labels.pattern.split("{")[0].replace(/[^\p{L}\p{N}]/gu, "").length;

/** The order code on a label, or null if it is unknown. */
function findCode(label) {
  try {
    return readLabel(label);
  } catch (error) {
    if (!(error instanceof UnknownCode)) throw error;
    return null;
  }
}

/** Return the order code on a label if it is one of this family. Throws ``UnknownCode`` with help. */
function readLabelOfFamily(family, label) {
  if (label.length > LONGEST_LABEL) {
    throw new UnknownCode(messageFor("too_long", label.slice(0, 20), label.length, LONGEST_LABEL), true);
  }
  const code = removeBlanks(label).toUpperCase();
  if (!code) throw new UnknownCode(messageFor("code_empty"), true);
  for (const spelling of family.labels.written) {
    const match = compileRegex(spelling.label).exec(code);
    if (match) return { ...resolveOrderCode(family, spelling, match.groups, code), label };
  }
  throw explainWrongPart(family, code);
}

/** Return the order code of a label whose parts a spelling of the family has matched, with notes about its tail. */
function resolveOrderCode(family, spelling, groups, code) {
  const { parts, pattern } = family.labels;
  const texts = mergeByName(Object.fromEntries(parts.map(({ name }) => {
    const spelledText = spelling.values?.[name]?.[groups[name].toUpperCase()];
    return [name, spelledText ?? groups[name]];
  })));
  const namesAndValues = parts.map((part) => [part.name, findListedValue(part, texts[part.name])]);
  const values = mergeByName(Object.fromEntries(namesAndValues));
  const row = findFittingRow(family, values);
  if (!row) throw new UnknownCode(describeClash(family, code, texts, values), true);
  const unlisted = parts.map((part) => part.name).filter((name) => values[name] === undefined);
  const listedCode = orderCodeOfRow(family, row);
  return {
    ...listedCode,
    code: unlisted.length ? fillPattern(pattern, mergeByName(texts, omitUndefined(values))) : listedCode.code,
    unlisted,
    tail: groups.tail_ ?? "",
    isSpecial: groups.special_ !== undefined,
    writtenAsIn: spelling.where ?? "",
  };
}

/** Return the values by name, except those that are undefined. */
const omitUndefined = (values) => Object.fromEntries(
  Object.entries(values).filter(([, listedText]) => listedText !== undefined));

/** The first listed code with these parts, where undefined represents an unlisted value. */
function findFittingRow(family, values) {
  const unlistedParts = family.labels.parts.filter((part) => values[part.name] === undefined);
  const isAllowed = ([otherPart, allowedValues]) =>
    values[otherPart] === undefined || allowedValues.includes(values[otherPart]);
  if (!unlistedParts.every((part) => Object.entries(part.only_with ?? {}).every(isAllowed))) return undefined;
  return family.codes.find((row) => {
    const rowValues = partsOfRow(family, row);
    return Object.entries(values).every(([name, wanted]) => wanted === undefined || wanted === rowValues[name]);
  });
}

/** Parts of the listed codes by row of the table, filled in by ``partsOfRow``. */
const partsByRow = new Map();

/** Return the values of the parts of a listed code, by name of the part. */
function partsOfRow(family, row) {
  if (!partsByRow.has(row)) {
    const { groups } = compileRegex(family.labels.written[0].label).exec(removeBlanks(row[0]));
    const listed = family.labels.parts.map((part) => [part.name, findListedValue(part, groups[part.name])]);
    partsByRow.set(row, mergeByName(Object.fromEntries(listed)));
  }
  return partsByRow.get(row);
}

/** Return the message about an order code whose parts are listed but exclude each other. */
function describeClash(family, code, texts, values) {
  const names = family.labels.parts.filter((part) => part.values.some(
    (candidate) => findFittingRow(family, mergeByName(values, { [part.name]: candidate })))).map((part) => part.name);
  const namedParts = names.map((name) => `${name} '${values[name] ?? texts[name]}'`).join(" and ") || "its parts";
  return messageFor("cannot_be_combined", code, namedParts, listNearestCodes([family], code));
}

/** Return the error about a text with one part left out or unlisted, or about a text that is far from every code. */
function explainWrongPart(family, code) {
  const { parts, wrong: patterns } = family.labels;
  const candidates = parts.flatMap((part, index) => {
    const groups = compileRegex(patterns[index]).exec(code)?.groups;
    if (!groups || !hasOtherText(groups, part, code)) return [];
    const unlisted = parts.filter(
      (other) => other !== part && findListedValue(other, groups[other.name]) === undefined);
    return [{ part, partText: groups[part.name], rank: 2 * unlisted.length + (groups[part.name] ? 1 : 0) }];
  });
  if (!candidates.length) {
    return new UnknownCode(
      messageFor("not_of_family", code, family.name.toUpperCase(), listNearestCodes([family], code)), false);
  }
  const { part, partText } = candidates.reduce(
    (best, candidate) => (candidate.rank < best.rank ? candidate : best));
  const partProblem = partText ? messageFor("has_part", part.name, partText) : messageFor("has_no_part", part.name);
  const validValues = part.values.join(", ") + (part.open ? messageFor("unlisted_values", part.open) : "");
  return new UnknownCode(
    messageFor("wrong_part", code, partProblem, validValues, listNearestCodes([family], code)), true);
}

/** Return whether a label has letters or digits of the family, apart from a wrong part and the tail. */
function hasOtherText(groups, part, code) {
  const partText = groups[part.name];
  const ownText = code.slice(0, code.length - (groups.tail_ ?? "").length - (groups.special_ ?? "").length);
  return /[A-Z0-9]/i.test(ownText.replace(partText, ""));
}

/** Return the message about a text that is far from the codes of every family, with the nearest codes. */
function describeUnknownLabel(text) {
  const nearestCodes = listNearestCodes(TABLE.families, text, TABLE.limits.likeness);
  return messageFor("unknown", text) + (nearestCodes ? messageFor("nearest", nearestCodes) : "");
}

/** List three similar codes with commas, those that begin with the text first. ``leastLikeness`` is from 0 to 1. */
function listNearestCodes(families, text, leastLikeness = 0) {
  // People confuse hyphens and slashes.
  const textWithHyphens = text.toUpperCase().replaceAll("/", "-");
  const pieces = textWithHyphens.split("-");
  const rank = ([code]) => {
    const codeWithHyphens = code.toUpperCase().replaceAll("/", "-");
    const textWithoutTail = pieces.slice(0, codeWithHyphens.split("-").length).join("-");
    return {
      code, begins: codeWithHyphens.startsWith(textWithHyphens),
      likeness: computeSimilarity(codeWithHyphens, textWithoutTail),
    };
  };
  return families.flatMap((family) => family.codes.map(rank))
    .sort((one, other) => other.begins - one.begins || other.likeness - one.likeness).slice(0, 3)
    .filter(({ likeness }) => likeness >= leastLikeness).map(({ code }) => code).join(", ");
}

/** Return the similarity of two texts from 0 to 1, as difflib.SequenceMatcher computes it. */
function computeSimilarity(text, otherText) {
  const countMatching = (start, end, otherStart, otherEnd) => {
    let [bestStart, bestLength, bestOtherStart] = [0, 0, 0];
    let lengthsBefore = new Map();
    for (let index = start; index < end; index += 1) {
      const lengthsHere = new Map();
      for (let otherIndex = otherStart; otherIndex < otherEnd; otherIndex += 1) {
        if (text[index] !== otherText[otherIndex]) continue;
        const length = (lengthsBefore.get(otherIndex - 1) ?? 0) + 1;
        lengthsHere.set(otherIndex, length);
        if (length > bestLength) [bestStart, bestOtherStart, bestLength] = [
          index - length + 1, otherIndex - length + 1, length];
      }
      lengthsBefore = lengthsHere;
    }
    return bestLength ? bestLength + countMatching(start, bestStart, otherStart, bestOtherStart)
      + countMatching(bestStart + bestLength, end, bestOtherStart + bestLength, otherEnd) : 0;
  };
  const total = text.length + otherText.length;
  return total ? (2 * countMatching(0, text.length, 0, otherText.length)) / total : 1;
}

/** Return the order code of a row of the table, which is [code, index of its interface, values of the parameters]. */
function orderCodeOfRow(family, [code, interfaceIndex, ...values]) {
  const namesAndValues = (family.given ?? []).map((name, index) => [name, toBigInt(values[index])]);
  const parameters = mergeByName(Object.fromEntries(namesAndValues));
  return { code, family, interface: family.interfaces[interfaceIndex], parameters };
}
