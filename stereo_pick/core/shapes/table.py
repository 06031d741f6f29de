"""The table that objects stand on: one more plane that touches each of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.errors import ArrayError
from stereo_pick.core.shapes.kinds import cross, dot
from stereo_pick.core.shapes.solids import Solids

FOUND, NONE = "found", "none"
_GIVEN_SIGMA_M = 0.001
TILT_RAD = float(np.deg2rad(0.5))  # sigma, as long as nothing else is known of it
_UNIT = 1e-2
_FARTHEST_M = 20.0  # as far as a robot's cell reaches; beyond it are millimetres
EDGE_ON = 0.1  # sine of the angle at which a table is hardly seen


@dataclass(frozen=True, eq=False)
class Table:
    """The points p [m] of the rectified left frame with normal @ p + offset_m = 0.

    normal: (3,), unit, towards the cameras; sigma_m: of its height where objects stand; tilt_rad: sigma of its tilts.
    """

    normal: Floats
    offset_m: float
    sigma_m: float
    tilt_rad: float = TILT_RAD

    def __post_init__(self) -> None:
        object.__setattr__(self, "normal", floats("normal", self.normal, 3))

    @staticmethod
    def parsed(text: str) -> Table:
        """Read `nx ny nz d`; raises ArrayError where that is no plane in front of the cameras."""
        try:
            *normal, offset_m = (float(word) for word in text.replace(",", " ").split())
        except ValueError:
            normal, offset_m = [], 0.0
        length = float(np.linalg.norm(normal))
        if len(normal) != 3 or not np.isfinite(length + offset_m) or abs(length - 1) > _UNIT:
            raise ArrayError(f"must be {FOUND}, {NONE}, or four numbers: a unit normal and an offset in metres")
        if normal[2] >= 0 or offset_m <= 0:
            raise ArrayError("the normal must point towards the cameras, so its z is negative and the offset positive")
        if normal[2] > -EDGE_ON * length:
            raise ArrayError(f"the cameras would see it edge-on: the normal's z is {normal[2]:g}, at most {-EDGE_ON}")
        if offset_m > _FARTHEST_M * length:
            raise ArrayError(f"the table would be {offset_m:g} m from the camera: give the offset in metres, not mm")
        return Table(np.array(normal) / length, offset_m / length, _GIVEN_SIGMA_M)

    @property
    def text(self) -> str:
        """What `parsed` reads, to a micrometre."""
        return " ".join(f"{each:.6f}" for each in (*self.normal.tolist(), self.offset_m))

    def height_m(self, points_m: Floats) -> Floats:
        """How high (...) above the table points (..., 3) are."""
        return np.asarray(points_m @ self.normal + self.offset_m)

    def under(self, solids: Solids) -> tuple[Floats, Floats]:
        """How high (S,) [m] the lowest point of each solid is, and its derivatives: see `above`."""
        down = (-self.normal @ solids.rotation)[:, None]
        return self.above(solids, solids.kind.touch(down, solids.half_m)[:, 0])

    def above(self, solids: Solids, own_m: Floats) -> tuple[Floats, Floats]:
        """How high (S,) [m] points (S, 3) [m] in the solids' own axes are, and the derivatives (S, 3 + Q + sizes) of
        that by centre [m], turns [rad] and half sizes [m]."""
        up = self.normal @ solids.rotation
        gradient = np.concatenate(
            [
                np.broadcast_to(self.normal, solids.centre_m.shape),
                (cross(own_m, up)[:, None] @ solids.turns)[:, 0],
                ((own_m * up)[:, None] @ (solids.kind.shares / solids.half_m[:, None]))[:, 0],
            ],
            axis=1,
        )
        return self.height_m(solids.centre_m) + dot(own_m, up), gradient

    def put_down(self, solids: Solids) -> Solids:
        """The solids moved along the normal until they touch the table."""
        height_m, _ = self.under(solids)
        centre_m = solids.centre_m - height_m[:, None] * self.normal
        return Solids(solids.kind, centre_m, solids.rotation, solids.half_m, solids.turns)
