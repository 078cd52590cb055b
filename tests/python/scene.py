"""A small scene for the tests of the Python module, with its answer by brute force."""

import shutil
import struct
import tempfile
import threading
import unittest
from pathlib import Path

import clearway
import numpy as np

RADIUS = 0.25


def poses_along_x(count, step):
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, 0, 3] = step * np.arange(count)
    return poses


def first_poses(points, model, poses, radius):
    """By point the first pose that touches it; -1: none."""
    first = np.full(len(points), -1)
    for i in reversed(range(len(poses))):
        moved = model @ poses[i, :3, :3].T + poses[i, :3, 3]
        first[np.linalg.norm(points[:, None] - moved, axis=2).min(axis=1) < radius] = i
    return first


def run_together(calls):
    """Each call in a thread of its own, until all have ended."""
    threads = [threading.Thread(target=call) for call in calls]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def write_las(path, quanta, scale=(0.001,) * 3, offset=(0, 0, 0), times=None, classes=None):
    """LAS 1.2; with times of points it is of format 1."""
    head = bytearray(227)
    struct.pack_into("<4s2xH16xBB", head, 0, b"LASF", 0, 1, 2)
    struct.pack_into("<HIIBHI", head, 94, 227, 227, 0, *((0, 20) if times is None else (1, 28)),
                     len(quanta))
    places = np.array(quanta) * scale + offset
    struct.pack_into("<12d", head, 131, *scale, *offset, *np.stack([places.max(0), places.min(0)], 1).ravel())
    rows = [struct.pack("<3i3xB4x", *q, 0 if classes is None else classes[i])
            + (b"" if times is None else struct.pack("<d", times[i])) for i, q in enumerate(quanta)]
    Path(path).write_bytes(head + b"".join(rows))


class SceneTest(unittest.TestCase):
    """2,000 points, 20 model points, 30 poses, in a folder of its own that is the working folder."""

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="clearway-python-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        random = np.random.default_rng(17)
        cls.points = np.round(random.uniform((-1, -2, -1), (7, 2, 1), (2000, 3)), 3)
        cls.model = random.uniform(-0.5, 0.5, (20, 3))
        cls.poses = poses_along_x(30, 0.2)
        np.savetxt(cls.folder / "scan.xyz", cls.points, "%.3f")
        clearway.convert(cls.folder / "scan.xyz", cls.folder / "site.h5", cell_points=64)

    def query(self, **parameters):
        return clearway.Query(self.model, self.poses, RADIUS, **parameters)

    def search(self, name="out.h5", query=None, **options):
        """Writes the result anew."""
        store = clearway.Store(self.folder / "site.h5")
        output = self.folder / name
        return clearway.search(store, query or self.query(), output, overwrite=True, **options)

    def slow_query(self):
        """Takes engine grid half a minute, and no cell much longer than another."""
        model = np.random.default_rng(1).uniform(-3, 3, (20_000, 3))
        return clearway.Query(model, poses_along_x(20_000, 1e-4), 1e-5)
