/* The settings of a BiSS or SSI master for one encoder, from the rules of the master's description. They are the same
   as those of "codewheel master", which generator/masters computes. */
"use strict";

{
  /** A value depends on a number that the spec does not give. */
  class UnknownValue extends Error {}
  /** The master does not support a feature that the encoder needs. */
  class UnsupportedFeature extends Error {}

  /** Bound of a clock that is known to work with the encoder, while its highest clock is unknown. */
  const START_WITH = "start_with";
  const HZ_BY_UNIT = { Hz: 1, kHz: 1000, MHz: 1000000 };
  const STEPS = { step_um: "µm", step_pm: "pm" };
  const NOT_GIVEN = "not_given";
  /** Items that count bits: the kind of bit, and its place in the frame. */
  const COUNTED_BITS = {
    multiturn_bits: ["multiturn bit", ""], singleturn_bits: ["singleturn bit", ""], position_bits: ["position bit", ""],
    padding_left: ["zero bit", " before the position"], padding_right: ["zero bit", " after the position"],
    data_bits: ["data bit", ""], status_bits: ["status bit", ""], data_and_status_bits: ["data and status bit", ""],
    crc_bits: ["CRC bit", ""], other_bits_left: ["other bit", " before the position"],
    other_bits_right: ["other bit", " after the position"],
    other_bits_after_status: ["other bit", " after the first status bit"], parity_bits: ["parity bit", ""],
    bits_without_crc: ["bit", " of data, status and others"], frame_bits: ["bit", " in the frame"],
  };

  /** Return a number with at most six significant digits, such as 2.5. */
  const shortNumber = (number) => String(Number(number.toPrecision(6)));

  /** Return a frequency in the largest unit that gives at least 1, such as "2.5 MHz". */
  function hertz(frequency) {
    for (const [factor, unit] of [[1e6, "MHz"], [1e3, "kHz"]]) {
      if (frequency >= factor) return `${shortNumber(frequency / factor)} ${unit}`;
    }
    return `${frequency} Hz`;
  }

  const countWithUnit = (count, unit) => (String(count) === "1" ? `${count} ${unit}` : `${count} ${unit}s`);

  /** Join words as "a", "a and b" or "a, b and c". */
  const joinWords = (words, last = "and") => (
    words.length < 2 ? words.join("") : `${words.slice(0, -1).join(", ")} ${last} ${words.at(-1)}`);

  /** Return a number in hexadecimal with at least ``digits`` digits. */
  const hexText = (number, digits) => `0x${number.toString(16).toUpperCase().padStart(digits, "0")}`;

  /** Return a clause about the clocks in Hz that are in use, such as "1 MHz and 5 MHz are in use". */
  const clocksInUse = (clocks) => `${joinWords(clocks.map(hertz))} ${clocks.length === 1 ? "is" : "are"} in use`;

  // -- facts about the encoder

  /** Return whether a fact meets the limits of a rule, or is a number that the spec does not give. */
  function isWithinLimits(limit, { words, numbers }) {
    if (limit.item in words) return limit.is.includes(words[limit.item]);
    const number = numbers[limit.item];
    if (number === null) return true;
    const isNumber = (listed) => BigInt(listed) === number;
    return number >= (limit.at_least ?? number) && number <= (limit.at_most ?? number)
      && (limit.one_of ?? [number]).some(isNumber) && !(limit.none_of ?? []).some(isNumber);
  }

  /** Return whether all conditions of a rule are met. A condition on a number that the spec does not give is not. */
  const doesApply = (rule, record) => (rule.when ?? []).every((condition) => (
    (condition.item in record.words || record.numbers[condition.item] !== null) && isWithinLimits(condition, record)));

  /** Replace names in braces, such as {data_bits}, by facts. A fact that the spec does not give becomes "unknown". */
  function fillTemplate(text, record) {
    let filledText = record.step_text ? text.replaceAll("{step_um}", record.step_text) : text;
    for (const [name, fact] of Object.entries({ ...record.words, ...record.numbers })) {
      filledText = filledText.replaceAll(`{${name}}`, fact === null ? "unknown" : String(fact));
    }
    return filledText;
  }

  /** Return the error for a number that the spec does not give, or that is no whole number of its unit. */
  function unknownNumber(name, data, stepText = "") {
    if (name in STEPS && stepText) {
      return new UnknownValue(`one count is ${stepText} µm, not a whole number of ${STEPS[name]}`);
    }
    return new UnknownValue(`not in the encoder's spec (${data.number_meanings[name]})`);
  }

  /** Fill a template, and throw ``UnknownValue`` if the spec does not give one of its numbers. */
  function fillKnownTemplate(text, record, data) {
    for (const name of Object.keys(data.number_meanings)) {
      const isKnown = record.numbers[name] !== null || (name === "step_um" && record.step_text);
      if (text.includes(`{${name}}`) && !isKnown) throw unknownNumber(name, data, record.step_text);
    }
    return fillTemplate(text, record);
  }

  /** Return a fact in words, such as "Gray code" or "4 zero bits before the position". */
  function factInWords(name, record, data) {
    if (name in record.words) return fillTemplate(data.word_meanings[name][record.words[name]], record);
    const number = record.numbers[name];
    if (name in COUNTED_BITS) {
      const [bitKind, place] = COUNTED_BITS[name];
      return countWithUnit(number, bitKind) + place;
    }
    if (name === "crc_inverted") return number ? "an inverted CRC" : "a plain CRC";
    const meaning = data.number_meanings[name];
    return name.startsWith("crc_polynomial") ? `${meaning.split(",")[0]}: ${hexText(number, 2)}`
      : `${meaning}: ${number}`;
  }

  /** Return the zero bits around the position in words, or "none". */
  const paddingText = (record, data) => ["padding_left", "padding_right"].filter((name) => record.numbers[name])
    .map((name) => factInWords(name, record, data)).join(", ") || "none";

  /** Return a fact as a sentence, such as "This encoder has 4 zero bits before the position." */
  function factSentence(name, record, data) {
    const fact = factInWords(name, record, data);
    if (name === "frame_bits") {
      return `This encoder sends frames of ${countWithUnit(record.numbers[name], "bit")}.`;
    }
    if (name === "movement") return `This encoder is ${fact}.`;
    const isNoun = name in record.words || name in COUNTED_BITS || name === "crc_inverted";
    return isNoun ? `This encoder has ${fact}.` : `For this encoder: ${fact}.`;
  }

  // -- values of settings: {value, text, bound}

  /** Return the sum of the terms of an expression. Throws ``UnsupportedFeature`` if the result cannot be set. */
  function evaluateExpression(expression, rule, record, data) {
    for (const name of expression.parameters) {
      if (record.numbers[name] === null) throw unknownNumber(name, data, record.step_text);
    }
    let sum = BigInt(expression.constant);
    for (const [multiple, factors] of expression.terms) {
      let product = BigInt(multiple);
      for (const [name, isPower] of factors) product *= isPower ? 1n << record.numbers[name] : record.numbers[name];
      sum += product;
    }
    if (sum < 0n && rule.as !== "signed") {
      throw new UnsupportedFeature(`${rule.name} would be ${expression.text}, which cannot be set`);
    }
    return sum;
  }

  /** Return the value that a rule chooses by one fact, such as the code of the position. */
  function chooseValue(rule, record, data) {
    const { of: factName, cases } = rule.choice;
    const fact = record.words[factName] ?? record.numbers[factName];
    if (fact === null) throw unknownNumber(factName, data, record.step_text);
    const chosenCase = cases.find((choice) => String(choice.is) === String(fact));
    if (chosenCase) return chosenCase.set;
    throw new UnsupportedFeature(`${rule.name} has no value for ${factInWords(factName, record, data)}`);
  }

  /** Return the lowest and the highest clock of the encoder in Hz. The lowest is 0 if the spec does not give it. */
  function clockLimits({ numbers }, data) {
    if (numbers.clock_max_hz === null) throw unknownNumber("clock_max_hz", data);
    return [Number(numbers.clock_min_hz ?? 0), Number(numbers.clock_max_hz)];
  }

  /** Return the highest clock of the encoder in words, as in the table of cable lengths if that limits it. */
  const highestClockText = (record) => hertz(record.cable_row ? record.cable_row.hz : Number(record.numbers.clock_max_hz));
  const fastestOf = (clocks) => clocks.reduce((fastest, clock) => (clock.hz > fastest.hz ? clock : fastest));

  /** Return the fastest clock in the list of a master that the encoder supports: {hz, set}. */
  function bestListedClock(rule, record, data) {
    const usedClocks = rule.clocks.filter((clock) => record.used_hz.includes(clock.hz));
    if (usedClocks.length) return fastestOf(usedClocks);
    const [lowest, highest] = clockLimits(record, data);
    const supportedClocks = rule.clocks.filter((clock) => lowest <= clock.hz && clock.hz <= highest);
    if (supportedClocks.length) return fastestOf(supportedClocks);
    const withCable = record.cable_m === null ? "" : ` with a cable of ${record.cable_m} m`;
    throw new UnsupportedFeature(`${rule.name}: no clock is between ${hertz(lowest)} and ${highestClockText(record)}, `
      + `the limits of the encoder${withCable}`);
  }

  /** Return the fastest clock in Hz that encoder and master support, for a master that takes any number. */
  function bestSelectableClock(clockRule, record, data) {
    const [lowestOfMaster, highestOfMaster] = [clockRule.at_least_hz ?? 0, clockRule.at_most_hz ?? Infinity];
    const usedClocks = record.used_hz.filter((clock) => lowestOfMaster <= clock && clock <= highestOfMaster);
    if (usedClocks.length) return Math.max(...usedClocks);
    const [lowest, highest] = clockLimits(record, data);
    const bestClock = Math.min(highest, highestOfMaster);
    if (bestClock >= Math.max(lowest, lowestOfMaster)) return bestClock;
    const supported = highestOfMaster < lowest ? `at most ${hertz(highestOfMaster)}` : `at least ${hertz(lowestOfMaster)}`;
    throw new UnsupportedFeature(`The master supports clocks of ${supported}, but the encoder needs ${hertz(lowest)} to `
      + highestClockText(record));
  }

  function listedClock(rule, record, data) {
    const clock = bestListedClock(rule, record, data);
    const frequency = hertz(clock.hz);
    const text = String(clock.set) === frequency ? frequency : `${clock.set} (${frequency})`;
    return { value: clock.set, text, bound: record.numbers.clock_max_hz === null ? START_WITH : "" };
  }

  function selectableClock(clockRule, record, data) {
    let clock = bestSelectableClock(clockRule, record, data);
    let bound = record.numbers.clock_max_hz === null ? START_WITH : "at_most";
    const row = record.cable_row;
    // The table of cable lengths may give an exclusive limit, which is shown as printed.
    if (row?.isBelow && clock === row.hz - 1) [clock, bound] = [row.hz, "below"];
    const { unit } = clockRule;
    if (!(unit in HZ_BY_UNIT)) return { value: clock, text: hertz(clock), bound };
    const number = clock / HZ_BY_UNIT[unit];
    const numberText = Number.isInteger(number) ? String(number) : shortNumber(number);
    const text = unit === "Hz" ? `${numberText} Hz (${hertz(clock)})` : `${numberText} ${unit}`;
    return { value: /^[0-9]+$/.test(numberText) ? Number(numberText) : numberText, text, bound };
  }

  /** Merge adjacent parts that have the same one of these roles, and name them after it. */
  function mergeParts(parts, roles) {
    const mergedParts = [];
    for (const part of parts) {
      if (!roles.includes(part.role)) mergedParts.push(part);
      else if (mergedParts.at(-1)?.role === part.role) {
        mergedParts.at(-1).bits += part.bits;
      } else mergedParts.push({ ...part, name: part.role });
    }
    return mergedParts;
  }

  /** Return the text that describes the frame to a master: a text for the start, and one for each part. */
  function frameString(stringRule, settingName, record, data) {
    const templates = {};
    for (const fieldRule of stringRule.fields) {
      if (doesApply(fieldRule, record)) templates[fieldRule.of] ??= fieldRule.text;
    }
    const pieces = [fillKnownTemplate(stringRule.start ?? "", record, data)];
    const isTurn = ({ role }) => role === "multiturn" || role === "singleturn";
    let parts = "position" in templates
      ? mergeParts(record.parts.map((part) => (isTurn(part) ? { ...part, role: "position" } : part)), ["position"])
      : mergeParts(record.parts, ["multiturn", "singleturn"]);
    if (stringRule.first !== "sent_first") parts = [...parts].reverse();
    for (const { name, role, bits, active } of parts) {
      const kind = role === "status" ? `status_active_${active || "low"}` : role;
      if (!(kind in templates)) {
        throw new UnsupportedFeature(`${fillTemplate(settingName, record)} cannot express '${name}'`);
      }
      const text = templates[kind].replaceAll("{bits}", String(bits)).replaceAll("{name}", name);
      pieces.push(fillKnownTemplate(text, record, data));
    }
    return pieces.join("");
  }

  /** Return the value of a setting: {value, text, bound}. */
  function settingValue(rule, record, data) {
    if ("unknown" in rule) throw new UnknownValue(rule.unknown);
    if ("value" in rule) {
      const number = evaluateExpression(rule.expression, rule, record, data);
      if (rule.as === "boolean") return { value: number !== 0n, text: number ? "TRUE" : "FALSE", bound: "" };
      return { value: number, text: rule.as === "hex" ? hexText(number, 2) : String(number), bound: rule.bound ?? "" };
    }
    if ("choice" in rule) {
      const value = chooseValue(rule, record, data);
      return { value, text: String(value), bound: "" };
    }
    if ("clocks" in rule) return listedClock(rule, record, data);
    if ("any_clock" in rule) return selectableClock(rule.any_clock, record, data);
    const text = "text" in rule ? fillKnownTemplate(rule.text, record, data)
      : frameString(rule.string, rule.name, record, data);
    return { value: text, text, bound: "" };
  }

  // -- locations of settings

  const isSameValue = (first, second) => (typeof first === "string" || typeof second === "string"
    ? first === second : Number(first) === Number(second));
  const CHANNEL_KEYS = ["index", "subindex", "symbol", "register", "address"];

  /** Return the locations of a setting, once for each channel of a device if they differ by channel. */
  function placesOf(rule, value, master, data, fillIn) {
    return rule.places.flatMap((placeRule) => master.devices
      .filter(({ name }) => (placeRule.on ?? [name]).includes(name))
      .flatMap((device) => {
        const differs = CHANNEL_KEYS.some((key) => Array.isArray(placeRule[key]));
        const channels = differs ? device.channels : [""];
        return channels.map((channel, index) => placeOf(placeRule, device.name, channel, index, value, master, data, fillIn));
      }));
  }

  function placeOf(rule, device, channel, channelIndex, value, master, data, fillIn) {
    const forChannel = (key) => (Array.isArray(rule[key]) ? rule[key][channelIndex] : rule[key]);
    const [kind, typeBits] = data.types[rule.type] ?? ["", null];
    const [high, low = high] = "at" in rule ? String(rule.at).split(":").map(Number) : [null, null];
    const defaultValue = rule.default === NOT_GIVEN ? null : rule.default;
    const givenText = (text) => (text === NOT_GIVEN ? "" : text);
    return {
      device, channel, index: forChannel("index") ?? null, subindex: forChannel("subindex") ?? null,
      symbol: fillIn(forChannel("symbol") ?? ""), register: forChannel("register") ?? "",
      address: forChannel("address") ?? null, high, low, type: givenText(rule.type), kind,
      bits: high === null ? typeBits : high - low + 1, minimum: rule.min ?? null, maximum: rule.max ?? null,
      unit: givenText(rule.unit), default: defaultValue,
      isDefault: defaultValue !== null && value !== null && isSameValue(defaultValue, value),
      standing: rule.standing ?? master.standing, source: rule.source,
    };
  }

  /** Return why a number does not fit into one of its locations, or "". */
  function reasonForMisfit({ name, value, places }) {
    if (value === null || typeof value === "string") return "";
    for (const { kind, bits, minimum, maximum } of places) {
      const limits = [...(maximum === null ? [] : [BigInt(maximum)]),
        ...(kind === "unsigned" && bits !== null ? [(1n << BigInt(bits)) - 1n] : [])];
      const highest = limits.length ? limits.reduce((least, limit) => (limit < least ? limit : least)) : null;
      if (highest !== null && value > highest) return `${name} would be ${value}, but it is at most ${highest}`;
      if (minimum !== null && value < minimum) return `${name} would be ${value}, but it is at least ${minimum}`;
    }
    return "";
  }

  // -- conditions for writing

  function objectWrite(rule, master, data) {
    return {
      title: rule.name ? `${rule.object} (${rule.name})` : rule.object,
      text: rule.as === "hex" ? hexText(rule.value, 1) : String(rule.value),
      places: placesOf(rule, rule.value, master, data, String),
    };
  }

  function whenEffective(effect) {
    if (effect.in_state) return `only in the ${effect.in_state} state`;
    if (effect.restart_of) return `after a restart of ${effect.restart_of}`;
    return effect.by_call ? `when ${effect.by_call} is called` : "immediately";
  }

  function conditionSentence({ of: settings, needs, after, then, effect }) {
    const names = joinWords(settings);
    if (needs.length) {
      const values = joinWords(needs.map(({ title, text }) => `${title} must be ${text}`));
      return `Before writing ${names || "any setting"}, ${values}.`;
    }
    if (after.length) return `Write ${names} after ${joinWords(after)}.`;
    if (then.length) {
      const values = joinWords(then.map(({ title, text }) => `${title} to ${text}`));
      return `After writing ${names || "all settings"}, set ${values}.`;
    }
    return `${names || "All settings"} ${settings.length === 1 ? "takes" : "take"} effect ${whenEffective(effect)}.`;
  }

  /** Return the conditions for writing the settings with these names. */
  function writingConditions(master, settingNames, record, data) {
    return master.writing.filter((rule) => doesApply(rule, record)).flatMap((rule) => {
      const namesUnder = (key) => (rule[key] ?? []).map((name) => fillTemplate(name, record))
        .filter((name) => settingNames.includes(name));
      const condition = {
        of: namesUnder("of"), after: namesUnder("after"), effect: rule.takes_effect,
        needs: (rule.needs ?? []).map((write) => objectWrite(write, master, data)),
        then: (rule.then ?? []).map((write) => objectWrite(write, master, data)),
        standing: rule.standing ?? master.standing, source: rule.source,
      };
      if (["of", "after"].some((key) => key in rule && !condition[key].length)) return [];
      return [{ ...condition, text: conditionSentence(condition) }];
    });
  }

  // -- the sheet of a master

  /** Return a sentence about the longest cable for a clock, or that no row of the table allows it. */
  function cableSentence({ rows, origin }, clock) {
    if (!rows.length) return "";
    const suitableRows = rows.filter((row) => clock <= row.highestHz);
    if (suitableRows.length) {
      const longest = suitableRows.reduce((row, other) => (other.metres > row.metres ? other : row));
      return `This clock frequency is suitable for a cable ${longest.cable}, according to the table in ${origin}.`;
    }
    const fastest = fastestOf(rows);
    return `No row of the table in ${origin} allows this clock: its highest clock is ${fastest.isBelow ? "below " : ""}`
      + `${hertz(fastest.hz)}, for a cable ${fastest.cable}.`;
  }

  function cableNote(rule, value, record, data) {
    if (value === null || record.cable_m !== null) return "";
    if ("clocks" in rule) return cableSentence(record.cables, bestListedClock(rule, record, data).hz);
    if ("any_clock" in rule) return cableSentence(record.cables, bestSelectableClock(rule.any_clock, record, data));
    return "";
  }

  function settingOf(rule, master, record, data, unknownParts) {
    let setting;
    try {
      if (unknownParts) throw new UnknownValue(`it depends on how the master handles ${unknownParts}`);
      setting = settingValue(rule, record, data);
    } catch (error) {
      if (!(error instanceof UnknownValue)) throw error;
      setting = { value: null, text: `unknown: ${error.message}`, bound: "" };
    }
    const startNote = setting.bound === START_WITH
      ? `The highest clock of the encoder is not known. ${clocksInUse(record.used_hz)}.` : "";
    const places = placesOf(rule, setting.value, master, data, (symbol) => fillTemplate(symbol, record));
    return {
      ...setting, name: fillTemplate(rule.name, record), at: fillTemplate(rule.at ?? "", record), places,
      isDefault: places.every((place) => place.isDefault), standing: rule.standing ?? master.standing,
      source: rule.source,
      note: [rule.note, startNote, cableNote(rule, setting.value, record, data)].filter(Boolean).join(" "),
    };
  }

  /** Return the settings, and a refusal with the devices that have the setting for each one without a value. */
  function settingsAndRefusals(master, record, data, uncovered) {
    const settings = [];
    const deviceRefusals = [];
    for (const rule of master.settings.filter((setting) => doesApply(setting, record))) {
      try {
        settings.push(settingOf(rule, master, record, data, rule.whole_frame ? uncovered : ""));
      } catch (error) {
        if (!(error instanceof UnsupportedFeature)) throw error;
        const devices = new Set(rule.places.flatMap(({ on }) => on ?? master.devices.map(({ name }) => name)));
        deviceRefusals.push([
          { reason: `${error.message}.`, standing: rule.standing ?? master.standing, source: rule.source }, devices]);
      }
    }
    return [settings, deviceRefusals];
  }

  /** Return the unusual parts of the frame that the description of a master does not cover, as text, or "". */
  function uncoveredParts(master, parts) {
    let isAfterPosition = false;
    const names = [];
    for (const { name, role } of parts) {
      isAfterPosition ||= role === "multiturn" || role === "singleturn";
      const other = isAfterPosition ? "other_bits_right" : "other_bits_left";
      const item = { other, parity: "parity_bits" }[role];
      if (item && !master.covered_items.includes(item)) names.push(`'${name}'`);
    }
    return joinWords(names);
  }

  function orderCodeRefusals(master, record, data) {
    const inferred = (reason) => (reason ? [{ reason, standing: "inferred", source: "" }] : []);
    const limits = master.limits.filter((rule) => doesApply(rule, record) && !isWithinLimits(rule, record));
    return [
      ...limits.map((rule) => ({
        reason: `${rule.reason} ${factSentence(rule.item, record, data)}`, standing: rule.standing ?? master.standing,
        source: rule.source,
      })),
      ...inferred(master.checks_crc && record.crc_obstacle),
      ...inferred(!master.several_channels && record.channel_refusal),
    ];
  }

  /** Return the sheet of a master: its settings for the encoder, or the refusals if it cannot use the encoder. */
  function sheetOf(master, record, data) {
    const uncovered = uncoveredParts(master, record.parts);
    const [settings, deviceRefusals] = settingsAndRefusals(master, record, data, uncovered);
    const unusable = new Set(deviceRefusals.flatMap(([, devices]) => [...devices]));
    const refusals = orderCodeRefusals(master, record, data);
    if (unusable.size === master.devices.length) refusals.push(...deviceRefusals.map(([refusal]) => refusal));
    if (!refusals.length) {
      refusals.push(...settings.map((setting) => [setting, reasonForMisfit(setting)]).filter(([, reason]) => reason)
        .map(([{ standing, source }, reason]) => ({ reason: `${reason}.`, standing, source })));
    }
    if (refusals.length) return { master, refusals, settings: [], notes: [], writing: [], gaps: [] };
    const hasOtherChannels = record.channel_gap !== "";
    const deviceNotes = deviceRefusals.map(
      ([refusal, devices]) => `Not for ${joinWords([...devices].sort())}. ${refusal.reason}`);
    const gaps = [
      uncovered && `The description of this master does not say how it handles ${uncovered} in the frame.`,
      hasOtherChannels && !master.several_channels && record.channel_gap,
    ].filter(Boolean);
    return {
      master, refusals, settings,
      notes: [...deviceNotes, ...(hasOtherChannels && master.several_channels ? [master.several_channels] : []),
        ...master.notes.filter((note) => doesApply(note, record)).map((note) => fillTemplate(note.text, record))],
      writing: writingConditions(master, settings.map(({ name }) => name), record, data),
      gaps: gaps.map((reason) => ({ reason, standing: "inferred", source: "" })),
    };
  }

  globalThis.codewheelMaster = {
    ...globalThis.codewheelMaster, clocksInUse, countWithUnit, hertz, hexText, joinWords, paddingText, sheetOf, shortNumber,
  };
}
