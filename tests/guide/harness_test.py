#!/usr/bin/python3
"""What the test of the guide takes for the same, and what it finds on a page."""

import tempfile
import unittest
from pathlib import Path
from unittest import mock

import guide_test
import page
import pages

PAGE = """# Page

```sh
clearway run --env site.h5 \\
    -o out.h5    # a remark
head -3 out.csv
```

```text
info: out.h5: 1 s
```

    {"name": "a file"}

Then look at it:

    clearway info out.h5

1. A list:

       clearway verify out.h5
"""


class Harness(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "page.md"
        self.path.write_text(PAGE, encoding="utf-8")

    def test_blocks_and_commands(self):
        first, file, last = page.blocks(self.path)
        self.assertEqual(first.commands,
                         ["clearway run --env site.h5 -o out.h5", "head -3 out.csv"])
        self.assertEqual(first.output.text, "info: out.h5: 1 s\n")
        self.assertEqual((file.language, file.commands), ("json", []))
        self.assertEqual(last.commands, ["clearway info out.h5"])

    def test_commands_outside_of_blocks(self):
        self.assertEqual(page.stray_commands(self.path), ["clearway verify out.h5"])

    def test_only_what_depends_on_the_machine_may_differ(self):
        shown = "info: out.h5: 17 of 2,000 points collide; engine sweep on the CPU, 1.50 s"
        self.assertTrue(page.same([shown], [shown.replace("1.50 s", "12.1 s")]))
        self.assertTrue(page.same([shown], [shown.replace("the CPU", "NVIDIA H200")]))
        self.assertFalse(page.same([shown], [shown.replace("17", "18")]))
        self.assertFalse(page.same([shown], [shown, "one line more"]))
        self.assertFalse(page.same([shown, "one line more"], [shown]))

    def test_dots_stand_for_any_lines(self):
        lines = ["a", "b", "c", "d"]
        for shown in (["a", "...", "d"], ["a", "b", "..."], ["...", "c", "d"],
                      ["a", "...", "c", "..."], ["..."], ["a", "b", "...", "c", "d"]):
            self.assertTrue(page.same(shown, lines), shown)
        for shown in (["b", "..."], ["...", "c"], ["a", "...", "e", "..."], ["a", "b"],
                      ["a", "b", "c", "d", "...", "d"]):
            self.assertFalse(page.same(shown, lines), shown)

    def test_refreshed(self):
        shown = ["took 3 s", "17 points", "...", "end"]
        printed = ["took 9 s", "18 points", "x", "y", "the end"]
        self.assertEqual(page.refreshed(shown, printed),
                         ["took 3 s", "18 points", "...", "the end"])
        self.assertEqual(page.refreshed(["a"], printed), printed)


class Follow(unittest.TestCase):
    """A page of a repository that has nothing else, with a program that prints its arguments."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "scratch").mkdir()
        program = self.root / "program"
        program.write_text('#!/bin/sh\necho "$*"\n[ "$1" != fail ]\n', encoding="utf-8")
        program.chmod(0o755)
        for table in ("NOT_RUN", "SNIPPETS_ELSEWHERE", "SAMPLES", "WRITTEN", "EXIT_CODES", "SMALLER"):
            patch = mock.patch.object(pages, table, {})
            patch.start()
            self.addCleanup(patch.stop)
        for module, name, value in ((page, "ROOT", self.root),
                                    (pages, "FOLLOWED_FROM_NOTHING", {"page.md"})):
            patch = mock.patch.object(module, name, value)
            patch.start()
            self.addCleanup(patch.stop)
        self.page = self.root / "page.md"

    def follow(self, text, update=False):
        """What is wrong with a page of this text."""
        self.page.write_text(text, encoding="utf-8")
        with tempfile.TemporaryDirectory(dir=self.root / "scratch") as scratch:
            guide = guide_test.Guide(self.root / "program", scratch, update)
            with mock.patch("builtins.print"):
                guide.follow("page.md")
            guide.all_used(["page.md"])
        return guide.faults

    def assert_fault(self, text, part):
        faults = self.follow(text)
        self.assertEqual(len(faults), 1, faults)
        self.assertIn(part, faults[0])

    def test_what_is_shown_is_compared(self):
        text = "```sh\nclearway 17 points\n```\n\n```text\n17 points\n```\n"
        self.assertEqual(self.follow(text), [])
        self.assert_fault(text.replace("text\n17", "text\n18"), "page.md:6: the page shows")

    def test_a_page_is_written_anew(self):
        text = "```sh\nclearway 17 points\n```\n\n```text\n18 points\n```\n\nThe end.\n"
        self.assertEqual(self.follow(text, update=True), [])
        self.assertEqual(self.page.read_text(encoding="utf-8"), text.replace("18", "17"))

    def test_exit_codes(self):
        self.assert_fault("    clearway fail\n", "page.md:1: ended with 1, expected 0: clearway fail")
        pages.EXIT_CODES[("page.md", "clearway fail")] = 1
        self.assertEqual(self.follow("    clearway fail\n"), [])
        self.assert_fault("    clearway fail\n    clearway fine\n".replace("fail", "good"), "no page has")

    def test_commands_and_snippets_that_nothing_runs(self):
        self.assert_fault("    make install\n", "neither run nor named in pages.py: make install")
        self.assert_fault("```cpp\nint a;\n```\n", "a block of cpp that no test runs")
        self.assert_fault("- So:\n\n      clearway here\n", "a command outside of a block")
        pages.NOT_RUN[("page.md", "make")] = "not here"
        self.assertEqual(self.follow("    make install\n"), [])
        self.assert_fault("    clearway fine\n", "NOT_RUN: no page has ('page.md', 'make')")


if __name__ == "__main__":
    unittest.main()
