// License 0BSD: use, modify and distribute this file without any condition.
// The form that builds the line of an encoder by clicking.

/** A line to begin with, by interface. */
const FIRST_LINES = mergeByName({
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
/** Orders of bytes, with their words in the form. */
const BYTE_ORDER_CHOICES = [["little", "low byte first"], ["big", "high byte first"]];
/** Options with a choice: their member, legend, interfaces, and values with their words. */
const LINE_CHOICES = [
  ["isGray", "Code", ["biss", "ssi", "spi"], [["", "binary"], [true, "Gray"]]],
  ["alignment", "Alignment", ["ssi"], [["", "not known"], ["msb_left", "left"], ["lsb_right", "right"]]],
  ["order", "Byte order", ["spi", "rs485"], [["", "not known"], ...BYTE_ORDER_CHOICES]],
  ["mode", "SPI mode", ["spi"], [["", "not known"], [0, "0"], [1, "1"], [2, "2"], [3, "3"]]],
];
/** Options with a text: their member, which is also their word, and legend. */
const LINE_TEXTS = [
  ["clock", "Clock, such as 1MHz"], ["baud", "Baud"], ["request", "Request in hex bytes"],
  ["counts", "Counts per revolution"], ["turns", "Revolutions that it counts"],
];
/** Effects of a flag that is active, with their words in the form. */
const LINE_EFFECTS = [["error", "an error"], ["warning", "a warning"], ["status", "a status only"]];

// -- from the form to the line

/** Return a field as a line writes it. */
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
      const startValue = field.init && !/^0(x0+)?$/i.test(field.init) ? `:${field.init}` : "";
      const orderWord = Object.keys(BYTE_ORDER_WORDS).find((word) => BYTE_ORDER_WORDS[word] === field.order);
      const words = [...(field.isReflected ? ["reflected"] : []), ...(orderWord ? [orderWord] : [])];
      return [`crc=${field.bits}:${field.poly}${startValue}${inversion}`, ...words].join(":");
    }
    default: return `${name}=${field.bits}${field.isSigned ? ":signed" : ""}`;
  }
}

/** Return the line of a form, which is {interface, options, fields}. */
function builtLine({ interface: interface_, options, fields }) {
  const optionTexts = Object.entries(LINE_KEYWORDS).filter(([, [interfaces, member, optionValue]]) =>
    optionValue !== false && interfaces.includes(interface_) && options[member] === optionValue)
    .map(([keyword]) => keyword);
  if (interface_ === "spi" && options.mode !== undefined) optionTexts.push(`mode=${options.mode}`);
  for (const [name] of LINE_TEXTS) {
    if (options[name] && LINE_SETTINGS[name][0].includes(interface_)) optionTexts.push(`${name}=${options[name]}`);
  }
  return `${[interface_, ...optionTexts].join(",")}:${
    fields.map((field) => writeLineField(field, interface_)).join(",")}`;
}

/** Return the form of a line, or null if the line has problems. Numbers are texts, as they are typed. */
function formOf(lineText) {
  const line = parsedLine(lineText);
  if (line.problems.length) return null;
  const typedOptions = lineText.slice(0, lineText.indexOf(":")).split(",")
    .map((piece) => piece.split("=").map((text) => text.trim()));
  const options = {
    ...line.options,
    ...Object.fromEntries(typedOptions.filter(([name]) => LINE_TEXTS.some(([textName]) => textName === name))),
  };
  return { interface: line.interface, options, fields: line.fields.map(toFormField) };
}

/** Convert a field of a parsed line to one of the form, where widths and other numbers are texts. */
function toFormField(field) {
  const { kind } = field;
  const widthText = { bits: `${field.bits}` };
  if (kind === "flag") {
    return {
      ...field,
      effect: Object.keys(LINE_EFFECT_VERDICTS).find((name) => LINE_EFFECT_VERDICTS[name] === field.verdict),
    };
  }
  if (kind === "constant") return { ...field, ...widthText, value: hex(field.value) };
  if (kind !== "crc") return { ...field, ...widthText };
  const poly = hex(field.poly | (ONE << BigInt(field.bits)));
  return { ...field, ...widthText, poly, init: hex(field.init) };
}

/** Add a new field with a name that is free in the form. A CRC stays the last field. */
function addField(form, fieldText) {
  const field = toFormField(parseLineField(fieldText, 0, form.interface));
  const names = new Set(form.fields.map((otherField) => otherField.name));
  const isNamed = !isFiller(field) && !["crc", "parity"].includes(field.kind) && !(field.name in LINE_NUMBER_UNITS);
  const { name } = field;
  for (let suffix = 2; isNamed && names.has(field.name); suffix += 1) field.name = `${name}_${suffix}`;
  const lastField = form.fields.at(-1);
  if (lastField?.kind === "crc") form.fields.splice(-1, 0, field);
  else form.fields.push(field);
  return field;
}

// -- the form

/** Create an input with its label. ``onChange`` gets its text. */
const createSmallInput = (label, text, onChange, attributes = {}) => {
  const input = createElement("input", { autocomplete: "off", spellcheck: "false", ...attributes });
  input.value = text ?? "";
  input.addEventListener("input", () => onChange(input.value.trim()));
  return createElement("label", {}, `${label} `, input);
};
/** Create a checkbox with its label. ``onChange`` gets whether it is on. */
const createCheckbox = (label, isOn, onChange) => {
  const input = createElement("input", { type: "checkbox" });
  input.checked = Boolean(isOn);
  input.addEventListener("change", () => onChange(input.checked));
  return createElement("label", {}, input, ` ${label}`);
};
/** Create a selection with its label. A choice is [value, text], and ``onChange`` gets the value. */
const createSelection = (label, choices, selectedValue, onChange) => {
  const select = createElement("select", {},
    choices.map(([, choiceText], choiceIndex) => createOption(`${choiceIndex}`, choiceText)));
  select.value = `${Math.max(choices.findIndex(([choiceValue]) => choiceValue === selectedValue), 0)}`;
  select.addEventListener("change", () => onChange(choices[Number(select.value)][0]));
  return createElement("label", {}, `${label} `, select);
};
/** Create a button. ``ariaLabel`` is its name for screen readers, if its text is a symbol. */
const createButton = (text, onClick, ariaLabel) => {
  const button = createElement("button", { type: "button", "aria-label": ariaLabel }, text);
  button.addEventListener("click", onClick);
  return button;
};

/** Return the words for a field in the form. */
function titleOfField({ kind, name }) {
  const titles = { flag: "Flag", number: LINE_NUMBER_UNITS[name]?.[1] ?? "Number", constant: "Constant",
    zero: "Zero bits", unused: "Unused bits", parity: "Parity bit over the other fields",
    crc: "CRC over the bits before it" };
  return titles[kind];
}

/** Create the inputs of a field. ``onChange`` writes the line, and ``redraw`` also builds the form again. */
function createLineFieldInputs(field, interface_, onChange, redraw) {
  const setterOf = (member) => (newValue) => {
    field[member] = newValue;
    onChange();
  };
  const bitsInput = createSmallInput("Bits", field.bits, setterOf("bits"), { inputmode: "numeric", size: "3" });
  const nameInput = createSmallInput("Name", field.name, setterOf("name"), { size: "12" });
  switch (field.kind) {
    case "flag": return [nameInput,
      createSelection("Active", [["low", "at 0"], ["high", "at 1"]], field.level, setterOf("level")),
      createSelection("Means", LINE_EFFECTS, field.effect, setterOf("effect"))];
    case "constant": return [nameInput, bitsInput,
      createSmallInput("Value", field.value, setterOf("value"), { size: "8" })];
    case "parity": return [
      createSelection("Ones, with it", [[false, "even"], [true, "odd"]], field.isOdd, setterOf("isOdd"))];
    case "crc": return createCrcInputs(field, interface_, bitsInput, setterOf, redraw);
    case "number": return [...(field.name in LINE_NUMBER_UNITS ? [] : [nameInput]), bitsInput,
      createCheckbox("signed", field.isSigned, setterOf("isSigned"))];
    default: return [bitsInput];
  }
}

/** Create a list of the known CRCs, and inputs for the numbers of any other. ``setterOf`` takes a field member. */
function createCrcInputs(field, interface_, bitsInput, setterOf, redraw) {
  const isSameCrc = ([poly, init]) => BigInt(poly) === parseLineNumber(field.poly)
    && BigInt(init) === parseLineNumber(field.init || "0");
  const knownCrc = TABLE.known_crcs.find(isSameCrc);
  const choices = [
    ...TABLE.known_crcs.map((row) => [row, `${hex(BigInt(row[0]))}: ${row[2]}`]), [undefined, "other"]];
  const pickCrc = (row) => {
    Object.assign(field, row
      ? { bits: `${bitLength(BigInt(row[0])) - 1}`, poly: hex(BigInt(row[0])), init: hex(BigInt(row[1])) }
      : { init: "0x0", isOther: true });
    if (row) delete field.isOther;
    redraw();
  };
  const isOther = field.isOther || !knownCrc;
  const numberInputs = [bitsInput, createSmallInput("Polynomial", field.poly, setterOf("poly"), { size: "10" }),
    createSmallInput("Start value", field.init, setterOf("init"), { size: "8" })];
  const byteInputs = [createCheckbox("reflected", field.isReflected, setterOf("isReflected")),
    createSelection("Byte order", [[undefined, "as the frame"], ...BYTE_ORDER_CHOICES], field.order, setterOf("order"))];
  return [createSelection("CRC", choices, isOther ? undefined : knownCrc, pickCrc), ...(isOther ? numberInputs : []),
    createCheckbox("inverted", field.isInverted, setterOf("isInverted")),
    ...(interface_ === "rs485" ? byteInputs : [])];
}

/** Create one field of the form, with buttons that move and remove it. */
function createFieldRow(form, fieldIndex, onChange, redraw) {
  const field = form.fields[fieldIndex];
  const title = titleOfField(field);
  const moveBy = (step) => () => {
    form.fields.splice(fieldIndex, 1);
    form.fields.splice(fieldIndex + step, 0, field);
    redraw(fieldIndex + step, step < 0 ? 0 : 1);
  };
  const remove = () => {
    form.fields.splice(fieldIndex, 1);
    redraw(Math.min(fieldIndex, form.fields.length - 1), 2);
  };
  const fieldLabel = `field ${fieldIndex + 1}, ${title}`;
  const [upButton, downButton] = [
    createButton("↑", moveBy(-1), `Move up ${fieldLabel}`),
    createButton("↓", moveBy(1), `Move down ${fieldLabel}`)];
  upButton.disabled = fieldIndex === 0;
  downButton.disabled = fieldIndex === form.fields.length - 1;
  const removeButton = createButton("✕", remove, `Remove ${fieldLabel}`);
  const buttons = createPart("span", "moves", upButton, downButton, removeButton);
  return createElement("li", {}, createElement("fieldset", {}, createElement("legend", {}, title),
    createPart("div", "row", createLineFieldInputs(field, form.interface, onChange, redraw), buttons)));
}

/** Create the inputs of the options that the interface of the line has. */
function createOptionRow(form, onChange) {
  const setterOf = (member) => (newValue) => {
    if (newValue === "") delete form.options[member];
    else form.options[member] = newValue;
    onChange();
  };
  const choices = LINE_CHOICES.filter(([, , interfaces]) => interfaces.includes(form.interface));
  const textOptions = LINE_TEXTS.filter(([name]) => LINE_SETTINGS[name][0].includes(form.interface));
  return createPart("div", "row",
    choices.map(([member, legend, , values]) =>
      createSelection(legend, values, form.options[member] ?? "", setterOf(member))),
    textOptions.map(([name, legend]) => createSmallInput(legend, form.options[name], setterOf(name), { size: "9" })));
}

/**
 * Create a form that builds a line. ``writeBox`` gets the line after each change, and ``readBox`` returns the text of
 * the box. The form is empty while it is closed.
 */
function createLineBuilder(readBox, writeBox) {
  let form = formOf(FIRST_LINES.biss);
  let writtenLine = "";
  const body = createPart("div", "builder");
  const summary = createElement("summary", {}, "No order code? Describe the frame by clicking");
  const root = createElement("details", {}, summary, body);

  /** Write the line of the form into the box. */
  const writeLine = () => {
    writtenLine = builtLine(form);
    writeBox(writtenLine);
  };

  /** Build the form again, and give the focus back to a button of a field: its index, and 0 up, 1 down, 2 remove. */
  function redraw(fieldIndex, buttonIndex) {
    writeLine();
    draw();
    if (buttonIndex === undefined) return;
    const buttons = [...body.querySelectorAll("li")][fieldIndex]?.querySelectorAll(`.${CLASS}-moves button`);
    const buttonToFocus = buttons && [buttons[buttonIndex], ...buttons].find((candidate) => !candidate.disabled);
    (buttonToFocus ?? body.querySelector(`.${CLASS}-new button`)).focus();
  }

  /** Change the interface of the line. An unchanged first line becomes the first line of the other interface. */
  function changeInterface(name) {
    const isUnchanged = builtLine(form) === builtLine(formOf(FIRST_LINES[form.interface]));
    if (isUnchanged) form = formOf(FIRST_LINES[name]);
    else {
      for (const field of form.fields) if (field.kind === "crc") field.isInverted = name === "biss";
      form.interface = name;
    }
    redraw();
    body.querySelector("select").focus();
  }

  /** Build the inputs of the form. */
  function draw() {
    const fieldRows = form.fields.map((_, fieldIndex) => createFieldRow(form, fieldIndex, writeLine, redraw));
    const isInForm = (fieldText) => form.fields.some(({ name }) => name === fieldText.split("=")[0])
      && /^(position|multiturn|singleturn|parity|crc)=/.test(fieldText);
    const addButtons = NEW_FIELDS.filter(([, fieldText]) => !isInForm(fieldText))
      .map(([buttonText, fieldText]) => createButton(`+ ${buttonText}`, () => {
        const field = addField(form, fieldText);
        redraw();
        [...body.querySelectorAll("li")][form.fields.indexOf(field)].querySelector("input, select").focus();
      }));
    const interfaceChoices = LINE_INTERFACES.map((name) => [name, LINE_TITLES[name]]);
    body.replaceChildren(
      createPart("div", "row", createSelection("Interface", interfaceChoices, form.interface, changeInterface)),
      createOptionRow(form, writeLine), createPart("p", "hint", "Fields in the order sent, first bit first:"),
      createElement("ol", {}, fieldRows), createPart("div", "new", addButtons));
  }

  /** Follow the text of the box, unless the form wrote it. */
  function follow() {
    if (!root.open || readBox() === writtenLine) return;
    form = (isLine(readBox()) && formOf(readBox())) || form;
    writtenLine = readBox();
    draw();
  }

  root.addEventListener("toggle", () => {
    if (!root.open) {
      body.replaceChildren();
      return;
    }
    form = (isLine(readBox()) && formOf(readBox())) || form;
    if (!readBox().trim()) writeLine();
    draw();
  });
  return { root, follow };
}
