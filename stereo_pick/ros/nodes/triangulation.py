"""The triangulation node: `correspondences` to `object_poses`, in the left camera's own frame or in the robot's."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import Any

from rclpy.context import Context

from stereo_pick.core.calibration.record import load_record
from stereo_pick.core.configuration import triangulation_groups
from stereo_pick.core.hand_eye.files import load_hand_eye
from stereo_pick.core.parameter_groups import configured, declared
from stereo_pick.core.params import Configurable, parameter, path_of
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.positioning import Positioning
from stereo_pick.core.refusal import count_reasons
from stereo_pick.core.rig import StereoRig
from stereo_pick.ros.joined_node import JoinedNode
from stereo_pick.ros.messages.correspondences import correspondences_of
from stereo_pick.ros.messages.diagnostics import ERROR, OK, WARN, Status
from stereo_pick.ros.messages.poses import markers_message, objects_message, pose_array_message
from stereo_pick.ros.messages.stamps import stamp_ns
from stereo_pick.ros.parameters import Values
from stereo_pick.ros.process import run_nodes
from stereo_pick.ros.topics import CORRESPONDENCES, OBJECT_MARKERS, OBJECT_POSES, OBJECTS

# Stamps of which camera_info waits for the correspondences: those of half a minute of images, at a hundred a second.
_WAITING = 3000


@dataclass(frozen=True)
class TriangulationOptions(Configurable):
    """What is known of the rig beyond its camera_info."""

    calibration_file: str = parameter(
        "", "The rig's calibration.yaml; its uncertainty goes into the positions' covariance.", fixed=True
    )
    hand_eye_file: str = parameter(
        "",
        "File of `stereo-pick hand-eye`; poses are then in its parent frame: the robot's base, or its flange.",
        fixed=True,
    )


class TriangulationNode(JoinedNode):
    """Publishes a PoseArray for every pair, an empty one where no object was found: silence would look like death."""

    def __init__(self, context: Context) -> None:
        groups: dict[str, type[Configurable]] = {"": TriangulationOptions, **triangulation_groups()}
        super().__init__("triangulation", context, declared(groups), [CORRESPONDENCES], _WAITING)
        self._options = configured(TriangulationOptions, "", self.parameters.values)
        self._positioning = _positioning(self._options)
        self._poses = self.advertise(OBJECT_POSES)
        self._objects = self.advertise(OBJECTS)
        self._markers = self.advertise(OBJECT_MARKERS)

    def configure(self, values: Values) -> Steps:
        """The pipeline's steps of these parameter values."""
        own = declared({"": TriangulationOptions})
        return super().configure({name: value for name, value in values.items() if name not in own})

    def result_status(self) -> Status:
        """What was located and refused in the last pair, and what its covariance contains."""
        refused = count_reasons(self._last.refused)
        values = {reason: str(count) for reason, count in refused.items()}
        values["covariance_of"] = ", ".join(self._last.covariance_of)
        if refused.get("ray_gap", 0) > len(self._last):
            message = f"the rays of {refused['ray_gap']} objects do not meet: has a camera moved since its calibration?"
            return Status(ERROR, message, values)
        if refused.get("low_confidence", 0) > len(self._last):
            message = (
                f"{refused['low_confidence']} positions are less sure than triangulation.min_confidence = "
                f"{self._last.min_confidence:g}: look at the covariances, with min_confidence 0; is tolerance_m = "
                f"{self._last.tolerance_m:g} less than the gripper needs?"
            )
            return Status(WARN, message, values)
        if self._positioning.record is not None and "calibration" not in self._last.covariance_of:
            stated = self._positioning.record.calibration_hash
            message = (
                f"calibration_file {self._options.calibration_file} is of another calibration ({stated}) than the "
                "camera_info: positions' covariance is without the calibration's; take both from one calibration"
            )
            return Status(WARN, message, values)
        if not self._frame_id or self._frame_id.startswith("/"):
            message = (
                f"frame_id of the poses is {self._frame_id!r}, which tf2 takes for none: let the left camera's driver, "
                "or the hand-eye file, name a frame, without a leading /"
            )
            return Status(WARN, message, values)
        return Status(OK, f"{len(self._last)} objects located, {len(self._last.refused)} refused", values)

    def process(self, messages: dict[str, Any], rig: StereoRig) -> None:
        """Locate the objects of one pair."""
        message = messages[CORRESPONDENCES.name]
        frame_id = message.header.frame_id
        self._positioning.check(rig, frame_id)
        located = self.steps.locate(correspondences_of(message), rig, stamp_ns(message.header.stamp))
        self._last = self._positioning.place(located, rig)
        self._frame_id = self._last.frame_id or frame_id
        self._objects.publish(objects_message(self._last, self._frame_id))
        self._poses.publish(pose_array_message(self._last, self._frame_id))
        self._markers.publish(markers_message(self._last, self._frame_id))


def _positioning(options: TriangulationOptions) -> Positioning:
    record = load_record(path_of(options.calibration_file)) if options.calibration_file else None
    hand_eye = load_hand_eye(path_of(options.hand_eye_file)) if options.hand_eye_file else None
    return Positioning(record, hand_eye)


def main(args: list[str] | None = None) -> int:
    """Run the node."""
    return run_nodes([TriangulationNode], args)


if __name__ == "__main__":
    sys.exit(main())
