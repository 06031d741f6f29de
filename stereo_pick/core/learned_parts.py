"""Whether a background was learned from an empty surface."""

from __future__ import annotations

from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.pipeline import Steps


def parts_learned(learned: RectifiedPair) -> str:
    """What is wrong with views (the mean of those learned from) in which parts are found; empty where none are."""
    _, found = Steps().correspond(learned)
    if not len(found):
        return ""
    x, y = found.left_px[0]
    parts = "an object is" if len(found) == 1 else f"{len(found)} objects are"
    return (
        f"{parts} in the views that the background was learned from, the first at ({x:.0f}, {y:.0f}) of the rectified "
        "left one: nothing that lies there will be found; clear the surface and learn it again"
    )
