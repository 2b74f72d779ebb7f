/* The output of "codewheel master" for one encoder and one master, as text of at most 80 columns. */
"use strict";

{
  const { clocksInUse, countWithUnit, hertz, hexText, joinWords, paddingText, sheetOf, shortNumber } = globalThis.codewheelMaster;

  const WIDTH = 80;
  /** Widths of the columns with the names and the values of settings. */
  const [WIDEST_NAME, WIDEST_VALUE] = [40, 18];
  const MARKS = { documented: "", inferred: " *", tried: " +" };

  /** Return the text as lines of at most 80 columns. Each line has the prefix, except the first if it has its own. */
  function wrapText(text, prefix = "", first = prefix) {
    const [firstWord, ...words] = text.trim().split(" ").filter(Boolean);
    if (firstWord === undefined) return "";
    const lines = [];
    let line = first + firstWord;
    for (const word of words) {
      if (line.length + 1 + word.length > WIDTH) {
        lines.push(line);
        line = prefix + word;
      } else line += ` ${word}`;
    }
    return [...lines, line].join("\n");
  }

  /** Return the lines of a table with names and texts, indented by two spaces. */
  function twoColumns(rows) {
    const width = Math.min(WIDEST_NAME, Math.max(...rows.map(([name]) => name.length)));
    return rows.map(([name, text]) => wrapText(text, " ".repeat(width + 4), `  ${name.padEnd(width)}  `));
  }

  // -- facts about the encoder

  const notStated = (record, topic) => record.mentioned[topic] || `the ${record.document} does not say`;

  function clockText(record) {
    const { clock_min_hz: lowest, clock_max_hz: highest } = record.numbers;
    const row = record.cable_row;
    const limits = [];
    if (lowest !== null) limits.push(`at least ${hertz(Number(lowest))}`);
    if (row?.isBelow) limits.push(`below ${hertz(row.hz)}`);
    else if (highest !== null) limits.push(`at most ${hertz(Number(highest))}`);
    if (limits.length) return limits.join(", ");
    return record.used_hz.length ? `${notStated(record)}, ${clocksInUse(record.used_hz)}` : notStated(record);
  }

  function cableText({ cables: { rows, origin, errata }, cable_m: metres }) {
    const errataText = errata.length ? `, errata ${errata.join(", ")}` : "";
    const text = `${rows.map((row) => row.text).join(", ")} (table in ${origin}${errataText})`;
    return metres === null ? text : `${text}. Clocks chosen for a cable of ${metres} m`;
  }

  function timeLimit(microseconds, bound) {
    if (microseconds === null) return "";
    const unit = [[1000000n, "s"], [1000n, "ms"]].find(
      ([factor]) => microseconds >= factor && microseconds % factor === 0n);
    return unit ? `${bound} ${microseconds / unit[0]} ${unit[1]}` : `${bound} ${microseconds} µs`;
  }

  function supplyText({ numbers: { supply_min_mv: lowest, supply_max_mv: highest } }) {
    const volts = (millivolts) => `${shortNumber(Number(millivolts) / 1000)} V`;
    return lowest === null || highest === null ? "" : `${volts(lowest)} to ${volts(highest)}`;
  }

  function statusText(record) {
    const levels = { low: "active low", high: "active high", "": "always 1" };
    const bits = record.parts.filter(({ role }) => role === "status");
    return bits.map(({ name, active }) => `${name} (${levels[active]})`).join(", ") || "none";
  }

  function dataBitsText({ numbers }) {
    return [
      String(numbers.data_bits), numbers.status_bits && `${numbers.data_and_status_bits} with the status bits`,
      (numbers.other_bits_left || numbers.other_bits_right) && `${numbers.bits_without_crc} with the other bits`,
      numbers.crc_bits && `${numbers.frame_bits} with the CRC`,
      numbers.parity_bits && `${numbers.frame_bits + 1n} with the parity bit`,
    ].filter(Boolean).join(", ");
  }

  function crcText({ numbers, crc_obstacle: obstacle }) {
    if (!numbers.crc_bits) return "none";
    const polynomial = numbers.crc_polynomial;
    const form = obstacle ? "in a form that masters cannot check, see below"
      : `sent ${numbers.crc_inverted ? "inverted" : "not inverted"}`;
    return `${numbers.crc_bits} bits, polynomial ${hexText(polynomial, 2)} (${polynomial}) with its top bit, `
      + `${hexText(numbers.crc_polynomial_without_top_bit, 2)} without it, `
      + `${hexText(numbers.crc_polynomial_without_last_1, 2)} without its trailing 1 (Koopman notation), `
      + `start value ${numbers.crc_start}, ${form}`;
  }

  /** Return the facts about the encoder as rows: the name of each fact, and its value in words. */
  function factRows(record, data) {
    const { numbers, words, parts } = record;
    const turns = numbers.multiturn_bits
      ? `: ${numbers.multiturn_bits} multiturn, ${numbers.singleturn_bits} singleturn` : "";
    const otherParts = parts.filter(({ role }) => role === "other").map(({ name }) => name);
    const order = parts.map(({ name, bits }) => `${name} ${bits}`).join(", ");
    const rows = [
      ["Interface", data.interfaces[words.interface]], ["Position bits", numbers.position_bits + turns],
      ["Padding", paddingText(record, data)], ["Status bits", statusText(record)],
      ["Other bits", otherParts.join(", ")], ["Data bits", dataBitsText(record)],
      ["Order", `${order}, most significant bit first`], ["Code", data.codings[words.coding]],
      ["CRC", crcText(record)], ["Parity", words.parity === "none" ? "" : `${words.parity}, last bit`],
      ["Clock", clockText(record)], ["Clock by cable", record.cables.rows.length ? cableText(record) : ""],
    ];
    if (words.interface === "biss") {
      const busy = timeLimit(numbers.busy_us, "at most");
      rows.push(["Timeout", record.timeout || notStated(record, "TIMEOUT")],
        ["Busy time", busy || `${notStated(record, "REPLY_TIME")}, but BiSS C allows 40 µs`]);
    } else rows.push(["Pause", timeLimit(numbers.pause_us, "at least") || notStated(record, "PAUSE")]);
    rows.push(["Supply", supplyText(record) || notStated(record, "SUPPLY")]);
    return rows.filter(([, text]) => text);
  }

  /** Return lines with the encoder, the grade of its spec, and the facts about it. */
  function recordLines({ record, title, statements }, data) {
    return [
      wrapText(`${record.code}: ${title}`, "  ", ""), ...statements.map((statement) => wrapText(statement, "  ")),
      ...twoColumns(factRows(record, data)), ...record.notes.map((note) => wrapText(note, "  "))];
  }

  // -- the sheet of a master

  const withMark = (text, { standing }) => text + MARKS[standing];

  /** Return a source with the citations of whole documents first. */
  function cited(source) {
    const citations = source.trim().split(/;\s*/);
    const hasPage = (citation) => citation.includes(":");
    return [...citations.filter((citation) => !hasPage(citation)), ...citations.filter(hasPage)].join(", ");
  }

  const citedRule = (text, rule) => `${withMark(text, rule)}${rule.source ? ` [${cited(rule.source)}]` : ""}`;
  const valueText = (setting) => withMark((setting.bound && `${setting.bound.replaceAll("_", " ")} `) + setting.text, setting);

  function legend({ master, refusals, settings, writing, gaps }) {
    const rules = [...settings, ...writing, ...refusals, ...gaps, ...settings.flatMap(({ places }) => places)];
    const standings = new Set([master.standing, ...rules.map(({ standing }) => standing)]);
    return ["Settings from the documentation of each master.",
      ...(standings.has("inferred") ? ["* = derived, not stated there."] : []),
      standings.has("tried") ? "+ = tested on hardware. All others are not yet tested." : "Not yet tested on hardware.",
    ].join(" ");
  }

  /** Return a location in words, such as "0x8000:01", or "". */
  function locationText({ index, subindex, symbol, register, address, high, low }) {
    if (index !== null) return `${hexText(index, 4)}:${subindex.toString(16).toUpperCase().padStart(2, "0")}`;
    const words = symbol || register || (address === null ? "" : `address ${address}`);
    if (high === null) return words;
    return high === low ? `${words}, bit ${low}` : `${words}, bits ${high}:${low}`;
  }

  const rangeText = ({ minimum, maximum }) => {
    if (minimum === null) return maximum === null ? "" : `at most ${maximum}`;
    return maximum === null ? `at least ${minimum}` : `${minimum} to ${maximum}`;
  };

  function defaultText(value, isHex) {
    if (typeof value === "boolean") return String(value).toUpperCase();
    if (typeof value === "number" && isHex) return hexText(value, 2);
    return value === null ? "" : String(value);
  }

  /** Return a location on all channels of one device in words. */
  function placeLine(places, isHex) {
    const [place] = places;
    const location = places.map((other) => locationText(other) + (other.channel && ` (${other.channel})`)).join(", ");
    const type = place.type === "bits" ? countWithUnit(place.bits ?? 0, "bit")
      : place.type.replace("signed_n", "signed n");
    const byDefault = defaultText(place.default, isHex);
    const facts = [
      location, type, place.unit && place.unit !== "none" ? `unit ${place.unit}` : "", rangeText(place),
      byDefault && `factory default ${byDefault}`, place.isDefault ? "leave it" : ""].filter(Boolean);
    const texts = { place: location, "data type": type, unit: place.unit, "factory default": byDefault };
    const missing = Object.keys(texts).filter((name) => !texts[name]);
    if (missing.length) facts.push(`${joinWords(missing)} not given`);
    return `${facts.join(", ")}${place.standing === "inferred" ? " *" : ""} [${place.source.replaceAll("; ", ", ")}]`;
  }

  /** Return the locations of a value as texts, one for all devices with the same location. */
  function placeLines(places, value, master) {
    const placesByDevice = [];
    for (const place of places) {
      if (placesByDevice.at(-1)?.[0].device === place.device) placesByDevice.at(-1).push(place);
      else placesByDevice.push([place]);
    }
    const devicesByLine = new Map();
    for (const devicePlaces of placesByDevice) {
      const line = placeLine(devicePlaces, value.startsWith("0x"));
      devicesByLine.set(line, [...devicesByLine.get(line) ?? [], devicePlaces[0].device]);
    }
    return [...devicesByLine].map(([line, devices]) => (
      devices.length === master.devices.length ? line : `${devices.join(", ")}: ${line}`));
  }

  /** Return lines with the values to write before and after a setting, and their locations. */
  const neededValueLines = (rule, master, indent) => [...rule.needs, ...rule.then].flatMap(
    (write) => placeLines(write.places, write.text, master).map(
      (line) => wrapText(`${write.title}: ${line}`, `${indent}  `, indent)));

  /** Return lines with a setting, its note, its conditions for writing, and its locations. */
  function settingLines(setting, { master, writing }, nameWidth, valueWidth) {
    const value = valueText(setting);
    const row = `  ${setting.name.padEnd(nameWidth)}  ${value.padEnd(valueWidth)}  ${setting.at}`.trimEnd();
    const nameAndPlace = setting.at ? `${setting.name}, ${setting.at}` : setting.name;
    const conditions = writing.filter(({ of: names }) => names.length === 1 && names[0] === setting.name);
    const sentences = conditions.map((rule) => citedRule(rule.text, rule));
    if (setting.isDefault && conditions.some(({ needs }) => needs.length)) {
      sentences.unshift(`${setting.text} is the factory default. Write it only if the setting was changed.`);
    }
    return [
      ...(row.length > WIDTH ? [wrapText(nameAndPlace, "      ", "  "), wrapText(value, "      ")] : [row]),
      ...[setting.note, ...sentences].filter(Boolean).map((sentence) => wrapText(sentence, "      ")),
      ...placeLines(setting.places, setting.text, master).map((line) => wrapText(line, "        ", "      ")),
      ...conditions.flatMap((rule) => neededValueLines(rule, master, "      ")),
    ];
  }

  /** Return lines with the settings of a master, its notes, its file formats and its documents. */
  function sheetLines(sheet) {
    const { master, settings, gaps, writing, notes } = sheet;
    const widest = (texts, limit) => Math.min(limit, Math.max(0, ...texts.map((text) => text.length)));
    const [nameWidth, valueWidth] = [
      widest(settings.map(({ name }) => name), WIDEST_NAME), widest(settings.map(valueText), WIDEST_VALUE)];
    const formats = master.files.map(({ format }) => format);
    return [
      wrapText(`${master.title} (${master.name})`, "  ", ""),
      ...settings.flatMap((setting) => settingLines(setting, sheet, nameWidth, valueWidth)),
      ...gaps.map((gap) => wrapText(citedRule(gap.reason, gap), "    ", "  - ")),
      ...writing.filter((rule) => rule.of.length !== 1).flatMap((rule) => [
        wrapText(citedRule(rule.text, rule), "    ", "  - "), ...neededValueLines(rule, master, "    ")]),
      ...notes.map((note) => wrapText(note, "    ", "  - ")),
      ...(formats.length ? [wrapText(`file: --format ${joinWords(formats, "or")}`, "      ", "  ")] : []),
      ...master.documents.map(({ key, title, url }) => (
        wrapText(url ? `${title}, ${url}` : title, "      ", `  ${key}: `))),
    ];
  }

  /** Return what "codewheel master" prints: the facts about an encoder, and its settings in one master. */
  function settingsText(encoder, master, data) {
    const { record } = encoder;
    const lines = recordLines(encoder, data);
    if (record.obstacle) return lines.join("\n");
    const sheet = sheetOf(master, record, data);
    lines.push("", wrapText(legend(sheet)), "");
    if (!sheet.refusals.length) return [...lines, ...sheetLines(sheet)].join("\n");
    return [
      ...lines, wrapText(`According to their documentation, these cannot use ${record.code}:`),
      wrapText(`${master.title} (${master.name})`, "    ", "  "),
      ...sheet.refusals.map((refusal) => wrapText(citedRule(refusal.reason, refusal), "      ", "    ")),
    ].join("\n");
  }

  /** Return what a table shows of the settings in one master: its settings in words, its notes and its refusals. */
  function shownSheet({ record }, master, data) {
    if (record.obstacle) return { refusals: [record.obstacle], notes: [], settings: [] };
    const { refusals, notes, settings } = sheetOf(master, record, data);
    return {
      refusals: refusals.map(({ reason }) => reason), notes,
      settings: settings.map((setting) => ({ name: setting.name, value: valueText(setting), at: setting.at })),
    };
  }

  globalThis.codewheelMaster = { ...globalThis.codewheelMaster, settingsText, shownSheet };
}
