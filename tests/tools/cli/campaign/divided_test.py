"""Campaigns whose runs are divided into shards: their tasks, the order of the work, what a shard
that fails does to its run, results as of runs that are not divided, and how they are submitted.

divided_test.py PROGRAM
"""

import os
import shutil
import subprocess
import unittest

from campaigns import Campaigns, make_scene, tasks_of

DIVIDED = {"limits.shard_seconds": 0.03}
RESULTS = "runs/*/*/*/out.h5"


class Divided(Campaigns):
    @classmethod
    def make(cls):
        make_scene(cls.place, vehicles=2, routes=1)

    def setUp(self):
        self.plan("divided", DIVIDED, more="--force")
        self.tasks = tasks_of(self.place, "divided")
        self.merge = self.tasks[0]["shard"][1]  # the number of the first one
        self.last = len(self.tasks) - 1

    def results(self, name, pattern=RESULTS):
        return {file.relative_to(self.place / name): file.read_bytes() for file in (self.place / name).glob(pattern)}

    def test_a_plan_has_shards_and_merges(self):
        merge = self.tasks[self.merge]
        self.assertEqual([merge["shards"], len(self.tasks), self.tasks[1]["folder"]],
                         [self.merge, 2 * (self.merge + 1), merge["folder"] + "/shards/2"])
        self.assertGreater(self.merge, 1)
        self.assertEqual([command[0] for command in merge["commands"][:2]], ["merge", "run"])
        self.plan("divided", DIVIDED, 0, "is this plan already")
        self.plan("long", {"limits.shard_seconds": 1000}, 0, "2 tasks")

    def test_a_run_may_have_two_shards(self):
        seconds = 0.03
        for _ in range(30):
            seconds *= 1.2
            self.plan("two", {"limits.shard_seconds": seconds}, more="--force")
            tasks = tasks_of(self.place, "two")
            if len(tasks) == 6:
                break
        self.assertEqual([task.get("shards") for task in tasks[:3]], [None, None, 2])

    def test_a_merge_waits_and_has_the_results_of_whole_runs(self):
        shards = f"0-{self.merge - 1}"
        self.run_tasks("divided", f"--task {self.merge}", 2, "waits for v00/r00/0.1/shards/1")
        self.assertEqual(self.status("divided")["missing"], len(self.tasks))
        self.run_tasks("divided", f"--task {shards}")
        look = self.status("divided")
        self.assertEqual([look["done"], look["list"][self.merge]["status"], self.listed("divided")],
                         [self.merge, "missing", f"{self.merge}-{self.last}"])
        page = self.report("divided")
        self.assertEqual([page["tasks"], page["not_done"]], [2, 2])
        self.run_tasks("divided", f"--task {self.merge}")
        self.run_tasks("divided", "--all --jobs 2")
        self.done("whole")
        for pattern in (RESULTS, "runs/*/*/*/conflicts.csv"):
            whole = self.results("whole", pattern)
            self.assertEqual([len(whole), whole], [2, self.results("divided", pattern)])
        keys = ["vehicle", "route", "verdict", "colliding_points", "least", "first", "warnings"]
        runs = [[{key: run[key] for key in keys} for run in self.report(name)["runs"]] for name in ("divided", "whole")]
        self.assertEqual(runs[0], runs[1])
        self.assertEqual([run["verdict"] for run in runs[0]], ["conflict"] * 2)

        before = self.files("divided", "runs/**/*.h5")
        self.assertEqual(self.run_tasks("divided").stderr.count("\n"), 1)
        folder = self.place / "divided" / self.tasks[self.merge]["folder"]
        (folder / "state.json").unlink()  # as where it was killed after the merge
        self.run_tasks("divided", f"--task {self.merge}")
        self.assertEqual(self.files("divided", "runs/**/*.h5"), before)

        for folder_of_shards in (self.place / "divided").glob("runs/*/*/*/shards"):
            shutil.rmtree(folder_of_shards)
        self.assertEqual([self.status("divided")["done"], self.listed("divided")], [len(self.tasks), ""])
        table = (folder / "conflicts.csv").read_bytes()
        for words in ("--all", "--task 0"):
            self.run_tasks("divided", words)
        (folder / "conflicts.csv").unlink()
        self.run_tasks("divided")
        self.assertEqual((folder / "conflicts.csv").read_bytes(), table)
        self.assertEqual(self.files("divided", "runs/**/part.h5"), {}, "a shard was searched in vain")

    def test_a_store_that_is_built_anew_between_the_shards_has_shards_of_its_own(self):
        """It has the same points in other cells."""
        self.plan("rebuilt", DIVIDED)
        self.run_tasks("rebuilt", "--task 0")
        store = self.place / "site.h5"
        kept = store.rename(self.place / "kept.h5")
        self.addCleanup(kept.rename, store)
        self.place.ask("convert environment.las --cell-points 1100 -o site.h5")
        self.run_tasks("rebuilt", "--task 1", 3, "an input has changed")
        self.plan("rebuilt", DIVIDED, 2, "is another plan")
        self.plan("rebuilt", DIVIDED, more="--force")
        self.assertEqual(self.status("rebuilt")["done"], 0)
        self.run_tasks("rebuilt")
        self.done("rebuilt_whole")
        self.assertEqual(self.results("rebuilt_whole"), self.results("rebuilt"))

    def test_a_campaign_for_gpus_is_planned_without_one_and_its_merges_need_none(self):
        changes = {**DIVIDED, "limits.device": "cuda"}
        try:
            self.plan("gpus", changes)
        except AssertionError as without_cuda:  # a build without CUDA
            self.assertIn("cuda", str(without_cuda).lower())
            return
        for task in tasks_of(self.place, "gpus"):
            device = "--device=cpu" if "shards" in task else "--device=cuda"
            self.assertIn(device, [words for words in task["commands"] if words[0] == "run"][0])

    def test_a_failed_shard_fails_its_run(self):
        self.plan("broken", DIVIDED)
        model = self.place / "vehicles/v01.ply"
        sound = model.read_bytes()
        self.addCleanup(model.write_bytes, sound)
        model.write_bytes(sound[:-100])
        self.run_tasks("broken", "--all --jobs 2", 3, "waits for v01/r00/0.1/shards/1")
        look, facts = self.status("broken"), self.report("broken")
        link = facts["runs"][1]["page"]
        self.assertEqual([look["failed"], look["missing"], facts["failed"], facts["conflict"], self.listed("broken")],
                         [self.merge, 1, 1, 1, f"{self.last}"])
        self.assertTrue(link.endswith("/shards/1/log.txt") and (self.place / "broken" / link).exists(), link)

    def submit(self, words, code=0, said="", name="divided", array_size="MaxArraySize            = 1001"):
        """Runs submit.sh with programs in the place of Slurm's. What each sbatch was given: its words,
        and then its standard input."""
        shutil.rmtree(self.place / "bin", ignore_errors=True)
        self.place.put("bin/scontrol", f"#!/bin/sh\necho '{array_size}'\n")
        self.place.put("bin/sbatch", "#!/bin/sh\ncd $(dirname $0)\nnumber=$(ls | grep -c job)\n"
                       "{ echo \"$@\"; cat; } > job$number < /dev/stdin\necho $number\n")
        for tool in ("scontrol", "sbatch"):
            (self.place / "bin" / tool).chmod(0o755)
        done = subprocess.run([self.place / name / "submit.sh", *words], stdin=subprocess.DEVNULL,
                              text=True, capture_output=True, timeout=60, check=False,
                              env={**os.environ, "PATH": f"{self.place / 'bin'}:{os.environ['PATH']}"})
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertIn(said, done.stdout + done.stderr)
        return [path.read_text() for path in sorted((self.place / "bin").glob("job*"))]

    def test_lists_of_tasks_are_submitted(self):
        """An empty list, such as that of what is missing where nothing is, submits nothing."""
        last, merges = self.last, f"{self.merge},{self.last}"
        shards = ",".join(str(i) for i in range(last) if i != self.merge)
        for words, code, said, *arrays in (
                ([], 0, "tasks: job", shards, merges), ([""], 0, "nothing is submitted"),
                ([" \n"], 0, "nothing is submitted"), (["0"], 0, "tasks: job", "0"),
                (["1,0,1"], 0, "tasks: job", "0,1"), ([f"{last}"], 0, "tasks: job", f"{last}"),
                ([f"{last + 1}"], 2, f"from 0 to {last}"), (["1-0"], 2, "that ascend"),
                (["all"], 2, "all: expected numbers"), (["0,"], 2, "0,: expected numbers"),
                (["0", "1"], 2, "one list of tasks")):
            given = [job.splitlines()[0] for job in self.submit(words, code, said)]
            self.assertEqual(["--wrap" in one for one in given], [False] * len(arrays) + [True] * bool(arrays))
            for array, one in zip(arrays, given):
                self.assertIn(f"--array={array}", one.split())
        self.assertEqual(self.submit(["0"], 4, "MaxArraySize", array_size=""), [])

    def test_merges_ask_slurm_for_no_gpu(self):
        self.plan("slurm", {**DIVIDED, "slurm": ["--gres=gpu:1", "--time=10"]})
        shards, merges, _ = self.submit([], name="slurm")
        self.assertIn("--dependency=afterany:0", merges.splitlines()[0])
        self.assertIn("#SBATCH --gres=gpu:1\n", shards)
        self.assertEqual([line for line in shards.splitlines()[1:] if line != "#SBATCH --gres=gpu:1"],
                         merges.splitlines()[1:])


if __name__ == "__main__":
    unittest.main()
