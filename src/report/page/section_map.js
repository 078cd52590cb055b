// Widths along the path: a map of chainage and height, with its cursor.

const sectionMap = { side: "width", width: 1000, height: 300, left: 62, right: 16, top: 26, bottom: 64, over: null };
const kMapSides = { width: "symmetric width", left: "room to the left", right: "room to the right" };
const kMostMapColumns = 2000;

const mapX = (chainage) => sectionMap.left + (sectionMap.width - sectionMap.left - sectionMap.right) *
    (chainage - mapRange()[0]) / (mapRange()[1] - mapRange()[0]);
const mapY = (z) => {
  const { bands } = section.facts, low = bands[0].z_from, high = bands.at(-1).z_to;
  return sectionMap.top + (sectionMap.height - sectionMap.top - sectionMap.bottom) * (high - z) / (high - low);
};

/** The whole path. */
function mapRange() {
  const { length, bin } = section.facts, last = sectionBins().at(-1) ?? 0;
  return [0, Math.max(length, (last + 1) * bin)];
}

/** The width that is white. */
function mapMost() {
  const { columns, cell, j_from } = section.facts;
  const left = (j_from + columns) * cell, right = -j_from * cell;
  return sectionMap.side === "width" ? 2 * Math.min(left, right) : sectionMap.side === "left" ? left : right;
}

/** From dark, where there is no room, to white; grey says the same. */
function mapRgb(room) {
  const share = room === null ? 1 : clamp(room / mapMost(), 0, 1);
  return [[59, 255], [7, 255], [100, 255]].map(([dark, light]) => Math.round(dark + share * (light - dark)));
}

/** The map's picture: a column for each stretch, or for a few of a very long path, which show the least. */
function mapImage() {
  const { bands, bin } = section.facts, bins = sectionBins(), [from, to] = mapRange();
  const columns = Math.min(kMostMapColumns, Math.ceil((to - from) / bin));
  const canvas = new OffscreenCanvas(columns, bands.length), context = canvas.getContext("2d");
  const pixels = context.createImageData(columns, bands.length), least = new Map();
  bins.forEach((number, index) => {
    const column = columns < kMostMapColumns ? number : Math.min(columns - 1, Math.floor(number * bin / (to - from) * columns));
    bands.forEach((_, band) => {
      const room = roomAt(index, band)[sectionMap.side], at = (bands.length - 1 - band) * columns + column;
      if (!least.has(at) || (room ?? Infinity) < (least.get(at) ?? Infinity)) least.set(at, room);
    });
  });
  for (const [at, room] of least) pixels.data.set([...mapRgb(room), 255], 4 * at);
  context.putImageData(pixels, 0, 0);
  return { canvas, to: columns < kMostMapColumns ? columns * bin : to };
}

/** A small picture as an address, without waiting for an encoder. */
function addressOf(offscreen) {
  const canvas = make("canvas", { width: offscreen.width, height: offscreen.height });
  canvas.getContext("2d").drawImage(offscreen, 0, 0);
  return canvas.toDataURL();
}

/** Where the load is stopped, by stretch and height. */
function mapStops() {
  if (!section.stops || !section.cells) return "";
  const { columns, bands, cell, k_from, rows } = section.facts, parts = [];
  for (const stop of section.facts.check.stops) {
    const index = sectionBins().indexOf(stop.bin), bits = bitsOf(section.cells, index), [from, to] = stretchRange(index);
    const stopping = stopsOf(index);
    const stopped = bands.map(({ z_from, z_to }) => {
      const first = clamp(Math.floor(z_from / cell + 1e-6) - k_from, 0, rows);
      const end = clamp(Math.ceil(z_to / cell - 1e-6) - k_from, 0, rows);
      for (let i = first * columns; i < end * columns; ++i) if (isSet(bits, i) && isSet(stopping, i)) return true;
      return false;
    });
    bands.forEach((band, i) => {
      if (!stopped[i] || stopped[i - 1]) return;
      let last = i;
      while (stopped[last + 1]) ++last;
      const x1 = mapX(from), x2 = mapX(to), y1 = mapY(bands[last].z_to), y2 = mapY(band.z_from);
      parts.push(`M${x1.toFixed(1)} ${y1.toFixed(1)}H${x2.toFixed(1)}V${y2.toFixed(1)}H${x1.toFixed(1)}Z`);
    });
  }
  return parts.join("");
}

function mapAxes() {
  const { width, height, left, right, top, bottom } = sectionMap, { bands } = section.facts, out = [];
  for (const z of ticks(bands[0].z_from, bands.at(-1).z_to, 8)) {
    out.push(make("line", { x1: left - 5, x2: left, y1: mapY(z), y2: mapY(z), stroke: "#6b7280" }),
             make("text", { x: left - 8, y: mapY(z) + 4, class: "end" }, String(z).replace("-", "−")));
  }
  for (const c of ticks(...mapRange(), width / 90)) {
    out.push(make("line", { x1: mapX(c), x2: mapX(c), y1: height - bottom, y2: height - bottom + 5, stroke: "#6b7280" }),
             make("text", { x: mapX(c), y: height - bottom + 18, class: "middle" }, String(c)));
  }
  out.push(make("text", { x: width - right, y: height - 4, class: "end" }, `chainage (${unitSymbol})`),
           make("text", { x: left, y: top - 9, class: "strong" }, `height (${unitSymbol}), ${kMapSides[sectionMap.side]}${section.stops ? "; hatched where the load is stopped" : ""}`),
           make("rect", { x: left, y: top, width: width - left - right, height: height - top - bottom, fill: "none", stroke: "#111827" }));
  return out;
}

/** Stretches that stop the load, as numbered bars below the axis. */
function mapBars() {
  const y = sectionMap.height - sectionMap.bottom + 26;
  let free = -Infinity;
  sectionMap.crowded = 0;
  return (section.facts.check?.stops ?? []).map((stop, i) => {
    const index = sectionBins().indexOf(stop.bin), [from, to] = stretchRange(index);
    const x1 = mapX(from), x2 = Math.max(mapX(to), x1 + 2), label = String(i + 1), middle = (x1 + x2) / 2;
    const room = middle - free > 8 * label.length + 8;
    if (room) free = middle; else ++sectionMap.crowded;
    return make("g", { class: "mark", onclick: (event) => { event.stopPropagation(); chooseStretch(index); } },
                make("rect", { x: x1 + 0.5, y, width: Math.max(1, x2 - x1 - 1), height: 9, fill: "#c2410c" }),
                room && make("text", { x: middle, y: y + 22, class: "middle" }, label));
  });
}

function drawMap() {
  const holder = byId("section-map");
  if (sectionBins().length === 0) {
    holder.replaceChildren(make("p", {}, "The load has no pose, so there is no map."));
    return;
  }
  sectionMap.width = clamp(holder.clientWidth || 1000, 520, 1400);
  sectionMap.height = clamp(sectionMap.width * 0.3, 240, 420);
  const { width, height, left, right, top, bottom } = sectionMap, { canvas, to } = mapImage();
  const x2 = mapX(to), inner = { x: left, y: top, height: height - top - bottom };
  const pattern = make("pattern", { id: "section-no-pose", width: 8, height: 8, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" },
                       make("rect", { width: 8, height: 8, fill: "#f3f4f6" }), make("line", { x1: 0, y1: 0, x2: 0, y2: 8, stroke: "#9ca3af", "stroke-width": 2 }));
  const stops = make("pattern", { id: "section-map-stops", width: 9, height: 9, patternUnits: "userSpaceOnUse", patternTransform: "rotate(-45)" },
                     make("line", { x1: 0, y1: 0, x2: 0, y2: 9, stroke: "#fff", "stroke-width": 4 }),
                     make("line", { x1: 0, y1: 0, x2: 0, y2: 9, stroke: "#c2410c", "stroke-width": 2.4 }));
  const svg = make("svg", { viewBox: `0 0 ${width} ${height}`, width, height, tabindex: 0, role: "application", "aria-label":
                            "Widths by chainage and height. Arrow keys move the cursor, Enter shows the stretch, Escape the whole path." },
      make("defs", {}, pattern, stops, make("clipPath", { id: "section-map-inside" },
          make("rect", { ...inner, width: width - left - right }))),
      make("rect", { ...inner, width: width - left - right, fill: "url(#section-no-pose)" }),
      make("image", { ...inner, width: x2 - left, preserveAspectRatio: "none", style: "image-rendering: pixelated",
                      href: addressOf(canvas), "clip-path": "url(#section-map-inside)" }),
      make("path", { d: mapStops(), fill: "url(#section-map-stops)", stroke: "#c2410c", "stroke-width": 1.2 }),
      mapAxes(), mapBars(),
      make("rect", { id: "section-cursor", fill: "none", stroke: "#00735c", "stroke-width": 2.5, "pointer-events": "none" }));
  const focused = holder.contains(document.activeElement);
  holder.replaceChildren(svg, mapScale(), crowdedBars(sectionMap.crowded));
  watchMap(svg);
  if (focused) svg.focus();
  placeMapCursor();
}

/** Five steps of the scale. */
function mapScale() {
  const most = mapMost();
  return make("div", { class: "scale" }, [0, 0.25, 0.5, 0.75, 1].map((share) =>
      make("span", { style: `background:rgb(${mapRgb(share * most).join(",")});color:${share > 0.45 ? "#111827" : "#fff"}` },
           `${(share * most).toFixed(1)} ${unitSymbol}`)));
}

function placeMapCursor() {
  const cursor = byId("section-cursor"), index = section.shown ?? null;
  if (!cursor) return;
  const [from, to] = index === null ? mapRange() : stretchRange(index), { z_from, z_to } = section.facts.bands[section.band];
  const x = mapX(from), y = mapY(z_to);
  cursor.setAttribute("x", x);
  cursor.setAttribute("y", y);
  cursor.setAttribute("width", Math.max(2, mapX(to) - x));
  cursor.setAttribute("height", Math.max(2, mapY(z_from) - y));
}

/** The stretch and the band at a place of the map; null where the load has no pose. */
function placeOnMap(svg, event) {
  const box = svg.getBoundingClientRect(), { left, right, top, bottom, width, height } = sectionMap;
  const x = (event.clientX - box.left) * width / box.width, y = (event.clientY - box.top) * height / box.height;
  const [from, to] = mapRange(), { bands, bin } = section.facts;
  const chainage = from + (x - left) / (width - left - right) * (to - from);
  const index = sectionBins().indexOf(Math.floor(chainage / bin));
  const band = Math.floor((1 - (y - top) / (height - top - bottom)) * bands.length);
  return index < 0 ? null : { index, band: clamp(band, 0, bands.length - 1) };
}

function showOnMap(index, band) {
  section.band = band;
  drawStretch(index);
  drawRoom();
  placeMapCursor();
}

function watchMap(svg) {
  let waiting = null;
  svg.addEventListener("pointermove", (event) => {
    const before = waiting;
    waiting = placeOnMap(svg, event);
    if (before || !waiting) return;
    requestAnimationFrame(() => {
      if (waiting) showOnMap(waiting.index, waiting.band);
      waiting = null;
    });
  });
  svg.addEventListener("pointerleave", () => {
    waiting = null;
    showOnMap(section.chosen, section.band);
  });
  svg.addEventListener("click", (event) => {
    const place = placeOnMap(svg, event);
    if (!place) return;
    section.band = place.band;
    chooseStretch(place.index);
  });
  svg.addEventListener("keydown", mapKey);
}

function mapKey(event) {
  const last = sectionBins().length - 1, top = section.facts.bands.length - 1;
  const along = (by) => chooseStretch(section.chosen === null ? (by > 0 ? 0 : last) : clamp(section.chosen + by, 0, last));
  const up = (by) => showOnMap(section.chosen, clamp(section.band + by, 0, top));
  const actions = {
    ArrowRight: () => along(1), ArrowLeft: () => along(-1), ArrowUp: () => up(1), ArrowDown: () => up(-1),
    Home: () => chooseStretch(0), End: () => chooseStretch(last), Escape: () => chooseStretch(null),
    Enter: () => byId("section-picture").scrollIntoView({ block: "nearest" }),
  };
  if (!actions[event.key]) return;
  event.preventDefault();
  actions[event.key]();
}

function mapTools() {
  return [make("label", {}, "Map of ", make("select", { id: "section-side", onchange: (event) => {
    sectionMap.side = event.target.value;
    drawMap();
  } }, Object.entries(kMapSides).map(([value, words]) => make("option", { value }, words))))];
}
