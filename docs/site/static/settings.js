/* The page with master settings: shows what "codewheel master" prints for an order code or a line, and a master. */
"use strict";

/** Return the text of a file about an order code. Lines have placeholders for the code, and for its identifier. */
function fileText(data, code, number) {
  const identifier = code.replace(/[^A-Za-z0-9_]|^(?=[0-9])/g, "_");
  const lines = data.texts[number].map((index) => data.lines[index]);
  return lines.map((line) => line.replaceAll("\u0000", code).replaceAll("\u0001", identifier)).join("\n");
}

/** Return the listed order code that a label is, or null. */
function listedCode(data, label) {
  const wanted = label.replace(/\s/g, "").toUpperCase();
  return Object.keys(data.codes).find((code) => code.toUpperCase() === wanted) ?? null;
}

/** Return the command that prints the same, for a shell. */
function settingsCommand(code, master, choice, cable = "") {
  // A line has no quotes, so double quotes are enough for every shell.
  const quotedCode = /^[\w./=,:-]+$/.test(code) ? code : `"${code}"`;
  const options = [choice, cable && `--cable ${cable}`];
  return ["codewheel master", quotedCode, "--master", master, ...options].filter(Boolean).join(" ");
}

/** Return the length of a cable in whole metres, rounded up, or null for an empty text. Throws an error for others. */
function cableMetres(text) {
  if (!text.trim()) return null;
  const metres = /^[0-9]+([.][0-9]+)?( *m)?$/.test(text.trim()) ? Math.ceil(parseFloat(text)) : 0;
  if (metres > 0 && metres <= 100000) return metres;
  throw new codewheelMaster.NoRecord(`'${text.trim().slice(0, 20)}' is not a length in metres, such as 30.`);
}

/**
 * Return the encoder that a text describes: {record, title, statements, choices}, with the files by master in
 * ``files``. ``wantedChoice`` answers the open questions, by default with the first answers. Throws ``NoRecord`` with the
 * reason if there are no settings.
 */
function describedEncoder(data, text, wantedChoice, cable) {
  const { NoRecord, limitToCable, readRecord, recordOfLine } = codewheelMaster;
  const withCable = (record) => (cable === null ? record : limitToCable(record, cable, data));
  if (/=|^\s*(biss|ssi|spi|rs485)\s*[:,]/i.test(text)) {
    const line = codewheelDecode.parsedLine(text);
    if (line.problems.length) {
      throw new NoRecord(line.problems.map(([column, message]) => `Column ${column}: ${message}.`).join(" "));
    }
    return { ...data.line, choices: [""], files: {}, choice: "", record: withCable(recordOfLine(line, data)) };
  }
  const code = listedCode(data, text);
  if (code === null) throw new NoRecord(missingCode(data, text));
  const [family, choices] = data.codes[code];
  const [choice, record, files] = choices.find(([answers]) => answers === wantedChoice) ?? choices[0];
  return {
    ...data.families[family], choices: choices.map(([answers]) => answers), choice, files: cable === null ? files : {},
    record: withCable({ ...readRecord(data.records[record]), code, obstacle: "" }),
  };
}

/** Return the message about a text that is no listed order code: the codes that begin like it, or the command. */
function missingCode(data, text) {
  const begun = text.replace(/\s/g, "").toUpperCase();
  if (!begun) return "";
  if (["BISS", "SSI", "RS485", "SPI"].includes(begun)) return "Write a line, such as biss:position=32,error,warning,crc=6:0x43.";
  const near = Object.keys(data.codes).filter((listed) => listed.toUpperCase().startsWith(begun)).slice(0, 5);
  return near.length ? `Order codes that begin like this: ${near.join(", ")}.`
    : `No order code with BiSS or SSI begins like this.${/^[\w./ -]{1,60}$/.test(text)
      ? ` The command may know the label: codewheel master "${text.trim()}"` : ""}`;
}

/** Return the notes of a master that apply because its supply is not enough for the encoder. */
const supplyWarnings = (notes) => notes.filter((note) => /\bsupply\b.*\bnot enough\b/.test(note));

/** Return the kind of a line of the output: a title, the place of a setting and other details, or a value. */
function lineKind(line) {
  if (/^\S.*\S$/.test(line) && !/[.:]$/.test(line)) return "title";
  return /^ {6,8}\S/.test(line) ? "quiet" : "";
}

function mountSettings(box, data) {
  const element = (tag, properties = {}, ...children) => {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
  };
  const labelled = (title, control) => {
    control.id = `settings-${title.toLowerCase().replace(/[^a-z]+/g, "-")}`;
    box.append(element("div", { className: "setting" },
      element("label", { textContent: title, htmlFor: control.id }), control));
    return control;
  };
  const withLinks = (line) => {
    const pieces = line.textContent.split(/(https:\/\/[^\s,]*[^\s,.)])/);
    line.replaceChildren(...pieces.map((piece, index) => (index % 2 ? element("a", { href: piece, textContent: piece }) : piece)));
    return line;
  };
  const textInput = () => element("input", { type: "text", autocomplete: "off", spellcheck: false });
  const list = element("datalist", { id: "settings-codes" },
    ...Object.keys(data.codes).map((code) => element("option", { value: code })));
  const code = labelled("Order code or line", textInput());
  code.setAttribute("list", list.id);
  const master = labelled("Master", element("select"));
  const choice = labelled("Open question", element("select"));
  const cable = labelled("Cable in metres", Object.assign(textInput(), { inputMode: "decimal" }));
  const message = element("p");
  message.setAttribute("role", "status");
  const warning = element("p", { className: "warning" });
  const table = element("table", { className: "docutils" });
  const files = element("ul");
  const output = element("pre", { tabIndex: 0 });
  const answer = element("div", { className: "answer" }, warning, table, files,
    element("details", { open: true }, element("summary", { textContent: "The output of the command" }), output));
  box.append(list, message, answer);

  const fill = (select, options) => {
    const chosen = select.value;
    select.replaceChildren(...options.map(([value, text]) => element("option", { value, textContent: text })));
    if (options.some(([value]) => value === chosen)) select.value = chosen;
  };
  const showTable = (settings) => {
    const row = (tag, cells) => element("tr", {}, ...cells.map((text) => element(tag, { textContent: text })));
    table.hidden = settings.length === 0;
    const columns = settings.some(({ at }) => at) ? ["name", "value", "at"] : ["name", "value"];
    const titles = { name: "Setting", value: "Value", at: "In the master" };
    table.replaceChildren(element("thead", {}, row("th", columns.map((column) => titles[column]))),
      element("tbody", {}, ...settings.map((setting) => row("td", columns.map((column) => setting[column])))));
  };
  const showOutput = (text) => {
    const lines = text.split("\n");
    output.replaceChildren(...lines.map((line, index) => {
      const end = index < lines.length - 1 ? "\n" : "";
      return withLinks(element("span", { className: lineKind(line), textContent: line + end }));
    }));
  };
  const showFiles = (encoder, name) => {
    files.replaceChildren(...(encoder.files[name] ?? []).map(([format, device, number]) => {
      const blob = new Blob([`${fileText(data, encoder.record.code, number)}\n`], { type: "text/plain" });
      const base = [name, format, device, encoder.record.code].join("-").replace(/[^A-Za-z0-9-]+/g, "_");
      const title = `File for ${device}: ${format}`;
      return element("li", {}, element("a", {
        href: URL.createObjectURL(blob), download: base + data.formats[format], textContent: title }));
    }));
  };
  const show = (wantedMaster, wantedChoice) => {
    answer.hidden = true;
    choice.parentNode.hidden = true;
    const storeInAddress = (members) => history.replaceState(null, "", `#${new URLSearchParams(members)}`);
    let encoder;
    try {
      encoder = describedEncoder(data, code.value, wantedChoice ?? choice.value, cableMetres(cable.value));
    } catch (error) {
      if (!(error instanceof codewheelMaster.NoRecord)) throw error;
      message.textContent = error.message;
      storeInAddress({ code: code.value.slice(0, 1000), ...(cable.value ? { cable: cable.value } : {}) });
      return;
    }
    answer.hidden = false;
    const { record } = encoder;
    fill(choice, encoder.choices.map((answers) => [answers, answers.replaceAll("--choose ", "")]));
    choice.value = encoder.choice;
    choice.parentNode.hidden = encoder.choices.length < 2;
    const described = data.masters.filter(({ takes }) => takes.includes(record.words.interface));
    fill(master, described.map(({ name, title }) => [name, title]));
    const isMasterKnown = !wantedMaster || described.some(({ name }) => name === wantedMaster);
    if (wantedMaster && isMasterKnown) master.value = wantedMaster;
    const chosen = described.find(({ name }) => name === master.value);
    const metres = record.cable_m ?? "";
    message.replaceChildren(element("code", { textContent: settingsCommand(record.code, chosen.name, encoder.choice, metres) }));
    const { refusals, notes, settings } = codewheelMaster.shownSheet(encoder, chosen, data);
    const interfaceTitle = data.interfaces[record.words.interface];
    const warnings = [
      ...(isMasterKnown ? [] : [`No master '${wantedMaster.slice(0, 40)}' is described for ${interfaceTitle}.`]),
      ...(encoder.choices.length > 1 ? ["The manual leaves a question open. Choose the answer that fits your encoder."] : []),
      ...refusals, ...supplyWarnings(notes)];
    warning.hidden = warnings.length === 0;
    warning.textContent = warnings.join(" ");
    showTable(settings);
    showOutput(codewheelMaster.settingsText(encoder, chosen, data));
    showFiles(encoder, chosen.name);
    storeInAddress({
      code: record.code, master: chosen.name,
      ...(encoder.choice ? { choose: encoder.choice.replaceAll("--choose ", "") } : {}),
      ...(metres ? { cable: metres } : {}) });
  };
  const readAddress = () => {
    const given = new URLSearchParams(location.hash.slice(1));
    code.value = given.get("code") ?? code.value;
    cable.value = given.get("cable") ?? "";
    const answers = given.get("choose")?.split(" ").map((pair) => `--choose ${pair}`).join(" ");
    show(given.get("master"), answers);
  };
  for (const control of [code, master, choice, cable]) control.addEventListener("input", () => show());
  window.addEventListener("hashchange", readAddress);
  // An address such as #top has no order code.
  [code.value] = Object.keys(data.codes);
  readAddress();
}

if (typeof document !== "undefined") {
  for (const box of document.querySelectorAll(".codewheel-settings")) mountSettings(box, window.codewheelSettings);
}
if (typeof module !== "undefined") {
  module.exports = { cableMetres, describedEncoder, fileText, listedCode, settingsCommand, supplyWarnings };
}
