// Licence 0BSD: use, modify and distribute this file without any condition.
// Form for the values of a register, from and to bytes.

/** The description of a register, and for a writable one a form that encodes its bytes. */
function createRegisterForm(state, register, text, show) {
  const placedRegister = () => placedFor(state.found, register, state.held, state.answers);
  const allLimits = register.limits ?? [];
  const bounds = allLimits.map((limits) => describeLimits(placedRegister(), limits)).filter(Boolean);
  const notes = part("p", "note", [...(register.about ?? []), ...bounds.map(sentence)].join(" "));
  if (!register.writable) {
    return { parts: [notes, part("p", "note", "Read-only. Paste its bytes to decode them.")], fill: null };
  }
  const refusal = part("p", "wrong");
  refusal.setAttribute("role", "alert");
  const inputs = [
    ...placedRegister().joins.filter((join) => join.parts.length > 1).map((join) => createJoinInput(join)),
    ...placedRegister().fields.filter(isGiven).map((placedField) => createFieldInput(placedField)),
  ];
  const limitsByMeaning = allLimits.filter((limits) => limits.name);
  const meanings = limitsByMeaning.map(({ name, meaning }) => createOption(name, `${name}: ${meaning ?? ""}`));
  const chosenMeaning = element("select", {}, createOption("", "choose"), meanings);

  function encodeInputs() {
    refusal.textContent = "";
    try {
      text.value = bytesFor(placedRegister(), readInputs(inputs), chooseLimits(register, limitsByMeaning, chosenMeaning.value));
      show(true);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      refusal.textContent = sentence(error.message);
    }
  }

  const form = element("fieldset", {}, element("legend", {}, "Change values to encode bytes"),
    limitsByMeaning.length ? createLabelledInput("Meaning", chosenMeaning) : "", inputs.map(({ label }) => label), refusal);
  form.addEventListener("input", (event) => {
    inputs.find((labelledInput) => labelledInput.input === event.target)?.split?.(inputs);
    encodeInputs();
  });
  if (register.default) form.append(createDefaultButton(register, text, show));
  return { parts: [form, notes], fill: (decoded) => fillInputs(inputs, decoded) };
}

function createDefaultButton(register, text, show) {
  const button = element("button", { type: "button" }, `Default: ${register.default}`);
  button.addEventListener("click", () => {
    text.value = register.default;
    show();
  });
  return button;
}

/** The limits of a register in numbers, or an empty string without limits. */
function describeLimits(placedRegister, { name, of, low, high }) {
  if (low === null && high === null) return "";
  const bounds = [["at least", low], ["at most", high]].filter(([, bound]) => bound !== null)
    .map(([words, bound]) => `${words} ${value(bound, placedRegister.parameters)}`);
  return `Limits of ${name ?? of ?? placedRegister.name}: ${bounds.join(", ")}`;
}

/** The applicable limits: those of the chosen meaning, if a register has several. */
function chooseLimits(register, limitsByMeaning, chosenMeaning) {
  if (limitsByMeaning.length && !chosenMeaning) throw new Refusal("Choose the meaning of the register first");
  if (!limitsByMeaning.length) return (register.limits ?? [])[0];
  return limitsByMeaning.find((limits) => limits.name === chosenMeaning);
}

/** An input for a field, by its kind. */
function createFieldInput({ field, name, width }) {
  const hint = [field.meaning, field.unit].filter(Boolean).join(", ") || counted(width, "bit");
  const inputOf = (input, read, write) => ({ name, input, read, write, label: createLabelledInput(name, input, hint) });
  if (field.kind === "flag" || field.kind === "not_flag") {
    const input = element("input", { type: "checkbox" });
    return inputOf(input, () => input.checked, (isActive) => Object.assign(input, { checked: isActive }));
  }
  if (field.kind === "choice") {
    const choices = field.values.map(([number, text]) => createOption(`${big(number)}`, text));
    const input = element("select", {}, createOption("", "choose"), choices);
    const read = () => (input.value ? BigInt(input.value) : "");
    return inputOf(input, read, (_, raw) => Object.assign(input, { value: `${raw}` }));
  }
  const isText = field.kind === "text";
  const input = element("input", { autocomplete: "off", inputmode: isText ? "text" : "numeric" });
  const read = () => (isText ? input.value : parseNumberOrEmpty(input.value));
  return inputOf(input, read, (fieldValue) => Object.assign(input, { value: fieldValue }));
}

/** An input for a number of several fields, which it fills in. */
function createJoinInput({ name, parts }) {
  const input = element("input", { autocomplete: "off", inputmode: "numeric" });
  const names = parts.map((part) => part.item?.name).filter(Boolean).reverse().join(" and ");
  const split = (inputs) => {
    const number = parseNumberOrEmpty(input.value);
    if (number === "") return;
    for (const [partName, partNumber] of splitNumber(parts, number)) {
      inputs.find((partInput) => partInput.name === partName)?.write(partNumber, partNumber);
    }
  };
  const label = createLabelledInput(name, input, said("as_one_number", names));
  return { name: "", join: name, input, label, split, write: (number) => Object.assign(input, { value: number }) };
}

const parseNumberOrEmpty = (text) => {
  const [, sign, digits] = /^\s*(-?)(.*)$/s.exec(text);
  const number = parseNumberOrNull(digits);
  return number === null ? "" : sign ? -number : number;
};

function readInputs(inputs) {
  const values = inputs.filter((input) => input.name).map((input) => [input.name, input.read()]);
  const missing = values.find(([, fieldValue]) => fieldValue === "");
  if (missing) throw new Refusal(`'${missing[0]}' needs a value`);
  return named(Object.fromEntries(values));
}

function fillInputs(inputs, decoded) {
  for (const input of inputs) {
    const field = decoded.fields.find((candidate) => candidate.name === (input.name || input.join));
    if (field) input.write(field.value, field.raw);
  }
}
