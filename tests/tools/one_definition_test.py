"""No two headers define types of one name in one namespace: the program that is linked with both
would use the functions of one for the other.

one_definition_test.py
"""

import collections
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TOKEN = re.compile(r"namespace\s*([\w:]*)\s*\{|\b(?:struct|class)\s+(\w+)\s*(?:final\s*)?(?::[^;{]*)?\{|\{|\}")


def types_of(text):
    """The names of the types that a header defines outside of other types and of functions."""
    open_braces = []  # the namespace that each open brace begins, or None
    for found in TOKEN.finditer(re.sub(r"//[^\n]*", "", text)):
        if found[0] == "}":
            open_braces.pop()
            continue
        if found[2] and None not in open_braces:
            yield "::".join([*open_braces, found[2]])
        open_braces.append(found[1] if found[0].startswith("namespace") else None)


class OneDefinition(unittest.TestCase):
    def test_types_of_one_name_are_one_type(self):
        self.assertEqual(list(types_of("namespace a { struct B { class C {}; }; } struct D : E {};")), ["a::B", "D"])
        headers = collections.defaultdict(list)
        for folder in ("include", "src", "tools"):
            for header in sorted((ROOT / folder).rglob("*.hpp")):
                for name in types_of(header.read_text()):
                    headers[name].append(str(header.relative_to(ROOT)))
        self.assertGreater(len(headers), 500)
        self.assertEqual({name: files for name, files in headers.items() if len(files) > 1}, {})


unittest.main()
