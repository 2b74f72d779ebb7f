// Licence 0BSD: use, modify and distribute this file without any condition.
// The mistakes in the table that would explain a wrong frame, with the same order as on the command line.

// A hypothesis that fewer bits can contradict matches too many random frames.
const LEAST_BITS = 3;
// Frames with fewer bits may be all zeros or all ones by coincidence.
const LEAST_EQUAL_BITS = 12;
// An explanation that matches fewer random frames than one in this many is as good as certain.
const CERTAIN_ONE_IN = 65536n;

/** Return the text about a dead line, or "" if the line changes. */
function deadLine({ at: placedLayout, given: typedFrame, number, data, problems, over: interface_ }) {
  if (placedLayout?.layout.length !== undefined) return "";
  const wordBits = typedFrame?.exact ? typedFrame.bits : Math.max(placedLayout?.bits ?? 0, typedFrame?.bits ?? 0);
  const bitCount = data ? 8 * data.length : wordBits;
  const receivedNumber = data ? data.reduce((sum, byte) => (sum << 8n) | BigInt(byte), 0n)
    : typedFrame?.number ?? number;
  if (bitCount < LEAST_EQUAL_BITS || (receivedNumber !== 0n && receivedNumber !== ones(bitCount))) return "";
  const level = receivedNumber ? 1 : 0;
  const doubt = placedLayout?.crc ? "and the CRC is correct too" : "and there is no CRC to distinguish it";
  // Without a CRC, the length alone proves nothing.
  const mayBeFrame = placedLayout && (
    placedLayout.crc ? !problems.length
      : hasRightConstants(placedLayout, receivedNumber ? ones(placedLayout.bits) : 0n));
  return mayBeFrame ? `Every bit is ${level}. A dead line looks the same, ${doubt}.`
    : `Every bit is ${level}: the line never changes. Check for ${level ? "a broken wire" : "a short circuit"}, `
      + `the supply and ${interface_?.name === "rs485" ? "wires A and B" : "the clock"}.`;
}

/** Return the bits that make the frame valid if one of them is inverted: the usual cause if only some frames fail. */
function findDisturbedBits({ at: placedLayout, number, problems }) {
  if (!placedLayout?.crc || problems[0]?.fault === "length"
    || !problems.some((problem) => problem.fault === "crc")) return [];
  const { low, width } = crcField(placedLayout);
  const crc = placedLayout.family.crcs[placedLayout.crc];
  const isValid = (candidate) => computedBy(crc, placedLayout, candidate) === bits(candidate, low, width)
    && hasRightConstants(placedLayout, candidate);
  return [...Array(placedLayout.bits).keys()].filter((bit) => isValid(number ^ (ONE << BigInt(bit))));
}

/** Return the mistakes that explain the frame, most likely first, each with its random frames per match. */
const explained = (decoded) => findExplanations(decoded).merged;

/**
 * Return the explanations of a frame twice: ``merged`` has one of those that lead to the same frame, ``all`` has every
 * one. ``isWithPairs`` also tries two mistakes if a single one matches.
 */
function findExplanations(decoded, isWithPairs = false) {
  const { at: placedLayout, given: typedFrame, data, problems } = decoded;
  const hasFault = (...faults) => problems.some((problem) => faults.includes(problem.fault));
  const noExplanations = { merged: [], all: [] };
  if (!problems.length || deadLine(decoded)) return noExplanations;
  if (data) {
    if (placedLayout && !hasFault("crc", "length", "constant")) return noExplanations;
    const hypotheses = tryMistakesInBytes(decoded);
    return hasCrcInBytes(decoded) ? explainWithCrc(hypotheses, [], isWithPairs) : explainWithoutCrc(hypotheses);
  }
  if (!placedLayout || !typedFrame || !hasFault("crc", "length", "constant")) return noExplanations;
  const crc = placedLayout.crc && placedLayout.family.crcs[placedLayout.crc];
  if (!crc) return explainWithoutCrc([
    ...tryMovedFrames(placedLayout, null, typedFrame), ...tryRearrangedFrames(placedLayout, null, typedFrame)]);
  const refuted = typedFrame.bits > placedLayout.bits || (typedFrame.exact && typedFrame.bits !== placedLayout.bits)
    ? [] : [createHypothesisAsSent(placedLayout, crc, typedFrame.number)];
  if (hasFault("crc", "length")) return explainWithCrc(
    tryMistakesInBits(placedLayout, crc, typedFrame), refuted, isWithPairs);
  const fittingFrames = [
    ...tryRearrangedFrames(placedLayout, crc, typedFrame), ...tryMovedFrames(placedLayout, crc, typedFrame),
  ].filter(fitsFrame);
  const significant = selectSignificant(fittingFrames, refuted);
  return significant.length ? explainWithCrc(significant, [], isWithPairs) : noExplanations;
}

/** Return whether any frame in bytes from the sender has a CRC. */
const hasCrcInBytes = ({ label: orderCode, over: interface_, sender }) => !orderCode
  || interface_.frames.some((layout) => layout.order && layout.sender === sender && layout.crc);

/** Return the part that a recording without a complete frame lacks, or "". */
function missingPart(decoded) {
  const { at: placedLayout, given: typedFrame, problems } = decoded;
  if (!typedFrame || !placedLayout || deadLine(decoded)) return "";
  if (isCutWord(decoded) && !explained(decoded).length) return findMissingPart(
    placedLayout, typedFrame.number.toString(2).padStart(typedFrame.written, "0"));
  if (!problems.some((problem) => problem.fault === "length")
    || mayHaveBits(typedFrame, placedLayout.bits)) return "";
  const crc = placedLayout.crc && placedLayout.family.crcs[placedLayout.crc];
  const isFoundByRule = (hypothesis) => hypothesis.kind !== TABLE.inside[0] && fitsFrame(hypothesis)
    && (!crc || (hypothesis.known + hypothesis.demanded >= LEAST_BITS && !isIdleLine(hypothesis)));
  if (tryMovedFrames(placedLayout, crc, typedFrame).some(isFoundByRule)) return "";
  return findMissingPart(placedLayout, writeReceivedBits(placedLayout, typedFrame));
}

/** Whether a wrong word of SSI or SPI with a CRC has at least a byte fewer hex digits than the frame. */
const isCutWord = ({ at: placedLayout, given: typedFrame, problems }) => !typedFrame.exact && typedFrame.written > 0
  && typedFrame.written <= placedLayout.bits - 8 && interfaceOf(placedLayout).name !== "biss"
  && problems.some((problem) => problem.fault === "crc");

/** Return the part that these received bits lack, by the patterns of the line. */
function findMissingPart(placedLayout, receivedText) {
  for (const [text, pattern] of lineRulesOf(placedLayout)?.incomplete ?? []) {
    const match = matchRecording(pattern, placedLayout, receivedText);
    const bitCount = match?.groups?.frame?.length ?? 0;
    if (match && bitCount < placedLayout.bits) return fillTemplate(
      text, bitCount, placedLayout.bits, placedLayout.bits - bitCount);
  }
  return "";
}

/** Return whether other frames with the same mistake would decide between these explanations. */
const anotherHelps = (explanations) => explanations.every((explanation) => explanation.kind !== "echo")
  && (explanations.length > 1 || (explanations.length === 1 && explanations[0].oneIn < CERTAIN_ONE_IN));

/** Return the mistakes that explain the most of several wrong frames, most likely first: single ones, or else two. */
function judgedTogether(decodedFrames) {
  const hasCrcOrLengthError = ({ problems }) => problems.some(
    (problem) => problem.fault === "crc" || problem.fault === "length");
  const explainedFrames = decodedFrames.slice(-TABLE.likely.frames)
    .map((decoded) => ({ frame: decoded, all: findExplanations(decoded).all }))
    .filter(({ frame, all }) => all.length || hasCrcOrLengthError(frame));
  const singleMistakes = findCommonMistakes(explainedFrames.map(({ all }) => all));
  if (singleMistakes.length && singleMistakes[0].frames === explainedFrames.length) return singleMistakes;
  return findCommonMistakes(explainedFrames.map(({ frame }) => findExplanations(frame, true).all));
}

/** The logarithm of the likelihood. A mistake is made once, so its frequency counts once. */
function computeCommonScore(explanations) {
  const frequency = Math.log2(TABLE.likely.kinds[explanations[0].kind]);
  return explanations.reduce((sum, explanation) => sum + (Math.log2(explanation.score) - frequency), 0) + frequency;
}

/**
 * Return the mistakes that explain the most frames, most likely first, from a list of explanations for each frame.
 * Explanations of frames with the same kind and template are one mistake.
 */
function findCommonMistakes(explanationLists) {
  const explanationsByKey = new Map();
  for (const explanations of explanationLists) {
    const likeliestByKey = new Map([...explanations].reverse().map(
      (explanation) => [`${explanation.kind} ${explanation.template} ${explanation.isTwice}`, explanation]));
    for (const [key, explanation] of likeliestByKey) explanationsByKey.set(
      key, [...explanationsByKey.get(key) ?? [], explanation]);
  }
  const mostFrames = Math.max(0, ...[...explanationsByKey.values()].map((explanations) => explanations.length));
  return [...explanationsByKey.values()].filter((explanations) => explanations.length === mostFrames)
    .map((explanations) => ({
      text: new Set(explanations.map((explanation) => explanation.text)).size === 1 ? explanations[0].text
        : withoutDetails(explanations[0].template),
      frames: mostFrames,
      oneIn: explanations.reduce((product, explanation) => product * explanation.oneIn, ONE),
      score: computeCommonScore(explanations),
      hidesShift: hidesShift(explanations[0]),
    })).sort((mistake, otherMistake) => otherMistake.score - mistake.score);
}

/** Return the interface that carries the frame. */
const interfaceOf = (placedLayout) => (
  placedLayout.family.interfaces.find((candidate) => candidate.frames?.includes(placedLayout.layout)));
/** Return the mistakes with the bits around a frame on its line, or undefined if the line carries bytes. */
const lineRulesOf = (placedLayout) => TABLE.lines[interfaceOf(placedLayout)?.line];
/** Match a pattern, in which ``#`` is the number of bits of the frame, with bits written in the order received. */
const matchRecording = (pattern, placedLayout, receivedText) => (
  new RegExp(pattern.replace("#", placedLayout.bits)).exec(receivedText));

// -- hypotheses

/**
 * Create the hypothesis that a mistake was made, from the members that its kind needs. The CRC covers the ``size`` bits
 * of ``data``, and ``received`` are the first ``known`` bits of the received CRC. The mistake determines ``demanded``
 * other bits, and ``holds`` is true if they are right. ``fixed`` counts the right constant bits, ``lost`` the last bits
 * that were cut off, and ``places`` the places at which the frame was searched.
 */
const createHypothesis = (members) => ({
  template: members.text, data: 0n, size: 0, received: 0n, known: 0, demanded: 0, holds: true, fixed: 0, likelihood: 1,
  lost: 0, parts: [], places: 1, ...members,
});

/** Return whether a frame with the mistake has these bits: the ones that it determines, and the CRC. */
function fitsFrame({
  crc, holds: isConsistent, isOfBytes, data: coveredData, size: coveredBits, known: crcBitsReceived,
  received: receivedCrc,
}) {
  if (!isConsistent || !crc) return isConsistent;
  const computedCrc = isOfBytes ? crcOfBytes(crc, bytesOf("big", coveredData, coveredBits / 8))
    : crcOfBits(crc, coveredData, coveredBits);
  return computedCrc >> BigInt(crc.width - crcBitsReceived) === receivedCrc;
}

/** Return the number of random frames of which one matches the hypothesis by chance, at least 1. */
const countFramesPerMatch = ({ known: crcBitsReceived, demanded: otherBitsRequired, places: placeCount }) => {
  const framesPerMatch = ONE << BigInt(crcBitsReceived + otherBitsRequired);
  return framesPerMatch > BigInt(placeCount) ? framesPerMatch / BigInt(placeCount) : ONE;
};
/** Return the likelihood of a mistake that matches: its frequency times the improbability of the match by chance. */
const computeScore = ({
  kind, known: crcBitsReceived, demanded: otherBitsRequired, fixed: rightConstantBits, likelihood, places: placeCount,
}) => (TABLE.likely.kinds[kind] * likelihood
  * 2 ** (crcBitsReceived + Math.max(otherBitsRequired, rightConstantBits))) / placeCount;

/** Return the key of a hypothesis. Hypotheses with the same key match the same frames. */
function matchKeyOf({
  crc, data: coveredData, size: coveredBits, received: receivedCrc, known: crcBitsReceived,
}) {
  const crcKey = crc && ["width", "poly", "init", "refin", "refout", "xorout"]
    .map((name) => `${big(crc[name])}`).join(" ");
  return `${crcKey} ${coveredData} ${crc && big(crc.init) ? coveredBits : 0} ${receivedCrc} ${crcBitsReceived}`;
}

/** Return whether all bits of the resulting frame are equal, as on an idle line. */
const isIdleLine = ({ at: placedLayout, number }) => Boolean(placedLayout) && placedLayout.bits >= LEAST_EQUAL_BITS
  && (number === 0n || number === ones(placedLayout.bits));

/** The tries that do not match too many random frames, without those known to fail. */
function selectSignificant(hypotheses, refuted) {
  const refutedKeys = new Set(refuted.map(matchKeyOf));
  return hypotheses.filter((hypothesis) => hypothesis.known + hypothesis.demanded >= LEAST_BITS
    && !isIdleLine(hypothesis) && !refutedKeys.has(matchKeyOf(hypothesis)));
}

/** Select the likeliest of the hypotheses that lead to the same frame. */
function selectDistinct(hypotheses) {
  const likeliestByKey = new Map();
  for (const hypothesis of hypotheses) {
    const fieldPlaces = hypothesis.at && [
      hypothesis.at.bits,
      ...hypothesis.at.fields.map((placedField) => `${placedField.name} ${placedField.low}`),
    ].join(" ");
    const resultKey = (
      `${matchKeyOf(hypothesis)} ${hypothesis.at ? `${hypothesis.number} ${fieldPlaces}` : hypothesis.text}`);
    const likeliest = likeliestByKey.get(resultKey);
    const isLikelier = !likeliest || (hypothesis.holds === likeliest.holds
      ? computeScore(hypothesis) > computeScore(likeliest) : hypothesis.holds);
    if (isLikelier) likeliestByKey.set(resultKey, hypothesis);
  }
  return [...likeliestByKey.values()];
}

/** Return a hypothesis that fits as an explanation, with its chance and score. ``isTwice`` marks two mistakes. */
const toExplanation = (hypothesis, isTwice = false) => (
  { ...hypothesis, isTwice, oneIn: countFramesPerMatch(hypothesis), score: computeScore(hypothesis) });
/** Sort the explanations in place, most likely first. */
const sortByScore = (explanations) => (
  explanations.sort((explanation, otherExplanation) => otherExplanation.score - explanation.score));

/** The explanations among tries with a CRC. Pairs are tried if no single mistake matches. */
function explainWithCrc(hypotheses, refuted, isWithPairs) {
  const significant = selectSignificant(hypotheses, refuted);
  const unrepeated = significant.filter((hypothesis) => !hypothesis.isRepeated);
  const distinct = selectDistinct(unrepeated);
  const merged = distinct.filter(fitsFrame).map((hypothesis) => toExplanation(hypothesis));
  const all = significant.filter(fitsFrame).map((hypothesis) => toExplanation(hypothesis));
  if (isWithPairs || merged.every((explanation) => explanation.kind === TABLE.inside[0])) {
    const pairs = selectSignificant(unrepeated.filter((hypothesis) => (
      hypothesis.crc && !["crc_not_inverted", TABLE.inside[0]].includes(hypothesis.kind)))
      .map(pairWithInversion), refuted);
    const explainPairs = (pairHypotheses) => (
      pairHypotheses.filter(fitsFrame).map((hypothesis) => toExplanation(hypothesis, true)));
    merged.push(...explainPairs(selectDistinct([...distinct, ...pairs]).slice(distinct.length)));
    all.push(...explainPairs(pairs));
  }
  return { merged: sortByScore(merged), all: sortByScore(all) };
}

/** Pair the mistake with the most common one, a CRC that is inverted or that should be. */
function pairWithInversion(hypothesis) {
  const textName = big(hypothesis.crc.xorout) ? "not_inverted_too" : "inverted_too";
  const template = fillTemplate(TABLE.texts[textName], hypothesis.template);
  const crc = { ...hypothesis.crc, xorout: big(hypothesis.crc.xorout) ^ ones(hypothesis.crc.width) };
  return { ...hypothesis, crc, template, text: fillTemplate(TABLE.texts[textName], hypothesis.text) };
}

/** The readings of a frame without a CRC. Nothing proves one of them. */
function explainWithoutCrc(hypotheses) {
  const fitting = sortByScore(hypotheses.filter(fitsFrame).map((hypothesis) => toExplanation(hypothesis)));
  const byMistake = new Map();
  for (const [index, explanation] of fitting.entries()) {
    const key = explanation.hasAssumedBit ? `${explanation.kind} ${explanation.template}` : index;
    byMistake.set(key, [...byMistake.get(key) ?? [], explanation]);
  }
  const all = sortByScore([...byMistake.values()].map(mergeSameMistake));
  const frames = all.map((explanation) => explanation.number ?? explanation.text);
  return { all, merged: all.filter((explanation, index) => frames.indexOf(frames[index]) === index) };
}

/** Return whether the CRC of an explanation is also valid for every second frame that is shifted by one bit. */
const hidesShift = ({ kind, crc, isOfBytes }) => kind === "crc_not_inverted" && Boolean(crc) && !isOfBytes
  && !big(crc.init) && !big(crc.xorout);

/** Merge explanations that differ only in the value of a lost bit. Each of them has half the evidence. */
function mergeSameMistake([likeliest, ...others]) {
  if (!others.length) return likeliest;
  return {
    ...likeliest, text: withoutDetails(likeliest.template),
    oneIn: others.reduce((sum, { oneIn }) => sum + oneIn, likeliest.oneIn),
    score: others.reduce((sum, { score }) => sum + score, likeliest.score),
    orNumbers: others.map(({ number }) => number),
  };
}

/** Return a template as a text without the details of a frame. */
const withoutDetails = (template) => fillTemplate(template.replace("({0}) ", ""), "some");

/** Return the bits that the CRC covers, shifted to bit 0, and how many they are. */
function coveredBitsOf(placedLayout, number) {
  const { width } = crcField(placedLayout);
  const [low, bitCount] = placedLayout.layout.crc_of ?? [width, placedLayout.bits - width];
  return { data: bits(number, low, bitCount), size: bitCount };
}

/** Create the hypothesis that the frame is as sent, to which the caller adds the mistake. */
function createHypothesisAsSent(placedLayout, crc, number) {
  return createHypothesis({
    crc, ...coveredBitsOf(placedLayout, number), received: bits(number, 0, crc.width), known: crc.width,
    fixed: hasRightConstants(placedLayout, number) ? countConstantBits(placedLayout) : 0,
    likelihood: computeLikelihood(placedLayout, number), text: "",
  });
}

/**
 * The frame was this number, whose last bits were not received.
 * These ``lost`` bits belong to the CRC, of which the others are compared. Without a CRC, they are assumed as in the
 * number, so they prove nothing.
 */
function createFrameHypothesis(
  placedLayout, crc, kind, text, frameNumber,
  { lost: missingLowBits = 0, demanded: otherBitsRequired = 0, holds: isConsistent = true, ...otherMembers } = {},
) {
  if (!crc) {
    return createHypothesis({
      kind, text, at: placedLayout, number: frameNumber, lost: missingLowBits, data: frameNumber,
      size: placedLayout.bits, likelihood: computeLikelihood(placedLayout, frameNumber),
      demanded: otherBitsRequired + Math.max(countConstantBits(placedLayout) - missingLowBits, 0),
      holds: isConsistent && hasRightConstants(placedLayout, frameNumber), ...otherMembers,
    });
  }
  return createHypothesis({
    kind, text, crc, at: placedLayout, number: frameNumber, lost: missingLowBits,
    ...coveredBitsOf(placedLayout, frameNumber), likelihood: computeLikelihood(placedLayout, frameNumber),
    received: bits(frameNumber, 0, crc.width) >> BigInt(missingLowBits), known: crc.width - missingLowBits,
    demanded: otherBitsRequired + countConstantBits(placedLayout),
    holds: isConsistent && hasRightConstants(placedLayout, frameNumber), ...otherMembers,
  });
}

// Each function whose name begins with "try" returns the hypotheses of a mistake, or [] if it is impossible here.

// -- frames of bits

/** Return the lengths in bits that a typed frame may have, longest first: as typed, or that of the frame and 1 less. */
const possibleLengthsOf = (placedLayout, typedFrame) => (typedFrame.exact || typedFrame.bits > placedLayout.bits
  ? [typedFrame.bits] : [placedLayout.bits, placedLayout.bits - 1])
  .filter((length) => length >= typedFrame.bits);
/** Return whether a typed frame may have this number of bits: exactly those typed, or also more leading zeros. */
const mayHaveBits = (typedFrame, bitCount) => (
  typedFrame.exact ? typedFrame.bits === bitCount : typedFrame.bits <= bitCount);
/** Return whether a placed field is error or warning: a flag, or an unused bit that is 1. */
const isStatusField = ({ field, width }) => (
  isFlag(field) || ("unused" in field && Boolean(big(field.unused)) && width === 1));

/** Try every single mistake that could have turned a valid frame into this one. */
function tryMistakesInBits(placedLayout, crc, typedFrame) {
  const otherCrcs = possibleLengthsOf(placedLayout, typedFrame).includes(placedLayout.bits)
    ? tryOtherCrcs(placedLayout, crc, typedFrame.number) : [];
  const hypotheses = [
    ...otherCrcs, ...tryRearrangedFrames(placedLayout, crc, typedFrame),
    ...tryMovedFrames(placedLayout, crc, typedFrame)];
  if (placedLayout.layout.crc_of) return hypotheses;
  return [
    ...hypotheses, ...tryRemovedStatus(placedLayout, crc, typedFrame),
    ...tryOtherPolynomials(placedLayout, crc, typedFrame)];
}

/** Try the frame as sent with another CRC. */
function tryOtherCrcs(placedLayout, crc, number) {
  const asSent = createHypothesisAsSent(placedLayout, crc, number);
  const withMistake = (kind, text, members) => ({ ...asSent, kind, text, template: text, ...members });
  const hypotheses = (crc.others ?? []).map(
    ([kind, text, parameters]) => withMistake(kind, text, { crc: parameters }));
  hypotheses.push(withMistake(
    "crc_reversed", TABLE.texts.crc_reversed, { received: reflected(asSent.received, crc.width) }));
  if (placedLayout.layout.crc_of) return hypotheses;
  const startBitRules = interfaceOf(placedLayout)?.name === "biss" ? TABLE.start_bits : [];
  return [
    ...hypotheses, ...tryOtherStatus(placedLayout, asSent, number, withMistake),
    ...tryOtherPositionCode(placedLayout, asSent, number, withMistake),
    ...startBitRules.map(([startBits, text]) => withMistake("start_bits_in_crc", text, {
      data: (BigInt(`0b${startBits}`) << BigInt(asSent.size)) | asSent.data, size: asSent.size + startBits.length }))];
}

/** Return the bits of error and warning in a frame, set to 1. */
const statusMaskOf = (placedLayout) => placedLayout.fields.filter(isStatusField)
  .reduce((mask, { low, width }) => mask | (ones(width) << BigInt(low)), 0n);

/** The CRC does not cover error and warning, or they were inverted. */
function tryOtherStatus(placedLayout, asSent, number, withMistake) {
  const statusMask = statusMaskOf(placedLayout);
  if (!statusMask) return [];
  const crcWidth = BigInt(asSent.known);
  const remainingBits = [...Array(asSent.size).keys()].reverse()
    .filter((bit) => !bits(statusMask >> crcWidth, bit, 1));
  const remainingData = remainingBits.reduce((sum, bit) => (sum << ONE) | bits(asSent.data, bit, 1), 0n);
  const leftOut = withMistake("status_left_out", TABLE.texts.status_left_out, {
    data: remainingData, size: remainingBits.length });
  // Only bits that are 1 while they are inactive can be converted to active high.
  const hasActiveLow = placedLayout.fields.filter(isStatusField).some(({ field }) => field.kind !== "flag");
  return hasActiveLow ? [leftOut, withMistake("status_turned", TABLE.texts.status_turned, {
    data: (number ^ statusMask) >> crcWidth, likelihood: computeLikelihood(placedLayout, number ^ statusMask) })]
    : [leftOut];
}

/** Find the bits of the number that a master would convert from Gray code: their low bit and width. */
function findConvertedBits({ layout, fields, joins, family, parameters }) {
  if (layout.gray) {
    return {
      low: Number(value(layout.gray.low ?? 0, parameters)), width: Number(value(layout.gray.width, parameters)) };
  }
  const joinedFields = joins[0]?.parts.map(({ item }) => item).filter(Boolean);
  if (joinedFields) {
    const width = joinedFields.reduce((sum, placedField) => sum + placedField.width, 0);
    return { low: joinedFields[0]?.low ?? 0, width };
  }
  const isNumber = ({ field }) => isGiven({ field }) && (field.kind === undefined || field.kind === "signed");
  return fields.filter(isNumber).reduce(
    (widest, placedField) => (placedField.width > widest.width ? placedField : widest), { low: 0, width: 0 });
}

/** Try a position in Gray code under a CRC that covers binary, or vice versa. */
function tryOtherPositionCode(placedLayout, asSent, number, withMistake) {
  const { low, width } = findConvertedBits(placedLayout);
  if (!width) return [];
  const position = bits(number, low, width);
  const otherBits = number ^ (position << BigInt(low));
  const coverConverted = (converted, text) => withMistake("other_code", text, {
    data: (otherBits | (converted << BigInt(low))) >> BigInt(asSent.known) });
  return [coverConverted(plainOf(position), TABLE.texts.covers_binary),
    coverConverted(position ^ (position >> ONE), TABLE.texts.covers_gray)];
}

/** Try frames whose bits are all inverted, or whose bits or bytes are in another order. */
function tryRearrangedFrames(placedLayout, crc, typedFrame) {
  const assumeFrame = (kind, frameNumber, members) => (
    createFrameHypothesis(placedLayout, crc, kind, TABLE.texts[kind], frameNumber, members));
  const hypotheses = [];
  if (possibleLengthsOf(placedLayout, typedFrame).includes(placedLayout.bits)) {
    const inverted = assumeFrame("all_inverted", typedFrame.number ^ ones(placedLayout.bits));
    const frequency = interfaceOf(placedLayout)?.name === "spi" ? TABLE.likely.without_pair : 1;
    hypotheses.push({ ...inverted, likelihood: inverted.likelihood * frequency },
      assumeFrame("bits_reversed", reflected(typedFrame.number, placedLayout.bits)));
    if (placedLayout.bits % 8 === 0) {
      const bytes = bytesOf("big", typedFrame.number, placedLayout.bits / 8);
      hypotheses.push(assumeFrame(
        "bits_reversed_in_bytes", numberOf("big", bytes.map((byte) => reflected(BigInt(byte), 8)))));
    }
  }
  const tryByteOrder = (kind, unitBits, reorder) => {
    const filledBits = Math.ceil(placedLayout.bits / unitBits) * unitBits;
    const isWholeBytes = typedFrame.bits % 8 === 0
      && (typedFrame.bits === placedLayout.bits || typedFrame.bits === filledBits);
    if (typedFrame.number >> BigInt(filledBits) || (typedFrame.exact && !isWholeBytes)) return;
    const filledFrame = numberOf("big", reorder(bytesOf("big", typedFrame.number, filledBits / 8)));
    const frameNumber = bits(filledFrame, 0, placedLayout.bits);
    hypotheses.push(assumeFrame(kind, frameNumber, {
      demanded: filledBits - placedLayout.bits, holds: frameNumber === filledFrame }));
  };
  tryByteOrder("bytes_reversed", 8, (bytes) => bytes.reverse());
  if (placedLayout.bits > 16) tryByteOrder(
    "words_swapped", 16, (bytes) => bytes.map((_, byteIndex) => bytes[byteIndex ^ 1]));
  return hypotheses;
}

/** Error and warning are missing: removed after the CRC was computed, or before. */
function tryRemovedStatus(placedLayout, crc, typedFrame) {
  const statusMask = statusMaskOf(placedLayout);
  const statusBits = onesIn(statusMask);
  const shortBits = placedLayout.bits - statusBits;
  if (!statusMask || statusMask >> BigInt(crc.width) !== ones(statusBits)
    || !mayHaveBits(typedFrame, shortBits)) return [];
  const idleStatus = placedLayout.fields.filter((placedField) => isStatusField(placedField)
    && (placedField.field.kind === "not_flag" || "unused" in placedField.field))
    .reduce((mask, { low, width }) => mask | (ones(width) << BigInt(low)), 0n);
  const data = typedFrame.number >> BigInt(crc.width);
  const receivedCrc = bits(typedFrame.number, 0, crc.width);
  const frameNumber = (data << BigInt(crc.width + statusBits)) | idleStatus | receivedCrc;
  const asIdle = createFrameHypothesis(
    placedLayout, crc, "status_not_sent", TABLE.texts.removed_and_idle, frameNumber);
  if (!typedFrame.exact) return [asIdle];
  return [asIdle, createHypothesis({
    kind: "status_not_sent", text: TABLE.texts.removed, crc, data, size: shortBits - crc.width,
    received: receivedCrc, known: crc.width, likelihood: computeLikelihood(placedLayout, frameNumber),
    number: frameNumber, at: placedLayout })];
}

/** Try data of the right length before a CRC of another length: complete, truncated, or followed by zeros. */
function tryOtherPolynomials(placedLayout, crc, typedFrame) {
  const dataBits = placedLayout.bits - crc.width;
  return TABLE.polynomials.flatMap((polynomial) => {
    const withTopBit = big(polynomial);
    const width = bitLength(withTopBit) - 1;
    if (withTopBit === (big(crc.poly) | (ONE << BigInt(crc.width)))) return [];
    const onesIfSet = (number) => (big(number) ? ones(width) : 0n);
    const otherCrc = {
      ...crc, width, poly: withTopBit & ones(width), init: onesIfSet(crc.init), xorout: onesIfSet(crc.xorout) };
    const lengths = [...new Set([dataBits + width, placedLayout.bits])];
    return lengths
      .filter((length) => length === typedFrame.bits || (!typedFrame.exact && length > typedFrame.bits))
      .map((length) => tryPolynomialWithLength(placedLayout, crc, otherCrc, typedFrame.number, length, dataBits));
  });
}

/** Try another CRC behind the first ``dataBits`` of the ``length`` bits of ``number``. */
function tryPolynomialWithLength(placedLayout, crc, otherCrc, number, length, dataBits) {
  const tailBits = length - dataBits;
  const [data, tail] = [number >> BigInt(tailBits), bits(number, 0, tailBits)];
  const crcBitsReceived = Math.min(otherCrc.width, tailBits);
  const zeroCount = Math.max(tailBits - otherCrc.width, 0);
  const frameNumber = data << BigInt(crc.width);
  const areConstantsRight = hasRightConstants(placedLayout, frameNumber);
  const polynomialText = fillTemplate(
    TABLE.texts.polynomial, hex(otherCrc.poly | (ONE << BigInt(otherCrc.width))), otherCrc.width);
  const text = crcBitsReceived < otherCrc.width
    ? fillTemplate(TABLE.texts.bits_arrived, polynomialText, crcBitsReceived)
    : zeroCount ? fillTemplate(TABLE.texts.then_zeros, polynomialText) : polynomialText;
  const hasFrameLength = length === placedLayout.bits;
  return createHypothesis({
    kind: "other_polynomial", text, crc: otherCrc, data, size: dataBits, received: tail >> BigInt(zeroCount),
    known: crcBitsReceived, demanded: zeroCount + (hasFrameLength ? 0 : countConstantBits(placedLayout)),
    holds: !bits(tail, 0, zeroCount) && (hasFrameLength || areConstantsRight),
    fixed: zeroCount + (areConstantsRight ? countConstantBits(placedLayout) : 0),
    likelihood: computeLikelihood(placedLayout, frameNumber),
  });
}

/** Compute the likelihood of the flags and reserved bits, relative to random bits. */
function computeLikelihood(placedLayout, number) {
  const { idle, active } = TABLE.likely;
  return placedLayout.fields.reduce((product, placedField) => {
    const isActive = isActiveOrDiffers(placedField, bits(number, placedField.low, placedField.width));
    if (isFlag(placedField.field)) return product * (isActive ? active : idle);
    if ("unused" in placedField.field) return product * (isActive ? active : idle ** placedField.width);
    return product;
  }, 1);
}

/** The bits as received, with those leading zeros that were typed, unless they may only pad the frame. */
function writeReceivedBits(placedLayout, typedFrame) {
  const isPadded = typedFrame.exact || typedFrame.number >> BigInt(placedLayout.bits) === 0n;
  const bitCount = isPadded ? typedFrame.bits : Math.max(typedFrame.written ?? 0, typedFrame.bits);
  return typedFrame.number.toString(2).padStart(bitCount, "0");
}

/** The frames with bits around them. A frame is searched at every bit only if no rule of the line finds it. */
function tryMovedFrames(placedLayout, crc, typedFrame) {
  const lineRules = lineRulesOf(placedLayout);
  if (!lineRules) return [];
  const receivedText = writeReceivedBits(placedLayout, typedFrame);
  const commandHypotheses = [
    ...(mayHaveBits(typedFrame, placedLayout.bits) ? tryEcho(placedLayout, typedFrame.number) : []),
    ...tryLeftOutCommand(placedLayout, crc, typedFrame)];
  const hypothesesByRule = [
    ...possibleLengthsOf(placedLayout, typedFrame).flatMap((length) => (
      lineRules.slips.flatMap((offset) => tryOffset(placedLayout, crc, typedFrame, length, offset)))),
    ...lineRules.recordings.flatMap((recording) => tryRecording(placedLayout, crc, receivedText, recording)),
  ];
  if (!crc || hypothesesByRule.some(fitsFrame)) return [...commandHypotheses, ...hypothesesByRule];
  const placeCount = Math.max(receivedText.length - placedLayout.bits + 1, 0);
  const [kind, template] = TABLE.inside;
  return [...commandHypotheses, ...hypothesesByRule, ...[...Array(placeCount).keys()].map((bitsBefore) => {
    const frameText = receivedText.slice(bitsBefore, bitsBefore + placedLayout.bits);
    const parts = [
      ["before", receivedText.slice(0, bitsBefore)], ["frame", frameText],
      ["behind", receivedText.slice(bitsBefore + placedLayout.bits)]];
    const members = { template, parts: parts.filter(([, partText]) => partText), places: placeCount };
    return createFrameHypothesis(
      placedLayout, crc, kind, fillTemplate(template, bitsBefore), BigInt(`0b${frameText}`), members);
  })];
}

/** The bits during the command are missing, and the command is the one that the layout expects. */
function tryLeftOutCommand(placedLayout, crc, typedFrame) {
  if (interfaceOf(placedLayout)?.name !== "spi") return [];
  const [coveredLow, coveredBits] = crc
    ? placedLayout.layout.crc_of ?? [crc.width, placedLayout.bits - crc.width] : [0, placedLayout.bits];
  const isDuringCommand = (placedField) => "fixed" in placedField.field || placedField.low >= coveredLow + coveredBits;
  const fields = [...placedLayout.fields].sort((placedField, otherField) => otherField.low - placedField.low);
  const dataIndex = fields.findIndex((placedField) => !isDuringCommand(placedField));
  const commandFields = fields.slice(0, dataIndex < 0 ? fields.length : dataIndex);
  const remainingBits = commandFields.at(-1)?.low ?? placedLayout.bits;
  if (remainingBits === placedLayout.bits || (placedLayout.bits - remainingBits) % 8
    || !mayHaveBits(typedFrame, remainingBits) || typedFrame.written !== remainingBits) return [];
  const constants = commandFields.filter(({ field }) => "fixed" in field);
  const frameNumber = constants.reduce(
    (sum, placedField) => sum | (big(placedField.field.fixed) << BigInt(placedField.low)), typedFrame.number);
  const text = fillTemplate(TABLE.texts.command_left_out, placedLayout.bits - remainingBits);
  const assumedBits = constants.reduce((sum, { width }) => sum + width, 0);
  return [{
    ...createFrameHypothesis(placedLayout, crc, "command_left_out", text, frameNumber),
    demanded: countConstantBits(placedLayout) - assumedBits }];
}

/**
 * A text that does not begin and end with the frame: extra bits before or after it, or missing bits.
 * ``front`` has a mark for each extra bit before the frame: 1 for a start bit, ~ for mostly 0, and ? for any bit.
 */
function tryOffset(
  placedLayout, crc, typedFrame, length, [kind, template, front, missingFirstBits, missingLowBits, extraLowBits],
) {
  if (length !== placedLayout.bits + front.length - missingFirstBits.length - missingLowBits + extraLowBits) return [];
  const framePartBits = length - front.length - extraLowBits;
  const frontAndFramePart = typedFrame.number >> BigInt(extraLowBits);
  const highestBit = framePartBits + front.length - 1;
  const startBits = [...front].flatMap((mark, index) => (mark === "1" ? [highestBit - index] : []));
  const isConsistent = startBits.every((bit) => bits(frontAndFramePart, bit, 1));
  const frameNumber = ((BigInt(`0b0${missingFirstBits}`) << BigInt(framePartBits))
    | bits(frontAndFramePart, 0, framePartBits)) << BigInt(missingLowBits);
  // Without a CRC, there is a hypothesis for each value of the lost last bits.
  const assumedBits = crc ? 0 : missingLowBits + missingFirstBits.length;
  const members = {
    template, lost: crc ? missingLowBits : assumedBits, demanded: startBits.length, holds: isConsistent,
    hasAssumedBit: assumedBits > 0 };
  const lastBitValues = [...Array(crc ? 1 : 1 << missingLowBits).keys()].map(BigInt);
  const text = fillTemplate(template, missingFirstBits);
  const hypotheses = lastBitValues.map((lastBits) => (
    createFrameHypothesis(placedLayout, crc, kind, text, frameNumber | lastBits, members)));
  const { idle, active } = TABLE.likely;
  const mostlyZeroBits = [...front].flatMap(
    (mark, index) => (mark === "~" ? [bits(frontAndFramePart, highestBit - index, 1)] : []));
  const frontLikelihood = mostlyZeroBits.reduce((product, bit) => product * (bit ? active : idle), 1);
  return hypotheses.map(
    (hypothesis) => ({ ...hypothesis, likelihood: hypothesis.likelihood * frontLikelihood }));
}

/** Try the frame in a recording with these parts. The bits of the parts in ``proofParts`` have one possible value. */
function tryRecording(placedLayout, crc, receivedText, [kind, text, pattern, proofParts]) {
  const groups = matchRecording(pattern, placedLayout, receivedText)?.groups;
  if (!groups) return [];
  const { frame: frameText, again: repeatedText = "" } = groups;
  const otherBitsRequired = proofParts.reduce((sum, name) => sum + (groups[name] ?? "").length, 0);
  const parts = Object.entries(groups).filter(([, partText]) => partText);
  return [createFrameHypothesis(placedLayout, crc, kind, text, BigInt(`0b${frameText}`), {
    demanded: otherBitsRequired, parts, holds: frameText.startsWith(repeatedText) })];
}

// -- frames of bytes

/** The most extra bytes that come from an echoed request. */
const MOST_ECHOED_BYTES = 4;

/** Try every single mistake that could have turned a valid frame into these bytes. */
function tryMistakesInBytes(decoded) {
  const { at: expectedLayout, data, label: orderCode, over: interface_, sender } = decoded;
  const wholeFrames = tryWholeFrames(decoded);
  const layouts = orderCode ? interface_.frames : [];
  // Where the manual is ambiguous, the first answer decides, as on the command line.
  const firstAnswers = Object.fromEntries(
    (orderCode?.family.alternatives ?? []).map((alternative) => [alternative.name, alternative.answers[0][0]]));
  const hypotheses = layouts.filter((layout) => layout.order && layout.sender === sender).flatMap((layout) => {
    const placedLayout = placedFor(orderCode, layout, {}, firstAnswers);
    const crc = placedLayout.crc ? placedLayout.family.crcs[placedLayout.crc] : null;
    if (crc && crc.width !== 8) return [];
    const isExpected = expectedLayout?.layout === layout && 8 * data.length === placedLayout.bits;
    return [...(crc && isExpected ? tryOtherByteCrcs(placedLayout, crc, data) : []),
      ...tryMovedBytes(placedLayout, crc, data)];
  });
  // Whole frames already explain extra bytes around the same frame.
  const isRepeated = (hypothesis) => ["bytes_in_front", "bytes_behind"].includes(hypothesis.kind)
    && wholeFrames.some(
      ({ at: placedLayout, number }) => number === hypothesis.number && placedLayout.layout === hypothesis.at.layout);
  return [...wholeFrames, ...hypotheses.map(
    (hypothesis) => ({ ...hypothesis, isRepeated: isRepeated(hypothesis) }))];
}

/** Join bytes to a number, the first byte highest. */
const joinBytes = (bytes) => numberOf("big", bytes);
/** Return the hypothesis with the last byte as the CRC over the bytes before it. */
const withCrcOverBytes = (hypothesis, bytes) => (
  { ...hypothesis, data: joinBytes(bytes.slice(0, -1)), received: BigInt(bytes.at(-1)), isOfBytes: true });

/** Try the frame as sent with another CRC. */
function tryOtherByteCrcs(placedLayout, crc, data) {
  const asSent = withCrcOverBytes(
    createHypothesisAsSent(placedLayout, crc, numberOf(placedLayout.layout.order, data)), data);
  const text = TABLE.texts.first_byte_left_out;
  return [
    ...(crc.byte_others ?? []).map(([kind, crcText, otherCrc]) => (
      { ...asSent, kind, text: crcText, template: crcText, crc: otherCrc })),
    {
      ...asSent, kind: "first_byte_left_out", text, template: text,
      data: joinBytes(data.slice(1, -1)), size: asSent.size - 8 },
  ];
}

/** The bytes do not begin and end with the frame, or are inverted. */
function tryMovedBytes(placedLayout, crc, data) {
  const { texts } = TABLE;
  const byteCount = placedLayout.bits / 8;
  const assumeFrame = (kind, text, bytes, template = text) => {
    const hypothesis = createFrameHypothesis(
      placedLayout, crc, kind, text, numberOf(placedLayout.layout.order, bytes), { template });
    return crc ? withCrcOverBytes(hypothesis, bytes) : hypothesis;
  };
  const extraBytes = data.length - byteCount;
  const hypotheses = [];
  if (extraBytes > 0 && extraBytes <= MOST_ECHOED_BYTES) {
    const extraText = extraBytes > 1 ? fillTemplate(texts.extra_bytes, extraBytes) : texts.extra_byte;
    hypotheses.push(assumeFrame("bytes_in_front", fillTemplate(texts.before, extraText), data.slice(extraBytes)),
      assumeFrame("bytes_behind", fillTemplate(texts.after, extraText), data.slice(0, byteCount)));
  }
  if (extraBytes === 0 || extraBytes === -1) {
    for (const byte of findPossibleFirstBytes(placedLayout)) {
      const [text, template] = [byte.toString(16).toUpperCase().padStart(2, "0"), "{0}"]
        .map((byteText) => fillTemplate(texts.byte_missing, byteText))
        .map((missingText) => (extraBytes ? missingText : fillTemplate(texts.and_follows, missingText)));
      hypotheses.push(assumeFrame("first_byte_lost", text, [byte, ...data.slice(0, byteCount - 1)], template));
    }
  }
  if (extraBytes === 0) hypotheses.push(
    assumeFrame("all_inverted", texts.bytes_inverted, data.map((byte) => byte ^ 0xFF)));
  return hypotheses;
}

/** The possible first bytes of a frame, if that byte only has the selector, constants, parity and usual values. */
function findPossibleFirstBytes(placedLayout) {
  const { order, selector, selects = [], usual = [] } = placedLayout.layout;
  const firstByteMask = numberOf(order, [0xFF, ...Array(placedLayout.bits / 8 - 1).fill(0)]);
  const fieldsInFirstByte = placedLayout.fields.filter(
    ({ low, width }) => bits(firstByteMask >> BigInt(low), 0, width));
  const usualValueOf = ({ name }) => usual.find((values) => values[0] === name && values.length === 2)?.[1];
  const otherFields = fieldsInFirstByte.filter(
    (placedField) => placedField.name !== selector && !("parity" in placedField.field));
  if (!otherFields.every((placedField) => (
    "fixed" in placedField.field || usualValueOf(placedField) !== undefined))) return [];
  const withField = (number, { low }, content) => number | (big(content) << BigInt(low));
  const withoutSelector = otherFields.reduce((number, placedField) => (
    withField(number, placedField, placedField.field.fixed ?? usualValueOf(placedField))), 0n);
  const selectorFields = fieldsInFirstByte.filter((placedField) => placedField.name === selector);
  return (selectorFields.length ? selects : [0]).map((selectorValue) => {
    let number = selectorFields.reduce(
      (sum, placedField) => withField(sum, placedField, selectorValue), withoutSelector);
    for (const parityField of fieldsInFirstByte.filter(({ field }) => "parity" in field)) {
      const { of: coveredPlaces, check } = placedLayout.checks.find(
        (placedCheck) => placedCheck.of && placedCheck.check.field === parityField.name);
      number = withField(number, parityField, parityOf(number, coveredPlaces, check));
    }
    return bytesOf(order, number, placedLayout.bits / 8)[0];
  });
}

/** Try the bytes as whole frames of RS-485: an echo of the request, a reply after it, or several replies. */
function tryWholeFrames({ data, label: orderCode, over: interface_, sender }) {
  const { most: mostBytes, least: leastEvidence, echo: echoText, frames: framesText } = TABLE.exchanges;
  if (!orderCode || data.length > mostBytes || interface_.name !== "rs485") return [];
  if (sender !== "encoder") return [];
  const candidates = interface_.frames.filter((layout) => layout.order).map((layout) => placedFor(orderCode, layout))
    .map((placedLayout) => ({ one: placedLayout, size: placedLayout.bits / 8 }));
  const fewestFramesFrom = new Map([[data.length, []]]);
  const isRequest = ({ one: placedLayout }) => placedLayout.layout.sender === "master";
  for (let firstByte = data.length - 1; firstByte >= 0; firstByte -= 1) {
    // A request is in front of its reply, even if both have the same form.
    const likely = candidates.filter((candidate) => isRequest(candidate) === (firstByte === 0));
    for (const { one: placedLayout, size: byteCount } of [
      ...likely, ...candidates.filter((candidate) => !likely.includes(candidate))]) {
      const followingFrames = fewestFramesFrom.get(firstByte + byteCount);
      if (!followingFrames || fewestFramesFrom.get(firstByte)?.length <= followingFrames.length + 1) continue;
      const bytes = data.slice(firstByte, firstByte + byteCount);
      const evidence = countExpectedBits(placedLayout, numberOf(placedLayout.layout.order, bytes));
      if (evidence && !decodeBytes(placedLayout, bytes).problems.length) fewestFramesFrom.set(
        firstByte, [{ one: placedLayout, bytes, evidence }, ...followingFrames]);
    }
  }
  const frames = fewestFramesFrom.get(0) ?? [];
  const replyCount = frames.filter((frame) => !isRequest(frame)).length;
  if (!frames.length || (frames.length === 1 && replyCount)) return [];
  const totalEvidence = frames.reduce((sum, frame) => sum + frame.evidence, 0);
  if (totalEvidence < leastEvidence) return [];
  const kindWithOneReply = isRequest(frames[0]) ? "bytes_in_front" : "bytes_behind";
  const kind = ["echo", kindWithOneReply][replyCount] ?? "several_frames";
  const parts = frames.map((frame) => [
    `${isRequest(frame) ? "request" : "reply"} ${frame.one.name}`, shownBytes(frame.bytes)]);
  const roles = parts.map(([title]) => title.split(" ")[0]);
  const [text, template] = kind === "echo"
    ? [` ${frames[0].one.name}`, ""].map((requestName) => fillTemplate(echoText, requestName))
    : [parts.map(([title]) => title), roles].map((names) => fillTemplate(framesText, names.join(", then ")));
  const lastFrame = frames[frames.length - 1];
  const isCertainReply = !isRequest(lastFrame) && !lastFrame.one.layout.asks?.length;
  return [createHypothesis({
    kind, text, template, at: lastFrame.one, parts, demanded: totalEvidence,
    data: joinBytes(data), size: 8 * data.length,
    number: isCertainReply ? numberOf(lastFrame.one.layout.order, lastFrame.bytes) : undefined,
  })];
}

/** Count the bits in a valid frame that have the value to expect: CRC, constants, and fields with a usual value. */
function countExpectedBits(placedLayout, number) {
  const usualBits = (placedLayout.layout.usual ?? []).reduce((sum, [name, ...usualValues]) => {
    const placedField = placedLayout.fields.find((candidate) => candidate.name === name);
    const isUsual = placedField && usualValues.some(
      (usualValue) => big(usualValue) === bits(number, placedField.low, placedField.width));
    return sum + (isUsual ? placedField.width - bitLength(BigInt(usualValues.length - 1)) : 0);
  }, 0);
  return countConstantBits(placedLayout) + usualBits
    + (placedLayout.crc ? placedLayout.family.crcs[placedLayout.crc].width : 0);
}

/** Find the request of SPI that a word from the encoder equals, with the most expected bits, or undefined. */
function findEchoedRequest(placedLayout, number) {
  const interface_ = interfaceOf(placedLayout);
  if (interface_?.name !== "spi" || placedLayout.layout.sender !== "encoder"
    || number >> BigInt(placedLayout.bits)) return undefined;
  // Bits that a reply has too are not evidence of an echo, such as the command on a shared line.
  const isRepeated = ({ field }) => "fixed" in field || "unused" in field;
  const repeatedBits = placedLayout.fields.filter(isRepeated).reduce((sum, { width }) => sum + width, 0);
  const hasDocumentedBits = (request) => request.fields.every((placedField) => !("unused" in placedField.field)
    || bits(number, placedField.low, placedField.width)
      === (big(placedField.field.unused) & ones(placedField.width)));
  const requests = interface_.frames.filter((layout) => layout.sender === "master" && !layout.order)
    .map((layout) => placeLayout(placedLayout.family, layout, placedLayout.parameters))
    .filter((request) => request.bits === placedLayout.bits && !decode(request, number).problems.length
      && hasDocumentedBits(request))
    .map((request) => ({
      name: request.name, size: request.bits, evidence: countExpectedBits(request, number) - repeatedBits }))
    .filter(({ evidence }) => evidence >= TABLE.exchanges.least_in_word);
  return requests.sort((request, otherRequest) => otherRequest.evidence - request.evidence)[0];
}

/** Try a word of SPI as the request that the master sent. */
function tryEcho(placedLayout, number) {
  const request = findEchoedRequest(placedLayout, number);
  if (!request) return [];
  const text = fillTemplate(TABLE.exchanges.word_echo, ` ${request.name}`);
  const template = fillTemplate(TABLE.exchanges.word_echo, "");
  return [createHypothesis({
    kind: "echo", text, template, data: number, size: request.size, demanded: request.evidence })];
}

/** Return the name of the request that a valid word also is, or "". */
function ownRequest({ at: placedLayout, number, problems }) {
  if (!placedLayout || placedLayout.layout.order || placedLayout.layout.sender !== "encoder"
    || problems.length) return "";
  return findEchoedRequest(placedLayout, number)?.name ?? "";
}

/** Return the numbers in a frame, each with its name in front. */
function numbersRead(placedLayout, number) {
  // Bytes can be a frame of any layout, and no choice is made where the manual leaves their reading open.
  const openParameters = placedLayout.layout.order ? (placedLayout.family.alternatives ?? []).flatMap(
    (alternative) => Object.keys(alternative.answers[0][2])) : [];
  const dependsOnAnswer = ({ low }) => Array.isArray(low) && low.slice(1).some((term) => term.slice(1)
    .some((parameter) => openParameters.includes(parameter.replace("^", ""))));
  const isNumber = ({ field }) => isGiven({ field }) && !dependsOnAnswer(field)
    && (field.kind === undefined || field.kind === "signed");
  const names = placedLayout.fields.filter(isNumber).map((placedField) => placedField.name);
  return decode(placedLayout, number).fields.filter((field) => names.includes(field.name))
    .map((field) => [field.name, field.value]);
}

/** The name of the position, which an encoder in one line has even if it does not state its counts. */
const positionNameOf = (measure) => measure?.of ?? "position";

/** Find the frames in a word of SSI with more typed bits than the frame, if its leading zeros were received. */
function findRecordedFrames(placedLayout, typedFrame) {
  const interface_ = interfaceOf(placedLayout);
  if (interface_?.name !== "ssi" || !typedFrame || typedFrame.exact
    || typedFrame.written <= placedLayout.bits) return [];
  const receivedText = typedFrame.number.toString(2).padStart(typedFrame.written, "0");
  const hypotheses = TABLE.lines[interface_.line].recordings
    .flatMap((recording) => tryRecording(placedLayout, null, receivedText, recording))
    .filter(fitsFrame);
  const numbers = [typedFrame.number, ...hypotheses.map((hypothesis) => hypothesis.number)];
  return hypotheses.filter((hypothesis, index) => numbers.indexOf(hypothesis.number) === index + 1)
    .map((hypothesis) => [`if ${hypothesis.text}`, hypothesis.number]);
}

/** Other readings of a position that nothing in the frame can contradict. They do not explain an error. */
function otherPositions({ at: placedLayout, number, problems, crc, fields, given: typedFrame }, measure) {
  const isWordOfEncoder = placedLayout && !placedLayout.layout.order && placedLayout.layout.sender === "encoder";
  const name = positionNameOf(measure);
  const position = fields.find((field) => field.name === name);
  if (!isWordOfEncoder || problems.length || crc || typeof position?.value !== "bigint") return [];
  const parts = position.high < 0 ? placedLayout.joins.find((join) => join.name === name).parts.map(({ item }) => item)
    .filter(Boolean) : [position];
  const low = Math.min(...parts.map((partField) => partField.low));
  const width = parts.reduce((sum, partField) => sum + (partField.width ?? partField.high - partField.low + 1), 0);
  const sentPosition = bits(number, low, width);
  const otherBits = number ^ (sentPosition << BigInt(low));
  const fromGray = (frameNumber, { low: partLow, width: partWidth, high }) => {
    const partBits = bits(frameNumber, partLow, partWidth ?? high - partLow + 1);
    return frameNumber ^ ((partBits ^ plainOf(partBits)) << BigInt(partLow));
  };
  const withLastBit0 = (number << ONE) & ones(placedLayout.bits);
  const frameNumbers = [
    [withLastBit0, withLastBit0 | ONE].find((candidate) => hasRightConstants(placedLayout, candidate)) ?? withLastBit0,
    number >> ONE,
    placedLayout.gray ? null : otherBits | (plainOf(sentPosition) << BigInt(low)),
    placedLayout.gray || parts.length < 2 ? null : parts.reduce(fromGray, number),
    placedLayout.gray ? toGray(placedLayout, number) : null,
    placedLayout.bits % 8 ? null : numberOf("big", bytesOf("little", number, placedLayout.bits / 8)),
  ];
  const readings = [
    ...frameNumbers.map((frameNumber, index) => [TABLE.doubts[index], frameNumber]),
    ...findRecordedFrames(placedLayout, typedFrame)];
  return readings.flatMap(([text, frameNumber]) => {
    const otherPosition = frameNumber === null ? position
      : decode(placedLayout, frameNumber).fields.find((field) => field.name === name);
    return otherPosition.value === position.value ? [] : [[text, otherPosition.value]];
  });
}

/** Return the placed checks of bits that must have one of few values in every frame, such as constants and parity. */
const constantChecksOf = (placedLayout) => placedLayout.checks.filter((placedCheck) => placedCheck.check.always);

/** Return the number of bits in a frame that can have only one value. */
function countConstantBits(placedLayout) {
  const freeBitsOf = (check) => bitLength(BigInt((check.values?.length ?? 1) - 1));
  return constantChecksOf(placedLayout).reduce((sum, { check, width }) => sum + width - freeBitsOf(check), 0);
}

/** Return whether the constants, the parity and the selector of a frame are right. */
const hasRightConstants = (placedLayout, number) => (
  constantChecksOf(placedLayout).every((placedCheck) => !problemOf(placedCheck, number, number).length));
