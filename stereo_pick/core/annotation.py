"""A picture of what was found: both rectified views with outlines, numbers, positions and reasons."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.refusal import Refusal

_FOUND, _REFUSED, _ROW, _TEXT = (80, 220, 80), (60, 60, 240), (120, 120, 60), (255, 255, 255)
_SUBPIXEL_BITS = 4
_SAME_PX = 0.1  # places that went to the raw view and back


def annotate(pair: RectifiedPair, blobs: Blobs, found: Correspondences, poses: ObjectPoses | None = None) -> Image:
    """Return a BGR picture (H, 2 W, 3) of the left and the right view side by side.

    Matched objects are green with their number (and position [mm], where poses are given) on their common row,
    what was refused is red with the reason. Numbers are those of the poses, where these are given.
    """
    left, right = (np.asarray(cv2.cvtColor(view, cv2.COLOR_GRAY2BGR), np.uint8) for view in (pair.left, pair.right))
    refused = poses.refused if poses is not None else found.refused
    later = poses.refused[len(found.refused) :] if poses is not None else ()  # what was matched, but not placed
    kept = [index for index, point in enumerate(found.left_px) if not _is_refused(point, later)]
    for canvas, side in ((left, "left"), (right, "right")):
        bad = [(point, refusal.reason) for refusal in refused if (point := getattr(refusal, f"{side}_px")) is not None]
        _outlines(canvas, blobs, side, [point for point, _ in bad], getattr(found, f"{side}_px")[kept])
        for point, reason in bad:
            _write(canvas, point, [reason], _REFUSED)
    picture: Image = np.hstack([left, right])
    shift = np.array([pair.left.shape[1], 0.0])
    for index, label in zip(kept, _labels(len(kept), poses)):
        start, end = found.left_px[index], found.right_px[index] + shift
        cv2.line(picture, _whole(start), _whole(end), _ROW, 1, cv2.LINE_AA)
        for point in (start, end):
            cv2.drawMarker(picture, _whole(point), _TEXT, cv2.MARKER_CROSS, 9, 1, cv2.LINE_AA)
        _write(picture, start, label, _TEXT)
        _write(picture, end, label[:1], _TEXT)
    return picture


def _is_refused(point_px: Floats, refused: Sequence[Refusal]) -> bool:
    """Whether a match was refused once its position was known."""
    return any(each.left_px is not None and np.abs(each.left_px - point_px).max() < _SAME_PX for each in refused)


def _outlines(canvas: Image, blobs: Blobs, side: str, refused_px: list[Floats], found_px: Floats) -> None:
    """Those of the other polarity only where one was found or refused: most are shadows and prints."""
    for blob in getattr(blobs, side):
        is_found = any(_holds(blob, point) for point in found_px)
        is_bad = any(_at(blob, point) or (not is_found and _holds(blob, point)) for point in refused_px)
        _outline(canvas, blob, _REFUSED if is_bad else _FOUND)
    for blob in getattr(blobs.others, side) if blobs.others else ():
        if any(_at(blob, point) for point in refused_px):
            _outline(canvas, blob, _REFUSED)
        elif any(_holds(blob, point) for point in found_px):
            _outline(canvas, blob, _FOUND)


def _labels(count: int, poses: ObjectPoses | None) -> list[list[str]]:
    if poses is None or len(poses) != count:
        return [[str(index + 1)] for index in range(count)]
    return [
        [str(index + 1), f"x {x:.1f}", f"y {y:.1f}", f"z {z:.1f} mm"]
        for index, (x, y, z) in enumerate(poses.xyz * 1000)
    ]


def _at(blob: Blob, point_px: Floats) -> bool:
    return bool(np.abs(blob.centroid_px - point_px).max() < 1e-6)


def _holds(blob: Blob, point_px: Floats) -> bool:
    x, y = point_px.tolist()
    return cv2.pointPolygonTest(blob.contour_px.astype(np.float32), (x, y), False) >= 0


def _outline(canvas: Image, blob: Blob, colour: tuple[int, int, int]) -> None:
    points = np.round(blob.contour_px * 2**_SUBPIXEL_BITS).astype(np.int32)
    cv2.polylines(canvas, [points], True, colour, 1, cv2.LINE_AA, _SUBPIXEL_BITS)


def _write(canvas: Image, at_px: Floats, lines: list[str], colour: tuple[int, int, int]) -> None:
    x, y = _whole(at_px)
    for number, line in enumerate(lines):
        place = (x + 6, y + 4 + 13 * number)
        for ink, thickness in (((0, 0, 0), 3), (colour, 1)):
            cv2.putText(canvas, line, place, cv2.FONT_HERSHEY_SIMPLEX, 0.4, ink, thickness, cv2.LINE_AA)


def _whole(point_px: Floats) -> tuple[int, int]:
    return round(float(point_px[0])), round(float(point_px[1]))
