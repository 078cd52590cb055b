#!/usr/bin/python3
"""Pages and pictures of sections: what they say, refusals, and what a browser shows of them.

Usage: section_page_test.py PROGRAM. Standard library only. Where chromium is not installed, the
pages are made and not opened; the test says so.
"""

import csv
import json
import os
import re
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

import scenes
from browser import Browser, find_chromium
from scenes import DATE, Scene, clearway

CHROMIUM = find_chromium()
SVG = "{http://www.w3.org/2000/svg}"


def make_street(folder):
    """A straight road of 40 m between walls, with a post on the left at x = 20 and a wire above."""
    scene = Scene(folder)
    scene.model = f"{folder}/model.xyz"
    lines = []
    for i in range(801):
        x = 0.05 * i
        for k in range(60):
            lines += [f"{x:.2f} 3.5 {0.05 * k:.2f}", f"{x:.2f} -3 {0.05 * k:.2f}"]
    lines += [f"20 {1.2 + 0.02 * j:.2f} {0.02 * k:.2f}" for j in range(5) for k in range(125)]
    lines += [f"30 {0.02 * j - 2:.2f} 2.91" for j in range(200)]
    with open(f"{folder}/scan.xyz", "w") as file:
        file.write("\n".join(lines) + "\n")
    with open(scene.trajectory, "w") as file:
        file.writelines(f"1 0 0 {2 + 0.25 * i:.2f} 0 1 0 0 0 0 1 0\n" for i in range(145))
    with open(scene.model, "w") as file:
        file.writelines(f"{x} {y} {z}\n" for x in (-1, 0, 1)
                        for y in (-1.3, -0.65, 0, 0.65, 1.3) for z in (0.5, 1, 1.5, 2, 2.5, 2.8))
    clearway("convert", f"{folder}/scan.xyz", "-o", scene.store, "--force")
    scene.section = f"{folder}/section.h5"
    clearway("section", "find", "--env", scene.store, "--trajectory", scene.trajectory,
             "--x-range=-1,1", "--window=-4,4,0,4", "--cell", 0.05, "--margin", 0.3, "-o",
             scene.section)
    for name, top in (("tall", 2.9), ("low", 2), ("thin", 2.2)):
        half = 0.7 if name == "thin" else 1.3
        with open(f"{folder}/{name}.csv", "w") as file:
            file.write(f"y,z\n-{half},0.5\n{half},0.5\n{half},{top}\n-{half},{top}\n")
    scene.search("out", "--radius", 0.3, "--first-pose")
    clearway("conflicts", f"{folder}/out.h5", "--trajectory", scene.trajectory, "--model",
             scene.model, "--min-points", 1, "-o", f"{folder}/conflicts.csv")
    return scene


class SectionPageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="clearway-section-")
        cls.street = make_street(cls.temporary.name)
        cls.browser = Browser(CHROMIUM) if CHROMIUM else None

    @classmethod
    def tearDownClass(cls):
        if cls.browser:
            cls.browser.__exit__()
        cls.temporary.cleanup()

    def file(self, name):
        return f"{self.street.folder}/{name}"

    def report(self, name, *options, code=0):
        text = clearway("report", self.street.section, "-o", self.file(name), "--force",
                        "--json", "--date", DATE, *options, code=code)
        return json.loads(text) if code == 0 else text

    def site(self):
        return "--env", self.street.store, "--trajectory", self.street.trajectory

    def open(self, name):
        if self.browser is None:
            self.skipTest("chromium is not installed: the page is made, but not looked at")
        page = self.browser.page(self.file(name))
        self.addCleanup(page.close)
        return page

    def check_page(self, page, facts):
        self.assertEqual(page.run("document.body.dataset.ready"), "true")
        text = page.run("document.body.innerText")
        for slip in ("false", "undefined", "null", "NaN", "[object"):
            self.assertNotIn(slip, text.replace(",", " ").split())
        self.assertEqual(json.loads(page.run("document.getElementById('facts').textContent")),
                         facts)
        self.assertEqual(page.complaints(), [])

    def test_the_places_that_stop_the_load_have_names(self):
        facts = self.report("tall.html", "--outline", self.file("tall.csv"), "--margin", 0.1,
                            *self.site(), "--conflicts", self.file("conflicts.csv"))
        check = facts["section"]["check"]
        self.assertEqual(check["verdict"], "stopped")
        by_chainage = {round(s["bin"] * 5): s for s in check["stops"]}
        self.assertEqual(sorted(by_chainage), [15, 25])
        post, wire = by_chainage[15], by_chainage[25]
        # The post begins at y = 1.2, the wire's cells at z = 2.9; the load ends at 1.3 and 2.9.
        self.assertEqual([i["side"] for i in post["intrusions"]], ["left"])
        self.assertAlmostEqual(post["intrusions"][0]["depth"], 0.2, 6)
        self.assertAlmostEqual(post["intrusions"][0]["clear_to"], 1.4, 6)
        self.assertIn("Clear on the left to y = 1.40 m", post["remedy"])
        self.assertEqual([i["side"] for i in wire["intrusions"]], ["above"])
        self.assertAlmostEqual(wire["intrusions"][0]["depth"], 0.1, 6)
        self.assertIn("Clear up to z = 3.00 m", wire["remedy"])
        self.assertEqual(post["intrusions"][0]["witness"]["xyz"][0], 20)
        with open(self.file("scan.xyz")) as file:
            lines = file.read().splitlines()
        for stop in (post, wire):
            witness = stop["intrusions"][0]["witness"]
            self.assertEqual([float(v) for v in lines[witness["source"]].split()],
                             [round(v, 4) for v in witness["xyz"]])
        self.assertTrue(post["obstacles"] and post["obstacles"] != wire["obstacles"])
        places = check["places"]  # the deepest is A
        self.assertEqual([(p["label"], p["side"], p["chainage_from"], p["chainage_to"]) for p in places],
                         [("A", "left", 15, 20), ("B", "above", 25, 30)])
        self.assertIn("Clear on the left to y = 1.40 m", places[0]["remedy"])
        self.assertTrue(post["intrusions"][0]["obstacle"].startswith("conflict "))

    def name_obstacles(self):
        """Obstacles with names of one's own, as options for the page."""
        with open(self.file("conflicts.csv")) as file:
            head, *rows = file.read().splitlines()
        with open(self.file("named.csv"), "w") as file:
            file.write(f"{head},name\n" + "".join(f'{r},"tree {i}, <old>"\n'
                                                   for i, r in enumerate(rows)))
        return "--conflicts", self.file("named.csv")

    def test_page_in_a_browser(self):
        facts = self.report("tall.html", "--outline", self.file("tall.csv"), "--margin", 0.1,
                            *self.site(), *self.name_obstacles())
        names = {name for stop in facts["section"]["check"]["stops"] for name in stop["obstacles"]}
        self.assertTrue(names and all(re.fullmatch(r"tree \d+, <old>", name) for name in names))
        page = self.open("tall.html")
        self.check_page(page, facts)
        self.assertIn(sorted(names)[0], page.run("byId('stops-places').innerText"))
        self.assertEqual(page.run("byId('verdict-word').textContent"), "Stopped")
        self.assertIn("in 2 stretches in all", page.run("byId('answer').textContent"))
        # The pictures of the stretches hold the cells of the table of the same section.
        clearway("section", "export", self.street.section, "--table", "bin-cells", "-o",
                 self.file("cells.csv"), "--force")
        with open(self.file("cells.csv")) as file:
            cells = [tuple(map(int, line.split(","))) for line in file.read().splitlines()[1:]]
        index = page.run("sectionBins().indexOf(3)")
        page.run(f"chooseStretch({index})")
        path = page.run("document.querySelector('#section-stretch path').getAttribute('d')")
        drawn = {(int(j) - 80 + i, int(k)) for j, k, n in re.findall(r"M(\d+) (\d+)h(\d+)", path)
                 for i in range(int(n))}
        self.assertEqual(drawn, {(j, k) for b, j, k, _ in cells if b == 3})
        whole = page.run("[...document.querySelectorAll('#section-cells path:not(.stops)')]"
                         ".map((p) => p.getAttribute('d')).join('')")
        drawn = {(int(j) - 80 + i, int(k)) for j, k, n in re.findall(r"M(\d+) (\d+)h(\d+)", whole)
                 for i in range(int(n))}
        self.assertEqual(drawn, {(j, k) for _, j, k, _ in cells})
        self.assertIn("stops the load", page.run("byId('section-title').textContent"))
        self.assertEqual(page.run("byId('section-cells').style.display"), "none")
        self.check_widths(page)
        self.check_keys(page)
        page.call("Emulation.setEmulatedMedia", media="print")
        page.pdf(self.file("tall.pdf"))
        self.assertEqual(page.complaints(), [])

    def check_widths(self, page):
        """What the cursor says is what the table of stations says."""
        clearway("section", "export", self.street.section, "--table", "stations", "-o",
                 self.file("stations.csv"), "--force")
        with open(self.file("stations.csv")) as file:
            rows = [line.rstrip().split(",") for line in file if not line.startswith("#")]
        names, rows = rows[0], rows[1:]
        bands = page.run("section.facts.bands.length")
        self.assertEqual(len(rows), bands * page.run("sectionBins().length"))
        rooms = page.run("sectionBins().flatMap((_, i) => section.facts.bands.map((_, b) => "
                         "roomAt(i, b)))")
        for row, room in zip(rows, rooms):
            row = dict(zip(names, row))
            for key, name in (("left", "left"), ("right", "right"), ("width", "symmetric_width")):
                if row[name] == "open":
                    self.assertIsNone(room[key])
                else:
                    self.assertAlmostEqual(room[key], float(row[name]), 9)
            if row["left"] != "open":
                self.assertEqual(room["leftPose"], int(row["left_pose"]))

    def check_keys(self, page):
        page.run("document.querySelector('#section-map svg').focus()")
        before = page.run("[section.chosen, section.band]")
        page.key("ArrowRight")
        page.key("ArrowUp")
        self.assertEqual(page.run("[section.chosen, section.band]"), [before[0] + 1, before[1] + 1])
        self.assertIn(f"z = {page.run('section.facts.bands[section.band].z_from'):.2f}",
                      page.run("byId('section-readout').textContent"))
        page.key("Escape")
        self.assertIsNone(page.run("section.chosen"))
        self.assertIsNone(page.run("byId('section-stretch')"))
        page.run("document.querySelector('#stops-table tbody tr').focus()")
        page.key("Enter", "\r")
        self.assertEqual(page.run("sectionBins()[section.chosen]"), 3)
        page.run("""{ const s = byId('section-side'); s.value = 'left';
            s.dispatchEvent(new Event('change')); }""")
        self.assertIn("room to the left", page.run("byId('section-map').textContent"))

    def test_a_load_that_passes_and_one_that_leaves_the_window(self):
        facts = self.report("thin.html", "--outline", self.file("thin.csv"), "--margin", 0.1)
        self.assertEqual(facts["section"]["check"]["verdict"], "passes")
        page = self.open("thin.html")
        self.check_page(page, facts)
        self.assertTrue(page.run("byId('verdict-word').textContent").startswith("Passes"))
        self.assertIsNone(page.run("byId('stops')"))
        facts = self.report("thin.html", "--outline", self.file("thin.csv"), "--margin", 0.4)
        self.assertEqual(facts["section"]["check"]["verdict"], "unknown")

    def test_without_an_outline(self):
        facts = self.report("wide.html", "--base", 0.5)
        # Left 1.2 by the post up to z = 2.5, and up to 2.9 by the wire across the middle.
        self.assertIn("the largest box: a load that stands at z = 0.5 m may be 2.4 m wide and "
                      "2.4 m high", facts["section"]["sentence"])
        self.assertIsNone(facts["section"]["check"])
        page = self.open("wide.html")
        self.check_page(page, facts)
        self.assertIn("2.4 m wide", page.run("byId('answer').textContent"))

    def test_picture(self):
        picture = self.file("picture.svg")
        clearway("report", self.street.section, "-o", picture, "--outline",
                 self.file("tall.csv"), "--margin", 0.1, *self.site(), "--conflicts",
                 self.file("conflicts.csv"))
        root = xml.parse(picture).getroot()
        self.assertEqual(root.tag, f"{SVG}svg")
        words = [text.text for text in root.iter(f"{SVG}text")]
        for expected in ("y (m), looking forward", "height z (m)", "stops the load",
                         "its margin, 0.1 m"):
            self.assertIn(expected, words)
        self.assertTrue(any(w.startswith("conflict ") for w in words))
        outline = next(e for e in root.iter(f"{SVG}path") if e.get("class") == "section_outline")
        scale, left = float(root.get("data-scale")), float(root.get("data-left"))
        # y to the left: the corner at y = -1.3 is right of the one at y = 1.3.
        first, second = re.findall(r"[ML]([\d.]+)", outline.get("d"))[:2]
        self.assertAlmostEqual(float(first), left + (80 + 26) * scale, 1)
        self.assertAlmostEqual(float(second), left + (80 - 26) * scale, 1)

    def test_report_of_a_run_shows_the_section(self):
        page, facts = self.street.report(self.file("out.h5"), "run", "--section",
                                         self.street.section)
        self.assertEqual(facts["section"]["name"], "section.h5")
        _, plain = self.street.report(self.file("out.h5"), "plain")
        self.assertNotIn("section", plain)
        shown = self.open("run.html")
        self.assertEqual(shown.complaints(), [])
        shown.run("chooseStretch(2)")
        self.assertIsNotNone(shown.run("byId('section-stretch').id"))
        self.assertIn("Chainage", shown.run("byId('section-title').textContent"))

    def test_feet(self):
        with open(self.file("feet.csv"), "w") as file:
            file.write("y,z\n" + "".join(f"{y / 0.3048!r},{z / 0.3048!r}\n" for y, z in
                                           ((-1.3, 0.5), (1.3, 0.5), (1.3, 2), (-1.3, 2))))
        feet = self.report("feet.html", "--outline", self.file("feet.csv"), "--unit", "ft",
                           "--margin", "0.25 ft")["section"]["check"]
        metres = self.report("feet.html", "--outline", self.file("low.csv"), "--margin",
                             0.25 * 0.3048)["section"]["check"]
        self.assertEqual([s["bin"] for s in feet["stops"]], [s["bin"] for s in metres["stops"]])
        self.assertAlmostEqual(feet["stops"][0]["intrusions"][0]["depth"],
                               metres["stops"][0]["intrusions"][0]["depth"], 9)

    def test_refusals(self):
        tall = ("--outline", self.file("tall.csv"))
        self.assertIn("--env", self.report("bad.html", *tall, "--conflicts",
                                           self.file("conflicts.csv"), code=2))
        self.assertIn("--trajectory", self.report("bad.html", *tall, "--env", self.street.store,
                                                  code=2))
        self.assertIn(".svg", self.report("bad.png", *tall, code=2))
        self.assertIn("--outline", self.report("bad.html", "--margin", 0.1, code=2))
        self.assertIn("column", self.report("bad.html", *tall, *self.site(), "--conflicts",
                                            self.file("tall.csv"), code=3))
        with open(self.file("other.xyz"), "w") as file:
            file.write("1 2 3\n4 5 6\n")
        clearway("convert", self.file("other.xyz"), "-o", self.file("other.h5"), "--force")
        self.assertIn("another environment", self.report(
            "bad.html", *tall, "--env", self.file("other.h5"), "--trajectory",
            self.street.trajectory, code=3))
        with open(self.file("conflicts.csv"), newline="") as file:
            rows = list(csv.DictReader(file))
        with open(self.file("moved.csv"), "w", newline="") as file:
            moved = csv.DictWriter(file, rows[0])
            moved.writeheader()
            moved.writerows({**row, "lo_x": -900} for row in rows)
        self.assertIn("outside of the environment", self.report(
            "bad.html", *tall, *self.site(), "--conflicts", self.file("moved.csv"), code=3))
        self.assertFalse(os.path.exists(self.file("bad.html")))

    def test_check_names_the_witness(self):
        arguments = ("section", "check", self.street.section, "--outline", self.file("tall.csv"),
                     "--json")
        plain = scenes.subprocess.run([scenes.PROGRAM, *arguments], capture_output=True, text=True)
        self.assertEqual(plain.returncode, 1)
        self.assertNotIn("witness", plain.stdout)
        found = json.loads(scenes.subprocess.run(
            [scenes.PROGRAM, *arguments, *self.site()], capture_output=True, text=True).stdout)
        self.assertEqual(found["witness"]["xyz"][0], 20)
        self.assertEqual([stop["witness"]["xyz"][0] for stop in found["stops"]], [20, 30])

    def test_bytes_are_the_same_again(self):
        texts = []
        for name in ("one.html", "two.html"):
            self.report(name, "--outline", self.file("tall.csv"), *self.site())
            with open(self.file(name), "rb") as file:
                texts.append(file.read())
        self.assertTrue(texts[0] == texts[1])


if __name__ == "__main__":
    scenes.PROGRAM = sys.argv.pop(1)
    unittest.main()
