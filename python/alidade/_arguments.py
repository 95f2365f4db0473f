"""Checks of arguments. Messages name the argument and say what it is, without its content."""

from __future__ import annotations

import functools
import inspect
import numbers
from typing import Any, Callable, Iterable, TypeVar, cast

from . import _core

Function = TypeVar("Function", bound=Callable[..., Any])


def described(value: Any) -> str:
    """ "an array (240, 320) of uint8", "a list"; short values as they are written."""
    if hasattr(value, "dtype") and hasattr(value, "shape"):
        return f"an array {tuple(value.shape)} of {value.dtype}"
    if value is None or isinstance(value, (bool, int, float, str, bytes)):
        return repr(value)
    return f"a {type(value).__name__}"


def number(name: str, value: Any) -> float:
    """The value as a float; NumPy's numbers, and arrays of one, are numbers, too. Raises TypeError."""
    if isinstance(value, (str, bytes)) or getattr(value, "shape", ()) != ():
        raise TypeError(f"{name} must be a number, not {described(value)}")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} must be a number, not {described(value)}") from None


def integer(name: str, value: Any) -> int:
    """The value as an int. Raises TypeError."""
    if isinstance(value, numbers.Integral):
        return int(value)
    try:
        return int(value.__index__())
    except (AttributeError, TypeError):
        raise TypeError(f"{name} must be a whole number, not {described(value)}") from None


def text(name: str, value: Any) -> str:
    """The value, which must be a str. Raises TypeError."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a str, not {described(value)}")
    return value


def meant(written: str, known: Iterable[str]) -> str:
    """ "; did you mean 'semidense'?", or nothing."""
    near = _core.nearest_name(written, list(known))
    return f"; did you mean {near!r}?" if near else ""


def suggesting(function: Function) -> Function:
    """A function whose error for an unknown argument names the one that was meant."""
    known = [name for name in inspect.signature(function).parameters if not name.startswith("_")]

    @functools.wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        for name in named:
            if name not in known:
                raise TypeError(f"{function.__name__}() has no argument {name!r}{meant(name, known)}")
        return function(*arguments, **named)

    return cast(Function, call)
