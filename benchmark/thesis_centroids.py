"""Table 3.15, the centroids that the thesis prints: under which reading their rays meet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from formatting import Row, Section, decimals, markdown_table
from thesis_printed import TABLE_3_15_LEFT_PX, TABLE_3_15_RIGHT_PX, TABLE_3_16_CM

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.parameters import transform
from stereo_pick.core.camera import Camera
from stereo_pick.core.rays import closest_points
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform
from stereo_pick.core.triangulation import Triangulator

_STEPS, _STEP_RAD = 20, 1e-6
_LEFT = Transform.identity()
_PRINTED_MM = np.array([calculated * 10 for calculated, _ in TABLE_3_16_CM.values()])


def readings_table(rig: StereoRig) -> Section:
    """How far the rays of the four objects miss each other, and the depths between the objects, however one reads."""
    readings = list(_readings(rig))
    plain = readings[0]
    turn = _fitted_turn(plain)
    angles = ", ".join(f"{angle:+.1f}°".replace("-", "−") for angle in np.degrees(turn))
    rows = [
        ["printed in the thesis (table 3.16)", "", *(decimals(mm, 1) for mm in _PRINTED_MM)],
        _row(plain.name, plain),
        _row(f"{plain.name}, depths in the right camera's frame", plain, plain.right_T_left),
        *(_row(reading.name, reading) for reading in readings[1:]),
        _row(f"{plain.name}, the right camera turned by {angles} about x, y, z (fitted)", plain.turned(turn)),
    ]
    header = ["pixels of table 3.15 read as", "rays miss by, mm"]
    table = markdown_table([*header, *(f"{a} to {b}, mm" for a, b in TABLE_3_16_CM)], rows)
    least_mm = min(float(reading.gaps_mm.max()) for reading in readings)
    limit_mm = Triangulator().max_ray_gap_m * 1000
    text = (
        f"{table}\n\nIn each of the {len(readings)} readings the rays of at least one object miss each other by "
        f"{least_mm:.1f} mm or more; the package refuses from {limit_mm:g} mm."
    )
    gaps_mm = plain.gaps_mm
    return Section(f"rays miss each other by {gaps_mm.min():.1f} to {gaps_mm.max():.1f} mm: refused as `ray_gap`", text)


@dataclass(frozen=True, eq=False)
class Reading:
    """Rays (4, 3) of the left and of the right camera, and how the cameras stand."""

    name: str
    left: Floats
    right: Floats
    right_T_left: Transform

    def turned(self, turn: Floats) -> Reading:
        """The same with the right camera turned on the spot by a rotation vector (3,) [rad]."""
        return replace(self, right_T_left=transform(turn, np.zeros(3)) @ self.right_T_left)

    @property
    def nearest(self) -> tuple[Floats, Floats]:
        """Where the rays come nearest to each other, on the left and on the right one (4, 3) [m]."""
        return closest_points(self.left, self.right, self.right_T_left)

    @property
    def gaps_mm(self) -> Floats:
        on_left, on_right = self.nearest
        return np.asarray(np.linalg.norm(on_left - on_right, axis=1) * 1000)

    def depths_mm(self, frame_T_left: Transform) -> Floats:
        """The depths of table 3.16, counted so that the thesis's are positive."""
        on_left, on_right = self.nearest
        z_mm = frame_T_left.apply((on_left + on_right) / 2)[:, 2] * 1000
        return np.array([z_mm[0] - z_mm[1], z_mm[2] - z_mm[0], z_mm[2] - z_mm[1], z_mm[0] - z_mm[3]])


def _readings(rig: StereoRig) -> Iterator[Reading]:
    """The plain reading first. Rectified pixels come with R and P, which hold the direction of R and T."""
    for pixels, order, views, direction in product(
        ("raw", "rectified"), ("(x, y)", "(row, column)"), ("", "views exchanged"), ("", "R and T as in eq. 3.14")
    ):
        if pixels == "rectified" and direction:
            continue
        step = 1 if order == "(x, y)" else -1
        left_px, right_px = TABLE_3_15_LEFT_PX[:, ::step], TABLE_3_15_RIGHT_PX[:, ::step]
        if views:
            left_px, right_px = right_px, left_px
        yield Reading(
            ", ".join(filter(None, (pixels, order, views, direction))),
            _rays(rig.left, left_px, pixels),
            _rays(rig.right, right_px, pixels),
            rig.right_T_left.inverse() if direction else rig.right_T_left,
        )


def _rays(camera: Camera, pixels: Floats, kind: str) -> Floats:
    return camera.rays(pixels) if kind == "rectified" else np.c_[camera.normalized(pixels), np.ones(len(pixels))]


def _row(name: str, reading: Reading, frame_T_left: Transform = _LEFT) -> Row:
    gaps_mm = reading.gaps_mm
    depths = (decimals(mm, 1).replace("-", "−") for mm in reading.depths_mm(frame_T_left))
    return [name, f"{gaps_mm.min():.1f} to {gaps_mm.max():.1f}", *depths]


def _fitted_turn(reading: Reading) -> Floats:
    """The rotation vector (3,) [rad] of the right camera that fits rays and printed depths best (Gauss-Newton)."""

    def residuals_mm(turn: Floats) -> Floats:
        turned = reading.turned(turn)
        on_left, on_right = turned.nearest
        off_mm = turned.depths_mm(_LEFT) - _PRINTED_MM
        return np.concatenate([(on_left - on_right).ravel() * 1000, off_mm])

    turn = np.zeros(3)
    for _ in range(_STEPS):
        here = residuals_mm(turn)
        slopes = [(residuals_mm(turn + step) - here) / _STEP_RAD for step in np.eye(3) * _STEP_RAD]
        turn = turn - np.linalg.lstsq(np.stack(slopes, axis=1), here, rcond=None)[0]
    return turn
