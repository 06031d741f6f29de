"""Where an object's centre appears in both views, and how sure that is: by its outlines, or by the solid that it is."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.hypotheses import BODY
from stereo_pick.core.edges.rims import to_rims
from stereo_pick.core.edges.supported import Supported
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.blob import SHARP
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes import SolidFit, centroid_px
from stereo_pick.core.shapes.evidence import ARC_PX, USUAL_PX
from stereo_pick.core.shapes.kinds import CYLINDER

_BY_SOLID_SIGMA_PX = 0.13  # of a solid's edges as a whole
_ARC_SIGMA_PX = 0.21  # by which light and shading move an arc of an outline
_POINT_SIGMA_PX = 0.01  # of the image of a solid's centre, beside where the solid is
_MISSING = np.pi / 6  # see `_missing_sigma_px`
_UNKNOWN_SHAPE = 0.04  # sigma of the centre of an unknown shape, as a part of its length
_DISAGREE = 2.5  # sigmas
_DOUBT = 0.05  # one sigma of what may be larger or smaller, as a part of its size

BlobPair = tuple[Blob, Blob]


@dataclass(frozen=True, eq=False)
class Located:
    """Image points (2,) [px] of an object's centre, their sigma [px], and the solid, if one explains it; or the
    reason why they are not known. In the rectified left frame [m²], (3, 3): covariance, of what moves both points
    together, beside their sigma; doubt, the part of all this that is about which solid it is. is_rough: whether the
    solid is known to lie so far off that the edges say no more of it than its outlines."""

    left_px: Floats
    right_px: Floats
    sigma_px: float
    fit: SolidFit | None
    reason: str = ""
    covariance: Floats = field(default_factory=lambda: np.zeros((3, 3)))
    doubt: Floats = field(default_factory=lambda: np.zeros((3, 3)))
    is_rough: bool = False


Row = tuple[BlobPair, Located]
"""An object's outlines, and where it is."""


def by_outlines(rig: StereoRig, blobs: BlobPair, fit: SolidFit | None) -> Located:
    """The solid-angle centroids of the outlines, moved by what the solid says of perspective.

    Where they lie off the solid's own centre by more than their noise, a piece of an outline is not the object's: the
    solid, which leaves out such pieces, decides.
    """
    cameras = rig.left, rig.right
    left_px, right_px = centres_by_outlines_px(rig, blobs, fit)
    length_px = min(len(blob.contour_px) for blob in blobs)  # a point each pixel
    rougher = max(1.0, fit.residual_px / USUAL_PX) if fit is not None else 1.0
    variance = (_ARC_SIGMA_PX * rougher) ** 2 * ARC_PX / length_px
    if fit is not None:
        own = [fit.centre_px(camera) for camera in cameras]
        off_px = max(float(np.linalg.norm(place - seen)) for place, seen in zip(own, (left_px, right_px)))
        if off_px > _DISAGREE * np.sqrt(variance):
            return Located(own[0], own[1], float(np.sqrt(variance + (off_px / 3) ** 2)), fit)
    else:
        variance += (_UNKNOWN_SHAPE * max(blob.rectangle[0] for blob in blobs)) ** 2
    variance += float(left_px[1] - right_px[1]) ** 2 / 2
    return Located(left_px, right_px, float(np.sqrt(variance)), fit)


def centres_by_outlines_px(rig: StereoRig, blobs: BlobPair, fit: SolidFit | None) -> tuple[Floats, Floats]:
    """The solid-angle centroids (2,) of the outlines in both views, moved to the centre's image as far as a solid says
    by how much."""
    left_px, right_px = (centroid_px(blob.contour_px, camera) for blob, camera in zip(blobs, (rig.left, rig.right)))
    if fit is None:
        return left_px, right_px
    return left_px + fit.perspective_shift_px(rig.left), right_px + fit.perspective_shift_px(rig.right)


def by_stretched(rig: StereoRig, fit: SolidFit, longer: Supported) -> Located:
    """The longer solid's centre; where the shorter one is a body, too, and its shadow may be what was found beyond it,
    no surer than the two agree."""
    if fit.flatness >= BODY:
        off_m = longer.fit.centre_m - fit.centre_m
        longer = replace(longer, doubt=longer.doubt + float(off_m @ off_m) / 4 * np.eye(3))
    return by_supported(rig, longer)


def by_supported(rig: StereoRig, found: Supported) -> Located:
    """The images of the centre of a solid on edges, as sure as it is that it is this solid."""
    where = by_solid(rig, found.fit, found.support)
    doubt_px = np.sqrt(_spread(_covariance_per_px2(rig, found.fit.centre_m), found.doubt))
    return replace(where, sigma_px=float(np.hypot(where.sigma_px, doubt_px)), doubt=found.doubt)


def by_solid(rig: StereoRig, fit: SolidFit, shown: float) -> Located:
    """The images of the solid's centre; its covariance as the least sigma that covers it.

    shown: the part of its silhouette that lies on edges.
    """
    left_px, right_px = fit.centre_px(rig.left), fit.centre_px(rig.right)
    per_px2 = _covariance_per_px2(rig, fit.centre_m)
    spread = _spread(per_px2, fit.covariance)
    missing_px = _missing_sigma_px(fit, shown, rig.focal_px)
    return Located(left_px, right_px, float(np.sqrt(_BY_SOLID_SIGMA_PX**2 + missing_px**2 + spread)), fit)


def of_size(fit: SolidFit) -> Floats:
    """Covariance (3, 3) [m²] of the centre of what may be larger or smaller."""
    return np.asarray((_DOUBT * float(fit.size_m.mean())) ** 2 * np.eye(3))


def of_thickness(fit: SolidFit) -> Floats:
    """Covariance (3, 3) [m²] of the centre of what may be anywhere within its least size."""
    return np.asarray(float(fit.size_m.min()) ** 2 / 12 * np.eye(3))


def depth_m(where: Located, rig: StereoRig) -> float:
    """How far away two image points say that something is: Z = f B / d."""
    offset_px = rig.left.P[0, 2] - rig.right.P[0, 2]
    disparity_px = float(where.left_px[0] - where.right_px[0] - offset_px)
    return rig.focal_px * rig.baseline_m / max(disparity_px, 1e-6)


def by_adjusted(rig: StereoRig, where: Located, fit: SolidFit, doubt: Floats) -> Located:
    """The images of a solid's centre, known as well as its covariance says; doubt: (3, 3) [m²], of what solid it is.

    where: by its outlines. They stay as far apart in their rows as these are: by that the outlines do not agree.
    """
    apart_px = np.array([0.0, float(where.left_px[1] - where.right_px[1]) / 2])
    left_px, right_px = fit.centre_px(rig.left) + apart_px, fit.centre_px(rig.right) - apart_px
    return Located(left_px, right_px, _POINT_SIGMA_PX, fit, covariance=fit.covariance + doubt)


def may_have_dark_ends(where: Located) -> bool:
    """Whether an object is known to be one of those of which outlines may leave an end out."""
    return where.fit is not None and where.fit.kind == CYLINDER.name


def with_dark_ends(rig: StereoRig, blobs: BlobPair, where: Located) -> Located:
    """The same, of a cylinder whose outlines leave an end out because its face is as dark as the table."""
    if where.fit is None or not may_have_dark_ends(where):
        return where
    whole = to_rims(where.fit, rig, [blob.contour_px[blob.sharpness >= SHARP] for blob in blobs])
    left_px, right_px = (whole.centre_px(camera) - where.fit.centre_px(camera) for camera in (rig.left, rig.right))
    return replace(where, left_px=where.left_px + left_px, right_px=where.right_px + right_px, fit=whole)


def _missing_sigma_px(fit: SolidFit, shown: float, focal_px: float) -> float:
    """What the part of an outline that is not shown may hide, as sigma of the centroid.

    Where an arc c of a circle of radius r is replaced by something else, that may go about c / 8 beyond or short of it:
    an area of c²/8 at the distance r from the centre, so that the centroid moves by c²/8 r / (pi r²). With the part m
    missing, c = 2 pi r m, that is pi/2 m² r; a third of it is taken as one sigma.
    """
    radius_px = float(fit.size_m.mean()) / 2 * focal_px / float(fit.centre_m[2])
    return float(_MISSING * (1 - shown) ** 2 * radius_px)


def _spread(per_px2: Floats, covariance: Floats) -> float:
    """The least variance [px²] of image points that covers a covariance (3, 3) [m²]."""
    return max(0.0, float(np.linalg.eigvals(np.linalg.solve(per_px2, covariance)).real.max()))


def _covariance_per_px2(rig: StereoRig, centre_m: Floats) -> Floats:
    """Covariance (3, 3) [m²] of a point whose image points are off by one sigma of one pixel each."""
    x, y, z = centre_m
    focal, baseline = rig.focal_px, rig.baseline_m
    scale = z / (focal * baseline)
    jacobian = np.array(
        [
            [(baseline - x) * scale, x * scale, 0.0, 0.0],
            [-y * scale, y * scale, z / focal / 2, z / focal / 2],
            [-z * scale, z * scale, 0.0, 0.0],
        ]
    )
    return np.asarray(jacobian @ jacobian.T)
