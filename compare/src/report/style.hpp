#pragma once

#include <string_view>

namespace dlo::compare::builtin {

/// The script of a report's page; its data stands before it, see page_data.
extern const std::string_view interactive_js;

}  // namespace dlo::compare::builtin

namespace dlo::compare {

/// Style sheet of a report's page. Figures are drawn for a light page; in the dark they are
/// inverted as a whole and their hues turned back, which holds for any colours that gnuplot writes.
inline constexpr const char* report_style = R"~~~(
:root { color-scheme: light dark; --back: #ffffff; --text: #1b1f24; --faint: #57606a; --line: #c9d1d9;
  --card: #f6f8fa; --accent: #0059a8; --force: #b34700; --other: #0059a8; }
@media (prefers-color-scheme: dark) {
  :root { --back: #14181d; --text: #e6eaee; --faint: #a3adb8; --line: #3b444e; --card: #1c2229;
    --accent: #7cb8f2; --force: #ff9a5c; --other: #7cb8f2; }
  figure svg { filter: invert(1) hue-rotate(180deg); }
}
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; text-size-adjust: 100%; }
body { margin: 0 auto; padding: 1rem; max-width: 76rem; background: var(--back); color: var(--text);
  font: 1rem/1.5 system-ui, sans-serif; overflow-wrap: break-word; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0.5rem 0; }
h2 { font-size: 1.25rem; margin: 2.2rem 0 0.6rem; padding-top: 0.6rem; border-top: 1px solid var(--line); }
h3 { font-size: 1.05rem; margin: 1.4rem 0 0.4rem; }
a { color: var(--accent); }
nav { position: sticky; top: 0; z-index: 2; background: var(--back); border-bottom: 1px solid var(--line); }
nav ul { list-style: none; margin: 0; padding: 0; display: flex; overflow-x: auto; white-space: nowrap; gap: 0.2rem 1rem; }
section { scroll-margin-top: 3rem; }
nav a { display: inline-block; padding: 0.3rem 0; }
.faint, figcaption, caption { color: var(--faint); font-size: 0.9rem; }
.screen { display: grid; grid-template-columns: 1fr; gap: 1rem 2rem; }
@media (min-width: 70rem) { .screen { grid-template-columns: 2fr 3fr; } }
.screen .figures { grid-template-columns: repeat(auto-fit, minmax(min(100%, 20rem), 1fr)); align-content: start; }
.screen p { margin: 0.5rem 0; font-size: 1.05rem; }
p.badge { display: inline-block; margin: 0.4rem 0; padding: 0.2rem 1rem; border-radius: 6px;
  font-size: 1.6rem; font-weight: 700; color: #ffffff; background: #1a7f37; }
p.badge.fail { background: #b3261e; }
dl.three { display: flex; flex-wrap: wrap; gap: 0.6rem 2rem; }
.three strong { display: block; font-size: 1.4rem; font-variant-numeric: tabular-nums; }
.three span, .three dt { color: var(--faint); font-size: 0.9rem; }
pre { overflow-x: auto; font: 0.8rem/1.4 ui-monospace, monospace; background: var(--card); padding: 0.8rem; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 28rem), 1fr)); gap: 1.2rem; }
figure { margin: 0; min-width: 0; }
figure svg { display: block; width: 100%; max-width: 32rem; height: auto; }
figcaption { margin-top: 0.4rem; }
figcaption strong { color: var(--text); }
.missing { border: 1px dashed var(--line); padding: 1rem; }
.table { overflow-x: auto; margin: 0.8rem 0; max-width: 100%; }
table { border-collapse: collapse; font-size: 0.85rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; padding: 0.3rem 0; caption-side: top; }
th, td { overflow-wrap: normal; padding: 0.3rem 0.6rem; border-bottom: 1px solid var(--line); text-align: left; vertical-align: top; }
thead th { border-bottom: 2px solid var(--line); vertical-align: bottom; }
tbody th { font-weight: 600; min-width: 8.5rem; position: sticky; left: 0; background: var(--back); }
.n { text-align: right; }
.n, .w { white-space: nowrap; }
thead .n, thead .w { white-space: normal; }
td:not(.n):not(.w) { min-width: 14rem; }
caption span { position: sticky; left: 0; display: inline-block; max-width: calc(100vw - 2rem); }
/* What the page's script shows. */
.stage { position: relative; border: 1px solid var(--line); border-radius: 4px; touch-action: pan-y; }
.stage svg { display: block; width: 100%; }
.stage text { font: 13px system-ui, sans-serif; fill: var(--faint); }
.stage path, .legend line { fill: none; }
.stage .obstacle { fill: var(--card); stroke: var(--line); }
.stage .axis { stroke: var(--faint); stroke-width: 1.5; }
.stage .grid { stroke: var(--line); }
.stage .clamp { stroke: var(--faint); stroke-width: 5; fill: var(--faint); opacity: 0.6; }
.stage .mark { fill: none; stroke: var(--accent); stroke-width: 2.5; }
.curve { stroke-width: 2; stroke: var(--text); }
.curve.c1 { stroke: var(--force); stroke-dasharray: 7 3; }
.curve.c2 { stroke: var(--other); stroke-dasharray: 2 3; }
.point.c1 { fill: var(--force); } .point.c2 { fill: var(--other); }
.controls button { margin-right: 0.4rem; }
.controls, .controls button, .controls select, .sliders select { font-size: 1rem; }
.turns { display: inline-block; margin-left: 1rem; } .turns[hidden] { display: none; }
.controls select, .sliders select { max-width: 100%; }
.legend { list-style: none; padding: 0; margin: 0.6rem 0; display: flex; flex-wrap: wrap; gap: 0.2rem 1.2rem; }
.legend svg { width: 36px; height: 12px; margin-right: 0.5rem; }
#interactive output { font-variant-numeric: tabular-nums; }
#view-readout, #grid-readout { display: block; margin: 0.5rem 0; min-height: 3em; }
.sliders { display: grid; grid-template-columns: max-content minmax(8rem, 26rem) 9rem; gap: 0.5rem 1rem; align-items: center; }
.sliders > * { min-width: 0; } .sliders input { width: 100%; margin: 0; }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 22rem), 1fr)); gap: 1rem; }
:focus-visible { outline: 3px solid var(--accent); outline-offset: 2px; }
code { font: 0.85em ui-monospace, monospace; background: var(--card); padding: 0.1em 0.3em; overflow-wrap: anywhere; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 0.3rem 1rem; }
dt { font-weight: 600; } dd { margin: 0; min-width: 0; overflow-wrap: anywhere; }
details summary { cursor: pointer; padding: 0.3rem 0; }
summary h2 { display: inline-block; width: calc(100% - 2rem); margin: 0; border: 0; padding: 0; }
details.section { border-top: 1px solid var(--line); margin-top: 0.6rem; padding: 0.3rem 0; }
@media (max-width: 30rem) {
  dl { grid-template-columns: 1fr; } dd { margin-bottom: 0.5rem; }
  .sliders { grid-template-columns: 1fr 7rem; } .sliders label { grid-column: 1 / -1; }
  .turns { display: block; margin: 0.5rem 0 0; }
  tbody th { min-width: 6.5rem; } th, td { padding: 0.3rem; } .w { white-space: normal; }
}
@media print {
  @page { margin: 15mm; }
  :root { --back: #ffffff; --text: #000000; --faint: #333333; --line: #999999; --card: #ffffff; --accent: #000000; }
  body { padding: 0; max-width: none; font-size: 10pt; }
  nav, #interactive { display: none; }
  figure svg { filter: none; max-width: 11cm; }
  figure, tr, .screen { break-inside: avoid; }
  h2, h3, caption { break-after: avoid; }
  .table { overflow: visible; }
  table { font-size: 7.5pt; }
  th, td, tbody th { padding: 0.15rem 0.3rem; min-width: 0; position: static; }
  td:not(.n):not(.w) { min-width: 0; }
}
)~~~";

}  // namespace dlo::compare
