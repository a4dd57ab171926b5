"""The ROS master of a stack: started on a free or a given port, watched, ended."""
import socket
import time
from pathlib import Path
from typing import Any, Mapping
from xmlrpc.client import ServerProxy

from kr3_experiments.errors import Kr3Error, StackError
from kr3_experiments.processes import ManagedProcess


def free_port() -> int:
    """A TCP port that nobody listens on now."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def require_free_port(port: int) -> None:
    """@throws Kr3Error  somebody listens on the port already, or it cannot be used"""
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(("", port))
    except (OSError, OverflowError) as error:
        owner = "another ROS master" if is_master(f"http://127.0.0.1:{port}") else "another program"
        if isinstance(error, OSError) and error.errno == 98:
            raise Kr3Error(
                f"port {port} is in use by {owner}; choose another with --port"
            ) from error
        raise Kr3Error(f"port {port} cannot be used: {error}") from error


def is_master(uri: str, timeout_s: float = 2.0) -> bool:
    """Whether a ROS master answers at `uri`."""
    previous = socket.getdefaulttimeout()
    socket.setdefaulttimeout(timeout_s)
    try:
        answer: Any = ServerProxy(uri).getPid("/kr3_probe")
        return bool(answer[0] == 1)
    except Exception:  # noqa: B902  whatever listens there may answer anything at all
        return False
    finally:
        socket.setdefaulttimeout(previous)


def start_master(
    port: int, log: Path, environment: Mapping[str, str], timeout_s: float = 15.0
) -> ManagedProcess:
    """Start rosmaster and wait until it answers.

    @throws Kr3Error    the port is in use
    @throws StackError  it did not answer in time
    """
    require_free_port(port)
    command = ["rosmaster", "--core", "-p", str(port)]
    process = ManagedProcess("the ROS master", command, log, environment)
    deadline = time.monotonic() + timeout_s
    while not is_master(f"http://127.0.0.1:{port}"):
        if process.exit_code() is not None or time.monotonic() > deadline:
            process.signal_group(9)
            raise StackError(f"the ROS master did not start on port {port}:\n{process.log_tail()}")
        time.sleep(0.05)
    return process
