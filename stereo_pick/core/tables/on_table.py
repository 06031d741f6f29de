"""A second look at what the outlines alone left open, once the table is known that the other objects stand on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stereo_pick.core.edges.hypotheses import BODY, Images
from stereo_pick.core.edges.standing import standing, standing_alike
from stereo_pick.core.edges.supported import CHANCE, Supported
from stereo_pick.core.places.clear_of import clear_of
from stereo_pick.core.places.frontier import reaches_down
from stereo_pick.core.places.located import TOP, as_tube_on, convex_outlines, ends_sharply, is_flat
from stereo_pick.core.places.one_plane import FLAT_PX, Sides, plane_with
from stereo_pick.core.places.overlap import none_behind_another, one_in_each_place
from stereo_pick.core.places.position import BlobPair, Located, Row, by_supported
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.common_table import hangs_clear, stands_on, surely_on
from stereo_pick.core.shapes.kinds import SPHERE
from stereo_pick.core.shapes.table import Table

_SURE_PX = 0.2  # sigma from which a table may better a position


@dataclass(frozen=True, eq=False)
class OnTable:
    """images: the views; table: what the objects stand on; flat_parts: whether parts may be as thin as a print."""

    images: Images
    table: Table
    flat_parts: bool

    def seen(self, kept: Sequence[Row], pairs: Sequence[BlobPair]) -> tuple[list[Row], list[Row]]:
        """What is found, and what must be refused.

        kept: what was found without the table; what is sure and stands on it stays. What stands on it, or is sure but
        hangs clear of it, is looked for as one of its own kind: that it ends there is hardly chance. All else, what
        hangs and is none of its kind, and the pairs (what may be the lit parts of the same objects), is looked for as
        solids on the table, behind all that is found by then.
        """
        found, unsure = _divided(kept, lambda where: is_sure(where, self.table))
        bodies, open_ = _divided(unsure, self._stands_or_hangs)
        behind = self._behind(found)
        more, refused = behind._weighed_all(bodies, behind._alike_or_else(bodies))
        found = found + more
        behind = self._behind(found)
        standing_there = behind.solids([*(blobs for blobs, _ in open_), *pairs])
        more, others = behind._weighed_all(open_, standing_there[: len(open_)])
        found += more
        for blobs, solid in zip(pairs, standing_there[len(open_) :]):
            if solid is not None:
                found.append((blobs, by_supported(self.images.rig, solid)))
        found, twice = one_in_each_place(found)
        found, hidden = none_behind_another(found, self.images.rig)
        return found, refused + others + twice + hidden

    def solids(self, pairs: Sequence[BlobPair]) -> list[Supported | None]:
        """For each of these, of whatever kind, the solid that stands on the table; None where none is found."""
        outlines = [convex_outlines(clear_of(blobs, self.images)) for blobs in pairs]
        found = standing(self.images, outlines, self.table)
        return [None if each is None or (is_flat(each.fit) and not self.flat_parts) else each for each in found]

    def _behind(self, known: Sequence[Row]) -> OnTable:
        """The same, where these are known to be."""
        return replace(
            self,
            images=self.images.behind(
                [where.fit for _, where in known if where.fit is not None and not where.is_rough]
            ),
        )

    def _weighed_all(
        self, rows: Sequence[Row], standing_there: Sequence[Supported | None]
    ) -> tuple[list[Row], list[Row]]:
        """What becomes of these: what is found, and what must be refused."""
        without = self._in_the_air([where.fit if on_it else None for (_, where), on_it in zip(rows, standing_there)])
        again = [(row[0], self._weighed(*row, *each)) for row, *each in zip(rows, standing_there, without)]
        return [row for row in again if not row[1].reason], [row for row in again if row[1].reason]

    def _weighed(
        self, blobs: BlobPair, where: Located, on_it: Supported | None, in_the_air: Supported | None
    ) -> Located:
        """What was found without the table against what would stand on it.

        A part of a solid is supported where it shares the whole one's edges: what stands on the table and has as much
        support is the whole. What hangs in the air where another could stand is that one, no surer than they agree if
        that has less support; where none could, it must have a body of its own. What cannot be there at all is the
        other one.
        """
        fit = where.fit
        if fit is None:
            if on_it is not None:
                return by_supported(self.images.rig, on_it)
            where = as_tube_on(self.images, blobs, self.table) or where
            return where if reaches_down(*blobs, self.images.rig, self.table) else replace(where, reason="half_lit")
        hangs = hangs_clear(self.table, fit)
        if on_it is not None and in_the_air is not None:
            if on_it.support >= in_the_air.support - CHANCE or (hangs and on_it.is_exact):
                return by_supported(self.images.rig, on_it)
            if hangs:
                off_m = on_it.fit.centre_m - fit.centre_m
                unsure = replace(on_it, doubt=on_it.doubt + np.outer(off_m, off_m))
                return by_supported(self.images.rig, unsure)
        if stands_on(self.table, fit) or (hangs and not self._may_be_a_lit_top(blobs, fit)):
            return where
        if on_it is not None and on_it.is_exact:
            return by_supported(self.images.rig, on_it)
        return replace(where, reason="off_table")

    def _may_be_a_lit_top(self, blobs: BlobPair, fit: SolidFit) -> bool:
        """Whether a solid is a sheet, or a ball that looks, and is as sharp, as a cylinder from straight above."""
        if fit.kind != SPHERE.name or not all(ends_sharply(blob) for blob in blobs):
            return is_flat(fit, TOP)
        sides = Sides.of(*blobs, self.images.rig)
        return sides.off_px(plane_with(self.table.normal, sides)) < FLAT_PX

    def _in_the_air(self, fits: Sequence[SolidFit | None]) -> list[Supported | None]:
        """The support of solids that need not stand on the table."""
        found = iter(self.images.all_locked([fit.solid.turning_freely() for fit in fits if fit], None))
        return [next(found) if fit else None for fit in fits]

    def _alike_or_else(self, rows: Sequence[Row]) -> list[Supported | None]:
        """Solids of the same kinds; and, for what hangs, of any kind."""
        found = self._alike(rows)
        hanging = [i for i, (_, where) in enumerate(rows) if found[i] is None and not _stands(where, self.table)]
        for i, other in zip(hanging, self.solids([rows[i][0] for i in hanging])):
            found[i] = other
        return found

    def _alike(self, rows: Sequence[Row]) -> list[Supported | None]:
        fits = [where.fit for _, where in rows if where.fit is not None]
        outlines = [convex_outlines(clear_of(blobs, self.images, where.fit)) for blobs, where in rows]
        return standing_alike(self.images, outlines, fits, self.table)

    def _stands_or_hangs(self, where: Located) -> bool:
        return _stands(where, self.table) or _hangs(where, self.table)


def _divided(rows: Sequence[Row], is_so: Callable[[Located], bool]) -> tuple[list[Row], list[Row]]:
    """Those of which it is so, and the others."""
    return [row for row in rows if is_so(row[1])], [row for row in rows if not is_so(row[1])]


def is_sure(where: Located, table: Table) -> bool:
    """Whether an object is known so well, and to stand on a table, that it need not be looked for on it."""
    return where.fit is not None and where.sigma_px <= _SURE_PX and surely_on(table, where.fit)


def _stands(where: Located, table: Table) -> bool:
    return where.fit is not None and where.fit.flatness >= BODY and stands_on(table, where.fit)


def _hangs(where: Located, table: Table) -> bool:
    """Whether an object is as sure, but far above the table, and more than the lit top of another."""
    if where.fit is None or where.sigma_px > _SURE_PX or is_flat(where.fit, TOP):
        return False
    return hangs_clear(table, where.fit)
