"""tools/check_prose.py accepts clean documents and names what is wrong in planted faults."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CHECKER = Path(__file__).resolve().parents[2] / "tools" / "check_prose.py"

PROGRAM = """#!/bin/sh
case "$*" in
"run --help-all") cat <<END
Search
Usage: toy run [OPTIONS]

Options:
  -h,--help                   Print this help message and exit
  --radius METRES REQUIRED    Search radius in metres
  --engine TEXT:{sweep,grid}=sweep
                              The engine
  --force Excludes: --resume  Overwrite

%s
Example: toy run --radius 1
END
;;
*) cat <<END
A toy
Usage: toy [OPTIONS] SUBCOMMAND

Options:
  -h,--help                   Print this help message and exit

Subcommands:
  run                         Search
END
;;
esac
"""

COMMANDS = """# Commands

`--help` prints the options.

## toy run

| option | meaning |
|---|---|
| `--radius METRES` | search radius |
| `--engine NAME` | the engine |
| `--force` | overwrite |

    cmake --build build && toy run --radius 1 --engine grid   # --build is of cmake
    toy run \\
        --force

```text
error: out.h5: exists already; --force overwrites it
```
"""

GLOSSARY = """# Glossary

## The query

| term | meaning |
|---|---|
| pose | where it stands |
| least distance | how near it comes |

## Words that are not used

| not | but |
|---|---|
| waypoint, key frame | pose |
"""


class CheckProse(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.write("README.md", "# Toy\n\nRead the [commands](docs/guide/commands.md#toy-run).\n")
        self.write("docs/guide/commands.md", COMMANDS)
        self.program = self.root / "toy"
        self.set_footer("All is well.")

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def append(self, name, text):
        self.write(name, (self.root / name).read_text(encoding="utf-8") + text)

    def set_footer(self, footer):
        self.program.write_text(PROGRAM % footer, encoding="utf-8")
        self.program.chmod(0o755)

    def check(self):
        """The exit code and the faults."""
        done = subprocess.run([sys.executable, CHECKER, "--root", self.root, self.program],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.stderr, "")
        return done.returncode, done.stdout.splitlines()

    def assert_clean(self):
        self.assertEqual(self.check(), (0, []))

    def assert_fault(self, *parts):
        """Exactly one, whose line holds all parts."""
        code, faults = self.check()
        self.assertEqual((code, len(faults)), (1, 1), faults)
        for part in parts:
            self.assertIn(part, faults[0])

    def test_clean_documents_pass(self):
        self.assert_clean()

    def test_long_and_short_sentences_are_nobodys_business(self):
        self.append("README.md", "\nOne. Two.\n" + "word " * 80 + "\n")
        self.assert_clean()

    def test_a_path_of_the_sources_that_is_nowhere(self):
        self.write("src/core/sweep.hpp", "")
        self.append("README.md", "\n`src/core`, `src/core/sweep`, `src/NAME.cpp` and `src/core/sweep.hpp`.\n")
        self.assert_clean()
        self.append("README.md", "\nIn `src/core/weep`.\n")
        self.assert_fault("src/core/weep: no such file or folder")

    def test_names_that_no_source_has(self):
        self.write("src/core/sweep.hpp", "struct SweepTree { int find_all(int); };\n"
                                         "inline constexpr int kMostTrees = 3;\n"
                                         'const char* made = "index.html";\n')
        self.append("README.md", "\n`SweepTree`, `SweepTree::find_all()`, `find_all(tree)`, `kMostTrees`, "
                                 "`sweep.hpp`, `core/sweep.hpp`, `out/index.html`, `NAME_reader.hpp`, "
                                 "`LAS`, `Clear`, `a(b) - c(d)`.\n\n    GoneType gone.cpp\n")
        self.assert_clean()
        for name in ("SweepTrees", "SweepTree::find_one()", "find_some()", "kMostLeaves", "sweeps.hpp"):
            with self.subTest(name):
                readme = (self.root / "README.md").read_text(encoding="utf-8")
                self.append("README.md", f"\nSee `{name}`.\n")
                self.assert_fault(f"{name}: no source has this name")
                self.write("README.md", readme)

    def test_a_list_of_names_that_is_not_complete(self):
        names = ("near", "few", "unseen", "unknown", "doubt")
        self.write("src/answer.cpp", "const char* name_of(Reason reason) {\n  switch (reason) {\n" +
                   "".join(f'    return "{name}";\n' for name in names) + "  }\n}\n")
        self.write("src/python/answer.cpp", "\"A list of 'near', 'few', \"\n\"'unseen' and 'doubt'.\"")
        self.assert_clean()
        self.write("src/python/answer.cpp", "\n\"A list of 'near', 'few' \"\n\"and 'doubt'.\"")
        self.assert_fault("src/python/answer.cpp:2: a list of Reason lacks unseen")

    def test_a_command_that_the_first_table_lacks(self):
        self.write("docs/guide/command-line.md", "# All\n\n| command | what |\n|---|---|\n"
                                                 "| `toy run` | searches |\n")
        self.assert_clean()
        self.write("docs/guide/command-line.md", "# All\n\n| command | what |\n|---|---|\n"
                                                 "| `toy run --force` | writes |\n\n| `toy run` | x |\n")
        self.assert_fault("toy run is not in the first table")

    def test_a_word_that_a_term_replaces(self):
        self.write("docs/design/glossary.md", GLOSSARY)
        self.assert_clean()
        self.append("README.md", "\nOne\nof the key\nframes.\n\n    cat waypoint\n")
        self.assert_fault("README.md:6: key frames: the glossary's term is: pose")

    def test_a_word_that_a_term_replaces_in_tables_and_help(self):
        self.write("docs/design/glossary.md", GLOSSARY)
        self.append("docs/guide/commands.md", "\n| Waypoint |\n|---|\n")
        self.assert_fault("docs/guide/commands.md:21: Waypoint: the glossary's term is: pose")
        self.write("docs/guide/commands.md", COMMANDS)
        self.set_footer("Give every waypoint.")
        self.assert_fault("toy run --help: waypoint: the glossary's term is: pose")

    def test_a_term_that_is_defined_twice(self):
        self.write("docs/design/glossary.md", GLOSSARY.replace("| least", "| way, pose | a |\n| least"))
        self.assert_fault("docs/design/glossary.md:8: pose is defined in line 7 already")

    def test_broken_link(self):
        self.append("README.md", "\nSee [this\npage](docs/guide/nothing.md).\n")
        self.assert_fault("README.md:5: broken link: docs/guide/nothing.md: no such file")

    def test_broken_link_in_any_markdown(self):
        self.write("docs/design/new.md", "# New\n\n| [a](../guide/commands.md#nothing) |\n")
        self.assert_fault("docs/design/new.md:3: broken link", "no such heading")

    def test_broken_image_and_reference(self):
        self.append("README.md", "\n[![picture](none.png)](toy)\n")
        self.assert_fault("README.md:5: broken link: none.png")
        self.write("README.md", "[a]: none.md\n")
        self.assert_fault("README.md:1: broken link: none.md")

    def test_links_to_the_web_and_in_code_are_not_followed(self):
        self.append("README.md", "\n[web](https://example.org/x) `[a](b)` [here](#toy) [dir](docs)\n")
        self.assert_clean()

    def test_unknown_option(self):
        self.append("README.md", "\nGive\n`--nothing`.\n")
        self.assert_fault("README.md:6: --nothing: no such option")

    def test_unknown_option_in_a_command_and_a_message(self):
        self.append("README.md", "\n    ls --all | toy run --radius 1 --all\n")
        self.assert_fault("README.md:5: --all: no such option: toy run")
        self.write("README.md", "```text\nerror: take --all\n```\n")
        self.assert_fault("README.md:2: --all: no such option: error")

    def test_option_of_another_program(self):
        self.append("README.md", "\n`ls --all`, `FLAG=1 ctest --test-dir build`, `run --force`\n")
        self.assert_clean()

    def test_option_of_another_command(self):
        self.append("README.md", "\n`toy COMMAND --radius` and `run --other`\n")
        self.assert_fault("README.md:5: --other: no such option: run")

    def test_unknown_command(self):
        self.append("README.md", "\n`toy`, `toy run all`, `toy --help`, `cat toy here`\n")
        self.assert_clean()
        self.append("README.md", "\n    FLAG=1 toy walk --radius 1\n")
        self.assert_fault("README.md:7: toy walk: no such command")

    def test_missing_option(self):
        self.write("docs/guide/commands.md", COMMANDS.replace("--engine", "engine"))
        self.assert_fault("docs/guide: --engine of toy run: not described below the heading toy run")

    def test_missing_option_below_its_heading(self):
        text = COMMANDS.replace("--force", "force")
        self.write("docs/guide/commands.md", f"{text}\n## Other\n\n`--force`\n")
        self.assert_fault("docs/guide: --force of toy run: not described below the heading toy run")

    def test_missing_option_without_a_heading(self):
        text = COMMANDS.replace("--radius", "radius").replace("## toy run", "## Run")
        self.write("docs/guide/commands.md", text)
        self.write("README.md", "`--radius`\n")
        self.assert_fault("docs/guide: --radius of toy run: not described anywhere")

    def test_codes_of_warnings_come_from_the_table(self):
        self.write("src/core/messages/message_table.hpp", '{"feet", kWarning, kScans, "In feet."},\n')
        self.write("src/a.cpp", 'log.warn(\n  "feet", x);  // "gone"\n')
        self.assert_clean()
        self.write("src/b.cpp", 'return {Message::Severity::kNote, "feet"};\n')
        self.assert_fault("src/b.cpp:1: a message that is made by hand")
        self.write("src/b.cpp", "")
        self.write("src/core/messages/message_table.hpp", '{"feet", kWarning, kScans},\n{"gone", kNote, kScans},\n')
        self.assert_fault("src/core/messages/message_table.hpp: gone: no source gives")


if __name__ == "__main__":
    unittest.main()
