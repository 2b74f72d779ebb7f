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
  const doubt = at?.crc ? "and the CRC is correct too" : "and there is no CRC to distinguish it";
  // Without a CRC, the length alone proves nothing.
  const isPossible = at && (at.crc ? !problems.length : hasFixed(at, found ? ones(at.bits) : 0n));
  return isPossible ? `Every bit is ${level}. A dead line looks the same, ${doubt}.`
    : `Every bit is ${level}: the line never changes. Check for ${level ? "a broken wire" : "a short circuit"}, `
      + `the supply and ${over?.name === "rs485" ? "wires A and B" : "the clock"}.`;
}

/** Return the bits that make the frame valid if one of them is inverted: the usual cause if only some frames fail. */
function findDisturbedBits({ at, number, problems }) {
  if (!at?.crc || problems[0]?.fault === "length" || !problems.some((item) => item.fault === "crc")) return [];
  const { low, width } = crcField(at);
  const crc = at.family.crcs[at.crc];
  const fits = (one) => computedBy(crc, at, one) === bits(one, low, width) && hasFixed(at, one);
  return [...Array(at.bits).keys()].filter((bit) => fits(number ^ (ONE << BigInt(bit))));
}

/** Return the mistakes that explain the frame, most likely first, each with its random frames per match. */
const explained = (frame) => explanationsOf(frame).merged;

/**
 * Return the explanations of a frame twice: ``merged`` has one of those that lead to the same frame, ``all`` has every
 * one. ``isWithPairs`` also tries two mistakes if a single one matches.
 */
function explanationsOf(frame, isWithPairs = false) {
  const { at, given, data, problems } = frame;
  const hasFault = (...kinds) => problems.some((item) => kinds.includes(item.fault));
  const none = { merged: [], all: [] };
  if (!problems.length || deadLine(frame)) return none;
  if (data) {
    if (at && !hasFault("crc", "length", "constant")) return none;
    const tries = triesWithBytes(frame);
    return hasCrcInBytes(frame) ? chosen(tries, [], isWithPairs) : readingsOf(tries);
  }
  if (!at || !given || !hasFault("crc", "length", "constant")) return none;
  const crc = at.crc && at.family.crcs[at.crc];
  if (!crc) return readingsOf([...movedFrames(at, null, given), ...rearranged(at, null, given)]);
  const failed = given.bits > at.bits || (given.exact && given.bits !== at.bits) ? [] : [asSent(at, crc, given.number)];
  if (hasFault("crc", "length")) return chosen(triesWithBits(at, crc, given), failed, isWithPairs);
  const moved = [...rearranged(at, crc, given), ...movedFrames(at, crc, given)].filter(fits);
  const fitting = significant(moved, failed);
  return fitting.length ? chosen(fitting, [], isWithPairs) : none;
}

/** Whether any frame in bytes from the sender has a CRC. */
const hasCrcInBytes = ({ label, over, sender }) => !label
  || over.frames.some((item) => item.order && item.sender === sender && item.crc);

/** Return the part that a recording without a complete frame lacks, or "". */
function missingPart(frame) {
  const { at, given, problems } = frame;
  if (!given || !problems.some((item) => item.fault === "length") || deadLine(frame) || mayHave(given, at.bits)) return "";
  const crc = at.crc && at.family.crcs[at.crc];
  const isFound = (one) => one.kind !== TABLE.inside[0] && fits(one) && (!crc || one.known + one.demanded >= LEAST_BITS);
  if (movedFrames(at, crc, given).some(isFound)) return "";
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

/** Return the mistakes that explain the most of several wrong frames, most likely first: single ones, or else two. */
function judgedTogether(frames) {
  const isBroken = ({ problems }) => problems.some((item) => item.fault === "crc" || item.fault === "length");
  const found = frames.slice(-TABLE.likely.frames).map((frame) => ({ frame, all: explanationsOf(frame).all }))
    .filter(({ frame, all }) => all.length || isBroken(frame));
  const single = common(found.map(({ all }) => all));
  if (single.length && single[0].frames === found.length) return single;
  return common(found.map(({ frame }) => explanationsOf(frame, true).all));
}

/** The logarithm of the likelihood. A mistake is made once, so its frequency counts once. */
function commonScore(group) {
  const frequency = Math.log2(TABLE.likely.kinds[group[0].kind]);
  return group.reduce((sum, one) => sum + (Math.log2(one.score) - frequency), 0) + frequency;
}

function common(lists) {
  const groups = new Map();
  for (const found of lists) {
    const own = new Map([...found].reverse().map((one) => [`${one.kind} ${one.template} ${one.isTwice}`, one]));
    for (const [key, one] of own) groups.set(key, [...groups.get(key) ?? [], one]);
  }
  const most = Math.max(0, ...[...groups.values()].map((group) => group.length));
  return [...groups.values()].filter((group) => group.length === most).map((group) => ({
    text: new Set(group.map((one) => one.text)).size === 1 ? group[0].text
      : filled(group[0].template.replace("({0}) ", ""), "some"),
    frames: most,
    oneIn: group.reduce((product, one) => product * one.oneIn, ONE),
    score: commonScore(group),
  })).sort((one, other) => other.score - one.score);
}

const interfaceOf = (at) => at.family.interfaces.find((one) => one.frames?.includes(at.layout));
const lineOf = (at) => TABLE.lines[interfaceOf(at)?.line];
const matched = (pattern, at, received) => new RegExp(pattern.replace("#", at.bits)).exec(received);

// -- tries

/** A mistake, tried, with the members that its kind needs. Those are the members of the same name on the command line. */
const tryOf = (members) => ({
  template: members.text, data: 0n, size: 0, received: 0n, known: 0, demanded: 0, holds: true, fixed: 0, likelihood: 1,
  lost: 0, parts: [], places: 1, ...members,
});

/** Whether a frame with the mistake has these bits: the ones that it determines, and the CRC. */
function fits({ crc, holds, isOfBytes, data, size, known, received }) {
  if (!holds || !crc) return holds;
  const computed = isOfBytes ? crcOfBytes(crc, bytesOf("big", data, size / 8)) : crcOfBits(crc, data, size);
  return computed >> BigInt(crc.width - known) === received;
}

const oneInOf = ({ known, demanded, places }) => {
  const all = ONE << BigInt(known + demanded);
  return all > BigInt(places) ? all / BigInt(places) : ONE;
};
const scoreOf = ({ kind, known, demanded, fixed, likelihood: likely, places }) => (
  TABLE.likely.kinds[kind] * likely * 2 ** (known + Math.max(demanded, fixed))) / places;

/** The key of a try. Tries with the same key match the same frames. */
function questionOf({ crc, data, size, received, known }) {
  const own = crc && ["width", "poly", "init", "refin", "refout", "xorout"].map((name) => `${big(crc[name])}`).join(" ");
  return `${own} ${data} ${crc && big(crc.init) ? size : 0} ${received} ${known}`;
}

/** The tries that do not match too many random frames, without those known to fail. */
function significant(tries, failed) {
  const questions = new Set(failed.map(questionOf));
  return tries.filter((one) => one.known + one.demanded >= LEAST_BITS && !questions.has(questionOf(one)));
}

/** One of the tries that lead to the same frame. */
function distinct(tries) {
  const kept = new Map();
  for (const one of tries) {
    const places = one.at && [one.at.bits, ...one.at.fields.map((item) => `${item.name} ${item.low}`)].join(" ");
    const key = `${questionOf(one)} ${one.at ? `${one.number} ${places}` : one.text}`;
    const earlier = kept.get(key);
    const isBetter = !earlier || (one.holds === earlier.holds ? scoreOf(one) > scoreOf(earlier) : one.holds);
    if (isBetter) kept.set(key, one);
  }
  return [...kept.values()];
}

const explanationOf = (one, isTwice = false) => ({ ...one, isTwice, oneIn: oneInOf(one), score: scoreOf(one) });
const byScore = (found) => found.sort((one, other) => other.score - one.score);

/** The explanations among tries with a CRC. Pairs are tried if no single mistake matches. */
function chosen(tries, failed, isWithPairs) {
  const significantTries = significant(tries, failed);
  const usable = significantTries.filter((one) => !one.isRepeated);
  const single = distinct(usable);
  const merged = single.filter(fits).map((one) => explanationOf(one));
  const all = significantTries.filter(fits).map((one) => explanationOf(one));
  if (isWithPairs || merged.every((one) => one.kind === TABLE.inside[0])) {
    const pairs = significant(usable.filter((one) => one.crc && !["crc_not_inverted", TABLE.inside[0]].includes(one.kind))
      .map(notInverted), failed);
    const twice = (found) => found.filter(fits).map((one) => explanationOf(one, true));
    merged.push(...twice(distinct([...single, ...pairs]).slice(single.length)));
    all.push(...twice(pairs));
  }
  return { merged: byScore(merged), all: byScore(all) };
}

function notInverted(one) {
  const change = big(one.crc.xorout) ? "not_inverted_too" : "inverted_too";
  const template = filled(TABLE.texts[change], one.template);
  const crc = { ...one.crc, xorout: big(one.crc.xorout) ^ ones(one.crc.width) };
  return { ...one, crc, template, text: filled(TABLE.texts[change], one.text) };
}

/** The readings of a frame without a CRC. Nothing proves one of them. */
function readingsOf(tries) {
  const all = byScore(tries.filter(fits).map((one) => explanationOf(one)));
  const numbers = all.map((one) => one.number);
  return { all, merged: all.filter((one, place) => numbers.indexOf(one.number) === place) };
}

/** The bits that the CRC covers, and how many they are. */
function coveredBy(at, number) {
  const { width } = crcField(at);
  const [low, count] = at.layout.crc_of ?? [width, at.bits - width];
  return { data: bits(number, low, count), size: count };
}

/** The frame as sent, to which the caller adds the mistake. */
function asSent(at, crc, number) {
  return tryOf({
    crc, ...coveredBy(at, number), received: bits(number, 0, crc.width), known: crc.width,
    fixed: hasFixed(at, number) ? fixedBits(at) : 0, likelihood: likelihood(at, number), text: "",
  });
}

/** The frame was this number, whose last bits were not received. */
function readAs(at, crc, kind, text, frame, { lost = 0, demanded = 0, holds = true, ...others } = {}) {
  if (!crc) {
    const completed = [...Array(1 << lost).keys()].map((last) => frame | BigInt(last));
    const number = completed.find((one) => hasFixed(at, one)) ?? frame;
    return tryOf({
      kind, text, at, number, lost, data: number, size: at.bits, likelihood: likelihood(at, number),
      demanded: demanded + Math.max(fixedBits(at) - lost, 0), holds: holds && hasFixed(at, number), ...others,
    });
  }
  return tryOf({
    kind, text, crc, at, number: frame, lost, ...coveredBy(at, frame), likelihood: likelihood(at, frame),
    received: bits(frame, 0, crc.width) >> BigInt(lost), known: crc.width - lost,
    demanded: demanded + fixedBits(at), holds: holds && hasFixed(at, frame), ...others,
  });
}

// -- frames of bits

const lengthsOf = (at, given) => (given.exact || given.bits > at.bits ? [given.bits] : [at.bits, at.bits - 1])
  .filter((length) => length >= given.bits);
const mayHave = (given, count) => (given.exact ? given.bits === count : given.bits <= count);
const isStatus = ({ field, width }) => isFlag(field) || ("unused" in field && Boolean(big(field.unused)) && width === 1);

/** Every single mistake that could have turned a valid frame into this one. */
function triesWithBits(at, crc, given) {
  const others = lengthsOf(at, given).includes(at.bits) ? otherCrcs(at, crc, given.number) : [];
  const moved = [...others, ...rearranged(at, crc, given), ...movedFrames(at, crc, given)];
  if (at.layout.crc_of) return moved;
  return [...moved, ...withoutStatus(at, crc, given), ...otherPolynomials(at, crc, given)];
}

/** The frame as sent with another CRC. */
function otherCrcs(at, crc, number) {
  const sent = asSent(at, crc, number);
  const other = (kind, text, members) => ({ ...sent, kind, text, template: text, ...members });
  const found = (crc.others ?? []).map(([kind, text, parameters]) => other(kind, text, { crc: parameters }));
  found.push(other("crc_reversed", TABLE.texts.crc_reversed, { received: reflected(sent.received, crc.width) }));
  if (at.layout.crc_of) return found;
  const starts = interfaceOf(at)?.name === "biss" ? TABLE.start_bits : [];
  return [...found, ...statusOtherwise(at, sent, number, other), ...positionOtherwise(at, sent, number, other),
    ...starts.map(([front, text]) => other("start_bits_in_crc", text, {
      data: (BigInt(`0b${front}`) << BigInt(sent.size)) | sent.data, size: sent.size + front.length }))];
}

const statusMask = (at) => at.fields.filter(isStatus).reduce((mask, { low, width }) => mask | (ones(width) << BigInt(low)), 0n);

/** The CRC does not cover error and warning, or they were inverted. */
function statusOtherwise(at, sent, number, other) {
  const mask = statusMask(at);
  if (!mask) return [];
  const width = BigInt(sent.known);
  const kept = [...Array(sent.size).keys()].reverse().filter((bit) => !bits(mask >> width, bit, 1));
  const left = kept.reduce((made, bit) => (made << ONE) | bits(sent.data, bit, 1), 0n);
  return [
    other("status_left_out", TABLE.texts.status_left_out, { data: left, size: kept.length }),
    other("status_turned", TABLE.texts.status_turned, {
      data: (number ^ mask) >> width, likelihood: likelihood(at, number ^ mask) }),
  ];
}

/** The place of the number that a master would convert from Gray code. */
function convertedPlace({ layout, fields, joins, family, parameters }) {
  if (layout.gray) {
    return { low: Number(value(layout.gray.low ?? 0, parameters)), width: Number(value(layout.gray.width, parameters)) };
  }
  const parts = joins[0]?.parts.map(({ item }) => item).filter(Boolean);
  if (parts) {
    const width = parts.reduce((sum, item) => sum + item.width, 0);
    return { low: parts[0]?.low ?? 0, width };
  }
  const isNumber = ({ field }) => isGiven({ field }) && (field.kind === undefined || field.kind === "signed");
  return fields.filter(isNumber).reduce((widest, item) => (item.width > widest.width ? item : widest), { low: 0, width: 0 });
}

/** The position is in Gray code but the CRC covers binary, or vice versa. */
function positionOtherwise(at, sent, number, other) {
  const { low, width } = convertedPlace(at);
  if (!width) return [];
  const position = bits(number, low, width);
  const without = number ^ (position << BigInt(low));
  const covers = (converted, text) => other("other_code", text, {
    data: (without | (converted << BigInt(low))) >> BigInt(sent.known) });
  return [covers(plainOf(position), TABLE.texts.covers_binary),
    covers(position ^ (position >> ONE), TABLE.texts.covers_gray)];
}

/** All bits are inverted, or the bits or bytes are in another order. */
function rearranged(at, crc, given) {
  const read = (kind, frame, members) => readAs(at, crc, kind, TABLE.texts[kind], frame, members);
  const found = [];
  if (lengthsOf(at, given).includes(at.bits)) {
    found.push(read("all_inverted", given.number ^ ones(at.bits)), read("bits_reversed", reflected(given.number, at.bits)));
    if (at.bits % 8 === 0) {
      const bytes = bytesOf("big", given.number, at.bits / 8);
      found.push(read("bits_reversed_in_bytes", numberOf("big", bytes.map((byte) => reflected(BigInt(byte), 8)))));
    }
  }
  const moved = (kind, unit, move) => {
    const filledBits = Math.ceil(at.bits / unit) * unit;
    const isWhole = given.bits % 8 === 0 && (given.bits === at.bits || given.bits === filledBits);
    if (given.number >> BigInt(filledBits) || (given.exact && !isWhole)) return;
    const swapped = numberOf("big", move(bytesOf("big", given.number, filledBits / 8)));
    const frame = bits(swapped, 0, at.bits);
    found.push(read(kind, frame, { demanded: filledBits - at.bits, holds: frame === swapped }));
  };
  moved("bytes_reversed", 8, (bytes) => bytes.reverse());
  if (at.bits > 16) moved("words_swapped", 16, (bytes) => bytes.map((_, place) => bytes[place ^ 1]));
  return found;
}

/** Error and warning are missing: removed after the CRC was computed, or before. */
function withoutStatus(at, crc, given) {
  const mask = statusMask(at);
  const count = onesIn(mask);
  const short = at.bits - count;
  if (!mask || mask >> BigInt(crc.width) !== ones(count) || !mayHave(given, short)) return [];
  const idle = at.fields.filter((item) => isStatus(item) && (item.field.kind === "not_flag" || "unused" in item.field))
    .reduce((set, { low, width }) => set | (ones(width) << BigInt(low)), 0n);
  const data = given.number >> BigInt(crc.width);
  const received = bits(given.number, 0, crc.width);
  const frame = (data << BigInt(crc.width + count)) | idle | received;
  const asIdle = readAs(at, crc, "status_not_sent", TABLE.texts.removed_and_idle, frame);
  if (!given.exact) return [asIdle];
  return [asIdle, tryOf({ kind: "status_not_sent", text: TABLE.texts.removed, crc, data, size: short - crc.width,
    received, known: crc.width, likelihood: likelihood(at, frame), number: frame, at })];
}

/** Data of the right length before a CRC of another length: complete, truncated, or followed by zeros. */
function otherPolynomials(at, crc, given) {
  const size = at.bits - crc.width;
  return TABLE.polynomials.flatMap((polynomial) => {
    const whole = big(polynomial);
    const width = bitLength(whole) - 1;
    if (whole === (big(crc.poly) | (ONE << BigInt(crc.width)))) return [];
    const all = (number) => (big(number) ? ones(width) : 0n);
    const other = { ...crc, width, poly: whole & ones(width), init: all(crc.init), xorout: all(crc.xorout) };
    const lengths = [...new Set([size + width, at.bits])];
    return lengths.filter((length) => length === given.bits || (!given.exact && length > given.bits))
      .map((length) => ofLength(at, crc, other, given.number, length, size));
  });
}

function ofLength(at, crc, other, number, length, size) {
  const after = length - size;
  const [data, tail] = [number >> BigInt(after), bits(number, 0, after)];
  const known = Math.min(other.width, after);
  const zeros = Math.max(after - other.width, 0);
  const frame = data << BigInt(crc.width);
  const isRight = hasFixed(at, frame);
  const polynomial = filled(TABLE.texts.polynomial, hex(other.poly | (ONE << BigInt(other.width))), other.width);
  const text = known < other.width ? filled(TABLE.texts.bits_arrived, polynomial, known)
    : zeros ? filled(TABLE.texts.then_zeros, polynomial) : polynomial;
  const isAsLong = length === at.bits;
  return tryOf({
    kind: "other_polynomial", text, crc: other, data, size, received: tail >> BigInt(zeros), known,
    demanded: zeros + (isAsLong ? 0 : fixedBits(at)), holds: !bits(tail, 0, zeros) && (isAsLong || isRight),
    fixed: zeros + (isRight ? fixedBits(at) : 0), likelihood: likelihood(at, frame),
  });
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
function movedFrames(at, crc, given) {
  const line = lineOf(at);
  if (!line) return [];
  const received = receivedBits(at, given);
  const echo = [...(mayHave(given, at.bits) ? echoes(at, given.number) : []), ...withCommand(at, crc, given)];
  const byRule = [
    ...lengthsOf(at, given).flatMap((length) => line.slips.flatMap((slip) => slipped(at, crc, given, length, slip))),
    ...line.recordings.flatMap((recording) => recorded(at, crc, received, recording)),
  ];
  if (!crc || byRule.some(fits)) return [...echo, ...byRule];
  const places = Math.max(received.length - at.bits + 1, 0);
  const [kind, template] = TABLE.inside;
  return [...echo, ...byRule, ...[...Array(places).keys()].map((place) => {
    const frame = received.slice(place, place + at.bits);
    const parts = [["before", received.slice(0, place)], ["frame", frame], ["behind", received.slice(place + at.bits)]];
    const around = { template, parts: parts.filter(([, some]) => some), places };
    return readAs(at, crc, kind, filled(template, place), BigInt(`0b${frame}`), around);
  })];
}

/** The bits during the command are missing, and the command is the one that the layout expects. */
function withCommand(at, crc, given) {
  if (interfaceOf(at)?.name !== "spi") return [];
  const [low, count] = crc ? at.layout.crc_of ?? [crc.width, at.bits - crc.width] : [0, at.bits];
  const isDuring = (item) => "fixed" in item.field || item.low >= low + count;
  const fields = [...at.fields].sort((one, other) => other.low - one.low);
  const end = fields.findIndex((item) => !isDuring(item));
  const first = fields.slice(0, end < 0 ? fields.length : end);
  const rest = first.at(-1)?.low ?? at.bits;
  if (rest === at.bits || (at.bits - rest) % 8 || !mayHave(given, rest) || given.written !== rest) return [];
  const constants = first.filter(({ field }) => "fixed" in field);
  const number = constants.reduce((sum, item) => sum | (big(item.field.fixed) << BigInt(item.low)), given.number);
  const text = filled(TABLE.texts.command_left_out, at.bits - rest);
  const assumed = constants.reduce((sum, { width }) => sum + width, 0);
  return [{ ...readAs(at, crc, "command_left_out", text, number), demanded: fixedBits(at) - assumed }];
}

/** A text that does not begin and end with the frame: extra bits before or after it, or missing bits. */
function slipped(at, crc, given, length, [kind, template, front, missing, lost, behind]) {
  if (length !== at.bits + front.length - missing.length - lost + behind) return [];
  const there = length - front.length - behind;
  const body = given.number >> BigInt(behind);
  const last = there + front.length - 1;
  const starts = [...front].flatMap((mark, place) => (mark === "1" ? [last - place] : []));
  const holds = starts.every((place) => bits(body, place, 1));
  const number = ((BigInt(`0b0${missing}`) << BigInt(there)) | bits(body, 0, there)) << BigInt(lost);
  const members = { template, lost, demanded: starts.length, holds };
  const one = readAs(at, crc, kind, filled(template, missing), number, members);
  const { idle, active } = TABLE.likely;
  const mostlyZero = [...front].flatMap((mark, place) => (mark === "~" ? [bits(body, last - place, 1)] : []));
  const frontLikelihood = mostlyZero.reduce((product, bit) => product * (bit ? active : idle), 1);
  return [{ ...one, likelihood: one.likelihood * frontLikelihood }];
}

/** The frame in a recording with these parts. */
function recorded(at, crc, received, [kind, text, pattern, proof]) {
  const groups = matched(pattern, at, received)?.groups;
  if (!groups) return [];
  const { frame, again = "" } = groups;
  const demanded = proof.reduce((sum, name) => sum + (groups[name] ?? "").length, 0);
  const parts = Object.entries(groups).filter(([, some]) => some);
  return [readAs(at, crc, kind, text, BigInt(`0b${frame}`), { demanded, parts, holds: frame.startsWith(again) })];
}

// -- frames of bytes

/** The most extra bytes that come from an echoed request. */
const MOST_ECHOED = 4;

/** Every single mistake that could have turned a valid frame into these bytes. */
function triesWithBytes(frame) {
  const { at: expected, data, label, over, sender } = frame;
  const whole = wholeFrames(frame);
  const layouts = label ? over.frames : [];
  // Where the manual is ambiguous, the first answer decides, as on the command line.
  const answers = Object.fromEntries((label?.family.alternatives ?? []).map((item) => [item.name, item.answers[0][0]]));
  const moved = layouts.filter((layout) => layout.order && layout.sender === sender).flatMap((layout) => {
    const at = placedFor(label, layout, {}, answers);
    const crc = at.crc ? at.family.crcs[at.crc] : null;
    if (crc && crc.width !== 8) return [];
    const isExpected = expected?.layout === layout && 8 * data.length === at.bits;
    return [...(crc && isExpected ? otherByteCrcs(at, crc, data) : []), ...movedBytes(at, crc, data)];
  });
  // Whole frames already explain extra bytes around the same frame.
  const isRepeated = (one) => ["bytes_in_front", "bytes_behind"].includes(one.kind)
    && whole.some(({ at, number }) => number === one.number && at.layout === one.at.layout);
  return [...whole, ...moved.map((one) => ({ ...one, isRepeated: isRepeated(one) }))];
}

const asBytes = (data) => numberOf("big", data);
const overBytes = (one, data) => ({ ...one, data: asBytes(data.slice(0, -1)), received: BigInt(data.at(-1)), isOfBytes: true });

/** The frame as sent with another CRC. */
function otherByteCrcs(at, crc, data) {
  const sent = overBytes(asSent(at, crc, numberOf(at.layout.order, data)), data);
  const text = TABLE.texts.first_byte_left_out;
  return [
    ...(crc.byte_others ?? []).map(([kind, words, other]) => ({ ...sent, kind, text: words, template: words, crc: other })),
    { ...sent, kind: "first_byte_left_out", text, template: text, data: asBytes(data.slice(1, -1)), size: sent.size - 8 },
  ];
}

/** The bytes do not begin and end with the frame, or are inverted. */
function movedBytes(at, crc, data) {
  const { texts } = TABLE;
  const size = at.bits / 8;
  const read = (kind, text, frame, template = text) => {
    const one = readAs(at, crc, kind, text, numberOf(at.layout.order, frame), { template });
    return crc ? overBytes(one, frame) : one;
  };
  const extra = data.length - size;
  const found = [];
  if (extra > 0 && extra <= MOST_ECHOED) {
    const bytes = extra > 1 ? filled(texts.extra_bytes, extra) : texts.extra_byte;
    found.push(read("bytes_in_front", filled(texts.before, bytes), data.slice(extra)),
      read("bytes_behind", filled(texts.after, bytes), data.slice(0, size)));
  }
  if (extra === 0 || extra === -1) {
    for (const byte of firstBytes(at)) {
      const [text, template] = [byte.toString(16).toUpperCase().padStart(2, "0"), "{0}"]
        .map((name) => filled(texts.byte_missing, name)).map((words) => (extra ? words : filled(texts.and_follows, words)));
      found.push(read("first_byte_lost", text, [byte, ...data.slice(0, size - 1)], template));
    }
  }
  if (extra === 0) found.push(read("all_inverted", texts.bytes_inverted, data.map((byte) => byte ^ 0xFF)));
  return found;
}

/** The possible first bytes of a frame, if that byte only has the selector, constants, parity and usual values. */
function firstBytes(at) {
  const { order, selector, selects = [], usual = [] } = at.layout;
  const mask = numberOf(order, [0xFF, ...Array(at.bits / 8 - 1).fill(0)]);
  const first = at.fields.filter(({ low, width }) => bits(mask >> BigInt(low), 0, width));
  const usualOf = ({ name }) => usual.find((one) => one[0] === name && one.length === 2)?.[1];
  const others = first.filter((item) => item.name !== selector && !("parity" in item.field));
  if (!others.every((item) => "fixed" in item.field || usualOf(item) !== undefined)) return [];
  const put = (number, { low }, content) => number | (big(content) << BigInt(low));
  const start = others.reduce((number, item) => put(number, item, item.field.fixed ?? usualOf(item)), 0n);
  const chosen_ = first.filter((item) => item.name === selector);
  return (chosen_.length ? selects : [0]).map((selected) => {
    let number = chosen_.reduce((sum, item) => put(sum, item, selected), start);
    for (const item of first.filter(({ field }) => "parity" in field)) {
      const { of, check } = at.checks.find((one) => one.of && one.check.field === item.name);
      number = put(number, item, parityOf(number, of, check));
    }
    return bytesOf(order, number, at.bits / 8)[0];
  });
}

/** The bytes as whole frames of RS-485: an echo of the request, a reply after it, or several replies. */
function wholeFrames({ data, label, over, sender }) {
  const { most, least, echo, frames: list } = TABLE.exchanges;
  if (!label || data.length > most || over.name !== "rs485") return [];
  if (sender !== "encoder") return [];
  const candidates = over.frames.filter((item) => item.order).map((item) => placedFor(label, item))
    .map((one) => ({ one, size: one.bits / 8 }));
  const fewest = new Map([[data.length, []]]);
  const isRequest = ({ one }) => one.layout.sender === "master";
  for (let start = data.length - 1; start >= 0; start -= 1) {
    // A request is in front of its reply, even if both have the same form.
    const likely = candidates.filter((item) => isRequest(item) === (start === 0));
    for (const { one, size } of [...likely, ...candidates.filter((item) => !likely.includes(item))]) {
      const rest = fewest.get(start + size);
      if (!rest || fewest.get(start)?.length <= rest.length + 1) continue;
      const bytes = data.slice(start, start + size);
      const evidence = expectedBits(one, numberOf(one.layout.order, bytes));
      if (evidence && !decodeBytes(one, bytes).problems.length) fewest.set(start, [{ one, bytes, evidence }, ...rest]);
    }
  }
  const found = fewest.get(0) ?? [];
  const replies = found.filter((item) => !isRequest(item)).length;
  if (!found.length || (found.length === 1 && replies)) return [];
  const asked = found.reduce((sum, item) => sum + item.evidence, 0);
  if (asked < least) return [];
  const one = isRequest(found[0]) ? "bytes_in_front" : "bytes_behind";
  const kind = ["echo", one][replies] ?? "several_frames";
  const titled = found.map((item) => [`${isRequest(item) ? "request" : "reply"} ${item.one.name}`, shownBytes(item.bytes)]);
  const roles = titled.map(([title]) => title.split(" ")[0]);
  const [text, template] = kind === "echo" ? [` ${found[0].one.name}`, ""].map((name) => filled(echo, name))
    : [titled.map(([title]) => title), roles].map((names) => filled(list, names.join(", then ")));
  const last = found[found.length - 1];
  const isRead = !isRequest(last) && !last.one.layout.asks?.length;
  return [tryOf({
    kind, text, template, at: last.one, parts: titled, demanded: asked, data: asBytes(data), size: 8 * data.length,
    number: isRead ? numberOf(last.one.layout.order, last.bytes) : undefined,
  })];
}

/** The number of bits in a valid frame that have the value to expect: CRC, constants, and fields with a usual value. */
function expectedBits(at, number) {
  const usual = (at.layout.usual ?? []).reduce((sum, [name, ...values]) => {
    const item = at.fields.find((one) => one.name === name);
    const isUsual = item && values.some((one) => big(one) === bits(number, item.low, item.width));
    return sum + (isUsual ? item.width - bitLength(BigInt(values.length - 1)) : 0);
  }, 0);
  return fixedBits(at) + usual + (at.crc ? at.family.crcs[at.crc].width : 0);
}

/** The request of SPI that a word from the encoder equals, with the most expected bits, or undefined. */
function echoedRequest(at, number) {
  const over = interfaceOf(at);
  if (over?.name !== "spi" || at.layout.sender !== "encoder" || number >> BigInt(at.bits)) return undefined;
  // Bits that a reply has too are no evidence of an echo, such as the command on a shared line.
  const isRepeated = ({ field }) => "fixed" in field || "unused" in field;
  const repeated = at.fields.filter(isRepeated).reduce((sum, { width }) => sum + width, 0);
  const hasDocumented = (one) => one.fields.every((item) => !("unused" in item.field)
    || bits(number, item.low, item.width) === (big(item.field.unused) & ones(item.width)));
  const requests = over.frames.filter((item) => item.sender === "master" && !item.order)
    .map((item) => placed(at.family, item, at.parameters))
    .filter((one) => one.bits === at.bits && !decode(one, number).problems.length && hasDocumented(one))
    .map((one) => ({ name: one.name, size: one.bits, evidence: expectedBits(one, number) - repeated }))
    .filter(({ evidence }) => evidence >= TABLE.exchanges.least_in_word);
  return requests.sort((one, other) => other.evidence - one.evidence)[0];
}

/** A word of SPI that is the request that the master sent. */
function echoes(at, number) {
  const request = echoedRequest(at, number);
  if (!request) return [];
  const text = filled(TABLE.exchanges.word_echo, ` ${request.name}`);
  const template = filled(TABLE.exchanges.word_echo, "");
  return [tryOf({ kind: "echo", text, template, data: number, size: request.size, demanded: request.evidence })];
}

/** The name of the request that a valid word also is, or "". */
function ownRequest({ at, number, problems }) {
  if (!at || at.layout.order || at.layout.sender !== "encoder" || problems.length) return "";
  return echoedRequest(at, number)?.name ?? "";
}

/** The numbers in a frame, by name. */
function numbersRead(at, number) {
  // Bytes can be a frame of any layout, and no choice is made where the manual leaves their reading open.
  const open = at.layout.order ? (at.family.alternatives ?? []).flatMap((item) => Object.keys(item.answers[0][2])) : [];
  const isOpen = ({ low }) => Array.isArray(low) && low.slice(1).some((term) => term.slice(1)
    .some((name) => open.includes(name.replace("^", ""))));
  const isNumber = ({ field }) => isGiven({ field }) && !isOpen(field)
    && (field.kind === undefined || field.kind === "signed");
  const names = at.fields.filter(isNumber).map((item) => item.name);
  return decode(at, number).fields.filter((item) => names.includes(item.name)).map((item) => [item.name, item.value]);
}

/** The name of the position, which an encoder in one line has even if it does not state its counts. */
const positionNameOf = (measure) => measure?.of ?? "position";

/** The frames in a word of SSI with more typed bits than the frame, if its leading zeros were received. */
function recordedFrames(at, given) {
  const interface_ = interfaceOf(at);
  if (interface_?.name !== "ssi" || !given || given.exact || given.written <= at.bits) return [];
  const received = given.number.toString(2).padStart(given.written, "0");
  const found = TABLE.lines[interface_.line].recordings.flatMap((recording) => recorded(at, null, received, recording))
    .filter(fits);
  const numbers = [given.number, ...found.map((one) => one.number)];
  return found.filter((one, place) => numbers.indexOf(one.number) === place + 1)
    .map((one) => [`if ${one.text}`, one.number]);
}

/** Other readings of a position that nothing in the frame can contradict. They do not explain an error. */
function otherPositions({ at, number, problems, crc, fields, given }, measure) {
  const isOfBits = at && !at.layout.order && at.layout.sender === "encoder";
  const name = positionNameOf(measure);
  const position = fields.find((item) => item.name === name);
  if (!isOfBits || problems.length || crc || typeof position?.value !== "bigint") return [];
  const parts = position.high < 0 ? at.joins.find((one) => one.name === name).parts.map(({ item }) => item)
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
  const readings = [...frames.map((frame, place) => [TABLE.doubts[place], frame]), ...recordedFrames(at, given)];
  return readings.flatMap(([text, frame]) => {
    const read = frame === null ? position : decode(at, frame).fields.find((item) => item.name === name);
    return read.value === position.value ? [] : [[text, read.value]];
  });
}

const always = (at) => at.checks.filter((item) => item.check.always);

/** Return the number of bits in a frame that can have only one value. */
function fixedBits(at) {
  const open = (check) => bitLength(BigInt((check.values?.length ?? 1) - 1));
  return always(at).reduce((sum, { check, width }) => sum + width - open(check), 0);
}

const hasFixed = (at, number) => always(at).every((item) => !problemOf(item, number, number).length);
