#!/usr/bin/python3
"""Runs the sweep and kdtree engines on the cases that are hard for a sweep; prints one JSON object.

Usage: tools/bench/hard_cases.py PROGRAM FOLDER [--points N]
Scenes and results go to FOLDER. Every case is answered by both engines; equal says whether the results
are the same bytes.
"""
import argparse
import filecmp
import json
import pathlib
import subprocess

import numpy as np


def run(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, arguments))}: {done.stderr}")
    return done.stdout


def make_scene(program, folder, kind, points, model_points=None):
    name = f"{kind}_{model_points or 'full'}"
    out = folder / name
    if not (folder / f"{name}.h5").exists():
        extra = ["--model-points", model_points] if model_points else []
        run(program, "scene", kind, "--points", points, *extra, "-o", out, "--force")
        run(program, "convert", out / "environment.las", "-o", folder / f"{name}.h5", "--force")
    return folder / f"{name}.h5", out / "model.ply", np.loadtxt(out / "trajectory.txt")


def orthonormal(poses):
    """Rows of 12 numbers whose rotations are made rotations again (nearest, by SVD)."""
    matrices = poses.reshape(-1, 3, 4).copy()
    u, _, v = np.linalg.svd(matrices[:, :, :3])
    matrices[:, :, :3] = u @ v
    return matrices.reshape(-1, 12)


def resampled(poses, count):
    at = np.linspace(0, len(poses) - 1, count)
    return orthonormal(np.stack([np.interp(at, range(len(poses)), c) for c in poses.T], axis=1))


def turned_on_the_spot(pose, count):
    base = pose.reshape(3, 4)
    out = []
    for angle in np.linspace(0, 2 * np.pi, count):
        turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        out.append(np.hstack([base[:, :3] @ turn, base[:, 3:]]).ravel())
    return np.array(out)


def shifted_aside(poses, metres):
    matrices = poses.reshape(-1, 3, 4).copy()
    matrices[:, :, 3] += metres * matrices[:, :, 1]
    return matrices.reshape(-1, 12)


def jittered_passes(poses, passes):
    random = np.random.default_rng(1)
    rounds = []
    for i in range(passes):
        moved = poses[:: 1 if i % 2 == 0 else -1].copy()
        moved[:, [3, 7, 11]] += random.normal(0, 0.005, 3)
        rounds.append(moved)
    return np.vstack(rounds)


def cases(program, folder, points):
    hall = make_scene(program, folder, "hall", points)
    tunnel = make_scene(program, folder, "tunnel", points)
    poses = hall[2]
    yield "hall as it is", hall, poses, 0.1, []
    yield "rotation on the spot, 10,000 poses", hall, turned_on_the_spot(poses[len(poses) // 2], 10000), 0.1, []
    yield "twenty passes, to and fro", hall, jittered_passes(poses, 20), 0.1, []
    for metres in (0.5, 1.0, 1.5):
        yield f"tunnel, wagon shifted {metres} m to the wall", tunnel, shifted_aside(tunnel[2], metres), 0.1, []
    for radius in (0.001, 0.01):
        yield f"r = {radius} m, voxel 0.05 m", hall, poses, radius, ["--field-voxel", 0.05]
        yield f"r = {radius} m, voxel chosen", hall, poses, radius, []
    for count in (100, 1000, 10000, 100000, 1000000):
        yield f"|T| = {count}", hall, resampled(poses, count), 0.1, []
    for count in (1000, 10000, 100000, 1000000):
        scene = make_scene(program, folder, "hall", points, count)
        yield f"|M| = {count}", scene, poses, 0.1, []


def measure(program, folder, name, scene, poses, radius, extra):
    store, model, _ = scene
    trajectory = folder / "trajectory.txt"
    np.savetxt(trajectory, poses, fmt="%.9g")
    row = {"case": name, "poses": len(poses), "radius": radius}
    for engine in ("sweep", "kdtree"):
        out = folder / f"{engine}.h5"
        options = extra if engine == "sweep" else []
        report = json.loads(run(program, "run", "--env", store, "--model", model, "--trajectory", trajectory,
                                "--radius", radius, "-o", out, "--force", "--json", "--engine", engine, *options))
        row[engine] = {k: round(report["seconds"][k], 4) for k in ("plan", "field", "compute", "total")}
    row["colliding_points"] = report["colliding_points"]
    row["searches"] = report["searches"]
    row["equal"] = filecmp.cmp(folder / "sweep.h5", folder / "kdtree.h5", shallow=False)
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--points", type=int, default=1000000)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    rows = [measure(options.program, options.folder, *case)
            for case in cases(options.program, options.folder, options.points)]
    print(json.dumps({"environment_points": options.points, "cases": rows}, indent=1))


if __name__ == "__main__":
    main()
