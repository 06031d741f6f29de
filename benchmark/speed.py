"""Prints what every way from a rectified pair to positions costs, all of them in turn in one run, as Markdown.

python benchmark/speed.py [--data DIR] [--rounds N] [--write docs/speed.md]
"""

from __future__ import annotations

import argparse
import platform
import statistics
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import speed_ways
from accuracy import replace_generated
from families import staged
from formatting import Row, decimals, markdown_table
from rendering import render
from rendering.rigs import camera
from scenes import find_bench_rig, load_scenes
from speed_last_look import last_look_table
from speed_ways import FLOOR, OURS, Way

from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.camera import Camera
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.rig import StereoRig

SEEDS = range(4)
LARGE_PX = {"1080p": (1920, 1080), "4K": (3840, 2160)}
_LONG_S = 1.0  # a way that takes longer has one turn
Seconds = dict[str, list[float]]
"""Of every step of every way, one time a pair."""


def main() -> None:
    """Print the tables, or put them into a page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="folder that holds bench_rig; rendered pairs alone if there is none")
    parser.add_argument("--rounds", type=int, default=15, help="times that each way has its turn on each VGA pair")
    parser.add_argument("--write", type=Path, help="page whose generated part is replaced")
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    text = report(arguments.data, arguments.rounds)
    if arguments.write:
        replace_generated(arguments.write, text)
    else:
        print(text)


def report(data: Path | None, rounds: int) -> str:
    """All tables."""
    tables = {f"{len(SEEDS)} rendered VGA pairs": measured([_rendered(seed) for seed in SEEDS], rounds)}
    bench_pair = _bench_pair(data)
    if bench_pair:
        tables["`bench_rig/table_3_16`, VGA"] = measured([bench_pair], rounds)
    for name, size_px in LARGE_PX.items():
        tables[f"one rendered {name} pair"] = measured([_rendered(SEEDS[0], size_px)], rounds=3)
    versions = f"OpenCV {cv2.__version__}, NumPy {np.__version__}, Python {platform.python_version()}"
    return "\n\n".join(
        [
            "Four cylinders. CPU time of one thread from the rectified pair to positions: the median of the rounds in "
            f"which each way has its turn, then of the pairs. {versions}, {platform.machine()}.",
            table(tables),
            "From the raw pair to poses, one scene of each of the [surroundings](surroundings.md), VGA, both settings "
            "in turn:",
            last_look_table(),
        ]
    )


def measured(pairs: Sequence[RectifiedPair], rounds: int) -> Seconds:
    """The median time of each step on each of these pairs."""
    seconds: Seconds = {}
    for pair in pairs:
        taken: Seconds = {}
        ways = speed_ways.ways(pair)
        for _ in range(rounds):
            for way in ways:
                if way.name in taken and taken[way.name][0] > _LONG_S:
                    continue
                spent = _run(way, pair)
                if spent[way.name] < _LONG_S:  # what the other ways left in the processor's caches counts for none
                    spent = _run(way, pair)
                for step, step_s in spent.items():
                    taken.setdefault(step, []).append(step_s)
        for step, spent_s in taken.items():
            seconds.setdefault(step, []).append(statistics.median(spent_s))
    return seconds


def table(tables: dict[str, Seconds]) -> str:
    """Milliseconds, and how many times ours, side by side."""
    header = ["from the rectified pair"]
    for name in tables:
        header += [f"{name}: ms", "× ours"]
    rows: list[Row] = []
    for step in next(iter(tables.values())):
        row = [step]
        for seconds in tables.values():
            if step not in seconds:
                row += ["–", "–"]
                continue
            spent, ours = statistics.median(seconds[step]), statistics.median(seconds[OURS])
            row += [decimals(spent * 1000, 2), decimals(spent / ours, 2)]
        rows.append(row)
    floors = [statistics.median(s[OURS]) / statistics.median(s[FLOOR]) for s in tables.values()]
    rows.append(["ours in floors", *(cell for ratio in floors for cell in ("", decimals(ratio, 1)))])
    return markdown_table(header, rows)


def _run(way: Way, pair: RectifiedPair) -> dict[str, float]:
    """CPU time [s] of the way and, where it has several, of its steps."""
    spent, state = {way.name: 0.0}, pair
    for name, step in way.steps.items():
        start = time.process_time()
        state = step(state)
        taken = time.process_time() - start
        spent[way.name] += taken
        if len(way.steps) > 1:
            spent[f"– {name}"] = taken
    return spent


def _bench_pair(data: Path | None) -> RectifiedPair | None:
    try:
        folder = find_bench_rig(data)
    except SystemExit:
        return None
    (scene,) = (scene for scene in load_scenes(folder) if scene.group == "table_3_16")
    return Rectifier(load_rig(folder / "calibration" / "truth")).rectify(scene.frame)


def _rendered(seed: int, size_px: tuple[int, int] | None = None) -> RectifiedPair:
    scene = staged("four_cylinders", seed)
    rig = _enlarged(scene.rig, size_px) if size_px else scene.rig
    return Rectifier(rig).rectify(render(rig, scene.scene, scene.left, scene.right, seed))


def _enlarged(rig: StereoRig, size_px: tuple[int, int]) -> StereoRig:
    """The same lenses before a sensor of smaller pixels, its upper and lower ends left out."""
    resized = partial(_resized, size_px=size_px)
    return StereoRig.from_extrinsics(resized(rig.left), resized(rig.right), rig.right_T_left)


def _resized(lens: Camera, size_px: tuple[int, int]) -> Camera:
    factor = size_px[0] / lens.width_px
    cut_px = (lens.height_px * factor - size_px[1]) / 2
    focal, centre = lens.K[[0, 1], [0, 1]] * factor, (lens.K[:2, 2] + 0.5) * factor - (0.5, 0.5 + cut_px)
    return camera(lens.name, (focal[0], focal[1]), (centre[0], centre[1]), lens.D, lens.distortion_model, size_px)


if __name__ == "__main__":
    main()
