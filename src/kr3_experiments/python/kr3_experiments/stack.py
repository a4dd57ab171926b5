"""The running robot: a master and the nodes of a stack file, started, watched and ended together."""
import os
import signal
import time
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Optional
from xmlrpc.client import Fault

import rosgraph
import roslib.packages
import rospkg
import rospy

from kr3_experiments.errors import Kr3Error, StackError, StartError
from kr3_experiments.master import is_master, start_master
from kr3_experiments.processes import ManagedProcess, Supervisor, end_processes
from kr3_experiments.stack_file import NodeSpec, ReadyKind, ReadySign
from kr3_experiments.yaml_file import read_mapping

_CALLER = "/kr3_bringup"
_POLL_S = 0.05


class Stack:
    """Context manager: on exit everything that it started is ended, and nothing else.

    Main thread only. Long waits go through `spin_until`, which also watches the processes.
    """

    def __init__(self, run_dir: Path, report: Callable[[str], None] = print):
        """@param run_dir  folder for the logs; @param report  takes one line about a change of state"""
        self._report = report
        self._logs = run_dir / "log"
        self._supervisor = Supervisor(report)
        self._environment = dict(os.environ)
        self._environment.setdefault("ROS_IP", "127.0.0.1")
        self._environment["ROS_LOG_DIR"] = str(self._logs / "ros")
        self._environment["PYTHONUNBUFFERED"] = "1"
        self._environment["ROSCONSOLE_STDOUT_LINE_BUFFERED"] = "1"  # a log ends where its node does
        self._helpers: List[ManagedProcess] = []
        self._uri = ""
        self._owns_master = False
        self._last_master_check = 0.0
        self._packages = rospkg.RosPack()

    def __enter__(self) -> "Stack":
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    @property
    def uri(self) -> str:
        """Address of the master."""
        return self._uri

    def start_master(self, port: int) -> None:
        """Start a master of our own and join it. @throws Kr3Error  port in use"""
        process = start_master(port, self._logs / "master.log", self._environment)
        self._supervisor.add(process)
        self._owns_master = True
        self._join(f"http://127.0.0.1:{port}")
        rosgraph.Master(_CALLER).setParam("/run_id", str(int(time.time())))
        self.start_process("rosout", [self.executable("rosout", "rosout")], max_restarts=3)

    def use_master(self, uri: str) -> None:
        """Work with a master that somebody else started. @throws StackError  it does not answer"""
        if not is_master(uri):
            raise StackError(f"no ROS master answers at {uri}")
        self._join(uri)

    def _join(self, uri: str) -> None:
        self._uri = uri
        self._environment["ROS_MASTER_URI"] = uri
        os.environ["ROS_MASTER_URI"] = uri
        os.environ.setdefault("ROS_IP", "127.0.0.1")
        os.environ["ROS_LOG_DIR"] = self._environment["ROS_LOG_DIR"]
        rosgraph.Master(_CALLER).setParam("/use_sim_time", True)
        if not rospy.core.is_initialized():
            rospy.init_node("kr3_bringup", anonymous=True, disable_signals=True)

    def executable(self, package: str, name: str) -> str:
        """What `rosrun package name` runs, found without its second of searching. @throws Kr3Error  there is none"""
        try:
            found = roslib.packages.find_node(package, name, self._packages)
        except rospkg.ResourceNotFound as error:
            raise Kr3Error(f"package {package} is not in the workspace") from error
        if not found:
            raise Kr3Error(f"package {package} has no executable '{name}'")
        return str(found[0])

    def start_process(self, name: str, command: List[str], max_restarts: int = 0) -> ManagedProcess:
        """Start any other program that belongs to the stack, with its output in `log/NAME.log`."""
        process = ManagedProcess(name, command, self._logs / f"{name}.log", self._environment)
        self._supervisor.add(process, max_restarts)
        return process

    def start_unwatched(self, name: str, command: List[str]) -> ManagedProcess:
        """As `start_process`, for a helper that may end at any time; the stack only ends it in the end."""
        process = ManagedProcess(name, command, self._logs / f"{name}.log", self._environment)
        self._helpers.append(process)
        return process

    def start_nodes(self, specs: List[NodeSpec]) -> None:
        """Start all nodes side by side and wait until each is ready.

        @throws Kr3Error    a package or an executable is unknown, or a parameter file cannot be read
        @throws StartError  a node ended, or was not ready in time
        """
        for spec in specs:
            self._set_parameters(spec)
            program = self.executable(spec.package, spec.executable)
            command = [program, *spec.arguments, f"__name:={spec.name}"]
            self.start_process(spec.name, command, spec.max_restarts)
        started = time.monotonic()
        for spec in specs:
            signs = [_Watch(sign) for sign in spec.ready]
            try:
                self._wait_ready(spec, signs, started + spec.ready_timeout_s)
            finally:
                for sign in signs:
                    sign.close()
            self._report(f"{spec.name} is ready ({time.monotonic() - started:.1f} s)")

    def _wait_ready(self, spec: NodeSpec, signs: List["_Watch"], deadline: float) -> None:
        pending = list(signs)
        while pending:
            self._supervisor.raise_if_ended()
            pending = [sign for sign in pending if not sign.is_given()]
            if pending and time.monotonic() > deadline:
                missing = ", ".join(
                    f"{sign.sign.kind.value} '{sign.sign.name}'" for sign in pending
                )
                log = self._logs / f"{spec.name}.log"
                raise StartError(
                    f"{spec.name} was not ready within {spec.ready_timeout_s:.0f} s (no {missing}); the end of {log}:\n"
                    + "\n".join(log.read_text(errors="replace").splitlines()[-12:])
                )
            time.sleep(_POLL_S)

    def _set_parameters(self, spec: NodeSpec) -> None:
        """Replace the node's private parameters: those of an earlier run would be refused as unknown."""
        master = rosgraph.Master(_CALLER)
        parameters: Dict[str, Any] = {}
        try:
            folder = Path(self._packages.get_path(spec.package))
        except rospkg.ResourceNotFound as error:
            raise Kr3Error(
                f"package {spec.package} of {spec.name} is not in the workspace"
            ) from error
        if spec.config is not None:
            parameters.update(_load_parameters(folder / spec.config))
        parameters.update(spec.parameters)
        try:
            master.deleteParam(f"/{spec.name}")
        except (rosgraph.MasterError, Fault):
            pass  # it was not set
        for name, value in parameters.items():
            master.setParam(f"/{spec.name}/{name}", value)

    def poll(self) -> None:
        """Look after the processes. @throws StackError  the master died or a node ended for good"""
        self._supervisor.poll()
        if self._owns_master or time.monotonic() - self._last_master_check < 1.0:
            return
        self._last_master_check = time.monotonic()
        if not is_master(self._uri):
            raise StackError(f"the ROS master at {self._uri} does not answer any more")

    def spin_until(self, done: Callable[[], bool], timeout_s: Optional[float] = None) -> bool:
        """Wait for `done`, looking after the processes. @return False: the time ran out (wall time)"""
        deadline = None if timeout_s is None else time.monotonic() + timeout_s
        while not done():
            self.poll()
            if deadline is not None and time.monotonic() > deadline:
                return False
            time.sleep(_POLL_S)
        return True

    def end(self) -> None:
        """End everything that was started, in bounded time; meanwhile Ctrl-C changes nothing. May be called twice."""
        previous = {
            number: signal.signal(number, signal.SIG_IGN)
            for number in (signal.SIGINT, signal.SIGTERM)
        }
        try:
            self._end()
        finally:
            for number, handler in previous.items():
                signal.signal(number, handler)

    def _end(self) -> None:
        if rospy.core.is_initialized() and not rospy.is_shutdown():
            rospy.signal_shutdown("the stack ends")
        end_processes(self._helpers)
        self._supervisor.end()


class _Watch:
    """Looks for one ready sign."""

    def __init__(self, sign: ReadySign):
        self.sign = sign
        self._subscriber: Optional[rospy.Subscriber] = None
        self._given = False
        if sign.kind is ReadyKind.TOPIC:
            self._subscriber = rospy.Subscriber(sign.name, rospy.AnyMsg, self._on_message)

    def _on_message(self, _message: rospy.AnyMsg) -> None:
        self._given = True

    def is_given(self) -> bool:
        """Whether the sign was seen."""
        if self._given or self.sign.kind is ReadyKind.TOPIC:
            return self._given
        name = rospy.resolve_name(self.sign.name)
        if self.sign.kind is ReadyKind.SERVICE:
            try:
                rospy.wait_for_service(name, timeout=0.05)
                self._given = True
            except rospy.ROSException:
                pass
            return self._given
        publishers, subscribers, _ = rosgraph.Master(_CALLER).getSystemState()
        listens = any(topic == f"{name}/goal" for topic, _ in subscribers)
        reports = any(topic == f"{name}/status" for topic, _ in publishers)
        self._given = listens and reports
        return self._given

    def close(self) -> None:
        """Stop listening."""
        if self._subscriber is not None:
            self._subscriber.unregister()


def _load_parameters(file: Path) -> Mapping[str, Any]:
    return read_mapping(file, "expected parameter names with values", may_be_empty=True)
