"""How far edges support a solid: how much of its silhouette lies on them, and how exactly."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.locking import Locked
from stereo_pick.core.shapes.evidence import centre_covariance, determined
from stereo_pick.core.shapes.fitting import NOISE_PX
from stereo_pick.core.shapes.refinement import medians
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table

_SUPPORTED = 0.65  # part of the silhouette, in either view, that must lie on edges ...
_PER_PX = 2.0  # ... and more of it where they lie farther off than noise, as a median
_CONTRADICTED = 0.5  # a stretched solid with so much support makes the shorter one doubtful
CHANCE = 1 / 12  # by which the support of two solids that share most of their silhouettes may differ
_RESIDUAL = 2.0  # noise by which the edges may lie off the silhouette, as a median
_UNKNOWN_M2 = np.eye(3)  # covariance of the centre where nothing holds it


@dataclass(frozen=True, eq=False)
class Supported:
    """A solid on edges: fit; support: the lesser share of its silhouette, of both views, that lies on edges as far as
    it is not hidden; off_px: how far these lie off, as a median, by more than noise moves such weak edges; doubt:
    covariance (3, 3) [m²] of its centre as it may be another solid, which no better fit of this one makes less;
    noise_px: by which edges lie off what is there."""

    fit: SolidFit
    support: float
    off_px: float
    believable: bool
    doubt: Floats = field(default_factory=lambda: np.zeros((3, 3)))
    noise_px: float = NOISE_PX

    @property
    def score(self) -> float:
        """What tells the better of two: support, less how far the edges lie off."""
        return self.support - _PER_PX * self.off_px

    @property
    def is_exact(self) -> bool:
        """Whether it is believable without noise as an excuse for how far its edges lie off."""
        return self.believable and carries(self.support, self.fit.residual_px, noise_px=self.noise_px)

    @property
    def raises_doubt(self) -> bool:
        """Whether there is so much to it that a shorter solid is doubtful."""
        return self.believable or (self.support > _CONTRADICTED and _is_tight(self.off_px, self.noise_px))


def supported(locked: Locked, table: Table | None, noise_px: float) -> Iterator[Supported]:
    """Each of these solids on its edges; table: which it is kept on; noise_px: by which edges lie off what is there."""
    fit, solids, size_m = locked.fit, locked.fit.solids, locked.fit.solids.size_m()
    residual, held = np.abs(fit.residual_px), fit.weight > 0
    medians_px = medians(residual, held)
    offs_px = medians(residual / np.hypot(1.0, locked.sigma_px / noise_px), held)
    known = np.flatnonzero(np.isfinite(medians_px))
    covariance = np.tile(_UNKNOWN_M2, (len(held), 1, 1))
    covariance[known] = centre_covariance(fit.only(known), np.maximum(noise_px, 1.5 * medians_px[known]), table)
    fixed = determined(fit, covariance)
    for i, (support, median_px, off_px) in enumerate(
        zip(locked.shown.min(axis=1).tolist(), medians_px.tolist(), offs_px.tolist())
    ):
        result = SolidFit(solids.kind.name, solids.centre_m[i], solids.rotation[i], size_m[i], median_px, covariance[i])
        is_believable = bool(fixed[i]) and carries(support, off_px, noise_px=noise_px)
        yield Supported(result, support, off_px, is_believable, noise_px=noise_px)


def carries(support: float, off_px: float, least: float = _SUPPORTED, noise_px: float = NOISE_PX) -> bool:
    """Whether edges so far off a solid, with so much of its silhouette on them, make it believable."""
    return _is_tight(off_px, noise_px) and support > least + _PER_PX * max(0.0, off_px - noise_px)


def _is_tight(off_px: float, noise_px: float) -> bool:
    return off_px < _RESIDUAL * noise_px
