// Licence 0BSD: use, modify and distribute this file without any condition.
// Drawing of a frame as a row of its fields, with the bits of a frame or without.

/** How to see the subject of the line below the drawing: the value or the meaning of a field. */
const howToPoint = (subject) => `Point at a field, or move to it with the Tab key, to see its ${subject} and source.`;

/** The bits of a frame as a row of its fields. Pointed at or focused, a field shows its value and source below. */
function bitsOf(found, table) {
  const { at, fields } = found;
  const rows = [...table.querySelectorAll("tbody tr")];
  const cells = fields.filter((field) => field.high >= 0 && firstAtItsPlace(field, fields) === field).map((field) => {
    const size = field.high - field.low + 1;
    const raw = size > 1 ? `${hex(field.raw)}` : `${field.raw}`;
    const explanation = meaningOf(at, field);
    return {
      name: field.name, high: field.high, low: field.low,
      colour: field.value === true ? "active" : field.colour,
      isOneName: fields.filter((other) => other.high === field.high && other.low === field.low).length === 1,
      text: field.raw.toString(2).padStart(size, "0"),
      says: `${inUnits(field)} (${raw}).${explanation ? ` ${sentence(explanation)}` : ""}`,
      light: () => rows.forEach((row, place) => row.classList.toggle(`${CLASS}-lit`, fields[place] === field)),
    };
  });
  return rowOf(at, cells, "value");
}

/** The fields of a frame without its bits, as in the pictures of the pages. */
function emptyFrame(at) {
  return rowOf(at, at.fields.map(({ field, name, low, width }) => {
    const high = low + width - 1;
    const active = { flag: "1 = active.", not_flag: "0 = active." }[field.kind] ?? "";
    const meaning = field.meaning || field.on || "";
    return {
      name, high, low, colour: field.colour, isOneName: true,
      text: high === low ? `${low}` : `${high}:${low}`,
      says: [active, meaning && sentence(meaning)].filter(Boolean).join(" "),
      light: () => {},
    };
  }), "meaning");
}

const firstAtItsPlace = (field, fields) =>
  fields.find((other) => other.high === field.high && other.low === field.low);

/** A row with a button for each field in the order sent, and a line with the ``subject`` of the chosen one. */
function rowOf(at, cells, subject) {
  const { layout } = at;
  const isLowFirst = layout.order === "little";
  cells.sort((one, other) => (isLowFirst ? one.low - other.low : other.high - one.high));
  const about = part("p", "about", howToPoint(subject));
  about.setAttribute("aria-hidden", "true");
  const source = layout.source ? ` Manual ${layout.source}` : "";
  const buttons = cells.map((cell) => {
    const size = cell.high - cell.low + 1;
    const place = placeOf(at, cell);
    const where = layout.order ? place : `bit${size > 1 ? "s" : ""} ${place}`;
    const words = `: ${where}${cell.says ? `, ${cell.says}` : "."}`;
    const shownName = cell.isOneName ? breakable(cell.name) : cell.name;
    const button = element("button", {
      type: "button", class: `${CLASS}-cell ${CLASS}-cell-${cell.colour}${size > 2 ? "" : ` ${CLASS}-narrow`}`,
      "aria-label": `${cell.name}${words}${source}`,
    }, part("span", "bits", cell.text), part("span", "name", shownName));
    const longestWord = size > 2 ? Math.max(...cell.name.split("_").map((word) => word.length)) : 0;
    // The policy of the page allows this, but no attribute.
    button.style.flex = `${size} 1 ${Math.max(size, longestWord, cell.text.length) + 1}ch`;
    const point = () => {
      about.replaceChildren(element("b", {}, cell.name), words, source && part("span", "source", source));
      cell.light();
      buttons.forEach((other) => other.classList.toggle(`${CLASS}-lit`, other === button));
    };
    for (const event of ["pointerenter", "focus", "click"]) button.addEventListener(event, point);
    return button;
  });
  const row = element("div", { class: `${CLASS}-drawing`, role: "group", "aria-label": "Bits of the frame" }, buttons);
  return part("div", "frame-drawing", row, about);
}
