"""Stereo guidance for robotic picking: two calibrated cameras in, object poses out."""

__version__ = "0.1.0"
