"""What memory and reading a question demands for each place of a store, a cell having as many places
as its points: python3 tools/bench/demand.py PROGRAM FOLDER [--points N].

Makes the scene `hall` twice in FOLDER, with N points and with twice as many, and asks both the same
questions with one thread. What grows from the one to the other, divided by the places that were
added, is demanded by points; the rest is the same for every store.
"""
import argparse
import json
import pathlib
import subprocess

PLAIN = ["--engine", "sweep"]
CHECK = PLAIN + ["--first-pose", "--clearance", "0.5", "--profile", "0.5"]
ERRORS = ["--error-scan", "0.01", "--error-pose", "0.01"]
QUESTIONS = {
    "set": PLAIN,
    "first and last poses": PLAIN + ["--first-pose"],
    "clearances": PLAIN + ["--clearance", "0.5"],
    "as check asks": CHECK,
    "check, errors": CHECK + ERRORS,
    "check, floor": CHECK + ["--floor", "0.2"],
    "check, ignored box": CHECK + ["--ignore-box", "-1000,-1000,-1000,1000,1000,0.5"],
    "depth": PLAIN + ["--depth"],
    "check, shard 1/16": CHECK + ["--shard", "1/16"],
    "kdtree": ["--engine", "kdtree"],
}


def run(program, *arguments):
    words = [program, *map(str, arguments)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1, 6):
        raise SystemExit(f"{' '.join(words)}: {done.stderr}")
    return done.stdout


def scene(program, folder, points):
    """The store, model and trajectory of a scene with so many points."""
    made = folder / str(points)
    if not (made / "site.h5").exists():
        made.mkdir(parents=True, exist_ok=True)
        run(program, "scene", "hall", "-o", made, "--points", points, "--force")
        run(program, "convert", made / "environment.las", "-o", made / "site.h5", "--json")
        lines = (made / "trajectory.txt").read_text().splitlines(keepends=True)
        poses = [line for line in lines if not line.startswith("#")]
        (made / "ten.txt").write_text("".join(poses[:: max(1, len(poses) // 10)][:10]))
    return made


def answer(program, folder, options, trajectory):
    return json.loads(run(program, "run", "--json", "--force", "--threads", 1, "--env",
                          folder / "site.h5", "--model", folder / "model.ply", "--trajectory",
                          folder / trajectory, "--radius", "0.1", "-o", folder / "out.h5",
                          *options))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--points", type=int, default=1_000_000)
    given = parser.parse_args()
    small, large = (scene(given.program, given.folder, n) for n in (given.points, 2 * given.points))
    cell_points = json.loads(run(given.program, "info", "--json", large / "site.h5"))["cell_points"]
    print("| question | bytes demanded a place | whole demand | coordinates | sources | classes "
          "| peak | seconds |")
    print("|---|---|---|---|---|---|---|---|")
    asked = [(name, options, "trajectory.txt") for name, options in QUESTIONS.items()]
    asked.append(("check, ten poses", CHECK, "ten.txt"))
    for name, options, trajectory in asked:
        less, more = (answer(given.program, of, options, trajectory) for of in (small, large))
        places = cell_points * (more["cells_total"] - less["cells_total"])
        demanded = (more["needed_host_bytes"] - less["needed_host_bytes"]) / places
        read = more["bytes_read"]
        print(f"| {name} | {demanded:.3f} | {more['needed_host_bytes'] / 2**20:.1f} MiB "
              f"| {read['coordinates']:,} | {read['sources']:,} | {read['classes']:,} "
              f"| {more['peak_host_bytes'] / 2**20:.1f} MiB | {more['seconds']['total']:.2f} |")


if __name__ == "__main__":
    main()
