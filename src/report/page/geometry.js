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

function poseOfColumns(poses, i) {
  const facts = page.facts.page, step = facts.lattice.step;
  const r = poses.rotation.map((column) => column[i] * facts.rotation_step);
  return { r, t: [poses.x[i] * step, poses.y[i] * step, poses.z[i] * step] };
}

/** Shown pose i: rotation (rows) and place. */
const poseAt = (i) => poseOfColumns(page.poses, i);

/** Of that body; null where it has none. The model alone is body 0. */
function bodyPoseAt(i, body) {
  if (!page.bodyPoses) return poseAt(i);
  const at = body * page.poses.count + i;
  return page.bodyPoses.there[at] ? poseOfColumns(page.bodyPoses, at) : null;
}

/** What moves as one: the model, or each body of the vehicle. */
const bodyFacts = () => page.facts.inputs.model.bodies ?? [page.facts.inputs.model];

/** The number of the body with that name; undefined where there is but the model. */
function bodyNumber(name) {
  return name === undefined ? undefined : bodyFacts().findIndex((b) => b.name === name);
}

/** The bodies that are there at shown pose i: [{body, pose}]. */
function bodiesAt(i) {
  return bodyFacts().map((_, body) => ({ body, pose: bodyPoseAt(i, body) })).filter((b) => b.pose);
}

const turned = (pose, v) => [dot(pose.r.slice(0, 3), v), dot(pose.r.slice(3, 6), v),
                             dot(pose.r.slice(6, 9), v)];
const moved = (pose, m) => plus(turned(pose, m), pose.t);
/** Back into the pose's frame: its rotation's transpose is its inverse but for a non-rigid one. */
function movedBack(pose, p) {
  const r = pose.r, d = plus(p, pose.t, -1);
  return [0, 1, 2].map((k) => r[k] * d[0] + r[3 + k] * d[1] + r[6 + k] * d[2]);
}

/** The index of the first value of an ascending list that is there already, or else the list's length. */
function firstThat(list, isThere) {
  let lo = 0, hi = list.length;
  while (lo < hi) {
    const middle = lo + hi >> 1;
    if (isThere(list[middle])) hi = middle; else lo = middle + 1;
  }
  return lo;
}

/** The same among the shown poses; the last of them where no value is there. */
const firstPoseThat = (list, isThere) => clamp(firstThat(list ?? [], isThere), 0, Math.max(0, page.poses.count - 1));

/** Of the pose with that index in the trajectory, or the next one that the page has. */
const shownPose = (index) => firstPoseThat(page.poses.index, (i) => i >= index);

/** The shown pose nearest to a chainage; of equals the first. */
function poseAtChainage(chainage) {
  const list = page.poses.chainage, at = firstPoseThat(list, (c) => c >= chainage);
  return at > 0 && chainage - list[at - 1] <= list[at] - chainage ? at - 1 : at;
}

/** The places of a point set, one after the other. */
function* placesOf({ xyz }) {
  for (let i = 0; i < xyz.length; i += 3) yield [xyz[i], xyz[i + 1], xyz[i + 2]];
}

/** The box around places; nothing where there are none. */
function boxAround(places) {
  const lo = [Infinity, Infinity, Infinity], hi = [-Infinity, -Infinity, -Infinity];
  for (const place of places) {
    place.forEach((v, k) => {
      lo[k] = Math.min(lo[k], v);
      hi[k] = Math.max(hi[k], v);
    });
  }
  return places.length > 0 ? { lo, hi } : undefined;
}

/** Unit axis of the model's frame, by its number: +x, -x, +y, -y, +z, -z. */
function axisOf(number) {
  const axis = [0, 0, 0];
  axis[number >> 1] = number & 1 ? -1 : 1;
  return axis;
}

/** Around all bodies at shown pose i, in the frame of a pose. */
function jointBox(i, pose) {
  const corners = ({ lo, hi }) => [...Array(8).keys()].map((corner) => [0, 1, 2].map((k) => (corner >> k & 1 ? hi : lo)[k]));
  return boxAround(bodiesAt(i).flatMap(({ body, pose: its }) =>
      corners(bodyFacts()[body].box).map((m) => movedBack(pose, moved(its, m))))) ?? { lo: [0, 0, 0], hi: [0, 0, 0] };
}

/**
 * The vehicle at shown pose i: its directions, its middle, and its size along them. body: of that
 * one alone, where it is there.
 */
function vehicleAt(i, body) {
  const facts = page.facts, own = page.bodyPoses && body !== undefined ? bodyPoseAt(i, body) : null;
  const pose = own ?? poseAt(i);
  const box = own ? bodyFacts()[body].box : page.bodyPoses ? jointBox(i, pose) : facts.inputs.model.box;
  const forward = axisOf(facts.page.forward), up = axisOf(facts.page.up), left = cross(up, forward);
  const size = box.hi.map((h, k) => h - box.lo[k]);
  const middle = times(plus(box.lo, box.hi), 0.5);
  const extent = (axis) => Math.abs(dot(axis, size));
  return {
    shown: i, pose,
    forward: unit(turned(pose, forward)), left: unit(turned(pose, left)),
    up: unit(turned(pose, up)), middle: moved(pose, middle),
    length: extent(forward), width: extent(left), height: extent(up),
  };
}

/** The diagonal of its box; of a vehicle with bodies the greatest at some of its poses. */
function sizeOfVehicle() {
  const diagonal = (box) => length(plus(box.hi, box.lo, -1)), n = page.poses.count;
  if (!page.bodyPoses) return diagonal(page.facts.inputs.model.box);
  const some = [...Array(Math.min(n, 50)).keys()].map((k) => Math.floor((k + 0.5) * n / Math.min(n, 50)));
  return Math.max(0.1, ...some.map((i) => diagonal(jointBox(i, poseAt(i)))));
}

/** Where a conflict is shown: the nearest point, or else the middle of its points. */
function placeOf(conflict) {
  return inPage(conflict.nearest_point ?? conflict.centroid);
}

/** The model point nearest to a place, at shown pose i: {point, distance}. */
function nearestOfModel(shown, place) {
  const xyz = page.model.xyz;
  let best = Infinity, point = place;
  for (const { body, pose } of bodiesAt(shown)) {
    const e = movedBack(pose, place), { first, count } = page.model.ranges[body];
    let at = -1;
    for (let i = 3 * first; i < 3 * (first + count); i += 3) {
      const dx = xyz[i] - e[0], dy = xyz[i + 1] - e[1], dz = xyz[i + 2] - e[2];
      const d2 = dx * dx + dy * dy + dz * dz;
      if (d2 < best) { best = d2; at = i; }
    }
    if (at >= 0) point = moved(pose, [xyz[at], xyz[at + 1], xyz[at + 2]]);
  }
  return { point, distance: Math.sqrt(best) };
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
