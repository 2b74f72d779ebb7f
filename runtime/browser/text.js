// License 0BSD: use, modify and distribute this file without any condition.
// Parsing of frames and labels, and inference of order codes from a frame.

/** The error for a text that is not a frame. It says how to write the frame, in words and as ``spellings`` to pick. */
class FrameText extends Error {
  constructor(message, spellings = []) {
    super(message);
    this.spellings = spellings;
  }
}

/** Most bits of a frame over BiSS, SSI and SPI. */
const MOST_FRAME_BITS = 128;
/** Number of digits from which a piece of digits is not a byte in hexadecimal. */
const FEWEST_DIGITS_OF_NUMBER = 3;
const LONGEST_QUOTE = TABLE.limits.quote;
/** Return a text in quotes, with ... after its first characters if it is long, and with escapes for invisible ones. */
function quoteText(text) {
  const characters = [...text.replace(/[\p{Cc}\p{Cf}\p{Cs}\p{Zl}\p{Zp}]/gu, escapeCharacter)];
  const isLong = characters.length > LONGEST_QUOTE;
  return isLong ? `'${characters.slice(0, LONGEST_QUOTE - 3).join("")}...'` : `'${characters.join("")}'`;
}

/** Return the escape of an invisible character, such as \u200b of a zero-width space. */
function escapeCharacter(character) {
  if (character === "\t") return "\\t";
  const code = character.codePointAt(0);
  const [letter, digitCount] = code < 0x100 ? ["x", 2] : code < 0x10000 ? ["u", 4] : ["U", 8];
  return `\\${letter}${code.toString(16).padStart(digitCount, "0")}`;
}

/** Spellings of programs and logs, and their replacement. */
const PASTED_SPELLINGS = TABLE.notations.pasted.map(
  ([pattern, replacement]) => [new RegExp(pattern, "g"), replacement]);
/** Blanks that only Python or only JavaScript removes from the ends of a text, such as a byte order mark. */
const ODD_BLANKS = new RegExp(TABLE.notations.odd_blanks, "g");
/** A time in front of a frame. */
const LEADING_TIME = new RegExp(`^${TABLE.notations.time}`);
/** Return whether a text has a notation of the table, such as "decimal". */
const hasNotation = (name, text) => new RegExp(`^(?:${TABLE.notations[name]})$`).test(text);

/**
 * Return the frames in a text, one per line, as {number, time, text, offset} with the ``offset`` of the text in its
 * line. Comments after # and empty lines are skipped.
 */
function linesOf(input) {
  return input.split(/\r\n|\r|\n/).flatMap((line, lineIndex) => {
    const beforeComment = line.replace(ODD_BLANKS, " ").split("#")[0].trimEnd();
    const timeAndFrame = beforeComment.trimStart();
    const timeMatch = LEADING_TIME.exec(timeAndFrame);
    const frameText = timeMatch ? timeAndFrame.slice(timeMatch[0].length) : timeAndFrame;
    const offset = beforeComment.length - frameText.length;
    return frameText ? [{ number: lineIndex + 1, time: timeMatch?.[1] ?? "", text: frameText, lineIndex, offset }] : [];
  });
}

/** Return the text of a frame without brackets, quotes and other marks of the program that it was copied from. */
function checked(text) {
  if (text.length > TABLE.limits.text) throw new FrameText(messageFor("frame_too_long"));
  // An array of numbers without a prefix is decimal in every programming language.
  const [array] = /(?:^|[[({])\s*[0-9]+\s*,.*/s.exec(text) ?? [];
  const arrayPieces = array?.split(/[\s'",;[\](){}<>]+/).filter(Boolean) ?? [];
  if (array) rejectDecimalBytes(text, arrayPieces);
  // Single digits are the same byte in decimal and in hex. Zeros and ones may be bits.
  const areSingleDigits = arrayPieces.every((piece) => /^[0-9]$/.test(piece)) && /[2-9]/.test(arrayPieces.join(""));
  const textOfBytes = areSingleDigits
    ? text.slice(0, -array.length) + arrayPieces.map((piece) => `0${piece}`).join(" ") : text;
  const plainText = PASTED_SPELLINGS.reduce(
    (cleaned, [pattern, replacement]) => cleaned.replace(pattern, replacement), textOfBytes).trim();
  if (!plainText) throw new FrameText(messageFor("frame_empty"));
  return plainText;
}

/** Throw the error for pieces of ``text`` that can be bytes in decimal, unless they may be bits, as digits.py does. */
function rejectDecimalBytes(text, pieces) {
  const canBeDecimal = pieces.length > 1 && pieces.every((piece) => /^(0|[1-9][0-9]{0,2})$/.test(piece) && piece < 256);
  if (!canBeDecimal || /^[01]+$/.test(pieces.join("")) || pieces.every((piece) => piece.length === 1)) return;
  const write = (bytePieces) => bytePieces.map((piece) => piece.toUpperCase().padStart(2, "0")).join(" 0x");
  const decimalText = `0x${write(pieces.map((piece) => Number(piece).toString(16)))}`;
  const canBeHex = pieces.every((piece) => piece.length < FEWEST_DIGITS_OF_NUMBER);
  const meanings = [
    messageFor("if_decimal", decimalText), ...(canBeHex ? [messageFor("if_hex", write(pieces))] : [])];
  throw new FrameText(messageFor("decimal_bytes", quoteText(text), meanings.join(", ")));
}

/** Return whether a piece of several digits begins with 0. */
const hasLeadingZero = (pieces) => pieces.some((piece) => piece.length > 1 && piece[0] === "0");

/**
 * Return the text of a number of ``bitCount`` bits with 0b or 0x if its digits have only one meaning, and otherwise as
 * it is. The command line has the same rules, in digits.py.
 */
function withPrefix(text, bitCount) {
  const pieces = text.replaceAll("_", "").trim().split(/\s+/);
  const areDigits = pieces.every((piece) => /^[0-9a-f]+$/i.test(piece));
  if (!areDigits || /^0?b[01]+$/i.test(pieces.join(""))) return text;
  if (/^[01]+$/.test(pieces.join(""))) {
    const digits = binaryDigits(pieces, bitCount);
    return digits ? `0b${digits}` : text;
  }
  if (pieces.length === 1) return hasNotation("decimal", pieces[0]) ? text : `0x${pieces[0]}`;
  const bytePieces = withLeadingZeros(pieces);
  return bytePieces.every((piece) => piece.length % 2 === 0) ? bytePieces.map((piece) => `0x${piece}`).join(" ") : text;
}

/** Return the bits of a number in pieces of zeros and ones, or "" if the pieces may also be hex or decimal. */
function binaryDigits(pieces, bitCount) {
  const digits = pieces.join("");
  if (digits.length === bitCount) return digits;
  const lengths = new Set(pieces.map((piece) => piece.length));
  const longest = Math.max(...lengths);
  if (longest === 1 && pieces.length > Math.ceil(bitCount / 8)) return digits;
  if (pieces.length === 1 || longest <= 2) return "";
  const mayBeHexWords = pieces.every((piece) => piece.length === 4) && digits.length <= 2 * Math.ceil(bitCount / 8);
  if (mayBeHexWords) return "";
  const lacksZeros = lengths.size > 1 && longest <= 8 && !hasLeadingZero(pieces);
  return lacksZeros ? pieces.map((piece) => piece.padStart(8, "0")).join("") : digits;
}

/** Return bytes in hex or binary, of a program that omits leading zeros, as two hex digits each. */
function withLeadingZeros(pieces) {
  const lengths = pieces.map((piece) => piece.length);
  const longest = Math.max(...lengths);
  if (pieces.every((piece) => /^[01]+$/.test(piece))) {
    const areBytes = pieces.length > 1 && longest >= 3 && longest <= 8;
    const cannotBeHex = lengths.some((length) => length % 2) || lengths.every((length) => length === 8);
    return areBytes && cannotBeHex
      ? pieces.map((piece) => formatBytes([parseInt(piece, 2)])) : pieces;
  }
  const arePrefixedBytes = pieces.length > 1 && pieces.every((piece) => /^0b[01]{1,8}$/i.test(piece));
  if (arePrefixedBytes && longest === 10) return pieces.map((piece) => formatBytes([parseInt(piece.slice(2), 2)]));
  return longest === 2 && !hasLeadingZero(pieces) ? pieces.map((piece) => piece.padStart(2, "0")) : pieces;
}

/** Return whether a piece is a number in binary with its prefix. */
const isBinaryNumber = (piece) => /^0b[01]+$/i.test(piece);

/** Return whether pieces are several numbers that cannot be one frame of ``bitCount`` bits, as digits.py does. */
function areSeveralNumbers(pieces, bitCount) {
  if (withLeadingZeros(pieces).filter(isBinaryNumber).length > 1) return true;
  const digits = pieces.join("");
  const areLongDigits = /^[0-9]*[2-9][0-9]*$/.test(digits)
    && pieces.some((piece) => piece.length >= FEWEST_DIGITS_OF_NUMBER);
  return pieces.length > 1 && areLongDigits && digits.length > 2 * Math.ceil(bitCount / 8);
}

/** Return the numbers of hex bytes, which are written in pieces of whole bytes. */
function bytesIn(text) {
  const pieces = withLeadingZeros(text.split(/\s+/));
  const areBinary = pieces.filter(isBinaryNumber).length > 1;
  const typedPieces = text.split(/\s+/);
  if (typedPieces.some((piece) => piece.length === FEWEST_DIGITS_OF_NUMBER)) rejectDecimalBytes(text, typedPieces);
  return pieces.flatMap((piece) => {
    const digits = piece.replace(/^0x/i, "");
    if (areBinary || !/^[0-9a-f]+$/i.test(digits)) throw new FrameText(messageFor("not_hex", quoteText(piece)));
    const evenDigits = digits !== piece && digits.length === 1 ? `0${digits}` : digits;
    if (evenDigits.length === 1) throw new FrameText(messageFor("one_digit", quoteText(piece), digits));
    if (evenDigits.length % 2) {
      const isAboveByte = pieces.length > 1 && digits === piece && /^[0-9]+$/.test(digits) && Number(digits) > 255;
      throw new FrameText(messageFor(isAboveByte ? "above_byte" : "odd", quoteText(piece)));
    }
    return evenDigits.match(/../g).map((byte) => parseInt(byte, 16));
  });
}

/**
 * Read one number of ``bitCount`` bits: 0b with all leading zeros, or 0x or hex bytes, which imply them.
 * If ``areBytesExact``, bytes of another length have exactly the bits that are written.
 */
function numberIn(text, bitCount, areBytesExact) {
  if (areSeveralNumbers(text.replaceAll("_", "").trim().split(/\s+/), bitCount)) {
    const typedPieces = text.split(/\s+/);
    const isWholeFrame = typedPieces.length === countBytes(bitCount) && typedPieces.every((piece) => /^[0-9]+$/.test(piece));
    if (isWholeFrame && numberOf("big", typedPieces.map(Number)) >> BigInt(bitCount) === 0n) {
      rejectDecimalBytes(text, typedPieces);
    }
    throw new FrameText(messageFor("no_bits", quoteText(text), bitCount, messageFor("write_separately", bitCount)));
  }
  const prefixedText = withPrefix(text, bitCount);
  let compactText = prefixedText.replace(/[\s_]/g, "");
  if (/^0b[01]+$/i.test(compactText)) return makeTypedFrame(compactText, compactText.length - 2, true);
  const pieces = prefixedText.split(/\s+/);
  const isPieceOfBytes = (piece) => /^(0x)?([0-9a-f]{2})+$/i.test(piece);
  if (pieces.length > 1 && pieces.every(isPieceOfBytes)) {
    if (pieces.every((piece) => /^[01]+$/.test(piece))) throw new FrameText(messageFor("bits_or_bytes", quoteText(text)));
    compactText = "0x" + pieces.map((piece) => piece.replace(/^0x/i, "")).join("");
    const writtenBits = 4 * (compactText.length - 2);
    if (areBytesExact && (writtenBits < bitCount || writtenBits >= bitCount + 8)) return makeTypedFrame(
      compactText, writtenBits, true);
  }
  if (/^0x[0-9a-f]+$/i.test(compactText)) {
    return {
      ...makeTypedFrame(compactText, bitLength(BigInt(compactText)), false), written: 4 * (compactText.length - 2),
      isBytes: pieces.length > 1 && pieces.every(isPieceOfBytes),
    };
  }
  rejectDecimalBytes(text, pieces);
  const meanings = pieces.length === 1 ? listMeanings(compactText, bitCount) : [];
  // Hex digits with one meaning already have a prefix, unless it is misspelt.
  if (meanings.length === 1 && /^[0-9]+$/.test(compactText)) {
    const areBits = meanings[0] === messageFor("if_bits", compactText);
    return areBits ? makeTypedFrame(`0b${compactText}`, compactText.length, true)
      : { ...makeTypedFrame(compactText, bitLength(BigInt(compactText)), false), written: 0 };
  }
  const isLongNumber = pieces.length === 1 && hasNotation("long_number", compactText);
  const remedies = meanings.length || !isLongNumber ? meanings
    : [messageFor("if_decimal", `0x${hexDigits(BigInt(compactText))}`), messageFor("if_hex", compactText)];
  const remedy = remedies.length ? messageFor("write_one_of", remedies.join(", ")) : messageFor("write_number", bitCount);
  const spellings = remedies.map((remedyText) => remedyText.split(" ")[0]);
  throw new FrameText(messageFor("no_bits", quoteText(text), bitCount, remedy), spellings);
}

/**
 * Return a typed frame: its number with its bits. Unless ``exact``, it may have more. ``written`` counts the bits of
 * all digits, or is 0 for a decimal number. ``isBytes`` is true for several bytes, which usually have all their zeros.
 */
const makeTypedFrame = (text, bitCount, isExact) => ({
  number: BigInt(text), bits: bitCount, exact: isExact, written: bitCount, isBytes: false,
});

/**
 * List the possible meanings of digits that have lost their 0x or 0b, as numbers of at most ``bitCount`` bits.
 * The command line does the same.
 */
function listMeanings(digits, bitCount) {
  const fits = (number) => number >> BigInt(bitCount) === 0n;
  const isDecimal = hasNotation("decimal", digits) && fits(BigInt(digits));
  const isHexadecimal = hasNotation("hexadecimal", digits) && fits(BigInt(`0x${digits}`));
  return [
    ...(isDecimal ? [messageFor("if_decimal", `0x${hexDigits(BigInt(digits))}`)] : []),
    ...(isHexadecimal ? [messageFor("if_hex", digits)] : []),
    ...(hasNotation("bits", digits) ? [messageFor("if_bits", digits)] : []),
  ];
}

/** The message about a text that is not a valid frame of any order code: how to write it, if that is the reason. */
function notOfAnyCode(text) {
  let plainText;
  try {
    plainText = checked(text);
  } catch (error) {
    if (error instanceof FrameText) return error.message;
    throw error;
  }
  const isReadable = (parse) => {
    try {
      parse(plainText, MOST_FRAME_BITS);
      return true;
    } catch (error) {
      if (error instanceof FrameText) return false;
      throw error;
    }
  };
  const hasMeanings = /^[0-9a-f]+$/i.test(plainText) && withPrefix(plainText, MOST_FRAME_BITS) === plainText;
  const meanings = hasMeanings ? listMeanings(plainText, MOST_FRAME_BITS).join(", ") : "";
  const remedy = meanings ? messageFor("write_one_of", meanings) : messageFor("write_any");
  if (!isReadable(numberIn) && !isReadable(bytesIn)) return messageFor("no_order_code", quoteText(plainText), remedy);
  return `this frame is not valid for any order code${meanings ? `. ${remedy}` : ""}`;
}

/** Return the digits of one binary number for a frame of ``bitCount`` bits in bytes, or "" for any other text. */
function bitsOfBytes(text, bitCount, lineCarriesBytes) {
  const [, prefix, digits] = /^(0b)?([01]*)$/i.exec(text.replaceAll("_", "")) ?? [];
  if (!digits || (prefix && !lineCarriesBytes)) return digits ?? "";
  const areBits = digits.length > Math.max(Math.floor(bitCount / 4), 8) && digits.length <= bitCount;
  const hasAllBits = digits.length === bitCount && digits.includes("1");
  return areBits && (hasAllBits || (lineCarriesBytes && digits[0] === "1")) ? digits : "";
}

/** Return the bytes of a frame in bytes: hex text, or one binary number of the bits sent, or of the bytes in order. */
function placedBytes(placedLayout, text, lineCarriesBytes) {
  const sentBits = placedLayout.bits - (placedLayout.layout.fill ?? 0);
  const digits = bitsOfBytes(text, sentBits, lineCarriesBytes);
  if (!digits) return bytesIn(text);
  const bytes = digits.padStart(placedLayout.bits, "0").match(/.{8}/g).map((byte) => parseInt(byte, 2));
  if (lineCarriesBytes) return placedLayout.layout.order === "little" ? bytes.reverse() : bytes;
  if (digits.length !== sentBits) {
    throw new FrameText(
      messageFor("no_bits", quoteText(text), sentBits, messageFor("write_bits", sentBits, placedLayout.bits / 8)));
  }
  return bytes;
}

/** Return the parameters of an order code by name, from the contents of registers and the answers of the user. */
function computeParameters(orderCode, registerContents = {}, answers = {}) {
  const parameters = mergeByName(orderCode.parameters, registerContents);
  for (const alternative of orderCode.family.alternatives ?? []) {
    const answer = alternative.answers.find(([answerName]) => answerName === answers[alternative.name]);
    const numberByParameter = answer?.[2] ?? {};
    for (const [name, number] of Object.entries(numberByParameter)) parameters[name] = toBigInt(number);
  }
  return resolveParameters(orderCode.family, parameters);
}

/** Place the fields of a layout for an order code, with the contents of registers and the answers of the user. */
function placedFor(orderCode, layout, registerContents, answers) {
  return {
    ...placeLayout(orderCode.family, layout, computeParameters(orderCode, registerContents, answers)),
    code: orderCode.code,
  };
}

/** Return the layouts of a sender such as "encoder", or only the one with the name in "encoder:NAME". */
function layoutsOf(interface_, senderAndName) {
  const [sender, layoutName] = senderAndName.split(":");
  return interface_.frames.filter(
    (layout) => layout.sender === sender && (!layoutName || layout.name === layoutName));
}

/**
 * Decode the frame in a text. ``orderCode`` is {code, family, interface, parameters}. ``senderAndName`` is "encoder" or
 * "master", with a colon and the name of the frame where that is needed.
 */
function decodeFrame(orderCode, senderAndName, text, registerContents, answers) {
  const [sender, layoutName] = senderAndName.split(":");
  const layouts = layoutsOf(orderCode.interface, senderAndName);
  if (!layouts.length) {
    throw new FrameText(`the spec does not describe a frame from the ${sender} over ${orderCode.interface.title}`);
  }
  const [interface_, plainText] = [orderCode.interface, checked(text)];
  const wholeFrame = sender === "encoder" && !layoutName
    ? decodeChannels(orderCode, plainText, registerContents, answers) : null;
  if (wholeFrame) return { ...wholeFrame, interface: interface_ };
  if (!layouts[0].order) {
    const haveLengths = interface_.exact?.includes(sender);
    const placedLayouts = layouts.map((layout) => placedFor(orderCode, layout, registerContents, answers));
    const placedLayout = haveLengths ? findLayoutOfLength(placedLayouts, plainText) : placedLayouts[0];
    return { ...decodeBits(placedLayout, numberIn(plainText, placedLayout.bits, haveLengths)), interface: interface_ };
  }
  const firstLayout = placedFor(orderCode, layouts[0], registerContents, answers);
  const bytes = placedBytes(firstLayout, plainText, interface_.name === "rs485");
  const layoutOrFailure = layoutName ? { layout: layouts[0] } : identifyLayout(orderCode.interface, sender, bytes);
  const decoded = layoutOrFailure.layout
    ? decodeBytes(placedFor(orderCode, layoutOrFailure.layout, registerContents, answers), bytes) : layoutOrFailure;
  return { ...decoded, receivedBytes: bytes, interface: interface_, orderCode, sender };
}

/** Return the first layout, unless the text has another length and only one other layout has that length. */
function findLayoutOfLength(placedLayouts, text) {
  const hasLength = ({ bits }) => mayHaveBits(numberIn(text, bits, true), bits);
  const [firstLayout] = placedLayouts;
  const fittingLayouts = hasLength(firstLayout) ? [firstLayout] : placedLayouts.filter(hasLength);
  return fittingLayouts.length === 1 ? fittingLayouts[0] : firstLayout;
}

/** Return the placed layouts of the other frames that a text can be, if no field tells the frames apart. */
function otherFrames(orderCode, sender, text, decoded, registerContents, answers) {
  if (!decoded.placedLayout || findSelector(orderCode.interface, sender)) return [];
  const hasOtherLength = decoded.problems.some((problem) => problem.fault === "length");
  return layoutsOf(orderCode.interface, sender).filter((layout) => layout !== decoded.placedLayout.layout
    && !layout.order === !decoded.placedLayout.layout.order
    && !layout.asks?.some((question) => !(question in answers))).flatMap((layout) => {
    try {
      const { placedLayout, problems } = decodeFrame(
        orderCode, `${sender}:${layout.name}`, text, registerContents, answers);
      // Hex digits imply leading zeros, so without this, a short frame would be valid as a long frame.
      const mayHaveLength = hasOtherLength || placedLayout.bits === decoded.placedLayout.bits;
      return !problems.length && mayHaveLength ? [placedLayout] : [];
    } catch (error) {
      if (error instanceof FrameText) return [];
      throw error;
    }
  });
}

/**
 * Return a typed frame, or the first bits of one if bytes are missing: they usually have all their zeros, unless the CRC
 * proves otherwise. ``padded`` is then a valid frame with more zeros, if any. The command has the same rule, in frames.py.
 */
function asFirstBits(placedLayout, typedFrame) {
  const { number, bits, written, exact, isBytes } = typedFrame;
  // A program may have printed bits that begin with a 1 without their leading zeros.
  const mayLackZeros = exact && bits < placedLayout.bits && bitLength(number) === bits;
  if (!mayLackZeros && (exact || !isBytes || written / 8 >= countBytes(placedLayout.bits))) return typedFrame;
  const isValid = !decode(placedLayout, number).problems.length;
  if (mayLackZeros) {
    return { ...typedFrame, padded: isValid ? `0b${number.toString(2).padStart(placedLayout.bits, "0")}` : "" };
  }
  if (isValid && placedLayout.crc) return typedFrame;
  const padded = isValid ? `0x${hexDigits(number).padStart(Math.ceil(placedLayout.bits / 4), "0")}` : "";
  return { ...typedFrame, bits: written, exact: true, padded };
}

/** Decode a frame of bits. ``asTyped`` is {number, bits, exact, written}, as ``numberIn`` returns it. */
function decodeBits(placedLayout, asTyped) {
  const typedFrame = asFirstBits(placedLayout, asTyped);
  const { number, bits, exact, isBytes, written } = typedFrame;
  const hasOtherBitCount = exact && bits !== placedLayout.bits;
  const hasTooManyBytes = !exact && isBytes && number >> BigInt(placedLayout.bits) !== 0n;
  return {
    ...(hasOtherBitCount || hasTooManyBytes
      ? createLengthError(placedLayout, `${placedLayout.bits} bits`, exact ? bits : written)
      : decode(placedLayout, number)),
    typedFrame,
  };
}

/** Return the selector that identifies the frames of a sender, if they have one. */
const findSelector = (interface_, sender) => interface_.told?.find((selector) => selector.sender === sender);

/** Return {layout} of the frame that the selector in these bytes identifies, or else a result with the problem. */
function identifyLayout(interface_, sender, bytes) {
  const selector = findSelector(interface_, sender);
  if (!selector) return { layout: layoutsOf(interface_, sender)[0] };
  const fallbackLayout = interface_.frames[selector.fallback];
  if (bytes.length < selector.needs) {
    const message = messageFor("too_few_bytes", countWithNoun(bytes.length, "byte"));
    return fallbackLayout ? { layout: fallbackLayout } : makeFailedFrame("length", "", message);
  }
  const selectorValue = selector.pieces.reduce(
    (bitsSoFar, [byteIndex, rightShift, mask, leftShift]) =>
      bitsSoFar | (((bytes[byteIndex] >> rightShift) & mask) << leftShift), 0);
  const selectorRow = selector.frames.find(([, ...selectorValues]) => selectorValues.includes(selectorValue));
  if (selectorRow || fallbackLayout) return {
    layout: selectorRow ? interface_.frames[selectorRow[0]] : fallbackLayout,
  };
  const allowedValues = selector.frames.flatMap(([, ...selectorValues]) => selectorValues)
    .sort((first, second) => first - second).map(hexDigits);
  return makeFailedFrame("range", selector.selector,
    messageFor("no_frame", selector.selector, hexDigits(selectorValue), allowedValues.join(", ")));
}

/** Return the result for a frame whose layout cannot be determined, with its problem. */
const makeFailedFrame = (faultKind, field, message) => ({
  ...createEmptyResult(null, 0n), problems: [{ fault: faultKind, field, message }],
});

/** Decode the bytes of a register. */
function decodeRegister(orderCode, register, text, registerContents, answers) {
  const bytes = bytesIn(checked(text));
  if (bytes.length !== register.length) {
    const [neededBytes, receivedBytes] = [countWithNoun(register.length, "byte"), countWithNoun(bytes.length, "byte")];
    throw new FrameText(messageFor("register_length", register.name, neededBytes, receivedBytes));
  }
  return decodeBytes(placedFor(orderCode, register, registerContents, answers), bytes);
}

/**
 * Return all order codes for which a text is a valid frame, grouped by the places of its fields. A number that may be
 * decimal is of none, since it would fit many widths.
 */
function inferred(text) {
  const groups = new Map();
  if (/^\s*(?=[0-9]*[2-9])[1-9][0-9]*\s*$/.test(text)) return [];
  for (const family of TABLE.families.filter((candidate) => !candidate.base)) {
    for (const orderCode of family.codes.map((row) => orderCodeOfRow(family, row))) {
      for (const sender of ["encoder", "master"]) addIfValid(groups, orderCode, sender, text);
    }
  }
  return [...groups.values()];
}

/** Decode a text with an order code, and add the code to the group with the same fields if the frame is valid. */
function addIfValid(groups, orderCode, sender, text) {
  let decoded;
  try {
    decoded = decodeFrame(orderCode, sender, text);
  } catch (error) {
    if (error instanceof FrameText) return;
    throw error;
  }
  if (decoded.problems.length) return;
  const { placedLayout } = decoded;
  const fieldPlaces = placedLayout.fields.map((placedField) => [placedField.name, placedField.low, placedField.width]);
  const groupKey = JSON.stringify([orderCode.family.name, placedLayout.name, placedLayout.gray !== null, fieldPlaces]);
  const { family, interface: interface_ } = orderCode;
  if (!groups.has(groupKey)) groups.set(groupKey, { decoded, sender, interface: interface_, family, codes: [] });
  groups.get(groupKey).codes.push(orderCode.code);
}
