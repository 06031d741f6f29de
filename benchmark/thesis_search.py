"""Tables 3.3 to 3.5: what correlation finds, in the scenes of tables 3.14 and 3.16, whose truth is known."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import cv2
import numpy as np
from formatting import Row, Section, decimals, markdown_table
from scenes import Scene, label_at

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence import Method
from stereo_pick.core.correspondence.ssd import Ssd
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Blobs, Detector
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.rig import StereoRig

POINTS_A_SCENE = 6  # as many as in table 3.3
GOOD_PX = 6.0  # the largest error that table 3.3 calls a good correlation
Search = Callable[[RectifiedPair, Floats], Floats]


class Start(NamedTuple):
    """A pixel of the left rectified view on an object; true_px: where the right view shows its point, if it does."""

    left_px: Floats
    true_px: Floats | None


def table_3_3(rig: StereoRig, scenes: Sequence[Scene]) -> Section:
    """Pixels on the parts, looked for in the whole right image, and along their row."""
    rectifier, random = Rectifier(rig), np.random.default_rng(33)
    pairs = [rectifier.rectify(scene.frame) for scene in scenes]
    starts = [list(_on_objects(rig, scene, random)) for scene in scenes]
    rows: list[Row] = [["thesis, whole image", "6", "4 of 5", "3", "6", "2551"]]
    for name, search in (("3 × 3, whole image (`ssd.search=full`)", whole_image), ("3 × 3, along the row", along_row)):
        began = time.process_time()
        found = [[search(pair, start.left_px) for start in these] for pair, these in zip(pairs, starts)]
        spent_s = time.process_time() - began
        rows.append([name, *_counts(starts, found), decimals(spent_s / sum(map(len, starts)) * 1000, 2)])
    rows.insert(2, ["thesis, along the row", "–", "–", "–", "–", "174"])
    header = [
        "table 3.3",
        "points",
        f"in both views: found within {GOOD_PX:g} px",
        "median error px",
        "worst of these px",
    ]
    header += ["ms a point"]
    headline = f"{rows[1][2]} within {GOOD_PX:g} px in the whole image, {rows[3][2]} along the row"
    return Section(headline, markdown_table(header, rows))


def table_3_4(rig: StereoRig, scenes: Sequence[Scene], others: Sequence[Scene]) -> Section:
    """The centroids of the left view, looked for in the right one."""
    rows: list[Row] = [["thesis, modified SSD", "its own", "2", "2", "1.49, 2.72"]]
    for group, members in (("tables 3.14, 3.16", scenes), ("all", others)):
        for name, method in (
            ("3 × 3, whole image (`ssd.search=full`)", Ssd(search="full")),
            ("3 × 3, along the row (the thesis's modified SSD)", None),
            ("`ssd` by default", Ssd()),
        ):
            rows.append([name, group, *_centroid_errors(rig, members, method)])
    header = ["tables 3.4, 3.5", "scenes", "centroids", f"found within {GOOD_PX:g} px", "worst of these x, y px"]
    text = markdown_table([*header, "answered wrongly", "refused"], [[*row, *["–"] * (7 - len(row))] for row in rows])
    _, _, total, good, worst_px, wrong, refused = rows[-1]
    headline = f"`ssd`: {good} of {total} found, at worst {worst_px} px off, {wrong} wrong, {refused} refused; "
    return Section(f"{headline}the thesis's search along the row: {rows[-2][5]} wrong", text)


def whole_image(pair: RectifiedPair, left_px: Floats) -> Floats:
    """Least SSD over the whole right image (eq. 3.8), as method `ssd` does it with search = full."""
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], np.float64)
    found = Ssd(search="full").match(pair, Blobs((Blob(left_px + square, contrast=1.0),), (), "bright"))
    return np.asarray(found.right_px[0])


def along_row(pair: RectifiedPair, left_px: Floats) -> Floats:
    """Least SSD of a 3 × 3 window along its row, as the thesis does after rectification (3.7.3)."""
    column, row = np.round(left_px).astype(int)
    row = int(np.clip(row, 1, pair.left.shape[0] - 2))
    window, strip = pair.left[row - 1 : row + 2, column - 1 : column + 2], pair.right[row - 1 : row + 2]
    cost = cv2.matchTemplate(strip.astype(np.float32), window.astype(np.float32), cv2.TM_SQDIFF)
    return np.array([int(cost.argmin()) + 1, row], np.float64)


def _on_objects(rig: StereoRig, scene: Scene, random: np.random.Generator) -> Iterator[Start]:
    rows, columns = np.nonzero(cv2.erode(np.array(scene.left_labels), np.ones((5, 5), np.uint8)))
    for which in random.choice(len(rows), POINTS_A_SCENE, replace=False):
        left_px = np.round(rig.left.rectified([(columns[which], rows[which])])[0])
        yield Start(left_px, true_partner(rig, scene, left_px))


def true_partner(rig: StereoRig, scene: Scene, left_px: Floats) -> Floats | None:
    """Where the right rectified view shows the surface point of a left rectified pixel (2,); None if it does not."""
    raw_px = rig.left.unrectified(left_px)[0]
    surface_mm = scene.surface_mm(rig.left, raw_px)
    if surface_mm is None:
        return None
    right_raw_px = rig.project(surface_mm / 1000)[1][0]
    same = label_at(scene.right_labels, right_raw_px) == label_at(scene.left_labels, raw_px)
    return rig.right.rectified(right_raw_px)[0] if same and _faces(rig, scene, raw_px, surface_mm) else None


def _faces(rig: StereoRig, scene: Scene, raw_px: Floats, surface_mm: Floats) -> bool:
    """Whether the right camera sees that point too, and not the front of the same convex part before it."""
    solid = scene.objects[label_at(scene.left_labels, raw_px) - 1].solid
    centre_mm = rig.right_T_left.inverse().translation * 1000
    moved = solid.camera_T_solid.copy()
    moved[:3, 3] -= centre_mm
    first_mm = type(solid)(solid.shape, solid.dimensions_mm, moved).first_hit_mm(surface_mm - centre_mm)
    return first_mm is not None and bool(np.linalg.norm(first_mm + centre_mm - surface_mm) < 0.5)


def _counts(starts: Sequence[Sequence[Start]], found: Sequence[Sequence[Floats]]) -> list[str]:
    pairs = [(start, px) for these, those in zip(starts, found) for start, px in zip(these, those)]
    off_px = np.array([np.linalg.norm(px - start.true_px) for start, px in pairs if start.true_px is not None])
    good = off_px <= GOOD_PX
    worst = decimals(off_px[good].max(), 1) if good.any() else "–"
    return [str(len(pairs)), f"{good.sum()} of {len(off_px)}", decimals(float(np.median(off_px)), 1), worst]


def _centroid_errors(rig: StereoRig, scenes: Sequence[Scene], method: Method | None) -> list[str]:
    rectifier, detector = Rectifier(rig), Detector()
    off_px: list[Floats] = []
    wrong = refused = 0
    for scene in scenes:
        pair = rectifier.rectify(scene.frame)
        blobs = detector.detect(pair)
        matched = method.match(pair, blobs) if method else None
        for blob in blobs.sound()[0]:
            true_px = true_partner(rig, scene, blob.centroid_px)
            if true_px is None:
                continue
            if matched is None:
                px = along_row(pair, blob.centroid_px)
            else:
                row = np.flatnonzero((matched.left_px == blob.centroid_px).all(axis=1))
                if len(row) == 0:
                    refused += 1
                    continue
                px = matched.right_px[row[0]]
            if np.linalg.norm(px - true_px) <= GOOD_PX:
                off_px.append(np.abs(px - true_px))
            else:
                wrong += 1
    worst = ", ".join(decimals(value, 2) for value in np.max(off_px, axis=0)) if off_px else "–"
    return [str(len(off_px) + wrong + refused), str(len(off_px)), worst, str(wrong), str(refused)]
