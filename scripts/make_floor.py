#!/usr/bin/python3
"""Writes the files of a floor of rooms, for experiments: the world of domains/office with N rooms.

    make_floor.py OUT --rooms 10 [--cells 4] [--layout line|grid] [--objects 1] [--defaults 3] [--noise 1]
                  [--exact] [--models FILE]

The rooms r1, r2, ... stand in a line or in a square grid; a room's cells are a square grid, 2 m apart, and what
is beside another cell, across rooms too, is its neighbour. The robot starts in r1 and is to bring book b1 to the last
room. Defaults say that books are in r2, if not there in r3, and so on. With --exact nothing ever goes wrong: drives end
where they should, looking and grasping never fail.
"""

import argparse
import math
import pathlib

import yaml

PITCH_M = 2.0


def cells_of_room(room, num_rooms, num_cells, layout):
    """Coordinates (x, y) in m of a room's cells; room counts from 0."""
    side = math.ceil(math.sqrt(num_cells))
    columns = num_rooms if layout == "line" else math.ceil(math.sqrt(num_rooms))
    left = (room % columns) * side
    bottom = (room // columns) * side
    return [((left + i % side) * PITCH_M, (bottom + i // side) * PITCH_M) for i in range(num_cells)]


def map_text(args):
    components, places = [], []
    for room in range(args.rooms):
        for i, place in enumerate(cells_of_room(room, args.rooms, args.cells, args.layout)):
            components.append((f"r{room + 1}_c{i}", f"r{room + 1}"))
            places.append(place)

    lines = ["components:"]
    lines += [
        f"  - {{name: {name}, part_of: {room}, at: [{x:g}, {y:g}]}}"
        for (name, room), (x, y) in zip(components, places)
    ]
    lines += ["", "neighbors:"]
    beside = [
        (i, j)
        for i in range(len(places))
        for j in range(i)
        if math.dist(places[i], places[j]) <= PITCH_M
    ]
    lines += [f"  - [{components[j][0]}, {components[i][0]}]" for i, j in beside]
    return "\n".join(lines) + "\n"


def domain_text(office, args):
    rooms = ", ".join(f"r{i + 1}" for i in range(args.rooms))
    books = ", ".join(f"b{i + 1}" for i in range(args.objects))
    sorts = (
        f"sorts\n  place = {{{rooms}}}.\n  robot = {{rob1}}.\n  textbook = {{{books}}}.\n"
        "  object = textbook.\n  thing = robot + object.\n\n"
    )
    laws = office[office.index("fluents") : office.index("defaults")]
    defaults = ""
    for i in range(min(args.defaults, args.rooms - 1)):
        body = "".join(f", loc(X) != r{j + 2}" for j in range(i))
        defaults += f"  d{i + 1}(X): loc(X) = r{i + 2} if textbook(X){body}.\n"
    return (
        "% A floor for experiments, written by make_floor.py.\n\n"
        + sorts
        + laws
        + ("defaults\n" + defaults if defaults else "")
    )


def models_text(office, noise):
    """The office's numbers with every rate of errors multiplied: of outcomes but the likeliest, of sensors."""
    if noise == 1:
        return office
    models = yaml.safe_load(office)
    for action in models["actions"].values():
        outcomes = action.get("outcomes")
        if outcomes:
            probabilities = outcomes["probabilities"]
            likeliest = max(probabilities, key=probabilities.get)
            for label in probabilities:
                if label != likeliest:
                    probabilities[label] *= noise
            rest = sum(share for label, share in probabilities.items() if label != likeliest)
            probabilities[likeliest] = 1.0 - rest
            outcomes.pop("counts", None)
            outcomes.pop("prior", None)
            outcomes["source"] = "hand-written"
        for name, sensor in action.get("observations", {}).items():
            if sensor == "exact":
                continue
            changed = {"true_positive": 1.0 - noise * (1.0 - sensor["true_positive"])}
            if "false_positive" in sensor:
                changed["false_positive"] = noise * sensor["false_positive"]
            action["observations"][name] = {**changed, "source": "hand-written"}
    return yaml.safe_dump(models, sort_keys=False)


def scenario_text(args):
    records = '  - {kind: init, statement: "loc(rob1) = r1", value: true}\n'
    for i in range(args.objects):
        records += f'  - {{kind: init, statement: "in_hand(rob1, b{i + 1})", value: false}}\n'
    goal = f"loc(b1) = r{args.rooms} and not in_hand(rob1, b1)"
    return f'initial_records:\n{records}\ngoal: "{goal}"\n\ntarget:\n  object: b1\n'


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("out", type=pathlib.Path, help="directory, made if there is none")
    parser.add_argument("--rooms", type=int, required=True)
    parser.add_argument("--cells", type=int, default=4, help="of each room")
    parser.add_argument("--layout", choices=("line", "grid"), default="grid")
    parser.add_argument("--objects", type=int, default=1)
    parser.add_argument("--defaults", type=int, default=3, help="length of the chain")
    parser.add_argument("--noise", type=float, default=1.0, help="times the rates of all errors")
    parser.add_argument("--exact", action="store_true", help="without noise")
    parser.add_argument(
        "--models", default="models.yaml", help="file of the office with the numbers (models.yaml)"
    )
    parser.add_argument(
        "--office",
        type=pathlib.Path,
        default=pathlib.Path(__file__).resolve().parent.parent / "domains" / "office",
        help="directory with the laws",
    )
    args = parser.parse_args()
    if args.rooms < 2 or args.cells < 1 or args.objects < 1 or args.defaults < 0 or args.noise < 0:
        parser.error("at least two rooms, a cell each, an object, and no negative noise")
    args.out.mkdir(parents=True, exist_ok=True)

    def office(name):
        return (args.office / name).read_text(encoding="utf-8")

    files = {
        "domain.kr3": domain_text(office("domain.kr3"), args),
        "refinement.kr3": office("refinement.kr3"),
        "models.yaml": models_text(office(args.models), 0.0 if args.exact else args.noise),
        "bindings.yaml": office("bindings.yaml"),
        "map.yaml": map_text(args),
        "scenario.yaml": scenario_text(args),
    }
    for name, text in files.items():
        (args.out / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
