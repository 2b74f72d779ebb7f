// Licence 0BSD: use, modify and distribute this file without any condition.
// Form for the values of a register, from and to bytes.

/** The description of a register, and for a writable one a form that encodes its bytes. */
function registerForm(state, register, text, show) {
  const placedRegister = () => placedFor(state.found, register, state.held, state.answers);
  const allLimits = register.limits ?? [];
  const bounds = allLimits.map((limits) => boundsOf(placedRegister(), limits)).filter(Boolean);
  const notes = part("p", "note", [...(register.about ?? []), ...bounds.map(sentence)].join(" "));
  if (!register.writable) {
    return { parts: [notes, part("p", "note", "Read-only. Paste its bytes to decode them.")], fill: null };
  }
  const refusal = part("p", "wrong");
  refusal.setAttribute("role", "alert");
  const inputs = [
    ...placedRegister().joins.filter((join) => join.parts.length > 1).map((join) => joinInput(join)),
    ...placedRegister().fields.filter(isGiven).map((placedField) => fieldInput(placedField)),
  ];
  const limitsByMeaning = allLimits.filter((limits) => limits.name);
  const meanings = limitsByMeaning.map(({ name, meaning }) => option(name, `${name}: ${meaning ?? ""}`));
  const chosenMeaning = element("select", {}, option("", "choose"), meanings);

  function encodeInputs() {
    refusal.textContent = "";
    try {
      text.value = bytesFor(placedRegister(), valuesOf(inputs), limitsFor(register, limitsByMeaning, chosenMeaning.value));
      show(true);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      refusal.textContent = sentence(error.message);
    }
  }

  const form = element("fieldset", {}, element("legend", {}, "Change values to encode bytes"),
    limitsByMeaning.length ? labelled("Meaning", chosenMeaning) : "", inputs.map(({ label }) => label), refusal);
  form.addEventListener("input", (event) => {
    inputs.find((labelledInput) => labelledInput.input === event.target)?.split?.(inputs);
    encodeInputs();
  });
  if (register.default) form.append(defaultButton(register, text, show));
  return { parts: [form, notes], fill: (decoded) => fill(inputs, decoded) };
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
function boundsOf(placedRegister, { name, of, low, high }) {
  if (low === null && high === null) return "";
  const bounds = [["at least", low], ["at most", high]].filter(([, bound]) => bound !== null)
    .map(([words, bound]) => `${words} ${value(bound, placedRegister.parameters)}`);
  return `Limits of ${name ?? of ?? placedRegister.name}: ${bounds.join(", ")}`;
}

/** The applicable limits: those of the chosen meaning, if a register has several. */
function limitsFor(register, limitsByMeaning, chosenMeaning) {
  if (limitsByMeaning.length && !chosenMeaning) throw new Refusal("Choose the meaning of the register first");
  if (!limitsByMeaning.length) return (register.limits ?? [])[0];
  return limitsByMeaning.find((limits) => limits.name === chosenMeaning);
}

/** An input for a field, by its kind. */
function fieldInput({ field, name, width }) {
  const hint = [field.meaning, field.unit].filter(Boolean).join(", ") || counted(width, "bit");
  const inputOf = (input, read, write) => ({ name, input, read, write, label: labelled(name, input, hint) });
  if (field.kind === "flag" || field.kind === "not_flag") {
    const input = element("input", { type: "checkbox" });
    return inputOf(input, () => input.checked, (isActive) => Object.assign(input, { checked: isActive }));
  }
  if (field.kind === "choice") {
    const choices = field.values.map(([number, text]) => option(`${big(number)}`, text));
    const input = element("select", {}, option("", "choose"), choices);
    const read = () => (input.value ? BigInt(input.value) : "");
    return inputOf(input, read, (_, raw) => Object.assign(input, { value: `${raw}` }));
  }
  const isText = field.kind === "text";
  const input = element("input", { autocomplete: "off", inputmode: isText ? "text" : "numeric" });
  const read = () => (isText ? input.value : numberOrEmpty(input.value));
  return inputOf(input, read, (fieldValue) => Object.assign(input, { value: fieldValue }));
}

/** An input for a number of several fields, which it fills in. */
function joinInput({ name, parts }) {
  const input = element("input", { autocomplete: "off", inputmode: "numeric" });
  const names = parts.map((part) => part.item?.name).filter(Boolean).reverse().join(" and ");
  const split = (inputs) => {
    const number = numberOrEmpty(input.value);
    if (number === "") return;
    for (const [partName, partNumber] of splitInto(parts, number)) {
      inputs.find((partInput) => partInput.name === partName)?.write(partNumber, partNumber);
    }
  };
  const label = labelled(name, input, said("as_one_number", names));
  return { name: "", join: name, input, label, split, write: (number) => Object.assign(input, { value: number }) };
}

const numberOrEmpty = (text) => {
  const [, sign, digits] = /^\s*(-?)(.*)$/s.exec(text);
  const number = numberOrNull(digits);
  return number === null ? "" : sign ? -number : number;
};

function valuesOf(inputs) {
  const values = inputs.filter((input) => input.name).map((input) => [input.name, input.read()]);
  const missing = values.find(([, fieldValue]) => fieldValue === "");
  if (missing) throw new Refusal(`'${missing[0]}' needs a value`);
  return named(Object.fromEntries(values));
}

function fill(inputs, decoded) {
  for (const input of inputs) {
    const field = decoded.fields.find((candidate) => candidate.name === (input.name || input.join));
    if (field) input.write(field.value, field.raw);
  }
}
