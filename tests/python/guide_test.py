#!/usr/bin/python3
"""Runs the Python blocks of a page, one after the other, in a folder of their own.

    guide_test.py PAGE --scene PROGRAM   with a scene that PROGRAM makes; compares what is printed
    guide_test.py PAGE --scene PROGRAM --needs MODULE    as above; skipped where Python lacks MODULE
    guide_test.py PAGE --street          with the street of CLEARWAY_TEST_DATA, and its known answer
"""

import argparse
import contextlib
import importlib.util
import io
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

STREET_POINTS = 78_439
STREET_HASH = 0xD4D727161424E54F
SKIPPED = 77


def blocks(page):
    """(number of the first line, code, text that is to be printed or None)"""
    fences = re.finditer(r"^```(\w+)\n(.*?)^```$", page, re.M | re.S)
    found = []
    for fence in fences:
        if fence[1] == "python":
            found.append([page.count("\n", 0, fence.start()) + 2, fence[2], None])
        elif fence[1] == "text":
            found[-1][2] = fence[2]
    return found


def run(path, compare):
    """Runs the page's blocks; returns their names."""
    names = {}
    for line, code, expected in blocks(path.read_text(encoding="utf-8")):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile("\n" * (line - 1) + code, str(path), "exec"), names)
        if compare and expected is not None and printed.getvalue() != expected:
            sys.exit(f"{path}:{line}: printed\n{printed.getvalue()}expected\n{expected}")
    return names


def fnv1a(sources):
    """FNV-1a of the indices as 8 little-endian bytes each."""
    value = 1469598103934665603  # with which the known answer was made, a tenth of the usual one
    for byte in sources.astype("<u8").tobytes():
        value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return value


def street_folder():
    data = os.environ.get("CLEARWAY_TEST_DATA")
    if not data:
        print("skipped: needs real scans; set CLEARWAY_TEST_DATA to their folder")
        sys.exit(SKIPPED)
    return Path(data) / "street"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("page", type=Path)
    parser.add_argument("--scene")
    parser.add_argument("--needs", help="a module of Python that the page imports")
    parser.add_argument("--street", action="store_true")
    options = parser.parse_args()
    if options.needs and importlib.util.find_spec(options.needs) is None:
        print(f"skipped: {options.page.name} needs Python's module {options.needs}")
        sys.exit(SKIPPED)
    page = options.page.resolve()
    with tempfile.TemporaryDirectory(prefix="clearway-guide-") as folder:
        if options.street:
            street = street_folder()
            os.chdir(folder)
            for name, here in (("street.las", "environment.las"), ("beetle.ply", "model.ply"),
                               ("trajectory.txt", "trajectory.txt")):
                os.symlink(street / name, here)
            names = run(page, compare=False)
            result = names["result"]
            assert result.size() == STREET_POINTS, result
            assert fnv1a(result.source()) == STREET_HASH
            assert [w.code for w in names["report"].warnings] == ["large-steps"]
            print(f"the street: {result.size()} points collide")
        else:
            os.chdir(folder)
            scene = re.search(r"^    clearway (scene .*)$", page.read_text(encoding="utf-8"), re.M)
            subprocess.run([options.scene, *scene[1].split()], check=True, capture_output=True)
            run(page, compare=True)


if __name__ == "__main__":
    main()
