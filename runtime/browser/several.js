// License 0BSD: use, modify and distribute this file without any condition.
// Frames in several pasted lines: words in one line, and numbers in columns. The command has the same rules, in several_frames.py.

/** Number of lines that show whether numbers are decimal, and whether the first column counts the lines. */
const SAMPLE_LINES = 20;
/** Fewest lines that show a column that counts the lines. */
const FEWEST_ROWS = 3;
/** Fewest digits that show that numbers are decimal, since hex numbers of this length have letters. */
const FEWEST_DECIMAL_DIGITS = 24;
/** The number of a line, a separator of CSV, and a frame of at least 3 characters. */
const NUMBERED_ROW = /^(0|[1-9][0-9]{0,8})[ ]*[,;\t][ ]*([0-9A-Za-z]{3,})$/;
/** The names of two columns, with a letter that is not a hex digit. */
const HEADER_ROW = /^(?=.*[G-Wg-wYyZz])[A-Za-z_][A-Za-z0-9_ ]*[,;\t][ ]*[A-Za-z_][A-Za-z0-9_ ]*$/;

/**
 * Return the lines of ``linesOf`` with a line for each frame: for each word of a line with several words, such as
 * {0x7FFE, 0x3FFF}, and for each number in a column. The words of a single line are numbered from 1.
 */
function splitIntoWords(lines, orderCode, sender, registerContents, answers) {
  const sizes = frameSizesOf(orderCode, sender, registerContents, answers);
  if (!sizes.length) return lines;
  const frameLines = readColumns(lines, sizes[0]);
  return frameLines.flatMap((line) => {
    const matches = [...line.text.matchAll(/[^\s'",;[\](){}<>]+/g)];
    const words = wordsOf(matches.map(([word]) => word), sizes);
    if (!words.length) return [line];
    return words.map((text, wordIndex) => ({
      ...line, number: lines.length > 1 ? line.number : wordIndex + 1, text,
      offset: line.offset + matches[wordIndex].index,
    }));
  });
}

/** Return the numbers of bits of the sender's frames, without duplicates, or [] if the line carries bytes. */
function frameSizesOf(orderCode, sender, registerContents, answers) {
  if (orderCode.interface.name === "rs485") return [];
  const layouts = orderCode.interface.frames.filter((layout) => layout.sender === sender);
  return [...new Set(layouts.map((layout) => placedFor(orderCode, layout, registerContents, answers).bits))];
}

/** Return the lines without a header, without a column that counts them, and with decimal numbers in hex. */
function readColumns(lines, bitCount) {
  const mayBeTable = lines.length > 1 && (hasNotation("decimal", lines[0].text) || /[,;\t]/.test(lines[0].text));
  if (!mayBeTable) return lines;
  const hasHeader = HEADER_ROW.test(lines[0].text);
  const sampleRows = lines.slice(hasHeader ? 1 : 0, SAMPLE_LINES);
  const hasNumbers = haveLineNumbers(sampleRows);
  const isTable = hasNumbers || sampleRows.every((row) => row.time);
  const rows = hasHeader && isTable ? lines.slice(1) : lines;
  const frameRows = hasNumbers ? rows.map(withoutLineNumber) : rows;
  const sampleCount = SAMPLE_LINES - (lines.length - rows.length);
  const sampleTexts = frameRows.slice(0, sampleCount).map(({ text }) => text);
  if (lackLeadingZeros(sampleTexts, bitCount)) {
    return frameRows.map((row) => (
      /^1[01]*$/.test(row.text) ? { ...row, text: `0b${row.text.padStart(bitCount, "0")}` } : row));
  }
  if (!areDecimalNumbers(sampleTexts, bitCount)) return frameRows;
  return frameRows.map((row) => (
    hasNotation("decimal", row.text) ? { ...row, text: `0x${hexDigits(BigInt(row.text))}` } : row));
}

/** Return whether each row begins with its number, which increases by the same step from row to row. */
function haveLineNumbers(rows) {
  const matches = rows.map(({ text }) => NUMBERED_ROW.exec(text));
  if (rows.length < FEWEST_ROWS || matches.includes(null)) return false;
  const numbers = matches.map(([, number]) => Number(number));
  const steps = new Set(numbers.slice(1).map((number, index) => number - numbers[index]));
  return steps.size === 1 && numbers[1] > numbers[0];
}

/** Return a row without its number, or any other row as it is. */
function withoutLineNumber(row) {
  const frameText = NUMBERED_ROW.exec(row.text)?.[2];
  if (frameText === undefined) return row;
  return { ...row, text: frameText, offset: row.offset + row.text.length - frameText.length };
}

/** Return whether texts are frames of ``bitCount`` bits without their leading zeros, as digits.py does. */
function lackLeadingZeros(texts, bitCount) {
  const lengths = texts.map((text) => text.length);
  return texts.every((text) => /^1[01]*$/.test(text)) && new Set(lengths).size > 1
    && Math.min(...lengths) > 8 && Math.max(...lengths) === bitCount;
}

/** Return whether all texts are decimal numbers, although single ones could also be hex. */
function areDecimalNumbers(texts, bitCount) {
  if (texts.length < 2 || !texts.every((text) => hasNotation("decimal", text))) return false;
  const digits = texts.join("");
  const isTooLarge = (prefix) => (text) => BigInt(prefix + text) >> BigInt(bitCount) > 0n;
  if (/^[01]*$/.test(digits) || texts.some(isTooLarge(""))) return false;
  return texts.some(isTooLarge("0x")) || digits.length >= FEWEST_DECIMAL_DIGITS;
}

/** Return several words with their prefixes if each is a frame of one of these sizes, or [], as digits.py does. */
function wordsOf(words, sizes) {
  if (words.length < 2) return [];
  if (words.every((word) => /^0b[01]{9,}$/i.test(word.replaceAll("_", "")))) return words;
  const [bitCount] = sizes;
  const areNumbers = words.every((word) => word.length >= FEWEST_DIGITS_OF_NUMBER) && areDecimalNumbers(words, bitCount);
  if (areNumbers && BigInt(`0x${words.join("")}`) >> BigInt(bitCount)) {
    return words.map((word) => `0b${BigInt(word).toString(2).padStart(bitCount, "0")}`);
  }
  const framesBySize = sizes.map((bitCount) => (
    sizes.includes(words.length * bitCount) ? [] : wordsOfSize(words, bitCount)));
  return framesBySize.find((frames) => frames.length) ?? [];
}

/** Return the words with their prefixes if each is a frame of ``bitCount`` bits, or [] for other words. */
function wordsOfSize(words, bitCount) {
  if (bitCount <= 8) return [];
  const digitCount = Math.ceil(bitCount / 4);
  const digits = words.map((word) => word.replace(/^(0x[^uUlL]*)[ul]+$/i, "$1").replace(/^0x/i, ""));
  const prefixCount = words.filter((word) => /^0x/i.test(word)).length;
  const lengths = digits.map((plain) => plain.length);
  if (digits.every((plain) => /^[0-9A-Fa-f]+$/.test(plain)) && Math.max(...lengths) === digitCount) {
    const fewestDigits = prefixCount === words.length ? Math.floor(digitCount / 2) + 1 : digitCount;
    // A letter or a prefix shows that digits are hex.
    const areHex = prefixCount > 0 || /[A-Fa-f]/.test(digits.join(""));
    const fit = digits.every((plain) => BigInt(`0x${plain}`) >> BigInt(bitCount) === 0n);
    if (areHex && fit && Math.min(...lengths) >= fewestDigits) return digits.map((plain) => `0x${plain}`);
  }
  const bitTexts = words.map((word) => word.replace(/^0b/i, ""));
  const bitLengths = bitTexts.map((bitText) => bitText.length);
  // Words in binary may lack leading zeros if another one has all bits. Shorter ones may be bytes.
  const areBinary = bitTexts.every((bitText) => /^[01]+$/.test(bitText))
    && Math.min(...bitLengths) > 8 && Math.max(...bitLengths) === bitCount;
  return areBinary ? bitTexts.map((bitText) => `0b${bitText.padStart(bitCount, "0")}`) : [];
}
