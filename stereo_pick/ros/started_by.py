"""Nodes that end with the process that started them, however that one ended: nobody else would end them, and they would
go on publishing poses."""

from __future__ import annotations

import os

_VARIABLE = "STEREO_PICK_STARTED_BY"


def ending_with_this_process() -> dict[str, str]:
    """The environment variable for processes to start."""
    return {_VARIABLE: str(os.getpid())}


def is_orphaned() -> bool:
    """Whether this process was to end with the one that started it, and that one is gone."""
    return os.environ.get(_VARIABLE, str(os.getppid())) != str(os.getppid())
