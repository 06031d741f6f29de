"""The shared memory by which images go from node to node within a host."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

PROFILE_VARIABLE = "FASTRTPS_DEFAULT_PROFILES_FILE"
PROFILE = Path(__file__).with_name("fastdds_profile.xml")
_SHARED_MEMORY = "/dev/shm"
_SEGMENT_BYTES = 36_000_000  # what Fast DDS takes there for the profile's segment_size


def lack_of_profile() -> str:
    """What to say where the profile that the user chose is no file, which Fast DDS passes over; else nothing."""
    chosen = os.environ.get(PROFILE_VARIABLE, "")
    if not chosen or os.path.isfile(chosen):
        return ""
    return (
        f"{PROFILE_VARIABLE} = {chosen} names no file: Fast DDS goes on without, and large images get lost on their "
        "way; correct it, or unset it: then the package's own profile is used"
    )


def lack_of_shared_memory() -> str:
    """What to say where this process will get no shared memory for its images; nothing where it will."""
    if os.environ.get(PROFILE_VARIABLE) != str(PROFILE) or not os.path.isdir(_SHARED_MEMORY):
        return ""
    free_bytes = shutil.disk_usage(_SHARED_MEMORY).free
    if free_bytes >= _SEGMENT_BYTES:
        return ""
    return (
        f"{_SHARED_MEMORY} has only {free_bytes / 1e6:.0f} MB left, and Fast DDS needs {_SEGMENT_BYTES / 1e6:.0f} for "
        "each process: large images get lost on their way; give a container more (docker run --shm-size=1g), and "
        "remove what killed processes left there (fastdds shm clean)"
    )
