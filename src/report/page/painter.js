// Draws points on a 2-D canvas: the pictures, the plan, and the 3-D view where there is no WebGL.

/** Points of a stamp of that shape, as offsets in pixels. */
function stampOf(shape, size) {
  const half = Math.max(0, (size - 1) / 2), out = [];
  for (let y = -Math.floor(half); y <= Math.ceil(half); ++y) {
    for (let x = -Math.floor(half); x <= Math.ceil(half); ++x) {
      const inside = shape === "diamond" ? Math.abs(x) + Math.abs(y) <= half + 0.5
          : shape === "triangle" ? Math.abs(x) <= (y + half) / 2 + 0.5
          : shape === "round" ? x * x + y * y <= (half + 0.3) * (half + 0.3) : true;
      if (inside) out.push([x, y]);
    }
  }
  return out;
}

/**
 * camera: {origin, right, up, toViewer (unit vectors), halfWidth, halfHeight (metres),
 * distance (of the eye from origin; 0: parallel)}.
 */
class Projection {
  constructor(width, height, camera) {
    Object.assign(this, { width, height, camera, perMetre: width / (2 * camera.halfWidth) });
  }

  /** [x, y, depth] in pixels; depth in metres, larger is nearer. null behind the eye. */
  project(p) {
    const c = this.camera, d = plus(p, c.origin, -1);
    const depth = dot(d, c.toViewer);
    if (c.distance && depth > 0.98 * c.distance) return null;
    const f = c.distance ? c.distance / (c.distance - depth) : 1;
    return [this.width / 2 + dot(d, c.right) * f * this.perMetre,
            this.height / 2 - dot(d, c.up) * f * this.perMetre, depth];
  }
}

class Painter extends Projection {
  constructor(width, height, camera) {
    super(width, height, camera);
    this.image = new ImageData(width, height);
    this.pixels = new Uint32Array(this.image.data.buffer);
    this.depth = new Float32Array(width * height).fill(-Infinity);
  }

  sees(chunk, lo, hi) {
    const c = this.camera, d = plus(chunk.centre, c.origin, -1);
    const reach = (axis) => Math.abs(axis[0]) * chunk.half[0] + Math.abs(axis[1]) * chunk.half[1] +
        Math.abs(axis[2]) * chunk.half[2];
    const depth = dot(d, c.toViewer), thick = reach(c.toViewer);
    if (depth - thick > hi || depth + thick < lo) return false;
    if (c.distance) return depth - thick < c.distance;
    return Math.abs(dot(d, c.right)) <= c.halfWidth + reach(c.right) &&
        Math.abs(dot(d, c.up)) <= c.halfHeight + reach(c.up);
  }

  /**
   * set: of columns.js. how: {colour(i) -> 0xAABBGGRR, stamp, lo, hi (depths drawn), keep(i),
   * over: on top of all that is there}. Returns the number of points drawn.
   */
  points(set, how) {
    const c = this.camera, { width, height, pixels, depth: depths } = this;
    const { lo = -Infinity, hi = Infinity, stamp = [[0, 0]], keep, colour, over } = how;
    const [rx, ry, rz] = c.right, [ux, uy, uz] = c.up, [vx, vy, vz] = c.toViewer;
    const xyz = set.xyz, [ox, oy, oz] = c.origin, s = this.perMetre;
    let drawn = 0;
    for (const chunk of set.chunks) {
      if (!this.sees(chunk, lo, hi)) continue;
      for (let i = chunk.first; i < chunk.first + chunk.count; ++i) {
        const x = xyz[3 * i] - ox, y = xyz[3 * i + 1] - oy, z = xyz[3 * i + 2] - oz;
        const depth = x * vx + y * vy + z * vz;
        if (depth < lo || depth > hi || (keep && !keep(i))) continue;
        if (c.distance && depth > 0.98 * c.distance) continue;
        const f = c.distance ? s * c.distance / (c.distance - depth) : s;
        const px = width / 2 + (x * rx + y * ry + z * rz) * f | 0;
        const py = height / 2 - (x * ux + y * uy + z * uz) * f | 0;
        if (px < -8 || py < -8 || px > width + 8 || py > height + 8) continue;
        const value = colour(i);
        ++drawn;
        for (const [dx, dy] of stamp) {
          const qx = px + dx, qy = py + dy;
          if (qx < 0 || qy < 0 || qx >= width || qy >= height) continue;
          const at = qy * width + qx;
          if (!over && depths[at] >= depth) continue;
          depths[at] = depth;
          pixels[at] = value;
        }
      }
    }
    return drawn;
  }

  /** Darkens what lies behind its neighbours in the picture, so that shapes stand out. */
  shade(strength = 1) {
    const { width, height, pixels, depth } = this, scale = this.perMetre;
    const reach = Math.max(1, Math.round(width / 700));
    const out = new Uint32Array(pixels.length);
    for (let y = 0; y < height; ++y) {
      for (let x = 0; x < width; ++x) {
        const at = y * width + x, value = pixels[at];
        if (value === 0) continue;
        const own = depth[at];
        let hidden = 0;
        for (const [dx, dy] of [[reach, 0], [-reach, 0], [0, reach], [0, -reach]]) {
          const qx = x + dx, qy = y + dy;
          if (qx < 0 || qy < 0 || qx >= width || qy >= height) continue;
          const difference = depth[qy * width + qx] - own;
          if (difference > 0) hidden += Math.min(1, difference * scale / (12 * reach));
        }
        const f = Math.exp(-0.55 * strength * hidden);
        out[at] = 0xff000000 | (value >> 16 & 255) * f << 16 | (value >> 8 & 255) * f << 8 |
            (value & 255) * f;
      }
    }
    pixels.set(out);
  }

  show(context) { putImage(context, this.image); }
}

/** Draws an image onto a canvas, whose own content stays where the image is clear. */
function putImage(context, image) {
  const holder = new OffscreenCanvas(image.width, image.height);
  holder.getContext("2d").putImageData(image, 0, 0);
  context.drawImage(holder, 0, 0);
}

const packed = ([r, g, b]) => (255 << 24 | b << 16 | g << 8 | r) >>> 0;

/** Grey of an environment point by its height above the vehicle's top, a tenth of a metre a step. */
const environmentColours = (() => {
  const low = [92, 105, 122], middle = [148, 158, 168], high = [196, 190, 176];
  return Uint32Array.from({ length: 256 }, (_, tag) => {
    const t = clamp((tag - 128 + 30) / 60, 0, 1);
    return packed(t < 0.5 ? mix(low, middle, 2 * t) : mix(middle, high, 2 * t - 1));
  });
})();

const classColours = page.facts.classes.map((c) => packed(kClassWords[c.name].rgb));
const classShapes = page.facts.classes.map((c) => kClassWords[c.name].shape);

/** The environment, in greys. */
function paintEnvironment(painter, how = {}) {
  const { tag } = page.environment;
  return painter.points(page.environment,
                        { colour: (i) => environmentColours[tag[i]], ...how });
}

/** Colliding and near points by class, the worst on top. how.size: of a stamp in pixels. */
function paintClasses(painter, how = {}) {
  const { tag } = page.points;
  for (let k = page.facts.classes.length - 1; k >= 0; --k) {
    if (how.hidden && how.hidden[k]) continue;
    const stamp = stampOf(classShapes[k], k === 0 ? how.size : Math.max(2, how.size - 1));
    painter.points(page.points, {
      ...how, stamp, keep: (i) => tag[i] === k && (!how.keep || how.keep(i)),
      colour: () => classColours[k],
    });
  }
}
