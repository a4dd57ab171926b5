"""The training phase in the abstract simulator: as many trials as one likes, in a world whose numbers are known."""
import subprocess
from pathlib import Path
from typing import List

from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.worker import find_program
from kr3_experiments.learning.counts import Attempt, read_attempts


def attempts_in_abstract_world(
    folder: Path, trials: int, seed: int, output: Path, models: str = "models.yaml"
) -> List[Attempt]:
    """Try every low-level action `trials` times, on each side of the truth, and keep the attempts in `output`.

    Each trial has a state of its own, so that trials are independent. With the same seed the first trials do not depend
    on how many there are; those of a round follow each other, so that a part of the file is a shorter training phase.

    @param folder  of the domain. @param models  file in it: the world's numbers
    @throws Kr3Error  kr3_training is not built or refuses, or `output` cannot be written
    """
    command = [
        find_program("kr3_executive", "kr3_training"),
        *(str(folder), "--trials", str(trials), "--seed", str(seed), "--models", models),
    ]
    try:
        with output.open("w", encoding="utf-8") as file:
            done = subprocess.run(
                command, stdout=file, stderr=subprocess.PIPE, text=True, check=False
            )
    except OSError as error:
        raise Kr3Error(f"{output}: {error.strerror}") from error
    if done.returncode != 0:
        raise Kr3Error(f"no training in the abstract world: {done.stderr.strip()}")
    return read_attempts(output)
