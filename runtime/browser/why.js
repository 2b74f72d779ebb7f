// Licence 0BSD: use, modify and distribute this file without any condition.
// The mistakes in the table that would explain a wrong CRC.

const LEAST_BITS = 3;
// Frames with fewer bits may be all zeros or all ones by coincidence.
const LEAST_STUCK = 12;

/** Return the text about a dead line, or "" if the line changes. */
function deadLine({ at, given, number, data, problems, over }) {
  if (at?.layout.length !== undefined) return "";
  const exact = given?.exact ? given.bits : Math.max(at?.bits ?? 0, given?.bits ?? 0);
  const size = data ? 8 * data.length : exact;
  const found = data ? data.reduce((sum, byte) => (sum << 8n) | BigInt(byte), 0n) : given?.number ?? number;
  if (size < LEAST_STUCK || (found !== 0n && found !== ones(size))) return "";
  const level = found ? 1 : 0;
  const doubt = at?.layout.crc ? "and the CRC is correct too" : "and there is no CRC to distinguish it";
  return at && !(at.layout.crc && problems.length) ? `Every bit is ${level}. A dead line looks the same, ${doubt}.`
    : `Every bit is ${level}: the line never changes. Check for ${level ? "a broken wire" : "a short circuit"}, `
      + `the supply and ${over?.name === "rs485" ? "wires A and B" : "the clock"}.`;
}

/** Return the bits that make the frame valid if one of them is inverted: the usual cause if only some frames fail. */
function disturbedBits({ at, number, problems }) {
  if (!at?.layout.crc || problems[0]?.fault === "length" || !problems.some((item) => item.fault === "crc")) return [];
  const { low, width } = crcField(at);
  const crc = at.family.crcs[at.layout.crc];
  const fits = (one) => computedBy(crc, at, one) === bits(one, low, width) && hasFixed(at, one);
  return [...Array(at.bits).keys()].filter((bit) => fits(number ^ (ONE << BigInt(bit))));
}

/** Return the mistakes in the table that explain the CRC, each with its number of random frames per match. */
function explained(frame) {
  const { at, given, problems, number } = frame;
  if (deadLine(frame)) return [];
  if (!at?.layout.crc || !problems.some((item) => ["crc", "length"].includes(item.fault))) return [];
  const crc = at.family.crcs[at.layout.crc];
  const isWhole = problems.every((item) => item.fault !== "length");
  const found = isWhole ? crc.others.flatMap(([text, other]) => otherCrc(at, number, text, other)) : [];
  const slips = given ? TABLE.slips.flatMap((slip) => slipped(at, crc, given, slip)) : [];
  // Two mistakes that lead to the same frame match the same frames.
  const asked = slips.map((item) => `${item.number} ${item.lost}`);
  return [...found, ...slips.filter((_, place) => asked.indexOf(asked[place]) === place)];
}

function otherCrc(at, number, text, other) {
  const { low, width } = crcField(at);
  return computedBy(other, at, number) === bits(number, low, width) ? [{ text, oneIn: ONE << BigInt(width) }] : [];
}

/** Try a text that does not begin and end with the frame: extra bits before or after it, or missing bits. */
function slipped(at, crc, given, [text, front, missing, lost, behind]) {
  const length = at.bits + front.length - missing.length - lost + behind;
  const lengths = given.exact || given.bits > at.bits ? [given.bits] : [at.bits, at.bits - 1];
  if (!lengths.includes(length) || length < given.bits) return [];
  const there = length - front.length - behind;
  const body = given.number >> BigInt(behind);
  const last = there + front.length - 1;
  const starts = [...front].flatMap((mark, place) => (mark === "1" ? [last - place] : []));
  if (!starts.every((place) => bits(body, place, 1))) return [];
  const number = ((BigInt(`0b0${missing}`) << BigInt(there)) | bits(body, 0, there)) << BigInt(lost);
  const [known, fixed] = [crc.width - lost, fixedBits(at)];
  const same = given.number === number && !lost && given.bits <= at.bits;
  const fits = computedBy(crc, at, number) >> BigInt(lost) === bits(number, 0, crc.width) >> BigInt(lost);
  const asked = known + starts.length + fixed;
  if (same || !fits || asked < LEAST_BITS || !hasFixed(at, number)) return [];
  return [{ text, oneIn: ONE << BigInt(asked), number, lost }];
}

const always = (at) => at.checks.filter((item) => item.check.always);

/** Return the number of bits in a frame that can have only one value. */
function fixedBits(at) {
  const open = (check) => bitLength(BigInt((check.values?.length ?? 1) - 1));
  return always(at).reduce((sum, { check, width }) => sum + width - open(check), 0);
}

const hasFixed = (at, number) => always(at).every((item) => !problemOf(item, number, number).length);
