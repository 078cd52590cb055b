"""A folder in which a script asks the program, and what several scripts make in one. The first
argument of a script is the program."""

import csv
import json
import math
import os
import re
import shlex
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = os.path.abspath(sys.argv.pop(1))
EAST, NORTH = 500000, 5316000  # of scans in a map projection


class Place:
    def __init__(self, folder):
        self.folder = Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)

    def __truediv__(self, name):
        return self.folder / name

    def ask(self, words, code=0, *said, lacks=(), under=(), **options):
        """Runs the program, which has to end with this exit code and to say all these texts.

        under: the words of a command that runs it."""
        words = shlex.split(words) if isinstance(words, str) else list(map(str, words))
        done = subprocess.run([*under, PROGRAM, *words], cwd=self.folder, capture_output=True, text=True,
                              check=False, **options)
        text = done.stderr + done.stdout
        wrong = [part for part in said if part not in text] + [part for part in lacks if part in text]
        if done.returncode != code or wrong:
            raise AssertionError(f"{shlex.join(words)}\nexit code {done.returncode}, expected {code}\n"
                                 f"{text}\nmissing, or not expected: {wrong}")
        return done

    def json(self, words, code=0):
        return json.loads(self.ask(words + " --json", code).stdout)

    def start(self, words, to=subprocess.PIPE, **options):
        return subprocess.Popen([PROGRAM, *shlex.split(words)], cwd=self.folder, text=True,
                                stdout=to, stderr=subprocess.STDOUT, **options)

    def put(self, name, content):
        """Writes text, or what is no text as JSON."""
        (self / name).parent.mkdir(parents=True, exist_ok=True)
        (self / name).write_text(content if isinstance(content, str) else json.dumps(content))

    def bytes(self, *names):
        return [(self / name).read_bytes() for name in names]

    def rows(self, name):
        with open(self / name, newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def facts(self, page):
        """The facts in a page."""
        text = (self / page).read_text()
        return json.loads(re.search(r'<script[^>]*id="facts"[^>]*>(.*?)</script>', text, re.S)[1])

    def put_path(self, name, places):
        """places: x, y, z, and by how much the pose is turned to the left."""
        self.put(name, "".join(pose(*place) for place in places))

    def put_box(self, name, lo, hi):
        """A closed mesh."""
        corners = [(x, y, z) for x in (lo[0], hi[0]) for y in (lo[1], hi[1]) for z in (lo[2], hi[2])]
        faces = ("0 1 3", "0 3 2", "4 6 7", "4 7 5", "0 4 5", "0 5 1",
                 "2 3 7", "2 7 6", "0 2 6", "0 6 4", "1 5 7", "1 7 3")
        self.put(name, "OFF\n8 12 0\n" + "".join("%g %g %g\n" % p for p in corners) +
                 "".join(f"3 {face}\n" for face in faces))

    def make_hall(self, points, model_points, poses, convert=""):
        """environment.las, model.ply, trajectory.txt and site.h5."""
        self.ask(f"scene hall --points {points} --model-points {model_points} --poses {poses} -o . --force")
        self.ask(f"convert environment.las {convert} -o site.h5 --force")


def pose(x, y=0, z=0, turn=0):
    c, s = math.cos(turn), math.sin(turn)
    return f"{c:.15g} {-s:.15g} 0 {x:.15g} {s:.15g} {c:.15g} 0 {y:.15g} 0 0 1 {z:.15g}\n"


def zone(unit, metres):
    return (f'PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89",'
            f'DATUM["European_Terrestrial_Reference_System_1989",'
            f'SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],'
            f'UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4258"]],PROJECTION["Transverse_Mercator"],'
            f'PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],'
            f'PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",{500000 / metres:.12g}],'
            f'PARAMETER["false_northing",0],UNIT["{unit}",{metres:.16g}]]').encode() + b"\0"


def write_las(path, points, wkt=b"", metres=1.0, year=0):
    """LAS 1.4 with steps of 1 mm or a thousandth of a foot. points: x, y, z, class, withheld."""
    start = (EAST / metres, NORTH / metres, 0) if wkt else (0, 0, 0)
    steps = [[round(p[k] / metres * 1000) for k in range(3)] for p in points]
    record = struct.pack("<2x16sHH32x", b"LASF_Projection", 2112, len(wkt)) + wkt if wkt else b""
    bounds = [bound(step[k] / 1000 + start[k] for step in steps) for k in range(3) for bound in (max, min)]
    header = struct.pack("<4s2xH16xBB64xHHHIIBH24x", b"LASF", 16, 1, 4, year and 100, year, 375,
                         375 + len(record), bool(wkt), 6, 30)
    header += struct.pack("<12d20xQ120x", 1e-3, 1e-3, 1e-3, *start, *bounds, len(points))
    bodies = b"".join(struct.pack("<3i2xBBB13x", *step, 0x11, 4 if p[4] else 0, p[3])
                      for step, p in zip(steps, points))
    path.write_bytes(header + record + bodies)


class Scratch(unittest.TestCase):
    """Tests with a folder of their own, which make() fills once."""

    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory(prefix="clearway-test-")
        cls.addClassCleanup(scratch.cleanup)
        cls.place = Place(scratch.name)
        cls.make()

    @classmethod
    def make(cls):
        pass
