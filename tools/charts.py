#!/usr/bin/python3
"""Draws the JSON files of `clearway-bench`, tools/certainty.py, tools/check_cost.py and
tools/measure_peers.py, each as SVG and PNG named as its experiment.

Reads *.json, and *.json.gz as `gzip` makes them. Other JSON files are left out.
Needs matplotlib and numpy (Debian: python3-matplotlib).
Example: tools/charts.py figures -o charts
"""

import argparse
import copy
import sys
from pathlib import Path

from charting import (accuracy, certainty, check, datasets, grid, peers, points, scaling, section,
                      seen, share, stability, surfaces, table, threads)
from charting.record import read_record

FIGURES = {"table": table, "threads": threads, "grid": grid, "datasets": datasets,
           "points": points, "accuracy": accuracy, "stability": stability, "scaling": scaling,
           "surfaces": surfaces, "seen": seen, "section": section, "certainty": certainty,
           "check": check, "peers": peers, "share": share}
TABLES = (table, peers, points, share)  # those that are also made as text


def files_in(folder):
    """The JSON files of a folder, compressed ones too."""
    return sorted([*folder.glob("*.json"), *folder.glob("*.json.gz")])


def add_datasets(records):
    """What `table` measured is drawn as Fig. 3 too, unless `datasets` was measured by itself."""
    if any(record.experiment == "datasets" for record in records):
        return
    for record in [record for record in records if record.experiment == "table"]:
        times = copy.copy(record)
        times.experiment = "datasets"
        records.append(times)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="with JSON files of clearway-bench")
    parser.add_argument("-o", "--output", type=Path,
                        help="folder of the charts (default: the same)")
    options = parser.parse_args()
    output = options.output or options.folder
    records = [read_record(path) for path in files_in(options.folder)]
    records = [record for record in records if record and record.experiment in FIGURES]
    if not records:
        sys.exit(f"{options.folder}: no JSON file of clearway-bench")
    add_datasets(records)
    output.mkdir(parents=True, exist_ok=True)
    for record in records:
        if not record.cases:
            print(f"{record.path}: has no cases yet", file=sys.stderr)
            continue
        figure = FIGURES[record.experiment]
        beside = [other for other in records if other.experiment == "table"]
        sheet = figure.draw(record, *beside[:1]) if figure is peers else figure.draw(record)
        for path in sheet.save(output):
            print(path)
        if figure in TABLES:
            text = output / f"{record.experiment}.md"
            text.write_text(figure.markdown(record))
            print(text)


if __name__ == "__main__":
    main()
