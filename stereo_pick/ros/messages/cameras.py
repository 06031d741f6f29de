"""sensor_msgs/CameraInfo."""

from __future__ import annotations

import numpy as np
from sensor_msgs.msg import CameraInfo

from stereo_pick.core.camera import Camera
from stereo_pick.core.sensor_window import SensorWindow
from stereo_pick.ros.messages.stamps import header


def camera_of(message: CameraInfo, name: str) -> Camera:
    """The camera whose raw images a camera_info comes with, those of its region of interest, binned; raises
    CalibrationError where no real camera has these numbers."""
    return SensorWindow.of(message).of_raw(_full(message, name))


def rectified_camera_of(message: CameraInfo, name: str) -> Camera:
    """The same of rectified images."""
    return SensorWindow.of(message).of_rectified(_full(message, name))


def _full(message: CameraInfo, name: str) -> Camera:
    return Camera(
        name=name,
        width_px=message.width,
        height_px=message.height,
        K=np.reshape(message.k, (3, 3)),
        D=np.asarray(message.d),
        R=np.reshape(message.r, (3, 3)),
        P=np.reshape(message.p, (3, 4)),
        distortion_model=message.distortion_model,
    )


def camera_info_message(camera: Camera, stamp_ns: int, frame_id: str) -> CameraInfo:
    """The camera_info of a camera (REP 104), with a stamp [ns]."""
    return CameraInfo(
        header=header(stamp_ns, frame_id),
        height=camera.height_px,
        width=camera.width_px,
        distortion_model=camera.distortion_model,
        d=camera.D.tolist(),
        k=camera.K.ravel().tolist(),
        r=camera.R.ravel().tolist(),
        p=camera.P.ravel().tolist(),
    )


def content(message: CameraInfo) -> tuple[object, ...]:
    """What makes two camera_info describe the same camera: everything but the header."""
    return (
        message.width,
        message.height,
        message.distortion_model,
        SensorWindow.of(message),
        *(tuple(values) for values in (message.d, message.k, message.r, message.p)),
    )
