"""Marks on the table: holes, dots, stains, the squares of a board. Many outlines that lie on one plane, on which
something stands, are no objects, and say well where the table is.

On the plane of the lit tops of objects that are alike, or of balls that are looked straight down at, nothing stands.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.matches.similarity import Similarity
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.places.one_plane import FLAT_PX, Sides, plane_of
from stereo_pick.core.places.position import BlobPair, Row
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.common_table import stands_on, surely_on
from stereo_pick.core.shapes.kinds import SPHERE
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.tables.shaded_table import GRID, shows_edges
from stereo_pick.core.windows.plane_alignment import Alignment, aligned
from stereo_pick.core.windows.table_windows import Windows, clear_of_objects, on_grid, reduction, uneven
from stereo_pick.core.windows.window_planes import agree_on, of_table, off_px, planes_through, refitted

_LEAST = 6  # outlines: three make a plane, as many bear it out
_TRIPLES = 500
_APART_PX = 20
_TRIED = 4
_MAY_BE_MARKS = ("", "merged", "beside_bright")  # whatever speaks against an object
_LENS_PX = 0.03  # what is left of distortion is no noise
_SIGMAS = 3.0
_LOW = 1 / 3  # of their width, above a table: an object is higher
_MOST_MARKS = 0.9  # part of them
_NEAR_PX = 1.0  # of where the plane would have the centre of an outline


@dataclass(frozen=True, eq=False)
class Marks:
    """pairs: outlines in both views that lie on one plane; table: that plane."""

    pairs: Sequence[BlobPair]
    table: Table

    def others(self, blobs: Blobs) -> Blobs:
        """All other outlines."""
        return _without(blobs, frozenset(blob for each in self.pairs for blob in each))

    def bear(self, fits: Sequence[SolidFit]) -> bool:
        """Whether one of these solids surely stands on their plane; balls stand on any."""
        others = [fit for fit in fits if fit.kind != SPHERE.name]
        return any(stands_on(self.table, fit) and surely_on(self.table, fit) for fit in others)

    def are_on(self, table: Table, rig: StereoRig) -> bool:
        """Whether they lie on a table, as far as both are known."""
        height_m, _ = self._above_m(table, rig)
        return bool(abs(height_m) < _SIGMAS * np.hypot(table.sigma_m, self.table.sigma_m))

    def are_on_a_plate(self, table: Table, rig: StereoRig) -> bool:
        """Whether they lie level above a table, but less than tops of objects so wide would: as on a board."""
        height_m, per_px = self._above_m(table, rig)
        wide_m = per_px * float(np.median([np.sqrt(left.area_px2) for left, _ in self.pairs]))
        is_level = float(table.normal @ self.table.normal) > np.cos(
            _SIGMAS * np.hypot(table.tilt_rad, self.table.tilt_rad)
        )
        return bool(is_level and 0 < height_m < _LOW * wide_m)

    def _above_m(self, table: Table, rig: StereoRig) -> tuple[float, float]:
        """How high above a table their middle is, and how long a pixel is there [m]."""
        middle_px = np.mean([left.centroid_px for left, _ in self.pairs], axis=0)
        ahead = np.append(normalized(middle_px, rig.left), 1.0)
        depth_m = -self.table.offset_m / float(ahead @ self.table.normal)
        return float(table.height_m(ahead * depth_m)), depth_m / rig.focal_px

    def told_from(self, blobs: Blobs, similarity: Similarity) -> tuple[Blobs, list[Unread]]:
        """What may be objects if that plane is the table; and what is none: the marks, and what one view alone shows
        and is no larger than they are, but for the largest few: these may be the edge of a board, or several in one."""
        others = self.others(blobs)
        most_px2 = float(np.quantile([blob.area_px2 for each in self.pairs for blob in each], _MOST_MARKS))
        alone = _alone(others, similarity, most_px2)
        unread = [*(Unread("flat", *each) for each in self.pairs), *alone]
        return _without(others, frozenset(each.alone for each in alone if each.alone)), unread


def marks_among(blobs: Blobs, pair: RectifiedPair, similarity: Similarity) -> Iterator[Marks]:
    """The outlines that lie on one plane, where they are many; those that most of them lie on come first.

    Marks that repeat lie on other planes as well, as far as each may be any of its neighbours in the other view.
    """
    pairs = _possible(blobs, similarity)
    for on_it in _planes(pairs):
        marks = _flat(on_it, pair.rig)
        if marks is None:
            continue
        better = _by_windows(marks.table, pair, marks.others(blobs))
        if better is not None and better.sigma_m < marks.table.sigma_m:
            marks = replace(marks, table=better)
        yield replace(marks, pairs=[*marks.pairs, *_on_it(marks.table, marks.others(blobs), pair.rig)])


def more_marks(rows: Sequence[Row], marks: Sequence[Unread]) -> list[Row]:
    """Those of what no solid explains that are no larger than the largest of marks."""
    most_px2 = max((blob.area_px2 for each in marks for blob in (each.left, each.right) if blob), default=0.0)
    return [row for row in rows if row[1].fit is None and all(blob.area_px2 <= most_px2 for blob in row[0])]


def _possible(blobs: Blobs, similarity: Similarity) -> list[BlobPair]:
    """All outlines of both views that may belong together, each with each."""
    left, right = ([blob for blob in side if blob.fault in _MAY_BE_MARKS] for side in (blobs.left, blobs.right))
    pairs = [(left[i], right[j]) for i, j in np.argwhere(np.isfinite(similarity.costs(left, right))).tolist()]
    return pairs + (_possible(blobs.others, similarity) if blobs.others else [])


def _planes(pairs: Sequence[BlobPair]) -> Iterator[list[BlobPair]]:
    """Those of these that lie, as far as their centres tell, on one of the planes that most of them do."""
    if len(pairs) < _LEAST:
        return
    windows = _centres(pairs)
    planes = planes_through(windows, _TRIPLES, _APART_PX)
    agree, taken = agree_on(planes, windows), np.zeros(len(pairs), np.bool_)
    for _ in range(_TRIED if len(planes) else 0):
        _, on_it = refitted(planes[(agree & ~taken).sum(axis=1).argmax()], windows)
        if (on_it & ~taken).sum() < _LEAST:
            return
        taken |= on_it
        yield [pairs[i] for i in np.flatnonzero(on_it).tolist()]


def _flat(pairs: Sequence[BlobPair], rig: StereoRig) -> Marks | None:
    """Those of these that lie on the plane of their centres with all of their outlines, if they are many."""
    table = _through(pairs, rig)
    flat = [each for each in pairs if _lies_on(table, each, rig)] if table else []
    table = _through(flat, rig) if len(flat) >= _LEAST else None
    return Marks(flat, table) if table else None


def _centres(pairs: Sequence[BlobPair]) -> Windows:
    left_px, right_px = (np.array([blob.centroid_px for blob in side]) for side in zip(*pairs))
    return Windows(left_px, left_px[:, 0] - right_px[:, 0])


def _through(pairs: Sequence[BlobPair], rig: StereoRig) -> Table | None:
    """The plane through the centres of outlines, as sure in the middle of the view as these scatter about it; None
    where these are in one line, or it would be seen edge-on, or from behind."""
    windows = _centres(pairs)
    rows = windows.rows
    if np.linalg.matrix_rank(rows) < rows.shape[1]:
        return None
    plane = np.asarray(np.linalg.lstsq(rows, windows.disparity_px, rcond=None)[0], np.float64)
    off = off_px(plane, windows)
    scatter_px2 = max(float(off @ off) / (len(off) - 3), _LENS_PX**2)
    alignment = Alignment(plane, np.asarray(np.linalg.inv(rows.T @ rows) * scatter_px2, np.float64))
    return alignment.table(_middle(rig.left.frame_size), rig, 1.0, _LENS_PX)


def _by_windows(table: Table, pair: RectifiedPair, objects: Blobs) -> Table | None:
    """The same, as all shows that lies on it and is clear of objects: outlines may be few, and all at one side."""
    rig, scale = pair.rig, reduction(pair.left)
    left, right = uneven(pair.left, rig.left, scale), uneven(pair.right, rig.right, scale)
    wide_px, high_px, _ = GRID
    several = [*objects.left, *(objects.others.left if objects.others else ())]
    clear = clear_of_objects(left, several, scale, wide_px, high_px)
    centre_px = on_grid(shows_edges(pair, left, scale) & clear, *GRID).astype(np.float64)
    plane = of_table(table, rig, scale)
    better = aligned(left, right, plane, Windows(centre_px, np.c_[centre_px, np.ones(len(centre_px))] @ plane), GRID)
    return better.table(_middle(left.shape[::-1]), rig, scale, _LENS_PX) if better else None


def _middle(size_px: Sequence[int]) -> Floats:
    width, height = size_px
    return np.array([width / 2, height / 2, 1.0])


def _on_it(table: Table, blobs: Blobs, rig: StereoRig) -> list[BlobPair]:
    """The outlines that lie on it: of marks that repeat, some may be taken for others."""
    left_px, right_px = (np.reshape([blob.centroid_px for blob in side], (-1, 2)) for side in (blobs.left, blobs.right))
    disparity_px = np.c_[left_px, np.ones(len(left_px))] @ of_table(table, rig, 1.0)
    there_px = left_px - np.c_[disparity_px, np.zeros(len(left_px))]
    near = np.argwhere(np.linalg.norm(there_px[:, None] - right_px, axis=2) < _NEAR_PX)
    pairs = [(blobs.left[i], blobs.right[j]) for i, j in near]
    found = [each for each in pairs if _lies_on(table, each, rig)]
    return found + (_on_it(table, blobs.others, rig) if blobs.others else [])


def _lies_on(table: Table, blobs: BlobPair, rig: StereoRig) -> bool:
    return Sides.of(*blobs, rig).off_px(plane_of(table, rig)) < FLAT_PX


def _alone(blobs: Blobs, similarity: Similarity, most_px2: float) -> list[Unread]:
    """What one view alone shows, and is no larger than that."""
    fits: Bools = np.isfinite(similarity.costs(blobs.left, blobs.right))
    left = [Unread("left_only", blob, None) for blob, fit in zip(blobs.left, np.any(fits, axis=1).tolist()) if not fit]
    right = [
        Unread("right_only", None, blob) for blob, fit in zip(blobs.right, np.any(fits, axis=0).tolist()) if not fit
    ]
    found = [each for each in (*left, *right) if each.alone and each.alone.area_px2 <= most_px2]
    return found + (_alone(blobs.others, similarity, most_px2) if blobs.others else [])


def _without(blobs: Blobs, some: frozenset[Blob]) -> Blobs:
    left, right = (tuple(each for each in side if each not in some) for side in (blobs.left, blobs.right))
    return replace(blobs, left=left, right=right, others=_without(blobs.others, some) if blobs.others else None)
