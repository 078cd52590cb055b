#!/usr/bin/python3
"""Measures the seconds of `clearway check`, from the scan to the report, by the number of points.

Each case is made in a folder of its own and removed, so the disk needs room for the largest alone:
80 bytes a point. The scan is in the page cache.
Example: tools/check_cost.py build/release/tools/clearway -o check.json --points 1000000,10000000 \\
             --threads 2,16
tools/charts.py draws the file.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from trials.header import header


def numbers(text):
    return [int(number) for number in text.split(",")]


def check(program, scene, how):
    """The answer of one check of a scene, whose files are removed again, with its peak memory."""
    folder = scene / "site"
    command = [program, "check", scene / "environment.las", "--model", scene / "model.ply",
               "--trajectory", scene / "trajectory.txt", "--radius", "0.1", "-o", folder, "--json",
               *how]
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as log:
        process = subprocess.Popen([str(word) for word in command], stdout=out, stderr=log)
        _, status, usage = os.wait4(process.pid, 0)
        shutil.rmtree(folder, ignore_errors=True)
        out.seek(0)
        log.seek(0)
        if status != 0:
            sys.exit(f"{' '.join(map(str, command))}: failed\n{log.read()}")
        return json.load(out), usage.ru_maxrss * 1024


def run_of(answer, peak_bytes):
    seconds = answer["seconds"]
    return {"seconds": {**seconds, "total": sum(seconds.values())}, "peak_host_bytes": peak_bytes}


def ways(options):
    """Options of a check, with the name of the way to do it."""
    for threads in options.threads:
        way = "1 core" if threads == 1 else f"{threads} cores"
        yield way, ["--threads", threads, "--device", "cpu"]
    if options.gpu:
        yield "GPU", ["--device", "cuda"]


def cases(options, folder):
    for points in options.points:
        scene = folder / str(points)
        subprocess.run([options.program, "scene", options.scene, "--points", str(points), "-o",
                        scene], check=True, capture_output=True)
        for way, how in ways(options):
            answers = [check(options.program, scene, [*how, *options.more])
                       for _ in range(options.runs)]
            runs = [run_of(*answer) for answer in answers]
            print(points, way, *(f"{run['seconds']['total']:.2f}" for run in runs),
                  file=sys.stderr)
            yield {"key": f"{options.scene}/{points}/{way}",
                   "parameters": {"scene": options.scene, "points": points, "way": way},
                   "runs": runs,
                   "findings": {"colliding_points": answers[0][0]["run"]["colliding_points"]}}
        shutil.rmtree(scene)


def gpu_names():
    found = shutil.which("nvidia-smi")
    if not found:
        return []
    return subprocess.run([found, "--query-gpu=name", "--format=csv,noheader"],
                          capture_output=True, text=True).stdout.splitlines()


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path, help="the clearway that is measured")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the figures, a JSON file")
    parser.add_argument("--scene", default="hall", help="as clearway scene names it")
    parser.add_argument("--points", type=numbers, default=[1_000_000, 3_000_000, 10_000_000],
                        help="numbers of environment points")
    parser.add_argument("--threads", type=numbers, default=[2], help="numbers of threads")
    parser.add_argument("--gpu", action="store_true", help="measure on a GPU too")
    parser.add_argument("--with", dest="more", type=str.split, default=[],
                        help='more options of clearway check, for example "--memory 24G"')
    parser.add_argument("--runs", type=int, default=3, help="runs of each case")
    parser.add_argument("--work", type=Path, help="folder for the scenes (default: a temporary one)")
    options = parser.parse_args()
    record = header("check", options.program, "small", gpu_names())
    with tempfile.TemporaryDirectory(dir=options.work) as folder:
        record["cases"] = []
        for case in cases(options, Path(folder)):
            record["cases"].append(case)
            options.output.write_text(json.dumps(record, indent=1) + "\n")


if __name__ == "__main__":
    main()
