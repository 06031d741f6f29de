"""Where stereo pairs come from: one file a source; no ROS."""
