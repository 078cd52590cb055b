"""The files that the pages speak of as the user's: a small hall under these names, and what is made of it."""

import json
import os
import re
import shutil
import struct
import subprocess
from pathlib import Path


def _box_stl(path, size):
    """A closed box of these lengths, whose middle of the floor is the origin."""
    length, width, height = size
    corners = [((i & 1) * length - length / 2, (i >> 1 & 1) * width - width / 2, (i >> 2) * height)
               for i in range(8)]
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    lines = ["solid box"]
    for a, b, c, d in sides:
        for triangle in ((a, b, c), (a, c, d)):
            lines += ["facet normal 0 0 0", "outer loop"]
            lines += ["vertex {} {} {}".format(*corners[corner]) for corner in triangle]
            lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid box"]) + "\n", encoding="utf-8")


LAND_XML = """<?xml version="1.0"?>
<LandXML version="1.2"><Units><Metric linearUnit="meter"/></Units>
<Alignments><Alignment name="track" staStart="1000" length="178.539816339745">
<CoordGeom>
<Line length="100"><Start>0 0</Start><End>0 100</End></Line>
<Curve rot="ccw" radius="50" length="78.539816339745">
<Start>0 100</Start><Center>50 100</Center><End>50 150</End></Curve>
</CoordGeom>
<Profile><ProfAlign name="rails"><PVI>1000 10</PVI><PVI>1200 12</PVI></ProfAlign></Profile>
<Cant name="cant" gauge="1.435" rotationPoint="insideRail">
<CantStation station="1000" appliedCant="0"/>
<CantStation station="1200" appliedCant="60" curvature="ccw"/></Cant>
</Alignment></Alignments></LandXML>
"""

ROUTE = ((0, 0), (30, 0), (30, 40))

CAMPAIGN = {"name": "Stand-in", "environments": {"hall": "site.h5"}, "vehicles": {"car": "car.ply"},
            "routes": {"line": "path.txt"}, "radii": [0.1]}

WAGON = {"bodies": [{"name": "body", "model": "body.ply", "pivots": [1, -1]}]}


def _positions(trajectory):
    return [line.split()[3:12:4] for line in trajectory.read_text().splitlines()]


def _drive(scan, path, folder):
    """The scan as if a moving scanner had made it: with GPS times, and its path by these times."""
    las = bytearray(scan.read_bytes())
    first, size, points = (struct.unpack_from(form, las, at)[0]
                           for form, at in (("<I", 96), ("<H", 105), ("<I", 107)))
    seconds = len(path) - 1
    records = b"".join(las[first + size * i:first + size * (i + 1)] +
                       struct.pack("<d", seconds * i / points) for i in range(points))
    las[104:107] = struct.pack("<BH", 1, size + 8)
    (folder / "drive.las").write_bytes(bytes(las[:first]) + records)
    (folder / "drive.txt").write_text("".join(
        f"{time} {' '.join(place)} 0 0 0 1\n" for time, place in enumerate(path)), encoding="utf-8")


def make(folder, clearway):
    """Makes all of them; `clearway` runs the program with the words that it gets, in the folder."""
    clearway("scene hall --points 20000 --model-points 2000 --poses 200 -o .".split())
    (folder / "scans").mkdir()
    (folder / "environment.las").rename(folder / "scans" / "hall.las")
    shutil.copy(folder / "scans" / "hall.las", folder / "scan.las")
    for name in ("car.ply", "body.ply"):
        shutil.copy(folder / "model.ply", folder / name)
    for name in ("path.txt", "track.txt", "crane.txt"):
        shutil.copy(folder / "trajectory.txt", folder / name)
    (folder / "path.csv").write_text("time,x,y,z,roll,pitch,yaw\n" + "".join(
        f"{number},{x},{y},{z},0,0,0\n"
        for number, (x, y, z) in enumerate(_positions(folder / "path.txt"))), encoding="utf-8")
    _drive(folder / "scan.las", _positions(folder / "path.txt"), folder)
    _box_stl(folder / "car.stl", (4500, 1900, 1500))
    _box_stl(folder / "crane.stl", (500, 500, 3000))
    _box_stl(folder / "bogie.stl", (2, 1.5, 0.8))
    clearway("model bogie.stl --spacing 0.1 -o bogie.ply".split())
    for name, length in (("tractor", "5"), ("trailer", "9")):
        clearway(["model", "box", f"{length},2.5,3", "-o", f"{name}.ply"])
    (folder / "wagon.json").write_text(json.dumps(WAGON), encoding="utf-8")
    clearway("convert scans/ -o site.h5".split())
    asked = "run --env site.h5 --model car.ply --trajectory path.txt --first-pose".split()
    clearway([*asked, *"--radius 0.1 --clearance 0.3 --profile 0.5 -o out.h5".split()])
    clearway([*asked, *"--radius 0.2 -o other.h5".split()])
    for name, source in (("kdtree", "out"), ("sweep", "out"), ("before", "out"), ("after", "other")):
        shutil.copy(folder / f"{source}.h5", folder / f"{name}.h5")
    (folder / "gauge.csv").write_text(
        "height,half_width\n0.4,1.2\n1.2,1.6\n3.2,1.6\n4.3,0.8\n", encoding="utf-8")
    (folder / "track.xml").write_text(LAND_XML, encoding="utf-8")
    (folder / "route.csv").write_text("x,y\n" + "".join(f"{x},{y}\n" for x, y in ROUTE), encoding="utf-8")
    (folder / "route.geojson").write_text(json.dumps({"type": "LineString", "coordinates": ROUTE}),
                                          encoding="utf-8")
    (folder / "lane.csv").write_text("x,y\n1,0\n19,0\n", encoding="utf-8")
    (folder / "street.xyz").write_text("".join(
        f"{x / 10} {y / 10} {x / 1000}\n" for x in range(201) for y in range(-20, 21)), encoding="utf-8")
    clearway("convert street.xyz -o street.h5 --unit m".split())
    (folder / "street.xyz").unlink()
    (folder / "curve.csv").write_text("x,y,z\n0,0,4\n20,0,4\n40,2,4.1\n", encoding="utf-8")
    (folder / "campaign.json").write_text(json.dumps(CAMPAIGN), encoding="utf-8")
    for name in ("model.ply", "trajectory.txt"):
        (folder / name).unlink()


def lend(made, folder, commands):
    """The files in a folder of their own, but for those that the commands make."""
    shutil.copytree(made, folder, copy_function=os.link)
    for command in commands:
        for output in re.findall(r"(?:-o|--output)[ =](\S+)", command):
            if (folder / output).is_file():
                (folder / output).unlink()
