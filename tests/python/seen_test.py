"""Seen space in random scenes is what its definition says: which cubes are swept and unseen, their
groups, and the length that was not scanned. Uses exact integers and all pairs.

Usage: PYTHONPATH=BUILD/python seen_test.py
"""

import itertools
import math
import os
import random
import struct
import tempfile
import unittest

import clearway
import numpy as np

SCENES = 24
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


def write_las(path, quanta, scale, offset):
    head = bytearray(227)
    struct.pack_into("<4s2xH16xBB", head, 0, b"LASF", 0, 1, 2)
    struct.pack_into("<HIIBHI", head, 94, 227, 227, 0, 0, 20, len(quanta))
    places = np.array(quanta) * scale + offset
    struct.pack_into("<12d", head, 131, *scale, *offset,
                     *np.stack([places.max(0), places.min(0)], 1).ravel())
    with open(path, "wb") as file:
        file.write(head + b"".join(struct.pack("<3i8x", *q) for q in quanta))


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

    def unseen(self, swept):
        beams = []
        for origin, end in zip(self.origins, self.quanta):
            place = (origin + self.offset - self.offset) / self.scale
            start = [rounded(v) for v in place]
            way = [abs(a - b) for a, b in zip(start, end)]
            long = max(way) >= 2**30 or math.hypot(*(w * s for w, s in zip(way, self.scale))) > 1000
            if start != end and not long:
                beams.append((start, end))
        def is_seen(cube):
            least = [h * i + h // 4 for h, i in zip(self.sides, cube)]
            most = [h * (i + 1) - h // 4 for h, i in zip(self.sides, cube)]
            return any(meet(a, b, least, most) for a, b in beams)
        return sorted(cube for cube in swept if not is_seen(cube))


def groups_of(cubes, first):
    """Groups by 26 neighbours, by their least first pose and then their least cube."""
    left, groups = set(cubes), []
    for cube in cubes:
        if cube not in left:
            continue
        left.remove(cube)
        group, open_ = [], [cube]
        while open_:
            at = open_.pop()
            group.append(at)
            for step in itertools.product((-1, 0, 1), repeat=3):
                near = tuple(a + b for a, b in zip(at, step))
                if near in left:
                    left.remove(near)
                    open_.append(near)
        groups.append(group)
    return sorted(groups, key=lambda g: (min(first[c] for c in g), min(g)))


def not_scanned(scene, groups, first, side):
    steps = np.linalg.norm(np.diff(scene.poses[:, :3, 3], axis=0), axis=1)
    chainage = np.concatenate([[0], np.cumsum(steps), [steps.sum()]])
    length, end = 0, None
    for pose in sorted({first[c] for g in groups if len(g) >= scene.seen_min for c in g}):
        start, stop = chainage[pose], chainage[pose + 1]
        length += stop - (end if end is not None and start - end < side else start)
        end = stop
    return length


class SeenSpace(unittest.TestCase):
    def test_random_scenes(self):
        swept_cubes = seen_cubes = listed = 0
        with tempfile.TemporaryDirectory() as folder:
            for seed in range(SCENES):
                scene = Scene(seed)
                if min(scene.sides) < 4:
                    continue
                scene.write(folder)
                found, radius = scene.search(folder)
                first = scene.swept(radius)
                if first is None:
                    continue
                with self.subTest(seed=seed):
                    unseen = scene.unseen(first)
                    cubes = clearway.Result(f"{folder}/out.h5").unseen()
                    self.assertEqual(found.seen.swept, len(first))
                    self.assertEqual([tuple(map(int, c)) for c in cubes.cube], unseen)
                    self.assertEqual(list(cubes.first_pose), [first[c] for c in unseen])
                    groups = groups_of(unseen, first)
                    number = {c: n + 1 for n, group in enumerate(groups) for c in group}
                    self.assertEqual(list(cubes.group), [number[c] for c in unseen])
                    big = sum(len(g) >= scene.seen_min for g in groups)
                    self.assertEqual(found.seen.listed_groups, big)
                    self.assertEqual("not-scanned" in found.reasons,
                                     big > 0 and found.verdict != "conflict")
                    self.assertAlmostEqual(found.seen.not_scanned_length,
                                           not_scanned(scene, groups, first, found.seen.cube), 6)
                    swept_cubes += len(first)
                    seen_cubes += len(first) - len(unseen)
                    listed += big
        self.assertGreater(swept_cubes, 8_000)
        self.assertGreater(seen_cubes, 200)
        self.assertGreater(listed, 8)

    def test_a_store_without_origins_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            np.savetxt(f"{folder}/scan.xyz", np.ones((20, 3)) * np.arange(20)[:, None], "%.3f")
            clearway.convert(f"{folder}/scan.xyz", f"{folder}/site.h5")
            store = clearway.Store(f"{folder}/site.h5")
            query = clearway.Query(np.zeros((1, 3)), np.eye(4)[None], 0.1, seen=True)
            with self.assertRaisesRegex(clearway.UsageError, "where its scanner stood"):
                clearway.search(store, query, f"{folder}/out.h5")
            self.assertFalse(os.path.exists(f"{folder}/out.h5"))


if __name__ == "__main__":
    unittest.main()
