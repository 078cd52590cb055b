// The scene from above, cut open where it is enclosed, with the path and the numbered conflicts.

const plan = { centre: [0, 0], halfWidth: 10, turned: false, places: [] };

/** Around all that the plan shows, and a metre beside the path. */
const planBox = () => boxAround([
  ...[...page.environment.chunks, ...page.points.chunks].flatMap(({ centre, half }) => [plus(centre, half, -1), plus(centre, half)]),
  ...page.path.flatMap((place) => [plus(place, [1, 1, 0], -1), plus(place, [1, 1, 0])]),
]) ?? { lo: [-1, -1], hi: [1, 1] };

/** A view of all; the longer side lies across the page. */
function fitPlan() {
  const { lo, hi } = planBox(), canvas = byId("plan-canvas");
  const size = [hi[0] - lo[0], hi[1] - lo[1]];
  plan.turned = size[1] > 1.25 * size[0];
  plan.centre = [(lo[0] + hi[0]) / 2, (lo[1] + hi[1]) / 2];
  const [across, high] = plan.turned ? [size[1], size[0]] : size;
  plan.halfWidth = 0.52 * Math.max(across, high * canvas.width / canvas.height);
  schedulePlan();
}

function planCamera(canvas) {
  const right = plan.turned ? [0, 1, 0] : [1, 0, 0], up = plan.turned ? [-1, 0, 0] : [0, 1, 0];
  return { origin: [...plan.centre, 0], right, up, toViewer: [0, 0, 1], distance: 0,
           halfWidth: plan.halfWidth, halfHeight: plan.halfWidth * canvas.height / canvas.width };
}

/** Where the places of shown poses are in the picture; of a long path some thousand of them, and its end. */
function projectedPath(painter, from = 0, to = page.poses.count - 1) {
  const stride = Math.max(1, Math.floor(page.poses.count / 3000)), out = [];
  for (let i = from; i < to; i += stride) out.push(painter.project(page.path[i]));
  if (to >= from) out.push(painter.project(page.path[to]));
  return out;
}

function drawPath(context, painter, unitSize) {
  for (const [style, wide] of [["rgba(255,255,255,0.85)", 4.5], ["#111827", 1.8]]) {
    strokeThrough(context, projectedPath(painter), style, wide * unitSize);
  }
  drawUnsearchedPath(context, painter, unitSize);
}

/** What a scene shows of a conflict by a number. A possible conflict is hollow, an accepted one grey. */
function conflictMarks() {
  const worst = worstOutside();
  return conflictList().map((conflict) => {
    const { shape, colour } = classOf(conflict.least_distance), chosen = conflict === page.conflict;
    const quiet = isAccepted(conflict);
    return { place: placeOf(conflict), text: String(conflict.id), shape, chosen, quiet,
             colour: quiet ? kQuietColour : colour,
             hollow: isPossible(conflict), rank: conflict.rank, first: chosen || conflict === worst,
             select: () => selectConflict(conflict) };
  });
}

/** What became of the numbers without room; nothing where all have it. */
const crowdedWords = (dots) => dots === 0 ? ""
    : `${plural(dots, "number has", "numbers have")} no room beside others here, so that a dot stands for ` +
      `${dots === 1 ? "it" : "each"}; the table has all of them.`;

/**
 * The numbers of conflicts and unseen groups, the worst ones first; those without room become dots, of which the element with the
 * name `note` tells. Returns what pickNumber() finds.
 */
function drawNumbers(context, painter, unitSize, note) {
  const order = [...conflictMarks(), ...groupMarks()].sort((a, b) => b.chosen - a.chosen ||
      b.first - a.first || (a.quiet ?? false) - (b.quiet ?? false) || a.rank - b.rank);
  const taken = [], dots = [];
  for (const mark of order) {
    const at = painter.project(mark.place);
    if (!at || at[0] < 0 || at[1] < 0 || at[0] > painter.width || at[1] > painter.height) continue;
    const apart = Math.max(24, 8 * mark.text.length) * unitSize;
    const free = taken.every(([x, y]) => Math.hypot(x - at[0], y - at[1]) > apart);
    (free ? taken : dots).push(at);
    at.mark = mark;
  }
  for (const at of dots) drawNumber(context, at, at.mark, false, unitSize);
  for (const at of taken.reverse()) drawNumber(context, at, at.mark, true, unitSize);
  byId(note).textContent = crowdedWords(dots.length);
  return taken.map(({ 0: x, 1: y, mark }) => ({ x, y, mark }));
}

/** The outline of a mark: a diamond and a triangle are as large as the disc in them. */
function markPath(context, shape, x, y, radius) {
  const corners = { diamond: [[0, -1.35], [1.35, 0], [0, 1.35], [-1.35, 0]],
                    triangle: [[0, -1.75], [1.55, 0.95], [-1.55, 0.95]],
                    square: [[-1, -1], [1, -1], [1, 1], [-1, 1]] }[shape];
  context.beginPath();
  if (!corners) context.arc(x, y, radius, 0, 7);
  for (const [dx, dy] of corners ?? []) context.lineTo(x + dx * radius, y + dy * radius);
  context.closePath();
}

function drawNumber(context, [x, y], mark, full, unitSize) {
  const { chosen, text } = mark, hollow = mark.hollow && !chosen;
  const radius = (full ? Math.max(chosen ? 12 : mark.quiet ? 8 : 9.5, 3.6 * text.length) : 3) * unitSize;
  markPath(context, mark.shape, x, y, radius);
  context.fillStyle = chosen ? "#111827" : hollow ? "#fff" : mark.colour;
  context.globalAlpha = full ? 1 : 0.6;
  context.fill();
  context.globalAlpha = 1;
  if (!full) return;
  context.strokeStyle = hollow ? mark.colour : "#fff";
  context.lineWidth = (hollow ? 2.4 : 1.6) * unitSize;
  context.stroke();
  context.fillStyle = hollow ? "#111827" : "#fff";
  context.textAlign = "center";
  setFont(context, (text.length > 2 ? 9 : 11) * unitSize, "700");
  context.fillText(text, x, y + 4 * unitSize);
  if (!mark.quiet) return;
  context.fillStyle = kQuietColour;
  haloText(context, "✓", x + radius + 5 * unitSize, y - 0.5 * radius, "center");
}

function drawBodyMark(context, painter, unitSize, v) {
  const corner = (a, b) => painter.project(plus(plus(v.middle, v.forward, a * v.length / 2), v.left,
                                                b * v.width / 2));
  const corners = [corner(-1, -1), corner(-1, 1), corner(0.6, 1), corner(1, 0), corner(0.6, -1)];
  context.beginPath();
  for (const c of corners) if (c) context.lineTo(c[0], c[1]);
  context.closePath();
  context.fillStyle = "rgba(0,115,92,0.75)";
  context.fill();
  context.strokeStyle = "#003d31";
  context.lineWidth = 1.5 * unitSize;
  context.stroke();
}

/** Which way y points, where the plan is turned and where it is not. */
function drawAxes(context, unitSize) {
  const x = context.canvas.width - 34 * unitSize, y = 40 * unitSize, long = 24 * unitSize;
  context.fillStyle = "#111827";
  setFont(context, 12 * unitSize, "600");
  const axes = plan.turned ? [["x", 0, 1], ["y", 1, 0]] : [["x", 1, 0], ["y", 0, -1]];
  for (const [name, dx, dy] of axes) {
    strokeThrough(context, [[x - long / 2, y], [x - long / 2 + dx * long, y + dy * long]], "#111827", 1.6 * unitSize);
    haloText(context, name, x - long / 2 + dx * (long + 9 * unitSize),
             y + dy * (long + 9 * unitSize) + 4 * unitSize, "center");
  }
}

/** Draws the plan as it is now. */
function paintPlan(canvas, unitSize) {
  const context = canvas.getContext("2d"), painter = new Painter(canvas.width, canvas.height,
                                                                 planCamera(canvas));
  context.fillStyle = kBackground;
  context.fillRect(0, 0, canvas.width, canvas.height);
  const { tag } = page.environment, size = Math.max(1, Math.round(1.4 * unitSize));
  const cut = page.enclosed ? (i) => tag[i] <= 128 + 2 : undefined;
  paintEnvironment(painter, { stamp: stampOf("square", size), keep: cut });
  painter.shade(0.8);
  painter.show(context);
  paintUnseen(context, painter, unitSize);
  drawPath(context, painter, unitSize);
  const marks = new Painter(canvas.width, canvas.height, planCamera(canvas));
  paintClasses(marks, { over: true, size: size + 2 });
  marks.show(context);
  for (const { body } of page.poses.count > 0 ? bodiesAt(page.pose) : []) {
    drawBodyMark(context, painter, unitSize, vehicleAt(page.pose, body));
  }
  plan.places = drawNumbers(context, painter, unitSize, "plan-crowded");
  drawScaleBar(context, painter.perMetre, unitSize);
  drawAxes(context, unitSize);
}

const schedulePlan = inNextFrame(() => {
  const canvas = byId("plan-canvas");
  if (canvas.width > 0 && canvas.height > 0) paintPlan(canvas, canvas.width / canvas.clientWidth || 1);
});

function sizePlan() {
  const stage = byId("plan-stage"), box = planBox(), size = [box.hi[0] - box.lo[0], box.hi[1] - box.lo[1]];
  const ratio = Math.min(...size) / Math.max(...size);
  sizeCanvases(stage, clamp(stage.clientWidth * ratio * 1.05, 260, Math.min(720, 0.72 * innerHeight)));
}

function zoomPlan(factor, at) {
  const canvas = byId("plan-canvas"), camera = planCamera(canvas);
  const u = at ? 2 * at[0] - 1 : 0, v = at ? 1 - 2 * at[1] : 0;
  const shift = (half) => plus(times(camera.right, u * half * (1 - factor)), camera.up,
                               v * half * (1 - factor) * canvas.height / canvas.width);
  const d = shift(plan.halfWidth);
  plan.halfWidth = clamp(plan.halfWidth * factor, 0.5, 1e5);
  plan.centre = [plan.centre[0] + d[0], plan.centre[1] + d[1]];
  schedulePlan();
}

/** Moves the plan by parts of its width and height. */
function panPlan(dx, dy) {
  const canvas = byId("plan-canvas"), camera = planCamera(canvas);
  const d = plus(times(camera.right, -2 * dx * camera.halfWidth), camera.up,
                 2 * dy * camera.halfHeight);
  plan.centre = [plan.centre[0] + d[0], plan.centre[1] + d[1]];
  schedulePlan();
}

function buildPlan() {
  const canvas = make("canvas", { id: "plan-canvas", tabindex: 0, role: "application",
                                  "aria-label": "Plan. Arrow keys move it, plus and minus zoom, 0 shows all." });
  byId("plan-stage").append(canvas);
  byId("plan-tools").append(
    button("Zoom in", () => zoomPlan(0.6)), button("Zoom out", () => zoomPlan(1 / 0.6)),
    button("All", fitPlan),
    make("span", { class: "hint" }, "Drag moves, Ctrl and wheel zoom, a number opens its conflict or place."));
  byId("plan-note").textContent = environmentNote() + (page.enclosed
      ? " The scene is enclosed, so what lies above the vehicle is left out." : "") + unsearchedNote() + marksNote();
  watchPointer(canvas, panPlan, zoomPlan, (x, y) => pickNumber(plan.places, canvas, x, y));
  onKeys(canvas, () => ({ ArrowLeft: () => panPlan(0.1, 0), ArrowRight: () => panPlan(-0.1, 0),
                          ArrowUp: () => panPlan(0, 0.1), ArrowDown: () => panPlan(0, -0.1),
                          ...zoomKeys(() => zoomPlan(0.6), () => zoomPlan(1 / 0.6), fitPlan) }));
  sizePlan();
  fitPlan();
  on("pose", schedulePlan);
  on("conflict", schedulePlan);
  on("group", schedulePlan);
  new ResizeObserver(() => { sizePlan(); fitPlan(); }).observe(byId("plan-stage"));
}
