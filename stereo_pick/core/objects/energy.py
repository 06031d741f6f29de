"""Which way of reading the views shows more of objects: by area and squared contrast."""

from __future__ import annotations

from collections.abc import Iterable

from stereo_pick.core.objects.blob import Blob, Blobs


def contrast_energy(blobs: Blobs) -> float:
    """That of what both views show."""
    return _energy(blobs.left) + _energy(blobs.right)


def seen_by_both(blobs: Blobs, max_concavity: float) -> float:
    """The least, of both views, of outlines that may be those of one part: what is printed on a surface, and what lies
    on another one with its shadow, mostly have notches."""
    return min(_energy(b for b in side if b.concavity <= max_concavity) for side in (blobs.left, blobs.right))


def _energy(blobs: Iterable[Blob]) -> float:
    """At least so much is the sum of the squared contrasts of all pixels, of which half have the contrast and a tenth
    the peak of their object: most of a body may be its dark side."""
    return sum(blob.area_px2 * (0.4 * blob.contrast**2 + 0.1 * blob.peak**2) for blob in blobs if not blob.cut)
