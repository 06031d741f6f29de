"""Solids that their patterns show: a pattern has edges of its own beside those of the solid, which lie off by more then
than those of a plain one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from stereo_pick.core.doubts.seen_surface import is_seen_beyond, is_surface_seen
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.supported import Supported
from stereo_pick.core.places.located import TOP, is_flat
from stereo_pick.core.shapes.fitting import Pair
from stereo_pick.core.shapes.kinds import KINDS
from stereo_pick.core.shapes.solid_fit import SolidFit

_HALF = 1 / 2  # of its silhouette
PATTERN_PX = 0.5  # by which edges may be off


def patterned(images: Images, solids: Sequence[Supported], before: Sequence[SolidFit]) -> Iterator[Supported]:
    """Those of which the surface is seen where it is, and not beyond; the best first. before: what may hide others."""
    for each in sorted(solids, key=lambda each: -each.score):
        seen = images.pair, each.fit, before
        if _may_be(each) and is_surface_seen(*seen) and not is_seen_beyond(*seen):
            yield each


def near_outlines(images: Images, outlines: Pair) -> list[Supported]:
    """The solids that come near an object's outlines, and longer ones, on whatever table."""
    near = [images.of_kind(outlines, kind)[0] for kind in KINDS.values()]
    longer = [images.longer(each) for each in near]
    return [*images.all_locked(near, None), *(each for each in longer if each is not None)]


def _may_be(found: Supported) -> bool:
    return found.support > _HALF and found.fit.residual_px < PATTERN_PX and not is_flat(found.fit, TOP)
