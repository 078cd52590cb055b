"""Seen space of sections in random scenes is what its definition says: which cells are blocked, and
which are not known because no beam crossed the cubes over them. Beams are followed in exact integers,
places are computed in double in the documented order of operations, and all pairs are looked at.

Usage: PYTHONPATH=BUILD/python section_seen_test.py [SCENES]
"""

import math
import random
import sys
import tempfile
import unittest

import clearway
import numpy as np
from seen_test import Scene, meet, rounded

SCENES = 40
UNIT = 2.0**-53


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
    """A scene of seen_test.py that is asked for a section."""

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
        low, high = cubes * sides + sides // 4, (cubes + 1) * sides - sides // 4
        open_ = np.ones(len(cubes), bool)
        for origin, end in zip(self.origins, self.quanta):
            start = [rounded(v) for v in (origin + self.offset - self.offset) / self.scale]
            way = [abs(a - b) for a, b in zip(start, end)]
            if start == end or max(way) >= 2**30 or math.hypot(
                    *(w * s for w, s in zip(way, self.scale))) > 1000:
                continue
            a, b = np.minimum(start, end), np.maximum(start, end)
            for n in np.flatnonzero(open_ & (a <= high).all(1) & (b >= low).all(1)):
                if meet(start, end, [int(v) for v in low[n]], [int(v) for v in high[n]]):
                    open_[n] = False
        return cubes[open_], middles[open_]


def rows(cells):
    keys = list(zip(*(map(int, c) for c in (cells.bin, cells.k, cells.j)))) if len(cells) else []
    assert keys == sorted(set(keys))
    return dict(zip(keys, map(int, cells.first_pose)))


class SectionSeenSpace(unittest.TestCase):
    def scenes(self, count):
        with tempfile.TemporaryDirectory() as folder:
            for seed in range(count):
                scene = SectionScene(seed)
                if min(scene.sides) < 4:
                    continue
                scene.write(folder)
                with self.subTest(seed=seed):
                    yield folder, scene

    def test_random_scenes(self):
        blocked_cells = unknown_cells = free = 0
        for folder, scene in self.scenes(SCENES):
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
        print(f"{blocked_cells} cells blocked, {unknown_cells} not known, {free} free")

    def test_checks_and_widths_heed_what_is_not_known(self):
        verdicts = {"passes": 0, "stopped": 0, "unknown": 0}
        for folder, scene in self.scenes(30):
            scene.find(folder)
            section = clearway.Section(f"{folder}/section.h5")
            blocked, unknown = rows(section.bin_cells()), rows(section.unknown_bin_cells())
            rng = random.Random(scene.rng.random())
            for _ in range(20):
                y, z = rng.uniform(-0.5, 0.4), rng.uniform(-0.4, 0.3)
                a, b = y + rng.uniform(0.01, 0.3), z + rng.uniform(0.01, 0.3)
                margin = rng.choice((0, 0.03, 0.05)) if scene.margin else 0
                reach = margin + section.rounding()
                def near(cells):
                    g, places = scene.cell, {}
                    for (bin_number, k, j), pose in cells.items():
                        away = math.hypot(max(y - (j + 1) * g, j * g - a, 0),
                                          max(z - (k + 1) * g, k * g - b, 0))
                        if away < reach:
                            places.setdefault(bin_number, []).append((pose, k, j))
                    return [(n, *min(places[n])) for n in sorted(places)]
                found = section.check([(y, z), (a, z), (a, b), (y, b)], margin)
                for told, cells in ((found.stops, blocked), (found.unknowns, unknown)):
                    self.assertEqual([(p.bin, p.first_pose, *reversed(p.cell)) for p in told],
                                     near(cells))
                grid, g = section.grid(), scene.cell
                leaves = (y - margin < grid.j_from * g or a + margin > grid.j_to * g
                          or z - margin < grid.k_from * g or b + margin > grid.k_to * g)
                expected = ("stopped" if found.stops else "unknown"
                            if found.unknowns or leaves or section.warnings() else "passes")
                if not section.warnings():
                    self.assertEqual(found.verdict, expected)
                    if found.verdict == "unknown" and not leaves:
                        self.assertIn(f"first at pose {found.unknowns[0].first_pose}", found.reason)
                verdicts[found.verdict] += 1
            if section.grid().j_from < 0 < section.grid().j_to:
                self.check_widths(section, blocked, unknown)
        self.assertGreater(min(verdicts["stopped"], verdicts["unknown"]), 50)
        self.assertGreater(verdicts["passes"], 0)
        print(verdicts)

    def check_widths(self, section, blocked, unknown):
        g = section.parameters().cell
        for stretch in section.stations(band=g, base=section.grid().k_from * g):
            for band in stretch.bands:
                k = round(band.z_from / g)
                for left in (True, False):
                    def nearest(cells):
                        columns = [j if left else -j - 1 for (n, row, j) in cells
                                   if n == stretch.bin and row == k and (j >= 0) == left]
                        return min(columns, default=math.inf)
                    of_blocked, of_unknown = nearest(blocked), nearest(unknown)
                    width, end = ((band.left, band.left_end) if left
                                  else (band.right, band.right_end))
                    least = min(of_blocked, of_unknown)
                    if least == math.inf:
                        self.assertEqual((width, end), (None, None))
                    else:
                        self.assertAlmostEqual(width, least * g)
                        self.assertEqual(end, "blocked" if of_blocked == least else "not-known")

    def test_a_store_without_origins_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            np.savetxt(f"{folder}/scan.xyz", np.ones((20, 3)) * np.arange(20)[:, None], "%.3f")
            clearway.convert(f"{folder}/scan.xyz", f"{folder}/site.h5")
            store = clearway.Store(f"{folder}/site.h5")
            with self.assertRaisesRegex(clearway.UsageError, "where its scanner stood"):
                clearway.find_section(store, np.eye(4)[None], f"{folder}/out.h5", -1, 1, seen=True)
            with self.assertRaisesRegex(clearway.UsageError, "expected seen space"):
                clearway.find_section(store, np.eye(4)[None], f"{folder}/out.h5", -1, 1,
                                      seen_cube=0.1)
            clearway.find_section(store, np.eye(4)[None], f"{folder}/out.h5", -1, 1)
            section = clearway.Section(f"{folder}/out.h5")
            self.assertIsNone(section.unknown_cells())
            self.assertIsNone(section.unknown_bin_cells())
            with self.assertRaisesRegex(clearway.UsageError, "without seen space"):
                clearway.export_section(section, "unknown-cells", f"{folder}/t.csv")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        SCENES = int(sys.argv.pop())
    unittest.main()
