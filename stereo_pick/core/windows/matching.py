"""What window matching can be told, and when a match is believed; the same for single points and for whole images."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.params import Configurable, parameter
from stereo_pick.core.windows.texture import window_sizes
from stereo_pick.core.windows.window import COSTS

_ENOUGH = 0.5  # of max_sigma_px: from where on a wider window is not worth the depths that it mixes


@dataclass(frozen=True)
class Evidence:
    """What is known of N matches.

    sigma_px: (N,), one sigma of the place; similarity: (N,), 1 all alike, 0 nothing; within: (N,), whether it lies
    within the depth range; uniqueness: (N,), factor by which the next best place is worse; return_px: (N,), distance
    from the start at which it is found again in the first view.
    """

    sigma_px: Floats
    similarity: Floats
    within: Bools
    uniqueness: Floats
    return_px: Floats

    @classmethod
    def before_refinement(cls, uniqueness: Floats, return_px: Floats, sigma_px: float) -> Evidence:
        """Of matches at whole pixels, whose texture promises `sigma_px`."""
        like = np.ones(len(uniqueness))
        return cls(sigma_px * like, like, like > 0, uniqueness, return_px)


@dataclass(frozen=True)
class WindowMatching(Configurable):
    """How windows are compared, and from where on a match is refused."""

    cost: str = parameter(
        "zncc",
        "How windows are compared: by normalised cross-correlation, which forgives a gain and an offset between the "
        "cameras, or by the plain sum of squared differences (thesis eq. 3.8), which forgives neither: where a part "
        "has shading only, a difference of a few per cent moves its match, unnoticed.",
        choices=COSTS,
    )
    narrowest_window_px: int = parameter(7, "Width and height of the narrowest window; odd.", low=3, high=101)
    widest_window_px: int = parameter(
        23,
        "The same of the widest. Between the two, the window is the narrowest whose texture promises half of "
        "max_sigma_px and whose match is believed; the wider it is, the more depths it mixes.",
        low=3,
        high=101,
    )
    max_sigma_px: float = parameter(
        0.15, "Uncertainty of the match, by its texture and residual, from which it is refused.", low=0.01, high=2.0
    )
    min_similarity: float = parameter(
        0.5, "Part of the window's own variation that the match must explain.", low=0.0, high=1.0
    )
    min_uniqueness: float = parameter(
        1.2,
        "By what factor the next best place on the line must correlate worse. Above 1, no other place may be as alike "
        "as min_similarity either: prints that repeat are refused.",
        low=1.0,
        high=10.0,
    )
    left_right_tolerance_px: float = parameter(
        1.0, "How far the match, looked for in the left view, may come out from where it started.", low=0.05, high=10.0
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("narrowest_window_px", "widest_window_px"):
            if getattr(self, name) % 2 == 0:
                raise ParameterError(f"{name} = {getattr(self, name)} must be odd")
        if self.narrowest_window_px > self.widest_window_px:
            raise ParameterError(
                f"narrowest_window_px = {self.narrowest_window_px} must not exceed "
                f"widest_window_px = {self.widest_window_px}"
            )

    def sizes_px(self) -> list[int]:
        """The widths of the windows, from the narrowest."""
        return window_sizes(self.narrowest_window_px, self.widest_window_px)

    def enough_px(self, *, last: bool) -> float:
        """Predicted sigma [px] with which a window is tried; the `last`, widest one only must not be hopeless."""
        return self.max_sigma_px * (1.0 if last else _ENOUGH)

    def judge(self, evidence: Evidence) -> NDArray[np.str_]:
        """Why each match (N,) is refused, a reason of `refusal.REASONS`, or empty where it is believed."""
        faults = {
            "no_texture": evidence.sigma_px > self.max_sigma_px,
            "poor_match": evidence.similarity < self.min_similarity,
            "left_only": ~evidence.within,
            "ambiguous": evidence.uniqueness <= self.min_uniqueness,
        }
        astray = np.abs(evidence.return_px) > self.left_right_tolerance_px
        return np.select([*faults.values(), astray], [*faults, "poor_match"], default="")

    def detail(self, reason: str, evidence: Evidence) -> str:
        """The measured value behind the refusal of a single match."""
        similarity, return_px = float(evidence.similarity[0]), float(evidence.return_px[0])
        if reason == "no_texture":
            return f"sigma {evidence.sigma_px[0]:.2f} px"
        if reason == "poor_match" and similarity < self.min_similarity:
            return f"similarity {similarity:.2f}"
        if reason == "poor_match":
            return f"leads back {return_px:+.1f} px beside its start"
        return "fits beyond the depth range" if reason == "left_only" else ""
