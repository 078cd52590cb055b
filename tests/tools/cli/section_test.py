#!/usr/bin/python3
"""The commands section find, check and export with the inputs and options that people and accidents
give them.

    section_test.py CLEARWAY
"""

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np

PROGRAM = []
RECTANGLE = "-0.5,0.5\n0.5,0.5\n0.5,1.5\n-0.5,1.5\n"
FOOT = 0.3048


def clearway(words, folder, timeout=120):
    return subprocess.run([PROGRAM[0], *map(str, words)], cwd=folder, capture_output=True, text=True,
                          check=False, timeout=timeout, errors="replace")


def text_of(corners):
    return "".join(f"{y!r},{z!r}\n" for y, z in corners)


def wait_until_caught(process, kind):
    """A signal before the program listens to it ends the program as any other would be."""
    while process.poll() is None:
        caught = re.search(r"SigCgt:\s*(\w+)", Path(f"/proc/{process.pid}/status").read_text())
        if caught and int(caught[1], 16) >> (kind - 1) & 1:
            return
        time.sleep(0.005)


class Drawing:
    """A DXF file in the form of release 12: pairs of a code and a value, a line each."""

    def __init__(self, path):
        lines = path.read_text().split("\n")
        self.comments, self.texts, self.corners = [], [], []
        entity = {}
        for code, value in zip(map(str.strip, lines[::2]), lines[1::2]):
            if code == "999":
                self.comments.append(value)
            elif code == "0":
                self.end(entity)
                entity = {"0": value}
            else:
                entity[code] = value
        assert entity == {"0": "EOF"}, entity

    def end(self, entity):
        if entity.get("0") == "VERTEX":
            self.corners.append((float(entity["10"]), float(entity["20"])))
        elif entity.get("0") == "TEXT":
            self.texts.append(entity["1"])


def tube(random, count, length):
    """Points on the walls of a tube of 4 x 3 m around the x axis."""
    points = np.stack([random.uniform(-3, length + 3, count), random.uniform(-2, 2, count),
                       random.uniform(0, 3, count)], 1)
    wall = random.integers(0, 4, count)
    points[wall == 0, 1], points[wall == 1, 1] = -2, 2
    points[wall == 2, 2], points[wall == 3, 2] = 0, 3
    return points


class Sections(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory(prefix="clearway-section-")
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = Path(scratch.name)
        cls.points = tube(np.random.default_rng(5), 30000, 20)
        cls.write_scan("scan.xyz", cls.points)
        cls.write_path("path.txt", 41, 0.5)
        cls.ok("convert scan.xyz --unit m -o site.h5")
        cls.ok("section find --env site.h5 --trajectory path.txt --x-range=-1,1 --cell 0.05 "
               "--window=-3,3,-0.5,4 --margin 0.2 -o section.h5")

    @classmethod
    def write_scan(cls, name, points):
        np.savetxt(cls.folder / name, points, "%.4f")

    @classmethod
    def write_path(cls, name, count, step, more=lambda i: (0, 0)):
        rows = (f"1 0 0 {i * step} 0 1 0 {more(i)[0]} 0 0 1 {more(i)[1]}\n" for i in range(count))
        (cls.folder / name).write_text("".join(rows))

    @classmethod
    def run_(cls, words, **more):
        return clearway(words.split() if isinstance(words, str) else words, cls.folder, **more)

    @classmethod
    def ok(cls, words, code=0):
        done = cls.run_(words)
        assert done.returncode == code, (words, done)
        return done

    def find(self, more, code=0, env="site.h5", path="path.txt", range_="-1,1"):
        done = self.run_(f"section find --env {env} --trajectory {path} --x-range={range_} "
                         f"-o out.h5 {'' if 'no-force' in more else '--force'} "
                         + more.replace("no-force", ""))
        self.assertEqual(done.returncode, code, done)
        return done

    def check(self, outline, more="", section="section.h5"):
        if outline is not None:
            data = outline if isinstance(outline, bytes) else outline.encode()
            (self.folder / "outline.csv").write_bytes(data)
        return self.run_(f"section check {section} --outline outline.csv --json {more}")

    def verdict(self, outline, more="", section="section.h5"):
        done = self.check(outline, more, section)
        code = {"passes": 0, "stopped": 1, "unknown": 6}
        answer = json.loads(done.stdout)
        self.assertEqual(done.returncode, code[answer["verdict"]], done)
        return answer

    def refused(self, done, text, code):
        self.assertEqual(done.returncode, code, done)
        self.assertRegex(done.stderr, text)
        self.assertEqual(done.stdout, "")
        self.assertNotRegex(done.stderr, r"terminate|internal|std::")


class Outlines(Sections):
    def test_half_an_outline_is_warned_of(self):
        half = "0,0.5\n0.5,0.5\n0.5,1.5\n0,1.5\n"
        for outline, codes in ((RECTANGLE, []), (half, ["half-outline"])):
            answer = self.verdict(outline)
            self.assertEqual([w["code"] for w in answer["warnings"]], codes)
        report = self.ok("report section.h5 --outline outline.csv --json -o page.html --force")
        self.assertIn("half-outline", report.stdout)
        self.assertIn("--mirror", report.stderr)
        (self.folder / "outline.csv").write_text(half)
        self.assertIn("--mirror", self.ok("model outline outline.csv --x=-1,1 -o half.off").stderr)

    def test_hostile_outlines_are_refused_by_name(self):
        far = "-0.5,0.5\n0.5,0.5\n1e308,1e308\n"
        cases = {
            "empty": ("", 3, "outline.csv: holds no corner"),
            "blank": ("\n\n  \n", 3, "outline.csv: holds no corner"),
            "only names": ("y,z\n", 3, "outline.csv: holds no corner"),
            "one corner": ("0,1\n", 2, "outline.csv: .*1 corner"),
            "two corners": ("0,1\n1,2\n", 2, "outline.csv: .*2 corners"),
            "crossing": ("-1,0\n1,1\n1,0\n-1,1\n", 2, "outline.csv: .*cross"),
            "line": ("0,0.5\n0,1\n0,2\n", 2, "outline.csv: "),
            "nan": ("-1,0\nnan,1\n1,0\n", 3, "outline.csv: line 2: .*two finite numbers"),
            "infinite": ("-1,0\ninf,1\n1,0\n", 3, "outline.csv: line 2: .*two finite numbers"),
            "text": ("a load\nof wood\n", 3, "outline.csv: line 1: .*y,z"),
            "text later": ("y,z\n-1,0\nx,1\n", 3, "outline.csv: line 3: .*two finite numbers"),
            "three numbers": ("0,0,0\n1,0,0\n1,1,0\n", 3, "outline.csv: line 1: .*two finite numbers"),
            "1e308": (far, 2, "outline.csv: .*1e\\+?308|outline.csv: .*1e\\+?0?6|outline.csv: .*beyond"),
            "1e999": ("-1,0\n1,0\n1e999,1\n", 3, "outline.csv: line 3: "),
            "duplicates": ("-1,0\n1,0\n1,0\n1,1\n-1,1\n", 2, "outline.csv: .*cross or touch"),
            "other names": ("x,y\n0,0\n1,0\n1,1\n", 3, "outline.csv: line 1: .*names y,z"),
            "mirror names": ("height,half_width\n0,1\n1,1\n", 3, "outline.csv: line 1: .*mirrored"),
            "binary": (bytes(range(256)) * 40, 3, "outline.csv: line 1: "),
            "zeros": (b"\0" * 4096, 3, "outline.csv: line 1: "),
            "huge": ("0,1\n" * 10001, 3, "outline.csv: line 10001: .*more corners than 10,000"),
            "one long line": ("1," * 5_000_000, 3, "outline.csv"),
            "section": ((self.folder / "section.h5").read_bytes(), 3, "outline.csv: is an HDF5 file"),
        }
        for name, (text, code, message) in cases.items():
            with self.subTest(name):
                self.refused(self.check(text), message, code)
        (self.folder / "outline.csv").unlink()
        self.refused(self.check(None), "outline.csv: cannot open", 4)
        (self.folder / "outline.csv").mkdir()
        self.refused(self.check(None), "outline.csv: is a directory", 4)
        (self.folder / "outline.csv").rmdir()

    def test_forms_of_one_outline_have_one_answer(self):
        expected = self.verdict(RECTANGLE, "--margin 0.2")
        self.assertEqual(expected["verdict"], "passes")
        rows = RECTANGLE.split()
        for name, text in {
                "names": "y,z\n" + RECTANGLE, "quoted": '"Y","Z"\n' + RECTANGLE,
                "clockwise": "\n".join(reversed(rows)) + "\n",
                "closed": RECTANGLE + rows[0], "tabs": RECTANGLE.replace(",", "\t"),
                "semicolons": RECTANGLE.replace(",", ";"), "blanks": RECTANGLE.replace(",", "  "),
                "crlf": RECTANGLE.replace("\n", "\r\n"), "bom": "\ufeff" + RECTANGLE,
                "blank lines": RECTANGLE.replace("\n", "\n\n"),
                "other start": "\n".join(rows[2:] + rows[:2])}.items():
            with self.subTest(name):
                self.assertEqual(self.verdict(text, "--margin 0.2"), expected)
        half = "height,half_width\n0.5,0.5\n1.5,0.5\n"
        self.assertEqual(self.verdict(half, "--margin 0.2 --mirror"), expected)
        centimetres = "\n".join(",".join(f"{100 * float(v):g}" for v in row.split(","))
                                for row in rows)
        self.assertEqual(self.verdict(centimetres, "--unit cm --margin 20cm"), expected)
        feet = "\n".join(",".join(repr(float(v) / FOOT) for v in row.split(",")) for row in rows)
        self.assertEqual(self.verdict(feet, "--unit ft --margin 0.2")["verdict"], "passes")
        self.assertEqual(self.verdict(feet)["verdict"], "stopped")  # as metres it is far too large

    def test_verdicts(self):
        wide = RECTANGLE.replace("0.5,", "2.2,")
        stopped = self.verdict(wide, "--margin 0.1")
        self.assertEqual((stopped["verdict"], stopped["reason"]), ("stopped", None))
        self.assertEqual(stopped["first_pose"], 0)
        self.assertEqual(stopped["chainage"], 0)
        self.assertEqual(len(stopped["cell"]), 2)
        self.assertEqual([s["bin"] for s in stopped["stops"]], [0, 1, 2, 3, 4])
        self.assertEqual(stopped["stops"][0]["cell"], stopped["cell"])
        more = self.verdict(RECTANGLE, "--margin 0.3")
        self.assertEqual((more["verdict"], more["first_pose"]), ("unknown", None))
        self.assertIn("margins up to 0.2", more["reason"])
        self.assertEqual(self.verdict(wide, "--margin 0.3")["verdict"], "stopped")
        # Without --margin, that of the section counts.
        close = RECTANGLE.replace("0.5,", "1.8,")
        self.assertEqual(self.verdict(close, "--margin 0.1")["verdict"], "passes")
        by_default = self.verdict(close)
        self.assertEqual((by_default["verdict"], by_default["margin"]), ("stopped", 0.2))
        self.assertEqual(self.verdict(close, "--margin 0.2"), by_default)
        leaves = self.verdict("-0.2,3.2\n0.2,3.2\n0.2,3.99\n-0.2,3.99\n", "--margin 0.05")
        self.assertEqual(leaves["verdict"], "unknown")
        self.assertIn("leaves the window", leaves["reason"])
        for margin in ("-0.1", "nan", "inf", "x", "1e999"):
            with self.subTest(margin):
                done = self.check(RECTANGLE, f"--margin={margin}")
                self.refused(done, "--margin", 2)

    def test_sentences(self):
        (self.folder / "outline.csv").write_text(RECTANGLE)
        done = self.run_("section check section.h5 --outline outline.csv --margin 0.1")
        self.assertEqual(done.stdout,
                         "passes: the load passes at all 41 poses of the path with a margin of 0.1 m\n")
        done = self.run_("section check section.h5 --outline outline.csv")
        self.assertEqual(done.stdout,
                         "passes: the load passes at all 41 poses of the path with a margin of 0.2 m\n")
        done = self.run_("section check section.h5 --outline outline.csv --margin 0")
        self.assertEqual(done.stdout,
                         "passes: the load passes at all 41 poses of the path without a margin\n")
        (self.folder / "outline.csv").write_text(RECTANGLE.replace("0.5,", "2.2,"))
        done = self.run_("section check section.h5 --outline outline.csv")
        self.assertRegex(done.stdout, r"^stopped: the load is stopped with a margin of 0.2 m at pose "
                                      r"0, 0 m along the path, "
                                      r".* m to the (left|right) at a height of .* m, and in 5 "
                                      r"stretches in all\n$")

    def test_a_damaged_section_is_refused(self):
        bytes_ = (self.folder / "section.h5").read_bytes()
        (self.folder / "outline.csv").write_text(RECTANGLE)
        damaged = {"half": bytes_[:len(bytes_) // 2], "empty": b"", "text": b"y,z\n",
                   "zeros in the middle": bytes_[:len(bytes_) // 2] + b"\0" * 4096
                                          + bytes_[len(bytes_) // 2 + 4096:],
                   "longer": bytes_ + b"x", "store": (self.folder / "site.h5").read_bytes()}
        for name, content in damaged.items():
            (self.folder / "damaged.h5").write_bytes(content)
            with self.subTest(name):
                for words in ("section check damaged.h5 --outline outline.csv",
                              "section export damaged.h5 --table bands -o t.csv"):
                    self.refused(self.run_(words), "damaged.h5", 3)
                if name != "store":
                    self.assertIn(self.run_("verify damaged.h5").returncode, (1, 3))
        self.assertFalse((self.folder / "t.csv").exists())
        self.refused(self.run_("section check none.h5 --outline outline.csv"), "none.h5: cannot open", 4)
        self.refused(self.run_("section check . --outline outline.csv"), "is a directory", 4)
        self.assertEqual(self.run_("verify section.h5").returncode, 0)



class OutlineTables(Sections):
    """section check --table: outlines by stretches of the path."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        lists = cls.folder / "lists"
        (lists / "forms").mkdir(parents=True)
        (lists / "forms" / "narrow.csv").write_text(RECTANGLE)
        (lists / "forms" / "wide.csv").write_text(RECTANGLE.replace("-0.5,", "-2.2,"))
        station = "".join(f"{i * 0.5},0,0,0,0,0,1,{1000 + i * 0.6}\n" for i in range(41))
        (cls.folder / "stations.csv").write_text("x,y,z,qx,qy,qz,qw,station\n" + station)
        (cls.folder / "back.csv").write_text("x,y,z,qx,qy,qz,qw,station\n" + "".join(
            f"{i * 0.5},0,0,0,0,0,1,{1000 - i}\n" for i in range(41)))

    @classmethod
    def table(cls, text, name="outlines.csv"):
        data = text if isinstance(text, bytes) else text.encode()
        (cls.folder / "lists" / name).write_bytes(data)
        return f"section check section.h5 --table lists/{name}"

    def answer(self, text, more=""):
        done = self.run_(self.table(text) + " --json " + more)
        answer = json.loads(done.stdout)
        code = {"passes": 0, "stopped": 1, "unknown": 6}
        self.assertEqual(done.returncode, code[answer["verdict"]], done)
        return answer

    NAMES = "chainage_from,chainage_to,outline,margin\n"

    def test_each_row_is_a_check_of_its_stretch(self):
        answer = self.answer(self.NAMES + "0,7,forms/narrow.csv,0.1\n7,20,forms/wide.csv,\n")
        self.assertEqual(answer["verdict"], "stopped")
        self.assertEqual(answer["row"], 1)
        self.assertEqual([row["bins"] for row in answer["rows"]], [[0, 1], [1, 4]])
        self.assertEqual([row["margin"] for row in answer["rows"]], [0.1, 0.2])
        for row in answer["rows"]:
            whole = self.run_(f"section check section.h5 --outline lists/{row['outline']} --json "
                              f"--margin {row['margin']}")
            first, last = row["bins"]
            self.assertEqual(row["stops"], [s for s in json.loads(whole.stdout)["stops"]
                                            if first <= s["bin"] <= last])
        self.assertEqual(answer["stops"], [{**s, "row": 1} for s in answer["rows"][1]["stops"]])
        self.assertEqual(self.answer(self.NAMES + "0,20,forms/narrow.csv,\n", "--margin 0.05")
                         ["rows"][0]["margin"], 0.05)
        printed = self.run_(self.table(self.NAMES + "0,20,forms/narrow.csv,0.1\n"))
        self.assertIn("line 2, chainage 0 to 20 m, forms/narrow.csv with a margin of 0.1 m: passes",
                      printed.stdout)

    def test_what_has_no_outline_is_unknown_unless_something_is_stopped(self):
        gap = self.answer(self.NAMES + "0,10,forms/narrow.csv,\n12,20,forms/narrow.csv,\n")
        self.assertEqual(gap["verdict"], "unknown")
        self.assertEqual(gap["gaps"], [{"chainage_from": 10, "chainage_to": 12, "bins": [2, 2]}])
        self.assertEqual(self.answer(self.NAMES + "0,10,forms/wide.csv,\n")["verdict"], "stopped")
        beyond = self.answer(self.NAMES + "0,20,forms/narrow.csv,\n90,99,forms/narrow.csv,\n")
        self.assertEqual((beyond["verdict"], beyond["rows"][1]["verdict"]), ("passes", None))
        printed = self.run_("section check section.h5 --table lists/outlines.csv")
        self.assertIn("passes: the outlines of 1 of 2 rows (line 3 is not judged, because the load has "
                      "no pose there) pass at all 41 poses of the path\n", printed.stdout)

    def test_rows_by_station(self):
        rows = "station_from,station_to,outline\n1000,1012,forms/wide.csv\n1012,1024,forms/narrow.csv\n"
        answer = self.answer(rows, "--trajectory stations.csv")
        self.assertEqual(answer["verdict"], "stopped")
        self.assertEqual([round(row["chainage_to"], 9) for row in answer["rows"]], [10, 20])
        self.assertEqual(answer["rows"][1]["station_to"], 1024)
        command = self.table(rows)
        self.refused(self.run_(command), "by station; expected --trajectory", 2)
        self.refused(self.run_(command + " --trajectory path.txt"), "no stations of the path", 2)
        self.refused(self.run_(command + " --trajectory back.csv"), "do not ascend from pose 0", 2)
        self.write_path("other.txt", 41, 0.4)
        self.refused(self.run_(command + " --trajectory other.txt"), "another trajectory", 3)
        chainage = self.table(self.NAMES + "0,20,forms/narrow.csv,\n")
        self.refused(self.run_(chainage + " --trajectory path.txt"), "--trajectory needs --env", 2)

    def test_forms_of_one_table_have_one_answer(self):
        text = self.NAMES + "0,7,forms/narrow.csv,0.1\n7,20,forms/wide.csv,\n"
        expected = self.answer(text)
        for name, form in {
                "semicolons": text.replace(",", ";"), "bom": "\ufeff" + text,
                "bom and semicolons": "\ufeff" + text.replace(",", ";"),
                "crlf": text.replace("\n", "\r\n"), "spaces": text.replace(",", " , "),
                "quotes": text.replace("forms/narrow.csv", '"forms/narrow.csv"'),
                "unit": text.replace("margin\n", "margin [cm]\n").replace("0.1", "10"),
                "a column more": text.replace("\n", ",x\n")}.items():
            with self.subTest(name):
                self.assertEqual(self.answer(form), expected)

    def test_wrong_tables_are_refused_by_file_and_line(self):
        row = "0,20,forms/narrow.csv,0.1\n"
        (self.folder / "lists" / "bad.csv").write_text("0,1\nx\n")
        (self.folder / "lists" / "cross.csv").write_text("-1,0\n1,1\n1,0\n-1,1\n")
        cases = {
            "empty": ("", 3, "outlines.csv: holds no row"),
            "names only": (self.NAMES, 3, "outlines.csv: holds no row"),
            "no names": (row, 3, "line 1: .*expected the columns chainage_from"),
            "no outline": ("chainage_from,chainage_to\n0,20\n", 3, "line 1: .*expected the columns"),
            "both": ("chainage_from,station_to,outline\n", 3, "line 1: .*by chainage and by station"),
            "twice": ("chainage_from,chainage_to,outline,outline\n", 3, "line 1: .*outline twice"),
            "unit": (self.NAMES.replace("margin", "margin [deg]") + row, 3, "line 1: .*margin in"),
            "text": (self.NAMES + "a,20,forms/narrow.csv,0\n", 3, "line 2: .*finite number"),
            "nan": (self.NAMES + "0,nan,forms/narrow.csv,0\n", 3, "line 2: .*finite number"),
            "backwards": (self.NAMES + "20,0,forms/narrow.csv,0\n", 3, "line 2: .*ends before"),
            "fields": (self.NAMES + "0,20,forms/narrow.csv\n", 3, "line 2: has 3 fields.*expected 4"),
            "decimal commas": (self.NAMES.replace(",", ";") + "0,0;20,0;forms/narrow.csv;0,1\n", 3,
                               "line 2: .*decimal"),
            "margin": (self.NAMES + "0,20,forms/narrow.csv,-1\n", 3, "line 2: .*margin below 0"),
            "no file": (self.NAMES + "0,20,,0\n", 3, "line 2: names no outline"),
            "missing": (self.NAMES + "0,20,none.csv,0\n", 4, "line 2: .*none.csv: cannot open"),
            "bad outline": (self.NAMES + "0,20,bad.csv,0\n", 3, "line 2: .*bad.csv: line 2"),
            "crossing": (self.NAMES + "0,20,cross.csv,0\n", 2, "line 2: cross.csv: .*cross"),
            "overlap": (self.NAMES + "9,20,forms/narrow.csv,0\n0,10,forms/narrow.csv,0\n", 3,
                        "line 3: overlaps line 2 from 9 to 10"),
            "binary": (bytes(range(256)) * 40, 3, "outlines.csv: line 1: "),
        }
        for name, (text, code, message) in cases.items():
            with self.subTest(name):
                self.refused(self.run_(self.table(text)), message, code)
        self.refused(self.run_("section check section.h5"), "--outline or --table", 2)
        self.refused(self.run_(self.table(self.NAMES + row) + " --outline lists/bad.csv"), "excludes", 2)

    def test_page_and_picture_show_which_outline_is_judged(self):
        self.table(self.NAMES + "0,7,forms/narrow.csv,0.1\n7,18,forms/wide.csv,\n")
        done = self.ok("report section.h5 --table lists/outlines.csv --json --force -o page.html "
                       "-o picture.svg --env site.h5 --trajectory path.txt")
        check = json.loads(done.stdout)["section"]["check"]
        self.assertEqual([load["outline_name"] for load in check["loads"]],
                         ["forms/narrow.csv", "forms/wide.csv"])
        self.assertEqual([(row["line"], row["load"], row["verdict"]) for row in check["rows"]],
                         [(2, 0, "passes"), (3, 1, "stopped")])
        self.assertEqual([gap["bins"] for gap in check["gaps"]], [[3, 4]])
        self.assertEqual({stop["load"] for stop in check["stops"]}, {1})
        picture = (self.folder / "picture.svg").read_text()
        self.assertEqual(picture.count("section_load"), 2)
        for words in ("forms/narrow.csv, margin 0.1 m", "forms/wide.csv, margin 0.2 m"):
            self.assertIn(words, picture)


class Finding(Sections):
    def test_json(self):
        done = self.find("--json --margin 0.2 --between-poses")
        found = json.loads(done.stdout)
        self.assertEqual(list(found)[-11:], ["blocked", "blocked_in_bins", "bins", "rounding",
                                             "motion", "device", "device_estimate",
                                             "needed_host_bytes", "peak_device_bytes", "seconds",
                                             "warnings"])
        self.assertEqual(found["bins"], 5)
        self.assertEqual(len(found["motion"]), 2)
        self.assertIsNone(json.loads(self.find("--json").stdout)["motion"])
        info = json.loads(self.ok("info section.h5 --json").stdout)
        self.assertEqual((info["kind"], info["bins"]), ("section", 5))

    def test_questions_that_have_no_answer_are_refused(self):
        scaled, singular = "1.01 0 0 0 0 1.01 0 0 0 0 1.01 0\n", "0 0 0 0 0 0 0 0 0 0 0 0\n"
        (self.folder / "scaled.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n" + scaled)
        (self.folder / "singular.txt").write_text(singular)
        cases = [("--window=1,1,0,2", "is empty", {}), ("--window=2,1,0,2", "is empty", {}),
                 ("--window=nan,1,0,2", "--window", {}), ("--window=0,1", "--window", {}),
                 ("", "its rear, and then its front", {"range_": "1,-1"}),
                 ("", "--x-range", {"range_": "1"}), ("", "--x-range", {"range_": "a,b"}),
                 ("--cell 0", "--cell", {}), ("--cell=-1", "--cell", {}),
                 ("--cell 1e-9", "too small for the window", {}), ("--bin 0", "--bin", {}),
                 ("--margin=-1", "--margin", {}), ("--ignore-class 300", "ignore-class", {}),
                 ("--ignore-box 1,2", "ignore-box", {}), ("--pivots 1", "--pivots", {})]
        for more, text, named in cases:
            with self.subTest(more or named):
                self.refused(self.find(more, 2, **named), text, 2)
        self.assertIn(self.find("--bin 1e-300", 2).returncode, (2,))
        for path in ("scaled.txt", "singular.txt"):
            with self.subTest(path):
                done = self.run_(
                    f"section find --env site.h5 --trajectory {path} --x-range=-1,1 -o out.h5")
                self.assertIn(done.returncode, (2, 3), done)
                self.assertRegex(done.stderr, "scale|stretch|singular|rotation")
        self.refused(self.find("", 3, env="path.txt"), "path.txt", 3)
        self.refused(self.find("", 3, env="section.h5"), "section.h5", 3)

    def test_nothing_to_find_is_a_warning_and_unknown(self):
        (self.folder / "none.ply").write_text(
            "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
            "property float z\nend_header\n")
        self.ok("convert none.ply -o none.h5")
        self.write_path("far.txt", 5, 0.5, lambda i: (5000, 0))
        cases = {"all-ignored": {"more": "--ignore-box=-99,-99,-99,99,99,99"},
                 "out-of-reach": {"more": "", "path": "far.txt"},
                 "no-points": {"more": "", "env": "none.h5"}}
        for code, how in cases.items():
            with self.subTest(code):
                more = how.pop("more")
                found = json.loads(self.find(more + " --json", **how).stdout)
                self.assertIn(code, [w["code"] for w in found["warnings"]])
                answer = self.verdict(RECTANGLE, section="out.h5")
                self.assertEqual(answer["verdict"], "unknown")
                self.assertIn(code, answer["reason"])
                self.assertIn(code, [w["code"] for w in answer["warnings"]])
                (self.folder / "out.h5").unlink()
                done = self.find(more + " --strict", 3, **how)
                self.assertFalse((self.folder / "out.h5").exists())

    def test_an_output_that_exists_is_kept(self):
        before = (self.folder / "section.h5").read_bytes()
        words = ("section find --env site.h5 --trajectory path.txt --x-range=-1,1 -o section.h5")
        self.refused(self.run_(words), "section.h5: exists.*--force", 2)
        for output in ("site.h5", "path.txt"):
            self.refused(self.run_(words.replace("-o section.h5", f"-o {output} --force")),
                         f"{output}: is an input too", 2)
        self.refused(self.run_("section export section.h5 --table bands -o section.h5 --force"),
                     "section.h5: is an input too", 2)
        (self.folder / "kept.csv").write_text("mine")
        self.refused(self.run_("section export section.h5 --table bands -o kept.csv"),
                     "kept.csv: exists", 2)
        self.assertEqual((self.folder / "kept.csv").read_text(), "mine")
        self.assertEqual((self.folder / "section.h5").read_bytes(), before)

    def test_too_little_memory_names_a_bin_that_fits(self):
        refusals = 0
        for memory in ("1M", "3M", "6M", "12M"):
            for cell in ("0.01", "0.03"):
                words = f"--memory {memory} --cell {cell} --bin 0.5"
                done = self.run_(f"section find --env site.h5 --trajectory path.txt "
                                 f"--x-range=-1,1 -o out.h5 --force {words}")
                if done.returncode == 0:
                    continue
                self.assertEqual(done.returncode, 4, done)
                if "larger cells" in done.stderr:
                    continue
                refusals += 1
                fits = re.search(r"bins of ([\d.]+) fit", done.stderr)
                found = json.loads(self.find(words.replace("--bin 0.5", f"--bin {fits[1]}")
                                             + " --json").stdout)
                limit = int(memory[:-1]) << 20
                self.assertLessEqual(found["needed_host_bytes"], limit)
        self.assertGreaterEqual(refusals, 2)
        self.refused(self.find("--memory 1M --cell 0.001", 4), "larger cells or a smaller window", 4)

    def test_a_kill_leaves_no_section(self):
        (self.folder / "out.h5").unlink(missing_ok=True)
        self.write_path("slow.txt", 40001, 0.0005)
        words = [PROGRAM[0], "section", "find", "--env", "site.h5", "--trajectory", "slow.txt",
                 "--x-range=-1,1", "--cell", "0.004", "--bin", "2", "--threads", "1", "-o", "out.h5"]
        stopped = {signal.SIGTERM: 0, signal.SIGINT: 0, signal.SIGKILL: 0}
        for attempt in range(6):
            kind = list(stopped)[attempt % 3]
            with subprocess.Popen(words, cwd=self.folder, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True) as process:
                wait_until_caught(process, signal.SIGTERM)
                time.sleep(0.05 + 0.1 * attempt)
                process.send_signal(kind)
                _, told = process.communicate(timeout=60)
            if process.returncode == 0:
                (self.folder / "out.h5").unlink()
                continue
            if kind == signal.SIGKILL and (self.folder / "out.h5").exists():
                self.ok("verify out.h5")  # the kill came when the section was there already
                (self.folder / "out.h5").unlink()
                continue
            stopped[kind] += 1
            self.assertFalse((self.folder / "out.h5").exists())
            if kind != signal.SIGKILL:
                self.assertEqual(process.returncode, 5, told)
                self.assertEqual([p.name for p in self.folder.glob("*out.h5*")], [])
        self.assertGreaterEqual(min(stopped.values()), 1, stopped)
        for left in self.folder.glob("*out.h5*"):  # what a kill leaves does not hinder the next one
            self.assertNotEqual(left.name, "out.h5")
        self.find("no-force")

    def test_feet(self):
        self.write_scan("feet.xyz", self.points / FOOT)
        self.ok("convert feet.xyz --unit ift -o feet.h5")
        self.write_path("feet.txt", 40, 0.5 / FOOT)
        found = json.loads(self.find("--json --window=-10,10,-2,12 --cell 0.2 --bin 5m --margin 0.5",
                                     env="feet.h5", path="feet.txt", range_="-1m,1m").stdout)
        info = json.loads(self.ok("info out.h5 --json").stdout)
        self.assertEqual(info["length_unit"], "foot")
        self.assertEqual(found["bins"], 4)
        self.assertAlmostEqual(info["bin"], 5 / FOOT)
        metres = self.verdict(RECTANGLE, "--unit m --margin 0.1m", "out.h5")
        self.assertEqual(metres["verdict"], "passes")
        self.assertAlmostEqual(metres["margin"], 0.1 / FOOT)
        feet = "\n".join(",".join(repr(float(v) / FOOT) for v in row.split(","))
                         for row in RECTANGLE.split())
        for more in ("", "--unit ft", "--unit ift"):
            self.assertEqual(self.verdict(feet, f"{more} --margin 0.3", "out.h5")["verdict"], "passes")
        wide = RECTANGLE.replace("0.5,", "1.9,")
        self.assertEqual(self.verdict(wide, "--unit m --margin 0", "out.h5")["verdict"], "passes")
        self.assertEqual(self.verdict(wide, "--margin 0", "out.h5")["verdict"], "passes")
        self.assertEqual(self.verdict(wide, "--unit m --margin 0.1m", "out.h5")["verdict"], "stopped")
        self.assertEqual(self.verdict(wide, "--margin 0.05m", "out.h5")["verdict"], "passes")
        self.ok("section export out.h5 --table bands --band 1ft --base 1ft -o t.csv --force")
        first = [line for line in (self.folder / "t.csv").read_text().splitlines()
                 if line[0].isdigit()][0]
        self.assertTrue(first.startswith("1,2,"), first)
        # A foot that is not the international one: "ft" is the environment's foot.
        self.ok("convert feet.xyz --unit us-ft -o us.h5")
        self.find("--window=-10,10,-2,12 --cell 0.25", env="us.h5", path="feet.txt", range_="-3,3")
        edge = "-6.5,2\n6.5,2\n6.5,4\n-6.5,4\n"
        self.assertEqual(self.verdict(edge, "--unit ft", "out.h5"),
                         self.verdict(edge, "", "out.h5"))


class Seen(Sections):
    """A tube that is scanned from its axis, every few metres."""

    ASKED = ("--window=-3,3,-0.5,4 --cell 0.05 --margin 0.2 --seen --seen-cube 0.25")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.write_seen("seen", 120000)
        cls.find_seen("seen")

    @classmethod
    def write_seen(cls, name, count, more=None):
        points = tube(np.random.default_rng(8), count, 20)
        stands = np.repeat(np.arange(-3, 24, 1.0), -(-count // 27))[:count]
        away = points[:, 0] - stands  # at most 3 m along the tube, so that beams cross it
        points[:, 0] = stands + np.clip(away % 6 - 3, -3, 3)
        if more is not None:
            points, stands = more(points, stands)
        cls.write_scan(f"{name}.xyz", points)
        first = np.flatnonzero(np.diff(stands, prepend=np.nan) != 0)
        rows = "".join(f"{i},{stands[i]},0,1.5\n" for i in first)
        (cls.folder / f"{name}.csv").write_text("first,x,y,z\n" + rows)
        cls.ok(f"convert {name}.xyz --unit m --origins {name}.csv -o {name}.h5")

    @classmethod
    def find_seen(cls, name, more="", output=None):
        output = output or f"{name}-section.h5"
        return json.loads(cls.ok(
            f"section find --env {name}.h5 --trajectory path.txt --x-range=-1,1 {cls.ASKED} "
            f"-o {output} --force --json {more}").stdout)

    def cells(self, section, table="unknown-cells"):
        self.ok(f"section export {section} --table {table} -o cells.csv --force")
        lines = (self.folder / "cells.csv").read_text().splitlines()
        self.assertEqual(lines[0], "bin,j,k,first_pose" if "bin-" in table else "j,k,first_pose")
        return [tuple(map(int, line.split(","))) for line in lines[1:]]

    def test_what_the_beams_crossed_is_free_and_the_rest_is_not_known(self):
        section = "seen-section.h5"
        self.assertEqual(self.verdict(RECTANGLE, "--margin 0.2", section)["verdict"], "passes")
        outside = "-2.9,3.3\n2.9,3.3\n2.9,3.8\n-2.9,3.8\n"
        answer = self.verdict(outside, "--margin 0", section)
        self.assertEqual((answer["verdict"], answer["first_pose"], answer["stops"]),
                         ("unknown", None, []))
        self.assertRegex(answer["reason"], "no beam .* first at pose 0, 0 along the path")
        self.assertEqual([p["bin"] for p in answer["unknowns"]], [0, 1, 2, 3, 4])
        self.ok(f"section find --env seen.h5 --trajectory path.txt --x-range=-1,1 --force "
                f"{self.ASKED.split('--seen')[0]} -o plain.h5")
        plain = self.verdict(outside, "--margin 0", "plain.h5")
        self.assertEqual(plain["verdict"], "passes")
        self.assertNotIn("unknowns", plain)
        self.assertNotIn("seen", json.loads(self.find("--json", env="seen.h5").stdout))
        unknown = {cell[:2] for cell in self.cells(section)}
        self.assertIn((50, 70), unknown)   # y 2.5, z 3.5: behind the walls
        self.assertNotIn((0, 30), unknown)  # the axis
        blocked = {cell[:2]: cell[2] for cell in self.cells(section, "cells")}
        self.assertEqual(blocked, {c[:2]: c[2] for c in self.cells("plain.h5", "cells")})

    def test_what_hides_behind_a_board_is_not_known(self):
        def with_board(points, stands):
            part = 1.2 / np.maximum(points[:, 1], 1.2)  # of the beam, to the plane of the board
            at = stands + part * (points[:, 0] - stands)
            hits = (part < 1) & (np.abs(at - 10) < 1.5)
            points[hits] = np.stack([at, np.full(len(at), 1.2),
                                     1.5 + part * (points[:, 2] - 1.5)], 1)[hits]
            return points, stands
        self.write_seen("board", 120000, with_board)
        found = self.find_seen("board")
        # At y = 1.6 the board hides what lies from x = 9.1 to 10.9.
        cells = {cell[:2]: cell[2] for cell in self.cells("board-section.h5")}
        free = {cell[:2] for cell in self.cells("seen-section.h5")}
        hidden = (32, 30)  # y = 1.6, z = 1.5
        self.assertNotIn(hidden, free)
        # From the pose on at which the load, with its margin, reaches the first hidden cubes.
        self.assertIn(hidden, cells)
        self.assertTrue(14 <= cells[hidden] <= 17, cells[hidden])
        outline = "1.4,1.3\n1.7,1.3\n1.7,1.7\n1.4,1.7\n"
        answer = self.verdict(outline, "--margin 0", "board-section.h5")
        self.assertEqual(answer["verdict"], "unknown")
        self.assertTrue(25 <= answer["unknowns"][0]["cell"][1] <= 34)
        self.assertEqual(self.verdict(outline, "--margin 0", "seen-section.h5")["verdict"], "passes")
        self.assertGreater(found["seen"]["unknown"], 0)

    def test_the_file(self):
        found = self.find_seen("seen", "--threads 1", "a.h5")
        self.find_seen("seen", "--threads 3", "b.h5")
        self.assertEqual((self.folder / "a.h5").read_bytes(), (self.folder / "b.h5").read_bytes())
        self.assertEqual(found["seen"]["cube"], 0.25)
        self.assertEqual(found["seen"]["unknown"], len(self.cells("a.h5")))
        self.assertEqual(found["seen"]["unknown_in_bins"],
                         len(self.cells("a.h5", "unknown-bin-cells")))
        info = json.loads(self.ok("info a.h5 --json").stdout)
        self.assertEqual((info["seen_cube"], info["unknown"]), (0.25, found["seen"]["unknown"]))
        self.ok("verify a.h5")
        bytes_ = (self.folder / "a.h5").read_bytes()
        refused = 0
        for at in range(0, len(bytes_), max(1, len(bytes_) // 60)):
            changed = bytearray(bytes_)
            changed[at] ^= 0x55
            (self.folder / "changed.h5").write_bytes(changed)
            done = self.run_("verify changed.h5")
            self.assertIn(done.returncode, (0, 1, 3, 4), done)
            refused += done.returncode != 0
        self.assertGreater(refused, 20)

    def test_tables_say_where_widths_end(self):
        self.ok("section export seen-section.h5 --table bands --band 0.5 --base 0.5 -o t.csv --force")
        text = (self.folder / "t.csv").read_text()
        self.assertIn("no beam of the scanner crossed", text)
        lines = [line for line in text.splitlines() if not line.startswith("#")]
        self.assertTrue(lines[0].endswith("symmetric_width,left_end,right_end"))
        ends = {line.split(",")[-1] for line in lines[1:]} | {line.split(",")[-2] for line in lines[1:]}
        self.assertLessEqual(ends, {"blocked", "not-known", ""})
        self.assertIn("not-known", ends)
        for table in ("boxes", "stations"):
            self.ok(f"section export seen-section.h5 --table {table} --band 0.5 -o t.csv --force")
            self.assertIn(",left_end,right_end\n", (self.folder / "t.csv").read_text())
        self.ok("section export section.h5 --table bands -o t.csv --force")
        self.assertNotIn("_end", (self.folder / "t.csv").read_text())
        self.refused(self.run_("section export section.h5 --table unknown-cells -o no.csv"),
                     "without seen space", 2)

    def test_refusals(self):
        for more, text, env in (("--seen", "where its scanner stood", "site.h5"),
                                ("--seen-cube 0.1", "expected seen space", "seen.h5"),
                                ("--seen --seen-cube 0", "--seen-cube", "seen.h5"),
                                ("--seen --seen-cube 1e-7", "at least", "seen.h5"),
                                ("--seen --seen-cube 1e9", "below 2", "seen.h5")):
            with self.subTest(more):
                self.refused(self.find(more, 2, env=env), text, 2)
        done = self.find("--seen --seen-cube 0.02 --memory 4M", 4, env="seen.h5")
        self.assertRegex(done.stderr, "larger cubes|larger cells|bins of")
        done = self.run_("section find --env seen.h5 --trajectory path.txt --x-range=-1,1 --force "
                         "--cell 0.05 --bin 0.5 --seen --memory 6M -o out.h5")
        self.assertEqual(done.returncode, 4)
        fits = re.search(r"bins of ([\d.]+) fit", done.stderr)
        found = json.loads(self.find(f"--cell 0.05 --bin {fits[1]} --seen --memory 6M --json",
                                     env="seen.h5").stdout)
        self.assertLessEqual(found["needed_host_bytes"], 6 << 20)
        (self.folder / "empty.csv").write_text("x,y,z,qx,qy,qz,qw\n")
        nothing = self.run_("section find --env seen.h5 --trajectory empty.csv --x-range=-1,1 "
                            "--seen -o out.h5 --force --json")
        if nothing.returncode == 0:
            self.assertEqual(json.loads(nothing.stdout)["seen"]["unknown"], 0)
            self.assertEqual(self.verdict(RECTANGLE, "", "out.h5")["verdict"], "unknown")

    def test_fewer_beams_know_less(self):
        self.write_seen("fewer", 120000, lambda points, stands: (points[::3], stands[::3]))
        self.find_seen("fewer")
        more = {c[:3] for c in self.cells("fewer-section.h5", "unknown-bin-cells")}
        less = {c[:3] for c in self.cells("seen-section.h5", "unknown-bin-cells")}
        blocked = {c[:3] for c in self.cells("seen-section.h5", "bin-cells")}
        self.assertEqual(less - more - blocked, set())
        self.assertGreater(len(more), len(less))


class Exports(Sections):
    def rows(self, table, more="--band 0.5"):
        self.ok(f"section export section.h5 --table {table} {more} -o t.csv --force")
        lines = (self.folder / "t.csv").read_text().splitlines()
        return [line.split(",") for line in lines if not line.startswith("#")]

    def test_tables_follow_from_the_cells(self):
        cells = np.array(self.rows("cells", "")[1:], int)
        of_bins = np.array(self.rows("bin-cells", "")[1:], int)
        first = {}
        for _, j, k, pose in of_bins:
            first[k, j] = min(pose, first.get((k, j), pose))
        self.assertEqual([(j, k, pose) for (k, j), pose in sorted(first.items())],
                         [tuple(c) for c in cells])
        bands = self.rows("bands")
        self.assertEqual(bands[0][:2] + bands[0][-1:], ["z_from", "z_to", "symmetric_width"])
        boxes = self.rows("boxes", f"--band 0.5 --base={bands[1][0]}")
        lifted = self.rows("boxes")  # from the lowest band whose middle is free
        self.assertLess(len(lifted), len(boxes))
        self.assertEqual([box[0] for box in lifted[1:]], [box[0] for box in boxes[-len(lifted) + 1:]])
        self.assertNotEqual(lifted[1][1], "0")
        least = 10**6
        for band, box in zip(bands[1:], boxes[1:], strict=True):
            low, high = round(float(band[0]) / 0.05), round(float(band[1]) / 0.05)
            here = cells[(cells[:, 1] >= low) & (cells[:, 1] < high)]
            left = here[here[:, 0] >= 0, 0].min(initial=10**6)
            least = min(least, left)
            for cell, shown in ((left, band[2]), (least, box[1])):
                if cell == 10**6:
                    self.assertEqual(shown, "open")
                else:
                    self.assertAlmostEqual(float(shown), cell * 0.05)
        stations = self.rows("stations")
        self.assertEqual(len(stations) - 1, 5 * (len(bands) - 1))
        self.assertEqual(stations[0][:3], ["bin", "chainage_from", "chainage_to"])

    def test_refusals(self):
        for words, text in (("--table rows", "--table"), ("--table bands --band 0", "--band"),
                            ("--table bands --band=-1", "--band"), ("", "expected --table"),
                            ("--table bands --base 99", "no band"), ("--table bands --base nan", "--base"),
                            ("--table bands --outline", "outline|exclud"),
                            ("--table bands --band 1e-9", "at most a million")):
            with self.subTest(words):
                self.refused(self.run_(f"section export section.h5 {words} -o no.csv"), text, 2)
        self.find("--window=0.5,3,0,3")
        self.refused(self.run_("section export out.h5 --table bands -o no.csv"), "lacks the middle", 2)
        self.refused(self.run_("section export section.h5 --outline --base 0 -o no.dxf"),
                     "no load stands", 2)
        self.assertEqual([p.name for p in self.folder.glob("no.*")], [])

    def test_the_largest_outline_passes(self):
        self.ok("section export section.h5 --outline --base 0.1 --band 0.2 -o o.dxf --force")
        outline = [(-x, y) for x, y in Drawing(self.folder / "o.dxf").corners]
        self.assertGreater(len(outline), 3)
        self.assertEqual(self.verdict(text_of(outline), "--margin 0")["verdict"], "passes")
        wider = text_of([(1.01 * y, z) for y, z in outline])
        self.assertEqual(self.verdict(wider, "--margin 0")["verdict"], "stopped")

    def test_drawings_look_forward(self):
        """18 sections of tubes with a post on one side: what is right of the path is right in the
        drawing, which says so, and mirrored it is the outline that the section lets pass."""
        random = np.random.default_rng(17)
        for trial in range(18):
            side = [-1, 1][trial % 2]  # -1: the post is on the right
            post = random.uniform(0.3, 1.2)
            bottom = [-0.5, 0, 0.42][trial % 3]
            scan = np.concatenate([self.points[::3], np.stack([
                np.full(200, random.uniform(5, 15)), np.full(200, side * post),
                np.linspace(0.6, 2.4, 200)], 1)])
            self.write_scan("post.xyz", scan)
            self.ok("convert post.xyz --unit m -o post.h5 --force")
            self.find(f"--window=-3,3,{bottom},4 --cell 0.05", env="post.h5")
            base = max(0.1, bottom)
            more = "" if bottom > 0 else f"--base {base}"
            self.ok(f"section export out.h5 --outline {more} --band 0.25 -o o.dxf --force")
            with self.subTest(trial):
                drawing = Drawing(self.folder / "o.dxf")
                self.assertIn("Looking forward: x is to the right, y is up", drawing.comments)
                self.assertIn("y to the left instead: y = -x", " ".join(drawing.comments))
                self.assertEqual(drawing.texts, ["Looking forward: x is to the right, y is up"])
                least = {sign: min(abs(x) for x, _ in drawing.corners if x * sign > 0)
                         for sign in (-1, 1)}  # 1: on the right of the drawing
                self.assertGreater(least[side], 1.9)
                self.assertTrue(post - 0.1 < least[-side] < post, (post, least))
                outline = text_of([(-a, b) for a, b in drawing.corners])
                self.assertEqual(self.verdict(outline, "", "out.h5")["verdict"], "passes")
                mirrored = text_of(drawing.corners)
                self.assertEqual(self.verdict(mirrored, "", "out.h5")["verdict"], "stopped")

    def test_a_window_above_the_base(self):
        self.find("--window=-3,3,0.42,4 --cell 0.02")
        for table in ("bands", "boxes", "stations"):
            words = f"section export out.h5 --table {table} --band 0.5 -o t.csv --force"
            self.refused(self.run_(words + " --base 0"), "base z = 0 is below the window.*z = 0.42", 2)
            self.ok(words)
            lines = (self.folder / "t.csv").read_text().splitlines()
            self.assertIn("# The base is the bottom of the window, z = 0.42", lines)
            first = next(line for line in lines if line[0].isdigit()).split(",")
            self.assertAlmostEqual(float(first[{"bands": 0, "boxes": 0, "stations": 3}[table]]),
                                   0.92 if table == "boxes" else 0.42)
        self.refused(self.run_("section export out.h5 --outline --base 0 -o no.dxf"),
                     "below the window", 2)
        self.refused(self.run_("report out.h5 --base 0 -o no.html"), "below the window", 2)
        self.ok("report out.h5 -o page.html --force")

    def test_a_section_in_doubt_has_no_widths(self):
        self.write_path("far.txt", 5, 0.5, lambda i: (5000, 0))
        self.find("", path="far.txt")
        for words in ("--table bands", "--table boxes", "--table stations", "--outline"):
            with self.subTest(words):
                self.refused(self.run_(f"section export out.h5 {words} -o no.csv"), "out-of-reach", 2)
        self.ok("section export out.h5 --table cells -o t.csv --force")


if __name__ == "__main__":
    PROGRAM.append(os.path.abspath(sys.argv.pop(1)))
    unittest.main()
