"""Prints everything that a user of the Python module sees, as one JSON object: name, and what is there.

Run as a script, in a process of its own for each build, because a process can load only one of them.
Example: PYTHONPATH=build/release/python python3 python_names.py
"""

import inspect
import json

import clearway


def description(thing):
    """What a user sees of an object besides its members: its kind, signature and docstring."""
    lines = [type(thing).__name__]
    if isinstance(thing, property):
        lines += [f"settable: {thing.fset is not None}", *_signature(thing.fget)]
    elif callable(thing):
        lines += _signature(thing)
    if inspect.isclass(thing):
        lines.append("bases: " + ", ".join(base.__name__ for base in thing.__bases__))
    elif not callable(thing) and not isinstance(thing, property):
        lines.append(f"value: {thing!r}")
    return "\n".join([*lines, inspect.getdoc(thing) or ""])


def _signature(function):
    try:
        return [f"signature: {inspect.signature(function)}"]
    except (TypeError, ValueError):  # a class or a function of C++ has it in its docstring
        return []


def names():
    """Name and description of the module, its public members, and those of its classes."""
    found = {"clearway": inspect.getdoc(clearway) or ""}
    for name in sorted(vars(clearway)):
        thing = getattr(clearway, name)
        if name.startswith("_") or inspect.ismodule(thing):
            continue
        found[f"clearway.{name}"] = description(thing)
        if inspect.isclass(thing):
            for member, value in sorted(vars(thing).items()):
                if _is_of_user(member):
                    found[f"clearway.{name}.{member}"] = description(value)
    return found


def _is_of_user(member):
    """Members of classes that come from the language rather than from Clearway are left out."""
    return not member.startswith("_") or member in (
        "__init__", "__len__", "__getitem__", "__iter__", "__enter__", "__exit__", "__eq__", "__call__")


if __name__ == "__main__":
    print(json.dumps(names(), indent=1))
