"""Arguments of the public calls: each is checked before the compiled part gets it.

The compiled part describes a call that does not fit by listing the C++ types of all parameters,
which names no culprit. So every public call, constructor and property is wrapped here: it takes
arguments as a Python function of its signature does, converts numbers of any type, and says which
argument is wrong. The signatures of the compiled part name the check of each parameter, and it gets
all of them by name. What remains to be said of values and arrays, the library says.
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


@_of_type("float")
def _finite(name, value):
    try:
        if isinstance(value, (bool, str, bytes)):
            raise TypeError
        number = float(value)  # numpy scalars of any width, Decimal and Fraction too
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name}: expected a number, {_found(value)}") from None
    if not math.isfinite(number):
        raise UsageError(f"{name}: expected a finite number, {_found(value)}")
    return number


def _limited(words, fits):
    @_of_type("float")
    def check(name, value):
        number = _finite(name, value)
        if not fits(number):
            raise UsageError(f"{name}: expected {words}, {_found(value)}")
        return number
    return check


_at_least_0 = _limited("0 or a number above it", lambda number: number >= 0)
_above_0 = _limited("a number above 0", lambda number: number > 0)


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


# The checks by the names that the signatures of the compiled part have for them.
_KINDS = {
    **{name: _kind(kind) for name, kind in vars(_clearway).items() if isinstance(kind, type)},
    "Flag": _flag,
    "Text": _text,
    "AxisName": _of_type("_Axis")(lambda name, value: _text(name, value)),
    "OneOf": _one_of,
    "Number": _finite,
    "From0": _at_least_0,
    "Above0": _above_0,
    "Whole": _whole,
    "Int": _whole(2**31 - 1),
    "Count": _whole(2**64 - 1),
    "Unit": _or_name(_at_least_0),
    "EnvironmentUnit": _or_name(_above_0),
    "Vector": _of_type("Sequence[float]")(_tuple_of(3, _finite, "three numbers x, y and z")),
    "Window": _tuple_of(4, _finite, "four numbers, y from and to, and z from and to"),
    "Pivots": _tuple_of(2, _finite, "two numbers, the front pivot and the rear one"),
    "Lateral": _of_type("Sequence[float]")(_tuple_of(
        2, _finite, "two numbers of metres, the shift farthest to the right and to the left")),
    "Part": _tuple_of(2, _whole(2**32 - 1), "a pair (i, n)"),
    "Path": _path,
    "Paths": _paths,
    "OrNone": _or_none,
    "Each": _each,
    "Array": _anything,
    "Outline": _of_type("_Doubles | Sequence[Sequence[float]]")(lambda _name, value: value),
    "ArrayOrModel": _of_type("ArrayLike | Model")(lambda _name, value: value),
    "Tower": _of_type('Body | Literal["path"]')(lambda _name, value: value),
    "Progress": _of_type("_Progress")(lambda name, value: _callable(name, value)),
    "Tell": _of_type("_Tell")(lambda name, value: _callable(name, value)),
    "Stop": _of_type("_Stop")(_having("is_set")),
    "Messages": _of_type("Iterable[Message]")(_each(_kind(_clearway.Message))),
    "Notes": _of_type("list[Message]")(_having("append")),
}


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


def signature_of(function):
    """As the docstring of the compiled function begins, with a check as the annotation of each
    parameter; without one it takes nothing."""
    text = getattr(function, "__text_signature__", None) or "(self)"
    scope = dict(_KINDS)
    exec(f"def signature{text}: pass", scope)  # our own text, which holds literals and checks alone
    return inspect.signature(scope["signature"])


def checked(call, function):
    """The compiled function, which says which argument is wrong. call: its name for people."""
    signature = signature_of(function)
    checks = {name: parameter for name, parameter in signature.parameters.items() if name != "self"}

    @functools.wraps(function)
    def wrapped(*args, **named):
        _refuse_unknown(call, signature, named)
        try:
            bound = signature.bind(*args, **named)
        except TypeError as error:
            raise TypeError(f"{call}(): {error}") from None
        given = bound.arguments
        for name, parameter in checks.items():
            if name not in given:
                given[name] = parameter.default
            elif given[name] is not None or parameter.default is not None:
                given[name] = parameter.annotation(name, given[name])
        return function(*(given.pop("self"),) if "self" in given else (), **given)

    wrapped.__signature__ = signature.replace(parameters=[
        parameter.replace(annotation=parameter.empty) for parameter in signature.parameters.values()])
    return wrapped


# A property is checked as the argument of a Query with its name, also that of a Body.
_PROPERTIES = signature_of(_clearway.Query.__init__).parameters


def _checked_property(name, compiled):
    check = _PROPERTIES[name].annotation

    def assign(self, value):
        compiled.fset(self, check(name, value))
    return property(compiled.fget, assign, doc=compiled.__doc__)


def check_class(made):
    """Checks the constructor, the methods and the properties of a compiled class."""
    for name, member in list(vars(made).items()):
        if isinstance(member, property):
            if member.fset is not None:
                setattr(made, name, _checked_property(name, member))
        elif hasattr(member, "__objclass__"):
            continue  # of a class whose objects only the module makes
        elif name == "__init__" or (callable(member) and not name.startswith("_")):
            call = made.__name__ if name == "__init__" else f"{made.__name__}.{name}"
            setattr(made, name, checked(call, member))
