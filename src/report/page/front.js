// The vehicle's cross-section, seen along its path: how much was not scanned in each place of it.

const kNotSwept = "#d1d5db";
const kFrontMargin = { left: 62, right: 16, top: 30, bottom: 46 };

/** Cells that are swept on less than this share of the greatest length are drawn small. */
const kLittleSwept = 0.1;

/** What is unseen of what is swept in a cell, from 0 to 1; null where nothing is swept. */
const frontShare = (front, i) => front.swept[i] > 0 ? front.unseen[i] / front.swept[i] : null;

/** A share in percent, so that neither nothing nor everything is said of a part. */
function percentWords(share) {
  const percent = Math.round(100 * share);
  return String(percent === 0 && share > 0 ? "<1" : percent === 100 && share < 1 ? ">99" : percent);
}

/** Draws the grid with its numbers and axes, and the outline of the vehicle over it. */
function drawFront(canvas) {
  const { front } = seenFacts(), { width } = canvas, context = canvas.getContext("2d");
  const { left: marginLeft, right, top, bottom } = kFrontMargin, scale = width / 1000;
  const pixels = Math.min((width - (marginLeft + right) * scale) / front.columns,
                          (canvas.height - (top + bottom) * scale) / front.rows);
  const x0 = (width - pixels * front.columns + (marginLeft - right) * scale) / 2, y0 = top * scale;
  const most = Math.max(...front.swept);
  context.fillStyle = "#fff";
  context.fillRect(0, 0, width, canvas.height);
  context.fillStyle = kNotSwept;
  context.fillRect(x0, y0, pixels * front.columns, pixels * front.rows);
  front.swept.forEach((swept, i) => {
    const share = frontShare(front, i);
    if (share === null) return;
    const column = i % front.columns, row = Math.floor(i / front.columns);
    const x = x0 + (front.columns - 1 - column) * pixels, y = y0 + (front.rows - 1 - row) * pixels;
    const small = swept < kLittleSwept * most, inset = small ? 0.3 * pixels : 0;
    context.fillStyle = `rgb(${shadeOf(share).join(",")})`;
    context.fillRect(x + inset, y + inset, pixels - 2 * inset + (small ? 0 : 0.5),
                     pixels - 2 * inset + (small ? 0 : 0.5));
    if (small || share === 0) return;
    const words = percentWords(share);
    context.fillStyle = share > 0.45 ? "#fff" : "#111827";
    setFont(context, Math.min(0.44 * pixels, 1.5 * pixels / words.length), "600");
    context.textAlign = "center";
    context.fillText(words, x + pixels / 2, y + 0.64 * pixels);
  });
  drawFrontVehicle(context, x0, y0, pixels);
  drawFrontAxes(context, x0, y0, pixels, scale);
}

/** The outline of the vehicle in the middle of its path, seen from behind it. */
function drawFrontVehicle(context, x0, y0, pixels) {
  if (page.poses.count === 0) return;
  const { front } = seenFacts(), shown = Math.floor(page.poses.count / 2);
  if (bodiesAt(shown).length === 0) return;
  const width = Math.round(pixels * front.columns), height = Math.round(pixels * front.rows);
  const pose = poseAt(shown), { forward, left, up } = vehicleAt(shown);
  const middle = (least, cells) => least + 0.5 * cells * front.cell;
  const origin = plus(plus(pose.t, left, middle(front.left, front.columns)), up,
                      middle(front.up, front.rows));
  const painter = new Painter(width, height, { origin, right: times(left, -1), up,
      toViewer: times(forward, -1), distance: 0, halfWidth: 0.5 * front.columns * front.cell,
      halfHeight: 0.5 * front.rows * front.cell });
  const v = vehicleAt(shown), spacing = Math.sqrt(v.length * (v.width + v.height) * 2 / page.model.count);
  const close = Math.ceil(clamp(Math.max(0.06, spacing) * painter.perMetre, 2, 60));
  const mask = eroded(maskOf(painter, movedModel(shown), close + 1), width, height, close);
  const layer = new OffscreenCanvas(width, height);
  drawMask(layer.getContext("2d"), mask, width, height, [0, 0, 0, 0], [255, 255, 255, 255]);
  for (const [dx, dy] of [[-2, 0], [2, 0], [0, -2], [0, 2]]) context.drawImage(layer, x0 + dx, y0 + dy);
  drawMask(layer.getContext("2d"), mask, width, height, [0, 0, 0, 0], [0, 90, 72, 255]);
  for (const [dx, dy] of [[0, 0], [1, 0], [0, 1]]) context.drawImage(layer, x0 + dx, y0 + dy);
}

function drawFrontAxes(context, x0, y0, pixels, scale) {
  const { front } = seenFacts();
  const wide = pixels * front.columns, high = pixels * front.rows;
  context.strokeStyle = "#111827";
  context.lineWidth = scale;
  context.strokeRect(x0, y0, wide, high);
  context.fillStyle = "#111827";
  setFont(context, 13 * scale);
  const perMetre = pixels / front.cell;
  for (const y of ticks(front.left, front.left + front.columns * front.cell, 8)) {
    const x = x0 + wide - (y - front.left) * perMetre;
    context.fillRect(x - scale / 2, y0 + high, scale, 5 * scale);
    haloText(context, signed(y).replace(/0$/, ""), x, y0 + high + 19 * scale, "center");
  }
  for (const z of ticks(front.up, front.up + front.rows * front.cell, 6)) {
    const y = y0 + high - (z - front.up) * perMetre;
    context.fillRect(x0 - 5 * scale, y - scale / 2, 5 * scale, scale);
    haloText(context, signed(z).replace(/0$/, ""), x0 - 9 * scale, y + 4 * scale, "right");
  }
  setFont(context, 13 * scale, "600");
  haloText(context, "← its left", x0, y0 + high + 40 * scale, "left");
  haloText(context, `from the path (${unitSymbol})`, x0 + wide / 2, y0 + high + 40 * scale, "center");
  haloText(context, "its right →", x0 + wide, y0 + high + 40 * scale, "right");
  haloText(context, `height above the path (${unitSymbol})`, x0, y0 - 10 * scale, "left");
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
  const { front } = seenFacts();
  if (!(front.columns > 0)) return;
  const canvas = make("canvas", { width: 1400, role: "img", id: "front-canvas", "aria-label":
      `The vehicle's cross-section, looking forward. ${frontWords()}` });
  const { left, right, top, bottom } = kFrontMargin, scale = canvas.width / 1000;
  const high = (canvas.width - (left + right) * scale) * front.rows / front.columns;
  canvas.height = Math.round(clamp(high + (top + bottom) * scale, 500, 1200));
  const most = Math.max(...front.swept);
  const little = front.swept.some((length) => length > 0 && length < kLittleSwept * most);
  byId("unseen-front").append(make("figure", {}, canvas,
      make("figcaption", {}, make("strong", {}, "The vehicle, seen from behind. "),
           "A number says how many percent of the space that the vehicle sweeps at this place of its " +
           "cross-section were not scanned. Darker is more, white is all scanned, and grey is not swept. " +
           (little ? "Small squares are places that the vehicle sweeps on less than a tenth of the way. " : "") +
           `A cell is ${shortLength(front.cell)} wide. The line is the vehicle's outline. ${frontWords()}`)),
      shadeScale((share) => share, (share) => `${100 * share} %`));
  drawFront(canvas);
}
