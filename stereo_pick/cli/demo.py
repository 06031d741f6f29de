"""`stereo-pick demo`: the four nodes on the demo bag, beside the known truth."""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations
from pathlib import Path

import numpy as np

from stereo_pick.cli.live_table import Positions
from stereo_pick.cli.locate import write_picture
from stereo_pick.cli.run import run_chain
from stereo_pick.core.configuration import steps
from stereo_pick.core.errors import ParameterError, SourceError
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.matches.assignment import assign
from stereo_pick.core.pipeline import Pipeline
from stereo_pick.core.rig import StereoRig
from stereo_pick.sources.opening import open_source

_GATE_M = 0.03  # further away an estimate belongs to no true object
_MAX_MEAN_DEPTH_ERROR_M = 0.0015
_FASTEST, _SLOWEST = 0.1, 0.01  # of its speed, at which the bag is played
_SLACK = 1.3  # by which a pair may take longer in the nodes than here
_DOMAINS = range(91, 101)  # from 102 on Linux may have given their ports to others
_TRIES = 3  # each at half the speed, where the machine got too busy for the one before

_DESCRIPTION = """\
Replay the demo bag (a rendered conveyor scene with exactly known positions) through the four nodes, each a process of
its own, over real DDS; show the poses as they come beside the truth; write an annotated picture; end with a verdict."""

Truth = dict[str, tuple[float, float, float]]


@dataclass
class Score:
    """What the received poses are worth, measured against the truth."""

    truth: dict[int, Truth]
    frames: int = 0
    missed: int = 0
    ghosts: int = 0
    errors_m: list[float] = field(default_factory=list)
    depth_errors_m: list[float] = field(default_factory=list)

    def receive(self, stamp_ns: int, _frame_id: str, positions: Positions) -> None:
        """Score one PoseArray, and print it beside the truth."""
        truth = self.truth.get(stamp_ns, {})
        names, points = list(truth), np.array(list(truth.values())).reshape(-1, 3)
        found = np.array(positions).reshape(-1, 3)
        distance = np.linalg.norm(points[:, None] - found[None], axis=2)
        pairs = assign(np.where(distance < _GATE_M, distance, np.inf), unmatched_cost=_GATE_M)
        self.frames += 1
        self.missed += len(points) - len(pairs)
        self.ghosts += len(found) - len(pairs)
        self.errors_m += [float(distance[pair]) for pair in pairs]
        dz = {i: float(found[j, 2] - points[i, 2]) for i, j in pairs}
        self.depth_errors_m += [abs(dz[a] - dz[b]) for a, b in combinations(dz, 2)]
        for i, j in pairs:
            measured, true = (" ".join(f"{value * 1e3:8.1f}" for value in row) for row in (found[j], points[i]))
            print(
                f"{stamp_ns / 1e9 % 1000:8.3f} {names[i]:<10} {measured}  {true} {distance[i, j] * 1e3:7.1f}",
                flush=True,
            )

    def verdict(self) -> tuple[bool, str]:
        """Whether all is as it should be, and one line that says what came out."""
        mean_depth_error_m = float(np.mean(self.depth_errors_m)) if self.depth_errors_m else np.inf
        complete = self.frames == len(self.truth) and self.missed == self.ghosts == 0
        good = complete and mean_depth_error_m <= _MAX_MEAN_DEPTH_ERROR_M
        if not self.errors_m:
            return False, f"demo: FAILED: {self.frames} of {len(self.truth)} pairs received, no object found"
        return good, (
            f"demo: {'OK' if good else 'FAILED'}: {self.frames} of {len(self.truth)} pairs, "
            f"{len(self.errors_m)} objects found, {self.missed} missed, {self.ghosts} ghosts; "
            f"position error mean {np.mean(self.errors_m) * 1e3:.2f} mm, max {max(self.errors_m) * 1e3:.2f} mm; "
            f"depth between objects: mean error {mean_depth_error_m * 1e3:.2f} mm"
        )


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `demo` subcommand."""
    parser = subparsers.add_parser("demo", help="replay the demo bag beside its truth", description=_DESCRIPTION)
    parser.add_argument(
        "--output", type=Path, default=Path("demo_output"), metavar="DIR", help="for the picture (default: %(default)s)"
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Run the demo until its verdict, or Ctrl-C, which is no failure.

    Raises SourceError where its bag is not installed, ParameterError on an unusable --output.
    """
    bags = find_bags()
    try:
        args.output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ParameterError(f"--output {args.output} cannot be made: {error.strerror}; name a folder") from None
    # A controller that waits for poses in the domain that is set must not get those of the demo.
    os.environ |= {"ROS_DOMAIN_ID": str(own_domain()), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    picture = args.output / "annotated.png"
    try:
        pair_s = _draw(bags / "demo", picture)
    except KeyboardInterrupt:
        print("demo: stopped before the first pair")
        return 0
    score, stopped = _replayed(bags, pair_s)
    if stopped:
        print(f"demo: stopped after {score.frames} of {len(score.truth)} pairs")
        return 0
    good, line = score.verdict()
    print(f"annotated picture: {picture}")
    print(line)
    return 0 if good else 1


def _replayed(bags: Path, pair_s: float) -> tuple[Score, bool]:
    """What came of the bag, and whether a signal ended it; once more, and slower, where pairs were lost on the way.

    pair_s: how long a pair takes.
    """
    truth, header = load_truth(bags / "demo_truth.json"), ("x, y, z measured [mm]", "x, y, z true [mm]")
    score, rate = Score(truth), rate_for(list(truth), pair_s)
    for _ in range(_TRIES):
        score = Score(truth)
        print("starting four nodes on the demo bag ...", flush=True)
        print(f"{'time s':>8} {'object':<10} {header[0]:>26}  {header[1]:>26} {'error':>7}", flush=True)
        outcome = run_chain({"source": str(bags / "demo"), "rate": rate}, {}, score.receive)
        if outcome.stopped or score.frames >= len(truth):
            return score, outcome.stopped
        print(f"{score.frames} of {len(truth)} pairs came through: this machine is busy", flush=True)
        rate = max(rate / 2, _SLOWEST)
    return score, False


def rate_for(stamps_ns: Sequence[int], pair_s: float) -> float:
    """The speed at which nodes that need so long for a pair keep up with pairs of these stamps."""
    interval_s = (max(stamps_ns) - min(stamps_ns)) / 1e9 / max(len(stamps_ns) - 1, 1)
    return min(max(interval_s / (_SLACK * pair_s), _SLOWEST), _FASTEST)


def own_domain() -> int:
    """A ROS domain that hardly anything else is in: not the one that is set, and a high one."""
    free = [domain for domain in _DOMAINS if str(domain) != os.environ.get("ROS_DOMAIN_ID")]
    return free[os.getpid() % len(free)]


def find_bags() -> Path:
    """The folder of the demo bag: in the checkout, or where the package was installed."""
    for parent in Path(__file__).resolve().parents:
        for folder in (parent / "bags", parent / "share" / "stereo_pick" / "bags"):
            if (folder / "demo_truth.json").is_file():
                return folder
    raise SourceError("the demo bag is not installed: run the demo in a checkout of stereo_pick")


def load_truth(path: Path) -> dict[int, Truth]:
    """The true positions [m] by stamp [ns] and name."""
    frames = json.loads(path.read_text())["frames"]
    return {frame["stamp_ns"]: {o["name"]: tuple(o["position_m"]) for o in frame["objects"]} for frame in frames}


def _draw(bag: Path, picture: Path) -> float:
    """Draw what the same core finds in the last pair; how long [s] that took it."""
    source = open_source(bag)
    cameras = source.cameras
    if cameras is None:
        raise SourceError(f"{bag} holds no camera_info")
    *_, last = source
    pipeline, frame = Pipeline(StereoRig.from_cameras(*cameras), steps({})), StereoFrame(*last.images(), last.stamp_ns)
    began_s = time.perf_counter()
    result = pipeline.run(frame)
    pair_s = time.perf_counter() - began_s
    write_picture(picture, result)
    return pair_s
