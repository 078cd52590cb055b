#!/usr/bin/python3
"""Shifts and smoothed paths in Python. shifts_test.py, with the module on the path."""

import json
import threading
import unittest

import clearway
import numpy as np
from scene import RADIUS, SceneTest

OPTIONS = {"lateral": (-3, 2.75), "step": 0.25, "min_points": 1, "gap": 0.2}


class ShiftTest(SceneTest):
    def test_shifts_are_of_the_conflicts_and_in_the_report(self):
        np.savetxt(self.folder / "few.xyz", self.points[::33], "%.3f")
        clearway.convert(self.folder / "few.xyz", self.folder / "few.h5")
        store, page = clearway.Store(self.folder / "few.h5"), self.folder / "page.html"
        clearway.search(store, self.query(first_pose=True), self.folder / "few_out.h5")
        result = clearway.Result(self.folder / "few_out.h5")
        table = clearway.find_shifts(result, store, self.model, self.poses, **OPTIONS)
        conflicts = clearway.find_conflicts(result, self.poses, min_points=1, gap=0.2).listed
        self.assertGreater(len(conflicts), 5)
        self.assertEqual([(row.conflict, row.first_pose, row.last_pose, row.chainage_to, row.station_from)
                          for row in table.conflicts],
                         [(c.id, c.first_pose, c.last_pose, c.chainage_to, None) for c in conflicts])
        for row in [*table.conflicts, table.path]:
            if row.shift is not None:  # the model fits when the straight path is moved aside
                aside = self.poses[row.first_pose:row.last_pose + 1] + 0
                aside[:, 1, 3] += row.shift
                report = clearway.search(store, clearway.Query(self.model, aside, RADIUS),
                                         self.folder / "aside.h5", overwrite=True)
                self.assertEqual(report.colliding_points, 0)
        self.assertTrue(any(row.shift for row in table.conflicts))
        self.assertEqual((table.path.conflict, table.path.last_pose, table.lateral_from,
                          table.lateral_to, table.step), (0, len(self.poses) - 1, -3, 2.75, 0.25))
        self.assertEqual(table.searches,
                         table.path.searches + sum(row.searches for row in table.conflicts))
        self.assertRegex(repr(table) + repr(table.conflicts[0]), "(?s)the whole path: .*conflict 1: ")
        body = clearway.Body("one", self.model, self.poses)
        clearway.search(store, clearway.Query(poses=self.poses, radius=RADIUS, bodies=[body],
                                              first_pose=True), self.folder / "bodies.h5")
        of_body = clearway.find_shifts(clearway.Result(self.folder / "bodies.h5"), store, None,
                                       self.poses, bodies=[body], labels=clearway.PoseLabels(), **OPTIONS)
        shifts = [row.shift for row in table.conflicts]
        self.assertEqual([row.shift for row in of_body.conflicts], shifts)
        facts = json.loads(clearway.write_report(result, store, self.model, self.poses, page, shifts=table,
                                                 min_points=1, gap=0.2).facts)["shifts"]
        self.assertEqual([facts["path"]["shift"], *(row["shift"] for row in facts["list"])],
                         [table.path.shift, *shifts])
        stop = threading.Event()
        stop.set()
        for kind, words, named in (
                (clearway.UsageError, "contains 0", {"lateral": (1, 2)}),
                (clearway.InputError, "another trajectory", {"poses": self.poses[:-1]}),
                (clearway.Interrupted, "", {"stop": stop})):
            with self.subTest(named), self.assertRaisesRegex(kind, words):
                clearway.find_shifts(**{"result": result, "store": store, "model": self.model,
                                        "poses": self.poses, **named})
        with self.assertRaisesRegex(clearway.InputError, "not those of the table of shifts"):
            clearway.write_report(result, store, self.model, self.poses, page, shifts=table,
                                  min_points=10**6, overwrite=True)

    def test_smoothed_paths(self):
        poses = self.poses.copy()
        heading = 0.3 * np.sin(np.arange(len(poses)) / 5) + np.random.default_rng(4).uniform(-0.01, 0.01, 30)
        poses[:, 0, 0] = poses[:, 1, 1] = np.cos(heading)
        poses[:, 1, 0], poses[:, 0, 1] = np.sin(heading), -np.sin(heading)
        path = clearway.smooth_trajectory(poses, 0.05, model=self.model)
        self.assertEqual(path.poses.shape, (len(path.place), 4, 4))
        self.assertEqual((path.place[0], path.place[-1]), (0, len(poses) - 1))
        self.assertTrue(0 < path.largest_deviation <= 0.05 and path.largest_step <= 0.1)
        self.assertTrue(path.error_at_poses > path.error_between_poses > 0)
        self.assertIn("control points", repr(path))
        self.assertLess(len(clearway.smooth_trajectory(poses, 0.05, model=self.model, step=0.3).poses),
                        len(path.poses))
        jump = poses.copy()
        jump[25:, 1, 3] += 3
        for kind, words, of, within, model in (
                (clearway.UsageError, "expected the model", poses, 0.05, None),
                (clearway.UsageError, "within", poses, -1, self.model),
                (clearway.InputError, "model: has no points", poses, 0.05, []),
                (clearway.InputError, "from pose 24 to pose 25", jump, 0.05, self.model)):
            with self.assertRaisesRegex(kind, words):
                clearway.smooth_trajectory(of, within, model=model)


if __name__ == "__main__":
    unittest.main()
