"""A right camera that has turned a little since its calibration: how far, and the views as if it had not.

A bump or warmth turns a camera by a milliradian or two. Its rows are then no longer those of the left view, and no
solid explains both outlines of a part. Turns about its x axis (pitch) and its z axis (roll) show in the rows at which
outlines begin and end. One about its y axis shifts the columns alone, as another depth does: nothing tells how far.
It is taken to be as large as what shows, and goes into the sigma of all points.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence.correspondences import Correspondences
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.correspondence.rig_check import fitting_pairs
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.objects.blob import SHARP
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.refinement import bounded, tukey
from stereo_pick.core.shapes.sight import normalized, turning

_END_PX = np.array(0.1)  # by which light and noise move the end of an outline in one view against the other
_AGREEING = 3.0  # of these, within which ends tell of one turn
_USUAL_RAD = 0.002  # a turn, before the ends are asked
_LOOSE = np.eye(2) * (_END_PX / _USUAL_RAD) ** 2
_SURELY = 13.8  # chi-square of two degrees of freedom that chance exceeds once in a thousand times
_MOST_ENDS = 40  # that are asked two and two
_UNKNOWNS = 2  # of a turn
_ROUNDS = 5


@dataclass(frozen=True, eq=False)
class Turn:
    """How a camera has turned, in its rectified view.

    pitch_rad, roll_rad: about its x and z axis; offset_px: by how many rows that moves the objects, on average.
    """

    camera: Camera
    pitch_rad: float
    roll_rad: float
    offset_px: float

    @property
    def angle_rad(self) -> float:
        """Of both turns together."""
        return float(np.hypot(self.pitch_rad, self.roll_rad))

    @property
    def unseen_px(self) -> float:
        """How far objects may be off along their rows: by a turn about the y axis as large as what shows, one sigma."""
        return float(self.camera.P[0, 0] * self.angle_rad / np.sqrt(2))

    @property
    def is_too_far(self) -> bool:
        """Whether that is more than what is borne across the rows."""
        return self.unseen_px > Feature().epipolar_tolerance_px

    def undone(self, pair: RectifiedPair, blobs: Blobs) -> tuple[RectifiedPair, Blobs]:
        """The views and the outlines as if the right camera had not turned."""
        projection = self.camera.P[:, :3]
        rotation = cv2.Rodrigues(np.array([self.pitch_rad, 0.0, self.roll_rad]))[0]
        homography = np.asarray(projection @ rotation @ np.linalg.inv(projection))
        right = cv2.warpPerspective(pair.right, homography, self.camera.frame_size, flags=cv2.INTER_CUBIC)
        return replace(pair, right=right.astype(np.uint8)), _moved(blobs, homography)

    def told(self, found: Correspondences) -> Correspondences:
        """What was found in these, no surer than the turn that does not show lets it be."""
        sigma_px = np.hypot(found.sigma_px, self.unseen_px / np.sqrt(2))  # each view has its half of the variance
        return replace(found, sigma_px=sigma_px, turned_px=self.offset_px)


def turn_of(blobs: Blobs, rig: StereoRig) -> Turn | None:
    """How the right camera has turned, as most outlines tell; None where it has not, or where that may be chance.

    An epipolar plane that touches a part touches it for both cameras.
    """
    pairs = _pairs(blobs, rig)
    if not pairs:
        return None
    ends = np.concatenate([_ends(*pair) for pair in pairs])
    per_rad = _rows_per_rad(ends[:, :2], rig.right)
    turn_rad = _turn_rad(per_rad, ends[:, 2])
    moved_px = per_rad @ turn_rad
    agree = np.abs(ends[:, 2] - moved_px) < _AGREEING * _END_PX
    gain = np.sum(bounded(ends[:, 2], _END_PX) - bounded(ends[:, 2] - moved_px, _END_PX))
    if gain < _SURELY * _END_PX**2 or not _is_said_by_most(agree):
        return None
    offset_px = float(np.sqrt((moved_px[agree] ** 2).mean()))
    return Turn(rig.right, float(turn_rad[0]), float(turn_rad[1]), offset_px)


def _pairs(blobs: Blobs, rig: StereoRig) -> list[tuple[Blob, Blob]]:
    """Outlines that fit one another; those of parts that touch begin and end where one of them does."""
    left, right = ([blob for blob in side if blob.fault in ("", "merged")] for side in (blobs.left, blobs.right))
    return [(left[i], right[j]) for i, j in fitting_pairs(left, right, rig)]


def _ends(left: Blob, right: Blob) -> Floats:
    """The top and the bottom of an outline (2, 3): where in the right view, and how many rows above those of the left
    one [px]; infinitely many where the one or the other is no edge of the object."""
    return np.array([_end(left, right, which) for which in (np.argmin, np.argmax)])


def _end(left: Blob, right: Blob, which: Callable[[Floats], np.intp]) -> tuple[float, float, float]:
    one, other = which(left.contour_px[:, 1]), which(right.contour_px[:, 1])
    x, y = right.contour_px[other].tolist()
    is_edge = all(not len(blob.sharpness) or blob.sharpness[at] >= SHARP for blob, at in ((left, one), (right, other)))
    return x, y, float(left.contour_px[one, 1]) - y if is_edge else np.inf


def _rows_per_rad(points_px: Floats, camera: Camera) -> Floats:
    """By how many rows points (N, 2) of a rectified view move when its camera turns about x or z: (N, 2)."""
    rows = [moved[:, 1] for moved in turning(normalized(points_px, camera))]
    return np.asarray(camera.P[1, 1] * np.stack(rows, axis=1))


def _turn_rad(per_rad: Floats, offset_px: Floats) -> Floats:
    """The turn (2,) [rad] that most ends agree on: first as two of them have it, then by Tukey's weights."""
    known = np.isfinite(offset_px)
    per_rad, offset_px = per_rad[known], offset_px[known]
    if not len(offset_px):
        return np.zeros(2)
    proposed = _proposed(per_rad, offset_px)
    cost = bounded(offset_px - proposed @ per_rad.T, _END_PX).sum(axis=1)
    turn_rad = proposed[(cost + (proposed**2).sum(axis=1) * _LOOSE[0, 0]).argmin()]
    for _ in range(_ROUNDS):
        weighted = per_rad * tukey(offset_px - per_rad @ turn_rad, _END_PX)[:, None]
        turn_rad = np.linalg.solve(weighted.T @ per_rad + _LOOSE, weighted.T @ offset_px)
    return np.asarray(turn_rad)


def _proposed(per_rad: Floats, offset_px: Floats) -> Floats:
    """The turns (N, 2) [rad] that each two of the ends have."""
    few = np.arange(0, len(offset_px), -(-len(offset_px) // _MOST_ENDS))
    both = few[np.stack(np.triu_indices(len(few)), axis=1)]
    design = per_rad[both].transpose(0, 2, 1)
    pull = design @ offset_px[both][..., None]
    return np.asarray(np.linalg.solve(design @ per_rad[both] + _LOOSE, pull)[..., 0])


def _is_said_by_most(agree: Bools) -> bool:
    """Whether most of the pairs, of which each has two ends, agree: by more ends than a turn has unknowns, or by both
    ends of one, which are above each other and tell of pitch alone."""
    of_pairs = agree.reshape(-1, 2)
    return bool((agree.sum() > _UNKNOWNS or of_pairs.all(axis=1).any()) and of_pairs.any(axis=1).mean() > 0.5)


def _moved(blobs: Blobs, homography: Floats) -> Blobs:
    moved = (cv2.perspectiveTransform(blob.contour_px[:, None], homography)[:, 0] for blob in blobs.right)
    right = tuple(replace(blob, contour_px=np.asarray(px, np.float64)) for blob, px in zip(blobs.right, moved))
    return replace(blobs, right=right, others=None if blobs.others is None else _moved(blobs.others, homography))
