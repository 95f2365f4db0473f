"""Passes the library's warnings to `logging`, between two calls."""

import logging

from . import _core

logger = logging.getLogger("alidade")


def tell_warnings() -> None:
    for text in _core.take_warnings():
        logger.warning("%s", text)
