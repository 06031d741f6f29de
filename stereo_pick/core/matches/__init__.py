"""Matches: which object of the left view is which one of the right view."""
