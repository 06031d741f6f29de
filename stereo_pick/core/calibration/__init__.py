"""Calibration: reading and writing it, and making it from views of a board."""
