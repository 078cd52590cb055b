"""Disks that are really full or read-only: exit code 4, the file named, nothing that looks finished,
and finished work is used once there is room.

disk_test.py PROGRAM
"""

import contextlib
import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

if "--mounting" in sys.argv:
    sys.argv.remove("--mounting")
else:  # begins again where it may mount file systems that nobody else sees
    own = "unshare --user --map-root-user --mount".split()
    if shutil.which("unshare") is None or subprocess.run([*own, "true"], check=False).returncode != 0:
        print("not tested: this user may not mount file systems here")
        sys.exit(0)
    os.execvp("unshare", [*own, sys.executable, *sys.argv, "--mounting"])

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from place import Scratch  # noqa: E402

PAGE, ROOM = 4096, 64 << 20
QUESTION = "--model model.ply --trajectory trajectory.txt --radius 0.1"
SEARCH = f"run --env site.h5 {QUESTION} --threads 2 --device cpu"


class Disks(Scratch):
    @classmethod
    def make(cls):
        """A hall in which every cell leaves some bytes in the journal."""
        cls.place.make_hall(30000, 300, 150, "--cell-points 256")
        cls.place.ask(f"{SEARCH} -o made.h5")
        cls.disk = cls.place / "disk"
        cls.disk.mkdir()

    def mount(self, size, more=""):
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"{more}size={size}", "tmpfs", self.disk], check=True)

    @contextlib.contextmanager
    def disk_of(self, size):
        self.mount(size)
        try:
            yield
        finally:
            subprocess.run(["umount", self.disk], check=True)

    def failed(self, words, *said):
        self.assertEqual(self.place.ask(words, 4, "disk", *said).stdout, "")

    def fill(self, words, name, growth):
        """Gives a command disks that are too small, with more room each time, and lets it go on with
        room. What it said of each of them, and which files it left."""
        self.place.ask(f"{words} -o expected-{name}")
        expected, said, left, size = self.place.bytes(f"expected-{name}"), [], [], PAGE
        command = f"{words} -o disk/{name}"
        while True:
            with self.disk_of(size):
                process = self.place.start(command)
                text = process.communicate()[0]
                if process.returncode == 0:
                    self.assertEqual(os.listdir(self.disk), [name])
                    return said, left
                self.assertEqual(process.returncode, 4, f"{size} bytes: {text}")
                self.assertIn("disk", text)
                said.append(text)
                left += os.listdir(self.disk)
                more = " --resume" if os.listdir(self.disk) else ""
                if more and words.startswith("run"):
                    self.assertEqual(os.listdir(self.disk), [f"{name}.journal"])
                    self.failed(command + more)  # still full
                self.mount(ROOM, "remount,")
                self.place.ask(command + more)
                self.assertEqual([os.listdir(self.disk), self.place.bytes(f"disk/{name}")], [[name], expected])
            size = growth(size)

    def test_a_run_goes_on_once_there_is_room(self):
        for engine in ("sweep", "grid", "kdtree"):
            with self.subTest(engine):
                said, left = self.fill(f"{SEARCH} --engine {engine}", f"{engine}.h5",
                                       lambda size: size + (PAGE if size < 8 * PAGE else size // 2 // PAGE * PAGE))
                self.assertTrue(left)
                self.assertTrue(any(".h5.journal" not in text for text in said))  # no room for the result
                self.assertTrue(any(" of which are missing: " in text for text in said))

    def test_a_conversion_goes_on_once_there_is_room_and_an_export_begins_again(self):
        for words, name in (("convert environment.las", "out.h5"), ("export made.h5", "out.las"),
                            ("export made.h5", "out.csv"), ("export made.h5", "out.ply")):
            with self.subTest(name):
                said, left = self.fill(words, name, lambda size: 2 * size)
                self.assertGreater(len(said), 2)
                self.assertTrue(words.startswith("convert") or not left, left)

    def test_inputs_are_read_from_a_read_only_disk_and_outputs_refused_at_once(self):
        def bytes_of_disk():
            return {file.name: file.read_bytes() for file in self.disk.iterdir()}
        with self.disk_of(ROOM):
            for name in ("environment.las", "model.ply", "trajectory.txt", "site.h5", "made.h5"):
                shutil.copyfile(self.place / name, self.disk / name)
            self.place.ask(f"{SEARCH} --journal-interval 0 -o disk/out.h5", 4, under=["prlimit", "--fsize=1500"])
            before = bytes_of_disk()
            self.assertIn("out.h5.journal", before)
            self.mount(ROOM, "remount,ro,")
            search = "run --env disk/site.h5 --model disk/model.ply --trajectory disk/trajectory.txt --radius 0.1"
            for words in ("convert disk/environment.las -o a.h5", f"{search} -o b.h5", "export disk/made.h5 -o c.csv",
                          *(f"{command} disk/{name}" for command in ("verify", "info")
                            for name in ("site.h5", "made.h5", "out.h5.journal"))):
                self.place.ask(words)
            for words in (f"{search} -o disk/out.h5", f"{search} -o disk/out.h5 --resume",
                          f"{search} -o disk/out.h5 --force", f"{search} -o disk/made.h5 --force",
                          "convert disk/environment.las -o disk/new.h5", "export disk/made.h5 -o disk/new.csv"):
                self.failed(words)
            self.assertEqual(bytes_of_disk(), before)

    def test_check_names_the_folder_as_the_place_for_another_disk(self):
        with self.disk_of(40 * PAGE):
            self.failed(f"check environment.las {QUESTION} -o disk/site", "give -o a folder on a disk with more")


if __name__ == "__main__":
    unittest.main()
