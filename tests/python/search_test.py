#!/usr/bin/python3
"""One example of each function and class that searches, reads and reports. search_test.py, with the
module on the path. Every option that has an effect is given once, and its effect is seen."""

import json
import os
import struct
import unittest
from pathlib import Path

import clearway
import numpy as np
from scene import RADIUS, SceneTest, first_poses, poses_along_x, write_las


class Searches(SceneTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.first = first_poses(cls.points, cls.model, cls.poses, RADIUS)
        cls.expected = np.flatnonzero(cls.first >= 0)
        assert len(cls.expected) > 50

    def result(self, query=None, **options):
        self.report = self.search(query=query, **options)
        return clearway.Result(self.folder / "out.h5")

    def far_query(self):
        far = poses_along_x(2, 0.1) + [[0, 0, 0, 50], [0] * 4, [0] * 4, [0] * 4]
        return clearway.Query(self.model, far, 0.1, first_pose=True, clearance=0.2)

    def test_every_engine_finds_what_brute_force_finds(self):
        for engine in ("sweep", "kdtree", "grid"):
            with self.subTest(engine):
                result = self.result(engine=engine, device="cpu", threads=2)
                np.testing.assert_array_equal(result.source(), self.expected)
                self.assertEqual((self.report.colliding_points, len(result), result.size()),
                                 (len(self.expected),) * 3)
                self.assertEqual((self.report.device, self.report.engine), ("cpu", engine))
                for column in (result.first_pose, result.clearance, result.profile):
                    self.assertIsNone(column())

    def test_gpu(self):
        try:
            result = self.result(device="cuda")
        except clearway.ResourceError as error:
            self.assertEqual(error.remedy, "cpu_device")
            self.skipTest(str(error))
        self.assertEqual(self.report.device, "cuda")
        np.testing.assert_array_equal(result.source(), self.expected)

    def test_columns_and_the_answer_of_a_file(self):
        result = self.result(self.query(first_pose=True, clearance=0.5, profile=0.5))
        source, first = result.source(), result.first_pose()
        self.assertEqual((source.dtype, first.dtype), (np.uint64, np.uint32))
        np.testing.assert_array_equal(first, self.first[source])
        np.testing.assert_allclose(result.xyz(), self.points[source], atol=1e-9)
        near = result.clearance()
        np.testing.assert_array_equal(near.source[near.distance < RADIUS], source)
        self.assertEqual((near.xyz.shape, near.pose.dtype), ((len(near), 3), np.uint32))
        profile = result.profile()
        np.testing.assert_allclose(profile.chainage, 0.2 * np.arange(30))
        np.testing.assert_array_equal(np.isfinite(profile.distance),
                                      profile.source != clearway.Profile.NO_POINT)
        self.assertEqual((result.poses(), result.environment_points()), (30, 2000))
        np.testing.assert_allclose(result.model_box().lo, self.model.min(axis=0))
        self.assertEqual(result.parameters().clearance, 0.5)
        answer = result.answer()
        self.assertIsInstance(self.report, clearway.Answer)
        self.assertEqual((answer.verdict, answer.reasons), ("conflict", []))
        for name in ("colliding_points", "clearance_points", "profile_poses", "model_points",
                     "poses", "shard", "ignored_colliding"):
            self.assertEqual(getattr(answer, name), getattr(self.report, name), name)
        for name in ("first_place", "least_clearance", "least_profile"):
            self.assertEqual(getattr(answer, name).source, getattr(self.report, name).source, name)

    def test_an_empty_result_is_not_an_absent_one(self):
        result = self.result(self.far_query())
        self.assertEqual((result.xyz().shape, result.first_pose().shape, len(result.clearance())),
                         ((0, 3), (0,), 0))
        codes = [w.code for w in self.report.warnings]
        self.assertIn("out-of-reach", codes)
        self.assertIn("out-of-reach", repr(self.report))
        for answer in (self.report, result.answer()):
            self.assertEqual((answer.verdict, answer.reasons, answer.doubts),
                             ("undecided", ["question-in-doubt"], ["out-of-reach"]))
        summary = clearway.write_report(result, clearway.Store(self.folder / "site.h5"), self.model,
                                        self.far_query().poses, self.folder / "far.html",
                                        warnings=self.report.warnings)
        told = [w["code"] for w in json.loads(summary.facts)["warnings"]]
        self.assertEqual(sorted(told), sorted(codes))  # each once

    def test_an_error_budget(self):
        query = self.query(error_scan=0, error_model=0.02)
        result = self.result(query)
        report, answer, near, certain = self.report, result.answer(), result.near(), result.collisions().certain
        self.assertTrue(report.margins["clear"] > report.margins["conflict"] > 0.02)
        self.assertEqual((answer.verdict, answer.reasons, answer.margins),
                         (report.verdict, report.reasons, report.margins))
        self.assertTrue(len(near) == report.near_points > 0)
        self.assertFalse(set(near.source) & set(self.expected))
        self.assertIsNone(near.certain)
        self.assertEqual((certain.dtype, certain.sum()), (bool, report.certain_points))
        self.assertLess(certain.sum(), len(certain))
        margins = [self.search(query=self.query(error_scan=0.01, sigmas=sigmas)).margins["clear"]
                   for sigmas in (1, 3)]
        self.assertLess(margins[0], margins[1])
        query.error_scan = query.error_model = None
        self.assertIsNone(self.result(query).collisions().certain)

    def test_parameters_of_a_query_change_what_is_found(self):
        every = len(self.expected)
        box = clearway.Box((0, -1, -1), (3, 1, 1))
        inside = np.all((self.points >= box.lo) & (self.points <= box.hi), axis=1)
        result = self.result(self.query(ignore_boxes=[box]))
        np.testing.assert_array_equal(result.source(), self.expected[~inside[self.expected]])
        self.assertEqual((result.parameters().ignore_boxes, result.ignored().points, self.report.ignored_colliding),
                         ([box], inside.sum(), inside[self.expected].sum()))
        self.assertGreater(self.search(query=self.query(between_poses=True)).colliding_points, every)
        result = self.result(self.query(floor=0.05))
        for floored in (self.report, result.answer()):
            self.assertEqual(floored.floor_colliding, every - self.report.colliding_points)
        self.assertEqual((result.parameters().floor, self.query().floor, self.search().floor_colliding),
                         (0.05, None, None))
        body = clearway.Body("car", self.model, self.poses)
        body.floor = 0.05
        query = clearway.Query(poses=self.poses, radius=RADIUS, bodies=[body])
        self.assertEqual(self.search("body.h5", query).colliding_points, len(result))
        self.assertIn("no radius yet", repr(clearway.Query(self.model, self.poses)))

    def test_a_surface_and_a_solid(self):
        half = 0.99975  # points are on its lower side alone
        made = clearway.box_model(2 * half, 2 * half, 2 * half)
        (self.folder / "box.off").write_text(
            "OFF\n8 12 0\n" + "".join("{} {} {}\n".format(*v) for v in made.vertices)
            + "".join("3 {} {} {}\n".format(*t) for t in made.triangles))
        local = np.abs(self.points[None] - self.poses[:, None, :3, 3] - (0, 0, half)) - half
        signed = np.where((local < 0).all(axis=2), local.max(axis=2),
                          np.linalg.norm(np.maximum(local, 0), axis=2)).min(axis=0)
        found, boxes = {}, {}
        for model_as in ("points", "surface", "solid"):
            box = boxes[model_as] = clearway.read_model(self.folder / "box.off", model_as,
                                                        spacing=0.3 * (model_as == "points"))
            result = self.result(clearway.Query(box, self.poses, RADIUS, first_pose=True, clearance=0.5))
            found[model_as] = set(result.source())
        self.assertEqual((self.report.model_solids, self.report.model_triangles, self.report.inside_points),
                         (1, 12, (signed <= 0).sum()))
        near = result.clearance()
        np.testing.assert_allclose(near.distance, signed[near.source], atol=1e-12)
        np.testing.assert_array_equal(boxes["solid"].solid_of, np.zeros(12))
        listed = clearway.find_conflicts(result, self.poses).listed
        self.assertAlmostEqual(max(c.depth for c in listed), -signed.min())
        self.assertEqual(boxes["points"].triangles.shape, (0, 3))
        self.assertGreater(len(boxes["points"].vertices), 100)
        self.assertGreater(boxes["points"].spacing, 0.2)
        self.assertEqual(found["solid"], set(np.flatnonzero(signed < RADIUS)))
        self.assertTrue(found["points"] < found["surface"] <= found["solid"])

    def test_a_model_of_triangles(self):
        square = clearway.Model([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
        self.assertIn("2 model triangles", repr(clearway.Query(square, self.poses)))
        for wrong, said in (([[0, 1, 4]], "the vertex 4, expected 0 to 3"), ([[0, 1, -1]], "the vertex -1"),
                            ([[0, 1]], "n x 3"), ([[0, 1, 2.5]], "triangles")):
            with self.assertRaisesRegex((clearway.UsageError, TypeError), said):
                clearway.Model(square.vertices, wrong)
        result = self.result(clearway.Query(square, self.poses, RADIUS, first_pose=True))
        store = clearway.Store(self.folder / "site.h5")
        with self.assertRaises(clearway.InputError):  # its corners alone are another model
            clearway.write_report(result, store, square.vertices, self.poses, self.folder / "no.html")

    def test_a_model_with_other_axes_is_turned(self):
        upright, path = np.array([[2.0, 0.5, 1.0], [-1.0, 0.25, 0.5]]), self.folder / "turned.xyz"
        np.savetxt(path, np.stack([upright[:, 2], -upright[:, 0], -upright[:, 1]], axis=1), "%.17g")
        axes = {"forward": "-y", "up": "x"}
        turned = clearway.read_model(path, **axes)
        for points in (turned.vertices, clearway.read_model_points(path, **axes),
                       clearway.read_model_points(path, **axes, unit="mm") * 1000):
            np.testing.assert_allclose(points, upright, rtol=1e-15)
        with self.assertRaisesRegex(clearway.UsageError, "same axis"):
            clearway.read_model(path, forward="z")
        result = self.result(clearway.Query(turned, self.poses, RADIUS, first_pose=True))
        self.assertEqual((turned.file_axes, result.model_axes()), (("-y", "+x"),) * 2)
        clearway.find_conflicts(result, self.poses, model=turned)
        with self.assertRaisesRegex(clearway.UsageError, "turned the model"):
            clearway.find_conflicts(result, self.poses, forward="-y")

    def test_arrays_outlive_their_result(self):
        result = self.result()
        source, xyz = result.source(), result.xyz()
        del result
        os.remove(self.folder / "out.h5")
        np.testing.assert_array_equal(source, self.expected)
        xyz += 1  # they are the caller's
        source[:] = 0

    def test_shards_are_merged(self):
        query = self.query(first_pose=True, clearance=0.5, profile=0.5)
        warned = self.search("far.h5", self.far_query()).warnings
        self.search("whole.h5", query, input_warnings=warned)
        parts, merged = [self.folder / f"part{i}.h5" for i in range(1, 4)], self.folder / "merged.h5"
        for i, part in enumerate(parts, 1):
            one = self.search(part.name, query, shard=(i, 3), input_warnings=warned)
            self.assertEqual(one.shard, (i, 3))
            self.assertTrue(repr(one).startswith(f"<part {i} of 3: "), repr(one))
        with self.assertRaises(clearway.InputError) as caught:
            clearway.Result(parts[0])
        self.assertEqual(caught.exception.remedy, "merge")
        report = clearway.merge(reversed(parts), merged)
        self.assertEqual((report.parts, report.colliding_points, report.was_finished, report.length_unit),
                         (3, len(self.expected), False, "unknown"))
        self.assertEqual(merged.read_bytes(), (self.folder / "whole.h5").read_bytes())
        self.assertEqual([(w.code, w.text, w.numbers, w.parts) for w in report.warnings[:len(warned)]],
                         [(w.code, w.text, w.numbers, 3) for w in warned])
        self.assertIn("out-of-reach", repr(report))
        told = []
        self.assertTrue(clearway.merge(parts, merged, resume=True, message=told.append).was_finished)
        self.assertIn("(in all parts)", told[0].text)
        for given, options in ((parts, {"strict": True}), (parts[1:], {})):
            with self.assertRaises(clearway.InputError):
                clearway.merge(given, merged, overwrite=True, **options)

    def test_conflicts(self):
        result = self.result(self.query(first_pose=True))
        found = clearway.find_conflicts(result, self.poses, gap=0.3, min_points=5, chainage_start=100,
                                        model=self.model)
        self.assertEqual((found.gap, found.min_points, len(found.conflict_of)), (0.3, 5, len(result)))
        self.assertGreater(len(found.listed), 1)
        for conflict in found.listed:
            of = found.conflict_of == conflict.id
            self.assertEqual((conflict.points, conflict.colliding), (of.sum(), of.sum()))
            np.testing.assert_allclose(result.xyz()[of].mean(axis=0), conflict.centroid)
            np.testing.assert_array_equal(result.xyz()[of].min(axis=0), conflict.box.lo)
            self.assertEqual((conflict.first_pose, conflict.last_pose, conflict.encroachment_is),
                             (result.first_pose()[of].min(), result.last_pose()[of].max(), None))
            self.assertAlmostEqual(conflict.chainage_from, 100 + 0.2 * conflict.first_pose)
            self.assertIn(conflict.first_touch, ("left", "right", "above", "below", "front", "behind"))
            known = [trim for side in ("left", "right", "above", "below")
                     if (trim := getattr(conflict, f"trim_{side}")) is not None]
            if known and conflict.side in ("left", "right", "above", "below"):
                self.assertEqual(getattr(conflict, f"trim_{conflict.side}"), min(known))
            for shift in (conflict.own_shift_left, conflict.own_shift_right):
                self.assertTrue(shift is None or 0 < shift <= 2)
        self.assertEqual(sorted(c.rank for c in found.listed), list(range(1, len(found.listed) + 1)))
        self.assertEqual(sum(c.points for c in found.listed) + found.small_points, len(result))
        self.assertEqual(sum(g.points for g in found.small), found.small_points)
        usual = clearway.find_conflicts(result, self.poses)
        self.assertTrue(usual.gap >= 0.3 and 1 <= usual.min_points <= 10 and usual.spacing > 0)
        with self.assertRaises(clearway.InputError):
            clearway.find_conflicts(result, self.poses[1:])

    def test_station_table_and_stations_of_conflicts(self):
        result = self.result(self.query(first_pose=True, clearance=0.3))
        table = np.hstack([100 + 2 * np.arange(30)[:, None], self.poses[:, :3, 3], self.poses[:, :3, :3].reshape(30, 9)])
        np.savetxt(self.folder / "stations.csv", table, "%.17g", ",", comments="",
                   header="station [m],x,y,z,r00,r01,r02,r10,r11,r12,r20,r21,r22")
        labels = clearway.PoseLabels()
        clearway.read_trajectory(self.folder / "stations.csv", labels=labels)
        every, clear = 5.8 / 3.5, result.clearance()
        table = clearway.station_table(result, self.poses, every=every, labels=labels)
        self.assertEqual((len(table), table.bodies), (4, [""]))
        row_of = np.minimum(0.2 * np.arange(30) // every, 3)
        for i, row in enumerate(table.rows):
            here = clear.distance[row_of[clear.pose] == i]
            self.assertEqual(row.least and row.least.distance, here.min() if len(here) else None)
            self.assertAlmostEqual(row.station_from, 100 + 10 * i * every)
            self.assertIn(row.verdict, ("clear", "conflict", "undecided"))
            self.assertEqual(len(row.overthrow), 1)
        self.assertIn("conflict", [row.verdict for row in table.rows])
        for conflict in clearway.find_conflicts(result, self.poses, min_points=1, labels=labels).listed:
            self.assertEqual((conflict.station_from, conflict.station_to),
                             (100 + 2 * conflict.first_pose, 100 + 2 * conflict.last_pose))
        self.assertIsNone(clearway.find_conflicts(result, self.poses, min_points=1).listed[0].station_from)
        with self.assertRaisesRegex(clearway.UsageError, "stretches of 0 m"):
            clearway.station_table(result, self.poses, every=0)

    def test_report_page(self):
        result, store = self.result(self.query(first_pose=True)), clearway.Store(self.folder / "site.h5")
        path = self.folder / "out.html"
        summary = clearway.write_report(result, store, self.model, self.poses, path, title="<Tunnel>",
                                        overwrite=True)
        page = path.read_text()
        self.assertFalse(summary.clear)
        self.assertIn("<title>&lt;Tunnel&gt;</title>", page)
        self.assertEqual(summary.bytes, len(page.encode()))
        with self.assertRaisesRegex(clearway.UsageError, r"^model: expected .* \(\) where bodies"):
            clearway.write_report(result, store, None, self.poses, path)


class Stores(SceneTest):
    def test_what_a_store_says(self):
        store = clearway.Store(self.folder / "site.h5")
        self.assertEqual((store.point_count(), store.crs_wkt(), store.length_unit(), store.path,
                          store.class_points(), store.has_origins()),
                         (2000, "", "unknown", self.folder / "site.h5", {}, False))
        np.testing.assert_allclose([store.box().lo, store.box().hi],
                                   [self.points.min(axis=0), self.points.max(axis=0)])

    def test_conversion_by_any_path(self):
        scan, store = self.folder / "scan.xyz", self.folder / "again.h5"
        for inputs in (scan, str(scan), os.fsencode(scan), [scan], (str(scan),)):
            report = clearway.convert(inputs, store, overwrite=True, cell_points=64)
            self.assertEqual((report.points, report.was_finished), (2000, False))
        self.assertEqual(store.read_bytes(), (self.folder / "site.h5").read_bytes())
        self.assertTrue(clearway.convert(scan, store, cell_points=64, resume=True).was_finished)
        name = os.fsencode(self.folder) + b"/sch\xf6n.h5"  # no UTF-8
        clearway.convert(scan, name)
        self.assertEqual(clearway.Store(name).path, Path(os.fsdecode(name)))
        self.assertEqual(clearway.Store(os.fsdecode(name)).point_count(), 2000)
        with self.assertRaisesRegex(clearway.InputError, r"sch\\xf6n"):
            clearway.Result(name)
        with self.assertRaises(ValueError):
            clearway.Store("a\0b")

    def test_options_of_a_conversion(self):
        rows, bad = self.folder / "rows.xyz", self.folder / "bad.xyz"
        rows.write_text("7 1 2 3\n7 4 5 6\n")
        bad.write_text("7 1 2 3\n7 x\n")
        store = self.folder / "rows.h5"
        report = clearway.convert([rows, bad], store, columns=["2", "3", "4"], skip_unreadable=True)
        self.assertEqual((report.points, report.box.hi[2]), (2, 6))
        with self.assertRaises(clearway.InputError):
            clearway.convert([rows, bad], store, columns=["2", "3", "4"], overwrite=True)
        rows.write_text("X [m],Y [m],Z [ft]\n1,2,0\n3,4,10\n")
        self.assertAlmostEqual(clearway.convert(rows, store, unit_z="ft", overwrite=True).box.hi[2], 3.048)

    def test_points_of_a_moving_scanner_have_origins_by_their_times(self):
        las, path = self.folder / "drive.las", self.folder / "drive.txt"
        write_las(las, [(1000, 0, 0), (2000, 0, 0)], times=(100.25, 102))
        path.write_text("100 0 0 0 0 0 0 1\n101 4 0 0 0 0 0 1\n")
        options = {"origins_path": path, "format": "tum", "lever_arm": (0, 0, 1.5)}
        report = clearway.convert(las, self.folder / "drive.h5", **options)
        found = report.origins_path
        self.assertEqual((report.origins, report.points_without_origin, found.point_clock, found.path_clock,
                          found.shifts, found.first_point, found.last_pose, found.after),
                         (1, 1, "week-seconds", "week-seconds", [0], 100.25, 101, 1))
        self.assertTrue(clearway.Store(self.folder / "drive.h5").has_origins())
        with self.assertRaisesRegex(clearway.UsageError, "one of the two"):
            clearway.convert(las, self.folder / "other.h5", **options, origins="o.csv")

    def test_classes(self):
        las = self.folder / "classes.las"
        write_las(las, np.rint(1000 * self.points).astype(int), classes=[2 + i % 3 for i in range(2000)])
        clearway.convert(las, self.folder / "classes.h5", unit="m")
        store = clearway.Store(self.folder / "classes.h5")
        self.assertEqual(store.class_points(), {2: 667, 3: 667, 4: 666})
        clearway.search(store, self.query(ignore_classes=[2]), self.folder / "classes_out.h5")
        result = clearway.Result(self.folder / "classes_out.h5")
        self.assertEqual(result.parameters().ignore_classes, [2])
        self.assertTrue(len(result) and (result.source() % 3 != 0).all())


class Inputs(SceneTest):
    def test_trajectories(self):
        path = self.folder / "path.txt"
        np.savetxt(path, self.poses[:, :3].reshape(-1, 12), "%.17g")
        np.testing.assert_array_equal(clearway.read_trajectory(path), self.poses)
        path.write_text("\n".join(f"{10 + i} {i} 0 0 0 0 0 1" for i in range(3)))
        labels, messages = clearway.PoseLabels(), []
        poses = clearway.read_trajectory(path, format="tum", labels=labels, messages=messages)
        self.assertEqual(poses.shape, (3, 4, 4))
        np.testing.assert_array_equal(labels.time, [10, 11, 12])
        self.assertEqual({(m.severity, m.code) for m in messages} - {("note", "")}, set())
        moved = clearway.read_trajectory(path, format="tum", lever_arm=(0, 0, 1.5))
        np.testing.assert_array_equal(moved[:, 2, 3], [-1.5] * 3)

    def test_a_file_in_another_unit_needs_the_unit_of_the_environment(self):
        path = self.folder / "feet.csv"
        path.write_text("x [ft],y [ft],z [ft],qx,qy,qz,qw\n0,0,0,0,0,0,1\n10,0,0,0,0,0,1\n")
        with self.assertRaisesRegex(clearway.UsageError, "feet.*store.metres_per_unit"):
            clearway.read_trajectory(path)
        for named, x in (({"environment_unit": 1.0}, 3.048), ({"metres_per_unit": "ft"}, 3.048),
                         ({"environment_unit": clearway.METRES_PER_FOOT}, 10)):
            self.assertAlmostEqual(clearway.read_trajectory(path, **named)[1, 0, 3], x)

    def test_alignments(self):
        path = self.folder / "track.xml"
        path.write_text(
            '<LandXML><Units><Metric linearUnit="meter"/></Units><Alignments>'
            '<Alignment name="a" staStart="1000"><CoordGeom>'
            '<Line><Start>0 0</Start><End>0 100</End></Line></CoordGeom>'
            '<Profile><ProfAlign name="p"><PVI>1000 10</PVI><PVI>1100 11</PVI></ProfAlign></Profile>'
            '</Alignment></Alignments></LandXML>')
        labels, messages = clearway.PoseLabels(), []
        poses = clearway.read_alignment(path, alignment="a", profile="p", station_from=1010, station_to=1090,
                                        step=30, cant="none", messages=messages, labels=labels)
        np.testing.assert_array_equal(labels.station, [1010, 1040, 1070, 1090])
        np.testing.assert_allclose(poses[:, :3, 3], [[x, 0, 10 + x / 100] for x in (10, 40, 70, 90)], atol=1e-12)
        self.assertEqual([message.code for message in messages], ["no-cant"])
        for words, named in (("--height", {"height": 3}), ("no alignment of the name", {"alignment": "b"}),
                             ("no profile of the name", {"profile": "b"})):
            with self.assertRaisesRegex((clearway.UsageError, clearway.InputError), words):
                clearway.read_alignment(path, **named)

    def test_lines(self):
        path, ground, labels, messages = self.folder / "route.csv", self.folder / "ground.h5", clearway.PoseLabels(), []
        path.write_text("x,y,station\n0,0,100\n10,0,110\n10,20,130\n")
        poses = clearway.read_line(path, step=2, height=3, corner_radius=4, messages=messages, labels=labels)
        self.assertEqual([message.code for message in messages], ["line-rounded"])
        np.testing.assert_allclose(poses[3, :3, 3], [6, 0, 3], atol=1e-12)
        turned = 1 / 2  # radians after 2 m of an arc of 4 m
        np.testing.assert_allclose(poses[4, :2, 0], [np.cos(turned), np.sin(turned)], atol=1e-12)
        self.assertEqual((labels.station[0], labels.station[-1]), (100, 130))
        for words, named in (("no heights", {"corner_radius": 1}), ("turns by 90 degrees", {"height": 1})):
            with self.assertRaisesRegex(clearway.InputError, words) as refused:
                clearway.read_line(path, **named)
        self.assertEqual(refused.exception.remedy, "round_corners")
        x, y = (axis.ravel() / 10 for axis in np.mgrid[-20:220, -20:220])
        np.savetxt(self.folder / "ground.xyz", np.stack([x, y, 4 + y / 100], axis=1))
        clearway.convert(self.folder / "ground.xyz", ground, unit="m")
        on_ground = clearway.read_line(path, corner_radius=4, ground=clearway.Store(ground), track=1.5)
        np.testing.assert_allclose(on_ground[:, 2, 3], 4 + on_ground[:, 1, 3] / 100, atol=0.003)
        np.testing.assert_allclose(on_ground[0, 2, 1], 0.01, atol=0.002)


if __name__ == "__main__":
    unittest.main()
