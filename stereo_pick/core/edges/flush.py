"""How solids that stand or lie on a table touch it: flush with a face, along a line, or at a point."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.shapes.kinds import BOX, CYLINDER, HEX_PRISM, Kind, cross
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_GAP_M = 0.0002  # sigma of the height of what touches the table
_TILT_RAD = np.deg2rad(2.0)  # sigma of the angle between it and the table
_STANDS = 0.7  # cosine between the normal and the axis of what stands, rather than lies
_ON_A_SIDE = np.cos(np.deg2rad(8))


class Touching(NamedTuple):
    """By how many sigmas each of S solids is off the table: R gaps or tilts each.

    off: (S, R); by_solid: (S, R, P), its derivatives by centre [m], turns [rad] and half sizes [m]; by_table:
    (S, R, 3), by the tilts [rad] of the table towards two directions across its normal, and its height [m] at a point.
    """

    off: Floats
    by_solid: Floats
    by_table: Floats


def touching(solids: Solids, table: Table, across: Floats, middle_m: Floats) -> Touching:
    """How the solids touch the table; across: (2, 3), unit, and middle_m: (3,), where its tilts leave it.

    There are three rows each: the height of the middle of the face, the line or the point on which a solid rests, and
    the tilts of that; a line has one, a point none.
    """
    up = table.normal @ solids.rotation
    own, flat = resting(solids.kind, up)
    touched = _touched(solids, up, own, flat)
    height_m, by_solid = table.above(solids, touched)
    touch = Touching(np.zeros((len(up), 3)), np.zeros((len(up), 3, by_solid.shape[1])), np.zeros((len(up), 3, 3)))
    touch.off[:, 0], touch.by_solid[:, 0] = height_m / _GAP_M, by_solid / _GAP_M
    touch.by_table[:, 0, :2] = (_turned(solids, touched) + solids.centre_m - middle_m) @ across.T / _GAP_M
    touch.by_table[:, 0, 2] = 1 / _GAP_M
    _add_tilts(touch, solids, table, across, own, flat)
    return touch


def _add_tilts(touch: Touching, solids: Solids, table: Table, across: Floats, own: Floats, flat: Bools) -> None:
    """Fill in the rows of the tilts: of a face both ways, of a line along it."""
    axis, tilts = _turned(solids, own), slice(3, 3 + solids.turns.shape[2])
    for row, side in enumerate(across, start=1):
        touch.off[flat, row] = ((axis - table.normal) @ side / _TILT_RAD)[flat]
        touch.by_solid[flat, row, tilts] = (_by_turns(solids, own, side) / _TILT_RAD)[flat]
        touch.by_table[flat, row, row - 1] = -1 / _TILT_RAD
    touch.off[~flat, 1] = (axis @ table.normal / _TILT_RAD)[~flat]
    touch.by_solid[~flat, 1, tilts] = (_by_turns(solids, own, table.normal) / _TILT_RAD)[~flat]
    touch.by_table[~flat, 1, :2] = (axis @ across.T / _TILT_RAD)[~flat]


def _turned(solids: Solids, own: Floats) -> Floats:
    """Vectors (S, 3) in the solids' own axes, in the rectified left frame."""
    return np.asarray((solids.rotation @ own[..., None])[..., 0])


def _by_turns(solids: Solids, own: Floats, direction: Floats) -> Floats:
    """How far (S, Q) vectors (S, 3) in the solids' own axes reach in a direction (3,) as these turn."""
    return np.asarray((cross(own, direction @ solids.rotation)[:, None] @ solids.turns)[:, 0])


def _touched(solids: Solids, up: Floats, own: Floats, flat: Bools) -> Floats:
    """The middle (S, 3) [m] of the face or the line on which each solid rests, or its lowest point."""
    down = np.where(flat[:, None], -own, -up)
    touched = solids.kind.touch(down[:, None], solids.half_m)[:, 0]
    along = (touched * own).sum(axis=1, keepdims=True) * own
    return np.asarray(np.where(flat[:, None], along, touched - along))


def resting(kind: Kind, up: Floats) -> tuple[Floats, Bools]:
    """The axis (S, 3), in the solids' own, that is upright where each (S,) rests flat on a face, else level, if any.

    up: (S, 3), the normal in the solids' axes.
    """
    own = np.zeros(up.shape)
    rows = np.arange(len(up))
    if kind is BOX:
        axis = np.abs(up).argmax(axis=1)
        own[rows, axis] = np.sign(up[rows, axis])
        return own, np.ones(len(up), bool)
    if kind is not CYLINDER and kind is not HEX_PRISM:
        return own, np.zeros(len(up), bool)
    stands = np.abs(up[:, 2]) > _STANDS
    own[:, 2] = np.where(stands, np.sign(up[:, 2]), 1.0)
    if kind is CYLINDER:
        return own, stands
    side = _nearest_side(up)
    on_side = ~stands & ((side * up).sum(axis=1) > _ON_A_SIDE)
    return np.where(on_side[:, None], side, own), stands | on_side


def _nearest_side(up: Floats) -> Floats:
    """The outward normal (S, 3) of the side of a hexagonal prism that is turned upwards most."""
    sixth = np.pi / 3
    facing = (np.floor(np.arctan2(up[:, 1], up[:, 0]) / sixth) + 0.5) * sixth
    return np.stack([np.cos(facing), np.sin(facing), np.zeros(len(up))], axis=1)
