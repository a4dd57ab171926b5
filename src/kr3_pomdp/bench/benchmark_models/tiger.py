"""Two doors, a tiger behind one of them. Source: Cassandra, Kaelbling and Littman (1994)."""

from .network import Conditional, Network, Variable, always

HEARD_RIGHT = 0.85


def tiger() -> Network:
    def transition(action: str, variable: str) -> Conditional:
        del variable
        if action == "listen":
            return Conditional(("tiger",), lambda where: {where: 1.0})
        return always({"left": 0.5, "right": 0.5})

    def observation(action: str) -> Conditional:
        if action != "listen":
            return always({"hear_left": 0.5, "hear_right": 0.5})
        return Conditional(
            ("tiger",),
            lambda where: {
                "hear_left": HEARD_RIGHT if where == "left" else 1.0 - HEARD_RIGHT,
                "hear_right": HEARD_RIGHT if where == "right" else 1.0 - HEARD_RIGHT,
            },
        )

    def reward(action: str) -> Conditional:
        if action == "listen":
            return always(-1.0)
        door = action.removeprefix("open_")
        return Conditional(("tiger",), lambda where: -100.0 if where == door else 10.0)

    return Network(
        name="Tiger",
        description="Two doors, a tiger behind one of them",
        discount=0.95,
        variables=(Variable("tiger", ("left", "right")),),
        actions=("listen", "open_left", "open_right"),
        observations=("hear_left", "hear_right"),
        start={"tiger": {"left": 0.5, "right": 0.5}},
        transition=transition,
        observation=observation,
        reward=reward,
    )
