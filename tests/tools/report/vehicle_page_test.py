#!/usr/bin/python3
"""The page of a vehicle of several bodies: each is drawn where it is, and findings name theirs.

Usage: vehicle_page_test.py PROGRAM. Standard library only. Where chromium is not installed, the
page is made and not opened; the test says so.
"""

import json
import os
import sys
import tempfile
import unittest

import scenes
from browser import Browser, find_chromium
from page_checks import PageChecks
from scenes import DATE, clearway, make_hall

CHROMIUM = find_chromium()
BODIES = ["middle", "front", "slow"]


class VehiclePageTest(PageChecks, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="clearway-vehicle-")
        folder = cls.folder = cls.temporary.name
        cls.hall = make_hall(folder)
        with open(f"{folder}/wedge.off", "w") as file:
            file.write("OFF\n4 4 0\n0 -0.4 0.2\n0.8 0 0.2\n0 0.4 0.2\n0 0 0.9\n"
                       "3 0 1 2\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")
        with open(f"{folder}/wagon.json", "w") as file:
            json.dump({"bodies": [
                {"name": "middle", "model": "model.ply", "pivots": [1.02, -1.02]},
                {"name": "front", "model": "wedge.off", "at": 2},
                {"name": "slow", "model": "wedge.off", "trajectory": "trajectory.txt"}]}, file)
        cls.inputs = ("--env", cls.hall.store, "--vehicle", f"{folder}/wagon.json", "--trajectory",
                      cls.hall.trajectory)
        cls.result = f"{folder}/out.h5"
        clearway("run", *cls.inputs, "--radius", 0.1, "--first-pose", "--clearance", 0.3,
                 "--profile", 0.5, "-o", cls.result, "--force")
        cls.page = f"{folder}/page.html"
        cls.facts = json.loads(cls.report(cls.page))
        cls.browser = Browser(CHROMIUM) if CHROMIUM else None
        cls.shown = cls.browser.page(cls.page) if CHROMIUM else None

    @classmethod
    def tearDownClass(cls):
        if cls.browser:
            cls.browser.__exit__()
        cls.temporary.cleanup()

    @classmethod
    def report(cls, page, *options, inputs=None, code=0):
        return clearway("report", cls.result, *(inputs or cls.inputs), "-o", page, "--force",
                        "--json", "--date", DATE, *options, code=code)

    def test_what_to_check_on_site(self):
        site = self.facts["on_site"]
        middle, front, slow = site["bodies"]
        self.assertEqual((middle["pivots"], front["at"]), ([1.02, -1.02], 2))
        self.assertFalse({"at", "pivots", "hitch"} & slow.keys())
        self.assertEqual((front["lo"], front["hi"]), ([0, -0.4, 0.2], [0.8, 0.4, 0.9]))
        if self.browser is None:
            self.skipTest("chromium is not installed: the page is made, but not looked at")
        page = self.shown
        words = page.run("byId('on-site').innerText")
        for part in ("Check these on site", "Bodies", "front: 0.80 × 0.80 × 0.70 m", "from its origin 0.80 m ahead",
                     "0.40 m left, 0.40 m right", "pivots 2.04 m apart, 1.02 m ahead of the path's pose and 1.02 m behind it",
                     "its origin is 2.00 m ahead of the path's pose"):
            self.assertIn(part, words)
        self.check_quiet(page)

    def test_facts_name_the_bodies(self):
        bodies = self.facts["inputs"]["model"]["bodies"]
        self.assertEqual([body["name"] for body in bodies], BODIES)
        self.assertEqual([body["triangles"] for body in bodies], [0, 4, 4])
        poses = self.facts["inputs"]["trajectory"]["poses"]
        self.assertEqual(bodies[2]["poses"], poses)
        self.assertLess(bodies[0]["poses"], bodies[1]["poses"])
        self.assertEqual(self.facts["page"]["model_points"],
                         sum(body["shown_points"] for body in bodies))
        listed = self.facts["conflicts"]["list"]
        self.assertTrue(listed and all(conflict["body"] in BODIES for conflict in listed))
        self.assertTrue(all(conflict["side"] != "unknown" for conflict in listed))
        self.assertIn(self.facts["least_distance"]["body"], BODIES)

    def test_facts_are_those_of_conflicts(self):
        out = f"{self.folder}/conflicts.json"
        clearway("conflicts", self.result, *self.inputs[2:], "-o", out, "--force")
        with open(out) as file:
            found = json.load(file)
        for a, b in zip(found["conflicts"], self.facts["conflicts"]["list"], strict=True):
            self.assertEqual(found["bodies"][a["body"]], b["body"])
            for key in ("id", "points", "source", "first_pose", "least_distance", "nearest_pose",
                        "side", "lateral", "height"):
                self.assertEqual(a[key], b[key], key)

    def test_refuses_what_is_not_of_the_run(self):
        model = ("--env", self.hall.store, "--model", self.hall.model, "--trajectory",
                 self.hall.trajectory)
        self.assertIn("several bodies", self.report(f"{self.folder}/bad.html", inputs=model, code=3))
        plain = self.hall.search("plain", "--radius", 0.1)
        refused = clearway("report", plain, *self.inputs, "-o", f"{self.folder}/bad.html", code=3)
        self.assertIn("one model", refused)
        with open(f"{self.folder}/other.json", "w") as file:
            json.dump({"bodies": [{"name": "middle", "model": "model.ply"}]}, file)
        other = ("--env", self.hall.store, "--vehicle", f"{self.folder}/other.json", "--trajectory",
                 self.hall.trajectory)
        self.assertIn("vehicle", self.report(f"{self.folder}/bad.html", inputs=other, code=3))

    def test_page_draws_each_body_where_it_is(self):
        if self.browser is None:
            self.skipTest("chromium is not installed: the page is made, but not looked at")
        page = self.shown
        self.check_words(page, self.facts)
        text = page.run("byId('verdict').innerText")
        for body in BODIES:
            self.assertIn(body, text)
        self.assertIn("Body", page.run("tableColumns().map((c) => c.title)"))
        # Each body has its own motion: the front is 2 m ahead of the path, the slow one on it.
        middle = page.run("Math.floor(page.poses.count / 2)")
        self.assertEqual(page.run(f"bodiesAt({middle}).map((b) => b.body)"), [0, 1, 2])
        ahead = page.run(f"length(plus(bodyPoseAt({middle}, 1).t, poseAt({middle}).t, -1))")
        self.assertAlmostEqual(ahead, 2, delta=0.1)
        self.assertLess(page.run(f"length(plus(bodyPoseAt({middle}, 2).t, poseAt({middle}).t, -1))"),
                        1e-6)
        self.assertEqual(page.run("bodyPoseAt(page.poses.count - 1, 1)"), None)
        # The drawn model comes as near to a conflict as the result says, but for its sampling.
        near = page.run("""(() => { const c = worstConflict(), v = shownPose(poseOf(c));
            return nearestOfModel(v, placeOf(c)).distance; })()""")
        worst = [c for c in self.facts["conflicts"]["list"]
                 if c["id"] == self.facts["conflicts"]["worst"]][0]
        self.assertAlmostEqual(near, worst["least_distance"], delta=0.02)
        self.check_quiet(page)

    def one_body(self, profile):
        """The facts and the page of a vehicle that has no pose at the ends of its path."""
        name = f"{self.folder}/one{profile}"
        with open(f"{name}.json", "w") as file:
            json.dump({"bodies": [{"name": "wagon", "model": "model.ply",
                                   "pivots": [1.02, -1.02]}]}, file)
        inputs = (*self.inputs[:3], f"{name}.json", *self.inputs[4:])
        # Pivots leave the ends of every path, so that is no reason to refuse a run.
        refused = clearway("run", *inputs, "--radius", 0.01, "--profile", profile, "-o",
                           f"{name}.h5", "--force", "--strict", code=3)
        self.assertNotIn("body-off-path", refused.splitlines()[-1])
        self.assertIn("info: ", next(line for line in refused.splitlines() if "off the path" in line))
        clearway("run", *inputs, "--radius", 0.01, "--profile", profile, "-o", f"{name}.h5",
                 "--force")
        facts = json.loads(clearway("report", f"{name}.h5", *inputs, "-o", f"{name}.html",
                                    "--force", "--json", "--date", DATE))
        return facts, f"{name}.html"

    def test_stretches_without_an_answer_are_shaded_and_named(self):
        facts, path = self.one_body(0.02)
        ends = facts["unsearched"]
        track = facts["inputs"]["trajectory"]
        self.assertEqual([end["has_answer"] for end in ends], [False, False])
        self.assertEqual([ends[0]["first_pose"], ends[1]["last_pose"]], [0, track["poses"] - 1])
        self.assertEqual(ends[0]["bodies"], ["wagon"])
        self.assertAlmostEqual(ends[0]["chainage_to"], 1.1, delta=0.15)
        self.assertAlmostEqual(track["searched_length"],
                               ends[1]["chainage_from"] - ends[0]["chainage_to"], 9)
        if self.browser is None:
            self.skipTest("chromium is not installed: the page is made, but not looked at")
        page = self.browser.page(path)
        self.check_words(page, facts)
        shaded = page.run("""[...document.querySelectorAll('#profile-chart rect.no-answer')]
            .map((r) => [+r.getAttribute('x'), +r.getAttribute('width')])""")
        self.assertEqual(len(shaded), 2)
        for (x, width), end in zip(shaded, ends):
            self.assertAlmostEqual(x, page.run(f"profileX({end['chainage_from']})"), 6)
            self.assertAlmostEqual(x + width, page.run(f"profileX({end['chainage_to']})"), 6)
        chart = page.run("document.querySelector('#profile-chart svg').textContent")
        self.assertIn("no answer", chart)
        self.assertIn("Where there is no curve and no shading, nothing is closer than 0.02 m",
                      chart)
        self.assertIn("No answer: the vehicle has no pose at chainage 0.00 to 1.",
                      page.run("byId('profile-unsearched').textContent"))
        self.assertIn("The vehicle was searched on", page.run("byId('searched').textContent"))
        self.assertIn("the path is dashed", page.run("byId('plan-note').textContent"))
        page.run("selectPose(0)")
        for place in ("profile-readout", "pose-text"):
            self.assertIn("no answer, as the vehicle has no pose here",
                          page.run(f"byId('{place}').textContent"))
        page.run("selectPose(Math.floor(page.poses.count / 2))")
        self.assertNotIn("no answer", page.run("byId('profile-readout').textContent"))
        page.run("zoomProfile(0.01, profileStart() + profileLength() / 2)")
        self.assertEqual(page.run("document.querySelectorAll('rect.no-answer').length"), 0)
        page.run("(preparePrint(), 1)")
        page.pdf(f"{self.folder}/one.pdf")
        self.check_quiet(page)

    def test_stretches_of_a_part_name_the_bodies_that_are_missing(self):
        parts = [s for s in self.facts["unsearched"] if s["has_answer"]]
        self.assertEqual(parts, self.facts["unsearched"])
        self.assertEqual({tuple(part["bodies"]) for part in parts},
                         {("middle",), ("middle", "front"), ("front",)} &
                         {tuple(part["bodies"]) for part in parts})
        self.assertTrue(any("front" in part["bodies"] for part in parts))
        if self.browser is None:
            self.skipTest("chromium is not installed: the page is made, but not looked at")
        page = self.shown
        self.assertEqual(page.run("document.querySelectorAll('rect.part-answer').length"),
                         len(parts))
        self.assertIn('"middle"', page.run("byId('profile-unsearched').textContent"))
        page.run("selectPose(page.poses.count - 1)")
        self.assertIn('without', page.run("byId('profile-readout').textContent"))
        self.assertIn("some of its bodies on", page.run("byId('searched').textContent"))
        self.check_quiet(page)


if __name__ == "__main__":
    scenes.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
