#!/usr/bin/python3
"""Counts which warnings Clearway gives for inputs in which nothing is wrong, and which of them would
make an answer undecided.

- All scenes of `clearway scene`, each with its own model and path: as they are, with poses only,
  with a floor, with every tenth pose and as a vehicle of one body.
- With --data, a folder of real data: street (scan, model, path), trajectories, alignments and
  formats. Each trajectory is asked about points around its positions, with a box as its model. Each
  scan in formats is converted, and asked about as it is.

It prints a table with the number of inputs for which each code came, and of those whose answer it
puts in doubt. Exits with 1 where any answer is in doubt, or one of --none came. Needs numpy.
Example: tools/false_alarms.py build/release/tools/clearway --none below-ground,cant-side
"""

import argparse
import collections
import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

SCENES = {"hall": "--points 300000 --model-points 20000 --poses 2000",
          "plant": "--points 300000 --model-points 20000 --poses 4000",
          "mine": "--points 300000 --model-points 20000 --poses 4000",
          "tunnel": "--points 300000 --model-points 20000 --poses 4000",
          "road": "--points 300000 --model-points 20000 --poses 1000"}
MODEL = "--model model.ply"
VARIANTS = {"poses": MODEL, "between": MODEL + " --between-poses",
            "floor": MODEL + " --floor {cut}", "few poses": MODEL + " --trajectory few.txt",
            "coarse": MODEL + " --radius 0.5", "vehicle": "--vehicle vehicle.json"}
SEEDS = (1, 2, 3)


class Trial:
    def __init__(self, program):
        self.program = Path(program).resolve()
        self.inputs, self.counts, self.doubts = 0, collections.Counter(), collections.Counter()

    def call(self, folder, words):
        done = subprocess.run([self.program, *words.split()], cwd=folder, capture_output=True,
                              text=True, check=False)
        if done.returncode not in (0, 1, 6):
            sys.exit(f"{words}: exit code {done.returncode}: {done.stderr}")
        return done.stdout

    def count(self, name, answer, of_question=True):
        """of_question: whether nothing is wrong with the question either, beside the scan."""
        answer = json.loads(answer)
        codes = sorted({warning["code"] for warning in answer["warnings"]})
        doubts = [code for code in answer.get("doubts", [])
                  if of_question or code.startswith("store-")]
        self.inputs += 1
        self.counts.update(codes)
        self.doubts.update(doubts)
        print(f"{name}: {' '.join(codes) or 'no warning'}"
              + (f"; IN DOUBT: {' '.join(doubts)}" if doubts else ""), flush=True)

    def scenes(self):
        for kind, sizes in SCENES.items():
            for seed in SEEDS:
                with tempfile.TemporaryDirectory() as folder:
                    self.scene(Path(folder), kind, f"{sizes} --seed {seed}", f"{kind} {seed}")

    def scene(self, folder, kind, sizes, name):
        self.call(folder, f"scene {kind} {sizes} -o .")
        self.call(folder, "convert environment.las -o site.h5")
        lines = (folder / "trajectory.txt").read_text().splitlines(keepends=True)
        (folder / "few.txt").write_text("".join(lines[::10]))
        (folder / "vehicle.json").write_text(json.dumps(
            {"bodies": [{"name": "whole", "model": "model.ply", "at": 0}]}))
        facts = json.loads(self.call(folder, "model model.ply --json"))
        cut = facts["bounds"]["lo"][2] + 0.3
        for variant, words in VARIANTS.items():
            words = words.format(cut=cut)
            path = "" if "--trajectory" in words else "--trajectory trajectory.txt"
            radius = "" if "--radius" in words else "--radius 0.1"
            self.count(f"{name}, {variant}", self.call(
                folder, f"run --env site.h5 {path} {radius} {words} --json --force -o out.h5"))

    def street(self, data):
        with tempfile.TemporaryDirectory() as folder:
            self.call(folder, f"convert {data}/street.las -o site.h5")
            for variant, words in {"beetle": "", "beetle, floor": "--floor 0.3",
                                   "beetle, between": "--between-poses"}.items():
                self.count(f"street, {variant}", self.call(
                    folder, f"run --env site.h5 --model {data}/beetle.ply --trajectory "
                    f"{data}/trajectory.txt --radius 0.1 {words} --json --force -o out.h5"))

    def formats(self, data):
        for file in sorted(data.iterdir()):
            with tempfile.TemporaryDirectory() as folder:
                done = subprocess.run([self.program, "convert", file, "--json", "-o", "site.h5"],
                                      cwd=folder, capture_output=True, text=True, check=False)
                if done.returncode != 0:
                    print(f"{file.name}: refused: {done.stderr.strip().splitlines()[-1]}")
                    continue
                made = json.loads(done.stdout)
                if made["points"] == 0:
                    continue
                x, y, z = np.mean([made["box"]["lo"], made["box"]["hi"]], axis=0)
                (Path(folder) / "path.txt").write_text(
                    "".join(f"1 0 0 {x + 0.1 * i} 0 1 0 {y} 0 0 1 {z}\n" for i in range(20)))
                self.count(file.name, self.call(
                    folder, "run --env site.h5 --model box:4,2,1.5 --trajectory path.txt "
                    "--radius 0.1 --json -o out.h5"), of_question=False)

    def trajectories(self, data):
        for file in sorted(data.iterdir()):
            with tempfile.TemporaryDirectory() as folder:
                info = json.loads(self.call(folder, f"trajectory info {file} --json"))
                self.count(f"{file.name}, info", json.dumps(info))
                self.call(folder, f"trajectory follow {file} --at 0 -o path.csv")
                with open(Path(folder) / "path.csv", encoding="utf-8", newline="") as table:
                    columns = [name.split()[0] for name in next(csv.reader(table))]
                    positions = np.loadtxt(table, delimiter=",",
                                           usecols=[columns.index(axis) for axis in "xyz"])[::10]
                around = np.random.default_rng(1).uniform(-4, 4, (len(positions), 50, 3))
                np.savetxt(Path(folder) / "scan.xyz",
                           (positions[:, None] + around).reshape(-1, 3), "%.3f")
                self.call(folder, "convert scan.xyz --unit m -o site.h5")
                self.count(f"{file.name}, run", self.call(
                    folder, f"run --env site.h5 --model box:1,0.5,0.5 --trajectory {file} "
                    "--radius 0.05 --first-pose --allow-non-rigid --json -o out.h5"))

    def alignments(self, data):
        for file in sorted(f for f in data.iterdir() if f.suffix.lower() == ".xml"):
            with tempfile.TemporaryDirectory() as folder:
                for height in ("", "--height 0"):
                    words = f"trajectory alignment {file} --json {height} --force -o path.csv"
                    done = subprocess.run([self.program, *words.split()], cwd=folder,
                                          capture_output=True, text=True, check=False)
                    if done.returncode == 0:
                        self.count(file.name, done.stdout)
                        self.count(f"{file.name}, info", self.call(
                            folder, "trajectory info path.csv --json"))
                        break
                else:
                    print(f"{file.name}: refused: {done.stderr.strip().splitlines()[-1]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the program clearway")
    parser.add_argument("--data", type=Path, help="folder of real data")
    parser.add_argument("--data-only", action="store_true", help="leave out the scenes")
    parser.add_argument("--none", default="", help="codes that must not come, with commas between")
    options = parser.parse_args()
    trial = Trial(options.program)
    if not options.data_only:
        trial.scenes()
    if options.data:
        data = options.data.resolve()
        trial.street(data / "street")
        trial.trajectories(data / "trajectories")
        trial.alignments(data / "alignments")
        trial.formats(data / "formats")
    watched = [code for code in options.none.split(",") if code]
    print(f"\n| code | of {trial.inputs} inputs | in doubt |\n|---|---|---|")
    for code in sorted(set(trial.counts) | set(watched)):
        print(f"| `{code}` | {trial.counts[code]} | {trial.doubts[code]} |")
    return int(bool(trial.doubts) or any(trial.counts[code] for code in watched))


if __name__ == "__main__":
    sys.exit(main())
