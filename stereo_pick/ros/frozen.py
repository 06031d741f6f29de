"""A camera that hangs while its driver goes on sending its last image, under new stamps."""

from __future__ import annotations

import numpy as np
from sensor_msgs.msg import Image

from stereo_pick.core.pairing import Pair, Side
from stereo_pick.ros.topics import SIDES


def frozen_side(pair: Pair[Image], before: Pair[Image] | None) -> Side | None:
    """The camera whose image is that of the pair before to the last bit, while the other one's has changed, if any.

    A sensor's noise never repeats. Where neither image changes, as in a simulation, or one is of one grey level, as
    with the lens cap on, that says nothing.
    """
    if before is None:
        return None
    repeated = [side for side in SIDES if getattr(pair, side).data == getattr(before, side).data]
    if len(repeated) != 1 or _is_even(getattr(pair, repeated[0])):
        return None
    return repeated[0]


def _is_even(image: Image) -> bool:
    data = np.frombuffer(image.data, np.uint8)
    return bool((data == data[:1]).all())
