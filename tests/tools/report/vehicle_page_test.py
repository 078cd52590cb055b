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

    @classmethod
    def tearDownClass(cls):
        if cls.browser:
            cls.browser.__exit__()
        cls.temporary.cleanup()

    @classmethod
    def report(cls, page, *options, inputs=None, code=0):
        return clearway("report", cls.result, *(inputs or cls.inputs), "-o", page, "--force",
                        "--json", "--date", DATE, *options, code=code)

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
        page = self.browser.page(self.page)
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


if __name__ == "__main__":
    scenes.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
