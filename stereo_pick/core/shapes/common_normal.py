"""The normal of the table that the solids of a scene stand on."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.shapes.kinds import BOX, SPHERE, cross, dot
from stereo_pick.core.shapes.solid_fit import SolidFit

ANGLE = np.sin(np.deg2rad(6))  # within which an axis stands or lies
BASE = 0.1  # of the solids' size, within which they stand on one table
_LEAD = 1.0  # votes by which the normal must lead before any other direction


def common_normal(fits: Sequence[SolidFit | None], faces: Sequence[SolidFit] = ()) -> Floats | None:
    """The direction (3,) towards the cameras in which the solids stand, rectified left frame; None where unclear.

    A cylinder or a hexagonal prism stands or lies, a box stands on a face: each votes for the directions in which its
    axes allow that. Each solid votes again where its lowest point is as low as the others'. Thin solids that are the
    lit faces of something vote for being level. One object alone decides nothing: nobody can tell a standing cylinder
    from a lying one by itself.
    """
    solids = [fit for fit in fits if fit is not None]
    turned = [fit for fit in solids if fit.kind != SPHERE.name]
    if not solids or len(turned) + len(faces) < 2:
        return None
    level = [across(face) for face in faces]
    candidates = np.array([*_candidates(turned), *level])
    votes = _orientation_votes(candidates, turned) + [_base_votes(each, solids) for each in candidates]
    for normal in level:
        votes += _vote(np.linalg.norm(np.cross(candidates, normal), axis=1) / ANGLE)
    best = candidates[votes.argmax()]
    others = votes[np.abs(candidates @ best) < np.cos(np.deg2rad(12))]
    least = 0.5 * (len(turned) + len(solids) + len(faces))
    if votes.max() < least or (len(others) and others.max() > votes.max() - _LEAD):
        return None
    return _towards_cameras(_mean(best, turned, level), solids)


def across(face: SolidFit) -> Floats:
    """The direction (3,) across a thin solid, towards the cameras."""
    thin = face.rotation[:, int(face.size_m.argmin())]
    return np.asarray(-thin * np.sign(thin @ face.centre_m))


def _candidates(turned: Sequence[SolidFit]) -> list[Floats]:
    """All axes (3,), and the directions across two that differ: unit vectors."""
    axes = [axis for fit in turned for axis in standing_axes(fit)]
    own = [fit.rotation[:, 2] for fit in turned if fit.kind != BOX.name]
    beside = [np.cross(one, other) for one, other in combinations(own, 2)]
    axes += [each / np.linalg.norm(each) for each in beside if np.linalg.norm(each) > 0.35]
    return axes


def standing_axes(fit: SolidFit) -> list[Floats]:
    """The axes that may stand upright."""
    return list(fit.rotation.T) if fit.kind == BOX.name else [fit.rotation[:, 2]]


def _orientation_votes(normals: Floats, turned: Sequence[SolidFit]) -> Floats:
    """Those (C,) for each of several normals (C, 3)."""
    votes = np.zeros(len(normals))
    for fit in turned:
        along = np.abs(normals @ np.array(standing_axes(fit)).T)
        off = np.sqrt(np.maximum(1 - along.max(axis=1) ** 2, 0))
        if fit.kind != BOX.name:
            off = np.minimum(off, along[:, 0])
        votes += _vote(off / ANGLE)
    return votes


def is_upright(normal: Floats, fit: SolidFit) -> bool:
    """Whether a solid stands or lies on what has this normal (3,)."""
    return fit.kind == SPHERE.name or min(_standing(normal, fit), _lying(normal, fit)) < ANGLE


def _standing(normal: Floats, fit: SolidFit) -> float:
    """Sine of the angle between the normal and the nearest axis that may stand."""
    across = cross(np.array(standing_axes(fit)), normal)
    return float(np.sqrt(dot(across, across).min()))


def _lying(normal: Floats, fit: SolidFit) -> float:
    """Sine of the angle by which a cylinder or a hexagonal prism is off lying; a box always stands."""
    return np.inf if fit.kind == BOX.name else abs(float(fit.rotation[:, 2] @ normal))


def _base_votes(normal: Floats, solids: Sequence[SolidFit]) -> float:
    base_m = lowest_m(_towards_cameras(normal, solids), solids)
    return float(_vote(_off_common_base(base_m, solids)).sum())


def lowest_m(normal: Floats, solids: Sequence[SolidFit]) -> Floats:
    """How high (S,) [m] the lowest point of each solid is above the camera, along a normal (3,) towards the cameras."""
    return np.array([fit.centre_m @ normal - fit.reach_m(-normal) for fit in solids])


def near_common_base(base_m: Floats, solids: Sequence[SolidFit]) -> Bools:
    """Which (S,) of the lowest points (S,) [m] are as low as most."""
    return np.asarray(_off_common_base(base_m, solids) < 1)


def _off_common_base(base_m: Floats, solids: Sequence[SolidFit]) -> Floats:
    size_m = float(np.mean([fit.size_m.mean() for fit in solids]))
    return np.abs(base_m - np.median(base_m)) / (BASE * size_m)


def _vote(off: Floats) -> Floats:
    """1 for what is exactly so, 0 for what is off (N,) by the tolerance, 1, and more."""
    return np.asarray(np.maximum(1 - off**2, 0))


def _towards_cameras(normal: Floats, solids: Sequence[SolidFit]) -> Floats:
    away = np.mean([fit.centre_m for fit in solids], axis=0) @ normal > 0
    return -normal if away else normal


def _mean(normal: Floats, turned: Sequence[SolidFit], level: Sequence[Floats]) -> Floats:
    """The direction nearest to the standing axes and furthest from the lying ones, of the solids that agree, and
    nearest to what is across level faces."""
    spread = np.zeros((3, 3))
    for fit in turned:
        upright = max(standing_axes(fit), key=lambda axis: abs(float(axis @ normal)))
        if min(_standing(normal, fit), _lying(normal, fit)) < ANGLE:
            spread += np.outer(upright, upright) * (1 if _standing(normal, fit) < ANGLE else -1)
    for each in level:
        if np.linalg.norm(np.cross(each, normal)) < ANGLE:
            spread += np.outer(each, each)
    return np.asarray(np.linalg.eigh(spread)[1][:, -1])
