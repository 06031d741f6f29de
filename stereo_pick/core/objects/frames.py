"""What is in a frame, such as the walls around a container or between the cells of a tray, and one with these."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Image

_OPEN = 1 / 3  # of a frame, at least, that is holes: the lit sides of its walls cover much of what they enclose
_THICK = 2.0  # by most of the walls: where they meet they are half as thick again


def outermost(mask: Image) -> Iterator[NDArray[np.int32]]:
    """The outer contours of what is 8-connected; of what lies in holes of other things only where these are frames, as
    the walls around a container are, of which holes are more than half: a part may have a pattern."""
    contours, nested = cv2.findContours(mask, cv2.RETR_TREE, cv2.CHAIN_APPROX_NONE)
    if nested is None:
        return
    area_px2 = [cv2.contourArea(each) for each in contours]
    around = nested[0][:, 3].tolist()
    is_hole = [_depth(around, i) % 2 == 1 for i in range(len(contours))]
    holes_px2 = [0.0] * len(contours)
    for i in np.flatnonzero(is_hole).tolist():
        holes_px2[around[i]] += area_px2[i]
    for i in np.flatnonzero(np.invert(is_hole)).tolist():
        hole = around[i]
        frame = around[hole]
        if hole < 0 or _is_framed(area_px2[i], area_px2[hole], holes_px2[frame], area_px2[frame]):
            yield np.asarray(contours[i], np.int32)


def _depth(around: Sequence[int], i: int) -> int:
    """How many contours are around a contour."""
    depth = 0
    while (i := around[i]) >= 0:
        depth += 1
    return depth


def _is_framed(own_px2: float, hole_px2: float, holes_px2: float, frame_px2: float) -> bool:
    """Whether what lies in a hole is no part of what is around it: that is little more than holes, and so is the hole.

    Through a tube that stands the lit table is seen, which fills most of its hole.
    """
    return holes_px2 > frame_px2 / 2 and own_px2 < hole_px2 / 2


def beside_walls(member: Image) -> Image:
    """What of an object's pixels (h, w), 1 or 0, is clearly thicker than the walls of a frame, and so is none of them;
    nothing where it is no frame.

    Parts that lie at walls, or are seen before them, have one outline with them.
    """
    frame = _largest(member)
    contours, _ = cv2.findContours(frame, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    if cv2.countNonZero(frame) > (1 - _OPEN) * sum(cv2.contourArea(each) for each in contours):
        return np.zeros_like(member)
    away_px = cv2.distanceTransform(np.pad(frame, 1), cv2.DIST_L2, cv2.DIST_MASK_5)[1:-1, 1:-1]
    is_ridge = (frame > 0) & (away_px >= cv2.dilate(away_px, np.ones((3, 3), np.uint8)))
    wall_px = float(np.median(away_px[is_ridge]))
    core = (away_px > _THICK * wall_px).astype(np.uint8)
    reach = np.ones((2 * int(_THICK * wall_px) + 1,) * 2, np.uint8)
    return np.asarray(cv2.bitwise_and(cv2.dilate(core, reach), frame), np.uint8)


def _largest(member: Image) -> Image:
    """The connected part of a mask that reaches farthest."""
    _, labels, stats, _ = cv2.connectedComponentsWithStats(member, connectivity=8)
    reach_px2 = stats[:, cv2.CC_STAT_WIDTH] * stats[:, cv2.CC_STAT_HEIGHT]
    reach_px2[0] = 0
    return np.asarray(labels == reach_px2.argmax(), np.uint8)
