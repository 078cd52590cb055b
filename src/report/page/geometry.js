const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const plus = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const length = (a) => Math.hypot(a[0], a[1], a[2]);
const unit = (a) => times(a, 1 / (length(a) || 1));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                         a[0] * b[1] - a[1] * b[0]];
const mix = (a, b, t) => a.map((v, k) => v + (b[k] - v) * t);
const clamp = (v, lo, hi) => Math.min(hi, Math.max(lo, v));

/** Coordinates of the scans to those of the page, and back. */
const inPage = (xyz) => plus(xyz, page.facts.page.lattice.origin, -1);
const inScan = (p) => plus(p, page.facts.page.lattice.origin);

/** Shown pose i: rotation (rows) and place. */
function poseAt(i) {
  const poses = page.poses, facts = page.facts.page, step = facts.lattice.step;
  const r = poses.rotation.map((column) => column[i] * facts.rotation_step);
  return { r, t: [poses.x[i] * step, poses.y[i] * step, poses.z[i] * step] };
}

const turned = (pose, v) => [dot(pose.r.slice(0, 3), v), dot(pose.r.slice(3, 6), v),
                             dot(pose.r.slice(6, 9), v)];
const moved = (pose, m) => plus(turned(pose, m), pose.t);

/** Of the pose with that index in the trajectory, or the next one that the page has. */
function shownPose(index) {
  const list = page.poses.index;
  let lo = 0, hi = page.poses.count - 1;
  while (lo < hi) {
    const middle = lo + hi >> 1;
    if (list[middle] < index) lo = middle + 1; else hi = middle;
  }
  return lo;
}

/** The shown pose nearest to a chainage; of equals the first. */
function poseAtChainage(chainage) {
  const list = page.poses.chainage;
  let lo = 0, hi = list.length - 1;
  while (lo < hi) {
    const middle = lo + hi >> 1;
    if (list[middle] < chainage) lo = middle + 1; else hi = middle;
  }
  return lo > 0 && chainage - list[lo - 1] <= list[lo] - chainage ? lo - 1 : lo;
}

/** Unit axis of the model's frame, by its number: +x, -x, +y, -y, +z, -z. */
function axisOf(number) {
  const axis = [0, 0, 0];
  axis[number >> 1] = number & 1 ? -1 : 1;
  return axis;
}

/** The vehicle at shown pose i: its directions, its middle, and its size along them. */
function vehicleAt(i) {
  const facts = page.facts, pose = poseAt(i), box = facts.inputs.model.box;
  const forward = axisOf(facts.page.forward), up = axisOf(facts.page.up), left = cross(up, forward);
  const size = box.hi.map((h, k) => h - box.lo[k]);
  const middle = times(plus(box.lo, box.hi), 0.5);
  const extent = (axis) => Math.abs(dot(axis, size));
  return {
    pose,
    forward: unit(turned(pose, forward)), left: unit(turned(pose, left)),
    up: unit(turned(pose, up)), middle: moved(pose, middle),
    length: extent(forward), width: extent(left), height: extent(up),
  };
}

/** Where a conflict is looked at: the nearest point, or else the middle of its points. */
function placeOf(conflict) {
  return inPage(conflict.nearest_point ?? conflict.centroid);
}

/** The model point nearest to a place, at a pose: {point, distance}. */
function nearestOfModel(pose, place) {
  const xyz = page.model.xyz, r = pose.r;
  const d = plus(place, pose.t, -1);
  // In the model's frame: its rotation's transpose is its inverse but for a non-rigid one.
  const e = [r[0] * d[0] + r[3] * d[1] + r[6] * d[2], r[1] * d[0] + r[4] * d[1] + r[7] * d[2],
             r[2] * d[0] + r[5] * d[1] + r[8] * d[2]];
  let best = Infinity, at = 0;
  for (let i = 0; i < xyz.length; i += 3) {
    const dx = xyz[i] - e[0], dy = xyz[i + 1] - e[1], dz = xyz[i + 2] - e[2];
    const d2 = dx * dx + dy * dy + dz * dz;
    if (d2 < best) { best = d2; at = i; }
  }
  return { point: moved(pose, [xyz[at], xyz[at + 1], xyz[at + 2]]), distance: Math.sqrt(best) };
}

/** Whether most of the path has something above it: a tunnel, a gallery, a hall. */
function isEnclosed() {
  const cells = new Map(), side = 1, n = page.poses.count;
  const key = (x, y) => Math.floor(x / side) * 1048576 + Math.floor(y / side);
  for (let k = 0; k < 500 && n > 0; ++k) {
    const m = vehicleAt(Math.floor(k * n / 500)).middle;
    cells.set(key(m[0], m[1]), false);
  }
  const { xyz, tag, count } = page.environment;
  for (let i = 0; i < count; ++i) {
    if (tag[i] < 128 + 3) continue;
    const at = key(xyz[3 * i], xyz[3 * i + 1]);
    if (cells.get(at) === false) cells.set(at, true);
  }
  const covered = [...cells.values()].filter((c) => c).length;
  return covered > 0.5 * cells.size;
}
