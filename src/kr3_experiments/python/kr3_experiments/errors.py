"""The errors a person can act on: the command line prints their message and exits with 1."""


class Kr3Error(Exception):
    """Something outside the program is wrong; the message says what was found and what was expected."""


class StackError(Kr3Error):
    """The running stack broke down: the master died, or a node ended too often or did not get ready."""
