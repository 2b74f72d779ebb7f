// License 0BSD: use, modify and distribute this file without any condition.
// Form for the values of a register, from and to bytes.

/**
 * Create the description of a register, and for a writable register a form that encodes its bytes into ``frameInput``.
 * Return {parts, fill}: the elements, and the function that fills the inputs from a decoded register.
 */
function createRegisterForm(state, register, frameInput, showResult) {
  const placedRegister = () => placedFor(state.orderCode, register, state.registerContents, state.answers);
  const allLimits = register.limits ?? [];
  const bounds = allLimits.map((limits) => describeLimits(placedRegister(), limits)).filter(Boolean);
  const notes = createPart("p", "note", [...(register.about ?? []), ...bounds.map(toSentence)].join(" "));
  if (!register.writable) {
    return { parts: [notes, createPart("p", "note", "Read-only. Paste its bytes to decode them.")], fill: null };
  }
  const refusal = createPart("p", "wrong");
  refusal.setAttribute("role", "alert");
  const inputs = [
    ...placedRegister().joins.filter((join) => join.parts.length > 1).map((join) => createJoinInput(join)),
    ...placedRegister().fields.filter(isEnteredByUser).map((placedField) => createFieldInput(placedField)),
  ];
  const limitsByMeaning = allLimits.filter((limits) => limits.name);
  const meanings = limitsByMeaning.map(({ name, meaning }) => createOption(name, `${name}: ${meaning ?? ""}`));
  const chosenMeaning = createElement("select", {}, createOption("", "choose"), meanings);

  /** Encode the values of the inputs and show the bytes, or show why they are rejected. */
  function encodeInputs() {
    refusal.textContent = "";
    try {
      frameInput.value = bytesFor(
        placedRegister(), readInputs(inputs), chooseLimits(register, limitsByMeaning, chosenMeaning.value));
      showResult(true);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      refusal.textContent = toSentence(error.message);
    }
  }

  const form = createElement("fieldset", {}, createElement("legend", {}, "Change values to encode bytes"),
    limitsByMeaning.length ? createLabelledInput("Meaning", chosenMeaning) : "",
    inputs.map(({ label }) => label), refusal);
  form.addEventListener("input", (event) => {
    inputs.find((labelledInput) => labelledInput.input === event.target)?.split?.(inputs);
    encodeInputs();
  });
  if (register.default) form.append(createDefaultButton(register, frameInput, showResult));
  return { parts: [form, notes], fill: (decoded) => fillInputs(inputs, decoded) };
}

/** Create the button that enters the default bytes of a register. */
function createDefaultButton(register, frameInput, showResult) {
  return createButton(`Default: ${register.default}`, () => {
    frameInput.value = register.default;
    showResult();
  });
}

/** Return the limits of a register in numbers, or an empty string if it has neither. */
function describeLimits(placedRegister, { name, of, low, high }) {
  if (low === null && high === null) return "";
  const bounds = [["at least", low], ["at most", high]].filter(([, bound]) => bound !== null)
    .map(([comparison, bound]) => `${comparison} ${evaluateExpression(bound, placedRegister.parameters)}`);
  return `Limits of ${name ?? of ?? placedRegister.name}: ${bounds.join(", ")}`;
}

/** Return the applicable limits: the limits of the chosen meaning, if a register has several. */
function chooseLimits(register, limitsByMeaning, chosenMeaning) {
  if (limitsByMeaning.length && !chosenMeaning) throw new Refusal("Choose the meaning of the register first");
  if (!limitsByMeaning.length) return (register.limits ?? [])[0];
  return limitsByMeaning.find((limits) => limits.name === chosenMeaning);
}

/** Create an input for a field, by its kind: {name, input, label, read, write}. */
function createFieldInput({ field, name, width }) {
  const hint = [field.meaning, field.unit].filter(Boolean).join(", ") || countWithNoun(width, "bit");
  const inputOf = (input, read, write) => ({ name, input, read, write, label: createLabelledInput(name, input, hint) });
  if (isFlag(field)) {
    const input = createElement("input", { type: "checkbox" });
    return inputOf(input, () => input.checked, (isActive) => Object.assign(input, { checked: isActive }));
  }
  if (field.kind === "choice") {
    const choices = field.values.map(([number, text]) => createOption(`${toBigInt(number)}`, text));
    const input = createElement("select", {}, createOption("", "choose"), choices);
    const read = () => (input.value ? BigInt(input.value) : "");
    return inputOf(input, read, (_, raw) => Object.assign(input, { value: `${raw}` }));
  }
  const isText = field.kind === "text";
  const input = createElement("input", { autocomplete: "off", inputmode: isText ? "text" : "numeric" });
  const read = () => (isText ? input.value : parseNumberOrEmpty(input.value));
  return inputOf(input, read, (fieldValue) => Object.assign(input, { value: fieldValue }));
}

/** Create an input for a number of several fields, which it fills in. */
function createJoinInput({ name, parts }) {
  const input = createElement("input", { autocomplete: "off", inputmode: "numeric" });
  const names = parts.map((part) => part.placedField?.name).filter(Boolean).reverse().join(" and ");
  const split = (inputs) => {
    const number = parseNumberOrEmpty(input.value);
    if (number === "") return;
    for (const [partName, partNumber] of splitNumber(parts, number)) {
      inputs.find((partInput) => partInput.name === partName)?.write(partNumber, partNumber);
    }
  };
  const label = createLabelledInput(name, input, messageFor("as_one_number", names));
  return { name: "", join: name, input, label, split, write: (number) => Object.assign(input, { value: number }) };
}

/** Return the number of a text, which may be negative, or an empty string. */
const parseNumberOrEmpty = (text) => {
  const [, sign, digits] = /^\s*(-?)(.*)$/s.exec(text);
  const number = parseNumberOrNull(digits);
  return number === null ? "" : sign ? -number : number;
};

/** Return the values of the inputs by name of the field. Throws ``Refusal`` if a field is empty. */
function readInputs(inputs) {
  const values = inputs.filter((input) => input.name).map((input) => [input.name, input.read()]);
  const emptyInput = values.find(([, fieldValue]) => fieldValue === "");
  if (emptyInput) throw new Refusal(`'${emptyInput[0]}' needs a value`);
  return mergeByName(Object.fromEntries(values));
}

/** Write the values of a decoded register into the inputs. */
function fillInputs(inputs, decoded) {
  for (const input of inputs) {
    const field = decoded.fields.find((candidate) => candidate.name === (input.name || input.join));
    if (field) input.write(field.value, field.raw);
  }
}
