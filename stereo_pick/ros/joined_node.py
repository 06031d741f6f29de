"""The base of the nodes after rectification: their step takes what belongs to one stamp, and the rectified cameras."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from rclpy.context import Context

from stereo_pick.core.configuration import steps
from stereo_pick.core.params import Parameter
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.rig import StereoRig
from stereo_pick.ros.messages.diagnostics import WARN, Status
from stereo_pick.ros.node import StepNode
from stereo_pick.ros.parameters import Values
from stereo_pick.ros.rig_cache import RigCache
from stereo_pick.ros.stamp_join import DEPTH, StampJoin
from stereo_pick.ros.topics import CAMERA_INFO_RECT, SIDES, Topic


class JoinedNode(StepNode):
    """Joins one message of each topic and both camera_info_rect by stamp, and processes them together.

    depth: how many stamps may be incomplete.
    """

    def __init__(
        self,
        name: str,
        context: Context,
        parameters: Mapping[str, Parameter],
        topics: Sequence[Topic],
        depth: int = DEPTH,
    ) -> None:
        self._rigs = RigCache()
        self._processed = 0
        joined = [*topics, *CAMERA_INFO_RECT.values()]
        self._join = StampJoin([topic.name for topic in joined], self._on_joined, depth)
        super().__init__(name, context, parameters)
        for topic in joined:
            self.listen(topic, partial(self._join.add, topic.name))

    def configure(self, values: Values) -> Steps:
        """The pipeline's steps of these parameter values, of which the node takes its own."""
        return steps(values)

    def apply(self, configured: Steps) -> None:
        """Use these steps from the next message on."""
        self.steps = configured

    def status(self) -> Status:
        """What is missing, or how the last message went."""
        if self._processed or self.failed:
            return self._ended() or self.failed or self.result_status()
        silent = ", ".join(self.resolve_topic_name(name) for name in self._join.silent())
        return Status(WARN, f"waiting for {silent or 'messages of one stamp on all topics'}")

    def _ended(self) -> Status | None:
        """The warning where there will be no other message to process: a last result would be reported for ever."""
        names = [self.resolve_topic_name(name) for name in self._join.counts]
        if gone := [name for name in names if self.count_publishers(name) == 0]:
            return Status(WARN, f"nobody publishes {', '.join(gone)} any more: has the node before this one ended?")
        if self._join.is_apart:
            return Status(
                WARN, f"no more messages of one stamp on all of {', '.join(names)}: are some lost on the way?"
            )
        return None

    def result_status(self) -> Status:
        """How the last processed message went."""
        raise NotImplementedError

    def process(self, messages: dict[str, Any], rig: StereoRig) -> None:
        """Make the node's step and publish its result; `messages` are by topic name."""
        raise NotImplementedError

    def _on_joined(self, messages: dict[str, Any]) -> None:
        rig = self._rigs.rig_of([messages[CAMERA_INFO_RECT[side].name] for side in SIDES])
        self.rig = rig
        self.process(messages, rig)
        self._processed += 1
        self.went_well()
