#!/usr/bin/python3
"""The manual pages name every command and option of the programs' help: man_pages_test.py PROGRAM..."""

import gzip
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "tools" / "man_pages.py"
PROGRAMS = []


def help_of(words):
    return subprocess.run([*words, "--help-all"], capture_output=True, text=True, check=True).stdout


def commands(words):
    """The command of these words and all below it, with their help."""
    text = help_of(words)
    yield words, text
    below = re.search(r"^Subcommands:\n((?: .*\n)*)", text, re.M)
    for name in re.findall(r"^  (\S+)", below[1] if below else "", re.M):
        yield from commands([*words, name])


def shown(text):
    """What a page says, without roff's marks."""
    return re.sub(r"\\f[BIR]", "", text).replace(r"\-", "-").replace(r"\&", "")


class ManPages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="clearway-man-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        subprocess.run([sys.executable, SCRIPT, "1.2.3", cls.folder, *PROGRAMS], check=True)
        cls.pages = {path.name.removesuffix(".1.gz"): gzip.decompress(path.read_bytes()).decode()
                     for path in cls.folder.iterdir()}

    def test_every_option_is_there(self):
        looked_at = 0
        for program in PROGRAMS:
            for words, text in commands([program]):
                names = [Path(words[0]).name, *words[1:]]
                page = shown(self.pages.get("-".join(names[:2])) or self.pages[names[0]])
                self.assertIn(" ".join(names), page)
                for flags in re.findall(r"^  (-[\w,-]+)", text, re.M):
                    self.assertIn("\n" + flags.replace(",", ", "), page, " ".join(names))
                    looked_at += 1
        self.assertGreater(looked_at, 100)

    def test_values_and_limits(self):
        run = shown(self.pages["clearway-run"])
        self.assertRegex(run, r"\n--radius METRES\n.*Required\.\n")
        self.assertRegex(run, r"\n--engine TEXT\n.*One of sweep, grid, kdtree\. Default: sweep\.\n")
        self.assertRegex(run, r"\n--threads N\n.*From 1 to 1024\.\n")
        self.assertRegex(run, r"\n--force\n.*Not with --resume\.\n")
        for page in ("clearway", "clearway-run"):
            codes = re.findall(r"^\.B (\w+)$", self.pages[page], re.M)
            self.assertEqual(codes, ["0", "1", "2", "3", "4", "5", "6", "other"])

    def test_they_are_what_man_takes(self):
        for name, page in self.pages.items():
            title = name.replace("-", r"\-")
            self.assertTrue(page.startswith(f".TH {title.upper()} 1 "), name)
            self.assertIn(f".SH NAME\n{title} \\- ", page)
            if shutil.which("groff"):
                done = subprocess.run(["groff", "-man", "-ww", "-Tutf8", "-z"], input=page,
                                      capture_output=True, text=True, check=True)
                self.assertEqual(done.stderr, "", name)


if __name__ == "__main__":
    PROGRAMS += [str(Path(path).resolve()) for path in sys.argv[1:]]
    unittest.main(argv=sys.argv[:1])
