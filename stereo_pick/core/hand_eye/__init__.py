"""Hand-eye calibration: where the camera stands in the robot's frame, or on its flange."""
