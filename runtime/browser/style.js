// License 0BSD: use, modify and distribute this file without any condition.
// Style of the box. Its colors come from palette.css, which precedes it.

function sheet() {
  const made = new CSSStyleSheet();
  made.replaceSync(`${PALETTE}
    div.${CLASS} { container-type: inline-size; text-align: start; }
    div.${CLASS} * { box-sizing: border-box; }
    div.${CLASS} [hidden] { display: none; }
    .${CLASS}-item { margin: 0 0 .8rem; }
    .${CLASS}-item > label { display: block; font-weight: 600; }
    div.${CLASS} :is(input:not([type]), select, textarea) {
      display: block; width: 100%; font: inherit; padding: .45rem .5rem; color: inherit;
      background: transparent; border: 1px solid var(--codewheel-control); border-radius: 4px;
    }
    .${CLASS}-item > :is(input:not([type]), select) { min-height: 2.6rem; }
    div.${CLASS} :is(option, optgroup) { background: var(--codewheel-page); color: var(--codewheel-ink); }
    div.${CLASS} :is(textarea, pre, input, input:not([type])) { font-family: ui-monospace, monospace; }
    div.${CLASS} [aria-invalid=true] { border-color: var(--codewheel-not-usable); }
    .${CLASS}-hint, .${CLASS}-meaning, .${CLASS}-raw, .${CLASS}-source { font-size: .875em; opacity: .85; }
    .${CLASS}-meaning, .${CLASS}-raw { display: block; font-weight: 400; }
    .${CLASS}-raw { font-family: ui-monospace, monospace; }
    div.${CLASS} fieldset { margin: 0 0 1rem; min-width: 0; border: 1px solid var(--codewheel-control); border-radius: 4px; }
    div.${CLASS} fieldset > label { display: block; margin: .3rem 0; }
    div.${CLASS} details { margin: 0 0 1rem; }
    div.${CLASS} summary { margin: 0 0 .5rem; cursor: pointer; }
    div.${CLASS} button {
      font: inherit; padding: .3rem .6rem; margin: 0 .4rem .4rem 0; color: inherit; background: transparent;
      border: 1px solid var(--codewheel-control); border-radius: 4px; cursor: pointer;
    }
    div.${CLASS} table { display: table; table-layout: fixed; width: 100%; margin: 1rem 0; }
    div.${CLASS} table { border-collapse: collapse; }
    div.${CLASS} caption { text-align: start; font-weight: 600; padding: .3rem 0; }
    div.${CLASS} :is(td, th) {
      padding: .35rem .6rem .35rem .3rem; text-align: start; vertical-align: top;
      border: 0 solid var(--codewheel-border);
      border-bottom-width: 1px; background: transparent; overflow-wrap: anywhere;
    }
    div.${CLASS} thead th { width: 35%; }
    div.${CLASS} thead th:nth-child(2) { width: 43%; }
    div.${CLASS} thead th:first-child { width: 22%; }
    @container (min-width: 40rem) {
      .${CLASS}-item:nth-of-type(-n+2) { display: inline-block; width: calc(50% - .5rem); vertical-align: top; }
      .${CLASS}-item:nth-of-type(1) { margin-inline-end: 1rem; }
      div.${CLASS} thead th:nth-child(2) { width: 60%; }
      div.${CLASS} thead th:is(:first-child, :last-child) { width: 20%; }
    }
    div.${CLASS} pre { margin: 0 0 1rem; padding: .5rem; white-space: pre-wrap; overflow-wrap: anywhere; }
    div.${CLASS} pre { border: 1px solid var(--codewheel-control); border-radius: 4px; background: transparent; color: inherit; }
    div.${CLASS} a { color: var(--codewheel-link); text-decoration: underline; }
    div.${CLASS} code { background: transparent; color: inherit; }
    .${CLASS}-builder ol { margin: 0; padding: 0; list-style: none; }
    div.${CLASS} .${CLASS}-builder fieldset { margin: 0 0 .5rem; padding: .2rem .5rem .4rem; }
    .${CLASS}-row { display: flex; flex-wrap: wrap; gap: .4rem .8rem; align-items: center; }
    .${CLASS}-builder > .${CLASS}-row { margin: 0 0 .6rem; }
    div.${CLASS} .${CLASS}-row :is(label, input, select) { display: inline-block; width: auto; max-width: 100%; margin: 0; }
    div.${CLASS} .${CLASS}-row select { max-width: min(100%, 17rem); }
    div.${CLASS} .${CLASS}-row :is(input:not([type]), select) { padding: .2rem .3rem; min-height: 1.8rem; }
    .${CLASS}-note { overflow-wrap: anywhere; }
    .${CLASS}-moves { margin-inline-start: auto; }
    div.${CLASS} .${CLASS}-moves button { margin: 0 0 0 .3rem; min-width: 2.2rem; min-height: 2rem; }
    div.${CLASS} button:disabled { opacity: .4; cursor: default; }
    .${CLASS}-good, .${CLASS}-bad, .${CLASS}-warning, .${CLASS}-plain {
      margin: 0 0 1rem; padding: .5rem .8rem; border-inline-start: .4rem solid var(--codewheel-control); font-weight: 600;
      border-radius: 4px; font-size: 1.1em; color: var(--codewheel-ink);
    }
    div.${CLASS} :is(.${CLASS}-good, .${CLASS}-bad, .${CLASS}-warning, .${CLASS}-plain) > p { margin: 0; }
    .${CLASS}-good { background: var(--codewheel-usable-ground); }
    .${CLASS}-warning { background: var(--codewheel-warning-ground); }
    .${CLASS}-bad { background: var(--codewheel-not-usable-ground); }
    .${CLASS}-plain { background: var(--codewheel-unknown-ground); }
    .${CLASS}-angle { font-size: 1.35em; font-weight: 600; margin: 0 0 .8rem; }
    .${CLASS}-drawing { display: flex; flex-wrap: wrap; gap: 2px; margin: .5rem 0 .3rem; }
    .${CLASS}-drawing .${CLASS}-cell {
      box-sizing: border-box; margin: 0; padding: .25rem .15rem; min-width: 1.3rem; border: 1px solid transparent;
      border-radius: 4px; font: inherit; text-align: center; cursor: pointer;
      line-height: 1.25; overflow-wrap: anywhere; color: var(--codewheel-ink);
    }
    .${CLASS}-drawing .${CLASS}-cell-data { background: var(--codewheel-bits-data); }
    .${CLASS}-drawing .${CLASS}-cell-flag { background: var(--codewheel-bits-flag); }
    .${CLASS}-drawing .${CLASS}-cell-choice { background: var(--codewheel-bits-choice); }
    .${CLASS}-drawing .${CLASS}-cell-check { background: var(--codewheel-bits-check); }
    .${CLASS}-drawing .${CLASS}-cell-fixed { background: var(--codewheel-bits-fixed); }
    .${CLASS}-drawing .${CLASS}-cell-active { background: var(--codewheel-bits-active); font-weight: 700; }
    .${CLASS}-drawing .${CLASS}-cell.${CLASS}-lit { border-color: currentColor; }
    div.${CLASS} tr.${CLASS}-lit > * { background: var(--codewheel-chosen); color: var(--codewheel-ink); }
    .${CLASS}-bits { display: block; font: .85em ui-monospace, monospace; }
    .${CLASS}-name { display: block; font-size: .75em; }
    .${CLASS}-narrow .${CLASS}-name { writing-mode: vertical-rl; margin: .2rem auto 0; white-space: nowrap; }
    @media print { .${CLASS}-picture { display: none; } }
    @media screen { .${CLASS}-printed { display: none; } }
    .${CLASS}-about { min-height: 1.6em; font-size: .92em; margin: 0 0 .5rem; }
    .${CLASS}-picture .${CLASS}-about:not(:has(b)) { display: none; }
    .${CLASS}-picture .${CLASS}-drawing { margin: 0 0 .3rem; }
    .${CLASS}-good > p::before { content: "✓ "; color: var(--codewheel-usable); }
    .${CLASS}-warning > p::before { content: "▲ "; color: var(--codewheel-warning); }
    .${CLASS}-bad > p::before { content: "✕ "; color: var(--codewheel-not-usable); }
    .${CLASS}-badge { white-space: nowrap; font-weight: 600; }
    .${CLASS}-badge::before { content: "? "; }
    .${CLASS}-badge-good::before { content: "✓ "; color: var(--codewheel-usable); }
    .${CLASS}-badge-warning::before { content: "▲ "; color: var(--codewheel-warning); }
    .${CLASS}-badge-bad::before { content: "✕ "; color: var(--codewheel-not-usable); }
    .${CLASS}-scroll { overflow-x: auto; }
    div.${CLASS} table.${CLASS}-many { table-layout: auto; }
    div.${CLASS} table.${CLASS}-many :is(th, td) { width: auto; overflow-wrap: break-word; }
    div.${CLASS} table.${CLASS}-many code { font-family: ui-monospace, monospace; font-size: .9em; }
    @container (min-width: 40rem) { div.${CLASS} .${CLASS}-value { white-space: nowrap; } }
    div.${CLASS} table.${CLASS}-many button { margin: 0; padding: .05rem .5rem; }
    @container (max-width: 40rem) {
      div.${CLASS} .${CLASS}-frame { display: none; }
      .${CLASS}-badge { white-space: normal; }
    }
    .${CLASS}-good { border-color: var(--codewheel-usable); }
    .${CLASS}-warning { border-color: var(--codewheel-warning); }
    .${CLASS}-bad { border-color: var(--codewheel-not-usable); }
    .${CLASS}-wrong { font-weight: 600; }
  `);
  return made;
}
