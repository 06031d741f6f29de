"""The calibration node: watches a board that is moved in front of both cameras, says what is missing, calibrates."""

from __future__ import annotations

import sys
from functools import partial

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.context import Context
from sensor_msgs.msg import Image
from std_srvs.srv import Trigger

from stereo_pick.core.calibration.any_board import parse_board
from stereo_pick.core.calibration.collecting import Pace, not_found, timed_pair
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.calibration.guidance import Guidance, guide
from stereo_pick.core.calibration.guidance_picture import guidance_picture
from stereo_pick.core.calibration.verdict import Word
from stereo_pick.core.calibration_run import CalibrationRun, calibrate_from
from stereo_pick.core.errors import StereoPickError
from stereo_pick.core.frames import grey
from stereo_pick.core.pairing import Pair
from stereo_pick.core.parameter_groups import configured, declared
from stereo_pick.core.params import path_of
from stereo_pick.ros.board_watch import BoardWatch, Progress
from stereo_pick.ros.calibration_options import CalibrationOptions
from stereo_pick.ros.messages.diagnostics import ERROR, OK, WARN, Status
from stereo_pick.ros.messages.images import image_message
from stereo_pick.ros.node import StepNode
from stereo_pick.ros.parameters import Values
from stereo_pick.ros.process import run_nodes
from stereo_pick.ros.raw_pairs import RawPairs
from stereo_pick.ros.topics import CALIBRATION_ANNOTATED

_DRAW_PERIOD_S = 0.1
_FINISH, _SAVE, _SAVED = "call ~/finish", "call ~/save", "the calibration is saved"
_IN_VAIN = 20  # pairs without a board after which more of them are no help


class CalibrationNode(StepNode):
    """Collects views of a board; the services `~/finish` and `~/save` calibrate from them and write the files."""

    logs_ok = True

    def __init__(self, context: Context) -> None:
        self._raw = RawPairs(self, self._on_pair)
        self._pace = Pace()
        self._start_ns: int | None = None
        self._run: CalibrationRun | None = None
        self._next = _FINISH
        super().__init__("calibration", context, declared({"": CalibrationOptions}))
        self._options.check_chosen()
        self._board = parse_board(self._options.board, self._options.square_m)
        self._watch = BoardWatch(self._board, self._options.max_waiting)
        self._drawn = self._watch.progress
        self._annotated = self.advertise(CALIBRATION_ANNOTATED)
        # A group of their own: while one waits for the watch, images and timers go on.
        services = MutuallyExclusiveCallbackGroup()
        self.create_service(Trigger, "~/finish", self._on_finish, callback_group=services)
        self.create_service(Trigger, "~/save", self._on_save, callback_group=services)
        self.create_timer(_DRAW_PERIOD_S, self._on_timer, clock=self.steady_clock)
        self._raw.listen()

    def configure(self, values: Values) -> CalibrationOptions:
        """The options of these parameter values."""
        return configured(CalibrationOptions, "", values)

    def apply(self, configured: CalibrationOptions) -> None:
        """Use these options."""
        self._options = configured
        self._raw.restart(configured.max_stamp_offset_s)

    def status(self) -> Status:
        """What of the board is still to be shown."""
        trouble, progress = self._raw.trouble(), self._watch.progress
        if self._watch.calibrating:
            return Status(OK, f"calibrating from {len(progress.kept)} views", self._values(progress))
        if trouble is not None and (trouble.level == ERROR or self._raw.counts.pairs == 0):
            return trouble
        if progress.error:
            return Status(ERROR, progress.error, self._values(progress))
        if progress.looked_at >= _IN_VAIN and not progress.shown:
            return Status(WARN, not_found(self._board, progress.looked_at), self._values(progress))
        missing = self._guidance(progress).missing
        left_out = self._watch.not_looked_at
        slow = f"; {left_out} pairs were not looked at: they come faster than the board is found" if left_out else ""
        message = f"{len(progress.kept)} views kept; " + ("; ".join(f"show {text}" for text in missing) or self._next)
        return Status(WARN if missing else OK, message + slow, self._values(progress))

    def destroy_node(self) -> None:
        """End the watch, too."""
        self._watch.close()
        super().destroy_node()

    def _values(self, progress: Progress) -> dict[str, str]:
        return {
            "pairs": str(self._raw.counts.pairs),
            "looked_at": str(progress.looked_at),
            "with_board": str(progress.shown),
            "views": str(len(progress.kept)),
            "waiting": str(self._watch.waiting),
            "not_looked_at": str(self._watch.not_looked_at),
            "calibration": self._run.summary if self._run else "",
        }

    def _guidance(self, progress: Progress) -> Guidance:
        size_px = progress.last.size_px if progress.last else (1, 1)
        return guide(progress.kept, size_px, self._board)

    def _on_pair(self, pair: Pair[Image]) -> None:
        if not self._pace.takes(pair.left_stamp_ns):
            return
        self._start_ns = pair.left_stamp_ns if self._start_ns is None else self._start_ns
        self._watch.offer(partial(self._read, pair, (pair.left_stamp_ns - self._start_ns) / 1e9))

    def _read(self, pair: Pair[Image], time_s: float) -> BoardImages:
        left, right = self._options.read(pair)
        return timed_pair(time_s, grey(left), grey(right))

    def _on_timer(self) -> None:
        """Publish a new picture where somebody looks at it."""
        if self._watch.failure is not None:
            raise self._watch.failure
        progress = self._watch.progress
        if progress is self._drawn or progress.last is None or self._annotated.get_subscription_count() == 0:
            return
        self._drawn = progress
        picture = guidance_picture(progress.last, progress.seen, progress.kept, self._guidance(progress))
        self._annotated.publish(image_message(picture, self.get_clock().now().nanoseconds, "calibration"))

    async def _on_finish(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Calibrate from the views kept so far; more can follow, and another finish."""
        self._raw.flush()
        try:
            self._run = await self._watch.calibrate(self._calibrate)
        except StereoPickError as error:
            return self._answer(response, False, str(error))
        accepted = self._run.verdict.word is not Word.REFUSED
        self._next = _SAVE if accepted else _FINISH
        return self._answer(response, accepted, self._run.summary)

    def _on_save(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        if self._run is None:
            return self._answer(response, False, "there is no calibration yet: call ~/finish first")
        try:
            written = self._run.save(path_of(self._options.output))
        except StereoPickError as error:
            return self._answer(response, False, str(error))
        self._next = _SAVED
        return self._answer(response, True, f"written: {', '.join(map(str, written))}")

    def _calibrate(self, images: tuple[BoardImages, ...]) -> CalibrationRun:
        return calibrate_from(images, self._board, self._options.baseline_m or None)

    def _answer(self, response: Trigger.Response, success: bool, message: str) -> Trigger.Response:
        if success:
            self.get_logger().info(message)
        else:  # rclpy takes no other severity at the same line
            self.get_logger().warning(message)
        response.success, response.message = success, message
        return response


def main(args: list[str] | None = None) -> int:
    """Run the node."""
    return run_nodes([CalibrationNode], args)


if __name__ == "__main__":
    sys.exit(main())
