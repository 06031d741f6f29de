"""How a learned surface that was moved is found again."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects.moved_surface import Picture, continued, has_moved, motion_of

SIZE_PX = (640, 480)
INSIDE = np.ones(SIZE_PX[::-1], bool)
SIGMA = 0.7
CORNERS = np.array([[60.0, 60, 1], [580, 60, 1], [60, 420, 1], [580, 420, 1]])


def printed(seed: int = 0) -> Picture:
    """A dozen labels on grey, as a view shows them."""
    rng = np.random.default_rng(seed)
    picture = np.full(SIZE_PX[::-1], 80.0, np.float32)
    for _ in range(12):
        corners = cv2.boxPoints((rng.uniform((40, 40), (600, 440)), rng.uniform(20, 90, 2), float(rng.uniform(0, 90))))
        cv2.fillConvexPoly(picture, corners.astype(np.int32), float(rng.choice([40.0, 130.0, 180.0])))
    return np.asarray(cv2.GaussianBlur(picture, (0, 0), 1.2), np.float32)


def pushed(picture: Picture, right_px: float, down_px: float, turn_deg: float) -> tuple[Picture, Floats]:
    """The same after a push, noisy, and with a part on it; and where each of its pixels was before."""
    to = cv2.getRotationMatrix2D((320, 240), turn_deg, 1.0) + np.array([[0, 0, right_px], [0, 0, down_px]])
    moved = cv2.warpAffine(picture, to, SIZE_PX, None, cv2.INTER_CUBIC, cv2.BORDER_REPLICATE)
    moved += np.random.default_rng(1).normal(0, SIGMA, moved.shape)
    moved[150:300, 200:380] = 230.0
    return np.asarray(moved, np.float32), cv2.invertAffineTransform(to)


@pytest.mark.parametrize(
    ("right_px", "down_px", "turn_deg"), [(0.4, 0.0, 0.0), (-2.0, 1.0, 0.0), (5.0, -4.0, 0.0), (1.0, 0.0, 0.8)]
)
def test_a_push_is_found_to_a_part_of_a_pixel(right_px: float, down_px: float, turn_deg: float) -> None:
    learned = printed()
    seen, before = pushed(learned, right_px, down_px, turn_deg)
    assert has_moved(learned, seen, INSIDE, SIGMA)
    motion = motion_of(learned, seen, INSIDE, SIGMA)
    assert motion is not None
    np.testing.assert_allclose(CORNERS @ motion.warp.T, CORNERS @ before.T, atol=0.15)
    if not turn_deg:
        assert motion.px == pytest.approx(np.hypot(right_px, down_px), abs=0.1)


def test_what_lies_where_it_lay_has_not_moved_whatever_lies_on_it() -> None:
    learned = printed()
    seen, _ = pushed(learned, 0.0, 0.0, 0.0)
    assert not has_moved(learned, seen, INSIDE, SIGMA)


def test_a_surface_without_edges_does_not_tell() -> None:
    even = np.full(SIZE_PX[::-1], 80.0, np.float32)
    assert not has_moved(even, printed(), INSIDE, SIGMA)


def test_other_labels_are_not_the_same_ones_moved() -> None:
    learned, seen = printed(0), printed(1)
    assert has_moved(learned, seen, INSIDE, SIGMA)
    assert motion_of(learned, seen, INSIDE, SIGMA) is None


def test_what_comes_into_view_is_as_what_is_beside_it() -> None:
    inside = INSIDE.copy()
    inside[:, :100] = False
    learned = np.where(inside, 80.0, 0.0).astype(np.float32)
    np.testing.assert_allclose(continued(learned, inside)[:, 85:], 80.0, atol=0.1)
