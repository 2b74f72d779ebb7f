// Licence 0BSD: use, modify and distribute this file without any condition.
// The mistakes in the table that would explain a wrong frame, with the same order as on the command line.

const LEAST_BITS = 3;
// Frames with fewer bits may be all zeros or all ones by coincidence.
const LEAST_STUCK = 12;
// An explanation that matches fewer random frames than one in this many is as good as certain.
const CERTAIN = 65536n;

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

/** Return the mistakes in the table that explain the frame, most likely first, each with its random frames per match. */
function explained(frame) {
  const { at, given, problems } = frame;
  const hasFault = (...kinds) => problems.some((item) => kinds.includes(item.fault));
  if (!problems.length || deadLine(frame)) return [];
  const whole = wholeFrames(frame);
  if (!at) return whole;
  if (!hasFault("crc", "length") && (at.layout.crc || !hasFault("constant"))) return [];
  const others = at.layout.crc && !hasFault("length") ? otherCrcs(frame) : [];
  const moved = given ? movedFrames(at, given) : [];
  const fitting = [...whole, ...others, ...moved].filter((one) => one.fits);
  return distinct(fitting.sort((one, other) => other.score - one.score));
}

/** Return the part that a recording without a complete frame lacks, or "". */
function missingPart(frame) {
  const { at, given, problems } = frame;
  const found = explained(frame);
  if (!given || !problems.some((item) => item.fault === "length") || deadLine(frame)) return "";
  if (found.some((one) => one.kind !== TABLE.inside[0])) return "";
  for (const [text, pattern] of lineOf(at)?.incomplete ?? []) {
    const match = matched(pattern, at, receivedBits(at, given));
    const count = match?.groups?.frame?.length ?? 0;
    if (match && count < at.bits) return filled(text, count, at.bits, at.bits - count);
  }
  return "";
}

/** Whether other frames with the same mistake would decide between these explanations. */
const anotherHelps = (found) => found.every((one) => one.kind !== "echo")
  && (found.length > 1 || (found.length === 1 && found[0].oneIn < CERTAIN));

/** Return the mistakes that explain the most of several wrong frames, most likely first. */
function judgedTogether(frames) {
  const groups = new Map();
  for (const found of frames.slice(0, TABLE.likely.frames).map(explained)) {
    const own = new Map([...found].reverse().map((one) => [`${one.kind} ${one.template}`, one]));
    for (const [key, one] of own) groups.set(key, [...groups.get(key) ?? [], one]);
  }
  const most = Math.max(0, ...[...groups.values()].map((group) => group.length));
  return [...groups.values()].filter((group) => group.length === most).map((group) => ({
    text: new Set(group.map((one) => one.text)).size === 1 ? group[0].text
      : filled(group[0].template.replace("({0}) ", ""), "some"),
    frames: most,
    oneIn: group.reduce((product, one) => product * one.oneIn, ONE),
    score: group.reduce((sum, one) => sum + Math.log2(one.score), 0),
  })).sort((one, other) => other.score - one.score);
}

const lineOf = (at) => TABLE.lines[at.family.interfaces.find((one) => one.frames?.includes(at.layout))?.line];
const matched = (pattern, at, received) => new RegExp(pattern.replace("#", at.bits)).exec(received);

/** Two mistakes that lead to the same frame match the same frames: the likelier one stays. */
function distinct(found) {
  const keys = found.map((one) => (one.number === undefined ? one.text : `${one.number} ${one.lost}`));
  return found.filter((_, place) => keys.indexOf(keys[place]) === place);
}

function otherCrcs({ at, number }) {
  const { low, width } = crcField(at);
  return at.family.crcs[at.layout.crc].others.map(([kind, text, other]) => ({
    kind, text, template: text, oneIn: ONE << BigInt(width),
    fits: computedBy(other, at, number) === bits(number, low, width),
    score: scoreOf(at, kind, number, width + (hasFixed(at, number) ? fixedBits(at) : 0)),
  }));
}

/** The likelihood of a mistake that matches: its frequency, times the improbability of the match without it. */
function scoreOf(at, kind, number, evidence, places = 1) {
  return (TABLE.likely.kinds[kind] * likelihood(at, number) * 2 ** evidence) / places;
}

/** The likelihood of the flags and reserved bits, relative to random bits. */
function likelihood(at, number) {
  const { idle, active } = TABLE.likely;
  return at.fields.reduce((product, item) => {
    const isActive = speaks(item, bits(number, item.low, item.width));
    if (isFlag(item.field)) return product * (isActive ? active : idle);
    if ("unused" in item.field) return product * (isActive ? active : idle ** item.width);
    return product;
  }, 1);
}

/** The bits as received, with those leading zeros that were typed, unless they may only pad the frame. */
function receivedBits(at, given) {
  const isPadded = given.exact || given.number >> BigInt(at.bits) === 0n;
  const size = isPadded ? given.bits : Math.max(given.written ?? 0, given.bits);
  return given.number.toString(2).padStart(size, "0");
}

/** The frames with bits around them. A frame is searched at every bit only if no rule of the line finds it. */
function movedFrames(at, given) {
  const line = lineOf(at);
  if (!line) return [];
  const lengths = given.exact || given.bits > at.bits ? [given.bits] : [at.bits, at.bits - 1];
  const received = receivedBits(at, given);
  const byRule = [
    ...lengths.flatMap((length) => line.slips.flatMap((slip) => slipped(at, given, length, slip))),
    ...line.recordings.flatMap((recording) => recorded(at, given, received, recording)),
  ];
  if (!at.layout.crc || byRule.some((one) => one.fits)) return byRule;
  const places = Math.max(received.length - at.bits + 1, 0);
  const [kind, text] = TABLE.inside;
  return [...byRule, ...[...Array(places).keys()].flatMap((place) => {
    const frame = received.slice(place, place + at.bits);
    const parts = [["before", received.slice(0, place)], ["frame", frame], ["behind", received.slice(place + at.bits)]];
    const around = { parts: parts.filter(([, some]) => some), places };
    return readAs(at, given, [kind, text, filled(text, place)], BigInt(`0b${frame}`), around);
  })];
}

/** A text that does not begin and end with the frame: extra bits before or after it, or missing bits. */
function slipped(at, given, length, [kind, text, front, missing, lost, behind]) {
  if (length !== at.bits + front.length - missing.length - lost + behind || length < given.bits) return [];
  const there = length - front.length - behind;
  const body = given.number >> BigInt(behind);
  const last = there + front.length - 1;
  const starts = [...front].flatMap((mark, place) => (mark === "1" ? [last - place] : []));
  const holds = starts.every((place) => bits(body, place, 1));
  const number = ((BigInt(`0b0${missing}`) << BigInt(there)) | bits(body, 0, there)) << BigInt(lost);
  return readAs(at, given, [kind, text, filled(text, missing)], number, { lost, demanded: starts.length, holds });
}

/** The frame in a recording with these parts. */
function recorded(at, given, received, [kind, text, pattern, proof]) {
  const groups = matched(pattern, at, received)?.groups;
  if (!groups) return [];
  const { frame, gap = "", again = "" } = groups;
  const demanded = proof.reduce((sum, name) => sum + (groups[name] ?? "").length, 0);
  const parts = Object.entries(groups).filter(([, some]) => some);
  return readAs(at, given, [kind, text, text], BigInt(`0b${frame}`),
    { demanded, parts, holds: (gap + frame).startsWith(gap + again) });
}

/** The explanation by a frame that was this number, without its last bits, or nothing if that is as sent. */
function readAs(at, given, [kind, template, text], frame, { lost = 0, demanded = 0, holds = true, parts, places = 1 }) {
  const crc = at.layout.crc && at.family.crcs[at.layout.crc];
  const completed = crc ? [frame] : [...Array(1 << lost).keys()].map((last) => frame | BigInt(last));
  const number = completed.find((one) => hasFixed(at, one)) ?? frame;
  const width = crc ? crc.width : 0;
  const known = crc ? width - lost : 0;
  const asked = known + demanded + (crc ? fixedBits(at) : Math.max(fixedBits(at) - lost, 0));
  const isAsGiven = given.number === number && !lost && given.bits <= at.bits
    && !(given.exact && given.bits !== at.bits);
  if (crc && (isAsGiven || asked < LEAST_BITS)) return [];
  const isRight = !crc || computedBy(crc, at, number) >> BigInt(lost) === bits(number, 0, width) >> BigInt(lost);
  const all = ONE << BigInt(asked);
  return [{
    kind, template, text, number, lost, parts: parts ?? [],
    oneIn: all > BigInt(places) ? all / BigInt(places) : ONE,
    fits: holds && isRight && hasFixed(at, number),
    score: scoreOf(at, kind, number, asked, places),
  }];
}

/** The bytes as whole frames of RS-485: an echo of the request, a reply after it, or several replies. */
function wholeFrames({ at, data, label, over, problems }) {
  const { most, least, echo, frames: list } = TABLE.exchanges;
  const isWrong = !at || problems.some((item) => ["crc", "length"].includes(item.fault));
  if (!label || !isWrong || data.length > most || over.name !== "rs485") return [];
  if (at && at.layout.sender !== "encoder") return [];
  const candidates = over.frames.filter((item) => item.order).map((item) => placedFor(label, item))
    .map((one) => ({ one, size: one.bits / 8, evidence: evidenceOf(one) })).filter(({ evidence }) => evidence >= least);
  const fewest = new Map([[data.length, []]]);
  for (let start = data.length - 1; start >= 0; start -= 1) {
    for (const { one, size, evidence } of candidates) {
      const rest = fewest.get(start + size);
      if (!rest || fewest.get(start)?.length <= rest.length + 1) continue;
      const bytes = data.slice(start, start + size);
      if (!decodeBytes(one, bytes).problems.length) fewest.set(start, [{ one, bytes, evidence }, ...rest]);
    }
  }
  const found = fewest.get(0) ?? [];
  const isRequest = ({ one }) => one.layout.sender === "master";
  const replies = found.filter((item) => !isRequest(item)).length;
  if (!found.length || (found.length === 1 && replies)) return [];
  const one = isRequest(found[0]) ? "bytes_in_front" : "bytes_behind";
  const kind = ["echo", one][replies] ?? "several_frames";
  const titled = found.map((item) => [`${isRequest(item) ? "request" : "reply"} ${item.one.name}`, shownBytes(item.bytes)]);
  const text = kind === "echo" ? filled(echo, found[0].one.name)
    : filled(list, titled.map(([title]) => title).join(", then "));
  const asked = found.reduce((sum, item) => sum + item.evidence, 0);
  const last = found[found.length - 1];
  const isRead = !isRequest(last) && !last.one.layout.asks?.length;
  return [{
    kind, template: text, text, at: last.one, lost: 0, parts: titled, oneIn: ONE << BigInt(asked), fits: true,
    number: isRead ? numberOf(last.one.layout.order, last.bytes) : undefined,
    score: TABLE.likely.kinds[kind] * 2 ** asked,
  }];
}

const evidenceOf = (at) => fixedBits(at) + (at.layout.crc ? at.family.crcs[at.layout.crc].width : 0);

/** The numbers in a frame, by name. */
function numbersRead(at, number) {
  const isNumber = ({ field }) => isGiven({ field }) && (field.kind === undefined || field.kind === "signed");
  const names = at.fields.filter(isNumber).map((item) => item.name);
  return decode(at, number).fields.filter((item) => names.includes(item.name)).map((item) => [item.name, item.value]);
}

/** Other readings of a position that nothing in the frame can contradict. They do not explain an error. */
function otherPositions({ at, number, problems, crc, fields }, measure) {
  const isOfBits = at && !at.layout.order && at.layout.sender === "encoder";
  const position = fields.find((item) => item.name === measure?.of);
  if (!isOfBits || problems.length || crc || typeof position?.value !== "bigint") return [];
  const parts = position.high < 0 ? at.joins.find((one) => one.name === measure.of).parts.map(({ item }) => item)
    .filter(Boolean) : [position];
  const low = Math.min(...parts.map((item) => item.low));
  const width = parts.reduce((sum, item) => sum + (item.width ?? item.high - item.low + 1), 0);
  const sent = bits(number, low, width);
  const others = number ^ (sent << BigInt(low));
  const early = (number << ONE) & ones(at.bits);
  const frames = [
    [early, early | ONE].find((one) => hasFixed(at, one)) ?? early,
    number >> ONE,
    at.gray ? null : others | (plainOf(sent) << BigInt(low)),
    at.gray ? toGray(at, number) : null,
    at.bits % 8 ? null : numberOf("big", bytesOf("little", number, at.bits / 8)),
  ];
  return frames.flatMap((frame, place) => {
    const read = frame === null ? position : decode(at, frame).fields.find((item) => item.name === measure.of);
    return read.value === position.value ? [] : [[TABLE.doubts[place], read.value]];
  });
}

const always = (at) => at.checks.filter((item) => item.check.always);

/** Return the number of bits in a frame that can have only one value. */
function fixedBits(at) {
  const open = (check) => bitLength(BigInt((check.values?.length ?? 1) - 1));
  return always(at).reduce((sum, { check, width }) => sum + width - open(check), 0);
}

const hasFixed = (at, number) => always(at).every((item) => !problemOf(item, number, number).length);
