#!/usr/bin/python3
"""Smoothed paths from Python: what a search of the given path finds, a search of the smoothed path finds too,
with the error that smoothing names.
"""

import unittest

import clearway
import numpy as np
from scene import RADIUS, SceneTest


def drive(random, count, step, noise):
    """A path along x that swings and turns, with noise."""
    poses = np.tile(np.eye(4), (count, 1, 1))
    at = step * np.arange(count)
    heading = 0.3 * np.sin(at / 2)
    poses[:, 0, 3], poses[:, 1, 3] = at, 0.4 * np.sin(at)
    poses[:, 0, 0] = poses[:, 1, 1] = np.cos(heading)
    poses[:, 1, 0], poses[:, 0, 1] = np.sin(heading), -np.sin(heading)
    poses[:, :3, 3] += random.uniform(-noise, noise, (count, 3))
    return poses


class Smoothing(SceneTest):
    def smoothed(self, poses, within, **options):
        path = clearway.smooth_trajectory(poses, within, model=self.model, **options)
        self.assertLessEqual(path.largest_deviation, within)
        self.assertEqual(path.poses.shape, (len(path.place), 4, 4))
        return path

    def found(self, poses, **parameters):
        self.search(query=clearway.Query(self.model, poses, RADIUS, **parameters))
        result = clearway.Result(self.folder / "out.h5")
        near = result.near()
        return set(result.source()) | set([] if near is None else near.source)

    def test_the_error_covers_what_the_given_path_touches(self):
        random = np.random.default_rng(4)
        for _ in range(3):
            noise = random.uniform(0, 0.02)
            poses = drive(random, int(random.integers(60, 300)), 0.02, noise)
            path = self.smoothed(poses, random.uniform(0.05, 0.15), step=random.uniform(0.05, 0.3))
            for between, error in ((False, path.error_at_poses), (True, path.error_between_poses)):
                given = self.found(poses, between_poses=between)
                self.assertGreater(len(given), 20)
                new = self.found(path.poses, between_poses=between, error_model=error)
                self.assertEqual(given - new, set())

    def test_steps_and_places(self):
        poses = drive(np.random.default_rng(6), 200, 0.02, 0.005)
        path = self.smoothed(poses, 0.05)
        moved = np.einsum("nij,mj->nmi", path.poses[:, :3, :3], self.model) + path.poses[:, None, :3, 3]
        steps = np.linalg.norm(np.diff(moved, axis=0), axis=2)
        self.assertLessEqual(steps.max(), path.largest_step)
        self.assertLessEqual(path.largest_step, 0.1)
        self.assertEqual((path.place[0], path.place[-1]), (0, 199))
        self.assertIn("control points", repr(path))

    def test_refusals(self):
        poses = drive(np.random.default_rng(7), 50, 0.02, 0)
        with self.assertRaisesRegex(clearway.UsageError, "expected the model"):
            clearway.smooth_trajectory(poses, 0.01)
        with self.assertRaisesRegex(clearway.UsageError, "within"):
            clearway.smooth_trajectory(poses, -1, model=self.model)
        poses[25:, 1, 3] += 3
        with self.assertRaisesRegex(clearway.InputError, "from pose 24 to pose 25"):
            self.smoothed(poses, 0.05)


if __name__ == "__main__":
    unittest.main()
