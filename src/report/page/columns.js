/** The bytes of a column: base64 of a zlib stream. The text leaves the page. */
async function columnBytes(name) {
  const holder = document.querySelector(`script[data-column="${name}"]`);
  if (!holder) return null;
  const text = holder.textContent;
  holder.remove();
  const packed = Uint8Array.fromBase64 ? Uint8Array.fromBase64(text) : decodeBase64(text);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function decodeBase64(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** Differences in zigzag, in four planes of bytes, to the integers they are of. */
function integersOf(bytes) {
  if (!bytes) return null;
  const n = bytes.length / 4;
  const out = new Int32Array(n);
  let value = 0;
  for (let i = 0; i < n; ++i) {
    const zigzag = bytes[i] | bytes[n + i] << 8 | bytes[2 * n + i] << 16 | bytes[3 * n + i] << 24;
    value = value + (zigzag >>> 1 ^ -(zigzag & 1)) | 0;
    out[i] = value;
  }
  return out;
}

const kChunk = 2048;

/** Runs of neighbouring points with their boxes: what is not in sight is left out by them. */
function chunksOf(xyz) {
  const chunks = [];
  for (let first = 0; first < xyz.length / 3; first += kChunk) {
    const count = Math.min(kChunk, xyz.length / 3 - first);
    const lo = [Infinity, Infinity, Infinity], hi = [-Infinity, -Infinity, -Infinity];
    for (let i = 3 * first; i < 3 * (first + count); i += 3) {
      for (let k = 0; k < 3; ++k) {
        if (xyz[i + k] < lo[k]) lo[k] = xyz[i + k];
        if (xyz[i + k] > hi[k]) hi[k] = xyz[i + k];
      }
    }
    const centre = lo.map((l, k) => (l + hi[k]) / 2), half = lo.map((l, k) => (hi[k] - l) / 2);
    chunks.push({ first, count, centre, half });
  }
  return chunks;
}

/** A point set: {count, xyz, tag, chunks}. offset: of the lattice's origin from the page's. */
async function readPoints(name, lattice, offset = [0, 0, 0]) {
  const names = [".x", ".y", ".z", ".tag"].map((end) => name + end);
  const [x, y, z, tag] = await Promise.all(names.map(columnBytes));
  const axes = [x, y, z].map(integersOf);
  const count = tag.length;
  const xyz = new Float32Array(3 * count);
  for (let k = 0; k < 3; ++k) {
    for (let i = 0; i < count; ++i) xyz[3 * i + k] = axes[k][i] * lattice.step + offset[k];
  }
  return { count, xyz, tag, chunks: chunksOf(xyz) };
}

/** A label of the shown poses: numbers, or texts in lines. */
async function readLabel({ key, step, origin }) {
  const bytes = await columnBytes("pose." + key);
  return step === undefined ? new TextDecoder().decode(bytes).split("\n")
                            : Float64Array.from(integersOf(bytes), (n) => n * step + origin);
}

/** Columns of integers by their names; null where the page lacks one. */
async function readIntegers(kind, names) {
  const read = async (name) => [name, integersOf(await columnBytes(`${kind}.${name}`))];
  return Object.fromEntries(await Promise.all(names.map(read)));
}

/** Places and rotations of poses, and further columns of integers. */
async function readPlaces(kind, ...names) {
  const rotation = await readIntegers(kind, [...Array(9).keys()].map((k) => `r${k}`));
  return { ...await readIntegers(kind, ["x", "y", "z", ...names]), rotation: Object.values(rotation) };
}

async function readPoses() {
  const facts = page.facts.page, start = page.facts.inputs.trajectory.chainage_start;
  const poses = await readPlaces("pose", "index", "chainage", "distance", "px", "py", "pz");
  const labels = await Promise.all(facts.labels.map(async (label) => [label.key, await readLabel(label)]));
  return { ...poses, count: poses.index?.length ?? 0, labels: Object.fromEntries(labels),
           chainage: Float64Array.from(poses.chainage ?? [], (c) => start + c * facts.chainage_step) };
}

/** Which of the model's points each body has: {first, count}. */
function bodyRanges() {
  let first = 0;
  const bodies = page.facts.inputs.model.bodies ?? [{ shown_points: page.model.count }];
  return bodies.map(({ shown_points: count }) => {
    first += count;
    return { first: first - count, count };
  });
}

async function readAll() {
  const facts = page.facts.page;
  [page.environment, page.points, page.model, page.poses, page.bodyPoses] = await Promise.all([
    readPoints("environment", facts.environment_lattice),
    readPoints("points", facts.lattice),
    readPoints("model", facts.model_lattice, facts.model_lattice.origin),
    readPoses(),
    page.facts.inputs.model.bodies && readPlaces("body", "there"),
  ]);
  page.model.ranges = bodyRanges();
  if (page.facts.seen?.list.length > 0) page.unseen = await readPoints("unseen", facts.lattice);
}
