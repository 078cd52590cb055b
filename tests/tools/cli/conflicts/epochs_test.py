"""Two scans of a road, each driven by the same car: what is new, gone, the same and not known.

epochs_test.py PROGRAM
"""

import random
import sys
import unittest
from dataclasses import dataclass, replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "report"))
from pages import Pages  # noqa: E402
from place import write_las  # noqa: E402

SURFACE, WALL, THING = 2, 6, 5  # classes
LISTS = ["new", "new_parts", "new_small", "worse", "not_searched", "too_small", "gone", "same"]


@dataclass
class Kerb:
    """A row of points beside the car, whose side is at 1."""
    x_from: float
    x_to: float
    z_from: float
    z_to: float
    y: float = 1.05
    withheld: bool = False


@dataclass
class Epoch:
    """A scan of a road from x = 0 to 60, and how it is searched. The defaults are those of scan a."""
    things: list
    scanned_to: float = 60
    hole: tuple = (0, 0)  # the ground is missing from here to there
    no_left: tuple = (0, 0)  # nothing is scanned to the left from here to there
    no_right: tuple = (0, 0)
    lower: float = 0  # metres by which all is registered too low
    noise: int | None = None  # another number gives other noise; that of scan b is 1 where none is given
    year: int = 0  # in the file's header; 0: none
    step: float = 0.05  # metres between the points of things
    run: str = "--radius 0.1 --clearance 0.3"
    path: str = "path.txt"
    model: str = "--model car.off"


def steps(start, end, step):
    return [start + step * i for i in range(round((end - start) / step + 1e-6) + 1) if start + step * i <= end + 1e-9]


def pole(x):
    return Kerb(x, x + 0.1, 0.4, 1.4)


def points_of(epoch):
    points = [(x, y, 0, SURFACE, False) for x in steps(0, 60, 0.4) for y in steps(-3, 3, 0.4)
              if not epoch.hole[0] < x < epoch.hole[1]]
    points += [(x, y, z, WALL, False) for y, lost in ((3, epoch.no_left), (-3, epoch.no_right))
               for x in steps(0, 60, 0.4) for z in steps(0.2, 2.8, 0.4) if not lost[0] <= x < lost[1]]
    points += [(x, thing.y, z, THING, thing.withheld) for thing in epoch.things
               for x in steps(thing.x_from, thing.x_to, epoch.step)
               for z in steps(thing.z_from, thing.z_to, epoch.step)]
    return [point for point in points if point[0] <= epoch.scanned_to]


POLES = [pole(20), pole(45)]
SMALL_POLE = Kerb(45, 45.05, 0.4, 1.0)
WITHHELD = Kerb(10, 10.05, 0.4, 1.0, withheld=True)
LONG = Kerb(20, 24, 0.35, 0.4)
CABLE = Kerb(30, 30.1, 0.5, 0.5)


class Epochs(Pages):
    @classmethod
    def make(cls):
        for name, end, y in (("path", 57, 0), ("half", 30, 0), ("beside", 57, -0.5)):
            cls.place.put_path(f"{name}.txt", [(x, y) for x in steps(3, end, 0.5)])
        cls.place.put_box("car.off", (-2, -1, 0.3), (2, 1, 1.5))

    def search(self, name, epoch):
        draw = random.Random(int(name == "b") if epoch.noise is None else epoch.noise)
        noisy = [(*(v + draw.uniform(-0.005, 0.005) for v in (x, y, z - epoch.lower)), *rest)
                 for x, y, z, *rest in points_of(epoch)]
        write_las(self.place / f"{name}.las", noisy, year=epoch.year)
        self.place.ask(f"convert {name}.las --force --unit m -o {name}_site.h5")
        self.place.ask(f"run --env {name}_site.h5 {epoch.model} --trajectory {epoch.path} --first-pose --force "
                       f"-o {name}.h5 {epoch.run}")

    def comparison(self, a, b):
        """Searches two epochs. The words of a command that compares them."""
        self.search("a", a)
        self.search("b", b)
        same = (a.run, a.path, a.model) == (b.run, b.path, b.model)
        return (f"compare a.h5 b.h5 --conflicts --trajectory {a.path} --trajectory-b {b.path}"
                f"{'' if same else ' --allow-other-question'}")

    def check_pair(self, name, a, b, code, lists, words, reasons="", doubts=""):
        """lists: those of the comparison that have entries, with the numbers of these. reasons, doubts:
        why a place was not searched, and why stretches of b's path are undecided."""
        with self.subTest(name):
            compare = self.comparison(a, b)
            self.place.ask(compare, code, words)
            found = self.place.json(compare, code)
            why = {reason for place in found["not_searched"] for reason in place["reasons"]}
            self.assertEqual([self.lists_of(found), ", ".join(sorted(why)), found["holds"]],
                             [lists, reasons, code == 0])
            self.place.ask(f"stations b.h5 --trajectory {b.path} --force -o s.csv")
            codes = {code for row in self.place.rows("s.csv") if row["verdict"] == "undecided"
                     for code in row["doubts"].split()}
            self.assertEqual(", ".join(sorted(codes)), doubts)

    @staticmethod
    def lists_of(found):
        return ", ".join(sorted(f"{name} {len(found[name])}" for name in LISTS if found[name]))

    def test_two_epochs_are_told_apart_as_a_person_would(self):
        a, one, not_searched = Epoch(POLES), Epoch([pole(20)]), "b has not searched"
        for row in (
                ("unchanged with other noise", a, a, 0, "same 2", "no new conflicts"),
                ("gone", a, one, 0, "gone 1, same 1", "1 conflict is gone if b was scanned there"),
                ("one side is missing in a, the other in b", replace(a, no_right=(0, 61)),
                 replace(one, no_left=(0, 61)), 6, "not_searched 1, same 1", not_searched, "one-side"),
                ("one side is missing in both", replace(a, no_left=(0, 61)), replace(one, no_left=(0, 61)), 0,
                 "gone 1, same 1", "no new conflicts"),
                ("a side is missing on stretches that overlap", Epoch([pole(45)], no_left=(0, 28)),
                 Epoch([], no_left=(22, 61)), 6, "not_searched 1", not_searched, "one-side"),
                ("a side is missing on one stretch", Epoch([pole(45)], no_left=(0, 28)),
                 Epoch([], no_left=(0, 28)), 0, "gone 1", "no new conflicts"),
                ("lower scan", a, Epoch(POLES, lower=3.5), 6, "not_searched 2", f"{not_searched} 2 places", "floats"),
                ("withheld pole", Epoch([SMALL_POLE]), Epoch([replace(SMALL_POLE, withheld=True)]), 6,
                 "not_searched 1", f"{not_searched} 1 place", "withheld"),
                ("pole that is gone between scans with withheld points", Epoch([SMALL_POLE, WITHHELD]),
                 Epoch([WITHHELD]), 0, "gone 1", "the dates of the files do not show that b is the later scan"),
                ("shorter scan", a, Epoch(POLES, scanned_to=33), 6, "not_searched 1, same 1", not_searched,
                 "leaves-scan", "leaves-scan"),
                ("hole in the ground", a, replace(one, hole=(38, 52)), 6, "not_searched 1, same 1",
                 "its run warned of nothing-below", "nothing-below", "nothing-below"),
                ("moved pole", a, Epoch([pole(20), pole(47)]), 1, "gone 1, new 1, same 1", "1 new conflict"),
                ("new cable of a few points", a, Epoch([*POLES, CABLE]), 1, "new_small 1, same 2",
                 "new groups that are too small to be listed: 1"),
                ("cable of a few points that both have", Epoch([*POLES, CABLE]), Epoch([*POLES, CABLE]), 0, "same 2",
                 "no new conflicts"),
                ("cable of a few points at another place", Epoch([*POLES, CABLE]),
                 Epoch([*POLES, Kerb(35, 35.1, 0.5, 0.5)]), 1, "new_small 1, same 2", "too small to be listed: 1"),
                ("new pole in the box of a kerb that is gone", Epoch([LONG, Kerb(20, 20.05, 0.4, 1.4)]),
                 Epoch([Kerb(23, 23.1, 0.9, 1.4)]), 1, "gone 1, new 1", "1 new conflict"),
                ("new pole that hangs together with an old kerb", Epoch([LONG]),
                 Epoch([LONG, Kerb(23, 23.1, 0.4, 1.4)]), 1, "new_parts 1, same 1",
                 "1 part of another conflict is new"),
                ("one falls into two", Epoch([LONG]), Epoch([replace(LONG, x_to=21.5), replace(LONG, x_from=22.5)]),
                 0, "same 2", "no new conflicts"),
                ("two become one", Epoch([replace(LONG, x_to=21.5), replace(LONG, x_from=22)]), Epoch([LONG]), 0,
                 "same 2", "no new conflicts"),
                ("the same scan twice", a, Epoch(POLES, noise=0), 6, "same 2", "the same scan"),
                ("older scan", Epoch(POLES, year=2024), Epoch(POLES, year=2022), 6, "same 2",
                 "by the dates of the files b is older than a"),
                ("pole that is missing in an older scan", Epoch(POLES, year=2024), replace(one, year=2022), 6,
                 "gone 1, same 1", "by the dates of the files b is older than a"),
                ("newer scan", Epoch(POLES, year=2022), Epoch(POLES, year=2024), 0, "same 2", "no new conflicts"),
                ("smaller radius", a, Epoch(POLES, run="--radius 0.02"), 6, "not_searched 2",
                 f"{not_searched} 2 places", "coarse-scan, radius"),
                ("ignored class", a, Epoch(POLES, run=f"{a.run} --ignore-class 5"), 6, "not_searched 2",
                 f"{not_searched} 2 places", "ignored"),
                ("another path", a, Epoch(POLES, path="beside.txt"), 6, "not_searched 2",
                 f"{not_searched} 2 places", "path"),
                ("shorter path", a, Epoch([], path="half.txt"), 6, "gone 1, not_searched 1",
                 f"{not_searched} 1 place", "path"),
                ("pole that the last pose of a shorter path reaches", Epoch([pole(31.5)]),
                 Epoch([], path="half.txt"), 0, "gone 1", "no new conflicts")):
            self.check_pair(*row)

    def test_the_floors_of_a_vehicles_bodies_are_compared_body_by_body(self):
        def vehicle(name, **floors):
            self.place.put(f"{name}.json", {"bodies": [
                {"name": body, "model": "car.off", "at": at, **({"floor": floors[body]} if floors else {})}
                for body, at in (("cab", 0), ("box", -5))]})
            return Epoch([pole(20), Kerb(45, 45.1, 0.4, 0.7)], model=f"--vehicle {name}.json")
        low, high, none = vehicle("low", cab=0.35, box=0.4), vehicle("high", cab=0.85, box=0.9), vehicle("none")
        for row in (("the same floors", low, low, 0, "same 2", "no new conflicts"),
                    ("higher floors", low, high, 6, "not_searched 2, same 1", "b has not searched 2 places",
                     "floor, model"),
                    ("floors that were not there before", none, high, 6, "not_searched 2, same 1",
                     "b has not searched 2 places", "floor, model")):
            self.check_pair(*row)
        # In one scan a vehicle is searched wherever its floors are not higher.
        for a, b, code, lists in ((high, low, 1, "new 1, new_parts 1, same 1"),
                                  (low, high, 6, "not_searched 2, same 1")):
            self.assertEqual(self.lists_of(self.place.json(self.comparison(a, replace(b, noise=0)), code)), lists)
        floor = self.place.json("info b.h5")["floor"]
        self.assertEqual([floor["height"], floor["bodies"]], [None, {"cab": 0.85, "box": 0.9}])

    def test_what_a_search_warns_of_is_in_all_that_is_made_of_its_result(self):
        compare = self.comparison(Epoch(POLES), Epoch([pole(20)], scanned_to=33))
        self.place.ask(f"{compare} -o c.html -o c.csv", 6)
        self.assertIn("not searched", (self.place / "c.html").read_text())
        self.assertRegex((self.place / "c.csv").read_text(), "(?s)\nnot searched,2,,.*leaves-scan\n")
        path = "b.h5 --trajectory path.txt"
        # The run collides, and still its result keeps the warning with its stretch.
        info = self.place.json("info b.h5")
        self.assertEqual([info["verdict"], info["doubts"], info["warnings"][0]["code"]],
                         ["conflict", ["leaves-scan"], "leaves-scan"])
        [(start, end)] = info["warnings"][0]["stretches"]
        # From where the scan ends to the last pose, with the pole at 45 m.
        self.assertTrue(60 < start < 70 and end == 108, (start, end))
        self.assertEqual(self.place.json(f"conflicts {path}")["warnings"], info["warnings"])
        self.place.ask(f"report {path} --env b_site.h5 --model car.off -o page.html")
        self.assertIn("leaves-scan", [one["code"] for one in self.place.facts("page.html")["warnings"]])
        # Where nothing collides, the verdict of the whole is undecided too.
        self.search("b", Epoch([], scanned_to=33, noise=0))
        self.assertEqual(self.place.json("info b.h5")["verdict"], "undecided")

    def test_the_page_shows_each_obstacle_in_a_row(self):
        """A conflict of a that fell into two is one of them."""
        compare = self.comparison(Epoch([LONG, pole(45)]),
                                  Epoch([replace(LONG, x_to=21.5), replace(LONG, x_from=22.5), pole(47)]))
        self.place.ask(f"{compare} -o p.html", 1)
        page = self.open(self.place / "p.html")
        cells = "[...document.querySelectorAll('#obstacles tbody tr')].map((row) => row.cells[{}].textContent)"
        self.gives(page, {"byId('verdict-word').textContent": "Worse", cells.format(1): ["new", "gone", "same"],
                          cells.format(2): ["–", "2", "1"], cells.format(3): ["3", "–", "1, 2"],
                          "[...document.querySelectorAll('.tile strong')].map((one) => one.textContent)":
                          ["1", "0", "0", "1", "1"], "document.querySelectorAll('#plan circle').length": 3})
        self.says(page, {"question": ["a, before", "2 conflicts", "closer than 0.1 m"], "answer": "1 new conflict"})

    def test_commands_that_read_a_result_repeat_what_its_run_warned_of(self):
        self.search("a", Epoch(POLES, no_left=(0, 61)))
        path = "a.h5 --trajectory path.txt"
        shift = f"shift {path} --env a_site.h5 --model car.off"
        for command, code in ((f"conflicts {path}", 0), (f"stations {path} -o stations.csv", 0),
                              ("export a.h5 -o out.csv", 0), (shift, 0), ("compare a.h5 a.h5", 0)):
            self.place.ask(command, code, "nothing was scanned on the left of the model")
        warnings = self.place.json("info a.h5")["warnings"]
        self.assertEqual(self.place.json(shift)["warnings"], warnings)
        self.assertEqual([warnings[0]["code"], warnings[0]["numbers"]["side"]], ["one-side", 1])

    def test_a_run_notes_few_points_that_the_store_left_out_as_withheld(self):
        self.search("a", Epoch([SMALL_POLE, WITHHELD]))
        self.place.ask("run --env a_site.h5 --model car.off --trajectory path.txt --radius 0.1 -o again.h5", 0,
                       "points of the scans are not searched, because they have the flag")
        self.assertGreater(self.place.json("info a.h5")["withheld_points"], 20)

    def test_compare_reads_a_model_as_run_did(self):
        epoch = Epoch(POLES, run="--radius 0.1 --model-vertices")
        compare = self.comparison(epoch, epoch)
        self.place.ask(f"{compare} --model car.off", 3)
        self.place.ask(f"{compare} --model car.off --model-vertices")

    def test_both_scans_are_grouped_as_the_first_one_whose_points_may_be_farther_apart(self):
        """Two things that are 0.55 m apart: in a thin scan they hang together, and in a dense one not."""
        two = [Kerb(20, 20.75, 0.4, 1.4), Kerb(21.3, 22.05, 0.4, 1.4)]
        both = self.place.json(self.comparison(Epoch(two, step=0.25), Epoch(two)))
        thin, dense = (self.place.json(f"conflicts {name}.h5 --trajectory path.txt") for name in "ab")
        self.assertEqual([thin["conflict_count"], dense["conflict_count"], dense["gap"]], [1, 2, 0.3])
        self.assertGreater(thin["gap"], 0.7)
        self.assertEqual([both["gap"], both["min_points"], both["b"]["conflicts"], self.lists_of(both)],
                         [thin["gap"], thin["min_points"], 1, "same 1"])
        self.place.ask("compare b.h5 a.h5 --conflicts --trajectory path.txt", 0,
                       "both are grouped with a gap of 0.3 m and at least")


if __name__ == "__main__":
    unittest.main()
