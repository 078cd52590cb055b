// The conflicts as a table: sorted, filtered, a hundred rows at a time.

const table = { title: "", down: true, first: 0, rows: 100, side: "", from: "", to: "",
                least: "" };

const sizeOf = (c) => c.hi.map((h, k) => h - c.lo[k]);

/** title, key to sort by, cell. */
function tableColumns() {
  const measured = conflictList().some((c) => c.least_distance !== null);
  return [
    ["No.", (c) => c.id, (c) => String(c.id)],
    ["Chainage", (c) => c.chainage_from, (c) => c.chainage_to - c.chainage_from < 0.005
        ? c.chainage_from.toFixed(2) : `${c.chainage_from.toFixed(2)} – ${c.chainage_to.toFixed(2)}`],
    ["Side", (c) => c.side, (c) => kSides[c.side]],
    measured && ["Class", (c) => c.least_distance ?? Infinity, classCell],
    measured && ["Least distance", (c) => c.least_distance ?? Infinity,
                 (c) => c.least_distance === null ? "" : c.least_distance.toFixed(3)],
    measured && ["Missing", (c) => c.encroachment ?? -1,
                 (c) => c.encroachment === null ? "" : c.encroachment.toFixed(3)],
    ["Points", (c) => c.points, (c) => count(c.points)],
    ["Size", (c) => Math.max(...sizeOf(c)), (c) => sizeOf(c).map((s) => s.toFixed(2)).join(" × ")],
    ["Pose", poseOf, (c) => String(poseOf(c))],
    ["Place x, y, z", (c) => (c.nearest_point ?? c.centroid)[0],
     (c) => coordinates(c.nearest_point ?? c.centroid)],
  ].filter(Boolean).map(([title, value, cell]) =>
      ({ title, value, cell, number: !["Side", "Class"].includes(title) }));
}

function classCell(conflict) {
  const words = classOf(conflict.least_distance);
  return make("span", {}, make("span", { style: `color:${words.colour}`, class: "symbol" },
                               words.symbol), ` ${words.name}`);
}

/** Column titles with the unit, where all of its numbers have one. */
function titleWithUnit(title) {
  const has = ["Chainage", "Least distance", "Missing", "Size", "Place x, y, z"].includes(title);
  return has ? `${title} (${unitSymbol})` : title;
}

function filteredConflicts() {
  const from = parseFloat(table.from), to = parseFloat(table.to), least = parseFloat(table.least);
  return conflictList().filter((c) =>
      (table.side === "" || c.side === table.side) && !(c.chainage_to < from) &&
      !(c.chainage_from > to) && !((c.encroachment ?? 0) < least));
}

function sortedConflicts(columns) {
  const column = columns.find((c) => c.title === table.title) ?? columns[0];
  const sign = table.down ? -1 : 1;
  return filteredConflicts().sort((a, b) => {
    const x = column.value(a), y = column.value(b);
    return (x < y ? -sign : x > y ? sign : 0) || a.id - b.id;
  });
}

function sortBy(title) {
  const numbers = !["No.", "Chainage", "Side", "Least distance", "Class", "Pose"].includes(title);
  table.down = table.title === title ? !table.down : numbers;
  table.title = title;
  table.first = 0;
  drawTable();
  const at = tableColumns().findIndex((column) => column.title === title);
  document.querySelectorAll("#conflicts-table th button")[at]?.focus();
}

function tableHead(columns, sortable) {
  return make("thead", {}, make("tr", {}, columns.map((c) => {
    const sorted = sortable && table.title === c.title;
    const label = titleWithUnit(c.title) + (sorted ? (table.down ? " ▼" : " ▲") : "");
    return make("th", { scope: "col", class: c.number ? "number" : null, "aria-sort": sorted ? (table.down ? "descending" : "ascending")
                                                          : null },
                sortable ? button(label, () => sortBy(c.title)) : titleWithUnit(c.title));
  })));
}

function tableRow(conflict, columns, live) {
  const cells = columns.map((c) => make("td", { class: c.number ? "number" : null }, c.cell(conflict)));
  if (!live) return make("tr", {}, cells);
  const chosen = conflict === page.conflict;
  return make("tr", { tabindex: 0, "data-id": conflict.id, class: chosen ? "chosen" : null,
                      "aria-selected": String(chosen), onclick: () => selectConflict(conflict),
                      onkeydown: rowKey }, cells);
}

function rowKey(event) {
  const row = event.currentTarget;
  const next = { ArrowDown: row.nextElementSibling, ArrowUp: row.previousElementSibling }[event.key];
  if (next) {
    event.preventDefault();
    next.focus();
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
    make("div", { class: "scroll" }, make("table", { class: "list" }, tableHead(columns, true),
         make("tbody", {}, rows.map((c) => tableRow(c, columns, true))))),
    tablePager(all.length));
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
}

function filterField(label, name, width) {
  const input = make("input", { type: "number", step: "any", style: `width:${width}em`,
                                oninput: (event) => {
                                  table[name] = event.target.value;
                                  table.first = 0;
                                  drawTable();
                                } });
  return make("label", {}, `${label} `, input);
}

function buildFilters() {
  const sides = [...new Set(conflictList().map((c) => c.side))].sort();
  const select = make("select", { onchange: (event) => {
    table.side = event.target.value;
    table.first = 0;
    drawTable();
  } }, make("option", { value: "" }, "all sides"),
       sides.map((side) => make("option", { value: side }, kSides[side] || "unknown")));
  byId("conflicts-tools").append(
    make("label", {}, "Side ", select), filterField("Chainage from", "from", 6),
    filterField("to", "to", 6),
    conflictList().some((c) => c.encroachment !== null)
        ? filterField(`At least missing (${unitSymbol})`, "least", 5) : "");
}

function buildTable() {
  const { conflicts } = page.facts;
  byId("conflicts-note").append(make("p", {}, conflictsNote(conflicts)));
  if (conflictList().length === 0) return;
  const measured = conflictList().some((c) => c.encroachment !== null);
  table.title = measured ? "Missing" : "Points";
  buildFilters();
  drawTable();
  on("conflict", markRow);
}

function conflictsNote(found) {
  if (!found) {
    return page.facts.colliding_points === 0 ? "There are none: nothing collides."
        : "The result has no first poses, so the colliding points have no place along the path. " +
          "clearway run --first-pose adds them, and this table.";
  }
  if (found.count === 0 && found.small_points === 0) return "There are none: nothing collides.";
  let text = `Colliding points at most ${shortLength(found.gap)} apart are one conflict`;
  text += found.split > 0 ? `, cut every ${shortLength(found.split)} along the path.` : ".";
  if (found.small_groups > 0) {
    text += ` ${plural(found.small_groups, "group")} of fewer than ${count(found.min_points)} points ` +
        `(${plural(found.small_points, "point")} in all) are counted as colliding, but not listed.`;
  }
  if (found.list.length < found.count) {
    text += ` This page lists the ${count(found.list.length)} worst of ${count(found.count)}; ` +
        "clearway conflicts writes all.";
  }
  return text;
}
