"""The same work on many scenes, in one process or several; the results in order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TypeVar

import cv2

Job, Result = TypeVar("Job"), TypeVar("Result")


def each(jobs: Sequence[Job], work: Callable[[Job], Result], processes: int) -> list[Result]:
    """What `work`, which must be picklable, makes of every job; OpenCV gets one thread a process."""
    if processes == 1:
        cv2.setNumThreads(1)
        return [work(job) for job in jobs]
    with ProcessPoolExecutor(processes, get_context("spawn"), cv2.setNumThreads, (1,)) as pool:
        return list(pool.map(work, jobs, chunksize=4))
