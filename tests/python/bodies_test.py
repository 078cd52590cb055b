#!/usr/bin/python3
"""Vehicles of several bodies in Python. bodies_test.py, with the module on the path."""

import unittest

import clearway
import numpy as np
from scene import RADIUS, SceneTest, first_poses


class BodyTest(SceneTest):
    def test_bodies_are_searched_as_models(self):
        messages = []
        front = clearway.follow("front", self.model, self.poses, at=1, messages=messages)
        self.assertEqual([m.code for m in messages], ["body-off-path"])
        np.testing.assert_array_equal(front.path_pose, range(25))
        np.testing.assert_allclose(front.poses[:, 0, 3], self.poses[:25, 0, 3] + 1)
        own = clearway.Body("own", self.model, self.poses)
        bodies = clearway.Query(poses=self.poses, radius=RADIUS, bodies=[front, own],
                                first_pose=True)
        self.search(query=bodies)
        result = clearway.Result(self.folder / "out.h5")
        self.assertEqual(result.bodies(), ["front", "own"])
        ahead = first_poses(self.points, self.model, front.poses, RADIUS)
        here = first_poses(self.points, self.model, self.poses, RADIUS)
        least = np.where(ahead < 0, here, np.where(here < 0, ahead, np.minimum(ahead, here)))
        found = np.flatnonzero(least >= 0)
        np.testing.assert_array_equal(result.source(), found)
        np.testing.assert_array_equal(result.first_pose(), least[found])
        np.testing.assert_array_equal(result.first_body(), (ahead != least)[found])

    def test_a_page_of_bodies(self):
        own = clearway.Body("own", self.model, self.poses)
        query = clearway.Query(poses=self.poses, radius=RADIUS, bodies=[own], first_pose=True)
        self.search(query=query)
        result = clearway.Result(self.folder / "out.h5")
        store = clearway.Store(self.folder / "site.h5")
        page = self.folder / "bodies.html"
        clearway.write_report(result, store, (), self.poses, page, bodies=[own])
        self.assertIn(b"own", page.read_bytes())

    def test_bodies_are_refused(self):
        with self.assertRaises(clearway.UsageError):
            clearway.follow("a", self.model, self.poses, at=1, pivots=(1, -1))
        body = clearway.Body("a", self.model, self.poses)
        with self.assertRaisesRegex(clearway.InputError, "another body has this name"):
            self.search(query=clearway.Query(poses=self.poses, radius=RADIUS, bodies=[body, body]))


if __name__ == "__main__":
    unittest.main()
