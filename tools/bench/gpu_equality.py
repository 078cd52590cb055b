#!/usr/bin/env python3
"""Runs every mode of the CUDA engines on small scenes and compares each result with the CPU's, byte for byte, and the device memory taken with what was allowed; writes one JSON file.

    gpu_equality.py --program build/release/tools/clearway --work /tmp/equality --out figures.json [--gpus 0,1]
                    [--scenes hall ...] [--store site.h5 --model model.ply --trajectory path.txt]
"""
import argparse
import filecmp
import json
import pathlib
import subprocess
import sys

MODES = {"set": [], "first-pose": ["--first-pose"], "between-poses": ["--between-poses"],
         "between-poses first-pose": ["--between-poses", "--first-pose"], "clearance": ["--clearance", "0.3"],
         "clearance first-pose": ["--clearance", "0.05", "--first-pose"],
         "clearance 0.3 first-pose": ["--clearance", "0.3", "--first-pose"]}
DEVICE_MEMORY = {"256M": 256 << 20, "2G": 2 << 30}
GRID_MODES = ["set", "first-pose"]
SCENES = ["hall", "plant", "mine", "tunnel"]


def call(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stderr}")
    return done.stdout


def scenes(options):
    for kind in options.scenes:
        folder = options.work / kind
        call(options.program, "scene", kind, "-o", folder, "--points", options.points, "--model-points", "20000", "--poses", "4000", "--force")
        for cell_points in ("1000", "65536"):
            store = folder / f"{cell_points}.h5"
            call(options.program, "convert", folder / "environment.las", "-o", store, "--cell-points", cell_points, "--force")
            yield f"{kind}, cells of {cell_points}", store, folder / "model.ply", folder / "trajectory.txt"
    if options.store:
        yield "given", options.store, options.model, options.trajectory


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=lambda name: pathlib.Path(name).resolve(), required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--scenes", nargs="*", choices=SCENES, default=SCENES)
    parser.add_argument("--points", default="1000000")
    parser.add_argument("--gpus")
    parser.add_argument("--store", type=pathlib.Path)
    parser.add_argument("--model", type=pathlib.Path)
    parser.add_argument("--trajectory", type=pathlib.Path)
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    where = ["--gpus", options.gpus] if options.gpus else ["--device", "cuda"]
    runs, differing, over = [], 0, 0
    for name, store, model, trajectory in scenes(options):
        ask = ["run", "--env", store, "--model", model, "--trajectory", trajectory, "--radius", "0.1", "--force", "--json"]
        for mode, extra in MODES.items():
            expected = options.work / "cpu.h5"
            report = json.loads(call(options.program, *ask, "-o", expected, "--device", "cpu", *extra))
            for engine in ["sweep"] + (["grid"] if mode in GRID_MODES else []):
                for memory, most_bytes in DEVICE_MEMORY.items():
                    found = options.work / "cuda.h5"
                    on_device = json.loads(call(options.program, *ask, "-o", found, "--engine", engine, *where,
                                                "--device-memory", memory, *extra))
                    same = filecmp.cmp(expected, found, shallow=False)
                    differing += not same
                    over += on_device["peak_device_bytes"] > most_bytes
                    runs.append({"scene": name, "mode": mode, "engine": engine, "device_memory": memory, "same": same,
                                 "colliding_points": report["colliding_points"],
                                 "peak_device_bytes": on_device["peak_device_bytes"]})
        options.out.write_text(json.dumps({"runs": len(runs), "differing": differing, "over_device_memory": over, "each": runs}, indent=1) + "\n")
    print(f"{len(runs)} runs, {differing} differ from the CPU's, {over} took more than --device-memory")
    sys.exit(1 if differing or over else 0)


if __name__ == "__main__":
    main()
