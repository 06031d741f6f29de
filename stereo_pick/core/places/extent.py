"""An object as a solid: what it is, how large, and how it lies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.errors import ArrayError
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.kinds import BOX, CYLINDER, HEX_PRISM, SPHERE

KINDS = ("", SPHERE.name, CYLINDER.name, BOX.name, HEX_PRISM.name)
"""What an object can be; the first: none of these, or not known."""

_STANDS = 0.7  # cosine


@dataclass(frozen=True, eq=False)
class Extent:
    """kind: one of KINDS but the first; rotation: (3, 3), its columns are the directions of the object's length, of
    its width, and down into the table, in the rectified left frame; size_m: (3,), length, width and height.

    A ball's or a standing cylinder's length has no direction of its own: it is that of the view's rows.
    """

    kind: str
    rotation: Floats
    size_m: Floats

    def __post_init__(self) -> None:
        if self.kind not in KINDS[1:]:
            raise ArrayError(f"kind is {self.kind!r}, must be one of {', '.join(KINDS[1:])}")
        object.__setattr__(self, "rotation", floats("rotation", self.rotation, 3, 3))
        object.__setattr__(self, "size_m", floats("size_m", self.size_m, 3))


def extent_of(fit: SolidFit, normal: Floats | None) -> Extent:
    """How a solid lies on a table with this normal (3,), towards the cameras, rectified left frame.

    Without one, the solid is taken to stand on the face that is turned away from the cameras.
    """
    axes, sizes = fit.rotation.T, fit.size_m
    up = -fit.centre_m / np.linalg.norm(fit.centre_m) if normal is None else normal
    if fit.kind == SPHERE.name:
        return Extent(fit.kind, _frame(np.array([1.0, 0.0, 0.0]), up), sizes)
    if fit.kind == BOX.name:
        height = int(np.abs(axes @ up).argmax())
        length, width = sorted((i for i in range(3) if i != height), key=lambda i: -sizes[i])
        down = -axes[height] * np.sign(axes[height] @ up)
        return Extent(fit.kind, _frame(_rightwards(axes[length]), -down), sizes[[length, width, height]])
    if abs(float(axes[2] @ up)) > _STANDS:
        length_axis = axes[0] if fit.kind == HEX_PRISM.name else np.array([1.0, 0.0, 0.0])
        return Extent(fit.kind, _frame(_rightwards(length_axis), axes[2] * np.sign(axes[2] @ up)), sizes)
    return Extent(fit.kind, _frame(_rightwards(axes[2]), up), sizes[[2, 0, 1]])


def _rightwards(axis: Floats) -> Floats:
    return axis if axis[0] >= 0 else -axis


def _frame(length: Floats, up: Floats) -> Floats:
    """The rotation whose third column is down and whose first is as near to the length as that allows."""
    down = -up / np.linalg.norm(up)
    x = length - (length @ down) * down
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(down, x), down], axis=1)
