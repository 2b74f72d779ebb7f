// Licence 0BSD: use, modify and distribute this file without any condition.
// The box, its inputs and their effects.

let boxes = 0;

/** An input with its label and hint. */
function labelled(text, input, hint = "") {
  boxes += 1;
  input.id = `${CLASS}-${boxes}`;
  const help = hint && element("span", { class: `${CLASS}-hint`, id: `${input.id}-hint` }, hint);
  if (hint) input.setAttribute("aria-describedby", help.id);
  return part("p", "item", element("label", { for: input.id }, text), input, help);
}

const option = (name, text = "") => element("option", { value: name }, text);

/**
 * A box in an element: ``data-code`` fills in an order code and ``data-frame`` frames. ``data-link`` follows the address
 * of the page. ``data-page`` is the address of a page with such a box, which the box links to.
 * ``data-evidence-above`` says that the page around the box states the evidence.
 */
function box(root) {
  const known = new Map(TABLE.families.flatMap((family) => family.codes.map((row) => [row[0], family.mark ?? ""])));
  const codes = element("datalist", { id: `${CLASS}-codes-${boxes}` }, [...known].map(([name, mark]) => option(name, mark)));
  const code = element("input", { list: codes.id, autocomplete: "off", spellcheck: "false" });
  code.value = root.dataset.code ?? "";
  const what = element("select");
  const text = element("textarea", { rows: "3", spellcheck: "false", autocomplete: "off" });
  text.value = root.dataset.frame ?? "";
  const [asks, form, result] = ["asks", "form", "result"].map((name) => part("div", name));
  const link = element("a", {}, root.dataset.page ? "All about this frame, and a link to it" : "Link to this");
  result.setAttribute("role", "status");
  const builder = root.hasAttribute("data-link") ? lineBuilder(() => code.value, (line) => {
    code.value = line;
    codeChanged();
  }) : null;
  let isSetUp = false;
  const state = { found: null, what: "encoder", answers: named(), held: named(), asked: "", fill: null };

  /** The selected register, if any. */
  const register = () => state.found?.interface.registers?.find((item) => `=${item.name}` === state.what);

  function codeChanged() {
    builder?.follow();
    const found = findCode(code.value);
    if (found?.code !== state.found?.code) Object.assign(state, { answers: named(), held: named(), asked: "" });
    state.found = found;
    const senders = [...new Set((found?.interface.frames ?? []).map((item) => item.sender))];
    const registers = found?.interface.registers ?? [];
    const frames = senders.flatMap((item) => framesOf(found.interface, item));
    const others = registers.map((item) => option(`=${item.name}`, `${item.title}, ${item.place}`));
    const group = others.length ? [element("optgroup", { label: "the bytes of a register" }, others)] : [];
    what.replaceChildren(...frames, ...group);
    const choices = [...frames, ...others].map((item) => item.value);
    if (!choices.includes(state.what)) state.what = choices.find((one) => one.startsWith("encoder")) ?? choices[0] ?? "encoder";
    what.value = state.what;
    what.parentElement.hidden = choices.length < 2;
    whatChanged();
  }

  function whatChanged() {
    const made = register() ? registerForm(state, register(), text, show) : { parts: [], fill: null };
    form.replaceChildren(...made.parts);
    state.fill = made.fill;
    show();
  }

  function decoded(one) {
    const { found, held, answers } = state;
    if (register()) return decodeRegister(found, register(), one, held, answers);
    return decodeFrame(found, state.what, one, held, answers);
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
    const layout = rows.find((one) => one.found?.at)?.found.at.layout ?? register();
    ask(layout);
    const missing = undecided(layout);
    const evidence = root.hasAttribute("data-evidence-above") ? [] : [part("p", "note", state.found.family.evidence)];
    result.replaceChildren(...notes(), ...(rows.length > 1 ? many(rows, missing) : rows.flatMap(single)), ...evidence);
    if (rows.length === 1 && rows[0].found && !isForm && !missing.length) state.fill?.(rows[0].found);
  }

  /** All about one frame, or the reason why it is not one. */
  function single({ line, found, error }) {
    if (error) return [part("div", "bad", element("p", {}, sentence(error)))];
    if (undecided(found.at?.layout).length && found.fields.length) {
      return [part("div", "warning", element("p", {}, UNDECIDED))];
    }
    const [sender] = state.what.split(":");
    const others = register() ? [] : otherFrames(state.found, sender, line.text, found, state.held, state.answers);
    return resultOf(found, state.found.interface.measure, others);
  }

  /** The table of many frames, and one of them in full below it. */
  function many(rows, missing) {
    if (missing.length) return [part("div", "warning", element("p", {}, UNDECIDED))];
    const full = part("div", "full");
    const pick = (one) => {
      full.replaceChildren(element("h3", {}, `Line ${one.line.number}`), ...single(one));
      full.scrollIntoView({ block: "nearest" });
    };
    const { measure } = state.found.interface;
    return [...togetherOf(rows), tableOf(rows, measure, pick), ...doubtsOfAll(rows, measure), exportsOf(rows), full];
  }

  /** Puts the inputs into the address of the page, so that a link to it carries them. */
  function follow() {
    link.href = (root.dataset.page ?? "") + linkTo(code.value, text.value, state);
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
    const help = code.value.trim() ? helpFor(code.value) : "";
    const near = help.split(/[\s,;]+/).filter((one) => known.has(one));
    const start = help ? [part("div", "bad", element("p", {}, sentence(help)), codeButtons(near, pick))] : [];
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
    const open = (family.alternatives ?? []).filter((item) => [...layout?.asks ?? [], ...layout?.offers ?? []]
      .includes(item.name));
    const held = (family.held ?? []).filter((item) => layout?.held?.includes(item.name));
    const asked = JSON.stringify([state.found.code, open, held]);
    if (asked === state.asked) return;
    state.asked = asked;
    asks.replaceChildren(...open.map((item) => question(state, item, show)), ...heldBy(state, held, show));
  }

  function followAddress() {
    const given = new URLSearchParams(location.hash.slice(1));
    if (![...given.keys()].length) return;
    code.value = given.get("code") ?? "";
    text.value = given.get("frame") ?? "";
    state.what = given.has("as") ? `=${given.get("as")}` : given.get("from") ?? "encoder";
    codeChanged();
    state.answers = named(Object.fromEntries(given.getAll("choose").map((pair) => pair.split("="))));
    state.asked = "";
    show();
  }

  root.replaceChildren(
    labelled("Order code, as on the label", code, "Leave it empty to list the codes that match the frame. "
      + "Any other encoder: one line, such as biss:position=32,error,warning,crc=6:0x43."), codes,
    labelled("Type", what), ...(builder ? [builder.root] : []),
    labelled("Frames, one per line, or the bytes of a register", text,
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

/** Why a text is not an order code, and what would be. */
function helpFor(label) {
  try {
    readLabel(label);
    return "";
  } catch (error) {
    if (!(error instanceof UnknownCode)) throw error;
    return error.message;
  }
}

const UNDECIDED = "The manual is ambiguous here. Choose above, because there is no default.";

/** The frames of a sender to choose from: one entry, or one for each frame if nothing in a frame identifies it. */
function framesOf(interface_, sender) {
  const found = interface_.frames.filter((item) => item.sender === sender);
  const isTold = interface_.told?.some((item) => item.sender === sender);
  if (found.length < 2 || isTold) return [option(sender, `a frame from the ${sender}`)];
  return found.map(({ name }) => option(`${sender}:${name}`, `${name.replaceAll("_", " ")}, from the ${sender}`));
}

function linkTo(code, text, state) {
  const given = new URLSearchParams({ code, frame: text.trim() });
  if (state.what.startsWith("=")) given.set("as", state.what.slice(1));
  else if (state.what !== "encoder") given.set("from", state.what);
  for (const [name, answer] of Object.entries(state.answers)) given.append("choose", `${name}=${answer}`);
  return `#${given}`;
}

/** A question that the manual leaves open, with its answers. Without a default, none is selected at first. */
function question(state, item, show) {
  const answers = item.answers.map(([name, meaning]) => {
    const radio = element("input", { type: "radio", name: `${CLASS}-${boxes}-${item.name}`, value: name });
    radio.checked = (state.answers[item.name] ?? item.default) === name;
    radio.addEventListener("change", () => {
      state.answers[item.name] = name;
      show();
    });
    return element("label", {}, radio, ` ${name}: ${meaning}`);
  });
  boxes += 1;
  return element("fieldset", {}, element("legend", {}, sentence(item.meaning)), answers);
}

/** The register contents that a frame depends on: those of the order code, unless the user enters others. */
function heldBy(state, held, show) {
  if (!held.length) return [];
  const delivered = parametersOf(state.found);
  const inputs = held.map((item) => {
    const input = element("input", { inputmode: "numeric", autocomplete: "off" });
    input.placeholder = `${delivered[item.name]}`;
    input.addEventListener("input", () => {
      const given = numberOrNull(input.value);
      const isInside = given !== null && given >= big(item.min) && (item.max === undefined || given <= big(item.max))
        && (!item.values || item.values.some((value) => big(value) === given));
      input.setAttribute("aria-invalid", `${input.value.trim() !== "" && !isInside}`);
      delete state.held[item.name];
      if (isInside) state.held[item.name] = given;
      show();
    });
    const range = item.values?.join(", ") ?? `${item.min ?? 0} to ${item.max ?? "the highest value"}`;
    return labelled(item.meaning, input, `${item.at}, ${range}`);
  });
  const summary = element("summary", {}, "Registers have factory defaults. Enter the contents of yours");
  return [element("details", {}, summary, inputs)];
}

const numberOrNull = (text) => (/^\s*(\d+|0x[0-9a-f]+)\s*$/i.test(text) ? BigInt(text.trim()) : null);
