#!/usr/bin/python3
"""Runs the Python blocks of a page, one after the other, in a folder of their own with a scene that
PROGRAM makes as the page says, and compares what is printed. Skipped where Python lacks MODULE.

    guide_test.py PAGE PROGRAM [MODULE]
"""

import contextlib
import importlib.util
import io
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SKIPPED = 77


def blocks(page):
    """(number of the first line, code, text that is to be printed or None)"""
    found = []
    for fence in re.finditer(r"^```(\w+)\n(.*?)^```$", page, re.M | re.S):
        if fence[1] == "python":
            found.append([page.count("\n", 0, fence.start()) + 2, fence[2], None])
        elif fence[1] == "text":
            found[-1][2] = fence[2]
    return found


def main(path, program, module="clearway"):
    if importlib.util.find_spec(module) is None:
        print(f"skipped: {path} needs Python's module {module}")
        sys.exit(SKIPPED)
    page, names = Path(path).read_text(encoding="utf-8"), {}
    with tempfile.TemporaryDirectory(prefix="clearway-guide-") as folder:
        os.chdir(folder)
        scene = re.search(r"^    clearway (scene .*)$", page, re.M)
        subprocess.run([program, *scene[1].split()], check=True, capture_output=True)
        for line, code, expected in blocks(page):
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile("\n" * (line - 1) + code, path, "exec"), names)
            if expected is not None and printed.getvalue() != expected:
                sys.exit(f"{path}:{line}: printed\n{printed.getvalue()}expected\n{expected}")


if __name__ == "__main__":
    main(*sys.argv[1:])
