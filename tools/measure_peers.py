#!/usr/bin/python3
"""Measures other libraries on one scene, and adds what they gave to a file.

They are the programs of tools/bench/peers/programs, which are in the folder of clearway; those that
were not built are named. A case that the file has already is not measured again, so what was stopped
goes on. One that fails, or takes longer than --patience, is kept with what it said.
Example: tools/measure_peers.py build/release/tools --scene hall --env hall.h5 \\
             --model hall/model.ply --trajectory hall/trajectory.txt -o peers.json
tools/charts.py draws the file.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from trials.header import header

PEERS = ("nanoflann", "cgal", "pcl", "open3d", "octomap")


def words(text):
    return text.split(",")


class Running:
    """A peer that prepares its search and then waits for its turn, so that all can prepare at the
    same time, and each searches alone."""

    def __init__(self, key, parameters, command, options):
        def bound():
            if options.memory:
                resource.setrlimit(resource.RLIMIT_AS, (options.memory << 30, options.memory << 30))

        self.case = {"key": key, "parameters": parameters}
        self.patience = options.patience
        self.stopped_after = None
        self.out = tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen(
            [str(word) for word in [*command, "--wait"]], stdin=subprocess.PIPE, stdout=self.out,
            stderr=subprocess.PIPE, text=True, preexec_fn=bound)
        self.said = []
        self.be_patient()
        self.preparing = threading.Thread(target=self.watch)
        self.preparing.start()

    def be_patient(self):
        """Stops the peer unless it says in time that it is prepared, or has searched."""
        self.start = time.monotonic()
        self.stopper = threading.Timer(self.patience, self.stop)
        self.stopper.start()

    def stop(self):
        self.stopped_after = time.monotonic() - self.start
        self.process.kill()

    def watch(self):
        for line in self.process.stderr:
            if line == "prepared\n":
                break
            self.said.append(line)
        self.stopper.cancel()

    def search(self):
        """The case with its findings, or how it failed. All peers are prepared."""
        if self.stopped_after is None:
            self.be_patient()
        try:
            _, log = self.process.communicate("go on\n")
        except BrokenPipeError:
            _, log = self.process.communicate()
        self.stopper.cancel()
        if self.stopped_after is not None:
            failed = {"after_seconds": self.stopped_after, "limit": self.patience}
        elif self.process.returncode != 0:
            failed = {"exit_code": self.process.returncode,
                      "log": ("".join(self.said) + log).strip()[-500:]}
        else:
            self.out.seek(0)
            return {**self.case, "findings": json.load(self.out)}
        return {**self.case, "failed": failed}


def cases(options):
    """The parameters of each case, and its command."""
    for name in options.peers:
        program = options.programs / f"peer_{name}"
        if not program.exists():
            print(f"{program}: not built, since its library was not found", file=sys.stderr)
            continue
        for cell in options.cells if name == "octomap" else [None]:
            command = [program, "--env", options.env, "--model", options.model, "--trajectory",
                       options.trajectory, "--radius", options.radius, "--threads",
                       options.threads, "--limit", options.limit]
            parameters = {"scene": options.scene, "peer": name, "threads": options.threads,
                          "radius": options.radius}
            if cell is not None:
                parameters["cell"] = float(cell)
                command += ["--cell", cell]
            yield parameters, command


def line_of(case):
    """One line of a case."""
    if "failed" in case:
        return f"{case['key']}: failed: {case['failed']}"
    found = case["findings"]
    return (f"{case['key']}: {found['all_poses_seconds']:.3g} s for all poses, one in "
            f"{found['every_pose']} searched; {found['false_hits']} false hits, "
            f"{found['misses']} misses of {found['colliding_points']}; prepared in "
            f"{found['prepare_seconds']:.1f} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=Path, help="folder of clearway and the peers")
    parser.add_argument("--scene", required=True, help="name of the scene in the file")
    for name in ("--env", "--model", "--trajectory"):
        parser.add_argument(name, required=True, help="as of clearway run")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the figures, a JSON file")
    parser.add_argument("--size", default="small", help="as of clearway-bench: small or full")
    parser.add_argument("--radius", type=float, default=0.1, help="metres")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--limit", type=float, default=60,
                        help="seconds of a search; where all poses take longer, every n-th is "
                             "searched, and the time is scaled")
    parser.add_argument("--patience", type=float, default=600,
                        help="seconds of a peer to prepare its search, and again to search and to compare")
    parser.add_argument("--memory", type=int, help="GiB that a peer may have (default: no bound)")
    parser.add_argument("--together", type=int, default=1,
                        help="peers that prepare their searches at the same time; each searches "
                             "alone")
    parser.add_argument("--peers", type=words, default=list(PEERS), help="default: all")
    parser.add_argument("--cells", type=words, default=["0.1", "0.05", "0.02", "0.01"],
                        help="edges of OctoMap's voxels in metres")
    options = parser.parse_args()
    record = (json.loads(options.output.read_text()) if options.output.exists() else
              {**header("peers", options.programs / "clearway", options.size), "cases": []})
    known = {case["key"] for case in record["cases"]}
    peers = []
    for parameters, command in cases(options):
        name = " ".join([parameters["peer"], *(f"{cell} m" for cell in [parameters.get("cell")]
                                               if cell)])
        key = f"{options.scene}/{name}/{options.threads} threads"
        if key not in known:
            peers.append((key, parameters, command))
    for first in range(0, len(peers), options.together):
        running = [Running(*peer, options) for peer in peers[first:first + options.together]]
        for peer in running:
            peer.preparing.join()
        for peer in running:
            record["cases"].append(peer.search())
            part = options.output.with_suffix(".part")
            part.write_text(json.dumps(record, indent=1) + "\n")
            part.replace(options.output)
            print(line_of(record["cases"][-1]), flush=True)


if __name__ == "__main__":
    main()
