"""Opaque things whose shape is known, and scans of them by exact ray casting with noisy ranges."""

import functools
import struct

import numpy as np

# Metres; the step of the stores of these scenes. Scanners stand at multiples of it, so that noise
# and the rounding of points are the only errors.
QUANTUM = 0.001


class Box:
    """A box with any attitude. half: half its sides. turn: its axes as columns."""

    def __init__(self, centre, half, turn=np.eye(3)):
        self.centre, self.half, self.turn = np.array(centre), np.array(half), np.array(turn)

    def hits(self, origin, ways):
        """How far along each way its surface is; infinite where the ray misses."""
        start = (origin - self.centre) @ self.turn
        way = ways @ self.turn
        with np.errstate(divide="ignore"):
            a, b = (-self.half - start) / way, (self.half - start) / way
        enters, leaves = np.minimum(a, b).max(1), np.maximum(a, b).min(1)
        return np.where((enters <= leaves) & (enters > 0), enters, np.inf)

    def holds(self, points):
        """Whether each point is inside or on the surface."""
        return (np.abs((points - self.centre) @ self.turn) <= self.half + 1e-9).all(-1)

    def bounds(self):
        reach = np.abs(self.turn) @ self.half
        return self.centre - reach, self.centre + reach


class Cylinder:
    """An upright cylinder from the height `low` to `high`."""

    def __init__(self, x, y, radius, low, high):
        self.axis, self.radius, self.low, self.high = np.array([x, y]), radius, low, high

    def hits(self, origin, ways):
        start = origin[:2] - self.axis
        a = (ways[:, :2] ** 2).sum(1)
        b = ways[:, :2] @ start
        with np.errstate(divide="ignore", invalid="ignore"):
            root = np.sqrt(b * b - a * (start @ start - self.radius**2))
            low, high = (self.low - origin[2]) / ways[:, 2], (self.high - origin[2]) / ways[:, 2]
            enters = np.maximum((-b - root) / a, np.minimum(low, high))
            leaves = np.minimum((-b + root) / a, np.maximum(low, high))
        return np.where((enters <= leaves) & (enters > 0), enters, np.inf)

    def holds(self, points):
        across = ((points[..., :2] - self.axis) ** 2).sum(-1)
        return ((across <= (self.radius + 1e-9) ** 2) & (points[..., 2] >= self.low - 1e-9)
                & (points[..., 2] <= self.high + 1e-9))

    def bounds(self):
        return (np.append(self.axis - self.radius, self.low),
                np.append(self.axis + self.radius, self.high))


def turned(heading, lean):
    """Axes that are turned about z, and then lean to the side."""
    c, s, l, m = np.cos(heading), np.sin(heading), np.cos(lean), np.sin(lean)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ [[1, 0, 0], [0, l, -m], [0, m, l]]


class Scene:
    """Things on a thick floor between thick walls, and one to three scanners among them."""

    def __init__(self, random):
        # Faces at whole multiples of 0.4 m, so that cubes of 0.1, 0.2 and 0.4 m are flush with them,
        # which is the hardest case for noise.
        self.things = [Box([0, 0, -0.4], [6, 6, 0.4]), Box([-6.4, 0, 1.6], [0.4, 6, 1.6]),
                       Box([0, 6.4, 1.6], [6, 0.4, 1.6]), Box([2.4, -1.2, 0.8], [0.8, 0.8, 0.8])]
        for i in range(2):  # anywhere
            self.things.append(Box([random.uniform(-4, 4), random.uniform(2, 4), 1 + i],
                                   random.uniform(0.4, 1, 3)))
        self.things.append(Box([5.2, 0, 1.5], [0.7, 5, 1.9],  # a slanted wall
                               turned(random.uniform(-0.1, 0.1), random.uniform(0.1, 0.4))))
        self.things.append(Cylinder(-3, -2, random.uniform(0.5, 1), 0, 3))
        self.things.append(Cylinder(1, -4, random.uniform(0.5, 1), 0, 2))
        free = []
        while len(free) < 1 + random.integers(3):
            at = np.round(random.uniform([-5, -5, 0.8], [4, 5, 2.5]), 3)
            if not any(thing.holds(at) for thing in self.things):
                free.append(at)
        self.scanners = free

    def scan(self, random, rays, noise):
        """Points and, for each, its scanner. noise(n): errors of n ranges, metres."""
        points, of = [], []
        for i, origin in enumerate(self.scanners):
            ways = random.normal(size=(rays, 3))
            ways /= np.linalg.norm(ways, axis=1)[:, None]
            ranges = np.min([thing.hits(origin, ways) for thing in self.things], axis=0)
            hit = np.isfinite(ranges)
            ranges = ranges[hit] + noise(hit.sum())
            points.append(origin + ranges[:, None] * ways[hit])
            of.append(np.full(hit.sum(), i))
        return np.concatenate(points), np.concatenate(of)

    @functools.cache
    def cubes_inside(self, side):
        """The cubes that lie in one thing with all of their closed volume, and those of them that
        have a neighbour which does not: the skin, which noise can reach. As keys(), ascending."""
        inside, skin = [], []
        for thing in self.things:
            low, high = thing.bounds()
            ranges = [np.arange(int(np.floor(a / side)), int(np.ceil(b / side)) + 1)
                      for a, b in zip(low - side, high + side)]
            cubes = np.stack(np.meshgrid(*ranges, indexing="ij"), -1)
            corners = np.stack(np.meshgrid(*[[0, 1]] * 3, indexing="ij"), -1).reshape(-1, 3)
            held = thing.holds((cubes[..., None, :] + corners) * side).all(-1)
            deep = held.copy()  # cubes at the ends of the array are never inside
            for axis in range(3):
                for step in (-1, 1):
                    deep &= np.roll(held, step, axis)
            inside.append(keys(cubes[held]))
            skin.append(keys(cubes[held & ~deep]))
        return np.unique(np.concatenate(inside)), np.unique(np.concatenate(skin))


def keys(cubes):
    """One number for each row of three indices."""
    far = cubes.astype(np.int64) + 2**20
    return far[:, 0] << 42 | far[:, 1] << 21 | far[:, 2]


def write_las(path, points, quantum=QUANTUM):
    """LAS 1.2, without an offset."""
    header = bytearray(227)
    header[0:4] = b"LASF"
    header[24:26] = bytes((1, 2))
    struct.pack_into("<HII", header, 94, 227, 227, 0)
    struct.pack_into("<BHI", header, 104, 0, 20, len(points))
    struct.pack_into("<6d", header, 131, *[quantum] * 3, 0, 0, 0)
    box = np.array([points.max(0), points.min(0)])
    struct.pack_into("<6d", header, 179, *box.T.ravel())
    records = np.zeros(len(points), [("xyz", "<i4", 3), ("rest", "V8")])
    records["xyz"] = np.rint(points / quantum)
    path.write_bytes(bytes(header) + records.tobytes())


def write_origins(path, scanners, of):
    """The places of scanners, for points in the order of their scanner."""
    first = np.searchsorted(of, np.arange(len(scanners)))
    path.write_text("first,x,y,z\n" + "".join(
        f"{at},{x:.3f},{y:.3f},{z:.3f}\n" for at, (x, y, z) in zip(first, scanners)))
