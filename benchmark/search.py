"""Where correlation ends up when it looks for the left centroids (thesis tables 3.3 and 3.4), against the truth."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from formatting import markdown_table
from scenes import Scene, label_at

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.correspondence.ssd import Ssd
from stereo_pick.core.objects import Detector
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.rig import StereoRig

GOOD_PX = 2.0
_UNCHECKED = Ssd(max_sigma_px=2.0, min_similarity=0.0, min_uniqueness=1.0, left_right_tolerance_px=10.0)
_SEARCHES = {
    "3 × 3, whole right image, as the thesis's SSD": Ssd(search="full"),
    "3 × 3, along the row, checks as loose as they go": replace(_UNCHECKED, narrowest_window_px=3, widest_window_px=3),
    "15 × 15, along the row, checks as loose as they go": replace(
        _UNCHECKED, narrowest_window_px=15, widest_window_px=15
    ),
    "`ssd` by default: 7 × 7 to 23 × 23, along the row, checked": Ssd(),
}
_OUTCOMES = ("near", "same object", "elsewhere", "refused")


def search_table(rig: StereoRig, scenes: Sequence[Scene]) -> str:
    """How many of the left centroids each search finds again, over all scenes."""
    counts: dict[str, Counter[str]] = {name: Counter() for name in _SEARCHES}
    rectifier, detector = Rectifier(rig), Detector()
    for scene in scenes:
        pair = rectifier.rectify(scene.frame)
        blobs = detector.detect(pair)
        starts = [blob.centroid_px for blob in blobs.sound()[0]]
        for name, search in _SEARCHES.items():
            counts[name].update(_outcomes(rig, scene, starts, search.match(pair, blobs)))
    rows = []
    for name, count in counts.items():
        total = count.total()
        rows.append([name, str(total), *(f"{count[o]} ({100 * count[o] / total:.0f} %)" for o in _OUTCOMES)])
    header = ["search", "left centroids", f"within {GOOD_PX:g} px", "farther off, same object", "elsewhere", "refused"]
    return markdown_table(header, rows)


def _outcomes(rig: StereoRig, scene: Scene, starts: Sequence[Floats], found: Correspondences) -> Iterator[str]:
    """What became of each left centroid that lies on an object."""
    for start in starts:
        raw_px = rig.left.unrectified(start)[0]
        surface_mm = scene.surface_mm(rig.left, raw_px)
        if surface_mm is None:
            continue
        row = np.flatnonzero((found.left_px == start).all(axis=1))
        if len(row) == 0:
            yield "refused"
            continue
        right_px = found.right_px[row[0]]
        true_px = rig.right.rectified(rig.project(surface_mm / 1000)[1])[0]
        if np.linalg.norm(right_px - true_px) <= GOOD_PX:
            yield "near"
        else:
            seen = label_at(scene.right_labels, rig.right.unrectified(right_px)[0])
            yield "same object" if seen == label_at(scene.left_labels, raw_px) else "elsewhere"
