"""What the training phase needs of a low level: its ground actions, when they are possible, what their outcomes do and
what they observe. Read from domain.kr3 and refinement.kr3; knows no ROS.

Values of a magnified sort are components here: the low level's places are cells.
"""
import itertools
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

from kr3_experiments.errors import Kr3Error

Value = Union[str, bool]
State = Mapping[str, Value]  # ground fluent, as "f(a, b)", to its value
Substitution = Mapping[str, str]

_NAME = r"[A-Za-z_]\w*"
_ATOM = re.compile(rf"^\s*(-?)\s*({_NAME})\s*(?:\(([^()]*)\))?\s*$")
_SECTIONS = ("sorts", "statics", "fluents", "actions", "axioms", "observations", "defaults")


def ground(name: str, arguments: Sequence[str]) -> str:
    """A ground atom as text."""
    return f"{name}({', '.join(arguments)})" if arguments else name


@dataclass(frozen=True)
class Atom:
    """A fluent, a static or an action, with variables or constants."""

    name: str
    arguments: Tuple[str, ...]

    def under(self, values: Substitution) -> str:
        """The ground atom."""
        return ground(self.name, [values.get(argument, argument) for argument in self.arguments])


@dataclass(frozen=True)
class Literal:
    """`left` is an atom or a variable; without `right` it is said to be true or false."""

    left: Union[Atom, str]
    right: Optional[str]
    positive: bool


@dataclass(frozen=True)
class Effect:
    """One outcome of a causal law. `definite` is its effect; None: nothing, or a value from a set."""

    label: str
    definite: Optional[Literal]


@dataclass(frozen=True)
class ObservationLaw:
    """`value` None: the action tells the fluent's value; else whether it has that value."""

    action: Atom
    fluent: Atom
    value: Optional[str]


@dataclass(frozen=True)
class GroundAction:
    """An action with its arguments."""

    name: str
    arguments: Tuple[str, ...]

    def __str__(self) -> str:
        return ground(self.name, self.arguments)


class LowLevel:
    """The laws of one domain at the low level.

    @param components  whole -> its components, of the magnified sort
    @throws Kr3Error   a file is missing, or has a law that is not understood here
    """

    def __init__(self, domain: Path, refinement: Path, components: Mapping[str, Sequence[str]]):
        self._components = components
        self.sorts: Dict[str, List[str]] = {}
        self._actions: Dict[str, List[str]] = {}
        self._conditions: List[Tuple[Atom, List[Literal]]] = []
        self._effects: Dict[str, List[Tuple[Atom, List[Effect]]]] = {}
        self.observations: List[ObservationLaw] = []
        self._magnified = ""
        coarse = _statements(domain)
        fine = _statements(refinement)
        for where, section, text in (*coarse, *fine):
            self._declare(where, section, text)
        replaced = {
            match.group(1)
            for _, section, text in fine
            if section == "axioms" and (match := re.match(rf"({_NAME})\(.*?\)\s+causes\b", text))
        }
        for where, section, text in coarse:
            name = re.match(_NAME, text)
            if section == "axioms" and not (
                name and name.group() in replaced and " causes " in text
            ):
                self._law(where, text)
        for where, section, text in fine:
            if section == "axioms":
                self._law(where, text)
            elif section == "observations":
                self._observation(where, text)

    def labels(self, action: str) -> List[str]:
        """The labels of an action's outcomes, in the order of its laws."""
        found: List[str] = []
        for _, effects in self._effects.get(action, []):
            found += [
                effect.label for effect in effects if effect.label and effect.label not in found
            ]
        return found

    def parameters(self, action: str) -> List[str]:
        """The sorts of its parameters. @throws Kr3Error  no such action"""
        if action not in self._actions:
            raise Kr3Error(f"there is no action '{action}': there are {', '.join(self._actions)}")
        return self._actions[action]

    def elements(self, sort: str) -> List[str]:
        """The elements that an argument of this sort has at the low level."""
        if sort == self._magnified:
            return [part for whole in self.sorts[sort] for part in self._components.get(whole, [])]
        if sort not in self.sorts:
            # The sort of components is named by the refinement alone.
            return [part for parts in self._components.values() for part in parts]
        return self.sorts[sort]

    def ground_actions(self, name: str) -> Iterator[GroundAction]:
        """All of one action."""
        for values in itertools.product(*(self.elements(sort) for sort in self.parameters(name))):
            yield GroundAction(name, values)

    def possible(self, action: GroundAction, state: State) -> bool:
        """Whether no law forbids the action in a state. What the state does not say counts as false."""
        for head, condition in self._conditions:
            if head.name == action.name and any(
                all(_holds(literal, values, state) for literal in condition)
                for values in self._bindings(head, condition, action, state)
            ):
                return False
        return True

    def conditions(self, action: GroundAction) -> List[str]:
        """The ground fluents that decide whether the action is possible, as far as its arguments name them."""
        found: List[str] = []
        for head, condition in self._conditions:
            values = dict(zip(head.arguments, action.arguments))
            for literal in condition:
                if head.name != action.name or isinstance(literal.left, str):
                    continue
                free = [a for a in literal.left.arguments if a[0].isupper() and a not in values]
                if not free and (name := literal.left.under(values)) not in found:
                    found.append(name)
        return found

    def outcome(self, action: GroundAction, after: State) -> str:
        """The label of what happened: of the effect that holds, else of the one that promises nothing definite.

        @return "" when the action's laws have no labels, or none fits
        """
        for head, effects in self._effects.get(action.name, []):
            values = dict(zip(head.arguments, action.arguments))
            rest = ""
            for effect in effects:
                if effect.definite is None:
                    rest = rest or effect.label
                elif _holds(effect.definite, values, after):
                    return effect.label
            return rest
        return ""

    def promised(self, action: GroundAction, state: State) -> Optional[Dict[str, Value]]:
        """The state after the action if its first definite effect comes true; None without one."""
        for head, effects in self._effects.get(action.name, []):
            values = dict(zip(head.arguments, action.arguments))
            for effect in effects:
                literal = effect.definite
                if literal is None or isinstance(literal.left, str):
                    continue
                value: Value = (
                    literal.positive
                    if literal.right is None
                    else values.get(literal.right, literal.right)
                )
                return {**state, literal.left.under(values): value}
        return None

    def _declare(self, where: str, section: str, text: str) -> None:
        if section == "sorts":
            name, _, definition = text.partition("=")
            elements: List[str] = []
            for part in definition.split("+"):
                part = part.strip()
                elements += (
                    [item.strip() for item in part.strip("{}").split(",")]
                    if part.startswith("{")
                    else self.sorts.get(part, [])
                )
            self.sorts[name.strip()] = elements
        elif section == "actions" and not text.startswith("exogenous"):
            atom = _atom(text, where)
            self._actions[atom.name] = list(atom.arguments)
        elif section == "" and text.startswith("magnify"):
            self._magnified = text.split()[1]

    def _law(self, where: str, text: str) -> None:
        if text.startswith("impossible"):
            head, _, body = text[len("impossible") :].partition(" if ")
            if not re.match(rf"^\s*{_NAME}\s*\(", head) or re.search(r"\)\s*,", head):
                return  # about actions at the same time: here they come one by one
            self._conditions.append(
                (_atom(head, where), [_literal(part, where) for part in _split(body)])
            )
        elif " causes " in text:
            head, _, body = text.partition(" causes ")
            effects = []
            for part in re.split(r"\bor\b", body.partition(" if ")[0]):
                match = re.match(r"^(.*?)(?:\[(\w+)\])?\s*$", part.strip())
                effect, label = (match.group(1).strip(), match.group(2)) if match else (part, None)
                vague = effect == "nothing" or "{" in effect
                effects.append(Effect(label or "", None if vague else _literal(effect, where)))
            atom = _atom(head, where)
            self._effects.setdefault(atom.name, []).append((atom, effects))

    def _observation(self, where: str, text: str) -> None:
        head, _, body = text.partition(" observes ")
        fluent, _, value = body.partition("=")
        self.observations.append(
            ObservationLaw(_atom(head, where), _atom(fluent, where), value.strip() or None)
        )

    def _bindings(
        self, head: Atom, condition: Sequence[Literal], action: GroundAction, state: State
    ) -> Iterator[Dict[str, str]]:
        """Values for the condition's variables: the action's arguments, then whatever the state's fluents have."""
        values = dict(zip(head.arguments, action.arguments))
        for literal in condition:  # V in "f(..) = V" is the value that f has
            if isinstance(literal.left, Atom) and literal.right and literal.positive:
                value = state.get(literal.left.under(values))
                if literal.right[0].isupper() and literal.right not in values and value is not None:
                    values[literal.right] = str(value)
        free = sorted(
            {
                argument
                for literal in condition
                if isinstance(literal.left, Atom)
                for argument in literal.left.arguments
                if argument[0].isupper() and argument not in values
            }
        )
        constants = sorted({item for elements in self.sorts.values() for item in elements})
        for chosen in itertools.product(constants, repeat=len(free)):
            yield {**values, **dict(zip(free, chosen))}


def _holds(literal: Literal, values: Substitution, state: State) -> bool:
    if isinstance(literal.left, str):
        left: Optional[Value] = values.get(literal.left, literal.left)
    else:
        left = state.get(literal.left.under(values))
    if literal.right is None:
        return (left is True) == literal.positive
    return (left == values.get(literal.right, literal.right)) == literal.positive


def _atom(text: str, where: str) -> Atom:
    match = _ATOM.match(text)
    if match is None or match.group(1):
        raise Kr3Error(f"{where}: found '{text.strip()}', expected a name with arguments")
    arguments = tuple(item.strip() for item in (match.group(3) or "").split(",") if item.strip())
    return Atom(match.group(2), arguments)


def _literal(text: str, where: str) -> Literal:
    for sign, positive in (("!=", False), ("=", True)):
        left, found, right = text.partition(sign)
        if found:
            is_atom = "(" in left
            return Literal(_atom(left, where) if is_atom else left.strip(), right.strip(), positive)
    match = _ATOM.match(text)
    if match is None:
        raise Kr3Error(f"{where}: found '{text.strip()}', expected a literal")
    return Literal(
        _atom(text.replace("-", "", 1) if match.group(1) else text, where), None, not match.group(1)
    )


def _split(body: str) -> List[str]:
    """Parts between commas outside parentheses."""
    parts, depth, part = [], 0, ""
    for character in body:
        depth += {"(": 1, ")": -1}.get(character, 0)
        if character == "," and depth == 0:
            parts.append(part)
            part = ""
        else:
            part += character
    return [item for item in (*parts, part) if item.strip()]


def _statements(file: Path) -> List[Tuple[str, str, str]]:
    """(where, section, text) of each statement. @throws Kr3Error  the file cannot be read"""
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise Kr3Error(f"{file}: {error.strerror}") from error
    result: List[Tuple[str, str, str]] = []
    section, text, start = "", "", 0
    for number, line in enumerate(lines, 1):
        bare = line.partition("%")[0].strip()
        if bare in _SECTIONS:
            section = bare
            continue
        start = start if text else number
        text = f"{text} {bare}".strip()
        if text.endswith("."):
            result.append((f"{file}:{start}", section, text[:-1].strip()))
            text = ""
    return result
