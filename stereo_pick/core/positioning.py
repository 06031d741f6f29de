"""What is known of a rig beyond its camera_info: how sure it is, and where it stands in the robot's frame."""

from __future__ import annotations

from dataclasses import dataclass, replace

from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.calibration.record import CalibrationRecord
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.hand_eye.files import FramedHandEye
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.rig import StereoRig


@dataclass(frozen=True)
class Positioning:
    """The last step of the way: poses in the left camera's frame get their whole covariance and their final frame.

    record: the calibration's own uncertainty; hand_eye: the frame in which the poses end, that of the robot's base or,
    with the camera on the hand, that of its flange. Without them the poses stay as they are.
    """

    record: CalibrationRecord | None = None
    hand_eye: FramedHandEye | None = None

    def is_of(self, rig: StereoRig) -> bool:
        """Whether there is a record, and of this rig."""
        return self.record is not None and self.record.calibration_hash == calibration_hash(rig)

    def check(self, rig: StereoRig, frame_id: str = "") -> None:
        """Raise CalibrationError where the hand-eye is of another calibration, or of another camera than `frame_id`."""
        if self.hand_eye is None:
            return
        self.hand_eye.check(rig)
        if frame_id and frame_id != self.hand_eye.child_frame:
            raise CalibrationError(
                f"the hand-eye file is of the frame {self.hand_eye.child_frame!r}, but the left images come from "
                f"{frame_id!r}: if that is the same camera, give both one name (child_frame in the file, or the "
                "parameter left_frame_id of capture)"
            )

    def place(self, poses: ObjectPoses, rig: StereoRig) -> ObjectPoses:
        """Add the calibration's covariance where the record is of this rig, then go over to the hand-eye's frame; then
        refuse what is not known with the confidence that is asked for."""
        if self.record is not None and self.is_of(rig):
            grown = poses.covariance + self.record.uncertainty.point_covariance(poses.xyz)
            poses = replace(poses, covariance=grown, covariance_of=(*poses.covariance_of, "calibration"))
        return (poses if self.hand_eye is None else _moved(poses, self.hand_eye)).confident(rig)


def _moved(poses: ObjectPoses, framed: FramedHandEye) -> ObjectPoses:
    """The same poses in the parent frame, with the hand-eye's own uncertainty."""
    found = framed.hand_eye.found
    R = found.transform.rotation
    return replace(
        poses,
        xyz=found.transform.apply(poses.xyz),
        covariance=R @ poses.covariance @ R.T + found.point_covariance(poses.xyz),
        covariance_of=(*poses.covariance_of, "hand_eye"),
        frame_id=framed.parent_frame,
        frame_R_camera=R,
    )
