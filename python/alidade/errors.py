"""Exceptions. Each message says what is wrong, where, and what to do."""


class Error(RuntimeError):
    """Base class of all errors. ``kind``: "usage", "input", "nothing mapped" or "stopped"."""

    kind = "error"
    status = 70
    """Exit status of the program for this error."""


class UsageError(Error, ValueError):
    """An invalid argument or setting."""

    kind = "usage"
    status = 2


class InputError(Error):
    """A file, image or recording that cannot be read, used or written."""

    kind = "input"
    status = 3


class ArrayError(InputError, TypeError):
    """An array of a type or shape that its argument cannot have. The message has both."""


class NothingMapped(Error):
    """Valid input in which no frame could be tracked."""

    kind = "nothing mapped"
    status = 4


class RunStopped(Error):
    """A part of the system failed, for a reason other than the recording. Results obtained without it are written."""

    kind = "stopped"
