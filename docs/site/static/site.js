// Opens the search with /, the folds that a link leads into, and closes the drawer of a phone after a choice.
(function () {
  "use strict";
  const all = (selector) => document.querySelectorAll(selector);

  /** Makes only boxes that scroll reachable by the keyboard. */
  function mark() {
    all(".table-wrapper, pre").forEach(function (item) {
      if (item.scrollWidth > item.clientWidth) {
        item.tabIndex = 0;
        item.setAttribute("role", "group");
        item.setAttribute("aria-label", item.tagName === "PRE" ? "Code" : "Table");
      } else {
        item.removeAttribute("tabindex");
        item.removeAttribute("role");
        item.removeAttribute("aria-label");
      }
    });
  }

  /** The element that the address names, or null. A damaged address names none. */
  function addressed() {
    try {
      return document.getElementById(decodeURIComponent(location.hash.slice(1)));
    } catch (error) {
      if (!(error instanceof URIError)) throw error;
      return null;
    }
  }

  /** Opens the folds around the target of the address. */
  function open() {
    const target = addressed();
    if (!target) return;
    const folded = [];
    if (target.matches("details")) folded.push(target);
    for (let at = target.closest("details"); at; at = at.parentElement.closest("details")) folded.push(at);
    if (!folded.some((item) => !item.open)) return;
    folded.forEach((item) => { item.open = true; });
    target.scrollIntoView();
  }

  /** A text without its case, hyphens and spaces, so that "ichaus" finds iC-Haus. */
  const plain = (text) => text.toLowerCase().replace(/[-\s]+/g, "");

  /** Shows the cards of the encoders that have all typed words, and the chosen manufacturer and interface. */
  function filterCards() {
    const form = document.querySelector(".filters");
    if (!form) return;
    const cards = [...all(".gallery > .card")].map((card) => ({
      card, text: plain(`${card.textContent} ${card.dataset.words}`), ...card.dataset }));
    const { words, manufacturer, interface: interfaces } = form.elements;
    const count = form.querySelector("output");
    const none = form.querySelector(".none");
    function follow() {
      const typed = words.value.split(/\s+/).map(plain).filter(Boolean);
      const shown = cards.filter((one) => typed.every((word) => one.text.includes(word))
        && (!manufacturer.value || one.manufacturer === manufacturer.value)
        && (!interfaces.value || one.interface.split("|").includes(interfaces.value)));
      cards.forEach((one) => { one.card.hidden = !shown.includes(one); });
      count.textContent = shown.length === 1 ? "1 family" : `${shown.length} families`;
      none.hidden = shown.length > 0;
    }
    form.hidden = false;
    form.addEventListener("input", () => {
      follow();
      // With fewer cards the page may be too short to stay where it was.
      form.scrollIntoView({ block: "nearest" });
    });
    none.querySelector("button").addEventListener("click", () => {
      form.reset();
      follow();
      words.focus();
    });
    form.addEventListener("submit", (event) => event.preventDefault());
    follow();
  }

  function setUp() {
    filterCards();
    const drawer = document.getElementById("__navigation");
    const sections = document.querySelector(".sections");
    if (sections && sections.querySelectorAll("li").length > 24) sections.classList.add("long");
    all(".sidebar-drawer a").forEach((link) => link.addEventListener("click", () => { drawer.checked = false; }));
    document.querySelector("header .menu").addEventListener("keydown", (event) => {
      if (event.key === "Enter" || event.key === " ") {
        event.preventDefault();
        drawer.checked = !drawer.checked;
      }
    });
    document.addEventListener("keydown", (event) => {
      if (event.key === "Escape") drawer.checked = false;
      const isTyping = event.target.closest("input, textarea, select, [contenteditable]");
      if (event.key !== "/" || event.ctrlKey || event.altKey || event.metaKey || isTyping) return;
      event.preventDefault();
      document.querySelector("header input[type=search]").focus();
    });
    open();
    mark();
  }

  // Printing shows what is folded.
  let folded = [];
  window.addEventListener("beforeprint", () => {
    folded = [...all("details:not([open])")];
    folded.forEach((item) => { item.open = true; });
  });
  window.addEventListener("afterprint", () => folded.forEach((item) => { item.open = false; }));
  window.addEventListener("hashchange", open);
  window.addEventListener("load", mark);
  window.addEventListener("resize", mark);
  document.addEventListener("toggle", mark, true);
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", setUp);
  else setUp();
})();
