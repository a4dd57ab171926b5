"""Work in a process of its own: a process joins one ROS master in its life."""
import multiprocessing
import os
from typing import Any, Callable, TypeVar

from kr3_experiments.errors import Kr3Error
from kr3_experiments.processes import describe_exit, end_with_parent

Result = TypeVar("Result")


def in_own_process(work: Callable[[], Result]) -> Result:
    """What `work` returns. The process is a copy of this one, and ends with it, however it ends.

    @throws Kr3Error  what `work` throws, or the process ended without a word
    """
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    parent = os.getpid()

    def run() -> None:
        end_with_parent(parent)
        try:
            sender.send((work(), None))
        except Kr3Error as error:
            sender.send((None, error))
        except KeyboardInterrupt:
            pass  # the parent knows

    process = context.Process(target=run)
    process.start()
    sender.close()
    try:
        process.join()
    except BaseException:
        process.terminate()
        process.join()
        raise
    answer: Any
    try:
        answer, error = receiver.recv()
    except EOFError:
        how = describe_exit(process.exitcode or 0)
        raise Kr3Error(f"a process ended without a result ({how})") from None
    if error is not None:
        raise error
    return answer
