"""Which point of an object is its position: the centre of its volume, of its top face, or of its visible surface."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.places.extent import Extent
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.surface import entered

CHOICES = ("volume", "top", "surface")


def reference_point_m(fit: SolidFit, extent: Extent, choice: str) -> Floats:
    """The point (3,) [m] in the rectified left frame: `volume`; `top`, where the line upwards from the centre leaves
    the solid; `surface`, where the line to the left camera does."""
    if choice == "volume":
        return fit.centre_m
    if choice == "top":
        return np.asarray(fit.centre_m - extent.rotation[:, 2] * extent.size_m[2] / 2)
    return np.asarray(fit.centre_m * entered(fit, np.zeros(3), fit.centre_m[None])[0])


def moved_px(fit: SolidFit, point_m: Floats, camera: Camera) -> Floats:
    """How far (2,) [px] from the image of the solid's centre that of a point lies, in a rectified camera."""
    projected = camera.P @ np.append(point_m, 1.0)
    return np.asarray(projected[:2] / projected[2] - fit.centre_px(camera))
