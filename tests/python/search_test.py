#!/usr/bin/python3
"""What the Python module finds, and what it gives back. search_test.py, with the module on the path."""

import json
import os
import struct
import unittest
from pathlib import Path

import clearway
import numpy as np
from scene import RADIUS, SceneTest, first_poses, poses_along_x


class FindsWhatBruteForceFinds(SceneTest):
    def setUp(self):
        self.first = first_poses(self.points, self.model, self.poses, RADIUS)
        self.expected = np.flatnonzero(self.first >= 0)
        self.assertGreater(len(self.expected), 50)

    def far_query(self):
        far = poses_along_x(2, 0.1) + [[0, 0, 0, 50], [0] * 4, [0] * 4, [0] * 4]
        return clearway.Query(self.model, far, 0.1, first_pose=True, clearance=0.2)

    def test_what_is_missing_or_misnamed_is_told(self):
        with self.assertRaisesRegex(TypeError, "no argument 'force'; did you mean 'overwrite'"):
            self.search(force=True)
        query = clearway.Query(self.model, self.poses)
        self.assertIn("no radius yet", repr(query))
        with self.assertRaisesRegex(clearway.UsageError, "^radius: the query has none"):
            self.search(query=query)
        self.search()
        page = self.folder / "none.html"
        with self.assertRaisesRegex(clearway.UsageError, r"^model: expected .* \(\) where bodies"):
            clearway.write_report(clearway.Result(self.folder / "out.h5"),
                                  clearway.Store(self.folder / "site.h5"), None, self.poses, page)

    def test_a_file_in_another_unit_needs_the_unit_of_the_environment(self):
        path = self.folder / "feet.csv"
        path.write_text("x [ft],y [ft],z [ft],qx,qy,qz,qw\n0,0,0,0,0,0,1\n10,0,0,0,0,0,1\n")
        with self.assertRaisesRegex(clearway.UsageError, "feet.*store.metres_per_unit"):
            clearway.read_trajectory(path)
        self.assertAlmostEqual(
            clearway.read_trajectory(path, environment_unit=1.0)[1, 0, 3], 3.048)
        self.assertEqual(clearway.read_trajectory(
            path, environment_unit=clearway.METRES_PER_FOOT)[1, 0, 3], 10)
        notes = []
        clearway.read_trajectory(path, metres_per_unit="ft", messages=notes)  # said by the caller
        self.assertNotIn("unit-assumed", [m.code for m in notes])

    def test_points_of_a_moving_scanner_have_origins_by_their_times(self):
        head = bytearray(227)
        struct.pack_into("<4s2xH16xBB", head, 0, b"LASF", 0, 1, 2)
        struct.pack_into("<HIIBHI", head, 94, 227, 227, 0, 1, 28, 2)
        struct.pack_into("<6d", head, 131, 0.001, 0.001, 0.001, 0, 0, 0)
        las = self.folder / "drive.las"
        las.write_bytes(head + b"".join(struct.pack("<3i8xd", x, 0, 0, time)
                                        for x, time in ((1000, 100.25), (2000, 102))))
        path = self.folder / "drive.txt"
        path.write_text("100 0 0 0 0 0 0 1\n101 4 0 0 0 0 0 1\n")
        report = clearway.convert(las, self.folder / "drive.h5", origins_path=path, format="tum",
                                  lever_arm=(0, 0, 1.5))
        self.assertEqual((report.origins, report.points_without_origin), (1, 1))
        found = report.origins_path
        self.assertEqual((found.point_clock, found.path_clock, found.shifts),
                         ("week-seconds", "week-seconds", [0]))
        self.assertEqual((found.first_point, found.last_pose, found.after), (100.25, 101, 1))
        self.assertTrue(clearway.Store(self.folder / "drive.h5").has_origins())
        with self.assertRaisesRegex(clearway.UsageError, "one of the two"):
            clearway.convert(las, self.folder / "other.h5", origins_path=path, origins="o.csv")
        with self.assertRaisesRegex(TypeError, "^lever_arm: "):
            clearway.convert(las, self.folder / "other.h5", origins_path=path, lever_arm=1)

    def test_a_body_that_lacks_poses_is_told_of_once(self):
        lacking = [i for i in range(len(self.poses)) if not 10 <= i < 15]
        body = clearway.Body("wagon", self.model, self.poses[lacking], path_pose=lacking)
        query = clearway.Query(poses=self.poses, radius=RADIUS, bodies=[body])
        report = self.search(query=query)
        told = [w for w in report.warnings if w.code == "body-off-path"]
        self.assertEqual(len(told), 1)
        self.assertIn("body wagon: 5 of", told[0].text)
        self.assertIn("10-14", told[0].text)
        report = self.search(query=query, input_warnings=told)
        self.assertEqual([w.code for w in report.warnings].count("body-off-path"), 1)

    def test_every_engine(self):
        for engine in ("sweep", "kdtree", "grid"):
            with self.subTest(engine):
                report = self.search(engine=engine, device="cpu", threads=2)
                result = clearway.Result(self.folder / "out.h5")
                np.testing.assert_array_equal(result.source(), self.expected)
                self.assertEqual(report.colliding_points, len(self.expected))
                self.assertEqual(len(result), result.size())
                self.assertEqual(report.device, "cpu")
                self.assertEqual(report.engine, engine)

    def test_an_error_budget(self):
        query = clearway.Query(self.model, self.poses, RADIUS, error_scan=0, error_model=0.02)
        report = self.search(query=query)
        self.assertGreater(report.margins["clear"], report.margins["conflict"])
        self.assertGreater(report.margins["conflict"], 0.02)
        self.assertEqual(report.colliding_points, len(self.expected))
        self.assertGreater(report.near_points, 0)
        answer = clearway.Result(self.folder / "out.h5").answer()
        self.assertEqual(answer.verdict, report.verdict)
        self.assertEqual(answer.reasons, report.reasons)
        self.assertEqual(answer.margins, report.margins)
        near = clearway.Result(self.folder / "out.h5").near()
        self.assertEqual(len(near), report.near_points)
        self.assertFalse(set(near.source) & set(self.expected))
        self.assertIsNone(near.certain)
        certain = clearway.Result(self.folder / "out.h5").collisions().certain
        self.assertEqual(certain.dtype, bool)
        self.assertEqual(certain.sum(), report.certain_points)
        self.assertLess(certain.sum(), len(certain))
        query.error_scan = query.error_model = None
        self.assertIsNone(self.search(query=query).margins)
        self.assertIsNone(clearway.Result(self.folder / "out.h5").collisions().certain)
        with self.assertRaisesRegex(clearway.UsageError, "^error_pose: expected 0 or a number"):
            query.error_pose = -0.1

    def test_a_surface(self):
        square = clearway.Model([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]],
                                     [[0, 1, 2], [0, 2, 3]])
        query = clearway.Query(square, self.poses, RADIUS, first_pose=True)
        self.assertIn("2 model triangles", repr(query))
        report = self.search(query=query)
        self.assertEqual((report.model_points, report.model_triangles), (4, 2))
        first = np.full(len(self.points), -1)
        for i in reversed(range(len(self.poses))):
            local = self.points - self.poses[i, :3, 3]
            outside = np.maximum(np.abs(local) - (1, 1, 0), 0)
            first[np.linalg.norm(outside, axis=1) < RADIUS] = i
        result = clearway.Result(self.folder / "out.h5")
        np.testing.assert_array_equal(result.source(), np.flatnonzero(first >= 0))
        np.testing.assert_array_equal(result.first_pose(), first[first >= 0])
        store = clearway.Store(self.folder / "site.h5")
        page = self.folder / "square.html"
        self.assertFalse(clearway.write_report(result, store, square, self.poses, page).clear)
        with self.assertRaises(clearway.InputError):  # its corners alone are another model
            clearway.write_report(result, store, square.vertices, self.poses, page, overwrite=True)

    def test_a_model_with_other_axes_is_turned(self):
        upright = np.array([[2.0, 0.5, 1.0], [-1.0, 0.25, 0.5]])
        in_file = np.stack([upright[:, 2], -upright[:, 0], -upright[:, 1]], axis=1)
        np.savetxt(self.folder / "turned.xyz", in_file, "%.17g")
        turned = clearway.read_model(self.folder / "turned.xyz", forward="-y", up="x")
        np.testing.assert_array_equal(turned.vertices, upright)
        self.assertEqual(turned.file_axes, ("-y", "+x"))
        points = clearway.read_model_points(self.folder / "turned.xyz", forward="-y", up="+x")
        np.testing.assert_array_equal(points, upright)
        with self.assertRaisesRegex(clearway.UsageError, "same axis"):
            clearway.read_model(self.folder / "turned.xyz", forward="z")
        with self.assertRaisesRegex(clearway.UsageError, "forward"):
            clearway.read_model(self.folder / "turned.xyz", forward="w")
        self.search(query=clearway.Query(turned, self.poses, RADIUS, first_pose=True))
        result = clearway.Result(self.folder / "out.h5")
        self.assertEqual(result.model_axes(), ("-y", "+x"))
        clearway.find_conflicts(result, self.poses, model=turned)
        with self.assertRaisesRegex(clearway.UsageError, "turned the model"):
            clearway.find_conflicts(result, self.poses, forward="-y")
        self.search(query=clearway.Query(upright, self.poses, RADIUS, first_pose=True))
        self.assertEqual(clearway.Result(self.folder / "out.h5").model_axes(), ("+x", "+z"))

    def test_a_solid(self):
        corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        faces = ["0 1 3", "0 3 2", "4 6 7", "4 7 5", "0 4 5", "0 5 1",
                 "2 3 7", "2 7 6", "0 2 6", "0 6 4", "1 5 7", "1 7 3"]
        (self.folder / "box.off").write_text(
            "OFF\n8 12 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in corners)
            + "".join(f"3 {face}\n" for face in faces))
        box = clearway.read_model(self.folder / "box.off", "solid")
        np.testing.assert_array_equal(box.solid_of, np.zeros(12))
        query = clearway.Query(box, self.poses, RADIUS, first_pose=True, clearance=0.5)
        report = self.search(query=query)
        local = self.points[None, :, :] - self.poses[:, None, :3, 3]
        beyond = np.abs(local) - 1
        signed = np.where((beyond < 0).all(axis=2), beyond.max(axis=2),
                          np.linalg.norm(np.maximum(beyond, 0), axis=2)).min(axis=0)
        result = clearway.Result(self.folder / "out.h5")
        np.testing.assert_array_equal(result.source(), np.flatnonzero(signed < RADIUS))
        near = result.clearance()
        np.testing.assert_allclose(near.distance, signed[near.source], atol=1e-12)
        self.assertEqual((report.model_solids, report.inside_points), (1, (signed < 0).sum()))
        listed = clearway.find_conflicts(result, self.poses).listed
        self.assertAlmostEqual(max(c.depth for c in listed), -signed.min())
        store = clearway.Store(self.folder / "site.h5")
        page = self.folder / "box.html"
        self.assertFalse(clearway.write_report(result, store, box, self.poses, page).clear)
        with self.assertRaises(clearway.InputError):  # without an inside it is another model
            clearway.write_report(result, store, clearway.Model(box.vertices, box.triangles),
                                  self.poses, page, overwrite=True)

    def test_a_surface_of_a_file(self):
        (self.folder / "one.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        noted = []
        shape = clearway.read_model(self.folder / "one.off", messages=noted)
        np.testing.assert_array_equal(shape.triangles, [[0, 1, 2]])
        self.assertEqual(shape.vertices.shape, (3, 3))
        self.assertIn("searched as it is", noted[0].text)
        sampled = clearway.read_model(self.folder / "one.off", "points", spacing=0.1)
        self.assertEqual(sampled.triangles.shape, (0, 3))
        self.assertIn("model points", repr(clearway.Query(sampled, self.poses, RADIUS)))

    def test_triangles_are_checked(self):
        points = np.eye(3)
        for wrong, said in (([[0, 1, 3]], "the vertex 3, expected 0 to 2"),
                            ([[0, 1, -1]], "the vertex -1"), ([[0, 1]], "n x 3")):
            with self.assertRaisesRegex(clearway.UsageError, said):
                clearway.Model(points, wrong)
        with self.assertRaises(TypeError):
            clearway.Model(points, [[0, 1, 2.5]])

    def test_ignored_boxes(self):
        box = clearway.Box((0, -1, -1), (3, 1, 1))
        inside = np.all((self.points >= (0, -1, -1)) & (self.points <= (3, 1, 1)), axis=1)
        report = self.search(query=self.query(ignore_boxes=[box]))
        result = clearway.Result(self.folder / "out.h5")
        np.testing.assert_array_equal(result.source(), self.expected[~inside[self.expected]])
        self.assertEqual(result.parameters().ignore_boxes, [box])
        self.assertEqual(result.ignored().points, np.count_nonzero(inside))
        self.assertEqual(report.ignored.in_boxes, [np.count_nonzero(inside)])
        self.assertLessEqual(report.ignored_looked_at, report.ignored.points)
        every = self.search("all.h5").colliding_points
        self.assertEqual(report.ignored_colliding, every - report.colliding_points)
        self.assertEqual(result.answer().ignored_colliding, report.ignored_colliding)

    def test_floor(self):
        every = self.search("all.h5").colliding_points
        report = self.search(query=self.query(floor=0.05))
        result = clearway.Result(self.folder / "out.h5")
        self.assertEqual(report.floor_colliding, every - report.colliding_points)
        self.assertEqual(result.answer().floor_colliding, report.floor_colliding)
        self.assertEqual(result.parameters().floor, 0.05)
        self.assertIsNone(clearway.Result(self.folder / "all.h5").answer().floor_colliding)
        self.assertIsNone(self.query().floor)
        body = clearway.Body("car", self.model, self.poses)
        self.assertIsNone(body.floor)
        body.floor = 0.05
        query = clearway.Query(poses=self.poses, radius=RADIUS, bodies=[body])
        same = self.search("body.h5", query=query)
        self.assertEqual(same.colliding_points, report.colliding_points)
        self.assertEqual(same.floor_colliding, report.floor_colliding)
        with self.assertRaisesRegex(clearway.UsageError, "floor"):
            self.search("nan.h5", query=self.query(floor=float("nan")))

    def test_ignored_classes_of_a_store_without(self):
        self.assertEqual(clearway.Store(self.folder / "site.h5").class_points(), {})
        with self.assertRaisesRegex(clearway.UsageError, "have no classes"):
            self.search(query=self.query(ignore_classes=[2]))

    def test_gpu(self):
        try:
            report = self.search(engine="sweep", device="cuda")
        except clearway.ResourceError as error:
            self.assertEqual(error.remedy, "cpu_device")
            self.skipTest(str(error))
        self.assertEqual(report.device, "cuda")
        np.testing.assert_array_equal(clearway.Result(self.folder / "out.h5").source(),
                                      self.expected)

    def test_columns(self):
        self.search(query=self.query(first_pose=True, clearance=0.5, profile=0.5))
        result = clearway.Result(self.folder / "out.h5")
        source, first = result.source(), result.first_pose()
        self.assertEqual((source.dtype, first.dtype), (np.uint64, np.uint32))
        np.testing.assert_array_equal(first, self.first[source])
        self.assertEqual(result.xyz().shape, (len(source), 3))
        np.testing.assert_allclose(result.xyz(), self.points[source], atol=1e-9)
        clearances = result.clearance()
        near = clearances.distance < RADIUS
        np.testing.assert_array_equal(clearances.source[near], source)
        self.assertEqual(clearances.xyz.shape, (len(clearances), 3))
        self.assertEqual(clearances.pose.dtype, np.uint32)
        profile = result.profile()
        self.assertEqual(len(profile), len(self.poses))
        np.testing.assert_allclose(profile.chainage, 0.2 * np.arange(30))
        has_point = profile.source != clearway.Profile.NO_POINT
        np.testing.assert_array_equal(np.isfinite(profile.distance), has_point)
        self.assertEqual(result.parameters().clearance, 0.5)
        self.assertEqual((result.poses(), result.environment_points()), (30, 2000))
        np.testing.assert_allclose(result.model_box().lo, self.model.min(axis=0))

    def test_absent_columns_are_none(self):
        self.search()
        result = clearway.Result(self.folder / "out.h5")
        self.assertIsNone(result.first_pose())
        self.assertIsNone(result.clearance())
        self.assertIsNone(result.profile())

    def test_an_empty_result(self):
        report = self.search(query=self.far_query())
        result = clearway.Result(self.folder / "out.h5")
        self.assertEqual(result.source().shape, (0,))
        self.assertEqual(result.xyz().shape, (0, 3))
        self.assertEqual(result.first_pose().shape, (0,))
        self.assertEqual(len(result.clearance()), 0)  # asked for, and nothing is near: not None
        self.assertIn("out-of-reach", [w.code for w in report.warnings])
        self.assertIn("out-of-reach", repr(report))
        for answer in (report, result.answer()):
            self.assertEqual(answer.verdict, "undecided")
            self.assertEqual(answer.reasons, ["question-in-doubt"])
            self.assertEqual(answer.doubts, ["out-of-reach"])

    def test_the_answer_of_a_file_is_that_of_the_search(self):
        report = self.search(query=self.query(first_pose=True, clearance=0.5, profile=0.5))
        answer = clearway.Result(self.folder / "out.h5").answer()
        self.assertIsInstance(report, clearway.Answer)
        self.assertEqual((answer.verdict, answer.reasons), ("conflict", []))
        for name in ("colliding_points", "clearance_points", "profile_poses", "model_points",
                     "poses", "shard", "ignored_colliding"):
            self.assertEqual(getattr(answer, name), getattr(report, name), name)
        for name in ("first_place", "least_clearance", "least_profile"):
            self.assertEqual(getattr(answer, name).source, getattr(report, name).source, name)

    def test_arrays_outlive_their_result(self):
        self.search()
        result = clearway.Result(self.folder / "out.h5")
        source, xyz = result.source(), result.xyz()
        del result
        os.remove(self.folder / "out.h5")
        np.testing.assert_array_equal(source, self.expected)
        xyz += 1  # they are the caller's
        source[:] = 0

    def test_shards(self):
        query = self.query(first_pose=True, clearance=0.5, profile=0.5)
        warned = self.search("far.h5", self.far_query()).warnings
        self.search("whole.h5", query, input_warnings=warned)
        parts = [self.folder / f"part{i}.h5" for i in range(1, 4)]
        for i, part in enumerate(parts, 1):
            one = self.search(part.name, query, shard=(i, 3), input_warnings=warned)
            self.assertEqual(one.shard, (i, 3))
            self.assertTrue(repr(one).startswith(f"<part {i} of 3: "), repr(one))
        with self.assertRaises(clearway.InputError) as caught:
            clearway.Result(parts[0])
        self.assertEqual(caught.exception.remedy, "merge")
        report = clearway.merge(reversed(parts), self.folder / "merged.h5", overwrite=True)
        self.assertEqual((report.parts, report.colliding_points), (3, len(self.expected)))
        self.assertEqual((self.folder / "merged.h5").read_bytes(),
                         (self.folder / "whole.h5").read_bytes())
        self.assertFalse(report.was_finished)
        self.assertEqual(report.length_unit,
                         clearway.Store(self.folder / "site.h5").length_unit())
        self.assertEqual([(w.code, w.text, w.numbers, w.parts)
                          for w in report.warnings[:len(warned)]],
                         [(w.code, w.text, w.numbers, 3) for w in warned])
        self.assertIn("out-of-reach", repr(report))
        told = []
        again = clearway.merge(parts, self.folder / "merged.h5", resume=True, message=told.append)
        self.assertTrue(again.was_finished)
        self.assertIn("(in all parts)", told[0].text)
        with self.assertRaises(clearway.InputError):
            clearway.merge(parts, self.folder / "merged.h5", overwrite=True, strict=True)
        with self.assertRaises(clearway.InputError):
            clearway.merge(parts[1:], self.folder / "merged.h5", overwrite=True)
        for shard in ((0, 3), (4, 3)):
            with self.assertRaises(clearway.UsageError):
                self.search("none.h5", query, shard=shard)

    def test_conflicts(self):
        self.search(query=self.query(first_pose=True))
        result = clearway.Result(self.folder / "out.h5")
        found = clearway.find_conflicts(result, self.poses, gap=0.3, min_points=5)
        self.assertEqual(len(found.conflict_of), len(result))
        for conflict in found.listed:
            of = found.conflict_of == conflict.id
            self.assertEqual(of.sum(), conflict.points)
            np.testing.assert_allclose(result.xyz()[of].mean(axis=0), conflict.centroid)
            np.testing.assert_array_equal(result.xyz()[of].min(axis=0), conflict.box.lo)
            self.assertIsNone(conflict.encroachment_is)
            self.assertEqual(conflict.colliding, conflict.points)
            self.assertIn(conflict.first_touch, ("left", "right", "above", "below", "front", "behind"))
            trims = {side: getattr(conflict, f"trim_{side}")
                     for side in ("left", "right", "above", "below")}
            known = [trim for trim in trims.values() if trim is not None]
            if known:
                self.assertEqual(trims[conflict.side], min(known))
            else:
                self.assertIn(conflict.side, ("around", conflict.first_touch))
        self.assertEqual((found.gap, found.min_points), (0.3, 5))
        self.assertGreater(found.spacing, 0)
        self.assertEqual(sorted(c.rank for c in found.listed), list(range(1, len(found.listed) + 1)))
        usual = clearway.find_conflicts(result, self.poses)
        self.assertGreaterEqual(usual.gap, 0.3)
        self.assertTrue(1 <= usual.min_points <= 10)
        self.assertEqual(sum(c.points for c in found.listed) + found.small_points, len(result))
        self.assertEqual(sum(g.points for g in found.small), found.small_points)
        for conflict in found.listed:
            of = found.conflict_of == conflict.id
            self.assertEqual(conflict.first_pose, result.first_pose()[of].min())
            self.assertEqual(conflict.last_pose, result.last_pose()[of].max())
            self.assertIsNone(conflict.own_shift_left)
            self.assertIsNotNone(conflict.obstacle_chainage)
        shifted = clearway.find_conflicts(result, self.poses, min_points=5, model=self.model)
        for conflict in shifted.listed:
            for shift in (conflict.own_shift_left, conflict.own_shift_right):
                self.assertTrue(shift is None or 0 < shift <= 2)
        with self.assertRaises(clearway.InputError):
            clearway.find_conflicts(result, self.poses[1:])

    def test_station_table(self):
        self.search(query=self.query(first_pose=True, clearance=0.3))
        result = clearway.Result(self.folder / "out.h5")
        lines = ["station [m],x,y,z,r00,r01,r02,r10,r11,r12,r20,r21,r22"]
        for i, pose in enumerate(self.poses):
            lines.append(",".join(repr(float(v)) for v in
                                  [100 + 2 * i, *pose[:3, 3], *pose[:3, :3].ravel()]))
        (self.folder / "stations.csv").write_text("\n".join(lines) + "\n")
        labels = clearway.PoseLabels()
        clearway.read_trajectory(self.folder / "stations.csv", labels=labels)
        steps = np.linalg.norm(np.diff(self.poses[:, :3, 3], axis=0), axis=1)
        chainage = np.concatenate([[0], np.cumsum(steps)])
        every = chainage[-1] / 3.5
        table = clearway.station_table(result, self.poses, every=every, labels=labels)
        self.assertEqual((len(table), table.bodies), (4, [""]))
        row_of = np.minimum(chainage // every, 3)
        clear = result.clearance()
        for i, row in enumerate(table.rows):
            here = row_of[clear.pose] == i
            self.assertEqual(row.least is None, not here.any())
            if row.least:
                self.assertEqual(row.least.distance, clear.distance[here].min())
            self.assertAlmostEqual(
                row.station_from, np.interp(i * every, chainage, 100 + 2 * np.arange(len(chainage))))
            self.assertIn(row.verdict, ("clear", "conflict", "undecided"))
            self.assertEqual(len(row.overthrow), 1)
        self.assertIn("conflict", [row.verdict for row in table.rows])
        found = clearway.find_conflicts(result, self.poses, min_points=1, labels=labels)
        for conflict in found.listed:
            self.assertEqual(conflict.station_from, 100 + 2 * conflict.first_pose)
            self.assertEqual(conflict.station_to, 100 + 2 * conflict.last_pose)
        self.assertIsNone(clearway.find_conflicts(result, self.poses, min_points=1).listed[0].station_from)
        for every in (0, -1, float("nan")):
            with self.assertRaises(clearway.UsageError):
                clearway.station_table(result, self.poses, every=every)

    def test_report_page(self):
        self.search(query=self.query(first_pose=True))
        summary = clearway.write_report(
            clearway.Result(self.folder / "out.h5"), clearway.Store(self.folder / "site.h5"),
            self.model, self.poses, self.folder / "out.html", title="<Tunnel>", overwrite=True)
        self.assertFalse(summary.clear)
        page = (self.folder / "out.html").read_text()
        self.assertTrue("<title>&lt;Tunnel&gt;</title>" in page)
        self.assertEqual(summary.bytes, len(page.encode()))


    def test_a_page_shows_what_the_search_warned_of(self):
        report = self.search(query=self.far_query())
        codes = [w.code for w in report.warnings]
        self.assertIn("out-of-reach", codes)
        for given in ([], report.warnings):
            summary = clearway.write_report(
                clearway.Result(self.folder / "out.h5"), clearway.Store(self.folder / "site.h5"),
                self.model, self.far_query().poses, self.folder / "far.html", warnings=given,
                overwrite=True)
            told = [w["code"] for w in json.loads(summary.facts)["warnings"]]
            self.assertEqual(sorted(told), sorted(codes))  # each once


class Stores(SceneTest):
    def test_what_a_store_says(self):
        store = clearway.Store(self.folder / "site.h5")
        self.assertEqual(store.point_count(), 2000)
        np.testing.assert_allclose(store.box().lo, self.points.min(axis=0))
        np.testing.assert_allclose(store.box().hi, self.points.max(axis=0))
        self.assertEqual(store.crs_wkt(), "")
        self.assertEqual(store.length_unit(), "unknown")
        self.assertEqual(store.path, self.folder / "site.h5")

    def test_conversion_by_any_path(self):
        scan, store = self.folder / "scan.xyz", self.folder / "again.h5"
        for inputs in (scan, str(scan), os.fsencode(scan), [scan], (str(scan),)):
            report = clearway.convert(inputs, store, overwrite=True, cell_points=64)
            self.assertEqual((report.points, report.was_finished), (2000, False))
        self.assertEqual(store.read_bytes(), (self.folder / "site.h5").read_bytes())
        self.assertTrue(clearway.convert(scan, store, cell_points=64, resume=True)
                        .was_finished)

    def test_heights_in_another_unit(self):
        scan, store = self.folder / "heights.xyz", self.folder / "heights.h5"
        scan.write_text("X [m],Y [m],Z [ft]\n1,2,0\n3,4,10\n")
        with self.assertRaisesRegex(clearway.InputError, "its heights are in foot") as caught:
            clearway.convert(scan, store)
        self.assertEqual(caught.exception.remedy, "ignore_crs")
        self.assertAlmostEqual(clearway.convert(scan, store, unit_z="ft").box.hi[2], 3.048)
        with self.assertRaisesRegex(clearway.UsageError, "unit_z"):
            clearway.convert(scan, store, unit_z=-1)

    def test_names_that_are_no_utf8(self):
        name = os.fsencode(self.folder) + b"/sch\xf6n.h5"
        clearway.convert(self.folder / "scan.xyz", name)
        self.assertEqual(clearway.Store(name).path, Path(os.fsdecode(name)))
        self.assertEqual(clearway.Store(os.fsdecode(name)).point_count(), 2000)
        with self.assertRaisesRegex(clearway.InputError, r"sch\\xf6n"):
            clearway.Result(name)

    def test_a_path_with_a_zero(self):
        with self.assertRaises(ValueError):
            clearway.Store("a\0b")
        with self.assertRaises(TypeError):
            clearway.Store(3)

    def test_files_opened_twice(self):
        self.search()
        one, two = (clearway.Result(self.folder / "out.h5") for _ in range(2))
        np.testing.assert_array_equal(one.source(), two.source())
        del one
        self.assertEqual(two.xyz().shape[1], 3)
        stores = [clearway.Store(self.folder / "site.h5") for _ in range(3)]
        self.assertEqual({s.point_count() for s in stores}, {2000})


class Inputs(SceneTest):
    def test_model_and_trajectory(self):
        np.savetxt(self.folder / "model.xyz", self.model, "%.17g")
        np.testing.assert_array_equal(clearway.read_model_points(self.folder / "model.xyz"), self.model)
        np.savetxt(self.folder / "path.txt", self.poses[:, :3].reshape(-1, 12), "%.17g")
        read = clearway.read_trajectory(self.folder / "path.txt")
        np.testing.assert_array_equal(read, self.poses)

    def test_labels_and_messages(self):
        lines = [f"{10 + i} {i} 0 0 0 0 0 1" for i in range(3)]
        (self.folder / "path.tum").write_text("\n".join(lines))
        labels, messages = clearway.PoseLabels(), []
        poses = clearway.read_trajectory(self.folder / "path.tum", format="tum", labels=labels,
                                         messages=messages)
        self.assertEqual(poses.shape, (3, 4, 4))
        np.testing.assert_array_equal(labels.time, [10, 11, 12])
        for message in messages:
            self.assertEqual((message.severity, message.code), ("note", ""))
        with self.assertRaisesRegex(clearway.UsageError, "format 'tun': expected one of auto"):
            clearway.read_trajectory(self.folder / "path.tum", format="tun")

    def test_alignments(self):
        path = self.folder / "track.xml"
        path.write_text(
            '<LandXML><Units><Metric linearUnit="meter"/></Units><Alignments>'
            '<Alignment name="a" staStart="1000"><CoordGeom>'
            '<Line><Start>0 0</Start><End>0 100</End></Line></CoordGeom>'
            '<Profile><ProfAlign name="p"><PVI>1000 10</PVI><PVI>1100 11</PVI></ProfAlign></Profile>'
            '</Alignment></Alignments></LandXML>')
        labels, messages = clearway.PoseLabels(), []
        poses = clearway.read_alignment(path, station_from=1010, step=30, cant="none",
                                        messages=messages, labels=labels)
        np.testing.assert_array_equal(labels.station, [1010, 1040, 1070, 1100])
        np.testing.assert_allclose(poses[:, :3, 3], [[x, 0, 10 + x / 100] for x in (10, 40, 70, 100)],
                                   atol=1e-12)
        self.assertEqual([message.code for message in messages], ["no-cant"])
        back = clearway.read_alignment(path, alignment="a", profile="p", reverse=True, step=30)
        np.testing.assert_array_equal(back[0, :3, 3], poses[-1, :3, 3])
        np.testing.assert_array_equal(back[0, :3, :2], -poses[-1, :3, :2])
        for kind, words, named in ((clearway.UsageError, "cant 'inner': expected one of file", {"cant": "inner"}),
                                   (clearway.UsageError, "step: expected", {"step": 0}),
                                   (TypeError, "profile: expected a text", {"profile": 1}),
                                   (clearway.UsageError, "--height", {"height": 3}),
                                   (clearway.InputError, "no alignment of the name", {"alignment": "b"})):
            with self.assertRaisesRegex(kind, words):
                clearway.read_alignment(path, **named)

    def test_lines(self):
        path = self.folder / "route.csv"
        path.write_text("x,y,station\n0,0,100\n10,0,110\n10,20,130\n")
        labels, messages = clearway.PoseLabels(), []
        poses = clearway.read_line(path, step=2, height=3, corner_radius=4, messages=messages,
                                   labels=labels)
        self.assertEqual([message.code for message in messages], ["line-rounded"])
        np.testing.assert_allclose(poses[3, :3, 3], [6, 0, 3], atol=1e-12)
        turned = 1 / 2  # radians after 2 m of an arc of 4 m
        np.testing.assert_allclose(poses[4, :2, 0], [np.cos(turned), np.sin(turned)], atol=1e-12)
        self.assertEqual((labels.station[0], labels.station[-1]), (100, 130))
        back = clearway.read_line(path, step=2, height=3, corner_radius=4, reverse=True)
        np.testing.assert_array_equal(back[-1, :3, 3], poses[0, :3, 3])
        np.testing.assert_array_equal(back[-1, :3, :2], -poses[0, :3, :2])
        inches = clearway.read_line(path, height=3, corner_radius=0.1, unit="in")
        np.testing.assert_allclose(inches[-1, :3, 3], [0.254, 0.508, 3], atol=1e-12)
        for kind, words, named in ((clearway.UsageError, "cant 'inner': expected one of file", {"cant": "inner"}),
                                   (clearway.UsageError, "corner_radius: expected", {"corner_radius": 0}),
                                   (clearway.InputError, "turns by 90 degrees", {"height": 1}),
                                   (clearway.InputError, "no heights", {"corner_radius": 1})):
            with self.assertRaisesRegex(kind, words):
                clearway.read_line(path, **named)
        place = [[x / 10, y / 10, 4 + y / 1000] for x in range(-20, 220) for y in range(-20, 220)]
        np.savetxt(self.folder / "ground.xyz", place)
        clearway.convert(self.folder / "ground.xyz", self.folder / "ground.h5", unit="m")
        store = clearway.Store(self.folder / "ground.h5")
        on_ground = clearway.read_line(path, corner_radius=4, ground=store, track=1.5)
        np.testing.assert_allclose(on_ground[:, 2, 3], 4 + on_ground[:, 1, 3] / 100, atol=0.003)
        np.testing.assert_allclose(on_ground[0, 2, 1], 0.01, atol=0.002)
        with self.assertRaisesRegex(TypeError, "ground: expected a clearway.Store"):
            clearway.read_line(path, corner_radius=4, ground="ground.h5", track=1.5)
        with self.assertRaisesRegex(clearway.UsageError, "both or neither"):
            clearway.read_line(path, corner_radius=4, ground=store)
        with self.assertRaises(clearway.InputError) as refused:
            clearway.read_line(path, height=1)
        self.assertEqual(refused.exception.remedy, "round_corners")


if __name__ == "__main__":
    unittest.main()
