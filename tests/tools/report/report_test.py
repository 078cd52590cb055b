#!/usr/bin/python3
"""Reports of small scenes: bytes, refusals, and what a browser shows of them.

Usage: report_test.py PROGRAM. Standard library only. Where chromium is not installed, the pages
are made and not opened; the test says so. CLEARWAY_TEST_DATA adds the street.
"""

import csv
import json
import math
import os
import sys
import tempfile
import unittest

import scenes
from browser import Browser, find_chromium
from page_checks import PageChecks
from scenes import Scene, clearway, make_car, make_empty, make_epoch, make_hall, make_lane, make_road

CHROMIUM = find_chromium()

BLANK = """(id) => { const from = document.querySelector(id);
  const copy = new OffscreenCanvas(from.width, from.height), c = copy.getContext("2d");
  c.drawImage(from, 0, 0);
  const pixels = new Uint32Array(c.getImageData(0, 0, from.width, from.height).data.buffer);
  return new Set(pixels).size; }"""


class ReportTest(PageChecks, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="clearway-report-")
        base = cls.temporary.name
        for name in ("hall", "empty", "road", "street"):
            os.mkdir(f"{base}/{name}")
        cls.hall = make_hall(f"{base}/hall")
        cls.found = cls.hall.search("out", "--radius", 0.1, "--first-pose", "--clearance", 0.3,
                                    "--profile", 0.5)
        cls.empty = make_empty(f"{base}/empty")
        cls.road = make_road(f"{base}/road")
        cls.browser = Browser(CHROMIUM) if CHROMIUM else None

    @classmethod
    def tearDownClass(cls):
        if cls.browser:
            cls.browser.__exit__()
        cls.temporary.cleanup()

    def open(self, page, **size):
        if self.browser is None:
            self.skipTest("chromium is not installed: the page is made, but not looked at")
        opened = self.browser.page(page, **size)
        self.addCleanup(opened.close)
        return opened

    def test_bytes_depend_on_nothing_else(self):
        one, _ = self.hall.report(self.found, "one", "--threads", 1)
        two, _ = self.hall.report(self.found, "two", "--threads", 3, "--memory", "1G")
        with open(one, "rb") as a, open(two, "rb") as b:
            self.assertTrue(a.read() == b.read())

    def test_facts_are_those_of_the_other_commands(self):
        _, facts = self.hall.report(self.found, "facts")
        info = json.loads(clearway("info", self.found, "--json"))
        self.assertEqual(facts["colliding_points"], info["colliding_points"])
        groups = f"{self.hall.folder}/conflicts.json"
        clearway("conflicts", self.found, "--trajectory", self.hall.trajectory, "-o", groups,
                 "--force")
        with open(groups) as file:
            listed = json.load(file)["conflicts"]
        self.assertEqual(len(listed), facts["conflicts"]["count"])
        self.assertGreater(len(listed), 3)
        for a, b in zip(listed, facts["conflicts"]["list"]):
            for key in ("id", "points", "source", "first_pose", "last_pose", "chainage_from",
                        "chainage_to", "least_distance", "nearest_pose", "side", "lateral",
                        "height"):
                self.assertEqual(a[key], b[key], key)

    def test_what_to_check_on_site(self):
        """A lorry that drives east, then a quarter of a circle of 12 m to the left; its front is behind."""
        folder = self.hall.folder
        shown = None
        for name, turn in (("ahead", 0), ("backwards", math.pi)):
            with self.subTest(name), open(f"{folder}/bend.txt", "w") as file:
                places = [(x / 4, 0, 0) for x in range(161)]
                places += [(40 + 12 * math.sin(a), 12 - 12 * math.cos(a), a)
                           for a in (math.pi / 2 * k / 80 for k in range(1, 81))]
                places += [(52, 12 + y / 4, math.pi / 2) for y in range(1, 81)]
                for x, y, heading in places:
                    half = (heading + turn) / 2
                    file.write(f"{1000 + x} {500 + y} 7 0 0 {math.sin(half):.12f} {math.cos(half):.12f}\n")
                file.flush()
                scene = Scene(folder)
                scene.trajectory, scene.model = f"{folder}/bend.txt", "box:8,2.5,3.4"
                result = scene.search("bend", "--radius", 0.1, "--first-pose",
                                      "--trajectory-format", "pose-xyzw")
                path, facts = scene.report(result, "bend", "--chainage-start", 100,
                                           "--trajectory-format", "pose-xyzw")
                site = facts["on_site"]
                first, last = site["first"], site["last"]
                self.assertEqual(site["bodies"][0]["hi"], [4, 1.25, 3.4])
                self.assertEqual((first["position"], last["position"]), ([1000, 500, 7], [1052, 532, 7]))
                self.assertAlmostEqual(first["bearing"], 90)
                self.assertAlmostEqual(last["bearing"], 0)
                self.assertAlmostEqual(first["front_bearing"], 270 if turn else 90)
                self.assertAlmostEqual(last["chainage"], 100 + 60 + 6 * math.pi, delta=0.01)
                self.assertAlmostEqual(site["bend"]["radius"], 12, delta=0.01)
                self.assertTrue(140 < site["bend"]["chainage"] < 160)
                shown = shown or self.open(path)
                words = self.verdict_of(shown, facts, "on-site")
                self.assertEqual("its front points the other way" in words, name == "backwards")
                for part in ("8.00 × 2.50 × 3.40 m", "1000.00, 500.00, 7.00", "towards 90° at the beginning",
                             "0° at the end", "left is towards 0°", "radius of about 12.00 m"):
                    self.assertIn(part, words)
                self.check_quiet(shown)
        straight = self.empty.report(self.empty.search("straight", "--radius", 0.1), "straight")[1]
        self.assertIsNone(straight["on_site"]["bend"])

    def test_refuses_what_is_not_of_the_run(self):
        other = Scene(self.hall.folder)
        other.trajectory = f"{self.hall.folder}/shorter.txt"
        with open(self.hall.trajectory) as a, open(other.trajectory, "w") as b:
            b.writelines(a.readlines()[:-1])
        self.assertIn("--trajectory", other.report(self.found, "bad", code=3)[1])
        other = Scene(self.hall.folder)
        other.model = self.empty.model
        self.assertIn("--model", other.report(self.found, "bad", code=3)[1])
        other = Scene(self.hall.folder)
        other.store = self.empty.store
        self.assertIn("--env", other.report(self.found, "bad", code=3)[1])
        self.assertIn("--clearance", self.hall.report(self.found, "bad", "--classes", "0.1,0.4",
                                                      code=2)[1])
        self.assertFalse(os.path.exists(f"{self.hall.folder}/bad.html"))

    def test_hall(self):
        odd = '<b>"Nord" & \\</script>'
        path, facts = self.hall.report(self.found, "hall", "--classes", "0.05,0.1,0.3", "--title",
                                       odd, "--project", odd + "1", "--client", odd + "2",
                                       "--author", odd + "3")
        self.assertEqual(facts["verdict"], "conflict")
        self.assertEqual([facts[key] for key in ("title", "project", "client", "author")],
                         [odd, odd + "1", odd + "2", odd + "3"])
        self.assertNotIn("seen", list(facts))
        page = self.open(path)
        self.check_words(page, facts)
        self.check_head(page, odd)
        # Without --seen, the page has nothing of seen space; without --section, no section.
        self.assertEqual(page.run("[byId('unseen'), byId('basis'), byId('scanned'), byId('section')]"),
                         [None] * 4)
        self.assertNotIn("Not scanned", page.run("document.body.innerText"))
        self.assertEqual([c["name"] for c in facts["classes"]], ["hit", "near", "watch"])
        worst = facts["conflicts"]["worst"]
        self.assertEqual(page.run("page.conflict.id"), worst)
        page.run("document.documentElement.style.scrollBehavior = 'auto'")
        for canvas in ("#plan-canvas", "#view-canvas", "[data-kind=front]", "[data-kind=above]",
                       "[data-kind=section]"):
            page.frames()
            self.assertGreater(page.run(f"({BLANK})('{canvas}')"), 20, canvas)
        self.check_slider(page)
        self.check_offsets(page, facts)
        self.check_ends(page)
        self.check_table(page, facts)
        self.check_keys(page)
        self.check_show(page)
        self.check_paper(page, facts)
        shot = f"{self.hall.folder}/shot.png"
        page.screenshot(shot)
        self.assertGreater(os.path.getsize(shot), 20000)
        page.pdf(f"{self.hall.folder}/page.pdf")
        self.assertGreater(os.path.getsize(f"{self.hall.folder}/page.pdf"), 50000)
        self.check_quiet(page)

    def check_head(self, page, odd):
        self.assertEqual(page.run("document.title"), odd)
        self.assertEqual(page.run("document.querySelector('h1').textContent"), odd)
        self.assertEqual(page.run("byId('about').textContent"),
                         f"Project: {odd}1Client: {odd}2Author: {odd}3")

    def test_stations(self):
        line = f"{self.hall.folder}/line.csv"
        with open(self.hall.trajectory) as matrices, open(line, "w") as table:
            table.write("station [m],x,y,z,r00,r01,r02,r10,r11,r12,r20,r21,r22\n")
            for i, text in enumerate(matrices):
                m = text.split()
                table.write(",".join([str(2500 - i), m[3], m[7], m[11],
                                      *(m[4 * row + k] for row in range(3) for k in range(3))]) + "\n")
        plain = self.hall.trajectory
        rows = f"{self.hall.folder}/stations.json"
        clearway("stations", self.found, "--trajectory", line, "--every", 3, "-o", rows, "--force")
        with open(rows) as file:
            expected = json.load(file)["stations"]
        self.hall.trajectory = line
        try:
            path, facts = self.hall.report(self.found, "stations", "--every", 3)
            self.assertIn("too long for a page",
                          self.hall.report(self.found, "bad", "--every", 0.001, code=2)[1])
        finally:
            self.hall.trajectory = plain
        listed = facts["stations"]["list"]
        self.assertEqual(len(listed), len(expected))
        self.assertEqual(facts["stations"]["every"], 3)
        for a, b in zip(listed, expected):
            for key in ("chainage_from", "chainage_to", "station_from", "station_to", "least",
                        "least_source", "left", "left_source", "right", "above", "verdict",
                        "reasons", "searched"):
                self.assertEqual(a[key], b[key], key)
            self.assertAlmostEqual(a["overthrow"][0]["end"] or 0, b["overthrow_end"] or 0, 6)
        for conflict in facts["conflicts"]["list"]:
            self.assertEqual(conflict["station_from"], 2500 - conflict["first_pose"])
        without = self.hall.report(self.found, "plain")[1]
        self.assertNotIn("station_from", without["conflicts"]["list"][0])
        self.assertEqual(without["stations"]["every"], 5)
        page = self.open(path)
        self.check_words(page, facts)
        cells = "[...document.querySelectorAll('#stations tbody tr')].map((r) => r.innerText)"
        page.run("document.querySelector('#stations details').open = true")
        shown = page.run(cells)
        self.assertEqual(len(shown), len(listed))
        for text, row in zip(shown, listed):
            self.assertIn(row["verdict"], text)
            self.assertIn(f"{row['station_from']:.2f} \u2013 {row['station_to']:.2f}", text)
        worst = next(c for c in facts["conflicts"]["list"] if c["id"] == facts["conflicts"]["worst"])
        self.assertIn("(station 2", page.run("byId('verdict').innerText"))
        self.assertIn(f"{worst['station_from']:.2f}", page.run("byId('conflict-details').innerText"))
        self.assertIn("station (m)", page.run("byId('profile').textContent"))
        self.assertIn("station 2", page.run("poseLabel(3)"))
        # A station lies between those of the poses.
        self.assertAlmostEqual(page.run("stationAt((page.poses.chainage[4] + page.poses.chainage[5]) / 2)"),
                               2495.5, 2)
        page.run("document.querySelectorAll('#stations tbody tr')[1].click()")
        page.run("document.querySelector('#stations details').open = false")
        page.run("preparePrint()")
        self.assertTrue(page.run("document.querySelector('#stations details').open"))
        page.run("endPrint()")
        self.assertFalse(page.run("document.querySelector('#stations details').open"))
        self.check_quiet(page)

    def test_shifts(self):
        folder = f"{self.hall.folder}/lane"
        os.mkdir(folder)
        lane = make_lane(folder)
        found = lane.search("out", "--model-as", "solid", "--radius", 0.001, "--first-pose",
                            "--clearance", 0.3)
        shifts = f"{folder}/shifts.json"
        told = json.loads(clearway("shift", found, "--env", lane.store, "--model", lane.model,
                                   "--trajectory", lane.trajectory, "--lateral", "-0.6,0.8",
                                   "-o", shifts, "--json"))
        path, facts = lane.report(found, "shifts", "--shifts", shifts)
        rows, listed = facts["shifts"]["list"], facts["conflicts"]["list"]
        self.assertEqual([r["shift"] for r in rows], [c["shift"] for c in told["conflicts"]])
        self.assertEqual([r["shift"] for r in rows], [-0.11, 0.21, None, None])
        self.assertIn("table of shifts", lane.report(found, "bad", "--min-points", 500, "--shifts",
                                                     shifts, code=3)[1])
        self.assertNotIn("shifts", lane.report(found, "plain")[1])
        page = self.open(path)
        self.check_words(page, facts)
        titles = page.run("tableColumns().map((c) => c.title)")
        cells = page.run(f"conflictList().map((c) => tableColumns()[{titles.index('Frees it')}].cell(c))")
        self.assertEqual(cells, ["0.11 right", "0.21 left", "\u2013", "\u2013"])
        no_shift = "no shift of up to 0.8 m to the left and 0.6 m to the right frees it"
        expected = ["0.11 m to the right between 2.0 and 5.0 m, which leaves 0.010 m",
                    "0.21 m to the left between 7.0 and 10.0 m, which leaves 0.010 m", no_shift, no_shift]
        for words, conflict in zip(expected, listed):
            page.run(f"selectConflict(conflictList().find((c) => c.id === {conflict['id']}))")
            self.assertIn(words, page.run("byId('conflict-details').innerText"))
        note = page.run("byId('conflicts-note').textContent")
        self.assertIn("No shift of up to 0.8 m to the left and 0.6 m to the right frees the whole path.", note)
        self.assertIn("2 of 4 conflicts can be freed", note)
        self.assertEqual(page.run("(sortBy('Frees it'), sortedConflicts(tableColumns()).map((c) => c.id))"),
                         [1, 2, 3, 4])
        page.run("preparePrint()")
        self.assertIn("Frees it", page.run("byId('print-cards').textContent"))
        self.check_quiet(page)

    def test_ledger(self):
        """Four panels beside a lane: one stays accepted, one comes nearer, one goes, one is out of reach."""
        folder = f"{self.hall.folder}/epochs"
        os.mkdir(folder)
        table, odd = f"{folder}/odd.csv", '<b>"a, b"</b></script><!-- \u2028 =1+1'
        lane, later = (make_epoch(folder, name, panels) for name, panels in (
            ("before", ((3, 0.4), (8, 0.4), (13, 0.4), (17, 0.4))), ("after", ((3, 0.4), (8, 0.35), (10.5, -0.4)))))
        known = ("--ledger", table, "--date", "2026-01-01")
        with open(later.trajectory, "w") as file:
            file.writelines(f"1 0 0 {0.05 * i} 0 1 0 0 0 0 1 0\n" for i in range(301))
        results = [one.search(name, "--radius", 0.05, "--first-pose", "--clearance", 0.3)
                   for one, name in ((lane, "first"), (later, "second"))]
        clearway("conflicts", results[0], "--trajectory", lane.trajectory, "--model", lane.model, "--env", lane.store,
                 "--update", *known)
        with open(table, newline="") as file:
            rows = list(csv.reader(file))
        for row, edit in zip(rows[1:], (("accepted", odd, odd, "2026-12-31"), ("accepted", "Ann", "", ""),
                                        ("accepted", "Ann", "", ""), ("open", "", "behind the gate", ""))):
            row[1:5] = edit
        with open(table, "w", newline="") as file:
            csv.writer(file).writerows(rows)
        with open(table, "rb") as file:
            before = file.read()
        path, facts = later.report(results[1], "ledger", "--ledger", table)
        with open(table, "rb") as file:
            self.assertEqual(file.read(), before)
        ledger = facts["ledger"]
        self.assertEqual([ledger[key] for key in ("name", "date", "accepted", "worse", "new", "gone", "not-searched")],
                         ["odd.csv", "2026-01-02", 1, 1, 1, 1, 1])
        self.assertEqual(later.report(results[1], "wide", "--ledger", table, "--worse-by", 0.1)[1]["ledger"]["worse"], 0)
        self.assertNotIn("ledger", later.report(results[1], "plain")[1])
        self.assertIn("--update makes it", later.report(results[1], "bad", "--ledger", f"{folder}/no.csv", code=2)[1])
        page = self.open(path)
        self.check_words(page, facts)
        self.assertIn("The verdict stays conflict. The ledger accepts 1 of the 3 conflicts. Of the others 1 is worse and "
                      "1 is new. 1 row of the ledger is gone. 1 row of the ledger was not searched",
                      page.run("byId('ledger-sentence').textContent"))
        cell = "document.querySelector('#conflicts-table tr[data-id=\"{}\"]').cells[{}].textContent"
        titles = page.run("tableColumns().map((c) => c.title)")
        self.assertEqual(page.run(cell.format(1, titles.index("Decided"))), f"{odd}, until 2026-12-31: {odd}")
        for conflict, words in ((1, "accepted"), (2, "worseIts least distance was"), (3, "new")):
            self.assertTrue(page.run(cell.format(conflict, titles.index("Ledger"))).startswith(words), words)
        self.assertEqual(page.run("conflictMarks().filter((mark) => mark.quiet).map((mark) => mark.text)"), ["1"])
        self.assertIn("Conflict 1, accepted", page.run("byId('profile-chart').textContent"))
        self.assertNotEqual(page.run("page.conflict.id"), 1)
        page.run("selectConflict(conflictList()[0])")
        self.assertIn(odd, page.run("byId('conflict-details').textContent"))
        without = page.run("byId('ledger-rows').innerText")
        for words in ("not-searched (was open)", "This question would not find it", "behind the gate",
                      "gone (was accepted)", "Nothing collides there any more"):
            self.assertIn(words, without)
        page.run("table.status = kNotAccepted; drawTable()")
        self.assertEqual(page.run("tableRows().map((row) => row.dataset.id).sort()"), ["2", "3"])
        page.run("preparePrint()")
        paper = page.run("byId('print-table').textContent")
        for words in (odd, "Its least distance was", "accepted"):
            self.assertIn(words, paper)
        self.check_quiet(page)

    def test_without_first_poses(self):
        bare = self.hall.search("bare", "--radius", 0.1)
        path, facts = self.hall.report(bare, "bare")
        self.assertIsNone(facts["conflicts"])
        page = self.open(path)
        self.check_words(page, facts)
        text = page.run("document.body.innerText")
        for option in ("--first-pose", "--clearance", "--profile"):
            self.assertIn(option, text)
        self.check_quiet(page)

    def test_depths_of_a_solid(self):
        solid = Scene(self.hall.folder)
        solid.model, solid.store = f"{solid.folder}/car.off", self.hall.store
        make_car(solid.model)
        asked = ("--radius", 0.1, "--first-pose", "--model-as", "solid")
        result = solid.search("solid", *asked, "--clearance", 0.3, "--profile", 0.5)
        path, facts = solid.report(result, "solid")
        info = json.loads(clearway("info", result, "--json"))
        self.assertEqual(info["model_solids"], 1)
        inside, depth = facts["inside"]["points"], facts["inside"]["depth"]
        self.assertEqual([inside, depth], [info["points_inside"], info["greatest_depth"]])
        self.assertGreater(inside, 10)
        self.assertTrue(0.05 < depth <= 0.7, depth)
        self.assertEqual(facts["least_distance"]["distance"], -depth)
        listed = facts["conflicts"]["list"]
        self.assertEqual(max(c["depth"] for c in listed), depth)
        self.assertLessEqual(sum(c["points_inside"] for c in listed), inside)
        page = self.open(path)
        self.check_words(page, facts)
        text = page.run("byId('verdict').innerText")
        for words in (f"{inside:,} points are inside it.", f"{depth:.3f} m deep inside the vehicle",
                      "The deepest point is", "1 closed part has an inside",
                      "deepest inside the vehicle"):
            self.assertIn(words, text)
        titles = page.run("tableColumns().map((c) => c.title)")
        cells = page.run(f"conflictList().map((c) => tableColumns()[{titles.index('Depth')}]"
                         ".cell(c))")
        for cell, conflict in zip(cells, listed):
            self.assertEqual(cell, f"{conflict['depth']:.3f}" if conflict["depth"] else "")
        self.assertIn("deep inside the vehicle", page.run("byId('conflict-details').innerText"))
        self.assertIn("inside the vehicle", page.run("byId('profile-chart').textContent"))
        self.assertLess(page.run("profile.low"), -depth)
        page.run("goToNearest()")
        self.assertIn(f"{depth:.3f} m deep inside the vehicle",
                      page.run("byId('profile-readout').textContent"))
        self.check_quiet(page)
        bare = solid.search("bare_solid", *asked)
        path, facts = solid.report(bare, "bare_solid")
        self.assertIsNone(facts["inside"])
        self.check_words(self.open(path), facts)

    def test_a_floor(self):
        asked = ("--radius", 0.1, "--first-pose", "--clearance", 0.3, "--floor", 0.3)
        plain = self.hall.report(self.hall.search("floor", *asked), "floor")[1]
        path, facts = self.hall.report(self.hall.search("floor_errors", *asked, "--error-pose", 0.01),
                                       "floor_errors")
        page = self.open(path)
        self.check_words(page, facts)
        with_errors = "0.3 m of the vehicle (0.1621 m with the errors)"
        for given, words in ((facts, with_errors), (plain, "0.3 m of the vehicle")):
            text = self.verdict_of(page, given)
            below = given["floor"]["colliding"]
            self.assertGreater(below, 10)
            self.assertIn(f"{below:,} points within the radius lie below {words}", text)
            self.assertIn(f"Only what lies at {words} or above", text)
        self.assertIn(f"Nothing at {with_errors}",
                      page.run("""(() => { const { verdict } = page.facts;
            page.facts.verdict = "clear";
            const sentence = verdictSentences()[0];
            page.facts.verdict = verdict;
            return sentence; })()"""))
        self.check_quiet(page)

    def test_empty_answer(self):
        result = self.empty.search("out", "--radius", 0.1, "--first-pose", "--clearance", 2)
        path, facts = self.empty.report(result, "empty")
        self.assertEqual(facts["verdict"], "clear")
        self.assertEqual(facts["least_distance"]["distance"], 1)
        self.assertEqual(facts["least_distance"]["pose"], 30)
        page = self.open(path, width=2560, height=1440)
        self.check_words(page, facts)
        text = page.run("byId('verdict').innerText")
        self.assertIn("1.000 m", text)
        self.assertIn("chainage 3.0", text)
        self.assertIn("The nearest point is below it, 0.50 m right of the path and 1.00 m below it",
                      text)
        self.assertIn(" at " + page.run("coordinates(page.facts.least_distance.point)") + ".", text)
        page.run("selectPose(90)")
        page.run("[...document.querySelectorAll('#profile-tools button')]"
                 ".find((b) => b.textContent === 'Nearest pose').click()")
        self.assertEqual(page.run("page.poses.index[page.pose]"), 30)
        self.assertIn("Every point of the environment keeps at least", text)
        self.assertIn("Every searched point keeps at least 0.1 m from the vehicle",
                      page.run("""(() => { const { ignored } = page.facts;
            page.facts.ignored = { points: 5 };
            const sentence = verdictSentences()[0];
            page.facts.ignored = ignored;
            return sentence; })()"""))
        self.assertIn("from the points of the model", page.run("""(() => {
            const { model } = page.facts.inputs, { spacing } = model;
            model.spacing = 0.05;
            const sentence = verdictSentences()[0];
            model.spacing = spacing;
            return sentence; })()"""))
        for count, small, words in ((1, 0, "1conflict"), (2, 3, "2conflicts"), (0, 0, "0conflicts"),
                                    (0, 1, "1place, too small for the list")):
            tile = f"conflictsTile({{ count: {count}, small_groups: {small} }}).textContent"
            self.assertEqual(page.run(tile), words)
        page.frames()
        self.assertGreater(page.run(f"({BLANK})('#view-canvas')"), 5)
        self.check_quiet(page)

    def test_profile_has_gaps(self):
        for far, pieces in ((1.05, 1), (0.5, 0)):
            result = self.empty.search("gap", "--radius", 0.1, "--first-pose", "--profile", far)
            path, facts = self.empty.report(result, "gap")
            page = self.open(path)
            self.check_words(page, facts)
            self.assertEqual(page.run("profileLine().length"), pieces)
            self.assertIn(f"nothing is closer than {far} m",
                          page.run("document.querySelector('#profile-chart svg').textContent"))
            buttons = page.run("byId('profile-tools').textContent")
            self.assertEqual("Nearest pose" in buttons, pieces > 0)
            self.check_quiet(page)

    def test_what_was_not_scanned(self):
        result = self.road.search("unseen", "--radius", 0.1, "--first-pose", "--profile", 0.5,
                                  "--seen")
        info = json.loads(clearway("info", result, "--json"))
        path, facts = self.road.report(result, "unseen")
        self.assertEqual([facts["verdict"], facts["reasons"]], ["undecided", ["not-scanned"]])
        seen = facts["seen"]
        for key in ("cube", "swept", "seen", "unseen", "groups", "listed_groups",
                    "not_scanned_length"):
            self.assertEqual(seen[key], info["seen"][key], key)
        self.assertEqual(seen["origins"], [{"what": "a file of origins", "points": 9801}])
        [group] = seen["list"]
        self.assertEqual([group["cubes"], group["shown"]], [seen["unseen"]] * 2)
        front = seen["front"]
        for kind in ("swept", "unseen"):
            self.assertEqual(len(front[kind]), front["columns"] * front["rows"])
            self.assertAlmostEqual(sum(front[kind]) * front["cell"] ** 2,
                                   seen[kind] * seen["cube"] ** 3, 6)
        right = sum(length for i, length in enumerate(front["unseen"])
                    if front["left"] + (i % front["columns"] + 1) * front["cell"] <= -0.2)
        self.assertEqual(right, 0)  # the board stands on the left
        page = self.open(path)
        self.check_words(page, facts)
        text = page.run("byId('verdict').innerText")
        words = f"{seen['not_scanned_length']:.1f} of 7.0 m"
        for sentence in (f"Not scanned on {words} of the path", "1 place, U1", words + "\n",
                         "from a file of origins", "wires, glass, mirrors",
                         "What would decide it", "Places were not scanned: see U1 below",
                         "but parts of the way were not scanned"):
            self.assertIn(sentence, text)
        self.assertEqual(page.run("page.unseen.count"), seen["unseen"])
        shaded = page.run("""[...document.querySelectorAll('#profile-chart rect.not-scanned')]
            .map((r) => [+r.getAttribute('x'), +r.getAttribute('width')])""")
        self.assertEqual(len(shaded), len(seen["stretches"]))
        for (x, width), (start, end) in zip(shaded, seen["stretches"]):
            self.assertAlmostEqual(x, page.run(f"profileX({start})"), 6)
            self.assertAlmostEqual(x + width, page.run(f"profileX({end})"), 6)
        self.assertIn("Not scanned: at chainage", page.run("byId('profile-unsearched').textContent"))
        # The numbers of the picture are those of the facts: each is drawn in its cell.
        drawn = page.run("""(() => { const out = [], draw = CanvasRenderingContext2D.prototype.fillText;
            CanvasRenderingContext2D.prototype.fillText = function (text) { out.push(text); };
            drawFront(document.createElement('canvas'));
            CanvasRenderingContext2D.prototype.fillText = draw;
            return out; })()""")
        shares = [unseen / swept for swept, unseen in zip(front["swept"], front["unseen"])
                  if swept >= 0.1 * max(front["swept"]) and unseen > 0]
        self.assertGreater(len(shares), 3)
        for share in shares:
            self.assertIn(page.run(f"percentWords({share})"), drawn)
        self.assertEqual([page.run(f"percentWords({share})") for share in
                          (0, 0.001, 0.5, 0.999, 1)], ["0", "<1", "50", ">99", "100"])
        self.assertGreater(page.run(f"({BLANK})('#front-canvas')"), 20)
        page.run("document.querySelector('#unseen-table tbody tr').click()")
        self.assertEqual(page.run("[page.group.id, page.poses.index[page.pose]]"),
                         [group["id"], group["first_pose"]])
        self.assertIn("U1: ", page.run("byId('unseen-chosen').innerText"))
        page.run("selectPose(0)")
        page.frames()
        place = page.run("plan.places.find((p) => p.mark.text === 'U1')")
        self.assertEqual(place["mark"]["shape"], "square")
        page.run("""{ const c = byId('plan-canvas'), s = c.width / c.clientWidth;
            const p = plan.places.find((p) => p.mark.text === 'U1');
            page.group = null;
            pickNumber(plan.places, c, p.x / s, p.y / s); }""")
        self.assertEqual(page.run("page.group.id"), group["id"])
        page.run("preparePrint()")
        self.assertEqual(page.run("document.querySelectorAll('#unseen-print tbody tr').length"), 1)
        page.pdf(f"{self.road.folder}/unseen.pdf")
        self.check_quiet(page)

    def test_all_that_is_swept_was_seen(self):
        result = self.road.search("small", "--radius", 0.1, "--seen", "--seen-min", 100000)
        path, facts = self.road.report(result, "small")
        self.assertEqual(facts["verdict"], "clear")
        self.assertEqual(facts["seen"]["list"], [])
        page = self.open(path)
        self.check_words(page, facts)
        text = page.run("byId('scanned').textContent")
        self.assertIn("A beam of the scanner passed through all but", text)
        self.assertIn("1 group of fewer than 100,000 cubes", text)
        self.assertEqual(page.run("document.querySelectorAll('rect.not-scanned').length"), 0)
        self.check_quiet(page)

    def test_certain_and_possible_conflicts(self):
        result = self.hall.search("budget", "--radius", 0.1, "--first-pose", "--clearance", 0.5,
                                  "--profile", 0.6, "--error-scan", 0.003, "--error-pose", 0.01,
                                  "--error-model", 0.01)
        listing = f"{self.hall.folder}/budget.json"
        clearway("conflicts", result, "--trajectory", self.hall.trajectory, "-o", listing, "--force")
        with open(listing) as file:
            classes = [c["class"] for c in json.load(file)["conflicts"]]
        path, facts = self.hall.report(result, "budget")
        listed = facts["conflicts"]["list"]
        self.assertEqual([c["class"] for c in listed], classes)
        self.assertEqual(set(classes), {"certain", "possible"})
        page = self.open(path)
        self.check_words(page, facts)
        at = page.run("tableColumns().map((c) => c.title)").index("Certainty")
        cells = page.run(f"conflictList().map((c) => tableColumns()[{at}].cell(c))")
        self.assertEqual([cell[2:] for cell in cells], classes)
        self.assertEqual(page.run("conflictMarks().map((m) => m.hollow)"),
                         [c == "possible" for c in classes])
        text = page.run("byId('verdict').innerText")
        for words in (f"{classes.count('possible')}\nof them possible, {classes.count('certain')} "
                      "certain", "0.13 %", "The risk is per place", "--seen looks for them"):
            self.assertIn(words, text)
        chart = page.run("document.querySelector('#profile-chart svg').textContent")
        margins, radius = facts["margins"], facts["query"]["radius"]
        self.assertIn("clear above " + page.run(
            f"shortLength(+({radius + margins['clear']}).toPrecision(4))"), chart)
        band = page.run("""(() => { const r = document.querySelector('rect.margins');
            return [+r.getAttribute('y'), +r.getAttribute('height')]; })()""")
        self.assertAlmostEqual(band[0], page.run(f"profileY({radius + margins['clear']})"), 6)
        self.assertAlmostEqual(sum(band), page.run(f"profileY({radius - margins['conflict']})"), 6)
        self.assertIsNone(page.run("byId('decides')"))  # a conflict is decided
        self.check_quiet(page)

    def test_an_undecided_page_says_what_would_decide_it(self):
        result = self.hall.search("exceed", "--radius", 0.02, "--first-pose", "--between-poses",
                                  "--error-scan", 0.002, "--error-registration", 0.03)
        path, facts = self.hall.report(result, "exceed")
        self.assertEqual([facts["verdict"], facts["reasons"]],
                         ["undecided", ["near", "errors-exceed-margin"]])
        page = self.open(path)
        self.check_words(page, facts)
        text = page.run("byId('decides').innerText")
        for words in ("possible conflicts in the table below", "the error of the registration is the largest, with 0.09 m",
                      "search a closed mesh with --model-as solid"):
            self.assertIn(words, text)
        self.assertIn("No conflict is certain, because the errors exceed the margin",
                      page.run("byId('conflicts').innerText"))
        self.check_quiet(page)

    def test_street(self):
        data = os.environ.get("CLEARWAY_TEST_DATA")
        if not data:
            self.skipTest("CLEARWAY_TEST_DATA is not set")
        street = Scene(f"{self.temporary.name}/street")
        street.model = f"{data}/street/warthog_ugv.obj"
        street.trajectory = f"{data}/street/trajectory.txt"
        clearway("convert", f"{data}/street/street.las", "-o", street.store)
        result = street.search("out", "--radius", 0.1, "--first-pose", "--clearance", 0.3)
        path, facts = street.report(result, "street", "--max-points", 200000)
        self.assertLessEqual(facts["page"]["environment_points"], 200000)
        page = self.open(path)
        self.check_words(page, facts)
        self.assertIn("as the ground is under wheels", page.run("byId('verdict').innerText"))
        self.check_quiet(page)


if __name__ == "__main__":
    scenes.PROGRAM = os.path.abspath(sys.argv.pop(1))
    if CHROMIUM is None:
        print("chromium is not installed: pages are made, but not looked at", file=sys.stderr)
    unittest.main(verbosity=2)
