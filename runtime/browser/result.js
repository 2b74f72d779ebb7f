// License 0BSD: use, modify and distribute this file without any condition.
// Display of a decoded frame or register. Text of specs is only ever inserted as text.

const CLASS = "codewheel-decode";
/** Class for the color and shape of a verdict. All others are plain. */
const VERDICT_CLASSES = { usable: "good", usable_with_warning: "warning", not_usable: "bad" };

/** An element with attributes and children, without empty children. */
function createElement(tag, attributes = {}, ...children) {
  const newElement = document.createElement(tag);
  for (const [name, setting] of Object.entries(attributes)) {
    if (setting !== undefined && setting !== false) newElement.setAttribute(name, setting === true ? "" : setting);
  }
  newElement.append(...children.flat().filter((child) => child !== "" && child !== null && child !== undefined));
  return newElement;
}

/** Create an element of the class ``codewheel-decode-NAME``. */
const createPart = (tag, name, ...children) => createElement(tag, { class: `${CLASS}-${name}` }, ...children);
/** Create a paragraph with a sentence. */
const createSentence = (text) => createElement("p", {}, toSentence(text));
/** Create a list with an entry for each content: a text, an element, or an array of both. */
const createList = (contents) => createElement("ul", {}, contents.map((content) => createElement("li", {}, content)));
/** Return the text with a capital first letter. */
const capitalize = (text) => text[0].toUpperCase() + text.slice(1);
/** Return the text with a full stop, unless it ends in a mark already. */
const toSentence = (text) => (/[.!?:]$/.test(text) ? text : `${text}.`);

/** Return the place of a field in readable form: bits of a word, or bytes of a frame from 0. */
function formatPlace(placedLayout, { high, low }) {
  if (high < 0) return "";
  const rangeText = (from, to) => (from === to ? `${from}` : `${from}:${to}`);
  if (!placedLayout.layout.order) return rangeText(high, low);
  const ends = [low, high].sort(
    (bit, otherBit) => byteIndexOf(placedLayout, bit) - byteIndexOf(placedLayout, otherBit));
  const bytes = ends.map((bit) => byteIndexOf(placedLayout, bit));
  const isWholeBytes = low % 8 === 0 && high % 8 === 7;
  if (bytes[0] === bytes[1]) return `byte ${bytes[0]}${isWholeBytes ? "" : `.${rangeText(high % 8, low % 8)}`}`;
  return isWholeBytes ? `bytes ${bytes[0]}-${bytes[1]}` : `bytes ${bytes[0]}.${ends[0] % 8}-${bytes[1]}.${ends[1] % 8}`;
}

/** Return the value of a field as text, and the value of a flag in words. */
const formatValue = (fieldValue) => (fieldValue === true ? "yes" : fieldValue === false ? "no" : `${fieldValue}`);

/** Return the meaning of a field, and for a number in Gray code also how it was sent. */
function describeMeaning({ gray, joins }, { name, high, low, raw, value, meaning }) {
  const isInGray = (lowest, highest) => gray && lowest >= gray.low && highest < gray.low + gray.width;
  const parts = joins.find((join) => join.name === name)?.parts ?? [];
  const joinedFields = parts.map(({ placedField }) => placedField).filter(Boolean);
  const isGray = high < 0
    ? joinedFields.length > 0 && joinedFields.every((field) => isInGray(field.low, field.low + field.width - 1))
    : isInGray(low, high);
  if (!isGray || typeof value !== "bigint") return meaning;
  const grayText = messageFor("gray", hex(raw), hex(value));
  return meaning ? `${toSentence(meaning)} ${capitalize(grayText)}` : grayText;
}

/** Return a value with its unit, or a number with the quantity that it represents. */
function formatWithUnit(field) {
  const valueText = formatValue(field.value);
  if (typeof field.value === "boolean" || !(field.scale || field.unit)) return valueText;
  return field.scale ? `${valueText} (${quantityOf(field.scale, field.value)})` : `${valueText} ${field.unit}`;
}

/** Return a name that may wrap after each of its words, as texts and elements. */
const breakableName = (name) => (
  name.split("_").flatMap((word, index) => (index ? ["_", createElement("wbr"), word] : [word])));

/** Return the length of a frame in bytes or bits, which with all its data channels is ``bitCount``. */
const describeLength = ({ layout, bits }, bitCount = bits) => (
  layout.order ? countWithNoun(bits / 8, "byte") : countWithNoun(bitCount, "bit"));

/** Create the table of the decoded fields: the place, the name with its meaning, and the value with the raw number. */
function createFieldTable(decoded) {
  const { placedLayout } = decoded;
  const { layout } = placedLayout;
  const rows = decoded.fields.map((field) => {
    const isOneBit = field.high >= 0 && field.high === field.low;
    const rawText = createPart("span", "raw", isOneBit ? `${field.raw}` : hex(field.raw));
    return createElement("tr", {},
      createElement("td", {}, formatPlace(placedLayout, field)),
      createElement("th", { scope: "row" }, breakableName(field.name),
        createPart("span", "meaning", describeMeaning(placedLayout, field))),
      createElement("td", {}, formatWithUnit(field), rawText));
  });
  const heads = ["Place", "Field", "Value, raw"].map((text) => createElement("th", { scope: "col" }, text));
  return createElement("table", {},
    createElement("caption", {}, `${layout.title}, ${describeLength(placedLayout)}`,
      layout.source ? createPart("span", "source", `, manual ${layout.source}`) : ""),
    createElement("thead", {}, createElement("tr", {}, heads)), createElement("tbody", {}, rows));
}

/** Return the decoded field with the measured number, or with its part within a turn if only that is a number. */
function findMeasuredField({ fields }, measure) {
  const findNumber = (name) => fields.find((field) => field.name === name && typeof field.value === "bigint");
  return findNumber(measure?.of) ?? findNumber(measure?.part);
}

/** The position in degrees or micrometres if it is usable, or the angle of a frame with only an angle. */
function describeMeasurement(decoded, measure) {
  if (!measure || !decoded.verdict || decoded.verdict === "not_usable") return "";
  const position = findMeasuredField(decoded, measure);
  if (!position) return "";
  const { parameters } = decoded.placedLayout;
  const evaluate = (expression) => (expression === undefined ? 0n : evaluateExpression(expression, parameters));
  const [stepUm, stepNm, countsPerTurn] = [
    evaluate(measure.step_um), evaluate(measure.step_nm), evaluate(measure.counts_per_turn)];
  if (stepUm) return `${position.name}: ${formatFraction(position.value * stepUm, ONE)} µm`;
  if (stepNm) return (
    `${position.name}: ${formatFraction(position.value * stepNm, 1000n * (evaluate(measure.per_counts) || ONE))} µm`);
  if (countsPerTurn < ONE) return "";
  // A negative remainder would be an angle before revolution 0.
  const angle = ((position.value % countsPerTurn) + countsPerTurn) % countsPerTurn;
  const degrees = (Number(angle * 360n) / Number(countsPerTurn)).toFixed((countsPerTurn / 360n).toString().length);
  const hasTurns = evaluate(measure.turns) > ONE && position.name === measure.of;
  return (
    `${position.name}: ${degrees}°${hasTurns ? ` of revolution ${(position.value - angle) / countsPerTurn}` : ""}`);
}

/** Create the line about the CRC of a frame: received, and correct or with the expected CRC, with its parameters. */
function createCrcLine({ crc, received, computed }) {
  const judgement = received === computed ? "correct" : `WRONG, expected ${hex(computed, 2)}`;
  const startText = crc.init ? `, start value ${hex(toBigInt(crc.init))}` : "";
  const invertedText = toBigInt(crc.xorout) === ones(crc.width) ? ", sent inverted" : "";
  return createElement("p", {}, `CRC ${hex(received, 2)}: ${judgement} (${crc.text}${startText}${invertedText})`);
}

/** List the reports of the encoder, each with its meaning, remedy and source. */
function listReports(decoded) {
  if (!decoded.reports.length) return [];
  const entries = decoded.reports.map((report) => [
    createElement("strong", {}, report.flag), `: ${toSentence(report.meaning)}`,
    report.remedy ? ` ${toSentence(report.remedy)}` : "",
    report.source ? createPart("span", "source", ` [${report.source}]`) : "",
  ]);
  return [createElement("p", {}, "The encoder reports:"), createList(entries)];
}

/** Create the first line: the verdict or the errors. */
function createHeadline(decoded) {
  if (decoded.problems.length) {
    const problemTexts = decoded.problems.map((problem) => `${problem.fault} error: ${problem.message}`);
    return createPart("div", "bad", problemTexts.map((text) => createElement("p", {}, text)));
  }
  const isRegister = decoded.placedLayout.layout.length !== undefined;
  const errorText = isRegister || decoded.crc ? "No error" : "No error, but this frame does not have a CRC";
  const phrases = [
    ...(decoded.reports.length ? [] : [errorText]), ...(decoded.verdict ? [TABLE.worth[decoded.verdict]] : [])];
  const verdict = decoded.verdict ? [createElement("code", {}, decoded.verdict), ": "] : [];
  const [firstSentence, ...moreSentences] = phrases.map(toSentence);
  const line = phrases.length
    ? [createElement("p", {}, verdict, [firstSentence, ...moreSentences.map(capitalize)].join(" "))] : [];
  return createPart("div", VERDICT_CLASSES[decoded.verdict] ?? "plain", line);
}

/** Name the other frames that it can be, in a sentence. */
function nameOtherFrames(decoded, otherLayouts) {
  if (!otherLayouts.length) return [];
  const names = otherLayouts.map((placedLayout) => placedLayout.name.replaceAll("_", " ")).join(", ");
  const textName = isAnotherFrame(decoded, otherLayouts) ? "valid_other" : decoded.problems.length ? "instead" : "also";
  const otherText = messageFor(textName, names);
  const otherCode = findOtherCode(decoded, otherLayouts);
  const otherReading = otherCode ? ` ${toSentence(messageFor("another_reading", otherCode))}` : "";
  return [createElement("p", {}, `${capitalize(otherText)}. Choose it above.${otherReading}`)];
}

/** Create the folded list of other readings of a position, which nothing in the frame contradicts. */
function createDoubts(decoded, measure) {
  const readings = otherPositions(decoded, measure).map(([text, position]) => `${position} ${text}`).join(", ");
  return readings ? [foldDoubt(measure, readings)] : [];
}

/** Create the note on a word that is also the request of the master, which makes all else in it meaningless. */
function createEchoNote(decoded) {
  const requestName = ownRequest(decoded);
  return requestName ? [createSentence(capitalize(messageFor("own_request", requestName)))] : [];
}

/** Create a question about the position that unfolds to its other ``readings``, a text. */
function foldDoubt(measure, readings) {
  const [question, ...answerParts] = messageFor("looks_wrong", positionNameOf(measure), readings).split("? ");
  return createElement("details", {},
    createElement("summary", {}, `${question}?`), createSentence(answerParts.join("? ")));
}

/** Create the lines about the mistakes that could explain a wrong frame. */
function createExplanations(decoded, hasOtherFrames) {
  const deadLineText = deadLine(decoded);
  if (deadLineText) return [createSentence(capitalize(deadLineText))];
  if (!decoded.problems.length) return [];
  const noiseText = describeNoise(decoded);
  const explanations = explained(decoded);
  const missingText = missingPart(decoded);
  const describedExplanations = explanations.map(
    (explanation) => describeExplanation(explanation.placedLayout ?? decoded.placedLayout, explanation));
  const explanationLines = explanations.length ? [
    createElement("p", {}, introduceExplanations(decoded, noiseText !== "")), createList(describedExplanations)] : [];
  const isIncomplete = missingText && decoded.problems.some(({ fault }) => fault === "length");
  const isUnexplained = !explanations.length && !isIncomplete && !hasOtherFrames && isCorrupted(decoded);
  const failure = hasOddCrcOverBytes(decoded) ? "not_searched" : "no_explanation";
  const notes = [
    ...(isUnexplained ? [toSentence(messageFor(failure))] : []),
    ...describeEqualReadings(decoded, explanations),
    ...(explanations.length && hidesShift(explanations[0]) ? [toSentence(messageFor("hidden_shift"))] : []),
    ...(anotherHelps(explanations) ? [messageFor("another_frame")] : []),
  ];
  return [
    ...(missingText ? [createElement("p", {}, toSentence(capitalize(missingText)))] : []),
    ...(noiseText ? [createElement("p", {}, noiseText)] : []), ...explanationLines,
    ...notes.map((note) => createElement("p", {}, note)),
  ];
}

/** Return the text about a corrupted bit, or "" if the frame stays wrong whichever single bit is inverted. */
function describeNoise(decoded) {
  const disturbedBits = findDisturbedBits(decoded);
  if (!disturbedBits.length) return "";
  const bitText = disturbedBits.length === 1
    ? nameBit(decoded.placedLayout, disturbedBits[0]) : `one of ${disturbedBits.length} bits`;
  if (hasOnlyParity(decoded.placedLayout)) return messageFor("disturbed_or_shifted", bitText);
  const hasCrc = Boolean(decoded.placedLayout.crc);
  return messageFor(hasCrc ? "disturbed" : "disturbed_without_crc", bitText);
}

/** Return the words before the explanations. If noise is also a cause (``hasNoise``), they are another cause. */
function introduceExplanations(decoded, hasNoise) {
  if (!canCrcContradict(decoded)) return `${messageFor("uncertain")}:`;
  return hasNoise ? "If all frames fail, possible explanations, most likely first:"
    : "Possible explanations, most likely first:";
}

/** Return whether a frame has a transmission error: a wrong CRC or length, or without a CRC, a wrong constant. */
const isCorrupted = ({ problems, crc }) => problems.some(
  ({ fault }) => ["crc", "length", "constant"].includes(fault))
  && !(crc && (crc.received === crc.computed || hasExchangedBytes(crc)));

/** Return the sentence on readings of a frame without a CRC that fit equally well, in a list, or an empty list. */
function describeEqualReadings(decoded, explanations) {
  if (canCrcContradict(decoded) || explanations.length < 2) return [];
  const mostFrames = explanations.map(({ oneIn }) => oneIn).reduce((most, oneIn) => (oneIn > most ? oneIn : most));
  const equalCount = explanations.filter(({ oneIn }) => oneIn === mostFrames).length;
  return equalCount > 1 ? [toSentence(messageFor("equal_readings", `${equalCount}`))] : [];
}

/** Describe one explanation: its text and chance, the numbers that the frame then contains, and the recording. */
function describeExplanation(placedLayout, { text, oneIn, number, orNumbers = [], parts = [] }) {
  const chanceText = oneIn > ONE ? ` (matches by chance in 1 of ${oneIn} frames)` : "";
  const numbers = number === undefined ? [] : [number, ...orNumbers];
  const numberTexts = numbers.map((frameNumber) => numbersRead(placedLayout, frameNumber)
    .map(([name, fieldNumber]) => `${name} ${fieldNumber}`).join(", ")).filter(Boolean);
  const readsText = numberTexts.length ? `: ${numberTexts.join(" or ")}` : "";
  return [`${text}${chanceText}${readsText}`, parts.length ? drawParts(parts) : ""];
}

/** Draw the parts of a recording, each a name and its bits, like the bits of a frame. */
const drawParts = (parts) => createPart("div", "drawing", parts.map(([name, partBits]) =>
  createPart("span", `cell ${CLASS}-cell-${name === "frame" ? "data" : "flag"}`,
    createPart("span", "bits", partBits), createPart("span", "name", name.replaceAll("_", "-")))));

/** Return the index from 0, in the order sent, of the byte that has a bit of the frame's number. */
function byteIndexOf({ layout, bits }, bit) {
  const index = layout.order === "little" ? bit >> 3 : bits / 8 - 1 - (bit >> 3);
  const place = layout.exchanged?.find(([start, stop]) => index >= start && index < stop);
  return place ? place[0] + place[1] - 1 - index : index;
}
/** Name a bit of a frame: by its byte if the frame is in bytes, and otherwise by its place in the word. */
const nameBit = (placedLayout, bit) => (
  placedLayout.layout.order ? `bit ${bit % 8} of byte ${byteIndexOf(placedLayout, bit)}` : `bit ${bit}`);

/** Create all output about a frame or register. ``otherLayouts`` are the other frames that it can be. */
function createResult(decoded, measure, otherLayouts) {
  const angleText = describeMeasurement(decoded, measure);
  const table = decoded.fields.length ? createFieldTable(decoded) : null;
  return [
    ...createEchoNote(decoded),
    createHeadline(decoded),
    ...(decoded.differences.length
      ? [createList(decoded.differences.map((difference) => `differs from the manual: ${difference}`))] : []),
    ...listReports(decoded),
    ...(table && angleText ? [createPart("p", "angle", angleText)] : []),
    ...(isAnotherFrame(decoded, otherLayouts) ? [] : createExplanations(decoded, otherLayouts.length > 0)),
    ...(table ? [drawFrameBits(decoded, table), table] : []),
    ...(decoded.crc ? [createCrcLine(decoded.crc)] : []),
    ...nameOtherFrames(decoded, otherLayouts),
    ...createDoubts(decoded, measure),
  ];
}

/** Create all output about a frame with several data channels: its verdict, and then each channel. */
function createWholeResult(decoded, measure) {
  const wrongChannels = decoded.channels.filter(({ problems }) => problems.length);
  const wrongNames = wrongChannels.map(({ placedLayout }) => placedLayout.name).join(" and ");
  const summaryText = wrongNames ? messageFor("no_position", wrongNames) : decoded.compared?.words;
  const summaryLines = summaryText ? [createSentence(capitalize(summaryText))] : [];
  // Some order codes do not send every channel.
  const sentChannels = decoded.channels.filter(({ placedLayout }) => placedLayout.bits > 0);
  const channelLines = sentChannels.flatMap((channel) => [
    createElement("h3", {}, capitalize(channel.placedLayout.layout.title)),
    ...createResult({ ...channel, verdict: channel.verdict && decoded.verdict }, measure, []),
  ]);
  const readingLines = decoded.readings.map((reading) => createSentence(messageFor("all_crcs_correct", reading)));
  return [createHeadline({ ...decoded, crc: true }), ...summaryLines, ...readingLines, ...channelLines];
}

/** Create a button for each order code, which calls ``pick`` with it. */
function createCodeButtons(codes, pick) {
  return createPart("div", "codes", codes.map((code) => createButton(code, () => pick(code))));
}

/** Compare two guesses: those that miss less than a byte of leading zeros come first, and then those with a CRC. */
function compareGuesses(first, second) {
  const missingBits = ({ decoded }) => Math.max(decoded.placedLayout.bits - (decoded.typedFrame?.written ?? Infinity), 0);
  const [firstRank, secondRank] = [first, second].map(
    (guess) => [missingBits(guess) >= 8, !guess.decoded.crc, missingBits(guess)]);
  const differingIndex = firstRank.findIndex((part, index) => part !== secondRank[index]);
  return differingIndex < 0 ? 0 : firstRank[differingIndex] - secondRank[differingIndex];
}

/**
 * List the order codes that match the frame in a text. ``pick`` selects one of them. If codes near to the label match it,
 * only these are listed. A frame that no code matches is not called wrong beside them, because a mistake may explain it.
 */
function createGuesses(frameText, pick, nearCodes) {
  const allGroups = inferred(frameText);
  const nearGroups = allGroups.map((group) => (
    { ...group, codes: group.codes.filter((code) => nearCodes.includes(code)) })).filter(({ codes }) => codes.length);
  const groups = nearGroups.length ? nearGroups : allGroups;
  if (!groups.length && nearCodes.length) return [];
  if (!groups.length) return [createPart("div", "bad", createSentence(capitalize(notOfAnyCode(frameText))))];
  const entries = groups.sort(compareGuesses).map((group) => {
    const { placedLayout } = group.decoded;
    const lengthText = describeLength(placedLayout, group.decoded.bits);
    const crcText = group.decoded.crc ? "with a correct CRC" : "without a CRC";
    const mark = group.family.mark ? ` (${group.family.mark})` : "";
    const text = (
      `${group.interface.title} from the ${group.sender}, `
        + `${placedLayout.layout.title}: ${lengthText}, ${crcText}${mark}`);
    return [createElement("p", {}, text), createCodeButtons(group.codes, (code) => pick(code, group.sender))];
  });
  const introduction = "Valid frame of these order codes. Select the one on the label:";
  return [createElement("p", {}, introduction), createList(entries)];
}
