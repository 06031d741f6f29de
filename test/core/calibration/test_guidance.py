"""What is still to be shown: against boards whose pose is known."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from simulated_views import BOARD, RIG, SIZE_PX

from stereo_pick.core.calibration.guidance import WANTED_VIEWS, guide
from stereo_pick.core.calibration.views import BoardView


def view(turn_deg: tuple[float, float, float] = (0, 0, 0), x_m: float = 0.0, y_m: float = 0.0) -> BoardView:
    """The board 0.6 m away, turned about x, y and z."""
    R = cv2.Rodrigues(np.radians(np.array(turn_deg, float)))[0]
    points = (BOARD.object_points() - BOARD.object_points().mean(axis=0)) @ R.T + [x_m, y_m, 0.6]
    return BoardView("view", *RIG.project(points))


def missing(*views: BoardView) -> str:
    return "; ".join(guide(views, SIZE_PX, BOARD).missing)


def test_at_first_everything_is_missing() -> None:
    guidance = guide([], SIZE_PX, BOARD)
    assert guidance.left_empty.all()
    assert guidance.right_empty.all()
    assert guidance.facing == ("left", "right", "up", "down")
    assert f"{WANTED_VIEWS} more views" in guidance.missing[0]


@pytest.mark.parametrize(
    ("turn_deg", "facing"),
    [((0, 25, 0), "left"), ((0, -25, 0), "right"), ((25, 0, 0), "down"), ((-25, 0, 0), "up")],
)
@pytest.mark.parametrize("spin_deg", [0, 180])
def test_a_turned_board_faces_where_its_normal_points(
    turn_deg: tuple[float, float, float], facing: str, spin_deg: float
) -> None:
    R = cv2.Rodrigues(np.radians(np.array(turn_deg, float)))[0]
    front = R @ [0, 0, -1]
    axis = int(np.argmax(np.abs(front[:2])))
    assert facing == (("left", "right"), ("up", "down"))[axis][int(front[axis] > 0)]
    spun = cv2.Rodrigues(R @ cv2.Rodrigues(np.array([0, 0, np.radians(spin_deg)]))[0])[0].ravel()
    found = guide([view(tuple(np.degrees(spun)))], SIZE_PX, BOARD)
    assert {"left", "right", "up", "down"} - set(found.facing) == {facing}


def test_a_board_that_faces_the_camera_is_turned_to_no_side() -> None:
    assert "face left, right, up, down" in missing(view())


def test_parts_of_the_images_that_no_board_reached_are_named() -> None:
    everywhere = [view(x_m=x, y_m=y) for x in (-0.15, 0, 0.15) for y in (-0.12, 0, 0.12)]
    assert "image's" not in missing(*everywhere)
    without = guide([each for each in everywhere if each.left_px[:, 0].min() > 250], SIZE_PX, BOARD)
    assert without.left_empty[:, 0].all()
    assert not without.left_empty[:, 2].any()
    assert "left image's upper left, middle left, lower left" in "; ".join(without.missing)


def test_a_good_set_lacks_nothing() -> None:
    turns = [(0, 25, 0), (0, -25, 0), (25, 0, 0), (-25, 0, 0)]
    views = [
        view(turns[(i + j) % 4], x, y) for i, x in enumerate((-0.15, 0, 0.15)) for j, y in enumerate((-0.12, 0, 0.12))
    ]
    assert missing(*views) == f"{WANTED_VIEWS - 9} more views"
    assert missing(*views, *views) == ""
