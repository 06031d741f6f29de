"""A second look at what the outlines alone left open, once the table is known that the other objects stand on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stereo_pick.core.correspondence.assignment import assign
from stereo_pick.core.correspondence.frontier import reaches_down
from stereo_pick.core.correspondence.located import TOP, convex_outlines, is_flat
from stereo_pick.core.correspondence.overlap import none_behind_another, one_in_each_place
from stereo_pick.core.correspondence.position import BlobPair, Located, Row, by_supported
from stereo_pick.core.correspondence.similarity import Similarity
from stereo_pick.core.objects import Blob
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.adjustment import adjusted
from stereo_pick.core.shapes.below_faces import tables_below
from stereo_pick.core.shapes.common_table import common_table, hangs_above, stands_on, supposed_tables, surely_on
from stereo_pick.core.shapes.fitting import can_be_fitted
from stereo_pick.core.shapes.hypotheses import BODY, CHANCE, Images, Supported
from stereo_pick.core.shapes.standing import standing, standing_alike
from stereo_pick.core.shapes.table import Table

_ROWS_PX, _OF_HEIGHT, _AREA_RATIO = 3.0, 2.0, 4.0  # by how much the lit parts of one object may differ
_SURE_PX = 0.2  # sigma from which a table may better a position
_TRIED_TABLES, _TRIED_PAIRS = 4, 3
_LEAST = 2  # objects that must stand on a table before they say more about it


@dataclass(frozen=True, eq=False)
class SecondLook:
    """images: the views; pairs: what in them may be the lit parts of the same objects, not found without a table;
    faces: thin solids that may be the lit tops of objects; flat_parts: whether parts may be as thin as a print."""

    images: Images
    pairs: Sequence[BlobPair]
    faces: Sequence[tuple[BlobPair, SolidFit]]
    flat_parts: bool

    def found_table(self, kept: Sequence[Row]) -> Table | None:
        """The table that the objects found agree on, with what the edges alone say of the others if need be; or one
        that lit faces or one of the objects let suppose, and on which another object is found, too.

        Where something is left to find on it, it is adjusted together with the objects that stand on it, and again with
        those that are clearly what they seem, if others are not.
        """
        fits = [where.fit for _, where in kept if where.fit is not None]
        table = self._agreed(fits, [*(blobs for blobs, where in kept if where.fit is None), *self.pairs])
        if table is None or not self._leaves_open(kept, table):
            return table
        standing = [fit for fit in fits if stands_on(table, fit)]
        if len(standing) < _LEAST:
            return table
        found, better = adjusted(standing, self.images.maps, self.images.rig, table, known=True)
        clear = [each.fit for each in found if each.is_creased and not each.is_astray]
        if not _LEAST <= len(clear) < len(standing):
            return better
        return adjusted(clear, self.images.maps, self.images.rig, better, known=True)[1]

    def _leaves_open(self, kept: Sequence[Row], table: Table) -> bool:
        return len(self.pairs) > 0 or not all(_is_sure(where, table) for _, where in kept)

    def _agreed(self, fits: list[SolidFit], unknown: Sequence[BlobPair]) -> Table | None:
        agreed = common_table(fits, self._level)
        if agreed is not None:
            return agreed
        fits = fits + self._bodies()
        return common_table(fits, self._level) or self._below_faces(fits) or self._verified(fits, unknown)

    @property
    def _level(self) -> list[SolidFit]:
        return [fit for _, fit in self.faces]

    def _bodies(self) -> list[SolidFit]:
        """The solids, on whatever table, that the edges of both views support for the pairs."""
        readings = [each for each in map(convex_outlines, self.pairs) if can_be_fitted(each)]
        self.images.look_at(readings)
        found = [self.images.best([each]) for each in readings]
        return [each.fit for each in found if each is not None and not is_flat(each.fit, TOP)]

    def _below_faces(self, fits: Sequence[SolidFit]) -> Table | None:
        """The table below lit faces on which one of the objects is found, and another one is or stands already."""
        tops = [blobs for blobs, _ in self.faces]
        others = [pair for pair in self.pairs if not any(pair[0] is left for left, _ in tops)]
        for table in tables_below(self._level, fits, self.images.maps, self.images.eyes_m):
            found = [each.fit for each in self._on(table, [*tops, *others][:_TRIED_PAIRS]) if each]
            standing = [fit for fit in _each_once(found, fits) if stands_on(table, fit)]
            if found and len(standing) >= _LEAST:
                return common_table(standing, self._level) or table
        return None

    def _verified(self, fits: Sequence[SolidFit], unknown: Sequence[BlobPair]) -> Table | None:
        for table in supposed_tables(fits)[:_TRIED_TABLES]:
            others = [found.fit for found in self._on(table, unknown[:_TRIED_PAIRS]) if found]
            agreed = common_table(_each_once(others, fits), self._level) if others else None
            if agreed is not None:
                return agreed
        return None

    def seen_on(self, table: Table, kept: Sequence[Row]) -> tuple[list[Row], list[Row]]:
        """What is found, and what must be refused.

        kept: what was found without the table; what is sure and stands on it stays. What stands on it, or is sure but
        hangs clear of it, is looked for as one of its own kind: that it ends there is hardly chance. All else, what
        hangs and is none of its kind, and the pairs, is looked for as solids on the table.
        """
        found, unsure = _divided(kept, lambda where: _is_sure(where, table))
        refused: list[Row] = []
        bodies, open_ = _divided(unsure, lambda where: _stands(where, table) or _hangs(where, table))
        unsure = bodies + open_
        standing_there = self._alike_or_else_on(table, bodies)
        standing_there += self._on(table, [*(blobs for blobs, _ in open_), *self.pairs])
        without = self._in_the_air([where.fit if on_it else None for (_, where), on_it in zip(unsure, standing_there)])
        for (blobs, where), on_it, in_the_air in zip(unsure, standing_there, without):
            again = self._weighed(table, blobs, where, on_it, in_the_air)
            (refused if again.reason else found).append((blobs, again))
        for blobs, on_it in zip(self.pairs, standing_there[len(unsure) :]):
            if on_it is not None:
                found.append((blobs, by_supported(self.images.rig, on_it)))
        found, twice = one_in_each_place(found)
        found, behind = none_behind_another(found, self.images.rig)
        return found, refused + twice + behind

    def _weighed(
        self, table: Table, blobs: BlobPair, where: Located, on_it: Supported | None, in_the_air: Supported | None
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
            return where if reaches_down(*blobs, self.images.rig, table) else replace(where, reason="half_lit")
        hangs = _hangs_clear(table, fit)
        if on_it is not None and in_the_air is not None:
            if on_it.support >= in_the_air.support - CHANCE or (hangs and on_it.is_exact):
                return by_supported(self.images.rig, on_it)
            if hangs:
                off_m = on_it.fit.centre_m - fit.centre_m
                unsure = replace(on_it, doubt=on_it.doubt + np.outer(off_m, off_m))
                return by_supported(self.images.rig, unsure)
        if stands_on(table, fit) or (hangs and not is_flat(fit, TOP)):
            return where
        if on_it is not None and on_it.is_exact:
            return by_supported(self.images.rig, on_it)
        return replace(where, fit=None, reason="off_table")

    def _in_the_air(self, fits: Sequence[SolidFit | None]) -> list[Supported | None]:
        """The support of solids that need not stand on the table."""
        found = iter(self.images.all_locked([fit.solid.turning_freely() for fit in fits if fit], None))
        return [next(found) if fit else None for fit in fits]

    def _alike_or_else_on(self, table: Table, rows: Sequence[Row]) -> list[Supported | None]:
        """Solids of the same kinds; and, for what hangs, of any kind."""
        found = self._alike_on(table, rows)
        hanging = [i for i, (_, where) in enumerate(rows) if found[i] is None and not _stands(where, table)]
        for i, other in zip(hanging, self._on(table, [rows[i][0] for i in hanging])):
            found[i] = other
        return found

    def _alike_on(self, table: Table, rows: Sequence[Row]) -> list[Supported | None]:
        fits = [where.fit for _, where in rows if where.fit is not None]
        return standing_alike(self.images, [convex_outlines(blobs) for blobs, _ in rows], fits, table)

    def _on(self, table: Table, pairs: Sequence[BlobPair]) -> list[Supported | None]:
        found = standing(self.images, [convex_outlines(blobs) for blobs in pairs], table)
        return [None if each is None or (is_flat(each.fit) and not self.flat_parts) else each for each in found]


def _each_once(found: Sequence[SolidFit], fits: Sequence[SolidFit]) -> list[SolidFit]:
    """The solids found, and those of the others that are none of them."""
    return [*found, *(fit for fit in fits if not any(fit.overlaps(other) for other in found))]


def lit_parts(left: Sequence[Blob], right: Sequence[Blob], disparities_px: tuple[float, float]) -> list[BlobPair]:
    """What may be the lit parts of the same objects."""
    cost = Similarity(_ROWS_PX, _OF_HEIGHT, _AREA_RATIO, disparities_px).costs(left, right)
    return [(left[i], right[j]) for i, j in assign(cost, unmatched_cost=1.0)]


def _divided(rows: Sequence[Row], is_so: Callable[[Located], bool]) -> tuple[list[Row], list[Row]]:
    """Those of which it is so, and the others."""
    return [row for row in rows if is_so(row[1])], [row for row in rows if not is_so(row[1])]


def _is_sure(where: Located, table: Table) -> bool:
    return where.fit is not None and where.sigma_px <= _SURE_PX and surely_on(table, where.fit)


def _stands(where: Located, table: Table) -> bool:
    return where.fit is not None and where.fit.flatness >= BODY and stands_on(table, where.fit)


def _hangs(where: Located, table: Table) -> bool:
    """Whether an object is as sure, but far above the table, and more than the lit top of another."""
    if where.fit is None or where.sigma_px > _SURE_PX or is_flat(where.fit, TOP):
        return False
    return _hangs_clear(table, where.fit)


def _hangs_clear(table: Table, fit: SolidFit) -> bool:
    return hangs_above(table, fit) and not stands_on(table, fit)
