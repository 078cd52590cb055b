// What stops the load, place by place and stretch by stretch, and the widths as a table.

/** The class of a point in words, and its number. */
const classWords = ({ class: number, class_name: name }) => number > 0 ? `class ${number} (${name})` : "";

function obstacleWords({ obstacle, witness }) {
  if (!witness) return obstacle;
  const point = `point ${count(witness.source)} at ${coordinates(witness.xyz)}`;
  return [obstacle, classWords(witness), point].filter(Boolean).join(", ");
}

/** How far something reaches into the load or its margin, rounded up. */
const depthCell = (depth) => depth < 0.0005 ? "< 0.001" : (Math.ceil(depth * 1000 - 1e-6) / 1000).toFixed(3);

/** Columns with a cell for each intrusion. */
function stopColumns() {
  const known = section.facts.check.stops.some((stop) => stop.intrusions.some((i) => i.witness));
  return columnsOf([
    ["Side", (i) => i.side],
    [`Too far (${unitSymbol})`, (i) => depthCell(i.depth), "number"],
    [`Deepest at chainage (${unitSymbol})`, (i) => i.chainage.toFixed(2), "number"],
    ["Pose", (i) => String(i.first_pose), "number"],
    [`y (${unitSymbol})`, (i) => `${signed(i.y_from)} – ${signed(i.y_to)}`, "number"],
    [`z (${unitSymbol})`, (i) => `${signed(i.z_from)} – ${signed(i.z_to)}`, "number"],
    ["Cells", (i) => count(i.cells), "number"],
    known && ["What is there", obstacleWords],
  ]);
}

function stopRows(stop, number, columns) {
  const index = sectionBins().indexOf(stop.bin), rows = stop.intrusions.length;
  const show = () => showStretch(stop.bin);
  const whole = (text) => make("td", { class: "number", rowspan: rows + 1 }, text);
  return [...stop.intrusions.map((intrusion, i) => make("tr",
      { ...chosenBy(show), tabindex: i === 0 ? 0 : null, "data-stop": number },
      i === 0 && [whole(String(number)), whole(rangeWords(stretchRange(index)))], cellsOf(columns, intrusion))),
      make("tr", { class: "remedy", onclick: show }, make("td", { colspan: columns.length }, `${stop.remedy}.`,
          stop.obstacles.length > 0 ? ` There: ${stop.obstacles.join(", ")}.` : ""))];
}

/** Numbers such as "1 – 4, 6". */
function numberRanges(numbers) {
  const out = [];
  for (const n of numbers) {
    const last = out.at(-1);
    if (last && last[1] === n - 1) last[1] = n; else out.push([n, n]);
  }
  return out.map(([a, b]) => a === b ? String(a) : `${a} – ${b}`).join(", ");
}

const kShownPlaces = 24, kShownStretches = 12;

/** What stops the load, place by place, deepest first, with what would free it. */
function placesTable() {
  const { places, loads } = section.facts.check, known = places.some((p) => p.obstacle || p.witness || othersAt(p));
  const columns = columnsOf([
    ["", ({ label }) => label],
    ["Side", ({ side }) => side],
    [`Too far (${unitSymbol})`, ({ depth }) => depthCell(depth), "number"],
    [`Chainage (${unitSymbol})`, (p) => rangeWords([p.chainage_from, p.chainage_to]), "number"],
    ["Stretches", ({ stops }) => numberRanges(stops)],
    [`Deepest at (${unitSymbol})`, ({ chainage }) => chainage.toFixed(2), "number"],
    [`z (${unitSymbol})`, (p) => `${signed(p.z_from)} – ${signed(p.z_to)}`, "number"],
    loads.length > 1 && ["Outline", ({ load }) => loads[load].outline_name],
    known && ["What is there", (p) => [obstacleWords(p), othersAt(p)].filter(Boolean).join("; "), "text"],
    ["What lets the load pass", ({ remedy }) => remedy, "text"],
  ]);
  const table = (part) => itemTable("Places that stop the load", columns, part, (place) =>
      ({ ...chosenBy(() => showStretch(section.facts.check.stops[deepestStop(place)].bin)), "data-place": place.label }), "tall");
  return make("div", {}, make("h3", {}, "By place"), table(places.slice(0, kShownPlaces)),
      folded(`${plural(places.length - kShownPlaces, "place")} less deep`, places.length > kShownPlaces && table(places.slice(kShownPlaces))));
}

/** Other named obstacles of the stretches of a place. */
function othersAt({ stops, obstacle }) {
  const names = new Set(stops.flatMap((n) => section.facts.check.stops[n - 1].obstacles));
  names.delete(obstacle);
  return names.size > 0 ? `in these stretches: ${[...names].join(", ")}` : "";
}

/** The index of the stop in which a place is deepest. */
function deepestStop({ stops, side, depth }) {
  const all = section.facts.check.stops;
  return stops.map((n) => n - 1).find((i) => all[i].intrusions.some((one) => one.side === side && one.depth === depth)) ?? stops[0] - 1;
}

function showStretch(bin) {
  chooseStretch(sectionBins().indexOf(bin));
  byId("section").scrollIntoView();
}

/** What is long and seldom read, behind a title. */
const folded = (title, content) => content && make("details", {}, make("summary", {}, title), content);

function buildStops() {
  const { check } = section.facts;
  if (!check || check.stops.length === 0) {
    removePart("stops");
    return;
  }
  const columns = stopColumns(), { stops, places } = check;
  byId("stops-note").append(make("p", {}, `${plural(places.length, "place")}, in ${plural(stops.length, "stretch", "stretches")} of ${sectionBins().length} ` +
      "that the load passes. What reaches in on one side in stretches one after the other is one place. " +
      "A long load meets one obstacle in many stretches, as it passes it from its front to its rear. " +
      "Too far is how much of the load and its margin it takes. y is to the left of the path, and z above it."));
  byId("stops-places").append(placesTable());
  const titles = columnsOf([["No."], [`Chainage (${unitSymbol})`], ...columns.map(({ title }) => [title])]);
  const table = scrollBox("tall",
      listTable("Stretches that stop the load", titles, stops.flatMap((stop, i) => stopRows(stop, i + 1, columns))));
  byId("stops-table").append(...(stops.length > kShownStretches
      ? [folded(`By stretch: ${count(stops.length)} stretches, each with what lets the load pass there`, table)]
      : [make("h3", {}, "By stretch"), table]));
}

/** Widths of the whole path, for each height and from the base up to it. */
function buildWidths() {
  const { bands, boxes } = section.facts, side = (v) => v === null ? "open" : v.toFixed(2);
  const wide = (v) => v === null ? "open" : (Math.floor(v * 100 + 1e-6) / 100).toFixed(2);
  const below = bands.length - boxes.length, base = boxes[0].z_from;
  const wideFrom = (box) => box ? wide(box.symmetric_width) : "";
  const columns = columnsOf([
    [`Height (${unitSymbol})`, ({ z_from, z_to }) => rangeWords([z_from, z_to])],
    ["Left", ({ left }) => side(left)], ["Right", ({ right }) => side(right)],
    ["Symmetric width", (band) => wide(band.symmetric_width)],
    [`Width from z = ${fixed(base, 2)} up to here`, (band) => wideFrom(boxes[bands.indexOf(band) - below])],
  ].map((column) => [...column, "number"]));
  byId("widths-table").append(
      make("p", {}, `Left and right run from y = 0 to the border of the nearest blocked cell, anywhere on the path. The symmetric width ` +
           `has room for rounding taken off. The last column is for a load that stands at z = ${fixed(base, 2)} ${unitSymbol}` +
           `${below > 0 ? ", the lowest height at which the middle is free." : "."}`),
      itemTable("Widths", columns, bands, undefined, "tall"));
}
