"""Compares the joint refinement with OpenCV's fixed intrinsics on views that took no part, as Markdown.

python benchmark/calibration.py [--data DIR]
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from formatting import decimals, markdown_table

from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.detection import BoardImages, detect
from stereo_pick.core.calibration.held_out import FOLDS, Cameras, HeldOut, epipolar_px, length_errors_m
from stereo_pick.core.calibration.parameters import transform
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate_best
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.camera import Camera
from stereo_pick.core.frames import grey
from stereo_pick.core.images import read_image

Calibrate = Callable[[Sequence[BoardView]], Cameras]


class Recording(NamedTuple):
    name: str
    left: str
    right: str
    board: Chessboard


RECORDINGS = (
    Recording("bouguet_stereo", "left*.jpg", "right*.jpg", Chessboard(9, 6, 0.030)),
    Recording("vigir2023_puma/calib", "left*.png", "right*.png", Chessboard(8, 6, 0.025)),
    Recording("sourishg/set1", "left*.jpg", "right*.jpg", Chessboard(9, 6, 0.02423)),
    Recording("bench_rig/calibration", "pair_*/left.png", "pair_*/right.png", Chessboard(9, 6, 0.029)),
)


def main() -> None:
    """Print the table of the recordings that are there."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="folder of the recordings; else STEREO_PICK_DATA")
    named = parser.parse_args().data or os.environ.get("STEREO_PICK_DATA")
    if not named:
        parser.error("name the folder of the recordings: --data DIR")
    rows = [
        row
        for recording in RECORDINGS
        if (Path(named) / recording.name).is_dir()
        for row in compare(recording, Path(named))
    ]
    header = ("recording", "method", "views", "held-out epipolar rms, px", "median, px", "board lengths rms, mm")
    print(f"{FOLDS} folds over the views; OpenCV {cv2.__version__}. The same corners for both.\n")
    print(markdown_table(header, rows))


def calibrated(recording: Recording, data: Path) -> CalibrationResult:
    """What `stereo-pick calibrate` makes of a recording."""
    folder, board = data / recording.name, recording.board
    files = zip(sorted(folder.glob(recording.left)), sorted(folder.glob(recording.right)))
    images = (BoardImages(left.name, left.name, right.name, *map(read, (left, right))) for left, right in files)
    return calibrate_best(detect(images, board), board)


def compare(recording: Recording, data: Path) -> Iterator[tuple[str, ...]]:
    result, board = calibrated(recording, data), recording.board
    assert result.held_out is not None
    size_px = result.solution.size_px
    opencv = hold_out(board, result.views, lambda views: fixed_intrinsics(board, views, size_px))
    for method, errors in (("joint refinement", result.held_out), ("OpenCV, intrinsics fixed", opencv)):
        yield (
            recording.name,
            method,
            str(len(result.views)),
            decimals(errors.epipolar_rms_px, 4),
            decimals(float(np.median(errors.epipolar_px)), 4),
            decimals(errors.length_rms_m * 1000, 3),
        )


def read(path: Path) -> np.ndarray:
    return grey(read_image(path))


def hold_out(board: Chessboard, views: Sequence[BoardView], calibrate: Calibrate) -> HeldOut:
    """Errors of the views in each fold after calibrating from the others."""
    epipolar, length = list[np.ndarray](), list[np.ndarray]()
    for fold in range(FOLDS):
        cameras = calibrate([view for i, view in enumerate(views) if i % FOLDS != fold])
        for i in range(fold, len(views), FOLDS):
            epipolar.append(epipolar_px(cameras, views[i]))
            length.append(length_errors_m(cameras, views[i], board))
    return HeldOut(np.concatenate(epipolar), np.concatenate(length))


def fixed_intrinsics(board: Chessboard, views: Sequence[BoardView], size_px: tuple[int, int]) -> Cameras:
    """The usual recipe: each camera alone, then stereoCalibrate with CALIB_FIX_INTRINSIC."""
    points = [board.object_points().astype(np.float32)] * len(views)
    sides = [[getattr(view, side).astype(np.float32) for view in views] for side in ("left_px", "right_px")]
    alone = [cv2.calibrateCamera(points, side, size_px, None, None, flags=cv2.CALIB_FIX_K3)[1:3] for side in sides]
    tight = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 200, 1e-9)
    R, T = cv2.stereoCalibrate(
        points, *sides, *alone[0], *alone[1], size_px, criteria=tight, flags=cv2.CALIB_FIX_INTRINSIC
    )[5:7]
    left, right = (
        Camera(name, *size_px, K, D.ravel()[:5], np.eye(3), np.eye(3, 4))
        for name, (K, D) in zip(("left", "right"), alone)
    )
    return left, right, transform(cv2.Rodrigues(R)[0], T)


if __name__ == "__main__":
    main()
