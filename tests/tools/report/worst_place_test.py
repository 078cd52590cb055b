#!/usr/bin/python3
"""Table, page, JSON and verdict name the same worst place, on twenty made scenes.

Usage: worst_place_test.py PROGRAM. Standard library only. A browser opens the first page of each
kind of search, because opening one takes as long as all else of its scene.
"""

import random
import re
import unittest

from pages import CHROMIUM, ROWS, Pages, Scene

SCENES = 20


def make_scene(place, seed):
    """A lane of 60 m with things beside and in the way of a box of 8 x 2.4 x 3 m."""
    random.seed(seed)
    points = [(x / 4, y / 4, 0) for x in range(-40, 281) for y in range(-32, 33)]
    for _ in range(random.randint(1, 7)):
        lo = [random.uniform(8, 55), random.choice((-1, 1)) * random.uniform(0, 1.6),
              random.choice((0, random.uniform(0.2, 3.4)))]
        size = [random.uniform(0.05, 2) for _ in range(3)]
        for _ in range(random.choice((8, 40, 400))):  # points on the surface of a box
            p = [random.uniform(a, a + b) for a, b in zip(lo, size)]
            k = random.randrange(3)
            p[k] = random.choice((lo[k], lo[k] + size[k]))
            points.append(p)
    place.put("scan.xyz", "".join("%.3f %.3f %.3f\n" % tuple(p) for p in points))
    place.put_path("path.txt", [(x / 10,) for x in range(601)])
    place.put_box("box.off", (-4, -1.2, 0.3), (4, 1.2, 3.3))


class WorstPlace(Pages):
    opened = set()

    def check_scene(self, place, seed):
        make_scene(place, seed)
        how = random.choice(("solid", "surface", "points"))
        ways = "--between-poses" if how == "points" and seed % 4 == 0 else ""
        said = place.ask(f"check scan.xyz --model box.off --model-as {how} {ways} --trajectory path.txt --radius 0.15 "
                         "-o site").stdout
        for row in place.rows("site/stations.csv"):
            if row["verdict"] == "conflict":
                self.assertTrue(row["least"] or row["least_below"], row)
                self.assertTrue(not row["least"] or float(row["least"]) <= 0.15, row)
            self.assertFalse(row["verdict"] == "clear" and row["least_below"], row)
        facts, rows = place.facts("site/report.html"), place.rows("site/conflicts.csv")
        if facts["verdict"] != "conflict":
            return 0
        worst = next(row["id"] for row in rows if row["rank"] == "1")
        listed = place.ask("conflicts site/result.h5 --trajectory path.txt --model box.off").stdout
        summary = place.json("conflicts site/result.h5 --trajectory path.txt --model box.off")
        table = next(line for line in said.splitlines() if re.match(r" +\d+ +\d+\.\d\d - ", line))
        first = facts["conflicts"]["list"][facts["conflicts"]["worst"] - 1]
        self.assertEqual({table.split()[0], str(summary["worst"]), str(facts["conflicts"]["worst"]), str(first["id"])},
                         {worst})
        sentences = [text.splitlines()[-1].partition("The worst place is ")[2] for text in (said, listed)]
        self.assertEqual([first["rank"], sentences[0]], [1, sentences[1]])
        self.assertTrue(sentences[0].startswith(f"conflict {worst}, "), sentences[0])
        self.assertNotIn("least distance is", said.splitlines()[-1])
        self.assertIn(first["remedy"], said)
        self.assertTrue(how == "solid" or all(row["encroachment_is"] in ("at-least", "") for row in rows))
        if CHROMIUM and (how, ways) not in self.opened:
            self.opened.add((how, ways))
            self.check_page(self.open(place / "site/report.html"), worst, first)
        return 1

    def check_page(self, page, worst, first):
        self.says(page, {"verdict": [f"The worst place is conflict {worst}, ", first["remedy"], f"No. {worst}"]})
        text = page.run("byId('verdict').innerText")
        self.assertEqual(set(re.findall(r"[Cc]onflict (\d+)", text)), {worst})
        self.gives(page, {f"[{ROWS}[0].dataset.id, String(page.conflict.id)]": [worst, worst]})
        if first["encroachment_is"] == "at-least":
            self.assertNotRegex(text, r"(?<!at least )\b0\.\d+ m missing")

    def test_everybody_names_the_same_place(self):
        found = 0
        for seed in range(SCENES):
            with self.subTest(seed=seed):
                found += self.check_scene(Scene(self.place / str(seed)), seed)
        self.assertGreater(found, SCENES / 2)


if __name__ == "__main__":
    unittest.main()
