// License 0BSD: use, modify and distribute this file without any condition.
// The box, its inputs and their effects.

/** Counts the ids of inputs, lists and questions, so that each is unique on the page. */
let idCounter = 0;

/** Return an input in a paragraph with its label and hint. */
function createLabelledInput(text, input, hint = "") {
  idCounter += 1;
  input.id = `${CLASS}-${idCounter}`;
  const hintElement = hint && createElement("span", { class: `${CLASS}-hint`, id: `${input.id}-hint` }, hint);
  if (hint) input.setAttribute("aria-describedby", hintElement.id);
  return createPart("p", "item", createElement("label", { for: input.id }, text), input, hintElement);
}

/** Create an option of a selection or list, with its value and text. */
const createOption = (name, text = "") => createElement("option", { value: name }, text);

/**
 * Fill an element with a box: ``data-code`` fills in an order code and ``data-frame`` frames. ``data-link`` follows the
 * address of the page. ``data-page`` is the address of a page with such a box, which the box links to.
 * ``data-evidence-above`` says that the page around the box states the evidence. ``data-picture`` is the id of a
 * section whose picture of the frame the box replaces by its own drawing, which a pasted frame fills.
 */
function box(root) {
  const marksByCode = new Map(TABLE.families.flatMap(
    (family) => family.codes.map((row) => [row[0], family.mark ?? ""])));
  const codeList = createElement("datalist", { id: `${CLASS}-codes-${idCounter}` },
    [...marksByCode].map(([name, mark]) => createOption(name, mark)));
  const codeInput = createElement("input", { list: codeList.id, autocomplete: "off", spellcheck: "false" });
  codeInput.value = root.dataset.code ?? "";
  const typeSelect = createElement("select");
  const frameInput = createElement("textarea", { rows: "3", spellcheck: "false", autocomplete: "off" });
  frameInput.value = root.dataset.frame ?? "";
  const [questionArea, formArea, resultArea] = ["asks", "form", "result"].map((name) => createPart("div", name));
  const linkText = root.dataset.page ? "All about this frame, and a link to it" : "Link to this";
  const frameLink = createElement("a", {}, linkText);
  resultArea.setAttribute("role", "status");
  const builder = root.hasAttribute("data-link") ? createLineBuilder(() => codeInput.value, (line) => {
    codeInput.value = line;
    updateFromCode();
  }) : null;
  const pictureSection = root.dataset.picture ? document.getElementById(root.dataset.picture) : null;
  const picture = pictureSection && createFramePicture(pictureSection);
  let isSetUp = false;
  const state = {
    orderCode: null, frameType: "encoder", answers: mergeByName(), registerContents: mergeByName(), questionsKey: "",
    fillForm: null };

  /** Return the selected register, if any. */
  const selectedRegister = () => (
    state.orderCode?.interface.registers?.find(({ name }) => `=${name}` === state.frameType));

  /** Read the order code, offer its frames and registers to choose from, and update the rest of the box. */
  function updateFromCode() {
    builder?.follow();
    const orderCode = findCode(codeInput.value);
    if (orderCode?.code !== state.orderCode?.code) {
      Object.assign(state, { answers: mergeByName(), registerContents: mergeByName(), questionsKey: "" });
    }
    // Frames of two families can have the same name.
    const isOtherFamily = orderCode && state.orderCode && orderCode.family.name !== state.orderCode.family.name;
    if (isOtherFamily) state.frameType = "encoder";
    state.orderCode = orderCode;
    const senders = [...new Set((orderCode?.interface.frames ?? []).map((layout) => layout.sender))];
    const registers = orderCode?.interface.registers ?? [];
    const frameChoices = senders.flatMap((sender) => createFrameChoices(orderCode.interface, sender));
    const registerChoices = registers.map(({ name, title, place }) => createOption(`=${name}`, `${title}, ${place}`));
    const registerGroups = registerChoices.length
      ? [createElement("optgroup", { label: "the bytes of a register" }, registerChoices)] : [];
    typeSelect.replaceChildren(...frameChoices, ...registerGroups);
    const choiceValues = [...frameChoices, ...registerChoices].map((choice) => choice.value);
    if (!choiceValues.includes(state.frameType)) {
      state.frameType = choiceValues.find((choice) => choice.startsWith("encoder")) ?? choiceValues[0] ?? "encoder";
    }
    typeSelect.value = state.frameType;
    typeSelect.parentElement.hidden = choiceValues.length < 2;
    updateFromType();
  }

  /** Build the form of the selected register, if any, and show the result. */
  function updateFromType() {
    const { parts, fill } = selectedRegister()
      ? createRegisterForm(state, selectedRegister(), frameInput, showResult) : { parts: [], fill: null };
    formArea.replaceChildren(...parts);
    state.fillForm = fill;
    showResult();
  }

  /** Decode a text as the selected register or frame. */
  function decodeText(frameText) {
    const { orderCode, registerContents, answers } = state;
    if (selectedRegister()) return decodeRegister(orderCode, selectedRegister(), frameText, registerContents, answers);
    return decodeFrame(orderCode, state.frameType, frameText, registerContents, answers);
  }

  /** Return the lines of the input, or the words of a line if each of them is a frame. */
  function listFrames() {
    const lines = linesOf(frameInput.value);
    if (selectedRegister()) return lines;
    const [sender] = state.frameType.split(":");
    return splitIntoWords(lines, state.orderCode, sender, state.registerContents, state.answers);
  }

  /** Return {line, decoded} with the decoded frame of a line, or {line, error} if the line is not a frame. */
  function decodeLine(line) {
    try {
      const decoded = decodeText(line.text);
      const isOfOtherKind = decoded.problems.length > 0 && isAnotherFrame(decoded, findOtherLayouts(decoded, line));
      return { line, decoded: { ...decoded, isOfOtherKind } };
    } catch (error) {
      if (!(error instanceof FrameText)) throw error;
      return { line, error: error.message, spellings: error.spellings };
    }
  }

  /** Return the names of the questions about a layout that the user has yet to answer. */
  const unansweredQuestions = (layout) => (layout?.asks ?? []).filter((name) => !(name in state.answers));

  /** Decode and show the text. ``isForm`` is true if the text comes from the values of a form. */
  function showResult(isForm = false) {
    updateAddress();
    frameInput.rows = Math.min(12, Math.max(3, frameInput.value.split("\n").length));
    if (!state.orderCode) {
      questionArea.replaceChildren();
      resultArea.replaceChildren(...helpToFindCode());
      return;
    }
    const rows = listFrames().map(decodeLine);
    const layout = rows.find(({ decoded }) => decoded?.placedLayout)?.decoded.placedLayout.layout ?? selectedRegister();
    askQuestions(layout);
    const openQuestions = unansweredQuestions(layout);
    const evidence = root.hasAttribute("data-evidence-above") ? []
      : [createPart("p", "note", state.orderCode.family.evidence)];
    const resultParts = rows.length > 1 ? resultOfLines(rows, openQuestions) : rows.flatMap(resultOfLine);
    const expectedLayout = rows.length ? null : findExpectedLayout();
    resultArea.replaceChildren(
      ...listNotes(), ...resultParts, ...(expectedLayout ? [drawEmptyFrame(expectedLayout)] : []), ...evidence);
    picture?.follow(resultArea, findExpectedLayout);
    if (rows.length === 1 && rows[0].decoded && !isForm && !openQuestions.length) state.fillForm?.(rows[0].decoded);
  }

  /** Return the layout to paste: the one with the position, among the choices. Null if a question is open. */
  function findExpectedLayout() {
    if (selectedRegister()) return null;
    const { interface: interface_ } = state.orderCode;
    const layouts = layoutsOf(interface_, state.frameType);
    const decidedLayouts = layouts.filter((layout) => !unansweredQuestions(layout).length);
    const placedLayouts = decidedLayouts.map(
      (layout) => placedFor(state.orderCode, layout, state.registerContents, state.answers));
    return placedLayouts.find((placedLayout) => hasPosition(placedLayout, interface_.measure))
      ?? (layouts.length === 1 ? placedLayouts[0] : null) ?? null;
  }

  /** All about one frame, or the reason why the text is not a frame. */
  function resultOfLine({ line, decoded, error, spellings = [] }) {
    if (error) {
      const buttons = createCodeButtons(spellings, (spelling) => rewriteLine(line, spelling));
      return [createPart("div", "bad", createSentence(error)), buttons];
    }
    const layout = decoded.placedLayout?.layout;
    // Even the length of a word can depend on the answers.
    const dependsOnAnswers = decoded.fields.length > 0 || !layout?.order;
    if (dependsOnAnswers && unansweredQuestions(layout).length) {
      return [createPart("div", "warning", createElement("p", {}, UNANSWERED_QUESTION))];
    }
    if (decoded.channels) return createWholeResult(decoded, state.orderCode.interface.measure);
    return createResult(decoded, state.orderCode.interface.measure, findOtherLayouts(decoded, line));
  }

  /** Return the layouts of the other frames that a line can be. */
  function findOtherLayouts(decoded, line) {
    const { orderCode, frameType, registerContents, answers } = state;
    const [sender] = frameType.split(":");
    return selectedRegister() ? [] : otherFrames(orderCode, sender, line.text, decoded, registerContents, answers);
  }

  /** Replace the text of a frame in its line by another spelling, and show the result. */
  function rewriteLine({ lineIndex, text, offset }, spelling) {
    const inputLines = frameInput.value.split(/\r\n|\r|\n/);
    const line = inputLines[lineIndex];
    inputLines[lineIndex] = line.slice(0, offset) + spelling + line.slice(offset + text.length);
    frameInput.value = inputLines.join("\n");
    showResult();
  }

  /** Return the table of many frames, and one of them in full below it. */
  function resultOfLines(rows, openQuestions) {
    if (openQuestions.length) return [createPart("div", "warning", createElement("p", {}, UNANSWERED_QUESTION))];
    const fullResult = createPart("div", "full");
    const showInFull = (row) => {
      fullResult.replaceChildren(createElement("h3", {}, `Line ${row.line.number}`), ...resultOfLine(row));
      fullResult.scrollIntoView({ block: "nearest" });
    };
    const { measure } = state.orderCode.interface;
    return [
      ...createCommonEchoNote(rows), ...listCommonMistakes(rows), createLineTable(rows, measure, showInFull),
      ...listCommonDoubts(rows, measure),
      createExportButtons(rows), fullResult,
    ];
  }

  /** Store the inputs in the URL of the page, so that a link to the page contains them. */
  function updateAddress() {
    frameLink.href = (root.dataset.page ?? "") + buildAddress(codeInput.value, frameInput.value, state);
    frameLink.hidden = !frameInput.value.trim();
    if (!root.hasAttribute("data-link") || !isSetUp) return;
    const isEmpty = !codeInput.value.trim() && !frameInput.value.trim();
    try {
      history.replaceState(null, "", isEmpty ? location.pathname + location.search : frameLink.getAttribute("href"));
    } catch (error) {
      // Browsers reject many changes in a short time, for example during typing. The link still has the inputs.
      if (error.name !== "SecurityError") throw error;
    }
  }

  /** Return the elements that help to find the order code: near codes, and the codes that match the first frame. */
  function helpToFindCode() {
    const pickCode = (pickedCode, sender = state.frameType) => {
      codeInput.value = pickedCode;
      state.frameType = sender;
      updateFromCode();
      codeInput.focus();
    };
    const helpText = codeInput.value.trim() ? explainUnknownCode(codeInput.value) : "";
    const nearCodes = helpText.split(/[\s,;]+/).filter((word) => marksByCode.has(word));
    const helpLine = createElement("p", {}, helpText && toSentence(helpText));
    const helpParts = helpText ? [createPart("div", "bad", helpLine, createCodeButtons(nearCodes, pickCode))] : [];
    const [firstLine] = linesOf(frameInput.value);
    // A line that describes the frame has been typed instead of an order code.
    const isGuessed = firstLine && !isLine(codeInput.value);
    return isGuessed ? [...helpParts, ...createGuesses(firstLine.text, pickCode, nearCodes)] : helpParts;
  }

  /** Return the notes on how the label differs from the codes in the manual, and on the origin of the family. */
  function listNotes() {
    const { family, code: codeText, tail, isSpecial, unlisted, writtenAsIn } = state.orderCode;
    const specNote = isLine(codeText) ? `To write it as a spec: codewheel new my_encoder --line '${codeText}'` : "";
    const spellingNote = writtenAsIn ? `The label is written as in ${writtenAsIn}.` : "";
    const unlistedNote = unlisted.length ? `Accepted, although not listed in the manual: ${unlisted.join(", ")}.` : "";
    const specialNote = isSpecial
      ? family.special_codes ?? "A code that ends in /Sxxx may differ from the manual." : "";
    const tailNote = tail ? `The label continues with ${tail}.` : "";
    const allNotes = [specNote, spellingNote, unlistedNote, tailNote, specialNote, ...(family.about ?? [])];
    return allNotes.filter(Boolean).map((noteText) => createPart("p", "note", noteText));
  }

  /** Show the questions that a layout leaves to the user. The inputs are built again after a change. */
  function askQuestions(layout) {
    const { family } = state.orderCode;
    const questions = [...layout?.asks ?? [], ...layout?.offers ?? []];
    const openAlternatives = (family.alternatives ?? []).filter(({ name }) => questions.includes(name));
    const heldParameters = (family.held ?? []).filter(({ name }) => layout?.held?.includes(name));
    const questionsKey = JSON.stringify([state.orderCode.code, openAlternatives, heldParameters]);
    if (questionsKey === state.questionsKey) return;
    state.questionsKey = questionsKey;
    const questionInputs = openAlternatives.map((alternative) => createQuestion(state, alternative, showResult));
    questionArea.replaceChildren(...questionInputs, ...createRegisterInputs(state, heldParameters, showResult));
  }

  /** Fill the inputs from the address of the page, and show the result. */
  function followAddress() {
    const parameters = new URLSearchParams(location.hash.slice(1));
    if (![...parameters.keys()].length) return;
    codeInput.value = parameters.get("code") ?? "";
    frameInput.value = parameters.get("frame") ?? "";
    state.orderCode = null;
    state.frameType = parameters.has("as") ? `=${parameters.get("as")}` : parameters.get("from") ?? "encoder";
    updateFromCode();
    state.answers = answersInAddress(parameters, state.orderCode?.family);
    state.questionsKey = "";
    showResult();
  }

  root.replaceChildren(
    createLabelledInput("Order code, as on the label", codeInput,
      "Leave it empty to list the codes that match the frame. "
      + "Any other encoder: one line, such as biss:position=32,error,warning,crc=6:0x43."), codeList,
    createLabelledInput("Type", typeSelect), ...(builder ? [builder.root] : []),
    createLabelledInput("Frames, one per line, or the bytes of a register", frameInput,
      "Hex bytes, or one number (0x… or 0b…), in any usual notation. A line can begin with a time. "
      + "Text after # is a comment."),
    questionArea, formArea, resultArea, createPart("p", "link", frameLink));
  codeInput.addEventListener("input", updateFromCode);
  typeSelect.addEventListener("change", () => {
    state.frameType = typeSelect.value;
    updateFromType();
  });
  frameInput.addEventListener("input", () => showResult());
  updateFromCode();
  if (root.hasAttribute("data-link")) {
    addEventListener("hashchange", followAddress);
    followAddress();
  }
  isSetUp = true;
}

/** Return whether a frame has the measured number, whole or as fields. */
const hasPosition = (placedLayout, measure) =>
  Boolean(measure)
  && [...placedLayout.fields, ...placedLayout.joins].some(({ name }) => name === measure.of || name === measure.part);

/**
 * Prepare the picture of a frame on the page. Return {follow}, which replaces it by the drawing in a result, or by an
 * empty drawing, or return null if the section has no picture.
 */
function createFramePicture(section) {
  const printedPicture = section.querySelector("picture");
  if (!printedPicture) return null;
  const drawingArea = createElement("div", { class: `${CLASS}-picture` });
  printedPicture.before(drawingArea);
  return {
    follow(resultArea, findExpectedLayout) {
      const expectedLayout = findExpectedLayout();
      const drawings = resultArea.querySelectorAll(`:scope > .${CLASS}-frame-drawing`);
      // The printed picture of a frame of bytes is smaller than its fields in a row.
      const isDrawn = Boolean(expectedLayout) && !expectedLayout.layout.order && drawings.length < 2;
      drawingArea.replaceChildren(...(isDrawn ? [drawings[0] ?? drawEmptyFrame(expectedLayout)] : []));
      printedPicture.classList.toggle(`${CLASS}-printed`, isDrawn);
    },
  };
}

/** Return the message that helps with a wrong order code, or an empty string if the order code is right. */
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

/**
 * Create the frames of a sender to choose from: one option, or one for each frame if the frames lack a selector. If
 * their length or all channels together identify a frame, an option for all frames comes first.
 */
function createFrameChoices(interface_, sender) {
  const layouts = layoutsOf(interface_, sender);
  const isIdentified = layouts.length < 2 || findSelector(interface_, sender);
  if (isIdentified) return [createOption(sender, `a frame from the ${sender}`)];
  const hasWholeFrame = interface_.channels && sender === "encoder";
  const haveLengths = interface_.exact?.includes(sender) && !layouts[0].order;
  const choiceForAll = createOption(
    sender, `${hasWholeFrame ? "a whole frame" : "a frame of any length"}, from the ${sender}`);
  const layoutChoices = layouts.map(
    ({ name }) => createOption(`${sender}:${name}`, `${name.replaceAll("_", " ")}, from the ${sender}`));
  return hasWholeFrame || haveLengths ? [choiceForAll, ...layoutChoices] : layoutChoices;
}

/** Return the part of an address after #, with the inputs of the box. */
function buildAddress(code, frameText, state) {
  const parameters = new URLSearchParams({ code, frame: frameText.trim() });
  if (state.frameType.startsWith("=")) parameters.set("as", state.frameType.slice(1));
  else if (state.frameType !== "encoder") parameters.set("from", state.frameType);
  for (const [name, answer] of Object.entries(state.answers)) parameters.append("choose", `${name}=${answer}`);
  return `#${parameters}`;
}

/** Return the answers in an address that a family has. An old or damaged link may have others. */
function answersInAddress(parameters, family) {
  const isAnswer = ([name, answer]) => (family?.alternatives ?? []).some(
    (alternative) => alternative.name === name && alternative.answers.some(([listedAnswer]) => listedAnswer === answer));
  return mergeByName(Object.fromEntries(parameters.getAll("choose").map((pair) => pair.split("=")).filter(isAnswer)));
}

/** Create a question that the manual leaves open, with its answers. Without a default, it starts unanswered. */
function createQuestion(state, alternative, showResult) {
  const answerLabels = alternative.answers.map(([name, meaning]) => {
    const groupName = `${CLASS}-${idCounter}-${alternative.name}`;
    const radio = createElement("input", { type: "radio", name: groupName, value: name });
    radio.checked = (state.answers[alternative.name] ?? alternative.default) === name;
    radio.addEventListener("change", () => {
      state.answers[alternative.name] = name;
      showResult();
    });
    return createElement("label", {}, radio, ` ${name}: ${toSentence(meaning)}`);
  });
  idCounter += 1;
  return createElement("fieldset", {}, createElement("legend", {}, toSentence(alternative.meaning)), answerLabels);
}

/** Create inputs for the register contents that a frame depends on. By default, the order code's values apply. */
function createRegisterInputs(state, heldParameters, showResult) {
  if (!heldParameters.length) return [];
  const defaults = computeParameters(state.orderCode);
  const inputs = heldParameters.map(({ name, meaning, at: registerName, min, max, values }) => {
    const input = createElement("input", { inputmode: "numeric", autocomplete: "off" });
    input.placeholder = `${defaults[name]}`;
    const isAllowed = (number) => number >= toBigInt(min) && (max === undefined || number <= toBigInt(max))
      && (!values || values.some((allowedNumber) => toBigInt(allowedNumber) === number));
    input.addEventListener("input", () => {
      const number = parseNumberOrNull(input.value);
      const isValid = number !== null && isAllowed(number);
      input.setAttribute("aria-invalid", `${input.value.trim() !== "" && !isValid}`);
      delete state.registerContents[name];
      if (isValid) state.registerContents[name] = number;
      showResult();
    });
    const range = values?.join(", ") ?? `${min ?? 0} to ${max ?? "the highest value"}`;
    return createLabelledInput(meaning, input, `${registerName}, ${range}`);
  });
  const summary = createElement("summary", {}, "Registers have factory defaults. Enter the contents of yours");
  return [createElement("details", {}, summary, inputs)];
}

/** Return the decimal or hexadecimal number that a text is, otherwise null. */
const parseNumberOrNull = (text) => (/^\s*(\d+|0x[0-9a-f]+)\s*$/i.test(text) ? BigInt(text.trim()) : null);
