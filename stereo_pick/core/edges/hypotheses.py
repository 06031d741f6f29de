"""Solids that the edges in the images support, for objects whose outlines alone do not tell."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property

import numpy as np

from stereo_pick.core.edges.beyond import Contour, shown_beyond
from stereo_pick.core.edges.edge_map import USUAL_BLUR_PX, EdgeMap
from stereo_pick.core.edges.growing import grown, is_longer
from stereo_pick.core.edges.locking import Locked, lock, seen_in_shadow
from stereo_pick.core.edges.supported import CHANCE, Supported, supported
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.fitting import NOISE_PX, Nearest, Pair, nearest_of_kind
from stereo_pick.core.shapes.kinds import BOX, CYLINDER, HEX_PRISM, SPHERE, Kind
from stereo_pick.core.shapes.occluders import Occluders
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_LOOKED_FOR, _LOOKED_FOR_LAST = (SPHERE, CYLINDER, BOX), (HEX_PRISM,)
_SHOWN_BEYOND = 0.5  # part of what a solid adds to the outlines that must lie on edges
BODY = 0.3  # thickness by length of what is no lit face
_ROUGHEST = 2.0  # of NOISE_PX: farther off lies what is not what it seems
_PLAUSIBLE_PX = 0.25  # misfit of the outlines beyond which a kind is not worth looking for


class Images:
    """What the two rectified views, and what is known of the blur of their lenses, offer to support a solid."""

    def __init__(self, pair: RectifiedPair, blurs_px: Sequence[float] = (USUAL_BLUR_PX, USUAL_BLUR_PX)) -> None:
        self.pair = pair
        self.rig: StereoRig = pair.rig
        self._blurs_px = blurs_px
        self.eyes_m = pair.rig.eyes_m
        self.nearest: Nearest = {}
        self._longer: dict[tuple[Solids, Table | None], Supported | None] = {}
        self._locked: dict[tuple[Solids, Table | None], Supported] = {}
        self.occluders: Occluders | None = None
        self.noise_px = NOISE_PX
        self.in_shadow = False

    def behind(self, fits: Sequence[SolidFit]) -> Images:
        """The same views, where these solids, and no others, are known to be: what they hide of others speaks neither
        for nor against those. The same object where there are none."""
        if not fits:
            return self
        found = self._asked_anew()
        found.occluders = Occluders.of(fits, self.rig)
        return found

    def as_rough_as(self, fits: Sequence[SolidFit]) -> Images:
        """The same views, where edges lie as far off what is there as off most of these solids: parts have rounded
        edges, and show them the more the nearer they are."""
        if not fits:
            return self
        found = self._asked_anew()
        found.noise_px = min(_ROUGHEST * NOISE_PX, max(NOISE_PX, float(np.median([fit.residual_px for fit in fits]))))
        return found

    def in_own_shadow(self) -> Images:
        """The same views, where a dark part's own shadow on the table may hide where it ends."""
        found = self._asked_anew()
        found.in_shadow = True
        return found

    def with_fading_limbs(self) -> Images:
        """The same views, where limbs as bright as what is behind them count as edges."""
        found = self._asked_anew()
        found.maps = [replace(each, fading_limbs=True) for each in self.maps]
        return found

    def _asked_anew(self) -> Images:
        """The same views, of which other solids may be supported."""
        found = copy(self)
        found.maps = self.maps  # made once for both
        found._longer, found._locked = {}, {}
        return found

    @cached_property
    def maps(self) -> list[EdgeMap]:
        """The edges of both views."""
        pair, rig = self.pair, self.rig
        return [EdgeMap.of(*view) for view in zip((pair.left, pair.right), (rig.left, rig.right), self._blurs_px)]

    @cached_property
    def exact_maps(self) -> list[EdgeMap]:
        """The same, where edges are placed as exactly as can be."""
        return [replace(each, is_exact=True) for each in self.maps]

    def _look_for(self, kinds: Sequence[Kind], readings: Sequence[Pair]) -> None:
        for kind in kinds:
            self.search(readings, kind)
        solids = [solid for pair in readings for solid in self._near(pair, kinds)]
        self._stretch(solids, None)
        self._lock([solid for solid in solids if self.contradicts(solid) is None], None)

    def search(self, pairs: Sequence[Pair], kind: Kind) -> None:
        """Search for the solids of a kind that are nearest to several objects' outlines, at once."""
        new = [pair for pair in dict.fromkeys(pairs) if (pair, kind) not in self.nearest]
        if new:
            self.nearest.update(nearest_of_kind(new, self.rig, kind))

    def longer(self, solid: Solids, table: Table | None = None) -> Supported | None:
        """The solid stretched to further edges and brought onto them, or None where there are none.

        On a known table it goes on level only.
        """
        self._stretch([solid], table)
        return self._longer[solid, table]

    def _stretch(self, solids: Sequence[Solids], table: Table | None) -> None:
        new = [solid for solid in solids if (solid, table) not in self._longer]
        grown_ones = [grown(solid, self.eyes_m, self.maps, table, self.occluders) for solid in new]
        self._lock([each for each in grown_ones if each is not None], table)
        for solid, stretched in zip(new, grown_ones):
            longer = None if stretched is None else self._locked[stretched, table]
            is_more = longer is not None and is_longer(longer.fit.solid, solid, self.rig.focal_px)
            self._longer[solid, table] = longer if is_more else None

    def locked(self, solid: Solids, table: Table | None = None) -> Supported:
        """The solid brought onto the edges next to its silhouette, and kept on the table, if that is known."""
        return self.all_locked([solid], table)[0]

    def all_locked(self, solids: Sequence[Solids], table: Table | None) -> list[Supported]:
        """The same of several solids."""
        self._lock(solids, table)
        return [self._locked[solid, table] for solid in solids]

    def _lock(self, solids: Sequence[Solids], table: Table | None) -> None:
        alike: dict[tuple[Kind, int], list[Solids]] = {}
        for solid in solids:
            if (solid, table) not in self._locked:
                alike.setdefault((solid.kind, solid.turns.shape[2]), []).append(solid)
        for several in alike.values():
            locked = self._where_edges_are(Solids.joined(several), table)
            for solid, each in zip(several, supported(locked, table, self.noise_px)):
                self._locked[solid, table] = each

    def _where_edges_are(self, solids: Solids, table: Table | None) -> Locked:
        if self.in_shadow and table is not None:
            return seen_in_shadow(solids, self.maps, self.rig, table, self.occluders)
        return lock(solids, self.maps, self.rig, table, self.occluders)

    def best(self, objects: Sequence[Sequence[Pair]]) -> list[Supported | None]:
        """For each object the solid with the most support among those that come near its outlines, and longer ones.

        objects: the outlines of each, trusted to different extents; to be asked for together, since all are worked on
        at once. Six sides come near to much else: they are looked for last, and must be exact.
        """
        found = self._best_of(_LOOKED_FOR, objects)
        left = [i for i, each in enumerate(found) if each is None]
        for i, six_sided in zip(left, self._best_of(_LOOKED_FOR_LAST, [objects[i] for i in left])):
            found[i] = six_sided if six_sided is not None and six_sided.is_exact else None
        return found

    def _best_of(self, kinds: Sequence[Kind], objects: Sequence[Sequence[Pair]]) -> list[Supported | None]:
        self._look_for(kinds, [pair for readings in objects for pair in readings])
        found = [self._believable(kinds, readings) for readings in objects]
        return [max(several, key=lambda each: each.score, default=None) for several in found]

    def _believable(self, kinds: Sequence[Kind], readings: Sequence[Pair]) -> list[Supported]:
        found = [each for pair in readings for solid in self._near(pair, kinds) for each in self._with_longer(solid)]
        return [each for each in found if each.believable]

    def shows_beyond(self, solid: Solids, contours: Sequence[Contour]) -> bool:
        """Whether there are edges where the solid's silhouette lies outside the object's contours, one a view."""
        return shown_beyond(solid, self.eyes_m, self.maps, contours) > _SHOWN_BEYOND

    def _near(self, pair: Pair, kinds: Sequence[Kind]) -> Iterator[Solids]:
        for kind in kinds:
            solid, misfit_px = self.of_kind(pair, kind)
            if misfit_px < _PLAUSIBLE_PX:
                yield solid

    def of_kind(self, pair: Pair, kind: Kind) -> tuple[Solids, float]:
        """The solid of a kind that comes nearest to an object's outlines alone, and its misfit [px]."""
        self.search([pair], kind)
        return self.nearest[pair, kind]

    def _with_longer(self, solid: Solids) -> list[Supported]:
        """A longer solid with support makes the shorter one, a part of it, unbelievable."""
        longer = self.contradicts(solid)
        return [longer] if longer is not None else [self.locked(solid)]

    def contradicts(self, solid: Solids) -> Supported | None:
        """A longer solid that has enough support to make this one doubtful, whether or not it is sure itself.

        A part of a body shares most of the whole one's edges: the whole has as much support. A lit face has more than
        the faint sides behind it.
        """
        longer = self.longer(solid)
        if longer is None or not longer.raises_doubt:
            return None
        sizes = solid.size_m()[0]
        is_body = float(sizes.min()) > BODY * float(sizes.max())
        return None if is_body and longer.support < self.locked(solid).support - CHANCE else longer

    def hides_a_side(self, pair: Pair) -> bool:
        """Whether the edges around an object of unknown shape hint that its outlines show a part of it only."""
        for kind in (CYLINDER, BOX):
            longer = self.longer(self.of_kind(pair, kind)[0])
            if longer is not None and longer.believable:
                return True
        return False
