"""The rectification node: `image_raw` and `camera_info` of both sides to `image_rect` and `camera_info_rect`."""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import partial

import numpy as np
from rclpy.context import Context
from rclpy.qos import DurabilityPolicy
from sensor_msgs.msg import CameraInfo, Image

from stereo_pick.core.errors import StereoPickError
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.pairing import Pair, Side
from stereo_pick.core.parameter_groups import configured, declared
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.rig import StereoRig
from stereo_pick.ros.info_of_stamp import InfoOfStamp
from stereo_pick.ros.messages.cameras import camera_info_message, camera_of, content
from stereo_pick.ros.messages.diagnostics import ERROR, OK, PAIRS, WARN, Status
from stereo_pick.ros.messages.images import image_message
from stereo_pick.ros.node import StepNode
from stereo_pick.ros.parameters import Values
from stereo_pick.ros.process import run_nodes
from stereo_pick.ros.raw_pairs import RawImageOptions, RawPairs
from stereo_pick.ros.topics import CAMERA_INFO, CAMERA_INFO_RECT, IMAGE_RAW, IMAGE_RECT, SIDES
from stereo_pick.sources.bag_topics import is_rectified

_MAX_HELD = 5  # pairs that wait for their camera_info
_TICK_S = 0.1
_LATE_TICKS = 3  # camera_info that has not come by then is lost, or not sent with each image

Infos = tuple[CameraInfo, CameraInfo]


class RectificationNode(StepNode):
    """Pairs raw images by stamp and publishes them rectified, with the stamp of the left one.

    A pair is rectified by the camera_info of its own stamps, where the cameras' drivers stamp them alike.
    """

    def __init__(self, context: Context) -> None:
        self._infos = {side: InfoOfStamp() for side in SIDES}
        self._used: Infos | None = None
        self._rectifier: Rectifier | None = None
        self._refused: StereoPickError | None = None
        self._held: list[Pair[Image]] = []
        self._held_ticks = 0
        self._rectified = 0
        self._raw = RawPairs(self, self._on_pair)
        super().__init__("rectification", context, declared({"": RawImageOptions}))
        self._images = {side: self.advertise(IMAGE_RECT[side]) for side in SIDES}
        self._camera_infos = {side: self.advertise(CAMERA_INFO_RECT[side]) for side in SIDES}
        for side in SIDES:
            self.listen(CAMERA_INFO[side], partial(self._on_camera_info, side))
        self._raw.listen()
        self.repeat(_TICK_S, self._on_tick)

    def configure(self, values: Values) -> RawImageOptions:
        """The options of these parameter values."""
        return configured(RawImageOptions, "", values)

    def apply(self, configured: RawImageOptions) -> None:
        """Pair by the new options from now on."""
        self._options = configured
        self._raw.restart(configured.max_stamp_offset_s)

    def status(self) -> Status:
        """What is missing, if anything is."""
        counts = self._raw.counts
        values = {"left": str(counts.left), "right": str(counts.right), PAIRS: str(counts.pairs)}
        trouble = self._raw.trouble()
        if trouble is not None and counts.pairs == 0:
            return replace(trouble, values=values)
        if self._refused is not None:
            return Status(ERROR, str(self._refused), values)
        if missing := self._missing_info():
            return Status(self._raw.missing_level(), missing, values)
        if trouble is not None:
            return replace(trouble, values=values)
        if self._rectified == 0:
            return Status(ERROR, self.last_error or f"none of {counts.pairs} pairs could be rectified", values)
        twice = self._rectified_before()
        return Status(WARN, twice, values) if twice else Status(OK, f"{self._rectified} pairs rectified", values)

    def _missing_info(self) -> str:
        """What to say where no camera_info has come of a camera."""
        topics = [self.resolve_topic_name(CAMERA_INFO[side].name) for side in SIDES if self._infos[side].latest is None]
        if not topics:
            return ""
        missing = f"no message on {' and '.join(topics)}: is the camera calibrated, and its camera_info published?"
        publishers = [each for topic in topics for each in self.get_publishers_info_by_topic(topic)]
        if not any(each.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for each in publishers):
            return missing
        return (
            f"{missing} It is published as transient_local: if once only, have it sent again, by qos_overrides of the "
            "subscription: reliability reliable, durability transient_local (docs/nodes.md)"
        )

    def _rectified_before(self) -> str:
        """What to say of images that were rectified before they came here; nothing where rectifying changes nothing."""
        for side, info in zip(SIDES, self._used or ()):
            topic = self.resolve_topic_name(IMAGE_RAW[side].name)
            if is_rectified(topic) and (any(info.d) or not np.allclose(info.r, np.eye(3).ravel())):
                return (
                    f"{topic} is rectified already, by its name, and is rectified again by its camera_info: positions "
                    "are off; remap to the raw images"
                )
        return ""

    def _on_camera_info(self, side: Side, message: CameraInfo) -> None:
        self._infos[side].add(message)
        self._rectify_held()

    def _on_pair(self, pair: Pair[Image]) -> None:
        self._held = [*self._held, pair][-_MAX_HELD:]
        self._held_ticks = 0
        self._rectify_held()

    def _on_tick(self) -> None:
        self._held_ticks += 1
        if self._held_ticks == _LATE_TICKS:
            self._rectify_held()

    def _rectify_held(self) -> None:
        """Rectify what has its camera_info; the last pair waits for it a moment, or until the next one comes."""
        while self._held:
            stamps = (self._held[0].left_stamp_ns, self._held[0].right_stamp_ns)
            sides = [(self._infos[side], stamp) for side, stamp in zip(SIDES, stamps)]
            if any(info.latest is None for info, _ in sides):
                return
            is_last = len(self._held) == 1 and self._held_ticks < _LATE_TICKS
            if is_last and any(info.awaits(stamp) for info, stamp in sides):
                return
            pair = self._held.pop(0)
            infos = self._belonging(*(info.take(stamp) for info, stamp in sides))
            if infos is not None:
                self._calibrate(infos)
                self._rectify(pair)

    def _belonging(self, left: CameraInfo | None, right: CameraInfo | None) -> Infos | None:
        """Both camera_info of a pair. A lost one is that of the pair before, unless the other camera's has changed."""
        if left is not None and right is not None:
            return left, right
        if self._used is None:
            return None
        if any(new is not None and content(new) != content(old) for new, old in zip((left, right), self._used)):
            return None
        return self._used

    def _calibrate(self, infos: Infos) -> None:
        """Take these into use, if they are not; raises StereoPickError where they are no rig, once."""
        known, self._used = self._used, infos
        if known is not None and all(content(new) == content(old) for new, old in zip(infos, known)):
            return
        self._rectifier = self._refused = self.rig = None
        try:
            self.rig = StereoRig.from_cameras(*(camera_of(info, side) for info, side in zip(infos, SIDES)))
            self._rectifier = Rectifier(self.rig)
        except StereoPickError as error:
            self._refused = error
            raise

    def _rectify(self, pair: Pair[Image]) -> None:
        if self._rectifier is None:
            return  # its camera_info was refused, which stays the node's status
        left, right = self._options.read(pair)
        rectified = self._rectifier.rectify(StereoFrame(left, right, pair.left_stamp_ns))
        cameras = {"left": rectified.rig.left, "right": rectified.rig.right}
        images = {"left": rectified.left, "right": rectified.right}
        for side in SIDES:
            frame_id = (pair.left if side == "left" else pair.right).header.frame_id
            info = camera_info_message(cameras[side], rectified.stamp_ns, frame_id)
            self._camera_infos[side].publish(info)
            self._images[side].publish(image_message(images[side], rectified.stamp_ns, frame_id))
        self._rectified += 1


def main(args: list[str] | None = None) -> int:
    """Run the node."""
    return run_nodes([RectificationNode], args)


if __name__ == "__main__":
    sys.exit(main())
