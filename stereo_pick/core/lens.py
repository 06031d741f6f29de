"""Intrinsics that no lens can have, though each number of them may be one's."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError

# From the optical axis to the nearest pixel; a window of a larger sensor need not hold the axis, and the widest lenses
# reach 2.4 of them, flat images as well as fisheyes.
_MOST_ASIDE_FOCAL = 3.0
_MOST_FOLDED = 1 / 3  # of the pixels: where a model is but extrapolated, in the corners, it may run wild
_WIDE_RAD = np.deg2rad(75.0)  # beyond it a fisheye's image ends before its frame does
_STEPS, _GRID = 1500, 64


def check_lens(camera: Camera) -> None:
    """Raise CalibrationError where an image lies beside all that a lens shows, or its distortion folds it over."""
    _check_principal_point(camera)
    _check_fold(camera)


def _check_principal_point(camera: Camera) -> None:
    centre_px, focal_px = camera.K[:2, 2], camera.K[[0, 1], [0, 1]]
    nearest_px = np.clip(centre_px, 0, np.array(camera.frame_size) - 1)
    aside = float(np.linalg.norm((centre_px - nearest_px) / focal_px))
    if aside > _MOST_ASIDE_FOCAL:
        raise CalibrationError(
            f"{camera.name} camera: principal point K[0,2], K[1,2] = {centre_px[0]:g}, {centre_px[1]:g} px lies "
            f"{aside:.1f} focal lengths beside the image of {camera.width_px} x {camera.height_px}: no lens sees so "
            "far aside; calibrate again"
        )


def _check_fold(camera: Camera) -> None:
    radii = _radii(camera, np.linspace(0.0, _WIDE_RAD, _STEPS))
    falling = np.flatnonzero(np.diff(radii) <= 0)
    if not len(falling):
        return
    reach = float(radii[falling[0]])
    x, y = (np.linspace(0, side_px - 1, _GRID) for side_px in camera.frame_size)
    from_axis = np.hypot((x[:, None] - camera.K[0, 2]) / camera.K[0, 0], (y - camera.K[1, 2]) / camera.K[1, 1])
    beyond = float((from_axis > reach).mean())
    if beyond > _MOST_FOLDED:
        raise CalibrationError(
            f"{camera.name} camera: D = {', '.join(f'{value:g}' for value in camera.D)} folds the image over: no ray "
            f"would end {reach * camera.K[0, 0]:.0f} px or more from its principal point, in {beyond:.0%} of the "
            "image; calibrate again, with views that fill the image"
        )


def _radii(camera: Camera, angles_rad: Floats) -> Floats:
    """How far from the principal point [focal lengths] rays at these angles to the optical axis are seen."""
    if camera.distortion_model == "equidistant":
        powers = angles_rad[:, None] ** np.arange(2, 10, 2)
        return np.asarray(angles_rad * (1 + powers @ camera.D))
    k1, k2, _, _, k3, k4, k5, k6 = np.append(camera.D[:8], np.zeros(8))[:8]
    r = np.tan(angles_rad)
    powers = r[:, None] ** np.arange(2, 8, 2)
    return np.asarray(r * (1 + powers @ (k1, k2, k3)) / (1 + powers @ (k4, k5, k6)))
