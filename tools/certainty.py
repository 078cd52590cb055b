#!/usr/bin/python3
"""Measures how often `clearway run` is sure and wrong, on scenes whose truth is known.

- How often a place that stands at the margin is called clear, or a conflict, by --sigmas, shape and
  errors: by Monte Carlo, and by asking Clearway about thousands of such places.
- How many cubes inside opaque things are called seen, by noise and side of the cubes.

Needs numpy, h5py and Clearway's Python module (Debian: python3-numpy, python3-h5py).
Example: PYTHONPATH=build/release/python tools/certainty.py build/release/tools/clearway -o certainty.json
tools/charts.py draws the file. The exit code is 1 where Clearway differs from the definition.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

import numpy as np

from trials.header import header
from trials.scans import Scene
from trials.seen_space import Ground, look
from trials.verdicts import ERRORS, SHAPES, Places, Program, monte_carlo, wrong

SIGMAS = (2, 3, 4)
MARGINS = (0, 0.1)
SIDES = (0.1, 0.2, 0.4)
BOUNDS = (0.005, 0.02, 0.045)     # of uniform noise
# Of normal noise; the second and third are a sixteenth and a twelfth of 0.2 m.
DEVIATIONS = (0.005, 0.0125, 0.2 / 12, 0.02, 0.05)
SIZES = {  # trials of each case; places that Clearway is asked about; scenes, and rays of a scanner
    "smoke": (20_000, 1_000, 1, 20_000),
    "small": (1_000_000, 20_000, 4, 100_000),
    "full": (10_000_000, 100_000, 16, 400_000),
}


def place_cases(trials):
    """False verdicts by Monte Carlo."""
    for shape in SHAPES.values():
        for mix, errors in ERRORS.items():
            for margin in MARGINS:
                found = monte_carlo(shape, errors, margin, SIGMAS, trials, 1)
                for sigmas, findings in found.items():
                    yield case({"vary": "place", "shape": shape.name, "errors": mix,
                                "margin": margin, "sigmas": sigmas}, findings)


def program_cases(program, places):
    """Verdicts of Clearway, beside those of the definition for the same places."""
    for seed, (shape, mix, margin, sigmas) in enumerate(
            (shape, mix, margin, sigmas) for shape in SHAPES.values() for mix in ERRORS
            for margin in MARGINS for sigmas in SIGMAS):
        errors = ERRORS[mix]
        drawn = Places(shape, errors, margin, places, np.random.default_rng([2, seed]))
        expected = wrong(drawn.distances(), margin, errors.margins(shape, sigmas))
        clear, conflict, margins = program.ask(drawn, errors, sigmas)
        yield case({"vary": "program", "shape": shape.name, "errors": mix, "margin": margin,
                    "sigmas": sigmas},
                   {"places": places, "clear": int(clear.sum()), "conflict": int(conflict.sum()),
                    "margins": margins, "formulas": errors.margins(shape, sigmas),
                    "differ": int((clear != expected[0]).sum() + (conflict != expected[1]).sum())})


def noise_cases(program, scenes, rays):
    """Cubes inside things that are called seen, by noise and side."""
    noises = [("uniform", bound) for bound in BOUNDS] + [("normal", sigma) for sigma in DEVIATIONS]
    sums = {(kind, size, side): {} for kind, size in noises for side in SIDES}
    for seed in range(scenes):
        scene = Scene(np.random.default_rng(seed))
        with tempfile.TemporaryDirectory() as folder:
            ground = Ground(program, Path(folder), scene)
            for kind, size in noises:
                random = np.random.default_rng([3, seed])
                found = look(ground, random, rays, noise_of(random, kind, size), SIDES)
                for side, counts in found.items():
                    one = sums[kind, size, side]
                    for name, count in counts.items():
                        one[name] = one.get(name, 0) + count
    for (kind, size, side), findings in sums.items():
        yield case({"vary": "noise", "noise": kind, "size": size, "side": side}, findings)


def noise_of(random, kind, size):
    """Draws n errors: uniform within +-size, or normal with the deviation size."""
    if kind == "uniform":
        return lambda n: random.uniform(-size, size, n)
    return lambda n: random.normal(0, size, n)


def case(parameters, findings):
    one = {"key": "/".join(str(value) for value in parameters.values()),
           "parameters": parameters, "findings": findings}
    print(one["key"], json.dumps(findings), file=sys.stderr)
    return one


def differs(findings):
    """Whether Clearway and the definition give other verdicts or margins."""
    if "differ" not in findings:
        return False
    margins, formulas = findings["margins"], findings["formulas"]
    return findings["differ"] > 0 or any(abs(margins[name] - value) > 1e-12
                                         for name, value in formulas.items())


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path, help="the clearway that is measured")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the figures, a JSON file")
    parser.add_argument("--size", choices=SIZES, default="small",
                        help="small takes minutes, full an hour, smoke seconds to try it out")
    parser.add_argument("--only", choices=("place", "program", "noise"), action="append",
                        help="measure this part alone; may be given several times")
    options = parser.parse_args()
    trials, places, scenes, rays = SIZES[options.size]
    record = {**header("certainty", options.program, options.size), "cases": []}
    wanted = options.only or ("place", "program", "noise")
    if "place" in wanted:
        record["cases"] += place_cases(trials)
    if "program" in wanted:
        import clearway

        record["cases"] += program_cases(Program(clearway), places)
    if "noise" in wanted:
        record["cases"] += noise_cases(options.program, scenes, rays)
    options.output.write_text(json.dumps(record, indent=1) + "\n")
    wrong_cases = [one["key"] for one in record["cases"] if differs(one["findings"])]
    if wrong_cases:
        sys.exit("Clearway differs from the definition: " + ", ".join(wrong_cases))


if __name__ == "__main__":
    main()
