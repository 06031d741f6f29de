"""Where a part ends that stands in a narrow shadow: a line about its foot, darker than both the part and the table.

From the table inwards such a line begins at an edge as clear as a part's own, and clearer than the foot itself.
"""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.objects.edge_model import vertex
from stereo_pick.core.sampling import places_along, sampled

_STEP_PX = 0.5
_WIDEST_PX = 3.0  # a wider shadow is seen as what it is
_BEHIND_PX = 3.0  # of what lies behind the darkest place
_CLEAR = 5.0  # noise by which the part must be lighter than its shadow ...
_OF_STEP = 0.2  # ... and as a part of the step from the table into it

_DARKEST = int(_WIDEST_PX / _STEP_PX) + 1
_BEHIND = np.arange(int(_BEHIND_PX / _STEP_PX) + 1)
_INWARDS_PX = np.arange(_DARKEST + len(_BEHIND) - 1) * _STEP_PX


def shadow_px(image: Image, edges_px: Floats, inwards: Floats, step: Floats, noise: float) -> Floats:
    """How wide (N,) [px] the shadow behind each edge (N, 2) [px] is, across which it gets darker by step (N,); 0 where
    what lies behind is as dark as the rest of the part.

    inwards: (N, 2), unit vectors; noise: one sigma of the view's slopes [grey levels/px].
    """
    if not len(edges_px):
        return np.zeros(0)
    levels = sampled(image, places_along(edges_px, inwards, _INWARDS_PX))
    row = np.arange(len(levels))
    darkest = levels[:, :_DARKEST].argmin(axis=1)
    behind = levels[row[:, None], darkest[:, None] + _BEHIND]
    one, two, three = behind[:, -3:].T
    median = np.maximum(np.minimum(one, two), np.minimum(np.maximum(one, two), three))
    lighter = median - behind[:, 0]
    slope = behind[:, 1:] - behind[:, :-1]
    steepest = np.minimum(np.maximum(slope.argmax(axis=1), 1), slope.shape[1] - 2)
    part = np.minimum(np.maximum(vertex(*(-slope[row, steepest + k] for k in (-1, 0, 1))), -0.5), 0.5)
    width_px = (darkest + steepest + 0.5 + part) * _STEP_PX
    return np.where(lighter > np.maximum(_CLEAR * noise, _OF_STEP * step), width_px, 0.0)
