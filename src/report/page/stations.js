// The path stretch by stretch: distances to both sides and above, overthrow, verdict.

/** Above so many stretches the table begins folded. */
const kUnfoldedRows = 40;
/** Of more bodies the table shows the greatest overthrow, with the body's name. */
const kBodyColumns = 2;

/** Told apart by shape and word, so that they read in grey. */
const kRowVerdicts = { conflict: "◆ conflict", undecided: "○ undecided", clear: "● clear" };
const kRowReasons = { near: "possibly too close", few: "few points", "not-scanned": "not scanned",
                       "errors-exceed-margin": "errors too large",
                       "question-in-doubt": "the question is in doubt" };

function rowVerdict(row) {
  const why = row.verdict !== "undecided" ? []
      : [...row.reasons.map((r) => (kRowReasons[r] ?? r) +
             (r === "question-in-doubt" ? ` (${row.doubts.join(", ")})` : "")),
         ...(row.searched ? [] : ["not searched"])];
  return kRowVerdicts[row.verdict] + (why.length > 0 ? `: ${why.join(", ")}` : "");
}

/** The greatest overthrow of all bodies, with the name of the body that has it. */
function greatestOverthrow(row, what) {
  const values = row.overthrow.map((body) => body[what]);
  const known = values.filter((v) => v !== null);
  if (known.length === 0) return "";
  const most = Math.max(...known);
  return `${overthrowCell(most)} ${page.facts.stations.bodies[values.indexOf(most)]}`.trim();
}

/** Without "−0.000". */
const overthrowCell = (v) => v === null ? "" : (Math.abs(v) < 0.0005 ? 0 : v).toFixed(3).replace("-", "−");

function stationColumns() {
  const { list, bodies } = page.facts.stations;
  const places = ["least", "left", "right", "above"].filter((k) => list.some((r) => r[k] !== null) ||
      (k === "least" && list.some((r) => r.least_below !== null || r.least_above !== null)));
  const digits = digitsFor(list.flatMap((r) => places.map((k) => r[k])));
  const limit = (r) => r.least_below !== null ? `< ${+r.least_below.toPrecision(4)}`
      : r.least_above !== null ? `> ${+r.least_above.toPrecision(4)}` : "";
  const distance = (key) => (r) => r[key] === null ? (key === "least" ? limit(r) : "")
      : isInside(r[key]) ? `inside, ${fixed(-r[key], digits)}` : fixed(r[key], digits);
  const columns = [[`Chainage (${unitSymbol})`, chainageCell]];
  if (list.some((r) => r.station_from !== undefined)) columns.push(["Station (m)", stationsCell]);
  columns.push(...places.map((key) => [`${capital(key)} (${unitSymbol})`, distance(key)]));
  for (const [what, name] of [["end", "Overthrow of the ends"], ["middle", "of the middle"]]) {
    if (!list.some((r) => r.overthrow.some((body) => body[what] !== null))) continue;
    if (bodies.length > kBodyColumns) {
      columns.push([`${name} (${unitSymbol})`, (r) => greatestOverthrow(r, what)]);
      continue;
    }
    bodies.forEach((body, b) => columns.push([
      `${body ? `${body}: ` : ""}${name} (${unitSymbol})`, (r) => overthrowCell(r.overthrow[b][what])]));
  }
  return columnsOf([...columns.map((column) => [...column, "number"]), ["Verdict", rowVerdict]]);
}

/** To the pose where the stretch has its nearest point, or else to its begin. */
function showStretch(row) {
  selectPose(row.least_pose === null ? poseAtChainage(row.chainage_from) : shownPose(row.least_pose));
}

function stationsNote() {
  const { list, every, notes } = page.facts.stations;
  const of = (verdict) => list.filter((r) => r.verdict === verdict).length;
  const counts = ["conflict", "undecided", "clear"].map((v) => `${count(of(v))} ${v}`).join(", ");
  const remarks = notes.map((note) => ` ${note}.`).join("");
  return `${plural(list.length, "stretch", "stretches")} of ${shortLength(every)}: ${counts}. The least distance is that of ` +
      "the profile of its poses and of the points that the vehicle is nearest to there; < and > say below or above " +
      "what it is where no more is known. A point counts to the left, to the right or above on the stretch where " +
      "the vehicle is nearest to it, by the box of the body that is nearest. The overthrow is how far the centre line of a body leaves the path in curves: its ends " +
      `outwards, its middle inwards.${remarks}`;
}

function buildStations() {
  const { stations } = page.facts;
  if (!stations || stations.list.length === 0) {
    removePart("stations");
    return;
  }
  byId("stations-note").append(make("p", {}, stationsNote()));
  byId("stations-table").append(make("details", { open: stations.list.length <= kUnfoldedRows ? "" : null },
      make("summary", {}, "The table"),
      itemTable("Stations", stationColumns(), stations.list, (row) =>
          ({ ...chosenBy(() => showStretch(row)), "data-verdict": row.verdict }))));
}

/** All of it on paper; then as it was. */
function unfoldStations(all) {
  const details = document.querySelector("#stations details");
  if (!details) return;
  if (all) details.dataset.open = String(details.open);
  details.open = all || details.dataset.open === "true";
}
