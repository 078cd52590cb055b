#!/usr/bin/python3
"""Sections from Python: against numpy and against the command line's file.

Usage: PYTHONPATH=BUILD/python section_test.py PROGRAM
"""

import math
import re
import subprocess
import sys
import threading
import unittest
from pathlib import Path

import clearway
import numpy as np
from scene import SceneTest

PROGRAM = None
REAR, FRONT, MARGIN = -0.8, 1.1, 0.2
WINDOW = (-1.5, 1.5, -0.9, 0.9)
CELL, BIN = 0.1, 1.0
MIDDLE = clearway.Box((-9, -0.7, -0.5), (9, 0.9, 0.6))


def rows(cells):
    """Cells as {(bin, k, j) or (k, j): first pose}; also asserts their order."""
    columns = [cells.k, cells.j] if cells.bin is None else [cells.bin, cells.k, cells.j]
    keys = list(zip(*(map(int, c) for c in columns)))
    assert keys == sorted(set(keys))
    return dict(zip(keys, map(int, cells.first_pose)))


class Sections(SceneTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        turn = np.deg2rad(1) * np.arange(len(cls.poses))
        cls.poses[:, 0, 0] = cls.poses[:, 1, 1] = np.cos(turn)
        cls.poses[:, 1, 0], cls.poses[:, 0, 1] = np.sin(turn), -np.sin(turn)
        cls.poses[:, 1:3, 3] = 0.00037, 0.00041  # so that no place is on the border of a cell

    def find(self, name="section.h5", **options):
        asked = {"window": WINDOW, "cell": CELL, "bin": BIN, "margin": MARGIN, "overwrite": True}
        store = clearway.Store(self.folder / "site.h5")
        return clearway.find_section(store, self.poses, self.folder / name, REAR, FRONT,
                                     **{**asked, **options})

    def section(self, **options):
        self.find(**options)
        return clearway.Section(self.folder / "section.h5")

    def run_in_folder(self, command):
        """What a command prints that finds the path and the store in its folder."""
        np.savetxt(self.folder / "path.txt", self.poses[:, :3, :].reshape(-1, 12), "%.17g")
        return subprocess.run(command, cwd=self.folder, check=True, capture_output=True, text=True).stdout

    def test_cells(self):
        stages = []
        report = self.find(progress=lambda update: stages.append(update.stage))
        self.assertEqual(stages[0], "section")
        section = clearway.Section(str(self.folder / "section.h5"))
        cells, whole = rows(section.bin_cells()), {}
        for (_, k, j), pose in cells.items():
            whole[k, j] = min(pose, whole.get((k, j), pose))
        self.assertEqual(rows(section.cells()), whole)
        self.assertEqual((section.unknown_cells(), section.unknown_bin_cells()), (None, None))
        self.assertEqual((report.blocked, report.blocked_in_bins, report.bins),
                         (len(whole), len(cells), len(section.bins())))
        self.assertEqual([c.dtype for c in (section.cells().j, section.cells().first_pose)],
                         [np.int32, np.uint32])
        self.assertIn(f"{report.blocked} blocked cells", repr(section))
        self.assertIn("cells are blocked", repr(report))

    def test_facts(self):
        box = clearway.Box((0, 0, 0), (1, 1, 1))
        section = self.section(pivots=(0.5, -0.3), ignore_boxes=[box])
        asked = section.parameters()
        self.assertEqual((asked.rear, asked.front, asked.window, asked.cell, asked.bin, asked.margin,
                          asked.between_poses, asked.pivots, asked.ignore_classes, asked.ignore_boxes),
                         (REAR, FRONT, WINDOW, CELL, BIN, MARGIN, False, (0.5, -0.3), [], [box]))
        ignored = ((self.points >= 0) & (self.points <= 1)).all(axis=1).sum()
        self.assertEqual((section.environment_points(), section.ignored_points(), section.poses(),
                          section.path, section.length_unit(), section.motion()),
                         (len(self.points), ignored, len(self.poses), self.folder / "section.h5",
                          "unknown", None))
        self.assertLess(section.load_poses(), section.poses())
        self.assertTrue(0 < section.rounding() < 1e-9)
        np.testing.assert_allclose(section.chainage(), 0.2 * np.arange(len(self.poses)), rtol=1e-12)
        between = self.section(between_poses=True)
        self.assertAlmostEqual(between.motion()[0], 0.2, delta=0.05)
        self.assertGreater(between.motion()[1], 0)
        plain = self.section(window=None, cell=0, bin=0).parameters()
        self.assertEqual((plain.window, plain.cell, plain.bin), ((-4, 4, 0, 6), 0.02, 5))

    def test_free_cells_and_ignored_cells(self):
        report = self.find(ignore_boxes=[MIDDLE])
        section = clearway.Section(self.folder / "section.h5")
        grid, cells, expected = section.grid(), section.cells(), np.ones((18, 30), bool)
        self.assertEqual((grid.j_from, grid.j_to, grid.k_from, grid.k_to), (-15, 15, -9, 9))
        expected[cells.k - grid.k_from, cells.j - grid.j_from] = False
        free = section.free_cells(0)
        self.assertEqual(free.dtype, bool)
        np.testing.assert_array_equal(free, expected)
        narrower = section.free_cells(0.15)
        self.assertTrue(narrower.any() and (free & narrower == narrower).all() and narrower.sum() < free.sum())
        self.assertFalse(section.free_cells(0.3).any())  # more than the section was found for
        all_cells = rows(self.section().cells())
        only = [k for k, j in all_cells if (k, j) not in rows(cells)]
        self.assertGreater(len(only), 20)
        high = sum(k * CELL > 0.5 for k in only)  # above the wheels
        for found in (report.ignored_cells, section.ignored_cells()):
            self.assertEqual((found.blocked, found.high), (len(only), high))
        self.assertIsNone(self.section().ignored_cells())

    def test_checks_of_outlines(self):
        section = self.section(ignore_boxes=[MIDDLE])
        passes = section.check([(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)], 0)
        self.assertEqual((passes.verdict, passes.reason, passes.stop, passes.stops),
                         ("passes", None, None, []))
        wide = np.array([(-1.4, -0.1), (1.4, -0.1), (1.4, 0.1), (-1.4, 0.1)])
        stopped = section.check(wide, 0.05)
        self.assertEqual((stopped.verdict, stopped.reason), ("stopped", None))
        cells = rows(section.bin_cells())
        stop = stopped.stop
        self.assertEqual(cells[stop.bin, stop.cell[1], stop.cell[0]], stop.first_pose)
        self.assertEqual(stop.chainage, section.chainage()[stop.first_pose])
        self.assertIn("stopped at pose", repr(stopped))
        self.assertEqual(repr(section.check(wide)), repr(section.check(wide, MARGIN)))
        unknown = section.check(wide / 50, 0.21)
        self.assertEqual(unknown.verdict, "unknown")
        self.assertRegex(unknown.reason, "margins up to 0.2 only")
        for outline, margin, error in (
                ([], 0, "0 corners"), ([(0, 0), (1, 1)], 0, "3"), ("text", 0, "outline: "),
                ([1, 2, 3], 0, "n x 2"), ([(0, 0), (1, math.nan), (1, 1)], 0, "outline: corner 1"),
                (wide, -1, "^margin: "), (wide, "a", "^margin: ")):
            with self.subTest(error), self.assertRaisesRegex((clearway.Error, TypeError), error):
                section.check(outline, margin)

    def test_a_table_of_outlines_is_a_check_of_each_row(self):
        section, table = self.section(), self.folder / "outlines.csv"
        for name, half in (("narrow.csv", 0.2), ("wide.csv", 1.2)):
            (self.folder / name).write_text(f"{-half},-0.3\n{half},-0.3\n{half},0.3\n{-half},0.3\n")
        table.write_text("chainage_from,chainage_to,outline,margin\n0,2.9,narrow.csv,0.1\n2.9,5.8,wide.csv,\n")
        check = section.check_table(table, 0.05)
        self.assertEqual([(r.line, r.outline, r.margin) for r in check.rows],
                         [(2, "narrow.csv", 0.1), (3, "wide.csv", 0.05)])
        for row in check.rows:
            whole = section.check(clearway.read_outline(self.folder / row.outline), row.margin)
            self.assertEqual([(s.bin, s.first_pose, s.cell) for s in row.check.stops],
                             [(s.bin, s.first_pose, s.cell) for s in whole.stops
                              if row.bins[0] <= s.bin <= row.bins[1]])
        self.assertEqual((check.gaps, check.verdict), ([], "stopped" if check.stops else "passes"))
        table.write_text("station_from,station_to,outline\n0,2.9,narrow.csv\n")
        gap = section.check_table(table, station=2 * section.chainage()).gaps[0]
        self.assertAlmostEqual(gap.chainage_from, 1.45)
        with self.assertRaisesRegex(clearway.UsageError, "no stations"):
            section.check_table(table)

    def test_widths(self):
        section = self.section(ignore_boxes=[MIDDLE])
        bands = section.bands(band=0.3, base=-0.3)
        self.assertEqual(len(bands), 4)
        row = [(j, pose) for (k, j), pose in rows(section.cells()).items() if -3 <= k < 0]
        left, right = min(j for j, _ in row if j >= 0), min(-j - 1 for j, _ in row if j < 0)
        np.testing.assert_allclose((bands[0].left, bands[0].right, section.symmetric_width(bands[0])),
                                   np.array((left, right, 2 * min(left, right))) * CELL)
        self.assertEqual(bands[0].left_pose, min(pose for j, pose in row if j == left))
        self.assertEqual([b.left for b in section.boxes(0.3, -0.3)],
                         list(np.minimum.accumulate([b.left for b in bands])))
        self.assertEqual([s.bin for s in section.stations(0.3, -0.3)], list(section.bins()))
        for words, call, named in (("^band: ", section.bands, {"band": -1}),
                                   ("below the window", section.boxes, {"base": -1})):
            with self.assertRaisesRegex(clearway.UsageError, words):
                call(**named)

    def test_the_command_line_writes_the_same_bytes(self):
        self.find(between_poses=True, pivots=(0.5, -0.3))
        self.run_in_folder([PROGRAM, "section", "find", "--env", "site.h5", "--trajectory", "path.txt",
                  f"--x-range={REAR},{FRONT}", "--pivots=0.5,-0.3", "--between-poses",
                  f"--window={','.join(map(str, WINDOW))}", "--cell", str(CELL), "--bin", str(BIN),
                  "--margin", str(MARGIN), "-o", "other.h5"])
        self.assertEqual((self.folder / "section.h5").read_bytes(),
                         (self.folder / "other.h5").read_bytes())
        section = self.section(ignore_boxes=[MIDDLE])
        clearway.export_section_outline(section, self.folder / "a.dxf", band=0.2, base=-0.4)
        self.assertIn("POLYLINE", (self.folder / "a.dxf").read_text())
        with self.assertRaisesRegex(clearway.UsageError, "a.dxf"):
            clearway.export_section_outline(section, self.folder / "a.dxf", band=0.2, base=-0.4)

    def test_the_snippet_of_the_guide(self):
        page = Path(__file__).parents[2] / "docs" / "guide" / "section.md"
        snippet = re.search(r"^```python\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S)[1]
        (self.folder / "load.csv").write_text("y,z\n-0.6,0.4\n0.6,0.4\n0.6,1.4\n-0.6,1.4\n")
        self.assertEqual(self.run_in_folder([sys.executable, "-c", snippet]), "stopped \n")

    def test_refusals(self):
        store, section, no = clearway.Store(self.folder / "site.h5"), self.section(), self.folder / "no.h5"
        stop = threading.Event()
        stop.set()
        for kind, words, named in (
                (clearway.UsageError, "where its scanner stood", {"seen": True}),
                (clearway.UsageError, "expected seen space", {"seen_cube": 0.1}),
                (clearway.ResourceError, "bins of .* fit|larger cells",
                 {"memory_bytes": 3_000_000, "bin": 0.2, "cell": 0.01}),
                (clearway.UsageError, "is an input too", {"name": "site.h5"}),
                (clearway.Interrupted, "", {"stop": stop})):
            with self.subTest(named), self.assertRaisesRegex(kind, words) as caught:
                self.find(**{"name": "no.h5", **named})
            if kind is clearway.ResourceError:
                self.assertEqual(caught.exception.remedy, "more_memory")
        for kind, words, call, *args in (
                (clearway.UsageError, "its rear, and then its front", clearway.find_section, store, self.poses,
                 no, 1, -1),
                (clearway.UsageError, "stretches lengths", clearway.find_section, store,
                 2 * np.eye(4)[None, :3], no, -1, 1),
                (clearway.InputError, "is not a section", clearway.Section, store.path),
                (clearway.UsageError, "without seen space", clearway.export_section, section, "unknown-cells", no),
                (clearway.UsageError, "is an input too", clearway.export_section, section, "cells", section.path,
                 True)):
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                call(*args[:3], overwrite=True) if args[-1] is True else call(*args)
        self.assertFalse(no.exists())

    def test_warnings_and_strict(self):
        told, far = [], self.poses + np.array([[0, 0, 0, 500.0]] + 3 * [[0] * 4])
        store, no = clearway.Store(self.folder / "site.h5"), self.folder / "no.h5"
        report = clearway.find_section(store, far, self.folder / "far.h5", REAR, FRONT, message=told.append)
        codes = [w.code for w in report.warnings]
        self.assertIn("out-of-reach", codes)
        section = clearway.Section(self.folder / "far.h5")
        for found in ([m for m in told if m.severity == "warning"], section.warnings()):
            self.assertEqual([w.code for w in found], codes)
        check = section.check([(-0.5, 1), (0.5, 1), (0, 2)])
        self.assertEqual((check.verdict, section.free_cells().any()), ("unknown", False))
        self.assertIn("out-of-reach", check.reason)
        for poses, warned in ((far, []), (self.poses, report.warnings)):
            with self.assertRaisesRegex(clearway.InputError, "strict"):
                clearway.find_section(store, poses, no, REAR, FRONT, input_warnings=warned, strict=True)
        self.assertFalse(no.exists())
        nothing = clearway.find_section(store, np.empty((0, 4, 4)), self.folder / "none.h5", -1, 1)
        self.assertEqual([w.code for w in nothing.warnings], ["no-poses"])
        empty = clearway.Section(self.folder / "none.h5")
        self.assertEqual((len(empty.cells()), empty.bin_cells().bin, len(empty.bins())), (0, None, 0))


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
