"""Tables 3.6 to 3.12: objects paired by area (eq. 3.11), on the printed areas and in scenes whose truth is known."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from formatting import Row, Section, markdown_table
from scenes import Scene, label_at
from thesis_printed import AREAS_PX2, paired_by_area

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.objects import Detector
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.rig import StereoRig


def printed_pairs_table() -> str:
    """What eq. 3.11 makes of the areas that the thesis prints."""
    rows = [[name, ", ".join(f"{i} with {j}" for i, j in paired_by_area(name))] for name in AREAS_PX2]
    return markdown_table(["areas of tables", "left objects paired with right ones"], rows)


def pairing_table(rig: StereoRig, scenes: Sequence[Scene]) -> Section:
    """How often the pairing by area and the package's own are right, on the same outlines."""
    rows: list[Row] = []
    for name, method in (("least difference of area (`feature.assignment=area`)", Feature(assignment="area")),
                         ("`feature` by default", Feature())):  # fmt: skip
        counts: Counter[str] = Counter()
        for scene in scenes:
            pair = Rectifier(rig).rectify(scene.frame)
            found = method.match(pair, Detector().detect(pair))
            for left_px, right_px in zip(found.left_px, found.right_px):
                left = _label(rig.left, left_px, scene.left_labels)
                right = _label(rig.right, right_px, scene.right_labels)
                counts["right" if left == right != 0 else "wrong"] += 1
        rows.append([name, str(counts.total()), str(counts["right"]), str(counts["wrong"])])
    text = markdown_table([f"pairing, {len(scenes)} scenes", "pairs formed", "of one object", "of two objects"], rows)
    (_, by_area, _, wrong), (_, own, _, own_wrong) = rows
    return Section(f"by area {wrong} of {by_area} pairs are of two objects; `feature` {own_wrong} of {own}", text)


def _label(camera: Camera, rectified_px: Floats, labels: Image) -> int:
    return label_at(labels, camera.unrectified(rectified_px)[0])
