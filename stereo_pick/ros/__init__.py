"""The ROS 2 side: nodes around the core, their topics, messages and parameters."""
