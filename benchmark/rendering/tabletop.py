"""What is painted on the table: planks, prints, its edge; flat, so that it stands nowhere above the table."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats


class Paint(ABC):
    """Something flat on the table."""

    @abstractmethod
    def over(self, xy_m: Floats, albedo: Floats) -> Floats:
        """The albedo (N,) of the table at points (N, 2) of its frame, after this paint, from that before it."""


@dataclass(frozen=True)
class Planks(Paint):
    """Boards with dark joints, each of its own shade, grained along."""

    width_m: float = 0.09
    joint_m: float = 0.002
    direction_rad: float = 0.0
    contrast: float = 0.08
    seed: int = 0

    def over(self, xy_m: Floats, albedo: Floats) -> Floats:
        c, s = np.cos(self.direction_rad), np.sin(self.direction_rad)
        along, across = xy_m @ (c, s), xy_m @ (-s, c)
        board = np.floor(across / self.width_m)
        shade = np.random.default_rng(self.seed).uniform(-1, 1, 64)[board.astype(int) % 64]
        grain = np.sin(across * 900 + 3 * np.sin(along * 12 + shade * 40)) * np.sin(
            across * 310 + along * 9 + shade * 70
        )
        joint = np.abs(across - board * self.width_m - self.width_m / 2) > (self.width_m - self.joint_m) / 2
        return np.asarray(albedo * (1 + self.contrast * (shade + 0.4 * grain)) * np.where(joint, 0.45, 1.0))


@dataclass(frozen=True)
class Carton(Paint):
    """A printed rectangle: a frame and bars of text-like lines."""

    x_m: float
    y_m: float
    length_m: float
    width_m: float
    yaw_rad: float
    albedo: float
    ink: float = 0.5

    def over(self, xy_m: Floats, albedo: Floats) -> Floats:
        along, across = own(xy_m, self.x_m, self.y_m, self.yaw_rad)
        margin = np.minimum(self.length_m / 2 - np.abs(along), self.width_m / 2 - np.abs(across))
        line = (np.sin(across * 700) > 0.3) & (np.sin(along * 160 + np.floor(across * 111) * 5) > -0.4)
        printed = ((margin > 0.008) & line) | ((margin > 0.003) & (margin < 0.005))
        return np.where(margin > 0, self.albedo * np.where(printed, self.ink, 1.0), albedo)


@dataclass(frozen=True)
class Label(Paint):
    """A rectangle, or an ellipse, of one grey."""

    x_m: float
    y_m: float
    length_m: float
    width_m: float
    yaw_rad: float
    albedo: float
    is_round: bool = False

    def over(self, xy_m: Floats, albedo: Floats) -> Floats:
        along, across = own(xy_m, self.x_m, self.y_m, self.yaw_rad)
        from_middle = np.abs(along) * 2 / self.length_m, np.abs(across) * 2 / self.width_m
        reach = np.hypot(*from_middle) if self.is_round else np.maximum(*from_middle)
        return np.where(reach < 1, self.albedo, albedo)


@dataclass(frozen=True)
class Edge(Paint):
    """The table ends `distance_m` from its origin in a direction; what lies beyond shows another grey."""

    distance_m: float
    direction_rad: float
    beyond: float

    def over(self, xy_m: Floats, albedo: Floats) -> Floats:
        outside = xy_m @ (np.cos(self.direction_rad), np.sin(self.direction_rad)) > self.distance_m
        return np.where(outside, self.beyond, albedo)


def own(xy_m: Floats, x_m: float, y_m: float, yaw_rad: float) -> tuple[Floats, Floats]:
    """Points (N, 2) along and across a sheet that lies at (x, y), turned so far."""
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    moved = xy_m - (x_m, y_m)
    return moved @ (c, s), moved @ (-s, c)


def surface_texture(points_m: Floats) -> Floats:
    """A paint that belongs to the surface, -1 to 1: waves of 5 to 12 mm through space."""
    waves = np.random.default_rng(7)
    directions = waves.normal(size=(12, 3))
    directions *= (2 * np.pi / waves.uniform(0.005, 0.012, 12) / np.linalg.norm(directions, axis=1))[:, None]
    return np.asarray(np.tanh(np.cos(points_m @ directions.T + waves.uniform(0, 6.3, 12)).sum(axis=1) / 2.5))
