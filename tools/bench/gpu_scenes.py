#!/usr/bin/env python3
"""Makes, converts and runs the four scenes at a share of the paper's sizes on a machine with a GPU; writes one JSON file.

    gpu_scenes.py --program build/release/tools/clearway --work /tmp/scenes --out figures.json [--share 1] [--scenes hall ...]

Every run is made cold once (the store's pages dropped from the page cache) and warm several times; the cells of the same
pages are read alone too, by clearway_stage_bench beside the program. A scene whose store lies in the work folder is not made again.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import time

POINTS = {"mine": 806_183_400, "hall": 55_872_714, "plant": 350_109_065, "tunnel": 18_919_000}
RADIUS = "0.1"


def timed(command):
    begin = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True)
    seconds = time.monotonic() - begin
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stderr}")
    return seconds, done.stdout, done.stderr


def drop_from_page_cache(path):
    with open(path, "rb") as file:
        os.fsync(file.fileno())
        os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def question(folder, store):
    return ["--env", store, "--model", folder / "model.ply", "--trajectory", folder / "trajectory.txt", "--radius", RADIUS]


def run(options, folder, store, extra, cold=False):
    if cold:
        drop_from_page_cache(store)
    output = folder / "out.h5"
    _, report, log = timed([options.program, "run", *question(folder, store), "-o", output, "--force", "--json", *extra])
    figures = json.loads(report)
    figures["log"] = [line for line in log.splitlines() if "info" in line]
    return figures


def stages(options, folder, store, extra, cold):
    if cold:
        drop_from_page_cache(store)
    bench = options.program.with_name("clearway_stage_bench")
    return json.loads(timed([bench, *question(folder, store), *extra])[1])


def make(options, kind, folder):
    """The store of the scene, and what making it took; one that lies there already is used."""
    points = round(POINTS[kind] * options.share)
    folder.mkdir(parents=True, exist_ok=True)
    store = folder / "site.h5"
    figures = {"points": points}
    if not store.exists():
        figures["scene_seconds"], _, _ = timed([options.program, "scene", kind, "-o", folder, "--points", str(points)])
        figures["convert_seconds"], _, _ = timed([options.program, "convert", folder / "environment.las", "-o", store, "--memory", options.memory,
                                                  *(["--cell-points", options.cell_points] if options.cell_points else [])])
        (folder / "environment.las").unlink()
    return store, figures | {"store_bytes": store.stat().st_size}


def measure(options, kind):
    folder = options.work / kind
    store, figures = make(options, kind, folder)
    sweep = ["--engine", "sweep", "--device", "cuda", "--device-memory", options.device_memory, "--memory", options.memory]
    figures["sweep_cold"] = run(options, folder, store, sweep, cold=True)
    figures["read_cold"] = stages(options, folder, store, [], cold=True)
    figures["sweep_warm"] = [run(options, folder, store, sweep) for _ in range(options.repetitions)]
    figures["read_warm"] = [stages(options, folder, store, [], cold=False) for _ in range(options.repetitions)]
    if kind in options.grid:
        grid = ["--engine", "grid", *sweep[2:]]
        figures["grid_warm"] = [run(options, folder, store, grid) for _ in range(options.repetitions)]
    if options.discard:
        for file in folder.iterdir():
            file.unlink()
    return figures


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=lambda name: pathlib.Path(name).resolve(), required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--share", type=float, default=1.0, help="of the paper's environment points")
    parser.add_argument("--scenes", nargs="+", choices=POINTS, default=list(POINTS))
    parser.add_argument("--grid", nargs="*", choices=POINTS, default=["hall"], help="scenes for the grid engine")
    parser.add_argument("--cell-points")
    parser.add_argument("--device-memory", default="2G")
    parser.add_argument("--memory", default="32G")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--discard", action="store_true", help="remove each scene when it is done")
    options = parser.parse_args()
    machine = subprocess.run(["nvidia-smi", "--query-gpu=name,driver_version", "--format=csv,noheader"],
                             capture_output=True, text=True).stdout.strip()
    results = {"machine": {"gpu": machine, "cores": len(os.sched_getaffinity(0))}, "device_memory": options.device_memory, "scenes": {}}
    for kind in options.scenes:
        results["scenes"][kind] = measure(options, kind)
        options.out.write_text(json.dumps(results, indent=1) + "\n")
        print(kind, "done", flush=True)


if __name__ == "__main__":
    main()
