"""The table that the solids of a scene stand on, found from the solids themselves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes.common_normal import (
    ANGLE,
    BASE,
    common_normal,
    is_upright,
    lowest_m,
    near_common_base,
    standing_axes,
)
from stereo_pick.core.shapes.kinds import CYLINDER, HEX_PRISM, SPHERE
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table

_AXIS_RAD = np.deg2rad(0.5)  # sigma of one solid's axis
_LEAST_SIGMA_M = 0.0003
_LEAST = 2
_BESIDE_M = 0.1  # from the middle of the solids that show the table, where others may stand
_THIN = 0.2  # height by length of what may be the top of a body only
_STEEP = np.sin(np.deg2rad(25))  # of the least angle at which a table is looked at
_STANDS = 0.7  # cosine
_SURELY = 3.0  # sigmas
SUPPOSED_SIGMA_M = 0.001


def common_table(fits: Sequence[SolidFit | None], faces: Sequence[SolidFit] = ()) -> Table | None:
    """The plane that the solids stand on, rectified left frame; None where too few of them agree on one, or the cameras
    would hardly see it.

    The axes say how it is inclined, and so do the lowest points of solids that are far apart: both count as their
    sigmas allow. faces: thin solids, lit faces that are level.
    """
    normal = common_normal(fits, faces)
    if normal is None:
        return None
    solids = [fit for fit in fits if fit is not None]
    base_m = lowest_m(normal, solids)
    on_it = np.flatnonzero(near_common_base(base_m, solids))
    if len(on_it) < _LEAST:
        return None
    feet_m = np.array([solids[i].centre_m - (solids[i].centre_m @ normal - base_m[i]) * normal for i in on_it])
    sigma_m = np.array([np.hypot(2 * np.sqrt(normal @ solids[i].covariance @ normal), _LEAST_SIGMA_M) for i in on_it])
    across = np.linalg.svd(normal[None])[2][1:]
    middle = feet_m.mean(axis=0)
    if not _is_looked_at(normal, middle):
        return None
    rows = np.c_[(feet_m - middle) @ across.T, np.ones(len(feet_m))] / sigma_m[:, None]
    known = np.diag([1.0, 1.0, 0.0]) * len(on_it) / _AXIS_RAD**2
    covariance = np.linalg.inv(rows.T @ rows + known)
    tilt_x, tilt_y, _ = found = -covariance @ rows.T @ ((feet_m - middle) @ normal / sigma_m)
    tilted = normal + tilt_x * across[0] + tilt_y * across[1]
    off = ((feet_m - middle) @ normal) / sigma_m + rows @ found
    worse = max(1.0, float(np.sqrt((off**2).mean())))
    offset_m = (float(found[2]) - float(middle @ tilted)) / float(np.linalg.norm(tilted))
    sigma = float(np.sqrt(covariance[2, 2] + covariance[:2, :2].trace() / 2 * _BESIDE_M**2)) * worse
    return Table(tilted / np.linalg.norm(tilted), offset_m, sigma)


def supposed_tables(fits: Sequence[SolidFit | None]) -> list[Table]:
    """What the solids would stand on, one by one, if they stand on a face that the cameras do not see, and what
    cylinders and balls would lie on together; those on which most of them would stand come first.

    Most of these are wrong: another object must be found on a table before it is believed.
    """
    bodies = [fit for fit in fits if fit is not None and fit.flatness >= _THIN]
    turned = [fit for fit in bodies if fit.kind != SPHERE.name]
    supposed = [(axis * sign, fit) for fit in turned for axis in standing_axes(fit) for sign in (-1.0, 1.0)]
    cylinders, balls = ([fit for fit in bodies if fit.kind == kind.name] for kind in (CYLINDER, SPHERE))
    supposed += [(normal, lying) for lying in cylinders for ball in balls for normal in _under_both(lying, ball)]
    tables = [
        Table(up, -float(lowest_m(up, [fit])[0]), SUPPOSED_SIGMA_M)
        for up, fit in supposed
        if _is_looked_at(up, fit.centre_m)
    ]
    return sorted(tables, key=lambda table: -sum(stands_on(table, fit) for fit in bodies))


def _is_looked_at(normal: Floats, place_m: Floats) -> bool:
    """Whether the left camera sees a table at a place (3,) from above, and not too much from the side."""
    return bool(float(-normal @ place_m) > _STEEP * float(np.linalg.norm(place_m)))


def _under_both(lying: SolidFit, ball: SolidFit) -> list[Floats]:
    """The normals (3,) of the planes on which a cylinder lies beside a ball."""
    axis = lying.rotation[:, 2]
    across = np.cross(axis, np.cross(ball.centre_m - lying.centre_m, axis))
    length_m, rise_m = float(np.linalg.norm(across)), float(ball.size_m[0] - lying.size_m[0]) / 2
    if not length_m > abs(rise_m):
        return []
    beside, rise = across / length_m, rise_m / length_m
    return [rise * beside + sign * np.sqrt(1 - rise**2) * np.cross(axis, beside) for sign in (-1.0, 1.0)]


def stands_on(table: Table, fit: SolidFit) -> bool:
    """Whether a solid stands or lies on a table."""
    return abs(base_m(table, fit)) < BASE * float(fit.size_m.mean()) and is_upright(table.normal, fit)


def surely_on(table: Table, fit: SolidFit) -> bool:
    """Whether a solid stands or lies as near to a table as its own sigma and the table's allow."""
    sigma_m = np.hypot(2 * np.sqrt(table.normal @ fit.covariance @ table.normal), table.sigma_m)  # twice: of its end
    return abs(base_m(table, fit)) < _SURELY * sigma_m and is_upright(table.normal, fit)


def hangs_above(table: Table, fit: SolidFit) -> bool:
    """Whether a solid is turned as if it stood or lay on a table, but is held, or supported, above it.

    What would hang higher than it is itself is rather the lit top of something.
    """
    height_m = fit.reach_m(table.normal) + fit.reach_m(-table.normal)
    return 0 < base_m(table, fit) < height_m and is_upright(table.normal, fit) and _is_stable(table.normal, fit)


def hangs_clear(table: Table, fit: SolidFit) -> bool:
    """Whether it does, and does not stand there after all, being tall."""
    return hangs_above(table, fit) and not stands_on(table, fit)


def _is_stable(normal: Floats, fit: SolidFit) -> bool:
    """Whether a solid would stay as it is if it were put down: a hexagonal prism lies on one of its sides."""
    across, beside, along = normal @ fit.rotation
    if fit.kind != HEX_PRISM.name or abs(along) > _STANDS:
        return True
    off = np.arctan2(beside, across) % (np.pi / 3) - np.pi / 6  # a side faces 30 degrees from a corner, and every 60
    return bool(abs(np.sin(off)) < ANGLE)


def base_m(table: Table, fit: SolidFit) -> float:
    """How high [m] above a table the lowest point of a solid is."""
    height_m, _ = table.under(fit.solid)
    return float(height_m[0])
