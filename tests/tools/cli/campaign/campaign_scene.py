"""A small hall and campaigns in it, for the tests of `clearway campaign`. The program is the first
argument of the script."""

import json
import os
import subprocess
import sys

PROGRAM = os.path.abspath(sys.argv[1])


def expect(condition, what):
    if not condition:
        sys.exit(f"{sys.argv[0]}: {what}")


def outcome(*words, **options):
    return subprocess.run([PROGRAM, *map(str, words)], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, **options)


def program(*words):
    """Standard output; the command has to succeed."""
    done = outcome(*words)
    expect(done.returncode == 0, f"{words}: exit code {done.returncode}: {done.stderr}")
    return done.stdout


def status(path):
    return json.loads(program("campaign", "status", path, "--json"))


def scene(folder, points, model_points, poses, seed=1):
    program("scene", "hall", "--points", points, "--model-points", model_points, "--poses", poses,
            "--seed", seed, "-o", folder)


def make_scene(work, vehicles, routes, slow=()):
    """site.h5, vehicles/vNN.ply and routes/rNN.txt. slow: numbers of vehicles with a large model."""
    scene(work / "hall", 30000, 300, 150)
    program("convert", work / "hall/environment.las", "--cell-points", 1000, "-o",
            work / "site.h5")
    (work / "vehicles").mkdir()
    (work / "routes").mkdir()
    model = (work / "hall/model.ply").read_bytes()
    if slow:
        scene(work / "large", 1000, 200000, 10)
    for i in range(vehicles):
        own = (work / "large/model.ply").read_bytes() if i in slow else model
        (work / f"vehicles/v{i:02}.ply").write_bytes(own)
    lines = (work / "hall/trajectory.txt").read_text().splitlines(keepends=True)
    for i in range(routes):
        (work / f"routes/r{i:02}.txt").write_text("".join(lines[i:]))


def write_campaign(work, **changes):
    campaign = {"name": "Test", "environments": {"hall": "site.h5"},
                "vehicles": {"all": {"model": "vehicles/*.ply"}},
                "routes": {"all": {"trajectory": "routes/*.txt"}}, "radii": [0.1],
                "query": {"first_pose": True}, "outputs": {"conflicts": ["csv"]},
                "limits": {"memory": "300M", "threads": 1}}
    campaign.update(changes)
    (work / "campaign.json").write_text(json.dumps(campaign))
    return work / "campaign.json"
