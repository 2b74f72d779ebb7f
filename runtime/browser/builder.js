// Licence 0BSD: use, modify and distribute this file without any condition.
// The form that builds the line of an encoder by clicking.

/** A line to begin with, by interface. */
const FIRST_LINES = named({
  biss: "biss:position=32,error,warning,crc=6:0x43", ssi: "ssi,gray:multiturn=12,singleturn=13",
  spi: "spi:position=14,error=high,parity=even", rs485: "rs485,low_byte_first:status=8,position=24,crc=8:0x101",
});
/** Fields to add: the text of the button, and the field. */
const NEW_FIELDS = [
  ["Position", "position=24"], ["Revolutions", "multiturn=12"], ["Position in a revolution", "singleturn=13"],
  ["Error bit", "error=low"], ["Warning bit", "warning=low"], ["Status bit", "status=high"],
  ["Life counter", "life_counter=6"], ["Other number", "value=8"], ["Constant bits", "constant=4:0x5"],
  ["Zero bits", "zero=1"], ["Unused bits", "unused=1"], ["Parity bit", "parity=even"], ["CRC", "crc=6:0x43"],
];
/** Options with a choice: their member, legend, interfaces, and values with their words. */
const LINE_CHOICES = [
  ["isGray", "Code", ["biss", "ssi", "spi"], [["", "binary"], [true, "Gray"]]],
  ["alignment", "Alignment", ["ssi"], [["", "not known"], ["msb_left", "left"], ["lsb_right", "right"]]],
  ["order", "Byte order", ["spi", "rs485"],
    [["", "not known"], ["little", "low byte first"], ["big", "high byte first"]]],
  ["mode", "SPI mode", ["spi"], [["", "not known"], [0, "0"], [1, "1"], [2, "2"], [3, "3"]]],
];
/** Options with a text: their member, which is also their word, and legend. */
const LINE_TEXTS = [
  ["clock", "Clock, such as 1MHz"], ["baud", "Baud"], ["request", "Request in hex bytes"],
  ["counts", "Counts per revolution"], ["turns", "Revolutions that it counts"],
];
const LINE_EFFECTS = [["error", "an error"], ["warning", "a warning"], ["status", "a status only"]];

// -- from the form to the line

/** A field as a line writes it. */
function writeLineField(field, interface_) {
  const { kind, name } = field;
  switch (kind) {
    case "flag": {
      const effect = field.effect ?? "status";
      const isUsual = effect === (name in LINE_EFFECT_VERDICTS ? name : "status");
      const isShort = interface_ === "biss" && field.level === "low" && isUsual && ["error", "warning"].includes(name);
      return isShort ? name : `${name}=${field.level}${isUsual ? "" : `:${effect}`}`;
    }
    case "constant": return `${name}=${field.bits}:${field.value}`;
    case "parity": return `parity=${field.isOdd ? "odd" : "even"}`;
    case "crc": {
      const inversion = field.isInverted === (interface_ === "biss") ? "" : field.isInverted ? ":inverted" : ":plain";
      const start = field.init && !/^0(x0+)?$/i.test(field.init) ? `:${field.init}` : "";
      return `crc=${field.bits}:${field.poly}${start}${inversion}`;
    }
    default: return `${name}=${field.bits}${field.isSigned ? ":signed" : ""}`;
  }
}

/** The line of a form. */
function builtLine({ interface: interface_, options, fields }) {
  const words = Object.entries(LINE_KEYWORDS).filter(([, [interfaces, member, value_]]) => value_ !== false
    && interfaces.includes(interface_) && options[member] === value_).map(([word]) => word);
  if (interface_ === "spi" && options.mode !== undefined) words.push(`mode=${options.mode}`);
  for (const [name] of LINE_TEXTS) {
    if (options[name] && LINE_SETTINGS[name][0].includes(interface_)) words.push(`${name}=${options[name]}`);
  }
  return `${[interface_, ...words].join(",")}:${fields.map((field) => writeLineField(field, interface_)).join(",")}`;
}

/** The form of a line, or null if the line has problems. Numbers are texts, as they are typed. */
function formOf(text) {
  const line = parsedLine(text);
  if (line.problems.length) return null;
  const given = text.slice(0, text.indexOf(":")).split(",").map((piece) => piece.split("=").map((one) => one.trim()));
  const options = { ...line.options, ...Object.fromEntries(given.filter(([name]) => LINE_TEXTS.some(([one]) => one === name))) };
  return { interface: line.interface, options, fields: line.fields.map(toFormField) };
}

function toFormField(field) {
  const { kind } = field;
  const width = { bits: `${field.bits}` };
  if (kind === "flag") {
    return { ...field, effect: Object.keys(LINE_EFFECT_VERDICTS).find((name) => LINE_EFFECT_VERDICTS[name] === field.verdict) };
  }
  if (kind === "constant") return { ...field, ...width, value: formatHex(field.value) };
  if (kind !== "crc") return { ...field, ...width };
  const poly = formatHex(field.poly | (ONE << BigInt(field.bits)));
  return { ...field, ...width, poly, init: formatHex(field.init) };
}

/** A new field with a name that no other field has. A CRC is the last one. */
function addField(form, text) {
  const field = toFormField(parseLineField(text, 0, form.interface));
  const names = new Set(form.fields.map((one) => one.name));
  const isNamed = !isFiller(field) && !["crc", "parity"].includes(field.kind) && !(field.name in LINE_NUMBER_UNITS);
  const { name } = field;
  for (let number = 2; isNamed && names.has(field.name); number += 1) field.name = `${name}_${number}`;
  const last = form.fields.at(-1);
  if (last?.kind === "crc") form.fields.splice(-1, 0, field);
  else form.fields.push(field);
  return field;
}

// -- the form

const createSmallInput = (label, text, changed, attributes = {}) => {
  const input = element("input", { autocomplete: "off", spellcheck: "false", ...attributes });
  input.value = text ?? "";
  input.addEventListener("input", () => changed(input.value.trim()));
  return element("label", {}, `${label} `, input);
};
const createCheckbox = (label, isOn, changed) => {
  const input = element("input", { type: "checkbox" });
  input.checked = Boolean(isOn);
  input.addEventListener("change", () => changed(input.checked));
  return element("label", {}, input, ` ${label}`);
};
const createSelection = (label, choices, chosen, changed) => {
  const select = element("select", {}, choices.map(([, words], place) => createOption(`${place}`, words)));
  select.value = `${Math.max(choices.findIndex(([one]) => one === chosen), 0)}`;
  select.addEventListener("change", () => changed(choices[Number(select.value)][0]));
  return element("label", {}, `${label} `, select);
};
const createButton = (text, act, label) => {
  const button = element("button", { type: "button", "aria-label": label }, text);
  button.addEventListener("click", act);
  return button;
};

/** The words for a field in the form. */
function titleOfField({ kind, name }) {
  const titles = { flag: "Flag", number: LINE_NUMBER_UNITS[name]?.[1] ?? "Number", constant: "Constant", zero: "Zero bits",
    unused: "Unused bits", parity: "Parity bit over the other fields", crc: "CRC over the bits before it" };
  return titles[kind];
}

/** The inputs of a field. ``changed`` writes the line, and ``redraw`` also builds the form again. */
function createLineFieldInputs(field, changed, redraw) {
  const set = (member) => (value_) => {
    field[member] = value_;
    changed();
  };
  const bitsInput = createSmallInput("Bits", field.bits, set("bits"), { inputmode: "numeric", size: "3" });
  const nameInput = createSmallInput("Name", field.name, set("name"), { size: "12" });
  switch (field.kind) {
    case "flag": return [nameInput,
      createSelection("Active", [["low", "at 0"], ["high", "at 1"]], field.level, set("level")),
      createSelection("Means", LINE_EFFECTS, field.effect, set("effect"))];
    case "constant": return [nameInput, bitsInput, createSmallInput("Value", field.value, set("value"), { size: "8" })];
    case "parity": return [createSelection("Ones, with it", [[false, "even"], [true, "odd"]], field.isOdd, set("isOdd"))];
    case "crc": return createCrcInputs(field, bitsInput, set, redraw);
    case "number": return [...(field.name in LINE_NUMBER_UNITS ? [] : [nameInput]), bitsInput,
      createCheckbox("signed", field.isSigned, set("isSigned"))];
    default: return [bitsInput];
  }
}

/** A list of the known CRCs, and the numbers of any other. */
function createCrcInputs(field, bitsInput, set, redraw) {
  const isSame = ([poly, init]) => BigInt(poly) === parseLineNumber(field.poly) && BigInt(init) === parseLineNumber(field.init || "0");
  const knownCrc = TABLE.known_crcs.find(isSame);
  const choices = [...TABLE.known_crcs.map((row) => [row, `${formatHex(BigInt(row[0]))}: ${row[2]}`]), [undefined, "other"]];
  const pick = (row) => {
    Object.assign(field, row ? { bits: `${bitLength(BigInt(row[0])) - 1}`, poly: formatHex(BigInt(row[0])), init: formatHex(BigInt(row[1])) }
      : { init: "0x0", isOther: true });
    if (row) delete field.isOther;
    redraw();
  };
  const isOther = field.isOther || !knownCrc;
  const numbers = [bitsInput, createSmallInput("Polynomial", field.poly, set("poly"), { size: "10" }),
    createSmallInput("Start value", field.init, set("init"), { size: "8" })];
  return [createSelection("CRC", choices, isOther ? undefined : knownCrc, pick), ...(isOther ? numbers : []),
    createCheckbox("inverted", field.isInverted, set("isInverted"))];
}

/** One field of the form, with buttons that move and remove it. */
function createFieldRow(form, place, changed, redraw) {
  const field = form.fields[place];
  const title = titleOfField(field);
  const move = (step) => () => {
    form.fields.splice(place, 1);
    form.fields.splice(place + step, 0, field);
    redraw(place + step, step < 0 ? 0 : 1);
  };
  const remove = () => {
    form.fields.splice(place, 1);
    redraw(Math.min(place, form.fields.length - 1), 2);
  };
  const number = `field ${place + 1}, ${title}`;
  const [up, down] = [createButton("↑", move(-1), `Move up ${number}`), createButton("↓", move(1), `Move down ${number}`)];
  up.disabled = place === 0;
  down.disabled = place === form.fields.length - 1;
  const buttons = part("span", "moves", up, down, createButton("✕", remove, `Remove ${number}`));
  return element("li", {}, element("fieldset", {}, element("legend", {}, title),
    part("div", "row", createLineFieldInputs(field, changed, redraw), buttons)));
}

/** The options of the line that its interface has. */
function createOptionRow(form, changed) {
  const set = (member) => (value_) => {
    if (value_ === "") delete form.options[member];
    else form.options[member] = value_;
    changed();
  };
  const choices = LINE_CHOICES.filter(([, , interfaces]) => interfaces.includes(form.interface));
  const texts = LINE_TEXTS.filter(([name]) => LINE_SETTINGS[name][0].includes(form.interface));
  return part("div", "row",
    choices.map(([member, legend, , values]) => createSelection(legend, values, form.options[member] ?? "", set(member))),
    texts.map(([name, legend]) => createSmallInput(legend, form.options[name], set(name), { size: "9" })));
}

/**
 * A form that builds a line. ``write`` gets the line after each change, and ``read`` returns the text of the box.
 * It is empty while it is closed.
 */
function createLineBuilder(read, write) {
  let form = formOf(FIRST_LINES.biss);
  let written = "";
  const body = part("div", "builder");
  const root = element("details", {}, element("summary", {}, "No order code? Describe the frame by clicking"), body);

  const changed = () => {
    written = builtLine(form);
    write(written);
  };

  /** Builds the form again, and gives the focus back to a button of a field: its place, and 0 up, 1 down, 2 remove. */
  function redraw(place, button) {
    changed();
    draw();
    if (button === undefined) return;
    const buttons = [...body.querySelectorAll("li")][place]?.querySelectorAll(`.${CLASS}-moves button`);
    const focused = buttons && [buttons[button], ...buttons].find((one) => !one.disabled);
    (focused ?? body.querySelector(`.${CLASS}-new button`)).focus();
  }

  function changeInterface(name) {
    const isFirst = builtLine(form) === builtLine(formOf(FIRST_LINES[form.interface]));
    if (isFirst) form = formOf(FIRST_LINES[name]);
    else {
      for (const field of form.fields) if (field.kind === "crc") field.isInverted = name === "biss";
      form.interface = name;
    }
    redraw();
    body.querySelector("select").focus();
  }

  function draw() {
    const rows = form.fields.map((_, place) => createFieldRow(form, place, changed, redraw));
    const isThere = (text) => form.fields.some(({ name }) => name === text.split("=")[0])
      && /^(position|multiturn|singleturn|parity|crc)=/.test(text);
    const added = NEW_FIELDS.filter(([, text]) => !isThere(text)).map(([words, text]) => createButton(`+ ${words}`, () => {
      const field = addField(form, text);
      redraw();
      [...body.querySelectorAll("li")][form.fields.indexOf(field)].querySelector("input, select").focus();
    }));
    const interfaces = LINE_INTERFACES.map((name) => [name, LINE_TITLES[name]]);
    body.replaceChildren(
      part("div", "row", createSelection("Interface", interfaces, form.interface, changeInterface)),
      createOptionRow(form, changed), part("p", "hint", "Fields in the order sent, first bit first:"),
      element("ol", {}, rows), part("div", "new", added));
  }

  /** Follows the text of the box, unless the form wrote it. */
  function follow() {
    if (!root.open || read() === written) return;
    form = (isLine(read()) && formOf(read())) || form;
    written = read();
    draw();
  }

  root.addEventListener("toggle", () => {
    if (!root.open) {
      body.replaceChildren();
      return;
    }
    form = (isLine(read()) && formOf(read())) || form;
    if (!read().trim()) changed();
    draw();
  });
  return { root, follow };
}
