// Licence 0BSD: use, modify and distribute this file without any condition.
// The table of many frames, and its export as CSV.

const VERDICTS = { usable: "good", usable_with_warning: "warning", not_usable: "bad" };

/** The verdict in words, with the class for its colour and shape. */
function verdictOf({ found, error }) {
  if (error) return ["not a frame", "bad"];
  if (found.problems.length) return [`${found.problems[0].fault.replace("crc", "CRC")} error`, "bad"];
  if (!found.verdict) return ["no verdict", "plain"];
  return [found.verdict.replace(/_/g, " "), VERDICTS[found.verdict]];
}

const badge = (text, kind) => element("span", { class: `${CLASS}-badge ${CLASS}-badge-${kind}` }, text);

/** The errors or reports of a frame in one line. */
function remarkOf({ found, error }) {
  if (error) return error;
  const problems = found.problems.map((item) => item.message);
  return [...problems, ...found.reports.map((item) => item.meaning || item.flag), ...found.differences].join(". ");
}

/** The field that the position is read from, or the first number of a frame. */
function mainField({ found }, measure) {
  if (!found?.fields.length || found.problems.length) return null;
  const number = (name) => found.fields.find((item) => item.name === name && typeof item.value === "bigint");
  return number(measure?.of) ?? number(measure?.part) ?? found.fields.find((item) => typeof item.value === "bigint");
}

/** A table of decoded lines. ``pick`` shows one of them in full. */
function tableOf(rows, measure, pick) {
  const hasTimes = rows.some((row) => row.line.time);
  const heads = ["Line", ...(hasTimes ? ["Time"] : []), "Frame", "Verdict", "Value", "Remark"];
  const body = rows.map((row) => {
    const button = element("button", { type: "button", "aria-label": `Show line ${row.line.number} in full` },
      `${row.line.number}`);
    button.addEventListener("click", () => pick(row));
    const field = mainField(row, measure);
    const shown = field ? [`${field.name} ${formatWithUnit(field)}`] : [];
    const angle = field ? measured(row.found, measure).replace(/^\w+: /, "") : "";
    return element("tr", {},
      element("td", {}, button), ...(hasTimes ? [element("td", {}, row.line.time)] : []),
      element("td", { class: `${CLASS}-frame` }, element("code", {}, row.line.text)),
      element("td", {}, badge(...verdictOf(row))),
      element("td", { class: `${CLASS}-value` }, shown, angle && part("span", "meaning", angle)),
      element("td", {}, remarkOf(row)));
  });
  const cells = heads.map((text) => element("th",
    { scope: "col", class: text === "Frame" && `${CLASS}-frame` }, text));
  return element("table", { class: `${CLASS}-many` },
    element("caption", {}, counted(rows.length, "frame")),
    element("thead", {}, element("tr", {}, cells)), element("tbody", {}, body));
}

/** The cells of a field by column: its value, and the quantity that a number stands for. */
function cellsOf(item) {
  const quantity = item.scale ? [[`${item.name} (${item.scale[3]})`, scaled(item.scale, item.value).decimal]] : [];
  return [[item.name, formatValue(item.value)], ...quantity];
}

/** The lines as CSV, with a column for each field and each quantity. */
function csvOf(rows) {
  const found = rows.map((row) => (row.found?.fields ?? []).flatMap(cellsOf));
  const names = [...new Set(found.flatMap((cells) => cells.map(([name]) => name)))];
  const cell = (text) => (/[",\r\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
  const lines = rows.map((row, place) => {
    const own = named(...found[place].map(([name, text]) => ({ [name]: text })));
    const { line } = row;
    return [`${line.number}`, line.time, line.text, row.found?.at?.name ?? "", row.found?.verdict ?? "", remarkOf(row),
      ...names.map((name) => own[name] ?? "")];
  });
  const heads = ["line", "time", "frame", "layout", "verdict", "remark", ...names];
  return [heads, ...lines].map((row) => `${row.map(cell).join(",")}\r\n`).join("");
}

/** The mistakes that explain all or most of the wrong frames among the lines, or that another frame would help. */
function togetherOf(rows) {
  const frames = rows.flatMap((row) => (row.found?.problems.length && !row.found.channels ? [row.found] : []));
  const found = judgedTogether(frames);
  if (!found.length || found[0].frames < 2) return [];
  const start = said("together", `${found[0].frames}`, `${Math.min(frames.length, TABLE.likely.frames)}`);
  const items = found.map(({ text, oneIn }) => (oneIn > ONE ? `${text} (matches by chance in 1 of ${oneIn})` : text));
  return [element("p", {}, `${start}:`), list(items)];
}

/** What all lines have in common although they are valid: a dead line, own requests, and other readings, folded. */
function doubtsOfAll(rows, measure) {
  const frames = rows.flatMap((row) => (row.found ? [row.found] : [])).slice(-TABLE.likely.frames);
  const dead = new Set(frames.map(deadLine));
  const requests = new Set(frames.map(ownRequest));
  const readings = frames.map((found) => new Map(otherPositions(found, measure)));
  const shared = [...readings[0]?.keys() ?? []].filter((text) => readings.every((own) => own.has(text)));
  const listed = shared.map((text) => `${readings.map((own) => own.get(text)).join(" ")} ${text}`).join(", ");
  return [
    ...(dead.size === 1 && !dead.has("") ? [element("p", {}, [...dead][0])] : []),
    ...(requests.size && !requests.has("") ? [element("p", {}, sentence(capitalize(said("own_requests", [...requests].join(", ")))))] : []),
    ...(listed ? [foldDoubt(measure, listed)] : []),
  ];
}

/** Buttons that copy and download the lines as CSV. */
function exportsOf(rows) {
  const copy = element("button", { type: "button" }, "Copy as CSV");
  copy.addEventListener("click", () => {
    navigator.clipboard.writeText(csvOf(rows)).then(() => { copy.textContent = "Copied"; },
      () => { copy.textContent = "The browser did not allow it"; });
  });
  const save = element("button", { type: "button" }, "Download CSV");
  save.addEventListener("click", () => {
    const url = URL.createObjectURL(new Blob([csvOf(rows)], { type: "text/csv" }));
    element("a", { href: url, download: "frames.csv" }).click();
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  });
  return part("p", "exports", copy, save);
}
