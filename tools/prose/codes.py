"""The codes of warnings and notes: those of the table are used, and messages get their code from it.

That the table has every code is checked by the compiler (core/messages/message_table.hpp), and that
the guide agrees with the table by the test of its tables.
"""

import re

TABLE = "src/core/messages/message_table.hpp"
SOURCES = ("src", "tools/cli")
ENDINGS = (".cpp", ".hpp", ".cu", ".cuh")

ROW = re.compile(r'\{"([a-z0-9-]+)",\s*k(?:Note|Warning|Either)')
LITERAL = re.compile(r'"([a-z0-9-]+)"')
BY_HAND = re.compile(r'Severity::k(?:Note|Warning),\s*"')


def problems(root, files):
    table = root / TABLE
    if not table.exists():
        return
    used = set()
    for path in sorted(files):
        name = str(path.relative_to(root))
        if path.suffix not in ENDINGS or path == table or not name.startswith(tuple(f"{f}/" for f in SOURCES)):
            continue
        text = re.sub(r"//.*", "", path.read_text(encoding="utf-8"))
        used.update(LITERAL.findall(text))
        for match in BY_HAND.finditer(text):
            line = text.count("\n", 0, match.start()) + 1
            yield f"{name}:{line}: a message that is made by hand; use note() or warning() of core/messages"
    for code in ROW.findall(table.read_text(encoding="utf-8")):
        if code not in used:
            yield f"{TABLE}: {code}: no source gives a message with this code"
