"""A rig's calibration exchanged while in use, one camera after the other, as set_camera_info services bring it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from stereo_pick.core.calibration.files import save_cameras
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.rig import StereoRig, check_baseline, check_unshifted, shift_m
from stereo_pick.core.transform import Transform

_SAME = 1e-6  # of a value; OpenCV and REP 104 give both cameras the very same numbers
_OTHER = {"left": "right", "right": "left"}


class CalibrationKeeper:
    """The two cameras in use, and the halves of a new calibration that still wait for their other half.

    cameras: left and right by their sides, just as they were given, or nothing yet; size_px: width and height of the
    images; folder: where they are saved, None where there is no such place, which `why_nowhere` explains.
    """

    def __init__(
        self, cameras: Mapping[str, Camera], size_px: tuple[int, int], folder: Path | None, why_nowhere: str = ""
    ) -> None:
        self.cameras = dict(cameras)
        self.waiting: dict[str, Camera] = {}
        self._size_px = size_px
        self._folder = folder
        self._why_nowhere = why_nowhere

    @property
    def rig(self) -> StereoRig | None:
        """The rig of both cameras in use; None as long as there are none."""
        return StereoRig.from_cameras(self.cameras["left"], self.cameras["right"]) if self.cameras else None

    def take(self, side: str, camera: Camera) -> str:
        """Take one camera's half of a calibration; returns what became of it.

        It is saved, and in use together with its other half, only once both are of one calibration: the right P[0,3]
        and both R belong to the pair. Raises CalibrationError, and changes nothing, where it cannot be right.
        """
        if self._folder is None:
            raise CalibrationError(f"there is nowhere to save it: {self._why_nowhere}")
        _check_half(side, camera, self._size_px)
        other = _OTHER[side]
        for partner in (self.waiting.get(other), self.cameras.get(other)):
            if partner is not None and _is_one_calibration(camera, partner):
                return self._use({side: camera, other: partner}, self._folder)
        self.waiting[side] = camera
        return (
            f"kept, but neither saved nor published yet: it is half of a calibration (P: {_scale(camera)}), and "
            f"{self._partner_text(other)}; now call {other}/set_camera_info with the other half"
        )

    def _use(self, pair: dict[str, Camera], folder: Path) -> str:
        pair = {side: replace(camera, name=self._name(side)) for side, camera in pair.items()}
        StereoRig.from_cameras(pair["left"], pair["right"])
        changed = {side: camera for side, camera in pair.items() if self._is_new(side, camera, folder)}
        save_cameras(pair, folder, changed)
        self.cameras = pair
        self.waiting.clear()
        return f"saved in {folder}; published for both cameras from the next pair on"

    def _is_new(self, side: str, camera: Camera, folder: Path) -> bool:
        known = self.cameras.get(side)
        same = known is not None and all(np.array_equal(getattr(known, each), getattr(camera, each)) for each in "KDRP")
        return not same or not (folder / f"{side}.yaml").is_file()

    def _name(self, side: str) -> str:
        return self.cameras[side].name if side in self.cameras else side

    def _partner_text(self, other: str) -> str:
        known = self.waiting.get(other) or self.cameras.get(other)
        return f"that of the {other} camera is of another one ({_scale(known)})" if known else "the other is missing"


def _check_half(side: str, camera: Camera, size_px: tuple[int, int]) -> None:
    """Raise CalibrationError where this cannot be that camera of a rig, whatever its other half is."""
    if camera.frame_size != size_px:
        width, height = camera.frame_size
        raise CalibrationError(
            f"{side} camera_info is for {width} x {height}, but the images are {size_px[0]} x {size_px[1]}: "
            "calibrate at the resolution that the camera runs at"
        )
    if side == "left":
        check_unshifted(camera)
    else:
        check_baseline(Transform(np.eye(3), shift_m(camera)))


def _is_one_calibration(one: Camera, other: Camera) -> bool:
    """Whether two P are the halves of one rectification (REP 104): one focal length, and one row (or column)."""
    upright = max(abs(one.P[0, 3]), abs(other.P[0, 3])) >= max(abs(one.P[1, 3]), abs(other.P[1, 3]))
    shared = [(0, 0), (1, 1), (1, 2) if upright else (0, 2)]
    return all(bool(np.isclose(one.P[at], other.P[at], rtol=_SAME, atol=0)) for at in shared)


def _scale(camera: Camera) -> str:
    return f"fx {camera.P[0, 0]:.3f}, cy {camera.P[1, 2]:.3f}"
