#!/usr/bin/python3
"""Pages and pictures of sections: what they say, refusals, and what a browser shows of them.

Usage: section_page_test.py PROGRAM. Standard library only.
"""

import csv
import json
import re
import unittest
import xml.etree.ElementTree as xml

from pages import DATE, Pages, Scene

SVG = "{http://www.w3.org/2000/svg}"
SITE = "--env site.h5 --trajectory path.txt"
TALL = "--outline tall.csv --margin 0.1"


class SectionPage(Pages):
    @classmethod
    def make(cls):
        """A straight road of 40 m between walls, with a post on the left at x = 20 and a wire above."""
        cls.street = street = Scene(cls.place.folder)
        street.model, street.trajectory = "model.xyz", "path.txt"
        points = [(0.05 * i, y, 0.05 * k) for i in range(801) for k in range(60) for y in (3.5, -3)]
        points += [(20, 1.2 + 0.02 * j, 0.02 * k) for j in range(5) for k in range(125)]
        points += [(30, 0.02 * j - 2, 2.91) for j in range(200)]
        street.put("scan.xyz", "".join("%g %g %g\n" % point for point in points))
        street.put_path("path.txt", [(2 + 0.25 * i,) for i in range(145)])
        street.put("model.xyz", "".join(f"{x} {y} {z}\n" for x in (-1, 0, 1) for y in (-1.3, -0.65, 0, 0.65, 1.3)
                                        for z in (0.5, 1, 1.5, 2, 2.5, 2.8)))
        street.ask("convert scan.xyz -o site.h5")
        street.ask(f"section find {SITE} --x-range=-1,1 --window=-4,4,0,4 --cell 0.05 --margin 0.3 -o section.h5")
        for name, half, top in (("tall", 1.3, 2.9), ("low", 1.3, 2), ("thin", 0.7, 2.2)):
            street.put(f"{name}.csv", f"y,z\n-{half},0.5\n{half},0.5\n{half},{top}\n-{half},{top}\n")
        street.ask(f"run {street.inputs()} --radius 0.3 --first-pose -o out.h5")
        street.ask(f"conflicts out.h5 {street.vehicle()} --min-points 1 -o conflicts.csv")

    def page_of(self, name, options, code=0, *said):
        """The facts of the page name.html of the section."""
        done = self.street.ask(f"report section.h5 -o {name}.html --force --json --date '{DATE}' {options}", code,
                               *said)
        return json.loads(done.stdout)["section"] if code == 0 else None

    def shown_section(self, name, **texts):
        """The open page, which has these texts in elements with these names."""
        page = self.open(self.street / f"{name}.html")
        self.gives(page, {"document.body.dataset.ready": "true",
                          "JSON.parse(byId('facts').textContent)": self.street.facts(f"{name}.html")})
        text = page.run("document.body.innerText").replace(",", " ").split()
        self.assertEqual({"false", "undefined", "null", "NaN", "[object"} & set(text), set())
        self.says(page, {f"byId('{name.replace('_', '-')}').textContent": words for name, words in texts.items()})
        return page

    def test_the_places_that_stop_the_load_have_names(self):
        check = self.page_of("stops", f"{TALL} {SITE} --conflicts conflicts.csv")["check"]
        # The post begins at y = 1.2, the wire's cells at z = 2.9; the load ends at 1.3 and 2.9.
        self.assertEqual(check["verdict"], "stopped")
        post, wire = sorted(check["stops"], key=lambda stop: stop["bin"])
        lines = (self.street / "scan.xyz").read_text().splitlines()
        for stop, chainage, side, depth, clear_to, remedy in (
                (post, 15, "left", 0.2, 1.4, "Clear on the left to y = 1.40 m"),
                (wire, 25, "above", 0.1, 3, "Clear up to z = 3.00 m")):
            [intrusion] = stop["intrusions"]
            self.assertEqual([round(stop["bin"] * 5), intrusion["side"]], [chainage, side])
            self.assertAlmostEqual(intrusion["depth"], depth, 6)
            self.assertIn(remedy, stop["remedy"])
            witness = intrusion["witness"]
            self.assertEqual([float(v) for v in lines[witness["source"]].split()],
                             [round(v, 4) for v in witness["xyz"]])
            if side == "left":
                self.assertAlmostEqual(intrusion["clear_to"], clear_to, 6)
        self.assertEqual(post["intrusions"][0]["witness"]["xyz"][0], 20)
        self.assertTrue(post["obstacles"] and post["obstacles"] != wire["obstacles"])
        self.assertTrue(post["intrusions"][0]["obstacle"].startswith("conflict "))
        # The deepest is A.
        keys = ("label", "side", "chainage_from", "chainage_to")
        self.assertEqual([[place[key] for key in keys] for place in check["places"]],
                         [["A", "left", 15, 20], ["B", "above", 25, 30]])
        self.assertIn("Clear on the left to y = 1.40 m", check["places"][0]["remedy"])
        self.page_of("again", f"{TALL} {SITE} --conflicts conflicts.csv")
        self.assertEqual(*self.street.bytes("stops.html", "again.html"))

    def cells_of(self, path):
        """The cells that the paths of a picture fill."""
        return {(int(j) - 80 + i, int(k)) for j, k, n in re.findall(r"M(\d+) (\d+)h(\d+)", path) for i in range(int(n))}

    def table(self, which):
        self.street.ask(f"section export section.h5 --table {which} -o table.csv --force")
        with open(self.street / "table.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(line for line in file if not line.startswith("#")))

    def test_the_page_shows_cells_widths_and_stretches(self):
        head, *rows = (self.street / "conflicts.csv").read_text().splitlines()
        self.street.put("named.csv", f"{head},name\n" + "".join(
            f'{row},"tree {i}, <old>"\n' for i, row in enumerate(rows)))
        check = self.page_of("tall", f"{TALL} {SITE} --conflicts named.csv")["check"]
        names = sorted({name for stop in check["stops"] for name in stop["obstacles"]})
        self.assertTrue(names and all(re.fullmatch(r"tree \d+, <old>", name) for name in names))
        page = self.shown_section("tall", stops_places=names[0], verdict_word="Stopped", answer="in 2 stretches in all")
        # The pictures of the stretches hold the cells of the table of the same section.
        cells = [tuple(int(row) for row in list(row.values())[:3]) for row in self.table("bin-cells")]
        page.run("chooseStretch(sectionBins().indexOf(3))")
        for path, expected in (("document.querySelector('#section-stretch path').getAttribute('d')",
                                {(j, k) for b, j, k in cells if b == 3}),
                               ("[...document.querySelectorAll('#section-cells path:not(.stops)')]"
                                ".map((p) => p.getAttribute('d')).join('')", {(j, k) for _, j, k in cells})):
            self.assertEqual(self.cells_of(page.run(path)), expected)
        self.says(page, {"byId('section-title').textContent": "stops the load"})
        self.gives(page, {"byId('section-cells').style.display": "none"})
        # What the cursor says is what the table of stations says.
        rooms = page.run("sectionBins().flatMap((_, i) => section.facts.bands.map((_, b) => roomAt(i, b)))")
        for row, room in zip(self.table("stations"), rooms, strict=True):
            for key, name in (("left", "left"), ("right", "right"), ("width", "symmetric_width")):
                if row[name] == "open":
                    self.assertIsNone(room[key])
                else:
                    self.assertAlmostEqual(room[key], float(row[name]), 9)
            if row["left"] != "open":
                self.assertEqual(room["leftPose"], int(row["left_pose"]))
        # Without a mouse.
        page.run("document.querySelector('#section-map svg').focus()")
        before = page.run("[section.chosen, section.band]")
        page.key("ArrowRight")
        page.key("ArrowUp")
        self.gives(page, {"[section.chosen, section.band]": [value + 1 for value in before]})
        self.says(page, {"byId('section-readout').textContent":
                         f"z = {page.run('section.facts.bands[section.band].z_from'):.2f}"})
        page.key("Escape")
        self.gives(page, {"[section.chosen, byId('section-stretch')]": [None, None]})
        page.run("document.querySelector('#stops-table tbody tr').focus()")
        page.key("Enter")
        self.gives(page, {"sectionBins()[section.chosen]": 3})
        page.run("{ const s = byId('section-side'); s.value = 'left'; s.dispatchEvent(new Event('change')); }")
        self.says(page, {"byId('section-map').textContent": "room to the left"})
        page.call("Emulation.setEmulatedMedia", media="print")
        self.assertTrue(page.call("Page.printToPDF", preferCSSPageSize=True)["data"])

    def test_a_load_that_passes_one_that_leaves_the_window_and_none(self):
        for margin, verdict in ((0.4, "unknown"), (0.1, "passes")):
            facts = self.page_of("thin", f"--outline thin.csv --margin {margin}")
            self.assertEqual(facts["check"]["verdict"], verdict)
        facts = self.page_of("wide", "--base 0.5")
        # Left 1.2 by the post up to z = 2.5, and up to 2.9 by the wire across the middle.
        self.assertIn("the largest box: a load that stands at z = 0.5 m may be 2.4 m wide and 2.4 m high",
                      facts["sentence"])
        self.assertIsNone(facts["check"])
        page = self.shown_section("thin", verdict_word="Passes")
        self.gives(page, {"byId('stops')": None})
        self.shown_section("wide", answer="2.4 m wide")

    def test_a_picture(self):
        self.street.ask(f"report section.h5 -o picture.svg {TALL} {SITE} --conflicts conflicts.csv")
        root = xml.parse(self.street / "picture.svg").getroot()
        words = [text.text for text in root.iter(f"{SVG}text")]
        self.assertEqual(root.tag, f"{SVG}svg")
        self.assertLessEqual({"y (m), looking forward", "height z (m)", "stops the load", "its margin, 0.1 m"},
                             set(words))
        self.assertTrue(any(word.startswith("conflict ") for word in words))
        outline = next(e for e in root.iter(f"{SVG}path") if e.get("class") == "section_outline")
        scale, left = float(root.get("data-scale")), float(root.get("data-left"))
        # y to the left: the corner at y = -1.3 is right of the one at y = 1.3.
        for found, cells in zip(re.findall(r"[ML]([\d.]+)", outline.get("d")), (80 + 26, 80 - 26)):
            self.assertAlmostEqual(float(found), left + cells * scale, 1)

    def test_the_report_of_a_run_shows_the_section(self):
        facts = self.street.report("run", "--section section.h5", result="out")
        self.assertEqual([facts["section"]["name"], "section" in self.street.report("plain", result="out")],
                         ["section.h5", False])
        page = self.open(self.street / "run.html")
        page.run("chooseStretch(2)")
        self.gives(page, {"byId('section-stretch').id": "section-stretch"})
        self.says(page, {"byId('section-title').textContent": "Chainage"})

    def test_an_outline_in_feet(self):
        self.street.put("feet.csv", "y,z\n" + "".join(f"{y / 0.3048!r},{z / 0.3048!r}\n" for y, z in (
            (-1.3, 0.5), (1.3, 0.5), (1.3, 2), (-1.3, 2))))
        feet, metres = (self.page_of("feet", options)["check"]["stops"] for options in (
            "--outline feet.csv --unit ft --margin '0.25 ft'", f"--outline low.csv --margin {0.25 * 0.3048}"))
        self.assertEqual([stop["bin"] for stop in feet], [stop["bin"] for stop in metres])
        self.assertAlmostEqual(*(stops[0]["intrusions"][0]["depth"] for stops in (feet, metres)), 9)

    def test_refusals(self):
        for options, code, word in ((f"{TALL} --conflicts conflicts.csv", 2, "--env"),
                                    (f"{TALL} --env site.h5", 2, "--trajectory"), ("--margin 0.1", 2, "--outline"),
                                    (f"{TALL} {SITE} --conflicts tall.csv", 3, "column")):
            self.page_of("bad", options, code, word)
        self.assertFalse((self.street / "bad.html").exists())
        self.street.ask(f"report section.h5 {TALL} -o bad.png", 2, ".svg")

    def test_check_names_the_witness(self):
        self.street.ask("section check section.h5 --outline tall.csv --json", 1, lacks=["witness"])
        found = self.street.json(f"section check section.h5 --outline tall.csv {SITE}", 1)
        self.assertEqual([found["witness"]["xyz"][0], [stop["witness"]["xyz"][0] for stop in found["stops"]]],
                         [20, [20, 30]])


if __name__ == "__main__":
    unittest.main()
