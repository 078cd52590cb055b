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


README, GUIDE = "README.md", "docs/guide/commands.md"
TABLE = "src/core/messages/message_table.hpp"
TERMS = {"docs/design/glossary.md": GLOSSARY}
NAMES = {"src/core/sweep.hpp": "struct SweepTree { int find_all(int); };\n"
                               "inline constexpr int kMostTrees = 3;\n"
                               'const char* made = "index.html";\n'}
REASONS = {"src/answer.cpp": "const char* name_of(Reason reason) {\n  switch (reason) {\n" +
           "".join(f'    return "{name}";\n' for name in ("near", "few", "unseen", "unknown", "doubt")) +
           "  }\n}\n"}
CODES = {TABLE: '{"feet", kWarning},\n',
         "src/a.cpp": 'log.warn(\n  "feet", x);  // "gone"\n'}
COMMAND_LINE = "docs/guide/command-line.md"

# What files have besides the clean ones ("+" begins what is appended to one), and parts of the only line
# that names a fault; none where they are clean.
ROWS = [
    ({}, ()),
    ({README: "+\nOne. Two.\n" + "word " * 80 + "\n"}, ()),
    # Paths and names of the sources.
    ({**NAMES, README: "+\n`src/core`, `src/core/sweep`, `src/NAME.cpp` and `src/core/sweep.hpp`.\n"}, ()),
    ({**NAMES, README: "+\nIn `src/core/weep`.\n"}, ("src/core/weep: no such file or folder",)),
    ({**NAMES, README: "+\n`SweepTree`, `SweepTree::find_all()`, `find_all(tree)`, `kMostTrees`, `sweep.hpp`, "
                       "`core/sweep.hpp`, `out/index.html`, `NAME_reader.hpp`, `LAS`, `Clear`, "
                       "`a(b) - c(d)`.\n\n    GoneType gone.cpp\n"}, ()),
    *(({**NAMES, README: f"+\nSee `{name}`.\n"}, (f"{name}: no source has this name",)) for name in (
        "SweepTrees", "SweepTree::find_one()", "find_some()", "kMostLeaves", "sweeps.hpp")),
    ({**REASONS, "src/python/answer.cpp": "\"A list of 'near', 'few', \"\n\"'unseen' and 'doubt'.\""}, ()),
    ({**REASONS, "src/python/answer.cpp": "\n\"A list of 'near', 'few' \"\n\"and 'doubt'.\""},
     ("src/python/answer.cpp:2: a list of Reason lacks unseen",)),
    # The first table of commands.
    ({COMMAND_LINE: "# All\n\n| command | what |\n|---|---|\n| `toy run` | searches |\n"}, ()),
    ({COMMAND_LINE: "# All\n\n| command | what |\n|---|---|\n| `toy run --force` | writes |\n\n"
                    "| `toy run` | x |\n"}, ("toy run is not in the first table",)),
    # Terms.
    (TERMS, ()),
    ({**TERMS, README: "+\nOne\nof the key\nframes.\n\n    cat waypoint\n"},
     ("README.md:6: key frames: the glossary's term is: pose",)),
    ({**TERMS, GUIDE: "+\n| Waypoint |\n|---|\n"},
     ("docs/guide/commands.md:21: Waypoint: the glossary's term is: pose",)),
    ({**TERMS, "toy": PROGRAM % "Give every waypoint."},
     ("toy run --help: waypoint: the glossary's term is: pose",)),
    ({"docs/design/glossary.md": GLOSSARY.replace("| least", "| way, pose | a |\n| least")},
     ("docs/design/glossary.md:8: pose is defined in line 7 already",)),
    # Links.
    ({README: "+\nSee [this\npage](docs/guide/nothing.md).\n"},
     ("README.md:5: broken link: docs/guide/nothing.md: no such file",)),
    ({"docs/design/new.md": "# New\n\n| [a](../guide/commands.md#nothing) |\n"},
     ("docs/design/new.md:3: broken link", "no such heading")),
    ({README: "+\n[![picture](none.png)](toy)\n"}, ("README.md:5: broken link: none.png",)),
    ({README: "[a]: none.md\n"}, ("README.md:1: broken link: none.md",)),
    ({README: "+\n[web](https://example.org/x) `[a](b)` [here](#toy) [dir](docs)\n"}, ()),
    # Options and commands.
    ({README: "+\nGive\n`--nothing`.\n"}, ("README.md:6: --nothing: no such option",)),
    ({README: "+\n    ls --all | toy run --radius 1 --all\n"}, ("README.md:5: --all: no such option: toy run",)),
    ({README: "```text\nerror: take --all\n```\n"}, ("README.md:2: --all: no such option: error",)),
    ({README: "+\n`ls --all`, `FLAG=1 ctest --test-dir build`, `run --force`\n"}, ()),
    ({README: "+\n`toy COMMAND --radius` and `run --other`\n"}, ("README.md:5: --other: no such option: run",)),
    ({README: "+\n`toy`, `toy run all`, `toy --help`, `cat toy here`\n"}, ()),
    ({README: "+\n    FLAG=1 toy walk --radius 1\n"}, ("README.md:5: toy walk: no such command",)),
    ({GUIDE: COMMANDS.replace("--engine", "engine")},
     ("docs/guide: --engine of toy run: not described below the heading toy run",)),
    ({GUIDE: COMMANDS.replace("--force", "force") + "\n## Other\n\n`--force`\n"},
     ("docs/guide: --force of toy run: not described below the heading toy run",)),
    ({GUIDE: COMMANDS.replace("--radius", "radius").replace("## toy run", "## Run"), README: "`--radius`\n"},
     ("docs/guide: --radius of toy run: not described anywhere",)),
    # Codes of warnings.
    (CODES, ()),
    ({**CODES, "src/b.cpp": 'return {Message::Severity::kNote, "feet"};\n'},
     ("src/b.cpp:1: a message that is made by hand",)),
    ({**CODES, TABLE: '{"feet", kWarning},\n{"gone", kNote},\n'},
     (f"{TABLE}: gone: no source gives",)),
]


class CheckProse(unittest.TestCase):
    def test_clean_documents_pass_and_each_fault_is_named(self):
        clean = {README: "# Toy\n\nRead the [commands](docs/guide/commands.md#toy-run).\n",
                 GUIDE: COMMANDS, "toy": PROGRAM % "All is well."}
        for files, fault in ROWS:
            with self.subTest(files), tempfile.TemporaryDirectory() as folder:
                root = Path(folder)
                for name in {**clean, **files}:
                    text = files.get(name, "+")
                    text = clean.get(name, "") + text[1:] if text[:1] == "+" else text
                    (root / name).parent.mkdir(parents=True, exist_ok=True)
                    (root / name).write_text(text, encoding="utf-8")
                (root / "toy").chmod(0o755)
                done = subprocess.run([sys.executable, CHECKER, "--root", root, root / "toy"],
                                      capture_output=True, text=True, check=False)
                faults = done.stdout.splitlines()
                self.assertEqual((done.stderr, done.returncode, len(faults)),
                                 ("", bool(fault), bool(fault)), faults)
                for part in fault:
                    self.assertIn(part, faults[0])


if __name__ == "__main__":
    unittest.main()
