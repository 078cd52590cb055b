"""A question as a railway asks it, from the alignment to the station table: a wagon on two pivots
runs along the track of the tunnel scene, which is given as LandXML with profile and cant. The
overthrow equals its closed form, and the least distances of each stretch equal brute force.

Usage: alignment_question_test.py CLEARWAY_PROGRAM
"""

import csv
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

SLOPE = 0.008
BEND = 320.0                             # radius of the first arc of the tunnel scene, metres
ELEMENTS = [(180, 0, 0), (60, 0, 1 / BEND), (320, 1 / BEND, 1 / BEND), (60, 1 / BEND, 0)]
CANT, RAIL_DISTANCE = 0.08, 1.5
FROM, TO, STEP, EVERY = 150.0, 420.0, 0.5, 5.0
HALF_PIVOTS, HALF_LENGTH = 10.0, 12.5
ROUNDED = 0.5e-4 + 1e-9  # the table has tenths of millimetres
LOW, HIGH = np.array([-HALF_LENGTH, -1.4, 0.95]), np.array([HALF_LENGTH, 1.4, 3.9])
RADIUS, CLEARANCE = 0.1, 0.6


def place(element, heading, u):
    """Where an element of linear curvature ends after u metres, from its start at the origin."""
    length, k0, k1 = element
    nodes, weights = np.polynomial.legendre.leggauss(40)
    t = u * (nodes + 1) / 2
    angle = heading + k0 * t + (k1 - k0) * t * t / (2 * length)
    return u / 2 * np.array([np.dot(weights, np.cos(angle)), np.dot(weights, np.sin(angle))])


def land_xml():
    """The beginning of the scene's track. LandXML has northing before easting."""
    at, heading, items = np.zeros(2), 0.0, []
    for length, k0, k1 in ELEMENTS:
        end = at + place((length, k0, k1), heading, length)
        shown = [f"<{name}>{p[1]:.15f} {p[0]:.15f}</{name}>"
                 for name, p in (("Start", at), ("End", end))]
        radius = ["INF" if k == 0 else f"{1 / k:.10f}" for k in (k0, k1)]
        if k0 == k1 == 0:
            items.append(f'<Line length="{length}">{"".join(shown)}</Line>')
        elif k0 == k1:
            centre = at + np.array([-math.sin(heading), math.cos(heading)]) / k0
            items.append(f'<Curve rot="ccw" radius="{radius[0]}" length="{length}">{shown[0]}'
                         f"<Center>{centre[1]:.15f} {centre[0]:.15f}</Center>{shown[1]}</Curve>")
        else:
            turn = (at + end) / 2
            items.append(f'<Spiral rot="ccw" spiType="clothoid" length="{length}" radiusStart='
                         f'"{radius[0]}" radiusEnd="{radius[1]}">{shown[0]}'
                         f"<PI>{turn[1]:.15f} {turn[0]:.15f}</PI>{shown[1]}</Spiral>")
        heading += (k0 + k1) / 2 * length
        at = end
    whole = sum(e[0] for e in ELEMENTS)
    cants = "".join(f'<CantStation station="{s}" appliedCant="{d}" curvature="ccw"/>'
                    for s, d in ((0, 0), (180, 0), (240, 1000 * CANT), (560, 1000 * CANT), (620, 0)))
    return f"""<?xml version="1.0"?>
<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.2" version="1.2">
<Units><Metric linearUnit="meter" areaUnit="squareMeter" volumeUnit="cubicMeter"
 temperatureUnit="celsius" pressureUnit="HPA"/></Units>
<Alignments><Alignment name="tunnel" staStart="0" length="{whole}">
<CoordGeom>{"".join(items)}</CoordGeom>
<Profile name="rails"><ProfAlign name="rails"><PVI>0 0</PVI><PVI>{whole} {SLOPE * whole}</PVI>
</ProfAlign></Profile>
<Cant name="cant" gauge="1.435" rotationPoint="insideRail">{cants}</Cant>
</Alignment></Alignments></LandXML>
"""


def write_wagon(folder):
    corners = [[(LOW, HIGH)[i >> k & 1][k] for k in range(3)] for i in range(8)]
    faces = ["0 2 3", "0 3 1", "4 5 7", "4 7 6", "0 1 5", "0 5 4", "2 6 7", "2 7 3", "0 4 6",
             "0 6 2", "1 3 7", "1 7 5"]
    (folder / "wagon.off").write_text(
        "OFF\n8 12 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in corners)
        + "".join(f"3 {face}\n" for face in faces))
    (folder / "wagon.json").write_text(
        '{"bodies": [{"name": "wagon", "model": "wagon.off", "pivots": '
        f"[{HALF_PIVOTS}, {-HALF_PIVOTS}]}}]}}\n")


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [{name.split(" [")[0]: value for name, value in row.items()}
                for row in csv.DictReader(line for line in file if not line.startswith("#"))]


def points_of(las):
    """x, y, z of a LAS file of the scene, in the order of the file."""
    data = las.read_bytes()
    start = int.from_bytes(data[96:100], "little")
    size = int.from_bytes(data[105:107], "little")
    scale, offset = np.frombuffer(data[131:155]), np.frombuffer(data[155:179])
    records = np.frombuffer(data[start:], dtype=np.uint8)
    records = records[:len(records) // size * size].reshape(-1, size)
    return records[:, :12].copy().view("<i4") * scale + offset


def poses_of(path):
    """The table of a followed body: rotations, places, and the poses of the path."""
    rows = rows_of(path)
    turns = np.array([[[float(r[f"r{i}{j}"]) for j in range(3)] for i in range(3)] for r in rows])
    places = np.array([[float(r[axis]) for axis in "xyz"] for r in rows])
    return turns, places, np.array([int(r["path_pose"]) for r in rows])


def distances_to_box(local):
    """Distances from places in the wagon's frame to the surface of its box."""
    beyond = np.maximum(LOW - local, local - HIGH)
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
    return np.where(beyond.max(axis=1) <= 0, -beyond.max(axis=1), outside)


def brute_force(points, turns, places, chainage):
    """For each stretch the least distance, and those to the left, to the right and above, of the
    points whose nearest pose lies on it."""
    least = np.full(len(points), np.inf)
    pose_of = np.zeros(len(points), dtype=int)
    for pose, (turn, at) in enumerate(zip(turns, places)):
        near = np.flatnonzero(np.linalg.norm(points - at, axis=1) < 15)
        distance = distances_to_box((points[near] - at) @ turn)
        better = distance < least[near]
        least[near[better]] = distance[better]
        pose_of[near[better]] = pose
    found = {}
    for point in np.flatnonzero(least < CLEARANCE):
        pose = pose_of[point]
        row = found.setdefault(int(chainage[pose] // EVERY), {})
        _, y, z = (points[point] - places[pose]) @ turns[pose]
        side = ("left" if y > HIGH[1] else "right" if y < LOW[1] else
                "above" if z > HIGH[2] else None)
        for name in ("least", side):
            if name and least[point] < row.get(name, np.inf):
                row[name] = least[point]
    return found


def closed_overthrow():
    """Overthrow of middle and ends on the arc, in the plane of the rails, which the cant turns. The
    pivots lie on the path, 10 m of way before and behind the pose; on a gradient the way is longer
    than on the map, and the ends of the chord are a little above or below the rails."""
    gradient, roll = math.atan(SLOPE), math.asin(CANT / RAIL_DISTANCE)
    half = HALF_PIVOTS * math.cos(gradient) / BEND
    across, rise = BEND * math.sin(half), HALF_PIVOTS * math.sin(gradient)
    reach = HALF_LENGTH * across / math.hypot(across, rise)
    inside = BEND * (1 - math.cos(half))
    outside = math.hypot(BEND * math.cos(half), reach) - BEND
    above = reach * rise / across - SLOPE * BEND * math.atan2(reach, BEND * math.cos(half))
    return inside * math.cos(roll), outside * math.cos(roll) + abs(above) * math.sin(roll)


def check_overthrow(rows):
    middle, end = closed_overthrow()
    on_arc = 0
    for row in rows:
        begin, stop = float(row["station_from"]), float(row["station_to"])
        if begin - HALF_LENGTH - 1 > 240 and stop + HALF_LENGTH + 1 < 560 and stop < TO - 15:
            on_arc += 1
            for name, expected in (("middle", middle), ("end", end)):
                found = float(row[f"wagon_overthrow_{name}"])
                assert abs(found - expected) < ROUNDED, (begin, name, found, expected)
    assert on_arc > 20, on_arc
    print(f"{on_arc} stretches on the arc: overthrow {middle:.6f} m inside, {end:.6f} m outside")


def check_distances(rows, found):
    compared = 0
    for number, row in enumerate(rows):
        expected = found.get(number, {})
        for name in ("least", "left", "right", "above"):
            text, value = row[name], expected.get(name)
            if name == "least" and row["verdict"] == "conflict" and (value or 1) >= RADIUS:
                # Something is closer there, and nearest at another place.
                assert text == "" and float(row["least_below"]) == RADIUS, (number, row)
                continue
            assert (text == "") == (value is None), (number, name, text, value)
            if value is not None:
                compared += 1
                assert abs(float(text) - value) < ROUNDED, (number, name, text, value)
    assert compared > 60, compared
    print(f"{compared} distances of {len(rows)} stretches equal brute force")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        def clearway(*words):
            done = subprocess.run([sys.argv[1], *map(str, words)], cwd=folder, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
            assert done.returncode == 0, (words, done.stderr)

        (folder / "track.xml").write_text(land_xml(), encoding="utf-8")
        write_wagon(folder)
        clearway("scene", "tunnel", "--points", 200000, "--model-points", 1, "--poses", 1, "-o", ".")
        clearway("convert", "environment.las", "-o", "site.h5")
        clearway("trajectory", "alignment", "track.xml", "--from", FROM, "--to", TO, "--step", STEP,
                 "-o", "line.csv")
        clearway("run", "--env", "site.h5", "--vehicle", "wagon.json", "--trajectory", "line.csv",
                 "--radius", RADIUS, "--first-pose", "--clearance", CLEARANCE, "-o", "out.h5")
        clearway("stations", "out.h5", "--vehicle", "wagon.json", "--trajectory", "line.csv",
                 "--every", EVERY, "-o", "stations.csv")
        clearway("trajectory", "follow", "line.csv", "--pivots", f"{HALF_PIVOTS},{-HALF_PIVOTS}",
                 "-o", "wagon.csv")
        rows = rows_of(folder / "stations.csv")
        check_overthrow(rows)
        turns, places, path_pose = poses_of(folder / "wagon.csv")
        path = np.array([[float(r[axis]) for axis in "xyz"] for r in rows_of(folder / "line.csv")])
        chainage = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
        found = brute_force(points_of(folder / "environment.las"), turns, places,
                            chainage[path_pose])
        check_distances(rows, found)


main()
