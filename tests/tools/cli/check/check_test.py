#!/usr/bin/python3
"""`clearway check`: from files to the finding, again, after a kill, with mistakes in each input.

    check_test.py CLEARWAY
"""

import math
import os
import random
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from place import PROGRAM, Place, Scratch, write_las, zone  # noqa: E402

FILES = ["site.h5", "result.h5", "conflicts.csv", "stations.csv", "report.html"]
INPUTS = "--model model.ply --trajectory trajectory.txt"
QUESTION = f"{INPUTS} --radius 0.1"
SITE = f"scans {QUESTION} -o site"
BY_HAND = f"run --env site/site.h5 {QUESTION} --first-pose --clearance 0.3 --profile 0.5"
DONE = "nothing was to be done"
MISSED = "What lies between two poses can be missed"
TWO_BODIES = [{"name": "front", "model": "model.ply"}, {"name": "rear", "model": "model.ply", "at": -4}]


def printed(done):
    return re.findall(r"^  (clearway .*)$", done.stdout, re.M)


def steps_of(done):
    return [shlex.split(command)[1] for command in printed(done)]


def last_line(done):
    return done.stdout.splitlines()[-1]


class Check(Scratch):
    """A small hall whose scan is in a folder of its own, and a fresh copy of it for each test."""

    @classmethod
    def make(cls):
        cls.master = Place(cls.place / "master")
        cls.master.ask("scene hall --points 20000 --model-points 500 --poses 1600 -o .")
        (cls.master / "scans").mkdir()
        (cls.master / "environment.las").rename(cls.master / "scans/environment.las")
        lines = (cls.master / "trajectory.txt").read_text().splitlines(keepends=True)
        far = [line.split() for line in lines]
        for name, some in (("quarter", lines[:400]), ("coarse", lines[::40]),
                           ("jump", lines[:400] + lines[1200:]),
                           ("far", [" ".join([*v[:3], str(float(v[3]) + 5000), *v[4:]]) + "\n" for v in far])):
            cls.master.put(f"{name}.txt", "".join(some))
        (cls.place / "bin").mkdir()
        (cls.place / "bin/clearway").symlink_to(PROGRAM)

    def copy(self):
        folder = Path(tempfile.mkdtemp(dir=self.place.folder)) / "work"
        shutil.copytree(self.master.folder, folder)
        return Place(folder)

    def setUp(self):
        self.here = self.copy()

    def check(self, words, code=0, *said, **options):
        return self.here.ask("check " + words, code, *said, **options)

    def made(self, folder="site", names=FILES, place=None):
        return (place or self.here).bytes(*(f"{folder}/{name}" for name in names))

    def assert_same(self, folder, names=("result.h5", "conflicts.csv"), as_in="fresh"):
        self.assertEqual(self.made(folder, names), self.made(as_in, names))

    def times(self, names=FILES):
        return [(self.here / "site" / name).stat().st_mtime_ns for name in names]

    def paste(self, commands, place):
        """Runs printed commands as a shell takes them apart."""
        path = f"{self.place / 'bin'}:{os.environ['PATH']}"
        for command in commands:
            done = subprocess.run(command, shell=True, cwd=place.folder, check=False, capture_output=True,
                                  text=True, env={**os.environ, "PATH": path})
            self.assertEqual(done.returncode, 0, f"{command}\n{done.stderr}")

    def check_pasted_elsewhere(self, done, output="site"):
        """The printed commands make the same files of the same inputs in another place."""
        other = self.copy()
        (other / output).mkdir()
        self.paste(printed(done), other)
        self.assertEqual(self.made(output, place=other), self.made(output))

    def vehicle(self, bodies, name="train.json"):
        self.here.put(name, {"bodies": bodies})

    def bend(self, name, places):
        """A path of poses at these places, which look along the way there."""
        ahead = [math.atan2(to[1] - at[1], to[0] - at[0]) for at, to in
                 zip([places[0], *places], [*places[1:], places[-1]])]
        self.here.put_path(name, [(x, y, 0, turn) for (x, y), turn in zip(places, ahead)])

    # What is found, and how it is told

    def test_four_arguments_are_enough(self):
        done = self.check(f"{SITE} --between-poses=false --seen=0", 0,  # flags that are off
                          "taken by default: --clearance 0.3 (3 times the radius) and "
                          "--profile 0.5 (5 times the radius)")
        self.assertEqual(sorted(os.listdir(self.here / "site")), sorted([*FILES, "check.json"]))
        run = self.here.ask(f"{BY_HAND} -o by_hand.h5")
        conflicts = self.here.ask(f"conflicts by_hand.h5 {INPUTS} -o by_hand.csv")
        self.assertEqual(self.here.bytes("by_hand.h5", "by_hand.csv"),
                         self.made(names=["result.h5", "conflicts.csv"]))
        # One place is named: the worst one, and not the nearest beside it.
        without_nearest = re.sub(r"; the least distance is .*?(?=; see the)", "", last_line(run))
        self.assertEqual(last_line(done), f"{without_nearest} {last_line(conflicts)}")

    def test_a_path_with_large_steps_is_made_denser(self):
        asked = "scans --model model.ply --trajectory coarse.txt --radius 0.1 -o site"
        done = self.check(asked, 0, "site/path.txt: from one pose to the next the model moves by up to",
                          lacks=[MISSED])
        self.assertEqual(steps_of(done), ["convert", "trajectory", "run", "conflicts", "stations", "report"])
        self.assertTrue(all("--trajectory site/path.txt" in c for c in printed(done)[2:]))
        first = self.made()
        again = self.here.json(f"check {asked}")
        self.assertTrue(again["nothing_done"] and all(again["reused"].values()), again)
        self.assertEqual(self.made(), first)
        # The page names the path that was given, and shows the warnings that --json has.
        facts = self.here.facts("site/report.html")
        self.assertIn("resample of coarse.txt: 40 given poses among ", facts["inputs"]["trajectory"]["made_by"])
        self.assertTrue(facts["inputs"]["environment"]["scans"]["names"])
        self.assertEqual(again["warnings"], facts["warnings"])
        # How the path is read is said of the file, and not of the denser one.
        given = self.check(f"{asked} --trajectory-format matrix --lever-arm 0,0,0.01 --force")
        run = printed(given)[steps_of(given).index("run")]
        self.assertNotRegex(run, "--lever-arm|--trajectory-format")

    def test_the_path_of_a_vehicle_is_made_denser_for_every_body(self):
        self.bend("bend.txt", [(i, 0.02 * i * i) for i in range(12)])
        bodies = [{"name": "a", "model": "model.ply"},
                  {"name": "b", "model": "model.ply", "pivots": [-2, -4]},
                  {"name": "c", "model": "model.ply", "towed": {"by": "b", "at": -5, "pivots": [0, -3]}}]
        self.vehicle(bodies)
        words = "scans --vehicle train.json --trajectory bend.txt --radius 0.1 -o train"
        done = self.check(words, lacks=[MISSED])
        resample = printed(done)[steps_of(done).index("trajectory")].removeprefix("clearway ")
        motion = self.here.json(resample)
        self.assertGreater(motion["largest_motion_before"], 0.1)
        self.assertLessEqual(motion["largest_motion_after"], 0.1 * (1 + 1e-6))
        self.check(words, 0, DONE)
        self.vehicle(bodies[:2])
        self.check(words, 2, "answers another question")
        # One with poses of its own, which belong to those of the path, leaves no room between them.
        self.vehicle([TWO_BODIES[0], {"name": "own", "model": "model.ply", "trajectory": "bend.txt"}])
        self.check(words.replace("-o train", "-o own"), 0, "no poses are put between",
                   "the poses of the body own belong to those of the path")

    def test_a_path_with_a_jump_stays_as_it_is(self):
        self.check("scans --model model.ply --trajectory jump.txt --radius 0.1 -o site", lacks=["resample"])
        self.assertFalse((self.here / "site/path.txt").exists())

    def near_and_whole(self, words, *said):
        """A check of what is near the path; its tables are those of all points."""
        near = self.check(f"{words} --near -o near", 0, *said)
        self.check(f"{words} -o whole")
        self.assert_same("near", ["conflicts.csv", "stations.csv"], "whole")
        self.check(f"{words} --near -o near", 0, DONE)
        return near

    def test_only_what_is_near_the_path_may_be_read(self):
        near = self.near_and_whole(f"scans {QUESTION}", "--near trajectory.txt --within ")
        self.check_pasted_elsewhere(near, "near")
        self.check(f"scans {QUESTION} --near --trust-bounds -o trusting", 0, "--trust-bounds")

    def test_a_corridor_that_proves_too_narrow_is_known_the_next_time(self):
        self.bend("corners.txt", [(0, 0), (30, 0), (30, 30), (60, 30), (60, 60)])
        asked = "scans --model model.ply --trajectory corners.txt --near -o site"
        self.check(f"{asked} --radius 0.1", 0, "The scans are converted once more")
        self.check(f"{asked} --radius 0.1", 0, DONE)
        self.check(f"{asked} --radius 0.3 --force")
        self.check(f"{asked} --radius 0.3".replace("-o site", "-o fresh"))
        self.assert_same("site", ["site.h5", "result.h5", "conflicts.csv"])

    def test_scans_in_feet_and_a_denser_path(self):
        near = self.near_and_whole("scans --model model.ply --trajectory coarse.txt --radius 3cm --unit ft",
                                   "--trajectory near/path.txt")
        self.assertNotIn("converted once more", near.stderr)

    def test_a_path_in_degrees_is_read_in_the_system_of_the_scans(self):
        draw = random.Random(1)
        points = [(side + draw.uniform(-0.1, 0.1), draw.uniform(270, 380), draw.uniform(12.5, 16), 1, False)
                  for side in (-60, -3, 3, 60) for _ in range(5000)]
        write_las(self.here / "utm.las", [*points, (0.9, 320, 13, 1, False)], zone("metre", 1))
        self.here.put("degrees.csv", "lat,lon,height,roll_deg,pitch_deg,heading_deg\n" + "".join(
            f"{48 + i * 0.5 / 111194:.10f},9.0,12.5,0,0,0\n" for i in range(60)))
        self.near_and_whole("utm.las --model box:4,1.8,1.5 --trajectory degrees.csv --radius 0.1",
                            "conflict: 1 point ")

    def test_the_printed_commands_give_the_same_bytes(self):
        done = self.check(SITE)
        self.assertEqual(steps_of(done), ["convert", "run", "conflicts", "stations", "report"])
        self.check_pasted_elsewhere(done)
        made = self.made()
        self.paste(printed(done), self.here)  # where everything is there already
        self.assertEqual(self.made(), made)

    def test_names_that_a_shell_would_take_apart(self):
        car, output = "it's a car.ply", "the $HOME; site"
        shutil.copy(self.here / "model.ply", self.master / car)
        self.addCleanup((self.master / car).unlink)
        self.here = self.copy()
        done = self.here.ask(
            ["check", "scans", "--model", car, "--trajectory", "trajectory.txt", "--radius", "10", "cm",
             "--floor", "-0.5", "--title", 'A "site" & more', "--ignore-box", "-1,-2.5,-3,-0.5,9,9",
             "--ignore-box=1,2,3,4,5,6", "-o", output], 0, "--clearance 30cm (", "--profile 50cm (")
        self.check_pasted_elsewhere(done, output)

    def test_the_commands_of_other_questions_give_the_same_bytes(self):
        self.vehicle(TWO_BODIES, "wagon.json")
        self.vehicle([TWO_BODIES[0], {"name": "rear", "model": "model.ply",
                                      "towed": {"by": "front", "at": -2.4, "pivots": [2.4, -1]}}], "towed.json")
        scans = self.check(f"{SITE} --origins origins.csv")
        self.assertIn("--origins origins.csv", printed(scans)[0])
        for words in ("--vehicle wagon.json", "--vehicle towed.json", "--model model.ply --between-poses",
                      "--model model.ply --error-scan 0.005 --error-model 0.01 --gap 0.2",
                      "--model model.ply --forward=-x",
                      "--model model.ply --seen",
                      "--model model.ply --clearance 0.2 --min-points 3 --split 0"):
            with self.subTest(words):
                done = self.check(f"site/site.h5 --trajectory quarter.txt --radius 0.1 {words} -o other --force")
                self.assertEqual("--gap" in printed(done)[0], "--error" in words)
                self.assertEqual("--clearance" in printed(done)[0], "--between-poses" not in words)
                self.assertEqual("--seen" in printed(done)[0], "--seen" in words)
                made = self.made("other", FILES[1:])
                self.paste(printed(done), self.here)
                self.assertEqual(self.made("other", FILES[1:]), made)

    def test_json(self):
        answer, again = (self.here.json(f"check {SITE}") for _ in range(2))
        self.assertEqual([answer["verdict"], answer["run"]["verdict"], answer["files"]["result"]],
                         ["conflict", "conflict", "site/result.h5"])
        self.assertEqual(list(answer["seconds"]), ["convert", "path", "run", "conflicts", "stations", "report"])
        self.assertGreater(min(answer["seconds"][step] for step in ("convert", "run", "report")), 0)
        self.assertEqual([answer["nothing_done"], again["nothing_done"]], [False, True])
        self.assertEqual(len(answer["commands"]), 5)
        self.assertEqual(again["commands"], answer["commands"])
        self.assertEqual(set(again["reused"].values()), {True})

    def test_exit_codes_are_those_of_run(self):
        self.check(SITE)
        self.check(f"{SITE} --fail-on-collision", 1)
        clear = self.check("scans --model box:0.2,0.2,0.2 --model-as points --trajectory trajectory.txt "
                           "--radius 0.01 -o clear --fail-on-collision")
        self.assertIn("clear", last_line(clear))
        far = "scans --model model.ply --trajectory far.txt --radius 0.1 -o far"
        undecided = self.check(f"{far} --fail-on-collision", 6, "nothing was scanned")
        self.assertIn("undecided", last_line(undecided))
        self.assertEqual(undecided.stderr.count("its verdict is undecided"), 1)
        self.check(far)
        self.check(f"{far} --strict", 3)

    def test_a_ledger_is_on_the_page_and_decides_about_success(self):
        words = f"{SITE} --min-points 1 --ledger known.csv --date 2026-03-01 --fail-on-collision"
        self.check(f"{words} --update", 1)
        found = self.here.facts("site/report.html")["ledger"]
        self.assertEqual([found["name"], found["date"], found["new"]],
                         ["known.csv", "2026-03-01", len(found["conflicts"])])
        self.here.put("known.csv", (self.here / "known.csv").read_text().replace(",new,", ",accepted,"))
        self.check(words, 0, "The verdict stays conflict. The ledger accepts all")
        self.assertEqual(self.here.facts("site/report.html")["ledger"]["accepted"], found["new"])

    def test_scans_are_files_folders_or_a_store(self):
        verdict = last_line(self.check(SITE))
        for scans, steps in (("scans/environment.las", ["convert"]), ("site/site.h5", [])):
            done = self.check(f"{scans} {QUESTION} -o {'scan' if steps else 'store'}")
            self.assertEqual(last_line(done), verdict)
            self.assertEqual(steps_of(done), [*steps, "run", "conflicts", "stations", "report"])
        self.assert_same("scan", ["result.h5"], "site")
        self.assert_same("store", ["result.h5"], "site")
        self.assertFalse((self.here / "store/site.h5").exists())
        self.here.put("scans/post.xyz", "1 2 1\n1 2 1.1\n")
        self.check(f"scans {QUESTION} -o mixed")
        info = self.here.json("info mixed/site.h5")
        self.assertEqual([{source["name"] for source in info["sources"]}, info["points"]],
                         [{"environment.las", "post.xyz"}, 20002])

    def test_the_vehicle_may_lie_among_the_scans(self):
        verdict = last_line(self.check(SITE))
        for name in ("model.ply", "trajectory.txt"):
            shutil.copy(self.here / name, self.here / "scans")
        words = "--model scans/model.ply --trajectory scans/trajectory.txt --radius 0.1"
        for number, scans in enumerate(("scans", "scans/environment.las scans/model.ply")):
            mixed = self.check(f"{scans} {words} -o mixed{number}", 0,
                               "scans/model.ply: belongs to the vehicle, so it is not taken as a scan")
            self.assertEqual(last_line(mixed), verdict)
            self.assertIn("clearway convert scans/environment.las -o", printed(mixed)[0])
        self.check(f"scans/model.ply {words} -o none", 2)
        self.vehicle(TWO_BODIES, "scans/wagon.json")
        self.check("scans --vehicle scans/wagon.json --trajectory trajectory.txt --radius 0.1 -o wagon", 0,
                   "scans/model.ply: belongs to the vehicle")

    def test_models_of_every_kind_alone_and_as_bodies(self):
        """A mesh, points, an outline and a box, which a vehicle's file names beside itself."""
        here = self.here
        here.put("vehicles/gauge.csv", "-1,0\n1,0\n1,2\n-1,2\n")
        here.ask("model box 2,1,1 -o vehicles/mesh.off")
        here.ask("model outline vehicles/gauge.csv --x=-1,1 -o vehicles/outline.off")
        shutil.copy(here / "model.ply", here / "vehicles/points.ply")
        models = ["mesh.off", "outline.off", "points.ply", "box:2,1,1"]
        self.check(SITE)
        site = "site/site.h5 --trajectory quarter.txt --radius 0.1 --force -o"
        counts = {}
        for model in models:
            with self.subTest(model):
                self.vehicle([{"name": "only", "model": model}], "vehicles/one.json")
                path = model if model.startswith("box:") else f"vehicles/{model}"
                for words in (f"one --model {path}", "vehicle --vehicle vehicles/one.json"):
                    self.check(f"{site} {words}")
                    self.check(f"{site} {words}", 0, DONE)
                one, vehicle = (here.json(f"info {name}/result.h5") for name in ("one", "vehicle"))
                counts[model] = one["colliding_points"]
                self.assertEqual([vehicle["colliding_points"], vehicle["verdict"]],
                                 [one["colliding_points"], one["verdict"]])
        self.assertEqual(counts["mesh.off"], counts["box:2,1,1"])
        self.vehicle([{"name": "first", "model": models[0], "pivots": [1, -1]}] +
                     [{"name": f"body {i}", "model": models[i], "at": -2.0 * i} for i in (1, 2, 3)],
                     "vehicles/all.json")
        for model_as in ("", "--model-as points --model-spacing 0.1"):
            done = self.check(f"{site} all --vehicle vehicles/all.json {model_as}")
            self.assertEqual(done.stderr.count("the body has no pose there"), 4, done.stderr)
        self.vehicle([{"name": "a", "model": "box:2,1"}], "vehicles/all.json")
        self.check(f"{site} all --vehicle vehicles/all.json", 2, "expected a box as box:LENGTH,WIDTH,HEIGHT")

    # The same command again. check_pairs.py draws other options and inputs in one folder.

    def test_the_second_run_has_nothing_to_do(self):
        first, before = self.check(SITE), self.times()
        self.assertEqual(self.check(SITE, 0, DONE).stdout, first.stdout)
        self.assertEqual(self.times(), before)
        self.check(f"{SITE} --threads 1 --memory 1G", 0, DONE)
        self.here.put("site/check.json", "[[[")
        self.check(SITE, lacks=[DONE])
        self.check(SITE, 0, DONE)

    def test_what_is_missing_or_changed_is_made_again(self):
        self.check(SITE)
        made = self.made(names=FILES[:3])
        self.here.put("site/conflicts.csv", "changed\n")
        (self.here / "site/report.html").unlink()
        self.check(SITE)
        self.assertEqual(self.made(names=FILES[:3]), made)
        before = self.times(["conflicts.csv"])
        self.check(f"{SITE} --title Other")
        self.assertEqual(self.here.facts("site/report.html")["title"], "Other")
        self.assertEqual(self.times(["conflicts.csv"]), before)

    def test_another_question_needs_force_and_uses_the_store_again(self):
        self.check(SITE)
        made, store = self.made(), self.times(["site.h5"])
        other = SITE.replace("0.1", "0.2")
        self.check(other, 2, "answers another question than this run: radius: 0.1 m in the file",
                   "--force answers this question in its place", lacks=["--resume"])
        self.assertEqual(self.made(), made)
        self.check(f"{other} --force", 0, "is the store of these inputs already")
        self.assertEqual(self.times(["site.h5"]), store)
        self.check(other.replace("-o site", "-o fresh"))
        self.assert_same("site")
        self.assertNotEqual(self.made(names=["result.h5"]), made[1:2])
        for more in ("", " --force"):
            self.check(other + more, 0, DONE)

    def test_other_scans_need_force(self):
        self.check(SITE)
        self.here.put("scans/post.xyz", "1 2 1\n1 2 1.1\n")
        self.check(SITE, 2, "site/site.h5: holds other scans than these", "--force")
        forced = self.check(f"{SITE} --force")
        self.assertEqual(last_line(self.check(f"scans {QUESTION} -o fresh")), last_line(forced))
        self.assert_same("site", ["site.h5"])
        self.check(f"{SITE} --cell-points 1000", 2,
                   "was converted with other options: its cell_points is 65536, expected 1000")

    def test_files_that_no_check_made_are_kept(self):
        self.here.put("site/report.html", "mine")
        self.check(SITE, 2, "site/report.html: exists already, and no check has made it")
        self.assertEqual(self.made(names=["report.html"]), [b"mine"])
        self.check(f"{SITE} --force")
        self.assertNotEqual(self.made(names=["report.html"]), [b"mine"])

    def test_what_was_made_by_hand_is_used(self):
        (self.here / "site").mkdir()
        self.here.ask("convert scans -o site/site.h5")
        self.here.ask(f"{BY_HAND} -o site/result.h5")
        before = self.times(FILES[:2])
        self.check(SITE, 0, "is the finished result of this query already")
        self.assertEqual(self.times(FILES[:2]), before)

    def test_a_killed_check_goes_on(self):
        """It is stopped when its folder has grown by a random part."""
        def size():
            return sum(file.stat().st_size for file in (self.here / "site").glob("*"))
        whole = self.check(SITE)
        made, most, draw = self.made(names=FILES[:-1]), size(), random.Random(5)
        for attempt in range(6):
            shutil.rmtree(self.here / "site")
            (self.here / "site").mkdir()
            least, how = draw.random() * most, signal.SIGKILL if attempt % 2 else signal.SIGTERM
            process = self.here.start("check " + SITE)
            try:
                while process.poll() is None and size() < least:
                    time.sleep(0.001)
            except FileNotFoundError:  # a file that has got its name
                pass
            process.send_signal(how)
            said = process.communicate()[0]
            if process.returncode == 5:
                self.assertIn("the same command goes on", said)
            else:
                self.assertIn(process.returncode, (0, -how), said)
            self.assertEqual(last_line(self.check(SITE)), last_line(whole))
            self.assertEqual(self.made(names=FILES[:-1]), made)
            self.assertEqual(list((self.here / "site").glob("*.journal")), [])

    # Mistakes

    def refused(self, words, code, *said):
        done = self.check(words, code, *said, lacks=["--resume", "--env", "unknown option", "internal"])
        self.assertEqual(done.stdout, "")

    def test_mistakes_in_the_inputs_are_named_with_what_helps(self):
        here = self.here
        self.check(SITE)
        (here / "empty").mkdir()
        here.put("broken.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n")
        here.put("file", "")
        path, pipe = "--trajectory trajectory.txt --radius 0.1", "/dev/null: is a pipe or device"
        for words, code, *said in (
                (f"empty {QUESTION}", 3, "empty: holds no point file"),
                (f"nowhere {QUESTION}", 4, "nowhere"),
                (f"trajectory.txt {QUESTION}", 3, "trajectory.txt: is a trajectory", "--trajectory takes it"),
                (f"- {QUESTION}", 2, "expected scans in files or folders"),
                (f"site/site.h5 scans {QUESTION}", 2, "is a store", "give it alone"),
                (f"site/result.h5 {QUESTION}", 3, "site/result.h5: is a result", "not a scan or a store"),
                ("scans --model trajectory.txt --trajectory model.ply --radius 0.1", 3,
                 "trajectory.txt: is a trajectory", "--trajectory takes it"),
                ("scans --model model.ply --trajectory model.ply --radius 0.1", 3, "model.ply: is",
                 "not a trajectory", "--model takes the vehicle"),
                (f"scans --model none.ply {path}", 4, "none.ply"),
                ("scans --model model.ply --trajectory /dev/null --radius 0.1", 2, pipe, "Write it into a file"),
                (f"scans --model /dev/null {path}", 2, pipe, "Write it into a file first"),
                (f"scans {path}", 2, "--model"),
                (f"scans --model site/site.h5 {path}", 3, "not a model", "inputs that come first"),
                (f"scans {INPUTS}", 2, "--radius"),
                (f"scans {INPUTS} --radius wide", 2, "--radius", "wide"),
                (f"scans {QUESTION} --forward z", 2, "same axis"),
                (f"scans {QUESTION} --engine fast", 2, "--engine"),
                (f"scans {QUESTION} --between-poses --clearance 0.3", 2, "clearance"),
                (f"scans {QUESTION} --vehicle wagon.json", 2, "--vehicle", "--model")):
            with self.subTest(words):
                self.refused(f"{words} -o out", code, *said)
        self.assertFalse((here / "out/site.h5").exists())
        self.refused(f"scans --model broken.obj {path} -o early", 3, "broken.obj: line 3: a face names vertex 9")
        self.assertEqual(os.listdir(here / "early"), ["check.json"])
        self.refused(f"scans {QUESTION} -o scans", 2, "is the folder of the scans")
        self.refused(f"scans {QUESTION} -o file", 4, "file: cannot make the folder")
        (here / "scans/broken.las").write_bytes(b"LASF" + b"\0" * 500)
        self.refused(f"scans {QUESTION} -o out", 3, "broken.las", "--skip-unreadable leaves out")
        self.check(f"scans {QUESTION} -o out --skip-unreadable")

    def test_a_limit_of_processes_is_told(self):
        """Pools of threads that do not fit beside each other, for a user who has no other process."""
        user = "setpriv --reuid 23456 --regid 23456 --clear-groups".split()
        if not shutil.which("setpriv") or os.geteuid() != 0 or subprocess.run(
                [*user, PROGRAM, "--version"], capture_output=True, check=False).returncode != 0:
            self.skipTest("only root becomes a user without other processes")
        for folder in (self.place.folder, self.here.folder.parent):
            os.chmod(folder, 0o755)
        codes = set()
        for limit in range(2, 14):
            out = self.here / "limited"
            shutil.rmtree(out, ignore_errors=True)
            out.mkdir()
            os.chmod(out, 0o777)
            done = subprocess.run([*user, "prlimit", f"--nproc={limit}", PROGRAM, "check", "scans",
                                   *shlex.split(QUESTION), "--threads", "4", "-o", "limited"],
                                  cwd=self.here.folder, capture_output=True, text=True, check=False)
            codes.add(done.returncode)
            self.assertEqual(done.returncode == 4, "threads cannot be started" in done.stderr, done.stderr)
        self.assertEqual(codes, {0, 4})

    def test_the_page_is_opened_where_there_is_a_browser(self):
        opened = self.here / "opened"
        for name in ("xdg-open", "open"):
            script = self.here / name / name
            self.here.put(f"{name}/{name}", f"#!/bin/sh\nprintf '%s' \"$1\" > {opened}.new\n"
                          f"/bin/mv {opened}.new {opened}\n")
            script.chmod(0o755)
            self.check(f"{SITE} --open", env={**os.environ, "PATH": str(script.parent)})
            last = time.monotonic() + 10
            while not opened.exists() and time.monotonic() < last:
                time.sleep(0.05)
            self.assertEqual(opened.read_text(), "site/report.html")
            opened.unlink()
        self.check(f"{SITE} --open", 0, "neither xdg-open nor open", "site/report.html",
                   env={**os.environ, "PATH": str(self.here.folder)})


if __name__ == "__main__":
    unittest.main()
