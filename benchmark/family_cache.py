"""Scenes rendered once: kept on disk under a name that changes with the sources that make them."""

from __future__ import annotations

import hashlib
import pickle
from functools import cache
from pathlib import Path

import numpy as np
from families import staged
from rendering import Truth

from stereo_pick.core.frames import StereoFrame

_HERE = Path(__file__).parent
_OWN = ("families", "staging", "parts", "placing")
_SOURCES = (*sorted((_HERE / "rendering").glob("*.py")), *(_HERE / f"{name}.py" for name in _OWN))


def taken(family: str, seed: int, folder: Path | None) -> tuple[str, StereoFrame, Truth]:
    """The rig's name, the raw pair and its truth."""
    if folder is None:
        return _rendered(family, seed)
    file = folder / f"{family}_{seed}_{_digest()}.pickle"
    if file.is_file():
        rig_name, left, right, truth = pickle.loads(file.read_bytes())
        return rig_name, StereoFrame(left, right), truth
    rig_name, frame, truth = _rendered(family, seed)
    folder.mkdir(parents=True, exist_ok=True)
    part = file.with_suffix(".part")
    part.write_bytes(pickle.dumps((rig_name, frame.left, frame.right, truth)))
    part.rename(file)
    return rig_name, frame, truth


def _rendered(family: str, seed: int) -> tuple[str, StereoFrame, Truth]:
    scene = staged(family, seed)
    return scene.rig_name, *scene.taken()


@cache
def _digest() -> str:
    sources = b"".join(source.read_bytes() for source in _SOURCES)
    return hashlib.sha256(np.__version__.encode() + sources).hexdigest()[:12]
