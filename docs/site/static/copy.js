// Buttons that copy the order code, the parameters of the CRC and the bytes to send. Without this script, the text remains.
(function () {
  "use strict";
  /** Bytes in hexadecimal, also with a prefix for a polynomial. */
  const BYTES = /^(?:0x)?[\da-f]{2,}(?: [\da-f]{2})*$/i;

  /** Copies text in pages that were opened as files too, where the clipboard may be missing. */
  async function copy(text) {
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      const area = document.createElement("textarea");
      area.value = text;
      document.body.append(area);
      area.select();
      document.execCommand("copy");
      area.remove();
    }
  }

  /** A button without text of its own, so the text of the page stays as it is. */
  function button(name, textOf) {
    const made = document.createElement("button");
    made.type = "button";
    made.className = "copy";
    made.title = name;
    made.setAttribute("aria-label", name);
    made.addEventListener("click", async () => {
      await copy(textOf());
      made.classList.add("done");
      made.setAttribute("aria-label", `${name}: copied`);
      setTimeout(() => {
        made.classList.remove("done");
        made.setAttribute("aria-label", name);
      }, 1500);
    });
    return made;
  }

  const textOf = (item) => item.textContent.replace(/\s+/g, " ").trim();

  /** Adds a button to bytes, in the same line as they are, and as the comma after them. */
  function addButton(code) {
    const copied = document.createElement("span");
    copied.className = "copied";
    code.replaceWith(copied);
    copied.append(code, button("Copy the bytes", () => textOf(code)));
    const after = copied.nextSibling;
    if (after?.nodeType === Node.TEXT_NODE && /^[,.;]/.test(after.data)) {
      copied.append(after.data[0]);
      after.data = after.data.slice(1);
    }
  }

  function start() {
    const title = document.querySelector("section:has(> #what-to-send) > h1");
    if (!title) return;
    const orderCode = textOf(title);
    title.append(button("Copy the order code", () => orderCode));
    const crc = [...document.querySelectorAll("#frame li")].find((item) => textOf(item).startsWith("CRC: poly"));
    if (crc) {
      const parameters = textOf(crc).replace(/^CRC: /, "");
      (crc.querySelector("p") ?? crc).append(button("Copy the parameters of the CRC", () => parameters));
    }
    for (const code of document.querySelectorAll("#what-to-send td code")) {
      if (BYTES.test(textOf(code))) addButton(code);
    }
  }

  if (document.readyState === "loading") addEventListener("DOMContentLoaded", start);
  else start();
})();
