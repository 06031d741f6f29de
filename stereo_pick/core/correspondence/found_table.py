"""The table that the objects stand on, found from those that are seen best and from what would stand on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from stereo_pick.core.edges.adjustment import adjusted
from stereo_pick.core.edges.below_faces import tables_below
from stereo_pick.core.edges.hypotheses import BODY, Images
from stereo_pick.core.edges.supported import Supported
from stereo_pick.core.found_late.last_look import LastLook
from stereo_pick.core.found_late.patterned import near_outlines, patterned
from stereo_pick.core.objects import Blobs
from stereo_pick.core.places.located import TOP, convex_outlines, is_flat
from stereo_pick.core.places.position import BlobPair, Row
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.common_normal import is_upright
from stereo_pick.core.shapes.common_table import common_table, stands_on, supposed_tables
from stereo_pick.core.shapes.fitting import Pair, can_be_fitted
from stereo_pick.core.shapes.kinds import SPHERE
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.tables.on_table import OnTable, is_sure

_TRIED_PAIRS = 3
_TRIED_ON_SHADED = 8  # outlines: a table that falls from the light is worth more of a look
_LOOKED_AT = 2  # supposed tables, more thoroughly: that takes longer
_LEAST = 2  # objects that must stand on a table before they say more about it

Shaded = Callable[[Blobs | None], Sequence[Table]]
"""What may be the table by what is seen beside objects, or by all that is seen."""


class FoundTable(NamedTuple):
    """table; is_seen: whether it is known without the objects that stand on it."""

    table: Table
    is_seen: bool


@dataclass(frozen=True, eq=False)
class TableSearch:
    """images: the views; pairs: what in them may be the lit parts of the same objects, not found without a table;
    faces: thin solids that may be the lit tops of objects; flat_parts: whether parts may be as thin as a print;
    shaded: what may be the table, the likeliest first; bright: the objects beside which shadows are; None where the
    outlines of objects may be what shows the table: what passes for a dark one may be a part and its shadow."""

    images: Images
    pairs: Sequence[BlobPair]
    faces: Sequence[tuple[BlobPair, SolidFit]]
    flat_parts: bool
    shaded: Shaded
    bright: Blobs | None

    def table(self, kept: Sequence[Row]) -> FoundTable | None:
        """The table that the objects found agree on, if need be once all their own edges have put them where they are;
        or that shadows show; or that the objects agree on with what the edges alone say of the others; or that lit
        faces, or one of the objects, let suppose, and on which another one is found."""
        fits = [where.fit for _, where in kept if where.fit is not None]
        table = common_table(fits, self._level)
        clear = [] if table else self._clear(fits)
        table = table or common_table(clear, self._level)
        if table is None:
            fits = fits + self._bodies()
            shaded = self._by_shadows(kept, fits, clear)
            if shaded is not None:
                return FoundTable(shaded, True)
            table = (
                common_table(fits, self._level)
                or self._below_faces(fits)
                or self._looked_at(kept, fits, supposed_tables(fits)[:_LOOKED_AT])
            )
        return FoundTable(self._bettered(kept, table), False) if table else None

    def _bettered(self, kept: Sequence[Row], table: Table) -> Table:
        """The same, adjusted together with the objects that stand on it, where something is left to find there; and
        again with those that are clearly what they seem, if others are not."""
        fits = [where.fit for _, where in kept if where.fit is not None]
        standing = [fit for fit in fits if stands_on(table, fit)]
        if len(standing) < _LEAST or not self._leaves_open(kept, table):
            return table
        found, better = adjusted(standing, self.images.maps, self.images.rig, table, known=True)
        clear = [each.fit for each in found if each.is_clear]
        if better is None or len(clear) == len(standing):
            return better or table
        if len(clear) < _LEAST:
            return self._looked_at(kept, clear, [better, *supposed_tables(clear)[:_LOOKED_AT]]) or better
        return adjusted(clear, self.images.maps, self.images.rig, better, known=True)[1] or better

    def _leaves_open(self, kept: Sequence[Row], table: Table) -> bool:
        return len(self.pairs) > 0 or not all(is_sure(where, table) for _, where in kept)

    def _clear(self, fits: Sequence[SolidFit]) -> list[SolidFit]:
        """Those of the solids that are clearly what they seem, where all their edges put them: an outline alone says
        roughly how a solid is turned."""
        if not fits:
            return []
        found, _ = adjusted(fits, self.images.maps, self.images.rig, None)
        return [each.fit for each in found if each.is_clear]

    @property
    def _level(self) -> list[SolidFit]:
        return [fit for _, fit in self.faces]

    def _bodies(self) -> list[SolidFit]:
        """The solids, on whatever table, that the edges of both views, or patterns, support for the pairs."""
        readings = [each for each in map(convex_outlines, self.pairs) if can_be_fitted(each)]
        supported = self.images.best([[each] for each in readings])
        found = [each or self._by_its_pattern(reading) for each, reading in zip(supported, readings)]
        return [each.fit for each in found if each is not None and not is_flat(each.fit, TOP)]

    def _by_its_pattern(self, reading: Pair) -> Supported | None:
        return next(patterned(self.images, near_outlines(self.images, reading), []), None)

    def _below_faces(self, fits: Sequence[SolidFit]) -> Table | None:
        """The table below lit faces on which one of the objects is found, and another one is or stands already.

        What is as thin as a rod may be light that mirrors in a body of which no face is lit: it does not count.
        """
        fits = [fit for fit in fits if fit.flatness >= BODY]
        tops = [blobs for blobs, _ in self.faces]
        others = [pair for pair in self.pairs if not any(pair[0] is left for left, _ in tops)]
        for table in tables_below(self._level, fits, self.images.maps, self.images.eyes_m):
            found = [each.fit for each in self._on(table).solids([*tops, *others][:_TRIED_PAIRS]) if each]
            standing = [fit for fit in _each_once(found, fits) if stands_on(table, fit)]
            if found and len(standing) >= _LEAST:
                return common_table(standing, self._level) or table
        return None

    def _by_shadows(self, kept: Sequence[Row], fits: Sequence[SolidFit], clear: Sequence[SolidFit]) -> Table | None:
        """The table that shadows show, if most objects stand on it, some of which may not be what they seem without it;
        one that was found without it among them, and no ball: these stand on any plane. Or that on which all edges show
        another object, unless most of what is clear is turned another way. None that an object is below, where outlines
        may say so: what hangs makes planes, too."""
        tables = self.shaded(self.bright)
        if self.bright is None:
            tables = [table for table in tables if all(table.height_m(fit.centre_m) > 0 for fit in fits)]
        for table in tables:
            if not any(stands_on(table, fit) for fit in fits if fit.kind != SPHERE.name):
                continue
            found = [each.fit for each in self._on(table).solids(self._not_on(table, kept)) if each]
            several = _each_once(found, fits)
            standing = [fit for fit in several if stands_on(table, fit)]
            if 2 * len(standing) > len(several):
                return table
        return self._looked_at(kept, fits, tables, _TRIED_ON_SHADED, _LEAST, clear)

    def _on(self, table: Table) -> OnTable:
        return OnTable(self.images, table, self.flat_parts)

    def _looked_at(
        self,
        kept: Sequence[Row],
        fits: Sequence[SolidFit],
        tables: Sequence[Table],
        most: int = _TRIED_PAIRS,
        least: int = 1,
        clear: Sequence[SolidFit] = (),
    ) -> Table | None:
        """The first of these tables on which all edges around something that does not stand on it show a solid.

        most: of the outlines, that are looked at; least: solids on it, these and others; clear: what is known without
        any table, which fewer solids on it do not outvote.
        """
        for table in tables:
            standing = [fit for fit in fits if stands_on(table, fit)]
            look = LastLook(self.images.behind(standing), table, standing, [])
            on_it = list(standing)
            for blobs in self._not_on(table, kept, most):
                seen = look.at(blobs, on_it)
                if seen is None:
                    continue
                on_it.append(seen[1].fit)
                if len(on_it) >= least and not _outvoted(table, on_it, clear):
                    return table
        return None

    def _not_on(self, table: Table, kept: Sequence[Row], most: int = _TRIED_PAIRS) -> list[BlobPair]:
        """The few outlines most worth a look of what is not known to stand on a table."""
        others = [blobs for blobs, where in kept if where.fit is None or not stands_on(table, where.fit)]
        return [*others, *self.pairs][:most]


def _outvoted(table: Table, on_it: Sequence[SolidFit], clear: Sequence[SolidFit]) -> bool:
    """Whether as many solids are turned as on no such table as are on it, balls not counted: they stand on any."""
    others = [fit for fit in clear if not any(fit.overlaps(other) for other in on_it)]
    against = [fit for fit in others if fit.kind != SPHERE.name and not is_upright(table.normal, fit)]
    return 0 < len(against) >= len([fit for fit in on_it if fit.kind != SPHERE.name])


def _each_once(found: Sequence[SolidFit], fits: Sequence[SolidFit]) -> list[SolidFit]:
    """The solids found, and those of the others that are none of them."""
    return [*found, *(fit for fit in fits if not any(fit.overlaps(other) for other in found))]
