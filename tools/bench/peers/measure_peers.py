#!/usr/bin/env python3
"""Measures the peers of tools/bench/peers/programs on one scene, and adds what they gave to a file.

measure_peers.py PROGRAMS --scene NAME --env STORE --model MODEL --trajectory PATH -o peers.json
                 [--radius 0.1] [--threads N] [--limit 60] [--cells 0.01,0.02,0.05,0.1]

PROGRAMS: the folder with peer_nanoflann and the others; those that are missing are named. A record
that the file has already, of the same scene, peer, cell and threads, is not measured again, so a
measurement that was stopped goes on.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys

PEERS = ("nanoflann", "cgal", "pcl", "open3d", "octomap")


def measured(program, arguments, cell):
    words = [program, "--env", arguments.env, "--model", arguments.model, "--trajectory",
             arguments.trajectory, "--radius", str(arguments.radius), "--threads",
             str(arguments.threads), "--limit", str(arguments.limit)]
    if cell is not None:
        words += ["--cell", str(cell)]
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        # A peer that fails is part of the answer, so it is kept with what it said.
        return {"failed": done.returncode, "message": done.stderr.strip()[-500:]}
    return json.loads(done.stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    for name in ("--scene", "--env", "--model", "--trajectory"):
        parser.add_argument(name, required=True)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--radius", type=float, default=0.1)
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--limit", type=float, default=60)
    parser.add_argument("--cells", default="0.1,0.05,0.02,0.01",
                        help="edges of OctoMap's voxels in metres")
    arguments = parser.parse_args()
    records = json.loads(arguments.output.read_text()) if arguments.output.exists() else []
    for name in PEERS:
        program = arguments.programs / f"peer_{name}"
        if not program.exists():
            print(f"{program}: not built, since its library was not found", file=sys.stderr)
            continue
        cells = arguments.cells.split(",") if name == "octomap" else [None]
        for cell in cells:
            key = {"scene": arguments.scene, "program": name, "threads": arguments.threads,
                   "cell": None if cell is None else float(cell)}
            if any(all(record[word] == value for word, value in key.items())
                   for record in records):
                continue
            record = {**key, **measured(program, arguments, cell)}
            records.append(record)
            part = arguments.output.with_suffix(".part")
            part.write_text(json.dumps(records, indent=1) + "\n")
            part.replace(arguments.output)
            if "failed" in record:
                print(f"{name}: failed with {record['failed']}: {record['message']}", flush=True)
                continue
            print(f"{name}{'' if cell is None else ' ' + cell + ' m'}: "
                  f"{record['all_poses_seconds']:.3g} s for all poses, one in "
                  f"{record['every_pose']} searched; {record['false_hits']} false hits, "
                  f"{record['misses']} misses of {record['colliding_points']}", flush=True)


main()
