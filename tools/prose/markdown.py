"""Markdown as far as prose, links and options need it."""

import re

CODE_SPAN = re.compile(r"(`+)(.+?)\1", re.DOTALL)
LINK = re.compile(r"!?\[((?:[^\[\]]|\[[^\]]*\])*)\]\(\s*<?([^\s)>]*)>?(?:\s+\"[^\"]*\")?\s*\)")
REFERENCE = re.compile(r"^ {0,3}\[[^\]]+\]:\s*<?(\S+?)>?(\s|$)")
FENCE = re.compile(r"^\s*(```+|~~~+)\s*(\w*)")
HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*#*$")
LIST_ITEM = re.compile(r"^\s*([-*+]|\d+[.)])\s+")


class Block:
    """Lines of one kind: prose, table, heading, reference or code (then with its language)."""

    def __init__(self, kind, line, text, language=""):
        self.kind, self.line, self.text, self.language = kind, line, text, language


def parse(text):
    """The blocks of a Markdown file; a list item begins a block of its own."""
    blocks = [Block("blank", 0, "")]
    fence, in_list = None, False
    for number, line in enumerate(text.splitlines(), 1):
        last, marker = blocks[-1], FENCE.match(line)
        if fence:
            if marker and marker[1].startswith(fence):
                fence = None
                blocks.append(Block("blank", number, ""))
            else:
                last.text += line + "\n"
        elif marker:
            fence = marker[1]
            blocks.append(Block("code", number + 1, "", marker[2]))
        elif last.kind == "code" and (line.startswith("    ") or not line.strip()):
            last.text += line.rstrip() + "\n"
        elif last.kind == "prose" and _goes_on(line):
            last.text += "\n" + line.lstrip("> ")
        else:
            in_list = bool(LIST_ITEM.match(line)) or in_list and line[:1] in ("", " ")
            blocks.append(_block_of(number, line, in_list))
    return [block for block in blocks if block.kind != "blank"]


def _goes_on(line):
    """Whether a line continues a paragraph."""
    return line.strip() and not (HEADING.match(line) or LIST_ITEM.match(line) or
                                 REFERENCE.match(line) or line.lstrip().startswith("|"))


def _block_of(number, line, in_list):
    if not line.strip():
        return Block("blank", number, "")
    if line.startswith("    ") and not in_list:
        return Block("code", number, line + "\n")
    if heading := HEADING.match(line):
        return Block("heading", number, heading[1])
    if line.lstrip().startswith("|"):
        return Block("table", number, line)
    if REFERENCE.match(line):
        return Block("reference", number, line)
    return Block("prose", number, LIST_ITEM.sub("", line).lstrip("> "))


def code_spans(block):
    """The line and the text of each code span of a block that is no code."""
    for span in CODE_SPAN.finditer(block.text if block.kind != "code" else ""):
        yield block.line + block.text.count("\n", 0, span.start()), span[2]


def link_targets(block):
    """What the links and images of a block point to."""
    if block.kind == "code":
        return []
    if block.kind == "reference":
        return [REFERENCE.match(block.text)[1]]
    text = CODE_SPAN.sub("`code`", block.text)
    inner = [link[0] for link in LINK.findall(text)]  # an image may be the text of a link
    return [link[1] for part in [text, *inner] for link in LINK.findall(part)]


def anchors(blocks):
    """The anchors of a Markdown file, as GitHub makes them."""
    found, seen = set(), {}
    for block in blocks:
        if block.kind != "heading":
            found.update(re.findall(r"<a (?:id|name)=\"([^\"]+)\"", block.text))
            continue
        text = LINK.sub(lambda link: link[1], block.text).lower()
        slug = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
        found.add(slug if slug not in seen else f"{slug}-{seen[slug]}")
        seen[slug] = seen.get(slug, 0) + 1
    return found
