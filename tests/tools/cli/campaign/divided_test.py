"""Campaigns whose runs are divided into shards: their tasks, the order of the work, what a shard
that fails does to its run, and results as of runs that are not divided.

divided_test.py PROGRAM
"""

import json
import os
import pathlib
import shutil
import subprocess
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
    done = plan(test, "refused", DIVIDED, query={"first_pose": True, "depth": True})
    expect(done.returncode == 3 and "depths are not found in shards" in done.stderr, done.stderr)
    expect(plan(test, "divided", DIVIDED).returncode == 0, "the same plan again")
    long_enough = plan(test, "long", {**LIMITS, "shard_seconds": 1000})
    expect("2 tasks" in long_enough.stdout, long_enough.stdout)


def merge_waits(test):
    done = run(test, "--task", test.merge)
    expect(done.returncode == 2 and "waits for v00/r00/0.1/shards/1" in done.stderr, done.stderr)
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
    expect(again.returncode == 0 and again.stderr.count("\n") == 1, again.stderr)
    state = test.path / test.tasks[test.merge]["folder"] / "state.json"
    state.unlink()  # as where it was killed after the merge
    expect(run(test, "--task", test.merge).returncode == 0, "the merge again")
    after = {file: file.stat().st_mtime_ns for file in test.path.glob("runs/**/*.h5")}
    expect(before == after, "a finished result was made again")


def finished_runs_need_no_shards(test):
    for shards in test.path.glob("runs/*/*/*/shards"):
        shutil.rmtree(shards)
    look = status(test.path)
    expect(look["done"] == len(test.tasks), f"{look}")
    expect(program("campaign", "status", test.path, "--missing") == "", "missing")
    expect(run(test, "--all").returncode == 0, "all of it")
    expect(run(test, "--task", 0).returncode == 0, "a shard")
    expect(not list(test.path.glob("runs/**/shards/*/part.h5")), "a shard was searched in vain")
    folder = test.path / test.tasks[test.merge]["folder"]
    table = (folder / "conflicts.csv").read_bytes()
    (folder / "conflicts.csv").unlink()
    done = run(test, "--all")
    expect(done.returncode == 0, done.stderr)
    expect((folder / "conflicts.csv").read_bytes() == table, "the output again")
    expect(not list(test.path.glob("runs/**/part.h5")), "shards were searched for an output")


def new_store_has_shards_of_its_own(test):
    """A store that is built anew between the shards of a run has the same points in other cells."""
    plan(test, "rebuilt", DIVIDED)
    test.path = test.work / "rebuilt"
    store, kept = test.work / "site.h5", test.work / "kept.h5"
    expect(run(test, "--task", 0).returncode == 0, "a shard of the old store")
    store.rename(kept)
    program("convert", test.work / "hall/environment.las", "--cell-points", 1100, "-o", store)
    done = run(test, "--task", 1)
    expect(done.returncode == 3 and "an input has changed" in done.stderr, done.stderr)
    done = plan(test, "rebuilt", DIVIDED)
    expect(done.returncode == 2 and "is another plan" in done.stderr, done.stderr)
    expect(outcome("campaign", "plan", test.work / "campaign.json", "-o", test.path,
                   "--force").returncode == 0, "the plan of the new store")
    look = status(test.path)
    expect(look["done"] == 0, f"a shard of the old store counts: {look}")
    done = run(test, "--all")
    expect(done.returncode == 0, done.stderr)
    for whole in (test.work / "whole").glob("runs/*/*/*/out.h5"):
        divided = test.path / whole.relative_to(test.work / "whole")
        expect(whole.read_bytes() == divided.read_bytes(), "the result of the new store")
    store.unlink()
    kept.rename(store)


def merges_need_no_gpu(test):
    """A campaign for GPUs is planned without one."""
    done = plan(test, "gpus", {**DIVIDED, "device": "cuda"})
    if done.returncode != 0:  # of a build without CUDA
        expect("cuda" in done.stderr.lower(), done.stderr)
        return
    tasks = [json.loads(line.rstrip(",")) for line in
             (test.work / "gpus/plan.json").read_text().splitlines()[1:-1]]
    for task in tasks:
        device = "--device=cpu" if "shards" in task else "--device=cuda"
        of_run = [words for words in task["commands"] if words[0] == "run"]
        expect(device in of_run[0], f"{task}")


def submit(test, *words, folder="slurm", scontrol="MaxArraySize            = 1001"):
    """Runs submit.sh with programs in the place of Slurm's. Returns how it ended, and what each
    sbatch was given: its words, and then its standard input."""
    programs = test.work / "bin"
    shutil.rmtree(programs, ignore_errors=True)
    programs.mkdir()
    for name, text in [("scontrol", f"echo '{scontrol}'"),
                       ("sbatch", f"number=$(ls {programs} | grep -c job)\n"
                                  f"{{ echo \"$@\"; cat; }} > {programs}/job$number < "
                                  "/dev/stdin\necho $number")]:
        (programs / name).write_text("#!/bin/sh\n" + text + "\n")
        (programs / name).chmod(0o755)
    done = subprocess.run([test.work / folder / "submit.sh", *words], stdin=subprocess.DEVNULL,
                          text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60,
                          env={**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"})
    return done, [path.read_text() for path in sorted(programs.glob("job*"))]


def submit_takes_lists(test):
    """An empty list, such as that of what is missing where nothing is, submits nothing."""
    program("campaign", "plan", write_campaign(test.work, limits=DIVIDED), "-o",
            test.work / "lists")
    last = test.last
    runs = [i for i in range(last + 1) if i not in (test.merge, last)]
    merges = f"{test.merge},{last}"
    for words, code, said, arrays in [
            ([], 0, "tasks: job", [",".join(map(str, runs)), merges]),
            ([""], 0, "nothing is submitted", []),
            ([" \n"], 0, "nothing is submitted", []),
            (["0"], 0, "tasks: job", ["0"]),
            (["1,0,1"], 0, "tasks: job", ["0,1"]),
            ([f"{last}"], 0, "tasks: job", [f"{last}"]),
            ([f"{last + 1}"], 2, f"from 0 to {last}", []),
            (["1-0"], 2, "that ascend", []),
            (["all"], 2, "all: expected numbers", []),
            (["0,"], 2, "0,: expected numbers", []),
            (["0", "1"], 2, "one list of tasks", [])]:
        done, jobs = submit(test, *words, folder="lists")
        expect(done.returncode == code and said in done.stdout + done.stderr, f"{words}: {done}")
        given = [job.splitlines()[0] for job in jobs]
        expect([words for words in given if "--wrap" in words] == given[len(arrays):],
               f"{words}: the report is the last job: {given}")
        expect(len(given) == len(arrays) + (1 if arrays else 0), f"{words}: {given}")
        expect(all(f"--array={array}" in one.split() for array, one in zip(arrays, given)),
               f"{words}: {given}")
    done, jobs = submit(test, "0", folder="lists", scontrol="")
    expect(done.returncode == 4 and "MaxArraySize" in done.stderr and not jobs, f"{done}")
    done = run(test, "--task", "")
    expect(done.returncode == 0 and "nothing to do" in done.stderr, done.stderr)


def merges_ask_slurm_for_no_gpu(test):
    campaign = write_campaign(test.work, limits=DIVIDED, slurm=["--gres=gpu:1", "--time=10"])
    program("campaign", "plan", campaign, "-o", test.work / "slurm")
    done, jobs = submit(test)
    expect(done.returncode == 0, done.stderr)
    shards, merges, _ = jobs
    expect("--dependency=afterany:0" in merges.splitlines()[0], merges)
    expect("#SBATCH --gres=gpu:1\n" in shards and "#SBATCH --gres" not in merges, merges)
    expect([line for line in shards.splitlines()[1:] if line != "#SBATCH --gres=gpu:1"]
           == merges.splitlines()[1:], "the rest of the script differs")


def failed_shard_fails_its_run(test):
    plan(test, "broken", DIVIDED)
    test.path = test.work / "broken"
    model = test.work / "vehicles/v01.ply"
    sound = model.read_bytes()
    model.write_bytes(sound[:-100])
    done = run(test, "--all", "--jobs", "2")
    expect(done.returncode == 3 and "waits for v01/r00/0.1/shards/1" in done.stderr, done.stderr)
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
                      finished_ones_stay, finished_runs_need_no_shards,
                      new_store_has_shards_of_its_own, merges_need_no_gpu,
                      submit_takes_lists, merges_ask_slurm_for_no_gpu,
                      failed_shard_fails_its_run]:
            begin = time.monotonic()
            check(test)
            print(f"{check.__name__}: {time.monotonic() - begin:.1f} s", flush=True)


main()
