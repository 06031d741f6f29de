"""Whether a solid that is found late is one: nothing that lies on the table would look like it."""

from __future__ import annotations

from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.found_late.along_rows import shows_height
from stereo_pick.core.found_late.last_look import Seen
from stereo_pick.core.tables.lying_flat import WarpedViews


def unless_marks(images: Images, warped: WarpedViews, seen: Seen | None) -> Seen | None:
    """A solid that is told from marks on the table, and not these in its place, or in that of some of it."""
    if seen is None:
        return None
    fit = seen[1].fit
    if not shows_height(fit, images) or not warped.is_told_from_marks(fit):
        return None
    return None if warped.is_seen_in_place_of(fit) or warped.is_seen_in_place_of_some(fit) else seen
