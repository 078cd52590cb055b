#!/usr/bin/python3
"""Shifts in Python. shifts_test.py, with the module on the path."""

import json
import threading
import unittest

import clearway
import numpy as np
from scene import RADIUS, SceneTest, first_poses

STEP, MOST = 0.25, 12


class ShiftTest(SceneTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # A path that winds, so that its y axes differ.
        angle = 0.3 * np.sin(np.arange(30) / 5)
        cls.poses = cls.poses.copy()
        cls.poses[:, 0, 0] = cls.poses[:, 1, 1] = np.cos(angle)
        cls.poses[:, 1, 0] = np.sin(angle)
        cls.poses[:, 0, 1] = -np.sin(angle)
        keep = np.random.default_rng(3).permutation(len(cls.points))[:60]
        cls.points = cls.points[np.sort(keep)]
        np.savetxt(cls.folder / "few.xyz", cls.points, "%.3f")
        clearway.convert(cls.folder / "few.xyz", cls.folder / "site.h5", overwrite=True)
        cls.store = clearway.Store(cls.folder / "site.h5")

    def result(self, **parameters):
        self.search(query=self.query(first_pose=True, **parameters))
        return clearway.Result(self.folder / "out.h5")

    def shifts(self, result, **options):
        return clearway.find_shifts(result, self.store, self.model, self.poses,
                                    lateral=(-STEP * MOST, STEP * MOST), step=STEP, min_points=1,
                                    gap=0.2, **options)

    def least(self, first, last):
        """The least shift of the poses from first to last, by brute force."""
        for steps in sorted(range(-MOST, MOST + 1), key=lambda k: (abs(k), -k)):
            poses = self.poses[first:last + 1].copy()
            poses[:, :3, 3] += steps * STEP * poses[:, :3, 1]
            if (first_poses(self.points, self.model, poses, RADIUS) < 0).all():
                return steps * STEP
        return None

    def test_shifts_are_those_of_brute_force(self):
        result = self.result()
        table = self.shifts(result)
        conflicts = clearway.find_conflicts(result, self.poses, min_points=1, gap=0.2).listed
        self.assertGreater(len(conflicts), 5)
        self.assertEqual(len(table), len(conflicts))
        for row, conflict in zip(table.conflicts, conflicts):
            self.assertEqual((row.conflict, row.first_pose, row.last_pose, row.chainage_to),
                             (conflict.id, conflict.first_pose, conflict.last_pose,
                              conflict.chainage_to))
            self.assertEqual(row.shift, self.least(row.first_pose, row.last_pose))
            self.assertIsNone(row.station_from)
        self.assertEqual(table.path.shift, self.least(0, len(self.poses) - 1))
        self.assertEqual((table.path.conflict, table.path.last_pose), (0, len(self.poses) - 1))
        self.assertEqual((table.lateral_from, table.lateral_to, table.step),
                         (-STEP * MOST, STEP * MOST, STEP))
        self.assertEqual(table.searches,
                         table.path.searches + sum(row.searches for row in table.conflicts))
        self.assertGreaterEqual(table.seconds, 0)
        self.assertIn("the whole path: ", repr(table))
        self.assertIn("conflict 1: ", repr(table.conflicts[0]))

    def test_bodies_and_the_report(self):
        body = clearway.Body("one", self.model, self.poses)
        self.search("bodies.h5", clearway.Query(poses=self.poses, radius=RADIUS, bodies=[body],
                                                first_pose=True))
        options = {"lateral": (-STEP * MOST, STEP * MOST), "step": STEP, "min_points": 1, "gap": 0.2}
        table = clearway.find_shifts(clearway.Result(self.folder / "bodies.h5"), self.store, None,
                                     self.poses, bodies=[body], **options)
        result = self.result()
        plain = self.shifts(result)
        self.assertEqual([row.shift for row in table.conflicts],
                         [row.shift for row in plain.conflicts])
        page = self.folder / "page.html"
        summary = clearway.write_report(result, self.store, self.model, self.poses, page,
                                        shifts=plain, min_points=1, gap=0.2)
        told = json.loads(summary.facts)["shifts"]
        self.assertEqual(told["path"]["shift"], plain.path.shift)
        self.assertEqual([row["shift"] for row in told["list"]],
                         [row.shift for row in plain.conflicts])
        with self.assertRaisesRegex(clearway.InputError, "not those of the table of shifts"):
            clearway.write_report(result, self.store, self.model, self.poses, page, shifts=plain,
                                  min_points=10**6, overwrite=True)

    def test_what_is_refused(self):
        result = self.result()

        def refused(error, words, poses=self.poses, **options):
            with self.assertRaisesRegex(error, words):
                clearway.find_shifts(result, self.store, self.model, poses, **options)

        refused(clearway.UsageError, "^lateral: expected two numbers", lateral=(1,))
        refused(TypeError, r"^lateral\[1\]: expected a number", lateral=(0, "far"))
        refused(clearway.UsageError, "contains 0", lateral=(1, 2))
        refused(clearway.UsageError, "^step: expected a number above 0", step=0)
        refused(clearway.UsageError, "more than 1,000,000", step=1e-9)
        refused(clearway.InputError, "another trajectory", poses=self.poses[:-1])
        refused(TypeError, "did you mean 'bodies'", vehicle=[])
        with self.assertRaisesRegex(TypeError, "^store: expected a clearway.Store"):
            clearway.find_shifts(result, "site.h5", self.model, self.poses)
        stop = threading.Event()
        stop.set()
        refused(clearway.Interrupted, "", stop=stop)


if __name__ == "__main__":
    unittest.main()
