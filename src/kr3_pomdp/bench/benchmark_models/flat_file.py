"""Write a Network as a flat `.pomdp` file (Cassandra's format): every state by name, rows of what is possible."""

from collections.abc import Iterable
from typing import TextIO

from .network import Network, State, check_distribution
from .network_file import number

Row = tuple[tuple[str, float], ...]


def write(network: Network, out: TextIO) -> None:
    """@raises ValueError  a row that is no distribution, or merged states that differ"""
    states = merged_states(network)
    out.write(f"# {network.description}\n\ndiscount: {number(network.discount)}\nvalues: reward\n")
    out.write(f"states: {' '.join(states)}\nactions: {' '.join(network.actions)}\n")
    out.write(f"observations: {' '.join(network.observations)}\n\nstart:")
    start = dict.fromkeys(states, 0.0)
    for state in network.states():
        start[network.merged(state)] += network.start_probability(state)
    check_distribution(start, tuple(states), "start")
    out.writelines(f" {number(p)}" for p in start.values())
    out.write("\n")
    for action in network.actions:
        out.write("\n")
        write_transitions(network, action, states, out)
        write_observations(network, action, states, out)
        write_rewards(network, action, states, out)


def merged_states(network: Network) -> dict[str, list[State]]:
    """The joint values that each state of the flat model stands for."""
    result: dict[str, list[State]] = {}
    for state in network.states():
        result.setdefault(network.merged(state), []).append(state)
    return result


def alike(rows: Iterable[Row], where: str) -> Row:
    """The row that all of them are.

    @raises ValueError  they differ
    """
    first, *others = rows
    if any(row != first for row in others):
        raise ValueError(f"{where}: merged states differ")
    return first


def transition_row(network: Network, action: str, state: State) -> Row:
    row: dict[str, float] = {}
    for following, p in network.next_states(action, state):
        name = network.merged(following)
        row[name] = row.get(name, 0.0) + p
    return tuple(row.items())


def write_transitions(
    network: Network, action: str, states: dict[str, list[State]], out: TextIO
) -> None:
    rows = {}
    for name, members in states.items():
        where = f"transition of {action} in {name}"
        rows[name] = alike((transition_row(network, action, s) for s in members), where)
        check_distribution(dict(rows[name]), tuple(states), where)
    if all(row == ((name, 1.0),) for name, row in rows.items()):
        out.write(f"T: {action} identity\n")
        return
    for name, row in rows.items():
        out.writelines(f"T: {action} : {name} : {to} {number(p)}\n" for to, p in row)


def write_observations(
    network: Network, action: str, states: dict[str, list[State]], out: TextIO
) -> None:
    conditional = network.observation(action)
    rows = {}
    for name, members in states.items():
        where = f"observation of {action} in {name}"
        seen = [network.value(conditional, s) for s in members]
        rows[name] = alike((tuple(o for o in d.items() if o[1] > 0.0) for d in seen), where)
        check_distribution(dict(rows[name]), network.observations, where)
    if len(set(rows.values())) == 1:
        rows = {"*": next(iter(rows.values()))}
    for name, row in rows.items():
        out.writelines(f"O: {action} : {name} : {seen} {number(p)}\n" for seen, p in row)


def write_rewards(
    network: Network, action: str, states: dict[str, list[State]], out: TextIO
) -> None:
    conditional = network.reward(action)
    rewards = {}
    for name, members in states.items():
        values = [((name, network.value(conditional, s)),) for s in members]
        rewards[name] = alike(values, f"reward of {action} in {name}")[0][1]
    if len(set(rewards.values())) == 1:
        rewards = {"*": next(iter(rewards.values()))}
    for name, reward in rewards.items():
        if reward != 0.0:
            out.write(f"R: {action} : {name} : * : * {number(reward)}\n")
