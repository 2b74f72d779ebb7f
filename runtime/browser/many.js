// License 0BSD: use, modify and distribute this file without any condition.
// The table of many frames, and its export as CSV.

/** Return the verdict on a row in words, with the class for its color and shape. */
function describeVerdict({ decoded, error }) {
  if (error) return ["not a frame", "bad"];
  if (decoded.problems.length) return [`${decoded.problems[0].fault.replace("crc", "CRC")} error`, "bad"];
  return [(decoded.verdict ?? "no verdict").replace(/_/g, " "), VERDICT_CLASSES[decoded.verdict] ?? "plain"];
}

/** Create the mark of a verdict: its text with the color and shape of ``verdictClass``. */
const createBadge = (text, verdictClass) => (
  createElement("span", { class: `${CLASS}-badge ${CLASS}-badge-${verdictClass}` }, text));

/** Return the errors or reports of a frame in one line. */
function writeRemark({ decoded, error }) {
  if (error) return error;
  const messages = decoded.problems.map((problem) => problem.message);
  return [
    ...messages, ...decoded.reports.map((report) => report.meaning || report.flag), ...decoded.differences].join(". ");
}

/** Return the field that the position is read from, the number named "position", or the first number of a frame. */
function findMainField({ decoded }, measure) {
  if (!decoded?.fields.length || decoded.problems.length) return null;
  const numbers = decoded.fields.filter((field) => typeof field.value === "bigint");
  return findMeasuredField(decoded, measure) ?? numbers.find(({ name }) => name === "position") ?? numbers[0];
}

/** Create a table of lines, each with its frame ``decoded`` or an ``error``. ``pick`` shows a frame in full. */
function createLineTable(rows, measure, pick) {
  const hasTimes = rows.some((row) => row.line.time);
  const heads = ["Line", ...(hasTimes ? ["Time"] : []), "Frame", "Verdict", "Value", "Remark"];
  const bodyRows = rows.map((row) => {
    const { number } = row.line;
    const showButton = createButton(`${number}`, () => pick(row), `Show line ${number} in full`);
    const mainField = findMainField(row, measure);
    const valueTexts = mainField ? [`${mainField.name} ${formatWithUnit(mainField)}`] : [];
    const angleText = mainField ? describeMeasurement(row.decoded, measure).replace(/^\w+: /, "") : "";
    return createElement("tr", {},
      createElement("td", {}, showButton), ...(hasTimes ? [createElement("td", {}, row.line.time)] : []),
      createElement("td", { class: `${CLASS}-frame` }, createElement("code", {}, row.line.text)),
      createElement("td", {}, createBadge(...describeVerdict(row))),
      createElement("td", { class: `${CLASS}-value` }, valueTexts,
        angleText && createPart("span", "meaning", angleText)),
      createElement("td", {}, writeRemark(row)));
  });
  const headCells = heads.map((text) => createElement("th",
    { scope: "col", class: text === "Frame" && `${CLASS}-frame` }, text));
  const table = createElement("table", { class: `${CLASS}-many` },
    createElement("caption", {}, countWithNoun(rows.length, "frame")),
    createElement("thead", {}, createElement("tr", {}, headCells)), createElement("tbody", {}, bodyRows));
  return createPart("div", "scroll", table);
}

/** Return the cells of a field by column: its value, and the quantity that a number represents. */
function listCsvCells(field) {
  const quantityCells = field.scale
    ? [[`${field.name} (${field.scale[3]})`, scaleNumber(field.scale, field.value).decimal]] : [];
  return [[field.name, formatValue(field.value)], ...quantityCells];
}

/** Write the lines as CSV, with a column for each field and each quantity. */
function writeCsv(rows) {
  const cellsOfRows = rows.map((row) => (row.decoded?.fields ?? []).flatMap(listCsvCells));
  const columnNames = [...new Set(cellsOfRows.flatMap((cells) => cells.map(([name]) => name)))];
  const quoteCell = (text) => (/[",\r\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
  const lines = rows.map((row, rowIndex) => {
    const textByColumn = mergeByName(...cellsOfRows[rowIndex].map(([name, text]) => ({ [name]: text })));
    const { line } = row;
    return [
      `${line.number}`, line.time, line.text,
      row.decoded?.placedLayout?.name ?? "", row.decoded?.verdict ?? "", writeRemark(row),
      ...columnNames.map((name) => textByColumn[name] ?? "")];
  });
  const heads = ["line", "time", "frame", "layout", "verdict", "remark", ...columnNames];
  return [heads, ...lines].map((texts) => `${texts.map(quoteCell).join(",")}\r\n`).join("");
}

/** List the mistakes that explain the most of the wrong frames among the lines, if they explain at least two. */
function listCommonMistakes(rows) {
  const { mistakes, failedCount, isOfAll } = judgeFrames(rows.flatMap(({ decoded }) => (decoded ? [decoded] : [])));
  if (!mistakes.length || mistakes[0].frames < 2) return [];
  const introduction = isOfAll ? messageFor("together_all", `${mistakes[0].frames}`)
    : messageFor("together", `${mistakes[0].frames}`, `${failedCount}`);
  const mistakeTexts = mistakes.map(
    ({ text, oneIn }) => (oneIn > ONE ? `${text} (matches by chance in 1 of ${oneIn})` : text));
  const shiftLines = mistakes[0].hidesShift ? [createSentence(messageFor("hidden_shift"))] : [];
  return [createElement("p", {}, `${introduction}:`), createList(mistakeTexts), ...shiftLines];
}

/** Return the last decoded frames of the lines, which are judged together. */
const lastFramesOf = (rows) => rows.flatMap((row) => (row.decoded ? [row.decoded] : [])).slice(-TABLE.likely.frames);

/** Create the note on lines that are all requests of the master, in a list. */
function createCommonEchoNote(rows) {
  const requestNames = new Set(lastFramesOf(rows).map(ownRequest));
  if (!requestNames.size || requestNames.has("")) return [];
  return [createSentence(capitalize(messageFor("own_requests", [...requestNames].join(", "))))];
}

/** List the doubts that all lines have in common although they are valid: a dead line, other readings. */
function listCommonDoubts(rows, measure) {
  const frames = lastFramesOf(rows);
  const [deadLineText, ...otherTexts] = new Set(frames.map(deadLine));
  const readingsOfFrames = frames.map((decoded) => new Map(otherPositions(decoded, measure)));
  const commonTexts = [...readingsOfFrames[0]?.keys() ?? []]
    .filter((text) => readingsOfFrames.every((positionByText) => positionByText.has(text)));
  const readingsText = commonTexts.map(
    (text) => `${readingsOfFrames.map((positionByText) => positionByText.get(text)).join(" ")} ${text}`).join(", ");
  return [
    ...(deadLineText && !otherTexts.length && !frames.some(({ problems }) => problems.length) ? [createSentence(capitalize(deadLineText))] : []),
    ...(readingsText ? [foldDoubt(measure, readingsText)] : []),
  ];
}

/** Create buttons that copy and download the lines as CSV. */
function createExportButtons(rows) {
  const copyButton = createButton("Copy as CSV", () => {
    navigator.clipboard.writeText(writeCsv(rows)).then(() => { copyButton.textContent = "Copied"; },
      () => { copyButton.textContent = "The browser did not allow it"; });
  });
  const downloadButton = createButton("Download CSV", () => {
    const url = URL.createObjectURL(new Blob([writeCsv(rows)], { type: "text/csv" }));
    createElement("a", { href: url, download: "frames.csv" }).click();
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  });
  return createPart("p", "exports", copyButton, downloadButton);
}
