#!/usr/bin/python3
"""The page of a vehicle of several bodies: each is drawn where it is, and findings name theirs.

Usage: vehicle_page_test.py PROGRAM. Standard library only.
"""

import unittest

from pages import Pages, hall

BODIES = ["middle", "front", "slow"]
MIDDLE = {"name": "middle", "model": "model.ply", "pivots": [1.02, -1.02]}


class VehiclePage(Pages):
    @classmethod
    def make(cls):
        cls.hall = hall(cls.place / "hall")
        cls.hall.put("wedge.off", "OFF\n4 4 0\n0 -0.4 0.2\n0.8 0 0.2\n0 0.4 0.2\n0 0 0.9\n"
                     "3 0 1 2\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")
        cls.hall.put("wagon.json", {"bodies": [
            MIDDLE, {"name": "front", "model": "wedge.off", "at": 2},
            {"name": "slow", "model": "wedge.off", "trajectory": "trajectory.txt"}]})
        cls.hall.model = "wagon.json"
        cls.hall.search("out", "--first-pose --clearance 0.3 --profile 0.5")
        cls.facts = cls.hall.report("out")

    def test_facts_name_the_bodies_and_are_those_of_conflicts(self):
        facts = self.facts
        bodies, poses = facts["inputs"]["model"]["bodies"], facts["inputs"]["trajectory"]["poses"]
        self.assertEqual([[body["name"], body["triangles"]] for body in bodies],
                         list(map(list, zip(BODIES, [0, 4, 4]))))
        self.assertEqual([bodies[2]["poses"], bodies[0]["poses"] < bodies[1]["poses"]], [poses, True])
        self.assertEqual(facts["page"]["model_points"], sum(body["shown_points"] for body in bodies))
        self.assertIn(facts["least_distance"]["body"], BODIES)
        found, listed = self.hall.conflicts("out"), facts["conflicts"]["list"]
        self.assertEqual([found["bodies"][one["body"]] for one in found["conflicts"]], [one["body"] for one in listed])
        self.same_values(found["conflicts"], listed, "id points source first_pose least_distance nearest_pose side "
                         "lateral height")
        self.assertTrue(listed and all(one["side"] != "unknown" for one in listed))
        site = facts["on_site"]["bodies"]
        self.assertEqual([site[0]["pivots"], site[1]["at"], site[1]["lo"], site[1]["hi"]],
                         [[1.02, -1.02], 2, [0, -0.4, 0.2], [0.8, 0.4, 0.9]])
        self.assertFalse({"at", "pivots", "hitch"} & site[2].keys())

    def test_what_is_not_of_the_run_is_refused(self):
        self.hall.put("other.json", {"bodies": [MIDDLE]})
        inputs = "--env site.h5 --trajectory trajectory.txt"
        self.hall.ask(f"run {inputs} --model model.ply --radius 0.1 -o plain.h5")
        for result, vehicle, words in (("out", "--model model.ply", "several bodies"),
                                       ("out", "--vehicle other.json", "vehicle"),
                                       ("plain", "--vehicle wagon.json", "one model")):
            self.hall.ask(f"report {result}.h5 {inputs} {vehicle} -o bad.html", 3, words)

    def test_the_page_draws_each_body_where_it_is(self):
        page = self.shown(self.hall, "out", self.facts)
        self.says(page, {
            "verdict": BODIES,
            "on-site": ["Check these on site", "Bodies", "front: 0.80 × 0.80 × 0.70 m", "from its origin 0.80 m ahead",
                        "0.40 m left, 0.40 m right", "its origin is 2.00 m ahead of the path's pose",
                        "pivots 2.04 m apart, 1.02 m ahead of the path's pose and 1.02 m behind it"]})
        # Each body has its own motion: the front is 2 m ahead of the path, the slow one on it.
        middle = page.run("Math.floor(page.poses.count / 2)")
        ahead = "length(plus(bodyPoseAt(%d, %d).t, poseAt(%d).t, -1))"
        self.gives(page, {"tableColumns().some((c) => c.title === 'Body')": True,
                          f"bodiesAt({middle}).map((b) => b.body)": [0, 1, 2],
                          "bodyPoseAt(page.poses.count - 1, 1)": None})
        self.assertAlmostEqual(page.run(ahead % (middle, 1, middle)), 2, delta=0.1)
        self.assertLess(page.run(ahead % (middle, 2, middle)), 1e-6)
        # The drawn model comes as near to a conflict as the result says, but for its sampling.
        near = page.run("""(() => { const c = worstConflict(), v = shownPose(poseOf(c));
            return nearestOfModel(v, placeOf(c)).distance; })()""")
        conflicts = self.facts["conflicts"]
        worst = next(c for c in conflicts["list"] if c["id"] == conflicts["worst"])
        self.assertAlmostEqual(near, worst["least_distance"], delta=0.02)
        # Stretches on which some bodies are missing name them.
        parts = self.facts["unsearched"]
        self.assertTrue(all(part["has_answer"] for part in parts))
        self.assertLessEqual({tuple(part["bodies"]) for part in parts}, {("middle",), ("middle", "front"), ("front",)})
        self.assertTrue(any("front" in part["bodies"] for part in parts))
        self.gives(page, {"document.querySelectorAll('rect.part-answer').length": len(parts)})
        page.run("selectPose(page.poses.count - 1)")
        self.says(page, {"byId('profile-unsearched').textContent": '"middle"',
                         "byId('profile-readout').textContent": "without",
                         "byId('searched').textContent": "some bodies on"})

    def test_stretches_without_an_answer_are_shaded_and_named(self):
        """A vehicle that has no pose at the ends of its path, as pivots leave the ends of every path, so
        that is no reason to refuse a run."""
        one = type(self.hall)(self.hall.folder)
        one.model = "one.json"
        one.put("one.json", {"bodies": [{**MIDDLE, "name": "wagon"}]})
        words = f"run {one.inputs()} --radius 0.01 --profile 0.02 -o one.h5 --force"
        refused = one.ask(f"{words} --strict", 3).stderr.splitlines()
        self.assertNotIn("body-off-path", refused[-1])
        self.assertIn("info: ", next(line for line in refused if "off the path" in line))
        one.ask(words)
        facts = one.report("one")
        begin, end = facts["unsearched"]
        track = facts["inputs"]["trajectory"]
        self.assertEqual([begin["has_answer"], end["has_answer"], begin["first_pose"], end["last_pose"],
                          begin["bodies"]],
                         [False, False, 0, track["poses"] - 1, ["wagon"]])
        self.assertAlmostEqual(begin["chainage_to"], 1.1, delta=0.15)
        self.assertAlmostEqual(track["searched_length"], end["chainage_from"] - begin["chainage_to"], 9)
        page = self.shown(one, "one", facts)
        self.check_shaded(page, "no-answer", [(each["chainage_from"], each["chainage_to"]) for each in (begin, end)])
        self.says(page, {
            "byId('profile-chart').textContent":
                ["no answer", "Where there is no curve and no shading, nothing is closer than 0.02 m"],
            "byId('profile-unsearched').textContent": "No answer: the vehicle has no pose at chainage 0.00 to 1.",
            "byId('searched').textContent": "The vehicle was searched on",
            "byId('plan-note').textContent": "the path is dashed"})
        page.run("selectPose(0)")
        for place in ("profile-readout", "pose-text"):
            self.says(page, {f"byId('{place}').textContent": "no answer, as the vehicle has no pose here"})
        page.run("selectPose(Math.floor(page.poses.count / 2))")
        self.gives(page, {"byId('profile-readout').textContent.includes('no answer')": False})
        page.run("zoomProfile(0.01, profileStart() + profileLength() / 2)")
        self.check_shaded(page, "no-answer", [])
        page.run("(preparePrint(), 1)")
        self.assertTrue(page.call("Page.printToPDF", preferCSSPageSize=True)["data"])


if __name__ == "__main__":
    unittest.main()
