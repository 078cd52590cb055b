"""Files of BCF 2.1: members, elements and attributes as its public schemas want them, cameras,
pictures, and what the ledger says.

bcf_test.py PROGRAM
"""

import re
import struct
import sys
import unittest
import xml.etree.ElementTree as ElementTree
import zipfile
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from place import Scratch  # noqa: E402

# Each element's children in the order that the schema wants: ? may be there once, * any number of
# times, + once or more.
CHILDREN = {
    "Version": "DetailedVersion?", "Markup": "Header? Topic Comment* Viewpoints*",
    "Topic": "ReferenceLink* Title Priority? Index? Labels* CreationDate CreationAuthor ModifiedDate? "
             "ModifiedAuthor? DueDate? AssignedTo? Stage? Description? BimSnippet? DocumentReference* "
             "RelatedTopic*",
    "Viewpoints": "Viewpoint? Snapshot? Index?",
    "VisualizationInfo": "Components? OrthogonalCamera? PerspectiveCamera? Lines? ClippingPlanes? Bitmap*",
    "PerspectiveCamera": "CameraViewPoint CameraDirection CameraUpVector FieldOfView",
    "Lines": "Line+", "Line": "StartPoint EndPoint",
    **dict.fromkeys(["CameraViewPoint", "CameraDirection", "CameraUpVector", "StartPoint", "EndPoint"], "X Y Z")}
ATTRIBUTES = {"Version": "VersionId", "Topic": "Guid TopicType? TopicStatus?", "Viewpoints": "Guid",
              "VisualizationInfo": "Guid"}
DATE, DOUBLE = r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(Z|[+-]\d\d:\d\d)", r"-?\d+(\.\d+)?([eE][+-]?\d+)?"
TEXT = {"CreationDate": DATE, "X": DOUBLE, "Y": DOUBLE, "Z": DOUBLE, "FieldOfView": DOUBLE, "Index": r"\d+",
        "Title": ".+", "CreationAuthor": ".+"}
GUID = "[a-f0-9]{8}-[a-f0-9]{4}-[a-f0-9]{4}-[a-f0-9]{4}-[a-f0-9]{12}"
POINT, MODEL = (200, 30, 30), (90, 110, 140)  # colours of the pictures


def follows(names, rule):
    """Whether names stand in the order and number that a rule wants."""
    pattern = "".join(f"(?:{word.rstrip('?*+')} ){word[len(word.rstrip('?*+')):]}" for word in rule.split())
    return re.fullmatch(pattern, "".join(f"{name} " for name in names)) is not None


class Bcf(Scratch):
    @classmethod
    def make(cls):
        """A hall, and a truck beside a crane that looks backwards, with points to the right of each."""
        cls.place.make_hall(30000, 300, 150)
        cls.place.ask("run --env site.h5 --model model.ply --trajectory trajectory.txt --radius 0.1 --first-pose "
                      "--clearance 0.2 -o hall.h5")
        cls.place.put("yard.xyz", "".join(f"{x} {y} {0.3 + 0.05 * i}\n" for i in range(10)
                                          for x, y in ((5, -0.3), (8, 10.3))))
        cls.place.put("box.xyz", "".join(f"{x} {y} {0.1 * k}\n" for x in (-0.5, 0.5) for y in (-0.2, 0.2)
                                         for k in range(11)))
        cls.place.put_box("box.off", (-0.5, -0.2, 0), (0.5, 0.2, 1))
        cls.place.put_path("path.txt", [(0.1 * i,) for i in range(101)])
        cls.place.put_path("crane.txt", [(0.1 * i, 10, 0, 3.14159265358979) for i in range(101)])
        cls.place.put("wagon.json", {"bodies": [{"name": "truck", "model": "box.xyz"}, {
            "name": "crane", "model": "box.xyz", "trajectory": "crane.txt"}]})
        cls.place.ask("convert yard.xyz -o yard.h5")
        for name, model in (("wagon", "--vehicle wagon.json"), ("mesh", "--model box.off")):
            cls.place.ask(f"run --env yard.h5 --trajectory path.txt --radius 0.15 --first-pose --clearance 0.3 "
                          f"-o {name}.h5 {model}")

    def parsed(self, archive, name):
        root = ElementTree.fromstring(archive.read(name))
        for element in root.iter():
            self.assertTrue(follows([child.tag for child in element], CHILDREN.get(element.tag, "")), element.tag)
            rule = ATTRIBUTES.get(element.tag, "")
            order = [word.rstrip("?") for word in rule.split()]
            self.assertLessEqual(element.attrib.keys(), set(order), element.tag)
            self.assertTrue(follows(sorted(element.attrib, key=order.index), rule), element.tag)
            if "Guid" in element.attrib:
                self.assertRegex(element.get("Guid"), f"^{GUID}$")
            if element.tag in TEXT:
                self.assertRegex(element.text or "", f"^{TEXT[element.tag]}$", element.tag)
        return root

    def check_camera(self, view):
        camera = view.find("PerspectiveCamera")
        direction, up = ([float(camera.find(name).find(axis).text) for axis in "XYZ"]
                         for name in ("CameraDirection", "CameraUpVector"))
        for a, b, product in ((direction, direction, 1), (up, up, 1), (direction, up, 0)):
            self.assertAlmostEqual(sum(x * y for x, y in zip(a, b)), product, 6)
        self.assertTrue(45 <= float(camera.find("FieldOfView").text) <= 60)

    def colours_of(self, png):
        """How often each colour is in a picture, whose chunks are sound."""
        self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
        at, chunks = 8, []
        while at < len(png):
            length, kind = struct.unpack(">I4s", png[at:at + 8])
            data = png[at + 8:at + 8 + length]
            self.assertEqual(struct.unpack(">I", png[at + 8 + length:at + 12 + length])[0], zlib.crc32(kind + data))
            chunks.append((kind, data))
            at += 12 + length
        self.assertEqual([kind for kind, _ in chunks], [b"IHDR", b"IDAT", b"IEND"])
        width, height, *form = struct.unpack(">IIBBBBB", chunks[0][1])
        raw = zlib.decompress(chunks[1][1])
        self.assertEqual([form, len(raw), set(raw[::1 + 3 * width])], [[8, 2, 0, 0, 0], height * (1 + 3 * width), {0}])
        pixels = b"".join(raw[y * (1 + 3 * width) + 1:(y + 1) * (1 + 3 * width)] for y in range(height))
        return {colour: sum(found.start() % 3 == 0 for found in re.finditer(re.escape(bytes(colour)), pixels))
                for colour in (POINT, MODEL)}

    def topics_of(self, words, name="c.bcf"):
        """The markup of each topic, and how many pixels of its picture show the model."""
        self.place.ask(f"conflicts {words} --force -o {name}")
        topics, guids = [], []
        with zipfile.ZipFile(self.place / name) as archive:
            names = archive.namelist()
            folders = sorted({name.split("/")[0] for name in names if "/" in name})
            self.assertEqual([archive.testzip(), len(names), len(set(names))], [None] + [1 + 3 * len(folders)] * 2)
            self.assertEqual(self.parsed(archive, "bcf.version").get("VersionId"), "2.1")
            for folder in folders:
                markup = self.parsed(archive, f"{folder}/markup.bcf")
                viewpoint = markup.find("Viewpoints")
                view = self.parsed(archive, f"{folder}/{viewpoint.find('Viewpoint').text}")
                self.assertEqual([markup.find("Topic").get("Guid"), view.get("Guid")], [folder, viewpoint.get("Guid")])
                self.check_camera(view)
                colours = self.colours_of(archive.read(f"{folder}/{viewpoint.find('Snapshot').text}"))
                self.assertGreater(colours[POINT], 0)
                guids += [folder, view.get("Guid")]
                topics.append((markup.find("Topic"), colours[MODEL]))
        self.assertEqual(len(set(guids)), len(guids))
        return topics

    def test_files_follow_the_schemas(self):
        conflicts = "hall.h5 --trajectory trajectory.txt"
        self.assertGreater(len(self.topics_of(f"{conflicts} --min-points 3 --model model.ply")), 2)
        # Where no conflict is listed, the small groups become topics.
        self.assertGreater(len(self.topics_of(f"{conflicts} --min-points 1000000", "none.bcfzip")), 0)

    def test_pictures_show_the_bodies_where_they_are_given(self):
        for words, shown, filled in (("wagon.h5", [False, False], 0),
                                     ("wagon.h5 --vehicle wagon.json", [True, True], 0),
                                     ("mesh.h5 --model box.off", [True], 1)):
            pixels = [count for _, count in self.topics_of(f"{words} --trajectory path.txt --min-points 3")]
            self.assertEqual([[count > 0 for count in pixels], sum(count > 5000 for count in pixels)], [shown, filled])

    def test_a_topic_has_what_the_ledger_says(self):
        words = ("mesh.h5 --trajectory path.txt --model box.off --env yard.h5 --ledger books.csv --min-points 3 "
                 "--date 2026-06-01")
        self.place.ask(f"conflicts {words} --update")
        table = (self.place / "books.csv").read_text()
        self.place.put("books.csv", table.replace("1,new,,,,", '1,accepted,=1+1,"<i>""a, b"" & c",2027-01-01,'))
        [(topic, _)] = self.topics_of(words)
        self.assertEqual([topic.get("TopicStatus"), topic.find("Labels").text, topic.find("AssignedTo").text],
                         ["Closed", "accepted", "=1+1"])
        self.assertIn("By the ledger it is accepted; row 1, until 2027-01-01: <i>", topic.find("Description").text)


if __name__ == "__main__":
    unittest.main()
