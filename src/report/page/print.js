// What only paper has: all rows of the table in one, and the worst conflicts with their pictures.

const kPrintedRows = 200, kPrintedCards = 8;

function printedTable() {
  const columns = tableColumns(), all = sortedConflicts(columns), rows = all.slice(0, kPrintedRows);
  const left = all.length - rows.length;
  return [make("table", { class: "list" }, tableHead(columns, false),
               make("tbody", {}, rows.map((c) => tableRow(c, columns, false)))),
          left > 0 && make("p", { class: "note" },
                           `${count(left)} more conflicts are in the page itself, not on paper.`)];
}

function printedCards() {
  const worst = [...conflictList()].sort((a, b) => (b.encroachment ?? 0) - (a.encroachment ?? 0) ||
      b.points - a.points).slice(0, kPrintedCards);
  const rest = conflictList().length - worst.length;
  return [make("h2", {}, rest > 0 ? `The ${worst.length} worst conflicts` : "The conflicts, one by one"),
          worst.map((conflict) => make("article", { class: "card" },
              make("h3", {}, `Conflict ${conflict.id}`), conflictFacts(conflict),
              conflictPictures(conflict, 520)))];
}

function preparePrint() {
  const holder = byId("print-cards");
  if (holder.childElementCount > 0) return;
  if (conflictList().length === 0) return;
  holder.append(make("section", { class: "printed-table" }, make("h2", {}, "All conflicts"),
                     ...printedTable().filter(Boolean)),
                make("section", {}, ...printedCards().flat()));
}

function buildPrint() {
  byId("print-page").addEventListener("click", () => window.print());
  window.addEventListener("beforeprint", preparePrint);
  window.addEventListener("afterprint", () => byId("print-cards").replaceChildren());
}
