"""What two views show of objects and their table, once the table has had its say."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from stereo_pick.core.correspondence.found_table import FoundTable, Shaded
from stereo_pick.core.correspondence.other_polarity import joined
from stereo_pick.core.correspondence.reading import FirstLook, Reader, Reading
from stereo_pick.core.correspondence.together import Together, adjusted_together
from stereo_pick.core.found_late.last_look import LastLook, may_be_found
from stereo_pick.core.found_late.shaded_foot import refused_in_its_shadow
from stereo_pick.core.objects import Blob
from stereo_pick.core.places.one_plane import shows_one_face
from stereo_pick.core.places.position import Row
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.common_table import stands_on, supposed_tables, surely_on
from stereo_pick.core.shapes.kinds import SPHERE
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.tables.lying_flat import WarpedViews

_SUPPOSED = 2  # tables that single objects let suppose
_SEVERAL = 2  # solids on a table that bear it out
_SIGMAS = 3.0


@dataclass(frozen=True, eq=False)
class FirstLooks:
    """What is found without a table; others: of the other polarity."""

    first: FirstLook
    others: FirstLook | None

    @property
    def kept(self) -> list[Row]:
        """The objects found, of both polarities."""
        return [*self.first.kept, *self.kept_besides]

    @property
    def kept_besides(self) -> list[Row]:
        """Those of the other polarity."""
        return self.others.kept if self.others else []

    @property
    def fits(self) -> list[SolidFit]:
        """The solids that explain them."""
        return [where.fit for _, where in self.kept if where.fit is not None]

    @property
    def shaded(self) -> frozenset[Blob]:
        """The outlines of which shadows may be a part."""
        looks = [look for look in (self.first, self.others) if look is not None and look.blobs.may_be_shaded]
        return frozenset(blob for look in looks for blob in (*look.blobs.left, *look.blobs.right))

    def not_on(self, there: FoundTable) -> FirstLooks:
        """The same, where solids that stand on a table were mistaken."""
        on_it = partial(stands_on, there.table)
        return FirstLooks(self.first.without(on_it), self.others.without(on_it) if self.others else None)


@dataclass(frozen=True, eq=False)
class Scene:
    """reading: what outlines say; together: what all edges make of that; is_known: whether the table is known without
    the objects that stand on it; shaded: the outlines of which shadows may be a part."""

    reading: Reading
    together: Together
    is_known: bool
    shaded: frozenset[Blob]

    @property
    def is_groundless(self) -> bool:
        """Whether nothing stands on a table after all that nothing showed but what was thought to stand there."""
        table = self.together.table
        if self.is_known or table is None:
            return False
        return not any(stands_on(table, fit) for fit in self.solids)

    @property
    def solids(self) -> list[SolidFit]:
        """Those that explain objects."""
        return [where.fit for _, where in self.together.kept if where.fit is not None]

    @property
    def standing(self) -> list[SolidFit]:
        """Those of them that surely stand on the table; balls stand on any."""
        table = self.together.table
        return [fit for fit in self.solids if fit.kind != SPHERE.name and surely_on(table, fit)] if table else []

    def is_above(self, other: Scene) -> bool:
        """Whether the table is one that something of the other scene goes through: walls have tops on a plane, too."""
        table = self.together.table
        return table is not None and any(
            float(table.under(fit.solid)[0][0]) < -_SIGMAS * table.sigma_m for fit in other.standing
        )

    def may_be_shaded(self, row: Row, rig: StereoRig) -> bool:
        """Whether what no solid explains may be an object and its shadow, as long as no table is known that would tell
        how far down it reaches: one that lies flat throws none."""
        blobs, where = row
        if where.fit is not None or self.together.table is not None or self.shaded.isdisjoint(blobs):
            return False
        return not shows_one_face(*blobs, rig)


def scene_on(reader: Reader, looks: FirstLooks, there: FoundTable | None, edge_radius_m: float) -> Scene:
    """The scene on a table, or on none; edge_radius_m: one sigma of how far edges are rounded."""
    reading = reader.read(looks.first, there.table if there else None)
    if looks.others is not None:
        besides = reader.read(looks.others, reading.table)
        is_bright = looks.first.blobs.polarity == "bright"
        bright, dark = (reading, besides) if is_bright else (besides, reading)
        reading = joined(bright, dark, reading, reader.images.rig)
    is_known = there is not None and there.is_seen
    together = adjusted_together(reader, reading, is_known, edge_radius_m)
    return Scene(reading, together, is_known, looks.shaded)


def scene_on_found_table(reader: Reader, looks: FirstLooks, shaded: Shaded, edge_radius_m: float) -> Scene:
    """The scene on the table that is found; if need be looked for again, without what was mistaken for an object on it.

    shaded: what may be the table, by its shadows.
    """
    there = reader.table(looks.first, looks.kept_besides, shaded)
    scene = scene_on(reader, looks, there, edge_radius_m)
    if there is not None and scene.is_groundless:
        doubted = looks.not_on(there)
        there = reader.table(doubted.first, doubted.kept_besides, shaded)
        return scene_on(reader, doubted, there, edge_radius_m)
    if len(scene.standing) >= _SEVERAL or not reader.last_look:
        return scene
    return _scene_on_any(reader, looks, scene, shaded, edge_radius_m)


def _scene_on_any(reader: Reader, looks: FirstLooks, scene: Scene, shaded: Shaded, edge_radius_m: float) -> Scene:
    """The same scene on what may be its table by all that is seen, or as one of its objects stands, if several are
    found there: where outlines are one with those of what lies there, no other way tells of it."""
    if not scene.together.refused:
        return scene
    seen = [FoundTable(table, True) for table in shaded(None)]
    supposed = [FoundTable(table, False) for table in supposed_tables(scene.solids)[:_SUPPOSED]]
    for several in (seen, supposed):
        likely = [there for there in several if _bears_any(reader, scene, there.table)]
        scenes = [scene_on(reader, looks, there, edge_radius_m) for there in likely]
        lowest = [each for each in scenes if not any(each.is_above(other) for other in scenes)]
        best = max(lowest, key=lambda each: len(each.standing), default=scene)
        if len(best.standing) >= _SEVERAL and len(best.solids) > len(scene.solids):
            return best
    return scene


def _bears_any(reader: Reader, scene: Scene, table: Table) -> bool:
    """Whether something that is refused in a scene is found on a table: most of those tried are none."""
    look, warped = LastLook(reader.images, table, [], []), WarpedViews(reader.images.pair, table)
    several = may_be_found(scene.together.refused)
    return any(look.at_refused(unread, []) or refused_in_its_shadow(look, warped, unread, []) for unread in several)
