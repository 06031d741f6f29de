"""How the properties of the core are tried out: the same examples on every run, however busy the machine."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("core", deadline=None, derandomize=True, max_examples=60)
settings.load_profile("core")
