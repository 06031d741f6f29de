"""The capture node's calibration: where it comes from, and the services that exchange it while the node runs."""

from __future__ import annotations

from functools import partial

from rclpy.node import Node
from sensor_msgs.srv import SetCameraInfo

from stereo_pick.core.calibration.files import load_cameras
from stereo_pick.core.calibration.record import FILE_NAME, record_of
from stereo_pick.core.calibration.renewal import CalibrationKeeper
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError, SourceError, StereoPickError
from stereo_pick.core.params import path_of
from stereo_pick.core.rig import StereoRig
from stereo_pick.ros.messages.cameras import camera_of
from stereo_pick.ros.topics import SIDES
from stereo_pick.sources.source import StereoSource

_REMEDY = "start capture with the parameter calibration set to a folder"


class CalibrationInUse:
    """The cameras of the folder or file `calibration`, else those of the recording.

    What `left|right/set_camera_info` bring is saved in that folder; an empty one waits for it. size_px: of the images.
    Raises StereoPickError where there is no calibration, or none of a rig.
    """

    def __init__(
        self, node: Node, calibration: str, recording: str, source: StereoSource, size_px: tuple[int, int]
    ) -> None:
        self._node = node
        path = path_of(calibration)
        self._folder = path if calibration and path.is_dir() else None
        nowhere = f"{calibration} is an OpenCV file" if calibration else f"the camera_info is that of {recording}"
        cameras = _cameras(calibration, recording, source)
        self._keeper = CalibrationKeeper(cameras, size_px, self._folder, f"{nowhere}; {_REMEDY}")
        self._refresh()
        for side in SIDES:
            node.create_service(SetCameraInfo, f"{side}/set_camera_info", partial(self._on_call, side))

    @property
    def cameras(self) -> dict[str, Camera]:
        """What is to be published, by side; nothing as long as there is no calibration."""
        return self._keeper.cameras

    def trouble(self) -> str:
        """What the user should do about the calibration, if anything."""
        missing = [side for side in SIDES if side not in self._keeper.waiting]
        if len(missing) == 1:
            now = "the calibration before is published" if self.cameras else "no camera_info is published"
            call = f"call {missing[0]}/set_camera_info with the other half"
            return f"half of a new calibration came: {call}; until then {now}"
        if not missing:
            return "the two camera_info that came are not of one stereo calibration: calibrate both cameras as a pair"
        if not self.cameras:
            return "no calibration yet: call left/set_camera_info and right/set_camera_info"
        return self._doubt

    def _on_call(
        self, side: str, request: SetCameraInfo.Request, response: SetCameraInfo.Response
    ) -> SetCameraInfo.Response:
        try:
            response.status_message = self._keeper.take(side, camera_of(request.camera_info, side))
            response.success = True
            self._refresh()
        except StereoPickError as error:
            response.success, response.status_message = False, str(error)
        log = self._node.get_logger().info if response.success else self._node.get_logger().warning
        log(f"{side}/set_camera_info: {response.status_message}")
        return response

    def _refresh(self) -> None:
        """Look whether the file of uncertainties beside the cameras is theirs."""
        self.rig, self._doubt = self._keeper.rig, ""
        if self.rig is None or self._folder is None or not (self._folder / FILE_NAME).is_file():
            return
        try:
            record_of(self._folder / FILE_NAME, self.rig)
        except CalibrationError as error:
            self._doubt = str(error)


def _cameras(calibration: str, recording: str, source: StereoSource) -> dict[str, Camera]:
    path = path_of(calibration)
    if calibration and path.is_dir() and not any(path.iterdir()):
        return {}
    cameras = load_cameras(path) if calibration else source.cameras
    if cameras is None:
        raise SourceError(f"{recording} holds no camera_info: give the parameter calibration")
    StereoRig.from_cameras(*cameras)
    return dict(zip(SIDES, cameras))
