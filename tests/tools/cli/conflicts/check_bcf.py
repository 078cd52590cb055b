#!/usr/bin/env python3
"""Checks BCF files against the rules of the public schemas of BCF 2.1: check_bcf.py FILE..."""

import re
import struct
import sys
import xml.etree.ElementTree as ElementTree
import zipfile
import zlib

GUID = re.compile("[a-f0-9]{8}-[a-f0-9]{4}-[a-f0-9]{4}-[a-f0-9]{4}-[a-f0-9]{12}")
DATE = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(Z|[+-]\d\d:\d\d)")
DOUBLE = re.compile(r"-?\d+(\.\d+)?([eE][+-]?\d+)?")

# Each element's children in the order that the schema wants, with how often they may be there.
ONE, MAYBE, ANY, SOME = (1, 1), (0, 1), (0, None), (1, None)
VECTOR = [("X", ONE), ("Y", ONE), ("Z", ONE)]
CHILDREN = {
    "Version": [("DetailedVersion", MAYBE)],
    "Markup": [("Header", MAYBE), ("Topic", ONE), ("Comment", ANY), ("Viewpoints", ANY)],
    "Topic": [("ReferenceLink", ANY), ("Title", ONE), ("Priority", MAYBE), ("Index", MAYBE),
              ("Labels", ANY), ("CreationDate", ONE), ("CreationAuthor", ONE),
              ("ModifiedDate", MAYBE), ("ModifiedAuthor", MAYBE), ("DueDate", MAYBE),
              ("AssignedTo", MAYBE), ("Stage", MAYBE), ("Description", MAYBE),
              ("BimSnippet", MAYBE), ("DocumentReference", ANY), ("RelatedTopic", ANY)],
    "Viewpoints": [("Viewpoint", MAYBE), ("Snapshot", MAYBE), ("Index", MAYBE)],
    "VisualizationInfo": [("Components", MAYBE), ("OrthogonalCamera", MAYBE),
                          ("PerspectiveCamera", MAYBE), ("Lines", MAYBE),
                          ("ClippingPlanes", MAYBE), ("Bitmap", ANY)],
    "PerspectiveCamera": [("CameraViewPoint", ONE), ("CameraDirection", ONE),
                          ("CameraUpVector", ONE), ("FieldOfView", ONE)],
    "CameraViewPoint": VECTOR, "CameraDirection": VECTOR, "CameraUpVector": VECTOR,
    "Lines": [("Line", SOME)], "Line": [("StartPoint", ONE), ("EndPoint", ONE)],
    "StartPoint": VECTOR, "EndPoint": VECTOR,
}
ATTRIBUTES = {  # name: those required, those allowed too
    "Version": ({"VersionId"}, set()),
    "Topic": ({"Guid"}, {"TopicType", "TopicStatus"}),
    "Viewpoints": ({"Guid"}, set()),
    "VisualizationInfo": ({"Guid"}, set()),
}
TEXT = {"CreationDate": DATE, "X": DOUBLE, "Y": DOUBLE, "Z": DOUBLE, "FieldOfView": DOUBLE,
        "Index": re.compile(r"\d+"), "Title": re.compile(".+"), "CreationAuthor": re.compile(".+")}


def check(good, what):
    if not good:
        raise SystemExit(f"check_bcf: {what}")


def check_children(element, where):
    rest = [child.tag for child in element]
    for name, (least, most) in CHILDREN.get(element.tag, []):
        count = 0
        while rest and rest[0] == name:
            rest.pop(0)
            count += 1
        check(count >= least and (most is None or count <= most), f"{where}: {count} of {name}")
    check(not rest, f"{where}: {rest[:1]} in a wrong place")


def check_element(element, where):
    where = f"{where}/{element.tag}"
    check_children(element, where)
    required, allowed = ATTRIBUTES.get(element.tag, (set(), set()))
    names = set(element.attrib)
    check(required <= names <= required | allowed, f"{where}: attributes {names}")
    if "Guid" in names:
        check(GUID.fullmatch(element.get("Guid")), f"{where}: Guid {element.get('Guid')}")
    form = TEXT.get(element.tag)
    check(form is None or form.fullmatch(element.text or ""), f"{where}: {element.text}")
    for child in element:
        check_element(child, where)


def parsed(archive, name):
    element = ElementTree.fromstring(archive.read(name))
    check_element(element, name)
    return element


def vector(element):
    return [float(element.find(axis).text) for axis in "XYZ"]


def check_camera(view, where):
    camera = view.find("PerspectiveCamera")
    direction, up = vector(camera.find("CameraDirection")), vector(camera.find("CameraUpVector"))
    for what in (direction, up):
        check(abs(sum(x * x for x in what) - 1) < 1e-6, f"{where}: length of a direction")
    check(abs(sum(x * y for x, y in zip(direction, up))) < 1e-6, f"{where}: up is not upright")
    check(45 <= float(camera.find("FieldOfView").text) <= 60, f"{where}: field of view")


def pixels_of(png, where):
    """Checks the chunks; gives all rows of RGB, one after the other."""
    check(png[:8] == b"\x89PNG\r\n\x1a\n", f"{where}: no PNG")
    at, chunks = 8, []
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        data = png[at + 8:at + 8 + length]
        crc, = struct.unpack(">I", png[at + 8 + length:at + 12 + length])
        check(zlib.crc32(kind + data) == crc, f"{where}: checksum of {kind}")
        chunks.append((kind, data))
        at += 12 + length
    check([kind for kind, _ in chunks] == [b"IHDR", b"IDAT", b"IEND"], f"{where}: chunks")
    width, height, *form = struct.unpack(">IIBBBBB", chunks[0][1])
    check(form == [8, 2, 0, 0, 0], f"{where}: form {form}")
    raw = zlib.decompress(chunks[1][1])
    check(len(raw) == height * (1 + 3 * width), f"{where}: size")
    rows = [raw[y * (1 + 3 * width):(y + 1) * (1 + 3 * width)] for y in range(height)]
    check(all(row[0] == 0 for row in rows), f"{where}: filters")
    return b"".join(row[1:] for row in rows)


def count_of(pixels, colour):
    """How many pixels have a colour, of which no end is its beginning."""
    return sum(found.start() % 3 == 0 for found in re.finditer(re.escape(bytes(colour)), pixels))


def check_snapshot(png, where):
    """Gives how many pixels show the model."""
    pixels = pixels_of(png, where)
    check(count_of(pixels, (200, 30, 30)) > 0, f"{where}: no colliding point in the picture")
    return count_of(pixels, (90, 110, 140))


def check_archive(path):
    guids = []
    model_pixels = []
    with zipfile.ZipFile(path) as archive:
        check(archive.testzip() is None, f"{path}: a member is damaged")
        names = archive.namelist()
        check(len(set(names)) == len(names), f"{path}: a name twice")
        check(parsed(archive, "bcf.version").get("VersionId") == "2.1", "version")
        folders = sorted({name.split("/")[0] for name in names if "/" in name})
        for folder in folders:
            markup = parsed(archive, f"{folder}/markup.bcf")
            check(markup.find("Topic").get("Guid") == folder, f"{folder}: another Guid")
            viewpoint = markup.find("Viewpoints")
            view = parsed(archive, f"{folder}/{viewpoint.find('Viewpoint').text}")
            check(view.get("Guid") == viewpoint.get("Guid"), f"{folder}: Guid of the view")
            check_camera(view, folder)
            snapshot = f"{folder}/{viewpoint.find('Snapshot').text}"
            model_pixels.append(check_snapshot(archive.read(snapshot), snapshot))
            guids += [folder, view.get("Guid")]
        check(len(names) == 1 + 3 * len(folders), f"{path}: members")
    check(len(set(guids)) == len(guids), f"{path}: a Guid twice")
    with_model = sum(1 for pixels in model_pixels if pixels)
    dense = sum(1 for pixels in model_pixels if pixels > 5000)
    print(f"{path}: {len(folders)} topics, {with_model} with the model, {dense} full of it")


for file in sys.argv[1:]:
    check_archive(file)
