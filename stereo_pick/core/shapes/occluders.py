"""What solids that stand nearer to the cameras hide of others: there is nothing to be seen, for or against them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Ints
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.predicted import inside
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.solids import Solids

_BESIDE_PX = 3.0  # next to an edge that is another's, where an edge of their own is not told from it
_LEAST_EXPECTED = 1 / 2  # of what could be seen, that counts even where less is not hidden

Hide = Callable[[Floats, int], Bools]
"""Which places (S, N, 2), normalized, of S solids are hidden (S, N) in a view."""


@dataclass(frozen=True, eq=False)
class Occluders:
    """K solids: polygons (K, 2, M, 2), normalized, their silhouettes in both views; depth_m (K,), of their centres;
    focal_px, of the rectified views."""

    polygons: Floats
    depth_m: Floats
    focal_px: float

    @staticmethod
    def of(fits: Sequence[SolidFit], rig: StereoRig) -> Occluders:
        """These solids (at least one) as the cameras of the rig see them."""
        polygons = [fit.silhouettes(rig) for fit in fits]
        depth_m = np.array([fit.centre_m[2] for fit in fits])
        return Occluders(np.array(polygons), depth_m, rig.focal_px)

    def cover(self, places: Floats, view: int, depth_m: float = np.inf) -> Bools:
        """Which places (N, 2), normalized, lie in a view on those nearer than this, or so near to them that they may be
        on their edges."""
        covered = np.zeros(len(places), bool)
        for polygon in self.polygons[self.depth_m < depth_m, view]:
            covered |= inside(places[None], polygon[None])[0] > -_BESIDE_PX / self.focal_px
        return covered

    def hide(self, solids: Solids, places: Floats, view: int, own: Ints | None = None) -> Bools:
        """Which places (S, N, 2), normalized, of these solids they hide in a view; own: (S,), which of them each solid
        is itself.

        Solids do not reach into each other: what is hidden is taken to be farther away by half its least size, as the
        middles are. They stay where they began, while those that they hide are adjusted.
        """
        hidden = np.zeros(places.shape[:2], bool)
        if not hidden.size:
            return hidden
        margin = _BESIDE_PX / self.focal_px
        polygons = self.polygons[:, view]
        low, high = polygons.min(axis=1) - margin, polygons.max(axis=1) + margin
        near = (places.max(axis=1)[:, None] > low) & (places.min(axis=1)[:, None] < high)
        farther = solids.centre_m[:, 2] - solids.size_m().min(axis=1) / 2
        before = near.all(axis=2) & (self.depth_m < farther[:, None])
        if own is not None:
            before[np.arange(len(own)), own] = False
        for solid, other in np.argwhere(before):
            hidden[solid] |= inside(places[solid, None], polygons[other, None])[0] > -margin
        return hidden


def share_seen(seen: Bools, hidden: Bools, there: Bools | None = None) -> Floats:
    """The part (...) of what is not hidden (..., N), but of half of all at least, that is seen.

    there: (..., N), what would be seen where nothing hides it; all, unless given.
    """
    would_be = np.ones(seen.shape, bool) if there is None else there
    expected = np.maximum((would_be & ~hidden).sum(axis=-1), _LEAST_EXPECTED * would_be.sum(axis=-1))
    return np.asarray((seen & ~hidden).sum(axis=-1) / np.maximum(expected, 1))
