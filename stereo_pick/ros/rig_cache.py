"""The rig that a pair of camera_info describes, made anew only when they change."""

from __future__ import annotations

from collections.abc import Sequence

from sensor_msgs.msg import CameraInfo

from stereo_pick.core.rig import StereoRig
from stereo_pick.ros.messages.cameras import camera_of, content


class RigCache:
    """Keeps the last rig, because what is derived from a rig (maps, masks) is kept by the rig's identity."""

    def __init__(self) -> None:
        self._key: tuple[object, ...] | None = None
        self._rig: StereoRig | None = None

    def rig_of(self, infos: Sequence[CameraInfo]) -> StereoRig:
        """The rig of a left and a right `camera_info_rect`, with just their R and P.

        Raises CalibrationError where they describe no rig.
        """
        key = tuple(content(info) for info in infos)
        if self._rig is None or key != self._key:
            left, right = infos
            self._rig, self._key = StereoRig(camera_of(left, "left"), camera_of(right, "right")), key
        return self._rig
