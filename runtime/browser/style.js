// Licence 0BSD: use, modify and distribute this file without any condition.
// Style of the box, which inherits its colours from the page.

function sheet() {
  const made = new CSSStyleSheet();
  made.replaceSync(`
    div.${CLASS} { container-type: inline-size; text-align: start; }
    div.${CLASS} * { box-sizing: border-box; }
    div.${CLASS} [hidden] { display: none; }
    .${CLASS}-item { margin: 0 0 .8rem; }
    .${CLASS}-item > label { display: block; font-weight: 600; }
    div.${CLASS} :is(input:not([type]), select, textarea) {
      display: block; width: 100%; font: inherit; padding: .45rem .5rem; color: inherit;
      background: transparent; border: 1px solid GrayText; border-radius: 4px;
    }
    div.${CLASS} :is(option, optgroup) { background: Field; color: FieldText; }
    div.${CLASS} :is(textarea, pre, input, input:not([type])) { font-family: ui-monospace, monospace; }
    div.${CLASS} [aria-invalid=true] { border-color: #c62828; }
    .${CLASS}-hint, .${CLASS}-meaning, .${CLASS}-raw, .${CLASS}-source { font-size: .875em; opacity: .85; }
    .${CLASS}-meaning, .${CLASS}-raw { display: block; font-weight: 400; }
    .${CLASS}-raw { font-family: ui-monospace, monospace; }
    div.${CLASS} fieldset { margin: 0 0 1rem; min-width: 0; border: 1px solid GrayText; border-radius: 4px; }
    div.${CLASS} fieldset > label { display: block; margin: .3rem 0; }
    div.${CLASS} details { margin: 0 0 1rem; }
    div.${CLASS} summary { margin: 0 0 .5rem; cursor: pointer; }
    div.${CLASS} button {
      font: inherit; padding: .3rem .6rem; margin: 0 .4rem .4rem 0; color: inherit; background: transparent;
      border: 1px solid GrayText; border-radius: 4px; cursor: pointer;
    }
    div.${CLASS} table { display: table; table-layout: fixed; width: 100%; margin: 1rem 0; }
    div.${CLASS} table { border-collapse: collapse; }
    div.${CLASS} caption { text-align: start; font-weight: 600; padding: .3rem 0; }
    div.${CLASS} :is(td, th) {
      padding: .35rem .6rem .35rem 0; text-align: start; vertical-align: top; border: 0 solid GrayText;
      border-bottom-width: 1px; background: transparent; overflow-wrap: anywhere;
    }
    div.${CLASS} thead th { width: 35%; }
    div.${CLASS} thead th:nth-child(2) { width: 43%; }
    div.${CLASS} thead th:first-child { width: 22%; }
    @container (min-width: 40rem) {
      div.${CLASS} thead th:nth-child(2) { width: 60%; }
      div.${CLASS} thead th:is(:first-child, :last-child) { width: 20%; }
    }
    div.${CLASS} pre { margin: 0 0 1rem; padding: .5rem; white-space: pre-wrap; overflow-wrap: anywhere; }
    div.${CLASS} pre { border: 1px solid GrayText; border-radius: 4px; background: transparent; color: inherit; }
    div.${CLASS} a { color: inherit; text-decoration: underline; }
    div.${CLASS} code { background: transparent; color: inherit; }
    .${CLASS}-good, .${CLASS}-bad, .${CLASS}-warning, .${CLASS}-plain {
      margin: 0 0 1rem; padding: .1rem .8rem; border-inline-start: .4rem solid GrayText; font-weight: 600;
    }
    .${CLASS}-good > p::before { content: "✓ "; color: #388e3c; }
    .${CLASS}-warning > p::before { content: "▲ "; color: #c77700; }
    .${CLASS}-bad > p::before { content: "✕ "; color: #d32f2f; }
    .${CLASS}-badge { white-space: nowrap; font-weight: 600; }
    .${CLASS}-badge::before { content: "? "; }
    .${CLASS}-badge-good::before { content: "✓ "; color: #388e3c; }
    .${CLASS}-badge-warning::before { content: "▲ "; color: #c77700; }
    .${CLASS}-badge-bad::before { content: "✕ "; color: #d32f2f; }
    div.${CLASS} table.${CLASS}-many { table-layout: auto; }
    div.${CLASS} table.${CLASS}-many :is(th, td) { width: auto; overflow-wrap: break-word; }
    div.${CLASS} table.${CLASS}-many code { font-family: ui-monospace, monospace; font-size: .9em; }
    @container (min-width: 40rem) { div.${CLASS} .${CLASS}-value { white-space: nowrap; } }
    div.${CLASS} table.${CLASS}-many button { margin: 0; padding: .05rem .5rem; }
    @container (max-width: 40rem) {
      div.${CLASS} .${CLASS}-frame { display: none; }
      .${CLASS}-badge { white-space: normal; }
    }
    .${CLASS}-good { border-color: #388e3c; }
    .${CLASS}-warning { border-color: #c77700; }
    .${CLASS}-bad { border-color: #d32f2f; }
    .${CLASS}-wrong { font-weight: 600; }
  `);
  return made;
}
