"""The centre of what an object covers of the view, as directions and not as pixels.

Perspective stretches an image towards its borders, and a centre of area with it. The cone of rays to an object knows no
image: its centre is where the object would appear if the camera looked straight at it. For a sphere it points exactly
at the centre.
"""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.shapes.kinds import cross, dot


def centroid_px(contour_px: Floats, camera: Camera) -> Floats:
    """Image point (2,) [px] of the solid angle's centroid of a closed contour (N, 2) [px] in a rectified view.

    The centroid's direction is the sum of the unit normals of the cone's faces, each times its angle: the vector
    area of the spherical polygon, in either sense of rotation.
    """
    focal, middle = camera.P[[0, 1], [0, 1]], camera.P[:2, 2]
    rays = np.ones((len(contour_px), 3))
    rays[:, :2] = (contour_px - middle) / focal
    rays /= np.sqrt(dot(rays, rays))[:, None]
    faces = cross(rays, rays[np.arange(1 - len(rays), 1)])
    sine = np.sqrt(dot(faces, faces))
    angle_to_sine = np.where(sine > 1e-6, np.arcsin(np.minimum(sine, 1.0)) / np.maximum(sine, 1e-6), 1.0)
    direction = angle_to_sine @ faces
    return np.asarray(direction[:2] / direction[2] * focal + middle)
