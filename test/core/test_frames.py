"""Pairs on their way: a type is the proof that its step was done."""

from __future__ import annotations

import numpy as np
import pytest
from outlines import PARALLEL
from rigs import SIZE_PX

from stereo_pick.core.errors import ImageError
from stereo_pick.core.frames import RectifiedPair, StereoFrame, check_size, grey

SHAPE = SIZE_PX[::-1]


def black(*shape: int) -> np.ndarray:
    return np.zeros(shape, np.uint8)


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize(
    "bad", [np.zeros(SHAPE, np.uint16), black(0, 640), black(480, 640, 2)], ids=lambda b: str(b.shape)
)
def test_a_frame_refuses_what_is_no_image_and_says_which(side: str, bad: np.ndarray) -> None:
    images = {"left": black(*SHAPE), "right": black(*SHAPE), side: bad}
    with pytest.raises(ImageError, match=f"{side} image"):
        StereoFrame(**images)


def test_an_image_of_another_size_is_refused_with_both_sizes() -> None:
    with pytest.raises(ImageError, match="left image is 320 x 240, but the calibration is for 640 x 480: calibrate at"):
        check_size("left image", black(240, 320), SIZE_PX)


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_rectified_pair_has_the_rigs_size(side: str) -> None:
    images = {"left": black(*SHAPE), "right": black(*SHAPE), side: black(240, 320)}
    with pytest.raises(ImageError, match=f"rectified {side} image is 320 x 240"):
        RectifiedPair(rig=PARALLEL, **images)


def test_the_images_of_a_pair_cannot_be_changed() -> None:
    pair = RectifiedPair(black(*SHAPE), black(*SHAPE), PARALLEL)
    with pytest.raises(ValueError, match="read-only"):
        pair.left[0, 0] = 1


def test_grey_is_the_luminance_of_BGR() -> None:
    bgr = np.broadcast_to(np.array([10, 100, 200], np.uint8), (4, 4, 3)).copy()
    assert abs(int(grey(bgr)[0, 0]) - (0.114 * 10 + 0.587 * 100 + 0.299 * 200)) <= 1
    plain = black(4, 4)
    assert grey(plain) is plain
