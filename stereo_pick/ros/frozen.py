"""Cameras that hang while their driver goes on sending their last image, under new stamps."""

from __future__ import annotations

import numpy as np
from sensor_msgs.msg import Image

from stereo_pick.core.pairing import Pair, Side
from stereo_pick.ros.topics import SIDES


def repeated_sides(pair: Pair[Image], before: Pair[Image] | None) -> list[Side]:
    """The cameras whose images are those of the pair before to the last bit: a sensor's noise never repeats.

    None where all that repeats is of one grey level, as with the lens cap on: that says nothing.
    """
    if before is None:
        return []
    repeated = [side for side in SIDES if getattr(pair, side).data == getattr(before, side).data]
    return [] if all(_is_even(getattr(pair, side)) for side in repeated) else repeated


def _is_even(image: Image) -> bool:
    data = np.frombuffer(image.data, np.uint8)
    return bool((data == data[:1]).all())
