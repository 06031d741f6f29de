"""Prints how well the windows of method `ssd` match every pixel of textured pictures with dense truth, as Markdown.

python benchmark/dense.py [--data DIR]
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from formatting import decimals, markdown_table

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.windows.dense import disparity_map
from stereo_pick.core.windows.matching import WindowMatching
from stereo_pick.core.windows.sweep import sweep

Matcher = Callable[[Image, Image, tuple[int, int]], Floats]
_PLAIN_WINDOW_PX = 9
_SGBM_WINDOW_PX = 5


class Picture(NamedTuple):
    """A rectified pair, the true disparity (H, W) of its left view, NaN where unknown, and the range to search [px]."""

    name: str
    left: Image
    right: Image
    truth_px: Floats
    limits_px: tuple[int, int]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="folder that holds middlebury; else STEREO_PICK_DATA")
    named = parser.parse_args().data or os.environ.get("STEREO_PICK_DATA")
    if not named:
        parser.error("name the folder of the recordings: --data DIR")
    cv2.setNumThreads(1)
    header = ("picture", "matcher", "accepted", "bad > 1 px", "bad > 2 px", "median error px", "CPU time × SGBM")
    print(markdown_table(header, [row for picture in pictures(Path(named)) for row in compare(picture)]))


def pictures(data: Path) -> list[Picture]:
    """The Middlebury pairs `cones` (2003) and `motorcycle` (2014, a quarter of the size)."""
    cones, motorcycle = data / "middlebury" / "cones", data / "middlebury" / "motorcycle_q"
    cones_px = cv2.imread(str(cones / "disp2.pgm"), cv2.IMREAD_UNCHANGED) / 4.0
    motorcycle_px = np.load(motorcycle / "disp.npz")["arr_0"].astype(np.float64)
    return [
        Picture("cones", _grey(cones / "im2.png"), _grey(cones / "im6.png"), _known(cones_px), (0, 63)),
        Picture(
            "motorcycle_q",
            _grey(motorcycle / "left.png"),
            _grey(motorcycle / "right.png"),
            _known(motorcycle_px),
            (0, 70),
        ),
    ]


def compare(picture: Picture) -> list[tuple[str, ...]]:
    """A row a matcher; the share of bad pixels is that of the accepted ones of known depth."""
    matchers: dict[str, Matcher] = {
        "windows, ZNCC": _windows("zncc"),
        "windows, SSD": _windows("ssd"),
        f"plain SSD {_PLAIN_WINDOW_PX} × {_PLAIN_WINDOW_PX}, as it comes": _plain,
        "OpenCV StereoSGBM": _sgbm,
    }
    taken = {name: _timed(matcher, picture) for name, matcher in matchers.items()}
    unit_s = taken["OpenCV StereoSGBM"][1]
    return [
        (picture.name, name, *score(disparity_px, picture.truth_px).cells(), decimals(seconds / unit_s, 1))
        for name, (disparity_px, seconds) in taken.items()
    ]


class Score(NamedTuple):
    """Parts of the known pixels that were accepted, and of these that are wrong; and the median error [px]."""

    accepted: float
    bad_1: float
    bad_2: float
    median_px: float

    def cells(self) -> tuple[str, ...]:
        parts = (self.accepted, self.bad_1, self.bad_2)
        return (*(f"{decimals(100 * part, 1)} %" for part in parts), decimals(self.median_px, 3))


def score(disparity_px: Floats, truth_px: Floats) -> Score:
    """Compare disparities with the truth, both (H, W), NaN where there is none."""
    known = np.isfinite(truth_px)
    error = np.abs(disparity_px - truth_px)[known & np.isfinite(disparity_px)]
    accepted = len(error) / np.count_nonzero(known)
    return Score(accepted, float((error > 1).mean()), float((error > 2).mean()), float(np.median(error)))


def _windows(cost: str) -> Matcher:
    matching = WindowMatching(cost=cost)
    return lambda left, right, limits_px: disparity_map(left, right, limits_px, matching).disparity_px


def _plain(left: Image, right: Image, limits_px: tuple[int, int]) -> Floats:
    """Least SSD of one window, taken as it comes."""
    views = (view.astype(np.float32) for view in (left, right))
    return sweep(*views, limits_px, _PLAIN_WINDOW_PX, "ssd", shifted=False).disparity_px.astype(np.float64)


def _sgbm(left: Image, right: Image, limits_px: tuple[int, int]) -> Floats:
    area, count = _SGBM_WINDOW_PX**2, -(-(limits_px[1] + 1) // 16) * 16
    matcher = cv2.StereoSGBM.create(
        0, count, _SGBM_WINDOW_PX, P1=8 * area, P2=32 * area, disp12MaxDiff=1, uniquenessRatio=10
    )
    padded = (cv2.copyMakeBorder(view, 0, 0, count, 0, cv2.BORDER_REPLICATE) for view in (left, right))
    found = matcher.compute(*padded)[:, count:]
    return np.where(found < 0, np.nan, found / 16.0)


def _timed(matcher: Matcher, picture: Picture) -> tuple[Floats, float]:
    start = time.process_time()
    disparity_px = matcher(picture.left, picture.right, picture.limits_px)
    return disparity_px, time.process_time() - start


def _grey(path: Path) -> Image:
    return np.asarray(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE), np.uint8)


def _known(truth_px: Floats) -> Floats:
    return np.where(np.isfinite(truth_px) & (truth_px > 0), truth_px, np.nan)


if __name__ == "__main__":
    main()
