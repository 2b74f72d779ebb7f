// License 0BSD: use, modify and distribute this file without any condition.
// Drawing of a frame as a row of its fields, with the bits of a frame or without.

/** Say how to see the subject of the line below the drawing: the value or the meaning of a field. */
const describePointing = (subject) =>
  `Point at a field, or move to it with the Tab key, to see its ${subject} and source.`;

/** Draw the bits of a frame as a row of its fields. Pointed at or focused, a field shows its value and source below. */
function drawFrameBits(decoded, table) {
  const { placedLayout, fields } = decoded;
  const tableRows = [...table.querySelectorAll("tbody tr")];
  const cells = fields.filter(
    (field) => field.high >= 0 && findFirstAtItsPlace(field, fields) === field).map((field) => {
    const bitCount = field.high - field.low + 1;
    const rawText = bitCount > 1 ? `${hex(field.raw)}` : `${field.raw}`;
    const meaning = describeMeaning(placedLayout, field);
    return {
      name: field.name, high: field.high, low: field.low,
      colour: field.value === true ? "active" : field.colour,
      isOneName: fields.filter((other) => other.high === field.high && other.low === field.low).length === 1,
      shownText: field.raw.toString(2).padStart(bitCount, "0"),
      description: `${formatWithUnit(field)} (${rawText}).${meaning ? ` ${toSentence(meaning)}` : ""}`,
      highlightTableRow: () => tableRows.forEach((tableRow, index) => (
        tableRow.classList.toggle(`${CLASS}-lit`, fields[index] === field))),
    };
  });
  return drawFieldRow(placedLayout, cells, "value");
}

/** The fields of a frame without its bits, as in the pictures of the pages. */
function drawEmptyFrame(placedLayout) {
  return drawFieldRow(placedLayout, placedLayout.fields.map(({ field, name, low, width }) => {
    const high = low + width - 1;
    const activeText = { flag: "1 = active.", not_flag: "0 = active." }[field.kind] ?? "";
    const meaning = field.meaning || field.on || "";
    return {
      name, high, low, colour: field.colour, isOneName: true,
      shownText: high === low ? `${low}` : `${high}:${low}`,
      description: [activeText, meaning && toSentence(meaning)].filter(Boolean).join(" "),
      highlightTableRow: () => {},
    };
  }), "meaning");
}

/** Return the first of the decoded fields that has the same bits as ``field``. */
const findFirstAtItsPlace = (field, fields) =>
  fields.find((candidate) => candidate.high === field.high && candidate.low === field.low);

/**
 * Draw a row with a button for each cell, in the order sent, and a line with the ``subject`` of the chosen one. A cell
 * has the bits ``high`` to ``low`` of a field, its color, the ``shownText`` in it, and its ``description`` for the
 * line.
 */
function drawFieldRow(placedLayout, cells, subject) {
  const { layout } = placedLayout;
  const isLowFirst = layout.order === "little";
  cells.sort((cell, otherCell) => (isLowFirst ? cell.low - otherCell.low : otherCell.high - cell.high));
  const pointedLine = createPart("p", "about", describePointing(subject));
  pointedLine.setAttribute("aria-hidden", "true");
  const sourceText = layout.source ? ` Manual ${layout.source}` : "";
  const buttons = cells.map((cell) => {
    const bitCount = cell.high - cell.low + 1;
    const place = formatPlace(placedLayout, cell);
    const placeText = layout.order ? place : `bit${bitCount > 1 ? "s" : ""} ${place}`;
    const description = `: ${placeText}${cell.description ? `, ${cell.description}` : "."}`;
    const shownName = cell.isOneName ? breakableName(cell.name) : cell.name;
    const cellButton = createElement("button", {
      type: "button", class: `${CLASS}-cell ${CLASS}-cell-${cell.colour}${bitCount > 2 ? "" : ` ${CLASS}-narrow`}`,
      "aria-label": `${cell.name}${description}${sourceText}`,
    }, createPart("span", "bits", cell.shownText), createPart("span", "name", shownName));
    const longestWord = bitCount > 2 ? Math.max(...cell.name.split("_").map((word) => word.length)) : 0;
    // The policy of the page allows this, but no attribute.
    cellButton.style.flex = `${bitCount} 1 ${Math.max(bitCount, longestWord, cell.shownText.length) + 1}ch`;
    const showCell = () => {
      pointedLine.replaceChildren(
        createElement("b", {}, cell.name), description, sourceText && createPart("span", "source", sourceText));
      cell.highlightTableRow();
      buttons.forEach((otherButton) => otherButton.classList.toggle(`${CLASS}-lit`, otherButton === cellButton));
    };
    for (const event of ["pointerenter", "focus", "click"]) cellButton.addEventListener(event, showCell);
    return cellButton;
  });
  const row = createElement(
    "div", { class: `${CLASS}-drawing`, role: "group", "aria-label": "Bits of the frame" }, buttons);
  return createPart("div", "frame-drawing", row, pointedLine);
}
