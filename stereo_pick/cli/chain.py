"""The four nodes as processes: started in the order in which nothing gets lost, stopped cleanly."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType

from stereo_pick.core.errors import SourceError
from stereo_pick.core.params import Value
from stereo_pick.ros.started_by import ending_with_this_process

DOWNSTREAM = ("triangulation", "correspondence", "rectification")
_START = "import sys; from stereo_pick.ros.executables import {node}; sys.exit({node}())"
_STOP_S = 10.0
_AGAIN_S = 1.0  # a signal that comes while Python itself starts can get lost


class Chain:
    """The processes of the nodes; as a context manager it ends them all, whatever happens."""

    def __init__(self, environment: Mapping[str, str] | None = None) -> None:
        self._environment = {**os.environ, **(environment or {}), **ending_with_this_process()}
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._logs = tempfile.TemporaryDirectory(prefix="stereo_pick_")

    def __enter__(self) -> Chain:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        deadline = time.monotonic() + _STOP_S
        while self.runs and time.monotonic() < deadline:
            self._interrupt()
        for process in self._processes.values():
            if process.poll() is None:
                process.kill()
                process.wait()
        self._logs.cleanup()

    def start(self, node: str, values: Mapping[str, Value], remappings: Sequence[str] = ()) -> None:
        """Start the executable of a node with parameter values; it logs into a file that `log` reads."""
        command = [sys.executable, "-c", _START.format(node=node), "--ros-args"]
        for name, value in values.items():
            command += ["-p", f"{name}:={_yaml(value)}"]
        with self._log_file(node).open("wb") as log:
            self._processes[node] = subprocess.Popen(
                [*command, *remappings],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                env=self._environment,
                start_new_session=True,  # Ctrl-C ends this process first, which then ends them in order
            )

    def status(self, node: str) -> int | None:
        """Exit status of a node, None while it runs."""
        return self._processes[node].poll()

    def log(self, node: str) -> str:
        """What a node has printed so far."""
        return self._log_file(node).read_text(encoding="utf-8", errors="replace").strip()

    @property
    def runs(self) -> bool:
        """Whether any node runs yet."""
        return any(process.poll() is None for process in self._processes.values())

    def check(self, but: str = "") -> None:
        """Raise SourceError, with what it printed last, where a node, but one perhaps, ended with an error."""
        for node in self._processes:
            if node != but and self.status(node):
                last = self.log(node).splitlines()[-1:] or ["no message"]
                raise SourceError(last[0].removeprefix("stereo-pick: error: "))

    def _interrupt(self) -> None:
        """Send SIGINT to all that run, and give them a moment to end."""
        running = [process for process in self._processes.values() if process.poll() is None]
        for process in running:
            process.send_signal(signal.SIGINT)
        deadline = time.monotonic() + _AGAIN_S
        for process in running:
            with suppress(subprocess.TimeoutExpired):
                process.wait(max(0.0, deadline - time.monotonic()))

    def _log_file(self, node: str) -> Path:
        return Path(self._logs.name) / f"{node}.log"


def _yaml(value: Value) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return "'" + value.replace("'", "''") + "'" if isinstance(value, str) else repr(value)
