"""What was refused, looked for once more where the table and the other objects are known: whole, and piece by piece."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from stereo_pick.core.doubts.beyond_solid import goes_on_beyond, is_part_of, is_seen_alone, is_seen_to_be_more
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.found_late.carried import without_edges
from stereo_pick.core.found_late.inscribed import discs_within
from stereo_pick.core.found_late.last_look import MOST, LastLook, Seen, may_be_found
from stereo_pick.core.found_late.on_top import by_itself, with_those_on_top
from stereo_pick.core.found_late.risen import all_risen
from stereo_pick.core.found_late.shaded_foot import refused_in_its_shadow
from stereo_pick.core.found_late.told_from_marks import unless_marks
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.objects import Blob
from stereo_pick.core.places.located import TOP, is_flat
from stereo_pick.core.places.overlap import covers
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.tables.lying_flat import WarpedViews


def found_after_all(
    images: Images,
    look: LastLook,
    open_: Sequence[Unread],
    aside: Sequence[Unread],
    seen: Sequence[Seen],
    warped: WarpedViews,
) -> tuple[list[Seen], list[Unread]]:
    """What is seen, with those of the refused, and of what was set aside, that are found where none of the others is,
    and what stands on others; and what stays refused."""
    found, refused = list(seen), list(open_)
    for unread in may_be_found(open_):
        another = _found(look, warped, unread, _fits(found), is_whole=True)
        if another is None:
            continue
        (blobs, _), there = another
        found.append(another)
        if not goes_on_beyond(blobs, there.fit, images):  # else the rest of it is refused still
            refused.remove(unread)
        refused = [each for each in refused if not is_seen_alone(each, there.fit, images)]
    for piece in _risen(warped, _several(refused) + [each.left for each in aside if each.left], found):
        another = _found(look, warped, piece, _fits(found))
        if another is not None:
            found.append(by_itself(another, images.rig))
    found += _within(look, warped, refused, found)
    outlines_px = [each.left.contour_px for each in refused if each.left]
    for risen in all_risen(warped.seen, warped.table, _fits(found), outlines_px)[:MOST]:
        another = unless_marks(look.images, warped, look.at_risen(risen, _fits(found)))
        if another is not None and not _is_a_piece(another, refused, images):
            found.append(by_itself(another, images.rig))
            refused = [each for each in refused if not is_part_of(each, another[1].fit, images)]
    return with_those_on_top(images, look, found), refused


def _found(
    look: LastLook, warped: WarpedViews, unread: Unread, others: Sequence[SolidFit], is_whole: bool = False
) -> Seen | None:
    """What was refused, if something rises from the table there, and a solid is found instead.

    is_whole: whether the rest of a piece would rise within its outlines, so that a dark part's upper half will do.
    """
    if unread.left and warped.shows_nothing_rise(unread.left, others):
        return None
    found = unless_marks(look.images, warped, look.at_refused(unread, others))
    if found is not None or not is_whole:
        return found
    fading = replace(look, images=look.images.with_fading_limbs())
    found = unless_marks(fading.images, warped, fading.at_fading(unread, others))
    return found or unless_marks(look.images, warped, refused_in_its_shadow(look, warped, unread, others))


def _fits(found: Sequence[Seen]) -> list[SolidFit]:
    return [each.fit for _, each in found]


def _risen(warped: WarpedViews, outlines: Sequence[Blob], found: Sequence[Seen]) -> list[Unread]:
    """What rises from the table in outlines in the left view, other parts of which may lie there."""
    hulls = [(left, hull) for left in outlines for hull in warped.rising(left, _fits(found))]
    return [Unread("merged", without_edges(left, hull), None) for left, hull in hulls]


def _several(refused: Sequence[Unread]) -> list[Blob]:
    """The outlines in the left view of what may be several."""
    return [each.left for each in refused if each.reason == "merged" and each.left and each.right]


def _within(look: LastLook, warped: WarpedViews, refused: Sequence[Unread], found: Sequence[Seen]) -> list[Seen]:
    """What is found within outlines that are several, or reach beyond the views."""
    rig, more = look.images.rig, list[Seen]()
    cameras = rig.left, rig.right
    for disc in discs_within(refused, _fits(found), rig):
        known = _fits([*found, *more])
        if any(covers(fit, disc.centre_px, cameras[disc.view]) for fit in known):
            continue
        another = _found(look, warped, disc.unread, known)
        # what is thin may be a pattern on a plate, or its shadow
        if another is None or is_flat(another[1].fit, TOP):
            continue
        if disc.is_filled_by(another[1].fit, rig) and not _is_a_piece(another, refused, look.images):
            more.append(by_itself(another, rig))
    return more


def _is_a_piece(seen: Seen, refused: Sequence[Unread], images: Images) -> bool:
    """Whether one view shows, of one object that it has whole, more than that solid."""
    return any(is_seen_to_be_more(each, seen[1].fit, images) for each in refused)
