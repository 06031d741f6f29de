"""Solids and the edges that the images show: found by them, brought onto them, borne out or contradicted by them."""
