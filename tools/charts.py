#!/usr/bin/python3
"""Draws the JSON files of tools/experiments.py as SVG and PNG, each named as its experiment, with the
numbers as Markdown; `table` also as `engines`.

Reads *.json, and *.json.gz as `gzip` makes them. Other JSON files are left out.
Needs matplotlib and numpy (Debian: python3-matplotlib).
Example: tools/charts.py figures -o charts
"""

import argparse
import sys
from pathlib import Path

from charting import (accuracy, certainty, check, engines, grid, numbers, peers, points, scaling,
                      section, seen, share, stability, surfaces, table, threads)
from charting.record import read_record

FIGURES = (table, engines, threads, grid, points, accuracy, stability, scaling, surfaces, seen,
           section, certainty, check, peers, share)


def files_in(folder):
    """The JSON files of a folder, compressed ones too."""
    return sorted([*folder.glob("*.json"), *folder.glob("*.json.gz")])


def name_of(figure):
    return figure.__name__.removeprefix("charting.")


def figures_of(record):
    """The figures that an experiment's record is drawn as."""
    experiment = record.experiment
    return [figure for figure in FIGURES
            if experiment == ("table" if figure is engines else name_of(figure))]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="with JSON files of experiments")
    parser.add_argument("-o", "--output", type=Path,
                        help="folder of the charts (default: the same)")
    options = parser.parse_args()
    output = options.output or options.folder
    records = [read_record(path) for path in files_in(options.folder)]
    records = [record for record in records if record and figures_of(record)]
    if not records:
        sys.exit(f"{options.folder}: no JSON file of an experiment")
    output.mkdir(parents=True, exist_ok=True)
    for record in records:
        if not record.cases:
            print(f"{record.path}: has no cases yet", file=sys.stderr)
            continue
        beside = [other for other in records if other.experiment == "table"]
        for figure in figures_of(record):
            sheet = figure.draw(record, *beside[:1]) if figure is peers else figure.draw(record)
            for path in sheet.save(output, name_of(figure)):
                print(path)
            text = output / f"{name_of(figure)}.md"
            text.write_text(getattr(figure, "markdown", numbers.markdown)(record))
            print(text)


if __name__ == "__main__":
    main()
