// Licence 0BSD: use, modify and distribute this file without any condition.
// Form for the values of a register, from and to bytes.

/** The description of a register, and for a writable one a form that encodes its bytes. */
function registerForm(state, register, text, show) {
  const at = () => placedFor(state.found, register, state.held, state.answers);
  const bounds = (register.limits ?? []).map((one) => boundsOf(at(), one)).filter(Boolean);
  const about = part("p", "note", [...(register.about ?? []), ...bounds.map(sentence)].join(" "));
  if (!register.writable) {
    return { parts: [about, part("p", "note", "Read-only. Paste its bytes to decode them.")], fill: null };
  }
  const wrong = part("p", "wrong");
  wrong.setAttribute("role", "alert");
  const items = [
    ...at().joins.filter((join) => join.parts.length > 1).map((join) => joinItem(join)),
    ...at().fields.filter(isGiven).map((item) => fieldItem(item)),
  ];
  const senses = (register.limits ?? []).filter((one) => one.name);
  const meanings = senses.map((one) => option(one.name, `${one.name}: ${one.meaning ?? ""}`));
  const meant = element("select", {}, option("", "choose"), meanings);

  function make() {
    wrong.textContent = "";
    try {
      text.value = bytesFor(at(), valuesOf(items), limitsFor(register, senses, meant.value));
      show(true);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      wrong.textContent = sentence(error.message);
    }
  }

  const fields = element("fieldset", {}, element("legend", {}, "Change values to encode bytes"),
    senses.length ? labelled("Meaning", meant) : "", items.map((item) => item.label), wrong);
  fields.addEventListener("input", (event) => {
    items.find((item) => item.input === event.target)?.split?.(items);
    make();
  });
  if (register.default) fields.append(defaultButton(register, text, show));
  return { parts: [fields, about], fill: (found) => fill(items, found) };
}

function defaultButton(register, text, show) {
  const button = element("button", { type: "button" }, `Default: ${register.default}`);
  button.addEventListener("click", () => {
    text.value = register.default;
    show();
  });
  return button;
}

/** The limits of a register in numbers, or an empty string without limits. */
function boundsOf(at, { name, of, low, high }) {
  if (low === null && high === null) return "";
  const shown = [["at least", low], ["at most", high]].filter(([, one]) => one !== null)
    .map(([words, one]) => `${words} ${value(one, at.parameters)}`);
  return `Limits of ${name ?? of ?? at.name}: ${shown.join(", ")}`;
}

/** The applicable limits: those of the chosen meaning, if a register has several. */
function limitsFor(register, senses, meant) {
  if (senses.length && !meant) throw new Refusal("Choose the meaning of the register first");
  return senses.length ? senses.find((one) => one.name === meant) : (register.limits ?? [])[0];
}

/** An input for a field, by its kind. */
function fieldItem({ field, name, width }) {
  const hint = [field.meaning, field.unit].filter(Boolean).join(", ") || counted(width, "bit");
  const item = (input, read, write) => ({ name, input, read, write, label: labelled(name, input, hint) });
  if (field.kind === "flag" || field.kind === "not_flag") {
    const input = element("input", { type: "checkbox" });
    return item(input, () => input.checked, (one) => Object.assign(input, { checked: one }));
  }
  if (field.kind === "choice") {
    const choices = field.values.map(([number, text]) => option(`${big(number)}`, text));
    const input = element("select", {}, option("", "choose"), choices);
    const read = () => (input.value ? BigInt(input.value) : "");
    return item(input, read, (_, raw) => Object.assign(input, { value: `${raw}` }));
  }
  const isText = field.kind === "text";
  const input = element("input", { autocomplete: "off", inputmode: isText ? "text" : "numeric" });
  const read = () => (isText ? input.value : numberOrEmpty(input.value));
  return item(input, read, (one) => Object.assign(input, { value: one }));
}

/** An input for a number of several fields, which it fills in. */
function joinItem({ name, parts }) {
  const input = element("input", { autocomplete: "off", inputmode: "numeric" });
  const names = parts.map((one) => one.item?.name).filter(Boolean).reverse().join(" and ");
  const split = (items) => {
    const given = numberOrEmpty(input.value);
    if (given === "") return;
    for (const [part, own] of splitInto(parts, given)) items.find((one) => one.name === part)?.write(own, own);
  };
  const label = labelled(name, input, said("as_one_number", names));
  return { name: "", join: name, input, label, split, write: (one) => Object.assign(input, { value: one }) };
}

const numberOrEmpty = (text) => {
  const [, sign, digits] = /^\s*(-?)(.*)$/s.exec(text);
  const number = numberOrNull(digits);
  return number === null ? "" : sign ? -number : number;
};

function valuesOf(items) {
  const given = items.filter((item) => item.name).map((item) => [item.name, item.read()]);
  const missing = given.find(([, one]) => one === "");
  if (missing) throw new Refusal(`'${missing[0]}' needs a value`);
  return named(Object.fromEntries(given));
}

function fill(items, found) {
  for (const item of items) {
    const entry = found.fields.find((one) => one.name === (item.name || item.join));
    if (entry) item.write(entry.value, entry.raw);
  }
}
