"""A scene's true table, as the parameter that `stereo-pick table` measures."""

from __future__ import annotations

from rendering import Truth

from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.table import Table


def given_table(rig: StereoRig, truth: Truth) -> str:
    """The setting `feature.table=nx ny nz d`."""
    normal = rig.left.R @ truth.left_T_table.rotation[:, 2]
    offset_m = -float(normal @ rig.left.R @ truth.left_T_table.translation)
    return f"feature.table={Table(normal, offset_m, 0.0).text}"
