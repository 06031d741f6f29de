"""Doubts: what the images show beside, before and inside of a solid that was found, and so whether it is one."""
