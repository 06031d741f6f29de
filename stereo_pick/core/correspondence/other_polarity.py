"""Dark objects among bright ones, or bright among dark: what is no shadow, no high light, and no print.

All of these lie flat on the table, or on another object. What stands up is an object.
"""

from __future__ import annotations

from collections.abc import Sequence

from stereo_pick.core.correspondence.reading import Reading
from stereo_pick.core.edges.hypotheses import BODY
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.objects.beside import are_beside, is_high_light
from stereo_pick.core.places.frontier import stands_up
from stereo_pick.core.places.overlap import clash
from stereo_pick.core.places.position import BlobPair, Located, Row
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.common_table import stands_on, surely_on
from stereo_pick.core.shapes.table import Table

_BODIES = ("half_lit", "off_table", "ambiguous")  # reasons that need the outlines of a body, or several alike
_FADING = 0.25  # of a bright object's width: as far away from its outline a round one may get dark


def joined(bright: Reading, dark: Reading, chosen: Reading, rig: StereoRig) -> Reading:
    """The objects of both polarities; chosen: the one of the two that shows more, and needs less proof.

    Where a bright and a dark one are in each other's way, the dark one is the other's shadow or dark side.
    """
    return _dark_besides(bright, dark, rig) if chosen is bright else _bright_besides(dark, bright, rig)


def _dark_besides(bright: Reading, dark: Reading, rig: StereoRig) -> Reading:
    """Bright objects, and dark bodies. What else is dark mostly is a shadow: it is spoken of where there are such."""
    table = bright.table
    light, on_dark = _high_lights_aside(bright.kept, dark, table)
    bodies = [row for row in dark.kept if _is_body(row[1], table)]
    kept = _of_none(bodies, light, rig)
    away = _of_none([row for row in dark.kept if row not in bodies], light, rig)
    besides = [each for each in dark.unread if kept or _is_object(each, rig, table)]
    reason = "off_table" if table else "flat"
    for_good = [Unread(reason, *row[0]) for row in away]
    alone, high_lights = _told_apart(on_dark, kept)
    aside = _others(dark.unread, besides) + high_lights
    return Reading(light + kept, bright.unread + besides + alone, table, for_good, aside)


def _bright_besides(dark: Reading, bright: Reading, rig: StereoRig) -> Reading:
    """Dark objects, and bright bodies; and of what is dark and lost beside them it is spoken."""
    table = dark.table
    light, on_dark = _high_lights_aside([row for row in bright.kept if _is_body(row[1], table)], dark, table)
    kept = _of_none(dark.kept, light, rig)
    besides = [each for each in bright.unread if _is_object(each, rig, table)]
    alone, high_lights = _told_apart(on_dark, kept)
    aside = _others(bright.unread, besides) + high_lights
    besides += [Unread("beside_bright", *row[0]) for row in dark.kept if row not in kept and row[1].fit is None]
    return Reading(light + kept, dark.unread + besides + alone, table, aside=aside)


def _others(several: Sequence[Unread], these: Sequence[Unread]) -> list[Unread]:
    return [each for each in several if each not in these]


def _high_lights_aside(bright: Sequence[Row], dark: Reading, table: Table | None) -> tuple[list[Row], list[Row]]:
    """What is bright, but no place on something dark, and what may be one: what surely stands on the table is in that,
    as in a tray."""
    on_dark = [row for row in bright if not _surely_stands(row[1], table) and _is_on_one_of(row[0], dark.kept)]
    return [row for row in bright if row not in on_dark], on_dark


def _told_apart(on_dark: Sequence[Row], dark: list[Row]) -> tuple[list[Unread], list[Unread]]:
    """What may be a high light, but of nothing dark that is kept, so that it may be an object; and the others."""
    unread = [Unread("half_lit", *blobs) for blobs, _ in on_dark]
    alone = [each for each, (blobs, _) in zip(unread, on_dark) if not _is_on_one_of(blobs, dark)]
    return alone, _others(unread, alone)


def _surely_stands(where: Located, table: Table | None) -> bool:
    """Whether it is a body that stands on the table."""
    if table is None or where.fit is None:
        return False
    return where.fit.flatness >= BODY and surely_on(table, where.fit)


def _of_none(dark: Sequence[Row], light: Sequence[Row], rig: StereoRig) -> list[Row]:
    """What is dark, but neither a side nor the shadow of a bright object."""
    return [row for row in dark if not any(_is_of(row, each, rig) for each in light)]


def _is_body(where: Located, table: Table | None) -> bool:
    """Whether it stands on the table; one of unknown shape is kept only where its outlines reach down to that."""
    if table is None:
        return where.fit is not None and where.fit.flatness >= BODY
    return where.fit is None or (where.fit.flatness >= BODY and stands_on(table, where.fit))


def _is_on_one_of(bright: BlobPair, dark: list[Row]) -> bool:
    return any(is_high_light(one, other) for pair, _ in dark for one, other in zip(bright, pair))


def _is_of(dark: Row, bright: Row, rig: StereoRig) -> bool:
    """Whether what is dark is a bright object's own side, or its shadow."""
    fits = dark[1].fit, bright[1].fit
    if fits[0] is not None and fits[1] is not None and clash(fits[0], fits[1], rig):
        return True
    is_body = fits[0] is not None and fits[0].flatness >= BODY
    return not is_body and any(
        are_beside(one, other, _FADING * other.rectangle[1]) for one, other in zip(dark[0], bright[0])
    )


def _is_object(unread: Unread, rig: StereoRig, table: Table | None) -> bool:
    """Whether what was refused is no shadow: seen as a body in part, or with its upper end above the table."""
    if unread.left is None or unread.right is None or unread.reason == "beside_bright":
        return False
    if unread.reason in _BODIES:
        return True
    return table is not None and stands_up(unread.left, unread.right, rig, table)
