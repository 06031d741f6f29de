"""The base of the four nodes: topics with overridable QoS, live parameters, diagnostics, errors that do not kill."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from copy import copy
from dataclasses import replace
from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSPolicyKind, QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions

from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.errors import ParameterError, StereoPickError
from stereo_pick.core.params import Parameter
from stereo_pick.core.rig import StereoRig
from stereo_pick.ros.messages.diagnostics import ERROR, OK, WARN, Status, diagnostics_message, kind
from stereo_pick.ros.parameters import LiveParameters, Values, descriptor, wrong_type
from stereo_pick.ros.topics import CLOCK, DIAGNOSTICS, Topic

CALIBRATION_HASH = "calibration_hash"
_DIAGNOSTICS_PERIOD_S = 1.0
_HEARD_S = 2.0  # who was killed never confirms
OVERRIDABLE = (QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH, QoSPolicyKind.RELIABILITY, QoSPolicyKind.DURABILITY)
_OF_MANY = (DIAGNOSTICS, CLOCK)  # topics that several nodes may publish, as one clock for all cells


class StepNode(Node):
    """A node around one step of the pipeline.

    A StereoPickError in a callback drops that message and becomes the node's status until one went well: a bad image
    must not end the node, and must not pass unseen.
    """

    finished = False
    may_be_abandoned = False
    logs_ok = False  # whether a new status is logged where all is well, too
    rig: StereoRig | None = None  # that of the node's last camera_info; its hash goes into the diagnostics

    def __init__(self, name: str, context: Context, parameters: Mapping[str, Parameter]) -> None:
        try:
            super().__init__(name, context=context)
        except InvalidParameterTypeException as error:  # of one of those that every ROS node has, named at the end
            raise wrong_type(str(error).rpartition(": ")[2], bool, error) from None
        self.steady_clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._error: StereoPickError | None = None
        self._is_new = self._is_over = False  # the error
        self.last_error = ""
        self._logged: set[tuple[bytes, str]] = set()
        self._topics: list[str] = []
        self._diagnostics = self.advertise(DIAGNOSTICS)
        self.parameters = LiveParameters(self, parameters, self.configure, self._reconfigure)
        self._reconfigure()
        self.create_timer(_DIAGNOSTICS_PERIOD_S, self.report, clock=self.steady_clock)

    def configure(self, values: Values) -> Any:
        """Build the node's step from parameter values; raises ParameterError on a value it cannot take."""
        raise NotImplementedError

    def apply(self, configured: Any) -> None:
        """Take a newly built step into use."""
        raise NotImplementedError

    def status(self) -> Status:
        """How the node is doing, when its last message was processed without error."""
        return Status(OK, "running")

    def advertise(self, topic: Topic) -> Publisher:
        """Create a publisher whose QoS parameters can override; raises ParameterError where theirs is none."""
        with self._overridden(topic, "publisher") as options:
            return self.create_publisher(topic.type, topic.name, _own(topic.qos), qos_overriding_options=options)

    def listen(self, topic: Topic, callback: Callable[[Any], None]) -> None:
        """Create a subscription whose QoS parameters can override; errors of the callback become the node's status.

        Raises ParameterError where the parameters' QoS is none.
        """
        with self._overridden(topic, "subscription") as options:
            self.create_subscription(
                topic.type, topic.name, self._guarded(callback), _own(topic.qos), qos_overriding_options=options
            )

    @property
    def failed(self) -> Status | None:
        """The error of the last message, where it came to nothing."""
        return None if self._error is None or self._is_over else Status(ERROR, str(self._error))

    def went_well(self) -> None:
        """Report no error before this one again: what came last was processed."""
        self._is_over = True

    def repeat(self, period_s: float, callback: Callable[[], None]) -> None:
        """Call back again and again; errors become the node's status."""
        guarded = self._guarded(lambda _: callback())
        self.create_timer(period_s, lambda: guarded(None), clock=self.steady_clock)

    def report(self) -> None:
        """Publish the node's status, and log it where it is new and not OK, or the node logs that, too."""
        status = self.status()
        if self._error is not None and (self._is_new or status.level == OK):
            status = Status(ERROR, str(self._error))
        if self._is_over:
            self._error = None
        if status.level == OK:
            status = replace(self.mixed() or status, values=status.values)
        if self.rig is not None:
            status = replace(status, values={**status.values, CALIBRATION_HASH: calibration_hash(self.rig)})
        self._log(status)
        if self._error is None and not self._is_new:
            self._logged = {_news(status)}
        self._is_new = False
        now_ns = self.get_clock().now().nanoseconds
        # /diagnostics is one for all namespaces: names alone would be those of several cells' nodes.
        name = self.get_fully_qualified_name().removeprefix("/")
        self._diagnostics.publish(diagnostics_message(f"stereo_pick: {name}", status, now_ns))

    def mixed(self) -> Status | None:
        """The warning where one of the node's topics has several publishers, as two drivers, or chains, have."""
        for topic in self._topics:
            count = self.count_publishers(topic)
            if count > 1:
                return Status(
                    WARN,
                    f"{count} publishers on {topic}: what is of different cameras, or calibrations, would be taken for "
                    "that of one; end all but one (what was killed is forgotten after some 20 s)",
                )
        return None

    @contextmanager
    def abandonable(self) -> Iterator[None]:
        """Work of seconds within which a signal ends the process at once: it computes, and leaves nothing half done."""
        self.may_be_abandoned = True
        try:
            yield
        finally:
            self.may_be_abandoned = False

    @property
    def is_heard(self) -> bool:
        """Whether anybody listens to what is reported."""
        return self._diagnostics.get_subscription_count() > 0

    def report_for_good(self) -> None:
        """Report, and wait a while until all who listen have it: what has ended repeats nothing."""
        self.report()
        self._diagnostics.wait_for_all_acked(Duration(seconds=_HEARD_S))

    @contextmanager
    def _overridden(self, topic: Topic, end: str) -> Iterator[QoSOverridingOptions]:
        """Let parameters override the QoS of one of the node's topics."""
        name = self.resolve_topic_name(topic.name)
        if topic not in _OF_MANY:
            self._topics.append(name)
        parameters = f"qos_overrides.{name}.{end}"
        depth = Parameter(f"{parameters}.depth", topic.qos.depth, "How many messages wait.", 1, None, fixed=True)
        try:
            self.declare_parameter(depth.name, depth.default, descriptor(depth))  # rclpy's own takes 0 and less, too
            yield QoSOverridingOptions(OVERRIDABLE)
        except (RuntimeError, InvalidParameterTypeException, InvalidParameterValueException) as error:
            raise ParameterError(
                f"correct the parameters {parameters}.*: reliability is reliable or best_effort, history "
                "keep_last or keep_all, durability volatile or transient_local, depth a number from 1: "
                + " ".join(str(error).split())
            ) from None

    def _reconfigure(self) -> None:
        self.apply(self.configure(self.parameters.values))

    def _guarded(self, callback: Callable[[Any], None]) -> Callable[[Any], None]:
        def guarded(message: Any) -> None:
            try:
                callback(message)
            except StereoPickError as error:
                self._error, self.last_error = error, str(error)
                self._is_new, self._is_over = True, False
                self._log(Status(ERROR, str(error)))

        return guarded

    def _log(self, status: Status) -> None:
        """Log what is new: errors that take turns, as those of both cameras do, are so once, until all goes well."""
        news = _news(status)
        if news in self._logged:
            return
        self._logged.add(news)
        if status.level == ERROR:
            self.get_logger().error(status.message)
        elif status.level != OK:
            self.get_logger().warning(status.message)
        elif self.logs_ok:
            self.get_logger().info(status.message)


def _news(status: Status) -> tuple[bytes, str]:
    """What makes a status worth another line in the log."""
    return status.level, kind(status.message)


def _own(qos: QoSProfile) -> QoSProfile:
    """A copy of a profile: rclpy writes a topic's overrides into the profile it is given."""
    return copy(qos)
