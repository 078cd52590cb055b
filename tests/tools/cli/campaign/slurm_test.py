"""A campaign on a real Slurm of one node: 24 runs, of which three are divided into shards. One shard
is killed and one gets TERM, and both are queued again; one run, and all shards of another one, fail
for good; the merges come once, after all of these, and the report once, after all. The merge without
its shards is not queued again.

slurm_test.py PROGRAM
"""

import json
import os
import signal
import sys
import time
import unittest
from pathlib import Path

from campaigns import LIMITS, Campaigns, make_scene, tasks_of
from one_node_slurm import OneNodeSlurm, what_is_missing

VEHICLES, SLOW, BROKEN_SLOW, BROKEN_VEHICLE = 24, (3, 5, 8), 5, 13
MAX_ARRAY = 20  # more tasks become two arrays
NAME = "a campaign"


def words_of(number):
    try:
        return Path(f"/proc/{number}/cmdline").read_bytes().split(b"\0")
    except FileNotFoundError:
        return []


def child_of(number):
    return int(Path(f"/proc/{number}/task/{number}/children").read_text().split()[0])


def is_pending(number, which):
    text = Path(f"/proc/{number}/status").read_text()
    return int(text.split("ShdPnd:")[1].split()[0], 16) >> (which - 1) & 1


class Slurm(Campaigns):
    @classmethod
    def make(cls):
        make_scene(cls.place, vehicles=VEHICLES, routes=1, slow=SLOW)

    def element(self, task):
        """Of a job array."""
        before = 2 if task in self.merges else 0  # jobs
        return f"{self.jobs[before + task // MAX_ARRAY]}_{task % MAX_ARRAY}"

    def held(self, task):
        """The process of a task, and its command, which is stopped so that it cannot end; None where it
        has."""
        wanted = [b"--task", str(task).encode()]
        found = [int(entry.name) for entry in Path("/proc").iterdir() if entry.name.isdigit()
                 and words_of(entry.name)[-3:-1] == wanted and str(self.path).encode() in words_of(entry.name)]
        try:
            os.kill(child_of(found[0]), signal.SIGSTOP)
            return found[0], child_of(found[0])
        except (ProcessLookupError, FileNotFoundError, IndexError):
            return None

    def disturb(self, look):
        """Kills one shard that is met while it runs, and has Slurm send TERM to another one, as it does
        60 seconds before the end: to the script alone."""
        for task in self.shards:
            if look["list"][task]["status"] != "running" or task in self.disturbed or len(self.disturbed) == 2:
                continue
            held = self.held(task)
            if held is None:
                continue
            self.disturbed.append(task)
            process, command = held
            if len(self.disturbed) == 1:
                os.kill(process, signal.SIGKILL)
                continue
            self.slurm.run("scancel", "--batch", "--signal=TERM", self.element(task))
            last = time.monotonic() + 20
            while not is_pending(command, signal.SIGTERM):
                self.assertLess(time.monotonic(), last, "the script does not pass TERM on")
                time.sleep(0.02)
            os.kill(command, signal.SIGCONT)

    def wait(self):
        last, done_before, queue = time.monotonic() + 100, set(), None
        while queue != []:
            self.assertLess(time.monotonic(), last, f"it takes too long: {queue}")
            look = self.status(f"'{NAME}'")
            queue = self.slurm.run("squeue", "-h", "-r", "-o", "%i %T").splitlines()
            done = {one["task"] for one in look["list"] if one["status"] == "done"}
            self.assertLessEqual(done_before, done, "a task that was done is no longer")
            for task in done - done_before:
                self.assertNotIn(f"{self.element(task)} PENDING", queue)
            done_before = done
            self.disturb(look)
            time.sleep(0.1)
        self.assertEqual(len(self.disturbed), 2, "no two shards were met running")
        return self.status(f"'{NAME}'")

    def test_a_campaign_on_slurm(self):
        self.plan(f"'{NAME}'", {"limits": {**LIMITS, "shard_seconds": 0.18}})  # divides the slow ones alone
        self.path, self.disturbed, tasks = self.place / NAME, [], tasks_of(self.place, NAME)
        lost = [task["task"] for task in tasks if task["vehicle"] == f"v{BROKEN_SLOW:02}"]
        lost_merge = lost.pop()
        self.shards = [task["task"] for task in tasks if "shard" in task and task["task"] not in lost]
        self.merges = [task["task"] for task in tasks if "shards" in task]
        broken = next(task["task"] for task in tasks if task["vehicle"] == f"v{BROKEN_VEHICLE:02}")
        self.assertEqual(len(self.merges), len(SLOW))
        for vehicle in (BROKEN_VEHICLE, BROKEN_SLOW):
            file = self.place / f"vehicles/v{vehicle:02}.ply"
            file.write_bytes(file.read_bytes()[:-100])
        with OneNodeSlurm(self.place / "slurm", MAX_ARRAY) as self.slurm:
            self.assertEqual(self.listed(f"'{NAME}'"), f"0-{len(tasks) - 1}")
            said = self.slurm.run(self.path / "submit.sh")
            self.jobs = said.split("tasks: job ")[1].split(";")[0].split(":")
            self.assertEqual(len(self.jobs), 3, said)
            look = self.wait()

        failed = sorted([broken, *lost])
        self.assertEqual([look["done"], look["failed"], self.listed(f"'{NAME}'"), self.listed(f"'{NAME}'", "failed")],
                         [len(tasks) - len(failed) - 1, len(failed), f"{lost_merge}",
                          f"{failed[0]}-{failed[-2]},{failed[-1]}"])
        self.assertEqual([look["list"][broken][key] for key in ("exit_code", "tries")], [3, 1])
        self.assertEqual([look["list"][task]["tries"] for task in self.disturbed], [2, 2])
        states = [self.path / one["folder"] / "state.json" for one in look["list"]]
        page = self.path / "index.html"
        self.assertIn("failed (3)", page.read_text())
        self.assertEqual((self.path / "slurm/report.log").read_text().count("index.html"), 1)
        self.assertGreaterEqual(page.stat().st_mtime,
                                max(file.stat().st_mtime for file in self.path.glob("runs/**/state.json")))

        # Merges come once, after all tasks that are none.
        last = max(state.stat().st_mtime for task, state in enumerate(states) if task not in self.merges)
        self.assertEqual(look["list"][lost_merge]["status"], "missing")
        for merge in set(self.merges) - {lost_merge}:
            folder = states[merge].parent
            run = json.loads((folder / "run.json").read_text())
            self.assertEqual([look["list"][merge]["tries"], run["verdict"], run["was_finished"]], [1, "conflict", True])
            self.assertGreaterEqual((folder / "out.h5").stat().st_mtime, last)

        # What the scripts said.
        logs = [(self.path / f"slurm/{self.element(task)}.log").read_text() for task in range(len(tasks))]
        self.assertIn("exit code 5, queued again", logs[self.disturbed[1]])
        self.assertIn("exit code 3", logs[broken])
        for words in ("which is not done", "exit code 2"):
            self.assertIn(words, logs[lost_merge])
        self.assertEqual([task for task, log in enumerate(logs) if "queued again" in log], sorted(self.disturbed))


if __name__ == "__main__":
    missing = what_is_missing()
    if missing:
        print("skipped: not installed: " + ", ".join(missing))
        sys.exit(77)
    unittest.main()
