"""Write a Network as `.pomdpx`: one table a variable, with `*` where a table does not depend on a parent.

Entries are written from the common to the particular; a later entry replaces what an earlier one said.
"""

import itertools
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any, TextIO

from .network import Conditional, Network, Variable, check_distribution

ANY = "*"
Entry = tuple[tuple[str, ...], str]


def compress(
    domains: Sequence[tuple[str, ...]], text_of: Callable[[tuple[str, ...]], str]
) -> list[Entry]:
    """Entries, with `*` where possible, that together give `text_of` of every combination of values."""
    if not domains:
        return [((), text_of(()))]
    parts = {}
    for value in domains[0]:
        parts[value] = compress(domains[1:], lambda rest, first=value: text_of((first, *rest)))
    return merge(parts)


def merge(parts: dict[str, list[Entry]]) -> list[Entry]:
    """Entries of the values of one more parent in front; what most of them share comes first, with `*`."""
    usual = Counter(tuple(entries) for entries in parts.values()).most_common(1)[0][0]
    result = [((ANY, *instance), text) for instance, text in usual]
    for value, entries in parts.items():
        if tuple(entries) != usual:
            result += [((value, *instance), text) for instance, text in entries]
    return result


def table(
    network: Network,
    name_of_action: Callable[[str], Conditional],
    text_of: Callable[[Any, str], str],
) -> tuple[list[str], list[Entry]]:
    """The parents that some action's table has, and the entries: action, parents."""
    conditionals = {action: name_of_action(action) for action in network.actions}
    used = set(itertools.chain.from_iterable(c.parents for c in conditionals.values()))
    parents = [variable.name for variable in network.variables if variable.name in used]
    parts = {}
    for action, conditional in conditionals.items():
        own = [network.variable(parent) for parent in conditional.parents]
        entries = compress(
            [variable.values for variable in own],
            lambda values, a=action, c=conditional: text_of(c.of(*values), a),
        )
        parts[action] = [(spread(conditional.parents, parents, i), text) for i, text in entries]
    return parents, merge(parts)


def spread(own: Sequence[str], parents: Sequence[str], instance: Sequence[str]) -> tuple[str, ...]:
    """An instance over all parents; those that are not its own are `*`."""
    values = dict(zip(own, instance))
    return tuple(values.get(parent, ANY) for parent in parents)


def probabilities(variable: Variable, where: str) -> Callable[[Any, str], str]:
    """How a distribution over the variable's values is written."""

    def text(distribution: Any, action: str) -> str:
        check_distribution(distribution, variable.values, f"{where}, action {action}")
        return " ".join(number(distribution.get(value, 0.0)) for value in variable.values)

    return text


def number(value: float) -> str:
    """Shortest text that reads back to the same number."""
    return str(int(value)) if value == int(value) else repr(float(value))


def write(network: Network, out: TextIO) -> None:
    out.write("<?xml version='1.0' encoding='UTF-8'?>\n")
    out.write(f"<pomdpx version='1.0' id='{network.name}'>\n")
    out.write(f"<Description>{network.description}</Description>\n")
    out.write(f"<Discount>{number(network.discount)}</Discount>\n<Variable>\n")
    for variable in network.variables:
        seen = "true" if variable.seen else "false"
        out.write(
            f"<StateVar vnamePrev='{variable.name}_0' vnameCurr='{variable.name}_1' fullyObs='{seen}'>"
            f"<ValueEnum>{' '.join(variable.values)}</ValueEnum></StateVar>\n"
        )
    out.write(
        f"<ObsVar vname='seen'><ValueEnum>{' '.join(network.observations)}</ValueEnum></ObsVar>\n"
    )
    out.write(
        f"<ActionVar vname='action'><ValueEnum>{' '.join(network.actions)}</ValueEnum></ActionVar>\n"
    )
    out.write("<RewardVar vname='reward'/>\n</Variable>\n<InitialStateBelief>\n")
    for variable in network.variables:
        text = probabilities(variable, f"start of {variable.name}")(
            network.start[variable.name], "-"
        )
        function(out, "CondProb", f"{variable.name}_0", ["null"], [(("-",), text)], "ProbTable")
    out.write("</InitialStateBelief>\n<StateTransitionFunction>\n")
    for variable in network.variables:
        parents, entries = table(
            network,
            lambda action, name=variable.name: network.transition(action, name),
            probabilities(variable, f"transition of {variable.name}"),
        )
        before = ["action", *(f"{parent}_0" for parent in parents)]
        entries = [((*instance, "-"), text) for instance, text in entries]
        function(out, "CondProb", f"{variable.name}_1", before, entries, "ProbTable")
    out.write("</StateTransitionFunction>\n<ObsFunction>\n")
    seen_values = Variable("seen", network.observations)
    parents, entries = table(
        network, network.observation, probabilities(seen_values, "observation")
    )
    after = ["action", *(f"{parent}_1" for parent in parents)]
    entries = [((*instance, "-"), text) for instance, text in entries]
    function(out, "CondProb", "seen", after, entries, "ProbTable")
    out.write("</ObsFunction>\n<RewardFunction>\n")
    parents, entries = table(network, network.reward, lambda value, action: number(value))
    before = ["action", *(f"{parent}_0" for parent in parents)]
    function(out, "Func", "reward", before, entries, "ValueTable")
    out.write("</RewardFunction>\n</pomdpx>\n")


def function(
    out: TextIO, kind: str, variable: str, parents: list[str], entries: list[Entry], value_tag: str
) -> None:
    out.write(
        f"<{kind}><Var>{variable}</Var><Parent>{' '.join(parents)}</Parent><Parameter type='TBL'>\n"
    )
    for instance, text in entries:
        out.write(
            f"<Entry><Instance>{' '.join(instance)}</Instance><{value_tag}>{text}</{value_tag}></Entry>\n"
        )
    out.write(f"</Parameter></{kind}>\n")
