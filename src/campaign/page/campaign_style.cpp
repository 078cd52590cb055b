#include "campaign/page/campaign_style.hpp"

namespace clearway::campaign {

const char* const kCampaignStyle = R"css(:root {
  --ink: #111827; --soft: #4b5563; --line: #d1d5db; --focus: #1d4ed8;
  font: 15px/1.45 system-ui, "Segoe UI", "DejaVu Sans", Arial, sans-serif; color: var(--ink);
}
* { box-sizing: border-box; }
body { margin: 0; background: #eef0f3; }
header { display: flex; align-items: baseline; gap: 0.3rem 1.4rem; flex-wrap: wrap;
  padding: 0.5rem 1.2rem; background: var(--ink); color: #fff; }
header h1 { font-size: 1.15rem; margin: 0; overflow-wrap: anywhere; }
header p { margin: 0; color: #cbd5e1; font-size: 0.9rem; }
main { padding: 0.8rem 1.2rem; display: grid; gap: 0.8rem; }
section { background: #fff; border: 1px solid var(--line); border-radius: 8px;
  padding: 0.8rem 1.1rem; min-width: 0; }
h2 { font-size: 1.15rem; margin: 0 0 0.5rem; }
:focus-visible { outline: 3px solid var(--focus); outline-offset: 2px; }
.answer { font-size: 1.5rem; font-weight: 600; margin: 0 0 0.6rem; line-height: 1.25; }
.legend { list-style: none; display: flex; flex-wrap: wrap; gap: 0.5rem; margin: 0; padding: 0; }
.legend li { padding: 0.25rem 0.7rem; border-radius: 5px; font-size: 0.92rem; }
.legend b { font-size: 1.15rem; }
.sign { display: inline-block; width: 1.1em; text-align: center; font-weight: 700; }
.conflict { --back: #fbdccf; --front: #8a2404; --edge: #b4330a; }
.doubtful { --back: #fff3cd; --front: #6b4700; --edge: #a16207; }
.undecided { --back: #e9e3f8; --front: #4a2a8a; --edge: #7c5cc4; }
.clear { --back: #e3f4ef; --front: #005645; --edge: #9fd3c4; }
.failed { --back: #3f4652; --front: #fff; --edge: #111827; }
.not_done { --back: #fff; --front: #4b5563; --edge: #9ca3af; }
.legend li, .matrix td { background: var(--back); color: var(--front);
  border: 1.5px solid var(--edge); }
.legend .not_done, .matrix .not_done { border-style: dashed; }
.note { margin: 0.5rem 0 0; color: var(--soft); font-size: 0.9rem; }
.scroll { overflow: auto; max-height: 85vh; }
table { border-collapse: separate; border-spacing: 3px; font-variant-numeric: tabular-nums; }
.matrix th { background: #fff; text-align: left; padding: 0.25rem 0.6rem; font-weight: 600;
  max-width: 16rem; overflow-wrap: anywhere; }
.matrix thead th { position: sticky; top: 0; z-index: 2; vertical-align: bottom; }
.matrix th:first-child { position: sticky; left: 0; z-index: 1; }
.matrix thead th:first-child { z-index: 3; }
.matrix small { display: block; font-weight: 400; color: var(--soft); }
.matrix td { border-radius: 5px; min-width: 6.6rem; padding: 0; line-height: 1.25; }
.matrix td > a, .matrix td:not(:has(a)) { padding: 0.3rem 0.5rem; }
.matrix td > a { display: block; color: inherit; text-decoration: none; }
.matrix td > a:hover .word, .matrix td > a:focus .word { text-decoration: underline; }
.matrix td small { padding-left: 1.7em; color: inherit; white-space: nowrap; }
.matrix td b { font-weight: 600; padding-left: 1.4em; white-space: nowrap; }
.list { border-spacing: 0; width: 100%; }
.list th { text-align: left; background: #e5e9ef; padding: 0.2rem 0.5rem; }
.list td { padding: 0.2rem 0.5rem; border-top: 1px solid #e5e7eb; vertical-align: top;
  overflow-wrap: anywhere; }
.list td:first-child { width: 4rem; }
.list td:nth-child(2) { width: 22%; }
.list a { color: var(--focus); }
@page { size: A4 landscape; margin: 12mm; }
@media print {
  :root { font-size: 8.5pt; }
  body { background: #fff; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  header { background: none; color: var(--ink); padding: 0 0 2mm; border-bottom: 1px solid; }
  header p { color: var(--soft); }
  main { display: block; padding: 3mm 0 0; }
  section { border: 0; padding: 0; margin: 0 0 6mm; }
  .scroll { overflow: visible; max-height: none; }
  .matrix th, .matrix thead th, .matrix th:first-child { position: static; }
  thead { display: table-header-group; }
  tr, .legend { break-inside: avoid; }
  h2 { break-after: avoid; }
  .matrix td { min-width: 0; }
  .many { font-size: 6pt; border-spacing: 1px; width: 100%; table-layout: fixed; }
  .many th:first-child { width: 28mm; }
  .many th { padding: 0.3mm; }
  .many .word { display: none; }
  .many td b { padding: 0; white-space: normal; }
  .matrix.many td > a, .matrix.many td:not(:has(a)) { padding: 0.4mm; }
}
)css";

}  // namespace clearway::campaign
