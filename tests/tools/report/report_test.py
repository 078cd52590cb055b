#!/usr/bin/python3
"""Reports of small scenes: bytes, refusals, and what a browser shows of them.

Usage: report_test.py PROGRAM. Standard library only. Where chromium is not installed, the pages
are made and not opened; the test says so. CLEARWAY_TEST_DATA adds the street.
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest

from browser import Browser, find_chromium

PROGRAM = None
CHROMIUM = find_chromium()
DATE = "2026-01-02 03:04 UTC"

BLANK = """(id) => { const from = document.querySelector(id);
  const copy = new OffscreenCanvas(from.width, from.height), c = copy.getContext("2d");
  c.drawImage(from, 0, 0);
  const pixels = new Uint32Array(c.getImageData(0, 0, from.width, from.height).data.buffer);
  return new Set(pixels).size; }"""


def clearway(*arguments, code=0):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != code:
        raise AssertionError(f"{arguments}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout if code == 0 else done.stderr


class Scene:
    """Store, model, trajectory and result in a folder of their own."""

    def __init__(self, folder, *query):
        self.folder, self.model = folder, f"{folder}/model.ply"
        self.trajectory, self.store = f"{folder}/trajectory.txt", f"{folder}/site.h5"
        self.query = query

    def search(self, name, *options):
        result = f"{self.folder}/{name}.h5"
        clearway("run", "--env", self.store, "--model", self.model, "--trajectory",
                 self.trajectory, *options, "-o", result, "--force")
        return result

    def report(self, result, name, *options, code=0):
        page = f"{self.folder}/{name}.html"
        text = clearway("report", result, "--env", self.store, "--model", self.model,
                        "--trajectory", self.trajectory, "-o", page, "--force", "--json",
                        "--date", DATE, *options, code=code)
        return page, json.loads(text) if code == 0 else text


def make_hall(folder):
    clearway("scene", "hall", "--points", 60000, "--poses", 400, "--model-points", 5000, "-o",
             folder, "--force")
    hall = Scene(folder)
    clearway("convert", f"{folder}/environment.las", "-o", hall.store, "--force")
    return hall


def make_empty(folder):
    """A box that is carried one metre above a floor."""
    scene = Scene(folder)
    scene.model = f"{folder}/model.xyz"
    with open(f"{folder}/floor.xyz", "w") as file:
        for x in range(0, 200):
            for y in range(-20, 21):
                file.write(f"{x / 10} {y / 10} 0\n")
    with open(scene.model, "w") as file:
        for x in (-0.5, 0.5):
            for y in (-0.5, 0.5):
                for z in (0, 1):
                    file.write(f"{x} {y} {z}\n")
    with open(scene.trajectory, "w") as file:
        for i in range(100):
            file.write(f"1 0 0 {5 + i / 10} 0 1 0 0 0 0 1 {1 + abs(i - 30) / 100}\n")
    clearway("convert", f"{folder}/floor.xyz", "-o", scene.store, "--force")
    return scene


class ReportTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="clearway-report-")
        base = cls.temporary.name
        for name in ("hall", "empty", "street"):
            os.mkdir(f"{base}/{name}")
        cls.hall = make_hall(f"{base}/hall")
        cls.found = cls.hall.search("out", "--radius", 0.1, "--first-pose", "--clearance", 0.3,
                                    "--profile", 0.5)
        cls.empty = make_empty(f"{base}/empty")
        cls.browser = Browser(CHROMIUM) if CHROMIUM else None

    @classmethod
    def tearDownClass(cls):
        if cls.browser:
            cls.browser.__exit__()
        cls.temporary.cleanup()

    def open(self, page, **size):
        if self.browser is None:
            self.skipTest("chromium is not installed: the page is made, but not looked at")
        return self.browser.page(page, **size)

    def check_quiet(self, page):
        self.assertEqual(page.complaints(), [])

    def check_words(self, page, facts):
        self.assertEqual(page.run("document.body.dataset.ready"), "true")
        word = page.run("byId('verdict-word').textContent").lower()
        doubtful = facts["verdict"] == "clear" and facts["warnings"]
        self.assertEqual(word, "clear, but doubtful" if doubtful else facts["verdict"])
        text = page.run("document.body.innerText")
        for slip in ("false", "undefined", "null", "NaN"):
            self.assertNotIn(slip, text.split())
        self.assertIn(f"{facts['colliding_points']:,}", text)
        for kind in ("environment", "model", "trajectory"):
            self.assertIn(facts["inputs"][kind]["hash"], text)
        self.assertEqual(json.loads(page.run("document.getElementById('facts').textContent")),
                         facts)

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
                        "chainage_to", "least_distance", "nearest_pose", "side"):
                self.assertEqual(a[key], b[key], key)

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
        path, facts = self.hall.report(self.found, "hall", "--classes", "0.05,0.1,0.3")
        self.assertEqual(facts["verdict"], "conflict")
        page = self.open(path)
        self.check_words(page, facts)
        self.assertEqual([c["name"] for c in facts["classes"]], ["hit", "near", "watch"])
        worst = facts["conflicts"]["worst"]
        self.assertEqual(page.run("page.conflict.id"), worst)
        page.run("document.documentElement.style.scrollBehavior = 'auto'")
        for canvas in ("#plan-canvas", "#view-canvas", "[data-kind=front]", "[data-kind=above]",
                       "[data-kind=section]"):
            page.frames()
            self.assertGreater(page.run(f"({BLANK})('{canvas}')"), 20, canvas)
        self.check_slider(page)
        self.check_table(page, facts)
        self.check_keys(page)
        shot = f"{self.hall.folder}/shot.png"
        page.screenshot(shot)
        self.assertGreater(os.path.getsize(shot), 20000)
        page.pdf(f"{self.hall.folder}/page.pdf")
        self.assertGreater(os.path.getsize(f"{self.hall.folder}/page.pdf"), 50000)
        self.check_quiet(page)

    def check_slider(self, page):
        page.run("""{ const s = byId('pose-slider'); s.value = 7;
            s.dispatchEvent(new Event('input')); }""")
        page.frames()
        index = page.run("page.poses.index[7]")
        self.assertIn(f"pose {index:,},", page.run("byId('pose-text').textContent"))
        self.assertIn(f"Pose {index:,},", page.run("byId('profile-readout').textContent"))

    def check_table(self, page, facts):
        rows = "document.querySelectorAll('#conflicts-table tbody tr')"
        self.assertEqual(page.run(f"{rows}.length"), min(100, facts["conflicts"]["count"]))
        page.run("sortBy('No.')")
        ids = page.run(f"[...{rows}].map((r) => +r.dataset.id)")
        self.assertEqual(ids, sorted(ids))
        page.run(f"{rows}[2].click()")
        self.assertEqual(page.run("page.conflict.id"), ids[2])
        self.assertIn(f"Conflict {ids[2]}", page.run("byId('conflict-details').innerText"))
        side = facts["conflicts"]["list"][0]["side"]
        page.run(f"""{{ const s = document.querySelector('#conflicts-tools select');
            s.value = '{side}'; s.dispatchEvent(new Event('change')); }}""")
        count = sum(c["side"] == side for c in facts["conflicts"]["list"])
        self.assertEqual(page.run(f"{rows}.length"), min(100, count))

    def check_keys(self, page):
        """From a row of the table to the next, and into it, without a mouse."""
        page.run("document.querySelector('#conflicts-table tbody tr').focus()")
        page.key("ArrowDown")
        chosen = page.run("document.activeElement.dataset.id")
        page.key("Enter", "\r")
        self.assertEqual(page.run("String(page.conflict.id)"), chosen)
        page.run("document.querySelector('#profile-chart svg').focus()")
        before = page.run("page.pose")
        page.key("ArrowRight")
        self.assertEqual(page.run("page.pose"), before + 1)

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
        page.frames()
        self.assertGreater(page.run(f"({BLANK})('#view-canvas')"), 5)
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
        self.assertIn("--model-above", page.run("byId('verdict').innerText"))
        self.check_quiet(page)


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    if CHROMIUM is None:
        print("chromium is not installed: pages are made, but not looked at", file=sys.stderr)
    unittest.main(verbosity=2)
