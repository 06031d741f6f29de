"""The base of all correspondence methods.

A new method is one file in this folder: a frozen dataclass derived from `Method` whose fields, made by
`parameter`, are its parameters and whose `match` is its algorithm. The file's name is the method's name.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

from stereo_pick.core.correspondence.correspondences import Correspondences
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blobs
from stereo_pick.core.params import Configurable, parameter
from stereo_pick.core.rig import StereoRig


@dataclass(frozen=True)
class Method(Configurable, ABC):
    """Finds the objects of the left view again in the right view.

    What every method owes (test/core/correspondence/test_contract.py holds each one to it): one row a matched
    object, no object twice; an object that it cannot be sure of becomes a refusal, not a row; depths within
    min_depth_m and max_depth_m.
    """

    min_depth_m: float = parameter(0.1, "Nearest depth at which objects are looked for.", low=0.01, high=100.0)
    max_depth_m: float = parameter(10.0, "Farthest depth at which objects are looked for.", low=0.02, high=1000.0)

    def __post_init__(self) -> None:
        """Raise ParameterError on a value out of its range, or depths of which none is between them."""
        super().__post_init__()
        if self.min_depth_m >= self.max_depth_m:
            depths = f"min_depth_m = {self.min_depth_m:g} must be less than max_depth_m = {self.max_depth_m:g}"
            raise ParameterError(depths)

    @abstractmethod
    def match(self, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        """Return the matched objects of a rectified pair, and those refused."""

    def disparities_px(self, rig: StereoRig) -> tuple[float, float]:
        """Least and greatest `u_left - u_right` [px] of the depth range (eq. 1.34, plus the difference of the cx)."""
        offset = float(rig.left.P[0, 2] - rig.right.P[0, 2])
        scale = rig.focal_px * rig.baseline_m
        return scale / self.max_depth_m + offset, scale / self.min_depth_m + offset
