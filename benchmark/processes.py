"""The same work on many scenes, in one process or several: what programs of that kind ask for, and the results."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import TypeVar

import cv2
from families import FAMILIES

Job, Result = TypeVar("Job"), TypeVar("Result")


def scene_parser(
    text: str | None, default: Sequence[str], families: Iterable[str] = FAMILIES, seeds: int = 30
) -> argparse.ArgumentParser:
    """The options of a program, of that docstring, that looks at scenes of families and writes a page."""
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--family", nargs="+", choices=list(families), default=default)
    parser.add_argument("--seeds", type=int, default=seeds, help=f"scenes a family (default {seeds})")
    parser.add_argument("--cache", type=Path, help="folder that keeps the rendered scenes")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--write", type=Path, help="page whose generated part is replaced")
    return parser


def each(jobs: Sequence[Job], work: Callable[[Job], Result], processes: int) -> list[Result]:
    """What `work`, which must be picklable, makes of every job; OpenCV gets one thread a process."""
    if processes == 1:
        cv2.setNumThreads(1)
        return [work(job) for job in jobs]
    with ProcessPoolExecutor(processes, get_context("spawn"), cv2.setNumThreads, (1,)) as pool:
        return list(pool.map(work, jobs, chunksize=4))
