// The 3-D view: a camera around a target, what is drawn, and the vehicle's slider.

const view = { target: [0, 0, 0], distance: 20, yaw: -2.2, pitch: 0.7, follow: false, hidden: 0,
               cutAbove: false, cutFront: false, scene: null, places: [] };
const kHalfAngle = Math.PI / 8;

function cameraAxes(yaw, pitch) {
  const flat = Math.cos(pitch);
  const toViewer = [flat * Math.cos(yaw), flat * Math.sin(yaw), Math.sin(pitch)];
  const right = unit([-toViewer[1], toViewer[0], 0]);
  return { toViewer, right, up: cross(toViewer, right) };
}

function viewCamera() {
  const { target, distance } = view, axes = cameraAxes(view.yaw, view.pitch);
  return { ...axes, target, distance, eye: plus(target, axes.toViewer, distance),
           halfAngle: kHalfAngle };
}

/** The same camera as the painter has it, for numbers and where there is no WebGL. */
function painterCamera(canvas) {
  const camera = viewCamera(), half = view.distance * Math.tan(kHalfAngle);
  return { ...camera, origin: view.target, halfHeight: half,
           halfWidth: half * canvas.width / canvas.height };
}

/** Leaves out what is nearer to the viewer than the target and hides it. */
function cutPlane(camera) {
  const { toViewer, target, distance } = camera, size = page.vehicleSize;
  if (!view.cutFront || distance > 6 * size) return undefined;  // of an overview nothing
  const margin = Math.min(0.4 * size, 0.45 * distance);
  return [...toViewer, -dot(toViewer, target) - margin];
}

function drawWebgl(canvas) {
  const camera = viewCamera(), { height } = canvas, gl = view.scene.gl;
  const perMetre = height / (2 * Math.tan(kHalfAngle)), scale = devicePixelRatio || 1;
  const spacing = page.facts.page.environment_spacing || 0.02;
  const black = [[17, 24, 39]];
  view.scene.draw(canvas.width, height, camera, [
    ["environment", { environment: 1, palette: [[92, 105, 122], [148, 158, 168], [196, 190, 176]],
                      size: 1.3 * spacing * perMetre, least: 1.2 * scale, most: 5 * scale,
                      cutAbove: view.cutAbove ? 128 + 2 : 1000, cutPlane: cutPlane(camera) }],
    ...bodiesAt(page.pose).map(({ body, pose }) =>
        ["model", { palette: [bodyRgb(body)], matrix: matrixOf(pose),
                    ...page.model.ranges[body],
                    size: 0.03 * perMetre, least: 1.5 * scale, most: 6 * scale }]),
    ["path", { palette: black, mode: gl.LINE_STRIP, size: 1, least: 2, most: 2 }],
    ["path", { palette: black, size: 0.01 * perMetre, least: 2 * scale, most: 3 * scale }],
    ...(page.unseen && !view.unseenHidden ? [["unseen", { environment: 3,
        palette: [kUnseenRgb], size: seenFacts().cube * perMetre, least: 3 * scale,
        most: 64 * scale }]] : []),
    ["points", { environment: 0, palette: page.facts.classes.map((c) => kClassWords[c.name].rgb), hidden: view.hidden, size: 0.03 * perMetre,
                 least: 2.5 * scale, most: 9 * scale }],
  ]);
}

/** Slower, and without the line of the path; for browsers without WebGL2, and for printing. */
function drawWithoutWebgl(canvas) {
  const painter = new Painter(canvas.width, canvas.height, painterCamera(canvas));
  const { tag, xyz } = page.environment, camera = viewCamera(), plane = cutPlane(camera);
  const size = Math.max(1, Math.round(canvas.width / 700));
  paintEnvironment(painter, { stamp: stampOf("square", size), keep: (i) =>
      !(view.cutAbove && tag[i] > 128 + 2) &&
      !(plane && plane[0] * xyz[3 * i] + plane[1] * xyz[3 * i + 1] + plane[2] * xyz[3 * i + 2] +
        plane[3] > 0) });
  const model = { ...page.model, xyz: new Float32Array(movedModel(page.pose).flat()) };
  model.chunks = chunksOf(model.xyz);
  painter.points(model, { stamp: stampOf("square", size + 1), colour: () => packed(kModelRgb) });
  if (page.unseen && !view.unseenHidden) {
    painter.points(page.unseen, { stamp: stampOf("square", size + 3), colour: () => packed(kUnseenRgb) });
  }
  paintClasses(painter, { size: size + 2, hidden: page.facts.classes.map((_, k) => view.hidden >> k & 1) });
  painter.shade();
  const context = canvas.getContext("2d");
  context.fillStyle = "#f3f4f6";
  context.fillRect(0, 0, canvas.width, canvas.height);
  painter.show(context);
}

function paintView() {
  const canvas = byId("view-canvas"), over = byId("view-numbers");
  if (canvas.width === 0 || canvas.height === 0) return;
  if (page.poses.count > 0) {
    if (view.follow) view.target = vehicleAt(page.pose).middle;
    if (view.scene) drawWebgl(canvas); else drawWithoutWebgl(canvas);
  }
  const context = over.getContext("2d");
  context.clearRect(0, 0, over.width, over.height);
  view.places = drawNumbers(context, new Projection(over.width, over.height, painterCamera(over)),
                            over.width / over.clientWidth || 1, "view-crowded");
}

const scheduleView = inNextFrame(paintView);

function sizeView() {
  const stage = byId("view-stage"), height = clamp(0.5 * stage.clientWidth, 320, 0.78 * innerHeight);
  sizeCanvases(stage, height);
  stage.style.height = `${height}px`;
  scheduleView();
}

/** Brings the camera there, in half a second where motion is welcome. */
function flyTo(goal) {
  const from = { ...view }, start = performance.now();
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches || !view.scene;
  const turn = Math.atan2(Math.sin(goal.yaw - from.yaw), Math.cos(goal.yaw - from.yaw));
  view.flight = goal;
  const step = (now) => {
    if (view.flight !== goal) return;
    const t = still ? 1 : clamp((now - start) / 500, 0, 1), s = t * t * (3 - 2 * t);
    view.target = mix(from.target, goal.target, s);
    view.distance = from.distance * (goal.distance / from.distance) ** s;
    view.yaw = from.yaw + turn * s;
    view.pitch = from.pitch + (goal.pitch - from.pitch) * s;
    scheduleView();
    if (t < 1) requestAnimationFrame(step);
  };
  step(start);
}

function flyToConflict() {
  const conflict = page.conflict;
  if (!conflict) return scheduleView();
  flyToPlace(vehicleAt(page.pose, bodyNumber(conflict.body)), placeOf(conflict));
}

/** To the group where the vehicle first reaches it, because its middle may be far along the path. */
function flyToGroup() {
  if (!page.group) return scheduleView();
  const v = vehicleAt(page.pose), place = inPage(page.group.middle);
  const far = length(plus(place, v.middle, -1)) > page.vehicleSize;
  flyToPlace(v, far ? v.middle : place);
}

/** In front of the vehicle, above it, on the other side than the place. */
function flyToPlace(v, place) {
  const aside = dot(plus(place, v.middle, -1), v.left) > 0 ? -1 : 1;
  const ahead = dot(plus(place, v.middle, -1), v.forward) < -0.25 * v.length ? -1 : 1;
  const eye = plus(times(v.forward, 0.75 * ahead), v.left, 0.55 * aside);
  const size = Math.min(page.vehicleSize, 3 * Math.max(v.width, v.height));
  flyTo({ target: mix(place, v.middle, 0.15), distance: 2.1 * size, pitch: 0.45,
          yaw: Math.atan2(eye[1], eye[0]) });
}

/** Brings the 3-D view into sight, the vehicle back to a pose of the trajectory, and the camera to what was chosen. */
function showInView(pose, fly) {
  selectPose(shownPose(pose));
  fly();
  byId("view").scrollIntoView();
}

/** Distance from which all of the path and what is beside it is in sight. */
function fittingDistance(target, yaw, pitch) {
  const canvas = byId("view-canvas"), wide = Math.tan(kHalfAngle) * canvas.width / canvas.height;
  const { toViewer, right, up } = cameraAxes(yaw, pitch);
  const stride = Math.max(1, Math.floor(page.path.length / 300)), size = page.vehicleSize;
  let distance = 2 * size;
  for (let i = 0; i < page.path.length; i += stride) {
    const d = plus(page.path[i], target, -1), depth = dot(d, toViewer);
    const across = Math.abs(dot(d, right)) + size, high = Math.abs(dot(d, up)) + size;
    distance = Math.max(distance, depth + across / wide, depth + high / Math.tan(kHalfAngle));
  }
  return 1.1 * distance;
}

function flyToOverview() {
  if (page.path.length === 0) return;
  const { lo, hi } = boxAround(page.path);
  const target = times(plus(lo, hi), 0.5), pitch = 0.8;
  // Across the path's longer side, so that it lies along the picture.
  const yaw = hi[1] - lo[1] > hi[0] - lo[0] ? -0.35 : -Math.PI / 2 - 0.35;
  flyTo({ target, distance: fittingDistance(target, yaw, pitch), yaw, pitch });
}

function flyToVehicle() {
  const v = vehicleAt(page.pose), eye = plus(v.forward, v.left, 0.7);
  flyTo({ target: v.middle, distance: 2.6 * page.vehicleSize, pitch: 0.5,
          yaw: Math.atan2(eye[1], eye[0]) });
}
