"""The scenes of the families, rendered once."""

from __future__ import annotations

from pathlib import Path

from families import staged
from rendering import Truth
from scene_cache import kept

from stereo_pick.core.frames import StereoFrame

_SOURCES = ("families", "staging", "parts", "placing")


def taken(family: str, seed: int, folder: Path | None) -> tuple[str, StereoFrame, Truth]:
    """The rig's name, the raw pair and its truth."""
    return kept(folder, f"{family}_{seed}", _SOURCES, lambda: _rendered(family, seed))


def _rendered(family: str, seed: int) -> tuple[str, StereoFrame, Truth]:
    scene = staged(family, seed)
    return scene.rig_name, *scene.taken()
