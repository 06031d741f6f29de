"""Cameras that hang while their driver goes on sending their last image, under new stamps."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Image
from stereo_pick.core.images import Bytes
from stereo_pick.core.pairing import Side

STILL = 40  # pairs in a row that are the same, from which on both cameras are taken to hang


class HangWatch:
    """Looks at the data of pair after pair. still: how many pairs, the last ones, were each the same as that before."""

    def __init__(self) -> None:
        self.still = 0
        self._before: dict[Side, Image] = {}

    def hanging(self, left: Bytes, right: Bytes) -> Side | None:
        """The camera whose image is the one before to the last bit, while the other's is not: noise never repeats.

        None where that is of one grey level, as with the lens cap on, and where either image is of another size than
        before, which is another fault: these say nothing.
        """
        pair: dict[Side, Image] = {"left": np.frombuffer(left, np.uint8), "right": np.frombuffer(right, np.uint8)}
        before, self._before = self._before, pair
        resized = any(len(pair[side]) != len(before[side]) for side in before)
        repeated = [side for side in before if np.array_equal(pair[side], before[side])]
        if resized or all(_is_even(pair[side]) for side in repeated):
            repeated = []
        self.still = self.still + 1 if len(repeated) == len(pair) else 0
        return repeated[0] if len(repeated) == 1 else None


def hangs(name: str) -> str:
    """What to say of the camera whose images are those of this name, a topic's for instance."""
    return (
        f"{name} repeats the image before to the last bit, while the other camera's changes: does the camera hang? "
        "Restart it, and its driver"
    )


def all_alike(pairs: str) -> str:
    """What to say where these pairs are one and the same: nobody can tell from when they are."""
    return (
        f"{pairs} are the same to the last bit: do both cameras hang? Restart them, and their driver; a simulation "
        "without noise looks like that, too"
    )


def _is_even(data: Image) -> bool:
    return bool((data == data[:1]).all())
