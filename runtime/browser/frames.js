// License 0BSD: use, modify and distribute this file without any condition.
// Decoding and encoding of frames and registers by the table.

/**
 * Place the fields of a layout for an order code, except fields of 0 bits. In the result, places are numbers of bits,
 * and a placed field is {field, name, low, width} with the ``field`` of the table.
 */
function placeLayout(family, layout, parameters) {
  const evaluate = (expression) => Number(evaluateExpression(expression, parameters));
  const sharedParts = (indexes = []) => indexes.map((index) => family.shared[index]);
  const isSatisfied = (condition) => !condition
    || Boolean(parameters[condition.parameter]) === Boolean(condition.holds);
  const fields = sharedParts(layout.fields).map((field) => withMeaningForOrderCode(field, parameters))
    .map((field) => ({ field, name: field.name, low: evaluate(field.low), width: evaluate(field.width) }))
    .filter(({ width }) => width > 0);
  const crcFieldName = fields.find(({ field }) => field.crc)?.name;
  return {
    family, layout, parameters, fields, name: layout.name, bits: evaluate(layout.bits),
    crc: family.crcs?.[layout.crcs ? layout.crcs[crcFieldName] : layout.crc],
    gray: placeGray(layout.gray, parameters),
    digits: (layout.digits ?? []).map((coding) => (
      { ...coding, low: Number(evaluate(coding.low ?? 0)), width: Number(evaluate(coding.width)) })),
    joins: (layout.joins ?? []).map((join) => placeJoin(join, fields, parameters)),
    checks: sharedParts(layout.checks).map((check) => placeCheck(check, parameters))
      .filter(({ width }) => width > 0),
    reportCauses: sharedParts(layout.tells).filter(({ only }) => isSatisfied(only)),
    verdictCauses: (layout.speaks ?? []).filter(({ only, chosen }) => isSatisfied(only) && isSatisfied(chosen)),
  };
}

/** Return a field, with the text of an unexplained field if its meaning belongs to other order codes. */
function withMeaningForOrderCode(field, parameters) {
  const isExplained = !field.only || parameters[field.only];
  return isExplained ? field : { ...field, on: TABLE.unexplained, off: "", meaning: "" };
}

/** Return {low, width, excess} of the bits in Gray code, or null if the order code sends binary. */
function placeGray(gray, parameters) {
  const isUsed = gray && (!gray.when || parameters[gray.when]);
  if (!isUsed) return null;
  const evaluate = (expression) => evaluateExpression(expression, parameters);
  return { low: Number(evaluate(gray.low)), width: Number(evaluate(gray.width)), excess: evaluate(gray.excess ?? 0) };
}

/**
 * Return {name, parts} of a number in several fields. A part is {placedField, low} with the lowest bit in the number.
 * Its ``placedField`` is undefined if the field has 0 bits.
 */
function placeJoin(join, fields, parameters) {
  const parts = join.fields.map(([fieldName, low]) => ({
    placedField: fields.find(({ name }) => name === fieldName), low: Number(evaluateExpression(low, parameters)) }));
  return { name: join.name, parts };
}

/** Return a check with its place, its limits, and for a parity the {low, width} of the bits that it covers. */
function placeCheck(check, parameters) {
  const evaluate = (expression) => Number(evaluateExpression(expression, parameters));
  return {
    check, low: evaluate(check.low), width: evaluate(check.width),
    limit: check.limit === undefined ? undefined : evaluateExpression(check.limit, parameters),
    lowest: evaluateExpression(check.lowest ?? 0, parameters),
    joinedPlaces: check.joined?.map(([low, width]) => ({ low: evaluate(low), width: evaluate(width) })),
    coveredPlaces: check.parity_of?.map(([low, width]) => ({ low: evaluate(low), width: evaluate(width) })),
  };
}

/** Return the decoded number: fields, CRC, errors, reports and verdict. */
function decode(placedLayout, number) {
  if (number >> BigInt(placedLayout.bits)) {
    return createLengthError(placedLayout, `${placedLayout.bits} bits`, bitLength(number));
  }
  const decoded = createEmptyResult(placedLayout, number);
  const binary = convertToBinary(placedLayout, number);
  decoded.fields = placedLayout.fields.flatMap((placedField) => decodeFieldAndRuns(placedField, number, binary));
  decoded.crc = checkCrc(placedLayout, number);
  if (decoded.crc && decoded.crc.received !== decoded.crc.computed) {
    const messageName = hasExchangedBytes(decoded.crc) ? "crc_exchanged" : "crc";
    const message = messageFor(messageName, hex(decoded.crc.received, 2), hex(decoded.crc.computed, 2));
    decoded.problems.push({ fault: "crc", field: decoded.crc.field, message });
  }
  decoded.problems.push(...placedLayout.checks.flatMap((placedCheck) => findProblems(placedCheck, number, binary)));
  const rankOf = (problem) => TABLE.faults.indexOf(problem.fault);
  decoded.problems.sort((problem, otherProblem) => rankOf(problem) - rankOf(otherProblem));
  decoded.fields.push(...placedLayout.joins.map((join) => joinFields(join, number, binary)));
  if (!decoded.problems.length) judgeFrame(decoded);
  return decoded;
}

/** Create the result of decoding, with its lists still empty. */
const createEmptyResult = (placedLayout, number) => ({
  placedLayout, number, fields: [], crc: null, problems: [], reports: [], differences: [], verdict: null,
});

/** Return the result of a frame of another length than the layout needs. */
function createLengthError(placedLayout, neededText, receivedCount) {
  const decoded = createEmptyResult(placedLayout, 0n);
  decoded.problems.push(
    { fault: "length", field: "", message: messageFor("length", placedLayout.name, neededText, receivedCount) });
  return decoded;
}

/** Decode a frame or register of bytes. */
function decodeBytes(placedLayout, bytes) {
  if (8 * bytes.length !== placedLayout.bits) {
    return createLengthError(placedLayout, countWithNoun(placedLayout.bits / 8, "byte"), bytes.length);
  }
  return decode(placedLayout, numberOfFrame(placedLayout.layout, bytes));
}

/** Return the number of a frame with digits and Gray code converted to binary, less the Gray excess. */
function convertToBinary(placedLayout, frame) {
  const number = placedLayout.digits.reduce(
    (sum, coding) => replaceBits(coding, sum, numberOfDigits(coding, extractBits(sum, coding.low, coding.width))), frame);
  if (!placedLayout.gray) return number;
  const { low, width, excess } = placedLayout.gray;
  const binary = grayToBinary(extractBits(number, low, width)) - excess;
  return replaceBits(placedLayout.gray, number, binary);
}

/** Return the number that digits form. If a digit has no valid code, its bits are all 1. */
function numberOfDigits({ width, digit_bits: digitBits, codes }, sentBits) {
  let number = 0n;
  for (let place = Math.floor((width - 1) / digitBits) * digitBits; place >= 0; place -= digitBits) {
    const digit = codes.indexOf(Number(extractBits(sentBits, place, digitBits)));
    if (digit < 0) return ones(width);
    number = number * BigInt(codes.length) + BigInt(digit);
  }
  return number;
}

/** Return the bits of the digits of a number. */
function digitsOfNumber({ width, digit_bits: digitBits, codes }, number) {
  let [bits, remaining] = [0n, number];
  for (let place = 0; place < width; place += digitBits) {
    bits |= BigInt(codes[Number(remaining % BigInt(codes.length))]) << BigInt(place);
    remaining /= BigInt(codes.length);
  }
  return bits;
}

/** Return the number with other bits at a place. */
function replaceBits({ low, width }, number, newBits) {
  return (number & ~(ones(width) << BigInt(low))) | (BigInt.asUintN(width, newBits) << BigInt(low));
}

/** Return the number that a number in Gray code represents. */
function grayToBinary(gray) {
  let binary = gray;
  for (let shifted = gray >> ONE; shifted; shifted >>= ONE) binary ^= shifted;
  return binary;
}

/** Return the number of a frame with digits as they are sent, and the position in Gray code with the excess added. */
function convertFromBinary(placedLayout, frame) {
  const number = placedLayout.digits.reduce(
    (sum, coding) => replaceBits(coding, sum, digitsOfNumber(coding, extractBits(sum, coding.low, coding.width))), frame);
  if (!placedLayout.gray) return number;
  const { low, width, excess } = placedLayout.gray;
  const sumWithExcess = BigInt.asUintN(width, extractBits(number, low, width) + excess);
  return replaceBits(placedLayout.gray, number, sumWithExcess ^ (sumWithExcess >> ONE));
}

/** Return a field in readable form, with its runs of digits. ``raw`` is transmitted, ``value`` is decoded. */
function decodeFieldAndRuns(placedField, number, binary) {
  const { field, low, width } = placedField;
  const fieldBits = extractBits(binary, low, width);
  const decodedField = {
    name: field.name, raw: extractBits(number, low, width), value: fieldBits, unit: field.unit ?? "",
    scale: field.scale, meaning: field.meaning ?? "", high: low + width - 1, low, colour: field.colour,
    ...interpretRaw(field, fieldBits, width),
  };
  const runs = (field.runs ?? []).map(([name, divisor, modulus, meaning = ""]) => {
    const runNumber = (fieldBits / toBigInt(divisor)) % toBigInt(modulus);
    return { ...decodedField, name, raw: runNumber, value: runNumber, unit: "", scale: undefined, meaning };
  });
  return [decodedField, ...runs];
}

/** Return {value, meaning} of the bits of a field by its kind. */
function interpretRaw(field, raw, width) {
  switch (field.kind) {
    case "flag":
    case "not_flag": {
      const isActive = (raw === 0n) === (field.kind === "not_flag");
      return { value: isActive, meaning: (isActive ? field.on : field.off) || field.meaning || "" };
    }
    case "choice": {
      const listedChoice = field.values.find((choice) => toBigInt(choice[0]) === raw);
      return listedChoice ? { value: listedChoice[1], meaning: listedChoice[2] || field.meaning || "" } : {};
    }
    case "signed":
      return { value: BigInt.asIntN(width, raw) };
    case "text": {
      const characterCodes = bytesOf("big", raw, width / 8);
      return { value: String.fromCharCode(...characterCodes) };
    }
    case "digits":
    case undefined:
      return { value: raw || toBigInt(field.zero_means) };
    default:
      throw new TypeError(`unknown kind ${field.kind}`);
  }
}

/** Join the parts of a number that is sent in several fields. */
function joinFields(join, number, binary) {
  const parts = join.parts.filter(({ placedField }) => placedField);
  const joinFrom = (source) => parts.reduce((sum, { placedField, low }) => (
    sum | (extractBits(source, placedField.low, placedField.width) << BigInt(low))), 0n);
  const names = parts.map(({ placedField }) => placedField.name).reverse().join(" and ");
  const meaning = join.parts.length > 1 ? messageFor("as_one_number", names) : "";
  // The place of several fields is left empty.
  return { name: join.name, raw: joinFrom(number), value: joinFrom(binary), unit: "", meaning, high: -1, low: -1 };
}

/** Return the placed field with the CRC. */
const findCrcField = (placedLayout) => placedLayout.fields.find((placedField) => placedField.field.crc);

/** Return the received CRC and the computed one, or null if the layout has no CRC. */
function checkCrc(placedLayout, number) {
  const { crc } = placedLayout;
  if (!crc) return null;
  const field = findCrcField(placedLayout);
  const received = extractBits(number, field.low, field.width);
  return { crc, field: field.name, received, computed: computeCrc(crc, placedLayout, number) };
}

/** Return whether a CRC is wrong, but would be correct if its bytes were sent in reverse order. */
function hasExchangedBytes({ crc, received, computed }) {
  const width = Number(crc.width);
  if (received === computed || width % 8) return false;
  return numberOf("big", bytesOf("little", received, width / 8)) === computed;
}

/** Return the lowest bit that the CRC of a frame covers, and the number of these bits. */
function placeOfCoveredBits(placedLayout) {
  const { width } = findCrcField(placedLayout);
  return placedLayout.layout.crc_of ?? [width, placedLayout.bits - width];
}

/** Compute the CRC with these parameters over the bits of a frame that its CRC covers. */
function computeCrc(crc, placedLayout, number) {
  const { width } = findCrcField(placedLayout);
  const [low, bitCount] = placeOfCoveredBits(placedLayout);
  if (!placedLayout.layout.order || width % 8) return crcOfBits(crc, number >> BigInt(low), bitCount);
  return crcOfBytes(crc, bytesOfFrame(placedLayout.layout, number, placedLayout.bits / 8).slice(0, -width / 8));
}

/** Return a list with the problem if the bits at the place of a check are wrong, otherwise an empty list. */
function findProblems(placedCheck, number, binary) {
  const { check, low, width, limit, lowest, coveredPlaces, joinedPlaces } = placedCheck;
  // A parity covers the bits as sent, before Gray code is converted.
  const checkedBits = joinedPlaces
    ? joinPlaces(joinedPlaces, binary) : extractBits(coveredPlaces ? number : binary, low, width);
  const checkedNumber = check.says === "outside" ? BigInt.asIntN(width, checkedBits) : checkedBits;
  const rightValues = coveredPlaces ? [computeParity(number, coveredPlaces, check)]
    : (check.values ?? []).map((listedValue) => toBigInt(listedValue) & ones(width));
  const hasLimit = limit !== undefined;
  const isCorrect = hasLimit
    ? checkedNumber >= lowest && checkedNumber <= limit : rightValues.includes(checkedNumber);
  if (isCorrect) return [];
  const message = check.says === "not_in_code"
    ? messageFor(check.says, check.field, hex(extractBits(number, low, width)), limit, check.code)
    : describeProblem(placedCheck, checkedNumber, rightValues[0]);
  return [{ fault: check.fault, field: check.field, message }];
}

/** Return the number that the bits at several places form, most significant first. */
const joinPlaces = (places, number) => places.reduce(
  (sum, { low, width }) => (sum << BigInt(width)) | extractBits(number, low, width), 0n);

/** Return the message about a wrong number. Its name in the table is that of the check. */
function describeProblem({ check, limit, lowest, coveredPlaces }, checkedNumber, rightValue) {
  const { field, says: messageName } = check;
  switch (messageName) {
    case "constant":
      return messageFor(messageName, field, hex(checkedNumber), hex(rightValue));
    case "parity":
      return messageFor(messageName, field, checkedNumber, listCoveredFields(check, coveredPlaces), rightValue);
    case "no_value":
      return messageFor(messageName, field, hex(checkedNumber));
    case "of_other_frame":
      return messageFor(messageName, field, hexDigits(checkedNumber));
    case "too_high":
      return messageFor(messageName, field, checkedNumber, limit);
    case "outside":
      return messageFor(messageName, `${field} ${checkedNumber}`, lowest, limit);
    case "digits":
      return messageFor(messageName, field, checkedNumber, check.most);
    default:
      throw new TypeError(`unknown check ${messageName}`);
  }
}

/** Return the names of the fields that a parity bit covers, without those that the order code does not have. */
const listCoveredFields = (check, coveredPlaces) => (
  check.of_names.filter((_, index) => coveredPlaces[index].width > 0).join(", "));

/** Add the reports, the verdict and the differences from the manual to the result of a valid frame or register. */
function judgeFrame(decoded) {
  const { placedLayout, number } = decoded;
  const binary = convertToBinary(placedLayout, number);
  const isActive = (placedField) => (
    isActiveOrDiffers(placedField, extractBits(binary, placedField.low, placedField.width)));
  const activeNames = new Set(placedLayout.fields.filter(isActive).map((placedField) => placedField.name));
  const applies = ({ flag, when }) =>
    (when ? when.every((pair) => hasFieldValue(decoded, pair)) : activeNames.has(flag));
  decoded.reports = placedLayout.reportCauses.filter(applies);
  if (placedLayout.layout.otherwise) {
    const decidingCause = placedLayout.verdictCauses.find((cause) =>
      applies(cause) && !(cause.unless ?? []).some((name) => activeNames.has(name)));
    decoded.verdict = decidingCause ? decidingCause.verdict : placedLayout.layout.otherwise;
    if (!hasJudgingBits(placedLayout) && decoded.verdict !== "not_usable") decoded.verdict = "unknown";
  }
  decoded.differences = [
    ...placedLayout.fields.flatMap((placedField) => findDifference(decoded, placedField)), ...findStrangeRuns(decoded),
  ];
}

/** Return whether the frame has bits that say whether the position is usable, if this depends on the order code. */
function hasJudgingBits({ layout, parameters }) {
  return layout.judges_if_positive === undefined || evaluateExpression(layout.judges_if_positive, parameters) > 0;
}

/** Return whether a flag is active, or unused bits differ from the manual. */
function isActiveOrDiffers({ field, width }, raw) {
  if ("unused" in field) return raw !== (toBigInt(field.unused) & ones(width));
  return field.kind === "flag" ? raw !== 0n : field.kind === "not_flag" && raw === 0n;
}

/** Return whether a flag is active (1) or inactive (0), or another field has this value. */
function hasFieldValue({ placedLayout, number }, [name, wantedNumber]) {
  const placedField = placedLayout.fields.find((candidate) => candidate.name === name);
  const raw = placedField && extractBits(convertToBinary(placedLayout, number), placedField.low, placedField.width);
  if (!placedField) return false;
  return isFlag(placedField.field)
    ? isActiveOrDiffers(placedField, raw) === (wantedNumber === 1) : raw === toBigInt(wantedNumber);
}

/** Return whether a field is a flag, active high or active low. */
const isFlag = ({ kind }) => kind === "flag" || kind === "not_flag";

/** Return a list with the message about a field that differs from its documented value, otherwise an empty list. */
function findDifference(decoded, { field }) {
  if (field.equals === undefined || decoded.placedLayout.layout.sender === "master") return [];
  const decodedField = decoded.fields.find((candidate) => candidate.name === field.name);
  const isText = typeof field.equals === "string";
  const actual = isText ? decodedField.value : decodedField.raw;
  const documented = isText ? field.equals : evaluateExpression(field.equals[0], decoded.placedLayout.parameters);
  if (actual === documented) return [];
  const [actualText, documentedText] = [actual, documented].map(
    (content) => (isText ? `"${content}"` : hex(content, 2)));
  const name = field.printed || field.name;
  return [decoded.placedLayout.layout.sender
    ? messageFor("other_value", name, actualText, documentedText)
    : messageFor("other_content", name, actualText, decoded.placedLayout.code, documentedText)];
}

/** Return the messages about runs of digits outside their usual range. */
function findStrangeRuns(decoded) {
  const strangeRanges = decoded.placedLayout.layout.strange ?? [];
  return strangeRanges.flatMap(([runName, low, high, template]) => {
    const run = decoded.fields.find(({ name }) => name === runName);
    const isStrange = run && (run.raw < toBigInt(low) || run.raw > toBigInt(high));
    return isStrange ? [fillTemplate(template, run.raw)] : [];
  });
}

/** Return the names and values of the fields that together hold a number. Excess bits go to the highest field. */
function splitNumber(parts, number) {
  const highestBit = Math.max(...parts.map((part) => part.low + (part.placedField?.width ?? 0)));
  return parts.filter((part) => part.placedField).map(({ placedField, low }) => {
    const isOpen = low + placedField.width === highestBit || number < 0n;
    return [placedField.name, isOpen ? number >> BigInt(low) : extractBits(number, low, placedField.width)];
  });
}

/** Error about a value that a register or field rejects. */
class Refusal extends Error {}

/** Return the number whose fields have these values: numbers, booleans and texts by name. */
function encode(placedLayout, values) {
  const parities = placedLayout.fields.filter((placedField) => placedField.field.parity);
  let number = placedLayout.fields.reduce(
    (sum, placedField) => sum | (encodeField(placedField, values) << BigInt(placedField.low)), 0n);
  number = convertFromBinary(placedLayout, number);
  parities.forEach((placedField) => {
    const coveredFields = placedLayout.fields.filter((candidate) => placedField.field.parity.includes(candidate.name));
    number |= computeParity(number, coveredFields, placedField.field) << BigInt(placedField.low);
  });
  if (placedLayout.crc) {
    number |= computeCrc(placedLayout.crc, placedLayout, number) << BigInt(findCrcField(placedLayout).low);
  }
  for (const problem of decode(placedLayout, number).problems) throw new Refusal(problem.message);
  return number;
}

/** Return whether the user provides the value of a field. All others are derived. */
const isEnteredByUser = ({ field }) => !["crc", "parity", "fixed", "unused"].some((name) => name in field);

/** Return the bits of a field for a value: a number, a boolean or a text. */
function encodeField(placedField, values) {
  const { field, width } = placedField;
  if ("fixed" in field) return toBigInt(field.fixed) & ones(width);
  if (!isEnteredByUser(placedField)) return toBigInt(field.unused) & ones(width);
  const wantedValue = values[field.name];
  if (isFlag(field)) return BigInt(wantedValue === (field.kind === "flag"));
  if (field.kind === "text") return encodeText(placedField, wantedValue);
  const raw = field.zero_means && wantedValue === toBigInt(field.zero_means) ? 0n : BigInt.asUintN(width, wantedValue);
  if (interpretRaw({
    ...field, kind: field.kind === "signed" ? "signed" : undefined,
  }, raw, width).value !== wantedValue) {
    throw new Refusal(messageFor("too_wide", field.name, wantedValue, width));
  }
  if (field.power_of_two && wantedValue & (wantedValue - ONE)) throw new Refusal(
    messageFor("no_power_of_two", field.name, wantedValue));
  return raw;
}

/** Return the bits of a text, one byte for each character. */
function encodeText({ field, width }, text) {
  const characterCodes = [...text].map((character) => character.codePointAt(0));
  if (characterCodes.length !== width / 8 || characterCodes.some((code) => code > 255)) {
    throw new Refusal(messageFor("too_wide", field.name, `"${text}"`, width));
  }
  return numberOf("big", characterCodes);
}

/** Reject a number outside the limits of its register. */
function refuseOutsideLimits(placedLayout, number, limits) {
  if (!limits || (limits.low === null && limits.high === null)) return;
  const decodedFields = decode(placedLayout, number).fields;
  const limitedNumber = limits.of ? decodedFields.find((candidate) => candidate.name === limits.of).value : number;
  const boundOf = (limit) => (limit === null ? null : evaluateExpression(limit, placedLayout.parameters));
  const [low, high] = [boundOf(limits.low), boundOf(limits.high)];
  if ((low !== null && limitedNumber < low) || (high !== null && limitedNumber > high)) {
    throw new Refusal(messageFor("outside", limitedNumber, low ?? "the lowest value", high ?? "the highest value"));
  }
}

/** Return the fields that together hold the one number of a register, such as a position. */
function listPartsOfNumber(placedLayout) {
  const [join] = placedLayout.joins;
  if (join) return join.parts;
  return placedLayout.fields.filter(isEnteredByUser).map((placedField) => ({ placedField, low: 0 }));
}

/** Return the bytes of a register that holds one number, such as a position, in hex. */
function bytesOfNumber(placedLayout, number, limits) {
  const namesAndValues = splitNumber(listPartsOfNumber(placedLayout), number);
  return bytesFor(placedLayout, mergeByName(Object.fromEntries(namesAndValues)), limits);
}

/** Return the highest number that a register can hold within its limits. */
function highestNumber(placedLayout, limits) {
  const partWidths = listPartsOfNumber(placedLayout).filter((part) => part.placedField)
    .map(({ placedField, low }) => low + placedField.width - (placedField.field.kind === "signed" ? 1 : 0));
  const [highestInBits, limit] = [ones(Math.max(...partWidths)), limits?.high ?? null];
  const allowed = limit === null ? highestInBits : evaluateExpression(limit, placedLayout.parameters);
  return allowed < highestInBits ? allowed : highestInBits;
}

/** Return the bytes of a register with these values, in hex. */
function bytesFor(placedLayout, values, limits) {
  const number = encode(placedLayout, values);
  refuseOutsideLimits(placedLayout, number, limits);
  return formatBytes(bytesOfFrame(placedLayout.layout, number, placedLayout.layout.length));
}
