#!/usr/bin/python3
"""Vehicles of several bodies in Python. bodies_test.py, with the module on the path."""

import json
import unittest

import clearway
import numpy as np
from scene import RADIUS, SceneTest, first_poses, poses_along_x


class BodyTest(SceneTest):
    def searched(self, *bodies):
        """The result of a search for the bodies on the path."""
        query = clearway.Query(poses=self.poses, radius=RADIUS, bodies=bodies, first_pose=True, profile=0.01)
        self.report = self.search(query=query)
        return clearway.Result(self.folder / "out.h5")

    def test_bodies_are_searched_as_models(self):
        messages = []
        front = clearway.follow("front", self.model, self.poses, at=1, messages=messages)
        self.assertEqual([(m.code, m.severity) for m in messages], [("body-off-path", "note")])
        own = clearway.Body("own", self.model, self.poses)
        [end] = clearway.unsearched_stretches(self.poses, [front])
        self.assertEqual((end.first_pose, end.last_pose, end.bodies, end.has_answer), (25, 29, [0], False))
        self.assertTrue(clearway.unsearched_stretches(self.poses, [front, own])[0].has_answer)
        self.assertEqual(clearway.unsearched_stretches(self.poses, [own]), [])
        self.assertIn("1 body without a pose", repr(end))
        np.testing.assert_array_equal(front.path_pose, range(25))
        np.testing.assert_allclose(front.poses[:, 0, 3], self.poses[:25, 0, 3] + 1)
        result = self.searched(front, own)
        self.assertEqual(result.bodies(), ["front", "own"])
        ahead = first_poses(self.points, self.model, front.poses, RADIUS)
        here = first_poses(self.points, self.model, self.poses, RADIUS)
        ahead, here = (np.where(first < 0, 99, first) for first in (ahead, here))
        least = np.minimum(ahead, here)
        found = np.flatnonzero(least < 99)
        np.testing.assert_array_equal(result.source(), found)
        np.testing.assert_array_equal(result.first_pose(), least[found])
        np.testing.assert_array_equal(result.first_body(), (ahead != least)[found])

    def test_towed_bodies(self):
        path, messages = poses_along_x(200, 0.1), []
        tractor = clearway.follow("tractor", self.model, path, towed_by="path", at=0,
                                  pivots=(3.8, 0))
        trailer = clearway.follow("trailer", self.model, path, towed_by=tractor, at=-0.6,
                                  pivots=(8, 0), messages=messages)
        np.testing.assert_allclose(trailer.poses[:, 0, 3], path[:, 0, 3] - 3.8 - 0.6 - 8, atol=1e-9)
        self.assertEqual([(m.code, m.severity) for m in messages], [("body-transient", "note")])
        read = clearway.read_vehicle(self.write_vehicle([
            {"name": "trailer", "model": "model.xyz",
             "towed": {"by": "tractor", "at": -0.6, "pivots": [8, 0]}},
            {"name": "tractor", "model": "model.xyz", "towed": {"at": 0, "pivots": [3.8, 0]}}]), path)
        for one, other in zip(read, (trailer, tractor)):
            np.testing.assert_array_equal(one.poses, other.poses)
        for kind, words, of, arguments in (
                (clearway.UsageError, "towed_by: expected at", path, {"towed_by": tractor}),
                (clearway.UsageError, '"path"', path, {"towed_by": "road", "pivots": (1, 0)}),
                (clearway.UsageError, "the axle", path, {"towed_by": tractor, "pivots": (0, 1)}),
                (clearway.UsageError, "path", path[:5], {"towed_by": tractor, "pivots": (1, 0)}),
                (clearway.InputError, "goes backwards", path[::-1], {"towed_by": "path", "pivots": (8, 0)})):
            with self.assertRaisesRegex(kind, words):
                clearway.follow("t", self.model, of, at=0, **arguments)

    def test_a_profile_tells_what_was_not_searched(self):
        result = self.searched(clearway.follow("front", self.model, self.poses, at=1))
        distance = result.profile().distance
        np.testing.assert_array_equal(np.isnan(distance), np.arange(len(distance)) >= 25)
        self.assertEqual(result.answer().searched.whole, self.report.searched.whole)
        self.assertLess(self.report.searched.whole, self.report.searched.path)

    def write_vehicle(self, bodies):
        np.savetxt(self.folder / "model.xyz", self.model, "%.17g")
        np.savetxt(self.folder / "path.txt", self.poses[:, :3].reshape(-1, 12), "%.17g")
        file = self.folder / "wagon.json"
        file.write_text(json.dumps({"bodies": bodies}))
        return file

    def test_boxes_and_outlines_are_solids(self):
        box = clearway.box_model(4, 1.8, 1.4)
        self.assertEqual((len(box.vertices), len(box.triangles)), (8, 12))
        file = self.folder / "half.csv"
        file.write_text("height,half_width\n0,900\n1400,900\n")
        outline = clearway.read_outline(file, mirror=True, unit="mm")
        np.testing.assert_allclose(outline, [[0.9, 0], [0.9, 1.4], [-0.9, 1.4], [-0.9, 0]])
        solid = clearway.outline_model(outline, -2, 2)
        self.assertEqual(sorted(map(tuple, solid.vertices)), sorted(map(tuple, box.vertices)))
        (self.folder / "unmirrored.csv").write_text("y,z\n0,0\n1,0\n1,2\n0,2\n")
        messages = []
        clearway.read_outline(self.folder / "unmirrored.csv", messages=messages)
        self.assertEqual([m.code for m in messages], ["half-outline"])
        with self.assertRaisesRegex(clearway.InputError, "is to be mirrored"):
            clearway.read_outline(file)

    def test_a_file_of_bodies_is_read(self):
        mesh = "OFF\n3 1 0\n0 0 0\n100 0 0\n0 100 0\n3 0 1 2\n"
        (self.folder / "fin.off").write_text(mesh)
        file = self.write_vehicle([
            {"name": "front", "model": "model.xyz", "at": "100cm"},
            {"name": "own", "model": "model.xyz", "trajectory": "path.txt"},
            {"name": "fin", "model": "fin.off", "model_unit": "cm", "pivots": [0.5, -0.5]}])
        messages = []
        with self.assertRaisesRegex(clearway.UsageError, r"units of 0.01 m.*environment_unit=1.0"):
            clearway.read_vehicle(file, self.poses)
        front, own, fin = clearway.read_vehicle(file, self.poses, environment_unit=1.0,
                                                messages=messages)
        self.assertEqual([b.name for b in (front, own, fin)], ["front", "own", "fin"])
        self.assertIn("body-off-path", [m.code for m in messages])
        followed = clearway.follow("front", self.model, self.poses, at=1)
        np.testing.assert_array_equal(front.poses, followed.poses)
        np.testing.assert_array_equal(front.path_pose, followed.path_pose)
        np.testing.assert_array_equal(front.model, self.model)
        np.testing.assert_array_equal(own.poses, self.poses)
        np.testing.assert_allclose(fin.model.vertices.max(axis=0), [1, 1, 0])
        self.assertEqual(len(fin.path_pose), 24)
        sampled = clearway.read_vehicle(str(file), self.poses, "points", spacing=0.1,
                                        environment_unit=1)[2]
        self.assertGreater(len(sampled.model.vertices), 20)
        feet = clearway.read_vehicle(file, self.poses, environment_unit=clearway.METRES_PER_FOOT)
        self.assertEqual(len(feet[0].poses), 13)  # a metre is 3.28 of these units

    def test_conflicts_are_seen_from_bodies(self):
        file = self.write_vehicle([{"name": "front", "model": "model.xyz", "at": 1}])
        bodies = clearway.read_vehicle(file, self.poses)
        result = self.searched(*bodies)
        page = self.folder / "bodies.html"
        clearway.write_report(result, clearway.Store(self.folder / "site.h5"), (), self.poses, page,
                              bodies=bodies)
        self.assertIn(b"front", page.read_bytes())
        for given, known in ((bodies, True), ((), False)):
            listed = clearway.find_conflicts(result, self.poses, min_points=1, bodies=given).listed
            self.assertEqual({c.side != "unknown" for c in listed}, {known})
        with self.assertRaisesRegex(clearway.InputError, "another vehicle"):
            clearway.find_conflicts(result, self.poses, bodies=bodies * 2)

    def test_bodies_of_another_path_are_refused_by_all_who_read_them(self):
        moved = self.poses + np.pad(np.full((3, 1), 0.1), ((0, 1), (3, 0)))
        read = clearway.read_vehicle(
            self.write_vehicle([{"name": "a", "model": "model.xyz"}]), self.poses[:10])[0]
        result, store = self.searched(clearway.Body("a", self.model, self.poses)), clearway.Store(self.folder / "site.h5")
        page = self.folder / "none.html"
        for body, words in (
                (clearway.Body("a", self.model, self.poses[:10]),
                 r"bodies\[0\] \(a\): has 10 poses, and the path has 30 poses"),
                (clearway.follow("a", self.model, self.poses[:10]), r"bodies\[0\] \(a\): was placed on"),
                (clearway.follow("a", self.model, moved), "another path"), (read, "another path")):
            for call in (lambda: self.searched(body),
                         lambda: clearway.find_conflicts(result, self.poses, bodies=[body]),
                         lambda: clearway.write_report(result, store, (), self.poses, page,
                                                       bodies=[body])):
                with self.assertRaisesRegex(clearway.UsageError, words):
                    call()
        self.assertFalse(page.exists())
        self.searched(clearway.Body("part", self.model, self.poses[:10], range(10)))  # as it says

    def test_bodies_are_refused(self):
        for wrong, kind in ((range(29), clearway.UsageError), ([0.5] * 30, TypeError),
                            (range(-1, 29), clearway.UsageError), ("all", TypeError)):
            with self.assertRaisesRegex(kind, "path_pose"):
                clearway.Body("a", self.model, self.poses, wrong)
        body = clearway.Body("a", self.model, self.poses)
        with self.assertRaisesRegex(clearway.InputError, "another body has this name"):
            self.searched(body, body)


if __name__ == "__main__":
    unittest.main()
