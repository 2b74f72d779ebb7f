// License 0BSD: use, modify and distribute this file without any condition.
// Wrong frames that would be right for another order code, or with other widths in the registers of the encoder.

/**
 * Try the frames of other order codes, and those that result from other register values: complete, read too long, or
 * truncated. A shape is {placedLayout, codes} with the order codes that send it, none if only registers select it.
 */
function tryOtherOrderCodes(placedLayout, typedFrame) {
  const { layout, family } = placedLayout;
  if (!placedLayout.crc) return tryShapesWithoutCrc(placedLayout, typedFrame);
  const crcNames = layout.crcs ? Object.values(layout.crcs) : [layout.crc];
  const shapes = listShapes(placedLayout);
  return crcNames.map((name) => family.crcs[name]).flatMap(
    (crc) => tryShapes(placedLayout, crc, typedFrame, groupByLength(placedLayout, crc, shapes)));
}

/** The shapes of the last parameters, by layout. Several frames of one encoder have the same shapes. */
const lastShapes = new WeakMap();

/** List all shapes of a layout: those of order codes, and then those that only registers can select. */
function listShapes(placedLayout) {
  const parametersKey = Object.entries(placedLayout.parameters).join(" ");
  const last = lastShapes.get(placedLayout.layout);
  if (last?.parametersKey === parametersKey) return last.shapes;
  const shapesOfCodes = listShapesOfCodes(placedLayout);
  const shapes = [...shapesOfCodes, ...listShapesOfRegisters(placedLayout, shapesOfCodes)];
  lastShapes.set(placedLayout.layout, { parametersKey, shapes });
  return shapes;
}

/** Try the shapes, which have this CRC and are grouped by their length. */
function tryShapes(placedLayout, crc, typedFrame, shapesByLength) {
  const hypotheses = tryCompleteShape(placedLayout, crc, typedFrame, shapesByLength);
  const { number } = typedFrame;
  for (const [length, shapes] of shapesByLength) {
    const extraBits = placedLayout.bits - length;
    if (extraBits > 0 && mayHaveBits(typedFrame, placedLayout.bits)) {
      // The extra bits are the stop bit and zeros, but a single one may be anything.
      const zeroBits = extraBits > 1 ? extraBits : 0;
      const frameNumber = number >> BigInt(extraBits);
      hypotheses.push(createShapeHypothesis(placedLayout, crc, chooseShape(shapes, frameNumber), frameNumber, {
        mistakeText: fillTemplate(TABLE.texts.read_too_long, countWithNoun(extraBits, "bit")),
        otherBitsRequired: zeroBits, isConsistent: !extractBits(number, 0, zeroBits) }));
    } else if (extraBits < 0 && -extraBits <= TABLE.likely.cut_bits && typedFrame.bits === placedLayout.bits) {
      const frameNumber = number << BigInt(-extraBits);
      hypotheses.push(createShapeHypothesis(placedLayout, crc, chooseShape(shapes, frameNumber), frameNumber, {
        mistakeText: fillTemplate(TABLE.texts.read_too_short, countWithNoun(-extraBits, "bit")),
        missingLowBits: -extraBits }));
    }
  }
  return hypotheses;
}

/** Try the complete frames of other shapes without a CRC. Constants, parity and the length are the evidence. */
function tryShapesWithoutCrc(placedLayout, typedFrame) {
  const { number } = typedFrame;
  // With unknown leading zeros, a length is possible if it is the expected one, or if its zeros were typed.
  const isPossible = (length) => mayHaveBits(typedFrame, length)
    && (typedFrame.exact || length === placedLayout.bits || length <= typedFrame.written);
  const shapesByLength = groupByLength(placedLayout, undefined, listShapes(placedLayout));
  return [...shapesByLength].filter(([length]) => isPossible(length)).flatMap(([length, shapes]) => {
    const hypothesis = createShapeHypothesis(placedLayout, undefined, chooseShape(shapes, number), number);
    // Without a constant, a frame of the expected length could contain any bits.
    const hasEvidence = hypothesis.otherBitsRequired > 0 || length !== placedLayout.bits;
    return hasEvidence ? [{ ...hypothesis, relativeFrequency: TABLE.likely.other_code_without_crc }] : [];
  });
}

/** Try the complete frame of another shape. With unknown leading zeros, the shortest shape represents all. */
function tryCompleteShape(placedLayout, crc, typedFrame, shapesByLength) {
  // A text without leading zeros that fits into the expected frame is not explained by a longer frame.
  if (!typedFrame.exact && typedFrame.bits <= placedLayout.bits) return [];
  const possibleShapes = [...shapesByLength].filter(([length]) => mayHaveBits(typedFrame, length))
    .map(([, shapes]) => chooseShape(shapes, typedFrame.number));
  if (!possibleShapes.length) return [];
  const shape = { placedLayout: possibleShapes[0].placedLayout, codes: possibleShapes.flatMap(({ codes }) => codes) };
  const hasOtherLengths = possibleShapes.length > 1;
  return [createShapeHypothesis(placedLayout, crc, shape, typedFrame.number, { hasOtherLengths })];
}

/** Create the hypothesis that a frame has another shape. */
function createShapeHypothesis(
  expectedLayout, crc, { placedLayout, codes }, frameNumber,
  { mistakeText = "", hasOtherLengths = false, ...members } = {},
) {
  const { texts } = TABLE;
  const lengthText = fillTemplate(hasOtherLengths ? texts.bits_or_more : texts.bits, placedLayout.bits);
  const text = `${lengthText}, ${describeSender(expectedLayout, codes)}${mistakeText}`;
  const template = codes.length ? `${lengthText}, ${texts.of_other_code}${mistakeText}` : text;
  const kind = codes.length ? "other_order_code" : "other_widths";
  return createFrameHypothesis(placedLayout, crc, kind, text, frameNumber, { template, ...members });
}

/** Describe the order codes that send a frame, or that other register values select it. */
function describeSender({ code }, codes) {
  const { texts } = TABLE;
  if (!codes.length) return fillTemplate(texts.of_registers, code);
  if (codes.length > 2) return fillTemplate(texts.of_more_codes, codes[0], codes.length - 1);
  return fillTemplate(codes.length > 1 ? texts.of_two_codes : texts.of_code, ...codes);
}

/** Choose the likeliest of the shapes of one length for a frame, with the order codes of all possible ones. */
function chooseShape(shapes, number) {
  const rightShapes = shapes.filter(({ placedLayout }) => hasRightConstants(placedLayout, number));
  const possibleShapes = rightShapes.length ? rightShapes : shapes;
  const likeliest = possibleShapes.reduce((best, shape) => (
    countConstantBits(shape.placedLayout) < countConstantBits(best.placedLayout) ? shape : best));
  return { placedLayout: likeliest.placedLayout, codes: possibleShapes.flatMap(({ codes }) => codes) };
}

/**
 * Group the shapes with this CRC by length, the shortest first, without the length of the expected frame. Without a CRC,
 * only the shape of the order code itself is left out.
 */
function groupByLength(placedLayout, crc, shapes) {
  const hasOtherCrc = placedLayout.crc !== crc;
  const shapesByLength = new Map();
  const shapesWithCrc = shapes.filter((shape) => shape.placedLayout.crc === crc)
    .sort((shape, otherShape) => shape.placedLayout.bits - otherShape.placedLayout.bits);
  for (const shape of shapesWithCrc) {
    const { bits } = shape.placedLayout;
    const isOtherShape = !crc && !shape.codes.includes(placedLayout.code);
    const isOther = bits !== placedLayout.bits || hasOtherCrc || isOtherShape;
    if (isOther) shapesByLength.set(bits, [...shapesByLength.get(bits) ?? [], shape]);
  }
  return shapesByLength;
}

/** List the shapes of the order codes of the interface, which differ in length, CRC or places of constants and parity. */
function listShapesOfCodes(placedLayout) {
  const { family, layout, parameters } = placedLayout;
  const interface_ = interfaceOf(placedLayout);
  // A question that the manual leaves open has the same answer for all frames.
  const answeredNames = (family.alternatives ?? []).flatMap(({ answers }) => Object.keys(answers[0][2]));
  const answers = Object.fromEntries(answeredNames.map((name) => [name, parameters[name]]));
  const shapesByKey = new Map();
  for (const row of family.codes ?? []) {
    const orderCode = orderCodeOfRow(family, row);
    if (orderCode.interface !== interface_) continue;
    const otherParameters = mergeByName(resolveParameters(family, orderCode.parameters), answers);
    const otherLayout = placeLayout(family, layout, otherParameters);
    const fixedFields = otherLayout.fields.filter(({ field }) => "fixed" in field || "parity" in field);
    const fixedPlaces = fixedFields.map(({ low, width }) => `${low}:${width}`);
    const shapeKey = [otherLayout.bits, layoutCrcName(otherLayout), ...fixedPlaces].join(" ");
    const shape = shapesByKey.get(shapeKey) ?? { placedLayout: otherLayout, codes: [] };
    shape.codes.push(orderCode.code);
    shapesByKey.set(shapeKey, shape);
  }
  return [...shapesByKey.values()];
}

/** Return the name of the CRC of a placed layout, or "". */
const layoutCrcName = ({ family, crc }) => Object.keys(family.crcs ?? {}).find((name) => family.crcs[name] === crc) ?? "";

/** List the shapes that only registers can select, the first for each length. */
function listShapesOfRegisters({ family, layout, parameters }, shapesOfCodes) {
  const lengths = new Set(shapesOfCodes.map((shape) => shape.placedLayout.bits));
  const own = Object.fromEntries((family.given ?? []).map((name) => [name, parameters[name]]));
  return combineStates(layout.states ?? []).flatMap((state) => {
    const changed = Object.fromEntries(Object.entries(state).map(([name, value]) => [name, toBigInt(value)]));
    const otherParameters = resolveParameters(family, mergeByName(own, changed));
    const length = Number(evaluateExpression(layout.bits, otherParameters));
    if (lengths.has(length)) return [];
    lengths.add(length);
    return [{ placedLayout: placeLayout(family, layout, otherParameters), codes: [] }];
  });
}

/** Combine the states of register fields, at most as many as the command tries. */
function combineStates(statesByField) {
  if (!statesByField.length) return [];
  return statesByField.reduce((combined, states) => combined.flatMap(
    (state) => states.map((otherState) => ({ ...state, ...otherState }))), [{}]).slice(0, TABLE.likely.states);
}
