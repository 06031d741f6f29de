"""Warnings on stderr."""

from __future__ import annotations

import sys


def warn(*texts: str) -> None:
    """Print each as a line, but empty ones."""
    for text in filter(None, texts):
        print(f"stereo-pick: warning: {text}", file=sys.stderr)
