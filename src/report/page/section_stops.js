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

/** Title, cell of an intrusion, whether it is a number. */
function stopColumns() {
  const known = section.facts.check.stops.some((stop) => stop.intrusions.some((i) => i.witness));
  return [
    ["Side", (i) => kSideWords[i.side], false],
    [`Too far (${unitSymbol})`, (i) => depthCell(i.depth), true],
    [`Deepest at chainage (${unitSymbol})`, (i) => i.chainage.toFixed(2), true],
    ["Pose", (i) => String(i.first_pose), true],
    [`y (${unitSymbol})`, (i) => `${signed(i.y_from)} – ${signed(i.y_to)}`, true],
    [`z (${unitSymbol})`, (i) => `${signed(i.z_from)} – ${signed(i.z_to)}`, true],
    ["Cells", (i) => count(i.cells), true],
    known && ["What is there", obstacleWords, false],
  ].filter(Boolean);
}

function stopRows(stop, number, columns) {
  const index = sectionBins().indexOf(stop.bin), rows = stop.intrusions.length;
  const show = () => {
    chooseStretch(index);
    byId("section").scrollIntoView();
  };
  const cells = [...stop.intrusions.map((intrusion, i) => make("tr", { tabindex: i === 0 ? 0 : null, "data-stop": number, onclick: show,
      onkeydown: (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        show();
      } },
      i === 0 && [make("td", { class: "number", rowspan: rows + 1 }, String(number)),
                  make("td", { class: "number", rowspan: rows + 1 }, rangeWords(stretchRange(index)))],
      columns.map(([, cell, isNumber]) => make("td", { class: isNumber ? "number" : null }, cell(intrusion))))),
      make("tr", { class: "remedy", onclick: show }, make("td", { colspan: columns.length }, `${stop.remedy}.`,
          stop.obstacles.length > 0 ? ` There: ${stop.obstacles.join(", ")}.` : ""))];
  return cells;
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
  return make("div", {}, make("h3", {}, "By obstacle"), make("div", { class: "scroll" },
      make("table", { class: "list", "aria-label": "Obstacles" },
          make("thead", {}, make("tr", {}, ["Obstacle", "Stops the load in stretches", "Where it is deepest"].map((title) =>
              make("th", { scope: "col" }, title)))),
          make("tbody", {}, named.map(({ name, stops, deepest }) => make("tr", {}, make("td", {}, name),
              make("td", {}, numberRanges(stops)),
              make("td", {}, deepest ? `${depthCell(deepest.depth)} ${unitSymbol} too far, ${kSideWords[deepest.side]}, at chainage ` +
                   `${station(deepest.chainage)}, z = ${signed(deepest.z_from)} to ${signed(deepest.z_to)} ${unitSymbol}`
                   : "others reach deeper there")))))));
}

function buildStops() {
  const { check } = section.facts;
  if (!check || check.stops.length === 0) {
    byId("stops").remove();
    document.querySelector('nav a[href="#stops"]').remove();
    return;
  }
  const columns = stopColumns();
  byId("stops-note").append(make("p", {}, `${plural(check.stops.length, "stretch", "stretches")} of ${sectionBins().length} ` +
      `with a pose of the load. A long load meets one obstacle in many stretches, as it passes it from its front to its rear. ` +
      "Too far is how much of the load and its margin it takes. Below each stretch stands what lets the load pass there. " +
      "y is to the left of the path, and z above it."));
  byId("stops-obstacles").append(obstaclesTable());
  byId("stops-table").append(make("h3", {}, "By stretch"), make("div", { class: "scroll tall" },
      make("table", { class: "list", "aria-label": "Stretches that stop the load" },
          make("thead", {}, make("tr", {}, ["No.", `Chainage (${unitSymbol})`, ...columns.map(([title]) => title)]
              .map((title) => make("th", { scope: "col" }, title)))),
          make("tbody", {}, check.stops.flatMap((stop, i) => stopRows(stop, i + 1, columns))))));
}

/** Widths of the whole path, for each height and from the base up to it. */
function buildWidths() {
  const { bands, boxes } = section.facts, side = (v) => v === null ? "open" : v.toFixed(2);
  const wide = (v) => v === null ? "open" : (Math.floor(v * 100 + 1e-6) / 100).toFixed(2);
  byId("widths-table").append(
      make("p", {}, `Left and right run from y = 0 to the border of the nearest blocked cell, anywhere on the path. The symmetric width ` +
           "has room for rounding taken off. The last column is for a load that stands on the first height."),
      make("div", { class: "scroll tall" }, make("table", { class: "list", "aria-label": "Widths" },
          make("thead", {}, make("tr", {}, [`Height (${unitSymbol})`, "Left", "Right", "Symmetric width", "Width from the base up to here"]
              .map((title) => make("th", { scope: "col", class: "number" }, title)))),
          make("tbody", {}, bands.map((band, i) => make("tr", {}, [rangeWords([band.z_from, band.z_to]), side(band.left), side(band.right),
              wide(band.symmetric_width), wide(boxes[i].symmetric_width)].map((text) => make("td", { class: "number" }, text))))))));
}
