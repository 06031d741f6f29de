"""One camera: exactly the content of a sensor_msgs/CameraInfo."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import ArrayLike

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.errors import ArrayError, CalibrationError
from stereo_pick.core.transform import check_rotation

_D_LENGTHS = {
    "plumb_bob": (4, 5),
    "rational_polynomial": (8, 12, 14),
    "equidistant": (4,),
}

_MOST_PX = 20000  # the largest sensors have 19568 x 12588; of more, memory would run out where nobody can say why

_SAME = 1e-6
MAX_SKEW_PX = 0.05  # at the image's edge

# Focal lengths by the larger side of the image: from 157 degrees of view to half a degree
_LEAST_FOCAL, _MOST_FOCAL = 0.1, 100.0


@dataclass(frozen=True, eq=False)
class Camera:
    """Intrinsics and rectification of one camera (REP 104).

    K: (3, 3) raw camera matrix [px]; D: distortion coefficients in ROS and OpenCV order (thesis
    eq. 3.2 and 3.3); R: (3, 3) rotation from the camera's optical frame to the rectified one;
    P: (3, 4) projection of rectified points [px], P[0,3] = -fx * baseline for the right camera.
    Raises CalibrationError, naming the camera and the value, where no real camera has these numbers.
    """

    name: str
    width_px: int
    height_px: int
    K: Floats
    D: Floats
    R: Floats
    P: Floats
    distortion_model: str = "plumb_bob"

    def __post_init__(self) -> None:
        if self.width_px <= 0 or self.height_px <= 0:
            raise CalibrationError(
                f"{self.name} camera: image size {self.width_px} x {self.height_px} must be positive: "
                "is the camera calibrated?"
            )
        if max(self.frame_size) > _MOST_PX:
            raise CalibrationError(
                f"{self.name} camera: image size {self.width_px} x {self.height_px} is no camera's, whose sides have "
                f"{_MOST_PX} pixels at most: give width and height of its images in pixels"
            )
        try:
            if np.size(self.D) == 0 and self.distortion_model == "plumb_bob":
                object.__setattr__(self, "D", np.zeros(5))
            for field, shape in (("K", (3, 3)), ("D", (None,)), ("R", (3, 3)), ("P", (3, 4))):
                object.__setattr__(self, field, floats(field, getattr(self, field), *shape))
        except ArrayError as error:
            raise CalibrationError(f"{self.name} camera: {error}") from None
        self._check_values()

    @property
    def frame_size(self) -> tuple[int, int]:
        """Width and height [px]."""
        return self.width_px, self.height_px

    def normalized(self, raw_px: ArrayLike) -> Floats:
        """Raw pixels (N, 2) to undistorted normalized coordinates (N, 2): eq. 3.5 to 3.1 inverted."""
        points = np.asarray(raw_px, np.float64).reshape(-1, 1, 2)
        if len(points) == 0:
            return np.zeros((0, 2))
        if self.distortion_model == "equidistant":
            undistorted = cv2.fisheye.undistortPoints(points, self.K, self.D)
        else:
            undistorted = cv2.undistortPointsIter(
                points,
                self.K,
                self.D,
                np.eye(3),
                np.eye(3),
                (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 100, 1e-10),
            )
        return np.asarray(undistorted, np.float64).reshape(-1, 2)

    def project(self, xyz: ArrayLike) -> Floats:
        """Points (N, 3) [m] in this camera's optical frame to raw pixels (N, 2): eq. 3.1 to 3.5."""
        points = np.asarray(xyz, np.float64).reshape(-1, 1, 3)
        if len(points) == 0:
            return np.zeros((0, 2))
        zero = np.zeros(3)
        if self.distortion_model == "equidistant":
            pixels, _ = cv2.fisheye.projectPoints(points, zero, zero, self.K, self.D)
        else:
            pixels, _ = cv2.projectPoints(points, zero, zero, self.K, self.D)
        return np.asarray(pixels, np.float64).reshape(-1, 2)

    def rectified(self, raw_px: ArrayLike) -> Floats:
        """Raw pixels (N, 2) to rectified pixels (N, 2)."""
        rays = np.c_[self.normalized(raw_px), np.ones(len(np.reshape(raw_px, (-1, 2))))] @ self.R.T
        return np.asarray(rays[:, :2] / rays[:, 2:] * self.P[[0, 1], [0, 1]] + self.P[:2, 2])

    def unrectified(self, rectified_px: ArrayLike) -> Floats:
        """Rectified pixels (N, 2) to raw pixels (N, 2)."""
        return self.project(self.rays(rectified_px))

    def rays(self, rectified_px: ArrayLike) -> Floats:
        """Viewing directions (N, 3) of rectified pixels (N, 2), in the camera's own optical frame."""
        pixels = np.asarray(rectified_px, np.float64).reshape(-1, 2)
        normalized = (pixels - self.P[:2, 2]) / self.P[[0, 1], [0, 1]]
        return np.asarray(np.c_[normalized, np.ones(len(pixels))] @ self.R)

    def _check_values(self) -> None:
        for name, matrix in (("K", self.K), ("P", self.P)):
            if matrix[0, 0] <= 0 or matrix[1, 1] <= 0:
                raise CalibrationError(
                    f"{self.name} camera: focal length {name}[0,0] = {matrix[0, 0]:g}, {name}[1,1] = "
                    f"{matrix[1, 1]:g} px must be positive: is the camera calibrated?"
                )
        self._check_form()
        self._check_proportion()
        try:
            check_rotation("R", self.R)
        except ArrayError as error:
            raise CalibrationError(f"{self.name} camera: {error}; calibrate again") from None
        if self.distortion_model not in _D_LENGTHS:
            raise CalibrationError(
                f"{self.name} camera: unknown distortion model {self.distortion_model!r}; "
                f"known are {', '.join(_D_LENGTHS)}"
            )
        if len(self.D) not in _D_LENGTHS[self.distortion_model]:
            raise CalibrationError(
                f"{self.name} camera: {len(self.D)} distortion coefficients do not fit {self.distortion_model!r}, "
                f"which has {' or '.join(map(str, _D_LENGTHS[self.distortion_model]))}"
            )

    def _check_form(self) -> None:
        """K has the form that ROS and OpenCV read, of which they look at fx, fy, cx and cy alone."""
        skew_px = abs(self.K[0, 1]) / self.K[1, 1] * self.height_px / 2
        if skew_px > MAX_SKEW_PX or not np.allclose(self.K[[1, 2, 2, 2], [0, 0, 1, 2]], (0, 0, 0, 1), atol=_SAME):
            written = ", ".join(f"{value:g}" for value in self.K.ravel())
            raise CalibrationError(
                f"{self.name} camera: K = {written} is not of the form fx, 0, cx, 0, fy, cy, 0, 0, 1: transpose it if "
                "it is Matlab's, or calibrate again without skew"
            )

    def _check_proportion(self) -> None:
        focal_px = float(self.K[0, 0])
        part = focal_px / max(self.frame_size)
        if not _LEAST_FOCAL <= part <= _MOST_FOCAL:
            raise CalibrationError(
                f"{self.name} camera: focal length K[0,0] = {focal_px:g} px is no lens's for an image of "
                f"{self.width_px} x {self.height_px}: that would be {_LEAST_FOCAL:g} to {_MOST_FOCAL:g} times as many "
                "pixels as its larger side; it counts in pixels, not in millimetres or metres"
            )
