"""What the executables of the nodes run: a node takes a second to load, and Ctrl-C ends it cleanly even then."""

from __future__ import annotations

import os
import signal
from importlib import import_module


def capture() -> int:
    """Run the capture node."""
    return _run("capture")


def rectification() -> int:
    """Run the rectification node."""
    return _run("rectification")


def correspondence() -> int:
    """Run the correspondence node."""
    return _run("correspondence")


def triangulation() -> int:
    """Run the triangulation node."""
    return _run("triangulation")


def calibration() -> int:
    """Run the calibration node."""
    return _run("calibration")


def stereo_pick() -> int:
    """Run the four nodes in one process."""
    return _run("stereo_pick")


def _run(node: str) -> int:
    for number in (signal.SIGINT, signal.SIGTERM):  # until the node handles them
        signal.signal(number, lambda *_: os._exit(0))
    return int(import_module(f"stereo_pick.ros.nodes.{node}").main())
