"""Ways to cut objects in two so that what belongs together in both views has the same rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from stereo_pick.core.correspondence.position import BlobPair
from stereo_pick.core.correspondence.similarity import Similarity
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.splitting import divisions


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
    def cut(self) -> frozenset[Blob]:
        """The objects."""
        return frozenset(whole for whole, _ in self.wholes)


def ways_to_cut(left: Sequence[Blob], right: Sequence[Blob], similarity: Similarity) -> list[Way]:
    """All ways to see two parts in the objects of each view, in at least one of them by a cut; the likeliest first."""
    one, other = _twos(left), _twos(right)
    if not one or not other or all(len(two.wholes) == 2 for two in (*one, *other)):
        return []
    cost = similarity.costs([p for two in one for p in two.parts], [p for two in other for p in two.parts])
    cost = cost.reshape(len(one), 2, len(other), 2)
    turns = np.stack([cost[:, 0, :, 0] + cost[:, 1, :, 1], cost[:, 0, :, 1] + cost[:, 1, :, 0]])
    total = turns.min(axis=0) / 2 + [[a.unexplained + b.unexplained for b in other] for a in one]
    total[np.ix_([len(two.wholes) == 2 for two in one], [len(two.wholes) == 2 for two in other])] = np.inf
    order = np.argsort(total, axis=None)[: np.isfinite(total).sum()]
    best = (np.unravel_index(at, total.shape) for at in order)
    return [_way(one[i], other[j], turned=bool(turns[1, i, j] < turns[0, i, j])) for i, j in best]


def _twos(blobs: Sequence[Blob]) -> list[_Two]:
    cut = [_Two((blob,), each.parts, each.unexplained) for blob in blobs for each in divisions(blob)]
    return cut + [_Two(pair, pair, 0.0) for pair in combinations(blobs, 2)]


def _way(left: _Two, right: _Two, turned: bool) -> Way:
    one, other = right.parts[::-1] if turned else right.parts
    wholes = [(two.wholes[0], list(two.parts)) for two in (left, right) if len(two.wholes) == 1]
    wholes += [(whole, [whole]) for two in (left, right) if len(two.wholes) == 2 for whole in two.wholes]
    return Way(((left.parts[0], one), (left.parts[1], other)), tuple(wholes))
