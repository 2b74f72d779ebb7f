// License 0BSD: use, modify and distribute this file without any condition.
// The mistakes in the table that would explain a wrong frame, with the same order as on the command line.

/** Return {receivedNumber, bitCount}: what was received as a number, first byte or bit highest, and its bits. */
function measureReceived({ placedLayout, typedFrame, number, receivedBytes }) {
  if (receivedBytes) return { receivedNumber: joinBytes(receivedBytes), bitCount: 8 * receivedBytes.length };
  const bitCount = typedFrame?.exact ? typedFrame.bits : Math.max(placedLayout?.bits ?? 0, typedFrame?.bits ?? 0);
  return { receivedNumber: typedFrame?.number ?? number, bitCount };
}

/** Return whether a frame with equal bits is valid by its CRC or, as the length alone proves little, its constants. */
function isValidWithEqualBits(placedLayout, problems, level) {
  if (!placedLayout) return false;
  if (placedLayout.crc) return !problems.length;
  return hasRightConstants(placedLayout, level ? ones(placedLayout.bits) : 0n);
}

/** Return the text about a dead line, or "" if the line changes. */
function deadLine(decoded) {
  const { placedLayout, problems, interface: interface_ } = decoded;
  const { texts } = TABLE;
  const isRegister = placedLayout?.layout.length !== undefined;
  if (isRegister) return "";
  const { receivedNumber, bitCount } = measureReceived(decoded);
  const hasEqualBits = receivedNumber === 0n || receivedNumber === ones(bitCount);
  if (bitCount < TABLE.likely.equal_bits || !hasEqualBits) return hasZeroReply(decoded) ? texts.zero_reply : "";
  const level = receivedNumber ? 1 : 0;
  if (isValidWithEqualBits(placedLayout, problems, level)) {
    return fillTemplate(texts.line_may_be_stuck, level, placedLayout.crc ? texts.crc_is_correct : texts.has_no_crc);
  }
  const lineFault = level ? "a broken wire" : "a short circuit";
  const otherCause = interface_?.name === "rs485" ? "wires A and B" : "the clock";
  return fillTemplate(texts.line_stuck, level, lineFault, otherCause);
}

/** Return whether an invalid SPI word consists of a right command with a constant, and of at least 12 zeros. */
function hasZeroReply({ placedLayout, typedFrame, problems, interface: interface_ }) {
  const isInvalidWord = interface_?.name === "spi" && placedLayout && typedFrame
    && problems.some(({ fault }) => fault === "crc" || fault === "length");
  if (!isInvalidWord || !mayHaveBits(typedFrame, placedLayout.bits)) return false;
  const { command, remainingBits, assumedBits } = findCommand(placedLayout);
  return assumedBits > 0 && remainingBits >= TABLE.likely.equal_bits && typedFrame.number === command;
}

/** Return the bits that make the frame valid if one of them is inverted: the usual cause if only some frames fail. */
function findDisturbedBits({ placedLayout, number, problems, receivedBytes }) {
  if (!placedLayout || problems[0]?.fault === "length") return [];
  if (!placedLayout.crc) return findDisturbedConstants(placedLayout, number, receivedBytes);
  if (!problems.some((problem) => problem.fault === "crc")) return [];
  const { low, width } = findCrcField(placedLayout);
  const { crc } = placedLayout;
  const isValid = (frameNumber) => computeCrc(crc, placedLayout, frameNumber) === extractBits(frameNumber, low, width)
    && hasRightConstants(placedLayout, frameNumber);
  return listNumbersBelow(placedLayout.bits).filter((bit) => isValid(number ^ (ONE << BigInt(bit))));
}

/** Return the bits that make the constants and the parity of a frame of bits right if one of them is inverted. */
function findDisturbedConstants(placedLayout, number, receivedBytes) {
  if (receivedBytes || hasRightConstants(placedLayout, number)) return [];
  return listNumbersBelow(placedLayout.bits).filter(
    (bit) => hasRightConstants(placedLayout, number ^ (ONE << BigInt(bit))));
}

/** Return the numbers from 0 to ``count`` - 1. */
const listNumbersBelow = (count) => [...Array(count).keys()];

/** Return the mistakes that explain the frame, most likely first, each with its random frames per match. */
const explained = (decoded) => findExplanations(decoded).merged;

/**
 * Return the explanations of a frame twice: ``merged`` contains one explanation for each resulting frame, ``all``
 * contains every explanation. ``isWithPairs`` also tries two mistakes if a single mistake matches.
 */
function findExplanations(decoded, isWithPairs = false) {
  const { placedLayout, typedFrame, receivedBytes, problems } = decoded;
  const noExplanations = { merged: [], all: [] };
  if (!problems.length || deadLine(decoded)) return noExplanations;
  const hasExplainableFault = problems.some(({ fault }) => ["crc", "length", "constant"].includes(fault));
  if (receivedBytes) {
    const isExplainable = !placedLayout || hasExplainableFault;
    return isExplainable ? explainBytes(decoded, isWithPairs) : noExplanations;
  }
  const isExplainable = placedLayout && typedFrame && hasExplainableFault;
  return isExplainable ? explainBits(decoded, isWithPairs) : noExplanations;
}

/** Return the explanations of a frame of bytes, {merged, all}. */
function explainBytes(decoded, isWithPairs) {
  const hypotheses = tryMistakesInBytes(decoded);
  return canCrcContradict(decoded) ? explainWithCrc(hypotheses, [], isWithPairs) : explainWithoutCrc(hypotheses);
}

/** Return the explanations of a frame of bits, {merged, all}. */
function explainBits({ placedLayout, typedFrame, problems }, isWithPairs) {
  const { crc } = placedLayout;
  if (!crc) {
    return explainWithoutCrc([
      ...tryMovedFrames(placedLayout, null, typedFrame), ...tryRearrangedFrames(placedLayout, null, typedFrame),
      ...tryOtherOrderCodes(placedLayout, typedFrame)]);
  }
  const hasOtherLength = typedFrame.bits > placedLayout.bits
    || (typedFrame.exact && typedFrame.bits !== placedLayout.bits);
  // A frame of this length is wrong as sent, and so are the hypotheses that match the same frames.
  const refuted = hasOtherLength ? [] : [createHypothesisAsSent(placedLayout, crc, typedFrame.number)];
  if (problems.some(({ fault }) => fault === "crc" || fault === "length")) {
    return explainWithCrc(tryMistakesInBits(placedLayout, crc, typedFrame), refuted, isWithPairs);
  }
  // Only constants are wrong, so the frame has other bits around it or another order.
  const fittingHypotheses = [
    ...tryRearrangedFrames(placedLayout, crc, typedFrame), ...tryMovedFrames(placedLayout, crc, typedFrame),
  ].filter(fitsFrame);
  const significant = selectSignificant(fittingHypotheses, refuted);
  return significant.length ? explainWithCrc(significant, [], isWithPairs) : { merged: [], all: [] };
}

/** Return whether a CRC can contradict the frame: its own one or, for bytes, that of any frame from the sender. */
const canCrcContradict = ({ placedLayout, receivedBytes, interface: interface_, sender }) => (
  receivedBytes ? layoutsOf(interface_, sender).some((layout) => layout.order && layout.crc)
    : Boolean(placedLayout?.crc));

/** Return the part that is missing from a recording, or the bytes that are missing from a shorter text, or "". */
function missingPart(decoded) {
  const { placedLayout, typedFrame, receivedBytes, problems } = decoded;
  if (!placedLayout || !(typedFrame || receivedBytes) || deadLine(decoded)) return "";
  if (receivedBytes) return explained(decoded).length ? "" : describeMissingBytes(placedLayout, 8 * receivedBytes.length);
  if (hasMissingDigits(decoded) && !explained(decoded).length) {
    return fillTemplate(TABLE.texts.read_as_zeros, describeMissingBytes(placedLayout, typedFrame.written));
  }
  const hasWrongLength = problems.some((problem) => problem.fault === "length");
  if (!hasWrongLength || mayHaveBits(typedFrame, placedLayout.bits)) return "";
  const { crc } = placedLayout;
  const isSignificant = (hypothesis) => !crc || (isSignificantWithCrc(hypothesis) && !isIdleLine(hypothesis));
  const isFoundByRule = (hypothesis) => (
    hypothesis.kind !== TABLE.inside[0] && fitsFrame(hypothesis) && isSignificant(hypothesis));
  if (tryMovedFrames(placedLayout, crc, typedFrame).some(isFoundByRule)) return "";
  const { padded, isBytes, written } = typedFrame;
  const missingText = findMissingPart(placedLayout, writeReceivedBits(placedLayout, typedFrame))
    || (isBytes ? describeMissingBytes(placedLayout, written) : "");
  return padded && missingText ? fillTemplate(TABLE.texts.zeros_left_out, missingText, padded) : missingText;
}

/** Return whether whole bytes are missing from the digits of a frame with a wrong CRC, so that they were read as 0. */
const hasMissingDigits = ({ placedLayout, typedFrame, problems }) => !typedFrame.exact && typedFrame.written > 0
  && countBytes(typedFrame.written) < countBytes(placedLayout.bits)
  && problems.some(({ fault }) => fault === "crc");

/** Return the number of bytes that bits fill, the last one at least in part. */
const countBytes = (bitCount) => Math.ceil(bitCount / 8);

/** Return how many bytes of the frame are missing, or "". */
function describeMissingBytes(placedLayout, receivedBits) {
  const [receivedCount, frameCount] = [countBytes(receivedBits), countBytes(placedLayout.bits)];
  if (receivedCount >= frameCount) return "";
  const missingText = countWithNoun(frameCount - receivedCount, "byte");
  return fillTemplate(TABLE.texts.bytes_missing, receivedCount, frameCount, missingText);
}

/** Return the part that is missing from these received bits, according to the patterns of the line. */
function findMissingPart(placedLayout, receivedText) {
  for (const [template, pattern] of lineRulesOf(placedLayout)?.incomplete ?? []) {
    const match = matchRecording(pattern, placedLayout, receivedText);
    const bitCount = match?.groups?.frame?.length ?? 0;
    if (match && bitCount < placedLayout.bits) {
      return fillTemplate(template, bitCount, placedLayout.bits, placedLayout.bits - bitCount);
    }
  }
  return "";
}

/** Return whether other frames with the same mistake would decide between these explanations. */
const anotherHelps = (explanations) => explanations.every((explanation) => explanation.kind !== "echo")
  && (explanations.length > 1 || (explanations.length === 1 && explanations[0].oneIn < TABLE.likely.certain));

/**
 * Return the mistakes in several frames {mistakes, failedCount, isOfAll}, most likely first, as the command does. With
 * ``isOfAll``, they explain all frames, valid ones too, and otherwise the most of the ``failedCount`` frames that fail.
 */
function judgeFrames(decodedFrames) {
  const frames = decodedFrames.filter(({ channels }) => !channels);
  const failedFrames = frames.filter(isFailedFrame).slice(-TABLE.likely.frames);
  const mistakesInAll = judgedWithValid(frames);
  const mistakes = mistakesInAll.length || failedFrames.length < 2 ? mistakesInAll : judgedTogether(failedFrames);
  return { mistakes, failedCount: failedFrames.length, isOfAll: mistakesInAll.length > 0 };
}

/** Return whether a frame has an error that can be explained, and is not a valid frame of another kind. */
function isFailedFrame(decoded) {
  const { problems, placedLayout, receivedBytes, isOfOtherKind } = decoded;
  if (!problems.length || isOfOtherKind) return false;
  const faults = receivedBytes ? ["crc", "length", "constant"] : ["crc", "length"];
  const hasFault = (receivedBytes && !placedLayout) || problems.some(({ fault }) => faults.includes(fault));
  const hasHypotheses = !receivedBytes || tryMistakesInBytes(decoded).length > 0;
  if (canCrcContradict(decoded) && hasFault && hasHypotheses) return true;
  return listMistakes(decoded).length > 0 || missingPart(decoded) !== ""
    || (!placedLayout?.crc && findDisturbedBits(decoded).length > 0);
}

/** Return all explanations of a frame, of which a dead line is one. ``isWithPairs`` also tries two mistakes. */
function listMistakes(decoded, isWithPairs = false) {
  if (decoded.isOfOtherKind) return [];
  const deadLineText = deadLine(decoded);
  if (!deadLineText) return findExplanations(decoded, isWithPairs).all;
  const { bitCount } = measureReceived(decoded);
  const equalBits = hasZeroReply(decoded) ? findCommand(decoded.placedLayout).remainingBits : bitCount - 1;
  const oneIn = ONE << BigInt(Math.min(equalBits, MOST_EQUAL_BITS));
  const frequency = TABLE.likely.kinds.line_stuck;
  return [{
    kind: "line_stuck", text: deadLineText, template: deadLineText, isTwice: false, oneIn, frequency,
    score: frequency * Number(oneIn) }];
}

/** More equal bits do not make a dead line more certain. */
const MOST_EQUAL_BITS = 62;

/**
 * Return the mistakes that explain most of several wrong frames, most likely first. Pairs of mistakes are tried if no
 * single mistake explains all of them, or if the likeliest hides a shift.
 */
function judgedTogether(failedFrames) {
  const singleMistakes = findCommonMistakes(failedFrames.map((decoded) => listMistakes(decoded)));
  const isExplained = singleMistakes[0]?.frames === failedFrames.length;
  if (isExplained && !singleMistakes[0].hidesShift) return singleMistakes;
  return findCommonMistakes(failedFrames.map((decoded) => listMistakes(decoded, true)));
}

/**
 * Return the mistakes that explain all frames, valid ones too, most likely first. There are none unless the only check
 * is a parity bit, which half of all shifted frames pass, and enough frames fail.
 */
function judgedWithValid(decodedFrames) {
  const frames = decodedFrames.slice(-TABLE.likely.frames);
  const failedCount = frames.filter(({ problems }) => problems.length).length;
  if (failedCount === frames.length || failedCount * TABLE.likely.least_failed < frames.length) return [];
  if (!frames.every(({ placedLayout, typedFrame }) => placedLayout && typedFrame && hasOnlyParity(placedLayout))) return [];
  const explanationLists = frames.map((decoded) => {
    const isValid = !decoded.problems.length && !deadLine(decoded);
    return isValid ? explainBits(decoded, false).all : listMistakes(decoded);
  });
  const mistakes = findCommonMistakes(explanationLists);
  return mistakes[0]?.frames === frames.length ? mistakes : [];
}

/** The logarithm of the likelihood. A mistake is made once, so its frequency counts once. */
function computeCommonScore(explanations) {
  const evidence = explanations.reduce((sum, { score, frequency }) => sum + Math.log2(score / frequency), 0);
  return Math.log2(explanations[0].frequency) + evidence;
}

/**
 * Return the mistakes that explain the most frames, most likely first, from a list of explanations for each frame.
 * Explanations of frames with the same kind and template are one mistake.
 */
function findCommonMistakes(explanationLists) {
  const explanationsByMistake = new Map();
  for (const explanations of explanationLists) {
    for (const [mistakeKey, explanation] of likeliestByMistake(explanations)) {
      const explanationsOfEarlier = explanationsByMistake.get(mistakeKey) ?? [];
      explanationsByMistake.set(mistakeKey, [...explanationsOfEarlier, explanation]);
    }
  }
  const explanationsOfMistakes = [...explanationsByMistake.values()];
  const mostFrames = Math.max(0, ...explanationsOfMistakes.map((explanations) => explanations.length));
  return explanationsOfMistakes.filter((explanations) => explanations.length === mostFrames)
    .map(mergeExplanations)
    .sort((mistake, otherMistake) => otherMistake.score - mistake.score);
}

/** Return the likeliest explanation of a frame by mistake, from its explanations in order of their likelihood. */
function likeliestByMistake(explanations) {
  // The first explanation of a mistake overwrites later explanations.
  return new Map([...explanations].reverse().map(
    (explanation) => [`${explanation.kind} ${explanation.template} ${explanation.isTwice}`, explanation]));
}

/** Merge the explanations of several frames by the same mistake: {text, frames, oneIn, score}. */
function mergeExplanations(explanations) {
  const texts = new Set(explanations.map((explanation) => explanation.text));
  const commonText = withoutDetails(explanations[0].template);
  return {
    text: texts.size === 1 ? explanations[0].text : commonText,
    frames: explanations.length,
    oneIn: explanations.reduce((product, explanation) => product * explanation.oneIn, ONE),
    score: computeCommonScore(explanations),
    hidesShift: hidesShift(explanations[0]),
  };
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
 * Create the hypothesis that a mistake was made, from the members that its kind needs. The CRC covers the
 * ``coveredBits`` bits of ``coveredData``, and ``receivedCrc`` has the first ``crcBitsReceived`` bits of the received
 * CRC. The mistake determines ``otherBitsRequired`` other bits, and ``isConsistent`` is true if they are right.
 * ``rightConstantBits`` counts the right constant bits, ``missingLowBits`` the last bits that were cut off, and
 * ``placeCount`` the places at which the frame was searched. ``relativeFrequency`` is how frequent the mistake is here,
 * relative to other mistakes of its kind.
 */
const createHypothesis = (members) => ({
  template: members.text, coveredData: 0n, coveredBits: 0, receivedCrc: 0n, crcBitsReceived: 0, otherBitsRequired: 0,
  isConsistent: true, rightConstantBits: 0, likelihood: 1, missingLowBits: 0, parts: [], placeCount: 1, relativeFrequency: 1,
  ...members,
});

/** Return whether a frame with the mistake has these bits: the bits that it determines, and the CRC. */
function fitsFrame({
  crc, isConsistent, isOfBytes, coveredData, coveredBits, crcBitsReceived,
  receivedCrc,
}) {
  if (!isConsistent || !crc) return isConsistent;
  const computedCrc = isOfBytes ? crcOfBytes(crc, bytesOf("big", coveredData, coveredBits / 8))
    : crcOfBits(crc, coveredData, coveredBits);
  return computedCrc >> BigInt(crc.width - crcBitsReceived) === receivedCrc;
}

/** Return the number of random frames of which one matches the hypothesis by chance, at least 1. */
const countFramesPerMatch = ({ crcBitsReceived, otherBitsRequired, placeCount }) => {
  const framesPerMatch = ONE << BigInt(crcBitsReceived + otherBitsRequired);
  return framesPerMatch > BigInt(placeCount) ? framesPerMatch / BigInt(placeCount) : ONE;
};
/** Return the estimated frequency of a mistake. */
const frequencyOf = ({ kind, relativeFrequency }) => TABLE.likely.kinds[kind] * relativeFrequency;
/** Return the likelihood of a mistake that matches: its frequency times the improbability of the match by chance. */
const computeScore = (hypothesis) => {
  const { crcBitsReceived, otherBitsRequired, rightConstantBits, likelihood, placeCount } = hypothesis;
  const evidence = crcBitsReceived + Math.max(otherBitsRequired, rightConstantBits);
  return (frequencyOf(hypothesis) * likelihood * 2 ** evidence) / placeCount;
};

/** Return the key of a hypothesis. Hypotheses with the same key match the same frames. */
function matchKeyOf({
  crc, coveredData, coveredBits, receivedCrc, crcBitsReceived,
}) {
  const crcKey = crc && ["width", "poly", "init", "refin", "refout", "xorout"]
    .map((name) => `${toBigInt(crc[name])}`).join(" ");
  return `${crcKey} ${coveredData} ${crc && toBigInt(crc.init) ? coveredBits : 0} ${receivedCrc} ${crcBitsReceived}`;
}

/** Return whether a hypothesis has enough bits to contradict it, so that few random frames match. */
const isSignificantWithCrc = ({ crcBitsReceived, otherBitsRequired }) => (
  crcBitsReceived + otherBitsRequired >= TABLE.likely.bits);
/** Return whether all bits of the resulting frame are equal, as on an idle line. */
const isIdleLine = ({ placedLayout, number }) => Boolean(placedLayout) && placedLayout.bits >= TABLE.likely.equal_bits
  && (number === 0n || number === ones(placedLayout.bits));

/** The tries that do not match too many random frames, without those known to fail. */
function selectSignificant(hypotheses, refuted) {
  const refutedKeys = new Set(refuted.map(matchKeyOf));
  const isRefuted = (hypothesis) => refutedKeys.has(matchKeyOf(hypothesis));
  return hypotheses.filter(
    (hypothesis) => isSignificantWithCrc(hypothesis) && !isIdleLine(hypothesis) && !isRefuted(hypothesis));
}

/** Select the likeliest of the hypotheses that lead to the same frame. */
function selectDistinct(hypotheses) {
  const likeliestByKey = new Map();
  for (const hypothesis of hypotheses) {
    const resultKey = `${matchKeyOf(hypothesis)} ${describeResult(hypothesis)}`;
    const likeliest = likeliestByKey.get(resultKey);
    if (!likeliest || isLikelier(hypothesis, likeliest)) likeliestByKey.set(resultKey, hypothesis);
  }
  return [...likeliestByKey.values()];
}

/** Return the frame and the places of its fields as text, or the text of a mistake that leaves the frame as it is. */
function describeResult({ placedLayout, number, text }) {
  if (!placedLayout) return text;
  const fieldPlaces = placedLayout.fields.map(({ name, low }) => `${name} ${low}`);
  return [number, placedLayout.bits, ...fieldPlaces].join(" ");
}

/** Return whether a hypothesis is likelier than another: only it is consistent, or it has the higher score. */
function isLikelier(hypothesis, other) {
  if (hypothesis.isConsistent !== other.isConsistent) return hypothesis.isConsistent;
  return computeScore(hypothesis) > computeScore(other);
}

/** Return a hypothesis that fits as an explanation, with its chance and score. ``isTwice`` marks two mistakes. */
const toExplanation = (hypothesis, isTwice) => ({
  ...hypothesis, isTwice, oneIn: countFramesPerMatch(hypothesis), score: computeScore(hypothesis),
  frequency: frequencyOf(hypothesis) });
/** Sort the explanations in place, most likely first. */
const sortByScore = (explanations) => (
  explanations.sort((explanation, otherExplanation) => otherExplanation.score - explanation.score));

/** The explanations among tries with a CRC. Pairs are tried if no single mistake matches. */
function explainWithCrc(hypotheses, refuted, isWithPairs) {
  const significant = selectSignificant(hypotheses, refuted);
  const unrepeated = significant.filter((hypothesis) => !hypothesis.isRepeated);
  const distinct = selectDistinct(unrepeated);
  const merged = explainFitting(distinct, false);
  const all = explainFitting(significant, false);
  // A frame found at any bit is weak evidence.
  const isFoundInsideOnly = merged.every((explanation) => explanation.kind === TABLE.inside[0]);
  if (isWithPairs || isFoundInsideOnly) {
    const canBePaired = ({ crc, kind }) => (
      crc && !["crc_not_inverted", "other_message", TABLE.inside[0]].includes(kind));
    const pairs = selectSignificant(unrepeated.filter(canBePaired).map(pairWithInversion), refuted);
    // A pair that leads to the same frame as a single mistake is left out.
    const distinctPairs = selectDistinct([...distinct, ...pairs]).slice(distinct.length);
    merged.push(...explainFitting(distinctPairs, true));
    all.push(...explainFitting(pairs, true));
  }
  return { merged: sortByScore(merged), all: sortByScore(all) };
}

/** Return the hypotheses that fit the frame as explanations. ``isTwice`` marks pairs of mistakes. */
const explainFitting = (hypotheses, isTwice) => (
  hypotheses.filter(fitsFrame).map((hypothesis) => toExplanation(hypothesis, isTwice)));

/** Pair the mistake with the most common mistake, a CRC that is inverted or that should be. */
function pairWithInversion(hypothesis) {
  const textName = toBigInt(hypothesis.crc.xorout) ? "not_inverted_too" : "inverted_too";
  const template = fillTemplate(TABLE.texts[textName], hypothesis.template);
  const crc = { ...hypothesis.crc, xorout: toBigInt(hypothesis.crc.xorout) ^ ones(hypothesis.crc.width) };
  const relativeFrequency = hypothesis.relativeFrequency * TABLE.likely.with_second;
  return { ...hypothesis, crc, template, relativeFrequency, text: fillTemplate(TABLE.texts[textName], hypothesis.text) };
}

/** The readings of a frame without a CRC. Nothing proves one of them. */
function explainWithoutCrc(hypotheses) {
  const fitting = sortByScore(explainFitting(hypotheses, false));
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
  && !toBigInt(crc.init) && !toBigInt(crc.xorout);

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
  const [low, bitCount] = placeOfCoveredBits(placedLayout);
  return { coveredData: extractBits(number, low, bitCount), coveredBits: bitCount };
}

/** Create the hypothesis that the frame is as sent, to which the caller adds the mistake. */
function createHypothesisAsSent(placedLayout, crc, number) {
  return createHypothesis({
    crc, ...coveredBitsOf(placedLayout, number),
    receivedCrc: extractBits(number, 0, crc.width), crcBitsReceived: crc.width,
    rightConstantBits: hasRightConstants(placedLayout, number) ? countConstantBits(placedLayout) : 0,
    likelihood: computeLikelihood(placedLayout, number), text: "",
  });
}

/**
 * The frame was this number, whose last bits were not received.
 * These ``missingLowBits`` bits belong to the CRC, of which the others are compared. Without a CRC, they are assumed as in the
 * number, so they prove nothing.
 */
function createFrameHypothesis(
  placedLayout, crc, kind, text, frameNumber,
  { missingLowBits = 0, otherBitsRequired = 0, isConsistent = true, ...otherMembers } = {},
) {
  if (!crc) {
    return createHypothesis({
      kind, text, placedLayout, number: frameNumber, missingLowBits, coveredData: frameNumber,
      coveredBits: placedLayout.bits, likelihood: computeLikelihood(placedLayout, frameNumber),
      otherBitsRequired: otherBitsRequired + Math.max(countConstantBits(placedLayout) - missingLowBits, 0),
      isConsistent: isConsistent && hasRightConstants(placedLayout, frameNumber), ...otherMembers,
    });
  }
  return createHypothesis({
    kind, text, crc, placedLayout, number: frameNumber, missingLowBits,
    ...coveredBitsOf(placedLayout, frameNumber), likelihood: computeLikelihood(placedLayout, frameNumber),
    receivedCrc: extractBits(frameNumber, 0, crc.width) >> BigInt(missingLowBits),
    crcBitsReceived: crc.width - missingLowBits,
    otherBitsRequired: otherBitsRequired + countConstantBits(placedLayout),
    isConsistent: isConsistent && hasRightConstants(placedLayout, frameNumber), ...otherMembers,
  });
}

// Each function whose name begins with "try" returns the hypotheses of a mistake, or [] if it is impossible here.

// -- frames of bits

/** Return the possible lengths in bits of a typed frame, longest first: as typed, or the frame's length and 1 less. */
const possibleLengthsOf = (placedLayout, typedFrame) => (typedFrame.exact || typedFrame.bits > placedLayout.bits
  ? [typedFrame.bits] : [placedLayout.bits, placedLayout.bits - 1])
  .filter((length) => length >= typedFrame.bits);
/** Return whether a typed frame may have this number of bits: exactly those typed, or also more leading zeros. */
const mayHaveBits = (typedFrame, bitCount) => (
  typedFrame.exact ? typedFrame.bits === bitCount : typedFrame.bits <= bitCount);
/** Return whether a placed field is error or warning: a flag, or an unused bit that is 1. */
const isStatusField = ({ field, width }) => (
  isFlag(field) || ("unused" in field && Boolean(toBigInt(field.unused)) && width === 1));

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
    ...tryOtherPolynomials(placedLayout, crc, typedFrame), ...tryOtherOrderCodes(placedLayout, typedFrame)];
}

/** Try the frame as sent with another CRC. */
function tryOtherCrcs(placedLayout, crc, number) {
  const asSent = createHypothesisAsSent(placedLayout, crc, number);
  const withMistake = (kind, text, members) => ({ ...asSent, kind, text, template: text, ...members });
  const hypotheses = (crc.others ?? []).map(
    ([kind, text, parameters]) => withMistake(kind, text, { crc: parameters }));
  hypotheses.push(withMistake(
    "crc_reversed", TABLE.texts.crc_reversed, { receivedCrc: reverseBits(asSent.receivedCrc, crc.width) }));
  if (placedLayout.layout.crc_of) return hypotheses;
  const startBitRules = interfaceOf(placedLayout)?.name === "biss" ? TABLE.start_bits : [];
  const coverStartBits = ([startBits, text]) => withMistake("start_bits_in_crc", text, {
    coveredData: (BigInt(`0b${startBits}`) << BigInt(asSent.coveredBits)) | asSent.coveredData,
    coveredBits: asSent.coveredBits + startBits.length });
  return [
    ...hypotheses, ...tryOtherStatus(placedLayout, asSent, number, withMistake),
    ...tryOtherPositionCode(placedLayout, asSent, number, withMistake),
    ...startBitRules.map(coverStartBits)];
}

/** Return the bits of fields in a frame, set to 1. */
const maskOf = (placedFields) => (
  placedFields.reduce((mask, { low, width }) => mask | (ones(width) << BigInt(low)), 0n));

/** The CRC does not cover error and warning, or they were inverted. */
function tryOtherStatus(placedLayout, asSent, number, withMistake) {
  const statusFields = placedLayout.fields.filter(isStatusField);
  const statusMask = maskOf(statusFields);
  if (!statusMask) return [];
  const crcWidth = BigInt(asSent.crcBitsReceived);
  const remainingBits = listNumbersBelow(asSent.coveredBits).reverse()
    .filter((bit) => !extractBits(statusMask >> crcWidth, bit, 1));
  const remainingData = remainingBits.reduce((sum, bit) => (sum << ONE) | extractBits(asSent.coveredData, bit, 1), 0n);
  const leftOut = withMistake("status_left_out", TABLE.texts.status_left_out, {
    coveredData: remainingData, coveredBits: remainingBits.length });
  // Only bits that are 1 while they are inactive can be converted to active high.
  const hasActiveLow = statusFields.some(({ field }) => field.kind !== "flag");
  return hasActiveLow ? [leftOut, withMistake("status_turned", TABLE.texts.status_turned, {
    coveredData: (number ^ statusMask) >> crcWidth, likelihood: computeLikelihood(placedLayout, number ^ statusMask) })]
    : [leftOut];
}

/** Find the bits of the number that a master would convert from Gray code: their low bit and width. */
function findConvertedBits({ layout, fields, joins, family, parameters }) {
  if (layout.gray) {
    const evaluate = (expression) => Number(evaluateExpression(expression, parameters));
    return { low: evaluate(layout.gray.low ?? 0), width: evaluate(layout.gray.width) };
  }
  const joinedFields = joins[0]?.parts.map(({ placedField }) => placedField).filter(Boolean);
  if (joinedFields) {
    const width = joinedFields.reduce((sum, placedField) => sum + placedField.width, 0);
    return { low: joinedFields[0]?.low ?? 0, width };
  }
  const isNumber = ({ field }) => isEnteredByUser({ field }) && (field.kind === undefined || field.kind === "signed");
  return fields.filter(isNumber).reduce(
    (widest, placedField) => (placedField.width > widest.width ? placedField : widest), { low: 0, width: 0 });
}

/** Try a position in Gray code under a CRC that covers binary, or vice versa. */
function tryOtherPositionCode(placedLayout, asSent, number, withMistake) {
  const { low, width } = findConvertedBits(placedLayout);
  if (!width) return [];
  const position = extractBits(number, low, width);
  const otherBits = number ^ (position << BigInt(low));
  const coverConverted = (converted, text) => withMistake("other_code", text, {
    coveredData: (otherBits | (converted << BigInt(low))) >> BigInt(asSent.crcBitsReceived) });
  return [coverConverted(grayToBinary(position), TABLE.texts.covers_binary),
    coverConverted(position ^ (position >> ONE), TABLE.texts.covers_gray)];
}

/** Try frames whose bits are all inverted, or whose bits or bytes are in another order. */
function tryRearrangedFrames(placedLayout, crc, typedFrame) {
  const assumeFrame = (kind, frameNumber, members) => (
    createFrameHypothesis(placedLayout, crc, kind, TABLE.texts[kind], frameNumber, members));
  const hypotheses = [];
  if (possibleLengthsOf(placedLayout, typedFrame).includes(placedLayout.bits)) {
    const inverted = assumeFrame("all_inverted", typedFrame.number ^ ones(placedLayout.bits));
    const relativeFrequency = interfaceOf(placedLayout)?.name === "spi" ? TABLE.likely.without_pair : 1;
    hypotheses.push({ ...inverted, relativeFrequency },
      assumeFrame("bits_reversed", reverseBits(typedFrame.number, placedLayout.bits)));
    if (placedLayout.bits % 8 === 0) {
      const bytes = bytesOf("big", typedFrame.number, placedLayout.bits / 8);
      hypotheses.push(assumeFrame(
        "bits_reversed_in_bytes", numberOf("big", bytes.map((byte) => reverseBits(BigInt(byte), 8)))));
    }
  }
  const tryByteOrder = (kind, unitBits, reorder) => {
    const filledBits = Math.ceil(placedLayout.bits / unitBits) * unitBits;
    const isWholeBytes = typedFrame.bits % 8 === 0
      && (typedFrame.bits === placedLayout.bits || typedFrame.bits === filledBits);
    if (typedFrame.number >> BigInt(filledBits) || (typedFrame.exact && !isWholeBytes)) return;
    const filledFrame = numberOf("big", reorder(bytesOf("big", typedFrame.number, filledBits / 8)));
    const frameNumber = extractBits(filledFrame, 0, placedLayout.bits);
    hypotheses.push(assumeFrame(kind, frameNumber, {
      otherBitsRequired: filledBits - placedLayout.bits, isConsistent: frameNumber === filledFrame }));
  };
  tryByteOrder("bytes_reversed", 8, (bytes) => bytes.reverse());
  if (placedLayout.bits > 16) tryByteOrder(
    "words_swapped", 16, (bytes) => bytes.map((_, byteIndex) => bytes[byteIndex ^ 1]));
  return hypotheses;
}

/** Error and warning are missing: removed after the CRC was computed, or before. */
function tryRemovedStatus(placedLayout, crc, typedFrame) {
  const statusFields = placedLayout.fields.filter(isStatusField);
  const statusMask = maskOf(statusFields);
  const statusBits = countOnes(statusMask);
  const shortBits = placedLayout.bits - statusBits;
  if (!statusMask || statusMask >> BigInt(crc.width) !== ones(statusBits)
    || !mayHaveBits(typedFrame, shortBits)) return [];
  const idleStatus = maskOf(statusFields.filter(({ field }) => field.kind !== "flag"));
  const data = typedFrame.number >> BigInt(crc.width);
  const receivedCrc = extractBits(typedFrame.number, 0, crc.width);
  const frameNumber = (data << BigInt(crc.width + statusBits)) | idleStatus | receivedCrc;
  const asIdle = createFrameHypothesis(
    placedLayout, crc, "status_not_sent", TABLE.texts.removed_and_idle, frameNumber);
  if (!typedFrame.exact) return [asIdle];
  return [asIdle, createHypothesis({
    kind: "status_not_sent", text: TABLE.texts.removed, crc, coveredData: data, coveredBits: shortBits - crc.width,
    receivedCrc, crcBitsReceived: crc.width, likelihood: computeLikelihood(placedLayout, frameNumber),
    number: frameNumber, placedLayout })];
}

/** Try data of the right length before a CRC of another length: complete, truncated, or followed by zeros. */
function tryOtherPolynomials(placedLayout, crc, typedFrame) {
  const dataBits = placedLayout.bits - crc.width;
  return TABLE.polynomials.flatMap((polynomial) => {
    const withTopBit = toBigInt(polynomial);
    const width = bitLength(withTopBit) - 1;
    if (withTopBit === (toBigInt(crc.poly) | (ONE << BigInt(crc.width)))) return [];
    const onesIfSet = (number) => (toBigInt(number) ? ones(width) : 0n);
    const otherCrc = {
      ...crc, width, poly: withTopBit & ones(width), init: onesIfSet(crc.init), xorout: onesIfSet(crc.xorout) };
    const lengths = [...new Set([dataBits + width, placedLayout.bits])];
    return lengths
      .filter((length) => length === typedFrame.bits || (!typedFrame.exact && length > typedFrame.bits))
      .map((length) => tryPolynomialWithLength(placedLayout, crc, otherCrc, typedFrame.number, length, dataBits));
  });
}

/** Try another CRC after the first ``dataBits`` of the ``length`` bits of ``number``. */
function tryPolynomialWithLength(placedLayout, crc, otherCrc, number, length, dataBits) {
  const tailBits = length - dataBits;
  const [data, tail] = [number >> BigInt(tailBits), extractBits(number, 0, tailBits)];
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
    kind: "other_polynomial", text, crc: otherCrc, coveredData: data, coveredBits: dataBits,
    receivedCrc: tail >> BigInt(zeroCount),
    crcBitsReceived, otherBitsRequired: zeroCount + (hasFrameLength ? 0 : countConstantBits(placedLayout)),
    isConsistent: !extractBits(tail, 0, zeroCount) && (hasFrameLength || areConstantsRight),
    rightConstantBits: zeroCount + (areConstantsRight ? countConstantBits(placedLayout) : 0),
    likelihood: computeLikelihood(placedLayout, frameNumber),
  });
}

/** Compute the likelihood of the flags and reserved bits, relative to random bits. */
function computeLikelihood(placedLayout, number) {
  const { idle, active } = TABLE.likely;
  return placedLayout.fields.reduce((product, placedField) => {
    const isActive = isActiveOrDiffers(placedField, extractBits(number, placedField.low, placedField.width));
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

/** Return whether the typed bytes of an SPI word have more bits than the word, but fewer than a whole byte more. */
function isWordInBytes(placedLayout, typedFrame) {
  const extraBits = (typedFrame?.written ?? 0) - placedLayout.bits;
  return interfaceOf(placedLayout)?.name === "spi" && Boolean(typedFrame?.isBytes) && extraBits > 0 && extraBits < 8;
}

/** The frames with bits around them. A frame is searched at every bit only if no rule of the line finds it. */
function tryMovedFrames(placedLayout, crc, typedFrame) {
  const lineRules = lineRulesOf(placedLayout);
  if (!lineRules || !placedLayout.bits) return [];
  const writtenText = writeReceivedBits(placedLayout, typedFrame);
  // A word that does not fill its bytes can be at their beginning. The zeros in front of it are then received bits.
  const receivedText = isWordInBytes(placedLayout, typedFrame)
    ? writtenText.padStart(typedFrame.written, "0") : writtenText;
  const mayBeEcho = mayHaveBits(typedFrame, placedLayout.bits);
  const commandHypotheses = [
    ...(mayBeEcho ? tryEcho(placedLayout, typedFrame.number) : []),
    ...tryCommandBits(placedLayout, crc, typedFrame)];
  const offsetHypotheses = possibleLengthsOf(placedLayout, typedFrame).flatMap((length) => (
    lineRules.slips.flatMap((offset) => tryOffset(placedLayout, crc, typedFrame, length, offset))));
  const hypotheses = [
    ...commandHypotheses, ...offsetHypotheses,
    ...lineRules.recordings.flatMap((recording) => tryRecording(placedLayout, crc, receivedText, recording))];
  const isFoundByRule = hypotheses.slice(commandHypotheses.length).some(fitsFrame);
  return crc && !isFoundByRule ? [...hypotheses, ...tryFrameAtEveryBit(placedLayout, crc, receivedText)] : hypotheses;
}

/** Try the frame at each bit of ``receivedText``, which are the bits in the order received. */
function tryFrameAtEveryBit(placedLayout, crc, receivedText) {
  const [kind, template] = TABLE.inside;
  const placeCount = Math.max(receivedText.length - placedLayout.bits + 1, 0);
  return listNumbersBelow(placeCount).map((bitsBefore) => {
    const frameEnd = bitsBefore + placedLayout.bits;
    const frameText = receivedText.slice(bitsBefore, frameEnd);
    const allParts = [
      ["before", receivedText.slice(0, bitsBefore)], ["frame", frameText], ["behind", receivedText.slice(frameEnd)]];
    const parts = allParts.filter(([, partText]) => partText);
    const text = fillTemplate(template, bitsBefore);
    return createFrameHypothesis(
      placedLayout, crc, kind, text, BigInt(`0b${frameText}`), { template, parts, placeCount });
  });
}

/**
 * Return the constants of the bits that are sent during the command of SPI, the number of these bits, of the bits after
 * them, and of the constants. The numbers are 0 if the command does not consist of whole bytes.
 */
function findCommand(placedLayout) {
  const [coveredLow, coveredBits] = placedLayout.crc ? placeOfCoveredBits(placedLayout) : [0, placedLayout.bits];
  const isDuringCommand = (placedField) => "fixed" in placedField.field || placedField.low >= coveredLow + coveredBits;
  const fields = [...placedLayout.fields].sort((placedField, otherField) => otherField.low - placedField.low);
  const dataIndex = fields.findIndex((placedField) => !isDuringCommand(placedField));
  const commandFields = fields.slice(0, dataIndex < 0 ? fields.length : dataIndex);
  const remainingBits = commandFields.at(-1)?.low ?? placedLayout.bits;
  const commandBits = placedLayout.bits - remainingBits;
  if (!commandBits || commandBits % 8) return { command: 0n, commandBits: 0, remainingBits: 0, assumedBits: 0 };
  const constants = commandFields.filter(({ field }) => "fixed" in field);
  const command = constants.reduce(
    (sum, placedField) => sum | (toBigInt(placedField.field.fixed) << BigInt(placedField.low)), 0n);
  return { command, commandBits, remainingBits, assumedBits: constants.reduce((sum, { width }) => sum + width, 0) };
}

/**
 * The bits during the command of SPI are missing, idle because only MISO was recorded, or intact before shifted data. Missing
 * and idle bits are assumed to be those that the layout expects.
 */
function tryCommandBits(placedLayout, crc, typedFrame) {
  if (interfaceOf(placedLayout)?.name !== "spi") return [];
  const { command, commandBits, remainingBits, assumedBits } = findCommand(placedLayout);
  if (!commandBits) return [];
  const assumeCommand = (text, evidence) => ({
    ...createFrameHypothesis(placedLayout, crc, "command_left_out", text,
      command | extractBits(typedFrame.number, 0, remainingBits)),
    otherBitsRequired: countConstantBits(placedLayout) - assumedBits + evidence });
  if (mayHaveBits(typedFrame, remainingBits) && typedFrame.written === remainingBits) {
    return [assumeCommand(fillTemplate(TABLE.texts.command_left_out, commandBits), 0)];
  }
  if (!assumedBits || !remainingBits || !mayHaveBits(typedFrame, placedLayout.bits)) return [];
  const received = typedFrame.number >> BigInt(remainingBits);
  const isIdle = (typedFrame.exact || typedFrame.written > remainingBits)
    && received !== command >> BigInt(remainingBits) && (received === 0n || received === ones(commandBits));
  const idleText = fillTemplate(TABLE.texts.command_idle, commandBits, received & ONE);
  const offsets = lineRulesOf(placedLayout).slips.flatMap(
    (offset) => tryOffset(placedLayout, crc, typedFrame, placedLayout.bits, offset, commandBits))
    // The intact command does not prove that the data are shifted.
    .map((hypothesis) => ({ ...hypothesis, rightConstantBits: hypothesis.otherBitsRequired,
      otherBitsRequired: Math.max(hypothesis.otherBitsRequired - assumedBits, 0) }));
  // Idle bits can have two values.
  return [...(isIdle ? [assumeCommand(idleText, commandBits - 1)] : []), ...offsets];
}

/**
 * A text that does not begin and end with the frame: extra bits before or after it, or missing bits.
 * ``front`` and ``behind`` have a mark for each extra bit: 1 for a start bit, ~ for mostly 0, and ? for any bit. The first
 * ``commandBits`` bits are not affected.
 */
function tryOffset(
  placedLayout, crc, typedFrame, length, [kind, offsetText, front, missingFirstBits, missingLowBits, behind],
  commandBits = 0,
) {
  const bitsAround = front.length + behind.length;
  if (length !== placedLayout.bits + bitsAround - missingFirstBits.length - missingLowBits) return [];
  const template = commandBits ? fillTemplate(TABLE.texts.after_command, offsetText) : offsetText;
  const affectedBits = length - commandBits;
  const command = typedFrame.number >> BigInt(affectedBits);
  const framePartBits = affectedBits - bitsAround;
  const frontAndFramePart = extractBits(typedFrame.number, 0, affectedBits) >> BigInt(behind.length);
  const highestBit = framePartBits + front.length - 1;
  const startBits = [...front].flatMap((mark, index) => (mark === "1" ? [highestBit - index] : []));
  const isConsistent = startBits.every((bit) => extractBits(frontAndFramePart, bit, 1));
  const affectedFrame = ((BigInt(`0b0${missingFirstBits}`) << BigInt(framePartBits))
    | extractBits(frontAndFramePart, 0, framePartBits)) << BigInt(missingLowBits);
  const frameNumber = (command << BigInt(placedLayout.bits - commandBits)) | affectedFrame;
  // Without a CRC, there is a hypothesis for each value of the lost last bits.
  const assumedBits = crc ? 0 : missingLowBits + missingFirstBits.length;
  const members = {
    template, missingLowBits: crc ? missingLowBits : assumedBits, otherBitsRequired: startBits.length, isConsistent,
    hasAssumedBit: assumedBits > 0, relativeFrequency: commandBits ? TABLE.likely.after_command : 1 };
  const lastBitValues = listNumbersBelow(crc ? 1 : 1 << missingLowBits).map(BigInt);
  const text = fillTemplate(template, missingFirstBits);
  const hypotheses = lastBitValues.map((lastBits) => (
    createFrameHypothesis(placedLayout, crc, kind, text, frameNumber | lastBits, members)));
  const { idle, active } = TABLE.likely;
  const bitsWithMark = (marks, mark, highestPlace) => [...marks].flatMap(
    (markOfBit, index) => (markOfBit === mark ? [extractBits(typedFrame.number, highestPlace - index, 1)] : []));
  const mostlyZeroBits = [
    ...bitsWithMark(front, "~", affectedBits - 1), ...bitsWithMark(behind, "~", behind.length - 1)];
  const likelihoodAround = mostlyZeroBits.reduce((product, bit) => product * (bit ? active : idle), 1);
  return hypotheses.map(
    (hypothesis) => ({ ...hypothesis, likelihood: hypothesis.likelihood * likelihoodAround }));
}

/**
 * Try the frame in a recording. ``pattern`` matches the recording, with a group for each of its parts, such as "frame".
 * The bits of the groups named in ``determinedNames`` have one possible value.
 */
function tryRecording(placedLayout, crc, receivedText, [kind, text, pattern, determinedNames]) {
  const textByPart = matchRecording(pattern, placedLayout, receivedText)?.groups;
  if (!textByPart) return [];
  // A frame that is sent twice is followed by ``again``, perhaps cut off.
  const { frame: frameText, again: repeatedText = "" } = textByPart;
  const parts = Object.entries(textByPart).filter(([, partText]) => partText);
  const zerosOfWord = countZerosOfWord(placedLayout, textByPart.zeros ?? "", parts[0]?.[0] === "zeros");
  const otherBitsRequired = determinedNames.reduce(
    (sum, name) => sum + (textByPart[name] ?? "").length, 0) - zerosOfWord;
  return [createFrameHypothesis(
    placedLayout, crc, kind, text, BigInt(`0b${frameText}`),
    { otherBitsRequired, parts, isConsistent: frameText.startsWith(repeatedText) })];
}

/** Return how many extra zeros on one side of a word the layout also has at this end of every word. */
function countZerosOfWord(placedLayout, zerosText, isFirst) {
  const constants = placedLayout.fields.filter(({ field }) => "fixed" in field);
  const zerosMask = constants.reduce((mask, { field, low, width }) => (
    mask | (ones(width) & ~toBigInt(field.fixed)) << BigInt(low)), 0n);
  const [marks] = zerosMask.toString(2).padStart(placedLayout.bits, "0").match(isFirst ? /^1*/u : /1*$/u);
  return Math.min(marks.length, zerosText.length);
}

// -- frames of bytes

/** Return whether a CRC consists of whole bytes. Mistakes in bytes with another CRC are not looked for. */
const isWholeBytes = ({ width }) => width % 8 === 0;

/** Return whether a frame of bytes has a CRC that does not consist of whole bytes. */
const hasOddCrcOverBytes = ({ receivedBytes, placedLayout }) => (
  Boolean(receivedBytes && placedLayout?.crc) && !isWholeBytes(placedLayout.crc));

/** Try every single mistake that could have turned a valid frame into these bytes. */
function tryMistakesInBytes(decoded) {
  const { placedLayout: expectedLayout, receivedBytes: data, orderCode, interface: interface_, sender } = decoded;
  const wholeFrames = tryWholeFrames(decoded);
  // Where the manual is ambiguous, the first answer decides, as on the command line.
  const firstAnswers = Object.fromEntries(
    (orderCode.family.alternatives ?? []).map((alternative) => [alternative.name, alternative.answers[0][0]]));
  const hypotheses = layoutsOf(interface_, sender).filter((layout) => layout.order).flatMap((layout) => {
    const placedLayout = placedFor(orderCode, layout, {}, firstAnswers);
    const { crc } = placedLayout;
    if (crc && !isWholeBytes(crc)) return [];
    const hasFrameLength = 8 * data.length === placedLayout.bits;
    const isExpected = expectedLayout?.layout === layout && hasFrameLength;
    const typedFrame = { number: numberOfFrame(layout, data), bits: 8 * data.length, exact: true };
    return [...(crc && isExpected ? tryOtherByteCrcs(placedLayout, crc, data) : []),
      ...(crc && !hasFrameLength ? tryOtherMessage(placedLayout, crc, data) : []),
      ...(crc ? [] : tryOtherOrderCodes(placedLayout, typedFrame)), ...tryMovedBytes(placedLayout, crc, data)];
  });
  // Whole frames already explain extra bytes around the same frame.
  const isSameFrame = (wholeFrame, hypothesis) => wholeFrame.number === hypothesis.number
    && wholeFrame.placedLayout.layout === hypothesis.placedLayout.layout;
  const isRepeated = (hypothesis) => ["bytes_in_front", "bytes_behind"].includes(hypothesis.kind)
    && wholeFrames.some((wholeFrame) => isSameFrame(wholeFrame, hypothesis));
  return [...wholeFrames, ...hypotheses.map(
    (hypothesis) => ({ ...hypothesis, isRepeated: isRepeated(hypothesis) }))];
}

/** Join bytes to a number, the first byte highest. */
const joinBytes = (bytes) => numberOf("big", bytes);
/** Return the hypothesis with the last bytes as the CRC over the bytes before it. */
const withCrcOverBytes = (hypothesis, placedLayout, bytes) => {
  const data = bytes.slice(0, -placedLayout.crc.width / 8);
  return {
    ...hypothesis, coveredData: joinBytes(data), coveredBits: 8 * data.length,
    receivedCrc: receivedCrcOf(placedLayout, bytes), isOfBytes: true };
};

/** Return the CRC in a frame of bytes. */
function receivedCrcOf(placedLayout, bytes) {
  const { low, width } = findCrcField(placedLayout);
  return extractBits(numberOfFrame(placedLayout.layout, bytes), low, width);
}

/** Try the frame as sent with another CRC. */
function tryOtherByteCrcs(placedLayout, crc, data) {
  const { texts } = TABLE;
  const asSent = withCrcOverBytes(
    createHypothesisAsSent(placedLayout, crc, numberOfFrame(placedLayout.layout, data)), placedLayout, data);
  const crcLength = crc.width / 8;
  const withMistake = (kind, text, members) => ({ ...asSent, kind, text, template: text, ...members });
  const swapped = { receivedCrc: numberOf("big", bytesOf("little", asSent.receivedCrc, crcLength)) };
  const hypotheses = crcLength > 1 ? [
    withMistake("crc_bytes_swapped", texts.crc_bytes_swapped, swapped),
    withMistake("crc_reversed", texts.crc_reversed, { receivedCrc: reverseBits(asSent.receivedCrc, crc.width) })] : [];
  for (const [kind, text, otherCrc] of crc.byte_others ?? []) {
    hypotheses.push(withMistake(kind, text, { crc: otherCrc }));
    if (crcLength > 1 && kind === "other_polynomial") {
      hypotheses.push(withMistake(kind, fillTemplate(texts.and_swapped, text), { crc: otherCrc, ...swapped }));
    }
  }
  const coveredBytes = data.slice(1, -crcLength);
  return [...hypotheses, withMistake("first_byte_left_out", texts.first_byte_left_out, {
    coveredData: joinBytes(coveredBytes), coveredBits: 8 * coveredBytes.length })];
}

/** The bytes are a whole message of another length, if a CRC of many bits with a start value other than 0 shows it. */
function tryOtherMessage(placedLayout, crc, receivedBytes) {
  const crcLength = crc.width / 8;
  const canShow = crc.width >= TABLE.exchanges.message_crc && toBigInt(crc.init) !== 0n;
  if (!canShow || receivedBytes.length <= crcLength) return [];
  const data = receivedBytes.slice(0, -crcLength);
  const frame = [...Array(placedLayout.bits / 8 - crcLength).fill(0), ...receivedBytes.slice(-crcLength)];
  return [createHypothesis({
    kind: "other_message", text: TABLE.texts.other_message, crc, coveredData: joinBytes(data),
    coveredBits: 8 * data.length, receivedCrc: receivedCrcOf(placedLayout, frame), crcBitsReceived: crc.width,
    isOfBytes: true })];
}

/** The bytes do not begin and end with the frame, are inverted, or have their bits in reverse order. */
function tryMovedBytes(placedLayout, crc, data) {
  const { texts } = TABLE;
  const byteCount = placedLayout.bits / 8;
  const assumeFrame = (kind, text, bytes, template = text, assumedBits = 0) => {
    const hypothesis = createFrameHypothesis(
      placedLayout, crc, kind, text, numberOfFrame(placedLayout.layout, bytes), { template });
    hypothesis.otherBitsRequired -= assumedBits;
    return crc ? withCrcOverBytes(hypothesis, placedLayout, bytes) : hypothesis;
  };
  const extraBytes = data.length - byteCount;
  const hypotheses = [];
  if (extraBytes > 0 && extraBytes <= TABLE.exchanges.echoed) {
    const extraText = extraBytes > 1 ? fillTemplate(texts.extra_bytes, extraBytes) : texts.extra_byte;
    hypotheses.push(assumeFrame("bytes_in_front", fillTemplate(texts.before, extraText), data.slice(extraBytes)),
      assumeFrame("bytes_behind", fillTemplate(texts.after, extraText), data.slice(0, byteCount)));
  }
  if (extraBytes === 0 || extraBytes === -1) {
    // The bits of the missing byte are assumed, so they prove nothing.
    const constantBits = countConstantBits({ checks: placedLayout.checks.filter(
      ({ low, width }) => extractBits(firstByteMaskOf(placedLayout) >> BigInt(low), 0, width)) });
    const followingBytes = data.slice(0, byteCount - 1);
    const assumeFirstByte = (byte, assumedBits) => {
      const [text, template] = [formatBytes([byte]), "{0}"]
        .map((byteText) => fillTemplate(texts.byte_missing, byteText))
        .map((missingText) => (extraBytes ? missingText : fillTemplate(texts.and_follows, missingText)));
      return assumeFrame("first_byte_lost", text, [byte, ...followingBytes], template, assumedBits);
    };
    const possibleBytes = findPossibleFirstBytes(placedLayout);
    hypotheses.push(...possibleBytes.map((byte) => assumeFirstByte(byte, constantBits)));
    // Any other first byte is searched if enough bits show that it is missing.
    const canSearch = crc && crc.width - 8 + countConstantBits(placedLayout) - constantBits >= TABLE.exchanges.least;
    const searchedBytes = canSearch ? [findFirstByte(placedLayout, crc, followingBytes)] : [];
    hypotheses.push(...searchedBytes.filter((byte) => !possibleBytes.includes(byte)).map((byte) => (
      { ...assumeFirstByte(byte, 0), placeCount: TABLE.exchanges.byte_values })));
    if (extraBytes && crc?.width > 8) {
      const bytes = [...data, findLastByte(placedLayout, crc, data)];
      hypotheses.push({
        ...assumeFrame("last_bits_missing", texts.last_byte_missing, bytes),
        placeCount: TABLE.exchanges.byte_values });
    }
  }
  if (extraBytes === 0) {
    const changedFrames = [
      ["all_inverted", texts.bytes_inverted, data.map((byte) => byte ^ 0xFF)],
      ["bits_reversed_in_bytes", texts.bits_reversed_in_bytes,
        data.map((byte) => Number(reverseBits(BigInt(byte), 8)))]];
    for (const [kind, text, frame] of changedFrames) {
      hypotheses.push(assumeFrame(kind, text, frame));
      if (crc?.width > 8) {
        const crcLength = crc.width / 8;
        const swappedFrame = [...frame.slice(0, -crcLength), ...frame.slice(-crcLength).reverse()];
        hypotheses.push({
          ...assumeFrame(kind, fillTemplate(texts.and_crc_bytes_swapped, text), swappedFrame),
          relativeFrequency: TABLE.likely.with_second });
      }
    }
  }
  return hypotheses;
}

/**
 * Find the first byte with which the CRC of a frame is right, or 0 if there is none. Each bit of this byte inverts certain
 * bits of the CRC, whatever the other bits are.
 */
function findFirstByte(placedLayout, crc, followingBytes) {
  const data = followingBytes.slice(0, -crc.width / 8);
  const crcWith0 = crcOfBytes(crc, [0, ...data]);
  const wrongCrcBits = receivedCrcOf(placedLayout, [0, ...followingBytes]) ^ crcWith0;
  const crcBitsByBit = listNumbersBelow(8).map((bit) => crcOfBytes(crc, [1 << bit, ...data]) ^ crcWith0);
  const invertedCrcBits = (byte) => crcBitsByBit.reduce(
    (bits, crcBits, bit) => ((byte >> bit) & 1 ? bits ^ crcBits : bits), 0n);
  const isFirstByte = (byte) => invertedCrcBits(byte) === wrongCrcBits;
  return Math.max(listNumbersBelow(TABLE.exchanges.byte_values).findIndex(isFirstByte), 0);
}

/** Find the last byte of a frame, which belongs to its CRC of several bytes. */
function findLastByte(placedLayout, crc, receivedBytes) {
  const computedCrc = crcOfBytes(crc, receivedBytes.slice(0, -(crc.width / 8 - 1)));
  const frameNumber = computedCrc << BigInt(findCrcField(placedLayout).low);
  return bytesOfFrame(placedLayout.layout, frameNumber, placedLayout.bits / 8).at(-1);
}

/** Return the mask of the first byte in the number of a frame. */
const firstByteMaskOf = ({ layout, bits }) => numberOfFrame(layout, [0xFF, ...Array(bits / 8 - 1).fill(0)]);

/** The possible first bytes of a frame, if that byte only has the selector, constants, parity and usual values. */
function findPossibleFirstBytes(placedLayout) {
  const { selector, selects: selectorValues = [], usual = [] } = placedLayout.layout;
  const byteCount = placedLayout.bits / 8;
  const fieldsInFirstByte = placedLayout.fields.filter(
    ({ low, width }) => extractBits(firstByteMaskOf(placedLayout) >> BigInt(low), 0, width));
  const selectorFields = fieldsInFirstByte.filter(({ name }) => name === selector);
  const parityFields = fieldsInFirstByte.filter(({ field }) => "parity" in field);
  const otherFields = fieldsInFirstByte.filter(({ name, field }) => name !== selector && !("parity" in field));
  const usualValueOf = (name) => usual.find((values) => values[0] === name && values.length === 2)?.[1];
  const expectedValueOf = ({ name, field }) => ("fixed" in field ? field.fixed : usualValueOf(name));
  if (otherFields.some((placedField) => expectedValueOf(placedField) === undefined)) return [];
  const insertField = (number, { low }, fieldValue) => number | (toBigInt(fieldValue) << BigInt(low));
  const numberWithoutSelector = otherFields.reduce(
    (number, placedField) => insertField(number, placedField, expectedValueOf(placedField)), 0n);
  return (selectorFields.length ? selectorValues : [0]).map((selectorValue) => {
    let number = selectorFields.reduce(
      (sum, placedField) => insertField(sum, placedField, selectorValue), numberWithoutSelector);
    for (const parityField of parityFields) {
      number = insertField(number, parityField, computeParityOf(placedLayout, parityField, number));
    }
    return bytesOfFrame(placedLayout.layout, number, byteCount)[0];
  });
}

/** Compute the parity that a parity field must have in a frame. */
function computeParityOf(placedLayout, parityField, number) {
  const { coveredPlaces, check } = placedLayout.checks.find(
    (placedCheck) => placedCheck.coveredPlaces && placedCheck.check.field === parityField.name);
  return computeParity(number, coveredPlaces, check);
}

/** Try the bytes as whole frames of RS-485: an echo of the request, a reply after it, or several replies. */
function tryWholeFrames({ receivedBytes, orderCode, interface: interface_, sender }) {
  const { most: mostBytes, least: leastEvidence } = TABLE.exchanges;
  if (receivedBytes.length > mostBytes || interface_.name !== "rs485" || sender !== "encoder") return [];
  const placedLayouts = interface_.frames.filter((layout) => layout.order)
    .map((layout) => placedFor(orderCode, layout));
  const frames = replaceWithOwnReplies(splitIntoFrames(placedLayouts, receivedBytes), placedLayouts);
  const isOnlyReply = frames.length === 1 && !isRequest(frames[0]);
  const totalEvidence = frames.reduce((sum, frame) => sum + frame.evidence, 0);
  if (!frames.length || isOnlyReply || totalEvidence < leastEvidence) return [];
  return [createWholeFramesHypothesis(frames, receivedBytes, totalEvidence)];
}

/**
 * Return whether a wrong frame is a valid frame of another kind, whose check bits match, so that it has no mistake. A
 * dead line or the own request is more likely than such a frame.
 */
function isAnotherFrame(decoded, otherLayouts) {
  const [otherLayout] = otherLayouts;
  return decoded.problems.length > 0 && otherLayouts.length === 1
    && Boolean(otherLayout.crc || otherLayout.checks.some((placedCheck) => placedCheck.check.fault === "constant"))
    && !deadLine(decoded) && !explained(decoded).some(({ kind }) => kind === "echo");
}

/** Return the text with other order codes that may have sent a valid frame of another kind without a CRC, or "". */
function findOtherCode(decoded, otherLayouts) {
  if (!isAnotherFrame(decoded, otherLayouts) || canCrcContradict(decoded)) return "";
  return explained(decoded).find(({ kind }) => kind === "other_order_code")?.text ?? "";
}

/** Return whether the master sends a frame. */
const isRequest = ({ placedLayout }) => placedLayout.layout.sender === "master";

/**
 * Split bytes into the fewest valid frames, each {placedLayout, bytes, evidence}, or return [] if that is impossible.
 * ``evidence`` counts the bits with the value to expect. A frame has some.
 */
function splitIntoFrames(placedLayouts, bytes) {
  const candidates = placedLayouts.map((placedLayout) => ({ placedLayout }));
  // The fewest frames from a byte to the end, by the index of this byte. It is filled from the end.
  const fewestFramesFrom = new Map([[bytes.length, []]]);
  for (let firstByte = bytes.length - 1; firstByte >= 0; firstByte -= 1) {
    // A request is in front of its reply, even if both have the same form.
    const isLikely = (candidate) => isRequest(candidate) === (firstByte === 0);
    const likeliestFirst = [
      ...candidates.filter(isLikely), ...candidates.filter((candidate) => !isLikely(candidate))];
    for (const { placedLayout } of likeliestFirst) {
      const nextByte = firstByte + placedLayout.bits / 8;
      const followingFrames = fewestFramesFrom.get(nextByte);
      const frameBytes = bytes.slice(firstByte, nextByte);
      const isShorter = followingFrames
        && !(fewestFramesFrom.get(firstByte)?.length <= followingFrames.length + 1);
      const evidence = isShorter
        ? countExpectedBits(placedLayout, numberOfFrame(placedLayout.layout, frameBytes)) : 0;
      if (evidence && !decodeBytes(placedLayout, frameBytes).problems.length) {
        fewestFramesFrom.set(firstByte, [{ placedLayout, bytes: frameBytes, evidence }, ...followingFrames]);
      }
    }
  }
  return fewestFramesFrom.get(0) ?? [];
}

/** Return the frames with each reply as the reply to the request before it, if its bytes are also valid as such. */
function replaceWithOwnReplies(frames, placedLayouts) {
  return frames.map((frame, index) => {
    const replyName = frames[index - 1]?.placedLayout.layout.reply;
    const placedLayout = placedLayouts.find(({ name, bits }) => name === replyName && bits === 8 * frame.bytes.length);
    if (!placedLayout || isRequest(frame) || frame.placedLayout.name === replyName) return frame;
    const evidence = countExpectedBits(placedLayout, numberOfFrame(placedLayout.layout, frame.bytes));
    const isValid = evidence && !decodeBytes(placedLayout, frame.bytes).problems.length;
    return isValid ? { placedLayout, bytes: frame.bytes, evidence } : frame;
  });
}

/** Create the hypothesis that the bytes are these frames, which are more than one reply. */
function createWholeFramesHypothesis(frames, receivedBytes, totalEvidence) {
  const { echo: echoText, frames: framesText } = TABLE.exchanges;
  const replyCount = frames.filter((frame) => !isRequest(frame)).length;
  const kindWithOneReply = isRequest(frames[0]) ? "bytes_in_front" : "bytes_behind";
  const kind = ["echo", kindWithOneReply][replyCount] ?? "several_frames";
  const roles = frames.map((frame) => (isRequest(frame) ? "request" : "reply"));
  const titleOf = (role, { name }) => (name === role ? role : `${role} ${name}`);
  const titles = frames.map((frame, index) => titleOf(roles[index], frame.placedLayout));
  const text = kind === "echo" ? fillTemplate(echoText, ` ${frames[0].placedLayout.name}`)
    : fillTemplate(framesText, titles.join(", then "));
  const template = kind === "echo" ? fillTemplate(echoText, "") : fillTemplate(framesText, roles.join(", then "));
  const lastFrame = frames.at(-1);
  const isCertainReply = !isRequest(lastFrame) && !lastFrame.placedLayout.layout.asks?.length;
  return createHypothesis({
    kind, text, template, placedLayout: lastFrame.placedLayout, otherBitsRequired: totalEvidence,
    likelihood: frames.reduce((product, { placedLayout, bytes }) => (
      product * computeLikelihood(placedLayout, numberOfFrame(placedLayout.layout, bytes))), 1),
    parts: frames.map((frame, index) => [titles[index], formatBytes(frame.bytes)]),
    coveredData: joinBytes(receivedBytes), coveredBits: 8 * receivedBytes.length,
    number: isCertainReply ? numberOfFrame(lastFrame.placedLayout.layout, lastFrame.bytes) : undefined,
  });
}

/** Count the bits in a valid frame that have the value to expect: CRC, constants, and fields with a usual value. */
function countExpectedBits(placedLayout, number) {
  const usualBits = (placedLayout.layout.usual ?? []).reduce((sum, [name, ...usualValues]) => {
    const placedField = placedLayout.fields.find((candidate) => candidate.name === name);
    const isUsual = placedField && usualValues.some(
      (usualValue) => toBigInt(usualValue) === extractBits(number, placedField.low, placedField.width));
    return sum + (isUsual ? placedField.width - bitLength(BigInt(usualValues.length - 1)) : 0);
  }, 0);
  return countConstantBits(placedLayout) + usualBits
    + (placedLayout.crc?.width ?? 0);
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
    || extractBits(number, placedField.low, placedField.width)
      === (toBigInt(placedField.field.unused) & ones(placedField.width)));
  const requests = layoutsOf(interface_, "master").filter((layout) => !layout.order)
    .map((layout) => placeLayout(placedLayout.family, layout, placedLayout.parameters))
    .filter((request) => request.bits === placedLayout.bits && !decode(request, number).problems.length
      && hasDocumentedBits(request))
    .map((request) => ({
      name: request.name, bits: request.bits, evidence: countExpectedBits(request, number) - repeatedBits }))
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
    kind: "echo", text, template, coveredData: number, coveredBits: request.bits,
    otherBitsRequired: request.evidence })];
}

/** Return the name of the request that a valid word also is, or "". */
function ownRequest({ placedLayout, number, problems }) {
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
  const isNumber = ({ field }) => isEnteredByUser({ field }) && !dependsOnAnswer(field)
    && (field.kind === undefined || field.kind === "signed");
  const names = placedLayout.fields.filter(isNumber).map((placedField) => placedField.name);
  return decode(placedLayout, number).fields.filter((field) => names.includes(field.name))
    .map((field) => [field.name, field.value]);
}

/** The name of the position, which an encoder in one line has even if it does not state its counts. */
const positionNameOf = (measure) => measure?.of ?? "position";

/** Return the text and the frame at the beginning of the bytes of an SPI word that does not fill them, in a list. */
function findLeftAlignedFrame(placedLayout, typedFrame) {
  if (!isWordInBytes(placedLayout, typedFrame)) return [];
  const frameNumber = typedFrame.number >> BigInt(typedFrame.written - placedLayout.bits);
  return hasRightConstants(placedLayout, frameNumber) ? [[TABLE.left_aligned, frameNumber]] : [];
}

/**
 * Return the text and the frame with zeros at its end, in a list, if a number lacks a byte or more. Its leading zeros may
 * be missing, but so may its last bits.
 */
function findCutFrame(placedLayout, typedFrame) {
  const missingBits = placedLayout.bits - (typedFrame?.written || placedLayout.bits);
  if (!typedFrame || typedFrame.exact || missingBits < 8) return [];
  const frameNumber = typedFrame.number << BigInt(missingBits);
  return hasRightConstants(placedLayout, frameNumber) ? [[TABLE.cut_off, frameNumber]] : [];
}

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

/** Return the parts of the position in a frame, each as {low, width}: one, or several that are joined. */
function listPositionParts(placedLayout, position) {
  const isJoined = position.high < 0;
  if (!isJoined) return [{ low: position.low, width: position.high - position.low + 1 }];
  const join = placedLayout.joins.find(({ name }) => name === position.name);
  return join.parts.map(({ placedField }) => placedField).filter(Boolean);
}

/** Return a number of which these bits are Gray code, with them in binary. */
function decodeGrayBits(number, { low, width }) {
  const grayBits = extractBits(number, low, width);
  return number ^ ((grayBits ^ grayToBinary(grayBits)) << BigInt(low));
}

/**
 * Return the frames that may have been sent instead, in the order of the texts in ``TABLE.doubts``: one bit later, one
 * bit earlier, in Gray code, in binary, with its bytes in reverse order, or inverted. A frame is null if that cannot be.
 */
function listDoubtfulFrames(placedLayout, number, position, typedFrame) {
  const parts = listPositionParts(placedLayout, position);
  const low = Math.min(...parts.map((part) => part.low));
  const width = parts.reduce((sum, part) => sum + part.width, 0);
  const isSplit = parts.length > 1;
  const withLastBit0 = (number << ONE) & ones(placedLayout.bits);
  const isPossible = (frameNumber) => hasRightConstants(placedLayout, frameNumber);
  const ifPossible = (frameNumber) => (
    frameNumber >> BigInt(placedLayout.bits) || !isPossible(frameNumber) ? null : frameNumber);
  const mayBeBytes = !typedFrame?.exact || typedFrame.bits % 8 === 0;
  const withReversedBytes = numberOf("big", bytesOf("little", number, countBytes(placedLayout.bits)));
  return [
    [withLastBit0, withLastBit0 | ONE].find(isPossible) ?? withLastBit0,
    number >> ONE,
    placedLayout.gray ? null : decodeGrayBits(number, { low, width }),
    placedLayout.gray || !isSplit ? null : parts.reduce(decodeGrayBits, number),
    placedLayout.gray ? convertFromBinary(placedLayout, number) : null,
    mayBeBytes ? ifPossible(withReversedBytes) : null,
    ifPossible(number ^ ones(placedLayout.bits)),
  ];
}

/**
 * The frame before it was read one clock early and one clock late, or null for a shift that is detected. A CRC whose
 * start value is 0 and that is not inverted is also valid for a frame that is shifted by a 0.
 */
function listUndetectedShifts(placedLayout, number) {
  const { init, xorout } = placedLayout.crc;
  const mayMissShift = toBigInt(init) === 0n && toBigInt(xorout) === 0n;
  return [number << ONE, number >> ONE].map((frameNumber) => (
    mayMissShift && !decode(placedLayout, frameNumber).problems.length ? frameNumber : null));
}

/** Other readings of a position that nothing in the frame can contradict. They do not explain an error. */
function otherPositions({ placedLayout, number, problems, crc, fields, typedFrame }, measure) {
  const isWordOfEncoder = placedLayout && !placedLayout.layout.order && placedLayout.layout.sender === "encoder";
  const name = positionNameOf(measure);
  const positionIn = (decodedFields) => decodedFields.find((field) => field.name === name);
  const position = positionIn(fields);
  const hasPosition = typeof position?.value === "bigint";
  const hasDigits = Boolean(placedLayout?.digits.length);
  if (!isWordOfEncoder || problems.length || !hasPosition || hasDigits) return [];
  const doubtfulFrames = crc ? listUndetectedShifts(placedLayout, number)
    : listDoubtfulFrames(placedLayout, number, position, typedFrame);
  const recordedFrames = crc ? [] : [
    ...findLeftAlignedFrame(placedLayout, typedFrame), ...findCutFrame(placedLayout, typedFrame),
    ...findRecordedFrames(placedLayout, typedFrame)];
  return [...doubtfulFrames.map((frameNumber, index) => [TABLE.doubts[index], frameNumber]), ...recordedFrames]
    .filter(([, frameNumber]) => frameNumber !== null)
    .map(([text, frameNumber]) => [text, positionIn(decode(placedLayout, frameNumber).fields).value])
    .filter(([, otherPosition]) => otherPosition !== position.value);
}

/** Return the placed checks of bits that must have one of few values in every frame, such as constants and parity. */
const constantChecksOf = (placedLayout) => placedLayout.checks.filter((placedCheck) => placedCheck.check.always);

/** Return the number of bits in a frame that can have only one value. */
function countConstantBits(placedLayout) {
  const freeBitsOf = (check) => bitLength(BigInt((check.values?.length ?? 1) - 1));
  return constantChecksOf(placedLayout).reduce((sum, { check, width }) => sum + width - freeBitsOf(check), 0);
}

/** Return whether nothing but one parity bit can contradict a frame, which then passes half of all shifts. */
const hasOnlyParity = (placedLayout) => !placedLayout.crc && countConstantBits(placedLayout) === 1
  && placedLayout.checks.some(({ coveredPlaces }) => coveredPlaces);

/** Return whether the constants, the parity and the selector of a frame are right. */
const hasRightConstants = (placedLayout, number) => (
  constantChecksOf(placedLayout).every((placedCheck) => !findProblems(placedCheck, number, number).length));
