"""How low-level actions are done: the domain's bindings.yaml, as the training phase needs it. Knows no ROS."""
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, List, Mapping, Optional, Sequence, Tuple

from kr3_experiments.errors import Kr3Error
from kr3_experiments.learning.laws import GroundAction, State, ground
from kr3_experiments.learning.models_file import action_name
from kr3_experiments.yaml_file import read_mapping


@dataclass(frozen=True)
class Binding:
    """One action's skill."""

    action: str
    parameters: Tuple[str, ...]
    server: str
    skill: str
    arguments: Tuple[str, ...]
    outcomes: Mapping[str, Tuple[str, ...]]  # label -> what it tells for each law about a truth

    def skill_arguments(self, action: GroundAction, state: State) -> List[str]:
        """The arguments for the skill. @throws Kr3Error  a fluent whose value is not known"""
        values = dict(zip(self.parameters, action.arguments))
        result = []
        for argument in self.arguments:
            if argument.startswith("${") and argument.endswith("}"):
                name, parameters = action_name(argument[2:-1], Path("bindings.yaml"))
                fluent = ground(name, [values.get(item, item) for item in parameters])
                if fluent not in state:
                    raise Kr3Error(f"{self.action}: the value of '{fluent}' is not known")
                result.append(str(state[fluent]))
            elif len(argument) >= 2 and argument[0] == argument[-1] == "'":
                result.append(argument[1:-1])
            else:
                result.append(values.get(argument, argument))
        return result

    def action_of(self, skill: str, arguments: Sequence[str], robot: str) -> Optional[GroundAction]:
        """The ground action that calls a skill so; None when it is another skill's.

        @param robot  stands for the one argument that a skill is not told: whose skill it is
        """
        if skill not in ("", self.skill) or len(arguments) != len(self.arguments):
            return None
        values = dict(zip(self.arguments, arguments))
        if sum(name not in values for name in self.parameters) > 1:
            return None
        return GroundAction(self.action, tuple(values.get(name, robot) for name in self.parameters))


def load_bindings(path: Path) -> Dict[str, Binding]:
    """Bindings by action. @throws Kr3Error  the file is missing or malformed"""
    try:
        content = read_mapping(path)
        result = {}
        for entry in content["actions"]:
            name, parameters = action_name(entry["action"], path)
            result[name] = Binding(
                name,
                tuple(parameters),
                entry["server"],
                entry["skill"],
                tuple(str(item) for item in entry["arguments"]),
                {
                    str(label): tuple(str(t) for t in tells)
                    for label, tells in entry["outcomes"].items()
                },
            )
        return result
    except (KeyError, TypeError, AttributeError) as error:
        raise Kr3Error(f"{path}: missing or malformed key {error}") from error
