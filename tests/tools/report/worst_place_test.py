#!/usr/bin/python3
"""Table, page, JSON and verdict name the same worst place, on twenty made scenes.

Usage: worst_place_test.py PROGRAM. Standard library only. A browser opens the first page of
each kind of search, because opening one takes as long as all else of its scene. Where chromium is
not installed, the pages are made and not opened; the test says so.
"""

import collections
import csv
import json
import random
import re
import sys
import tempfile
import unittest

import scenes
from browser import Browser, find_chromium
from scenes import clearway

SCENES = 20
OPENED = 1  # page of each kind of search


def add_box(points, number, lo, hi, step):
    """Points on the surface of a box."""
    for _ in range(number):
        p = [random.uniform(lo[k], hi[k]) for k in range(3)]
        k = random.randrange(3)
        p[k] = random.choice((lo[k], hi[k]))
        points.append([round(c / step) * step for c in p])


def make_scene(folder, seed):
    """A lane of 60 m with things beside and in the way of a box of 8 x 2.4 x 3 m."""
    random.seed(seed)
    points = [(x / 4, y / 4, 0) for x in range(-40, 281) for y in range(-32, 33)]
    for _ in range(random.randint(1, 7)):
        x, y = random.uniform(8, 55), random.choice((-1, 1)) * random.uniform(0, 1.6)
        z = random.choice((0, random.uniform(0.2, 3.4)))
        size = [random.uniform(0.05, 2) for _ in range(3)]
        add_box(points, random.choice((8, 40, 400)), (x, y, z),
                [a + b for a, b in zip((x, y, z), size)], 0.001)
    with open(f"{folder}/scan.xyz", "w") as file:
        file.writelines(f"{x:.3f} {y:.3f} {z:.3f}\n" for x, y, z in points)
    with open(f"{folder}/path.txt", "w") as file:
        file.writelines(f"1 0 0 {x / 10} 0 1 0 0 0 0 1 0\n" for x in range(601))
    model = f"{folder}/box.off"
    corners = [(x, y, z) for x in (-4, 4) for y in (-1.2, 1.2) for z in (0.3, 3.3)]
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6),
             (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    with open(model, "w") as file:
        file.write("OFF\n8 12 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in corners) +
                   "".join(f"3 {a} {b} {c}\n" for a, b, c in faces))


def page_facts(path):
    with open(path) as file:
        text = re.search(r'<script[^>]*id="facts"[^>]*>(.*?)</script>', file.read(), re.S).group(1)
    return json.loads(text)


class WorstPlaceTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        program = find_chromium()
        cls.browser = Browser(program) if program else None
        cls.opened = collections.Counter()

    @classmethod
    def tearDownClass(cls):
        if cls.browser:
            cls.browser.__exit__()

    def check_scene(self, seed, folder):
        make_scene(folder, seed)
        how = random.choice(("solid", "surface", "points"))
        ways = ("--between-poses",) if how == "points" and seed % 4 == 0 else ()
        site = f"{folder}/site"
        said = clearway("check", f"{folder}/scan.xyz", "--model", f"{folder}/box.off",
                        "--model-as", how, *ways, "--trajectory", f"{folder}/path.txt", "--radius",
                        0.15, "-o", site)
        with open(f"{site}/conflicts.csv") as file:
            rows = list(csv.DictReader(file))
        with open(f"{site}/stations.csv") as file:
            stretches = list(csv.DictReader(file))
        for row in stretches:
            if row["verdict"] == "conflict":
                self.assertTrue(row["least"] or row["least_below"], row)
                self.assertTrue(not row["least"] or float(row["least"]) <= 0.15, row)
            if row["verdict"] == "clear":
                self.assertFalse(row["least_below"], row)
        facts = page_facts(f"{site}/report.html")
        if facts["verdict"] != "conflict":
            return 0
        worst = next(row["id"] for row in rows if row["rank"] == "1")
        listed = clearway("conflicts", f"{site}/result.h5", "--trajectory", f"{folder}/path.txt",
                          "--model", f"{folder}/box.off", "-o", f"{folder}/all.json")
        with open(f"{folder}/all.json") as file:
            summary = json.load(file)
        table = next(line for line in said.splitlines() if re.match(r" +\d+ +\d+\.\d\d - ", line))
        first = facts["conflicts"]["list"][facts["conflicts"]["worst"] - 1]
        self.assertEqual({table.split()[0], str(summary["worst"]), str(facts["conflicts"]["worst"]),
                          str(first["id"])}, {worst})
        self.assertEqual(first["rank"], 1)
        for text in (said, listed):
            self.assertIn(f"The worst place is conflict {worst}, ", text.splitlines()[-1])
        self.assertNotIn("least distance is", said.splitlines()[-1])
        self.assertEqual(said.splitlines()[-1].split("The worst")[1], listed.splitlines()[-1].split("The worst")[1])
        self.assertIn(first["remedy"], said)
        if how != "solid":
            self.assertTrue(all(row["encroachment_is"] in ("at-least", "") for row in rows))
        if self.browser and self.opened[how, ways] < OPENED:
            self.opened[how, ways] += 1
            page = self.browser.page(f"{site}/report.html")
            self.check_page(page, worst, first)
            page.close()
        return 1

    def check_page(self, page, worst, first):
        text = page.run("byId('verdict').innerText")
        self.assertIn(f"The worst place is conflict {worst}, ", text)
        self.assertIn(first["remedy"], text)
        self.assertIn(f"No. {worst}", text)
        self.assertEqual(set(re.findall(r"[Cc]onflict (\d+)", text)), {worst})
        top = page.run("document.querySelector('#conflicts-table tbody tr').dataset.id")
        self.assertEqual([top, str(page.run("page.conflict.id"))], [worst, worst])
        if first["encroachment_is"] == "at-least":
            self.assertNotRegex(text, r"(?<!at least )\b0\.\d+ m missing")
        self.assertEqual(page.complaints(), [])

    def test_everybody_names_the_same_place(self):
        found = 0
        for seed in range(SCENES):
            with self.subTest(seed=seed), tempfile.TemporaryDirectory() as folder:
                found += self.check_scene(seed, folder)
        self.assertGreater(found, SCENES / 2)


if __name__ == "__main__":
    scenes.PROGRAM = sys.argv.pop(1)
    unittest.main()
