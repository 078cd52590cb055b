// The chosen conflict: its facts and its three pictures.

const kKinds = [["front", "From the front", "The conflict and what is within a few metres of it, and the vehicle's outline."],
                ["above", "From above", "What is not above the vehicle."],
                ["section", "Cross-section", "The dashed outline is the distance to keep."]];

/** What the slice goes through: without clearances the nearest point is not known. */
function sliceWords(conflict) {
  const which = isInside(conflict.least_distance) ? "deepest" : "nearest";
  return conflict.nearest_point ? `A slice through the ${which} point.`
      : "A slice through the middle of its points, at the first pose that comes too close.";
}

function nearestPoseWords({ nearest_pose: pose, least_distance: distance }) {
  if (pose === null) return "";
  return `, ${isInside(distance) ? "deepest" : "nearest"} at ${count(pose)}`;
}

function detailedDistance({ least_distance: distance }) {
  const required = shortLength(page.facts.query.radius);
  return isInside(distance) ? `${depthWords(distance)} inside the vehicle; required is ${required} outside`
                            : `${metres(distance)} of ${required}`;
}

function conflictFacts(conflict) {
  const { query } = page.facts, words = classOf(conflict.least_distance);
  const known = conflict.least_distance !== null;
  return factsTable(
    ...ledgerDetails(conflict),
    conflict.class && ["Certainty", conflict.class === "certain"
        ? "certain, even with the errors of the budget" : "possible: the errors leave it open"],
    ["Where", `chainage ${chainageCell(conflict)} ${unitSymbol}${after(sideOfPlace(conflict))}`],
    conflict.station_from !== undefined && ["Station", `${stationsCell(conflict)} m`],
    conflict.obstacle_chainage !== null && ["Obstacle", `stands at chainage ${placeWords(conflict.obstacle_chainage)}`],
    conflict.body !== undefined && ["Body", conflict.body],
    ["Place", coordinates(placeOfTable(conflict))],
    offsetWords(conflict) && ["Offset", offsetWords(conflict)],
    ["Distance", known ? `${words.symbol} ${words.name}: ${detailedDistance(conflict)}`
        : `closer than ${shortLength(query.radius)}; run with --clearance to know it`],
    known && ["Missing", missingWords(conflict.encroachment, conflict.least_distance, conflict.encroachment_is) ||
        "nothing, but with the errors it may be too close"],
    conflict.points_inside > 0 && ["Inside", `${count(conflict.points_inside)} of its points`],
    (conflict.depth_source ?? null) !== null && ["Depth", `${metres(conflict.depth)} to the nearest free point, an estimate`],
    conflict.remedy && ["Remedy", conflict.remedy],
    page.facts.shifts && ["Frees it", freedWords(conflict)],
    conflict.classified && ["Classes", conflict.classified],
    ["Points", `${count(conflict.points)} in ${sizeCell(conflict)} ${unitSymbol}`],
    ["Poses", `${count(conflict.first_pose)} to ${count(conflict.last_pose)}${nearestPoseWords(conflict)}`]);
}

/** The three pictures, drawn at once. width: of each in pixels. */
function conflictPictures(conflict, width) {
  return make("div", { class: "pictures" }, kKinds.map(([kind, title, what]) => {
    const text = kind === "section" ? `${sliceWords(conflict)} ${what}` : what;
    const canvas = make("canvas", { width, height: Math.round(width * 0.75), role: "img",
                                    "data-kind": kind,
                                    "aria-label": `Conflict ${conflict.id}, ${title}` });
    drawConflict(canvas, conflict, kind);
    return make("figure", {}, canvas, make("figcaption", {}, make("strong", {}, `${title}.`),
                                           make("span", { class: "what" }, ` ${text}`)));
  }));
}

/** The conflict before or after the chosen one, as the table is sorted; undefined at an end. */
function neighbourConflict(by) {
  const order = sortedConflicts(tableColumns());
  return order[order.indexOf(page.conflict) + by];
}

function neighbourButton(label, by) {
  return button(label, () => selectConflict(neighbourConflict(by)),
                { disabled: !neighbourConflict(by) });
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
         neighbourButton("Previous", -1), neighbourButton("Next", 1),
         button("Show in 3-D", () => showInView(poseOf(conflict), flyToConflict))),
    make("div", { class: "details" }, conflictFacts(conflict),
         conflictPictures(conflict, innerWidth > 1800 ? 880 : 640)));
  const buttons = [...holder.querySelectorAll("button:not(:disabled)")];
  if (focused) (buttons.find((again) => again.textContent === focused) ?? buttons[0])?.focus();
}

function buildDetails() {
  on("conflict", drawDetails);
}
