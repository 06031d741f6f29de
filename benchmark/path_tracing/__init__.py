"""The same parts in the light of a path tracer (Mitsuba 3): what reflections, inter-reflections and rounded edges do.

The truth is the ray caster's; only the light is traced. Needs `pip install 'mitsuba>=3.9'` and LLVM's library.
"""

from path_tracing.looks import Look, Room, Surface
from path_tracing.scenes import Traced

__all__ = ["Look", "Room", "Surface", "Traced"]
