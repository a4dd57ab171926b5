"""A POMDP in factors: what each variable depends on, action by action.

The writers for both file formats (flat_file, network_file) take a Network; the problems build one.
"""

import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

TOLERANCE = 1e-9

Distribution = Mapping[str, float]
State = tuple[str, ...]


@dataclass(frozen=True)
class Variable:
    """Part of the state. `seen`: the robot always knows its value."""

    name: str
    values: tuple[str, ...]
    seen: bool = False


@dataclass(frozen=True)
class Conditional:
    """What depends on the values of `parents`; `of` takes them in that order.

    It gives a distribution (values that are missing have probability 0), or a number for a reward.
    """

    parents: tuple[str, ...]
    of: Callable[..., Any]


def always(outcome: Any) -> Conditional:
    """The same whatever the state is."""
    return Conditional((), lambda: outcome)


@dataclass(frozen=True)
class Network:
    """A model; tables are given by functions of an action.

    transition(action, variable): parents are variables before the action
    observation(action): parents are variables after the action
    reward(action): parents are variables before the action; an expectation over what follows
    start: a distribution over the values of each variable, which are independent
    merged: name of a state in the flat model; states with one name must behave alike (an end that
    is reached in many ways)
    """

    name: str
    description: str
    discount: float
    variables: tuple[Variable, ...]
    actions: tuple[str, ...]
    observations: tuple[str, ...]
    start: Mapping[str, Distribution]
    transition: Callable[[str, str], Conditional]
    observation: Callable[[str], Conditional]
    reward: Callable[[str], Conditional]
    merged: Callable[[State], str] = "_".join

    def variable(self, name: str) -> Variable:
        return next(variable for variable in self.variables if variable.name == name)

    def states(self) -> Iterator[State]:
        """All joint values, the last variable fastest."""
        return itertools.product(*(variable.values for variable in self.variables))

    def flat_names(self) -> list[str]:
        """Names of the flat model's states, in their order."""
        return list(dict.fromkeys(self.merged(state) for state in self.states()))

    def value(self, conditional: Conditional, state: State) -> Any:
        """What `conditional` gives in a state."""
        return conditional.of(*(state[i] for i in self._positions(conditional)))

    def start_probability(self, state: State) -> float:
        product = 1.0
        for variable, value in zip(self.variables, state):
            product *= self.start[variable.name].get(value, 0.0)
        return product

    def next_states(self, action: str, state: State) -> Iterator[tuple[State, float]]:
        """The states that may follow, with their probabilities."""
        factors = [
            [
                (value, p)
                for value, p in self.value(self.transition(action, v.name), state).items()
                if p > 0.0
            ]
            for v in self.variables
        ]
        for choice in itertools.product(*factors):
            probability = 1.0
            for _, p in choice:
                probability *= p
            yield tuple(value for value, _ in choice), probability

    def _positions(self, conditional: Conditional) -> list[int]:
        names = [variable.name for variable in self.variables]
        return [names.index(parent) for parent in conditional.parents]


def check_distribution(distribution: Distribution, values: tuple[str, ...], where: str) -> None:
    """@raises ValueError  an unknown value, a number that is no probability, a sum other than 1"""
    for value, p in distribution.items():
        if value not in values:
            raise ValueError(f"{where}: unknown value '{value}'")
        if not 0.0 <= p <= 1.0 + TOLERANCE:
            raise ValueError(f"{where}: found probability {p} of '{value}'")
    total = sum(distribution.values())
    if abs(total - 1.0) > TOLERANCE:
        raise ValueError(f"{where}: found probabilities that sum to {total}, expected 1")
