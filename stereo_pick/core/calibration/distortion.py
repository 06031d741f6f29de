"""How many distortion coefficients the views support."""

from __future__ import annotations

import math
from collections.abc import Callable

from stereo_pick.core.calibration.parameters import USUAL, DistortionModel
from stereo_pick.core.calibration.refinement import StereoSolution

_MODELS = tuple(DistortionModel)

_SIGNIFICANT = 4.0

Fit = Callable[[DistortionModel], StereoSolution]


def supported(usual: StereoSolution, fit: Fit) -> StereoSolution:
    """The solution of the model that the views support, both cameras' corners taken together.

    usual: the fit of the USUAL model. A richer one must explain its coefficients beyond doubt (Schwarz 1978: each is
    worth ln of the number of residuals), a plainer one takes over where they are not significant (each worth 4: two
    standard deviations). A coefficient too many widens the stated uncertainties; one too few makes them untrue.
    """
    beyond_doubt = math.log(usual.coordinates_px.size)
    richer = _descend(usual, _MODELS[_MODELS.index(USUAL) + 1 :], fit, beyond_doubt)
    return richer if richer is not usual else _descend(usual, _MODELS[: _MODELS.index(USUAL)][::-1], fit, _SIGNIFICANT)


def _descend(best: StereoSolution, models: tuple[DistortionModel, ...], fit: Fit, price: float) -> StereoSolution:
    for model in models:
        solution = fit(model)
        if solution.criterion(price) >= best.criterion(price):
            break
        best = solution
    return best
