"""Seen space in random scenes is what its definition says: which cubes a vehicle sweeps that no beam
saw, and which cells of a section are blocked or, over such cubes, not known. Beams are followed in
exact integers, and all pairs are looked at. What lies on a border is shown by the tests in C++.

Usage: PYTHONPATH=BUILD/python seen_test.py
"""

import unittest

import clearway
import numpy as np
from scene import SceneTest, write_las

SCENES = 8
SCALE, OFFSET = 0.001, np.array([450000.0, 5400000.0, 100.0])
CUBE, SIDE = 0.15, 150  # in metres and in stored integers
RADIUS = 0.15
REAR, FRONT, MARGIN, CELL, BIN = -0.15, 0.1, 0.05, 0.07, 0.5
J, K = (-6, 5), (-4, 5)  # cells of the window, the last one excluded


def meets(start, end, low, high):
    """Whether the closed segment meets each of the closed boxes, in exact integers: at enter / way it
    comes between the planes of an axis, at leave / way it is past them."""
    turn, way = np.where(end < start, -1, 1), abs(end - start)
    enter = np.minimum((low - start) * turn, (high - start) * turn)
    leave = np.maximum((low - start) * turn, (high - start) * turn)
    ordered = enter[:, :, None] * way[None, None, :] <= leave[:, None, :] * way[None, :, None]
    return (enter <= way).all(1) & (leave >= 0).all(1) & ordered.all((1, 2))


class Scene:
    """A model of points on a path of four poses, and beams that end near it or beyond it; some are
    too long, and some have no length."""

    def __init__(self, seed, folder):
        rng = np.random.default_rng(seed)
        self.model = rng.uniform(-0.4, 0.4, (6, 3))
        self.poses = np.tile(np.eye(4), (4, 1, 1))
        self.poses[:, :3, :3] = np.linalg.qr(rng.normal(size=(4, 3, 3)))[0]
        self.poses[:, :3, 0] *= np.linalg.det(self.poses[:, :3, :3])[:, None]
        self.poses[:, :3, 3] = OFFSET + np.cumsum(rng.uniform(-0.25, 0.25, (4, 3)), axis=0)
        origins = rng.integers(-3000, 3000, (12, 3))
        origins[:2, 0] = 998_000, 1_002_000
        self.starts = np.repeat(origins, 100, axis=0)
        aims = rng.normal(0, 300, self.starts.shape)
        self.ends = np.rint(aims + rng.choice((0, *[0.5] * 19), (len(aims), 1)) * (aims - self.starts)).astype(int)
        self.ends[::9] = self.starts[::9]
        write_las(folder / "beams.las", self.ends, (SCALE,) * 3, OFFSET)
        places = origins * SCALE + OFFSET
        (folder / "origins.csv").write_text("first,x,y,z\n" + "".join(
            f"{100 * i},{x!r},{y!r},{z!r}\n" for i, (x, y, z) in enumerate(places.tolist())))
        clearway.convert(folder / "beams.las", folder / "seen.h5", overwrite=True, cell_points=64,
                         origins=folder / "origins.csv")
        self.store = clearway.Store(folder / "seen.h5")

    def cubes(self, reach=1):
        """All cubes near the path, and their middles."""
        path = (self.poses[:, :3, 3] - OFFSET) / CUBE
        ranges = [np.arange(np.floor(lo), hi + 1, dtype=int) for lo, hi in
                  zip(path.min(axis=0) - reach / CUBE, path.max(axis=0) + reach / CUBE)]
        cubes = np.stack(np.meshgrid(*ranges, indexing="ij"), -1).reshape(-1, 3)
        return cubes, (cubes + 0.5) * CUBE + OFFSET

    def unseen(self, cubes):
        """Which of the cubes no beam saw, which it does when it meets the inner half."""
        found = np.ones(len(cubes), bool)
        for start, end in zip(self.starts, self.ends):
            if 0 < np.linalg.norm((end - start) * SCALE) <= 1000:
                found &= ~meets(start, end, cubes * SIDE + SIDE // 4, (cubes + 1) * SIDE - SIDE // 4)
        return found

    def swept(self, between_poses):
        """The cubes that the model sweeps, and the first pose or way of each."""
        cubes, middles = self.cubes()
        first = np.full(len(cubes), -1)
        places = self.model @ np.swapaxes(self.poses[:, :3, :3], 1, 2) + self.poses[:, None, :3, 3]
        for i in reversed(range(len(places) - between_poses)):
            for a, b in zip(places[i], places[i + between_poses]):
                way = b - a
                share = np.clip((middles - a) @ way / max(way @ way, 1e-300), 0, 1)
                first[np.linalg.norm(middles - a - share[:, None] * way, axis=1) < RADIUS] = i
        return cubes[first >= 0], first[first >= 0]

    def section_cells(self):
        """The first poses of blocked cells by (bin, k, j), and those of cells that are not known."""
        blocked, unknown = {}, {}
        cubes, middles = self.cubes()
        middles = middles[self.unseen(cubes)]
        steps = np.linalg.norm(np.diff(self.poses[:, :3, 3], axis=0), axis=1)
        for i, (pose, chainage) in enumerate(zip(self.poses, np.cumsum([0, *steps]))):
            for out, places, half in ((blocked, self.ends * SCALE + OFFSET, 0), (unknown, middles, CUBE / 2)):
                place = (places - pose[:3, 3]) @ pose[:3, :3]
                extent = half * abs(pose[:3, :3]).sum(axis=0)
                low, high = place - extent, place + extent
                reached = (low[:, 0] <= FRONT + MARGIN) & (high[:, 0] >= REAR - MARGIN)
                for first, last in zip(np.floor(low[reached] / CELL), np.floor(high[reached] / CELL)):
                    for k in range(int(max(first[2], K[0])), int(min(last[2], K[1] - 1)) + 1):
                        for j in range(int(max(first[1], J[0])), int(min(last[1], J[1] - 1)) + 1):
                            out.setdefault((int(chainage // BIN), k, j), i)
        return blocked, not_yet(unknown, blocked)


def not_yet(unknown, blocked):
    """Cells are not known only before they are blocked."""
    return {key: pose for key, pose in unknown.items() if pose < blocked.get(key, np.inf)}


def whole(cells):
    """Those of all bins."""
    return {key: min(pose for at, pose in cells.items() if at[1:] == key) for key in {at[1:] for at in cells}}


def rows(cells):
    columns = [c for c in (cells.bin, cells.k, cells.j) if c is not None]
    return dict(zip(zip(*(c.tolist() for c in columns)), cells.first_pose.tolist()))


class SeenSpace(SceneTest):
    def test_cubes_that_a_vehicle_sweeps_unseen(self):
        swept = seen = 0
        for seed in range(SCENES):
            scene = Scene(seed, self.folder)
            query = clearway.Query(scene.model, scene.poses, RADIUS, seen=True, seen_cube=CUBE, seen_min=3,
                                   between_poses=seed % 2 == 1)
            found = clearway.search(scene.store, query, self.folder / "out.h5", overwrite=True)
            told = clearway.Result(self.folder / "out.h5").unseen()
            cubes, first = scene.swept(seed % 2)
            unseen = scene.unseen(cubes)
            big = int((np.bincount(told.group)[1:] >= 3).sum())
            with self.subTest(seed=seed):
                self.assertEqual((found.seen.swept, found.seen.listed_groups), (len(cubes), big))
                np.testing.assert_array_equal(told.cube, cubes[unseen])
                np.testing.assert_array_equal(told.first_pose, first[unseen])
                self.assertEqual("not-scanned" in found.reasons, big > 0 and found.verdict != "conflict")
            swept, seen = swept + len(cubes), seen + len(cubes) - unseen.sum()
        self.assertGreater(swept, 500)
        self.assertGreater(seen, 100)

    def test_cells_of_a_section_that_are_blocked_or_not_known(self):
        numbers = np.zeros(3, int)
        for seed in range(SCENES):
            scene = Scene(seed, self.folder)
            window = [CELL * (end + inside) for end, inside in zip((*J, *K), (0.5, -0.5) * 2)]
            report = clearway.find_section(
                scene.store, scene.poses, self.folder / "section.h5", REAR, FRONT, window=window, cell=CELL,
                bin=BIN, margin=MARGIN, seen=True, seen_cube=CUBE, overwrite=True, threads=1 + seed % 3)
            section = clearway.Section(self.folder / "section.h5")
            blocked, unknown = scene.section_cells()
            first = whole(blocked)
            known = not_yet(whole(unknown), first)
            with self.subTest(seed=seed):
                self.assertEqual(rows(section.bin_cells()), blocked)
                self.assertEqual(rows(section.unknown_bin_cells()), unknown)
                self.assertEqual(rows(section.unknown_cells()), known)
                self.assertEqual((report.seen.unknown, report.seen.unknown_in_bins), (len(known), len(unknown)))
                free = section.free_cells(0)
                for (k, j), is_free in np.ndenumerate(free):
                    self.assertEqual(is_free, not {(k + K[0], j + J[0])} & (first.keys() | known.keys()))
            numbers += len(blocked), len(unknown), free.sum()
        self.assertTrue((numbers > (200, 300, 50)).all(), numbers)


if __name__ == "__main__":
    unittest.main()
