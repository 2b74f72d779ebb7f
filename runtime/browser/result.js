// Licence 0BSD: use, modify and distribute this file without any condition.
// Display of a decoded frame or register. Text of specs is only ever inserted as text.

const CLASS = "codewheel-decode";

/** An element with attributes and children, without empty ones. */
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, item] of Object.entries(attributes)) {
    if (item !== undefined && item !== false) made.setAttribute(name, item === true ? "" : item);
  }
  made.append(...children.flat().filter((child) => child !== "" && child !== null && child !== undefined));
  return made;
}

const part = (tag, name, ...children) => element(tag, { class: `${CLASS}-${name}` }, ...children);
const list = (items) => element("ul", {}, items.map((item) => element("li", {}, item)));
const capital = (text) => text[0].toUpperCase() + text.slice(1);
const sentence = (text) => (/[.!?:]$/.test(text) ? text : `${text}.`);

/** The place of a field in readable form: bits of a word, or bytes of a frame from 0. */
function placeOf(at, { high, low }) {
  if (high < 0) return "";
  const range = (from, to) => (from === to ? `${from}` : `${from}:${to}`);
  if (!at.layout.order) return range(high, low);
  const bits = [low, high].sort((one, other) => byteOf(at, one) - byteOf(at, other));
  const ends = bits.map((bit) => byteOf(at, bit));
  const isWhole = low % 8 === 0 && high % 8 === 7;
  if (ends[0] === ends[1]) return `byte ${ends[0]}${isWhole ? "" : `.${range(high % 8, low % 8)}`}`;
  return isWhole ? `bytes ${ends[0]}-${ends[1]}` : `bytes ${ends[0]}.${bits[0] % 8}-${ends[1]}.${bits[1] % 8}`;
}

const shownValue = (item) => (item === true ? "yes" : item === false ? "no" : `${item}`);

/** The meaning of a field, and for a number in Gray code also how it was sent. */
function meaningOf({ gray, joins }, { name, high, low, raw, value, meaning }) {
  const isInside = (from, to) => gray && from >= gray.low && to < gray.low + gray.width;
  const parts = joins.find((one) => one.name === name)?.parts.map(({ item }) => item).filter(Boolean) ?? [];
  const isGray = high < 0 ? parts.length > 0 && parts.every((item) => isInside(item.low, item.low + item.width - 1))
    : isInside(low, high);
  if (!isGray || typeof value !== "bigint") return meaning;
  const words = said("gray", hex(raw), hex(value));
  return meaning ? `${sentence(meaning)} ${capital(words)}` : words;
}

/** A value with its unit, or a number with the quantity that it stands for. */
function inUnits(item) {
  const shown = shownValue(item.value);
  if (typeof item.value === "boolean" || !(item.scale || item.unit)) return shown;
  return item.scale ? `${shown} (${quantityOf(item.scale, item.value)})` : `${shown} ${item.unit}`;
}

/** A name that may wrap after each of its words. */
const breakable = (name) => name.split("_").flatMap((word, place) => (place ? ["_", element("wbr"), word] : [word]));

function fieldTable(found) {
  const rows = found.fields.map((item) => {
    const isOneBit = item.high >= 0 && item.high === item.low;
    const raw = part("span", "raw", isOneBit ? `${item.raw}` : hex(item.raw));
    return element("tr", {},
      element("td", {}, placeOf(found.at, item)),
      element("th", { scope: "row" }, breakable(item.name), part("span", "meaning", meaningOf(found.at, item))),
      element("td", {}, inUnits(item), raw));
  });
  const heads = ["Place", "Field", "Value, raw"].map((text) => element("th", { scope: "col" }, text));
  const size = found.at.layout.order ? counted(found.at.bits / 8, "byte") : counted(found.at.bits, "bit");
  return element("table", {},
    element("caption", {}, `${found.at.layout.title}, ${size}`, found.at.layout.source
      ? part("span", "source", `, manual ${found.at.layout.source}`) : ""),
    element("thead", {}, element("tr", {}, heads)), element("tbody", {}, rows));
}

/** The position in degrees or micrometres if it is usable, or the angle of a frame with only an angle. */
function measured(found, measure) {
  if (!measure || !found.verdict || found.verdict === "not_usable") return "";
  const number = (name) => found.fields.find((item) => item.name === name && typeof item.value === "bigint");
  const entry = number(measure.of) ?? number(measure.part);
  if (!entry) return "";
  const of = (item) => (item === undefined ? 0n : value(item, found.at.parameters));
  const [step, fine, turn] = [of(measure.step_um), of(measure.step_nm), of(measure.counts_per_turn)];
  if (step) return `${entry.name}: ${decimal(entry.value * step, ONE)} µm`;
  if (fine) return `${entry.name}: ${decimal(entry.value * fine, 1000n * (of(measure.per_counts) || ONE))} µm`;
  if (turn < ONE) return "";
  const angle = ((entry.value % turn) + turn) % turn; // A negative remainder would be an angle before revolution 0.
  const degrees = (Number(angle * 360n) / Number(turn)).toFixed((turn / 360n).toString().length);
  const hasTurns = of(measure.turns) > ONE && entry.name === measure.of;
  return `${entry.name}: ${degrees}°${hasTurns ? ` of revolution ${(entry.value - angle) / turn}` : ""}`;
}

function crcLine({ crc, received, computed }) {
  const judged = received === computed ? "correct" : `WRONG, expected ${hex(computed, 2)}`;
  const start = crc.init ? `, start value ${hex(big(crc.init))}` : "";
  const inverted = big(crc.xorout) === ones(crc.width) ? ", sent inverted" : "";
  return element("p", {}, `CRC ${hex(received, 2)}: ${judged} (${crc.text}${start}${inverted})`);
}

function reportsOf(found) {
  if (!found.reports.length) return [];
  const items = found.reports.map((item) => [
    element("strong", {}, item.flag), `: ${sentence(item.meaning)}`,
    item.remedy ? ` ${sentence(item.remedy)}` : "", item.source ? part("span", "source", ` [${item.source}]`) : "",
  ]);
  return [element("p", {}, "The encoder reports:"), list(items)];
}

/** The first line: the verdict or the errors. */
function headline(found) {
  if (found.problems.length) {
    const items = found.problems.map((item) => `${item.fault} error: ${item.message}`);
    return part("div", "bad", items.map((text) => element("p", {}, text)));
  }
  const isRegister = found.at.layout.length !== undefined;
  const start = isRegister || found.crc ? "No error" : "No error, but this frame does not have a CRC";
  const words = [...(found.reports.length ? [] : [start]), ...(found.verdict ? [TABLE.worth[found.verdict]] : [])];
  const verdict = found.verdict ? [element("code", {}, found.verdict), ": "] : [];
  const names = { not_usable: "bad", usable_with_warning: "warning", usable: "good" };
  const [first, ...more] = words.map(sentence);
  const line = words.length ? [element("p", {}, verdict, [first, ...more.map(capital)].join(" "))] : [];
  return part("div", names[found.verdict] ?? "plain", line);
}

/** Whether a wrong frame is a valid one of another kind, whose check bits match, so it has no mistake. */
function isAnother(found, others) {
  const [other] = others;
  return found.problems.length > 0 && others.length === 1
    && Boolean(other.crc || other.checks.some((item) => item.check.fault === "constant"));
}

/** The names of the other frames that it can be, in a sentence. */
function othersOf(found, others) {
  if (!others.length) return [];
  const names = others.map((at) => at.name.replaceAll("_", " ")).join(", ");
  const kind = isAnother(found, others) ? "valid_other" : found.problems.length ? "instead" : "also";
  const words = said(kind, names);
  return [element("p", {}, `${words[0].toUpperCase()}${words.slice(1)}. Choose it above.`)];
}

/** Other readings of a position that nothing in the frame can contradict, folded, and the request that it also is. */
function doubtsOf(found, measure) {
  const readings = otherPositions(found, measure).map(([text, one]) => `${one} ${text}`).join(", ");
  const request = ownRequest(found);
  return [
    ...(readings ? [foldedDoubt(measure, readings)] : []),
    ...(request ? [element("p", {}, sentence(capital(said("own_request", request))))] : []),
  ];
}

function foldedDoubt(measure, readings) {
  const [question, ...rest] = said("looks_wrong", positionName(measure), readings).split("? ");
  return element("details", {}, element("summary", {}, `${question}?`), element("p", {}, sentence(rest.join("? "))));
}

/** The mistakes that could explain a wrong frame. */
function whyOf(found) {
  const dead = deadLine(found);
  if (dead) return [element("p", {}, dead)];
  if (!found.problems.length) return [];
  const flips = disturbedBits(found);
  const which = flips.length === 1 ? bitName(found.at, flips[0]) : `one of ${flips.length} bits`;
  const noise = flips.length ? [element("p", {},
    `If only some frames fail, one bit may have been disturbed on the line: the CRC matches with ${which} inverted. `
    + "In that case, no change is needed.")] : [];
  const reasons = explained(found);
  const match = "these changes make the CRC match:";
  const withCrc = noise.length ? `If all frames fail, ${match}` : `T${match.slice(1)}`;
  const start = found.at?.crc ? withCrc : `${said("uncertain")}:`;
  const told = reasons.length ? [element("p", {}, start), list(reasons.map((one) => reasonOf(one.at ?? found.at, one)))] : [];
  const missing = missingPart(found);
  const help = anotherHelps(reasons) ? [element("p", {}, said("another_frame"))] : [];
  return [...noise, ...told, ...missing ? [element("p", {}, sentence(capital(missing)))] : [], ...help];
}

/** One explanation: its text and chance, the numbers that the frame then contains, and the parts of a recording. */
function reasonOf(at, { text, oneIn, number, parts = [] }) {
  const chance = oneIn > ONE ? ` (matches by chance in 1 of ${oneIn} frames)` : "";
  const numbers = number === undefined ? [] : numbersRead(at, number).map(([name, one]) => `${name} ${one}`);
  const reads = numbers.length ? `: ${numbers.join(", ")}` : "";
  return [`${text}${chance}${reads}`, parts.length ? drawnParts(parts) : ""];
}

/** The parts of a recording, drawn like the bits of a frame. */
const drawnParts = (parts) => part("div", "drawing", parts.map(([name, some]) =>
  part("span", `cell ${CLASS}-cell-${name === "frame" ? "data" : "flag"}`,
    part("span", "bits", some), part("span", "name", name.replaceAll("_", "-")))));

const byteOf = (at, bit) => (at.layout.order === "little" ? bit >> 3 : at.bits / 8 - 1 - (bit >> 3));
const bitName = (at, bit) => (at.layout.order ? `bit ${bit % 8} of byte ${byteOf(at, bit)}` : `bit ${bit}`);

/** All output about a frame or register. */
function resultOf(found, measure, others) {
  const angle = measured(found, measure);
  const table = found.fields.length ? fieldTable(found) : null;
  return [
    headline(found),
    ...(found.differences.length ? [list(found.differences.map((text) => `differs from the manual: ${text}`))] : []),
    ...reportsOf(found),
    ...(table && angle ? [part("p", "angle", angle)] : []),
    ...(table ? [bitsOf(found, table), table] : []),
    ...(found.crc ? [crcLine(found.crc)] : []),
    ...othersOf(found, others),
    ...doubtsOf(found, measure),
    ...(isAnother(found, others) ? [] : whyOf(found)),
  ];
}

/** All output about a frame with several data channels: its verdict, and then each channel. */
function wholeResultOf(found, measure) {
  const compared = found.compared ? [element("p", {}, sentence(capital(found.compared.words)))] : [];
  const channels = found.channels.flatMap((one) => [
    element("h3", {}, capital(one.at.layout.title)), ...resultOf({ ...one, verdict: one.verdict && found.verdict }, measure, []),
  ]);
  return [headline({ ...found, crc: true }), ...compared, ...channels];
}

/** A button for each order code, which calls ``pick`` with it. */
function codeButtons(codes, pick) {
  return part("div", "codes", codes.map((code) => {
    const button = element("button", { type: "button" }, code);
    button.addEventListener("click", () => pick(code));
    return button;
  }));
}

/** The order codes that match the frame in a text; ``pick`` selects one of them. */
function guessesOf(text, pick) {
  const groups = inferred(text);
  if (!groups.length) return [part("div", "bad", element("p", {}, sentence(notOfAnyCode(text))))];
  const withCrc = groups.filter((group) => group.decoded.crc);
  const rows = [...withCrc, ...groups.filter((group) => !group.decoded.crc)].map((group) => {
    const { at } = group.decoded;
    const bits = group.decoded.bits ?? at.bits;
    const size = at.layout.order ? counted(at.bits / 8, "byte") : counted(bits, "bit");
    const check = group.decoded.crc ? "with a correct CRC" : "without a CRC";
    const mark = group.family.mark ? ` (${group.family.mark})` : "";
    const text = `${group.over.title} from the ${group.sender}, ${at.layout.title}: ${size}, ${check}${mark}`;
    return [element("p", {}, text), codeButtons(group.codes, (code) => pick(code, group.sender))];
  });
  return [element("p", {}, "Valid frame of these order codes. Select the one on the label:"), list(rows)];
}
