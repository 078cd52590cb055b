#!/usr/bin/python3
"""Arrays and errors of the Python module."""

import unittest

import clearway
import numpy as np
from scene import SceneTest


class Arrays(SceneTest):
    def sources(self, **changed):
        query = self.query()
        for name, value in changed.items():
            setattr(query, name, value)
        self.search(query=query)
        return clearway.Result(self.folder / "out.h5").source()

    def test_any_layout_gives_the_same(self):
        expected = self.sources()
        wide = np.zeros((40, 6))
        wide[::2, ::2] = self.model
        frozen = self.model.copy()
        frozen.flags.writeable = False
        models = (np.asfortranarray(self.model), wide[::2, ::2], frozen, self.model.tolist(),
                  self.model[::-1][::-1], self.model.astype(">f8"))
        for model in models:
            np.testing.assert_array_equal(self.sources(model=model), expected)
        for poses in (self.poses[:, :3], np.asfortranarray(self.poses), list(self.poses)):
            np.testing.assert_array_equal(self.sources(poses=poses), expected)

    def test_other_numbers_are_converted(self):
        query = clearway.Query(np.array([[1, 2, 3]], "int16"), np.eye(4, dtype="float32")[None])
        self.assertEqual((query.model.dtype, query.poses.dtype), (np.float64, np.float64))
        np.testing.assert_array_equal(query.model, [[1, 2, 3]])

    def test_an_array_is_shared_until_the_search(self):
        model = self.model.copy()
        query = clearway.Query(model, self.poses, 0.25)
        model += 100
        np.testing.assert_array_equal(query.model, model)
        self.search(query=query)
        self.assertEqual(clearway.Result(self.folder / "out.h5").size(), 0)

    def test_wrong_shapes(self):
        query = self.query()
        for model in (np.zeros(3), np.zeros((3, 4)), np.zeros((2, 2, 3)), 5.0):
            with self.assertRaisesRegex(clearway.UsageError, "model: expected an array of n x 3"):
                query.model = model
        for poses in (np.eye(4), np.zeros((2, 12)), np.zeros((2, 4, 3))):
            with self.assertRaisesRegex(clearway.UsageError, "poses: expected an array of n x 4 x 4"):
                query.poses = poses
        with self.assertRaisesRegex(clearway.UsageError, "pose 1: expected 0 0 0 1"):
            query.poses = np.stack([np.eye(4), np.full((4, 4), 1.0)])
        np.testing.assert_array_equal(query.model, self.model)  # as before

    def test_wrong_values(self):
        query = self.query()
        for model in (np.zeros((2, 3), complex), np.zeros((2, 3), bool), [["1", "2", "3"]],
                      np.full((2, 3), None)):
            with self.assertRaisesRegex(TypeError, "model: expected real numbers"):
                query.model = model
        with self.assertRaises(ValueError):
            query.model = [[1, 2, 3], [4, 5]]
        with self.assertRaisesRegex(clearway.UsageError, "masked"):
            query.model = np.ma.masked_less(self.model, 0)
        query.model = np.ma.masked_array(self.model)  # nothing is masked
        for value in (np.nan, np.inf):
            broken = self.model.copy()
            broken[7, 1] = value
            with self.assertRaisesRegex(clearway.InputError, "model: point 7: expected finite"):
                self.sources(model=broken)
        broken = self.poses.copy()
        broken[3, 0, 0] = np.nan
        with self.assertRaisesRegex(clearway.InputError, "poses: pose 3: expected finite"):
            self.sources(poses=broken)

    def test_no_points_and_no_poses(self):
        with self.assertRaisesRegex(clearway.InputError, "no points"):
            self.sources(model=[])
        self.assertEqual(len(self.sources(poses=[])), 0)

    def test_poses_that_are_no_rotations(self):
        turned = self.poses.transpose(0, 2, 1).copy()  # the translation is in the last row
        with self.assertRaisesRegex(clearway.UsageError, "last row"):
            self.sources(poses=turned)
        scaled = self.poses * np.array([2, 2, 2, 1])
        with self.assertRaisesRegex(clearway.InputError, "pose 0: .*stretches") as caught:
            self.sources(poses=scaled)
        self.assertEqual(caught.exception.remedy, "allow_non_rigid")
        self.sources(poses=scaled, allow_non_rigid=True)

    def test_a_misspelt_parameter(self):
        with self.assertRaises(AttributeError):
            self.query().raduis = 1
        with self.assertRaises(TypeError):
            self.search(thread=2)
        with self.assertRaises(TypeError):
            self.search(input_warnings=["mind the step"])


class Errors(SceneTest):
    def test_classes(self):
        self.assertTrue(issubclass(clearway.UsageError, (clearway.Error, ValueError)))
        for kind in (clearway.InputError, clearway.ResourceError, clearway.Interrupted):
            self.assertTrue(issubclass(kind, clearway.Error))
        self.assertEqual(clearway.Error.__module__, "clearway")
        self.assertEqual((clearway.Error("x").remedy, clearway.Error("x").amount), (None, 0))

    def test_usage(self):
        query = self.query()
        query.radius = -1
        with self.assertRaisesRegex(clearway.UsageError, "the radius has to be") as caught:
            self.search(query=query)
        self.assertIsNone(caught.exception.remedy)
        store = clearway.Store(self.folder / "site.h5")
        (self.folder / "there.h5").write_text("mine")
        with self.assertRaises(clearway.UsageError) as caught:
            clearway.search(store, self.query(), self.folder / "there.h5")
        self.assertEqual(caught.exception.remedy, "overwrite")
        with self.assertRaisesRegex(clearway.UsageError, "engine 'fast': expected one of auto, sweep"):
            self.search(engine="fast")

    def test_input(self):
        (self.folder / "bad.h5").write_text("no store")
        with self.assertRaisesRegex(clearway.InputError, "bad.h5"):
            clearway.Store(self.folder / "bad.h5")
        with self.assertRaisesRegex(clearway.ResourceError, "none.h5"):
            clearway.Result(self.folder / "none.h5")

    def test_a_remedy_with_an_amount(self):
        with self.assertRaises(clearway.ResourceError) as caught:
            self.search(memory_bytes=1000)
        self.assertEqual(caught.exception.remedy, "more_memory")
        self.assertGreater(caught.exception.amount, 1000)
        self.search(memory_bytes=int(caught.exception.amount))

    def test_strict(self):
        poses = self.poses.copy()
        poses[:, 1, 3] += 1000
        query = self.query()
        query.poses = poses
        with self.assertRaises(clearway.InputError):
            self.search("strict.h5", query, strict=True)
        self.assertFalse((self.folder / "strict.h5").exists())


if __name__ == "__main__":
    unittest.main()
