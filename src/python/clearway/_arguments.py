"""Arguments of the public calls: each is checked before the compiled part gets it.

The compiled part describes a call that does not fit by listing the C++ types of all parameters,
which names no culprit. So every public call, constructor and property is wrapped here: it takes
arguments as a Python function of its signature does, converts numbers of any type, and says which
argument is wrong. The compiled part describes for each call how the parameters are checked that are
members of its options; every other parameter of one name means the same in every call, so that one
table serves them all. What remains to be said of values and arrays, the library says.
"""

import difflib
import functools
import inspect
import math
import operator
import os
import reprlib

from . import _clearway
from ._clearway import UsageError


def _of_type(annotation):
    """Gives a check the type that the stub has for its arguments."""
    def name_type(check):
        check.annotation = annotation
        return check
    return name_type


def _found(value):
    return "found " + reprlib.repr(value)


def _number(name, value):
    try:
        if isinstance(value, (bool, str, bytes)):
            raise TypeError
        return float(value)  # numpy scalars of any width, Decimal and Fraction too
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name}: expected a number, {_found(value)}") from None


@_of_type("float")
def _finite(name, value):
    number = _number(name, value)
    if not math.isfinite(number):
        raise UsageError(f"{name}: expected a finite number, {_found(value)}")
    return number


@_of_type("float")
def _at_least_0(name, value):
    number = _finite(name, value)
    if number < 0:
        raise UsageError(f"{name}: expected 0 or a number above it, {_found(value)}")
    return number


@_of_type("float")
def _above_0(name, value):
    number = _finite(name, value)
    if not number > 0:
        raise UsageError(f"{name}: expected a number above 0, {_found(value)}")
    return number


def _or_name(check):
    """A number of metres, or the name of a unit, which the compiled part knows."""
    return _of_type("float | str")(
        lambda name, value: value if isinstance(value, str) else check(name, value))


def _or_none(check):
    return _of_type(f"{check.annotation} | None")(
        lambda name, value: None if value is None else check(name, value))


def _whole(most, least=0):
    def check(name, value):
        try:
            if isinstance(value, bool):
                raise TypeError
            number = int(value) if hasattr(value, "is_integer") and value.is_integer() else (
                operator.index(value))  # 4e9 is a whole number too
        except (TypeError, ValueError, OverflowError):
            raise TypeError(f"{name}: expected a whole number, {_found(value)}") from None
        if not least <= number <= most:
            raise UsageError(f"{name}: expected {least} to {most}, {_found(value)}")
        return number
    return _of_type("int")(check)


@_of_type("bool")
def _flag(name, value):
    if isinstance(value, (str, bytes)) or value not in (False, True):
        raise TypeError(f"{name}: expected True or False, {_found(value)}")
    return bool(value)


@_of_type("str")
def _text(name, value):
    if not isinstance(value, str):
        raise TypeError(f"{name}: expected a text, {_found(value)}")
    return value


@_of_type("_AnyPath")
def _path(name, value):
    try:
        os.fspath(value)
    except TypeError:
        raise TypeError(f"{name}: expected a path, as str, bytes or os.PathLike, "
                        f"{_found(value)}") from None
    return value


@_of_type("_AnyPath | Iterable[_AnyPath]")
def _paths(name, value):
    if isinstance(value, (str, bytes, os.PathLike)):
        return value
    return _each(_path)(name, value)


def _kind(kind):
    def check(name, value):
        if not isinstance(value, kind):
            raise TypeError(f"{name}: expected a clearway.{kind.__name__}, {_found(value)}")
        return value
    return _of_type(kind.__name__)(check)


def _each(check):
    """A list, or anything else that gives its elements, none of which is a text's letter."""
    def check_all(name, value):
        try:
            if isinstance(value, (str, bytes)):
                raise TypeError
            elements = list(value)
        except TypeError:
            raise TypeError(f"{name}: expected a list, {_found(value)}") from None
        return [check(f"{name}[{i}]", element) for i, element in enumerate(elements)]
    return _of_type(f"Sequence[{check.annotation}]")(check_all)


def _tuple_of(count, check, words):
    def check_all(name, value):
        elements = _each(check)(name, value)
        if len(elements) != count:
            raise UsageError(f"{name}: expected {words}, {_found(value)}")
        return tuple(elements)
    return _of_type(f"tuple[{', '.join([check.annotation] * count)}]")(check_all)


@_of_type("Callable")
def _callable(name, value):
    if not callable(value):
        raise TypeError(f"{name}: expected a function, {_found(value)}")
    return value


def _having(method):
    def check(name, value):
        if not callable(getattr(value, method, None)):
            raise TypeError(f"{name}: expected an object that has {method}(), {_found(value)}")
        return value
    return check


@_of_type("ArrayLike")
def _anything(_name, value):
    """Arrays, which the compiled part converts and refuses by name."""
    return value


def _one_of(*names):
    """A text, of which the compiled part knows the choices."""
    return _of_type(f"Literal{list(names)}")(lambda name, value: _text(name, value))


def _described(kind, *limits):
    """The check of an argument that the compiled part describes, from the list of its fields."""
    if kind == "flag":
        return _flag
    if kind == "choice":
        return _one_of(*limits[0])
    if kind == "number":
        return {"any": _finite, "from 0": _at_least_0, "above 0": _above_0}[limits[0]]
    if kind == "optional":
        return _or_none(_described("number", *limits))
    if kind == "whole":
        return _whole(limits[0])
    if kind == "text":
        return _text
    if kind == "path":
        return _path
    if kind == "unit":
        return _or_name(_at_least_0)
    if kind == "vector":
        return _of_type("Sequence[float]")(_tuple_of(3, _finite, "three numbers x, y and z"))
    if kind == "boxes":
        return _each(_kind(_clearway.Box))
    return _each(_described(*limits[0]))


_messages = _each(_kind(_clearway.Message))
_model = _of_type("ArrayLike | Model")(lambda _name, value: value)

_DESCRIBED = {call: {name: _described(*check) for name, check in checks.items()}
              for call, checks in _clearway._checks.items()}
_CHECKS = {
    **{name: check for checks in _DESCRIBED.values() for name, check in checks.items()},
    **dict.fromkeys(("step", "rail_distance", "length", "width", "corner_radius", "track"),
                    _above_0),
    "environment_unit": _or_name(_above_0),
    **dict.fromkeys(("max_gap", "split", "every", "band"), _at_least_0),
    **dict.fromkeys(("at", "chainage_start", "station_from",
                     "station_to", "height", "rear", "front", "base"), _finite),
    **dict.fromkeys(("max_points", "min_points"), _whole(2**64 - 1)),
    **dict.fromkeys(("reverse", "mirror"), _flag),
    "cant": _one_of("file", "none", "center", "inside-rail", "outside-rail", "left-rail",
                    "right-rail"),
    "order": _one_of("ne", "en"),
    "table": _one_of("bands", "stations", "boxes", "cells", "bin-cells", "unknown-cells",
                     "unknown-bin-cells"),
    **dict.fromkeys(("name", "title", "project", "client", "author", "date", "result_name",
                     "environment_name", "model_name", "trajectory_name", "alignment", "ledger_name",
                     "environment_crs"), _text),
    **dict.fromkeys(("path", "file", "output", "ledger"), _path),
    **dict.fromkeys(("inputs", "parts"), _paths),
    **dict.fromkeys(("poses", "points", "vertices", "triangles", "path_pose", "lo", "hi",
                     "outline"), _anything),
    "model": _model,
    "towed_by": _of_type('Body | Literal["path"]')(lambda _name, value: value),
    "progress": _of_type("_Progress")(lambda name, value: _callable(name, value)),
    "message": _of_type("_Tell")(lambda name, value: _callable(name, value)),
    **dict.fromkeys(("warnings", "input_warnings"), _of_type("Iterable[Message]")(_messages)),
    "stop": _of_type("_Stop")(_having("is_set")),
    "messages": _of_type("list[Message]")(_having("append")),
    "classes": _each(_finite),
    "shard": _tuple_of(2, _whole(2**32 - 1), "a pair (i, n)"),
    "window": _tuple_of(4, _finite, "four numbers, y from and to, and z from and to"),
    "pivots": _tuple_of(2, _finite, "two numbers, the front pivot and the rear one"),
    "lateral": _of_type("Sequence[float]")(_tuple_of(
        2, _finite, "two numbers of metres, the shift farthest to the right and to the left")),
    "bodies": _each(_kind(_clearway.Body)),
    "labels": _kind(_clearway.PoseLabels),
    "shifts": _kind(_clearway.ShiftTable),
    **dict.fromkeys(("store", "ground"), _kind(_clearway.Store)),
    "result": _kind(_clearway.Result),
    "query": _kind(_clearway.Query),
    "section": _kind(_clearway.Section),
}
# Poses, where elsewhere it is a file; a name, where elsewhere it is a length.
_OF_CALL = {("follow", "path"): _anything, ("unsearched_stretches", "path"): _anything,
            ("write_report", "ledger"): _kind(_clearway.Ledger),
            ("read_alignment", "profile"): _text, ("box_model", "height"): _above_0,
            ("Section.symmetric_width", "band"): _kind(_clearway.SectionBand)}


def _check_of(call, name):
    return (_OF_CALL.get((call, name)) or _DESCRIBED.get(call, {}).get(name)
            or _CHECKS.get(name, _anything))


# What the command line calls an argument that is named otherwise here.
_MEANT = {"force": "overwrite", "env": "store", "environment": "store", "trajectory": "poses",
          "vehicle": "bodies", "memory": "memory_bytes", "device_memory": "device_memory_bytes"}


def _refuse_unknown(call, signature, named):
    known = [n for n in signature.parameters if n != "self"]
    for name in named:
        if name in known:
            continue
        near = [_MEANT[name]] if _MEANT.get(name) in known else difflib.get_close_matches(name, known, 1)
        raise TypeError(f"{call}() has no argument '{name}'"
                        + (f"; did you mean '{near[0]}'?" if near else ""))


def _signature_of(function):
    """As the docstring of the compiled function begins; without one it takes nothing."""
    text = getattr(function, "__text_signature__", None) or "(self)"
    scope = {}
    exec(f"def signature{text}: pass", scope)  # our own text, which holds literals alone
    return inspect.signature(scope["signature"])


def checked(call, function):
    """The compiled function, which says which argument is wrong. call: its name for people."""
    signature = _signature_of(function)

    @functools.wraps(function)
    def wrapped(*args, **named):
        _refuse_unknown(call, signature, named)
        try:
            bound = signature.bind(*args, **named)
        except TypeError as error:
            raise TypeError(f"{call}(): {error}") from None
        for name, value in bound.arguments.items():
            default = signature.parameters[name].default
            if name == "self" or (value is None and default is None):
                continue
            bound.arguments[name] = _check_of(call, name)(name, value)
        return function(*bound.args, **bound.kwargs)

    wrapped.__signature__ = signature
    return wrapped


def _checked_property(owner, name, compiled):
    def assign(self, value):
        compiled.fset(self, _check_of(owner, name)(name, value))
    return property(compiled.fget, assign, doc=compiled.__doc__)


def check_class(made):
    """Checks the constructor, the methods and the properties of a compiled class."""
    for name, member in list(vars(made).items()):
        if isinstance(member, property):
            if member.fset is not None:
                setattr(made, name, _checked_property(made.__name__, name, member))
        elif hasattr(member, "__objclass__"):
            continue  # of a class whose objects only the module makes
        elif name == "__init__" or (callable(member) and not name.startswith("_")):
            call = made.__name__ if name == "__init__" else f"{made.__name__}.{name}"
            setattr(made, name, checked(call, member))
