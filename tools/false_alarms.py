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
import shutil
import subprocess
import sys
import tempfile
from itertools import product
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
    """Asks the program in a folder that every scan or path has for itself."""

    def __init__(self, program, folder):
        self.program, self.folder = Path(program).resolve(), folder
        self.inputs, self.counts, self.doubts = 0, collections.Counter(), collections.Counter()

    def begin(self):
        shutil.rmtree(self.folder)
        self.folder.mkdir()

    def tried(self, words):
        """What a command prints; None where it fails, and then `failed` says why."""
        done = self.failed = subprocess.run([self.program, *words.split()], cwd=self.folder,
                                            capture_output=True, text=True, check=False)
        return done.stdout if done.returncode in (0, 1, 6) else None

    def call(self, words):
        printed = self.tried(words)
        if printed is None:
            sys.exit(f"{words}: exit code {self.failed.returncode}: {self.failed.stderr}")
        return printed

    def refused(self, file):
        print(f"{file.name}: refused: {self.failed.stderr.strip().splitlines()[-1]}")

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

    def run(self, name, words, **how):
        self.count(name, self.call(f"run --env site.h5 {words} --json --force -o out.h5"), **how)

    def scenes(self):
        for (kind, sizes), seed in product(SCENES.items(), SEEDS):
            self.begin()
            self.call(f"scene {kind} {sizes} --seed {seed} -o .")
            self.call("convert environment.las -o site.h5")
            lines = (self.folder / "trajectory.txt").read_text().splitlines(keepends=True)
            (self.folder / "few.txt").write_text("".join(lines[::10]))
            (self.folder / "vehicle.json").write_text(json.dumps(
                {"bodies": [{"name": "whole", "model": "model.ply", "at": 0}]}))
            facts = json.loads(self.call("model model.ply --json"))
            for variant, words in VARIANTS.items():
                words = words.format(cut=facts["bounds"]["lo"][2] + 0.3)
                path = "" if "--trajectory" in words else "--trajectory trajectory.txt"
                radius = "" if "--radius" in words else "--radius 0.1"
                self.run(f"{kind} {seed}, {variant}", f"{path} {radius} {words}")

    def street(self, data):
        self.begin()
        self.call(f"convert {data}/street.las -o site.h5")
        for variant, words in {"beetle": "", "beetle, floor": "--floor 0.3",
                               "beetle, between": "--between-poses"}.items():
            self.run(f"street, {variant}", f"--model {data}/beetle.ply --trajectory "
                     f"{data}/trajectory.txt --radius 0.1 {words}")

    def formats(self, data):
        for file in sorted(data.iterdir()):
            self.begin()
            made = self.tried(f"convert {file} --json -o site.h5")
            if made is None:
                self.refused(file)
                continue
            made = json.loads(made)
            if made["points"] == 0:
                continue
            x, y, z = np.mean([made["box"]["lo"], made["box"]["hi"]], axis=0)
            (self.folder / "path.txt").write_text(
                "".join(f"1 0 0 {x + 0.1 * i} 0 1 0 {y} 0 0 1 {z}\n" for i in range(20)))
            self.run(file.name, "--model box:4,2,1.5 --trajectory path.txt --radius 0.1",
                     of_question=False)

    def trajectories(self, data):
        for file in sorted(data.iterdir()):
            self.begin()
            self.count(f"{file.name}, info", self.call(f"trajectory info {file} --json"))
            self.call(f"trajectory follow {file} --at 0 -o path.csv")
            with open(self.folder / "path.csv", encoding="utf-8", newline="") as table:
                columns = [name.split()[0] for name in next(csv.reader(table))]
                positions = np.loadtxt(table, delimiter=",",
                                       usecols=[columns.index(axis) for axis in "xyz"])[::10]
            around = np.random.default_rng(1).uniform(-4, 4, (len(positions), 50, 3))
            np.savetxt(self.folder / "scan.xyz", (positions[:, None] + around).reshape(-1, 3), "%.3f")
            self.call("convert scan.xyz --unit m -o site.h5")
            self.run(f"{file.name}, run", f"--model box:1,0.5,0.5 --trajectory {file} "
                     "--radius 0.05 --first-pose --allow-non-rigid")

    def alignments(self, data):
        for file in sorted(f for f in data.iterdir() if f.suffix.lower() == ".xml"):
            self.begin()
            words = f"trajectory alignment {file} --json --force -o path.csv"
            made = self.tried(words) or self.tried(words + " --height 0")
            if made is None:
                self.refused(file)
                continue
            self.count(file.name, made)
            self.count(f"{file.name}, info", self.call("trajectory info path.csv --json"))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the program clearway")
    parser.add_argument("--data", type=Path, help="folder of real data")
    parser.add_argument("--data-only", action="store_true", help="leave out the scenes")
    parser.add_argument("--none", default="", help="codes that must not come, with commas between")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        trial = Trial(options.program, Path(folder) / "trial")
        trial.folder.mkdir()
        if not options.data_only:
            trial.scenes()
        for part in (trial.street, trial.trajectories, trial.alignments, trial.formats):
            if options.data:
                part(options.data.resolve() / part.__name__)
    watched = [code for code in options.none.split(",") if code]
    print(f"\n| code | of {trial.inputs} inputs | in doubt |\n|---|---|---|")
    for code in sorted(set(trial.counts) | set(watched)):
        print(f"| `{code}` | {trial.counts[code]} | {trial.doubts[code]} |")
    return int(bool(trial.doubts) or any(trial.counts[code] for code in watched))


if __name__ == "__main__":
    sys.exit(main())
