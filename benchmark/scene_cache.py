"""Scenes rendered once: kept on disk under a name that changes with the sources that make them."""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import TypeVar

import numpy as np
from rendering import Truth

from stereo_pick.core.frames import StereoFrame

_HERE = Path(__file__).parent
Rig = TypeVar("Rig")


def kept(
    folder: Path | None, name: str, sources: Sequence[str], make: Callable[[], tuple[Rig, StereoFrame, Truth]]
) -> tuple[Rig, StereoFrame, Truth]:
    """A rig (or its name), the raw pair and its truth, made where no folder keeps them; sources: modules beside this
    one, or packages, besides `rendering`."""
    if folder is None:
        return make()
    file = folder / f"{name}_{_digest(tuple(sources))}.pickle"
    if file.is_file():
        rig, left, right, truth = pickle.loads(file.read_bytes())
        return rig, StereoFrame(left, right), truth
    rig, frame, truth = make()
    folder.mkdir(parents=True, exist_ok=True)
    part = file.with_suffix(".part")
    part.write_bytes(pickle.dumps((rig, frame.left, frame.right, truth)))
    part.rename(file)
    return rig, frame, truth


@cache
def _digest(sources: tuple[str, ...]) -> str:
    names = ("rendering", *sources)
    files = [file for name in names for file in (sorted((_HERE / name).glob("*.py")) or [_HERE / f"{name}.py"])]
    texts = b"".join(file.read_bytes() for file in files)
    return hashlib.sha256(np.__version__.encode() + texts).hexdigest()[:12]
