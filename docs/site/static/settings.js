/* The page with master settings: shows what "codewheel master" prints for an order code and a master. */
"use strict";

/** Return a text about an order code. Lines have placeholders for the code, and for the code as an identifier. */
function settingsText(data, code, number) {
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
function settingsCommand(code, master, choice) {
  return ["codewheel master", code, "--master", master, choice].filter(Boolean).join(" ");
}

/** Return the kind of a line: the title of an encoder or a master, the place of a setting and other details, or a value. */
function lineKind(line) {
  if (/^\S.*\S$/.test(line) && !/[.:]$/.test(line)) return "title";
  return /^ {6,8}\S/.test(line) ? "quiet" : "";
}

/** Return the remarks about a supply of the master that is not enough for the encoder. */
function supplyWarnings(text) {
  const remarks = [...text.matchAll(/^( *)- (.*(?:\n\1 {2}.*)*)/gm)].map((found) => found[2].replace(/\s+/g, " "));
  return remarks.filter((remark) => /\bsupply\b.*\bnot enough\b/.test(remark));
}

function mountSettings(box, data) {
  const element = (tag, properties) => Object.assign(document.createElement(tag), properties);
  const labelled = (title, control) => {
    const row = element("div", { className: "setting" });
    const label = element("label", { textContent: title });
    control.id = label.htmlFor = `settings-${title.toLowerCase().replace(/ /g, "-")}`;
    row.append(label, control);
    box.append(row);
    return control;
  };
  const withLinks = (line) => {
    const pieces = line.textContent.split(/(https:\/\/[^\s,]*[^\s,.)])/);
    line.replaceChildren(...pieces.map((piece, index) => (index % 2 ? element("a", { href: piece, textContent: piece }) : piece)));
    return line;
  };
  const list = element("datalist", { id: "settings-codes" });
  list.append(...Object.keys(data.codes).map((code) => element("option", { value: code })));
  const code = labelled("Order code", element("input", { type: "text", autocomplete: "off", spellcheck: false }));
  code.setAttribute("list", list.id);
  const master = labelled("Master", element("select", {}));
  const choice = labelled("Open question", element("select", {}));
  const message = element("p", {});
  message.setAttribute("role", "status");
  const output = element("pre", { tabIndex: 0 });
  const warning = element("p", { className: "warning" });
  const cable = element("p", { className: "cable" });
  const files = element("ul", {});
  box.append(list, message, cable, warning, output, files);

  const fill = (select, options) => {
    const chosen = select.value;
    select.replaceChildren(...options.map(([value, text]) => element("option", { value, textContent: text })));
    if (options.some(([value]) => value === chosen)) select.value = chosen;
  };
  const readAddress = () => {
    const given = new URLSearchParams(location.hash.slice(1));
    code.value = given.get("code") ?? code.value;
    show(given.get("master"), given.get("choose"));
  };
  const show = (wantedMaster, wantedChoice) => {
    const found = listedCode(data, code.value);
    output.hidden = files.hidden = found === null;
    cable.hidden = warning.hidden = true;
    choice.parentNode.hidden = true;
    message.textContent = "";
    if (found === null) {
      const begun = code.value.replace(/\s/g, "").toUpperCase();
      const near = Object.keys(data.codes).filter((listed) => begun && listed.toUpperCase().startsWith(begun)).slice(0, 5);
      if (near.length) message.textContent = `Order codes that begin like this: ${near.join(", ")}.`;
      else if (begun) message.textContent = `No order code with BiSS or SSI begins like this. Try: codewheel master ${code.value}`;
      return;
    }
    const choices = data.codes[found];
    fill(choice, choices.map(([answers], index) => [String(index), answers.replaceAll("--choose ", "")]));
    const wantedIndex = choices.findIndex(([answers]) => answers.replaceAll("--choose ", "") === wantedChoice);
    if (wantedIndex >= 0) choice.value = String(wantedIndex);
    choice.parentNode.hidden = choices.length < 2;
    const [answers, byMaster] = choices[Number(choice.value)];
    const described = data.masters.filter((_, index) => byMaster[index].length);
    fill(master, described);
    if (described.some(([name]) => name === wantedMaster)) master.value = wantedMaster;
    const [number, formats] = byMaster[data.masters.findIndex(([name]) => name === master.value)];
    message.replaceChildren(element("code", { textContent: settingsCommand(found, master.value, answers) }));
    const text = settingsText(data, found, number);
    const warnings = supplyWarnings(text);
    warning.hidden = warnings.length === 0;
    warning.textContent = warnings.join(" ");
    cable.hidden = !text.includes("--cable METRES");
    cable.replaceChildren("For the clocks with a cable of 30 m, run ",
      element("code", { textContent: `${settingsCommand(found, master.value, answers)} --cable 30` }), ".");
    const lines = text.split("\n");
    output.replaceChildren(...lines.map((line, index) => {
      const end = index < lines.length - 1 ? "\n" : "";
      return withLinks(element("span", { className: lineKind(line), textContent: line + end }));
    }));
    files.replaceChildren(...formats.map(([format, device, file]) => {
      const blob = new Blob([`${settingsText(data, found, file)}\n`], { type: "text/plain" });
      const name = [master.value, format, device, found].join("-").replace(/[^A-Za-z0-9-]+/g, "_");
      const title = `File for ${device}: ${format}`;
      const link = element("a", { href: URL.createObjectURL(blob), download: name + data.formats[format], textContent: title });
      const item = element("li", {});
      item.append(link);
      return item;
    }));
    const address = new URLSearchParams({ code: found, master: master.value });
    if (answers) address.set("choose", answers.replaceAll("--choose ", ""));
    history.replaceState(null, "", `#${address}`);
  };
  for (const control of [code, master, choice]) control.addEventListener("input", () => show());
  window.addEventListener("hashchange", readAddress);
  // An address such as #top has no order code.
  code.value = Object.keys(data.codes)[0];
  readAddress();
}

if (typeof document !== "undefined") {
  for (const box of document.querySelectorAll(".codewheel-settings")) mountSettings(box, window.codewheelSettings);
}
if (typeof module !== "undefined") module.exports = { settingsText, listedCode, settingsCommand, supplyWarnings };
