"""Scenes of the benchmark's families, as the pipeline reads them."""

from __future__ import annotations

from functools import cache, lru_cache

from families import staged
from family_scoring import SceneScore, score
from rendering import Truth

from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.rig import StereoRig


@cache
def found(family: str, seed: int, steps: Steps | None = None) -> SceneScore:
    """What default parameters, or these, make of a scene, against its truth."""
    rig, frame, truth = _taken(family, seed)
    return score(family, seed, Pipeline(rig, steps or Steps()), frame, truth)


@lru_cache(maxsize=12)  # scenes are read more than once by a few tests alone
def _taken(family: str, seed: int) -> tuple[StereoRig, StereoFrame, Truth]:
    scene = staged(family, seed)
    return scene.rig, *scene.taken()
