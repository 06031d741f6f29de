"""From two outlines of an object to the image points of the centre of its volume.

The centre of an outline is not the image of the object's centre: what is nearer looks larger. A solid that explains
both outlines says how far off it is; where the outlines show only a part of the object, the solid says the rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stereo_pick.core.edges.adjusted import is_astray
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.supported import Supported
from stereo_pick.core.edges.tubes import tube_of
from stereo_pick.core.objects.blob import CUT, MAY_BE_CUT, SHARP, Blob
from stereo_pick.core.objects.splitting import may_be_two
from stereo_pick.core.places.one_plane import shows_one_face
from stereo_pick.core.places.position import (
    BlobPair,
    Located,
    by_outlines,
    by_solid,
    by_stretched,
    by_supported,
)
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes import Outline, SolidFit, fit_solids
from stereo_pick.core.shapes.fitting import Pair, can_be_fitted
from stereo_pick.core.shapes.kinds import CYLINDER, SPHERE
from stereo_pick.core.shapes.table import Table

_MAY_FADE = 0.35  # part of an outline that may fade, or be cut, where a solid explains the rest
_MAY_FADE_UNEXPLAINED = 0.15  # ... and where the outline is all that is known
_SLIGHT = 0.25  # of max_concavity
_NOTCH, _FADES = 0.5, 0.02  # of max_concavity, of the outline, in both views: light fades where the notch is
_COMPLETE = 0.05  # ... and where its centroid is more precise than the solid's
_SHARP_LIMB = 0.75  # of an outline: the light on a round body fades towards it, that on what is flat ends there
_SURELY_SHARP = 0.5
_SURELY_ONE = 0.9  # part of a notched outline from which on a tube that it lies on is the reason for the notch
_FLAT = 0.08  # thickness by length of what may be a print
TOP = 0.15  # ... of what may be the lit top of a body, as long as no table is known


def locate(images: Images, matched: Sequence[BlobPair], max_concavity: float, flat_parts: bool) -> list[Located]:
    """Find the centre of every matched object, or say why it cannot be known.

    max_concavity: of one part's outline; flat_parts: whether what shows one face only may be a flat part.
    """
    outlines = [trusted_outlines(blobs, SHARP) for blobs in matched]
    whole = [_is_whole(blobs, max_concavity) for blobs in matched]
    found = iter(fit_solids([each for each, one in zip(outlines, whole) if one], images.rig, nearest=images.nearest))
    fits = [next(found) if one else None for one in whole]
    readings = [[] if fit else _readings(blobs, each) for blobs, each, fit in zip(matched, outlines, fits)]
    best = images.best(readings)
    located = [_locate(images, *each, max_concavity) for each in zip(matched, outlines, best, fits)]
    return located if flat_parts else [_unless_flat(images.rig, *each) for each in zip(matched, located)]


def _locate(
    images: Images, blobs: BlobPair, outlines: Pair, best: Supported | None, fit: SolidFit | None, max_concavity: float
) -> Located:
    fading = max(blob.fading for blob in blobs)
    if fit is not None:
        longer = _longer(images, outlines, blobs, fit)
        if longer is not None:
            return by_stretched(images.rig, fit, longer) if longer.believable else refused_as(blobs, "half_lit")
        unseen = max(fading, *(blob.cut_share for blob in blobs))
        complete = unseen <= _COMPLETE
        return by_outlines(images.rig, blobs, fit) if complete else by_solid(images.rig, fit, 1 - unseen)
    if best is not None and images.shows_beyond(best.fit.solid, [(b.contour_px, b.sharpness > CUT) for b in blobs]):
        return by_supported(images.rig, best)
    tube = _tube(images, blobs, outlines)
    if (tube is None or tube.support < _SURELY_ONE) and _may_be_several(blobs, max_concavity):
        return refused_as(blobs, "merged")
    if _is_half_lit(images, blobs, outlines, max_concavity):
        return refused_as(blobs, "half_lit")
    if tube is None:
        return by_outlines(images.rig, blobs, None)
    return _by_tube(images, tube)


def as_tube_on(images: Images, blobs: BlobPair, table: Table) -> Located | None:
    """What the outlines alone leave open as a tube that lies or stands on the table; None where that is not seen. Its
    outlines may fade on one side: they need not tell how high up it is."""
    outlines = trusted_outlines(blobs, SHARP)
    tube = None if _has_no_own_side(images, blobs, outlines) else tube_of(images, outlines, table)
    return _by_tube(images, tube) if tube is not None else None


def _by_tube(images: Images, tube: Supported) -> Located:
    return replace(by_supported(images.rig, tube), is_rough=is_astray(tube.fit))


def _may_be_several(blobs: BlobPair, max_concavity: float) -> bool:
    if _is_notched(blobs, max_concavity) or max(blob.cut_share for blob in blobs) > MAY_BE_CUT:
        return True
    return any(blob.concavity > _SLIGHT * max_concavity and may_be_two(blob) for blob in blobs)


def _is_half_lit(images: Images, blobs: BlobPair, outlines: Pair, max_concavity: float) -> bool:
    notched = min(b.concavity for b in blobs) > _NOTCH * max_concavity and min(b.fading_notch for b in blobs) > _FADES
    if notched or sum(b.fading for b in blobs) / 2 > _MAY_FADE_UNEXPLAINED:
        return True
    return can_be_fitted(outlines) and images.hides_a_side(outlines)


def _tube(images: Images, blobs: BlobPair, outlines: Pair) -> Supported | None:
    """The tube that an object is, as a cylinder, where its outlines are its own all around, and sharp nearly all."""
    if max(blob.fading for blob in blobs) > _MAY_FADE_UNEXPLAINED or _has_no_own_side(images, blobs, outlines):
        return None
    return tube_of(images, outlines)


def _has_no_own_side(images: Images, blobs: BlobPair, outlines: Pair) -> bool:
    """Whether too much of the outlines is not an object's own, or all of them are of one face."""
    if max(blob.cut_share for blob in blobs) > MAY_BE_CUT or not can_be_fitted(outlines):
        return True
    return shows_one_face(*blobs, images.rig)


def _is_whole(blobs: BlobPair, max_concavity: float) -> bool:
    """Whether a solid that explains the outlines needs no support by other edges."""
    return not _is_notched(blobs, max_concavity) and max(blob.fading for blob in blobs) <= _MAY_FADE


def _is_notched(blobs: BlobPair, max_concavity: float) -> bool:
    return any(blob.concavity > max_concavity for blob in blobs)


def _readings(blobs: BlobPair, outlines: Pair) -> list[Pair]:
    """The outlines trusted as far as usual, where their edges are surely sharp only, and where they are in no notch:
    what is lit of a body may have one, its silhouette has none. What of it can be fitted, each once."""
    several = [outlines, trusted_outlines(blobs, _SURELY_SHARP), convex_outlines(blobs)]
    return [pair for pair in dict.fromkeys(several) if can_be_fitted(pair)]


def trusted_outlines(blobs: BlobPair, sharp: float, *, convex: bool = False) -> Pair:
    """Those of both views; trusted where they are at least so sharp and, if they must be convex, on their hulls."""
    left, right = (
        Outline.from_contour(b.contour_px, (b.sharpness >= sharp) & (b.on_hull if convex else True)) for b in blobs
    )
    return left, right


def convex_outlines(blobs: BlobPair) -> Pair:
    """Those of both views, trusted where they are as sharp as usual, and in no notch."""
    return trusted_outlines(blobs, SHARP, convex=True)


def _unless_flat(rig: StereoRig, blobs: BlobPair, located: Located) -> Located:
    """The lit top of a body and a flat part look the same."""
    if located.reason:
        return located
    if located.fit is None:
        return refused_as(blobs, "flat") if shows_one_face(*blobs, rig) else located
    return replace(located, reason="flat") if is_flat(located.fit, TOP) else located


def is_flat(fit: SolidFit, flat: float = _FLAT) -> bool:
    """Whether a solid is so thin that it may be a print, or the lit top of another."""
    return fit.flatness < flat


def ends_sharply(blob: Blob) -> bool:
    """Whether the edge of an outline is as sharp as those of what is flat: the light on a round body fades there."""
    return bool(len(blob.sharpness)) and float(np.median(blob.sharpness)) > _SHARP_LIMB


def _longer(images: Images, outlines: Pair, blobs: BlobPair, fit: SolidFit) -> Supported | None:
    """A longer solid that makes this one doubtful.

    Seen from above, the end of a cylinder is as round as a ball, but its edge is sharp where a ball's light fades
    towards its limb, most often: only a cylinder that is sure itself speaks against a ball.
    """
    if fit.kind != SPHERE.name:
        return images.contradicts(fit.solid)
    if not all(ends_sharply(blob) for blob in blobs):
        return None
    longer = images.contradicts(images.of_kind(outlines, CYLINDER)[0])
    return longer if longer is not None and longer.believable else None


def refused_as(blobs: BlobPair, reason: str) -> Located:
    """An object of these outlines of which the place is not known, for a reason."""
    return Located(blobs[0].centroid_px, blobs[1].centroid_px, 1.0, None, reason)
