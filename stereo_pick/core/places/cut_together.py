"""Ways to cut objects in two so that what belongs together in both views has the same rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.matches.similarity import Similarity
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.blob import MAY_BE_CUT
from stereo_pick.core.objects.splitting import divisions
from stereo_pick.core.places.position import BlobPair

_UNLIKE = 1.0  # what it costs that the views show different pieces of one of the two


@dataclass(frozen=True, eq=False)
class _Two:
    """Two parts of one view: of one object cut in two, or two objects; unexplained: what speaks against the cut."""

    wholes: tuple[Blob, ...]
    parts: tuple[Blob, Blob]
    unexplained: float


@dataclass(frozen=True, eq=False)
class Way:
    """Two pairs of parts, left and right; wholes: the objects of both views that they are the parts of, each with its
    parts."""

    pairs: tuple[BlobPair, BlobPair]
    wholes: tuple[tuple[Blob, list[Blob]], ...]

    @property
    def whole(self) -> frozenset[Blob]:
        """The objects."""
        return frozenset(whole for whole, _ in self.wholes)

    @property
    def cut(self) -> frozenset[Blob]:
        """Those of them that are cut in two."""
        return frozenset(whole for whole, parts in self.wholes if len(parts) == 2)


def ways_to_cut(left: Sequence[Blob], right: Sequence[Blob], similarity: Similarity, alike: bool) -> list[Way]:
    """All ways to see two parts in the objects of each view, in at least one of them by a cut; the likeliest first.

    alike: whether both parts look alike in both views; or one does, and of the other they show different pieces.
    """
    one, other = _twos(left), _twos(right)
    if not one or not other or all(len(two.wholes) == 2 for two in (*one, *other)):
        return []
    straight, turned = _costs(one, other, similarity, alike)
    total = np.minimum(straight, turned) / 2 + [[a.unexplained + b.unexplained for b in other] for a in one]
    total[np.ix_([len(two.wholes) == 2 for two in one], [len(two.wholes) == 2 for two in other])] = np.inf
    order = np.argsort(total, axis=None)[: np.isfinite(total).sum()]
    best = (np.unravel_index(at, total.shape) for at in order)
    return [_way(one[i], other[j], turned=bool(turned[i, j] < straight[i, j])) for i, j in best]


def _costs(one: list[_Two], other: list[_Two], similarity: Similarity, alike: bool) -> tuple[Floats, Floats]:
    """What it costs (N, M) that the parts of each two of one view are those of each two of the other in this order, and
    in the other."""
    parts = [[part for two in side for part in two.parts] for side in (one, other)]
    shape = len(one), 2, len(other), 2
    cost = similarity.costs(*parts)
    if alike:
        each = cost.reshape(shape)
        return each[:, 0, :, 0] + each[:, 1, :, 1], each[:, 0, :, 1] + each[:, 1, :, 0]
    unlike = np.where(np.isfinite(similarity.of_pieces().costs(*parts)) & np.isinf(cost), _UNLIKE, np.inf)
    left_told, right_told = (np.array([is_told(part) for part in side]) for side in parts)
    like, unlike = np.where(left_told[:, None] & right_told, cost, np.inf).reshape(shape), unlike.reshape(shape)
    straight = np.minimum(like[:, 0, :, 0] + unlike[:, 1, :, 1], unlike[:, 0, :, 0] + like[:, 1, :, 1])
    turned = np.minimum(like[:, 0, :, 1] + unlike[:, 1, :, 0], unlike[:, 0, :, 1] + like[:, 1, :, 0])
    return straight, turned


def is_told(part: Blob) -> bool:
    """Whether enough of a part's outline is its own to tell what it is, where the other view shows another piece of the
    part that it was cut from."""
    return part.cut_share <= MAY_BE_CUT


def _twos(blobs: Sequence[Blob]) -> list[_Two]:
    cut = [_Two((blob,), each.parts, each.unexplained) for blob in blobs for each in divisions(blob)]
    return cut + [_Two(pair, pair, 0.0) for pair in combinations(blobs, 2)]


def _way(left: _Two, right: _Two, turned: bool) -> Way:
    one, other = right.parts[::-1] if turned else right.parts
    wholes = [(two.wholes[0], list(two.parts)) for two in (left, right) if len(two.wholes) == 1]
    wholes += [(whole, [whole]) for two in (left, right) if len(two.wholes) == 2 for whole in two.wholes]
    return Way(((left.parts[0], one), (left.parts[1], other)), tuple(wholes))
