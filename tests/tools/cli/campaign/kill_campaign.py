"""Kills `clearway campaign run --all` and its tasks at random moments until it is done: the results
must be, byte for byte, those of a campaign that nobody disturbed, no result that was finished may
be made again, and status must be right whenever one looks.

kill_campaign.py PROGRAM [--kills N] [--seed S]

--kills: SIGKILLs; SIGTERMs come on top. A signal waits until the files of the campaign have grown
by a random part of what they have in the end.
"""

import argparse
import os
import pathlib
import random
import shutil
import signal
import tempfile
import time

from campaigns import LIMITS, Place, make_scene, put_campaign, status

VEHICLES, ROUTES = 6, 5
DIVIDED = {"limits": {**LIMITS, "shard_seconds": 0.04}}  # into three or so


def expect(condition, what):
    if not condition:
        raise AssertionError(what)


class Campaign:
    def __init__(self, place, name):
        self.place, self.name, self.path = place, name, place / name
        self.finished = {}  # of each result its number in the file system, and its time
        self.looks = 0

    def results(self):
        """The folders of all runs and shards, with the files that each has when it is done."""
        return {folder.relative_to(self.path): [folder / name for name in (
                    ["part.h5"] if folder.parent.name == "shards" else ["out.h5", "conflicts.csv"])]
                for pattern in ("runs/*/*/*", "runs/*/*/*/shards/*") for folder in self.path.glob(pattern)}

    def bytes(self):
        return {name: [file.read_bytes() for file in files] for name, files in self.results().items()}

    def size(self):
        return sum(file.stat().st_size for files in self.results().values() for file in files if file.exists())

    def see_results(self):
        for name, (result, *_) in self.results().items():
            if not result.exists():
                expect(name not in self.finished, f"{name}: a finished result is gone")
                continue
            now = (result.stat().st_ino, result.stat().st_mtime_ns)
            expect(self.finished.setdefault(name, now) == now, f"{name}: a finished result was made again")

    def look(self, reference, alive):
        """What must hold whenever one looks. alive: whether a campaign is at work."""
        self.looks += 1
        look, last = status(self.place, self.name), time.monotonic() + 5
        # A task that began in the moment in which its campaign was killed is killed a moment later.
        while not alive and look["running"] > 0:
            expect(time.monotonic() < last, f"nobody is at work: {look}")
            look = status(self.place, self.name)
        expect(sum(look[name] for name in ("done", "running", "begun", "interrupted", "failed", "missing")) ==
               len(reference) and look["begun"] == 0, f"{look}")
        if look["running"] > 2:
            # Tasks are read one after the other. Those that still run in a second look were at work
            # at the same time.
            running = [{one["folder"] for one in some["list"] if one["status"] == "running"}
                       for some in (look, status(self.place, self.name))]
            expect(len(running[0] & running[1]) <= 2, f"at the same time {running}")
        for one in look["list"]:
            name = pathlib.Path(one["folder"])
            if one["status"] == "done":
                expect([file.read_bytes() for file in self.results()[name]] == reference[name],
                       f"{name}: done, but not as undisturbed")
            if one["status"] == "failed":  # killed too often
                expect(one["exit_code"] == 4 and "signal 9" in one["message"], f"{one}")
            if one["status"] == "missing" and not alive and name in self.results():
                expect(not self.results()[name][0].exists(), f"{name}: missing, but there")
        self.see_results()
        return look


def children_of(number):
    try:
        return [int(word) for word in pathlib.Path(f"/proc/{number}/task/{number}/children").read_text().split()]
    except FileNotFoundError:
        return []


def works(number):
    try:
        return pathlib.Path(f"/proc/{number}/stat").read_text().split()[2] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def strike(process, draw):
    """One signal: to the campaign, or to one of its tasks. Its number of SIGKILLs."""
    kind, children = draw.random(), children_of(process.pid)
    which = signal.SIGTERM if kind < 0.1 else signal.SIGKILL
    try:
        os.kill(process.pid if kind < 0.6 or not children else draw.choice(children), which)
    except ProcessLookupError:
        return 0
    return int(which == signal.SIGKILL)


def attempt(campaign, reference, draw, kills):
    """One call of the campaign, disturbed. Whether it ended by itself, and the SIGKILLs."""
    whole = sum(len(content) for files in reference.values() for content in files)
    process = campaign.place.start(f"campaign run {campaign.name} --all --jobs 2")
    struck, children = 0, []
    while process.poll() is None and struck < kills:
        size = campaign.size()
        least = size + draw.random() * (whole - size) / 4
        while process.poll() is None and campaign.size() <= least:
            time.sleep(0.001)
        if draw.random() < 0.2:
            campaign.look(reference, alive=True)
        children = children_of(process.pid)
        struck += strike(process, draw) if process.poll() is None else 0
    text, last = process.communicate()[0], time.monotonic() + 5
    while any(works(child) for child in children):  # killed with it, a moment later
        expect(time.monotonic() < last, "a task outlives its campaign")
    expect(process.returncode in (0, 4, 5, -signal.SIGKILL, -signal.SIGTERM), f"{process.returncode}: {text}")
    campaign.see_results()
    return process.returncode == 0, struck


def undisturbed(place, name, changes):
    put_campaign(place, changes, f"{name}.json")
    place.ask(f"campaign plan {name}.json -o {name}")
    place.ask(f"campaign run {name} --all")
    return Campaign(place, name).bytes()


def torment(place, name, reference, draw, kills):
    """One campaign until it is done. The SIGKILLs and the looks."""
    place.ask(f"campaign plan {name}.json -o out")
    campaign, struck, done = Campaign(place, "out"), 0, False
    while not done:
        done, more = attempt(campaign, reference, draw, kills - struck)
        struck += more
        look = campaign.look(reference, alive=False)
    expect(look["done"] == len(reference) and campaign.bytes() == reference, f"the results differ: {look}")
    expect(place.ask("campaign run out --all").stderr.count("\n") == 1, "done twice")
    campaign.see_results()
    shutil.rmtree(campaign.path)
    return struck, campaign.looks


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    draw = random.Random(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        place = Place(folder)
        make_scene(place, VEHICLES, ROUTES)
        references = [(name, undisturbed(place, name, changes))
                      for name, changes in (("divided", DIVIDED), ("whole", {}))]
        runs = [{folder: files for folder, files in found.items() if folder.parent.name != "shards"}
                for _, found in references]
        expect(runs[0] == runs[1] and len(runs[0]) == VEHICLES * ROUTES, "merged results differ")
        kills = rounds = looks = 0
        while kills < arguments.kills:
            struck, looked = torment(place, *references[rounds % 2], draw, arguments.kills - kills)
            kills, looks, rounds = kills + struck, looks + looked, rounds + 1
        print(f"{kills} SIGKILLs over {rounds} campaigns of {VEHICLES * ROUTES} runs, {looks} looks: "
              "all results equal, none made twice")


main()
