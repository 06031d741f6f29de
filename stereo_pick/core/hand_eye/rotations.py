"""Rotations as vectors, quaternions and cross-product matrices."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import ArrayLike

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.errors import ArrayError
from stereo_pick.core.transform import Transform


def rotation_vector(rotation: Floats) -> Floats:
    """Axis times angle (..., 3) [rad] of rotation matrices (..., 3, 3); `cv2.Rodrigues` gives 0 below 1e-5 rad."""
    quaternion = to_quaternion(rotation)
    axis, cosine = quaternion[..., :3], quaternion[..., 3:]
    sine = np.linalg.norm(axis, axis=-1, keepdims=True)
    return np.asarray(axis * np.divide(2 * np.arctan2(sine, cosine), sine, out=np.full_like(sine, 2.0), where=sine > 0))


def rotation_matrix(vector: Floats) -> Floats:
    """The rotation matrix (3, 3) of axis times angle [rad]."""
    return np.asarray(cv2.Rodrigues(np.array(vector, np.float64))[0], np.float64)


def angle_rad(rotation: Floats) -> float:
    """By how much [rad] a rotation matrix turns."""
    return float(np.linalg.norm(rotation_vector(rotation)))


def cross_matrix(v: Floats) -> Floats:
    """`[v]x` (3, 3): `cross_matrix(v) @ w` is the cross product of v and w."""
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], np.float64)


def nearest_rotation(matrix: Floats) -> Floats:
    """The rotation matrix (3, 3) nearest to a matrix."""
    U, _, Vt = np.linalg.svd(matrix)
    return np.asarray(U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt)


def from_quaternion(xyz_m: ArrayLike, quaternion_xyzw: ArrayLike) -> Transform:
    """The transform of a position (3,) [m] and a quaternion x y z w, as geometry_msgs/Pose has them.

    Raises ArrayError where the quaternion's length is not 1 within a hundredth.
    """
    q = floats("quaternion_xyzw", quaternion_xyzw, 4)
    length = float(np.linalg.norm(q))
    if abs(length - 1) > 0.01:
        raise ArrayError(f"quaternion_xyzw {q.tolist()} has length {length:.3f}, must be 1: x y z w, w last")
    x, y, z, w = q / length
    v = np.array([x, y, z])
    rotation = (w * w - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * w * cross_matrix(v)
    return Transform(rotation, floats("xyz_m", xyz_m, 3))


def to_quaternion(rotation: Floats) -> Floats:
    """The quaternions x y z w (..., 4) of rotation matrices (..., 3, 3), w not negative: Bar-Itzhack's eigenvectors
    (2000)."""
    R, turned_back = rotation, np.swapaxes(rotation, -1, -2)
    trace = np.trace(R, axis1=-2, axis2=-1)
    K = np.empty((*trace.shape, 4, 4))
    K[..., :3, :3] = R + turned_back - trace[..., None, None] * np.eye(3)
    K[..., 3, :3] = K[..., :3, 3] = (R - turned_back)[..., [2, 0, 1], [1, 2, 0]]
    K[..., 3, 3] = trace
    q = np.linalg.eigh(K)[1][..., 3]
    return np.asarray(np.where(q[..., 3:] < 0, -q, q))
