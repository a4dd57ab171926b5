"""Models that the Python tests share, from formulas."""

import numpy as np

STATES = ["tiger_left", "tiger_right"]
ACTIONS = ["listen", "open_left", "open_right"]
HEARD = ["hear_left", "hear_right"]

TIGER_FILE = """
discount: 0.95
values: reward
states: tiger_left tiger_right
actions: listen open_left open_right
observations: hear_left hear_right
T: listen identity
T: open_left uniform
T: open_right uniform
O: listen
0.85 0.15
0.15 0.85
O: open_left uniform
O: open_right uniform
R: listen : * : * : * -1
R: open_left : tiger_left : * : * -100
R: open_left : tiger_right : * : * 10
R: open_right : tiger_left : * : * 10
R: open_right : tiger_right : * : * -100
"""


def tiger_arrays():
    """T [A, S, S], O [A, S, O] and R [A, S] of the Tiger problem (Cassandra, Kaelbling, Littman 1994)."""
    transitions = np.full((3, 2, 2), 0.5)
    transitions[0] = np.eye(2)
    observations = np.full((3, 2, 2), 0.5)
    observations[0] = [[0.85, 0.15], [0.15, 0.85]]
    rewards = np.array([[-1.0, -1.0], [-100.0, 10.0], [10.0, -100.0]])
    return transitions, observations, rewards


def named():
    return {"states": STATES, "actions": ACTIONS, "observation_names": HEARD}
