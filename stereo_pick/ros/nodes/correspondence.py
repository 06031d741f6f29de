"""The correspondence node: rectified pairs to `correspondences`, by the method of the parameter `method`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from rclpy.context import Context

from stereo_pick.core.annotation import annotate
from stereo_pick.core.configuration import correspondence_groups, method_parameter
from stereo_pick.core.correspondence.correspondences import collect
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.images import pixels
from stereo_pick.core.parameter_groups import declared
from stereo_pick.core.params import path_of
from stereo_pick.core.refusal import REASONS, RIG_FAULTS, count_reasons
from stereo_pick.core.rig import StereoRig
from stereo_pick.ros.background_learning import BackgroundLearning
from stereo_pick.ros.joined_node import JoinedNode
from stereo_pick.ros.messages.correspondences import correspondences_message
from stereo_pick.ros.messages.diagnostics import ERROR, OK, WARN, Status
from stereo_pick.ros.messages.images import buffer_of, image_message
from stereo_pick.ros.messages.stamps import stamp_ns
from stereo_pick.ros.process import run_nodes
from stereo_pick.ros.topics import ANNOTATED, CORRESPONDENCES, IMAGE_RECT, SIDES

_REMEDIES = {
    "swapped": "; exchange the two image topics, or the cameras",
    "misaligned": " Calibrate again",
    "too_dark": "; give more light, or expose longer; 12-bit images in 16 bits need full_scale_16",
    "saturated": "; expose for a shorter time, or close the iris",
    "out_of_focus": "; focus the lens on the work surface, or close the iris",
    "uneven": "; learn it from an empty view (segmentation.background_file), or put down plain cloth",
}


class CorrespondenceNode(JoinedNode):
    """Finds the objects in both rectified images and matches them."""

    def __init__(self, context: Context) -> None:
        parameters = {"method": method_parameter(), **declared(correspondence_groups())}
        super().__init__("correspondence", context, parameters, list(IMAGE_RECT.values()))
        self._correspondences = self.advertise(CORRESPONDENCES)
        self._annotated = self.advertise(ANNOTATED)
        self._learning = BackgroundLearning(self, self._background_path, self._reconfigure)

    def status(self) -> Status:
        """What is being learned, or as of any node."""
        progress = self._learning.progress
        return Status(WARN, progress) if progress else super().status()

    def result_status(self) -> Status:
        """What was matched and refused in the last pair."""
        refused = count_reasons(self._last.refused)
        values = {reason: str(count) for reason, count in refused.items()}
        for fault, remedy in _REMEDIES.items():
            if fault in refused:
                level = ERROR if fault in RIG_FAULTS else WARN
                return Status(level, f"{REASONS[fault]}{remedy}", values)
        if warnings := [text for text in (self._last.notice, self._learning.warning) if text]:
            return Status(WARN, "; ".join(warnings), values)
        return Status(OK, f"{len(self._last)} objects matched, {len(self._last.refused)} refused", values)

    def process(self, messages: dict[str, Any], rig: StereoRig) -> None:
        """Match the objects of one rectified pair."""
        images = [messages[IMAGE_RECT[side].name] for side in SIDES]
        left, right = (pixels(buffer_of(image), what=f"rectified {side} image") for side, image in zip(SIDES, images))
        pair = RectifiedPair(left, right, rig, stamp_ns(images[0].header.stamp))
        frame_id = images[0].header.frame_id
        if self._learning.takes(pair):
            self._last = collect([], [])
            self._correspondences.publish(correspondences_message(self._last, pair.stamp_ns, frame_id))
            return
        with self.abandonable():
            blobs, self._last = self.steps.correspond(pair)
        self._correspondences.publish(correspondences_message(self._last, pair.stamp_ns, frame_id))
        if self._annotated.get_subscription_count() > 0:
            self._annotated.publish(image_message(annotate(pair, blobs, self._last), pair.stamp_ns, frame_id))

    def _background_path(self) -> Path | None:
        file = self.steps.detector.background_file
        return path_of(file) if file else None


def main(args: list[str] | None = None) -> int:
    """Run the node."""
    return run_nodes([CorrespondenceNode], args)


if __name__ == "__main__":
    sys.exit(main())
