"""The surfaces of a view in which the table ends: it, and what lies beyond, if only one could say which is which."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Image
from stereo_pick.core.objects.background import Window, fit_background
from stereo_pick.core.objects.foreground import Contrast, contrast_with

_MUCH = 0.05  # of a view
_SMOOTH = 0.5  # of the grey levels between two surfaces, by which each may vary at most
_STRIDE_PX = 4
_RIM = np.ones((7, 7), np.uint8)  # pixels of the reduced view that see both surfaces


def surfaces(contrast: Contrast, threshold_sigma: float) -> list[Contrast]:
    """The view beside its background and, where another surface covers much of it up to its border, beside that."""
    piece = _another(contrast)
    if piece is None:
        return [contrast]
    other = contrast_with(fit_background(contrast.view.smooth, piece), contrast.view, threshold_sigma)
    apart = float(np.median(np.abs(_excess(contrast)[piece])))
    return [contrast, other] if other.bright_threshold < _SMOOTH * apart else [contrast]


def without_others(table: Contrast, every: Sequence[Contrast]) -> Contrast:
    """The view beside the table, without the other surfaces: what stands before one of them is an object still."""
    others = [_covered(each, table) for each in every if each is not table]
    return replace(table, beyond=others[0]) if others else table


def _another(contrast: Contrast) -> Bools | None:
    """The pixels (h, w) of the largest piece that stands out, if it is large and reaches the border."""
    view, some = contrast.view, np.s_[::_STRIDE_PX, ::_STRIDE_PX]
    least = _MUCH * np.count_nonzero(view.inside[some])
    for polarity in ("bright", "dark"):
        if np.count_nonzero(_largest(_stands_out(contrast, polarity, some))) < least:  # as most often
            continue
        piece = _largest(_stands_out(contrast, polarity, np.s_[:, :]))
        if np.count_nonzero(piece[some]) >= least and (piece & ~view.core).any():
            return piece
    return None


def _stands_out(contrast: Contrast, polarity: str, window: Window) -> Bools:
    excess = contrast.excess(polarity, window)
    return np.asarray((excess > contrast.threshold(polarity)) & contrast.view.inside[window])


def _covered(other: Contrast, table: Contrast) -> Image:
    """Where (h, w) a view shows another surface in one piece, and the rim where it runs over into the table: 1."""
    off, off_table = _excess(other), _excess(table)
    limit = max(other.bright_threshold, table.bright_threshold)
    between = (np.minimum(off, off_table) <= limit) & (np.maximum(off, off_table) >= -limit)
    piece = _largest((np.abs(off) <= other.bright_threshold) & other.view.inside)
    return np.where(between, np.asarray(cv2.dilate(piece.astype(np.uint8), _RIM), np.uint8), np.uint8(0))


def _excess(contrast: Contrast) -> NDArray[np.float32]:
    return contrast.excess("bright", np.s_[:, :])


def _largest(mask: Bools) -> Bools:
    _, label, about, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
    return np.asarray(label == 1 + int(about[1:, cv2.CC_STAT_AREA].argmax())) if len(about) > 1 else mask
