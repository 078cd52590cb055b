// The vehicle's cross-section, seen along its path: how much was not scanned in each place of it.

/** Cells that are swept on less than this share of the greatest length are drawn small. */
const kLittleSwept = 0.1;

/** What is unseen of what is swept in a cell, from 0 to 1; null where nothing is swept. */
const frontShare = (front, i) => front.swept[i] > 0 ? front.unseen[i] / front.swept[i] : null;

/** A share in percent, so that neither nothing nor everything is said of a part. */
function percentWords(share) {
  const percent = Math.round(100 * share);
  return String(percent === 0 && share > 0 ? "<1" : percent === 100 && share < 1 ? ">99" : percent);
}

/** The cells that are swept, with their numbers. side: of a cell in pixels. */
function frontCells(chart, side) {
  const { front } = seenFacts(), { cell, columns } = front, most = Math.max(...front.swept);
  return front.swept.map((swept, i) => {
    const share = frontShare(front, i), words = percentWords(share), small = swept < kLittleSwept * most, inset = small ? 0.3 * side : 0;
    const x = chart.x(front.left + (i % columns + 1) * cell), y = chart.y(front.up + (Math.floor(i / columns) + 1) * cell);
    return share !== null && make("g", {},
        make("rect", { x: x + inset, y: y + inset, width: side - 2 * inset, height: side - 2 * inset, fill: `rgb(${shadeOf(share).join(",")})` }),
        !small && share > 0 && make("text", { x: x + side / 2, y: y + 0.64 * side, class: "middle strong", style:
            `font-size: ${Math.min(0.44 * side, 1.5 * side / words.length)}px; fill: ${share > 0.45 ? "#fff" : "#111827"}` }, words));
  });
}

/** The outline of the vehicle in the middle of its path, seen from behind it. */
function frontVehicle(chart) {
  const shown = Math.floor(page.poses.count / 2), { front } = seenFacts();
  if (page.poses.count === 0 || bodiesAt(shown).length === 0) return "";
  const width = Math.round(1.4 * chart.wide), height = Math.round(1.4 * chart.tall), v = vehicleAt(shown);
  const middle = (least, cells) => least + 0.5 * cells * front.cell;
  const origin = plus(plus(v.pose.t, v.left, middle(front.left, front.columns)), v.up, middle(front.up, front.rows));
  const painter = new Painter(width, height, { origin, right: times(v.left, -1), up: v.up, toViewer: times(v.forward, -1),
      distance: 0, halfWidth: 0.5 * front.columns * front.cell, halfHeight: 0.5 * front.rows * front.cell });
  const spacing = Math.sqrt(v.length * (v.width + v.height) * 2 / page.model.count);
  const close = Math.ceil(clamp(Math.max(0.06, spacing) * painter.perMetre, 2, 60));
  const layer = new OffscreenCanvas(width, height);
  drawMask(layer.getContext("2d"), eroded(maskOf(painter, movedModel(shown), rowsOfDisc(close + 1)), width, height, close), width, height,
           (x, y, isEdge) => [0, 90, 72, isEdge ? 255 : 0]);
  return make("image", { ...chart.field, href: addressOf(layer), class: "outline" });
}

/** Where most is unseen, for those who do not see the picture. */
function frontWords() {
  const { front } = seenFacts();
  const most = Math.max(...front.unseen), at = front.unseen.indexOf(most);
  if (!(most > 0)) return "Everything that the vehicle sweeps was scanned.";
  const y = front.left + (at % front.columns + 0.5) * front.cell;
  const z = front.up + (Math.floor(at / front.columns) + 0.5) * front.cell;
  const sum = (of) => front.unseen.reduce((all, length, i) => all + (of(i) ? length : 0), 0);
  const all = sum(() => true), columns = front.columns;
  const left = sum((i) => front.left + (i % columns + 0.5) * front.cell > 0);
  const share = (part) => `${Math.round(100 * part / all)} %`;
  return `Of all that was not scanned, ${share(left)} lies left of the path and ` +
      `${share(all - left)} right of it. Most is unseen ${metres(Math.abs(y), 2)} ` +
      `${y < 0 ? "right" : "left"} of the path and ${metres(Math.abs(z), 2)} ` +
      `${z < 0 ? "below" : "above"} it: ${shortLength(+most.toPrecision(2))} of ` +
      `${shortLength(+front.swept[at].toPrecision(2))} that the vehicle sweeps in this cell.`;
}

function buildFront() {
  const { front } = seenFacts(), { cell, columns, rows, left, up } = front;
  if (!(columns > 0)) return;
  const chart = Object.assign(new Chart(46), { from: left + columns * cell, to: left, low: up, high: up + rows * cell, title: "",
                                               width: clamp(byId("unseen-front").clientWidth || 1000, 520, 1000) });
  const side = Math.min(chart.wide / columns, 0.78 * chart.width / rows), aside = (chart.wide - side * columns) / 2;
  Object.assign(chart, { left: chart.left + aside, right: chart.right + aside, height: chart.top + side * rows + chart.bottom });
  const words = (x, y, kind, text) => make("text", { x, y, class: `${kind} strong` }, text), below = chart.base + 40;
  const picture = chart.svg({ id: "front-picture", role: "img", "aria-label": `The vehicle's cross-section, looking forward. ${frontWords()}` }, [
    make("rect", { ...chart.field, class: "not-swept" }),
    make("g", { "shape-rendering": "crispEdges" }, frontCells(chart, side)), frontVehicle(chart),
    make("rect", { ...chart.field, fill: "none", stroke: "#111827" }), chart.axes(6, true, (value) => (value > 0 ? "+" : "") + minus(value)),
    words(chart.left, below, "", "← its left"), words(chart.left + chart.wide / 2, below, "middle", `from the path (${unitSymbol})`),
    words(chart.left + chart.wide, below, "end", "its right →"), words(chart.left, chart.top - 10, "", `height above the path (${unitSymbol})`)]);
  const most = Math.max(...front.swept), little = front.swept.some((length) => length > 0 && length < kLittleSwept * most);
  byId("unseen-front").append(make("figure", {}, picture,
      make("figcaption", {}, make("strong", {}, "The vehicle, seen from behind. "),
           "A number says how many percent of the space that the vehicle sweeps at this place of its " +
           "cross-section were not scanned. Darker is more, white is all scanned, and grey is not swept. " +
           (little ? "Small squares are places that the vehicle sweeps on less than a tenth of the way. " : "") +
           `A cell is ${shortLength(cell)} wide. The line is the vehicle's outline. ${frontWords()}`)),
      shadeScale((share) => share, (share) => `${100 * share} %`));
}
