"""Compares the joint refinement with OpenCV's fixed intrinsics on views that took no part, as Markdown.

python benchmark/calibration.py [--data DIR]
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from formatting import decimals, markdown_table

from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.detection import BoardImages, detect
from stereo_pick.core.calibration.held_out import FOLDS, Cameras, HeldOut, epipolar_px, length_errors_m
from stereo_pick.core.calibration.parameters import USUAL, DistortionModel, transform
from stereo_pick.core.calibration.refinement import refine
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate_best
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.camera import Camera
from stereo_pick.core.frames import grey
from stereo_pick.core.images import read_image

Calibrate = Callable[[list[int]], Cameras]


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
    rows = [compare(recording, Path(named)) for recording in RECORDINGS if (Path(named) / recording.name).is_dir()]
    header = (
        *("recording", "views", "epipolar rms, px: joint", "OpenCV", "per fold: joint - OpenCV", "so the joint one"),
        *("median, px: joint", "OpenCV", "board lengths rms, mm: joint", "OpenCV"),
    )
    print(
        f"On views that took no part, in {FOLDS} folds; OpenCV {cv2.__version__}. The same views, corners, folds and "
        "distortion coefficients for both;\nthe difference with its standard error, by which less than two is a tie.\n"
    )
    print(markdown_table(header, rows))


def calibrated(recording: Recording, data: Path) -> CalibrationResult:
    """What `stereo-pick calibrate` makes of a recording."""
    folder, board = data / recording.name, recording.board
    files = zip(sorted(folder.glob(recording.left)), sorted(folder.glob(recording.right)))
    images = (BoardImages(left.name, left.name, right.name, *map(read, (left, right))) for left, right in files)
    return calibrate_best(detect(images, board), board)


def compare(recording: Recording, data: Path) -> tuple[str, ...]:
    result, board = calibrated(recording, data), recording.board
    views, solution = result.views, result.solution

    def joint(kept: list[int]) -> Cameras:
        poses = [solution.poses[i] for i in kept]
        return refine(board, [views[i] for i in kept], solution.cameras, poses, solution.model).cameras

    def opencv(kept: list[int]) -> Cameras:
        return fixed_intrinsics(board, [views[i] for i in kept], solution.size_px, solution.model)

    methods = [hold_out(board, views, calibrate) for calibrate in (joint, opencv)]
    whole = [
        HeldOut(*(np.concatenate(part) for part in zip(*((e.epipolar_px, e.length_m) for e in folds))))
        for folds in methods
    ]
    return (
        recording.name,
        str(len(views)),
        *(decimals(errors.epipolar_rms_px, 4) for errors in whole),
        *difference(*([fold.epipolar_rms_px for fold in folds] for folds in methods)),
        *(decimals(float(np.median(errors.epipolar_px)), 4) for errors in whole),
        *(decimals(errors.length_rms_m * 1000, 3) for errors in whole),
    )


def difference(joint_px: list[float], opencv_px: list[float]) -> tuple[str, str]:
    """The mean difference of the folds [px] with its standard error, and what it says."""
    of_folds = np.subtract(joint_px, opencv_px)
    mean, error = float(of_folds.mean()), float(of_folds.std(ddof=1) / np.sqrt(len(of_folds)))
    said = "ties" if abs(mean) < 2 * error else "wins" if mean < 0 else "loses"
    return f"{decimals(mean, 4)} ± {decimals(error, 4)}", said


def float32(values: np.ndarray) -> np.ndarray:
    return np.asarray(values, np.float32)


def read(path: Path) -> np.ndarray:
    return grey(read_image(path))


def hold_out(board: Chessboard, views: Sequence[BoardView], calibrate: Calibrate) -> list[HeldOut]:
    """Errors of the views in each fold after calibrating from the others; calibrate takes the numbers of those."""
    folds = list[HeldOut]()
    for fold in range(FOLDS):
        cameras = calibrate([i for i in range(len(views)) if i % FOLDS != fold])
        held = [views[i] for i in range(fold, len(views), FOLDS)]
        epipolar = [epipolar_px(cameras, view) for view in held]
        folds.append(
            HeldOut(np.concatenate(epipolar), np.concatenate([length_errors_m(cameras, v, board) for v in held]))
        )
    return folds


def fixed_intrinsics(
    board: Chessboard, views: Sequence[BoardView], size_px: tuple[int, int], model: DistortionModel
) -> Cameras:
    """The usual recipe: each camera alone, then stereoCalibrate with CALIB_FIX_INTRINSIC on what both images show."""
    tight = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 200, 1e-9)
    fixed = cv2.CALIB_FIX_K3 if model is USUAL else 0
    alone = []
    for side in (0, 1):
        points, corners = [
            [float32(each[side]) for each in of]
            for of in ([view.points(board) for view in views], [view.corners_px for view in views])
        ]
        alone.append(cv2.calibrateCamera(points, corners, size_px, None, None, flags=fixed, criteria=tight)[1:3])
    both = [view.in_both() for view in views]
    points = [float32(view.points(board)[0]) for view in both]
    sides = [[float32(view.corners_px[side]) for view in both] for side in (0, 1)]
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
