"""Which matches cannot be told from others that fit as well."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects import Blob

Pairs = list[tuple[int, int]]


def uncrossed(pairs: Pairs, cost: Floats, left: Sequence[Blob], right: Sequence[Blob]) -> Pairs:
    """Exchange partners of pairs that cross, where both exchanged pairs are possible.

    Opaque objects that stand beside each other on a surface keep their order along an epipolar line (the ordering
    constraint); for alike objects in one row it decides what their shape cannot.
    """
    u_left = [float(blob.centroid_px[0]) for blob in left]
    u_right = [float(blob.centroid_px[0]) for blob in right]
    partner = dict(pairs)
    swapped = True
    while swapped:
        swapped = False
        for a in partner:
            for b in partner:
                crosses = u_left[a] < u_left[b] and u_right[partner[a]] > u_right[partner[b]]
                if crosses and np.isfinite(cost[a, partner[b]]) and np.isfinite(cost[b, partner[a]]):
                    partner[a], partner[b] = partner[b], partner[a]
                    swapped = True
    return list(partner.items())


def ambiguous_pairs(
    pairs: Pairs, cost: Floats, margin: float, known: Collection[tuple[int, int]] = ()
) -> set[tuple[int, int]]:
    """The pairs that could as well be formed otherwise; known: some of which that is known.

    A pair is in doubt when an object that is left over fits one of its ends within `margin` of its own cost; its
    other end is then left over too, and may cast doubt on the next pair: every chain of exchanges that makes
    another assignment as good is followed to its end.
    """
    doubtful = set(known)
    certain = [pair for pair in pairs if pair not in doubtful]
    free_left = set(range(cost.shape[0])) - {i for i, _ in certain}
    free_right = set(range(cost.shape[1])) - {j for _, j in certain}
    grows = True
    while grows:
        grows = False
        for i, j in pairs:
            limit = cost[i, j] + margin
            rival = any(cost[k, j] <= limit for k in free_left) or any(cost[i, k] <= limit for k in free_right)
            if rival and (i, j) not in doubtful:
                doubtful.add((i, j))
                free_left.add(i)
                free_right.add(j)
                grows = True
    return doubtful
