"""Planes with grain on them, seen by two cameras."""

from __future__ import annotations

import cv2
import numpy as np
from rigs import rotation

from stereo_pick.core.arrays import Floats
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blobs
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.table import Table

NO_OBJECTS = Blobs((), (), "bright")


def plane(tilt_deg: float, turn_deg: float, distance_m: float = 0.9) -> Table:
    facing = np.array([0.0, 0.0, -1.0])
    normal = rotation((0, 0, np.deg2rad(turn_deg))) @ rotation((np.deg2rad(tilt_deg), 0, 0)) @ facing
    return Table(normal, -float(normal[2]) * distance_m, 0.0)


def seen(rig: StereoRig, table: Table, contrast: float, seed: int = 0) -> RectifiedPair:
    """Grain on a plane: the right view shows at each pixel what the left one does where the plane puts it."""
    random = np.random.default_rng(seed)
    width, height = rig.left.frame_size
    noise = [cv2.GaussianBlur(random.normal(size=(height, width)), (0, 0), sigma) for sigma in (1.5, 4.0, 12.0)]
    grain = 110 + contrast * np.sum([each / each.std() for each in noise], axis=0)
    columns, rows = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    at = columns_in_left(rig, table, columns, rows)
    right = cv2.remap(grain.astype(np.float32), at.astype(np.float32), rows.astype(np.float32), cv2.INTER_CUBIC)
    views = (np.clip(np.round(each + random.normal(size=each.shape)), 0, 255) for each in (grain, right))
    left, right = (each.astype(np.uint8) for each in views)
    return RectifiedPair(left, right, rig, 0)


def columns_in_left(rig: StereoRig, table: Table, columns: Floats, rows: Floats) -> Floats:
    P = rig.right.P
    rays = np.stack([(columns - P[0, 2]) / P[0, 0], (rows - P[1, 2]) / P[1, 1], np.ones(columns.shape)], axis=-1)
    eye = rig.eyes_m[1]
    points = eye - rays * (float(table.height_m(eye)) / (rays @ table.normal))[..., None]
    return np.asarray(rig.left.P[0, 0] * points[..., 0] / points[..., 2] + rig.left.P[0, 2])
