/* The facts about an encoder that settings of masters depend on: for an order code from the data of the page, and for
   an encoder in one line from its fields. They are the same as those of "codewheel master". */
"use strict";

{
  const { hertz } = globalThis.codewheelMaster;

  /** There are no settings for this encoder. The message gives the reason. */
  class NoRecord extends Error {}

  const ROLES_AS_SENT = ["before", "position", "after", "status", "crc"];

  /** Return a row of a table of clocks by cable length, with its words. */
  function cableRow([metres, hz, isBelow, isShorter]) {
    const cable = `${isShorter ? "shorter than" : "up to"} ${metres} m`;
    return {
      metres, hz, isBelow, isShorter, cable, highestHz: isBelow ? hz - 1 : hz,
      text: `${cable}: ${isBelow ? "below " : ""}${hertz(hz)}`,
    };
  }

  /** Return a record with its numbers as BigInt, and with no cable length. */
  function readRecord(stored) {
    const numbers = Object.fromEntries(
      Object.entries(stored.numbers).map(([name, number]) => [name, number === null ? null : BigInt(number)]));
    const parts = stored.parts.map(([name, role, bits, active = ""]) => ({ name, role, bits, active }));
    const cables = { ...stored.cables, rows: stored.cables.rows.map(cableRow) };
    return { ...stored, numbers, parts, cables, cable_m: null, cable_row: null };
  }

  /** Return the row of the table with the highest clock for a cable length. */
  function rowForCable({ code, cables }, metres) {
    const rows = cables.rows.filter((row) => metres < row.metres || (metres === row.metres && !row.isShorter));
    if (rows.length) return rows.reduce((fastest, row) => (row.hz > fastest.hz ? row : fastest));
    const cable = `${code}, cable of ${metres} m`;
    if (!cables.rows.length) throw new NoRecord(`${cable}: the spec has no table of clocks by cable length`);
    const longest = Math.max(...cables.rows.map((row) => row.metres));
    throw new NoRecord(`${cable}: the table in ${cables.origin} ends at ${longest} m`);
  }

  /** Return the record with the highest clock for a cable of this length. */
  function limitToCable(record, metres, data) {
    const row = rowForCable(record, metres);
    const limited = {
      ...record, cable_m: metres, notes: record.notes.filter((note) => note !== data.note_on_clocks) };
    const { clock_min_hz: lowest, clock_max_hz: highest } = record.numbers;
    if (highest === null) return { ...limited, used_hz: record.used_hz.filter((clock) => clock <= row.highestHz) };
    const highestHz = Math.min(row.highestHz, Number(highest));
    if (lowest !== null && highestHz < lowest) {
      throw new NoRecord(`${record.code}, cable of ${metres} m: the table in ${record.cables.origin} has ${row.text}, `
        + `but the encoder needs at least ${hertz(Number(lowest))}`);
    }
    return {
      ...limited, numbers: { ...record.numbers, clock_max_hz: BigInt(highestHz) },
      cable_row: highestHz === row.highestHz ? row : null,
    };
  }

  // -- the record of a line

  /** Return the fields of a line as they are sent, with the names that they have in a spec. */
  function namedFields(line) {
    const family = globalThis.codewheelDecode.lineFamily(line);
    const frame = family.interfaces[0].frames.at(-1);
    return line.fields.map((field, index) => ({ ...field, name: family.shared[frame.fields[index]].name }));
  }

  /** Return the counts per revolution and the revolutions of a line, or null for each that it does not state. */
  function measurementOf({ fields, options }) {
    const bitsOf = (name) => fields.find((field) => field.kind === "number" && field.name === name)?.bits;
    const [singleturn, multiturn] = [bitsOf("singleturn"), bitsOf("multiturn")];
    const names = multiturn === undefined ? [singleturn === undefined ? "position" : "singleturn"]
      : ["multiturn", "singleturn"];
    if (singleturn !== undefined) {
      return { names, counts: 1n << BigInt(singleturn), turns: 1n << BigInt(multiturn ?? 0) };
    }
    return { names, counts: options.counts ?? null, turns: options.counts ? options.turns ?? 1n : null };
  }

  /** Return how many of the highest bits of the position count revolutions. */
  function turnBits({ names, counts, turns }, positionBits) {
    if (counts === null || turns === 1n) return 0;
    if (counts & (counts - 1n)) {
      const name = names.length > 1 ? "position" : names[0];
      throw new NoRecord(`'${name}' has ${counts} counts per revolution, so no bits of it are the revolutions`);
    }
    return Math.max(positionBits - ((counts - 1n) || "").toString(2).length, 0);
  }

  /** Return the parts of a field of the position: its highest bits, which count revolutions, and the bits below them. */
  function positionParts({ name, bits }, bitsOfTurns) {
    const singleturnBits = bits - bitsOfTurns;
    const turnsName = singleturnBits ? `${name}_turns` : name;
    return [
      ...(bitsOfTurns ? [{ name: turnsName, role: "multiturn", bits: bitsOfTurns, active: "" }] : []),
      ...(singleturnBits ? [{ name, role: "singleturn", bits: singleturnBits, active: "" }] : []),
    ];
  }

  /** Return the role of a field outside the position that follows from its kind. */
  function expectedRole({ kind, bits, value }, stage) {
    if (kind === "crc") return "crc";
    const isConstant = kind === "constant" || kind === "zero" || kind === "unused";
    if (isConstant && !value) return stage === "before" ? "before" : "after";
    return bits === 1 && (isConstant || kind === "flag") ? "status" : "other";
  }

  /** Return a part of the frame outside the position. Zero bits on either side of the position become padding. */
  function otherPart({ name, bits, kind, level }, role) {
    const isPadding = role === "before" || role === "after";
    const active = role === "status" && kind === "flag" ? level : "";
    return { name, role: isPadding ? "padding" : role, bits, active };
  }

  /** Return the role of a field in the order that masters expect. ``stage`` is the role that has been reached. */
  function roleOf(field, stage, names, fields) {
    if (names.includes(field.name)) {
      if (stage === "before" || stage === "position") return "position";
      throw new NoRecord(`the position is not in one piece: other bits are sent before '${field.name}'`);
    }
    const isBeforeEndOfPosition = fields.indexOf(field) < fields.findIndex(({ name }) => name === names.at(-1));
    if (stage === "position" && isBeforeEndOfPosition) {
      throw new NoRecord(`the position is not in one piece: '${field.name}' is sent within it`);
    }
    const role = expectedRole(field, stage);
    const possibleRoles = stage === "before" ? ["before"] : ROLES_AS_SENT.slice(ROLES_AS_SENT.indexOf(stage));
    if (possibleRoles.includes(role)) return role;
    return field.kind === "parity" && field === fields.at(-1) ? "parity" : "other";
  }

  /** Return the parts of the frame by their role for a master, in the order in which they are sent. */
  function frameParts(fields, names, bitsOfTurns) {
    let stage = "before";
    return fields.flatMap((field) => {
      const role = roleOf(field, stage, names, fields);
      if (ROLES_AS_SENT.includes(role)) stage = role;
      else if (stage === "position" || stage === "after") stage = "status";
      return role === "position" ? positionParts(field, bitsOfTurns[field.name]) : [otherPart(field, role)];
    });
  }

  /** Return the parts of a frame that no master can read. Their roles follow only from the kinds of the fields. */
  const roughParts = (fields, names, bitsOfTurns) => fields.flatMap((field) => {
    if (names.includes(field.name)) return positionParts(field, bitsOfTurns[field.name]);
    const role = expectedRole(field, "after");
    return [otherPart(field, role === "other" && field.kind === "parity" && field === fields.at(-1) ? "parity" : role)];
  });

  /** Return the numbers of bits of a frame, by their names in the rules for masters. */
  function bitCounts(parts) {
    const sumOf = (role, someParts = parts) => someParts.filter((part) => part.role === role)
      .reduce((sum, part) => sum + part.bits, 0);
    const left = parts.slice(0, parts.findIndex(({ role }) => role === "multiturn" || role === "singleturn"));
    const firstStatus = parts.findIndex(({ role }) => role === "status");
    const afterStatus = firstStatus < 0 ? [] : parts.slice(firstStatus);
    const position = sumOf("multiturn") + sumOf("singleturn");
    const data = position + sumOf("padding");
    return {
      multiturn_bits: sumOf("multiturn"), singleturn_bits: sumOf("singleturn"), position_bits: position,
      padding_left: sumOf("padding", left), padding_right: sumOf("padding") - sumOf("padding", left),
      data_bits: data, status_bits: sumOf("status"), data_and_status_bits: data + sumOf("status"),
      crc_bits: sumOf("crc"), other_bits_left: sumOf("other", left),
      other_bits_right: sumOf("other") - sumOf("other", left), other_bits_after_status: sumOf("other", afterStatus),
      parity_bits: sumOf("parity"), bits_without_crc: data + sumOf("status") + sumOf("other"),
      frame_bits: data + sumOf("status") + sumOf("crc") + sumOf("other"),
    };
  }

  /** Return the parameters of the CRC of a line, or zeros without a CRC. */
  function crcNumbers(crc) {
    const polynomial = crc ? crc.poly | (1n << BigInt(crc.bits)) : 0n;
    return {
      crc_polynomial: polynomial, crc_polynomial_without_top_bit: crc?.poly ?? 0n,
      crc_polynomial_without_last_1: polynomial >> 1n, crc_start: crc?.init ?? 0n,
      crc_inverted: crc?.isInverted ? 1n : 0n,
    };
  }

  /** Return the parts of the frame, and why no master can read the position, or "". */
  function partsAndObstacle(fields, measurement, positionFields) {
    const { names } = measurement;
    let bitsOfTurns = Object.fromEntries(names.map((name) => [name, 0]));
    try {
      let remainingBits = turnBits(measurement, positionFields.reduce((sum, { bits }) => sum + bits, 0));
      for (const { name, bits } of positionFields) {
        bitsOfTurns[name] = Math.min(bits, remainingBits);
        remainingBits -= bitsOfTurns[name];
      }
      return [frameParts(fields, names, bitsOfTurns), ""];
    } catch (error) {
      if (!(error instanceof NoRecord)) throw error;
      return [roughParts(fields, names, bitsOfTurns), `No master described here can read the position: ${error.message}.`];
    }
  }

  /** Return the facts that are words, by their names in the rules for masters. */
  function lineWords(line, fields, parts, numbers) {
    const levels = new Set(parts.filter(({ role }) => role === "status").map(({ active }) => active || "low"));
    const { singleturn_bits: singleturnBits, counts_per_turn: counts } = numbers;
    const hasAllCodes = counts === 1n << singleturnBits;
    const lastField = fields.at(-1);
    return {
      interface: line.interface, movement: "rotary", coding: line.options.isGray ? "gray" : "binary",
      status_active: levels.size > 1 ? "mixed" : [...levels][0] ?? "none",
      parity: parts.at(-1).role === "parity" ? (lastField.isOdd ? "odd" : "even") : "none",
      singleturn_codes: counts === null ? "unknown" : hasAllCodes ? "all" : "some",
    };
  }

  /** Return notes on a signed position, and on status bits and unused bits that a master may take for others. */
  function lineNotes(fields, positionFields, parts) {
    const paddingNames = parts.filter(({ role }) => role === "padding").map(({ name }) => name);
    const unusedNames = fields.filter(({ kind, name }) => kind === "unused" && paddingNames.includes(name))
      .map(({ name }) => `'${name}'`);
    const verdicts = fields.filter(({ kind }) => kind === "flag").map(({ verdict }) => verdict);
    const firstWarning = verdicts.indexOf("usable_with_warning");
    const firstError = verdicts.indexOf("not_usable");
    const [{ isSigned, bits }] = positionFields;
    const half = 1n << BigInt(bits - 1);
    const fixedBits = parts.filter(({ role, active }) => role === "status" && !active).map(({ name }) => name);
    return [
      ...(isSigned && positionFields.length === 1 ? [
        `The position is signed, in two's complement: ${-half} to ${half - 1n}. A master that reads it as unsigned `
        + `shows -1 as ${2n * half - 1n}.`] : []),
      ...(fixedBits.length ? [
        `${fixedBits.join(" and ")}: always 1, which a master treats as an inactive status bit.`] : []),
      ...(unusedNames.length ? [
        `Masters take ${unusedNames.join(" and ")} as zero bits. If the encoder sends ones there, a master may read a `
        + "wrong position."] : []),
      ...(firstWarning >= 0 && firstWarning < firstError ? [
        "A warning bit is sent before the error bit. Masters that expect the error bit first take one for the other."]
        : []),
    ];
  }

  /** Return the record of an encoder in one line. ``line`` is what ``parsedLine`` returns. */
  function recordOfLine(line, data) {
    const { interface: name, text: code, options } = line;
    if (!(name in data.line.records)) {
      throw new NoRecord(`${code} has the interface ${data.interfaces[name]}; ${data.line.other_interfaces}`);
    }
    const fields = namedFields(line);
    const measurement = measurementOf(line);
    const positionFields = measurement.names.flatMap((wanted) => fields.filter((field) => field.name === wanted));
    if (!positionFields.length) {
      throw new NoRecord(`no frame of ${data.interfaces[name]} carries '${measurement.names[0]}'`);
    }
    const [parts, obstacle] = partsAndObstacle(fields, measurement, positionFields);
    const counts = Object.fromEntries(
      Object.entries(bitCounts(parts)).map(([countName, count]) => [countName, BigInt(count)]));
    const { turns } = measurement;
    const mostTurns = 1n << counts.multiturn_bits;
    const unknownNumbers = readRecord(data.line.records[name]).numbers;
    const numbers = {
      ...unknownNumbers, ...counts, ...crcNumbers(line.fields.find(({ kind }) => kind === "crc")),
      counts_per_turn: measurement.counts, turns: turns !== null && turns > mostTurns ? mostTurns : turns,
    };
    return {
      ...readRecord(data.line.records[name]), code, parts, numbers, obstacle,
      words: lineWords(line, fields, parts, numbers), used_hz: options.clock ? [options.clock] : [],
      notes: [...lineNotes(fields, positionFields, parts), ...(obstacle ? [obstacle] : [])],
    };
  }

  globalThis.codewheelMaster = {
    ...globalThis.codewheelMaster, NoRecord, limitToCable, readRecord, recordOfLine };
}
