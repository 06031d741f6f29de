"""The triangulation node: `correspondences` to `object_poses`, in the left camera's own optical frame."""

from __future__ import annotations

import sys
from functools import partial
from typing import Any

from rclpy.context import Context

from stereo_pick.core.configuration import declared, steps, triangulation_groups
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.refusal import count_reasons
from stereo_pick.ros.messages.correspondences import correspondences_of
from stereo_pick.ros.messages.diagnostics import ERROR, OK, WARN, Status
from stereo_pick.ros.messages.poses import markers_message, objects_message, pose_array_message
from stereo_pick.ros.messages.stamps import stamp_ns
from stereo_pick.ros.node import StepNode
from stereo_pick.ros.parameters import Values
from stereo_pick.ros.process import run_nodes
from stereo_pick.ros.rig_cache import RigCache
from stereo_pick.ros.stamp_join import StampJoin
from stereo_pick.ros.topics import CAMERA_INFO_RECT, CORRESPONDENCES, OBJECT_MARKERS, OBJECT_POSES, OBJECTS, SIDES


class TriangulationNode(StepNode):
    """Publishes a PoseArray for every pair, an empty one where no object was found: silence would look like death."""

    def __init__(self, context: Context) -> None:
        self._rigs = RigCache()
        self._last: ObjectPoses | None = None
        topics = [CORRESPONDENCES, *CAMERA_INFO_RECT.values()]
        self._join = StampJoin([topic.name for topic in topics], self._on_correspondences)
        super().__init__("triangulation", context, declared(triangulation_groups()))
        self._poses = self.advertise(OBJECT_POSES)
        self._objects = self.advertise(OBJECTS)
        self._markers = self.advertise(OBJECT_MARKERS)
        for topic in topics:
            self.listen(topic, partial(self._join.add, topic.name))

    def configure(self, values: Values) -> Steps:
        """The steps of these parameter values, of which this node takes the last."""
        return steps(values)

    def apply(self, configured: Steps) -> None:
        """Use these steps from the next correspondences on."""
        self._steps = configured

    def status(self) -> Status:
        """What is missing, or what was refused in the last pair."""
        if self._last is None:
            silent = ", ".join(self.resolve_topic_name(name) for name in self._join.silent())
            return Status(WARN, f"waiting for {silent or 'correspondences and camera_info of one stamp'}")
        refused = count_reasons(self._last.refused)
        values = {reason: str(count) for reason, count in refused.items()}
        if refused.get("ray_gap", 0) > len(self._last):
            message = f"the rays of {refused['ray_gap']} objects do not meet: has a camera moved since its calibration?"
            return Status(ERROR, message, values)
        return Status(OK, f"{len(self._last)} objects located, {len(self._last.refused)} refused", values)

    def _on_correspondences(self, messages: dict[str, Any]) -> None:
        rig = self._rigs.rig_of([messages[CAMERA_INFO_RECT[side].name] for side in SIDES])
        message = messages[CORRESPONDENCES.name]
        frame_id = message.header.frame_id
        self._last = self._steps.locate(correspondences_of(message), rig, stamp_ns(message.header.stamp))
        self._objects.publish(objects_message(self._last, frame_id))
        self._poses.publish(pose_array_message(self._last, frame_id))
        self._markers.publish(markers_message(self._last, frame_id))


def main(args: list[str] | None = None) -> int:
    """Run the node."""
    return run_nodes([TriangulationNode], args)


if __name__ == "__main__":
    sys.exit(main())
