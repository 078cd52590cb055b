"""Campaigns whose runs are divided into shards: their tasks, the order of the work, what a shard
that fails does to its run, and results as of runs that are not divided.

divided_test.py PROGRAM
"""

import json
import pathlib
import tempfile
import time

from campaign_scene import expect, make_scene, outcome, program, status, write_campaign

LIMITS = {"memory": "300M", "threads": 1}
DIVIDED = {**LIMITS, "shard_seconds": 0.03}


class Test:
    def __init__(self, work):
        self.work = work
        make_scene(work, vehicles=2, routes=1)
        self.path = work / "divided"
        plan(self, "divided", DIVIDED)
        self.tasks = [json.loads(line.rstrip(",")) for line in
                      (self.path / "plan.json").read_text().splitlines()[1:-1]]
        self.merge = self.tasks[0]["shard"][1]  # the number of the first one
        self.last = len(self.tasks) - 1


def plan(test, name, limits, **changes):
    return outcome("campaign", "plan", write_campaign(test.work, limits=limits, **changes), "-o",
                   test.work / name)


def run(test, *words):
    return outcome("campaign", "run", test.path, *words)


def plan_has_shards_and_merges(test):
    merge = test.tasks[test.merge]
    expect(merge["shards"] == test.merge > 1, f"{merge}")
    expect(len(test.tasks) == 2 * (test.merge + 1), f"{len(test.tasks)} tasks")
    expect(merge["commands"][0][0] == "merge" and merge["commands"][1][0] == "run", f"{merge}")
    expect(test.tasks[1]["folder"] == merge["folder"] + "/shards/2", f"{test.tasks[1]}")
    for seconds in [0, -1, "long"]:
        done = plan(test, "refused", {**LIMITS, "shard_seconds": seconds})
        expect(done.returncode == 3 and "limits.shard_seconds: expected seconds" in done.stderr,
               done.stderr)
    expect(plan(test, "divided", DIVIDED).returncode == 0, "the same plan again")
    long_enough = plan(test, "long", {**LIMITS, "shard_seconds": 1000})
    expect("2 tasks" in long_enough.stdout, long_enough.stdout)


def merge_waits(test):
    done = run(test, "--task", test.merge)
    expect(done.returncode == 4 and "waits for v00/r00/0.1/shards/1" in done.stderr, done.stderr)
    expect(status(test.path)["missing"] == len(test.tasks), "it left a state")
    expect(run(test, "--task", f"0-{test.merge - 1}").returncode == 0, "the shards")
    look = status(test.path)
    expect(look["done"] == test.merge and look["list"][test.merge]["status"] == "missing",
           f"{look}")
    missing = program("campaign", "status", test.path, "--missing")
    expect(missing == f"{test.merge}-{test.last}\n", missing)
    page = json.loads(program("campaign", "report", test.path, "--json"))
    expect(page["tasks"] == 2 and page["not_done"] == 2, f"{page}")
    expect(run(test, "--task", test.merge).returncode == 0, "the merge")


def results_are_those_of_whole_runs(test):
    done = run(test, "--all", "--jobs", "2")
    expect(done.returncode == 0, done.stderr)
    plan(test, "whole", LIMITS)
    program("campaign", "run", test.work / "whole", "--all")
    for whole in (test.work / "whole").glob("runs/*/*/*"):
        divided = test.path / whole.relative_to(test.work / "whole")
        for name in ["out.h5", "conflicts.csv"]:
            expect((whole / name).read_bytes() == (divided / name).read_bytes(), name)
    facts = [json.loads(program("campaign", "report", path, "--json", "--force"))
             for path in [test.path, test.work / "whole"]]
    keys = ["vehicle", "route", "verdict", "colliding_points", "least", "first", "warnings"]
    runs = [[{key: run[key] for key in keys} for run in one["runs"]] for one in facts]
    expect(runs[0] == runs[1], f"{runs}")
    expect(facts[0]["conflict"] == 2, f"{facts[0]}")


def finished_ones_stay(test):
    before = {file: file.stat().st_mtime_ns for file in test.path.glob("runs/**/*.h5")}
    again = run(test, "--all")
    expect(again.returncode == 0 and again.stderr == "", again.stderr)
    state = test.path / test.tasks[test.merge]["folder"] / "state.json"
    state.unlink()  # as where it was killed after the merge
    expect(run(test, "--task", test.merge).returncode == 0, "the merge again")
    after = {file: file.stat().st_mtime_ns for file in test.path.glob("runs/**/*.h5")}
    expect(before == after, "a finished result was made again")


def failed_shard_fails_its_run(test):
    plan(test, "broken", DIVIDED)
    test.path = test.work / "broken"
    model = test.work / "vehicles/v01.ply"
    sound = model.read_bytes()
    model.write_bytes(sound[:-100])
    done = run(test, "--all", "--jobs", "2")
    expect(done.returncode == 4 and "waits for v01/r00/0.1/shards/1" in done.stderr, done.stderr)
    look = status(test.path)
    expect(look["failed"] == test.merge and look["missing"] == 1, f"{look}")
    facts = json.loads(program("campaign", "report", test.path, "--json"))
    expect(facts["failed"] == 1 and facts["conflict"] == 1, f"{facts}")
    link = facts["runs"][1]["page"]
    expect(link.endswith("/shards/1/log.txt") and (test.path / link).exists(), link)
    expect(program("campaign", "status", test.path, "--missing") == f"{test.last}\n", "missing")
    model.write_bytes(sound)


def main():
    with tempfile.TemporaryDirectory() as folder:
        test = Test(pathlib.Path(folder))
        for check in [plan_has_shards_and_merges, merge_waits, results_are_those_of_whole_runs,
                      finished_ones_stay, failed_shard_fails_its_run]:
            begin = time.monotonic()
            check(test)
            print(f"{check.__name__}: {time.monotonic() - begin:.1f} s", flush=True)


main()
