"""Running nodes as a process: start, signals, end."""

from __future__ import annotations

import ctypes
import os
import shlex
import signal
import sys
import threading
from collections.abc import Callable, Sequence

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from stereo_pick.core.errors import ParameterError, StereoPickError
from stereo_pick.ros.misspelled import warn_of_misspelled
from stereo_pick.ros.node import StepNode
from stereo_pick.ros.qos_overrides import warn_of_vain_overrides
from stereo_pick.ros.shared_memory import PROFILE, PROFILE_VARIABLE, lack_of_profile, lack_of_shared_memory
from stereo_pick.ros.started_by import is_orphaned
from stereo_pick.ros.unread_files import warn_of_unread

_LAST_DOMAIN = 232
_SPIN_S = 0.1

NodeFactory = Callable[[Context], StepNode]


class _Abandoned(BaseException):
    """A signal came within work that may be abandoned. No Exception, which rclpy would keep until the work is done."""


def run_nodes(factories: Sequence[NodeFactory], args: Sequence[str] | None = None) -> int:
    """Spin nodes in this process until they are done, or until SIGINT or SIGTERM; return the exit status.

    rclpy's own signal handlers race with its shutdown; here a handler only sets an event, and abandons what may be.
    """
    prepare_process()
    stop = threading.Event()
    context = Context()
    nodes: list[StepNode] = []
    lacks = (lack_of_profile(), lack_of_shared_memory())

    def end(*_: object) -> None:
        stop.set()
        if any(node.may_be_abandoned for node in nodes):
            raise _Abandoned

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, end)
    try:
        start_ros(context, args)
        for factory in factories:
            nodes.append(factory(context))
        for lack in filter(None, lacks):
            nodes[0].get_logger().warning(lack)
        warn_of_misspelled(nodes)
        warn_of_vain_overrides(nodes)
        warn_of_unread(nodes, sys.argv if args is None else args)
        _spin(nodes, context, stop)
        return 0
    except _Abandoned:
        return 0
    except StereoPickError as error:
        print(f"stereo-pick: error: {error}", file=sys.stderr)
        return 1
    finally:
        for node in nodes:
            node.destroy_node()
        context.try_shutdown()


def prepare_process() -> None:
    """Set up transport and memory for images, before the first `rclpy.init`.

    Fast DDS's default shared-memory segment of 512 KB cannot hold one VGA pair, and glibc gives every large
    block back to the system after each use. A profile that the user chose stays.
    """
    os.environ.setdefault(PROFILE_VARIABLE, str(PROFILE))
    try:
        mallopt = ctypes.CDLL("libc.so.6").mallopt
    except (OSError, AttributeError):  # another C library than glibc
        return
    for option, value in ((-3, 32 << 20), (-1, 256 << 20), (-2, 16 << 20)):  # mmap and trim threshold, top pad
        mallopt(option, value)


def start_ros(context: Context, args: Sequence[str] | None) -> None:
    """Start ROS in this context, without its signal handlers.

    Raises ParameterError, with the reason, if it fails or would, and on arguments that ROS passes over.
    """
    given = list(args) if args is not None else sys.argv[1:]
    domain = os.environ.get("ROS_DOMAIN_ID", "")
    if domain.isdecimal() and int(domain) > _LAST_DOMAIN:  # of which Fast DDS ends the process
        raise ParameterError(f"ROS_DOMAIN_ID = {domain} is outside its range 0 .. {_LAST_DOMAIN}")
    try:
        rclpy.init(args=given, context=context, signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as error:
        reason = " ".join(str(error).partition(", at /")[0].split())
        raise ParameterError(
            f"ROS 2 does not start ({reason}): correct what stands after --ros-args, or the environment "
            "(ROS_DOMAIN_ID, ROS_LOG_DIR)"
        ) from None
    passed_over = remove_ros_args(given)
    if passed_over:
        raise ParameterError(
            f"no node takes the arguments {shlex.join(passed_over)}: parameters, their files and remappings stand "
            "after --ros-args, as in --ros-args -p name:=value"
        )


def _spin(nodes: Sequence[StepNode], context: Context, stop: threading.Event) -> None:
    executor = SingleThreadedExecutor(context=context)
    for node in nodes:
        executor.add_node(node)
    while not stop.is_set() and not is_orphaned() and not any(node.finished for node in nodes):
        executor.spin_once(timeout_sec=_SPIN_S)
    for node in nodes:
        executor.remove_node(node)
