// What stops the load, stretch by stretch and obstacle by obstacle, and the widths as a table.

const kSideWords = { left: "left", right: "right", above: "above", below: "below" };

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
  return [
    { title: "Side", cell: (i) => kSideWords[i.side] },
    { title: `Too far (${unitSymbol})`, cell: (i) => depthCell(i.depth), number: true },
    { title: `Deepest at chainage (${unitSymbol})`, cell: (i) => i.chainage.toFixed(2), number: true },
    { title: "Pose", cell: (i) => String(i.first_pose), number: true },
    { title: `y (${unitSymbol})`, cell: (i) => `${signed(i.y_from)} – ${signed(i.y_to)}`, number: true },
    { title: `z (${unitSymbol})`, cell: (i) => `${signed(i.z_from)} – ${signed(i.z_to)}`, number: true },
    { title: "Cells", cell: (i) => count(i.cells), number: true },
    known && { title: "What is there", cell: obstacleWords },
  ].filter(Boolean);
}

function stopRows(stop, number, columns) {
  const index = sectionBins().indexOf(stop.bin), rows = stop.intrusions.length;
  const show = () => {
    chooseStretch(index);
    byId("section").scrollIntoView();
  };
  const whole = (text) => make("td", { class: "number", rowspan: rows + 1 }, text);
  return [...stop.intrusions.map((intrusion, i) => make("tr",
      { ...chosenBy(show), tabindex: i === 0 ? 0 : null, "data-stop": number },
      i === 0 && [whole(String(number)), whole(rangeWords(stretchRange(index)))], cellsOf(columns, intrusion))),
      make("tr", { class: "remedy", onclick: show }, make("td", { colspan: columns.length }, `${stop.remedy}.`,
          stop.obstacles.length > 0 ? ` There: ${stop.obstacles.join(", ")}.` : ""))];
}

/** Named obstacles with the stretches that they stop, deepest first. */
function namedObstacles() {
  const found = new Map();
  section.facts.check.stops.forEach((stop, i) => {
    for (const name of stop.obstacles) {
      if (!found.has(name)) found.set(name, { name, stops: [], deepest: null });
      found.get(name).stops.push(i + 1);
    }
    for (const intrusion of stop.intrusions) {
      const of = found.get(intrusion.obstacle);
      if (of && (!of.deepest || intrusion.depth > of.deepest.depth)) of.deepest = intrusion;
    }
  });
  return [...found.values()].sort((a, b) => (b.deepest?.depth ?? 0) - (a.deepest?.depth ?? 0) || b.stops.length - a.stops.length);
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

function obstaclesTable() {
  const named = namedObstacles();
  if (named.length === 0) return "";
  const columns = [
    { title: "Obstacle", cell: ({ name }) => name },
    { title: "Stops the load in stretches", cell: ({ stops }) => numberRanges(stops) },
    { title: "Where it is deepest", cell: ({ deepest }) => deepest
        ? `${depthCell(deepest.depth)} ${unitSymbol} too far, ${kSideWords[deepest.side]}, at chainage ` +
          `${station(deepest.chainage)}, z = ${signed(deepest.z_from)} to ${signed(deepest.z_to)} ${unitSymbol}`
        : "others reach deeper there" }];
  return make("div", {}, make("h3", {}, "By obstacle"), make("div", { class: "scroll" },
      listTable("Obstacles", columns, named.map((one) => make("tr", {}, cellsOf(columns, one))))));
}

function buildStops() {
  const { check } = section.facts;
  if (!check || check.stops.length === 0) {
    removePart("stops");
    return;
  }
  const columns = stopColumns();
  byId("stops-note").append(make("p", {}, `${plural(check.stops.length, "stretch", "stretches")} of ${sectionBins().length} ` +
      `with a pose of the load. A long load meets one obstacle in many stretches, as it passes it from its front to its rear. ` +
      "Too far is how much of the load and its margin it takes. Below each stretch stands what lets the load pass there. " +
      "y is to the left of the path, and z above it."));
  byId("stops-obstacles").append(obstaclesTable());
  const titles = [{ title: "No." }, { title: `Chainage (${unitSymbol})` }, ...columns.map(({ title }) => ({ title }))];
  byId("stops-table").append(make("h3", {}, "By stretch"), make("div", { class: "scroll tall" },
      listTable("Stretches that stop the load", titles, check.stops.flatMap((stop, i) => stopRows(stop, i + 1, columns)))));
}

/** Widths of the whole path, for each height and from the base up to it. */
function buildWidths() {
  const { bands, boxes } = section.facts, side = (v) => v === null ? "open" : v.toFixed(2);
  const wide = (v) => v === null ? "open" : (Math.floor(v * 100 + 1e-6) / 100).toFixed(2);
  const columns = [
    [`Height (${unitSymbol})`, ({ z_from, z_to }) => rangeWords([z_from, z_to])],
    ["Left", ({ left }) => side(left)], ["Right", ({ right }) => side(right)],
    ["Symmetric width", (band) => wide(band.symmetric_width)],
    ["Width from the base up to here", (band) => wide(boxes[bands.indexOf(band)].symmetric_width)],
  ].map(([title, cell]) => ({ title, cell, number: true }));
  byId("widths-table").append(
      make("p", {}, `Left and right run from y = 0 to the border of the nearest blocked cell, anywhere on the path. The symmetric width ` +
           "has room for rounding taken off. The last column is for a load that stands on the first height."),
      make("div", { class: "scroll tall" },
           listTable("Widths", columns, bands.map((band) => make("tr", {}, cellsOf(columns, band))))));
}
