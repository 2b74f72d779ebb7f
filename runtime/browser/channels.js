// License 0BSD: use, modify and distribute this file without any condition.
// Frames with several data channels, one directly after the other.

/**
 * Decode the frame in a text with all data channels. Return null if it is a single channel.
 * A text is a single channel if it has all digits of one, in hex digits or in bytes. Fewer digits may be a whole frame
 * without its leading zeros. Exact bits are a single channel if they are not more than the bits of the longest channel.
 */
function decodeChannels(orderCode, text, registerContents, answers) {
  const { channels } = orderCode.interface;
  if (!channels) return null;
  const placedChannels = channels.order.map((layoutIndex) => (
    placedFor(orderCode, orderCode.interface.frames[layoutIndex], registerContents, answers)));
  const bits = placedChannels.reduce((sum, placedLayout) => sum + placedLayout.bits, 0);
  const typedFrame = numberIn(text, bits, true);
  const channelBits = placedChannels.map((placedLayout) => placedLayout.bits);
  const writtenBits = channelBits.flatMap((count) => [4, 8].map((unit) => unit * Math.ceil(count / unit)));
  const longest = Math.max(...channelBits);
  const hasAllDigits = writtenBits.includes(typedFrame.written) && bitLength(typedFrame.number) <= longest;
  const hasBitsOfChannel = typedFrame.exact && typedFrame.bits <= longest;
  if (hasAllDigits || hasBitsOfChannel) return null;
  const positionChannel = placedChannels[channels.position];
  const receivedBits = typedFrame.exact ? typedFrame.bits : Math.max(bits, typedFrame.bits);
  if (receivedBits !== bits) {
    const message = describeChannelLength(placedChannels, bits, receivedBits);
    const emptyResult = createEmptyResult(positionChannel, 0n);
    const readings = listChannelReadings(placedChannels, typedFrame.number, receivedBits);
    return { ...emptyResult, problems: [{ fault: "length", field: "", message }], channels: [], bits, readings };
  }
  const wholeFrame = mergeChannels(channels, decodeEachChannel(placedChannels, typedFrame.number, bits));
  const readings = wholeFrame.problems.length ? listChannelReadings(placedChannels, typedFrame.number, bits) : [];
  return { ...wholeFrame, bits, readings };
}

/** List the readings of received bits with which all CRCs are correct, if these have enough bits to prove it. */
function listChannelReadings(placedChannels, number, receivedBits) {
  const crcBits = placedChannels.reduce((sum, placedLayout) => sum + (findCrcField(placedLayout)?.width ?? 0), 0);
  if (crcBits < TABLE.likely.channel_crc_bits) return [];
  const bits = placedChannels.reduce((sum, placedLayout) => sum + placedLayout.bits, 0);
  const isValid = (channelsInOrder, frameNumber) => (
    decodeEachChannel(channelsInOrder, frameNumber, bits).every(({ problems }) => !problems.length));
  if (receivedBits === bits) {
    const otherOrders = permute(placedChannels).slice(1).filter((otherOrder) => isValid(otherOrder, number));
    return otherOrders.map((otherOrder) => messageFor("other_order", otherOrder.map(({ name }) => name).join(", ")));
  }
  const bitsAround = receivedBits - bits;
  return listNumbersBelow(Math.max(bitsAround + 1, 0))
    .filter((bitsBefore) => isValid(placedChannels, extractBits(number, bitsAround - bitsBefore, bits)))
    .map((bitsBefore) => messageFor("bits_around", bitsBefore, bitsAround - bitsBefore));
}

/** Return all orders of a list, beginning with its own. */
function permute(list) {
  if (!list.length) return [[]];
  return list.flatMap((first, index) => (
    permute(list.filter((_, otherIndex) => otherIndex !== index)).map((others) => [first, ...others])));
}

/** Return the message about a frame of another length than the ``bits`` bits of all channels. */
function describeChannelLength(placedChannels, bits, receivedBits) {
  const channelTexts = placedChannels.map((placedLayout) => `${placedLayout.name} (${placedLayout.bits} bits)`);
  const bitsOff = Math.abs(bits - receivedBits);
  const difference = `${countWithNoun(bitsOff, "bit")} ${bitsOff === 1 ? "is" : "are"} `
    + (receivedBits < bits ? "missing" : "too many");
  return messageFor("length_of_channels", channelTexts.join(" and "), `${bits} bits`, receivedBits, difference);
}

/** Decode the channels in the ``bits`` bits of a frame, each by its placed layout. The first has the highest bits. */
function decodeEachChannel(placedChannels, number, bits) {
  let low = bits;
  return placedChannels.map((placedLayout) => {
    low -= placedLayout.bits;
    const channelNumber = (number >> BigInt(low)) & ones(placedLayout.bits);
    return decodeBits(placedLayout,
      { number: channelNumber, bits: placedLayout.bits, exact: true, written: placedLayout.bits });
  });
}

/** Merge the decoded channels into a whole frame: the errors, reports and fields of all, and their worst verdict. */
function mergeChannels(channels, decodedChannels) {
  const positionChannel = decodedChannels[channels.position];
  const nameInFrame = ({ placedLayout }, fieldName) => (
    placedLayout === positionChannel.placedLayout ? fieldName : `${placedLayout.name}.${fieldName}`);
  const problems = decodedChannels.flatMap((channel) => (
    channel.problems.map((problem) => ({ ...problem, message: `${channel.placedLayout.name}: ${problem.message}` }))));
  const comparison = problems.length ? null : compareChannels(channels, decodedChannels);
  const verdicts = decodedChannels.filter((channel) => channel === positionChannel || channel.verdict !== "unknown")
    .map((channel) => channel.verdict);
  if (comparison && !comparison.agree) verdicts.push("not_usable");
  const worstVerdict = Object.keys(TABLE.worth).find((verdict) => verdicts.includes(verdict)) ?? null;
  return {
    ...positionChannel,
    problems,
    verdict: problems.length ? null : worstVerdict,
    reports: decodedChannels.flatMap((channel) => channel.reports),
    differences: decodedChannels.flatMap((channel) => channel.differences),
    fields: decodedChannels.flatMap((channel) => (
      channel.fields.map((field) => ({ ...field, name: nameInFrame(channel, field.name) })))),
    channels: decodedChannels,
    compared: comparison,
  };
}

/** Return whether the compared fields agree, and the sentence about them, or null if nothing is compared. */
function compareChannels(channels, decodedChannels) {
  if (!channels.compared) return null;
  const { parameters } = decodedChannels[channels.position].placedLayout;
  const bitCount = Number(evaluateExpression(channels.compared_bits, parameters));
  const namedNumbers = channels.compared.map(([channelIndex, fieldName]) => {
    const { placedLayout, fields } = decodedChannels[channelIndex];
    const field = fields.find((decodedField) => decodedField.name === fieldName);
    return {
      name: `${fieldName} of ${placedLayout.name}`,
      number: field.value >> BigInt(field.high - field.low + 1 - bitCount),
    };
  });
  const differs = (number, otherNumber) => BigInt.asUintN(bitCount, number - otherNumber) > toBigInt(channels.tolerance)
    && BigInt.asUintN(bitCount, otherNumber - number) > toBigInt(channels.tolerance);
  const agree = !namedNumbers.some(({ number }) => differs(number, namedNumbers[0].number));
  const numbersText = namedNumbers.map(({ name, number }) => `${name} ${hex(number)}`).join(" and ");
  return { agree, words: messageFor(agree ? "compared" : "compared_not", bitCount, numbersText) };
}
