"""What Clearway says of places with errors is what the definition of the budget says: which are
clear, which are a conflict, and the margins. Some of each are wrong, as the errors demand.

Usage: PYTHONPATH=BUILD/python verdicts_test.py
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))

import clearway

from trials.verdicts import ERRORS, SHAPES, Places, Program, wrong

PLACES = 2_000


def main():
    wrongly = {"clear": 0, "conflict": 0}
    for seed, (shape, errors, margin) in enumerate((shape, errors, margin)
                                                   for shape in SHAPES.values()
                                                   for errors in ERRORS.values()
                                                   for margin in (0, 0.1)):
        sigmas = 1.5
        places = Places(shape, errors, margin, PLACES, np.random.default_rng(seed))
        margins = errors.margins(shape, sigmas)
        clear, conflict, told = Program(clearway).ask(places, errors, sigmas)
        expected = wrong(places.distances(), margin, margins)
        assert (clear == expected[0]).all(), (shape.name, margin, "clear")
        assert (conflict == expected[1]).all(), (shape.name, margin, "conflict")
        for name, value in margins.items():
            assert abs(told[name] - value) < 1e-12, (shape.name, name, told[name], value)
        wrongly["clear"] += clear.sum()
        wrongly["conflict"] += conflict.sum()
    assert min(wrongly.values()) > 200, wrongly


main()
