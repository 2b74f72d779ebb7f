// License 0BSD: use, modify and distribute this file without any condition.
// Expressions, bits and CRCs.

const ONE = 1n;

/** Merge values into one object by names of a spec, which can also be names that every JavaScript object has. */
const mergeByName = (...pairs) => Object.assign(Object.create(null), ...pairs);

/** Return a limit or count of the table as BigInt: there it is a number, or text if it is too large for a number. */
const toBigInt = (tableNumber) => BigInt(tableNumber ?? 0);
/** Return the number with ``width`` bits that are all 1. */
const ones = (width) => (ONE << BigInt(width)) - ONE;
/** Return ``width`` bits of a number, from bit ``low`` on. */
const extractBits = (number, low, width) => (number >> BigInt(low)) & ones(width);
/** Return a number in hex, with 0x and leading zeros up to ``digits``. */
const hex = (number, digits = 1) => "0x" + number.toString(16).padStart(digits, "0");
/** Return the digits of a number in hex, in capitals. */
const hexDigits = (number) => number.toString(16).toUpperCase();
/** Return bytes as text: two hex digits each, with spaces. */
const formatBytes = (bytes) => bytes.map((byte) => hexDigits(byte).padStart(2, "0")).join(" ");
/** Return a count with its noun in the singular or plural. */
const countWithNoun = (count, noun) => `${count} ${noun}${count === 1 ? "" : "s"}`;
/** Fill the values into a template, at {0}, {1} and so on. */
const fillTemplate = (template, ...values) => template.replace(/\{(\d)\}/g, (_, valueIndex) => values[valueIndex]);
/** Return the message with this name of the table, filled with values. */
const messageFor = (name, ...values) => fillTemplate(TABLE.said[name], ...values);
/** Count the bits of a number from its highest 1 on. */
const bitLength = (number) => (number ? number.toString(2).length : 0);

/** Return a fraction with all its decimals, or with six of them after ≈ if they are endless. */
function formatFraction(numerator, denominator) {
  const [magnitude, denominatorBits] = [numerator < 0n ? -numerator : numerator, denominator.toString(2).length];
  let exactPlaces = 0;
  while (exactPlaces <= denominatorBits && (magnitude * 10n ** BigInt(exactPlaces)) % denominator) exactPlaces += 1;
  const shownDecimals = exactPlaces > denominatorBits ? 6 : exactPlaces;
  const power = 10n ** BigInt(shownDecimals);
  const roundedNumber = (2n * magnitude * power + denominator) / (2n * denominator);
  const decimals = shownDecimals ? `.${(roundedNumber % power).toString().padStart(shownDecimals, "0")}` : "";
  const decimalText = `${numerator < 0n ? "-" : ""}${(roundedNumber / power).toLocaleString("en")}${decimals}`;
  return exactPlaces > denominatorBits ? `≈ ${decimalText}` : decimalText;
}

/**
 * Return the quantity that a number represents, with a fixed number of decimals, and whether these are exact. The scale
 * is [numerator, denominator, offset, unit, decimals].
 */
function scaleNumber([numerator, denominator, offset, , decimalCount = 0], number) {
  const [scaledNumerator, divisor] = [number * toBigInt(numerator) + toBigInt(offset), toBigInt(denominator)];
  const power = 10n ** BigInt(decimalCount);
  const roundedMagnitude = (2n * (scaledNumerator < 0n ? -scaledNumerator : scaledNumerator) * power + divisor)
    / (2n * divisor);
  const decimals = decimalCount ? `.${(roundedMagnitude % power).toString().padStart(decimalCount, "0")}` : "";
  return {
    decimal: `${scaledNumerator < 0n && roundedMagnitude ? "-" : ""}${roundedMagnitude / power}${decimals}`,
    exact: !((scaledNumerator * power) % divisor),
  };
}

/** Return a quantity with its unit. It begins with ≈ if its decimals are rounded. */
function quantityOf(scale, number) {
  const { decimal: decimalText, exact } = scaleNumber(scale, number);
  return `${exact ? "" : "≈ "}${decimalText} ${scale[3]}`;
}

/** Evaluate an expression, which is a number, or a list of a number and terms. Each term is a multiple and factors. */
function evaluateExpression(expression, parameters) {
  if (!Array.isArray(expression)) return toBigInt(expression);
  return expression.slice(1).reduce((sum, [multiple, ...factors]) => sum + factors.reduce(
    (product, name) => product * evaluateFactor(name, parameters), toBigInt(multiple)), toBigInt(expression[0]));
}

/** Return the parameter of a factor, or 2 to the power of the parameter if the factor begins with ^. */
function evaluateFactor(name, parameters) {
  if (!name.startsWith("^")) return parameters[name];
  const exponent = parameters[name.slice(1)];
  if (exponent < 0n || exponent > 128n) throw new RangeError(`2${name} is out of range`);
  return ONE << exponent;
}

/** Return the parameters of an order code and those derived from them. */
function resolveParameters(family, given) {
  const parameters = mergeByName(given);
  let unsettled = family.derived ?? [];
  for (let countBefore = -1; unsettled.length !== countBefore;) {
    countBefore = unsettled.length;
    unsettled = unsettled.filter(([name, expression]) => !settleParameter(parameters, name, expression));
  }
  return parameters;
}

/** Add a derived parameter if the parameters in its expression are there, and return whether they are. */
function settleParameter(parameters, name, expression) {
  const names = Array.isArray(expression) ? expression.slice(1).flatMap((term) => term.slice(1)) : [];
  if (!names.every((nameOrPower) => nameOrPower.replace("^", "") in parameters)) return false;
  try {
    parameters[name] = evaluateExpression(expression, parameters);
  } catch (error) {
    parameters[name] = 0n;
  }
  return true;
}

/** Return the lowest ``width`` bits of a number in reverse order. */
function reverseBits(number, width) {
  let reversed = 0n;
  for (let bitIndex = 0; bitIndex < width; bitIndex += 1) {
    reversed = (reversed << ONE) | extractBits(number, bitIndex, 1);
  }
  return reversed;
}

/** Compute a CRC over the lowest ``bitCount`` bits of a number, most significant first. */
function crcOfBits(crc, number, bitCount) {
  const [mask, poly, top] = [ones(crc.width), toBigInt(crc.poly), BigInt(crc.width - 1)];
  let register = toBigInt(crc.init);
  for (let bitIndex = BigInt(bitCount) - ONE; bitIndex >= 0n; bitIndex -= ONE) {
    const feedback = ((register >> top) ^ (number >> bitIndex)) & ONE;
    register = (register << ONE) & mask;
    if (feedback) register ^= poly;
  }
  return (crc.refout ? reverseBits(register, crc.width) : register) ^ toBigInt(crc.xorout);
}

/** Compute a CRC over bytes, each reflected if the CRC is. */
function crcOfBytes(crc, bytes) {
  const bytesInOrder = bytes.map((byte) => (crc.refin ? reverseBits(BigInt(byte), 8) : byte));
  return crcOfBits(crc, numberOf("big", bytesInOrder), 8 * bytes.length);
}

/** Return the number that bytes form: ``order`` is "little" for low byte first, "big" for high byte first. */
function numberOf(order, bytes) {
  const highFirst = order === "little" ? [...bytes].reverse() : bytes;
  return highFirst.reduce((sum, byte) => (sum << 8n) | BigInt(byte), 0n);
}

/** Return the ``byteCount`` bytes of a number, in this order. */
function bytesOf(order, number, byteCount) {
  const lowFirst = Array.from({ length: byteCount }, (_, byteIndex) => Number(extractBits(number, 8 * byteIndex, 8)));
  return order === "little" ? lowFirst : lowFirst.reverse();
}

/** Return the bytes of a frame with those of each field that has its own byte order in reverse order. */
function exchangeBytes({ exchanged = [] }, bytes) {
  return exchanged.reduce((orderedBytes, [start, stop]) => [
    ...orderedBytes.slice(0, start), ...orderedBytes.slice(start, stop).reverse(), ...orderedBytes.slice(stop)], bytes);
}

/** Return the number that the bytes of a frame or register form in the byte order of its layout. */
const numberOfFrame = (layout, bytes) => numberOf(layout.order, exchangeBytes(layout, bytes));
/** Return the ``byteCount`` bytes of a frame or register in the order in which they are sent. */
const bytesOfFrame = (layout, number, byteCount) => exchangeBytes(layout, bytesOf(layout.order, number, byteCount));

/** Return the parity of the bits of a number at these places, or of those bits at each place that are in the mask. */
function computeParity(number, places, { odd, mask }) {
  const countedBits = mask ? toBigInt(mask) : -1n;
  const digits = places.map(({ low, width }) => (extractBits(number, low, width) & countedBits).toString(2)).join("");
  return BigInt((digits.split("1").length - 1 + (odd ?? 0)) % 2);
}
