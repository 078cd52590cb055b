"""A campaign on a real Slurm of one node: 24 runs, of which three are divided into shards. One shard
is killed and one gets TERM, and both are queued again; one run, and all shards of another one, fail
for good; the merges come once, after all of these, and the report once, after all. The merge without
its shards is not queued again.

slurm_test.py PROGRAM
"""

import json
import os
import pathlib
import signal
import sys
import tempfile
import time

from campaign_scene import expect, make_scene, program, status, write_campaign
from one_node_slurm import OneNodeSlurm, what_is_missing

VEHICLES, SLOW, BROKEN_SLOW, BROKEN_VEHICLE = 24, (3, 5, 8), 5, 13
MAX_ARRAY = 20  # more tasks become two arrays
LIMITS = {"memory": "300M", "threads": 1, "shard_seconds": 0.18}  # divides the slow ones alone


def children_of(number):
    """Processes that a process started."""
    found = pathlib.Path(f"/proc/{number}/task/{number}/children")
    try:
        return [int(word) for word in found.read_text().split()]
    except FileNotFoundError:
        return []


def command_line(number):
    try:
        return pathlib.Path(f"/proc/{number}/cmdline").read_bytes().split(b"\0")
    except FileNotFoundError:
        return []


def task_process(folder, task):
    """Of `clearway campaign run DIR --task N`, or None."""
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        words = command_line(int(entry.name))
        if b"campaign" in words and str(folder).encode() in words and \
                words[-3:-1] == [b"--task", str(task).encode()]:
            return int(entry.name)
    return None


def held(folder, task):
    """The process of a task, its command stopped so that it cannot end; None where it has."""
    process = task_process(folder, task)
    try:
        os.kill(children_of(process)[0], signal.SIGSTOP)
        return process
    except (ProcessLookupError, IndexError, TypeError):
        return None


def has_pending(number, which):
    text = pathlib.Path(f"/proc/{number}/status").read_text()
    return int(text.split("ShdPnd:")[1].split()[0], 16) >> (which - 1) & 1


class Campaign:
    def __init__(self, path, slurm):
        self.path, self.slurm = path, slurm
        self.tasks = [json.loads(line.rstrip(",")) for line in
                      (path / "plan.json").read_text().splitlines()[1:-1]]
        lost = [task for task in self.tasks if task["vehicle"] == f"v{BROKEN_SLOW:02}"]
        self.lost = [task["task"] for task in lost if "shard" in task]
        self.lost_merge = lost[-1]["task"]
        self.shards = [task["task"] for task in self.tasks
                       if "shard" in task and task["task"] not in self.lost]
        self.merges = [task["task"] for task in self.tasks if "shards" in task]
        expect(len(self.merges) == len(SLOW), f"{len(self.merges)} runs are divided")
        self.killed = self.stopped = None
        self.broken = next(task["task"] for task in self.tasks
                           if task["vehicle"] == f"v{BROKEN_VEHICLE:02}")

    def disturb(self, look):
        """Kills one shard that is met while it runs, and has Slurm send TERM to another one."""
        for task in self.shards:
            if look["list"][task]["status"] != "running" or task in (self.killed, self.stopped):
                continue
            if self.killed is None:
                self.killed = task if self.kill(task) else None
            elif self.stopped is None:
                self.stopped = task if self.stop(task) else None

    def kill(self, task):
        process = held(self.path, task)
        if process is None:
            return False
        os.kill(process, signal.SIGKILL)
        return True

    def stop(self, task):
        """As Slurm does 60 seconds before the end: to the script alone."""
        process = held(self.path, task)
        if process is None:
            return False
        command = children_of(process)[0]
        self.slurm.run("scancel", "--batch", "--signal=TERM", self.element(task))
        last = time.monotonic() + 20
        while not has_pending(command, signal.SIGTERM):
            expect(time.monotonic() < last, "the script does not pass TERM on")
            time.sleep(0.02)
        os.kill(command, signal.SIGCONT)
        return True

    def element(self, task):
        """Of a job array."""
        before = 2 if task in self.merges else 0  # jobs
        return f"{self.jobs[before + task // MAX_ARRAY]}_{task % MAX_ARRAY}"

    def log(self, task):
        return (self.path / f"slurm/{self.element(task)}.log").read_text()

    def submit(self):
        said = self.slurm.run(self.path / "submit.sh")
        self.jobs = said.split("tasks: job ")[1].split(";")[0].split(":")
        expect(len(self.jobs) == 3, said)

    def wait(self, seconds):
        last = time.monotonic() + seconds
        done_before = set()
        while True:
            look = status(self.path)
            queue = self.slurm.run("squeue", "-h", "-r", "-o", "%i %T").splitlines()
            done = {one["task"] for one in look["list"] if one["status"] == "done"}
            expect(done_before <= done, "a task that was done is no longer")
            for task in done - done_before:
                expect(f"{self.element(task)} PENDING" not in queue, f"{task} is done and waits")
            done_before = done
            self.disturb(look)
            if not queue:
                expect(None not in (self.killed, self.stopped), "no two shards were met running")
                return status(self.path)
            expect(time.monotonic() < last, "it takes too long: " + "; ".join(queue))
            time.sleep(0.1)


def check_logs(campaign):
    """What the scripts said."""
    killed, stopped, broken = campaign.killed, campaign.stopped, campaign.broken
    text = {task: campaign.log(task) for task in range(len(campaign.tasks))}
    expect("queued again" in text[killed], "the killed task was not queued again")
    expect("exit code 5, queued again" in text[stopped], "TERM: " + text[stopped])
    expect("exit code 3" in text[broken] and "queued again" not in text[broken],
           "the broken task: " + text[broken])
    lost = text[campaign.lost_merge]
    expect("which is not done" in lost and "exit code 2" in lost, "the lost merge: " + lost)
    others = [task for task in text if task not in (killed, stopped)]
    again = [task for task in others if "queued again" in text[task]]
    expect(not again, f"queued again without a reason: {again}")


def check_merges(campaign, look):
    """Once, after all tasks that are none."""
    states = [campaign.path / one["folder"] / "state.json" for one in look["list"]]
    last = max(state.stat().st_mtime for task, state in enumerate(states)
               if task not in campaign.merges)
    for merge in campaign.merges:
        if merge == campaign.lost_merge:
            expect(look["list"][merge]["status"] == "missing", f"{look['list'][merge]}")
            continue
        expect(look["list"][merge]["tries"] == 1, f"merged twice: {look['list'][merge]}")
        result = states[merge].parent / "out.h5"
        expect(result.stat().st_mtime >= last, "a merge came before the end of the others")
        run = json.loads((states[merge].parent / "run.json").read_text())
        expect(run["verdict"] == "conflict" and run["was_finished"], f"{run}")


def check_end(campaign, look):
    path = campaign.path
    failed = sorted([campaign.broken, *campaign.lost])
    expect(look["done"] == len(campaign.tasks) - len(failed) - 1 and look["failed"] == len(failed),
           f"at the end: {look}")
    broken = look["list"][campaign.broken]
    expect(broken["exit_code"] == 3 and broken["tries"] == 1, f"the broken task: {broken}")
    expect(look["list"][campaign.stopped]["tries"] == 2, "the stopped task was not tried twice")
    expect(look["list"][campaign.killed]["tries"] == 2, "the killed task was not tried twice")
    page = (path / "index.html").read_text()
    expect("failed (3)" in page, "the page hides the failure")
    reports = (path / "slurm/report.log").read_text().count("index.html")
    expect(reports == 1, f"{reports} reports")
    newest = max(file.stat().st_mtime for file in path.glob("runs/**/state.json"))
    expect((path / "index.html").stat().st_mtime >= newest, "the report came before the end")
    expect(program("campaign", "status", path, "--missing") == f"{campaign.lost_merge}\n",
           "what is missing")
    said = program("campaign", "status", path, "--failed")
    last = failed[-1]
    expect(said == f"{failed[0]}-{failed[-2]},{last}\n", "--failed: " + said)
    check_merges(campaign, look)
    check_logs(campaign)


def main():
    missing = what_is_missing()
    if missing:
        print("skipped: not installed: " + ", ".join(missing))
        sys.exit(77)
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        make_scene(work, vehicles=VEHICLES, routes=1, slow=SLOW)
        path = work / "a campaign"
        program("campaign", "plan", write_campaign(work, limits=LIMITS), "-o", path)
        for vehicle in (BROKEN_VEHICLE, BROKEN_SLOW):
            broken = work / f"vehicles/v{vehicle:02}.ply"
            broken.write_bytes(broken.read_bytes()[:-100])
        with OneNodeSlurm(work / "slurm", max_array=MAX_ARRAY) as slurm:
            campaign = Campaign(path, slurm)
            missing = program("campaign", "status", path, "--missing")
            expect(missing == f"0-{len(campaign.tasks) - 1}\n", "before the start")
            campaign.submit()
            look = campaign.wait(100)
        check_end(campaign, look)
    print(f"{len(campaign.tasks)} tasks, {len(campaign.merges)} of them merges, one killed, one "
          f"stopped, one broken: {time.monotonic() - begin:.0f} s")


main()
