"""Small inputs that `clearway scene` does not make: scans in other formats, meshes, paths, vehicles, campaigns.

Everything is derived from the scene `hall`, so the same scene gives the same bytes.
"""

import json
import math
import struct

UTM = (500000.0, 5700000.0, 100.0)  # added to a scan and its path, as a projected system would
KEPT = 5  # every such point of the hall is in the scans of other formats


def derive(folder):
    """Makes all of them in a folder that has the scene `hall`."""
    points = _las_points(folder / "hall/environment.las")
    poses = [[float(word) for word in line.split()]
             for line in (folder / "hall/trajectory.txt").read_text().splitlines()]
    for name in ("scans", "halves", "mixed", "models", "paths", "lines"):
        (folder / name).mkdir()
    _scans(folder, points)
    _models(folder / "models")
    _paths(folder / "paths", poses)
    _lines(folder, poses)
    _vehicles(folder)
    _campaigns(folder)


# --- scans ---------------------------------------------------------------------------------------


def _las_header(path):
    data = path.read_bytes()
    return data, struct.unpack_from("<I", data, 96)[0], struct.unpack_from("<H", data, 105)[0], \
        struct.unpack_from("<3d", data, 131)


def _las_points(path):
    data, start, length, scale = _las_header(path)
    return [tuple(value * step for value, step in zip(struct.unpack_from("<3i", data, at), scale))
            for at in range(start, len(data) - length + 1, length)]


def _scans(folder, points):
    scans, few = folder / "scans", points[::KEPT]
    lines = [f"{x:.4f} {y:.4f} {z:.4f}" for x, y, z in few]
    body = "\n".join(lines) + "\n"
    (scans / "plain.xyz").write_text(body)
    (scans / "count.pts").write_text(f"{len(few)}\n" + "".join(f"{line} 7\n" for line in lines))
    (scans / "named.csv").write_text("number,north,east,height\n" + "".join(
        f"{i},{y:.4f},{x:.4f},{z:.4f}\n" for i, (x, y, z) in enumerate(few)))
    (scans / "points.txt").write_text("# a comment\n" + body.replace(" ", ";"))
    (scans / "text.ply").write_text(_ply_header("ascii", len(few), "float") + body)
    (scans / "binary.ply").write_bytes(_ply_header("binary_little_endian", len(few), "double").encode() +
                                       b"".join(struct.pack("<3d", *point) for point in few))
    (scans / "big_endian.ply").write_bytes(_ply_header("binary_big_endian", len(few), "float").encode() +
                                           b"".join(struct.pack(">3f", *point) for point in few))
    (scans / "text.pcd").write_text(_pcd_header(len(few), "ascii") + body)
    (scans / "binary.pcd").write_bytes(_pcd_header(len(few), "binary").encode() +
                                       b"".join(struct.pack("<3f", *point) for point in few))
    (scans / "placed.ptx").write_text(
        f"{len(few)}\n1\n1 2 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 2 0 1\n" +
        "".join(f"{x - 1:.4f} {y - 2:.4f} {z:.4f} 0.5\n" for x, y, z in few))
    (scans / "scan000.3d").write_text("".join(
        f"{-100 * y:.2f} {100 * z:.2f} {100 * x:.2f}\n" for x, y, z in few))
    (scans / "scan000.pose").write_text("0 0 0\n0 0 0\n")
    (scans / "decimal_commas.xyz").write_text(body.replace(".", ","))
    (scans / "not_finite.xyz").write_text(body + "nan 1 2\n1 inf 2\n")
    (scans / "torn.ply").write_text(_ply_header("ascii", len(few) + 1, "float") + body)
    (folder / "mixed/a.xyz").write_text(body)
    (folder / "mixed/b.ply").write_text(_ply_header("ascii", len(few), "float") + body)
    (folder / "mixed/broken.ply").write_text(_ply_header("ascii", 9, "float") + "1 2\n")
    half = len(points) // 2
    _write_las(folder / "halves/1.las", points[:half], (0, 0, 0))
    _write_las(folder / "halves/2.las", points[half:], (5, -3, 0))
    _write_las(scans / "classes.las", points, (0, 0, 0))
    _write_las(scans / "utm.las", [tuple(map(sum, zip(point, UTM))) for point in points], UTM)
    # Far from the path of the hall, for verdicts that are "clear" or "undecided".
    _write_las(scans / "elsewhere.las", [(x + 500, y, z) for x, y, z in few], (500, 0, 0))
    (scans / "empty.xyz").write_text("x y z\n")


def _ply_header(encoding, count, number):
    return (f"ply\nformat {encoding} 1.0\nelement vertex {count}\n" +
            "".join(f"property {number} {axis}\n" for axis in "xyz") + "end_header\n")


def _pcd_header(count, data):
    return ("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
            f"WIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA {data}\n")


def _write_las(path, points, offset):
    """LAS 1.2, point format 3, which has classes, GPS times and colours. The class says how high a point is."""
    scale = 0.0001
    header = bytearray(227)
    header[0:4] = b"LASF"
    header[24:26] = bytes((1, 2))
    header[26:58] = b"same outputs".ljust(32, b"\0")
    struct.pack_into("<HHHIIBHI", header, 90, 1, 2026, 227, 227, 0, 3, 34, len(points))
    struct.pack_into("<I", header, 111, len(points))
    struct.pack_into("<3d3d", header, 131, scale, scale, scale, *offset)
    columns = list(zip(*points))
    struct.pack_into("<6d", header, 179, *(bound for column in columns
                                           for bound in (max(column), min(column))))
    records = []
    for number, point in enumerate(points):
        stored = [round((value - start) / scale) for value, start in zip(point, offset)]
        height = point[2] - offset[2]
        kind = 2 if height < 0.3 else 3 if height < 1 else 6
        records.append(struct.pack("<3iHBBbBHdHHH", *stored, number % 1000, 9, kind, 0, 0, 1,
                                   number * 0.001, number % 256, 100, kind * 1000))
    path.write_bytes(bytes(header) + b"".join(records))


# --- models --------------------------------------------------------------------------------------


def _box(size, origin=(0, 0, 0)):
    """Corners and triangles of a closed box, outside normals; the middle of its floor is the origin."""
    length, width, height = size
    corners = [((i & 1) * length - length / 2 + origin[0],
                (i >> 1 & 1) * width - width / 2 + origin[1], (i >> 2) * height + origin[2])
               for i in range(8)]
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]


def _obj(corners, triangles, more=""):
    return ("".join("v {} {} {}\n".format(*corner) for corner in corners) +
            "".join("f {} {} {}\n".format(*(i + 1 for i in t)) for t in triangles) + more)


def _stl(corners, triangles):
    return "solid part\n" + "".join(
        "facet normal 0 0 0\nouter loop\n" +
        "".join("vertex {} {} {}\n".format(*corners[i]) for i in t) + "endloop\nendfacet\n"
        for t in triangles) + "endsolid part\n"


def _models(models):
    corners, triangles = _box((4.2, 1.8, 1.4))
    (models / "box.obj").write_text(_obj(corners, triangles))
    (models / "box.stl").write_text(_stl(corners, triangles))
    (models / "box_mm.stl").write_text(_stl(*_box((4200, 1800, 1400))))
    (models / "box_binary.stl").write_bytes(bytes(80) + struct.pack("<I", len(triangles)) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *(value for i in t for value in corners[i]), 0) for t in triangles))
    (models / "box.off").write_text(
        f"OFF\n{len(corners)} {len(triangles)} 0\n" +
        "".join("{} {} {}\n".format(*corner) for corner in corners) +
        "".join("3 {} {} {}\n".format(*t) for t in triangles))
    (models / "box.ply").write_text(
        _ply_header("ascii", len(corners), "float").replace(
            "end_header", f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header") +
        "".join("{} {} {}\n".format(*corner) for corner in corners) +
        "".join("3 {} {} {}\n".format(*t) for t in triangles))
    (models / "open.obj").write_text(_obj(corners, triangles[2:]))
    mast = [*corners, (0, 0, 1.4), (0, 0, 2.6), (1.5, 0, 2.0)]
    (models / "mast.obj").write_text(_obj(mast, triangles, "l 9 10\np 11\n"))
    two = [_box((1.6, 1.8, 1.4), (-1.3, 0, 0)), _box((1.6, 1.8, 1.0), (1.3, 0, 0.2))]
    (models / "two_parts.obj").write_text(_obj(
        two[0][0] + two[1][0], two[0][1] + [tuple(i + 8 for i in t) for t in two[1][1]]))
    _sphere(models / "sphere.obj")
    (models / "bogie.stl").write_text(_stl(*_box((2, 1.5, 0.8))))
    (models / "few.xyz").write_text("0 0 0.5\n1 0.5 0.7\n-1.5 -0.8 1.1\n2 0.9 0.6\n")
    (models / "no_faces.obj").write_text("v 0 0 0\nv 1 0 0\n")


def _sphere(path, rings=12, radius=0.9):
    """A closed mesh of many triangles, of which none is parallel to an axis."""
    corners = [(0, 0, 2 * radius), (0, 0, 0)]
    for ring in range(1, rings):
        for step in range(2 * rings):
            polar, around = math.pi * ring / rings, math.pi * step / rings
            corners.append((radius * math.sin(polar) * math.cos(around),
                            radius * math.sin(polar) * math.sin(around), radius * (1 + math.cos(polar))))
    at = lambda ring, step: 2 + (ring - 1) * 2 * rings + step % (2 * rings)  # noqa: E731
    triangles = []
    for step in range(2 * rings):
        triangles.append((0, at(1, step), at(1, step + 1)))
        triangles.append((1, at(rings - 1, step + 1), at(rings - 1, step)))
        for ring in range(1, rings - 1):
            triangles.append((at(ring, step), at(ring + 1, step), at(ring + 1, step + 1)))
            triangles.append((at(ring, step), at(ring + 1, step + 1), at(ring, step + 1)))
    path.write_text(_obj([tuple(round(value, 6) for value in corner) for corner in corners], triangles))


# --- paths ---------------------------------------------------------------------------------------


def _matrix(pose, rotation_digits=9, position_digits=9):
    return " ".join(f"{value:.{position_digits if i % 4 == 3 else rotation_digits}f}"
                    for i, value in enumerate(pose[:12]))


def _quaternion(pose):
    """x, y, z, w of a pose that turns by less than a half turn."""
    r = [pose[0:3], pose[4:7], pose[8:11]]
    w = math.sqrt(max(0.0, 1 + r[0][0] + r[1][1] + r[2][2])) / 2
    return [(r[2][1] - r[1][2]) / (4 * w), (r[0][2] - r[2][0]) / (4 * w),
            (r[1][0] - r[0][1]) / (4 * w), w]


def _moved(pose, by):
    return [value + by[i // 4] if i % 4 == 3 and i < 12 else value for i, value in enumerate(pose)]


def _paths(paths, poses):
    def write(name, chosen, **digits):
        (paths / name).write_text("".join(_matrix(pose, **digits) + "\n" for pose in chosen))

    write("few_digits.txt", poses, rotation_digits=5, position_digits=2)
    write("fewest_digits.txt", poses, rotation_digits=2, position_digits=1)
    write("one.txt", poses[40:41])
    write("repeated.txt", [pose for pose in poses[20:40] for _ in range(3)])
    write("back.txt", poses[20:50] + poses[49:19:-1])
    write("jump.txt", poses[:15] + poses[-15:])
    write("utm.txt", [_moved(pose, UTM) for pose in poses])
    write("beside.txt", [_moved(pose, (0, 0, 40)) for pose in poses[:30]] + poses[30:50])
    write("leaving.txt", [_moved(pose, (-90 + 3 * i, 0, 0)) for i, pose in enumerate(poses[:50])])
    (paths / "empty.txt").write_text("# no pose\n")
    (paths / "torn.txt").write_text(_matrix(poses[0]) + "\n1 2 3\n")
    (paths / "mirrored.txt").write_text("-1 0 0 4 0 1 0 0 0 0 1 0.5\n-1 0 0 5 0 1 0 0 0 0 1 0.5\n")
    (paths / "cm.txt").write_text("".join(
        _matrix([value * 100 if i % 4 == 3 and i < 12 else value for i, value in enumerate(pose)]) + "\n"
        for pose in poses))
    seven = [([pose[3], pose[7], pose[11]], _quaternion(pose)) for pose in poses]
    row = lambda values: " ".join(f"{value:.9f}" for value in values)  # noqa: E731
    (paths / "tum.txt").write_text("".join(f"{i * 0.1:.1f} {row(p + q)}\n" for i, (p, q) in enumerate(seven)))
    (paths / "xyzw.txt").write_text("".join(row(p + q) + "\n" for p, q in seven))
    (paths / "wxyz.txt").write_text("".join(row(p + [q[3], *q[:3]]) + "\n" for p, q in seven))
    (paths / "euroc.csv").write_text("#timestamp,x,y,z,qw,qx,qy,qz\n" + "".join(
        f"{1403636579763555584 + i * 100000000},{row(p + [q[3], *q[:3]]).replace(' ', ',')}\n"
        for i, (p, q) in enumerate(seven)))
    (paths / "quaternion.csv").write_text("time,name,x,y,z,qx,qy,qz,qw\n" + "".join(
        f"{i * 0.1:.1f},pose {i},{row(p + q).replace(' ', ',')}\n" for i, (p, q) in enumerate(seven)))
    (paths / "angles.csv").write_text("x,y,z,roll_deg,pitch_deg,yaw_deg\n" + "".join(
        f"{p[0]:.6f},{p[1]:.6f},{p[2]:.6f},0,0,{math.degrees(math.atan2(pose[4], pose[0])):.6f}\n"
        for (p, _), pose in zip(seven, poses)))
    (paths / "map.csv").write_text("lat,lon,height,roll_deg,pitch_deg,heading_deg\n" + "".join(
        f"{51.45 + i * 1e-6:.8f},{9.0 + i * 1e-6:.8f},120,0,0,45\n" for i in range(30)))


# --- alignments, lines and outlines --------------------------------------------------------------


ALIGNMENT = """<?xml version="1.0" encoding="UTF-8"?>
<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.2" version="1.2" date="2026-01-01" time="00:00:00">
<Units><Metric linearUnit="meter" areaUnit="squareMeter" volumeUnit="cubicMeter"
 temperatureUnit="celsius" pressureUnit="milliBars"/></Units>
<Alignments><Alignment name="track" length="200.0" staStart="0"><CoordGeom>
<Line length="200"><Start>0 0</Start><End>0 200</End></Line></CoordGeom>
<Profile name="rail"><ProfAlign name="rail"><PVI>0 10</PVI><PVI>200 10</PVI></ProfAlign></Profile>
<Cant name="cant" gauge="1.435" rotationPoint="center">
<CantStation station="0" appliedCant="0" curvature="cw"/>
<CantStation station="100" appliedCant="150" curvature="cw"/>
<CantStation station="200" appliedCant="150" curvature="cw"/></Cant>
</Alignment></Alignments></LandXML>
"""


def _lines(folder, poses):
    lines = folder / "lines"
    vertices = [(pose[3], pose[7], pose[11]) for pose in poses[::10]]
    (lines / "track.xml").write_text(ALIGNMENT)
    (lines / "route.csv").write_text("x,y,z\n" + "".join(f"{x:.3f},{y:.3f},{z:.3f}\n" for x, y, z in vertices))
    (lines / "stations.csv").write_text("station,x,y,z,cant\n" + "".join(
        f"{100 + 10 * i},{20 * i},{i * i * 0.05:.3f},1,{0.01 * i:.3f}\n" for i in range(12)))
    (lines / "route.geojson").write_text(json.dumps(
        {"type": "LineString", "coordinates": [list(vertex) for vertex in vertices]}))
    for name, height, width in (("load", 2.2, 0.9), ("slim", 0.6, 0.1)):
        (folder / f"{name}.csv").write_text(f"{-width},0.3\n{width},0.3\n{width},{height}\n{-width},{height}\n")
    (folder / "half.csv").write_text("0.3,0.9\n2.2,0.9\n")


# --- vehicles and campaigns ----------------------------------------------------------------------


VEHICLES = {
    "wagon": [{"name": "body", "model": "tunnel/model.ply", "pivots": [6, -6]},
              {"name": "front bogie", "model": "models/bogie.stl", "at": 6},
              {"name": "rear bogie", "model": "models/bogie.stl", "at": "-600cm"}],
    "points": [{"name": "car", "model": "hall/model.ply"},
               {"name": "trailer", "model": "hall/model.ply", "at": -5}],
    "own": [{"name": "car", "model": "hall/model.ply"},
            {"name": "few", "model": "models/few.xyz", "trajectory": "hall/trajectory.txt"},
            {"name": "crane", "model": "models/box_mm.stl", "model_unit": "mm",
             "trajectory": "paths/few_digits.txt"}],
    "solid": [{"name": "sphere", "model": "models/sphere.obj"},
              {"name": "box", "model": "models/box.obj", "at": -5}],
    "same_pose": [{"name": "a", "model": "hall/model.ply"}, {"name": "b", "model": "models/few.xyz"}],
    "no_name": [{"model": "hall/model.ply"}],
}


def _vehicles(folder):
    for name, bodies in VEHICLES.items():
        (folder / f"{name}.json").write_text(json.dumps({"bodies": bodies}, indent=1))


CAMPAIGNS = {
    "plain": {"vehicles": {"car": "hall/model.ply", "raised": {"model": "hall/model.ply", "above": 0.2}},
              "routes": {"line": "hall/trajectory.txt", "part": {"trajectory": "paths/back.txt",
                                                               "chainage_start": 100}},
              "radii": [0.1, "25cm"],
              "query": {"first_pose": True, "clearance": 0.3, "profile": 0.5},
              "outputs": {"conflicts": ["csv", "json", "geojson", "gpkg", "bcf"], "gap": 1,
                          "min_points": 2, "report": True}, "limits": {"threads": 1}},
    "bodies": {"vehicles": {"wagon": "wagon.json", "solid": {"model": "models/sphere.obj", "as": "solid"}},
               "routes": {"line": "hall/trajectory.txt", "empty": "paths/empty.txt"},
               "radii": [0.2], "query": {"first_pose": True, "ignore_boxes": [[0, 0, 0, 10, 5, 3]]},
               "outputs": {"conflicts": ["csv"], "min_points": 2, "report": True},
               "limits": {"threads": 1}},
    "shards": {"vehicles": {"car": "hall/model.ply"}, "routes": {"line": "hall/trajectory.txt"},
               "radii": [0.3], "query": {"clearance": 0.4},
               "limits": {"shard_seconds": 0.05, "threads": 1, "engine": "sweep"}},
    "long": {"environments": {"hall": "long.h5"}, "vehicles": {"car": "long/model.ply"},
             "routes": {"line": "long/trajectory.txt"}, "radii": [0.1],
             "query": {"first_pose": True}, "outputs": {"conflicts": ["csv"]},
             "limits": {"threads": 1, "engine": "sweep"}},
    "unknown_key": {"vehicles": {"car": "hall/model.ply"}, "routes": {"line": "hall/trajectory.txt"},
                    "radii": [0.1], "wheels": 4},
}


def _campaigns(folder):
    for name, campaign in CAMPAIGNS.items():
        whole = {"name": f"Campaign {name}", "environments": {"hall": "cells.h5"}, **campaign}
        (folder / f"campaign_{name}.json").write_text(json.dumps(whole, indent=1))
