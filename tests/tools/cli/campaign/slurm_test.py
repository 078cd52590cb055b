"""A campaign on a real Slurm of one node: an array of 24 tasks, of which one is killed and one gets
TERM, and both are queued again; one fails for good; the report comes once, after all of them.

slurm_test.py PROGRAM
"""

import os
import pathlib
import signal
import sys
import tempfile
import time

from campaign_scene import expect, make_scene, program, status, write_campaign
from one_node_slurm import OneNodeSlurm, what_is_missing

KILLED, STOPPED, BROKEN = 3, 8, 13
TASKS = 24
MAX_ARRAY = 20  # more tasks become two arrays


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
        self.disturbed = set()

    def disturb(self, look):
        """Kills one task while it runs, and has Slurm send TERM to another one."""
        for task, how in [(KILLED, self.kill), (STOPPED, self.stop)]:
            running = look["list"][task]["status"] == "running"
            if task not in self.disturbed and running and how(task):
                self.disturbed.add(task)

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
        return f"{self.jobs[task // MAX_ARRAY]}_{task % MAX_ARRAY}"

    def log(self, task):
        return (self.path / f"slurm/{self.element(task)}.log").read_text()

    def submit(self):
        said = self.slurm.run(self.path / "submit.sh")
        self.jobs = said.split("tasks: job ")[1].split(";")[0].split(":")
        expect(len(self.jobs) == 2, said)

    def wait(self, seconds):
        last = time.monotonic() + seconds
        done_before = set()
        while True:
            queue = self.slurm.run("squeue", "-h", "-r", "-o", "%i %T").splitlines()
            look = status(self.path)
            done = {one["task"] for one in look["list"] if one["status"] == "done"}
            expect(done_before <= done, "a task that was done is no longer")
            for task in done - done_before:
                expect(f"{self.element(task)} PENDING" not in queue, f"{task} is done and waits")
            done_before = done
            self.disturb(look)
            if not queue:
                return look
            expect(time.monotonic() < last, "it takes too long: " + "; ".join(queue))
            time.sleep(0.1)


def check_logs(campaign):
    """What the scripts said."""
    text = {task: campaign.log(task) for task in range(TASKS)}
    expect("queued again" in text[KILLED], "the killed task was not queued again")
    expect("exit code 5, queued again" in text[STOPPED], "TERM: " + text[STOPPED])
    expect("exit code 3" in text[BROKEN] and "queued again" not in text[BROKEN],
           "the broken task: " + text[BROKEN])
    others = [task for task in text if task not in (KILLED, STOPPED)]
    again = [task for task in others if "queued again" in text[task]]
    expect(not again, f"queued again without a reason: {again}")


def check_end(campaign, look):
    path = campaign.path
    expect(look["done"] == TASKS - 1 and look["failed"] == 1, f"at the end: {look}")
    broken = look["list"][BROKEN]
    expect(broken["exit_code"] == 3 and broken["tries"] == 1, f"the broken task: {broken}")
    expect(look["list"][STOPPED]["tries"] == 2, "the stopped task was not tried twice")
    expect(look["list"][KILLED]["tries"] == 2, "the killed task was not tried twice")
    page = (path / "index.html").read_text()
    expect("failed (3)" in page, "the page hides the failure")
    reports = (path / "slurm/report.log").read_text().count("index.html")
    expect(reports == 1, f"{reports} reports")
    newest = max(file.stat().st_mtime for file in path.glob("runs/*/*/*/state.json"))
    expect((path / "index.html").stat().st_mtime >= newest, "the report came before the end")
    expect(program("campaign", "status", path, "--missing") == "", "something is missing")
    expect(program("campaign", "status", path, "--failed") == f"{BROKEN}\n", "--failed")
    check_logs(campaign)


def main():
    missing = what_is_missing()
    if missing:
        print("skipped: not installed: " + ", ".join(missing))
        sys.exit(77)
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        make_scene(work, vehicles=TASKS, routes=1, slow=(KILLED, STOPPED))
        path = work / "a campaign"
        program("campaign", "plan", write_campaign(work), "-o", path)
        broken = work / f"vehicles/v{BROKEN:02}.ply"
        broken.write_bytes(broken.read_bytes()[:-100])
        with OneNodeSlurm(work / "slurm", max_array=MAX_ARRAY) as slurm:
            campaign = Campaign(path, slurm)
            expect(program("campaign", "status", path, "--missing") == f"0-{TASKS - 1}\n",
                   "before the start")
            campaign.submit()
            look = campaign.wait(100)
        check_end(campaign, look)
    print(f"{TASKS} tasks, one killed, one stopped, one broken: {time.monotonic() - begin:.0f} s")


main()
