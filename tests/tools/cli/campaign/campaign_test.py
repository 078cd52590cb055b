"""`clearway campaign`: what it refuses and how it names the key, that plans are stable, what a task
does again and what it does not, exit codes, and the page.

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
import tempfile
import time

from campaign_scene import PROGRAM, expect, make_scene, outcome, program, status, write_campaign

OFD_SETLK, WRITE_LOCK, UNLOCK = 37, 1, 2  # of Linux


class Test:
    def __init__(self, work):
        self.work = work
        make_scene(work, vehicles=3, routes=2)
        self.path = work / "out"

    def plan(self, *options, path=None, **changes):
        return outcome("campaign", "plan", write_campaign(self.work, **changes), "-o",
                       path or self.path, *options)

    def refused(self, message, **changes):
        done = self.plan(path=self.work / "refused", **changes)
        expect(done.returncode == 3 and message in done.stderr,
               f"{changes}: expected 3 and {message}: {done.returncode}: {done.stderr}")
        expect(not (self.work / "refused").exists(), "a refused plan was written")


def files_that_a_pattern_misses_are_named(test):
    """Only files of the kind of those that match, and that nothing else names."""
    for routes, missed in (({"all": "routes/*.txt"}, ""),
                           ({"first": "routes/r00.t*"}, "1 file beside them"),
                           ({"first": "routes/r00.t*", "rest": "routes/r0[1-9].txt"}, ""),
                           ({"first": "routes/r00.txt"}, "")):
        done = test.plan(path=test.work / "missed", routes=routes)
        expect(done.returncode == 0, f"{routes}: {done.stderr}")
        expect((missed in done.stderr) if missed else ("leaves out" not in done.stderr),
               f"{routes}: {done.stderr}")
        if missed:
            expect("routes.first: the pattern matches 1 file" in done.stderr
                   and "r01.txt" in done.stderr, done.stderr)
        shutil.rmtree(test.work / "missed")
    other = test.work / "routes/r09.csv"
    shutil.copy(test.work / "routes/r00.txt", other)
    done = test.plan(path=test.work / "missed", routes={"all": "routes/*.txt"})
    expect("leaves out 1 file beside them of the same kind: r09.csv" in done.stderr, done.stderr)
    other.unlink()
    shutil.rmtree(test.work / "missed")


def errors_name_the_key(test):
    model = "vehicles/v00.ply"
    test.refused("colour: unknown key; expected one of name,", colour="red")
    test.refused("vehicles.truck.colour: unknown key",
                 vehicles={"truck": {"model": model, "colour": "red"}})
    test.refused("vehicles.truck.model: is missing", vehicles={"truck": {"unit": "mm"}})
    test.refused("vehicles.truck.model: " + str(test.work / "no.ply") + ": there is no such file",
                 vehicles={"truck": {"model": "no.ply"}})
    test.refused("vehicles.truck.model: /dev/null: is a pipe or device",
                 vehicles={"truck": {"model": "/dev/null"}})
    test.refused("vehicles.truck: " + str(test.work / "no*.ply") + ": no file matches",
                 vehicles={"truck": "no*.ply"})
    test.refused("vehicles.truck.unit: parsec", vehicles={"truck": {"model": model,
                                                                    "unit": "parsec"}})
    test.refused("vehicles.truck.spacing: -1", vehicles={"truck": {"model": model,
                                                                   "spacing": -1}})
    test.refused("vehicles.truck.spacing: expected a length",
                 vehicles={"truck": {"model": model, "spacing": True}})
    test.refused("vehicles.all: the name v00 is that of vehicles.v00 too",
                 vehicles={"v00": model, "all": "vehicles/*.ply"})
    test.refused("vehicles.a/b: \"a/b\" cannot name a folder", vehicles={"a/b": model})
    test.refused("vehicles.truck.model: ", vehicles={"truck": {"model": "site.h5"}})
    test.refused("environments.hall: ", environments={"hall": model})
    test.refused("routes.north.environment: plant: no environment has that name",
                 routes={"north": {"trajectory": "routes/r00.txt", "environment": "plant"}})
    test.refused("routes.north.angles: grad: expected deg or rad",
                 routes={"north": {"trajectory": "routes/r00.txt", "angles": ["grad"]}})
    test.refused("radii[1]: zero: expected", radii=[0.1, "zero"])
    test.refused("radii[1]: 0.1 stands twice", radii=[0.1, 0.1])
    test.refused("radii: is empty", radii=[])
    test.refused("query.first_pose: expected true or false", query={"first_pose": 1})
    test.refused("query.clearance: -0.3", query={"first_pose": True, "clearance": -0.3})
    test.refused("outputs.conflicts: needs \"first_pose\"", query={})
    test.refused("outputs.conflicts[0]: expected csv", outputs={"conflicts": ["xls"]})
    test.refused("classes: needs \"report\"", classes=[0.1, 0.3])
    test.refused("classes: 0.3: needs a clearance", classes=[0.1, 0.3], outputs={"report": True})
    test.refused("limits.threads: expected a whole number", limits={"threads": "two"})
    test.refused("limits.memory: much", limits={"memory": "much"})
    tried = set()
    for key, kinds in {
            "name": "a text", "environments": "an object", "vehicles": "an object",
            "routes": "an object", "radii": "a list", "query": "an object", "slurm": "a list",
            "outputs": "an object", "limits": "an object",
            "vehicles.truck": "an object", "vehicles.truck.model": "a text",
            "vehicles.truck.unit": "a text", "vehicles.truck.spacing": "a length",
            "vehicles.truck.vertices": "true or false",
            "vehicles.truck.as": "a text", "vehicles.truck.forward": "a text",
            "vehicles.truck.turn": "true or false",
            "routes.north.trajectory": "a text", "routes.north.format": "a text",
            "routes.north.allow_non_rigid": "true or false", "routes.north.angles": "a list",
            "routes.north.lever_arm": "a list", "routes.north.chainage_start": "a length",
            "routes.north.crs": "a text", "routes.north.environment": "a text",
            "query.first_pose": "true or false", "query.clearance": "a length",
            "query.sigmas": "a number", "query.strict": "true or false",
            "query.ignore_classes": "a list", "query.ignore_boxes": "a list",
            "query.error_scan": "a length",
            "outputs.conflicts": "a list", "outputs.report": "true or false",
            "outputs.gap": "a length", "outputs.min_points": "a whole number",
            "outputs.split": "a length", "limits.memory": "bytes as a whole number, or a size",
            "limits.threads": "a whole number", "limits.engine": "a text",
            "limits.gpus": "a list", "limits.device_memory": "bytes as a whole number",
            "limits.shard_seconds": "seconds", "limits.journal_interval": "a number"}.items():
        all_wrong = [[True], {"a": 1}, None] + ([1] if kinds == "true or false" else [True])
        if kinds in tried:  # every wrong value for the first key of a kind, one for the others
            all_wrong = all_wrong[-1:]
        tried.add(kinds)
        for wrong in all_wrong:
            if kinds == "an object" and isinstance(wrong, dict) or (
                    kinds == "a list" and isinstance(wrong, list)):
                continue
            if key in ("vehicles.truck", "query.ignore_boxes") and wrong == [True]:
                continue
            first, *rest = key.split(".")
            changes = {"vehicles": {"truck": {"model": model}},
                       "routes": {"north": {"trajectory": "routes/r00.txt"}}}
            at, name = changes, first
            for name_below in rest:
                at, name = at.setdefault(name, {}), name_below
            at[name] = wrong
            test.refused(f"{key}: expected {kinds}", **changes)
    for key, entries in {"query.ignore_classes": "a whole number", "limits.gpus": "a whole number",
                         "routes.north.angles": "a text", "routes.north.lever_arm": "a length",
                         "classes": "a length", "query.ignore_boxes": "a list",
                         "radii": "a length", "slurm": "a text",
                         "outputs.conflicts": "a text"}.items():
        first, *rest = key.split(".")
        changes = {"vehicles": {"truck": {"model": model}},
                   "routes": {"north": {"trajectory": "routes/r00.txt"}},
                   "outputs": {"report": True}}
        at, name = changes, first
        for name_below in rest:
            at, name = at.setdefault(name, {}), name_below
        at[name] = [True]
        test.refused(f"{key}[0]: expected {entries}", **changes)
    test.refused("query.ignore_classes[1]: expected a whole number, 0 or more",
                 query={"ignore_classes": [2, -7]})
    test.refused("slurm[0]: --array=1: the script sets it itself", slurm=["--array=1"])
    file = test.work / "campaign.json"
    for text, message in [('{"name": "a", "vehicles": {"b": "c", "b": "d"}}',
                           "vehicles.b: stands twice"),
                          ('{"name": ' + 100_000 * "[", "line 1, column 73: lists and objects"),
                          ('{"name": ', "is no JSON: parse error at line 1"),
                          ("[1]", "expected one JSON object")]:
        file.write_text(text)
        done = outcome("campaign", "plan", file, "-o", test.work / "refused")
        expect(done.returncode == 3 and message in done.stderr, f"{text}: {done.stderr}")


def plans_are_stable(test):
    done = test.plan(radii=[0.1, "25cm"])
    expect(done.stdout == "Test: 12 tasks (3 vehicles, 2 routes, 2 radii)\n",
           done.stdout + done.stderr)
    text = (test.path / "plan.json").read_text()
    tasks = json.loads(text)["tasks"]
    expect([task["task"] for task in tasks] == list(range(12)), "numbers")
    expect(tasks[3]["folder"] == "runs/v00/r01/25cm", tasks[3]["folder"])
    expect(tasks[3]["question"]["radius"] == 0.25, "a radius with a unit")
    again = test.plan(radii=[0.1, "25cm"])
    expect(again.returncode == 0 and "is this plan already" in again.stderr, again.stderr)
    expect((test.path / "plan.json").read_text() == text, "another plan of the same inputs")
    program("campaign", "report", test.path, "--force")
    expect("<h2>Radius 25 cm</h2>" in (test.path / "index.html").read_text(), "a blank before a unit")
    other = test.plan()
    expect(other.returncode == 2 and "--force replaces it" in other.stderr, other.stderr)
    expect((test.path / "plan.json").read_text() == text, "a refused plan was written")
    expect(test.plan("--force").returncode == 0, "--force")


def by_hand(test):
    """The commands of the plan are those of a user."""
    task = json.loads((test.path / "plan.json").read_text())["tasks"][0]
    (test.work / "hand").mkdir()
    for command in task["commands"]:
        done = outcome(*command, cwd=test.work / "hand")
        expect(done.returncode == 0, done.stderr)
    for name in ["out.h5", "conflicts.csv"]:
        expect((test.work / "hand" / name).read_bytes() ==
               (test.path / task["folder"] / name).read_bytes(), name + " by hand differs")


def tasks_are_idempotent(test):
    expect(program("campaign", "status", test.path, "--missing") == "0-5\n", "before")
    expect(outcome("campaign", "run", test.path, "--task", "1,4-5").returncode == 0, "run")
    expect(program("campaign", "status", test.path, "--missing") == "0,2-3\n", "after three")
    expect(outcome("campaign", "run", test.path, "--all", "--jobs", "2").returncode == 0, "--all")
    look = status(test.path)
    expect(look["done"] == 6 and all(one["tries"] == 1 for one in look["list"]), f"{look}")
    files = {file: file.stat().st_mtime_ns for file in test.path.rglob("*")}
    done = outcome("campaign", "run", test.path, "--all")
    expect(done.returncode == 0 and done.stderr.startswith("info: Test: 6 runs: ") and
           done.stderr.count("\n") == 1, done.stderr)
    expect(files == {file: file.stat().st_mtime_ns for file in test.path.rglob("*")},
           "finished tasks wrote something")
    (test.path / "runs/v00/r00/0.1/conflicts.csv").unlink()
    expect(program("campaign", "status", test.path, "--missing") == "0\n", "an output is gone")
    expect(outcome("campaign", "run", test.path, "--all").returncode == 0, "again")
    expect("is the finished result" in (test.path / "runs/v00/r00/0.1/log.txt").read_text(),
           "the result was searched again")


def conflicts_are_those_of_a_single_run(test):
    """With the shifts, for which a single command needs the model."""
    folder = test.path / "runs/v00/r00/0.1"
    program("conflicts", folder / "out.h5", "--model", test.work / "vehicles/v00.ply",
            "--trajectory", test.work / "routes/r00.txt", "-o", test.work / "single.csv")
    table = (folder / "conflicts.csv").read_bytes()
    expect(table == (test.work / "single.csv").read_bytes(), "other conflicts")
    head, first = [line.split(",") for line in table.decode().splitlines()[:2]]
    expect(any(dict(zip(head, first))[name] for name in ("own_shift_left", "own_shift_right")), f"{first}")


def boxes_need_no_file(test):
    (test.work / "boxes.json").write_text(json.dumps(
        {"bodies": [{"name": "a", "model": "box:0.4,0.3,0.3"}]}))
    path = test.work / "boxes"
    done = test.plan(path=path, vehicles={"box": "box:0.4,0.3,0.3", "bodies": "boxes.json",
                                          "long": {"model": "box:0.4,0.3,0.3", "spacing": 0.05,
                                                   "as": "points"}},
                     outputs={"conflicts": ["csv"], "report": True}, routes={"a": "routes/r00.txt"})
    expect(done.returncode == 0, done.stderr)
    done = outcome("campaign", "run", path, "--all")
    expect(done.returncode == 0, done.stderr)
    for name in ("box", "bodies", "long"):
        expect((path / f"runs/{name}/a/0.1/report.html").exists(), name)
    test.refused("environments.hall: " + str(test.work / "box:1,1,1") + ": there is no such file",
                 environments={"hall": "box:1,1,1"})
    test.refused("vehicles.box: box:1,1: expected a box", vehicles={"box": "box:1,1"})


def one_at_a_time(test):
    folder = test.path / "runs/v01/r00/0.1"
    (folder / "conflicts.csv").unlink()
    with open(folder / "lock", "r+b") as lock:
        lock_whole = struct.pack("hhqqi4x", WRITE_LOCK, 0, 0, 0, 0)
        fcntl.fcntl(lock, OFD_SETLK, lock_whole)
        done = outcome("campaign", "run", test.path, "--task", "2")
        expect(done.returncode == 4 and "another process is at work" in done.stderr, done.stderr)
        expect(status(test.path)["list"][2]["status"] == "running", "a lock is held")
    expect(status(test.path)["list"][2]["status"] == "interrupted", "the lock is free")
    expect(outcome("campaign", "run", test.path, "--task", "2").returncode == 0, "then")


def new_plans_keep_results(test):
    """Of another question results are made anew; of other outputs only these."""
    results = {file: file.stat().st_ino for file in test.path.glob("runs/*/*/*/out.h5")}
    test.plan("--force", outputs={"conflicts": ["csv", "json"]})
    expect(status(test.path)["interrupted"] == 6, "an output is missing everywhere")
    expect(outcome("campaign", "run", test.path, "--all").returncode == 0, "outputs")
    expect(results == {file: file.stat().st_ino for file in results}, "results were made again")
    expect(len(list(test.path.glob("runs/*/*/*/conflicts.json"))) == 6, "no new outputs")
    test.plan("--force", query={"first_pose": True, "clearance": 0.2, "profile": 0.3})
    expect(status(test.path)["missing"] == 6, "the question is another one")
    expect(outcome("campaign", "run", test.path, "--all", "--jobs", "2").returncode == 0, "anew")
    expect(status(test.path)["done"] == 6, "not all are done")


def stores_are_opened_once(test):
    """The runs of one call share the store that the first of them needs, and give the same bytes."""
    results = {file: file.read_bytes() for file in test.path.glob("runs/*/*/*/out.h5")}
    for file in results:
        file.unlink()
    if shutil.which("strace") is None:
        print("strace is not installed, so nobody counts how often the store is opened")
        expect(outcome("campaign", "run", test.path, "--all").returncode == 0, "anew")
    else:
        calls = test.work / "calls.txt"
        done = subprocess.run(["strace", "-f", "-qq", "-e", "trace=openat,clone,clone3", "-o", calls,
                               PROGRAM, "campaign", "run", test.path, "--all"],
                              stderr=subprocess.PIPE, text=True)
        expect(done.returncode == 0, done.stderr)
        lines = calls.read_text().splitlines()
        parent = lines[0].split()[0]
        opened = [line.split()[0] for line in lines if "site.h5" in line and "O_RDONLY" in line]
        expect(opened and set(opened) == {parent}, f"the store is opened by {set(opened)}")
        started = [line for line in lines if line.startswith(parent) and "CLONE_THREAD" in line]
        expect(not started, "the parent of the runs has started a thread")
    expect(results == {file: file.read_bytes() for file in results}, "other bytes")


def failures(test):
    model = test.work / "vehicles/v02.ply"
    sound = model.read_bytes()
    test.plan("--force", radii=[0.2])
    model.write_bytes(sound[:-50])
    done = outcome("campaign", "run", test.path, "--all", "--jobs", "2")
    expect(done.returncode == 3, f"exit code {done.returncode}")
    look = status(test.path)
    expect(look["done"] == 4 and look["failed"] == 2, f"{look}")
    expect(look["list"][4]["exit_code"] == 3 and "v02.ply" in look["list"][4]["message"] and
           look["list"][4]["tries"] == 1, f"{look['list'][4]}")
    expect(program("campaign", "status", test.path, "--failed") == "4-5\n", "--failed")
    expect(program("campaign", "status", test.path, "--missing") == "", "--missing")
    model.write_bytes(sound.replace(b"element vertex 300", b"element vertex 299")[:len(sound)])
    done = outcome("campaign", "run", test.path, "--task", "4")
    expect(done.returncode == 3, "a changed input gave a result")
    expect(status(test.path)["list"][4]["status"] == "failed", "not of the planned question")
    model.write_bytes(sound)


def stores_near_a_path(test):
    """A question that the corridor holds has the rows of the whole store, and one that reaches beyond
    it fails with the distance that would do."""
    near = test.work / "near.h5"
    program("convert", test.work / "hall/environment.las", "--cell-points", 1000, "--near",
            test.work / "hall/trajectory.txt", "--within", 3, "-o", near)
    path = test.work / "corridor"
    test.plan(path=path, environments={"near": "near.h5"}, vehicles={"v00": "vehicles/v00.ply"},
              routes={"r00": "routes/r00.txt"}, radii=[0.1, 30])
    done = outcome("campaign", "run", path, "--all")
    expect(done.returncode == 3, f"exit code {done.returncode}: {done.stderr}")
    held, beyond = status(path)["list"]
    expect(held["status"] == "done" and beyond["status"] == "failed", f"{held}, {beyond}")
    expect("within 3 m of a path" in beyond["message"] and "--within 32." in beyond["message"], beyond["message"])
    whole = test.work / "whole.h5"
    program("run", "--env", test.work / "site.h5", "--model", test.work / "vehicles/v00.ply",
            "--trajectory", test.work / "routes/r00.txt", "--radius", 0.1, "--first-pose", "-o", whole)
    program("conflicts", whole, "--model", test.work / "vehicles/v00.ply", "--trajectory",
            test.work / "routes/r00.txt", "-o", test.work / "whole.csv")
    expect((path / "runs/v00/r00/0.1/conflicts.csv").read_bytes() ==
           (test.work / "whole.csv").read_bytes(), "other conflicts than those of the whole store")


def signals(test):
    """TERM ends the tasks, and the campaign with 5; those that had not begun are missing."""
    path = test.work / "stopped"
    test.plan(path=path)
    process = subprocess.Popen([PROGRAM, "campaign", "run", path, "--all"],
                               stderr=subprocess.PIPE, text=True)
    children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
    while not children.read_text() and process.poll() is None:
        time.sleep(0.001)
    process.send_signal(signal.SIGTERM)
    said = process.communicate()[1]
    expect(process.returncode == 5, f"exit code {process.returncode}: {said}")
    look = status(path)
    expect(look["running"] == 0 and look["failed"] == 0 and look["missing"] > 0, f"{look}")
    done = outcome("campaign", "run", path, "--all")
    expect(done.returncode == 0 and status(path)["done"] == 6, done.stderr)


def crashes(test):
    """A task that is killed is tried again, at most twice; one that crashes is not."""
    for which, tries, code in [("KILL", 3, 4), ("SEGV", 1, 128 + signal.SIGSEGV)]:
        path = test.work / which
        test.plan(path=path)
        process = subprocess.Popen([PROGRAM, "campaign", "run", path, "--all"],
                                   stderr=subprocess.PIPE, text=True)
        children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
        while process.poll() is None:
            try:
                for child in map(int, children.read_text().split()):
                    os.kill(child, getattr(signal, "SIG" + which))
            except (FileNotFoundError, ProcessLookupError):
                pass
            time.sleep(0.001)
        expect(process.returncode == code, f"{which}: exit code {process.returncode}")
        failed = [one for one in status(path)["list"] if one["status"] == "failed"]
        expect(failed and all(one["tries"] == tries and one["exit_code"] == code
                              for one in failed), f"{which}: {failed}")
        expect((program("campaign", "status", path, "--failed") == "") == (which == "KILL"),
               "a crash is tried again")


def page(test):
    expect(program("campaign", "report", test.path, "--date", "today", "--force") == "", "report")
    text = (test.path / "index.html").read_text()
    expect(text.count("<td class=\"failed\"") == 2, "failed cells")
    expect(re.search(r"Of 6 runs 4 find a conflict and 2 have failed\.", text), "answer")
    expect("http" not in re.sub(r"http-equiv", "", text), "the page needs a network")
    facts = json.loads(program("campaign", "report", test.path, "--force", "--json"))
    expect(facts["conflict"] == 4 and facts["failed"] == 2 and facts["clear"] == 0, f"{facts}")
    embedded = json.loads(re.search(r'id="facts">(.*)</script>', text)[1])
    expect(embedded["runs"] == facts["runs"], "the facts on the page")
    points = json.loads((test.path / "runs/v00/r00/0.2/run.json").read_text())
    expect(facts["runs"][0]["colliding_points"] == points["colliding_points"], "points")
    for link in re.findall(r'href="([^"]*)"', text):
        expect((test.path / link).exists(), link + ": a link leads nowhere")
    test.plan(path=test.work / "new", radii=[0.1], outputs={"report": True, "conflicts": ["bcf"], "min_points": 5},
              query={"first_pose": True, "clearance": 0.3}, classes=["5cm", 0.1, 0.3])
    program("campaign", "report", test.work / "new")
    text = (test.work / "new/index.html").read_text()
    expect("Of 6 runs 6 are not done." in text, "nothing is done")
    expect("<td class=\"clear\"" not in text, "a missing run is shown as clear")
    expect(outcome("campaign", "report", test.work / "new").returncode == 2, "a page is there")
    expect(outcome("campaign", "run", test.work / "new", "--task", "1").returncode == 0, "task 1")
    facts = json.loads(program("campaign", "report", test.work / "new", "--force", "--json"))
    run = facts["runs"][1]
    expect(run["page"] == "runs/v00/r01/0.1/report.html" and facts["not_done"] == 5, f"{facts}")
    expect("Test: v00 on r01" in (test.work / "new" / run["page"]).read_text(), "its title")
    expect((test.work / "new/runs/v00/r01/0.1/conflicts.bcf").exists(), "BCF")
    expect(run["least"]["distance"] < 0.3, f"{run}")


def misuse(test):
    done = outcome("campaign", "run", test.path)
    expect(done.returncode == 2 and "--all" in done.stderr, done.stderr)
    done = outcome("campaign", "run", test.path, "--task", "6")
    expect(done.returncode == 2 and "tasks 0 to 5" in done.stderr, done.stderr)
    done = outcome("campaign", "run", test.path, "--task", "5-3")
    expect(done.returncode == 2 and "such as 3,7-9" in done.stderr, done.stderr)
    done = outcome("campaign", "status", test.work)
    expect(done.returncode == 2 and "holds no campaign" in done.stderr, done.stderr)
    plan = test.path / "plan.json"
    sound = plan.read_text()
    plan.write_text(sound[:-20])
    done = outcome("campaign", "status", test.path)
    expect(done.returncode == 3 and "is damaged" in done.stderr, done.stderr)
    plan.write_text(sound)


def main():
    with tempfile.TemporaryDirectory() as folder:
        test = Test(pathlib.Path(folder))
        for check in [errors_name_the_key, files_that_a_pattern_misses_are_named, plans_are_stable,
                      tasks_are_idempotent, by_hand, stores_near_a_path,
                      conflicts_are_those_of_a_single_run, boxes_need_no_file, one_at_a_time, new_plans_keep_results, stores_are_opened_once, failures, signals, crashes, page, misuse]:
            begin = time.monotonic()
            check(test)
            print(f"{check.__name__}: {time.monotonic() - begin:.1f} s", flush=True)


main()
