"""Image points of the left and of the right view that show the same object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.errors import ArrayError
from stereo_pick.core.places.extent import Extent
from stereo_pick.core.refusal import Refusal


@dataclass(frozen=True, eq=False)
class Correspondences:
    """N matched objects, and what was refused.

    left_px, right_px: (N, 2) in the rectified views [px]; sigma_px: (N, 2), one sigma of the left and of the
    right point in each direction [px], the currency in which all methods state their uncertainty; covariance:
    (N, 3, 3) [m²], rectified left frame, what adds to that of the position: both points are off together where a solid
    is; size_px: (N, 2), length and width of the object in the left rectified view [px]; direction_rad: (N,), direction
    of its length there, from the x axis towards y; extents: N, the solid that explains it, or None; turned_px: by how
    many rows the right camera has turned since its calibration, which was undone before anything was matched; moved_px:
    as of `Blobs`.
    """

    left_px: Floats
    right_px: Floats
    sigma_px: Floats
    size_px: Floats
    direction_rad: Floats
    refused: tuple[Refusal, ...] = ()
    extents: tuple[Extent | None, ...] = ()
    covariance: Floats = field(default_factory=lambda: np.zeros((0, 3, 3)))
    turned_px: float = 0.0
    moved_px: float = 0.0

    def __post_init__(self) -> None:
        count = len(self.left_px)
        for name in ("left_px", "right_px", "sigma_px", "size_px"):
            object.__setattr__(self, name, floats(name, np.reshape(getattr(self, name), (-1, 2)), count, 2))
        object.__setattr__(self, "direction_rad", floats("direction_rad", self.direction_rad, count))
        if not len(self.covariance):
            object.__setattr__(self, "covariance", np.zeros((count, 3, 3)))
        object.__setattr__(self, "covariance", floats("covariance", self.covariance, count, 3, 3))
        if not self.extents:
            object.__setattr__(self, "extents", (None,) * count)
        if len(self.extents) != count:
            raise ArrayError(f"extents has {len(self.extents)} entries, needs {count}")

    def __len__(self) -> int:
        return len(self.left_px)

    @property
    def explained(self) -> int:
        """How many a solid explains."""
        return sum(extent is not None for extent in self.extents)

    @property
    def notice(self) -> str:
        """What of the rig, the table that is given, or the learned background should be put right; empty where
        nothing."""
        if not self.turned_px:
            off_table = next((each.detail for each in self.refused if each.reason == "off_table"), "")
            return "; ".join(filter(None, (off_table, self._of_background)))
        return (
            f"objects are {self.turned_px:.1f} rows off between the views: a camera has turned since its calibration, "
            "or that is poor. Positions are corrected for it, and less sure: calibrate again"
        )

    @property
    def _of_background(self) -> str:
        if not self.moved_px:
            return ""
        if not np.isfinite(self.moved_px):
            return (
                "the views do not look like the learned background any more, so it is not used: a camera, the table, "
                "or what lies on it was moved; learn it again"
            )
        return (
            f"the views lie {self.moved_px:.1f} px beside the learned background, which is moved along: a camera or "
            "the table was pushed; learn it again"
        )


@dataclass(frozen=True, eq=False)
class Match:
    """One row of `Correspondences`."""

    left_px: Floats
    right_px: Floats
    sigma_px: tuple[float, float]
    size_px: tuple[float, float]
    direction_rad: float
    extent: Extent | None = None
    covariance: Floats = field(default_factory=lambda: np.zeros((3, 3)))


def collect(matches: Sequence[Match], refused: Sequence[Refusal]) -> Correspondences:
    """Put single matches together, in their order."""
    return Correspondences(
        left_px=np.array([match.left_px for match in matches]).reshape(-1, 2),
        right_px=np.array([match.right_px for match in matches]).reshape(-1, 2),
        sigma_px=np.array([match.sigma_px for match in matches]).reshape(-1, 2),
        size_px=np.array([match.size_px for match in matches]).reshape(-1, 2),
        direction_rad=np.array([match.direction_rad for match in matches], np.float64),
        refused=tuple(refused),
        extents=tuple(match.extent for match in matches),
        covariance=np.array([match.covariance for match in matches]).reshape(-1, 3, 3),
    )
