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

from charting import certainty, costs, methods, paper, stability
from charting.record import markdown, read_record

# What draws each figure, from the record of that name unless another is named, and its numbers as
# text unless the usual table has them.
FIGURES = {
    "table": (paper.draw_table, {"text": paper.table_markdown}),
    "engines": (paper.draw_engines, {"record": "table"}), "threads": (paper.draw_threads, {}),
    "grid": (paper.draw_grid, {}), "points": (paper.draw_points, {"text": paper.points_markdown}),
    "accuracy": (methods.draw_accuracy, {}), "stability": (stability.draw, {}),
    "surfaces": (methods.draw_surfaces, {}),
    "seen": (costs.draw_seen, {}), "section": (costs.draw_section, {}),
    "certainty": (certainty.draw, {}), "check": (costs.draw_check, {}),
    "peers": (methods.draw_peers, {"text": methods.peers_markdown}),
    "ablation": (costs.draw_ablation, {"text": costs.ablation_markdown}),
    "outofcore": (costs.draw_outofcore, {"text": costs.outofcore_markdown}),
    "share": (costs.draw_share, {"text": costs.share_markdown})}


def figures_of(record):
    """Name, function and text of the figures that an experiment's record is drawn as."""
    return [(name, draw, how.get("text", markdown)) for name, (draw, how) in FIGURES.items()
            if record.experiment == how.get("record", name)]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="with JSON files of experiments")
    parser.add_argument("-o", "--output", type=Path,
                        help="folder of the charts (default: the same)")
    options = parser.parse_args()
    output = options.output or options.folder
    files = sorted([*options.folder.glob("*.json"), *options.folder.glob("*.json.gz")])
    records = [read_record(path) for path in files]
    records = [record for record in records if record and figures_of(record)]
    if not records:
        sys.exit(f"{options.folder}: no JSON file of an experiment")
    output.mkdir(parents=True, exist_ok=True)
    for record in records:
        if not record.cases:
            print(f"{record.path}: has no cases yet", file=sys.stderr)
            continue
        beside = [other for other in records if other.experiment == "table"]
        for name, draw, text_of in figures_of(record):
            sheet = draw(record, *beside[:1]) if draw is methods.draw_peers else draw(record)
            for path in sheet.save(output, name):
                print(path)
            text = output / f"{name}.md"
            text.write_text(text_of(record))
            print(text)


if __name__ == "__main__":
    main()
