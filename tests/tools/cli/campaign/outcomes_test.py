"""What a campaign says of its runs: a conflict, an undecided one, a clear one with warnings, one
that ignores points, a clear one, a failed one and one that is not done are told alike by `campaign
run`, `status`, `report --json` and the page, and the counts add up. Also with ledgers.

outcomes_test.py PROGRAM
"""

import csv
import json
import math
import re
import unittest

from campaigns import LIMITS, Campaigns, make_scene, told

OUTCOMES = ("conflict", "undecided", "clear_with_warnings", "clear", "failed", "not_done")
MIDDLE = {"routes": {"middle": "middle.txt"}}
SLIM = {**MIDDLE, "vehicles": {"slim": "slim.off"}}


class Outcomes(Campaigns):
    base = {"name": "All outcomes", "environments": {"street": "site.h5"},
            "vehicles": {"slim": "slim.off", "wide": "wide.off"},
            "routes": {"middle": "middle.txt", "far": "far.txt"}, "radii": [0.1],
            "query": {"first_pose": True, "clearance": 0.5}, "limits": LIMITS}

    @classmethod
    def make(cls):
        """A street 40 m long with walls at 3 m to both sides, a floor, and a pole in the middle of a
        second lane."""
        points = [(0.1 * i - 10, y, 0.1 * k) for i in range(401) for y in (-3, 3) for k in range(31)]
        points += [(0.1 * i - 10, 0.1 * j, 0) for i in range(401) for j in range(-30, 31)]
        points += [(10, 0.5, 0.1 * k) for k in range(5, 25)]
        cls.place.put("scan.xyz", "".join(f"{x:.3f} {y:.3f} {z:.3f}\n" for x, y, z in points))
        cls.place.ask("convert scan.xyz -o site.h5")
        cls.place.put_box("slim.off", (-1, -0.3, 0.5), (1, 0.3, 2))
        cls.place.put_box("wide.off", (-1, -1, 0.5), (1, 1, 2))
        for name, y in (("middle", 0), ("far", 5000)):
            cls.place.put_path(f"{name}.txt", [(0.05 * i, y) for i in range(401)])

    def page(self, name):
        return (self.place / name / "index.html").read_text()

    def status_text(self, name):
        return self.place.ask(f"campaign status {name}").stdout

    def told_alike(self, name, expected=None):
        """By status, as text and as JSON, by report and by its page."""
        look = self.status(name)
        expected = expected or look["outcomes"]
        runs = sum(expected.values())
        self.assertEqual([look["outcomes"], look["runs"]], [expected, runs])
        done = self.place.ask(f"campaign report {name} --force --json")
        facts, page, shown = json.loads(done.stdout), self.page(name), self.shown(name)
        for text in (self.status_text(name), done.stderr):
            self.assertEqual(told(text), (runs, expected))
        for outcome in OUTCOMES:
            counts = [facts[outcome], sum(run["outcome"] == outcome for run in facts["runs"])]
            if shown is not None:
                legend = re.search(
                    rf'<li class="{outcome}"><span class="sign" aria-hidden="true">.</span> <b>(\d+)</b>', shown)
                counts += [shown.count(f'<td class="{outcome}"'), int(legend[1]) if legend else 0]
            self.assertEqual(set(counts), {expected[outcome]}, outcome)
        answer = self.place.facts(f"{name}/index.html")["words"]["answer"]
        counted = [int(n) for n in re.findall(r"\b(\d+)\b", answer.split(". In ")[0])]
        self.assertEqual([counted[0], sum(counted[1:])], [runs, runs], answer)
        self.assertIn(answer, shown or answer)
        return look, facts, page

    def test_every_outcome_is_told_alike_and_the_worst_decides_about_the_exit_code(self):
        """slim passes, wide hits the pole, and far away nothing can be found."""
        self.plan("out")
        counts = dict.fromkeys(OUTCOMES, 0)
        self.told_alike("out", {**counts, "not_done": 4})
        wide = self.place / "wide.off"
        sound = wide.read_bytes()
        wide.write_bytes(sound[:60])
        self.run_tasks("out", "--task 0-1,3 --fail-on-collision", 3)  # a failure goes first
        wide.write_bytes(sound)
        done = self.run_tasks("out", "--task 0-2 --fail-on-collision", 1)  # then a conflict
        self.assertEqual(told(done.stderr)[1]["conflict"], 1)
        clear = json.loads((self.place / "out/runs/slim/middle/0.1/run.json").read_text())
        counts["clear_with_warnings" if clear["warnings"] else "clear"] = 1
        look, facts, page = self.told_alike("out", {**counts, "conflict": 1, "undecided": 1, "failed": 1})
        far = facts["runs"][1]
        self.assertEqual([far["verdict"], far["reasons"], far["warnings"]],
                         ["undecided", ["question-in-doubt"], look["list"][1]["warnings"]])
        self.assertIn("out-of-reach", far["warnings"])
        self.assertIn("out-of-reach", page)
        self.assertRegex(self.status_text("out"), r"(?s)runs:.*far.*the question is in doubt \(out-of-reach\)")
        self.run_tasks("out", "--task 0-1 --fail-on-collision", 6)  # then an undecided one
        self.run_tasks("out", "--task 0 --fail-on-collision")
        self.plan("warned", {"vehicles": {"slim": "slim.off"}})
        self.assertRegex(self.run_tasks("warned").stderr,
                         r"slim/far/0\.1: undecided; \d warnings? \(.*out-of-reach")

    def test_ignored_points_are_told(self):
        self.plan("ignoring", {"query": {"ignore_boxes": [[9, -1, 0.3, 11, 1, 3]], "first_pose": True},
                               "vehicles": {"wide": "wide.off"}, **MIDDLE})
        self.run_tasks("ignoring", "--all", 0, "20 points ignored")
        look, facts, page = self.told_alike("ignoring")
        self.assertEqual([facts["runs"][0]["ignored"]["points"], look["list"][0]["ignored"]["points"]], [20, 20])
        colliding = facts["runs"][0]["ignored"]["colliding"]
        self.assertIn(f"20 ignored, of which {colliding} would collide", page)
        self.assertIn("In 1 run points were left out of the search.", page)
        self.assertIn("20 points ignored", self.status_text("ignoring"))

    def test_a_distance_of_rounding_errors_alone_is_0_for_people(self):
        self.place.put("touching.xyz", "0 3.0000000000000001 1\n0 0.3 1\n")
        self.place.put_path("turned.txt", [(3 * math.sin(0.3), 3 - 3 * math.cos(0.3), 0, 0.3)])
        self.done("rounded", {"vehicles": {"touching": "touching.xyz"}, "routes": {"turned": "turned.txt"}})
        self.told_alike("rounded")
        words = self.place.facts("rounded/index.html")["words"]
        self.assertNotRegex(json.dumps(words), r"\de-\d")
        self.assertTrue(words["runs"][0]["least"].startswith("touches"), words)

    def test_a_run_whose_input_was_changed_can_be_made_when_that_is_put_back(self):
        self.plan("restored", MIDDLE)
        slim, out = self.place / "slim.off", self.place / "restored/runs/slim/middle/0.1/out.h5"
        sound = slim.read_text()
        slim.write_text(sound.replace("0.3 ", "0.4 "))
        for _ in range(2):
            self.run_tasks("restored", "--all", 3, "put it back")
            self.assertEqual([self.status("restored")["failed"], self.listed("restored")], [1, "0"])
        slim.write_text(sound)
        self.run_tasks("restored")
        self.assertEqual(self.status("restored")["done"], 2)
        out.write_bytes(b"no result")
        self.run_tasks("restored", "--all", 3, "is damaged or no result")
        out.unlink()
        self.run_tasks("restored")

    def test_a_run_whose_model_was_replaced_is_no_longer_clear_and_runs_again(self):
        self.done("outdated", MIDDLE)
        before, slim = self.status("outdated")["outcomes"], self.place / "slim.off"
        sound, out = slim.read_text(), self.place.bytes("outdated/runs/slim/middle/0.1/out.h5")
        slim.write_text(sound.replace("0.3 ", "1.0 "))
        words = "the model file slim.off changed since this run"
        look, _, page = self.told_alike("outdated")
        run = look["list"][0]
        self.assertEqual([look["outdated"], look["outcomes"]["not_done"], run["status"], run["changed"],
                          "verdict" in run, self.listed("outdated")], [1, 1, "outdated", words, False, "0"])
        self.assertIn(words, self.status_text("outdated"))
        self.assertIn(words, page)
        self.run_tasks("outdated", "--all", 3, f"{words}; it runs again", "an input has changed since it was planned")
        look = self.status("outdated")
        self.assertEqual([look["failed"], look["outcomes"]["clear"]], [1, 0])
        for change in (lambda: slim.write_text(sound), slim.touch):
            change()
            self.assertEqual(self.status("outdated")["outdated"], int(change == slim.touch))
            self.run_tasks("outdated")
            self.assertEqual(self.status("outdated")["outcomes"], before)
            self.assertEqual(self.place.bytes("outdated/runs/slim/middle/0.1/out.h5"), out)

    def test_a_route_in_a_folder_of_poses_is_outdated_when_one_of_its_files_is(self):
        for i in range(5):
            self.place.put(f"poses/scan{i:03}.pose", f"0 0 {100 * i}\n0 0 0\n")
        self.done("poses_done", {"routes": {"poses": "poses"}})
        last = self.place / "poses/scan004.pose"
        for change, outdated in ((lambda: None, 0), (lambda: last.write_text("0 0 401\n0 0 0\n"), 2), (last.unlink, 2)):
            change()
            self.assertEqual(self.status("poses_done")["outdated"], outdated)

    def test_options_of_a_run_reach_its_command_line(self):
        self.done("options", {
            "vehicles": {"solid": {"model": "slim.off", "as": "solid"},
                         "points": {"model": "slim.off", "as": "points", "spacing": 0.05}},
            "routes": {"middle": {"trajectory": "middle.txt", "chainage_start": 1000}},
            "outputs": {"report": True, "conflicts": ["csv"]},
            "limits": {"engine": "sweep", "journal_interval": 2.5, "threads": 1}})
        for name, solids in (("solid", 1), ("points", 0)):
            run = json.loads((self.place / f"options/runs/{name}/middle/0.1/run.json").read_text())
            self.assertEqual([run["model_as"], run["model_solids"]], [name, solids])
        plan = (self.place / "options/plan.json").read_text()
        for option in ("--model-as=solid", "--journal-interval=2.5", "--chainage-start=1000"):
            self.assertIn(option, plan)

    def test_an_error_budget_and_seen_space_give_verdicts_and_reasons_also_in_shards(self):
        for name, z in (("above", 6), ("below", -6)):  # from below no beam enters the lane
            self.place.put("origins.csv", f"first,x,y,z\n0,10,0,{z}\n")
            self.place.ask(f"convert scan.xyz --origins origins.csv -o {name}.h5 --cell-points 1000")
        for limits in (LIMITS, {**LIMITS, "shard_seconds": 0.008}):
            name = f"seen{len(limits)}"
            self.plan(name, {
                "environments": {"above": "above.h5", "below": "below.h5"}, "limits": limits,
                "routes": {at: {"trajectory": "middle.txt", "environment": at} for at in ("above", "below")},
                "vehicles.wide": {"model": "wide.off", "as": "solid"},
                "query": {"first_pose": True, "error_scan": 0.005, "error_registration": 0.005, "sigmas": 4,
                          "seen": True, "seen_cube": 0.25, "seen_min": 4}})
            self.run_tasks(name, "--all --fail-on-collision", 1)
            self.assertEqual(bool(self.files(name, "runs/*/*/*/shards/2")), "shard_seconds" in limits)
            self.assertEqual(
                {f"{run['route']}/{run['vehicle']}": (run["verdict"], run["reasons"])
                 for run in self.told_alike(name)[1]["runs"]},
                {"above/slim": ("clear", []), "above/wide": ("conflict", []),
                 "below/slim": ("undecided", ["not-scanned"]), "below/wide": ("conflict", [])})


class Ledgers(Campaigns):
    """Each run keeps its own from epoch to epoch."""

    @classmethod
    def make(cls):
        make_scene(cls.place, vehicles=2, routes=1)
        cls.tables = [f"books/v{i:02}/r00/0.1.csv" for i in range(2)]

    def plan(self, name, *arguments):
        outputs = {"conflicts": ["csv"], "report": True, "ledger": "books", "worse_by": "5cm", "min_points": 1}
        return super().plan(name, {"outputs": outputs}, *arguments)

    def tasks(self, name):
        """What each run says of its ledger, with the rows of its table."""
        return [(task, self.place.rows(table)) for task, table in zip(self.status(name)["list"], self.tables)]

    def test_ledgers_from_epoch_to_epoch(self):
        self.plan("march", 0, "2 ledgers are begun")
        self.assertEqual([self.place.rows(table) for table in self.tables], [[], []])
        self.run_tasks("march", "--all --fail-on-collision", 1)
        for task, rows in self.tasks("march"):
            ledger = task["ledger"]
            self.assertEqual([ledger["new"], ledger["conflicts"], ledger["outside"]], [len(rows)] * 2 + ["conflict"])
            self.assertGreater(len(rows), 1)
        self.assertEqual(self.status("march")["ledgers"]["new"], sum(len(rows) for _, rows in self.tasks("march")))
        for table in self.tables:
            rows = self.place.rows(table)
            with open(self.place / table, "w", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, rows[0])
                writer.writeheader()
                writer.writerows({**row, "status": "accepted"} for row in rows)
        before = self.place.bytes(*self.tables)

        self.plan("april")
        self.run_tasks("april", "--all --jobs 2 --fail-on-collision", 0, "ledgers: ")
        self.assertEqual({task["ledger"]["outside"] for task, _ in self.tasks("april")}, {"clear"})
        self.assertEqual(self.status("april")["outcomes"]["conflict"], 2)  # accepted conflicts are conflicts
        self.assertEqual(self.place.bytes(*self.tables), before)
        self.report("april")
        for text in (self.place.ask("campaign status april").stdout, (self.place / "april/index.html").read_text()):
            self.assertIn(" accepted", text)

        path = (self.place / "routes/r00.txt").read_text().splitlines(keepends=True)
        self.place.put("routes/r00.txt", "".join(path[:len(path) // 2]))  # the rest is not searched
        self.addCleanup(self.place.put, "routes/r00.txt", "".join(path))
        self.plan("may")
        self.run_tasks("may")
        for task, rows in self.tasks("may"):
            facts = self.place.facts(f"may/{task['folder']}/report.html")["ledger"]
            self.assertGreater(facts["not-searched"], 0)
            self.assertEqual([facts["not-searched"], facts["worse"], facts["name"]],
                             [task["ledger"]["not-searched"], 0, "0.1.csv"])
            self.assertEqual({row["status"] for row in rows}, {"accepted"})

        self.place.put(self.tables[0], (self.place / self.tables[0]).read_text().replace("accepted", "acepted"))
        self.plan("broken", 3, "expected new, open, accepted or resolved")
        self.assertFalse((self.place / "broken").exists())
        for table in self.tables:
            (self.place / table).unlink()
            (self.place / table.replace(".csv", ".places.h5")).unlink()
        # Two campaigns at the same time lose no row and add none twice.
        for name in ("one", "two"):
            self.plan(name)
        for process in [self.place.start(f"campaign run {name} --all --jobs 2") for name in ("one", "two")]:
            said = process.communicate()[0]
            self.assertEqual(process.returncode, 0, said)
        for task, rows in self.tasks("one"):
            self.assertEqual([len(rows), len({row["key"] for row in rows})], [task["ledger"]["conflicts"]] * 2)


if __name__ == "__main__":
    unittest.main()
