"""Errors that a user can act on: what is wrong, with which value, and what to do."""

from __future__ import annotations


class StereoPickError(Exception):
    """Base of all errors whose message is meant for the user, shown without a traceback."""


class ArrayError(StereoPickError, ValueError):
    """An array of the wrong shape, or one that holds NaN or infinity."""


class CalibrationError(StereoPickError):
    """A calibration that cannot be read, or that no real rig can have."""


class ImageError(StereoPickError):
    """An image that cannot be read, or that does not fit the calibration."""


class ParameterError(StereoPickError, ValueError):
    """A parameter that does not exist, or a value outside its range."""


class SourceError(StereoPickError):
    """A bag or a folder that holds no usable stereo pairs."""
