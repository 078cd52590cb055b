// Widths along the path: a map of chainage and height, with its cursor.

const sectionMap = Object.assign(new Chart(64), { side: "width" });
const kMapSides = { width: "symmetric width", left: "room to the left", right: "room to the right" };
const kMostMapColumns = 2000;

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

/** Dark where there is no room. */
const mapDarkness = (room) => room === null ? 0 : 1 - clamp(room / mapMost(), 0, 1);

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
  for (const [at, room] of least) pixels.data.set([...shadeOf(mapDarkness(room)), 255], 4 * at);
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
      const x1 = sectionMap.x(from), x2 = sectionMap.x(to), y1 = sectionMap.y(bands[last].z_to), y2 = sectionMap.y(band.z_from);
      parts.push(`M${x1.toFixed(1)} ${y1.toFixed(1)}H${x2.toFixed(1)}V${y2.toFixed(1)}H${x1.toFixed(1)}Z`);
    });
  }
  return parts.join("");
}

function mapAxes() {
  const { left, top } = sectionMap;
  return [...sectionMap.axes(8, true),
          make("text", { x: left, y: top - 9, class: "strong" }, `height (${unitSymbol}), ${kMapSides[sectionMap.side]}${section.stops ? "; hatched where the load is stopped" : ""}`),
          make("rect", { ...sectionMap.field, fill: "none", stroke: "#111827" })];
}

/** Stretches that stop the load, as numbered bars below the axis. */
function mapBars() {
  return sectionMap.bars((section.facts.check?.stops ?? []).map((stop, i) => {
    const index = sectionBins().indexOf(stop.bin), [from, to] = stretchRange(index);
    return { from, to, label: String(i + 1), choose: () => chooseStretch(index),
             look: (x, y, width) => ({ x: x + 0.5, y, width: Math.max(1, width - 1), height: 9, fill: "#c2410c" }) };
  }));
}

function drawMap() {
  const holder = byId("section-map");
  if (sectionBins().length === 0) {
    holder.replaceChildren(make("p", {}, "The load has no pose, so there is no map."));
    return;
  }
  const { bands } = section.facts, [from, to] = mapRange();
  Object.assign(sectionMap, { from, to, low: bands[0].z_from, high: bands.at(-1).z_to,
                              width: clamp(holder.clientWidth || 1000, 520, 1400) });
  sectionMap.height = clamp(sectionMap.width * 0.3, 240, 420);
  const { canvas, to: end } = mapImage(), { field } = sectionMap;
  watchMap(sectionMap.show(holder, "Widths by chainage and height. Arrow keys move the cursor, Enter shows the stretch, Escape the whole path.", [
    make("defs", {}, hatching("section-no-pose", 8, 45, "#f3f4f6", ["#9ca3af", 2]),
         hatching("section-map-stops", 9, -45, "none", ["#fff", 4], ["#c2410c", 2.4]),
         make("clipPath", { id: "section-map-inside" }, make("rect", field))),
    make("rect", { ...field, fill: "url(#section-no-pose)" }),
    make("image", { ...field, width: sectionMap.x(end) - field.x, preserveAspectRatio: "none", style: "image-rendering: pixelated",
                    href: addressOf(canvas), "clip-path": "url(#section-map-inside)" }),
    make("path", { d: mapStops(), fill: "url(#section-map-stops)", stroke: "#c2410c", "stroke-width": 1.2 }),
    mapAxes(), mapBars(),
    make("rect", { id: "section-cursor", fill: "none", stroke: "#00735c", "stroke-width": 2.5, "pointer-events": "none" })],
    shadeScale((share) => 1 - share, (share) => `${(share * mapMost()).toFixed(1)} ${unitSymbol}`)));
  placeMapCursor();
}

function placeMapCursor() {
  const cursor = byId("section-cursor"), index = section.shown ?? null;
  if (!cursor) return;
  const [from, to] = index === null ? mapRange() : stretchRange(index), { z_from, z_to } = section.facts.bands[section.band];
  const x = sectionMap.x(from), y = sectionMap.y(z_to);
  cursor.setAttribute("x", x);
  cursor.setAttribute("y", y);
  cursor.setAttribute("width", Math.max(2, sectionMap.x(to) - x));
  cursor.setAttribute("height", Math.max(2, sectionMap.y(z_from) - y));
}

/** The stretch and the band at a place of the map; null where the load has no pose. */
function placeOnMap(svg, event) {
  const [chainage, z] = sectionMap.at(svg, event), { bands, bin } = section.facts;
  const index = sectionBins().indexOf(Math.floor(chainage / bin));
  const band = Math.floor((z - sectionMap.low) / (sectionMap.high - sectionMap.low) * bands.length);
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
  const show = inNextFrame(() => waiting && showOnMap(waiting.index, waiting.band));
  svg.addEventListener("pointermove", (event) => {
    waiting = placeOnMap(svg, event);
    show();
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
  onKeys(svg, mapKeys);
}

function mapKeys() {
  const last = sectionBins().length - 1, top = section.facts.bands.length - 1;
  const along = (by) => chooseStretch(section.chosen === null ? (by > 0 ? 0 : last) : clamp(section.chosen + by, 0, last));
  const up = (by) => showOnMap(section.chosen, clamp(section.band + by, 0, top));
  return {
    ArrowRight: () => along(1), ArrowLeft: () => along(-1), ArrowUp: () => up(1), ArrowDown: () => up(-1),
    Home: () => chooseStretch(0), End: () => chooseStretch(last), Escape: () => chooseStretch(null),
    Enter: () => byId("section-picture").scrollIntoView({ block: "nearest" }),
  };
}

function mapTools() {
  return [make("label", {}, "Map of ", make("select", { id: "section-side", onchange: (event) => {
    sectionMap.side = event.target.value;
    drawMap();
  } }, Object.entries(kMapSides).map(([value, words]) => make("option", { value }, words))))];
}
