"""What an object's two outlines say of its shape: sphere, cylinder, box or hexagonal prism; its centre."""

from stereo_pick.core.shapes.common_normal import common_normal
from stereo_pick.core.shapes.fitting import fit_solid, fit_solids
from stereo_pick.core.shapes.outline import Outline
from stereo_pick.core.shapes.solid_angle import centroid_px
from stereo_pick.core.shapes.solid_fit import SolidFit

__all__ = ["Outline", "SolidFit", "centroid_px", "common_normal", "fit_solid", "fit_solids"]
