"""Names of the sources in documents: files, types, functions and constants in code spans exist, and
a list of the names of an enumeration, for users of Python, has all of them. And codes of warnings and
notes: those of the table are used, and messages get their code from it."""

import re

from . import markdown

ENDINGS = {".cpp", ".hpp", ".cu", ".cuh", ".py", ".pyi", ".js", ".css", ".html", ".sh", ".cmake",
           ".in", ".txt"}
FILE = re.compile(r"(?:[\w.-]+/)*[\w-]+\.(?:cpp|hpp|cuh?|pyi?|js|css|html|sh|cmake)")
TYPE = re.compile(r"(?:\w+::)*(?:k?[A-Z][a-z0-9]+(?:[A-Z][a-z0-9]*)+|k[A-Z]\w+)(?:(?:::|\.)\w+)*")
CALL = re.compile(r"((?:\w+(?:::|\.))*~?\w+)\((?:[^()]|\([^()]*\))*\)")
WORD = re.compile(r"[A-Za-z_]\w*")
PLACEHOLDER = re.compile(r"\bNAME(?=\b|_)|^DIR/")  # NAME_reader.hpp, DIR/index.html

NAME_OF = re.compile(r"\bname_of\((\w+) \w+\) \{\n(.*?)\n\}", re.DOTALL)
TEXT = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
LITERAL = re.compile(r'"(?:[^"\\\n]|\\.)*"(?:\s*"(?:[^"\\\n]|\\.)*")*|R"\((.*?)\)"', re.DOTALL)
QUOTED = re.compile(r"'([a-z0-9][a-z0-9-]*)'")

# That the table has every code is checked by the compiler, and that the guide agrees with it by the
# test of its tables.
SOURCES = (".cpp", ".hpp", ".cu", ".cuh")
MESSAGES = "src/core/messages/message_table.hpp"
ROW = re.compile(r'\{"([a-z0-9-]+)",\s*k(?:Note|Warning|Either)')
CODE = re.compile(r'"([a-z0-9-]+)"')
BY_HAND = re.compile(r'Severity::k(?:Note|Warning),\s*"')

LIST_FROM = 3  # so many names of an enumeration in one text are a list of them


class Names:
    """What the sources of a repository name. files: all of its files."""

    def __init__(self, root, files):
        self._root = root
        self._sources = {path: path.read_text(encoding="utf-8", errors="replace")
                         for path in sorted(files)
                         if path.suffix in ENDINGS and path.relative_to(root).parts[0] != "docs"}
        self._paths = ["/" + str(path.relative_to(root)) for path in files]
        self._words = set()
        for text in self._sources.values():
            self._words.update(WORD.findall(text))

    def unknown(self, name, blocks):
        """The code spans of a document whose names no source has."""
        for block in blocks:
            for line, code in markdown.code_spans(block):
                if not self._is_known(code.strip()):
                    yield f"{name}:{line}: {code}: no source has this name"

    def _is_known(self, code):
        if PLACEHOLDER.search(code):
            return True
        if FILE.fullmatch(code):
            own = any(path.endswith("/" + code) for path in self._paths)
            made = f'"{code.rpartition("/")[2]}"'  # a file that a program writes
            return own or any(made in text for text in self._sources.values())
        call = CALL.fullmatch(code)
        if not call and not TYPE.fullmatch(code):
            return True
        return set(WORD.findall(call[1] if call else code)) <= self._words

    def incomplete(self):
        """The texts of the Python module that list names of an enumeration, but not all of them.
        "auto" and "unknown" may be left out, because not every value of the type can be them."""
        enumerations = {}
        for path, text in self._sources.items():
            if path.suffix in (".cpp", ".hpp"):
                for of, body in NAME_OF.findall(text):
                    enumerations[of] = set(TEXT.findall(body)) - {"", "auto", "unknown"}
        for path, text in self._sources.items():
            if "python" not in path.relative_to(self._root).parts or path.suffix != ".cpp":
                continue
            for literal in LITERAL.finditer(text):
                listed = set(QUOTED.findall(literal[0]))
                for of, names in enumerations.items():
                    if LIST_FROM <= len(listed & names) < len(names):
                        line = text.count("\n", 0, literal.start()) + 1
                        missing = ", ".join(sorted(names - listed))
                        yield (f"{path.relative_to(self._root)}:{line}: a list of {of} lacks "
                               f"{missing}")


def code_problems(root, files):
    table = root / MESSAGES
    if not table.exists():
        return
    used = set()
    for path in sorted(files):
        name = str(path.relative_to(root))
        if path.suffix not in SOURCES or path == table or not name.startswith(("src/", "tools/cli/")):
            continue
        text = re.sub(r"//.*", "", path.read_text(encoding="utf-8"))
        used.update(CODE.findall(text))
        for match in BY_HAND.finditer(text):
            line = text.count("\n", 0, match.start()) + 1
            yield f"{name}:{line}: a message that is made by hand; use note() or warning() of core/messages"
    for code in ROW.findall(table.read_text(encoding="utf-8")):
        if code not in used:
            yield f"{MESSAGES}: {code}: no source gives a message with this code"
