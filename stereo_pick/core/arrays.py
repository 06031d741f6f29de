"""Arrays that are checked at birth and cannot be changed afterwards."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stereo_pick.core.errors import ArrayError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Image = NDArray[np.uint8]


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """Return `array`, made read-only."""
    array.setflags(write=False)
    return array


def floats(name: str, value: ArrayLike, *shape: int | None) -> Floats:
    """Copy `value` into a read-only float64 array of `shape`; None stands for any length.

    Raises ArrayError, naming the array, on another shape or on values that are not finite.
    """
    array: Floats = np.array(value, dtype=np.float64)
    if len(array.shape) != len(shape) or any(want not in (None, have) for have, want in zip(array.shape, shape)):
        wanted = tuple("any" if n is None else n for n in shape)
        raise ArrayError(f"{name} has shape {array.shape}, must have {wanted}")
    if not np.isfinite(array).all():
        bad = np.argwhere(~np.isfinite(array))[0].tolist()
        raise ArrayError(f"{name} holds {array[tuple(bad)]} at index {bad}: every value must be finite")
    frozen(array)
    return array


def image(name: str, value: NDArray[Any]) -> Image:
    """Return a read-only view of an 8-bit image of shape (H, W) or (H, W, 3).

    Raises ArrayError, naming the image, on another shape or type.
    """
    if value.dtype != np.uint8 or value.ndim not in (2, 3) or (value.ndim == 3 and value.shape[2] != 3):
        raise ArrayError(f"{name} is {value.dtype} of shape {value.shape}, must be uint8 (H, W) or (H, W, 3)")
    if value.size == 0:
        raise ArrayError(f"{name} is empty: shape {value.shape}")
    view = value.view()
    frozen(view)
    return view
