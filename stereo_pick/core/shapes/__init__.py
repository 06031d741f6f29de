"""What an object's two outlines say of its shape: a sphere, a cylinder or a box, and where its centre really is."""

from stereo_pick.core.shapes.common_normal import common_normal
from stereo_pick.core.shapes.fitting import fit_solid, fit_solids
from stereo_pick.core.shapes.outline import Outline
from stereo_pick.core.shapes.solid_angle import centroid_px
from stereo_pick.core.shapes.solid_fit import SolidFit

__all__ = ["Outline", "SolidFit", "centroid_px", "common_normal", "fit_solid", "fit_solids"]
