"""Whether it shows how high a solid is: what lies along the rows of the views does so at its ends alone.

Elsewhere it looks the same to both cameras on the table and above it, as a printed line does.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.locking import ON_EDGE_PX, Limbs, edges_beside
from stereo_pick.core.shapes.occluders import share_seen
from stereo_pick.core.shapes.predicted import silhouettes
from stereo_pick.core.shapes.solid_fit import SolidFit

_POINTS = 120  # of a silhouette
_ACROSS = np.cos(np.deg2rad(45))  # of an edge's normal to the rows
_LEAST = 1 / 4  # of its edges across the rows: half of them show of what is lit from one side


def shows_height(fit: SolidFit, images: Images) -> bool:
    """Whether a solid's edges across the rows show in both views, as far as nothing hides them."""
    solid, known = fit.solid, images.occluders
    hide = partial(known.hide, solid) if known else None
    beside = edges_beside(
        silhouettes(solid, images.eyes_m), Limbs.of(solid, images.rig), images.maps, _POINTS, hide=hide
    )
    across = np.abs(beside.normals[..., 0]) > _ACROSS
    return bool(share_seen((beside.off_px < ON_EDGE_PX) & across, beside.hidden, across).min() >= _LEAST)
