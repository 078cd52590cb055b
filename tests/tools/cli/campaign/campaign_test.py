"""`clearway campaign`: what it refuses and how it names the key, that plans are stable, what a task
does again and what it does not, exit codes, vehicles of several bodies, and the page.

campaign_test.py PROGRAM
"""

import fcntl
import json
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import time
import unittest

from campaigns import LIMITS, PROGRAM, Campaigns, make_scene, status, tasks_of

OFD_SETLK, WRITE_LOCK = 37, 1  # of Linux
MODEL = "vehicles/v00.ply"
ONE = {"vehicles": {"v00": MODEL}, "routes": {"r00": "routes/r00.txt"}}
NORTH = {"vehicles.truck.model": MODEL, "routes.north.trajectory": "routes/r00.txt"}
KINDS = {  # the keys that take a value of this kind
    "a text": "name vehicles.truck.model vehicles.truck.unit vehicles.truck.as vehicles.truck.forward "
              "routes.north.trajectory routes.north.format routes.north.crs routes.north.environment limits.engine",
    "an object": "environments vehicles routes query outputs limits vehicles.truck",
    "a list": "radii slurm routes.north.angles routes.north.lever_arm query.ignore_classes query.ignore_boxes "
              "outputs.conflicts limits.gpus",
    "a length": "vehicles.truck.spacing routes.north.chainage_start query.clearance query.error_scan outputs.gap "
                "outputs.split",
    "true or false": "vehicles.truck.vertices vehicles.truck.turn routes.north.allow_non_rigid query.first_pose "
                     "query.strict outputs.report",
    "a number": "query.sigmas limits.journal_interval",
    "a whole number": "outputs.min_points limits.threads",
    "bytes as a whole number, or a size": "limits.memory",
    "bytes as a whole number": "limits.device_memory",
    "seconds": "limits.shard_seconds"}
ENTRIES = {  # of lists
    "a whole number": "query.ignore_classes limits.gpus", "a text": "routes.north.angles slurm outputs.conflicts",
    "a length": "routes.north.lever_arm classes radii", "a list": "query.ignore_boxes"}
WAGON = [{"name": 'middle, "low"', "model": "v00.ply", "pivots": [1.05, -1.05]},
         {"name": "front", "model": "v00.ply", "at": 1},
         {"name": "tail", "model": "v00.ply", "towed": {"by": "front", "at": -1, "pivots": [1, -1]}}]


class Plans(Campaigns):
    @classmethod
    def make(cls):
        make_scene(cls.place, vehicles=3, routes=2)
        cls.place.put("vehicles/wagon.json", {"bodies": WAGON})

    def test_a_wrong_key_is_named(self):
        here = self.place.folder
        for changes, message in (
                ({"colour": "red"}, "colour: unknown key; expected one of name,"),
                ({"vehicles.truck": {"model": MODEL, "colour": "red"}}, "vehicles.truck.colour: unknown key"),
                ({"vehicles.truck.unit": "mm"}, "vehicles.truck.model: is missing"),
                ({"vehicles.truck.model": "no.ply"}, f"vehicles.truck.model: {here}/no.ply: there is no such file"),
                ({"vehicles.truck.model": "/dev/null"}, "vehicles.truck.model: /dev/null: is a pipe or device"),
                ({"vehicles.truck": "no*.ply"}, f"vehicles.truck: {here}/no*.ply: no file matches"),
                ({**NORTH, "vehicles.truck.unit": "parsec"}, "vehicles.truck.unit: parsec"),
                ({**NORTH, "vehicles.truck.spacing": -1}, "vehicles.truck.spacing: -1"),
                ({**NORTH, "vehicles.truck.as": "cloud"}, "vehicles.truck.as: "),
                ({**NORTH, "vehicles.truck.turn": True}, "needs forward or up"),
                ({"vehicles.truck": {"model": MODEL, "turn": True, "forward": "z"}}, "same axis"),
                ({"vehicles.v00": MODEL}, "the name v00 is that of vehicles."),
                ({"vehicles.a/b": MODEL}, 'vehicles.a/b: "a/b" cannot name a folder'),
                ({"vehicles.truck.model": "site.h5"}, "vehicles.truck.model: "),
                ({"vehicles.box": "box:1,1"}, "vehicles.box: box:1,1: expected a box"),
                ({"environments.hall": MODEL}, "environments.hall: "),
                ({"environments.hall": "box:1,1,1"}, f"environments.hall: {here}/box:1,1,1: there is no such file"),
                ({**NORTH, "routes.north.environment": "plant"},
                 "routes.north.environment: plant: no environment has that name"),
                ({**NORTH, "routes.north.angles": ["grad"]}, "routes.north.angles: grad: expected deg or rad"),
                ({"radii": [0.1, "zero"]}, "radii[1]: zero: expected"),
                ({"radii": [0.1, 0.1]}, "radii[1]: 0.1 stands twice"),
                ({"radii": []}, "radii: is empty"),
                ({"query.clearance": -0.3}, "query.clearance: -0.3"),
                ({"query": {}}, 'outputs.conflicts: needs "first_pose"'),
                ({"query.ignore_classes": [2, -7]}, "query.ignore_classes[1]: expected a whole number, 0 or more"),
                ({"outputs.conflicts": ["xls"]}, "outputs.conflicts[0]: expected csv"),
                ({"outputs.worse_by": 1}, 'outputs.worse_by: needs "ledger" beside it'),
                ({"outputs": {"ledger": "books"}}, 'outputs.ledger: needs "conflicts" beside it'),
                ({"outputs.ledger": ""}, "outputs.ledger: is empty"),
                ({"outputs.ledger": "books", "outputs.worse_by": -1}, "outputs.worse_by"),
                ({"classes": [0.1, 0.3]}, 'classes: needs "report"'),
                ({"classes": [0.1, 0.3], "outputs": {"report": True}}, "classes: 0.3: needs a clearance"),
                ({"limits.threads": "two"}, "limits.threads: expected a whole number"),
                ({"limits.memory": "much"}, "limits.memory: much"),
                ({"limits.shard_seconds": 0}, "limits.shard_seconds: expected seconds"),
                ({"limits.shard_seconds": -1}, "limits.shard_seconds: expected seconds"),
                ({"limits.shard_seconds": 1, "query.depth": True}, "depths are not found in shards"),
                ({"limits.engine": "kdtree", "vehicles.wagon": "vehicles/wagon.json"}, "expected engine sweep"),
                ({"slurm": ["--array=1"]}, "slurm[0]: --array=1: the script sets it itself")):
            self.refused(changes, message)
        for bodies, code, *words in (([{"name": "a", "model": "none.ply"}], 4, "bodies[0].model", "none.ply"),
                                     ([{**WAGON[0], "at": 1}], 3, "bodies[0]: a body moves in one way")):
            self.place.put("broken.json", {"bodies": bodies})
            self.plan("refused", {"vehicles.wagon": "broken.json"}, code, "campaign.json: vehicles.wagon", *words)

    def test_a_value_of_another_kind_is_named(self):
        for kind, keys in KINDS.items():
            values = [[True], {"a": 1}, None, 1 if kind == "true or false" else True]
            values = [value for value in values if not (kind == "an object" and isinstance(value, dict) or
                                                        kind == "a list" and isinstance(value, list))]
            for number, key in enumerate(keys.split()):
                for value in values[-1:] if number else values:
                    self.refused({**NORTH, key: value}, f"{key}: expected {kind}")
        for kind, keys in ENTRIES.items():
            for key in keys.split():
                self.refused({**NORTH, "outputs": {"report": True}, key: [True]}, f"{key}[0]: expected {kind}")

    def test_what_is_no_campaign_is_refused(self):
        for text, message in (('{"name": "a", "vehicles": {"b": "c", "b": "d"}}', "vehicles.b: stands twice"),
                              ('{"name": ' + 100_000 * "[", "line 1, column 73: lists and objects"),
                              ('{"name": ', "is no JSON: parse error at line 1"),
                              ("[1]", "expected one JSON object")):
            self.place.put("other.json", text)
            self.place.ask("campaign plan other.json -o refused", 3, message)

    def test_files_that_a_pattern_misses_are_named(self):
        """Only files of the kind of those that match, and that nothing else names."""
        for number, (routes, *said) in enumerate((
                ({"all": "routes/*.txt"},), ({"first": "routes/r00.txt"},),
                ({"first": "routes/r00.t*", "rest": "routes/r0[1-9].txt"},),
                ({"first": "routes/r00.t*"}, "routes.first: the pattern matches 1 file", "1 file beside them",
                 "r01.txt"))):
            self.plan(f"missed{number}", {"routes": routes}, 0, *said, lacks=() if said else ["leaves out"])
        shutil.copy(self.place / "routes/r00.txt", self.place / "routes/r09.csv")
        self.addCleanup((self.place / "routes/r09.csv").unlink)
        self.plan("missed", None, 0, "leaves out 1 file beside them of the same kind: r09.csv")

    def test_plans_are_stable(self):
        two = {"radii": [0.1, "25cm"]}
        said = self.plan("stable", two).stdout
        self.assertEqual(said, "Test: 12 tasks (3 vehicles, 2 routes, 2 radii)\n")
        text = (self.place / "stable/plan.json").read_text()
        tasks = json.loads(text)["tasks"]
        self.assertEqual([task["task"] for task in tasks], list(range(12)))
        self.assertEqual([tasks[3]["folder"], tasks[3]["question"]["radius"]], ["runs/v00/r01/25cm", 0.25])
        self.plan("stable", {**two, "slurm": ["--partition=long"]}, 0, "is this plan already")
        self.assertIn("--partition=long", "".join((self.place / "stable" / name).read_text()
                                                  for name in ("campaign.sbatch", "submit.sh")))
        self.report("stable")
        self.assertIn("<h2>Radius 25 cm</h2>", self.shown("stable") or "<h2>Radius 25 cm</h2>")
        self.assertEqual(self.place.facts("stable/index.html")["words"]["radii"]["25cm"], "Radius 25 cm")
        self.plan("stable", None, 2, "--force replaces it")
        self.assertEqual((self.place / "stable/plan.json").read_text(), text)
        self.plan("stable", more="--force")

    def test_finished_tasks_are_left_alone_and_are_those_of_a_user(self):
        self.plan("again")
        self.assertEqual(self.listed("again"), "0-5")
        self.run_tasks("again", "--task 1,4,5")
        self.assertEqual(self.listed("again"), "0,2-3")
        self.run_tasks("again", "--all --jobs 2")
        look = self.status("again")
        self.assertEqual([look["done"], {one["tries"] for one in look["list"]}], [6, {1}])
        before = self.files("again", "**/*")
        said = self.run_tasks("again").stderr
        self.assertRegex(said, "^info: Test: 6 runs: [^\n]*\n$")
        self.assertEqual(self.files("again", "**/*"), before)
        first = self.place / "again/runs/v00/r00/0.1"
        (self.place / "hand").mkdir()
        for command in tasks_of(self.place, "again")[0]["commands"]:
            subprocess.run([PROGRAM, *command], cwd=self.place / "hand", check=True, capture_output=True)
        for name in ("out.h5", "conflicts.csv"):
            self.assertEqual((self.place / "hand" / name).read_bytes(), (first / name).read_bytes(), name)
        row = self.place.rows("hand/conflicts.csv")[0]
        self.assertTrue(row["own_shift_left"] or row["own_shift_right"], row)
        (first / "conflicts.csv").unlink()
        self.assertEqual(self.listed("again"), "0")
        self.run_tasks("again")
        self.assertIn("is the finished result", (first / "log.txt").read_text())

    def test_one_process_at_a_time_runs_a_task(self):
        self.plan("locked", ONE)
        self.run_tasks("locked")
        folder = self.place / "locked/runs/v00/r00/0.1"
        (folder / "conflicts.csv").unlink()
        with open(folder / "lock", "r+b") as lock:
            fcntl.fcntl(lock, OFD_SETLK, struct.pack("hhqqi4x", WRITE_LOCK, 0, 0, 0, 0))
            self.run_tasks("locked", "--task 0", 4, "another process is at work")
            self.assertEqual(self.status("locked")["list"][0]["status"], "running")
        self.assertEqual(self.status("locked")["list"][0]["status"], "interrupted")
        self.run_tasks("locked", "--task 0")

    def test_of_another_question_results_are_made_anew_and_of_other_outputs_only_these(self):
        self.done("changed")
        results = self.files("changed", "runs/*/*/*/out.h5")
        for changes, count, number in (({"outputs.conflicts": ["csv", "json"]}, "interrupted", 6),
                                       ({"query.clearance": 0.2, "query.profile": 0.3}, "missing", 6),
                                       ({**ONE, "vehicles.wagon": "vehicles/wagon.json"}, "missing", 2)):
            self.plan("changed", changes, more="--force")
            self.assertEqual(self.status("changed")[count], number)
            self.run_tasks("changed", "--all --jobs 2")
            self.assertEqual(self.status("changed")["done"], number)
            if count == "interrupted":
                self.assertEqual(self.files("changed", "runs/*/*/*/out.h5"), results)
                self.assertEqual(len(self.files("changed", "runs/*/*/*/conflicts.json")), 6)
        self.place.put("vehicles/wagon.json", {"bodies": WAGON[:1]})
        self.addCleanup(self.place.put, "vehicles/wagon.json", {"bodies": WAGON})
        self.plan("changed", {**ONE, "vehicles.wagon": "vehicles/wagon.json"}, 2, "--force")

    @unittest.skipUnless(shutil.which("strace"), "strace is not installed")
    def test_the_runs_of_a_call_share_the_store_which_is_opened_once(self):
        self.plan("shared")
        self.place.ask("campaign run shared --all",
                       under="strace -f -qq -e trace=openat,clone,clone3 -o calls.txt".split())
        lines = (self.place / "calls.txt").read_text().splitlines()
        parent = lines[0].split()[0]
        opened = {line.split()[0] for line in lines if "site.h5" in line and "O_RDONLY" in line}
        self.assertEqual(opened, {parent})
        started = [line for line in lines if line.startswith(parent) and "CLONE_THREAD" in line]
        self.assertEqual(started, [], "the parent of the runs has started a thread")

    def test_failed_tasks_and_their_page(self):
        broken = self.place / "vehicles/v02.ply"
        sound = broken.read_bytes()
        self.addCleanup(broken.write_bytes, sound)
        self.plan("failures", {"radii": [0.2]})
        broken.write_bytes(sound[:-50])
        self.run_tasks("failures", "--all --jobs 2", 3)
        look = self.status("failures")
        failed = look["list"][4]
        self.assertEqual([look["done"], look["failed"], failed["exit_code"], failed["tries"]], [4, 2, 3, 1])
        self.assertIn("v02.ply", failed["message"])
        self.assertEqual([self.listed("failures", "failed"), self.listed("failures")], ["4-5", ""])
        broken.write_bytes(sound.replace(b"element vertex 300", b"element vertex 299"))
        self.run_tasks("failures", "--task 4", 3)  # not of the planned question
        self.assertEqual(self.status("failures")["list"][4]["status"], "failed")

        said = self.place.ask("campaign report failures --date today").stdout
        text = (self.place / "failures/index.html").read_text()
        facts = self.report("failures")
        shown = self.shown("failures") or 2 * '<td class="failed"'
        self.assertEqual([said, shown.count('<td class="failed"')], ["", 2])
        self.assertIn("Of 6 runs 4 find a conflict and 2 have failed.", text)
        self.assertNotIn("http", text.replace("http-equiv", "").replace("http://www.w3.org/2000/svg", ""))
        self.assertEqual([facts["conflict"], facts["failed"], facts["clear"]], [4, 2, 0])
        self.assertEqual(self.place.facts("failures/index.html")["runs"], facts["runs"])
        run = json.loads((self.place / "failures/runs/v00/r00/0.2/run.json").read_text())
        self.assertEqual(facts["runs"][0]["colliding_points"], run["colliding_points"])
        for link in re.findall(r'href="([^"]*)"', shown):
            self.assertTrue((self.place / "failures" / link).exists(), f"{link}: a link leads nowhere")

    def test_a_page_before_and_after_the_first_run(self):
        self.plan("new", {"outputs": {"report": True, "conflicts": ["bcf"], "min_points": 5},
                          "query.clearance": 0.3, "classes": ["5cm", 0.1, 0.3]})
        self.place.ask("campaign report new")
        text = (self.place / "new/index.html").read_text()
        self.assertIn("Of 6 runs 6 are not done.", text)
        self.assertNotIn('<td class="clear"', self.shown("new") or "")
        self.place.ask("campaign report new", 2)
        self.run_tasks("new", "--task 1")
        facts = self.report("new")
        run = facts["runs"][1]
        self.assertEqual([run["page"], facts["not_done"]], ["runs/v00/r01/0.1/report.html", 5])
        self.assertLess(run["least"]["distance"], 0.3)
        self.assertGreater(run["conflicts"]["count"], 0)  # whatever files have them
        self.assertIn("Test: v00 on r01", (self.place / "new" / run["page"]).read_text())
        self.assertTrue((self.place / "new/runs/v00/r01/0.1/conflicts.bcf").exists())

    def test_a_question_that_leaves_the_corridor_of_its_store_fails_with_what_would_do(self):
        self.place.ask("convert environment.las --cell-points 1000 --near trajectory.txt --within 3 -o near.h5")
        self.plan("corridor", {**ONE, "environments": {"near": "near.h5"}, "radii": [0.1, 30]})
        self.run_tasks("corridor", "--all", 3)
        held, beyond = self.status("corridor")["list"]
        self.assertEqual([held["status"], beyond["status"]], ["done", "failed"])
        self.assertRegex(beyond["message"], r"within 3 m of a path.*--within 32\.")
        self.done("whole", ONE)
        self.assertEqual(*self.place.bytes("corridor/runs/v00/r00/0.1/conflicts.csv",
                                           "whole/runs/v00/r00/0.1/conflicts.csv"))

    def start(self, name):
        """A campaign at work, and the file with the numbers of its tasks' processes."""
        self.plan(name)
        process = self.place.start(f"campaign run {name} --all")
        return process, pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")

    def test_term_ends_the_tasks_and_the_others_are_missing(self):
        process, children = self.start("stopped")
        while not children.read_text() and process.poll() is None:
            time.sleep(0.001)
        process.send_signal(signal.SIGTERM)
        said = process.communicate()[0]
        self.assertEqual(process.returncode, 5, said)
        look = self.status("stopped")
        self.assertEqual([look["running"], look["failed"], look["missing"] > 0], [0, 0, True], look)
        self.run_tasks("stopped")
        self.assertEqual(self.status("stopped")["done"], 6)

    def test_a_task_that_is_killed_is_tried_three_times_and_one_that_crashes_once(self):
        for which, tries, code in ((signal.SIGKILL, 3, 4), (signal.SIGSEGV, 1, 128 + signal.SIGSEGV)):
            process, children = self.start(which.name)
            while process.poll() is None:
                try:
                    for child in map(int, children.read_text().split()):
                        os.kill(child, which)
                except (FileNotFoundError, ProcessLookupError):
                    pass
                time.sleep(0.001)
            process.communicate()
            self.assertEqual(process.returncode, code)
            failed = {(one["tries"], one["exit_code"]) for one in status(self.place, which.name)["list"]
                      if one["status"] == "failed"}
            self.assertEqual(failed, {(tries, code)})
            self.assertEqual(self.listed(which.name, "failed") == "", which == signal.SIGKILL)

    def test_misuse(self):
        self.plan("misuse")
        for words, code, said in (("run misuse", 2, "--all"), ("run misuse --task 6", 2, "tasks 0 to 5"),
                                  ("run misuse --task 5-3", 2, "such as 3,7-9"),
                                  ("run misuse --task ''", 0, "nothing to do"),
                                  ("status .", 2, "holds no campaign")):
            self.place.ask(f"campaign {words}", code, said)
        self.place.put("misuse/plan.json", (self.place / "misuse/plan.json").read_text()[:-20])
        self.place.ask("campaign status misuse", 3, "is damaged")

    def test_the_runs_of_a_vehicle_are_those_of_the_program_also_in_shards(self):
        wagon = {**ONE, "vehicles": {"wagon": "vehicles/wagon.json", "car": MODEL}}
        self.done("vehicle", {**wagon, "outputs": {"conflicts": ["csv", "bcf"], "report": True}})
        inputs = "--vehicle vehicles/wagon.json --trajectory routes/r00.txt"
        self.place.ask(f"run --env site.h5 {inputs} --radius 0.1 --first-pose -o out.h5")
        self.place.ask(f"conflicts out.h5 {inputs} -o conflicts.csv")
        self.done("divided", {**wagon, "limits": {**LIMITS, "shard_seconds": 0.03}})
        self.assertGreater(sum(task["vehicle"] == "wagon" for task in tasks_of(self.place, "divided")), 2)
        for name in ("out.h5", "conflicts.csv"):
            run, whole, divided = self.place.bytes(name, *(f"{path}/runs/wagon/r00/0.1/{name}"
                                                           for path in ("vehicle", "divided")))
            self.assertTrue(run == whole == divided, name)
        rows = self.place.rows("conflicts.csv")
        self.assertIn(rows[0]["body_name"], ('middle, "low"', "front", "tail"))
        self.assertNotIn("unknown", {row["side"] for row in rows})
        page = (self.place / "vehicle/runs/wagon/r00/0.1/report.html").read_text()
        self.assertIn('"name":"middle, \\"low', page)
        facts = self.report("vehicle")
        self.assertEqual([facts["not_done"], facts["conflict"] > 0], [0, True])

    def test_models_may_be_boxes_or_have_other_axes(self):
        """A wedge, and the same with its y axis ahead, so that its x axis points to the right."""
        points = [(x / 10, y / 10, z / 5) for x in range(9) for y in range(-4, 5) for z in range(4) if x + y > 0]
        self.place.put("ahead_x.xyz", "".join(f"{x} {y} {z}\n" for x, y, z in points))
        self.place.put("ahead_y.xyz", "".join(f"{-y} {x} {z}\n" for x, y, z in points))
        self.place.put("boxes.json", {"bodies": [{"name": "a", "model": "box:0.4,0.3,0.3"}]})
        self.done("models", {**ONE, "outputs.report": True, "vehicles": {
            "turned": {"model": "ahead_y.xyz", "forward": "+y", "turn": True}, "upright": "ahead_x.xyz",
            "box": "box:0.4,0.3,0.3", "bodies": "boxes.json",
            "a long one": {"model": "box:0.4,0.3,0.3", "spacing": 0.05, "as": "points"}}})
        self.place.ask("compare " + " ".join(f"models/runs/{name}/r00/0.1/out.h5" for name in ("turned", "upright")))
        one, other = self.place.bytes(*(f"models/runs/{name}/r00/0.1/conflicts.csv" for name in ("turned", "upright")))
        self.assertEqual([one, len(one) > 100], [other, True])
        self.assertEqual(len(self.files("models", "runs/*/r00/0.1/report.html")), 5)
        self.report("models")
        self.assertIn('"runs/a%20long%20one/r00/0.1/report.html"', (self.place / "models/index.html").read_text())


if __name__ == "__main__":
    unittest.main()
