"""The stack file: which nodes make up the robot, with what parameters, and how one sees that each is ready."""
import math
import re
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import Any, Collection, Dict, List, Mapping, Optional, Tuple

from kr3_experiments.errors import Kr3Error
from kr3_experiments.yaml_file import read_mapping


class ReadyKind(Enum):
    """What shows that a node is ready."""

    TOPIC = "topic"  # a message arrives on it
    SERVICE = "service"  # it answers
    ACTION = "action"  # its server listens for goals


@dataclass(frozen=True)
class ReadySign:
    """`name` is the relative name of a topic, service or action."""

    kind: ReadyKind
    name: str


@dataclass(frozen=True)
class Follow:
    """In lockstep each message on `topic` says that the node is done with what bears the message's stamp."""

    topic: str
    period_s: float  # simulated, between messages


@dataclass(frozen=True)
class NodeSpec:
    """One node: `rosrun package executable __name:=name`, after its parameters were set."""

    name: str
    package: str
    executable: str
    config: Optional[str]  # parameter file, relative to the package
    parameters: Mapping[str, Any] = field(default_factory=dict)  # on top of `config`
    arguments: List[str] = field(default_factory=list)
    ready: List[ReadySign] = field(default_factory=list)
    ready_timeout_s: float = 60.0  # wall time
    max_restarts: int = 3
    follow: Optional[Follow] = None  # None: not in lockstep, or the node speaks for itself


_NODE_KEYS = {
    "name",
    "package",
    "executable",
    "config",
    "parameters",
    "arguments",
    "ready",
    "ready_timeout_s",
    "max_restarts",
    "lockstep",
}
_LOCKSTEP_KEYS = {"parameters", "follow", "period_s"}
_PLACEHOLDER = re.compile(r"\{(\w+)\}")


def substitute(value: Any, variables: Mapping[str, Any]) -> Any:
    """Fill in {name} in every text of a nested value; a text that is one placeholder takes the variable's own type.

    @throws Kr3Error  a placeholder without a variable
    """
    if isinstance(value, Mapping):
        return {key: substitute(item, variables) for key, item in value.items()}
    if isinstance(value, list):
        return [substitute(item, variables) for item in value]
    if not isinstance(value, str):
        return value

    def lookup(match: "re.Match[str]") -> Any:
        name = match.group(1)
        if name not in variables:
            raise Kr3Error(
                f"unknown placeholder {{{name}}}; there are {', '.join(sorted(variables))}"
            )
        return variables[name]

    whole = _PLACEHOLDER.fullmatch(value)
    if whole:
        return lookup(whole)
    return _PLACEHOLDER.sub(lambda match: str(lookup(match)), value)


def load_stack(
    file: Path,
    variables: Optional[Mapping[str, Any]],
    lockstep: bool = False,
    leave_out: Collection[str] = (),
) -> List[NodeSpec]:
    """Read a stack file.

    @param variables  None: placeholders stay as they are
    @param lockstep  the simulation waits for the nodes: with what the entries say below `lockstep`
    @param leave_out  names of nodes that are not wanted
    @throws Kr3Error  it cannot be read, or has an unknown key, a missing key or an unknown placeholder
    """
    content = read_mapping(file, "expected a list under 'nodes'")
    if not isinstance(content.get("nodes"), list):
        raise Kr3Error(f"{file}: expected a list under 'nodes'")
    entries = [
        entry
        for entry in content["nodes"]
        if not (isinstance(entry, dict) and entry.get("name") in leave_out)
    ]
    followed = [
        entry.get("name")
        for entry in entries
        if isinstance(entry, dict) and "follow" in (entry.get("lockstep") or {})
    ]
    known = None if variables is None else {**variables, "lockstep_consumers": followed}
    try:
        specs = [_node_spec(entry, known, lockstep) for entry in entries]
    except Kr3Error as error:
        raise Kr3Error(f"{file}: {error}") from error
    names = [spec.name for spec in specs]
    for name in names:
        if names.count(name) > 1:
            raise Kr3Error(f"{file}: two nodes are called {name}")
    return specs


def _node_spec(
    entry: Dict[str, Any], variables: Optional[Mapping[str, Any]], lockstep: bool
) -> NodeSpec:
    if not isinstance(entry, dict) or not {"name", "package"} <= entry.keys():
        raise Kr3Error(f"a node needs 'name' and 'package', found {entry!r}")
    unknown = entry.keys() - _NODE_KEYS
    if unknown:
        raise Kr3Error(
            f"{entry['name']}: unknown key '{sorted(unknown)[0]}'; known: {', '.join(sorted(_NODE_KEYS))}"
        )
    signs: List[ReadySign] = []
    for sign in entry.get("ready", []):
        (kind, name), *rest = sign.items()
        if rest or kind not in {item.value for item in ReadyKind}:
            raise Kr3Error(
                f"{entry['name']}: a ready sign is one of topic, service, action; found {sign!r}"
            )
        signs.append(ReadySign(ReadyKind(kind), name))

    def filled(value: Any) -> Any:
        return value if variables is None else substitute(value, variables)

    follow, more = _lockstep(entry["name"], entry.get("lockstep", {}))
    return NodeSpec(
        name=entry["name"],
        package=entry["package"],
        executable=entry.get("executable", entry["name"]),
        config=entry.get("config"),
        parameters=filled({**entry.get("parameters", {}), **(more if lockstep else {})}),
        arguments=filled(entry.get("arguments", [])),
        ready=signs,
        ready_timeout_s=float(entry.get("ready_timeout_s", NodeSpec.ready_timeout_s)),
        max_restarts=int(entry.get("max_restarts", NodeSpec.max_restarts)),
        follow=follow if lockstep else None,
    )


def _lockstep(name: str, entry: Any) -> Tuple[Optional[Follow], Mapping[str, Any]]:
    """What a node needs in lockstep: the topic that speaks for it, and parameters."""
    if not isinstance(entry, dict) or not entry.keys() <= _LOCKSTEP_KEYS:
        raise Kr3Error(
            f"{name}: 'lockstep' has {', '.join(sorted(_LOCKSTEP_KEYS))}; found {entry!r}"
        )
    if ("follow" in entry) != ("period_s" in entry):
        raise Kr3Error(
            f"{name}: 'lockstep' needs both follow and period_s or none; found {entry!r}"
        )
    if "follow" not in entry:
        return None, entry.get("parameters", {})
    period_s = entry["period_s"]
    if not isinstance(period_s, (int, float)) or not 0.0 < period_s < math.inf:
        raise Kr3Error(f"{name}: lockstep's period_s {period_s!r}: expected a number > 0")
    return Follow(str(entry["follow"]), float(period_s)), entry.get("parameters", {})
