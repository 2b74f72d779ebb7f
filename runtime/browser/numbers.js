// Licence 0BSD: use, modify and distribute this file without any condition.
// Expressions, bits and CRCs.

const ONE = 1n;

/** Values by names of a spec, which can also be names that every JavaScript object has. */
const named = (...pairs) => Object.assign(Object.create(null), ...pairs);

/** A limit or count of the table: a number, or text if it is too large for a number. */
const big = (limit) => BigInt(limit ?? 0);
const ones = (width) => (ONE << BigInt(width)) - ONE;
const bits = (number, low, width) => (number >> BigInt(low)) & ones(width);
const hex = (number, digits = 1) => "0x" + number.toString(16).padStart(digits, "0");
const counted = (count, noun) => `${count} ${noun}${count === 1 ? "" : "s"}`;
const filled = (text, ...values) => text.replace(/\{(\d)\}/g, (_, place) => values[place]);
const said = (name, ...values) => filled(TABLE.said[name], ...values);
const bitLength = (number) => (number ? number.toString(2).length : 0);

/** A fraction with all its decimals, or with six of them after ≈ if they never end. */
function decimal(numerator, denominator) {
  const [magnitude, places] = [numerator < 0n ? -numerator : numerator, denominator.toString(2).length];
  let exactPlaces = 0;
  while (exactPlaces <= places && (magnitude * 10n ** BigInt(exactPlaces)) % denominator) exactPlaces += 1;
  const digits = exactPlaces > places ? 6 : exactPlaces;
  const power = 10n ** BigInt(digits);
  const scaled = (2n * magnitude * power + denominator) / (2n * denominator);
  const decimals = digits ? `.${(scaled % power).toString().padStart(digits, "0")}` : "";
  const text = `${numerator < 0n ? "-" : ""}${(scaled / power).toLocaleString("en")}${decimals}`;
  return exactPlaces > places ? `≈ ${text}` : text;
}

/** The quantity that a number stands for, with a fixed number of decimals, and whether these are exact. */
function scaled([numerator, denominator, offset, , places = 0], number) {
  const [found, divisor] = [number * big(numerator) + big(offset), big(denominator)];
  const power = 10n ** BigInt(places);
  const size = (2n * (found < 0n ? -found : found) * power + divisor) / (2n * divisor);
  const part = places ? `.${(size % power).toString().padStart(places, "0")}` : "";
  return { decimal: `${found < 0n && size ? "-" : ""}${size / power}${part}`, exact: !((found * power) % divisor) };
}

/** A quantity with its unit. It begins with ≈ if its decimals are rounded. */
function quantityOf(scale, number) {
  const { decimal: digits, exact } = scaled(scale, number);
  return `${exact ? "" : "≈ "}${digits} ${scale[3]}`;
}

/** The value of an expression, which is a number and terms of a multiple and factors. */
function value(expression, parameters) {
  if (!Array.isArray(expression)) return big(expression);
  return expression.slice(1).reduce((sum, [multiple, ...factors]) => sum + factors.reduce(
    (product, name) => product * evaluateFactor(name, parameters), big(multiple)), big(expression[0]));
}

function evaluateFactor(name, parameters) {
  if (!name.startsWith("^")) return parameters[name];
  const exponent = parameters[name.slice(1)];
  if (exponent < 0n || exponent > 128n) throw new RangeError(`2${name} is out of range`);
  return ONE << exponent;
}

/** The parameters of an order code and those derived from them. */
function resolveParameters(family, given) {
  const parameters = named(given);
  let unsettled = family.derived ?? [];
  for (let countBefore = -1; unsettled.length !== countBefore;) {
    countBefore = unsettled.length;
    unsettled = unsettled.filter(([name, expression]) => !settleParameter(parameters, name, expression));
  }
  return parameters;
}

function settleParameter(parameters, name, expression) {
  const names = Array.isArray(expression) ? expression.slice(1).flatMap((term) => term.slice(1)) : [];
  if (!names.every((nameOrPower) => nameOrPower.replace("^", "") in parameters)) return false;
  try {
    parameters[name] = value(expression, parameters);
  } catch (error) {
    parameters[name] = 0n;
  }
  return true;
}

function reflected(number, width) {
  let reversed = 0n;
  for (let place = 0; place < width; place += 1) reversed = (reversed << ONE) | bits(number, place, 1);
  return reversed;
}

/** A CRC over the given bits of a number, most significant first. */
function crcOfBits(crc, number, count) {
  const [mask, poly, top] = [ones(crc.width), big(crc.poly), BigInt(crc.width - 1)];
  let register = big(crc.init);
  for (let place = BigInt(count) - ONE; place >= 0n; place -= ONE) {
    const feedback = ((register >> top) ^ (number >> place)) & ONE;
    register = (register << ONE) & mask;
    if (feedback) register ^= poly;
  }
  return (crc.refout ? reflected(register, crc.width) : register) ^ big(crc.xorout);
}

function crcOfBytes(crc, bytes) {
  const bytesInOrder = bytes.map((byte) => (crc.refin ? reflected(BigInt(byte), 8) : byte));
  return crcOfBits(crc, numberOf("big", bytesInOrder), 8 * bytes.length);
}

/** The number that bytes form: ``order`` is "little" for low byte first, "big" for high byte first. */
function numberOf(order, bytes) {
  const highFirst = order === "little" ? [...bytes].reverse() : bytes;
  return highFirst.reduce((sum, byte) => (sum << 8n) | BigInt(byte), 0n);
}

function bytesOf(order, number, count) {
  const lowFirst = Array.from({ length: count }, (_, place) => Number(bits(number, 8 * place, 8)));
  return order === "little" ? lowFirst : lowFirst.reverse();
}

/** The parity of the bits of a number at these places, or of those bits at each place that are in the mask. */
function parityOf(number, places, { odd, mask }) {
  const countedBits = mask ? big(mask) : -1n;
  const digits = places.map(({ low, width }) => (bits(number, low, width) & countedBits).toString(2)).join("");
  return BigInt((digits.split("1").length - 1 + (odd ?? 0)) % 2);
}
