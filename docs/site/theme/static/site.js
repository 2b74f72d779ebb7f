// Makes boxes that scroll reachable by the keyboard, and only those.
(function () {
  "use strict";
  function mark() {
    document.querySelectorAll(".wide, pre").forEach(function (item) {
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
  window.addEventListener("load", mark);
  window.addEventListener("resize", mark);
  document.addEventListener("toggle", mark, true);
})();
