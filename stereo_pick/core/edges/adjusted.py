"""A solid where all edges together put it, and how far they bear it out."""

from __future__ import annotations

from dataclasses import dataclass

from stereo_pick.core.shapes.kinds import CYLINDER
from stereo_pick.core.shapes.solid_fit import SolidFit

ASTRAY_PX = 0.3  # from its edges
MOST_CREASES = 2 / 3  # of its creases
MOST_SHOWN = 3 / 4  # of its silhouette, for what shows no creases


@dataclass(frozen=True, eq=False)
class Adjusted:
    """fit: the solid; shown, creased: the part of its silhouette that lies on edges, the least of both views, and of
    its creases (1 where there are none), as of `share_seen`; has_creases: whether there are any, clear of it; denied:
    the part of the silhouette, the most of both views, that has edges clearly beside it."""

    fit: SolidFit
    shown: float
    creased: float
    has_creases: bool
    denied: float

    @property
    def is_astray(self) -> bool:
        """Whether it is not what the edges show."""
        return is_astray(self.fit)

    @property
    def is_creased(self) -> bool:
        """Whether most of its creases show, so that it is hardly anything else."""
        return self.creased >= MOST_CREASES

    @property
    def shows_creases(self) -> bool:
        """Whether it has some, and most of them show."""
        return self.has_creases and self.is_creased

    @property
    def may_be_another(self) -> bool:
        """Whether it is a cylinder whose ends are not seen, so that its silhouette is all that speaks, without much of
        that."""
        return self.fit.kind == CYLINDER.name and not self.has_creases and self.shown < MOST_SHOWN

    @property
    def is_clear(self) -> bool:
        """Whether it is hardly anything else, and is there."""
        return self.is_creased and not self.is_astray

    @property
    def is_seen(self) -> bool:
        """Whether it shows enough of itself: what lacks its creases, like a tube black to its rim, shows all around."""
        return self.is_creased or self.shown > MOST_SHOWN


def is_astray(fit: SolidFit) -> bool:
    """Whether a solid lies so far off the edges that they do not show it, or not so finely."""
    return fit.residual_px > ASTRAY_PX
