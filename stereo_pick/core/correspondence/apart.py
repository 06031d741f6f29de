"""Touching parts: taken apart in each view, and counted where the parts are found in both."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from stereo_pick.core.correspondence.located import BlobPair, Located
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.objects.splitting import split

Row = tuple[BlobPair, Located]

_FLAT = 0.15  # thickness by length


def taken_apart(
    blobs: Blobs, dealt_with: Sequence[Blob], located: Callable[[list[Blob], list[Blob]], list[Row]]
) -> tuple[Blobs, list[Row]]:
    """The objects with touching ones taken apart, as far as at least one part is found, and those parts.

    dealt_with: the objects that need no taking apart; located: pairs what it is given of the left and of the right
    view, and says where each pair is.
    """
    parts = {
        id(blob): _parts(blob, blobs.max_concavity)
        for blob in (*blobs.left, *blobs.right)
        if not among(blob, dealt_with)
    }
    if all(len(each) <= 1 for each in parts.values()):
        return blobs, []
    whole = {id(part): blob for blob in (*blobs.left, *blobs.right) for part in parts.get(id(blob), [])}
    left, right = ([part for blob in side for part in parts.get(id(blob), [])] for side in (blobs.left, blobs.right))
    rows = [_unless_a_face(row) for row in located(left, right)]
    found = [whole[id(blob)] for each, where in rows if not where.reason for blob in each]
    rows = [row for row in rows if any(among(whole[id(blob)], found) for blob in row[0])]
    opened = [
        tuple(part for blob in side for part in (parts[id(blob)] if among(blob, found) else [blob]))
        for side in (blobs.left, blobs.right)
    ]
    return replace(blobs, left=opened[0], right=opened[1]), rows


def among(blob: Blob, others: Iterable[Blob]) -> bool:
    """Whether it is one of these itself."""
    return any(blob is other for other in others)


def _parts(blob: Blob, max_concavity: float) -> list[Blob]:
    if blob.fault == "merged":
        return split(replace(blob, fault=""), max_concavity)
    return [] if blob.fault else [blob]


def _unless_a_face(row: Row) -> Row:
    """One face of a half-lit part would pass for a flat part: what was cut out must be a body."""
    (left, right), where = row
    if where.fit is None or where.fit.size_m.min() > _FLAT * where.fit.size_m.max():
        return row
    return row[0], Located(left.centroid_px, right.centroid_px, 1.0, None, "merged")
