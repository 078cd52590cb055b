"""Kills `clearway campaign run --all` and its tasks at random moments until it is done: the results
must be, byte for byte, those of a campaign that nobody disturbed, no result that was finished may
be made again, and status must be right at every look.

kill_campaign.py PROGRAM [--kills N] [--seed S]

--kills: SIGKILLs; SIGTERMs come on top.
"""

import argparse
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import tempfile
import time

from campaign_scene import PROGRAM, expect, make_scene, outcome, program, status, write_campaign

VEHICLES, ROUTES = 6, 5
FILES = ["out.h5", "conflicts.csv"]
DIVIDED = {"memory": "300M", "threads": 1, "shard_seconds": 0.04}  # into three or so


def folders(path):
    return sorted([*path.glob("runs/*/*/*"), *path.glob("runs/*/*/*/shards/*")])


def files_of(folder):
    return ["part.h5"] if folder.parent.name == "shards" else FILES


def bytes_of(path):
    return {folder.relative_to(path): [(folder / name).read_bytes() for name in files_of(folder)]
            for folder in folders(path)}


class Watch:
    """What must hold whenever one looks."""

    def __init__(self, path, reference):
        self.path, self.reference = path, reference
        self.finished = {}  # of each result its number in the file system, and its time
        self.looks = 0

    def see_results(self):
        for folder in folders(self.path):
            result = folder / files_of(folder)[0]
            if not result.exists():
                expect(folder not in self.finished, f"{folder}: a finished result is gone")
                continue
            now = (result.stat().st_ino, result.stat().st_mtime_ns)
            expect(self.finished.setdefault(folder, now) == now,
                   f"{folder}: a finished result was made again")

    def look(self, alive):
        """alive: whether a campaign is at work."""
        self.looks += 1
        look = status(self.path)
        # A task that began in the moment in which its campaign was killed is killed a moment later.
        last = time.monotonic() + 5
        while not alive and look["running"] > 0:
            expect(time.monotonic() < last, f"nobody is at work: {look}")
            time.sleep(0.01)
            look = status(self.path)
        counts = {name: look[name] for name in
                  ["done", "running", "begun", "interrupted", "failed", "missing"]}
        expect(sum(counts.values()) == len(self.reference), f"{counts}")
        expect(counts["begun"] == 0, f"{look}")
        if counts["running"] > 2:
            # Tasks are read one after the other, so one that is read first may end, and another
            # begin, before that one is read. Those that still run in a second look were at work
            # at the same time.
            again = {one["folder"] for one in status(self.path)["list"] if one["status"] == "running"}
            both = [one["folder"] for one in look["list"]
                    if one["status"] == "running" and one["folder"] in again]
            expect(len(both) <= 2, f"{counts}, at the same time {both}")
        for one in look["list"]:
            folder = self.path / one["folder"]
            if one["status"] == "done":
                found = [(folder / name).read_bytes() for name in files_of(folder)]
                expect(found == self.reference[folder.relative_to(self.path)],
                       f"{folder}: done, but not as undisturbed")
            if one["status"] == "failed":  # killed too often
                expect(one["exit_code"] == 4 and "signal 9" in one["message"], f"{one}")
            if one["status"] == "missing" and not alive:  # else it may have been made since
                expect(not (folder / files_of(folder)[0]).exists(), f"{folder}: missing, but there")
        self.see_results()
        return counts


def children_of(number):
    try:
        words = pathlib.Path(f"/proc/{number}/task/{number}/children").read_text().split()
        return [int(word) for word in words]
    except FileNotFoundError:
        return []


def strike(process, draw):
    """One signal: to the campaign, or to one of its tasks. Its number of SIGKILLs."""
    kind = draw.random()
    children = children_of(process.pid)
    which = signal.SIGTERM if kind < 0.1 else signal.SIGKILL
    target = process.pid if kind < 0.6 or not children else draw.choice(children)
    try:
        os.kill(target, which)
    except ProcessLookupError:
        return 0
    return int(which == signal.SIGKILL)


def wait_for_children(children):
    """Those of a campaign that was killed are killed with it, a moment later."""
    last = time.monotonic() + 5
    while any(pathlib.Path(f"/proc/{child}/cmdline").exists() and
              pathlib.Path(f"/proc/{child}/stat").read_text().split()[2] != "Z"
              for child in children):
        expect(time.monotonic() < last, "a task outlives its campaign")
        time.sleep(0.002)


def attempt(path, watch, draw, usual, kills):
    """One call of the campaign, disturbed. Whether it ended by itself, and the SIGKILLs."""
    process = subprocess.Popen([PROGRAM, "campaign", "run", path, "--all", "--jobs", "2"],
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    struck, children = 0, []
    while process.poll() is None and struck < kills:
        time.sleep(draw.random() * usual / 8)
        if draw.random() < 0.2:
            watch.look(alive=True)
        children = children_of(process.pid)
        if process.poll() is None:
            struck += strike(process, draw)
    text, _ = process.communicate()
    try:
        wait_for_children(children)
    except (FileNotFoundError, ProcessLookupError):
        pass
    expect(process.returncode in (0, 4, 5, -signal.SIGKILL, -signal.SIGTERM),
           f"exit code {process.returncode}: {text}")
    watch.see_results()
    return process.returncode == 0, struck


class Reference:
    """A campaign that nobody disturbs."""

    def __init__(self, work, name, **changes):
        self.plan = write_campaign(work, **changes).rename(work / (name + ".json"))
        program("campaign", "plan", self.plan, "-o", work / name)
        begin = time.monotonic()
        program("campaign", "run", work / name, "--all")
        self.seconds = time.monotonic() - begin
        self.bytes = bytes_of(work / name)
        self.results = {folder: found for folder, found in self.bytes.items()
                        if folder.parent.name != "shards"}
        expect(len(self.results) == VEHICLES * ROUTES, "the undisturbed campaign is not complete")


def torment(path, reference, draw, kills):
    """One campaign until it is done. The SIGKILLs and the looks."""
    program("campaign", "plan", reference.plan, "-o", path)
    watch = Watch(path, reference.bytes)
    struck, done = 0, False
    while not done:
        done, more = attempt(path, watch, draw, reference.seconds, kills - struck)
        struck += more
        watch.look(alive=False)
    counts = watch.look(alive=False)
    expect(counts["done"] == len(reference.bytes), f"done, but {counts}")
    expect(bytes_of(path) == reference.bytes, "the results differ")
    again = outcome("campaign", "run", path, "--all")
    expect(again.returncode == 0 and again.stderr.count("\n") == 1, f"done twice: {again.stderr}")
    watch.see_results()
    shutil.rmtree(path)
    return struck, watch.looks


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    draw = random.Random(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        make_scene(work, VEHICLES, ROUTES)
        references = [Reference(work, "divided", limits=DIVIDED), Reference(work, "whole")]
        expect(references[0].results == references[1].results, "merged results differ")
        kills = rounds = looks = 0
        while kills < arguments.kills:
            struck, looked = torment(work / "out", references[rounds % 2], draw,
                                     arguments.kills - kills)
            kills, looks, rounds = kills + struck, looks + looked, rounds + 1
        print(f"{kills} SIGKILLs over {rounds} campaigns of {VEHICLES * ROUTES} runs "
              f"({references[1].seconds:.2f} s undisturbed, {references[0].seconds:.2f} s in "
              f"{len(references[0].bytes) - len(references[0].results)} shards), {looks} looks: "
              "all results equal, none made twice")


main()
