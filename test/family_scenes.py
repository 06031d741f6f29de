"""Scenes of the benchmark's families, as the pipeline reads them."""

from __future__ import annotations

from functools import cache

from families import staged
from family_scoring import SceneScore, score

from stereo_pick.core.pipeline import Pipeline, Steps


@cache
def found(family: str, seed: int, steps: Steps | None = None) -> SceneScore:
    """What default parameters, or these, make of a scene, against its truth."""
    scene = staged(family, seed)
    return score(family, seed, Pipeline(scene.rig, steps or Steps()), *scene.taken())
