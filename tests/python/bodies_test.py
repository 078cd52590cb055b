#!/usr/bin/python3
"""Vehicles of several bodies in Python. bodies_test.py, with the module on the path."""

import json
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

    def write_vehicle(self, bodies):
        np.savetxt(self.folder / "model.xyz", self.model, "%.17g")
        np.savetxt(self.folder / "path.txt", self.poses[:, :3].reshape(-1, 12), "%.17g")
        file = self.folder / "wagon.json"
        file.write_text(json.dumps({"bodies": bodies}))
        return file

    def test_a_file_of_bodies_is_read(self):
        mesh = "OFF\n3 1 0\n0 0 0\n100 0 0\n0 100 0\n3 0 1 2\n"
        (self.folder / "fin.off").write_text(mesh)
        file = self.write_vehicle([
            {"name": "front", "model": "model.xyz", "at": "100cm"},
            {"name": "own", "model": "model.xyz", "trajectory": "path.txt"},
            {"name": "fin", "model": "fin.off", "model_unit": "cm", "pivots": [0.5, -0.5]}])
        messages = []
        front, own, fin = clearway.read_vehicle(file, self.poses, messages=messages)
        self.assertEqual([b.name for b in (front, own, fin)], ["front", "own", "fin"])
        self.assertIn("body-off-path", [m.code for m in messages])
        followed = clearway.follow("front", self.model, self.poses, at=1)
        np.testing.assert_array_equal(front.poses, followed.poses)
        np.testing.assert_array_equal(front.path_pose, followed.path_pose)
        np.testing.assert_array_equal(front.model, self.model)
        np.testing.assert_array_equal(own.poses, self.poses)
        np.testing.assert_allclose(fin.model.points.max(axis=0), [1, 1, 0])
        self.assertEqual(len(fin.path_pose), 24)
        sampled = clearway.read_vehicle(str(file), self.poses, "points", spacing=0.1)[2]
        self.assertGreater(len(sampled.model), 20)
        feet = clearway.read_vehicle(file, self.poses, environment_unit=clearway.METRES_PER_FOOT)
        self.assertEqual(len(feet[0].poses), 13)  # a metre is 3.28 of these units

    def test_what_is_wrong_in_the_file_is_named(self):
        model = {"name": "a", "model": "model.xyz"}
        for body, words in [({**model, "at": "far"}, r"wagon.json: bodies\[0\].at: is \"far\""),
                            ({"name": "a"}, r"bodies\[0\].model: is missing"),
                            ({**model, "at": 100}, r"bodies\[0\]: the path is 5.8 m long")]:
            with self.assertRaisesRegex(clearway.InputError, words):
                clearway.read_vehicle(self.write_vehicle([body]), self.poses)
        with self.assertRaisesRegex(clearway.ResourceError, "none.json"):
            clearway.read_vehicle(self.folder / "none.json", self.poses)
        with self.assertRaisesRegex(clearway.UsageError, "model_as 'mesh'"):
            clearway.read_vehicle(self.write_vehicle([model]), self.poses, "mesh")

    def test_conflicts_are_seen_from_bodies(self):
        file = self.write_vehicle([{"name": "front", "model": "model.xyz", "at": 1}])
        bodies = clearway.read_vehicle(file, self.poses)
        query = clearway.Query(poses=self.poses, radius=RADIUS, bodies=bodies, first_pose=True)
        self.search(query=query)
        result = clearway.Result(self.folder / "out.h5")
        ahead = clearway.find_conflicts(result, self.poses, min_points=1, bodies=bodies).listed
        self.assertTrue(ahead and all(c.side != "unknown" for c in ahead))
        alone = clearway.find_conflicts(result, self.poses, min_points=1).listed
        self.assertTrue(all(c.side == "unknown" for c in alone))
        with self.assertRaisesRegex(clearway.InputError, "another vehicle"):
            clearway.find_conflicts(result, self.poses, bodies=bodies * 2)

    def test_bodies_are_refused(self):
        with self.assertRaises(clearway.UsageError):
            clearway.follow("a", self.model, self.poses, at=1, pivots=(1, -1))
        body = clearway.Body("a", self.model, self.poses)
        with self.assertRaisesRegex(clearway.InputError, "another body has this name"):
            self.search(query=clearway.Query(poses=self.poses, radius=RADIUS, bodies=[body, body]))


if __name__ == "__main__":
    unittest.main()
