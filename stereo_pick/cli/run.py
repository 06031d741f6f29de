"""`stereo-pick run`: the four nodes on a recording, with the poses in the terminal."""

from __future__ import annotations

import argparse
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import FrameType
from typing import TYPE_CHECKING

from stereo_pick.cli.chain import DOWNSTREAM, Chain
from stereo_pick.cli.live_table import LiveTable, Positions
from stereo_pick.cli.options import add_pipeline_options, pipeline_values
from stereo_pick.cli.positioning import FILE_PARAMETERS, positioning_files
from stereo_pick.cli.replay import add_recording_option, add_source_options, opened_source, source_rig
from stereo_pick.cli.warning import warn
from stereo_pick.core.configuration import correspondence_groups, triangulation_groups
from stereo_pick.core.errors import ParameterError, SourceError
from stereo_pick.core.parameter_groups import declared
from stereo_pick.core.params import Value
from stereo_pick.ros.shared_memory import lack_of_profile, lack_of_shared_memory
from stereo_pick.sources.source import without_partner

if TYPE_CHECKING:
    from stereo_pick.cli.monitor import Monitor

_RATES = (0.01, 100.0)
_START_S = 20.0
_OF_DISCOVERY = ("ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_DISCOVERY_SERVER", "ROS_STATIC_PEERS")
_SETTLE_S = 0.5
_DISCOVERED_S = 4.0  # others in the domain: it takes 3 s now and then
_QUIET_S = 1.0
_LATE_S = 10.0  # for what has not come of pairs that were captured, and that no node complains of
_SPIN_S = 0.05

_DESCRIPTION = """\
Run the four nodes (capture, rectification, correspondence, triangulation), each as a process of its own, on a
recorded bag or a folder of image pairs, and show the poses as they come. A picker, RViz or Foxglove can subscribe to
them meanwhile: object_poses (geometry_msgs/PoseArray), object_markers, image_annotated."""

_EPILOG = """\
examples:
  stereo-pick run --source my_bag
  stereo-pick run --source images/ --calibration my_rig --method ssd --rate 0.5 --loop"""


@dataclass(frozen=True)
class Outcome:
    """What came of a run: pairs captured, None where capture was not heard, PoseArrays, objects in them, nodes' errors,
    and whether a signal ended it."""

    pairs: int | None
    arrays: int
    objects: int
    errors: tuple[str, ...]
    stopped: bool


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `run` subcommand."""
    parser = subparsers.add_parser(
        "run",
        help="run the four nodes on a recording and show the poses",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_recording_option(parser)
    add_source_options(parser)
    add_pipeline_options(parser)
    parser.add_argument("--rate", type=float, default=1.0, help="speed of the replay (default: as recorded)")
    parser.add_argument("--loop", action="store_true", help="start over at the end")
    parser.add_argument("--one-process", action="store_true", help="all four nodes in one process")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Run until the recording ends, or Ctrl-C; 1 where nodes told of errors and nothing was located.

    Raises StereoPickError on unusable input.
    """
    if not _RATES[0] <= args.rate <= _RATES[1]:
        raise ParameterError(f"--rate {args.rate:g} is outside its range {_RATES[0]:g} .. {_RATES[1]:g}")
    source = opened_source(args)
    rig = source_rig(source, args)  # what is wrong with it is said here, before anything is started
    files = positioning_files(args, rig)
    capture: dict[str, Value] = {"source": str(args.source), "rate": args.rate, "loop": args.loop}
    capture |= {"left_topic": args.left_topic, "right_topic": args.right_topic}
    capture["max_stamp_offset_s"] = args.max_stamp_offset
    if args.calibration is not None:
        capture["calibration"] = str(args.calibration)
    capture |= (depth := {"full_scale_16": args.full_scale_16})
    values = {**pipeline_values(args), **files, **depth}
    outcome = run_chain(capture, values, LiveTable().show, one_process=args.one_process)
    pairs = None if args.loop else outcome.pairs
    print(f"{outcome.arrays} pose arrays received" + ("" if pairs is None else f" for {pairs} pairs"))
    if pairs is not None and not outcome.stopped:
        warn(without_partner(source, pairs), _lost(outcome, pairs, args.rate))
    return 1 if outcome.errors and outcome.objects == 0 and not outcome.stopped else 0


def _lost(outcome: Outcome, pairs: int, rate: float) -> str:
    """What to say of pairs that came to nothing, where no node has told why."""
    if outcome.arrays >= pairs or (outcome.errors and outcome.arrays == 0):
        return ""
    slower = max(_RATES[0], rate * min(1 / 2, outcome.arrays / pairs))
    return (
        f"not every pair came through: this machine is too slow for {pairs} pairs at rate {rate:g}; "
        f"use --rate {slower:.2g} or less, or `stereo-pick replay`"
    )


def run_chain(
    capture: Mapping[str, Value],
    values: Mapping[str, Value],
    show: Callable[[int, str, Positions], None],
    one_process: bool = False,
    environment: Mapping[str, str] | None = None,
) -> Outcome:
    """Start the nodes, call `show` for every PoseArray until the recording ends, and print what the nodes complain of.

    Raises SourceError where a node ends with an error.
    """
    from stereo_pick.cli.monitor import Monitor  # needs ROS, which the other subcommands start without

    stop = threading.Event()
    with Chain(environment) as chain:
        _stop_on_signals(stop)
        monitor, others_known_s = Monitor(show, _complain), time.monotonic() + _DISCOVERED_S
        warn(lack_of_profile(), lack_of_shared_memory())  # the nodes say so in their logs, which nobody sees
        try:
            if one_process:
                _spin_until(others_known_s, monitor, stop)
                _check_alone(monitor, own_poses=0)
                chain.start("stereo_pick", {**capture, **values})
            else:
                _start_downstream(chain, monitor, values, stop)
                _spin_until(max(others_known_s, time.monotonic() + _SETTLE_S), monitor, stop)
                _check_alone(monitor, own_poses=1)
                chain.start("capture", capture)
            _follow(chain, monitor, "stereo_pick" if one_process else "capture", stop)
            if not stop.is_set():
                chain.check()
        finally:
            monitor.close()
    return Outcome(monitor.captured, monitor.count, monitor.located, tuple(monitor.errors), stop.is_set())


def _complain(error: str) -> None:
    print(f"stereo-pick: error: {error}", file=sys.stderr, flush=True)


def _start_downstream(chain: Chain, monitor: Monitor, values: Mapping[str, Value], stop: threading.Event) -> None:
    """Start what listens before what speaks: images are best effort, and nobody repeats them."""
    groups = {
        "rectification": {"full_scale_16"},
        "correspondence": {"method", *declared(correspondence_groups())},
        "triangulation": {*FILE_PARAMETERS, *declared(triangulation_groups())},
    }
    for node in DOWNSTREAM:
        chain.start(node, {name: value for name, value in values.items() if name in groups.get(node, set())})
    deadline = time.monotonic() + _START_S
    while not stop.is_set() and not monitor.downstream_is_up():
        monitor.spin(_SPIN_S)
        chain.check()
        if time.monotonic() > deadline:
            raise SourceError(_no_way())


def _no_way() -> str:
    given = ", ".join(f"{name}={os.environ[name]}" for name in _OF_DISCOVERY if os.environ.get(name))
    what = f"does {given} keep them apart, or is" if given else "is"
    return f"the nodes found no way to each other within {_START_S:.0f} s: {what} the network blocked?"


def _check_alone(monitor: Monitor, own_poses: int) -> None:
    topic = monitor.taken_topic(own_poses)
    if topic is None:
        return
    domain = int(os.environ.get("ROS_DOMAIN_ID") or 0)
    raise SourceError(
        f"something else publishes {topic} in ROS domain {domain}, and its poses would mix with these: end it (once "
        f"killed it is forgotten after some 20 s), or take a domain of your own: ROS_DOMAIN_ID={(domain + 1) % 101}"
    )


def _follow(chain: Chain, monitor: Monitor, last: str, stop: threading.Event) -> None:
    """Receive until the node `last` has ended, if need be with an error, and nothing more comes."""
    while not stop.is_set() and chain.status(last) is None:
        chain.check(but=last)
        monitor.spin(_SPIN_S)
    quiet_since, count = time.monotonic(), monitor.count
    while not stop.is_set():
        patience_s = _LATE_S if monitor.is_behind and chain.runs else _QUIET_S
        if time.monotonic() - quiet_since > patience_s:
            return
        monitor.spin(_SPIN_S)
        if monitor.count > count:
            quiet_since, count = time.monotonic(), monitor.count


def _spin_until(end_s: float, monitor: Monitor, stop: threading.Event) -> None:
    while not stop.is_set() and time.monotonic() < end_s:
        monitor.spin(_SPIN_S)


def _stop_on_signals(stop: threading.Event) -> None:
    def handler(_number: int, _frame: FrameType | None) -> None:
        stop.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, handler)
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:  # its terminal was closed; nohup ignores that
        signal.signal(signal.SIGHUP, handler)
