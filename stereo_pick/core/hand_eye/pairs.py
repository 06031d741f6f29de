"""Pairs of a robot pose and a board view: what they must be like to determine anything."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import combinations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.hand_eye.reach import check_reach
from stereo_pick.core.hand_eye.rotations import rotation_vector
from stereo_pick.core.transform import Transform

MIN_PAIRS = 3
MIN_TURN_DEG = 5.0
MIN_OFF_AXIS_DEG = 3.0


class Mount(Enum):
    """Where the camera is: fixed, the board on the flange; or on the flange, the board fixed."""

    EYE_TO_HAND = "eye-to-hand"
    EYE_IN_HAND = "eye-in-hand"

    @property
    def other(self) -> Mount:
        """The mount that this one is not."""
        return Mount.EYE_IN_HAND if self is Mount.EYE_TO_HAND else Mount.EYE_TO_HAND

    @property
    def parent(self) -> str:
        """In what the camera is fixed."""
        return "base" if self is Mount.EYE_TO_HAND else "flange"


@dataclass(frozen=True)
class RobotView:
    """Where the robot said that its flange was, and where the camera saw the board, at one moment."""

    name: str
    base_T_flange: Transform
    camera_T_board: Transform

    def stand_T_parent(self, mount: Mount) -> Transform:
        """From what carries the camera to what carries the board: `A` of `A X B = Y`."""
        return self.base_T_flange if mount is Mount.EYE_IN_HAND else self.base_T_flange.inverse()


def check(views: Sequence[RobotView]) -> None:
    """Raise CalibrationError, with the measured value, where no solver could find anything in these pairs."""
    if len(views) < MIN_PAIRS:
        raise CalibrationError(
            f"{len(views)} pairs of robot pose and board view: at least {MIN_PAIRS} are needed, 12 or more are good"
        )
    for view in views:
        check_reach(f"{view.name}: the flange", view.base_T_flange.translation, "base")
    for what, poses in (
        ("the robot's poses", [view.base_T_flange for view in views]),
        ("the board's views", [view.camera_T_board for view in views]),
    ):
        _check_turns(what, _turns_deg(poses))


def _turns_deg(poses: Sequence[Transform]) -> Floats:
    """Rotation vectors (M, 3) [deg] between any two of the poses, M >= 1."""
    between = np.array([a.rotation.T @ b.rotation for a, b in combinations(poses, 2)])
    return np.degrees(rotation_vector(between))


def _check_turns(what: str, turns_deg: Floats) -> None:
    largest_deg = float(np.linalg.norm(turns_deg, axis=1).max())
    if largest_deg < MIN_TURN_DEG:
        raise CalibrationError(
            f"{what} differ by {largest_deg:.2f} deg at most: without rotation (at least {MIN_TURN_DEG:g} deg, 30 are "
            "good) nothing tells where the camera is; tilt the flange between the views"
        )
    axis = np.linalg.svd(turns_deg)[2][0]
    off_axis_deg = float(np.linalg.norm(turns_deg - np.outer(turns_deg @ axis, axis), axis=1).max())
    if off_axis_deg < MIN_OFF_AXIS_DEG:
        raise CalibrationError(
            f"{what} are all turned about one axis ({largest_deg:.1f} deg about it, {off_axis_deg:.2f} deg off it; at "
            f"least {MIN_OFF_AXIS_DEG:g} are needed): the position along that axis stays open; turn about a second one"
        )
