"""The files that the pages speak of as the user's: a small hall under these names, and what is made of it."""

import os
import re
import shutil
import struct
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tools"))
from place import PROGRAM, Place  # noqa: E402, F401


def _box_stl(length, width, height):
    """A closed box of these lengths, whose middle of the floor is the origin."""
    corners = [((i & 1) * length - length / 2, (i >> 1 & 1) * width - width / 2, (i >> 2) * height)
               for i in range(8)]
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    facets = [(a, *pair) for a, b, c, d in sides for pair in ((b, c), (c, d))]
    return "solid box\n" + "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*corners[i]) for i in facet) +
        "endloop\nendfacet\n" for facet in facets) + "endsolid box\n"


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


def _drive(scan, path, place):
    """The scan as if a moving scanner had made it: with GPS times, and its path by these times."""
    las = bytearray(scan.read_bytes())
    first, size, points = (struct.unpack_from(form, las, at)[0]
                           for form, at in (("<I", 96), ("<H", 105), ("<I", 107)))
    seconds = len(path) - 1
    records = b"".join(las[first + size * i:first + size * (i + 1)] +
                       struct.pack("<d", seconds * i / points) for i in range(points))
    las[104:107] = struct.pack("<BH", 1, size + 8)
    (place / "drive.las").write_bytes(bytes(las[:first]) + records)
    place.put("drive.txt", "".join(f"{time} {' '.join(at)} 0 0 0 1\n" for time, at in enumerate(path)))


def make(place):
    """Makes all of them."""
    place.ask("scene hall --points 20000 --model-points 2000 --poses 200 -o .")
    (place / "scans").mkdir()
    (place / "environment.las").rename(place / "scans/hall.las")
    path = [line.split()[3:12:4] for line in (place / "trajectory.txt").read_text().splitlines()]
    place.put("path.csv", "time,x,y,z,roll,pitch,yaw\n" + "".join(
        f"{number},{x},{y},{z},0,0,0\n" for number, (x, y, z) in enumerate(path)))
    _drive(place / "scans/hall.las", path, place)
    for name, size in (("car", (4500, 1900, 1500)), ("crane", (500, 500, 3000)), ("bogie", (2, 1.5, 0.8))):
        place.put(f"{name}.stl", _box_stl(*size))
    place.put("wagon.json", {"bodies": [{"name": "body", "model": "body.ply", "pivots": [1, -1]}]})
    place.put("campaign.json", {
        "name": "Stand-in", "environments": {"hall": "site.h5"}, "vehicles": {"car": "car.ply"},
        "routes": {"line": "path.txt"}, "radii": [0.1]})
    place.put("gauge.csv", "height,half_width\n0.4,1.2\n1.2,1.6\n3.2,1.6\n4.3,0.8\n")
    place.put("track.xml", LAND_XML)
    place.put("route.csv", "x,y\n0,0\n30,0\n30,40\n")
    place.put("route.geojson", {"type": "LineString", "coordinates": [[0, 0], [30, 0], [30, 40]]})
    place.put("lane.csv", "x,y\n1,0\n19,0\n")
    place.put("curve.csv", "x,y,z\n0,0,4\n20,0,4\n40,2,4.1\n")
    place.put("street.xyz", "".join(
        f"{x / 10} {y / 10} {x / 1000}\n" for x in range(201) for y in range(-20, 21)))

    def copy(source, *names):
        for name in names:
            shutil.copy(place / source, place / name)
    copy("scans/hall.las", "scan.las")
    copy("model.ply", "car.ply", "body.ply")
    copy("trajectory.txt", "path.txt", "track.txt", "crane.txt")
    asked = "run --env site.h5 --model car.ply --trajectory path.txt --first-pose"
    for command in ("model bogie.stl --spacing 0.1 -o bogie.ply", "model box 5,2.5,3 -o tractor.ply",
                    "model box 9,2.5,3 -o trailer.ply", "convert scans/ -o site.h5",
                    f"{asked} --radius 0.1 --clearance 0.3 --profile 0.5 -o out.h5",
                    f"{asked} --radius 0.2 -o other.h5", "convert street.xyz -o street.h5 --unit m"):
        place.ask(command, env={**os.environ, "CUDA_VISIBLE_DEVICES": ""})
    copy("out.h5", "kdtree.h5", "sweep.h5", "before.h5")
    copy("other.h5", "after.h5")
    for name in ("model.ply", "trajectory.txt", "street.xyz"):
        (place / name).unlink()


def lend(made, folder, commands):
    """The files in a folder of their own, but for those that the commands make."""
    shutil.copytree(made, folder, copy_function=os.link)
    for command in commands:
        for output in re.findall(r"(?:-o|--output)[ =](\S+)", command):
            if (folder / output).is_file():
                (folder / output).unlink()
