"""The triangulation node: `correspondences` to `object_poses`, in the left camera's own optical frame."""

from __future__ import annotations

import sys
from typing import Any

from rclpy.context import Context

from stereo_pick.core.configuration import declared, triangulation_groups
from stereo_pick.core.refusal import count_reasons
from stereo_pick.core.rig import StereoRig
from stereo_pick.ros.joined_node import JoinedNode
from stereo_pick.ros.messages.correspondences import correspondences_of
from stereo_pick.ros.messages.diagnostics import ERROR, OK, Status
from stereo_pick.ros.messages.poses import markers_message, objects_message, pose_array_message
from stereo_pick.ros.messages.stamps import stamp_ns
from stereo_pick.ros.process import run_nodes
from stereo_pick.ros.topics import CORRESPONDENCES, OBJECT_MARKERS, OBJECT_POSES, OBJECTS


class TriangulationNode(JoinedNode):
    """Publishes a PoseArray for every pair, an empty one where no object was found: silence would look like death."""

    def __init__(self, context: Context) -> None:
        super().__init__("triangulation", context, declared(triangulation_groups()), [CORRESPONDENCES])
        self._poses = self.advertise(OBJECT_POSES)
        self._objects = self.advertise(OBJECTS)
        self._markers = self.advertise(OBJECT_MARKERS)

    def result_status(self) -> Status:
        """What was located and refused in the last pair."""
        refused = count_reasons(self._last.refused)
        values = {reason: str(count) for reason, count in refused.items()}
        if refused.get("ray_gap", 0) > len(self._last):
            message = f"the rays of {refused['ray_gap']} objects do not meet: has a camera moved since its calibration?"
            return Status(ERROR, message, values)
        return Status(OK, f"{len(self._last)} objects located, {len(self._last.refused)} refused", values)

    def process(self, messages: dict[str, Any], rig: StereoRig) -> None:
        """Locate the objects of one pair."""
        message = messages[CORRESPONDENCES.name]
        frame_id = message.header.frame_id
        self._last = self.steps.locate(correspondences_of(message), rig, stamp_ns(message.header.stamp))
        self._objects.publish(objects_message(self._last, frame_id))
        self._poses.publish(pose_array_message(self._last, frame_id))
        self._markers.publish(markers_message(self._last, frame_id))


def main(args: list[str] | None = None) -> int:
    """Run the node."""
    return run_nodes([TriangulationNode], args)


if __name__ == "__main__":
    sys.exit(main())
