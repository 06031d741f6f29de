"""What was seen but not turned into a pose, and why: refuse, never guess."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from stereo_pick.core.arrays import Floats, floats

REASONS = {
    "faint": "differs too little from the background to be an object",
    "cut_by_border": "reaches the border of the image, so its centroid is unknown",
    "merged": "its outline has a deep notch: touching parts, a half-lit part, or a part that is not convex",
    "beside_bright": "it is dark beside a bright object: the shadow of that, its dark side, or a part that touches it",
    "half_lit": "its outline shows only a part of it: the rest is as bright as what is behind it",
    "flat": "nothing shows that it stands up: a print, a lit top, or a flat part (set flat_parts if yours are flat)",
    "off_table": "what fits it neither stands on the table (feature.table) nor can hang above it",
    "no_solid": "its top or surface (reference_point) is not known: no solid explains it, or which way is up is open",
    "other_shape": "the edges in and around its outlines are not those of the solid that fits: it is of another shape, "
    "or something is on it",
    "uncertain": "its depth is less sure than max_sigma_of_width allows: its outlines fit no solid, or not each other, "
    "or what touches it may be more of it",
    "left_only": "no object in the right view fits it",
    "right_only": "no object in the left view fits it",
    "ambiguous": "several objects of the other view fit it equally well",
    "no_texture": "its surface has too little texture to be found again by correlation (method ssd)",
    "poor_match": "what correlates best in the right view does not lead back to it, or does not look alike",
    "behind_camera": "its two rays meet behind the cameras",
    "ray_gap": "its two rays pass each other at more than max_ray_gap_m",
    "swapped": "the left and the right images are exchanged (or the calibration is wrong): "
    "the objects fit only the other way round",
    "misaligned": "the objects of one view do not fit those of the other: has a camera moved since its calibration?",
    "too_dark": "the view has so little light that no object could be told from its background",
    "saturated": "over-exposed: what is as bright as a pixel can be has no edges",
    "out_of_focus": "not even the sharpest part of its outline is sharp enough to be placed",
    "uneven": "the background varies so much that most objects could not be told from it",
    "shaded": "it is dark, no solid explains it and no table is known: its shadow may be a part of its outline",
    "low_confidence": "its position is less sure than min_confidence asks for",
    "out_of_range": "it is nearer than min_depth_m, or farther than max_depth_m",
}
"""Every reason for a refusal, and what it means."""

RIG_FAULTS = ("swapped", "misaligned")
"""Reasons that concern the rig, not one object: nothing of such a pair is believed."""


@dataclass(frozen=True, eq=False)
class Refusal:
    """Something seen in the left or in the right view, or in both, that gave no pose.

    left_px, right_px: (2,) in the rectified views [px], None where it was not seen; detail: the measured value.
    """

    reason: str
    left_px: Floats | None
    right_px: Floats | None
    detail: str = ""

    def __post_init__(self) -> None:
        if self.reason not in REASONS:
            raise ValueError(f"unknown reason {self.reason!r}; known are {', '.join(REASONS)}")
        for side in ("left_px", "right_px"):
            if getattr(self, side) is not None:
                object.__setattr__(self, side, floats(side, getattr(self, side), 2))


def count_reasons(refused: Iterable[Refusal]) -> dict[str, int]:
    """How often each reason occurs."""
    return dict(Counter(refusal.reason for refusal in refused))
