"""How light becomes grey levels."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, Image


@dataclass(frozen=True)
class Sensor:
    """Lens blur, unevenness, gain, noise, 8 bit.

    gradient: relative change of the light over the image's width and height; vignetting: loss in the corners;
    noise_dn: of a dark pixel; photon_dn: that of a white one's photons.
    """

    gain: float = 1.0
    offset_dn: float = 0.0
    blur_px: float = 0.7
    noise_dn: float = 1.0
    photon_dn: float = 0.0
    vignetting: float = 0.0
    gradient: tuple[float, float] = (0.0, 0.0)

    def expose(self, light: Floats, random: np.random.Generator) -> Image:
        """The image (H, W) of the light (H, W) that falls on each pixel, 1 being white."""
        if self.blur_px:
            light = cv2.GaussianBlur(light, (0, 0), self.blur_px)
        if self.vignetting or any(self.gradient):
            light = light * self._evenness(*light.shape)
        grey = 255 * self.gain * light
        noise = random.standard_normal(light.shape)
        if self.photon_dn:
            noise *= np.sqrt(self.noise_dn**2 + self.photon_dn**2 * np.clip(grey, 0, None) / 255)
        else:
            noise *= self.noise_dn
        return np.clip(np.round(grey + self.offset_dn + noise), 0, 255).astype(np.uint8)

    def _evenness(self, height: int, width: int) -> Floats:
        y, x = np.ogrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
        return np.asarray(
            (1 - self.vignetting * (x**2 + y**2) / 2) * (1 + (self.gradient[0] * x + self.gradient[1] * y) / 2)
        )


CLEAN = Sensor()
