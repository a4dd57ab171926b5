"""Everything of a domain that the training phase reads, and the models file that it writes."""
from dataclasses import dataclass
from pathlib import Path
from typing import Any, List, Mapping, Sequence

from kr3_experiments.errors import Kr3Error
from kr3_experiments.learning.bindings import Binding, load_bindings
from kr3_experiments.learning.counts import Attempt, count
from kr3_experiments.learning.laws import LowLevel
from kr3_experiments.learning.models_file import (
    Models,
    action_name,
    learned,
    load_models,
    table,
    with_classes,
    write_models,
)
from kr3_experiments.learning.truth import Truth


@dataclass(frozen=True)
class Lesson:
    """The files of a domain. `entries` and `keys` are the models' actions by name."""

    folder: Path
    models: Models
    entries: Mapping[str, Mapping[str, Any]]
    keys: Mapping[str, str]
    bindings: Mapping[str, Binding]

    def laws(self, components: Mapping[str, Sequence[str]]) -> LowLevel:
        """The low level over these components of its places."""
        return LowLevel(self.folder / "domain.kr3", self.folder / "refinement.kr3", components)

    def truth(self) -> Truth:
        """How ground truth becomes fluents."""
        return Truth(self.folder / "learning.yaml")


def load_lesson(folder: Path) -> Lesson:
    """@throws Kr3Error  a file is missing or malformed"""
    models = load_models(folder / "models.yaml")
    keys = {action_name(key, folder / "models.yaml")[0]: key for key in models["actions"]}
    entries = {name: models["actions"][key] or {} for name, key in keys.items()}
    return Lesson(folder, models, entries, keys, load_bindings(folder / "bindings.yaml"))


def conclude(
    lesson: Lesson,
    laws: LowLevel,
    attempts: Sequence[Attempt],
    output: Path,
    how: Sequence[str],
    classes: bool,
) -> List[str]:
    """Write the models file. @return lines for people

    @throws Kr3Error  there are no attempts, or it cannot be written
    """
    if not attempts:
        raise Kr3Error("there are no attempts to learn from")
    labels = {name: laws.labels(name) for name in lesson.entries}
    counts = count(attempts, labels)
    models = learned(lesson.models, counts, lesson.folder / "models.yaml")
    if classes:
        models = with_classes(models, attempts, laws, lesson.folder / "models.yaml")
    write_models(models, output, how)
    return table(counts)
