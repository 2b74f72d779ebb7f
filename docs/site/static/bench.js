// The page of an order code: a slider for the cable length, a box for the value of the preset, the folds in the sidebar,
// and links to the page that encodes registers. Without this script, the tables and the bytes for the position 0 remain.
(function () {
  "use strict";
  /** Offered lengths in metres. */
  const LENGTHS = [1, 2, 3, 5, 8, 10, 15, 20, 25, 30, 40, 50, 60, 80, 100, 150, 200, 300, 400, 500, 700, 1000];
  const USUAL = 30;

  function element(tag, attributes, ...children) {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    made.append(...children);
    return made;
  }

  /** A label, its input, and the output that follows it. */
  function setting(title, input, output) {
    output.htmlFor = input.id;
    return element("p", { class: "setting" }, element("label", { for: input.id }, title), input, output);
  }

  // ------------------------------------------------------------------------------------------------ cable

  const textOf = (cell) => cell.textContent.trim();

  /** The rows of the table of cable lengths: greatest length in metres, and the texts of clock and frame. */
  const rowsOf = (table) => [...table.tBodies[0].rows].map((row) => {
    const [metres, clock, frame] = [...row.cells].map(textOf);
    return { row, clock, frame, metres: Number.parseInt(metres, 10) };
  });

  function cable(table) {
    const rows = rowsOf(table);
    // SSI has lengths and clocks that must stay below the table's.
    const isBelow = textOf(table.tHead.rows[0].cells[0]).endsWith("below");
    const holds = (one, metres) => metres < one.metres || (metres === one.metres && !isBelow);
    const lengths = LENGTHS.filter((metres) => rows.some((one) => holds(one, metres)));
    const input = element("input", { type: "range", id: "cable-length", min: 0, max: lengths.length - 1, step: 1 });
    const output = element("output", {});
    function follow() {
      const metres = lengths[Number(input.value)];
      // The rows begin with the shortest cable, which has the fastest clock.
      const chosen = rows.find((one) => holds(one, metres));
      rows.forEach((one) => one.row.classList.toggle("chosen", one === chosen));
      const [clock, frame] = isBelow ? ["below", "frame longer than"] : ["up to", "frame"];
      output.replaceChildren(element("b", {}, `${metres} m: ${clock} ${chosen.clock}`), `, ${frame} ${chosen.frame}`);
      input.setAttribute("aria-valuetext", output.textContent);
    }
    input.value = Math.max(0, lengths.indexOf(USUAL));
    input.addEventListener("input", follow);
    const box = table.closest(".table-wrapper") ?? table;
    box.before(setting("Cable length", input, output));
    follow();
  }

  // ----------------------------------------------------------------------------------------------- preset

  const spaced = (place) => place.replace(/\s+/g, " ").trim();

  /** The elements in the table of commands with the bytes that are written to some addresses. */
  function bytesAt(place) {
    const codes = [...document.querySelectorAll("#what-to-send td code")];
    return codes.filter((code) => spaced(code.previousSibling?.textContent ?? "").endsWith(`${place}:`));
  }

  function preset(anchor, wheel, found) {
    const paragraph = anchor.closest("p");
    const link = paragraph.querySelector('a[href^="#register-"]');
    const register = found.interface.registers?.find((one) => `#register-${one.name}` === link?.getAttribute("href"));
    if (!register) return;
    const codes = bytesAt(spaced(link.textContent));
    const [at, limits] = [wheel.placedFor(found, register, {}, {}), register.limits?.[0]];
    const highest = wheel.highestNumber(at, limits);
    const about = document.getElementById("preset-of-rows");
    const input = element("input", {
      type: "text", id: "preset-number", inputmode: "numeric", autocomplete: "off", spellcheck: "false", value: "0",
    });
    const output = element("output", {});
    /** The bytes of a number, or the reason why it is not a preset. */
    function bytesOrHelp(typed) {
      if (!/^(?:\d{1,20}|0x[\da-f]{1,16})$/i.test(typed)) return { help: "Type a whole number, such as 1000 or 0x3E8." };
      if (BigInt(typed) > highest) return { help: `The highest preset is ${highest}.` };
      try {
        return { bytes: wheel.bytesOfNumber(at, BigInt(typed), limits) };
      } catch (error) {
        if (!(error instanceof wheel.Refusal)) throw error;
        return { help: `${error.message}.` };
      }
    }
    function follow() {
      const typed = input.value.replace(/[\s,_']/g, "");
      const { bytes, help } = bytesOrHelp(typed);
      input.setAttribute("aria-invalid", `${!bytes}`);
      output.className = bytes ? "" : "wrong";
      output.replaceChildren(...(bytes ? [element("code", { class: "literal" }, bytes)] : [help]));
      // Bytes of an earlier number would be copied by mistake.
      for (const code of codes) {
        code.textContent = bytes ?? "…";
        code.classList.toggle("chosen", Boolean(bytes));
      }
      about.textContent = bytes ? `The preset is ${BigInt(typed).toLocaleString("en")} in these rows.`
        : "The rows have no bytes, because the preset is not valid.";
    }
    input.addEventListener("input", follow);
    const before = document.querySelector("#what-to-send .table-wrapper");
    before.before(setting("Preset", input, output));
    follow();
  }

  // ------------------------------------------------------------------------------------- folds and registers

  /** Lists the folds below the details in the sidebar. */
  function listFolds() {
    const entry = document.querySelector('.sections a[href="#details"]');
    const items = [...document.querySelectorAll("#details > details > summary")].map((summary) => {
      summary.id = `fold-${summary.parentElement.querySelector("a[id]").id}`;
      const title = (summary.querySelector("b") ?? summary).textContent;
      return element("li", {}, element("a", { class: "reference internal", href: `#${summary.id}` }, title));
    });
    entry?.after(element("ul", {}, ...items));
  }

  /** Links each register to the page that encodes and decodes its bytes. */
  function linkRegisters(code) {
    const page = document.querySelector("header .to-decode")?.getAttribute("href");
    for (const anchor of page ? document.querySelectorAll('#details h3 > a[id^="register-"]') : []) {
      const given = new URLSearchParams({ code, as: anchor.id.replace("register-", "") });
      anchor.parentElement.append(" ", element("small", {},
        element("a", { href: `${page}#${given}` }, "encode or decode its bytes")));
    }
  }

  function start() {
    const table = document.querySelector("#clock-and-cable table");
    if (table) cable(table);
    const anchor = document.getElementById("preset-value");
    const wheel = globalThis.codewheelDecode;
    const code = document.querySelector("[data-code]")?.dataset.code ?? "";
    const found = wheel?.findCode(code);
    if (anchor && found) preset(anchor, wheel, found);
    listFolds();
    linkRegisters(code);
  }

  if (document.readyState === "loading") addEventListener("DOMContentLoaded", start);
  else start();
})();
