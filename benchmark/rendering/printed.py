"""What is printed on tables or drilled into them: grids, boards, markers, text, spots; flat."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rendering.tabletop import Paint, own
from stereo_pick.core.arrays import Floats


@dataclass(frozen=True)
class Holes(Paint):
    """Round dark holes in a square grid."""

    pitch_m: float
    diameter_m: float
    yaw_rad: float
    shade: float

    def over(self, xy_m: Floats, albedo: Floats) -> Floats:
        along, across = own(xy_m, 0, 0, self.yaw_rad)
        away = [(each + self.pitch_m / 2) % self.pitch_m - self.pitch_m / 2 for each in (along, across)]
        return np.where(np.hypot(*away) < self.diameter_m / 2, albedo * self.shade, albedo)


@dataclass(frozen=True)
class Lines(Paint):
    """A square grid of lines."""

    pitch_m: float
    width_m: float
    yaw_rad: float
    shade: float

    def over(self, xy_m: Floats, albedo: Floats) -> Floats:
        half_m = self.pitch_m / 2
        away = [np.abs((each + half_m) % self.pitch_m - half_m) for each in own(xy_m, 0, 0, self.yaw_rad)]
        return np.where(np.minimum(*away) < self.width_m / 2, np.minimum(albedo * self.shade, 0.9), albedo)


@dataclass(frozen=True)
class Slots(Paint):
    """Bands side by side."""

    pitch_m: float
    width_m: float
    yaw_rad: float
    shade: float

    def over(self, xy_m: Floats, albedo: Floats) -> Floats:
        _, across = own(xy_m, 0, 0, self.yaw_rad)
        return np.where(across % self.pitch_m < self.width_m, albedo * self.shade, albedo)


@dataclass(frozen=True)
class Board(Paint):
    """A chessboard of 10 x 7 squares with a white margin."""

    x_m: float
    y_m: float
    yaw_rad: float
    square_m: float

    def over(self, xy_m: Floats, albedo: Floats) -> Floats:
        column, row = (each / self.square_m for each in own(xy_m, self.x_m, self.y_m, self.yaw_rad))
        black = (np.floor(column + 5) + np.floor(row + 3.5)) % 2 == 0
        on_squares = (np.abs(column) < 5) & (np.abs(row) < 3.5)
        on_sheet = (np.abs(column) < 6) & (np.abs(row) < 4.5)
        return np.where(on_sheet, np.where(on_squares & black, 0.06, 0.8), albedo)


@dataclass(frozen=True)
class Marker(Paint):
    """A square marker: six by six cells, black around, white margin."""

    x_m: float
    y_m: float
    yaw_rad: float
    size_m: float
    seed: int

    def over(self, xy_m: Floats, albedo: Floats) -> Floats:
        column, row = (each / self.size_m * 8 + 4 for each in own(xy_m, self.x_m, self.y_m, self.yaw_rad))
        cells = np.zeros((8, 8), bool)
        cells[1:7, 1:7] = np.random.default_rng(self.seed).random((6, 6)) < 0.5
        inside = (column >= 0) & (column < 8) & (row >= 0) & (row < 8)
        sheet = (column >= -1) & (column < 9) & (row >= -1) & (row < 9)
        white = cells[np.clip(row, 0, 7).astype(int), np.clip(column, 0, 7).astype(int)]
        return np.where(sheet, np.where(inside & ~white, 0.06, 0.8), albedo)


@dataclass(frozen=True)
class Text(Paint):
    """Lines of something like letters, everywhere."""

    height_m: float
    yaw_rad: float
    ink: float
    seed: int

    def over(self, xy_m: Floats, albedo: Floats) -> Floats:
        column, row = (each / self.height_m * 4 for each in own(xy_m, 0, 0, self.yaw_rad))
        drawn = np.random.default_rng(self.seed).random((512, 512)) < 0.45
        letters = drawn[np.floor(row).astype(int) % 512, np.floor(column).astype(int) % 512]
        is_line = np.floor(row) % 8 < 5
        return np.where(letters & is_line, albedo * self.ink, albedo)


@dataclass(frozen=True)
class Spot(Paint):
    """Roundish, of another shade; its edge is so soft [m]."""

    x_m: float
    y_m: float
    radius_m: float
    shade: float
    soft_m: float
    seed: int

    def over(self, xy_m: Floats, albedo: Floats) -> Floats:
        x, y = own(xy_m, self.x_m, self.y_m, 0.0)
        turn = np.arctan2(y, x)
        lobes = np.random.default_rng(self.seed).normal(0, 1, (2, 5)) / np.arange(2, 7)
        radius = self.radius_m * (
            1 + 0.2 * sum(a * np.cos(k * turn) + b * np.sin(k * turn) for k, (a, b) in enumerate(lobes.T, start=2))
        )
        share = 1 / (1 + np.exp(np.clip((np.hypot(x, y) - radius) / (self.soft_m / 4), -50, 50)))
        return np.asarray(albedo * (1 + share * (self.shade - 1)))
