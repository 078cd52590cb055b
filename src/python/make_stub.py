#!/usr/bin/env python3
"""Writes the type stub of the module: make_stub.py FOLDER STUB

FOLDER holds the package `clearway`. Names, defaults and most types are those of the compiled part;
types of arguments are those of their checks in _arguments.py. Where the compiled part has only an
object or a text, the table TYPES has the type.
"""

import inspect
import re
import sys
import textwrap
from pathlib import Path

sys.path.insert(0, sys.argv[1])

import clearway  # noqa: E402
from clearway import _clearway  # noqa: E402
from clearway._arguments import signature_of  # noqa: E402

HEAD = '''\
from collections.abc import Callable, Iterable, Sequence
from os import PathLike
from pathlib import Path as _Path
from typing import Any, ClassVar, Final, Literal, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

_AnyPath = str | bytes | PathLike[str] | PathLike[bytes]
_Doubles = NDArray[np.float64]
_Sources = NDArray[np.uint64]
_Poses = NDArray[np.uint32]
_Flags = NDArray[np.bool_]
_Axis = Literal["+x", "x", "-x", "+y", "y", "-y", "+z", "z", "-z"]
_Progress = Callable[["ProgressUpdate"], Any]
_Tell = Callable[["Message"], Any]
class _Stop(Protocol):
    def is_set(self) -> bool: ...
__version__: str
class Error(Exception):
    remedy: str | None
    amount: float
class UsageError(Error, ValueError): ...
class InputError(Error): ...
class ResourceError(Error): ...
class Interrupted(Error): ...
'''

# Types of members, "Class.member" or a member of any class, and of what calls return, "call()".
TYPES = {
    "Message.severity": 'Literal["note", "warning"]',
    "numbers": "dict[str, float]",
    "Store.path": "_Path",
    "Section.path": "_Path",
    "busy_seconds": "dict[str, float]",
    "Answer.verdict": 'Literal["clear", "conflict", "undecided", "unknown"]',
    "SectionCheck.verdict": 'Literal["passes", "stopped", "unknown"]',
    "ReportSummary.verdict": 'Literal["clear", "conflict", "undecided"]',
    "OutsideOfAccepted.verdict": 'Literal["clear", "conflict", "undecided", "unknown"]',
    "margins": "dict[str, float] | None",
    "Body.model": "_Doubles | Model",
    "Query.model": "Any",  # any array or a Model is taken, and float64 or a Model given
    "Query.poses": "Any",
    "Ledger.counts()": "dict[str, int]",
    "Ledger.columns()": "dict[str, Any]",  # lists of texts and arrays of numbers
    "SectionReport.device": 'Literal["cpu", "cuda"]',
    "SectionCheck.reason": "str | None",
    "SectionBand.left_end": 'Literal["blocked", "not-known"] | None',
    "SectionBand.right_end": 'Literal["blocked", "not-known"] | None',
    "ReportSummary.conflicts": "Conflicts",
    "Session.__enter__": "def __enter__(self) -> Self: ...",
    "Session.__exit__": "def __exit__(self, *raised: object) -> None: ...",
}

ARRAYS = {"float64": "_Doubles", "uint64": "_Sources", "uint32": "_Poses", "bool": "_Flags"}


def type_of(call, *names):
    """What a compiled function returns, as its message about wrong arguments says."""
    for name in names:
        if name in TYPES:
            return TYPES[name]
    try:
        call(*[object()] * 9)
    except TypeError as error:
        found = re.search(r" -> (.*)$", str(error), re.M)[1]
    found = re.sub(r"\bclearway(\._clearway\.|::)", "", found)
    found = re.sub(r"float\[\d\]", "float", found)
    found = re.sub(r"\b(List|Dict|Tuple)\b", lambda name: name[0].lower(), found)
    found = re.sub(r"numpy\.ndarray\[(?:numpy\.)?(\w+)\]",
                   lambda kind: ARRAYS.get(kind[1], f"NDArray[np.{kind[1]}]"), found)
    found = re.sub(r"^Optional\[(.*)\]$", r"\1 | None", found)
    if re.search(r"\b(object|tuple|numpy\.ndarray)$|^(list|dict)$", found):
        raise SystemExit(f"make_stub.py: TYPES lacks {names[0]}, of which the module has {found}")
    return found


def argument(parameter):
    """A parameter as the stub has it."""
    if parameter.name == "self":
        return "self"
    kind = parameter.annotation.annotation
    if parameter.default is inspect.Parameter.empty:
        return f"{parameter.name}: {kind}"
    if parameter.default is None and not kind.endswith("| None"):
        kind += " | None"
    return f"{parameter.name}: {kind} = {parameter.default!r}".replace("'", '"')


def function(name, made, returned):
    """The definition of a function."""
    parts, keywords = [], False
    for parameter in signature_of(made.__wrapped__).parameters.values():
        if parameter.kind == parameter.KEYWORD_ONLY and not keywords:
            keywords = True
            parts.append("*")
        parts.append(argument(parameter))
    line = f"def {name}({', '.join(parts)}) -> {returned}: ..."
    if len(line) <= 100:
        return line
    # Commas inside of brackets stay on their lines.
    filled = textwrap.fill(", ".join(part.replace(" ", "\0") for part in parts), 94,
                           break_on_hyphens=False, break_long_words=False)
    return f"def {name}(\n{textwrap.indent(filled, '    ')},\n) -> {returned}: ...".replace("\0", " ")


def members(made):
    """The lines of a class."""
    name = made.__name__
    for member, value in vars(made).items():
        if isinstance(value, property):
            kind = type_of(value.fget, f"{name}.{member}", member)
            yield f"{member}: {kind}" if value.fset else f"{member}: Final[{kind}]"
        elif member in ("__init__", "__len__", "__enter__", "__exit__") or not member.startswith("_"):
            key = f"{name}.{member}"
            if not callable(value):
                yield f"{member}: ClassVar[{type(value).__name__}]"
            elif key in TYPES and TYPES[key].startswith("def "):
                yield TYPES[key]
            elif member == "__init__":
                if hasattr(value, "__wrapped__"):  # others are made by the module alone
                    yield function(member, value, "None")
            elif hasattr(value, "__wrapped__"):
                yield function(member, value, type_of(value.__wrapped__, key + "()", member + "()"))
            elif member == "__len__":
                yield "def __len__(self) -> int: ..."


def main():
    text = HEAD
    for name, value in vars(_clearway).items():
        if name.startswith("_") or name not in clearway.__all__:
            continue
        made = getattr(clearway, name)
        if isinstance(made, type):
            if issubclass(made, Exception):
                continue
            bases = [base.__name__ for base in made.__bases__ if base.__module__ == "clearway"]
            text += f"class {name}{f'({bases[0]})' if bases else ''}:\n"
            text += textwrap.indent("\n".join(members(made)) or "...", "    ") + "\n"
        elif callable(made):
            text += function(name, made, type_of(made.__wrapped__, name + "()")) + "\n"
        else:
            text += f"{name}: {type(value).__name__}\n"
    Path(sys.argv[2]).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
