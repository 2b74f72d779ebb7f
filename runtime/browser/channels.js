// Licence 0BSD: use, modify and distribute this file without any condition.
// Frames with several data channels, one directly after the other.

/** The frame in a text with all data channels, decoded, or null if the text is not longer than a single channel. */
function decodeChannels(found, text, held, answers) {
  const { channels } = found.interface;
  if (!channels) return null;
  const placedChannels = channels.order.map((place) => placedFor(found, found.interface.frames[place], held, answers));
  const bits = placedChannels.reduce((sum, at) => sum + at.bits, 0);
  const given = numberIn(text, bits, true);
  const written = given.exact ? given.bits : Math.max(given.bits, given.written - 3);
  if (written <= Math.max(...placedChannels.map((at) => at.bits))) return null;
  const main = placedChannels[channels.position];
  const received = given.exact ? given.bits : Math.max(bits, given.bits);
  if (received !== bits) {
    const names = placedChannels.map((at) => at.name).join(", ");
    return { ...otherLength({ ...main, name: names }, `${bits} bits`, received), channels: [], bits };
  }
  return { ...judgedChannels(channels, channelsIn(placedChannels, given.number, bits)), bits };
}

/** The channels of a frame, each decoded. The first one has the highest bits. */
function channelsIn(placedChannels, number, bits) {
  let low = bits;
  return placedChannels.map((at) => {
    low -= at.bits;
    const own = (number >> BigInt(low)) & ones(at.bits);
    return decodeBits(at, { number: own, bits: at.bits, exact: true, written: at.bits });
  });
}

const FROM_WORST = ["not_usable", "unknown", "usable_with_warning", "usable"];

/** The whole frame: the errors, reports and fields of all channels, and their worst verdict. */
function judgedChannels(channels, decoded) {
  const main = decoded[channels.position];
  const named = ({ at }, name) => (at === main.at ? name : `${at.name}.${name}`);
  const problems = decoded.flatMap((one) => one.problems.map((item) => ({ ...item, message: `${one.at.name}: ${item.message}` })));
  const compared = problems.length ? null : comparedIn(channels, decoded);
  const verdicts = decoded.filter((one) => one === main || one.verdict !== "unknown").map((one) => one.verdict);
  if (compared && !compared.agree) verdicts.push("not_usable");
  const worst = FROM_WORST.find((one) => verdicts.includes(one)) ?? null;
  return {
    ...main,
    problems,
    verdict: problems.length ? null : worst,
    reports: decoded.flatMap((one) => one.reports),
    differences: decoded.flatMap((one) => one.differences),
    fields: decoded.flatMap((one) => one.fields.map((item) => ({ ...item, name: named(one, item.name) }))),
    channels: decoded,
    compared,
  };
}

/** Whether the compared fields agree, and the sentence about them. Null if nothing is compared. */
function comparedIn(channels, decoded) {
  if (!channels.compared) return null;
  const bits = Number(value(channels.compared_bits, decoded[channels.position].at.parameters));
  const numbers = channels.compared.map(([place, name]) => {
    const { at, fields } = decoded[place];
    const item = fields.find((one) => one.name === name);
    return { name: `${name} of ${at.name}`, number: item.value >> BigInt(item.high - item.low + 1 - bits) };
  });
  const differs = (one, other) => BigInt.asUintN(bits, one - other) > big(channels.tolerance)
    && BigInt.asUintN(bits, other - one) > big(channels.tolerance);
  const agree = !numbers.some(({ number }) => differs(number, numbers[0].number));
  const words = numbers.map(({ name, number }) => `${name} ${hex(number)}`).join(" and ");
  return { agree, words: said(agree ? "compared" : "compared_not", bits, words) };
}
