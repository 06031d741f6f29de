"""Cameras whose driver sends their last image again and again."""

from __future__ import annotations

from array import array

import numpy as np
import pytest

from stereo_pick.core.hanging import STILL, HangWatch
from stereo_pick.core.pairing import Side

NOISE = [np.random.default_rng(seed).integers(0, 256, 96, np.uint8) for seed in range(8)]
EVEN = np.full(96, 7, np.uint8)


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("kept", [np.copy, np.ndarray.tobytes, lambda data: array("B", data.tobytes())])
def test_one_camera_that_repeats_its_image_is_named_until_it_goes_on(side: Side, kept: object) -> None:
    watch = HangWatch()
    still = [0, 1, 1, 1, 2, 3]
    found = []
    for number, shown in enumerate(still):
        images = kept(NOISE[shown]), kept(NOISE[number])  # type: ignore[operator]
        found.append(watch.hanging(*(images if side == "left" else images[::-1])))
    assert found == [None, None, side, side, None, None]


def test_both_that_repeat_theirs_are_counted_and_none_is_named() -> None:
    watch = HangWatch()
    assert [watch.hanging(NOISE[0], NOISE[1]) for _ in range(STILL + 1)] == [None] * (STILL + 1)
    assert watch.still == STILL
    assert watch.hanging(NOISE[0], NOISE[2]) == "left" and watch.still == 0


def test_one_grey_level_says_nothing() -> None:
    watch = HangWatch()
    assert [watch.hanging(EVEN, right) for right in NOISE] == [None] * len(NOISE)
    assert [watch.hanging(EVEN, EVEN) for _ in range(3)] == [None] * 3
    assert watch.still == 0


def test_beside_an_image_of_another_size_none_hangs() -> None:
    """That image itself is to blame, and told of where it is read."""
    watch = HangWatch()
    assert [watch.hanging(NOISE[0][:size], NOISE[1]) for size in (96, 48)] == [None, None]
    assert watch.hanging(NOISE[2][:48], NOISE[1]) == "right"
