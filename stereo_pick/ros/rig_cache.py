"""The rig that a pair of camera_info describes, made anew only when they change."""

from __future__ import annotations

from collections.abc import Sequence

from sensor_msgs.msg import CameraInfo

from stereo_pick.core.rig import StereoRig
from stereo_pick.ros.messages.cameras import content, rectified_camera_of
from stereo_pick.ros.topics import SIDES


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
            self._rig, self._key = StereoRig(*map(rectified_camera_of, infos, SIDES)), key
        return self._rig
