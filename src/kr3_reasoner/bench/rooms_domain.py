#!/usr/bin/python3
"""Generate the rooms x objects benchmark: a domain of the paper's kind, and histories for it.

Run as a tool, it writes `domain.kr3` and `history.kr3`; the benchmark imports it.
"""

import argparse
import pathlib
from dataclasses import dataclass

DEFAULT_PLACES = ("main_library", "aux_library", "office")


@dataclass(frozen=True)
class Size:
    """How large a domain is.

    rooms: number of places, at least 5 (the three of the defaults, the goal and one more)
    objects: number of textbooks, at least 1
    """

    rooms: int
    objects: int

    def __post_init__(self) -> None:
        if self.rooms < 5 or self.objects < 1:
            raise ValueError(
                f"found {self.rooms} rooms and {self.objects} objects, expected at least 5 and 1"
            )

    def __str__(self) -> str:
        return f"{self.rooms} x {self.objects}"

    @property
    def places(self) -> list[str]:
        """The three places of the defaults first, the robot's (`study`) and the goal's (`corner`) next."""
        return [*DEFAULT_PLACES, "study", "corner"] + [f"room{i}" for i in range(6, self.rooms + 1)]

    @property
    def books(self) -> list[str]:
        return [f"tb{i}" for i in range(1, self.objects + 1)]


GOAL = "loc(tb1) = corner and not in_hand(rob1, tb1)"
PARCEL_GOAL = "loc(parcel) = corner and not in_hand(rob1, parcel)"

AXIOMS = """
fluents
  inertial loc(thing) : place.
  inertial in_hand(robot, object).

actions
  move(robot, place).
  grasp(robot, object).
  putdown(robot, object).
{exogenous_actions}
axioms
  move(R, P) causes loc(R) = P.
  grasp(R, O) causes in_hand(R, O).
  putdown(R, O) causes -in_hand(R, O).
  loc(O) = P if loc(R) = P, in_hand(R, O).
  impossible move(R, P) if loc(R) = P.
  impossible A1, A2 if A1 != A2.
  impossible grasp(R, O) if loc(R) = P1, loc(O) = P2, P1 != P2.
  impossible grasp(R, O) if in_hand(R, O).
  impossible putdown(R, O) if -in_hand(R, O).
{exogenous_axioms}
defaults
  d1(X): loc(X) = main_library if textbook(X).
  d2(X): loc(X) = aux_library if textbook(X), loc(X) != main_library.
  d3(X): loc(X) = office if textbook(X), loc(X) != main_library, loc(X) != aux_library.
"""

EXOGENOUS_AXIOMS = """
  exo_move(O, P) causes loc(O) = P.
  impossible exo_move(O, P) if loc(O) = P.
  impossible exo_move(O, P) if in_hand(R, O).
"""


def domain(size: Size, exogenous: bool = False) -> str:
    """The description: one robot, textbooks with the defaults d1 to d3, and a parcel with none."""
    sorts = (
        f"sorts\n  place = {{{', '.join(size.places)}}}.\n  robot = {{rob1}}.\n"
        f"  textbook = {{{', '.join(size.books)}}}.\n  object = textbook + {{parcel}}.\n"
        "  thing = robot + object.\n"
    )
    return sorts + AXIOMS.format(
        exogenous_actions="  exogenous exo_move(object, place).\n" if exogenous else "",
        exogenous_axioms=EXOGENOUS_AXIOMS if exogenous else "",
    )


def start(size: Size) -> str:
    """The robot is in the study and holds nothing; only the defaults say where the books are.

    The parcel may be anywhere.
    """
    hands = "\n".join(f"init(in_hand(rob1, {book}), false)." for book in [*size.books, "parcel"])
    return f"init(loc(rob1) = study, true).\n{hands}\n"


def surprises(size: Size, steps: int, surprised: int) -> str:
    """A history in which the robot walks, and finds `surprised` books missing from where they should be.

    The books differ, so each surprise needs an exception of its own. Evenly spread over `steps` moves.
    """
    if surprised > min(steps, size.objects):
        raise ValueError(f"found {surprised} surprises, expected at most one a step and one a book")
    lines = [start(size)]
    route = [size.places[i] for i in (0, 3, 4)]
    where = "study"
    for step in range(steps):
        where = next(place for place in route[step % 3 :] + route if place != where)
        lines.append(f"hpd(move(rob1, {where}), {step}).")
        lines.append(f"obs(loc(rob1) = {where}, true, {step + 1}).")
    for i in range(surprised):
        step = 1 + i * steps // surprised
        lines.append(f"obs(loc({size.books[i]}) = main_library, false, {step}).")
    return "\n".join(lines) + "\n"


def moved(size: Size) -> str:
    """A book was seen in the office; later it is not there. Only an exogenous action explains it.

    Another book is missing from where its default puts it, which an exception explains.
    """
    return start(size) + (
        "obs(loc(tb1) = office, true, 0).\n"
        "hpd(move(rob1, main_library), 0).\n"
        "obs(loc(tb2) = main_library, false, 1).\n"
        "hpd(move(rob1, office), 1).\n"
        "obs(loc(tb1) = office, false, 2).\n"
    )


def open_places(size: Size) -> str:
    """The parcel is not where the robot is: one hypothesis for each other place."""
    return start(size) + "obs(loc(parcel) = study, false, 0).\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rooms", type=int)
    parser.add_argument("objects", type=int)
    parser.add_argument(
        "--history", choices=["start", "surprises", "moved", "open"], default="start"
    )
    parser.add_argument("--steps", type=int, default=80, help="moves in the history of surprises")
    parser.add_argument("--surprises", type=int, default=19)
    parser.add_argument(
        "--output", type=pathlib.Path, default=pathlib.Path("."), help="an existing folder"
    )
    args = parser.parse_args()
    size = Size(args.rooms, args.objects)
    history = {
        "start": lambda: start(size),
        "surprises": lambda: surprises(size, args.steps, args.surprises),
        "moved": lambda: moved(size),
        "open": lambda: open_places(size),
    }[args.history]()
    (args.output / "domain.kr3").write_text(domain(size, exogenous=args.history == "moved"))
    (args.output / "history.kr3").write_text(history)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
