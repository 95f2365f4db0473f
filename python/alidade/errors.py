"""What can go wrong. The message says what, where, and what to do about it."""


class Error(RuntimeError):
    """Anything the library refuses. ``kind``: "usage", "input", "nothing mapped" or "stopped"."""

    kind = "error"
    status = 70
    """Exit status of the program for the same."""


class UsageError(Error, ValueError):
    """An argument or setting that cannot be."""

    kind = "usage"
    status = 2


class InputError(Error):
    """A file, image or recording that cannot be read, used or written."""

    kind = "input"
    status = 3


class NothingMapped(Error):
    """Good input in which nothing could be tracked."""

    kind = "nothing mapped"
    status = 4


class RunStopped(Error):
    """A part of the system stopped by no fault of the recording's; what could be done without it is written."""

    kind = "stopped"
