// What only paper has: all rows of the table in one, and the worst conflicts with their pictures.

const kPrintedRows = 200, kPrintedCards = 8;

/** Those of the table. Paper is narrow, so the texts of the ledger stand below the rows. */
const printedColumns = () => tableColumns().filter(({ title }) => title !== "Decided").map((column) =>
    column.title === "Ledger" ? { ...column, cell: (c) => statusWord(ledgerStatus(c)) } : column);

function printedRows(conflict, columns) {
  const { why = "", ...entry } = ledgerOfConflict.get(conflict.id) ?? {};
  const texts = [capital(why), decisionWords(entry)].filter(Boolean).join(". ");
  return [make("tr", {}, cellsOf(columns, conflict)),
          texts && make("tr", { class: "remedy" }, make("td", { colspan: 2 }), make("td", { colspan: columns.length - 2 }, texts))];
}

/** Rows in the order of the table, whatever its filters leave out. */
function printedTable() {
  const { list, count: found } = page.facts.conflicts, columns = printedColumns();
  const rows = sortedConflicts(columns, list).slice(0, kPrintedRows);
  const left = found - rows.length, elsewhere = list.length < found
      ? `the page itself lists ${count(list.length)}, clearway conflicts writes all`
      : "the page itself lists all";
  return [listTable("Conflicts", columns, rows.flatMap((c) => printedRows(c, columns))),
          left > 0 && make("p", { class: "note" },
                           `${plural(left, "more conflict")} not on paper: ${elsewhere}.`)];
}

function printedCards() {
  const worst = [...conflictList()].sort((a, b) => a.rank - b.rank).slice(0, kPrintedCards);
  const rest = conflictList().length - worst.length;
  return [make("h2", {}, rest > 0 ? `The ${worst.length} worst conflicts` : "The conflicts, one by one"),
          worst.map((conflict) => make("article", { class: "card" },
              make("h3", {}, `Conflict ${conflict.id}`), conflictFacts(conflict),
              conflictPictures(conflict, 520)))];
}

/** What stands below each printed page: the title, the result's short hash, and the number. */
function pageFeet() {
  const { title, inputs } = page.facts;
  const quoted = (text) => `"${text.replace(/\p{C}/gu, " ").replace(/["\\]/g, "\\$&")}"`;
  const font = "font: 7.5pt sans-serif; color: #4b5563;";
  return `@page { @bottom-left { ${font} content: ${quoted(title)}; }
    @bottom-center { ${font} content: "Result ${inputs.result.hash.slice(0, 8)}"; }
    @bottom-right { ${font} content: "Page " counter(page) " of " counter(pages); } }`;
}

/** Of paper's width, so that its letters are not too small to read. */
function drawProfileFor(paper) {
  profile.onPaper = paper;
  drawProfile();
}

function preparePrint() {
  const holder = byId("print-cards");
  if (byId("print-feet")) return;
  drawProfileFor(true);
  unfoldStations(true);
  document.head.append(make("style", { id: "print-feet" }, pageFeet()));
  byId("verdict-body").append(make("p", { class: "note on-paper" }, byId("footer").textContent));
  if (unseenGroups().length > 0) byId("unseen-print").append(...printedGroups().filter(Boolean));
  if (conflictList().length === 0) return;
  byId("print-table").append(...printedTable().filter(Boolean));
  holder.append(make("section", {}, ...printedCards().flat()));
}

function endPrint() {
  drawProfileFor(false);
  unfoldStations(false);
  byId("print-cards").replaceChildren();
  byId("print-table").replaceChildren();
  byId("unseen-print")?.replaceChildren();
  byId("print-feet").remove();
  document.querySelector(".on-paper").remove();
}

function buildPrint() {
  window.addEventListener("beforeprint", preparePrint);
  window.addEventListener("afterprint", endPrint);
}
