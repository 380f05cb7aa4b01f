"""Checks of arguments, whose messages name the argument, before the extension is called."""

from __future__ import annotations

import functools
import inspect
import operator
import reprlib
from typing import TYPE_CHECKING, Any, Callable, Generic, Mapping, Optional, TypeVar

from . import _dlo
from ._errors import InputError

Function = TypeVar("Function", bound=Callable[..., Any])

Value = TypeVar("Value")

Kind = Callable[[Any], Optional[str]]
"""Function that returns None if a value is of the kind, else the reason: "what it is (allowed: ...)"."""


def _kind(allowed: str, convert: Callable[[Any], Any], *refused: type) -> Kind:
    """Returns the kind of all values that convert() accepts, except those of the refused types."""

    def problem(value: Any) -> Optional[str]:
        try:
            if not isinstance(value, refused):
                convert(value)
                return None
        except OverflowError:
            return f"out of range (allowed: {allowed} up to 1e308)"
        except UnicodeEncodeError:
            return "text with an unpaired surrogate (allowed: Unicode)"
        except Exception:  # an array, for example, has no truth value
            pass
        return f"a {type(value).__name__} (allowed: {allowed})"

    return problem


def _whole(least: int, most: int, allowed: str) -> Kind:
    kind = _kind(allowed, operator.index)
    out = f"out of range (allowed: {allowed}, up to {most})"
    return lambda value: kind(value) or (None if least <= operator.index(value) <= most else out)


def _each(kind: Kind, allowed: str) -> Kind:
    def problem(value: Any) -> Optional[str]:
        found = LIST(value) or next(filter(None, map(kind, value)), None)
        return found and f"{found.split(' (allowed', 1)[0]} (allowed: {allowed})"

    return problem


def QUANTITY(value: Any) -> Optional[str]:
    return TEXT(value) if isinstance(value, str) else _NUMBER_OR_TEXT(value)


def TABLE(value: Any) -> Optional[str]:
    return None if isinstance(value, Mapping) else f"a {type(value).__name__} (allowed: a dict)"


NUMBER = _kind("a number", float, str, bytes)
_NUMBER_OR_TEXT = _kind('a number, or text such as "2 mm"', float, bytes)
TEXT = _kind("text", str.encode)
TRUTH = _kind("True or False", bool)
LIST = _kind("a list", iter, str, bytes)
TEXTS = _each(TEXT, "a list of text")
NUMBERS = _each(NUMBER, "a list of numbers")
INTEGER = _whole(-(2**31), 2**31 - 1, "an integer")
COUNT = _whole(-(2**63), 2**63 - 1, "an integer")
INDEX = _whole(0, 2**63 - 1, "an integer from 0")


def require(key: str, value: Any, kind: Kind) -> None:
    """Raises InputError with key, value and what is allowed, unless the value is of the kind."""
    problem = kind(value)
    if problem is None:
        return
    try:
        shown = reprlib.repr(value)
    except Exception:  # __repr__ may raise any exception
        shown = "?"
    raise InputError(f"{key} = {shown}: {problem}")


_BY_ANNOTATION = {
    "str": TEXT,
    "int": INTEGER,
    "float": NUMBER,
    "bool": TRUTH,
    "Quantity": QUANTITY,
    "Sequence[str]": TEXTS,
    "Sequence[float]": NUMBERS,
}
_BY_ANNOTATION.update({f"Optional[{name}]": kind for name, kind in _BY_ANNOTATION.items()})
_CONVERTED: dict[Kind, Callable[[Any], Any]] = {
    TRUTH: bool,
    NUMBER: float,
    TEXTS: list,
    NUMBERS: lambda values: list(map(float, values)),
}


def checked(**kinds: Kind) -> Callable[[Function], Function]:
    """Checks and converts a function's arguments before each call, by their kinds.

    kinds: kinds of arguments whose annotation does not determine it. None is accepted where it is the default.
    """

    def decorate(function: Function) -> Function:
        signature = inspect.signature(function)
        found = {key: kinds.get(key, _BY_ANNOTATION.get(one.annotation)) for key, one in signature.parameters.items()}

        @functools.wraps(function)
        def call(*arguments: Any, **named: Any) -> Any:
            bound = signature.bind(*arguments, **named)
            given = bound.arguments
            for key, kind in found.items():
                if kind is None or key not in given or given[key] is signature.parameters[key].default:
                    continue
                require(key, given[key], kind)
                given[key] = _CONVERTED.get(kind, lambda value: value)(given[key])
            return function(*bound.args, **bound.kwargs)

        return call  # type: ignore[return-value]

    return decorate


class Attribute(property, Generic[Value]):
    """A property whose value has a type."""

    if TYPE_CHECKING:

        def __get__(self, instance: Any, owner: Optional[type] = None, /) -> Value: ...


class Strict:
    """Base of classes whose objects have only the attributes of their class."""

    if TYPE_CHECKING:  # attributes for the keys of a scene file are made when the module is imported

        def __getattr__(self, name: str) -> Any: ...

    def _no_field(self, name: str) -> str:
        fields = [key for key in dir(type(self)) if isinstance(getattr(type(self), key), property)]
        near = _dlo.did_you_mean(name, fields)
        return f"a dlo.{type(self).__name__} has no {name}{near} (allowed: {', '.join(fields)})"

    def __setattr__(self, name: str, value: Any) -> None:
        if name[0] != "_":
            known = getattr(type(self), name, None)
            if known is None or callable(known):
                raise AttributeError(self._no_field(name))
            if isinstance(known, property) and known.fset is None:
                raise AttributeError(f"{name} of a dlo.{type(self).__name__} is derived (allowed: to read it)")
        object.__setattr__(self, name, value)


def told(method: Function, **kinds: Kind) -> Function:
    """Wraps a method of the extension that may be called a thousand times per second. Only after it has refused
    its arguments are they checked, in the order of these kinds, to name the wrong one."""

    @functools.wraps(method)
    def call(self: Any, *arguments: Any, **named: Any) -> Any:
        try:
            return method(self, *arguments, **named)
        except TypeError:
            for key, value in [*zip(kinds, arguments), *named.items()]:
                if key in kinds:
                    require(key, value, kinds[key])
            raise

    return call  # type: ignore[return-value]
