"""Lines for a person at a terminal; safe to call from several threads."""
import os
import sys
import threading

from kr3_experiments.events import Event, terminal_line


class Terminal:
    """Writes progress to stdout, in colour if it is a terminal that has some."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._colour = (
            sys.stdout.isatty()
            and os.environ.get("TERM") != "dumb"
            and "NO_COLOR" not in os.environ
        )

    def line(self, text: str = "") -> None:
        """One line as it is."""
        with self._lock:
            print(text, flush=True)

    def heading(self, text: str) -> None:
        """A line that stands out."""
        self.line(f"\033[1m{text}\033[0m" if self._colour else text)

    def detail(self, text: str) -> None:
        """A line of less importance, indented."""
        self.line(f"\033[2m  {text}\033[0m" if self._colour else f"  {text}")

    def verdict(self, success: bool, text: str) -> None:
        """The last word on something."""
        code = "1;32" if success else "1;31"
        self.line(f"\033[{code}m{text}\033[0m" if self._colour else text)

    def event(self, event: Event) -> None:
        """One event of the mission."""
        self.line(terminal_line(event, self._colour))
