"""The algorithms: numpy, OpenCV and YAML; no ROS."""

import os

os.environ.setdefault("OPENCV_LOG_LEVEL", "ERROR")  # a damaged image is told of once, by an ImageError
