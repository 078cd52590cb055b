// What a ledger says of the conflicts, and its rows that no conflict belongs to.

const kShownRows = 500;
/** From what needs somebody to what does not. */
const kLedgerOrder = ["worse", "expired", "open", "new", "not-searched", "gone", "accepted", "resolved"];

/** What the ledger says; null where none was given. */
const ledgerFacts = () => page.facts.ledger ?? null;
const ledgerOfConflict = new Map((page.facts.ledger?.conflicts ?? []).map((entry) => [entry.conflict, entry]));

const ledgerStatus = (conflict) => ledgerOfConflict.get(conflict.id)?.status ?? "";
/** Whether its owner accepts a conflict as it is; such ones are drawn quieter. */
const isAccepted = (conflict) => ledgerStatus(conflict) === "accepted";
const ledgerRank = (status) => kLedgerOrder.indexOf(status);

/** The worst conflict that nobody has accepted; null where there is none. */
const worstOutside = () => conflictList().reduce((worst, c) =>
    isAccepted(c) || (worst && worst.rank < c.rank) ? worst : c, null);

const ledgerName = () => `the ledger${ledgerFacts().name ? ` ${ledgerFacts().name}` : ""}`;

const statusWord = (status) => make("span", { class: `status ${status}` }, status);

/** "Ann, until 2026-06-01: slow here". */
function decisionWords({ owner, comment, until }) {
  const who = [owner, until && `until ${until}`].filter(Boolean).join(", ");
  return [who, comment].filter(Boolean).join(": ");
}

/** The status, and below it why, where there is something to say. */
const statusCell = ({ status, why }) =>
    make("div", { class: why ? "judged reasoned" : "judged" }, statusWord(status), why && make("span", {}, capital(why)));

const ledgerCell = (conflict) => statusCell(ledgerOfConflict.get(conflict.id));
/** The details of a conflict have all of a long text. */
function decisionCell(entry) {
  const words = decisionWords(entry);
  return make("div", { class: words.length > 20 ? "decision long" : "decision", title: words || null }, words);
}

/** "1 worse, 2 new": conflicts by status but the accepted ones, the most urgent first. */
function otherStatuses() {
  const entries = ledgerFacts().conflicts;
  return kLedgerOrder.filter((status) => status !== "accepted").map((status) =>
      [status, entries.filter((entry) => entry.status === status).length]).filter(([, n]) => n > 0);
}

/** How many conflicts are accepted, and what that leaves. Empty without a ledger. */
function ledgerSentence() {
  const ledger = ledgerFacts();
  if (!ledger) return "";
  const accepted = ledger.accepted_conflicts, others = otherStatuses();
  const parts = [accepted > 0 && page.facts.verdict === "conflict" ? "The verdict stays conflict." : "", ledger.sentence];
  if (accepted > 0 && others.length > 0) {
    parts.push(`Of the others ${joined(others.map(([status, n]) => `${count(n)} ${n === 1 ? "is" : "are"} ${status}`))}.`);
  }
  const gone = ledger.gone, missed = ledger["not-searched"];
  if (gone > 0) parts.push(`${plural(gone, "row")} of the ledger ${gone === 1 ? "is" : "are"} gone.`);
  if (missed > 0) {
    parts.push(`${plural(missed, "row")} of the ledger ${missed === 1 ? "was" : "were"} not searched, so nobody knows ` +
               `whether ${missed === 1 ? "it is" : "they are"} still there.`);
  }
  return parts.filter(Boolean).join(" ");
}

/** What the column of statuses is. */
function ledgerNote() {
  const ledger = ledgerFacts();
  if (!ledger) return "";
  return ` The column Ledger says what ${ledgerName()} knows of each${ledger.date ? `, as of ${ledger.date}` : ""}.` +
      (ledger.accepted_conflicts > 0 ? " In plan, profile and 3-D view accepted conflicts are grey, with a ✓." : "");
}

/** What the details of a conflict say of its row. */
function ledgerDetails(conflict) {
  const entry = ledgerOfConflict.get(conflict.id);
  if (!entry) return [];
  const row = ledgerFacts().rows.find((one) => one.key === entry.key && entry.key);
  const seen = row?.first_seen && row.first_seen !== row.last_seen ? `, first seen ${row.first_seen}` : "";
  return [["Ledger", make("span", {}, statusWord(entry.status), entry.why ? `: ${entry.why}` : "",
                          entry.key ? ` (row ${entry.key}${seen})` : "")],
          decisionWords(entry) && ["Decided", decisionWords(entry)]].filter(Boolean);
}

/** Rows that no conflict belongs to, but those that are resolved, about which there is nothing to do. */
const rowsWithoutConflict = () => ledgerFacts().rows.filter((row) => row.conflicts.length === 0 && row.shown !== "resolved")
    .sort((a, b) => ledgerRank(a.shown) - ledgerRank(b.shown));

/** What the table says where this run says more. */
const wasWords = ({ shown, status }) => shown === status ? "" : ` (was ${status})`;

const middleOfRow = ({ lo, hi }) => lo === null ? "" : coordinates(lo.map((l, k) => (l + hi[k]) / 2));
const seenCell = ({ first_seen: first, last_seen: last }) => first === last ? first ?? "" : `${first ?? "?"} – ${last ?? "?"}`;

function buildLedgerRows() {
  if (!ledgerFacts()) return;
  const rows = rowsWithoutConflict(), resolved = ledgerFacts().resolved;
  const done = resolved > 0 ? `${plural(resolved, "row")} of the ledger ${resolved === 1 ? "is" : "are"} resolved.` : "";
  if (rows.length === 0) {
    byId("ledger-rows").append(done && make("p", { class: "note" }, done));
    return;
  }
  const columns = columnsOf([
    ["Row", (row) => row.key ?? ""],
    ["Status", (row) => make("span", {}, statusWord(row.shown), wasWords(row))],
    ["Why", (row) => capital(row.why ?? ""), "text"],
    rows.some(decisionWords) && ["Decided", decisionCell, "text"],
    ["Seen", seenCell],
    [`Place x, y, z (${unitSymbol})`, middleOfRow, "number"],
  ]);
  const shown = rows.slice(0, kShownRows), left = rows.length - shown.length;
  byId("ledger-rows").append(
    make("h3", {}, "Rows of the ledger without a conflict"),
    make("p", { class: "note" }, "A row is gone only if this run shows that nothing is there any more." +
         (left > 0 ? ` These are the first ${count(kShownRows)} of ${count(rows.length)}.` : "") + (done && ` ${done}`)),
    itemTable("Rows of the ledger without a conflict", columns, shown));
}
