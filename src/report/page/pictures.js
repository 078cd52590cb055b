// Pictures of a conflict at the pose where it is nearest: from the front, from above, and a
// cross-section. All three are drawn on canvases, when they are shown or printed.

const kBackground = "#f6f7f9";

/** The rows of a disc of pixels around its middle: [dy, half its width]. */
function rowsOfDisc(radius) {
  const widths = new Map();
  for (const [dx, dy] of stampOf("round", Math.max(1, 2 * Math.round(radius) + 1))) {
    widths.set(dy, Math.max(widths.get(dy) ?? 0, dx));
  }
  return [...widths];
}

/** Pixels of these rows around each of the points that passes keep(depth). */
function maskOf(painter, points, rows, keep) {
  const { width, height } = painter, mask = new Uint8Array(width * height), done = new Uint8Array(width * height);
  for (const p of points) {
    const at = painter.project(p);
    if (!at || (keep && !keep(at[2]))) continue;
    const x = at[0] | 0, y = at[1] | 0;
    if (x >= 0 && y >= 0 && x < width && y < height) {
      if (done[y * width + x]) continue;
      done[y * width + x] = 1;
    }
    for (const [dy, half] of rows) {
      const from = Math.max(0, x - half), to = Math.min(width, x + half + 1), qy = y + dy;
      if (qy >= 0 && qy < height && from < to) mask.fill(1, qy * width + from, qy * width + to);
    }
  }
  return mask;
}

/** The mask without its border of `radius` pixels: along rows, then along columns. */
function eroded(mask, width, height, radius) {
  const pass = (from, lines, along, line, step) => {
    const out = new Uint8Array(from.length);
    for (let a = 0; a < lines; ++a) {
      let run = 0;
      for (let b = 0; b < along; ++b) {
        const at = a * line + b * step;
        run = from[at] ? run + 1 : 0;
        if (run > 2 * radius) out[at - radius * step] = 1;
      }
    }
    return out;
  };
  return pass(pass(mask, height, width, width, 1), width, height, 1, width);
}

/** Draws a mask. colour(x, y, isEdge): of a pixel, with its opacity. */
function drawMask(context, mask, width, height, colour) {
  const image = new ImageData(width, height);
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x) {
      const at = y * width + x;
      if (!mask[at]) continue;
      const inside = x > 0 && y > 0 && x < width - 1 && y < height - 1 && mask[at - 1] &&
          mask[at + 1] && mask[at - width] && mask[at + width] && mask[at - width - 1] &&
          mask[at + width + 1];
      image.data.set(colour(x, y, !inside), 4 * at);
    }
  }
  putImage(context, image);
}

/** Points of all bodies at shown pose i, in the page's coordinates. */
function movedModel(shown) {
  const { xyz, ranges } = page.model, out = [];
  for (const { body, pose } of bodiesAt(shown)) {
    const { first, count } = ranges[body];
    for (let i = first; i < first + count; ++i) {
      out.push(moved(pose, [xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]]));
    }
  }
  return out;
}

/** What a picture of that kind shows: {camera, lo, hi (depths of the environment)}. */
function viewOf(kind, conflict, vehicle, place, aspect) {
  const { forward, left, up, middle } = vehicle;
  const across = Math.max(vehicle.width, 0.6 * vehicle.height, 0.5);
  const along = (p) => dot(plus(p, middle, -1), forward);
  const flat = plus(middle, forward, along(place));  // the middle, in the plane of the place
  if (kind === "above") {
    const half = 1.1 * across;
    const reach = Math.max(0, vehicle.length / 2 - 0.6 * half * aspect);
    const origin = plus(middle, forward, clamp(along(place), -reach, reach));
    const top = Math.max(vehicle.height / 2, dot(plus(place, middle, -1), up)) + 0.25;
    return { camera: { origin, right: forward, up: left, toViewer: up, halfHeight: half,
                       halfWidth: half * aspect, distance: 0 }, lo: -Infinity, hi: top };
  }
  const camera = { origin: flat, right: left, up, toViewer: forward, distance: 0 };
  if (kind === "front") {
    const aside = Math.abs(dot(plus(place, middle, -1), left)) + 0.3;
    const high = Math.abs(dot(plus(place, middle, -1), up)) + 0.3;
    camera.halfHeight = Math.max(0.75 * vehicle.height, 0.62 * vehicle.width / aspect,
                                 aside / aspect, high);
    camera.halfWidth = camera.halfHeight * aspect;
    return { camera, lo: -2, hi: 1 };
  }
  const radius = page.facts.query.radius;
  camera.halfHeight = Math.max(4 * radius, 0.27 * Math.max(vehicle.height, vehicle.width), 0.15,
                               1.4 * (conflict.points_inside ? conflict.depth : 0));
  camera.halfWidth = camera.halfHeight * aspect;
  camera.origin = place;
  return { camera, lo: -0.05, hi: 0.05 };
}

/** Draws a picture of a conflict: kind is "front", "above" or "section". */
function drawConflict(canvas, conflict, kind) {
  const { width, height } = canvas, context = canvas.getContext("2d");
  const vehicle = vehicleAt(shownPose(poseOf(conflict)), bodyNumber(conflict.body));
  const place = placeOf(conflict);
  const view = viewOf(kind, conflict, vehicle, place, width / height);
  const painter = new Painter(width, height, view.camera), unitSize = width / 480;
  context.fillStyle = kBackground;
  context.fillRect(0, 0, width, height);
  const size = Math.max(2, Math.round((kind === "section" ? 4 : 2) * unitSize));
  let thickness = view.hi;
  const square = stampOf("square", kind === "section" ? Math.max(2, size - 1) : size);
  let drawn = paintEnvironment(painter, { lo: view.lo, hi: view.hi, stamp: square });
  while (kind === "section" && drawn < 60 && thickness < 0.2) {
    thickness *= 2;  // where points are thin, more of them show where the surface is
    drawn = paintEnvironment(painter, { lo: -thickness, hi: thickness, stamp: square });
  }
  if (kind !== "section") painter.shade();
  painter.show(context);
  drawModel(context, painter, conflict, vehicle, kind, thickness);
  const marks = new Painter(width, height, view.camera);
  const reach = kind === "section" ? { lo: -thickness, hi: thickness } : view;
  paintClasses(marks, { lo: reach.lo, hi: reach.hi, over: true, size: size + 2 });
  marks.show(context);
  drawLabels(context, painter, conflict, vehicle, kind, unitSize, thickness);
}

function drawModel(context, painter, { body }, vehicle, kind, thickness) {
  const { width, height } = painter, points = movedModel(vehicle.shown);
  const inSlab = kind === "section" ? (depth) => Math.abs(depth) <= thickness : undefined;
  const spacing = Math.sqrt(vehicle.length * (vehicle.width + vehicle.height) * 2 /
      Math.max(page.model.ranges[bodyNumber(body) ?? 0].count, 1)) * painter.perMetre;
  if (kind === "section") {
    const radius = page.facts.query.radius * painter.perMetre;
    drawMask(context, maskOf(painter, points, rowsOfDisc(radius), inSlab), width, height,
             (x, y, isEdge) => [194, 65, 12, isEdge && (x + y >> 2) % 3 !== 0 ? 255 : 26]);
  }
  const close = Math.ceil(clamp(1.2 * spacing, 1, 14));
  const grown = maskOf(painter, points, rowsOfDisc(close + 1), inSlab);
  const mask = eroded(grown, width, height, close);
  const [r, g, b] = kModelRgb;
  drawMask(context, kind === "section" ? grownOnce(mask, width) : mask, width, height,
           (x, y, isEdge) => isEdge ? [0, 90, 72, 255] : [r, g, b, kind === "section" ? 200 : 48]);
}

/** A thin section stays visible. */
function grownOnce(mask, width) {
  const out = mask.slice();
  for (let i = width; i < mask.length - width; ++i) {
    if (mask[i]) out[i - 1] = out[i + 1] = out[i - width] = out[i + width] = 1;
  }
  return out;
}
