"""Real nodes and commands in tests: a ROS domain for each, conditions with deadlines instead of sleeps."""

from __future__ import annotations

import fcntl
import itertools
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import rclpy
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.publisher import Publisher
from rclpy.signals import SignalHandlerOptions

from stereo_pick.cli.main import main
from stereo_pick.ros.process import prepare_process
from stereo_pick.ros.topics import DIAGNOSTICS, Topic

ROOT = Path(__file__).resolve().parents[1]
DEADLINE_S = 60.0
NODES = ("capture", "rectification", "correspondence", "triangulation")
DOWNSTREAM = NODES[1:]

_turn = itertools.count()


@contextmanager
def reserved_domain() -> Iterator[int]:
    """A ROS domain id of 1 to 90: disjoint between the workers of a run, and locked against other runs."""
    worker = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
    workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    own = range(1 + worker % 90, 91, workers)
    for _ in own:
        domain = own[next(_turn) % len(own)]
        path = Path(tempfile.gettempdir()) / f"stereo_pick_test_{os.getuid()}_domain_{domain}.lock"
        with path.open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield domain
            return
    raise RuntimeError("every ROS domain is in use by another test run")


def environment(domain: int, **more: str) -> dict[str, str]:
    """What a child process needs to be in this ROS domain and in no other host's."""
    return {**os.environ, "ROS_DOMAIN_ID": str(domain), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", **more}


def slowness() -> float:
    """How many times slower than on an idle machine a process runs just now; limits on time are stretched by it."""
    start, busy = time.monotonic(), time.process_time()
    while time.process_time() - busy < 0.2:
        pass
    return max(1.0, (time.monotonic() - start) / 0.2)


def is_prompt(seconds: float) -> bool:
    """Whether something took less than 2 s, as it would on an idle machine; how busy this one is costs time to find."""
    return seconds < 2 or seconds < 2 * slowness()


class Graph:
    """The test's own place in a ROS domain: a node that listens, publishes, asks and waits.

    ros_args: parameters for the package's nodes that are made in this process, in `context`.
    """

    def __init__(self, domain: int, ros_args: Sequence[str] = ()) -> None:
        os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        prepare_process()
        self.context = Context()
        args = ["--ros-args", *ros_args] if ros_args else []
        rclpy.init(args=args, context=self.context, domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
        self.node = rclpy.create_node("test", context=self.context, use_global_arguments=False)
        self._executor = SingleThreadedExecutor(context=self.context)
        self._nodes: list[Any] = []
        self.host(self.node)
        self.diagnostics = self.listen(DIAGNOSTICS)

    def host(self, node: Any) -> Any:
        """Spin a node together with the test's own."""
        self._nodes.append(node)
        self._executor.add_node(node)
        return node

    def listen(self, topic: Topic) -> list[Any]:
        """The messages of a topic, as they come."""
        received: list[Any] = []
        self.node.create_subscription(topic.type, topic.name, received.append, topic.qos)
        return received

    def publisher(self, topic: Topic) -> Publisher:
        return self.node.create_publisher(topic.type, topic.name, topic.qos)

    def wait(self, condition: Callable[[], Any], what: str, seconds: float = DEADLINE_S) -> Any:
        """Spin until the condition holds, and return what it gave; fails with `what` at the deadline."""
        deadline = time.monotonic() + seconds
        while not (value := condition()):
            if time.monotonic() > deadline:
                raise AssertionError(f"not within {seconds:g} s: {what}; diagnostics: {self.statuses()}")
            self._executor.spin_once(timeout_sec=0.05)
        return value

    def spin(self, seconds: float, until: Callable[[], Any] = lambda: False) -> None:
        """Handle what comes within this time, or until something holds: for showing that something does not come."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and not until():
            self._executor.spin_once(timeout_sec=0.02)

    def statuses(self) -> dict[str, tuple[bytes, str]]:
        """Level and message of each node's last diagnostic."""
        return {
            status.name.removeprefix("stereo_pick: "): (status.level, status.message)
            for array in self.diagnostics
            for status in array.status
        }

    def wait_for_status(self, node: str, level: bytes, *parts: str) -> str:
        """Wait until a node's diagnostic has this level and all parts in its one line, and return the line."""

        def found() -> str:
            for array in self.diagnostics:
                for status in array.status:
                    told = status.name == f"stereo_pick: {node}" and status.level == level
                    if told and all(part in status.message for part in parts):
                        assert "\n" not in status.message
                        return str(status.message)
            return ""

        return str(self.wait(found, f"{node} tells {parts} at level {level!r}"))

    def forget_statuses(self) -> None:
        self.diagnostics.clear()

    def set_parameter(self, node: str, name: str, value: Any) -> SetParametersResult:
        """Set one parameter of a node by its service, as `ros2 param set` does."""
        message: ParameterMessage = Parameter(name, value=value).to_parameter_msg()
        request = SetParameters.Request(parameters=[message])
        return self.ask(SetParameters, f"{node}/set_parameters", request).results[0]

    def get_parameter(self, node: str, name: str) -> Any:
        """Ask for one parameter of a node by its service, as `ros2 param get` does."""
        request = GetParameters.Request(names=[name])
        return parameter_value_to_python(self.ask(GetParameters, f"{node}/get_parameters", request).values[0])

    def ask(self, kind: Any, name: str, request: Any) -> Any:
        client = self.node.create_client(kind, name)
        self.wait(client.service_is_ready, f"service {name}")
        future = client.call_async(request)
        self.wait(future.done, f"answer of {name}")
        self.node.destroy_client(client)
        return future.result()

    def close(self) -> None:
        for node in self._nodes:
            self._executor.remove_node(node)
            node.destroy_node()
        self.context.try_shutdown()


class Child:
    """A process whose output goes to a file."""

    def __init__(self, command: Sequence[str], log: Path, env: Mapping[str, str], cwd: Path | None = None) -> None:
        self.command = list(command)
        self._log = log
        with log.open("wb") as stream:
            self._process = subprocess.Popen(
                self.command, stdin=subprocess.DEVNULL, stdout=stream, stderr=subprocess.STDOUT, env=env, cwd=cwd
            )

    @property
    def output(self) -> str:
        return self._log.read_text(encoding="utf-8", errors="replace")

    def running(self) -> bool:
        return self._process.poll() is None

    def wait(self, seconds: float = DEADLINE_S) -> int:
        """Exit status, once the process has ended by itself."""
        try:
            return self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"{self.command} did not end within {seconds} s:\n{self.output}") from None

    def wait_for_output(self, part: str, seconds: float = DEADLINE_S) -> None:
        deadline = time.monotonic() + seconds
        while part not in self.output:
            assert self.running(), f"{self.command} ended without {part!r}:\n{self.output}"
            assert time.monotonic() < deadline, f"no {part!r} within {seconds} s:\n{self.output}"
            time.sleep(0.02)

    def end(self, number: int = signal.SIGINT) -> tuple[int, float]:
        """Exit status after a signal, and how many seconds it took."""
        assert self.running(), f"{self.command} has ended already:\n{self.output}"
        start = time.monotonic()
        self._process.send_signal(number)
        return self.wait(), time.monotonic() - start

    def close(self) -> None:
        """End it, whatever happened."""
        if self.running():
            self._process.send_signal(signal.SIGINT)
            try:
                self._process.wait(10)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()


class System:
    """A ROS domain with the package's processes in it, and the test's own place in it (`graph`)."""

    def __init__(self, domain: int, folder: Path) -> None:
        self.domain = domain
        self.folder = folder
        self.graph = Graph(domain)
        self._children: list[Child] = []

    def start(self, *command: str, cwd: Path | None = None, **env: str) -> Child:
        log = self.folder / f"child_{len(self._children)}.log"
        child = Child(command, log, environment(self.domain, **env), cwd)
        self._children.append(child)
        return child

    def start_node(self, name: str, values: Mapping[str, Any] | None = None, ros_args: Sequence[str] = ()) -> Child:
        """Start the executable of a node with parameter values."""
        parameters = [part for key, value in (values or {}).items() for part in ("-p", f"{key}:={_yaml(value)}")]
        module = f"stereo_pick.ros.nodes.{name}"
        return self.start(sys.executable, "-m", module, "--ros-args", *ros_args, *parameters)

    def start_command(self, *args: str) -> Child:
        """Start `stereo-pick` with arguments."""
        return self.start(sys.executable, "-m", "stereo_pick.cli.main", *args)

    def close(self) -> None:
        for child in reversed(self._children):
            child.close()
        self.graph.close()


@contextmanager
def running_system(folder: Path) -> Iterator[System]:
    """A system in a domain of its own, ended with all its processes; no process may have printed a traceback."""
    with reserved_domain() as domain:
        system = System(domain, folder)
        try:
            yield system
        finally:
            system.close()
        for log in folder.glob("child_*.log"):
            text = log.read_text(encoding="utf-8", errors="replace")
            assert "Traceback" not in text, text


@dataclass(frozen=True)
class Done:
    """An ended `stereo-pick`."""

    status: int
    stdout: str
    stderr: str

    @property
    def error(self) -> str:
        """The one line on stderr of a command that could not go on."""
        lines = self.stderr.splitlines()
        assert self.status == 1, (self.status, self.stderr)
        assert len(lines) == 1, self.stderr
        assert lines[0].startswith("stereo-pick: error: "), self.stderr
        return lines[0]


def stereo_pick(*args: str | Path, env: Mapping[str, str] | None = None, cwd: Path | None = None) -> Done:
    """Run the command `stereo-pick` to its end, as a process; it may never print a traceback."""
    command = [sys.executable, "-m", "stereo_pick.cli.main", *map(str, args)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=150, env=env, cwd=cwd, check=False)
    assert "Traceback" not in done.stdout + done.stderr, done.stderr
    return Done(done.returncode, done.stdout, done.stderr)


def stereo_pick_here(*args: str | Path) -> Done:
    """Run the command in this process, which saves a second; what is neither a status nor an error of its own raises.

    Its output is taken from the file descriptors, so that what libraries in C print counts, too.
    """
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        with _redirected(1, out), _redirected(2, err), redirect_stdout(out), redirect_stderr(err):
            status = main([str(arg) for arg in args])
        out.seek(0)
        err.seek(0)
        return Done(status, out.read(), err.read())


@contextmanager
def _redirected(descriptor: int, stream: IO[str]) -> Iterator[None]:
    kept = os.dup(descriptor)
    os.dup2(stream.fileno(), descriptor)
    try:
        yield
    finally:
        os.dup2(kept, descriptor)
        os.close(kept)


def _yaml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"'{value}'" if isinstance(value, (str, Path)) else repr(value)
