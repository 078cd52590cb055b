// The conflicts as a table: sorted, filtered, a hundred rows at a time.

const table = { title: "", down: true, first: 0, rows: 100, side: "", from: "", to: "",
                least: "", status: "" };

const sizeOf = (c) => c.hi.map((h, k) => h - c.lo[k]);
/** "8.00 × 2.50 × 3.40" */
const sizeCell = (c) => sizeOf(c).map((s) => s.toFixed(2)).join(" × ");

/** Whether the error budget leaves open if the conflict is one. */
const isPossible = (conflict) => conflict.class === "possible";

/** Whether the class of a conflict distinguishes it from others. */
function classesDiffer() {
  return new Set(conflictList().map((c) => classOf(c.least_distance).name)).size > 1;
}

/** What columns have besides a title, a value to sort by, and a cell. */
const kText = { kind: null }, kLength = { unit: unitSymbol }, kMost = { down: true }, kMostLength = { ...kLength, ...kMost };

/** {title, heading, value, cell, kind, down (whether the greatest comes first)}. */
function tableColumns() {
  const list = conflictList(), measured = list.some((c) => c.least_distance !== null);
  const digits = digitsFor(list.map((c) => c.least_distance));
  const lengths = (key) => (c) => c[key] === null ? "" : fixed(c[key], digits);
  const deep = list.some((c) => isInside(c.least_distance));
  const estimated = list.some((c) => (c.depth_source ?? null) !== null);
  const outside = (c) => isInside(c.least_distance) ? "inside" : lengths("least_distance")(c);
  const shifted = list.some((c) => c.own_shift_left !== null || c.own_shift_right !== null);
  const offset = (key) => [(c) => c[key] ?? 0, (c) => c[key] === null ? "" : signed(c[key]), kLength];
  return [
    ["No.", (c) => c.id, (c) => String(c.id)],
    ["Rank", (c) => c.rank, (c) => String(c.rank)],
    ledgerFacts() && ["Ledger", (c) => ledgerRank(ledgerStatus(c)), ledgerCell, kText],
    ledgerFacts()?.conflicts.some(decisionWords) &&
        ["Decided", (c) => decisionWords(ledgerOfConflict.get(c.id)), (c) => decisionCell(ledgerOfConflict.get(c.id)), kText],
    ["Chainage", (c) => c.chainage_from, chainageCell, kLength],
    list.some((c) => c.station_from !== undefined) && ["Station", (c) => c.station_from, stationsCell, { unit: "m" }],
    list.some((c) => c.obstacle_chainage !== null) &&
        ["Obstacle at", (c) => c.obstacle_chainage ?? c.chainage_from, stationCell, kLength],
    list.some((c) => c.body !== undefined) && ["Body", (c) => c.body ?? "", (c) => c.body ?? "", kText],
    ["Side", (c) => c.side, (c) => kSides[c.side], kText],
    list.some((c) => c.lateral !== null) && ["Lateral", ...offset("lateral")],
    list.some((c) => c.height !== null) && ["Height", ...offset("height")],
    list.some((c) => c.class) && ["Certainty", (c) => c.class, certaintyCell, kText],
    measured && classesDiffer() && ["Class", (c) => c.least_distance ?? Infinity, classCell, kText],
    measured && ["Least distance", (c) => c.least_distance ?? Infinity, outside, kLength],
    (deep || estimated) && [estimated ? "Depth, estimated" : "Depth", (c) => c.depth ?? 0,
                            (c) => c.depth ? fixed(c.depth, digits) : "", kMostLength],
    measured && ["Missing", (c) => c.encroachment ?? -1, missingCell, kMostLength],
    list.some((c) => leastTrim(c) !== null) &&
        ["Trim", (c) => leastTrim(c) ?? Infinity, (c) => roundedUp(leastTrim(c)), kMostLength],
    ...["left", "right"].map((side) => [side, `own_shift_${side}`]).map(([side, key]) =>
        shifted && [`Own shift ${side}`, (c) => c[key] ?? Infinity, (c) => roundedUp(c[key]), kMostLength]),
    page.facts.shifts && ["Frees it", freedRank, freedCell, kLength],
    ["Points", (c) => c.points, (c) => count(c.points), kMost],
    deep && ["Inside", (c) => c.points_inside ?? 0, (c) => count(c.points_inside ?? 0), kMost],
    ["Size", (c) => Math.max(...sizeOf(c)), sizeCell, kMostLength],
    ["Pose", poseOf, (c) => String(poseOf(c))],
    ["Place x, y, z", (c) => placeOfTable(c)[0], (c) => coordinates(placeOfTable(c)), kMostLength],
  ].filter(Boolean).map(([title, value, cell, how = {}]) =>
      ({ title, value, cell, kind: "number", ...how, heading: how.unit ? `${title} (${how.unit})` : title }));
}

/** The nearest point of a conflict, or else the middle of its points. */
const placeOfTable = (conflict) => conflict.nearest_point ?? conflict.centroid;

/** From and to, or one of them where they are the same. */
const span = (from, to, between = " – ") => from === to ? from : from + between + to;
const chainageCell = ({ chainage_from: from, chainage_to: to }) => span(from.toFixed(2), to.toFixed(2));
/** The stations of a conflict or a stretch, which go down where the path runs against them. */
const stationsCell = ({ station_from: from, station_to: to }) => span(fixed(from, 2), fixed(to, 2));

const stationCell = (c) => c.obstacle_chainage === null ? "" : c.obstacle_chainage.toFixed(2);

/** A shift or a trim, never rounded down; empty where there is none. */
const roundedUp = (length) => length === null ? "" : (Math.ceil(length * 1000 - 1e-6) / 1000).toFixed(3);

/** The trim on the conflict's side; null where none is known. */
const leastTrim = (c) => c[`trim_${c.side}`] ?? null;

const missingCell = (c) => c.encroachment === null ? ""
    : missingWords(c.encroachment, c.least_distance, c.encroachment_is, "");

const certaintyCell = (conflict) => isPossible(conflict) ? "○ possible" : "● certain";

function classCell(conflict) {
  const words = classOf(conflict.least_distance);
  return make("span", {}, make("span", { style: `color:${words.colour}`, class: "symbol" },
                               words.symbol), ` ${words.name}`);
}

const kNotAccepted = "not accepted";
const hasStatus = (c) => table.status === "" ||
    (table.status === kNotAccepted ? !isAccepted(c) : ledgerStatus(c) === table.status);

function filteredConflicts() {
  const from = parseFloat(table.from), to = parseFloat(table.to), least = parseFloat(table.least);
  return conflictList().filter((c) =>
      (table.side === "" || c.side === table.side) && hasStatus(c) && !(c.chainage_to < from) &&
      !(c.chainage_from > to) && !((c.encroachment ?? 0) < least));
}

function sortedConflicts(columns, list = filteredConflicts()) {
  const column = columns.find((c) => c.title === table.title) ?? columns[0];
  const sign = table.down ? -1 : 1;
  return [...list].sort((a, b) => {
    const x = column.value(a), y = column.value(b);
    return (x < y ? -sign : x > y ? sign : 0) || a.id - b.id;
  });
}

function sortBy(title) {
  const columns = tableColumns(), at = columns.findIndex((column) => column.title === title);
  const { down = false } = columns[at] ?? {};
  table.down = table.title === title ? !table.down : down;
  table.title = title;
  table.first = 0;
  drawTable();
  document.querySelectorAll("#conflicts-table th button")[at]?.focus();
}

/** The titles, each a button that sorts by it. */
function tableHead(columns) {
  return make("thead", {}, make("tr", {}, columns.map(({ title, heading, kind }) => {
    const sorted = table.title === title;
    return make("th", { scope: "col", class: kind,
                        "aria-sort": !sorted ? "none" : table.down ? "descending" : "ascending" },
                button(heading + (sorted ? (table.down ? " ▼" : " ▲") : ""), () => sortBy(title)));
  })));
}

function tableRow(conflict, columns) {
  const chosen = conflict === page.conflict;
  return make("tr", { tabindex: -1, "data-id": conflict.id, class: chosen ? "chosen" : null,
                      "data-status": ledgerStatus(conflict) || null,
                      "aria-selected": String(chosen), onclick: () => selectConflict(conflict),
                      onkeydown: rowKey }, cellsOf(columns, conflict));
}

const tableRows = () => [...document.querySelectorAll("#conflicts-table tbody tr")];

/** The table is one stop of the Tab key: that row, or else the chosen one, or the first. */
function setTabStop(row) {
  const rows = tableRows();
  const stop = row ?? rows.find((r) => r.classList.contains("chosen")) ?? rows[0];
  for (const other of rows) other.tabIndex = other === stop ? 0 : -1;
}

/** To the row so many further down, on another page of the table where it is there. */
function focusRow(row, by) {
  const total = filteredConflicts().length, at = table.first + tableRows().indexOf(row);
  const next = clamp(at + by, 0, total - 1);
  if (next < table.first || next >= table.first + table.rows) {
    table.first = next - next % table.rows;
    drawTable();
  }
  const there = tableRows()[next - table.first];
  setTabStop(there);
  there.focus();
}

function rowKey(event) {
  const row = event.currentTarget;
  const by = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10, Home: -1e9, End: 1e9 }[event.key];
  if (by) {
    event.preventDefault();
    focusRow(row, by);
  } else if (event.key === "Enter" || event.key === " ") {
    event.preventDefault();
    selectConflict(conflictList().find((c) => String(c.id) === row.dataset.id));
  }
}

function tablePager(total) {
  const last = Math.min(total, table.first + table.rows);
  const turn = (by) => { table.first = clamp(table.first + by, 0, total - 1); drawTable(); };
  const shown = total === 0 ? "No conflict has these properties."
      : `${count(table.first + 1)} to ${count(last)} of ${count(total)}`;
  return make("div", { class: "tools", id: "table-pager" }, make("span", { role: "status" }, shown),
    total > table.rows && button("Previous", () => turn(-table.rows),
                                 { disabled: table.first === 0 }),
    total > table.rows && button("Next", () => turn(table.rows), { disabled: last >= total }));
}

function drawTable() {
  const columns = tableColumns(), all = sortedConflicts(columns);
  const rows = all.slice(table.first, table.first + table.rows);
  byId("conflicts-table").replaceChildren(
    scrollBox("", make("table", { class: "list", role: "grid", "aria-label":
         "Conflicts. Arrow keys go from row to row, Enter shows the conflict." },
         tableHead(columns), make("tbody", {}, rows.map((c) => tableRow(c, columns))))),
    tablePager(all.length));
  setTabStop();
}

/** The part of the table with the chosen conflict, if it passes the filters. */
function turnToChosen() {
  const at = sortedConflicts(tableColumns()).indexOf(page.conflict);
  if (at < 0 || (at >= table.first && at < table.first + table.rows)) return;
  table.first = at - at % table.rows;
  drawTable();
}

/** Marks the chosen row without making the table again, which would lose the focus. */
function markRow() {
  turnToChosen();
  const holder = document.querySelector("#conflicts-table .scroll");
  const chosenRow = page.conflict && holder.querySelector(`tr[data-id="${page.conflict.id}"]`);
  if (chosenRow && !holder.contains(document.activeElement)) {
    holder.scrollTop = chosenRow.offsetTop - holder.clientHeight / 2;
  }
  for (const row of document.querySelectorAll("#conflicts-table tbody tr")) {
    const chosen = page.conflict !== null && row.dataset.id === String(page.conflict.id);
    row.classList.toggle("chosen", chosen);
    row.setAttribute("aria-selected", String(chosen));
  }
  if (!holder.contains(document.activeElement)) setTabStop();
}

/** A field of the filters with its label. */
function filterBy(label, name, field, event = "change") {
  field.addEventListener(event, () => {
    table[name] = field.value;
    table.first = 0;
    drawTable();
  });
  return make("label", {}, `${label} `, field);
}

const filterField = (label, name, width) =>
    filterBy(label, name, make("input", { type: "number", step: "any", style: `width:${width}em` }), "input");

const selectField = (options) =>
    make("select", {}, options.map(([value, words]) => make("option", { value }, words)));

/** The statuses of the ledger to choose from. */
function statusFilter() {
  const found = kLedgerOrder.filter((status) => conflictList().some((c) => ledgerStatus(c) === status));
  if (found.length < 2) return "";
  return filterBy("Ledger", "status", selectField([
    ["", "all"], ...(found.includes("accepted") ? [[kNotAccepted, kNotAccepted]] : []), ...found.map((status) => [status, status])]));
}

function buildFilters() {
  const sides = [...new Set(conflictList().map((c) => c.side))].sort();
  byId("conflicts-tools").append(
    filterBy("Side", "side", selectField([["", "all sides"], ...sides.map((side) => [side, kSides[side] || "unknown"])])),
    statusFilter(), filterField("Chainage from", "from", 6),
    filterField("to", "to", 6),
    conflictList().some((c) => c.encroachment !== null)
        ? filterField(`At least missing (${unitSymbol})`, "least", 5) : "");
}

function buildTable() {
  const { conflicts } = page.facts;
  byId("conflicts-note").append(make("p", {}, conflictsNote(conflicts)));
  if (conflictList().length === 0) return;
  table.title = "Rank";
  table.down = false;
  buildFilters();
  drawTable();
  on("conflict", markRow);
}

function conflictsNote(found) {
  if (!found) {
    return page.facts.colliding_points === 0 && !(page.facts.near_points > 0) ? "There are none: nothing collides."
        : "The result has no first poses, so the colliding points have no place along the path. " +
          "clearway run --first-pose adds them, and this table.";
  }
  if (found.count === 0 && found.small_points === 0) return "There are none: nothing collides.";
  let text = `Colliding points at most ${shortLength(found.gap)} apart are one conflict, from ` +
      `${plural(found.min_points, "point")} on`;
  text += found.split > 0 ? `, cut every ${shortLength(found.split)} along the path.` : ".";
  if (found.list.some((c) => c.lateral !== null)) {
    const place = found.list.some((c) => c.nearest_point) ? "nearest point" : "centre of its points";
    const [from, whose] = page.bodyPoses ? ["the body's origin", "body"] : ["the path", "vehicle"];
    text += ` Lateral is how far left (+) or right (−) of ${from} the ${place} lies, height how ` +
        `far above it, along the ${whose}'s own axes.`;
  }
  if (found.list.some((c) => c.class)) {
    const sure = page.facts.query.radius - page.facts.margins.conflict;
    text += sure <= 0 && !isSolid()
        ? " No conflict is certain, because the errors exceed the margin; "
        : " A conflict is certain where ten or more of its points that hang together are too close even with " +
          `the errors (${sure < 0 ? `more than ${shortLength(-sure)} inside` : `closer than ${shortLength(sure)}`}); ` +
        "the others are possible.";
    if (found.min_points !== 10 || found.gap !== page.facts.query.gap) {
      text += ` The verdict itself groups points that are at most ${shortLength(page.facts.query.gap)} apart, from 10 on.`;
    }
  }
  if (found.small_groups > 0) {
    text += ` ${plural(found.small_groups, "group")} of fewer than ${count(found.min_points)} points ` +
        `(${plural(found.small_points, "point")} in all) are counted as colliding, but not listed.`;
  }
  if (found.list.length < found.count) {
    text += ` This page lists the ${count(found.list.length)} worst of ${count(found.count)}; ` +
        "clearway conflicts writes all.";
  }
  return text + ledgerNote() + freedNote();
}
