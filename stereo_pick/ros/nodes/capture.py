"""The capture node: a recorded bag or a folder of image pairs to `left|right/image_raw` and `camera_info`."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass

from rclpy.context import Context
from rosgraph_msgs.msg import Clock

from stereo_pick.core.errors import ParameterError, StereoPickError
from stereo_pick.core.images import FULL_SCALE_16
from stereo_pick.core.pairing import MOST_OFFSET_S
from stereo_pick.core.parameter_groups import configured, declared
from stereo_pick.core.params import Configurable, parameter, path_of
from stereo_pick.ros.calibration_in_use import CalibrationInUse
from stereo_pick.ros.messages.cameras import camera_info_message
from stereo_pick.ros.messages.diagnostics import OK, PAIRS, WARN, Status
from stereo_pick.ros.messages.images import buffer_message
from stereo_pick.ros.messages.stamps import time_message
from stereo_pick.ros.node import StepNode
from stereo_pick.ros.parameters import Values
from stereo_pick.ros.process import run_nodes
from stereo_pick.ros.replay_clock import ReplayClock
from stereo_pick.ros.topics import CAMERA_INFO, CLOCK, IMAGE_RAW, SIDES
from stereo_pick.sources.opening import open_source
from stereo_pick.sources.source import SourcePair, StereoSource, without_partner

_LINGER_S = 1.0  # until the last images have left the process
_UNHEARD_S = 4.0  # until nobody is taken to listen: to find each other takes processes up to 3 s now and then
_SETTLE_S = 0.5  # until who listens to the images knows all topics: what comes before is lost to them
_IDLE_S = 0.02


@dataclass(frozen=True)
class CaptureOptions(Configurable):
    """Where stereo pairs come from, and how fast."""

    source: str = parameter(
        "", "A bag (mcap, sqlite3 or ROS 1) or a folder of image pairs (left*.png, right*.png).", fixed=True
    )
    calibration: str = parameter(
        "",
        "Folder with left.yaml and right.yaml, in which set_camera_info saves (a folder without files waits for it), "
        "or an OpenCV YAML file; empty takes the bag's own camera_info.",
        fixed=True,
    )
    left_topic: str = parameter("", "The bag's topic of left images; empty finds it by its name.", fixed=True)
    right_topic: str = parameter("", "The bag's topic of right images; empty finds it by its name.", fixed=True)
    max_stamp_offset_s: float = parameter(
        0.01,
        "By how much the stamps of a left and a right image in the bag may differ.",
        low=0.0,
        high=MOST_OFFSET_S,
        fixed=True,
    )
    left_frame_id: str = parameter(
        "",
        "Frame of the left camera (REP 103 optical); empty keeps the bag's, or left_camera_optical_frame.",
        fixed=True,
    )
    right_frame_id: str = parameter(
        "", "Frame of the right camera; empty keeps the bag's, or right_camera_optical_frame.", fixed=True
    )
    folder_rate_hz: float = parameter(
        10.0, "Pairs a second of an image folder, at rate 1.", low=0.01, high=1000.0, fixed=True
    )
    full_scale_16: int = parameter(
        FULL_SCALE_16,
        "Value that is white in 16-bit files and compressed images, which are published with 8 bit; 4095 for a 12-bit "
        "camera.",
        low=1,
        high=FULL_SCALE_16,
        fixed=True,
    )
    rate: float = parameter(1.0, "Speed of the replay, 1 as it was recorded.", low=0.01, high=100.0)
    loop: bool = parameter(False, "Start over at the end.")
    publish_clock: bool = parameter(True, "Publish the recorded time on /clock, for nodes with use_sim_time.")
    wait_for_subscribers_s: float = parameter(
        5.0, "How long to wait, before the first pair, until somebody listens to both images.", low=0.0, high=3600.0
    )


class CaptureNode(StepNode):
    """Replays stereo pairs in their own time; done at the end of the recording."""

    def __init__(self, context: Context) -> None:
        super().__init__("capture", context, declared({"": CaptureOptions}))
        if not self._options.source:
            raise ParameterError("parameter source is empty: give a bag or a folder of image pairs")
        self._source = _opened(self._options)
        self._pairs: Iterator[SourcePair] = iter(self._source)
        self._next: SourcePair | None = next(self._pairs, None)
        calibration, recording, size_px = self._options.calibration, self._options.source, _size_px(self._next)
        self._calibration = CalibrationInUse(self, calibration, recording, self._source, size_px)
        self._replay_clock = ReplayClock(self._options.rate)
        self._period_ns = round(1e9 / self._options.folder_rate_hz)  # of a single pair, too
        self._published = 0
        self._started_ns = self.steady_clock.now().nanoseconds
        self._heard_ns: int | None = None
        self._ended_ns: int | None = None
        self._failure: StereoPickError | None = None
        self._images = {side: self.advertise(IMAGE_RAW[side]) for side in SIDES}
        self._infos = {side: self.advertise(CAMERA_INFO[side]) for side in SIDES}
        self._clock_topic = self.advertise(CLOCK)
        self._timer = self.create_timer(_IDLE_S, self._on_timer, clock=self.steady_clock)

    def configure(self, values: Values) -> CaptureOptions:
        """The options of these parameter values."""
        return configured(CaptureOptions, "", values)

    def apply(self, configured: CaptureOptions) -> None:
        """Use rate and loop from now on."""
        self._options = configured
        if hasattr(self, "_replay_clock"):
            self._replay_clock.set_rate(configured.rate, self.steady_clock.now().nanoseconds)

    def status(self) -> Status:
        """How far the replay is, or what its calibration lacks."""
        self.rig = self._calibration.rig
        if self._published == 0:
            return Status(WARN, "waiting for subscribers of the images")
        if trouble := self._calibration.trouble():
            return Status(WARN, trouble)
        values = {PAIRS: str(self._published)}
        if self._ended_ns is None:
            return Status(OK, f"replaying {self._options.source}: {self._published} pairs published", values)
        if self._failure is not None:
            return Status(WARN, f"broke off after {self._published} pairs: {self._failure}", values)
        finished = f"finished {self._options.source}: {self._published} pairs published"
        lacking = without_partner(self._source, self._published)
        return Status(WARN, f"{finished}; {lacking}", values) if lacking else Status(OK, finished, values)

    def _on_timer(self) -> None:
        now_ns = self.steady_clock.now().nanoseconds
        if self._ended_ns is not None:
            self._end(now_ns - self._ended_ns)
        elif self._published == 0 and not self._is_awaited(now_ns):
            return
        else:
            self._replay(now_ns)

    def _is_awaited(self, now_ns: int) -> bool:
        """Whether somebody has been listening to both images for a moment, or has been waited for long enough."""
        if now_ns - self._started_ns > self._options.wait_for_subscribers_s * 1e9:
            return True
        if min(self._images[side].get_subscription_count() for side in SIDES) == 0:
            self._heard_ns = None
            return False
        self._heard_ns = self._heard_ns or now_ns
        return now_ns - self._heard_ns > _SETTLE_S * 1e9

    def _replay(self, now_ns: int) -> None:
        """Publish what is due, and sleep until the next pair is."""
        if self._next is None:
            self._ended_ns = now_ns
            self.report()
            return
        wait_ns = self._replay_clock.until_ns(self._next.recorded_ns, now_ns)
        if wait_ns <= 0:
            self._publish(self._next)
            self._replay_clock.published(self._next.recorded_ns, now_ns)
            self._next = self._following()
            wait_ns = 0 if self._next is None else self._replay_clock.until_ns(self._next.recorded_ns, now_ns)
        self._timer.timer_period_ns = int(min(max(wait_ns, 1_000_000), _IDLE_S * 1e9))

    def _end(self, since_ns: int) -> None:
        """Once the last images are out, and all who listen know how many, be done, or say what broke off the
        recording."""
        if since_ns < (_LINGER_S if self.is_heard else _UNHEARD_S) * 1e9:
            return
        self.report_for_good()
        if self._failure is not None:
            raise self._failure
        self.finished = True

    def _following(self) -> SourcePair | None:
        try:
            return self._read()
        except StereoPickError as error:
            self._failure = error
            return None

    def _read(self) -> SourcePair | None:
        following = next(self._pairs, None)
        if following is None and self._options.loop:
            return self._first_again()
        if following is not None and self._next is not None:
            self._period_ns = following.recorded_ns - self._next.recorded_ns
        return following

    def _first_again(self) -> SourcePair | None:
        """The first pair once more, due as long after the last one as that was after the one before."""
        self._pairs = iter(self._source)
        first = next(self._pairs, None)
        if first is not None:
            self._replay_clock.start_over(first.recorded_ns, self._period_ns)
        return first

    def _publish(self, pair: SourcePair) -> None:
        stamp_ns = self._stamp_ns(pair)
        if self._options.publish_clock:
            self._clock_topic.publish(Clock(clock=time_message(stamp_ns)))
        cameras = self._calibration.cameras
        buffers = {"left": pair.left, "right": pair.right}
        frame_ids = {
            "left": self._options.left_frame_id or pair.left_frame_id or "left_camera_optical_frame",
            "right": self._options.right_frame_id or pair.right_frame_id or "right_camera_optical_frame",
        }
        for side in SIDES:
            if side in cameras:
                self._infos[side].publish(camera_info_message(cameras[side], stamp_ns, frame_ids[side]))
            self._images[side].publish(buffer_message(buffers[side], stamp_ns, frame_ids[side]))
        self._published += 1

    def _stamp_ns(self, pair: SourcePair) -> int:
        """The recorded stamp; for files, which have none, the time now (not ROS time, which may come from here)."""
        return pair.stamp_ns if self._source.has_stamps else time.time_ns()


def _opened(options: CaptureOptions) -> StereoSource:
    return open_source(
        path_of(options.source),
        left_topic=options.left_topic,
        right_topic=options.right_topic,
        max_stamp_offset_s=options.max_stamp_offset_s,
        rate_hz=options.folder_rate_hz,
        uses_camera_info=not options.calibration,
        full_scale_16=options.full_scale_16,
    )


def _size_px(pair: SourcePair | None) -> tuple[int, int]:
    return (pair.left.width_px, pair.left.height_px) if pair is not None else (0, 0)


def main(args: list[str] | None = None) -> int:
    """Run the node."""
    return run_nodes([CaptureNode], args)


if __name__ == "__main__":
    sys.exit(main())
