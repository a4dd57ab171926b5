"""The errors a person can act on: the command line prints their message and exits with their code."""


class Kr3Error(Exception):
    """Something outside the program is wrong; the message says what was found and what was expected."""

    exit_code = 1


class StackError(Kr3Error):
    """The running stack broke down: the master died, or a node ended too often or did not get ready."""


class StartError(StackError):
    """The stack did not come up: no mission began."""

    exit_code = 3
