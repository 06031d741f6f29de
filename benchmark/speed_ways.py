"""The ways from a rectified pair to positions whose times are compared."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import cv2
import thesis_program
from rivals import WORKING_DEPTH_M, DenseStereo

from stereo_pick.core.arrays import Image
from stereo_pick.core.correspondence import Method
from stereo_pick.core.correspondence.ssd import Ssd
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.pipeline import Steps

OURS, FLOOR = "`feature`", "floor: twice (threshold and `findContours`)"

_SEMI_GLOBAL_PX = 1920 * 1080  # on larger images it takes minutes


@dataclass(frozen=True)
class Way:
    """What is done to a rectified pair, step by step: each step gets what the one before it returned."""

    name: str
    steps: dict[str, Callable[[Any], Any]]


def ways(pair: RectifiedPair) -> list[Way]:
    """All that are compared on this pair."""
    labels, contours = thesis_program.by_labels, thesis_program.by_contours
    near, far = WORKING_DEPTH_M
    dense = partial(DenseStereo, min_depth_m=near, max_depth_m=far)
    semi_global = [
        Way("SGBM 3-way and outlines", {"all": _package(dense(matcher="sgbm_3way"))}),
        Way("SGBM and outlines", {"all": _package(dense(matcher="sgbm"))}),
    ]
    return [
        Way(FLOOR, {"all": partial(_floor, (_otsu(pair.left), _otsu(pair.right)))}),
        Way(OURS, _stepwise(Steps())),
        Way("`ssd`", {"all": _package(Ssd())}),
        Way("thesis: feature mode", {"all": partial(thesis_program.feature, labels)}),
        Way("thesis: feature mode, from contours alone", {"all": partial(thesis_program.feature, contours)}),
        Way("thesis: modified SSD", {"all": partial(thesis_program.modified_ssd, labels)}),
        Way("thesis: modified SSD, from contours alone", {"all": partial(thesis_program.modified_ssd, contours)}),
        Way("StereoBM and outlines", {"all": _package(dense(matcher="bm"))}),
        *(semi_global if pair.left.size <= _SEMI_GLOBAL_PX else ()),
    ]


def _otsu(image: Image) -> float:
    return cv2.threshold(image, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)[0]


def _floor(levels: tuple[float, float], pair: RectifiedPair) -> None:
    """The least that finding objects by their outlines can cost, at levels that are known."""
    for image, level in zip((pair.left, pair.right), levels):
        _, mask = cv2.threshold(image, level, 255, cv2.THRESH_BINARY)
        cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)


def _stepwise(steps: Steps) -> dict[str, Callable[[Any], Any]]:
    """The package's own steps, with what each needs."""
    return {
        "objects": lambda pair: (pair, steps.detector.detect(pair)),
        "matching": lambda found: (found[0], steps.matched(*found)),
        "positions": lambda matched: steps.locate(matched[1], matched[0].rig, matched[0].stamp_ns),
    }


def _package(method: Method) -> Callable[[RectifiedPair], Any]:
    steps = Steps(method=method)
    return lambda pair: steps.locate(steps.correspond(pair)[1], pair.rig, pair.stamp_ns)
