// The search: labels as the command line reads them, names and addresses, and words with their synonyms.
(() => {
  "use strict";

  const INDEX = globalThis.codewheelSearch;
  const wheel = globalThis.codewheelDecode;

  /**
   * Words that people use for the same thing. The first words of a row are those of titles, the third words those of
   * other titles on the page of an order code.
   */
  const CONCEPTS = [
    ["connector wiring", "pinout pin pins wire wires connect connection connections plug socket colour color colours"],
    ["cable", "length distance metre metres meter long", "baud"],
    ["preset zero send", "home homing origin offset zeroing reference datum set"],
    ["baud rate", "baudrate bitrate bps bd mbd mbit kbit"],
    ["clock", "frequency mhz khz"],
    ["times", "time duration fast", "clock baud"],
    ["timeout times", "monoflop"],
    ["crc", "checksum polynomial poly checksums", "frame"],
    ["led leds", "blink blinks blinking flash flashes flashing lamp light lights"],
    ["battery", "batteries dead flat empty depleted"],
    ["save eeprom send", "store storing nonvolatile permanent persist keep"],
    ["alarm alarms error errors warning", "fault failure problem", "frame"],
    ["supply wiring", "voltage power volt volts vdc"],
    ["usable verdict", "trust valid reliable"],
    ["fails errors match", "wrong mismatch bad invalid"],
    ["restore defaults load", "factory default reset"],
    ["reply led", "answer answers respond responds response"],
    ["firmware", "arduino stm32 esp32 microcontroller mcu embedded"],
    ["python bench", "labview matlab pc"],
    ["send request", "poll query ask"],
    ["reset send", "clear restart"],
    ["direction counting", "clockwise counterclockwise cw ccw reverse reversed invert backwards"],
    ["frame frames layout", "telegram packet word message bits long"],
    ["errata", "mistake mistakes misprint erratum edition editions"],
    ["resolution", "counts ppr steps"],
  ];

  /** Words of a question that say nothing about its subject. */
  const FILLERS = new Set(("a an the is are do does did can could should must i my me it its of on in at for with and or how what which "
    + "where when why not no never always there this that many much need get have has says say new max maximum min minimum encoder encoders").split(" "));

  const superscripts = "⁰¹²³⁴⁵⁶⁷⁸⁹";

  /** A text in lower case, with numbers without separators and exponents as ^n. */
  function plain(text) {
    return text.toLowerCase().replaceAll("time-out", "timeout")
      .replace(/[⁰¹²³⁴⁵⁶⁷⁸⁹]+/g, (digits) => `^${[...digits].map((digit) => superscripts.indexOf(digit)).join("")}`)
      .replace(/\b\d{1,3}(?:[,\u00a0\u202f']\d{3})+\b/g, (number) => number.replace(/\D/g, ""))
      .replace(/\b(\d+(?:\.\d+)?)\s*m(?:bits?|bd|baud|bps)\b/g, (_, number) => `${Math.round(number * 1e6)} baud`);
  }

  /** The stem of a word: blinks and blinking are blink. */
  function stem(word) {
    if (!/^[a-z]+$/.test(word) || word.length < 4) return word;
    const cut = word.replace(/(?:ing|ed|es|s)$/, "");
    return (cut.length < 3 || /(?:ss|us)$/.test(word) ? word : cut).replace(/e$/, "");
  }

  /** The words of a text, also the parts of identifiers, and compounds such as read-only as one word. */
  function wordsOf(text) {
    const found = [];
    for (const [word] of plain(text).matchAll(/[\p{L}\p{N}_^µ]+(?:\.\d+)*(?:-[\p{L}\p{N}_]+)*/gu)) {
      const parts = word.split(/[-_]/).filter(Boolean);
      found.push(...parts.map(stem));
      if (parts.length > 1) found.push(word, stem(parts.join("")));
    }
    return found;
  }

  const concepts = CONCEPTS.map(([titles, others, own = ""]) => ({
    titles: new Set(wordsOf(titles)), own: new Set(wordsOf(`${titles} ${own}`)),
    all: new Set(wordsOf(`${titles} ${others}`)),
  }));
  const synonymsOf = (word) => concepts.filter((one) => one.all.has(word));

  const pages = INDEX.pages.map(([path, title, kind, family, over, isLower]) => ({ path, title, kind, family, over, isLower }));
  const counted = new Map();

  /** How often each word is in a text. */
  function countsOf(place) {
    if (!counted.has(place)) {
      const counts = new Map();
      for (const word of wordsOf(INDEX.texts[place])) counts.set(word, (counts.get(word) ?? 0) + 1);
      counted.set(place, counts);
    }
    return counted.get(place);
  }

  const sections = INDEX.sections.map(([page, anchor, title, text, isInSight]) => ({
    page: pages[page], anchor, title, text, isInSight: isInSight === 1, isExample: isInSight === 2,
    titleWords: new Set(wordsOf(title)),
  }));

  // --------------------------------------------------------------------------------------------- questions

  /** Words one of which is in a query: exact words by their stems, and beginnings, which end with an asterisk. */
  function alternativesIn(text) {
    const words = plain(text).split(/\s+/).filter(Boolean);
    const beginnings = words.filter((word) => word.endsWith("*")).map((word) => word.slice(0, -1));
    const stems = new Set(words.filter((word) => !word.endsWith("*")).map(stem));
    return (word) => stems.has(word) || beginnings.some((one) => word.startsWith(one));
  }

  /** What people type to find a page: one word of each part between slashes. */
  const asked = pages.flatMap((page) => (INDEX.asked[page.path] ?? []).map((text) => (
    { page, parts: text.split("/").map(alternativesIn) })));

  /** The pages that answer a query without a label, best first: those that account for most of its words. */
  function answersTo(typed) {
    const words = [...new Set(wordsOf(typed))];
    const accounted = new Map();
    for (const { page, parts } of asked) {
      const matching = words.filter((word) => parts.some((isOne) => isOne(word)));
      // One word may be in several parts, but counts for one.
      if (matching.length < parts.length || !parts.every((isOne) => words.some(isOne))) continue;
      const { covered, most } = accounted.get(page) ?? { covered: new Set(), most: 0 };
      matching.forEach((word) => covered.add(word));
      accounted.set(page, { covered, most: Math.max(most, parts.length) });
    }
    const score = ({ covered, most }) => covered.size + most / 2;
    return [...accounted].sort(([, one], [, other]) => score(other) - score(one)).map(([page]) => page);
  }

  // ------------------------------------------------------------------------------------------------ labels

  /** The order code that a text is a label of, in any spelling, or null. */
  function codeOf(text) {
    for (const spelled of [text, text.replace("-", "/"), text.replace("/", "-")]) {
      const found = wheel?.findCode(spelled);
      if (found) return found;
    }
    return null;
  }

  const families = () => (wheel?.table.families ?? []).filter((one) => !one.base);

  /** Whether a text begins like an order code. */
  function isLikeCode(text) {
    const start = /^[A-Z]{2,}\d{2}|^[A-Z]{3,}\d/.exec(text.toUpperCase())?.[0];
    return Boolean(start) && Object.keys(INDEX.codes).some((code) => code.startsWith(start));
  }

  const squeezed = (text) => text.toUpperCase().replace(/[^A-Z0-9]/g, "");

  /** A serial number after an order code on the label, with everything that follows it. */
  const SERIAL_NUMBER = /\s(?:S\/N|SN|No\.?|Nr\.?)[\s:#]*(?:\S*\d.*)?$/i;
  /** Phrases that mean a task by their first word. */
  const TASK = /\b(zero|home|reference) (?:position|point)\b/gi;

  /** What was typed, in the words that are searched for. */
  function searched(text) {
    const label = text.replace(SERIAL_NUMBER, "");
    return (read(label).label ? label : text).replace(TASK, "$1");
  }

  /** What was typed: a label or its beginning, a family, and the other words. */
  function read(text) {
    const pieces = text.trim().split(/\s+/).filter(Boolean);
    const asked = { label: null, wrong: "", family: "", manufacturer: "", words: pieces, text: text.trim() };
    for (let size = Math.min(4, pieces.length); size > 0; size -= 1) {
      for (let at = 0; at + size <= pieces.length; at += 1) {
        const tried = pieces.slice(at, at + size);
        const label = codeOf(tried.join("")) ?? (codeOf(tried[0]) ? null : codeOf(tried.join("/")));
        if (label) return { ...asked, label, words: [...pieces.slice(0, at), ...pieces.slice(at + size)] };
      }
    }
    // A name is also typed as it is printed: AksIM-2 is the family aksim2.
    const family = pieces.find((piece) => families().some((one) => one.name === nameOf(piece)));
    const others = pieces.filter((piece) => piece !== family);
    const wrong = family ? undefined : others.find(isLikeCode);
    const manufacturer = others.find((piece) => Object.hasOwn(INDEX.manufacturers, nameOf(piece))) ?? "";
    const subject = others.filter((one) => one !== wrong && one !== manufacturer);
    const words = subject.length || family ? subject : others;
    return { ...asked, family: family ? nameOf(family) : "", wrong: wrong ?? "", words, manufacturer: nameOf(manufacturer) };
  }

  const nameOf = (text) => text.toLowerCase().replace(/[^a-z0-9]/g, "");
  const interfaces = new Map(families().flatMap((one) => one.interfaces)
    .flatMap((one) => [[one.name, one.title], [nameOf(one.title), one.title]]));

  /** The words without the names of interfaces, which the label has decided, and the titles of other interfaces. */
  function withoutInterfaces({ label, words }) {
    const named = label ? words.filter((word) => interfaces.has(nameOf(word))) : [];
    const others = named.map((word) => interfaces.get(nameOf(word))).filter((title) => title !== label.interface.title);
    const rest = words.filter((word) => !named.includes(word));
    return { words: rest.length ? rest : words, others: [...new Set(others)] };
  }

  /** The page of a listed code, or of the listed code with the same numbers as an unlisted code. */
  function pageOf(label) {
    const code = label.code in INDEX.codes ? label.code : label.family.codes.find((row) => {
      const over = label.family.interfaces[row[1]];
      return over === label.interface && row[0] in INDEX.codes;
    })?.[0];
    return code === undefined ? null : pages[INDEX.codes[code]];
  }

  /** Why a text is not an order code: for the beginning of a code, the wrong part. */
  function helpFor(text) {
    const whole = messageFor(text);
    for (const code of Object.keys(INDEX.codes)) {
      const common = [...text.toUpperCase()].findIndex((one, place) => one !== code[place]);
      if (common < 4 || text.includes("/")) continue;
      const part = / has \S+ '.*?'; valid values: [^.]*/.exec(messageFor(text + code.slice(text.length)));
      if (part) return `'${text}'${part[0]}`;
    }
    return whole;
  }

  function messageFor(text) {
    try {
      wheel.readLabel(text);
      return "";
    } catch (error) {
      if (!(error instanceof wheel.UnknownCode)) throw error;
      return error.message;
    }
  }

  // ------------------------------------------------------------------------------------------------- words

  let spelled = null;

  /** The letters of a word that differ from another: the number of letters to change, add, leave out or exchange. */
  function distance(one, other) {
    const rows = [[...Array(other.length + 1).keys()]];
    for (let at = 1; at <= one.length; at += 1) {
      rows.push([at]);
      for (let to = 1; to <= other.length; to += 1) {
        const isSame = one[at - 1] === other[to - 1];
        const isExchanged = at > 1 && to > 1 && one[at - 1] === other[to - 2] && one[at - 2] === other[to - 1];
        rows[at].push(Math.min(rows[at - 1][to] + 1, rows[at][to - 1] + 1, rows[at - 1][to - 1] + (isSame ? 0 : 1),
          isExchanged ? rows[at - 2][to - 2] + 1 : Infinity));
      }
    }
    return rows[one.length][other.length];
  }

  /** A word as it is, or the nearest word of titles and synonyms if no page has a word that begins like it. */
  function corrected(word) {
    const typed = plain(word);
    if (!/^[a-z]{5,}$/.test(typed)) return word;
    const known = (one) => one.startsWith(stem(typed));
    if (concepts.some(({ all }) => [...all].some(known))) return word;
    if (INDEX.texts.some((_, place) => [...countsOf(place).keys()].some(known))) return word;
    spelled ??= new Set([...CONCEPTS.flat(), ...sections.map((one) => one.title)]
      .flatMap((text) => plain(text).match(/[a-z]{4,}/g) ?? []));
    const near = [...spelled].map((one) => [distance(typed, one), one]).sort((one, other) => one[0] - other[0]);
    return near.length && near[0][0] <= (typed.length < 8 ? 1 : 2) ? near[0][1] : word;
  }

  const hasOne = (words, others) => [...others].some((one) => words.has(one));

  /** How well a section answers the words; 0 if it lacks one of them, unless some are enough. */
  function scoreOf(section, words, someAreEnough, isOwn) {
    const counts = countsOf(section.text);
    let sum = 0;
    let isTitle = words.length > 1;
    // The title of a question has the words of the people who ask it.
    const titleWords = section.page.kind === "question" ? "all" : isOwn ? "own" : "titles";
    for (const { word, synonyms } of words) {
      const score = Math.max(
        section.titleWords.has(word) ? 14 : 0,
        synonyms.some((concept) => hasOne(section.titleWords, concept[titleWords])) ? 9 : 0,
        counts.has(word) ? 3 + Math.min(2, Math.log2(counts.get(word))) : 0,
        synonyms.some(({ all }) => hasOne(counts, all)) ? 2 : 0,
        word.length > 2 && [...section.titleWords].some((title) => title.startsWith(word)) ? 5 : 0,
        (word.length > 3 || /^\d/.test(word)) && [...counts.keys()].some((one) => one.startsWith(word)) ? 1 : 0,
      );
      if (!score && !someAreEnough) return 0;
      sum += score;
      isTitle &&= score >= 9;
    }
    // A short title is about little else.
    return sum && (isTitle ? 1.3 : 1) * sum + 3 / section.titleWords.size;
  }

  /** Whether the words are from the name of a master, of which a section lists the settings. */
  const isNamedMaster = (section, words) => section.page.kind === "masters" && !interfaces.has(nameOf(section.title))
    && words.every(({ word }) => section.titleWords.has(word));

  const WEIGHTS = {
    question: 0.9, code: 1, interface: 1, family: 0.95, general: 0.8, verdicts: 0.65, masters: 0.4, aside: 0.35, project: 0.2,
  };

  /** The sections that answer the words, best first; pages of other order codes are left out. */
  function found(words, page, typed, ofManufacturer) {
    if (!words.length) return [];
    const searched = sections.filter((one) => (one.page.kind !== "code" || one.page === page)
      && (!ofManufacturer || ofManufacturer.includes(one.page.family)));
    const phrase = typed.includes(" ") ? plain(typed) : "";
    const bonus = (section) => {
      if (!phrase) return 1;
      if (plain(section.title).startsWith(phrase)) return 2;
      return plain(`${section.title} ${INDEX.texts[section.text]}`).includes(phrase) ? 1.3 : 1;
    };
    const rank = (someAreEnough) => searched
      .map((section) => {
        // The upper part of the page of an order code answers most questions at once.
        const isUpper = section.isInSight && section.page === page;
        const weight = section.isExample ? WEIGHTS.aside : isNamedMaster(section, words) ? 1 : WEIGHTS[section.page.kind];
        // Families of lower grades come after families from manuals, unless their names are among the words.
        const score = scoreOf(section, words, someAreEnough, isUpper) * weight * (section.page.isLower ? 0.4 : 1);
        return { section, score: isUpper ? 2 * score : score };
      })
      .map((one) => (one.score ? { ...one, score: one.score * bonus(one.section) } : one))
      .filter((one) => one.score > 0).sort((one, other) => other.score - one.score);
    const all = rank(false);
    const isAside = ({ section }) => ["masters", "project"].includes(section.page.kind) && !isNamedMaster(section, words);
    if (all.every(isAside)) return rank(true);
    const isOwn = (one) => one.section.page === page;
    return page && !all.some(isOwn) ? [...rank(true).filter(isOwn), ...all] : all;
  }

  /** Names and addresses that are what was typed, or begin with it. */
  function namesFor(text, context) {
    const typed = plain(text).replace(/\./g, " ").trim();
    if (typed.length < 2) return [];
    const ranked = INDEX.things.flatMap(([name, what, page, anchor, family, priority]) => {
      const own = plain(name);
      const rank = own === typed ? 0 : typed.length > 2 && own.startsWith(`${typed} `) ? 2 : -1;
      const away = context.family && family !== context.family ? 10 : 0;
      const aside = context.over && pages[page].over && pages[page].over !== context.over ? 1 : 0;
      // The words for a name in a manual are looked for in the sections of families of lower grades.
      const isOther = pages[page].isLower && family !== context.family;
      return rank < 0 || isOther ? [] : [{ name, what, page: pages[page], anchor, family, rank: away + aside + rank + priority }];
    }).sort((one, other) => one.rank - other.rank);
    const seen = new Set();
    return ranked.filter((one) => {
      const key = `${one.page.path}#${one.anchor}`;
      return !seen.has(key) && seen.add(key);
    });
  }

  // --------------------------------------------------------------------------------------------- the page

  function element(tag, attributes, ...children) {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    made.append(...children.flat().filter((child) => child !== ""));
    return made;
  }

  const link = (page, anchor, text) => element("a", { href: `${page.path}.html${anchor ? `#${anchor}` : ""}` }, text);

  /** A part of a text around the first of the words, with the words marked. */
  function snippet(place, words) {
    const text = INDEX.texts[place];
    const stems = new Set(words.flatMap((one) => [one.word, ...one.synonyms.flatMap(({ all }) => [...all])]));
    const isHit = (word) => wordsOf(word).some((one) => stems.has(one));
    const hits = [...text.matchAll(/[\p{L}\p{N}_^.,-]+/gu)].filter(([word]) => isHit(word));
    const exact = hits.find((hit) => wordsOf(hit[0]).some((one) => words.some(({ word }) => word === one)));
    const at = Math.max(0, ((exact ?? hits[0])?.index ?? 0) - 60);
    const from = at && text.indexOf(" ", at) + 1;
    const to = Math.min(text.length, from + 200);
    const made = element("p", { class: "snippet" }, from ? "… " : "");
    let last = from;
    for (const hit of hits.filter((one) => one.index >= from && one.index + one[0].length <= to)) {
      made.append(text.slice(last, hit.index), element("mark", {}, hit[0]));
      last = hit.index + hit[0].length;
    }
    made.append(text.slice(last, to), to < text.length ? " …" : "");
    return made;
  }

  const hit = (page, anchor, title, from, below = "") => element("li", {},
    link(page, anchor, title), from ? element("span", { class: "from" }, from) : "", below);

  const sectionHit = ({ section }, words) => hit(section.page, section.anchor, section.title,
    section.title === section.page.title ? "" : section.page.title, snippet(section.text, words));

  /** A page as a whole, with a part of its text. */
  function answerHit(page, words) {
    const first = sections.find((one) => one.page === page);
    return hit(page, "", page.title, "", first ? snippet(first.text, words) : "");
  }

  const group = (title, items) => (items.length ? [element("h2", {}, title), element("ol", {}, items)] : []);

  /** The hits of a label alone: its page, and the sections there. */
  function labelHits(label, page) {
    const spelled = label.code === page.title ? page.title : label.code;
    const notes = [label.writtenAsIn && `The label is written as in ${label.writtenAsIn}.`,
      label.unlisted.length && `Accepted, although not listed in the manual: ${label.unlisted.join(", ")}.`,
      label.tail && `The label continues with ${label.tail}.`,
      label.isSpecial && (label.family.special_codes ?? "A code that ends in /Sxxx may differ from the manual.")];
    const text = notes.filter(Boolean).join(" ");
    const own = sections.filter((one) => one.page === page && one.anchor && one.isInSight);
    const jumps = element("p", { class: "snippet" }, own.slice(0, 12).flatMap((one, place) => [
      place ? " · " : "", link(page, one.anchor, one.title)]));
    const title = `${label.family.title}, ${label.interface.title}`;
    return [hit(page, "", spelled, title, text ? element("p", { class: "snippet" }, text) : ""), element("li", {}, jumps)];
  }

  /** The settings of the masters that the words name, for a label with BiSS or SSI: the page that shows them. */
  function settingsHits(label, words) {
    const listed = `generated/docs/${label.family.name}-${label.interface.name}-masters`;
    // Names of masters also have common words, such as control.
    const isCommon = (word) => sections.some((one) => one.page.kind !== "masters" && one.titleWords.has(word));
    const names = words.map(({ word }) => word).filter((word) => !isCommon(word));
    const isNamed = ({ page, titleWords }) => page.path === listed && names.some((word) => titleWords.has(word));
    const page = { path: "settings" };
    return sections.filter(isNamed).flatMap((section) => {
      const name = /--master (\w+)/.exec(INDEX.texts[section.text])?.[1];
      const anchor = new URLSearchParams({ code: label.code, master: name ?? "" });
      return name && INDEX.codes[label.code] !== undefined ? [hit(page, anchor, section.title, label.code)] : [];
    });
  }

  /** The codes that begin like a wrong code, or else the codes in its help. */
  function codesLike(text, help) {
    const start = squeezed(text);
    const codes = Object.keys(INDEX.codes);
    const beginning = codes.filter((code) => squeezed(code).startsWith(start));
    const named = new Set(help.split(/[\s,]+/));
    return beginning.length ? beginning : codes.filter((code) => named.has(code));
  }

  /** The order code, interface and family that the search is about. */
  function contextOf(asked, from) {
    const page = asked.label ? pageOf(asked.label) : pages.find((one) => one.path === from) ?? null;
    const family = asked.label?.family.name ?? (asked.family || page?.family) ?? "";
    const own = page && (!family || page.family === family) ? page : null;
    return { page: own?.kind === "code" ? own : null, family, over: asked.label?.interface.name ?? own?.over ?? "" };
  }

  function results(text, from) {
    const asked = read(searched(text));
    const context = contextOf(asked, from);
    const { words: plainWords, others } = withoutInterfaces(asked);
    const subject = plainWords.filter((word) => !FILLERS.has(word.toLowerCase()));
    const fixed = (subject.length ? subject : plainWords).map(corrected);
    const typed = fixed.join(" ");
    const words = [...new Set(wordsOf(typed))].map((word) => ({ word, synonyms: synonymsOf(word) }));
    const made = [];
    if (asked.wrong) {
      const help = helpFor(asked.wrong);
      const like = codesLike(asked.wrong, messageFor(asked.wrong));
      const isBeginning = like.length && squeezed(like[0]).startsWith(squeezed(asked.wrong));
      if (!isBeginning) made.push(element("p", { class: "help", role: "note" }, `${help}.`));
      made.push(...group("Order codes", like.slice(0, 12).map((code) => hit(pages[INDEX.codes[code]], "", code, ""))));
    }
    if (fixed.some((word) => !plainWords.includes(word))) {
      made.push(element("p", { class: "help", role: "note" }, "Showing results for ", element("b", {}, typed), "."));
    }
    for (const title of others) {
      const text = `${asked.label.code} has ${asked.label.interface.title}, not ${title}.`;
      made.push(element("p", { class: "help", role: "note" }, text));
    }
    const whole = plainWords.map(corrected).join(" ");
    const names = whole ? namesFor(whole, context) : [];
    const nameHits = names.slice(0, 6).map((one) => hit(one.page, one.anchor, one.name,
      `${one.family.toUpperCase()} ${one.what}`));
    const ofManufacturer = asked.label || asked.family ? undefined : INDEX.manufacturers[asked.manufacturer];
    const answers = answersTo(whole);
    // A page that lists what people type to find it comes last if they typed something else.
    const isAskedOtherwise = ({ section }) => section.page.path in INDEX.asked;
    const unanswered = found(words, context.page, whole, ofManufacturer).filter(({ section }) => !answers.includes(section.page));
    const hits = [...unanswered.filter((one) => !isAskedOtherwise(one)), ...unanswered.filter(isAskedOtherwise)];
    const questions = group("Questions and guides", answers.slice(0, 5).map((page) => answerHit(page, words)));
    if (!context.family) made.push(...questions);
    if (asked.label) made.push(...group("Settings for my master", settingsHits(asked.label, words)));
    // The page of a label comes first, even if it says nothing about the other words.
    if (asked.label && context.page && !hits.some((one) => one.section.page === context.page)) {
      made.push(...group(context.page.title, labelHits(asked.label, context.page)));
    }
    const isOf = {
      code: ({ page }) => page === context.page,
      over: ({ page }) => page.family === context.family && page.over === context.over && page.over !== "",
      family: ({ page }) => page.family === context.family && page.family !== "",
      encoders: ({ page }) => page.family !== "" && page.kind !== "project",
    };
    const taken = new Set();
    const take = (test, count) => hits.filter((one) => !taken.has(one) && test(one.section)).slice(0, count).map((one) => {
      taken.add(one);
      return sectionHit(one, words);
    });
    const title = families().find((one) => one.name === context.family)?.title ?? "";
    if (context.page) made.push(...group(context.page.title, take(isOf.code, 8)));
    // A plain word such as zero means the task rather than a field with this name.
    const isPlain = words.some((one) => one.synonyms.length) && /^(?:field|part) of/.test(names[0]?.what ?? "");
    const isOwn = names.length > 0 && !isPlain && (!context.family || names[0].family === context.family);
    if (isOwn) made.push(...group("Names and addresses", nameHits));
    if (asked.family && !words.length) {
      const page = pages.find((one) => one.path === `generated/docs/${asked.family}`);
      if (page) made.push(...group(page.title, [hit(page, "", page.title, "")]));
    }
    if (context.family) made.push(...questions);
    if (context.over) made.push(...group(`${title}, this interface`, take(isOf.over, 6)));
    if (context.family) made.push(...group(title, take(isOf.family, 6)));
    if (!isOwn && context.family) made.push(...group("Names and addresses", nameHits));
    const best = (test) => hits.find((one) => !taken.has(one) && test(one.section))?.score ?? 0;
    const isGeneral = (section) => !isOf.encoders(section);
    const rest = [[context.family ? "Other encoders" : "Encoders", isOf.encoders, best(isOf.encoders)],
      ["General", isGeneral, best(isGeneral)]];
    if (!context.family && rest[1][2] > (words.length > 1 ? 1.25 : 1.5) * rest[0][2]) rest.reverse();
    for (const [name, test] of rest) made.push(...group(name, take(test, 10)));
    if (!isOwn && !context.family) made.push(...group("Names and addresses", nameHits));
    const isAboutNone = words.length && made.length && !context.page && !asked.wrong;
    const hint = "Type the label as well, and the first hit is about your encoder: ";
    if (isAboutNone) made.unshift(element("p", { class: "quiet" }, hint, element("code", {}, `AMM5A21/65KSC1 ${typed}`)));
    return made;
  }

  function show() {
    const given = new URLSearchParams(location.search);
    const text = given.get("q") ?? "";
    const box = document.getElementById("search-results");
    const input = document.querySelector("header input[type=search]");
    input.value = text;
    if (!text.trim()) {
      input.focus();
      return;
    }
    const made = results(text, given.get("on") ?? "");
    const nothing = element("p", {}, "Nothing found. Try another word, or start from the ",
      link({ path: "generated/docs/README" }, "", "list of order codes"), ".");
    box.replaceChildren(...(made.length ? made : [nothing]));
    document.title = `${text} · Search · codewheel`;
  }

  show();
})();
