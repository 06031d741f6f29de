"""The correspondence node: rectified pairs to `correspondences`, by the method of the parameter `method`."""

from __future__ import annotations

import sys
from functools import partial
from typing import Any

from rclpy.context import Context

from stereo_pick.core.annotation import annotate
from stereo_pick.core.configuration import correspondence_groups, declared, method_parameter, steps
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.images import pixels
from stereo_pick.core.objects import Blobs
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.refusal import REASONS, count_reasons
from stereo_pick.ros.messages.correspondences import correspondences_message
from stereo_pick.ros.messages.diagnostics import ERROR, OK, WARN, Status
from stereo_pick.ros.messages.images import buffer_of, image_message
from stereo_pick.ros.messages.stamps import stamp_ns
from stereo_pick.ros.node import StepNode
from stereo_pick.ros.parameters import Values
from stereo_pick.ros.process import run_nodes
from stereo_pick.ros.rig_cache import RigCache
from stereo_pick.ros.stamp_join import StampJoin
from stereo_pick.ros.topics import ANNOTATED, CAMERA_INFO_RECT, CORRESPONDENCES, IMAGE_RECT, SIDES


class CorrespondenceNode(StepNode):
    """Finds the objects in both rectified images and matches them."""

    def __init__(self, context: Context) -> None:
        self._rigs = RigCache()
        self._last: Correspondences | None = None
        topics = [*IMAGE_RECT.values(), *CAMERA_INFO_RECT.values()]
        self._join = StampJoin([topic.name for topic in topics], self._on_pair)
        parameters = {"method": method_parameter(), **declared(correspondence_groups())}
        super().__init__("correspondence", context, parameters)
        self._correspondences = self.advertise(CORRESPONDENCES)
        self._annotated = self.advertise(ANNOTATED)
        for topic in topics:
            self.listen(topic, partial(self._join.add, topic.name))

    def configure(self, values: Values) -> Steps:
        """The steps of these parameter values, of which this node takes the first two."""
        return steps(values)

    def apply(self, configured: Steps) -> None:
        """Use these steps from the next pair on."""
        self._steps = configured

    def status(self) -> Status:
        """What is missing, or what was refused in the last pair."""
        if self._last is None:
            silent = ", ".join(self.resolve_topic_name(name) for name in self._join.silent())
            return Status(WARN, f"waiting for {silent or 'images and camera_info of one stamp'}")
        refused = count_reasons(self._last.refused)
        values = {reason: str(count) for reason, count in refused.items()}
        if "swapped" in refused:
            return Status(ERROR, f"{REASONS['swapped']}; exchange the two image topics, or the cameras", values)
        return Status(OK, f"{len(self._last)} objects matched, {len(self._last.refused)} refused", values)

    def _on_pair(self, messages: dict[str, Any]) -> None:
        images = [messages[IMAGE_RECT[side].name] for side in SIDES]
        rig = self._rigs.rig_of([messages[CAMERA_INFO_RECT[side].name] for side in SIDES])
        left, right = (pixels(buffer_of(image), what=f"rectified {side} image") for side, image in zip(SIDES, images))
        pair = RectifiedPair(left, right, rig, stamp_ns(images[0].header.stamp))
        blobs, self._last = self._steps.correspond(pair)
        frame_id = images[0].header.frame_id
        self._correspondences.publish(correspondences_message(self._last, pair.stamp_ns, frame_id))
        self._publish_annotated(pair, blobs, self._last, frame_id)

    def _publish_annotated(self, pair: RectifiedPair, blobs: Blobs, found: Correspondences, frame_id: str) -> None:
        if self._annotated.get_subscription_count() > 0:
            self._annotated.publish(image_message(annotate(pair, blobs, found), pair.stamp_ns, frame_id))


def main(args: list[str] | None = None) -> int:
    """Run the node."""
    return run_nodes([CorrespondenceNode], args)


if __name__ == "__main__":
    sys.exit(main())
