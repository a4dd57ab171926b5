"""Child processes that never outlive the program: own process groups, orderly ends, bounded restarts. Knows no ROS."""
import ctypes
import os
import signal
import subprocess
import time
from pathlib import Path
from typing import Callable, Dict, List, Mapping, Optional, Sequence

from kr3_experiments.errors import StackError, StartError

_PR_SET_PDEATHSIG = 1
_LIBC = ctypes.CDLL(None, use_errno=True)

# How long a process may take to obey each signal, s.
ESCALATION = ((signal.SIGINT, 6.0), (signal.SIGTERM, 3.0), (signal.SIGKILL, 2.0))


def _prepare_child() -> None:
    """In the child: get SIGTERM when the parent ends, however it ends; heed SIGINT.

    A shell's background job ignores SIGINT, and what it starts inherits that.
    """
    _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def end_with_parent(parent: int) -> None:
    """In a child that `parent` has forked: get SIGTERM when it ends, however it ends, also if it has already."""
    _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
    if os.getppid() != parent:
        os.kill(os.getpid(), signal.SIGTERM)


class ManagedProcess:
    """One child in a process group and session of its own, with its output in a log file.

    Start it from the main thread only: Linux ties its life to the thread that started it.
    """

    def __init__(
        self, name: str, command: Sequence[str], log: Path, environment: Mapping[str, str]
    ):
        self.name = name
        self.command = list(command)
        self.log = log
        self._environment = dict(environment)
        self._popen: Optional[subprocess.Popen] = None
        self.start()

    def start(self) -> None:
        """Start the process (again); its output is appended to the log."""
        self.log.parent.mkdir(parents=True, exist_ok=True)
        with self.log.open("ab") as output:
            self._popen = subprocess.Popen(
                self.command,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                env=self._environment,
                start_new_session=True,
                preexec_fn=_prepare_child,
            )

    @property
    def _started(self) -> "subprocess.Popen[bytes]":
        if self._popen is None:
            raise RuntimeError("the process was not started")
        return self._popen

    @property
    def pid(self) -> int:
        """Process id, which is also the id of its group."""
        return self._started.pid

    def exit_code(self) -> Optional[int]:
        """None while it runs; negative: the number of the signal that ended it."""
        return self._started.poll()

    def signal_group(self, number: int) -> bool:
        """Send a signal to the whole group. False: nobody is left in it."""
        try:
            os.killpg(self._started.pid, number)
        except ProcessLookupError:
            return False
        except PermissionError:  # only zombies that are not ours are left
            return False
        return True

    def is_gone(self) -> bool:
        """Whether the process and everything it started in its group ended."""
        return self._started.poll() is not None and not self.signal_group(0)

    def log_tail(self, lines: int = 12) -> str:
        """The end of the log, for error messages."""
        try:
            text = self.log.read_text(encoding="utf-8", errors="replace")
        except OSError:
            return ""
        return "\n".join(line for line in text.splitlines()[-lines:])


def end_processes(
    processes: Sequence[ManagedProcess], escalation: Sequence = ESCALATION
) -> List[ManagedProcess]:
    """End the groups of all processes side by side, with harder signals as time passes.

    @return those that had to be killed (SIGKILL)
    """
    killed: List[ManagedProcess] = []
    for number, patience_s in escalation:
        left = [process for process in processes if not process.is_gone()]
        if not left:
            break
        for process in left:
            process.signal_group(number)
        if number == signal.SIGKILL:
            killed = left
        deadline = time.monotonic() + patience_s
        while time.monotonic() < deadline and not all(process.is_gone() for process in left):
            time.sleep(0.02)
    return killed


class Supervisor:
    """A set of processes of which each may be restarted a bounded number of times.

    Nothing happens by itself: `poll` looks, restarts and raises. Not thread-safe; main thread only.
    """

    def __init__(self, report: Callable[[str], None] = print):
        self._report = report
        self._processes: Dict[str, ManagedProcess] = {}
        self._restarts_left: Dict[str, int] = {}
        self._restarts_allowed: Dict[str, int] = {}

    def add(self, process: ManagedProcess, max_restarts: int = 0) -> None:
        """Watch a process that runs already."""
        self._processes[process.name] = process
        self._restarts_left[process.name] = max_restarts
        self._restarts_allowed[process.name] = max_restarts

    def processes(self) -> List[ManagedProcess]:
        """All that are watched, in the order they were added."""
        return list(self._processes.values())

    def raise_if_ended(self) -> None:
        """@throws StartError when any process ended: during start-up nothing is restarted."""
        for process in self._processes.values():
            code = process.exit_code()
            if code is not None:
                raise StartError(
                    f"{process.name} ended during the start ({describe_exit(code)}); the end of {process.log}:\n"
                    + process.log_tail()
                )

    def poll(self) -> None:
        """Restart what ended. @throws StackError when something ended that may not be restarted (any more)."""
        for name, process in self._processes.items():
            code = process.exit_code()
            if code is None:
                continue
            if self._restarts_left[name] == 0:
                allowed = self._restarts_allowed[name]
                again = f" after {allowed} restarts" if allowed else ""
                raise StackError(
                    f"{name} ended{again} ({describe_exit(code)}); the end of {process.log}:\n"
                    + process.log_tail()
                )
            self._restarts_left[name] -= 1
            count = self._restarts_allowed[name] - self._restarts_left[name]
            self._report(
                f"{name} ended ({describe_exit(code)}): restart {count} of {self._restarts_allowed[name]}"
            )
            process.signal_group(signal.SIGKILL)  # what it may have left behind in its group
            process.start()

    def end(self) -> None:
        """End everything, the last started first in the list but side by side in time."""
        killed = end_processes(list(reversed(self._processes.values())))
        for process in killed:
            self._report(f"{process.name} did not obey SIGINT and SIGTERM and was killed")


def describe_exit(code: int) -> str:
    """'exit code 1' or 'signal SIGSEGV'."""
    if code >= 0:
        return f"exit code {code}"
    try:
        return f"signal {signal.Signals(-code).name}"
    except ValueError:
        return f"signal {-code}"
