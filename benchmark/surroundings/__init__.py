"""Scenes with more in them than parts: what is printed, lies, stands or hangs where robots work.

From a seed comes a scene, and how many of its solids, the first ones, are parts that must be found.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable

import numpy as np
from placing import NoRoomError
from staging import Random

from surroundings import printed, raised, things
from surroundings.common import Surrounded

_SCENE_TRIES = 200

SURROUNDINGS: dict[str, Callable[[Random], Surrounded]] = {
    each.__name__: each
    for each in (
        printed.breadboard, printed.slots, printed.cutting_mat, printed.chessboard, things.thick_board,
        printed.markers, printed.newspaper, printed.sheet, printed.tape, printed.stains, raised.stacked,
        raised.leaning, raised.propped, things.cable, things.swarf, things.gripper, things.hand, things.container,
        things.dividers, raised.platform, raised.terrace, things.rail, things.belt, things.crowd,
    )
}  # fmt: skip


def staged(family: str, seed: int) -> Surrounded:
    """Scene `seed` of a family."""
    random = np.random.default_rng([zlib.crc32(f"surroundings {family}".encode()), seed])
    for _ in range(_SCENE_TRIES):
        try:
            return SURROUNDINGS[family](random)
        except NoRoomError:
            continue
    raise RuntimeError(f"{family} {seed}: the parts find no room")
