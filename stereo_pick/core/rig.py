"""Two calibrated cameras as one rig."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.lens import check_lens
from stereo_pick.core.rectified_view import rectified_view
from stereo_pick.core.transform import Transform

MIN_BASELINE_M = 0.001
MAX_BASELINE_M = 5.0
_LONG_CM = 50.0  # baselines, in centimetres: longer ones are rather in millimetres
_SAME = 1e-4  # relative: files round
_MOST_ASIDE_DEG = 75.0  # from an optical axis to the view that suits both: beyond, nothing is left of the image


@dataclass(frozen=True, eq=False)
class StereoRig:
    """Left and right camera whose R and P describe one rectified view with horizontal rows (REP 104).

    Raises CalibrationError where the baseline is zero, negative or given in millimetres, or where
    R and P, or the image sizes, of the two cameras do not belong together.
    """

    left: Camera
    right: Camera

    def __post_init__(self) -> None:
        sizes = [f"{camera.width_px} x {camera.height_px}" for camera in (self.left, self.right)]
        if sizes[0] != sizes[1]:
            raise CalibrationError(
                f"the left camera's images are {sizes[0]}, the right one's {sizes[1]}: let both cameras run at one "
                "resolution, and calibrate again"
            )
        check_baseline(self.right_T_left)
        right = self.right.P
        if abs(right[1, 3]) > 1e-6 * abs(right[0, 3]):
            raise CalibrationError(
                f"left and right P do not share their rows: P[1,3] of the right one is {right[1, 3]:.3f}: "
                "they are not the horizontal rectification of one stereo calibration"
            )

    @staticmethod
    def from_cameras(left: Camera, right: Camera) -> StereoRig:
        """Build from two camera_info: their R and P say where the cameras stand, not how to rectify.

        Raises CalibrationError as the class does.
        """
        return StereoRig.from_extrinsics(left, right, extrinsics(left, right))

    @staticmethod
    def from_extrinsics(left: Camera, right: Camera, right_T_left: Transform) -> StereoRig:
        """Build from two cameras and `X_right = R X_left + T` [m], with the rectified view that suits them.

        Raises CalibrationError as the class does, and where no lens has the intrinsics, or where the cameras cannot
        look at one scene.
        """
        check_lens(left)
        check_lens(right)
        check_baseline(right_T_left)
        check_beside(right_T_left)
        return StereoRig(*rectified_view(left, right, right_T_left))

    @property
    def baseline_m(self) -> float:
        """Distance of the two camera centres [m]."""
        return float(-self.right.P[0, 3] / self.right.P[0, 0])

    @property
    def eyes_m(self) -> Floats:
        """The two cameras' centres (2, 3) [m] in the rectified left frame."""
        return np.array([[0.0, 0.0, 0.0], [self.baseline_m, 0.0, 0.0]])

    @property
    def focal_px(self) -> float:
        """Focal length of the rectified cameras [px]."""
        return float(self.left.P[0, 0])

    @cached_property
    def right_T_left(self) -> Transform:
        """From the left to the right camera's (raw) optical frame: `X_R = R X_L + T` [m].

        The thesis prints the reverse in eq. 3.14; its numbers (3.4.2) make sense only in this direction.
        """
        return extrinsics(self.left, self.right)

    def project(self, xyz: ArrayLike) -> tuple[Floats, Floats]:
        """Points (N, 3) [m] in the left optical frame to raw pixels (N, 2) of left and right."""
        return self.left.project(xyz), self.right.project(self.right_T_left.apply(xyz))


def extrinsics(left: Camera, right: Camera) -> Transform:
    """`right_T_left` [m] of two camera_info: R turns both into the rectified frame, P[:,3] / f is the shift there.

    Raises CalibrationError where P[0,3], of the wrong camera or positive, puts the right camera left of the left one,
    where the left P has a shift of its own, or where the focal lengths of the two P, or the rows (of cameras one above
    the other the columns) of their principal points, differ: one of them is wrong, and all distances would be.
    """
    if left.P[0, 3] != 0 and right.P[0, 3] == 0:
        raise CalibrationError(
            f"P[0,3] of the left camera = {left.P[0, 3]:.3f} and that of the right one is 0: left and right are "
            "swapped; exchange the two cameras, or calibrate again"
        )
    check_unshifted(left)
    shift = shift_m(right)
    if shift[0] > MIN_BASELINE_M and shift[0] > abs(shift[1]):
        raise CalibrationError(
            f"baseline -P[0,3] / fx of the right camera = {-shift[0]:.4f} m is negative: left and right are swapped; "
            "exchange the two cameras, or calibrate again"
        )
    focal_px = np.array([left.P[0, 0], left.P[1, 1], right.P[0, 0], right.P[1, 1]])
    if not np.allclose(focal_px[:2], focal_px[2:], rtol=_SAME):
        raise CalibrationError(
            "P of the two cameras have different focal lengths: fx {:.3f} and {:.3f}, fy {:.3f} and {:.3f}: they are "
            "not of one stereo rectification; calibrate the cameras as a stereo pair".format(*focal_px[[0, 2, 1, 3]])
        )
    row = 1 if abs(shift[0]) >= abs(shift[1]) else 0
    if not np.isclose(left.P[row, 2], right.P[row, 2], rtol=_SAME):
        raise CalibrationError(
            f"left and right P do not share their {('columns', 'rows')[row]}: c{'xy'[row]} {left.P[row, 2]:.3f} and "
            f"{right.P[row, 2]:.3f}: they are not of one stereo rectification; calibrate the cameras as a stereo pair"
        )
    # A file's rounded R is no rotation to the last digit: made one here, the rig survives its own camera_info.
    U, _, Vt = np.linalg.svd(right.R.T @ left.R)
    return Transform(U @ Vt, right.R.T @ shift)


def shift_m(right: Camera) -> Floats:
    """From the left camera's coordinates to the right one's (3,) [m], in the rectified frame: P[:,3] / f."""
    P = right.P
    return np.array([P[0, 3] / P[0, 0], P[1, 3] / P[1, 1], 0.0])


def check_unshifted(left: Camera) -> None:
    """Raise CalibrationError for a left camera whose P says that it stands elsewhere."""
    if left.P[:2, 3].any():
        raise CalibrationError(
            f"P[0,3] and P[1,3] of the left camera are {left.P[0, 3]:g} and {left.P[1, 3]:g}, must be 0: those of the "
            "right one say where it stands, seen from the left one; is it the right one's, or another rig's?"
        )


def check_baseline(right_T_left: Transform) -> None:
    """Raise CalibrationError for a baseline that is zero, negative or in millimetres."""
    centre = right_T_left.inverse().translation
    baseline_m = float(np.linalg.norm(centre))
    if baseline_m < MIN_BASELINE_M:
        raise CalibrationError(
            f"baseline = {baseline_m * 1000:.3f} mm is zero: both images come from the same place, "
            "or the cameras were calibrated one by one; calibrate them as a stereo pair"
        )
    if baseline_m > MAX_BASELINE_M:
        raise CalibrationError(
            f"baseline = {baseline_m:.1f} m is longer than {MAX_BASELINE_M:g} m: the calibration is in "
            f"{_units(baseline_m)}"
        )
    if _is_left(centre) and _is_left(right_T_left.translation):
        raise CalibrationError(
            f"baseline = {centre[0]:.4f} m is negative, and with the cameras exchanged it is, too: one of them stands "
            "on its head; turn it, or all of its images, by 180 deg, and calibrate again"
        )
    if _is_left(centre):
        raise CalibrationError(
            f"baseline = {centre[0]:.4f} m is negative: the right camera stands left of the left one; "
            "left and right are swapped: exchange them, or calibrate again; or R and T are of the inverse direction: "
            "X_right = R X_left + T is meant"
        )


def _is_left(centre: Floats) -> bool:
    """Whether a camera at this place (3,) stands left of the one in whose frame that is, rather than above or below."""
    return bool(-centre[0] > np.abs(centre[1:]).max())


def check_beside(right_T_left: Transform) -> None:
    """Raise CalibrationError for cameras that no common view suits: one stands where the other one looks, or their
    backs are turned to each other."""
    left_T_right = right_T_left.inverse()
    centre, axes = left_T_right.translation, np.array([[0.0, 0.0, 1.0], left_T_right.rotation[:, 2]])
    along = centre / np.linalg.norm(centre)
    across = axes.sum(axis=0) - along * (axes.sum(axis=0) @ along)
    if (axes @ across).min() > np.cos(np.deg2rad(_MOST_ASIDE_DEG)) * np.linalg.norm(across):
        return
    apart_deg = np.rad2deg(np.arccos(np.clip(axes[0] @ axes[1], -1, 1)))
    raise CalibrationError(
        "the right camera stands {:.3f} m right of the left one, {:.3f} below and {:.3f} before it, and looks "
        "{:.0f} deg away from where that looks: they cannot see one scene as a stereo pair does; check order, signs "
        "and units of R and T, or calibrate again".format(*centre, apart_deg)
    )


def _units(length: float) -> str:
    """Which a baseline may be in that is too long in metres, and what to do."""
    if length > _LONG_CM:
        return "millimetres; divide its translation (T, or P[0,3]) by 1000"
    return "centimetres or millimetres; divide its translation (T, or P[0,3]) by 100 or by 1000"
