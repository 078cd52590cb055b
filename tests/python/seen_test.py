"""Seen space in random scenes is what its definition says: which cubes a vehicle sweeps that no beam
saw, and which cells of a section are blocked or, over such cubes, not known. Beams are followed in
exact integers, places are computed in double in the documented order of operations, and all pairs
are looked at.

Usage: PYTHONPATH=BUILD/python seen_test.py
"""

import itertools
import math
import random
import tempfile
import unittest

import clearway
import numpy as np
from scene import write_las

SCENES = 24
SECTIONS = 40
UNIT = 2.0**-53
MILLIMETRE = (0.001, 0.002, 0.0005, 0.01, 0.004)
OFFSETS = ((0.0, 0.0, 0.0), (450000.0, 5400000.0, 100.0), (-1000.5, -77.0, -3.25))


def rounded(x):
    """As llround() does."""
    return int(math.floor(abs(x) + 0.5)) * (1 if x >= 0 else -1)


def rotation(rng):
    w, x, y, z = np.array(v := [rng.gauss(0, 1) for _ in range(4)]) / math.hypot(*v)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def meet(origin, end, least, greatest):
    """Whether the closed segment and the closed box share a point. All are integers, and so are the
    parts of a fraction (n, d), d > 0, so that the answer is exact."""
    enter, leave = (0, 1), (1, 1)
    for o, e, lo, hi in zip(origin, end, least, greatest):
        if o < lo and e < lo or o > hi and e > hi:
            return False
        if o != e:
            n, m, d = (lo - o, hi - o, e - o) if e > o else (o - hi, o - lo, o - e)
            if n * enter[1] > enter[0] * d:
                enter = (n, d)
            if m * leave[1] < leave[0] * d:
                leave = (m, d)
    return enter[0] * leave[1] <= leave[0] * enter[1]


class Scene:
    """Poses, a model, and beams that aim at it, some of them at corners of inner cubes."""

    def __init__(self, seed):
        self.rng = rng = random.Random(seed)
        self.scale = np.array([rng.choice(MILLIMETRE) for _ in range(3)])
        self.offset = np.array(rng.choice(OFFSETS))
        self.middle = np.array([rng.uniform(-30, 30) for _ in range(3)])
        self.cube = rng.choice((0.1, 0.15, 0.2, 0.3))
        self.sides = [rounded(self.cube / s) for s in self.scale]
        self.radius = rng.choice((0.05, 0.1, 0.2))
        self.between_poses = rng.random() < 0.5
        self.seen_min = rng.choice((1, 3, 8))
        self.model = np.array([[rng.uniform(-0.4, 0.4) for _ in range(3)]
                               for _ in range(rng.randint(1, 8))])
        self.poses = np.tile(np.eye(4), (rng.randint(1, 6), 1, 1))
        for i, pose in enumerate(self.poses):
            pose[:3, :3] = rotation(rng)
            step = [rng.uniform(-0.4, 0.4) for _ in range(3)]
            pose[:3, 3] = self.middle + self.offset if i == 0 else self.poses[i - 1, :3, 3] + step
        self.make_beams(rng.randint(20, 300))

    def corner(self, near):
        inset = [self.rng.choice((0, h // 4, h - h // 4)) for h in self.sides]
        return np.array([h * round(p / s / h) + i
                         for h, p, s, i in zip(self.sides, near, self.scale, inset)]) * self.scale

    def make_beams(self, count):
        rng, self.origins, self.quanta = self.rng, [], []
        origin = None
        for _ in range(count):
            if origin is None or rng.random() < 0.1:
                origin = self.middle + [rng.uniform(-5, 5) for _ in range(3)]
                if rng.random() < 0.1:  # too long a beam, or nearly
                    origin = self.middle + [rng.choice((-1, 1)) * rng.uniform(900, 1100), 0, 0]
                elif rng.random() < 0.2:
                    origin = self.corner(self.middle)
            aim = self.middle + [rng.gauss(0, 0.35) for _ in range(3)]
            kind = rng.random()
            if kind < 0.4:
                aim = origin + (aim - origin) * rng.uniform(1, 1.2)
            elif kind < 0.5:
                aim = origin
            elif kind < 0.6:
                aim[rng.randrange(3)] = origin[rng.randrange(3)]
            elif kind < 0.7:
                aim = self.corner(aim)
            self.origins.append(origin)
            self.quanta.append([rounded(a / s) for a, s in zip(aim, self.scale)])

    def write(self, folder):
        write_las(f"{folder}/scan.las", self.quanta, self.scale, self.offset)
        with open(f"{folder}/origins.csv", "w") as file:
            file.write("first,x,y,z\n")
            for i, origin in enumerate(self.origins):
                if i == 0 or origin is not self.origins[i - 1]:
                    place = ",".join(repr(float(v)) for v in origin + self.offset)
                    file.write(f"{i},{place}\n")
        clearway.convert(f"{folder}/scan.las", f"{folder}/site.h5", overwrite=True,
                         origins=f"{folder}/origins.csv", cell_points=256)

    def search(self, folder):
        errors = {"error_pose": 0.01, "error_scan": 0.002} if self.rng.random() < 0.3 else {}
        query = clearway.Query(self.model, self.poses, self.radius, seen=True,
                               seen_cube=self.cube, seen_min=self.seen_min,
                               between_poses=self.between_poses, **errors)
        found = clearway.search(clearway.Store(f"{folder}/site.h5"), query, f"{folder}/out.h5",
                                device="cpu", overwrite=True)
        margin = found.margins["clear"] if found.margins else 0
        return found, self.radius + margin

    def swept(self, radius):
        """The first pose of each swept cube; None where a cube is too near to the limit to tell."""
        places = self.model @ np.swapaxes(self.poses[:, :3, :3], 1, 2) + self.poses[:, None, :3, 3]
        flat = places.reshape(-1, 3)
        ends = [(flat.min(0) - radius - self.offset) / self.scale / self.sides - 1,
                (flat.max(0) + radius - self.offset) / self.scale / self.sides + 1]
        ranges = [range(math.floor(lo), math.ceil(hi) + 1) for lo, hi in zip(*ends)]
        cubes = np.array(list(itertools.product(*ranges)))
        middles = (cubes * np.array(self.sides, float) + np.array(self.sides) / 2) * self.scale
        middles += self.offset
        first = {}
        ways = len(places) - 1 if self.between_poses and len(places) > 1 else len(places)
        for way in reversed(range(ways)):
            end = way + 1 if self.between_poses and len(places) > 1 else way
            least = np.full(len(cubes), np.inf)
            for a, b in zip(places[way], places[end]):
                length = (b - a) @ (b - a)
                part = np.clip((middles - a) @ (b - a) / length, 0, 1) if length > 0 else 0
                nearest = a + np.multiply.outer(part, b - a) if length > 0 else a
                least = np.minimum(least, np.linalg.norm(middles - nearest, axis=1))
            if (abs(least - radius) < 1e-9).any():
                return None
            first.update({tuple(map(int, c)): way for c in cubes[least < radius]})
        return first

    def seen_by(self, start, end, low, high):
        """Which of the boxes the beam meets; none where it is too long or has no length."""
        way = [abs(a - b) for a, b in zip(start, end)]
        if start == end or max(way) >= 2**30 or math.hypot(
                *(w * s for w, s in zip(way, self.scale))) > 1000:
            return []
        a, b = np.minimum(start, end), np.maximum(start, end)
        return [n for n in np.flatnonzero((a <= high).all(1) & (b >= low).all(1))
                if meet(start, end, [int(v) for v in low[n]], [int(v) for v in high[n]])]

    def unseen(self, cubes):
        """Which of the cubes no beam saw."""
        sides = np.array(self.sides)
        low, high = cubes * sides + sides // 4, (cubes + 1) * sides - sides // 4
        unseen = np.ones(len(cubes), bool)
        for origin, end in zip(self.origins, self.quanta):
            start = [rounded(v) for v in (origin + self.offset - self.offset) / self.scale]
            unseen[self.seen_by(start, end, low, high)] = False
        return unseen


def pull_back(pose):
    """Cofactors by rows and the determinant, in the documented order of operations."""
    r = [float(v) for v in pose[:3, :3].ravel()]
    minor = lambda a, b, c, d: r[a] * r[b] - r[c] * r[d]
    rows = ((minor(4, 8, 5, 7), minor(2, 7, 1, 8), minor(1, 5, 2, 4)),
            (minor(5, 6, 3, 8), minor(0, 8, 2, 6), minor(2, 3, 0, 5)),
            (minor(3, 7, 4, 6), minor(1, 6, 0, 7), minor(0, 4, 1, 3)))
    return rows, (rows[0][0] * r[0] + rows[0][1] * r[3]) + rows[0][2] * r[6]


def dot(row, v):
    return (row[0] * v[0] + row[1] * v[1]) + row[2] * v[2]


class SectionScene(Scene):
    """A scene that is asked for a section."""

    def __init__(self, seed):
        super().__init__(seed)
        rng = random.Random(1000 + seed)
        self.rear = rng.uniform(-0.5, 0.1)
        self.front = self.rear + rng.choice((0, 0.3, 0.8))
        self.window = (-rng.uniform(0.1, 0.6), rng.uniform(0.1, 0.6),
                       -rng.uniform(0.1, 0.5), rng.uniform(0.1, 0.5))
        self.cell = rng.choice((0.04, 0.07, 0.1))
        self.bin = rng.choice((0.2, 0.5, 50))
        self.margin = rng.choice((0, 0.05))
        if rng.random() < 0.5:  # upright, as vehicles drive
            for pose in self.poses:
                angle = rng.uniform(-3, 3)
                pose[:2, :2] = [[math.cos(angle), -math.sin(angle)],
                                [math.sin(angle), math.cos(angle)]]
                pose[2, :3] = pose[:3, 2] = (0, 0, 1)
        elif rng.random() < 0.5:  # along the axes, where cubes and cells have common borders
            for pose in self.poses:
                pose[:3, :3] = np.eye(3)[list(rng.choice([(0, 1, 2), (1, 2, 0), (2, 0, 1)]))]

    def find(self, folder, **more):
        return clearway.find_section(
            clearway.Store(f"{folder}/site.h5"), self.poses, f"{folder}/section.h5", self.rear,
            self.front, window=self.window, cell=self.cell, bin=self.bin, margin=self.margin,
            seen=True, seen_cube=self.cube, overwrite=True, **more)

    def oracle(self, rounding):
        """({(bin, k, j): pose} of blocked cells, and that of cells that are not known)."""
        g = self.cell
        self.low = [math.floor(self.window[0] / g), math.floor(self.window[2] / g)]
        self.high = [math.ceil(self.window[1] / g), math.ceil(self.window[3] / g)]
        self.x_from, self.x_to = self.rear - self.margin, self.front + self.margin
        half = [0.5 * h * float(s) for h, s in zip(self.sides, self.scale)]
        slack = rounding + 2048 * UNIT * ((half[0] + half[1]) + half[2])
        cubes, middles = self.unseen_cubes()
        points = np.array(self.quanta, float) * self.scale + self.offset
        blocked, unknown, chainage = {}, {}, 0.0
        for i, pose in enumerate(self.poses):
            if i > 0:
                step = pose[:3, 3] - self.poses[i - 1, :3, 3]
                chainage += math.sqrt((step[0] * step[0] + step[1] * step[1]) + step[2] * step[2])
            bin_number = math.floor(chainage / self.bin)
            rows, determinant = pull_back(pose)
            def places(of):
                d = (of - pose[:3, 3]).T
                return np.array([dot(row, d) / determinant for row in rows])
            for (k, j) in self.cells_of_points(places(points)):
                blocked.setdefault((bin_number, k, j), i)
            extent = [dot([abs(v) for v in row], half) / abs(determinant) for row in rows]
            place = places(middles) if len(middles) else np.empty((3, 0))
            low = np.array([(place[a] - extent[a]) - slack for a in range(3)])
            high = np.array([(place[a] + extent[a]) + slack for a in range(3)])
            for n in np.flatnonzero((low[0] <= self.x_to) & (high[0] >= self.x_from)):
                first = [max(math.floor(low[a, n] / g), self.low[a - 1]) for a in (1, 2)]
                last = [min(math.floor(high[a, n] / g), self.high[a - 1] - 1) for a in (1, 2)]
                for k in range(first[1], last[1] + 1):
                    for j in range(first[0], last[0] + 1):
                        unknown.setdefault((bin_number, k, j), i)
        return blocked, {key: pose for key, pose in unknown.items()
                         if pose < blocked.get(key, math.inf)}

    def cells_of_points(self, places):
        inside = (places[0] >= self.x_from) & (places[0] <= self.x_to)
        j, k = np.floor(places[1] / self.cell), np.floor(places[2] / self.cell)
        inside &= (j >= self.low[0]) & (j < self.high[0]) & (k >= self.low[1]) & (k < self.high[1])
        return {(int(b), int(a)) for a, b in zip(j[inside], k[inside])}

    def unseen_cubes(self):
        """All cubes anywhere near the load that no beam saw, and their middles."""
        reach = max(abs(self.rear), abs(self.front)) + self.margin + 1.3 + 2 * self.cube
        ends = [(f(self.poses[:, :3, 3]) + s * reach - self.offset) / self.scale / self.sides
                for f, s in ((lambda p: p.min(0), -1), (lambda p: p.max(0), 1))]
        ranges = [np.arange(math.floor(lo), math.ceil(hi) + 1) for lo, hi in zip(*ends)]
        cubes = np.stack(np.meshgrid(*ranges, indexing="ij"), -1).reshape(-1, 3)
        sides = np.array(self.sides)
        middles = (cubes * sides.astype(float) + 0.5 * sides) * self.scale + self.offset
        near = np.zeros(len(cubes), bool)  # what is farther than the box has no cell of the window
        for pose in self.poses:
            place = (middles - pose[:3, 3]) @ pose[:3, :3]
            far = np.array([max(abs(self.x_from), abs(self.x_to)),
                            max(map(abs, self.window[:2])), max(map(abs, self.window[2:]))])
            near |= (np.abs(place) <= far + 2 * self.cube + 0.2).all(axis=1)
        cubes, middles = cubes[near], middles[near]
        open_ = self.unseen(cubes)
        return cubes[open_], middles[open_]


def rows(cells):
    keys = list(zip(*(map(int, c) for c in (cells.bin, cells.k, cells.j)))) if len(cells) else []
    assert keys == sorted(set(keys))
    return dict(zip(keys, map(int, cells.first_pose)))


class SeenSpace(unittest.TestCase):
    def scenes(self, made, count):
        with tempfile.TemporaryDirectory() as folder:
            for seed in range(count):
                scene = made(seed)
                if min(scene.sides) >= 4:
                    scene.write(folder)
                    with self.subTest(seed=seed):
                        yield folder, scene

    def test_cubes_that_a_vehicle_sweeps_unseen(self):
        swept_cubes = seen_cubes = 0
        for folder, scene in self.scenes(Scene, SCENES):
            found, radius = scene.search(folder)
            first = scene.swept(radius)
            if first is None:
                continue
            cubes = np.array(sorted(first))
            unseen = [tuple(map(int, c)) for c in cubes[scene.unseen(cubes)]]
            told = clearway.Result(f"{folder}/out.h5").unseen()
            self.assertEqual(found.seen.swept, len(first))
            self.assertEqual([tuple(map(int, c)) for c in told.cube], unseen)
            self.assertEqual(list(told.first_pose), [first[c] for c in unseen])
            big = sum(np.bincount(told.group)[1:] >= scene.seen_min) if unseen else 0
            self.assertEqual(found.seen.listed_groups, big)
            self.assertEqual("not-scanned" in found.reasons,
                             big > 0 and found.verdict != "conflict")
            swept_cubes += len(first)
            seen_cubes += len(first) - len(unseen)
        self.assertGreater(swept_cubes, 8_000)
        self.assertGreater(seen_cubes, 200)

    def test_cells_of_a_section_that_are_blocked_or_not_known(self):
        blocked_cells = unknown_cells = free = 0
        for folder, scene in self.scenes(SectionScene, SECTIONS):
            report = scene.find(folder, threads=1 + scene.rng.randrange(3))
            section = clearway.Section(f"{folder}/section.h5")
            blocked, unknown = scene.oracle(section.rounding())
            self.assertEqual(rows(section.bin_cells()), blocked)
            self.assertEqual(rows(section.unknown_bin_cells()), unknown)
            first, known = {}, {}
            for cells, out in ((blocked, first), (unknown, known)):
                for (_, k, j), pose in cells.items():
                    out[k, j] = min(pose, out.get((k, j), pose))
            known = {key: pose for key, pose in known.items() if pose < first.get(key, math.inf)}
            whole = section.unknown_cells()
            self.assertEqual(dict(zip(zip(whole.k, whole.j), whole.first_pose)), known)
            self.assertEqual((report.seen.unknown, report.seen.unknown_in_bins),
                             (len(known), len(unknown)))
            grid = section.grid()
            for (k, j), is_free in np.ndenumerate(section.free_cells(0)):
                key = (k + grid.k_from, j + grid.j_from)
                self.assertEqual(is_free, key not in first and key not in known)
                free += is_free
            blocked_cells += len(blocked)
            unknown_cells += len(unknown)
        self.assertGreater(blocked_cells, 500)
        self.assertGreater(unknown_cells, 5000)
        self.assertGreater(free, 200)

    def test_what_makes_no_sense_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            np.savetxt(f"{folder}/scan.xyz", np.ones((20, 3)) * np.arange(20)[:, None], "%.3f")
            clearway.convert(f"{folder}/scan.xyz", f"{folder}/site.h5")
            store, pose, out = clearway.Store(f"{folder}/site.h5"), np.eye(4)[None], f"{folder}/out.h5"
            query = clearway.Query(np.zeros((1, 3)), pose, 0.1, seen=True)
            clearway.find_section(store, pose, out, -1, 1)
            section = clearway.Section(out)
            self.assertIsNone(section.unknown_cells())
            self.assertIsNone(section.unknown_bin_cells())
            for words, call in (
                    ("where its scanner stood", lambda: clearway.search(store, query, f"{folder}/a.h5")),
                    ("where its scanner stood",
                     lambda: clearway.find_section(store, pose, f"{folder}/a.h5", -1, 1, seen=True)),
                    ("expected seen space",
                     lambda: clearway.find_section(store, pose, f"{folder}/a.h5", -1, 1, seen_cube=0.1)),
                    ("without seen space",
                     lambda: clearway.export_section(section, "unknown-cells", f"{folder}/t.csv"))):
                with self.assertRaisesRegex(clearway.UsageError, words):
                    call()


if __name__ == "__main__":
    unittest.main()
