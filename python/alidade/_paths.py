"""Paths in the form that the library takes: bytes, since file names may have any encoding."""

import os

from ._arguments import described
from .errors import UsageError


def coded(path: "os.PathLike[str] | os.PathLike[bytes] | str | bytes", argument: str = "path") -> bytes:
    """The path as bytes. Raises UsageError for a name that no file can have, TypeError for what is no path."""
    if not isinstance(path, (str, bytes, os.PathLike)):
        raise TypeError(f"{argument} must be a path (str, bytes or os.PathLike), not {described(path)}")
    try:
        name = os.fsencode(path)
    except UnicodeEncodeError:
        raise UsageError(f"{path!r} cannot be the name of a file: it has no encoding") from None
    if b"\0" in name:
        raise UsageError(f"{path!r} cannot be the name of a file: it contains a zero byte")
    return name


def decoded(path: "os.PathLike[str] | os.PathLike[bytes] | str | bytes") -> str:
    """The path as text, in which other encodings than UTF-8 are surrogate escapes."""
    return os.fsdecode(coded(path))
