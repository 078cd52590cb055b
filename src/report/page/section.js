// The cross-section of the route: the picture of the whole path or of one stretch, and the room at the cursor.

/** What the page knows of the section, and what is shown of it. */
const section = {
  facts: page.facts.section ?? null,
  chainage: null,             // of each pose of the path
  first: null,                // first pose of each blocked cell of the whole path, row by row
  whole: null, stops: null,   // bits of the window's cells
  cells: null, unknown: null, // the same for each stretch, one after the other
  left: null, right: null, left_pose: null, right_pose: null,  // for each stretch and, last, the whole path: bands
  chosen: null,               // which of the stretches is shown: an index, or null for the whole path
  shown: undefined,           // the same with what the pointer is over
  band: 0,                    // the band of height that the cursor is in
};

async function readSection() {
  if (!section.facts) return;
  const { chainage, ...columns } = await readIntegers("section", ["chainage", "first", "left", "right", "left_pose", "right_pose"]);
  Object.assign(section, columns, { chainage: Float64Array.from(chainage ?? [], (at) => at / 1000) });
  [section.whole, section.stops, section.cells, section.unknown] = await Promise.all(
      ["whole", "stops", "cells", "unknown"].map((name) => columnBytes(`section.${name}`)));
}

const sectionBins = () => section.facts.bins;
const bytesOfWindow = () => section.facts.columns * section.facts.rows + 7 >> 3;
const isSet = (bits, i) => bits[i >> 3] >> (i & 7) & 1;

/** The bits of one stretch. */
const bitsOf = (bits, index) => bits && bits.subarray(index * bytesOfWindow(), (index + 1) * bytesOfWindow());

/** From where to where a stretch reaches along the path. */
function stretchRange(index) {
  const { bin, length } = section.facts, from = sectionBins()[index] * bin;
  return [from, Math.min(from + bin, Math.max(length, from))];
}

const rangeWords = ([from, to], digits = 2) => `${from.toFixed(digits)} – ${to.toFixed(digits)} ${unitSymbol}`;

/** The cells that are set as a path, in cells from the window's corner; both: only where this is set, too. */
function pathOfCells(bits, both) {
  const { columns, rows } = section.facts, parts = [];
  for (let row = 0; row < rows; ++row) {
    const first = row * columns;
    for (let column = 0; column < columns; ++column) {
      if ((first + column & 7) === 0 && column + 8 <= columns && bits[first + column >> 3] === 0) {
        column += 7;
        continue;
      }
      const begin = column;
      while (column < columns && isSet(bits, first + column) && (!both || isSet(both, first + column))) ++column;
      if (column > begin) parts.push(`M${begin} ${row}h${column - begin}v1h-${column - begin}z`);
    }
  }
  return parts.join("");
}

/** The colour of a place of the path. */
function colourAt(chainage) {
  const { colours, length } = section.facts;
  return colours[length > 0 ? clamp(Math.floor(chainage / length * colours.length), 0, colours.length - 1) : 0];
}

/** The picture as a chart of y, which grows to the left, and z. */
function sectionChart() {
  const svg = byId("section-svg"), { columns, rows, cell, j_from, k_from } = section.facts, { width, height } = svg.viewBox.baseVal;
  const [left, top, scale] = ["left", "top", "scale"].map((name) => +svg.dataset[name]);
  return Object.assign(new Chart(height - top - rows * scale), {
    width, height, left, top, right: width - left - columns * scale,
    from: (j_from + columns) * cell, to: j_from * cell, low: k_from * cell, high: (k_from + rows) * cell });
}

function stretchCells(index) {
  const { transform } = byId("section-cells").attributes, bits = bitsOf(section.cells, index);
  const unknown = bitsOf(section.unknown, index);
  return make("g", { id: "section-stretch", "shape-rendering": "crispEdges", transform: transform.value },
      unknown && make("path", { class: "unknown", fill: "url(#section_unknown)", d: pathOfCells(unknown) }),
      make("path", { fill: colourAt(stretchRange(index)[0]), d: pathOfCells(bits) }),
      section.stops && make("path", { class: "stops", fill: "url(#section_stops)", d: pathOfCells(bits, stopsOf(index)) }));
}

/** The rows of a table of outlines that judge a stretch; none where one outline is judged everywhere. */
function rowsOf(index) {
  const bin = sectionBins()[index];
  return section.facts.check.rows.filter(({ bins }) => bins && bins[0] <= bin && bin <= bins[1]);
}

/** The indices of the loads that are judged on a stretch. */
const loadsOf = (index) => section.facts.check.rows.length > 0 ? [...new Set(rowsOf(index).map(({ load }) => load))] : [0];

/** The bits of the cells that stop the loads of a stretch. */
function stopsOf(index) {
  if (section.facts.check.loads.length === 1) return loadsOf(index).length > 0 ? section.stops : new Uint8Array(bytesOfWindow());
  const out = new Uint8Array(bytesOfWindow());
  for (const load of loadsOf(index)) bitsOf(section.stops, load + 1).forEach((byte, i) => { out[i] |= byte; });
  return out;
}

/** Which outlines of a table are judged on a stretch, in words. */
function outlineWords(index) {
  const { rows, loads } = section.facts.check;
  if (rows.length === 0) return "";
  const names = loadsOf(index).map((load) => `${loads[load].outline_name} with a margin of ${shortLength(loads[load].margin)}`);
  return names.length > 0 ? `, ${names.join(" and ")}` : "";
}

/** Whether a part of a stretch has no outline. */
const isInGap = (index) => section.facts.check.gaps.some(({ bins }) => bins[0] <= sectionBins()[index] && sectionBins()[index] <= bins[1]);

/** Shows the outlines of a stretch, or with null all of them. */
function drawLoads(index) {
  const shown = index === null || !section.facts.check ? null : loadsOf(index);
  for (const load of byId("section-svg").querySelectorAll(".section_load")) {
    load.style.display = shown === null || shown.includes(+load.dataset.load) ? "" : "none";
  }
}

/** The deepest places of the intrusions of one stretch, with how deep they are. */
function stretchMarks(index) {
  const chart = sectionChart(), { cell } = section.facts;
  return make("g", { id: "section-stretch-marks" }, stopsOfStretch(index).flatMap(({ intrusions }) => intrusions).map((intrusion) => {
    const x = chart.x((intrusion.cell[0] + 0.5) * cell), y = chart.y((intrusion.cell[1] + 0.5) * cell);
    const label = `${intrusion.depth.toFixed(2)} ${unitSymbol}${intrusion.obstacle ? `, ${intrusion.obstacle}` : ""}`;
    const right = x < chart.left + chart.wide / 2;
    return [make("circle", { cx: x, cy: y, r: 4, fill: "#fff", stroke: "#111827", "stroke-width": 2 }),
            make("text", { x: x + (right ? 9 : -9), y: y - 7, class: `strong halo ${right ? "" : "end"}` }, label)];
  }));
}

const stopsOfStretch = (index) => (section.facts.check?.stops ?? []).filter((stop) => stop.bin === sectionBins()[index]);

/** Shows a stretch, or with null the whole path, in the picture. */
function drawStretch(index) {
  if (index === section.shown) return;
  section.shown = index;
  for (const id of ["section-stretch", "section-stretch-marks"]) byId(id)?.remove();
  const whole = index === null || !section.cells;
  byId("section-cells").style.display = whole ? "" : "none";
  byId("section-marks").style.display = whole ? "" : "none";
  if (!whole) {
    byId("section-cells").after(stretchCells(index));
    byId("section-marks").after(stretchMarks(index));
  }
  drawLoads(whole ? null : index);
  byId("section-title").textContent = pictureTitle(index);
  byId("section-whole").disabled = section.chosen === null;
  drawRoom();
}

function pictureTitle(index) {
  if (index === null) return "The whole path: a cell shows where on the path it is blocked first.";
  if (!section.cells) return "The section is so large that the page has the picture of the whole path alone.";
  const range = `Chainage ${rangeWords(stretchRange(index))}`;
  if (!section.facts.check) return `${range}.`;
  const stops = stopsOfStretch(index), judged = `${range}${outlineWords(index)}`;
  const gap = isInGap(index) ? " A part of it has no outline in the table." : "";
  if (loadsOf(index).length === 0) return `${range}: the table has no outline here.`;
  return stops.length > 0 ? `${judged}: stops the load. ${stops.map(({ remedy }) => remedy).join(". ")}.${gap}`
      : `${judged}: nothing stops the load here.${gap}`;
}

function chooseStretch(index) {
  section.chosen = index;
  drawStretch(index);
  notify("stretch");
}

/** Widths in a band: {left, right, width} in lengths or null where open, and the poses that block. */
function roomAt(index, band) {
  const { bands, cell, kept, j_from, columns } = section.facts, at = (index ?? sectionBins().length) * bands.length + band;
  const length = (cells) => cells < 0 ? null : cells * cell;
  const left = length(section.left[at]), right = length(section.right[at]);
  const least = Math.min(left ?? (j_from + columns) * cell, right ?? -j_from * cell);
  return { left, right, width: left === null && right === null ? null : Math.max(0, 2 * least - 2 * kept),
           leftPose: section.left_pose[at], rightPose: section.right_pose[at] };
}

const poseWords = (pose) => `pose ${count(pose)} at chainage ${station(section.chainage[pose])}`;

function sideRoom(name, room, pose) {
  return room === null ? `${name} open up to the window` : `${name} ${metres(room, 2)} (${poseWords(pose)})`;
}

function roomWords(index, band) {
  const { left, right, width, leftPose, rightPose } = roomAt(index, band), { z_from, z_to } = section.facts.bands[band];
  const where = index === null ? "Whole path" : `Chainage ${rangeWords(stretchRange(index))}`;
  const wide = width === null ? "width open" : `width ${metres(width, 2)}`;
  return `${where}, z = ${z_from.toFixed(2)} – ${z_to.toFixed(2)} ${unitSymbol}: ` +
      `${sideRoom("left", left, leftPose)}, ${sideRoom("right", right, rightPose)}, ${wide}`;
}

/** The line in the picture with the widths to both sides at the cursor's height. */
function drawRoom() {
  byId("section-room")?.remove();
  const chart = sectionChart(), { z_from, z_to } = section.facts.bands[section.band];
  const { left, right } = roomAt(section.shown ?? null, section.band);
  const y = chart.y((z_from + z_to) / 2), x1 = left === null ? chart.left : chart.x(left);
  const x2 = right === null ? chart.left + chart.wide : chart.x(-right), x0 = chart.x(0);
  const words = (x, room) => make("text", { x, y: y - 6, class: "middle strong halo" },
                                  room === null ? "open" : `${room.toFixed(2)} ${unitSymbol}`);
  const end = (x) => make("line", { x1: x, x2: x, y1: y - 6, y2: y + 6, stroke: "#00735c", "stroke-width": 2.5 });
  byId("section-svg").append(make("g", { id: "section-room", "pointer-events": "none" },
      make("line", { x1, x2, y1: y, y2: y, stroke: "#fff", "stroke-width": 5, "stroke-opacity": 0.8 }),
      make("line", { x1, x2, y1: y, y2: y, stroke: "#00735c", "stroke-width": 2 }), end(x1), end(x2),
      words(Math.min(x0 - 26, (x0 + x1) / 2), left), words(Math.max(x0 + 26, (x0 + x2) / 2), right)));
  byId("section-readout").textContent = `${roomWords(section.shown ?? null, section.band)}.`;
}

/** The first pose that blocks a cell of the whole path; null where nothing does. */
function firstPoseAt(i) {
  if (!isSet(section.whole, i)) return null;
  let before = 0;
  for (let byte = 0; byte < i >> 3; ++byte) for (let b = section.whole[byte]; b; b &= b - 1) ++before;
  for (let at = i & ~7; at < i; ++at) before += isSet(section.whole, at);
  return section.first[before];
}

/** What is in the cell under the pointer, and the widths at its height. */
function readPicture(event) {
  const [y, z] = sectionChart().at(byId("section-svg"), event);
  const { cell, j_from, k_from, columns, rows, bands } = section.facts;
  const column = Math.floor(y / cell) - j_from, row = Math.floor(z / cell) - k_from;
  if (column < 0 || row < 0 || column >= columns || row >= rows) return;
  const band = bands.findIndex((b) => z >= b.z_from && z < b.z_to);
  if (band >= 0) section.band = band;
  drawRoom();
  const i = row * columns + column, shown = section.shown ?? null;
  const blocked = isSet(shown === null || !section.cells ? section.whole : bitsOf(section.cells, shown), i);
  const unknown = section.unknown && shown !== null && isSet(bitsOf(section.unknown, shown), i);
  const what = blocked ? `blocked${shown === null ? ` first by ${poseWords(firstPoseAt(i))}` : ""}`
      : unknown ? "not known" : "no point";
  byId("section-readout").textContent += ` Here y = ${signed(y)}, z = ${signed(z)}: ${what}.`;
  notify("stretch");
}

function buildSection() {
  if (!section.facts) {
    removePart("section");
    return;
  }
  byId("section-caution").textContent = `${section.facts.caution}. Looking forward, left is left.`;
  byId("section-tools").append(
      button("Whole path", () => chooseStretch(null), { id: "section-whole" }), ...mapTools(),
      make("span", { class: "hint" }, "Click the map to see a stretch. Arrow keys move the cursor, Escape shows the whole path."));
  section.band = Math.max(0, section.facts.bands.findIndex((b) => b.z_to > 1));
  drawMap();
  drawStretch(null);
  byId("section-svg").addEventListener("pointermove", readPicture);
  on("stretch", placeMapCursor);
}
