// The chosen conflict: its facts and its three pictures.

const kKinds = [["front", "From the front", "The conflict and what is within a few metres of it, and the vehicle's outline."],
                ["above", "From above", "What is not above the vehicle."],
                ["section", "Cross-section", "A slice through the nearest point. The dashed outline is the distance to keep."]];

function conflictFacts(conflict) {
  const { query } = page.facts, words = classOf(conflict.least_distance);
  const rows = [
    ["Where", `chainage ${conflict.chainage_from.toFixed(2)} to ${station(conflict.chainage_to)}` +
              after(sideWords(conflict.side))],
    ["Place", coordinates(conflict.nearest_point ?? conflict.centroid)],
  ];
  if (conflict.least_distance !== null) {
    rows.push(["Distance", `${words.symbol} ${words.name}: ${metres(conflict.least_distance)} of ` +
                           `${shortLength(query.radius)}`],
              ["Missing", metres(conflict.encroachment)]);
  } else {
    rows.push(["Distance", `closer than ${shortLength(query.radius)}; run with --clearance to know it`]);
  }
  rows.push(["Points", `${count(conflict.points)} in ${sizeOf(conflict).map((s) => s.toFixed(2)).join(" × ")} ${unitSymbol}`],
            ["Poses", `${count(conflict.first_pose)} to ${count(conflict.last_pose)}` +
             (conflict.nearest_pose !== null ? `, nearest at ${count(conflict.nearest_pose)}` : "")]);
  return make("table", { class: "facts" }, make("tbody", {},
              rows.map(([name, value]) => factRow(name, value))));
}

/** The three pictures, drawn at once. width: of each in pixels. */
function conflictPictures(conflict, width) {
  return make("div", { class: "pictures" }, kKinds.map(([kind, title, what]) => {
    const canvas = make("canvas", { width, height: Math.round(width * 0.75), role: "img",
                                    "data-kind": kind,
                                    "aria-label": `Conflict ${conflict.id}, ${title}` });
    drawConflict(canvas, conflict, kind);
    return make("figure", {}, canvas, make("figcaption", {}, make("strong", {}, title), ` ${what}`));
  }));
}

/** The conflict before or after the chosen one, as the table is sorted. */
function nextConflict(by) {
  const order = sortedConflicts(tableColumns());
  const at = order.indexOf(page.conflict);
  const next = order[at + by];
  if (next) selectConflict(next);
}

function drawDetails() {
  const conflict = page.conflict, holder = byId("conflict-details");
  if (!conflict) {
    holder.replaceChildren();
    return;
  }
  const focused = holder.contains(document.activeElement) ? document.activeElement.textContent : null;
  holder.replaceChildren(
    make("div", { class: "tools" }, make("h3", {}, `Conflict ${conflict.id}`),
         button("Previous", () => nextConflict(-1)), button("Next", () => nextConflict(1)),
         button("Show in 3-D", () => byId("view").scrollIntoView())),
    make("div", { class: "details" }, conflictFacts(conflict),
         conflictPictures(conflict, innerWidth > 1800 ? 880 : 640)));
  for (const again of holder.querySelectorAll("button")) {
    if (again.textContent === focused) again.focus();
  }
}

function buildDetails() {
  on("conflict", drawDetails);
}
