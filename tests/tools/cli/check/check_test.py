#!/usr/bin/python3
"""`clearway check`: from files to the finding, again, after a kill, with mistakes in each input.

    check_test.py CLEARWAY
"""

import json
import math
import os
import random
import re
import shlex
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

PROGRAM = os.path.abspath(sys.argv[1])
FILES = ["site.h5", "result.h5", "conflicts.csv", "stations.csv", "report.html"]
QUESTION = "--model model.ply --trajectory trajectory.txt --radius 0.1"


def clearway(words, folder, **options):
    words = shlex.split(words) if isinstance(words, str) else words
    return subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, text=True,
                          check=False, **options)


def printed_commands(text):
    return re.findall(r"^  (clearway .*)$", text, re.M)


def facts_of_page(page):
    return json.loads(re.search(r'<script[^>]*id="facts"[^>]*>(.*?)</script>', page.read_text(), re.S)[1])


def bytes_of(folder, names=FILES):
    return {name: (folder / name).read_bytes() for name in names}


UTM_32 = (b'PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89",'
          b'DATUM["European_Terrestrial_Reference_System_1989",'
          b'SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],'
          b'UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4258"]],'
          b'PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],'
          b'PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],'
          b'PARAMETER["false_easting",500000],PARAMETER["false_northing",0],'
          b'UNIT["metre",1],AUTHORITY["EPSG","25832"]]\0')


def write_utm_scan(path, points):
    """LAS 1.4 with a reference system, and steps of 1 mm from E 500 km and N 5,316 km on."""
    header = bytearray(375)
    header[0:4] = b"LASF"
    struct.pack_into("<H", header, 6, 16)
    header[24:26] = bytes((1, 4))
    struct.pack_into("<HII", header, 94, 375, 375 + 54 + len(UTM_32), 1)
    struct.pack_into("<BH", header, 104, 6, 30)
    struct.pack_into("<6d", header, 131, 1e-3, 1e-3, 1e-3, 500000, 5316000, 0)
    for k, start in enumerate((500000, 5316000, 0)):
        axis = [start + p[k] / 1000 for p in points]
        struct.pack_into("<2d", header, 179 + 16 * k, max(axis), min(axis))
    struct.pack_into("<Q", header, 247, len(points))
    record = bytearray(54)
    record[2:17] = b"LASF_Projection"
    struct.pack_into("<HH", record, 18, 2112, len(UTM_32))
    bodies = (struct.pack("<3i2xBxB13x", *p, 0x11, 1) for p in points)
    path.write_bytes(bytes(header + record) + UTM_32 + b"".join(bodies))


class Site(unittest.TestCase):
    """A small hall whose scan is in a folder of its own, and a fresh copy of it for each test."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="clearway-check-")
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.master = Path(cls.scratch.name) / "master"
        cls.master.mkdir()
        made = clearway("scene hall --points 20000 --model-points 500 --poses 1600 -o .", cls.master)
        assert made.returncode == 0, made.stderr
        (cls.master / "scans").mkdir()
        (cls.master / "environment.las").rename(cls.master / "scans/environment.las")

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(dir=self.scratch.name)) / "work"
        shutil.copytree(self.master, self.folder)

    def check(self, words, exit_code=0, folder=None, **options):
        done = clearway("check " + words, folder or self.folder, **options)
        self.assertEqual(done.returncode, exit_code, f"{words}\n{done.stdout}\n{done.stderr}")
        return done

    def asked(self, words, exit_code=0, **options):
        """A check of the scans with the usual question, into site/."""
        return self.check(f"scans {QUESTION} -o site {words}", exit_code, **options)

    def convert(self):
        """Makes site/site.h5 of the scans, and nothing else."""
        (self.folder / "site").mkdir()
        done = clearway("convert scans -o site/site.h5", self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)

    def paste(self, commands, folder):
        """Runs the commands as a shell takes them apart. Every one has to succeed."""
        links = folder / "bin"
        links.mkdir()
        (links / "clearway").symlink_to(PROGRAM)
        for command in commands:
            done = subprocess.run(command, shell=True, cwd=folder, capture_output=True, text=True,
                                  check=False,
                                  env={**os.environ, "PATH": f"{links}:{os.environ['PATH']}"})
            self.assertEqual(done.returncode, 0, f"{command}\n{done.stderr}")
        shutil.rmtree(links)

    def pasted_elsewhere(self, commands, output="site"):
        """The files that the commands make of the same inputs in another place."""
        other = Path(tempfile.mkdtemp(dir=self.scratch.name)) / "elsewhere"
        shutil.copytree(self.master, other)
        (other / output).mkdir(parents=True)
        self.paste(commands, other)
        return bytes_of(other / output)


class Finding(Site):
    def test_four_arguments_are_enough(self):
        done = self.asked("--between-poses=false --seen=0")  # flags that are off
        self.assertEqual(sorted(path.name for path in (self.folder / "site").iterdir()),
                         sorted([*FILES, "check.json"]))
        for words in ("run --env site/site.h5 --first-pose --clearance 0.3 --profile 0.5 "
                      f"{QUESTION} -o by_hand.h5",
                      "conflicts by_hand.h5 --trajectory trajectory.txt --model model.ply "
                      "-o by_hand.csv"):
            by_hand = clearway(words, self.folder)
            self.assertEqual(by_hand.returncode, 0, by_hand.stderr)
        self.assertEqual((self.folder / "by_hand.h5").read_bytes(),
                         (self.folder / "site/result.h5").read_bytes())
        self.assertEqual((self.folder / "by_hand.csv").read_bytes(),
                         (self.folder / "site/conflicts.csv").read_bytes())
        verdict = clearway(f"run --env site/site.h5 --first-pose --clearance 0.3 --profile 0.5 "
                           f"{QUESTION} -o again.h5", self.folder).stdout
        without_nearest = re.sub(r"; the least distance is .*?(?=; see the)", "",
                                 verdict.splitlines()[-1])
        # One place is named: the worst one, and not the nearest beside it.
        self.assertEqual(done.stdout.splitlines()[-1],
                         f"{without_nearest} {by_hand.stdout.splitlines()[-1]}")
        self.assertIn("taken by default: --clearance 0.3 (3 times the radius) and "
                      "--profile 0.5 (5 times the radius)", done.stderr)

    def first_quarter_of_the_path(self):
        """quarter.txt: 20 m with some conflicts, for many questions about it."""
        lines = (self.folder / "trajectory.txt").read_text().splitlines()
        (self.folder / "quarter.txt").write_text("\n".join(lines[:400]) + "\n")

    def coarse_path(self):
        lines = (self.folder / "trajectory.txt").read_text().splitlines()
        (self.folder / "coarse.txt").write_text("\n".join(lines[::40]) + "\n")
        return lines

    def test_a_path_with_large_steps_is_made_denser(self):
        self.coarse_path()
        coarse = "--model model.ply --trajectory coarse.txt --radius 0.1"
        done = self.check(f"scans {coarse} -o site")
        self.assertIn("site/path.txt: from one pose to the next the model moves by up to", done.stderr)
        self.assertNotIn("What lies between two poses can be missed", done.stderr)
        commands = printed_commands(done.stdout)
        self.assertEqual([shlex.split(command)[1] for command in commands],
                         ["convert", "trajectory", "run", "conflicts", "stations", "report"])
        self.assertTrue(all("--trajectory site/path.txt" in c for c in commands[2:]), commands)
        first = bytes_of(self.folder / "site")
        again = json.loads(self.check(f"scans {coarse} -o site --json").stdout)
        self.assertTrue(again["nothing_done"])
        self.assertEqual(set(again["reused"].values()), {True})
        self.assertEqual(bytes_of(self.folder / "site"), first)
        # The page names the path that was given, and shows the warnings that --json has.
        facts = facts_of_page(self.folder / "site/report.html")
        given = len((self.folder / "coarse.txt").read_text().splitlines())
        self.assertIn(f"resample of coarse.txt: {given} given poses among ",
                      facts["inputs"]["trajectory"]["made_by"])
        self.assertTrue(facts["inputs"]["environment"]["scans"]["names"])
        self.assertEqual(again["warnings"], facts["warnings"])
        # The way of reading the path is that of the file, and not of the denser one.
        given = self.check(f"scans {coarse} --trajectory-format matrix --lever-arm 0,0,0.01 -o site --force")
        run = next(c for c in printed_commands(given.stdout) if " run " in c)
        self.assertNotIn("--lever-arm", run)
        self.assertNotIn("--trajectory-format", run)

    def test_the_path_of_a_vehicle_is_made_denser_for_every_body(self):
        bends = [(i, 0.02 * i * i) for i in range(12)]
        self.bend(self.folder / "bend.txt", bends)
        bodies = [{"name": "a", "model": "model.ply"},
                  {"name": "b", "model": "model.ply", "pivots": [-2, -4]},
                  {"name": "c", "model": "model.ply",
                   "towed": {"by": "b", "at": -5, "pivots": [0, -3]}}]
        self.vehicle(bodies)
        words = "scans --vehicle train.json --trajectory bend.txt --radius 0.1"
        done = self.check(f"{words} -o train")
        self.assertNotIn("What lies between two poses can be missed", done.stderr)
        again = next(c for c in printed_commands(done.stdout) if " resample " in c)
        told = json.loads(clearway(shlex.split(again)[1:] + ["--json"], self.folder).stdout)
        self.assertGreater(told["largest_motion_before"], 0.1)
        self.assertLessEqual(told["largest_motion_after"], 0.1 * (1 + 1e-6))
        self.assertTrue(json.loads(self.check(f"{words} -o train --json").stdout)["nothing_done"])
        # A body that stays itself but is read from another file counts like the path.
        self.vehicle(bodies[:2])
        self.assertIn("answers another question", self.check(f"{words} -o train", 2).stderr)

    def test_a_body_with_a_trajectory_of_its_own_keeps_the_path(self):
        self.bend(self.folder / "bend.txt", [(i, 0) for i in range(12)])
        self.vehicle([{"name": "a", "model": "model.ply"},
                      {"name": "own", "model": "model.ply", "trajectory": "bend.txt"}])
        done = self.check("scans --vehicle train.json --trajectory bend.txt --radius 0.1 -o own")
        self.assertIn("no poses are put between", done.stderr)
        self.assertIn("the poses of the body own belong to those of the path", done.stderr)

    def vehicle(self, bodies):
        (self.folder / "train.json").write_text(json.dumps({"bodies": bodies}))

    @staticmethod
    def bend(file, places):
        """Poses at these places, which look along the way there."""
        lines = []
        for i, (x, y) in enumerate(places):
            to = places[min(i + 1, len(places) - 1)]
            at = places[max(i - 1, 0)]
            length = math.dist(at, to)
            c, s = (to[0] - at[0]) / length, (to[1] - at[1]) / length
            lines.append(f"{c} {-s} 0 {x} {s} {c} 0 {y} 0 0 1 0\n")
        file.write_text("".join(lines))

    def test_a_limit_of_processes_is_told(self):
        """Pools of threads that do not fit beside each other, for a user who has no other process."""
        user = ["setpriv", "--reuid", "23456", "--regid", "23456", "--clear-groups"]
        tried = shutil.which("setpriv") and os.geteuid() == 0 and subprocess.run(
            [*user, PROGRAM, "--version"], capture_output=True, check=False).returncode == 0
        if not tried:
            self.skipTest("only root becomes a user without other processes")
        for folder in (self.scratch.name, self.folder.parent):
            os.chmod(folder, 0o755)
        codes = set()
        for limit in range(2, 14):
            out = self.folder / "limited"
            shutil.rmtree(out, ignore_errors=True)
            out.mkdir(0o777)
            os.chmod(out, 0o777)
            done = subprocess.run(
                [*user, "prlimit", f"--nproc={limit}", PROGRAM, "check", "scans", *shlex.split(QUESTION),
                 "--threads", "4", "-o", "limited"],
                cwd=self.folder, capture_output=True, text=True, check=False)
            codes.add(done.returncode)
            if done.returncode != 0:
                self.assertEqual(done.returncode, 4, f"{limit}: {done.stderr}")
                self.assertIn("threads cannot be started", done.stderr)
        self.assertEqual(codes, {0, 4})

    def near_and_whole(self, words):
        """The output of a check of what is near the path; its tables are those of all points."""
        near = self.check(f"{words} --near -o near")
        self.check(f"{words} -o whole")
        tables = ["conflicts.csv", "stations.csv"]
        self.assertEqual(bytes_of(self.folder / "near", tables),
                         bytes_of(self.folder / "whole", tables))
        self.assertTrue(json.loads(
            self.check(f"{words} --near --json -o near").stdout)["nothing_done"])
        return near

    def test_only_what_is_near_the_path(self):
        near = self.near_and_whole(f"scans {QUESTION}")
        self.assertIn("--near trajectory.txt --within ", near.stdout)
        self.assertEqual(self.pasted_elsewhere(printed_commands(near.stdout), "near"),
                         bytes_of(self.folder / "near"))
        trusting = self.check(f"scans {QUESTION} --near --trust-bounds -o trusting")
        self.assertIn("--trust-bounds", trusting.stdout)

    def test_a_corridor_that_proves_too_narrow_is_known_the_next_time(self):
        self.bend(self.folder / "corners.txt", [(0, 0), (30, 0), (30, 30), (60, 30), (60, 60)])
        asked = "scans --model model.ply --trajectory corners.txt --near"
        self.assertIn("The scans are converted once more",
                      self.check(f"{asked} --radius 0.1 -o site").stderr)
        self.assertIn("nothing was to be done", self.check(f"{asked} --radius 0.1 -o site").stderr)
        self.check(f"{asked} --radius 0.3 -o site --force")
        self.check(f"{asked} --radius 0.3 -o fresh")
        for name in ("site.h5", "result.h5", "conflicts.csv"):
            self.assertEqual((self.folder / "site" / name).read_bytes(),
                             (self.folder / "fresh" / name).read_bytes(), name)

    def test_scans_in_feet_and_a_denser_path(self):
        self.coarse_path()
        near = self.near_and_whole("scans --model model.ply --trajectory coarse.txt --radius 3cm "
                                   "--unit ft")
        self.assertIn("--trajectory near/path.txt", near.stdout)
        self.assertNotIn("converted once more", near.stderr)

    def test_a_path_in_degrees_is_read_in_the_system_of_the_scans(self):
        draw = random.Random(1)
        points = [(side + draw.randrange(-100, 100), draw.randrange(270000, 380000),
                   draw.randrange(12500, 16000))
                  for side in (-60000, -3000, 3000, 60000) for _ in range(5000)]
        points.append((900, 320000, 13000))
        write_utm_scan(self.folder / "utm.las", points)
        lines = ["lat,lon,height,roll_deg,pitch_deg,heading_deg"]
        lines += [f"{48 + i * 0.5 / 111194:.10f},9.0,12.5,0,0,0" for i in range(60)]
        (self.folder / "degrees.csv").write_text("\n".join(lines) + "\n")
        near = self.near_and_whole(
            "utm.las --model box:4,1.8,1.5 --trajectory degrees.csv --radius 0.1")
        self.assertIn("conflict: 1 point ", near.stdout)

    def test_a_path_with_a_jump_stays_as_it_is(self):
        lines = self.coarse_path()
        (self.folder / "jump.txt").write_text("\n".join(lines[:400] + lines[1200:]) + "\n")
        done = self.check("scans --model model.ply --trajectory jump.txt --radius 0.1 -o site")
        self.assertFalse((self.folder / "site/path.txt").exists())
        self.assertNotIn("resample", done.stdout)

    def test_the_printed_commands_give_the_same_bytes(self):
        done = self.asked("")
        commands = printed_commands(done.stdout)
        self.assertEqual([shlex.split(command)[1] for command in commands],
                         ["convert", "run", "conflicts", "stations", "report"])
        made = bytes_of(self.folder / "site")
        self.assertEqual(self.pasted_elsewhere(commands), made)
        self.paste(commands, self.folder)  # where everything is there already
        self.assertEqual(bytes_of(self.folder / "site"), made)

    def test_names_that_a_shell_would_take_apart(self):
        (self.folder / "it's a car.ply").write_bytes((self.folder / "model.ply").read_bytes())
        shutil.copy(self.folder / "it's a car.ply", self.master)
        self.addCleanup((self.master / "it's a car.ply").unlink)
        output = "the $HOME; site"
        done = clearway(["check", "scans", "--model", "it's a car.ply", "--trajectory",
                         "trajectory.txt", "--radius", "10", "cm", "--floor", "-0.5",
                         "--title", 'A "site" & more', "--ignore-box", "-1,-2.5,-3,-0.5,9,9",
                         "--ignore-box=1,2,3,4,5,6", "-o", output], self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("--clearance 30cm (", done.stderr)
        self.assertIn("--profile 50cm (", done.stderr)
        made = bytes_of(self.folder / output)
        self.assertEqual(self.pasted_elsewhere(printed_commands(done.stdout), output), made)

    def test_json(self):
        done = self.asked("--json")
        answer = json.loads(done.stdout)
        self.assertEqual(answer["verdict"], "conflict")
        self.assertEqual(answer["run"]["verdict"], "conflict")
        self.assertEqual(len(answer["commands"]), 5)
        self.assertFalse(answer["nothing_done"])
        self.assertEqual(answer["files"]["result"], "site/result.h5")
        self.assertEqual(list(answer["seconds"]),
                         ["convert", "path", "run", "conflicts", "stations", "report"])
        self.assertGreater(min(answer["seconds"][step] for step in ("convert", "run", "report")), 0)
        again = json.loads(self.asked("--json").stdout)
        self.assertTrue(again["nothing_done"])
        self.assertEqual(again["commands"], answer["commands"])
        self.assertEqual(set(again["reused"].values()), {True})

    def test_exit_codes_are_those_of_run(self):
        self.asked("", 0)
        self.asked("--fail-on-collision", 1)
        clear = self.check("scans --model box:0.2,0.2,0.2 --model-as points --trajectory "
                           "trajectory.txt --radius 0.01 -o clear --fail-on-collision")
        self.assertIn("clear", clear.stdout.splitlines()[-1])
        lines = (self.folder / "trajectory.txt").read_text().splitlines()
        far = []
        for line in lines:
            values = line.split()
            values[3] = str(float(values[3]) + 5000)
            far.append(" ".join(values))
        (self.folder / "far.txt").write_text("\n".join(far) + "\n")
        undecided = self.check("scans --model model.ply --trajectory far.txt --radius 0.1 -o far "
                               "--fail-on-collision", 6)
        self.assertIn("undecided", undecided.stdout.splitlines()[-1])
        self.assertEqual(undecided.stderr.count("its verdict is undecided"), 1)
        self.assertIn("nothing was scanned", undecided.stderr + undecided.stdout)
        self.check("scans --model model.ply --trajectory far.txt --radius 0.1 -o far", 0)
        self.check("scans --model model.ply --trajectory far.txt --radius 0.1 -o far --strict", 3)

    def test_a_ledger_is_on_the_page_and_decides_about_success(self):
        def ledger_of_page():
            page = (self.folder / "site/report.html").read_text()
            return json.loads(re.search(r'id="facts"[^>]*>(.*?)</script>', page, re.S).group(1))["ledger"]

        words = f"scans {QUESTION} -o site --min-points 1 --ledger known.csv --date 2026-03-01 --fail-on-collision"
        self.check(words + " --update", exit_code=1)
        found = ledger_of_page()
        self.assertEqual([found["name"], found["date"], found["new"]],
                         ["known.csv", "2026-03-01", len(found["conflicts"])])
        table = self.folder / "known.csv"
        table.write_text(table.read_text().replace(",new,", ",accepted,"))
        done = self.check(words, exit_code=0)
        self.assertIn("The verdict stays conflict. The ledger accepts all", done.stdout)
        self.assertEqual(ledger_of_page()["accepted"], found["new"])

    def test_inputs_of_all_kinds(self):
        whole = self.asked("")
        verdict = whole.stdout.splitlines()[-1]
        single = self.check(f"scans/environment.las {QUESTION} -o single")
        self.assertEqual(single.stdout.splitlines()[-1], verdict)
        self.assertEqual((self.folder / "single/result.h5").read_bytes(),
                         (self.folder / "site/result.h5").read_bytes())
        store = self.check(f"site/site.h5 {QUESTION} -o of_store")
        self.assertEqual(store.stdout.splitlines()[-1], verdict)
        self.assertEqual([shlex.split(c)[1] for c in printed_commands(store.stdout)],
                         ["run", "conflicts", "stations", "report"])
        self.assertFalse((self.folder / "of_store/site.h5").exists())
        self.assertEqual((self.folder / "of_store/result.h5").read_bytes(),
                         (self.folder / "site/result.h5").read_bytes())
        (self.folder / "scans/post.ply").write_text(
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
            "property double z\nend_header\n1 2 1\n1 2 1.1\n")
        self.check(f"scans {QUESTION} -o mixed")
        info = json.loads(clearway("info mixed/site.h5 --json", self.folder).stdout)
        self.assertEqual({source["name"] for source in info["sources"]},
                         {"environment.las", "post.ply"})
        self.assertEqual(info["points"], 20002)

    def test_the_vehicle_may_lie_among_the_scans(self):
        whole = self.asked("")
        for name in ("model.ply", "trajectory.txt"):
            shutil.copy(self.folder / name, self.folder / "scans")
        words = "--model scans/model.ply --trajectory scans/trajectory.txt --radius 0.1"
        for number, scans in enumerate(("scans", "scans/environment.las scans/model.ply")):
            mixed = self.check(f"{scans} {words} -o mixed{number}")
            self.assertIn("scans/model.ply: belongs to the vehicle, so it is not taken as a scan",
                          mixed.stderr)
            self.assertEqual(mixed.stdout.splitlines()[-1], whole.stdout.splitlines()[-1])
            commands = printed_commands(mixed.stdout)
            self.assertIn("clearway convert scans/environment.las -o", commands[0])
        self.check("scans/model.ply --model scans/model.ply --trajectory trajectory.txt "
                   "--radius 0.1 -o none", 2)
        (self.folder / "scans/wagon.json").write_text(json.dumps(
            {"bodies": [{"name": "front", "model": "model.ply"},
                        {"name": "rear", "model": "model.ply", "at": -4}]}))
        wagon = self.check("scans --vehicle scans/wagon.json --trajectory trajectory.txt "
                           "--radius 0.1 -o wagon")
        self.assertIn("scans/model.ply: belongs to the vehicle", wagon.stderr)

    def test_other_questions(self):
        wagon = {"bodies": [{"name": "front", "model": "model.ply"},
                            {"name": "rear", "model": "model.ply", "at": -4}]}
        (self.folder / "wagon.json").write_text(json.dumps(wagon))
        wagon["bodies"][1] = {"name": "rear", "model": "model.ply",
                              "towed": {"by": "front", "at": -2.4, "pivots": [2.4, -1]}}
        (self.folder / "towed.json").write_text(json.dumps(wagon))
        self.first_quarter_of_the_path()
        self.convert()
        for words in ("--vehicle wagon.json", "--vehicle towed.json", "--model model.ply --between-poses",
                      "--model model.ply --error-scan 0.005 --error-model 0.01 --gap 0.2",
                      "--model model.ply --forward=-x",
                      "--model model.ply --clearance 0.2 --min-points 3 --split 0"):
            with self.subTest(words):
                done = self.check("site/site.h5 --trajectory quarter.txt --radius 0.1 "
                                  f"{words} -o other --force")
                commands = printed_commands(done.stdout)
                self.assertEqual("--gap" in commands[0], "--error" in words)
                self.assertEqual("--clearance" in commands[0], "--between-poses" not in words)
                made = bytes_of(self.folder / "other", FILES[1:])
                self.paste(commands, self.folder)
                self.assertEqual(bytes_of(self.folder / "other", FILES[1:]), made)

    def test_every_kind_of_model(self):
        """Meshes of all formats, points, boxes, outlines, and vehicles of them, in another folder."""
        here = self.folder / "vehicles"
        here.mkdir()
        shutil.copy(self.folder / "model.ply", here / "points.ply")
        clearway("model box 2,1,1 -o vehicles/mesh.off", self.folder)
        corners, faces = [], []
        for line in (here / "mesh.off").read_text().splitlines()[1:]:
            values = line.split("#")[0].split()
            if len(values) == 4 and values[0] == "3":
                faces.append([int(v) for v in values[1:]])
            elif len(values) == 3 and (corners or "." in line or not faces and values[1] != "12"):
                corners.append(values)
        (here / "mesh.obj").write_text(
            "".join(f"v {' '.join(c)}\n" for c in corners) +
            "".join(f"f {' '.join(str(i + 1) for i in f)}\n" for f in faces))
        (here / "mesh.ply").write_text(
            f"ply\nformat ascii 1.0\nelement vertex {len(corners)}\nproperty double x\n"
            f"property double y\nproperty double z\nelement face {len(faces)}\n"
            "property list uchar int vertex_indices\nend_header\n" +
            "".join(f"{' '.join(c)}\n" for c in corners) +
            "".join(f"3 {' '.join(map(str, f))}\n" for f in faces))
        (here / "mesh.stl").write_text("solid a\n" + "".join(
            "facet normal 0 0 0\nouter loop\n" +
            "".join(f"vertex {' '.join(corners[i])}\n" for i in f) + "endloop\nendfacet\n"
            for f in faces) + "endsolid a\n")
        (here / "points.txt").write_text("".join(f"{' '.join(c)}\n" for c in corners))
        (here / "gauge.csv").write_text("-1,0\n1,0\n1,2\n-1,2\n")
        made = clearway("model outline vehicles/gauge.csv --x=-1,1 -o vehicles/outline.off",
                        self.folder)
        self.assertEqual(made.returncode, 0, made.stderr)
        models = ["mesh.off", "mesh.obj", "mesh.ply", "mesh.stl", "outline.off", "points.ply",
                  "points.txt", "box:2,1,1"]
        self.assertEqual((len(corners), len(faces)), (8, 12))
        self.first_quarter_of_the_path()
        self.convert()
        site = "site/site.h5 --trajectory quarter.txt --radius 0.1 --force -o"
        sentences = {}
        for model in models:
            path = model if model.startswith("box:") else f"vehicles/{model}"
            with self.subTest(model):
                one = self.check(f"{site} one --model {path}")
                sentences[model] = one.stdout.splitlines()[-1]
                self.assertIn("nothing was to be done",
                              self.check(f"{site} one --model {path}").stderr)
                (here / "one.json").write_text(json.dumps(
                    {"bodies": [{"name": "only", "model": model}]}))
                vehicle = self.check(f"{site} vehicle --vehicle vehicles/one.json")
                self.assertEqual(json.loads(clearway("info vehicle/result.h5 --json", self.folder)
                                            .stdout)["colliding_points"],
                                 json.loads(clearway("info one/result.h5 --json", self.folder)
                                            .stdout)["colliding_points"])
                self.assertIn("nothing was to be done",
                              self.check(f"{site} vehicle --vehicle vehicles/one.json").stderr)
                self.assertEqual(vehicle.stdout.splitlines()[-1].split(" ")[:2],
                                 sentences[model].split(" ")[:2])
        mesh = {sentences[name] for name in ("mesh.off", "mesh.obj", "mesh.ply", "mesh.stl",
                                             "box:2,1,1")}
        self.assertEqual(len(mesh), 1, sentences)
        bodies = [{"name": f"body {i}", "model": model, "at": -2.0 * i}
                  for i, model in enumerate(models)]
        bodies[1] = {**bodies[1], "pivots": [1, -1]}
        del bodies[1]["at"]
        (here / "all.json").write_text(json.dumps({"bodies": bodies}))
        for model_as in ("", " --model-as points --model-spacing 0.1"):
            done = self.check(f"{site} all --vehicle vehicles/all.json{model_as}")
            self.assertEqual(sum("the body has no pose there" in line
                                 for line in done.stderr.splitlines()), len(models) - 1, done.stderr)
        (here / "all.json").write_text(json.dumps({"bodies": [{"name": "a", "model": "box:2,1"}]}))
        refused = self.check(f"{site} all --vehicle vehicles/all.json", 2)
        self.assertIn("expected a box as box:LENGTH,WIDTH,HEIGHT", refused.stderr)

    def test_seen_space(self):
        seen = self.check(f"scans {QUESTION} --origins origins.csv --seen -o seen")
        self.assertIn("--seen", printed_commands(seen.stdout)[1])
        self.assertIn("--origins origins.csv", printed_commands(seen.stdout)[0])


class Again(Site):
    def test_the_second_run_has_nothing_to_do(self):
        first = self.asked("")
        before = {name: (self.folder / "site" / name).stat().st_mtime_ns for name in FILES}
        second = self.asked("")
        self.assertIn("nothing was to be done", second.stderr)
        self.assertEqual(second.stdout, first.stdout)
        after = {name: (self.folder / "site" / name).stat().st_mtime_ns for name in FILES}
        self.assertEqual(before, after)
        self.assertIn("nothing was to be done", self.asked("--threads 1 --memory 1G").stderr)
        (self.folder / "site/check.json").write_text("[[[")
        self.assertNotIn("nothing was to be done", self.asked("").stderr)
        self.assertIn("nothing was to be done", self.asked("").stderr)

    def test_what_is_missing_or_changed_is_made_again(self):
        self.asked("")
        made = bytes_of(self.folder / "site")
        (self.folder / "site/conflicts.csv").write_text("changed\n")
        (self.folder / "site/report.html").unlink()
        self.asked("")
        now = bytes_of(self.folder / "site")
        for name in ("site.h5", "result.h5", "conflicts.csv"):
            self.assertEqual(now[name], made[name])
        before = (self.folder / "site/conflicts.csv").stat().st_mtime_ns
        self.asked("--title Other")
        self.assertIn(b"Other", (self.folder / "site/report.html").read_bytes())
        self.assertEqual(before, (self.folder / "site/conflicts.csv").stat().st_mtime_ns)

    def test_another_question_needs_force_and_uses_the_store_again(self):
        self.asked("")
        made = bytes_of(self.folder / "site")
        other = QUESTION.replace("0.1", "0.2")
        refused = self.check(f"scans {other} -o site", 2)
        self.assertIn("answers another question than this run: radius: 0.1 in the file",
                      refused.stderr.replace(" m ", " "))
        self.assertIn("--force answers this question in its place", refused.stderr)
        self.assertNotIn("--resume", refused.stderr)
        self.assertEqual(bytes_of(self.folder / "site"), made)
        store = (self.folder / "site/site.h5").stat().st_mtime_ns
        forced = self.check(f"scans {other} -o site --force")
        self.assertEqual((self.folder / "site/site.h5").stat().st_mtime_ns, store)
        self.assertIn("is the store of these inputs already", forced.stderr)
        self.check(f"scans {other} -o fresh")
        for name in ("result.h5", "conflicts.csv"):
            self.assertEqual((self.folder / "site" / name).read_bytes(),
                             (self.folder / "fresh" / name).read_bytes())
        self.assertNotEqual((self.folder / "site/result.h5").read_bytes(), made["result.h5"])
        self.assertIn("nothing was to be done", self.check(f"scans {other} -o site").stderr)
        self.assertIn("nothing was to be done",
                      self.check(f"scans {other} -o site --force").stderr)

    def test_other_scans_need_force(self):
        self.asked("")
        (self.folder / "scans/post.xyz").write_text("1 2 1\n1 2 1.1\n")
        refused = self.asked("", 2)
        self.assertIn("site/site.h5: holds other scans than these", refused.stderr)
        self.assertIn("--force", refused.stderr)
        forced = self.asked("--force")
        fresh = self.check(f"scans {QUESTION} -o fresh")
        self.assertEqual(fresh.stdout.splitlines()[-1], forced.stdout.splitlines()[-1])
        self.assertEqual((self.folder / "site/site.h5").read_bytes(),
                         (self.folder / "fresh/site.h5").read_bytes())
        self.assertIn("was converted with other options: its cell_points is 65536, expected 1000",
                      self.asked("--cell-points 1000", 2).stderr)

    def test_files_that_no_check_made_are_kept(self):
        (self.folder / "site").mkdir()
        (self.folder / "site/report.html").write_text("mine")
        refused = self.asked("", 2)
        self.assertIn("site/report.html: exists already, and no check has made it", refused.stderr)
        self.assertEqual((self.folder / "site/report.html").read_text(), "mine")
        self.asked("--force")
        self.assertNotEqual((self.folder / "site/report.html").read_text(), "mine")

    def test_what_was_made_by_hand_is_used(self):
        (self.folder / "site").mkdir()
        clearway("convert scans -o site/site.h5", self.folder)
        clearway(f"run --env site/site.h5 {QUESTION} --first-pose --clearance 0.3 --profile 0.5 "
                 "-o site/result.h5", self.folder)
        before = [(self.folder / "site" / name).stat().st_mtime_ns for name in FILES[:2]]
        done = self.asked("")
        self.assertIn("is the finished result of this query already", done.stderr)
        self.assertEqual([(self.folder / "site" / name).stat().st_mtime_ns for name in FILES[:2]],
                         before)

    def test_columns_are_remembered(self):
        (self.folder / "wide.txt").write_text(
            "".join(f"{i % 7} {i * 0.01} {i % 3} 1.5\n" for i in range(300)))
        words = f"wide.txt --columns 2,3,4 {QUESTION} -o wide"
        self.check(words)
        self.assertIn("nothing was to be done", self.check(words).stderr)
        for other in (words.replace("2,3,4", "3,2,4"), words.replace("--columns 2,3,4", "")):
            self.assertIn("was converted with other options: its columns is 2,3,4",
                          self.check(other, 2).stderr)
            self.check(other + " --force")
            self.check(words + " --force")

    def test_other_origins_make_the_seen_space_anew(self):
        origins = self.folder / "origins.csv"
        words = f"scans {QUESTION} --origins origins.csv --seen -o"
        origins.write_text("first,x,y,z\n0,1,2,3\n")
        self.check(f"{words} site")
        origins.write_text("first,x,y,z\n0,4,2,3\n")
        self.check(f"{words} site --force")
        self.check(f"{words} fresh")
        self.assertEqual(bytes_of(self.folder / "site", ["result.h5"]),
                         bytes_of(self.folder / "fresh", ["result.h5"]))

    def test_a_store_in_another_unit_makes_the_result_anew(self):
        run = f"run --env s.h5 {QUESTION} --first-pose -o r.h5 --resume"
        def result(unit):
            for words in (f"convert cloud.xyz --unit {unit} -o s.h5 --force", run):
                done = clearway(words, self.folder)
                self.assertEqual(done.returncode, 0, done.stderr)
            return (self.folder / "r.h5").read_bytes()
        (self.folder / "cloud.xyz").write_text("".join(f"{i * 0.01} 0 {i % 9}\n" for i in range(300)))
        metres = result("m")
        self.assertNotEqual(result("ift"), metres)
        self.assertIn("is the finished result", clearway(run, self.folder).stderr)
        self.assertEqual(result("m"), metres)

    def test_a_folder_of_poses(self):
        poses = self.folder / "poses"
        poses.mkdir()
        for i in range(4):
            (poses / f"scan{i:03}.pose").write_text(f"0 0 {100 * i}\n0 0 0\n")
        words = "scans --model model.ply --trajectory poses --radius 0.1 -o site"
        self.check(words)
        self.assertIn("nothing was to be done", self.check(words).stderr)
        (poses / "scan003.pose").write_text("50 0 300\n0 0 0\n")
        self.assertIn("answers another question", self.check(words, 2).stderr)
        self.check(words + " --force")
        found = bytes_of(self.folder / "site", ["path.txt", "conflicts.csv", "stations.csv"])
        self.check(words.replace("-o site", "-o fresh"))
        self.assertEqual(bytes_of(self.folder / "fresh", list(found)), found)

    def test_a_killed_check_goes_on(self):
        whole = self.asked("")
        made = bytes_of(self.folder / "site", FILES[:-1])
        seconds = time.monotonic()
        self.check(f"scans {QUESTION} -o timed")
        seconds = time.monotonic() - seconds
        chance = random.Random(5)
        for attempt in range(6):
            shutil.rmtree(self.folder / "site")
            how = signal.SIGKILL if attempt % 2 else signal.SIGTERM
            with subprocess.Popen([PROGRAM, *shlex.split(f"check scans {QUESTION} -o site")],
                                  cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  text=True) as process:
                time.sleep(chance.uniform(0.05, 0.9) * seconds)
                process.send_signal(how)
                error = process.communicate()[1]
            if how == signal.SIGTERM and process.returncode != 0:
                self.assertIn(process.returncode, (5, -signal.SIGTERM), error)
                if process.returncode == 5:
                    self.assertIn("the same command goes on", error)
            done = self.asked("")
            self.assertEqual(bytes_of(self.folder / "site", FILES[:-1]), made)
            self.assertEqual(done.stdout.splitlines()[-1], whole.stdout.splitlines()[-1])
            self.assertEqual(list((self.folder / "site").glob("*.journal")), [])


class Mistakes(Site):
    def refused(self, words, exit_code, *said):
        done = self.check(words, exit_code)
        self.assertEqual(done.stdout, "")
        for text in said:
            self.assertIn(text, done.stderr)
        for alien in ("--resume", "--env", "unknown option", "internal"):
            self.assertNotIn(alien, done.stderr)
        return done

    def test_scans(self):
        (self.folder / "empty").mkdir()
        self.refused(f"empty {QUESTION} -o out", 3, "empty: holds no point file")
        self.refused(f"nowhere {QUESTION} -o out", 4, "nowhere")
        (self.folder / "scans/broken.las").write_bytes(b"LASF" + b"\0" * 500)
        self.refused(f"scans {QUESTION} -o out", 3, "broken.las", "--skip-unreadable leaves out")
        self.check(f"scans {QUESTION} -o out --skip-unreadable")
        self.refused(f"trajectory.txt {QUESTION} -o out2", 3, "trajectory.txt: is a trajectory",
                     "--trajectory takes it")
        self.refused(f"scans {QUESTION} -o scans", 2, "is the folder of the scans")
        self.refused(f"- {QUESTION} -o out2", 2, "expected scans in files or folders")
        self.refused(f"out/site.h5 scans {QUESTION} -o out2", 2, "is a store", "give it alone")
        self.refused(f"out/result.h5 {QUESTION} -o out2", 3, "out/result.h5: is a result", "not a scan or a store")

    def test_model_and_trajectory(self):
        self.refused("scans --model trajectory.txt --trajectory model.ply --radius 0.1 -o out", 3,
                     "trajectory.txt: is a trajectory", "--trajectory takes it")
        self.refused("scans --model model.ply --trajectory model.ply --radius 0.1 -o out", 3,
                     "model.ply: is", "not a trajectory",
                     "--model takes the vehicle")
        self.refused("scans --model none.ply --trajectory trajectory.txt --radius 0.1 -o out", 4,
                     "none.ply")
        for piped in ("--model model.ply --trajectory /dev/null", "--model /dev/null --trajectory trajectory.txt"):
            self.refused(f"scans {piped} --radius 0.1 -o out", 2, "/dev/null: is a pipe or device",
                         "Write it into a file first")
        self.refused("scans --trajectory trajectory.txt --radius 0.1 -o out", 2, "--model")
        self.asked("")
        self.refused("scans --model site/site.h5 --trajectory trajectory.txt --radius 0.1 -o out",
                     3, "not a model", "inputs that come first")
        (self.folder / "broken.obj").write_text("v 0 0 0\nv 1 0 0\nf 1 2 9\n")
        self.refused("scans --model broken.obj --trajectory trajectory.txt --radius 0.1 -o early", 3,
                     "broken.obj: line 3: a face names vertex 9")
        self.assertEqual([path.name for path in (self.folder / "early").iterdir()], ["check.json"])

    def test_options(self):
        self.refused(f"scans --model model.ply --trajectory trajectory.txt -o out", 2, "--radius")
        self.refused(f"scans {QUESTION.replace('0.1', 'wide')} -o out", 2, "--radius", "wide")
        self.refused(f"scans {QUESTION} -o out --forward z", 2, "same axis")
        self.refused(f"scans {QUESTION} -o out --engine fast", 2, "--engine")
        self.refused(f"scans {QUESTION} -o out --between-poses --clearance 0.3", 2, "clearance")
        self.refused(f"scans {QUESTION} -o out --vehicle wagon.json", 2, "--vehicle", "--model")
        self.assertFalse((self.folder / "out").exists())
        (self.folder / "file").write_text("")
        self.refused(f"scans {QUESTION} -o file", 4, "file: cannot make the folder")

    def test_units(self):
        corners = [(x, y, z) for x in (-2000, 2000) for y in (-900, 900) for z in (300, 1400)]
        (self.folder / "mm.obj").write_text(
            "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "f 1 2 4 3\nf 5 6 8 7\nf 1 5 7 3\n")
        wrong = self.check("scans --model mm.obj --trajectory trajectory.txt --radius 0.1 -o wrong")
        self.assertIn("unit", wrong.stderr)
        right = self.check("scans --model mm.obj --model-unit mm --trajectory trajectory.txt "
                           "--radius 0.1 -o right")
        self.assertNotEqual(right.stdout.splitlines()[-1], wrong.stdout.splitlines()[-1])


class Open(Site):
    def browser(self, name):
        folder = self.folder / "browser"
        folder.mkdir()
        script = folder / name
        script.write_text(f"#!/bin/sh\nprintf '%s' \"$1\" > {self.folder}/opened\n")
        script.chmod(0o755)
        return {**os.environ, "PATH": str(folder)}

    def opened(self):
        for _ in range(100):
            if (self.folder / "opened").exists() and (self.folder / "opened").read_text():
                return (self.folder / "opened").read_text()
            time.sleep(0.05)
        return None

    def test_the_page_is_opened(self):
        for name in ("xdg-open", "open"):
            with self.subTest(name):
                self.asked("--open", env=self.browser(name))
                self.assertEqual(self.opened(), "site/report.html")
                shutil.rmtree(self.folder / "browser")
                (self.folder / "opened").unlink()

    def test_it_says_where_no_browser_is(self):
        done = self.asked("--open", env={**os.environ, "PATH": str(self.folder)})
        self.assertIn("neither xdg-open nor open", done.stderr)
        self.assertIn("site/report.html", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
