// Licence 0BSD: use, modify and distribute this file without any condition.
// The table of many frames, and its export as CSV.

const VERDICT_CLASSES = { usable: "good", usable_with_warning: "warning", not_usable: "bad" };

/** Return the verdict on a row in words, with the class for its colour and shape. */
function describeVerdict({ found: decoded, error }) {
  if (error) return ["not a frame", "bad"];
  if (decoded.problems.length) return [`${decoded.problems[0].fault.replace("crc", "CRC")} error`, "bad"];
  if (!decoded.verdict) return ["no verdict", "plain"];
  return [decoded.verdict.replace(/_/g, " "), VERDICT_CLASSES[decoded.verdict]];
}

/** Create the mark of a verdict: its text with the colour and shape of ``verdictClass``. */
const createBadge = (text, verdictClass) => (
  element("span", { class: `${CLASS}-badge ${CLASS}-badge-${verdictClass}` }, text));

/** Return the errors or reports of a frame in one line. */
function writeRemark({ found: decoded, error }) {
  if (error) return error;
  const messages = decoded.problems.map((problem) => problem.message);
  return [
    ...messages, ...decoded.reports.map((report) => report.meaning || report.flag), ...decoded.differences].join(". ");
}

/** Return the field that the position is read from, or the first number of a frame. */
function findMainField({ found: decoded }, measure) {
  if (!decoded?.fields.length || decoded.problems.length) return null;
  const findNumber = (name) => decoded.fields.find((field) => field.name === name && typeof field.value === "bigint");
  return findNumber(measure?.of) ?? findNumber(measure?.part)
    ?? decoded.fields.find((field) => typeof field.value === "bigint");
}

/** Create a table of lines, each with its frame decoded in ``found`` or an ``error``. ``pick`` shows one in full. */
function tableOf(rows, measure, pick) {
  const hasTimes = rows.some((row) => row.line.time);
  const heads = ["Line", ...(hasTimes ? ["Time"] : []), "Frame", "Verdict", "Value", "Remark"];
  const bodyRows = rows.map((row) => {
    const showButton = element("button", { type: "button", "aria-label": `Show line ${row.line.number} in full` },
      `${row.line.number}`);
    showButton.addEventListener("click", () => pick(row));
    const mainField = findMainField(row, measure);
    const valueTexts = mainField ? [`${mainField.name} ${formatWithUnit(mainField)}`] : [];
    const angleText = mainField ? measured(row.found, measure).replace(/^\w+: /, "") : "";
    return element("tr", {},
      element("td", {}, showButton), ...(hasTimes ? [element("td", {}, row.line.time)] : []),
      element("td", { class: `${CLASS}-frame` }, element("code", {}, row.line.text)),
      element("td", {}, createBadge(...describeVerdict(row))),
      element("td", { class: `${CLASS}-value` }, valueTexts, angleText && part("span", "meaning", angleText)),
      element("td", {}, writeRemark(row)));
  });
  const headCells = heads.map((text) => element("th",
    { scope: "col", class: text === "Frame" && `${CLASS}-frame` }, text));
  return element("table", { class: `${CLASS}-many` },
    element("caption", {}, counted(rows.length, "frame")),
    element("thead", {}, element("tr", {}, headCells)), element("tbody", {}, bodyRows));
}

/** Return the cells of a field by column: its value, and the quantity that a number stands for. */
function cellsOf(field) {
  const quantityCells = field.scale
    ? [[`${field.name} (${field.scale[3]})`, scaled(field.scale, field.value).decimal]] : [];
  return [[field.name, formatValue(field.value)], ...quantityCells];
}

/** Write the lines as CSV, with a column for each field and each quantity. */
function writeCsv(rows) {
  const cellsOfRows = rows.map((row) => (row.found?.fields ?? []).flatMap(cellsOf));
  const columnNames = [...new Set(cellsOfRows.flatMap((cells) => cells.map(([name]) => name)))];
  const quoteCell = (text) => (/[",\r\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
  const lines = rows.map((row, rowIndex) => {
    const textByColumn = named(...cellsOfRows[rowIndex].map(([name, text]) => ({ [name]: text })));
    const { line } = row;
    return [
      `${line.number}`, line.time, line.text, row.found?.at?.name ?? "", row.found?.verdict ?? "", writeRemark(row),
      ...columnNames.map((name) => textByColumn[name] ?? "")];
  });
  const heads = ["line", "time", "frame", "layout", "verdict", "remark", ...columnNames];
  return [heads, ...lines].map((texts) => `${texts.map(quoteCell).join(",")}\r\n`).join("");
}

/** List the mistakes that explain the most of the wrong frames among the lines, if they explain at least two. */
function togetherOf(rows) {
  const wrongFrames = rows.flatMap((row) => (row.found?.problems.length && !row.found.channels ? [row.found] : []));
  const mistakes = judgedTogether(wrongFrames);
  if (!mistakes.length || mistakes[0].frames < 2) return [];
  const introduction = said(
    "together", `${mistakes[0].frames}`, `${Math.min(wrongFrames.length, TABLE.likely.frames)}`);
  const mistakeTexts = mistakes.map(
    ({ text, oneIn }) => (oneIn > ONE ? `${text} (matches by chance in 1 of ${oneIn})` : text));
  const shiftLines = mistakes[0].hidesShift ? [element("p", {}, sentence(said("hidden_shift")))] : [];
  return [element("p", {}, `${introduction}:`), list(mistakeTexts), ...shiftLines];
}

/** List the doubts that all lines have in common although they are valid: a dead line, own requests, other readings. */
function doubtsOfAll(rows, measure) {
  const frames = rows.flatMap((row) => (row.found ? [row.found] : [])).slice(-TABLE.likely.frames);
  const deadLineTexts = new Set(frames.map(deadLine));
  const requestNames = new Set(frames.map(ownRequest));
  const readingsOfFrames = frames.map((decoded) => new Map(otherPositions(decoded, measure)));
  const commonTexts = [...readingsOfFrames[0]?.keys() ?? []]
    .filter((text) => readingsOfFrames.every((positionByText) => positionByText.has(text)));
  const readingsText = commonTexts.map(
    (text) => `${readingsOfFrames.map((positionByText) => positionByText.get(text)).join(" ")} ${text}`).join(", ");
  return [
    ...(deadLineTexts.size === 1 && !deadLineTexts.has("") ? [element("p", {}, [...deadLineTexts][0])] : []),
    ...(requestNames.size && !requestNames.has("")
      ? [element("p", {}, sentence(capitalize(said("own_requests", [...requestNames].join(", ")))))] : []),
    ...(readingsText ? [foldDoubt(measure, readingsText)] : []),
  ];
}

/** Create buttons that copy and download the lines as CSV. */
function exportsOf(rows) {
  const copyButton = element("button", { type: "button" }, "Copy as CSV");
  copyButton.addEventListener("click", () => {
    navigator.clipboard.writeText(writeCsv(rows)).then(() => { copyButton.textContent = "Copied"; },
      () => { copyButton.textContent = "The browser did not allow it"; });
  });
  const downloadButton = element("button", { type: "button" }, "Download CSV");
  downloadButton.addEventListener("click", () => {
    const url = URL.createObjectURL(new Blob([writeCsv(rows)], { type: "text/csv" }));
    element("a", { href: url, download: "frames.csv" }).click();
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  });
  return part("p", "exports", copyButton, downloadButton);
}
