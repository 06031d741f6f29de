"""How many distortion coefficients are estimated."""

from __future__ import annotations

import math
from collections.abc import Callable

from stereo_pick.core.calibration.parameters import RICH, DistortionModel
from stereo_pick.core.calibration.refinement import StereoSolution

Fit = Callable[[DistortionModel], StereoSolution]


def supported(usual: StereoSolution, fit: Fit) -> StereoSolution:
    """The solution with k3 where the views show it beyond doubt, else the usual one: k1 k2 p1 p2 are never left out.

    usual: the fit of the USUAL model. To leave a coefficient out is to claim that it is zero. Estimates without and
    with it scatter about each other by just the variance that the claim saves (Hausman 1978): whatever sigma it saves
    is what the views could not see, and no test on them can vouch for it. p1 p2 resemble a shift of the image centre
    and a turn of the camera; left out they can halve the stated sigma of a point, and move it by several of those,
    without being significant. k3 resembles k1 and k2 taken together: where boards were shown it changes the sigma of
    points by a few percent only, while k1 and k2 themselves become several times less sure. So it is left out unless
    it, for both cameras together, explains more than Schwarz (1978) asks for: ln of the number of residuals for each
    coefficient.
    """
    beyond_doubt = math.log(usual.coordinates_px.size)
    rich = fit(RICH)
    return rich if rich.criterion(beyond_doubt) < usual.criterion(beyond_doubt) else usual
