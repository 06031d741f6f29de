"""The algorithms: numpy, OpenCV and YAML; no ROS."""
