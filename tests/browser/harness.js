// Runs cases through decode.js, in a browser or in Node, and compares the results by a CRC-32 of their text.
(() => {
  "use strict";

  const wheel = globalThis.codewheelDecode;
  const remainders = Array.from({ length: 256 }, (_, byte) => {
    let found = byte;
    for (let bit = 0; bit < 8; bit += 1) found = found & 1 ? (found >>> 1) ^ 0xedb88320 : found >>> 1;
    return found;
  });

  function crc32(text) {
    let found = 0xffffffff;
    for (const byte of new TextEncoder().encode(text)) found = (found >>> 8) ^ remainders[(found ^ byte) & 0xff];
    return (~found >>> 0).toString(16).padStart(8, "0");
  }

  /** Return the order code of a case, with its own values of everything that an order code or a register sets. */
  function foundFor(item) {
    const family = wheel.table.families.find((one) => one.name === item.family);
    const given = Object.fromEntries(Object.entries(item.given).map(([name, value]) => [name, BigInt(value)]));
    return { code: item.code, family, interface: family.interfaces.find((one) => one.name === item.interface), parameters: given };
  }

  function decoded(found, item, text) {
    const register = (found.interface.registers ?? []).find((one) => one.name === item.register);
    if (register) return wheel.decodeRegister(found, register, text);
    if (!item.layout) return wheel.decodeFrame(found, item.sender, text);
    const layout = found.interface.frames.find((one) => one.name === item.layout);
    const at = wheel.placedFor(found, layout);
    return layout.order ? wheel.decodeBytes(at, wheel.bytesIn(text)) : wheel.decodeBits(at, wheel.numberIn(text, at.bits));
  }

  function textOf(decoded_) {
    const row = (...values) => values.join("\t");
    const quantity = (one) => (one.scale ? wheel.quantityOf(one.scale, one.value) : "");
    return [
      decoded_.placedLayout ? decoded_.placedLayout.name : "",
      ...decoded_.problems.map((one) => row("problem", one.fault, one.field, one.message)),
      ...decoded_.fields.map((one) => row(one.name, one.raw, one.value, one.unit, quantity(one), one.meaning,
        one.high, one.low)),
      decoded_.crc ? row("crc", decoded_.crc.received, decoded_.crc.computed) : "no crc",
      ...decoded_.reports.map((one) => row("report", one.flag, one.meaning, one.remedy ?? "", one.source ?? "")),
      row("verdict", decoded_.verdict ?? ""),
      ...decoded_.differences.map((one) => row("difference", one)),
    ].join("\n");
  }

  function decodingText(item, text) {
    const found = foundFor(item);
    try {
      return textOf(decoded(found, item, text));
    } catch (error) {
      return `${error.constructor.name}: ${error.message}`;
    }
  }

  /** Return the differences: the text of the frame, and its result here. */
  function compared(item) {
    const wrong = [];
    item.frames.forEach((text, place) => {
      const said = decodingText(item, text);
      if (crc32(said) !== item.expected[place]) wrong.push([item.name, text, said]);
    });
    return wrong;
  }

  /** Return the result of a text for an order code: errors, the values of the fields, and the expected CRC. */
  function values(item) {
    const label = wheel.findCode(item.code);
    const register = (label.interface.registers ?? []).find((one) => one.name === item.register);
    const found = register ? wheel.decodeRegister(label, register, item.text)
      : wheel.decodeFrame(label, item.sender, item.text, {}, item.answers);
    return {
      layout: found.placedLayout ? found.placedLayout.name : "",
      faults: found.problems.map((one) => one.fault),
      fields: Object.fromEntries(found.fields.map((one) => [one.name, `${one.value}`])),
      reports: found.reports.map((one) => one.flag),
      verdict: found.verdict,
      dead: wheel.deadLine(found),
      others: register ? [] : wheel.otherFrames(label, item.sender.split(":")[0], item.text, found, {}, item.answers)
        .map((at) => at.name),
    };
  }

  /** Return a text as bytes or as a number, or that it is refused. */
  function readings(item) {
    const read = (function_) => {
      try {
        return JSON.stringify(function_(wheel.checked(item.text)), (_, one) => (typeof one === "bigint" ? `${one}` : one));
      } catch (error) {
        return error instanceof wheel.FrameText ? "refused" : `${error}`;
      }
    };
    return [read(wheel.bytesIn), read((text) => wheel.numberIn(text, 36))];
  }

  /** Return the order code that a label is read as, or the help for a wrong one. */
  function label(text) {
    try {
      const found = wheel.readLabel(text);
      return [found.family.name, found.code, found.unlisted, found.tail, found.isSpecial, found.writtenAsIn];
    } catch (error) {
      if (error instanceof wheel.UnknownCode) return error.message;
      throw error;
    }
  }

  /** Return the result of each line of a text for an order code: the time, and the decoded frame or the reason for
   * refusal. */
  function lines(item) {
    const found = wheel.readLabel(item.code);
    const register = (found.interface.registers ?? []).find((one) => one.name === item.register);
    const one = (text) => {
      try {
        return textOf(register ? wheel.decodeRegister(found, register, text) : wheel.decodeFrame(found, "encoder", text));
      } catch (error) {
        if (error instanceof wheel.FrameText) return error.message;
        throw error;
      }
    };
    const inputLines = wheel.linesOf(item.text);
    const frames = register ? inputLines : wheel.splitIntoWords(inputLines, found, "encoder", {}, {});
    return frames.map((line) => [line.number, line.time, one(line.text)]);
  }

  /** Return the record of each line, or its problems. */
  function records(item) {
    return item.texts.map((text) => {
      const line = wheel.parsedLine(text);
      return line.problems.length ? { problems: line.problems } : wheel.lineFamily(line);
    });
  }

  /** Return each line as the form writes it again. */
  const builtLines = (item) => item.texts.map((text) => wheel.builtLine(wheel.formOf(text)));

  const labels = (item) => item.texts.map(label);

  /** Return the encoded register: its bytes, or that it is refused. */
  function encoded(item) {
    const found = foundFor(item);
    const register = found.interface.registers.find((one) => one.name === item.register);
    const at = wheel.placedFor(found, register);
    const limits = (register.limits ?? [])[0];
    return item.rows.map((row) => {
      const values = Object.fromEntries(Object.entries(row).map(([name, value]) =>
        [name, typeof value === "number" || /^-?\d+n$/.test(value) ? BigInt(`${value}`.replace("n", "")) : value]));
      try {
        return wheel.bytesFor(at, values, limits);
      } catch (error) {
        return error instanceof wheel.Refusal ? "refused" : `${error}`;
      }
    });
  }

  /** Return the mistakes that are listed for a frame, the missing part, whether a CRC can contradict the frame, whether
   * another frame helps, and the bits that may be disturbed. */
  function reasons(item) {
    return item.frames.map((text) => {
      const found = decoded(foundFor(item), item, text);
      const explanations = wheel.explained(found);
      const mistakes = explanations.map((one) => [one.text, `${one.oneIn}`,
        (one.number === undefined ? [] : [one.number, ...one.orNumbers ?? []]).flatMap((number) => (
          wheel.numbersRead(one.placedLayout ?? found.placedLayout, number).map(([name, value]) => `${name} ${value}`))),
        (one.parts ?? []).map((pair) => pair.join(" "))]);
      const isWithCrc = mistakes.length > 0 && wheel.canCrcContradict(found);
      const disturbedBits = wheel.deadLine(found) ? [] : wheel.findDisturbedBits(found);
      return [mistakes, wheel.missingPart(found), isWithCrc, wheel.anotherHelps(explanations), disturbedBits];
    });
  }

  /** Return other readings of the positions in frames, and the request that each frame also is. */
  const doubts = (item) => {
    const found = foundFor(item);
    return item.frames.map((text) => decoded(found, item, text)).map((one) => [
      wheel.otherPositions(one, found.interface.measure).map(([words, position]) => [words, `${position}`]),
      wheel.ownRequest(one)]);
  };

  /** Return the mistakes in several frames, the number of frames that fail, and whether all frames have the mistakes. */
  function together(item) {
    const found = foundFor(item);
    const decodedFrames = item.frames.map((text) => {
      if (!item.frameType) return decoded(found, item, text);
      const one = wheel.decodeFrame(found, item.frameType, text);
      const others = () => wheel.otherFrames(found, item.sender, text, one, {}, {});
      return { ...one, isOfOtherKind: one.problems.length > 0 && wheel.isAnotherFrame(one, others()) };
    });
    const { mistakes, failedCount, isOfAll } = wheel.judgeFrames(decodedFrames);
    return [mistakes.map((one) => [one.text, one.frames, `${one.oneIn}`]), failedCount, isOfAll];
  }

  /** Return the order codes for which a text is a valid frame. */
  const inferred = (item) => wheel.inferred(item.text).map((group) => [group.decoded.placedLayout.name, group.codes]);

  /** Return the message about a text that is not a frame of any order code. */
  const unread = (item) => wheel.notOfAnyCode(item.text);

  /** Compared frames, or the values of a text, for one start of a browser. */
  const answered = (item) => (item.frames ? compared(item) : values(item));

  globalThis.codewheelTests = { answered, builtLines, compared, values, readings, encoded, reasons, together, doubts, inferred, labels, lines, records, unread };
})();
