"""Names of version 0.1, accepted in this version with a DeprecationWarning."""

from __future__ import annotations

import warnings
from typing import Any, Dict

_KEYS = {"initialised_at": "initialized_at", "relocalisations": "relocalizations"}


def warn(old: str, now: str, level: int = 3) -> None:
    warnings.warn(f"{old} is now {now}; the old form is accepted in this version only", DeprecationWarning,
                  stacklevel=level)


class Renamed(Dict[str, Any]):
    """A dict in which renamed keys are found under the old name, too. Keys that version 0.1 wrote get the new name."""

    def __init__(self, values: Dict[str, Any]) -> None:
        super().__init__((_KEYS.get(key, key), value) for key, value in values.items())

    def __missing__(self, key: str) -> Any:
        now = _KEYS.get(key)
        if now is None or now not in self:
            raise KeyError(key)
        warn(repr(key), repr(now))
        return self[now]
