#!/usr/bin/env python3
"""Runs a scene on one GPU and on more and compares the results; writes one JSON file.

    gpu_count.py --program build/release/tools/clearway --work /tmp/gpus --out figures.json --gpus 2 [--scenes plant] [--share 1]

A scene whose store lies in the work folder is not made again.
"""
import argparse
import filecmp
import json
import pathlib
import subprocess
import sys

POINTS = {"mine": 806_183_400, "hall": 55_872_714, "plant": 350_109_065, "tunnel": 18_919_000}


def call(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stderr}")
    return done.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=lambda name: pathlib.Path(name).resolve(), required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--gpus", type=int, required=True)
    parser.add_argument("--scenes", nargs="+", choices=POINTS, default=["hall", "plant"])
    parser.add_argument("--share", type=float, default=1.0)
    parser.add_argument("--repetitions", type=int, default=3)
    options = parser.parse_args()
    results = {"gpus": options.gpus, "runs": []}
    for kind in options.scenes:
        folder = options.work / kind
        if not (folder / "site.h5").exists():
            call(options.program, "scene", kind, "-o", folder, "--points", round(POINTS[kind] * options.share), "--force")
            call(options.program, "convert", folder / "environment.las", "-o", folder / "site.h5", "--memory", "32G")
        ask = [options.program, "run", "--env", folder / "site.h5", "--model", folder / "model.ply", "--trajectory",
               folder / "trajectory.txt", "--radius", "0.1", "--force", "--json", "--device-memory", "2G", "--memory", "32G"]
        for engine in ("sweep", "grid"):
            for gpus in (1, options.gpus):
                names = ",".join(str(gpu) for gpu in range(gpus))
                for _ in range(options.repetitions):
                    output = folder / f"{gpus}.h5"
                    report = json.loads(call(*ask, "-o", output, "--engine", engine, "--gpus", names))
                    results["runs"].append({"scene": kind, "engine": engine, "gpus": gpus, "seconds": report["seconds"],
                                            "colliding_points": report["colliding_points"],
                                            "same": filecmp.cmp(folder / "1.h5", output, shallow=False)})
                    run = results["runs"][-1]
                    print(kind, engine, gpus, "same" if run["same"] else "DIFFERS",
                          {stage: round(run["seconds"][stage], 4) for stage in ("context", "search", "read", "compute")}, flush=True)
    options.out.write_text(json.dumps(results, indent=1) + "\n")
    sys.exit(0 if all(run["same"] for run in results["runs"]) else 1)


if __name__ == "__main__":
    main()
