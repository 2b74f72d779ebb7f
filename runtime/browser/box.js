// Licence 0BSD: use, modify and distribute this file without any condition.
// The box, its inputs and their effects.

let idCounter = 0;

/** An input with its label and hint. */
function createLabelledInput(text, input, hint = "") {
  idCounter += 1;
  input.id = `${CLASS}-${idCounter}`;
  const help = hint && element("span", { class: `${CLASS}-hint`, id: `${input.id}-hint` }, hint);
  if (hint) input.setAttribute("aria-describedby", help.id);
  return part("p", "item", element("label", { for: input.id }, text), input, help);
}

const createOption = (name, text = "") => element("option", { value: name }, text);

/**
 * A box in an element: ``data-code`` fills in an order code and ``data-frame`` frames. ``data-link`` follows the address
 * of the page. ``data-page`` is the address of a page with such a box, which the box links to.
 * ``data-evidence-above`` says that the page around the box states the evidence. ``data-picture`` is the id of a section
 * whose picture of the frame the box replaces by its own drawing, which a pasted frame fills.
 */
function box(root) {
  const known = new Map(TABLE.families.flatMap((family) => family.codes.map((row) => [row[0], family.mark ?? ""])));
  const codes = element("datalist", { id: `${CLASS}-codes-${idCounter}` }, [...known].map(([name, mark]) => createOption(name, mark)));
  const code = element("input", { list: codes.id, autocomplete: "off", spellcheck: "false" });
  code.value = root.dataset.code ?? "";
  const what = element("select");
  const text = element("textarea", { rows: "3", spellcheck: "false", autocomplete: "off" });
  text.value = root.dataset.frame ?? "";
  const [asks, form, result] = ["asks", "form", "result"].map((name) => part("div", name));
  const link = element("a", {}, root.dataset.page ? "All about this frame, and a link to it" : "Link to this");
  result.setAttribute("role", "status");
  const builder = root.hasAttribute("data-link") ? createLineBuilder(() => code.value, (line) => {
    code.value = line;
    codeChanged();
  }) : null;
  const section = root.dataset.picture ? document.getElementById(root.dataset.picture) : null;
  const picture = section && createFramePicture(section);
  let isSetUp = false;
  const state = { found: null, what: "encoder", answers: named(), held: named(), asked: "", fill: null };

  /** The selected register, if any. */
  const register = () => state.found?.interface.registers?.find(({ name }) => `=${name}` === state.what);

  function codeChanged() {
    builder?.follow();
    const found = findCode(code.value);
    if (found?.code !== state.found?.code) Object.assign(state, { answers: named(), held: named(), asked: "" });
    state.found = found;
    const senders = [...new Set((found?.interface.frames ?? []).map((layout) => layout.sender))];
    const registers = found?.interface.registers ?? [];
    const frames = senders.flatMap((sender) => createFrameChoices(found.interface, sender));
    const registerChoices = registers.map(({ name, title, place }) => createOption(`=${name}`, `${title}, ${place}`));
    const groups = registerChoices.length
      ? [element("optgroup", { label: "the bytes of a register" }, registerChoices)] : [];
    what.replaceChildren(...frames, ...groups);
    const choices = [...frames, ...registerChoices].map((choice) => choice.value);
    if (!choices.includes(state.what)) {
      state.what = choices.find((choice) => choice.startsWith("encoder")) ?? choices[0] ?? "encoder";
    }
    what.value = state.what;
    what.parentElement.hidden = choices.length < 2;
    whatChanged();
  }

  function whatChanged() {
    const { parts, fill } = register() ? createRegisterForm(state, register(), text, show) : { parts: [], fill: null };
    form.replaceChildren(...parts);
    state.fill = fill;
    show();
  }

  function decoded(frameText) {
    const { found, held, answers } = state;
    if (register()) return decodeRegister(found, register(), frameText, held, answers);
    return decodeFrame(found, state.what, frameText, held, answers);
  }

  function row(line) {
    try {
      return { line, found: decoded(line.text) };
    } catch (error) {
      if (!(error instanceof FrameText)) throw error;
      return { line, error: error.message };
    }
  }

  const undecided = (layout) => (layout?.asks ?? []).filter((name) => !(name in state.answers));

  /** Decodes and shows the text; ``isForm`` is true if the text comes from the values of a form. */
  function show(isForm = false) {
    follow();
    text.rows = Math.min(12, Math.max(3, text.value.split("\n").length));
    if (!state.found) {
      asks.replaceChildren();
      result.replaceChildren(...withoutCode());
      return;
    }
    const rows = linesOf(text.value).map(row);
    const layout = rows.find(({ found }) => found?.at)?.found.at.layout ?? register();
    ask(layout);
    const missing = undecided(layout);
    const evidence = root.hasAttribute("data-evidence-above") ? [] : [part("p", "note", state.found.family.evidence)];
    const shown = rows.length > 1 ? many(rows, missing) : rows.flatMap(single);
    const expected = rows.length ? null : expectedFrame();
    result.replaceChildren(...notes(), ...shown, ...(expected ? [emptyFrame(expected)] : []), ...evidence);
    picture?.follow(result, expectedFrame);
    if (rows.length === 1 && rows[0].found && !isForm && !missing.length) state.fill?.(rows[0].found);
  }

  /** The layout to paste, of those that the user can choose: the one with the position. Null if a question is open. */
  function expectedFrame() {
    if (register()) return null;
    const [sender, name] = state.what.split(":");
    const { interface: over } = state.found;
    const layouts = over.frames.filter((layout) => layout.sender === sender && (!name || layout.name === name));
    const decided = layouts.filter((layout) => !undecided(layout).length);
    const frames = decided.map((layout) => placedFor(state.found, layout, state.held, state.answers));
    return frames.find((at) => hasPosition(at, over.measure)) ?? (layouts.length === 1 ? frames[0] : null) ?? null;
  }

  /** All about one frame, or the reason why it is not one. */
  function single({ line, found, error }) {
    if (error) return [part("div", "bad", element("p", {}, sentence(error)))];
    if (undecided(found.at?.layout).length && found.fields.length) {
      return [part("div", "warning", element("p", {}, UNANSWERED_QUESTION))];
    }
    if (found.channels) return wholeResultOf(found, state.found.interface.measure);
    const [sender] = state.what.split(":");
    const others = register() ? [] : otherFrames(state.found, sender, line.text, found, state.held, state.answers);
    return resultOf(found, state.found.interface.measure, others);
  }

  /** The table of many frames, and one of them in full below it. */
  function many(rows, missing) {
    if (missing.length) return [part("div", "warning", element("p", {}, UNANSWERED_QUESTION))];
    const full = part("div", "full");
    const pick = (row) => {
      full.replaceChildren(element("h3", {}, `Line ${row.line.number}`), ...single(row));
      full.scrollIntoView({ block: "nearest" });
    };
    const { measure } = state.found.interface;
    return [...togetherOf(rows), tableOf(rows, measure, pick), ...doubtsOfAll(rows, measure), exportsOf(rows), full];
  }

  /** Puts the inputs into the address of the page, so that a link to it carries them. */
  function follow() {
    link.href = (root.dataset.page ?? "") + buildAddress(code.value, text.value, state);
    link.hidden = !text.value.trim();
    if (!root.hasAttribute("data-link") || !isSetUp) return;
    const isEmpty = !code.value.trim() && !text.value.trim();
    history.replaceState(null, "", isEmpty ? location.pathname + location.search : link.getAttribute("href"));
  }

  function withoutCode() {
    const pick = (picked, sender = state.what) => {
      code.value = picked;
      state.what = sender;
      codeChanged();
      code.focus();
    };
    const help = code.value.trim() ? explainUnknownCode(code.value) : "";
    const nearCodes = help.split(/[\s,;]+/).filter((word) => known.has(word));
    const start = help ? [part("div", "bad", element("p", {}, sentence(help)), codeButtons(nearCodes, pick))] : [];
    const [first] = linesOf(text.value);
    return first ? [...start, ...guessesOf(first.text, pick)] : start;
  }

  /** How the label differs from the codes in the manual, and the origin of the family. */
  function notes() {
    const { family, code: own, tail, isSpecial, unlisted, writtenAsIn } = state.found;
    const asSpec = isLine(own) ? `To write it as a spec: codewheel new my_encoder --line '${own}'` : "";
    const written = writtenAsIn ? `The label is written as in ${writtenAsIn}.` : "";
    const open = unlisted.length ? `Accepted, although not listed in the manual: ${unlisted.join(", ")}.` : "";
    const special = isSpecial ? family.special_codes ?? "A code that ends in /Sxxx may differ from the manual." : "";
    const goesOn = tail ? `The label continues with ${tail}.` : "";
    const all = [asSpec, written, open, goesOn, special, ...(family.about ?? [])];
    return all.filter(Boolean).map((words) => part("p", "note", words));
  }

  /** The questions that a layout leaves to the user, rebuilt only if they changed. */
  function ask(layout) {
    const { family } = state.found;
    const questions = [...layout?.asks ?? [], ...layout?.offers ?? []];
    const open = (family.alternatives ?? []).filter(({ name }) => questions.includes(name));
    const held = (family.held ?? []).filter(({ name }) => layout?.held?.includes(name));
    const asked = JSON.stringify([state.found.code, open, held]);
    if (asked === state.asked) return;
    state.asked = asked;
    const questionsToAsk = open.map((alternative) => createQuestion(state, alternative, show));
    asks.replaceChildren(...questionsToAsk, ...createRegisterInputs(state, held, show));
  }

  function followAddress() {
    const parameters = new URLSearchParams(location.hash.slice(1));
    if (![...parameters.keys()].length) return;
    code.value = parameters.get("code") ?? "";
    text.value = parameters.get("frame") ?? "";
    state.what = parameters.has("as") ? `=${parameters.get("as")}` : parameters.get("from") ?? "encoder";
    codeChanged();
    state.answers = named(Object.fromEntries(parameters.getAll("choose").map((pair) => pair.split("="))));
    state.asked = "";
    show();
  }

  root.replaceChildren(
    createLabelledInput("Order code, as on the label", code, "Leave it empty to list the codes that match the frame. "
      + "Any other encoder: one line, such as biss:position=32,error,warning,crc=6:0x43."), codes,
    createLabelledInput("Type", what), ...(builder ? [builder.root] : []),
    createLabelledInput("Frames, one per line, or the bytes of a register", text,
      "Hex bytes, or one number (0x… or 0b…), in any usual notation. A line can begin with a time. "
      + "Text after # is a comment."),
    asks, form, result, part("p", "link", link));
  code.addEventListener("input", codeChanged);
  what.addEventListener("change", () => {
    state.what = what.value;
    whatChanged();
  });
  text.addEventListener("input", () => show());
  codeChanged();
  if (root.hasAttribute("data-link")) {
    addEventListener("hashchange", followAddress);
    followAddress();
  }
  isSetUp = true;
}

/** Whether a frame has the measured number, whole or as fields. */
const hasPosition = (at, measure) =>
  Boolean(measure) && [...at.fields, ...at.joins].some(({ name }) => name === measure.of || name === measure.part);

/** The picture of a frame on the page, which ``follow`` replaces by the drawing in a result, or an empty one. */
function createFramePicture(section) {
  const printed = section.querySelector("picture");
  if (!printed) return null;
  const drawing = element("div", { class: `${CLASS}-picture` });
  printed.before(drawing);
  return {
    follow(result, expectedFrame) {
      const drawings = result.querySelectorAll(`:scope > .${CLASS}-frame-drawing`);
      const filled = drawings.length === 1 ? drawings[0] : null;
      const expected = drawings.length ? null : expectedFrame();
      drawing.replaceChildren(...(filled ? [filled] : expected ? [emptyFrame(expected)] : []));
      printed.classList.toggle(`${CLASS}-printed`, Boolean(filled || expected));
    },
  };
}

/** Why a text is not an order code, and what would be. */
function explainUnknownCode(label) {
  try {
    readLabel(label);
    return "";
  } catch (error) {
    if (!(error instanceof UnknownCode)) throw error;
    return error.message;
  }
}

const UNANSWERED_QUESTION = "The manual is ambiguous here. Choose above, because there is no default.";

/** The frames of a sender to choose from: one entry, or one for each frame if nothing in a frame identifies it. */
function createFrameChoices(interface_, sender) {
  const layouts = interface_.frames.filter((layout) => layout.sender === sender);
  const isIdentified = interface_.told?.some((dispatch) => dispatch.sender === sender);
  if (layouts.length < 2 || isIdentified) return [createOption(sender, `a frame from the ${sender}`)];
  const hasWhole = interface_.channels && sender === "encoder";
  const whole = hasWhole ? [createOption(sender, `a whole frame, from the ${sender}`)] : [];
  const titles = layouts.map(({ name }) => createOption(`${sender}:${name}`, `${name.replaceAll("_", " ")}, from the ${sender}`));
  return [...whole, ...titles];
}

function buildAddress(code, text, state) {
  const parameters = new URLSearchParams({ code, frame: text.trim() });
  if (state.what.startsWith("=")) parameters.set("as", state.what.slice(1));
  else if (state.what !== "encoder") parameters.set("from", state.what);
  for (const [name, answer] of Object.entries(state.answers)) parameters.append("choose", `${name}=${answer}`);
  return `#${parameters}`;
}

/** A question that the manual leaves open, with its answers. Without a default, none is selected at first. */
function createQuestion(state, alternative, show) {
  const answers = alternative.answers.map(([name, meaning]) => {
    const radio = element("input", { type: "radio", name: `${CLASS}-${idCounter}-${alternative.name}`, value: name });
    radio.checked = (state.answers[alternative.name] ?? alternative.default) === name;
    radio.addEventListener("change", () => {
      state.answers[alternative.name] = name;
      show();
    });
    return element("label", {}, radio, ` ${name}: ${meaning}`);
  });
  idCounter += 1;
  return element("fieldset", {}, element("legend", {}, sentence(alternative.meaning)), answers);
}

/** The register contents that a frame depends on: those of the order code, unless the user enters others. */
function createRegisterInputs(state, held, show) {
  if (!held.length) return [];
  const defaults = computeParameters(state.found);
  const inputs = held.map(({ name, meaning, at, min, max, values }) => {
    const input = element("input", { inputmode: "numeric", autocomplete: "off" });
    input.placeholder = `${defaults[name]}`;
    const isAllowed = (number) => number >= big(min) && (max === undefined || number <= big(max))
      && (!values || values.some((allowed) => big(allowed) === number));
    input.addEventListener("input", () => {
      const number = parseNumberOrNull(input.value);
      const isValid = number !== null && isAllowed(number);
      input.setAttribute("aria-invalid", `${input.value.trim() !== "" && !isValid}`);
      delete state.held[name];
      if (isValid) state.held[name] = number;
      show();
    });
    const range = values?.join(", ") ?? `${min ?? 0} to ${max ?? "the highest value"}`;
    return createLabelledInput(meaning, input, `${at}, ${range}`);
  });
  const summary = element("summary", {}, "Registers have factory defaults. Enter the contents of yours");
  return [element("details", {}, summary, inputs)];
}

const parseNumberOrNull = (text) => (/^\s*(\d+|0x[0-9a-f]+)\s*$/i.test(text) ? BigInt(text.trim()) : null);
