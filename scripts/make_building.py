#!/usr/bin/python3
"""Writes a building with its contents, and a domain about it: all that ./kr3 map, train, learn and demo need.

    make_building.py domains/my_floor --rooms 15 [--layout wings|ring|hall] [--objects 12] [--seed 1]

Layouts: wings (corridors with rooms on both sides), ring (a corridor around a core, rooms on all sides), hall (zones
of one hall with wide openings). Every room is furnished so that the robot gets into each of its quarters and to every
front.
Objects of a class look different from one another. With --looks the objects are those of another folder.
The same arguments write the same files. What is not written: map.bt (./kr3 map NAME) and perception.yml.gz
(./kr3 train NAME; with --looks a link to that of the other domain does).
"""

import argparse
import importlib.util
import math
import os
import pathlib
import random
from typing import Dict, List

import building_layout as layout

ROOT = pathlib.Path(__file__).resolve().parent.parent
OFFICE = ROOT / "domains" / "office"

ESSENTIAL = ("library", "library", "study", "kitchen", "office")
FURTHER = ("office", "lab", "meeting", "office", "workshop", "lounge", "lab", "store", "copy_room")
# class: share of the objects, kinds of rooms where its objects usually are
CLASSES = {
    "textbook": (0.4, ("library",)),
    "printer": (0.2, ("office", "copy_room", "lab")),
    "mug": (0.25, ("kitchen", "lounge")),
    "pot": (0.15, ("kitchen",)),
}
WORDS = (
    "LOGIC ROBOTICS ALGEBRA GENETICS OPTICS HISTORY MUSIC STATICS BOTANY GEOLOGY SONNETS TOPOLOGY FRACTALS NEURONS "
    "PLANETS GAMES MARKETS CIRCUITS POLYMERS GLACIERS"
).split()
STYLES = ("triangles", "circles", "molecules", "squares")
MAX_OBJECTS_PER_ROOM = 5
CLEARANCE_M = 0.5  # around the robot's start


def room_names(count):
    """`count` names, kinds of rooms numbered."""
    kinds = [
        ESSENTIAL[i] if i < len(ESSENTIAL) else FURTHER[(i - len(ESSENTIAL)) % len(FURTHER)]
        for i in range(count)
    ]
    seen: Dict[str, int] = {}
    names = []
    for kind in kinds:
        seen[kind] = seen.get(kind, 0) + 1
        names.append(f"{kind}_{seen[kind]}")
    return names


def kind_of(name):
    """The kind of a room from its name."""
    return name.rsplit("_", 1)[0]


def object_names(count):
    """`count` pairs (name, class)."""
    numbers = {
        name: max(1 if count < 8 else 2, int(share * count)) for name, (share, _) in CLASSES.items()
    }
    numbers["textbook"] += count - sum(numbers.values())
    return [(f"{name}_{i + 1}", name) for name, number in numbers.items() for i in range(number)]


def office_artist():
    """The module that draws the textures of the office."""
    spec = importlib.util.spec_from_file_location(
        "make_textures", OFFICE / "textures" / "make_textures.py"
    )
    assert spec is not None and spec.loader is not None, "a path that ends with .py has a loader"
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def look(artist, rng, index, name, class_name):
    """A texture of one object: hue, words and pattern of its own."""

    def colour(hue, saturation, value):
        sector = hue * 6.0
        parts = [abs((sector + shift) % 6.0 - 3.0) - 1.0 for shift in (4.0, 2.0, 0.0)]
        return tuple(
            int(255 * value * (1 - saturation * (1 - min(max(p, 0.0), 1.0)))) for p in parts
        )

    hue = index * 0.381966 % 1.0  # the golden angle: neighbours in the list differ most
    word = WORDS[index % len(WORDS)]
    style = STYLES[index % len(STYLES)]
    font = artist.FONTS[(index // len(STYLES) + index) % len(artist.FONTS)]
    if class_name == "textbook":
        cover = colour(hue, rng.uniform(0.6, 0.9), rng.uniform(0.5, 0.8))
        return artist.book(name, cover, word, rng.choice(WORDS).lower(), style, font)
    if class_name == "printer":
        case = colour(hue, rng.uniform(0.05, 0.35), rng.uniform(0.45, 0.9))
        return artist.printer(
            name, case, word, colour(hue + 0.5, 0.9, 0.5), rng.choice([96, 112, 128])
        )
    glaze = colour(hue, rng.uniform(0.3, 0.8), rng.uniform(0.6, 0.95))
    return artist.vessel(name, glaze, colour(hue + 0.45, 0.9, 0.45), word, style)


def write_textures(folder, objects, seed):
    """The objects' pictures, and floor and wall of this building, as small PNGs."""
    import cv2  # here: who takes the looks of another folder needs no OpenCV
    import numpy as np

    artist = office_artist()
    rng = random.Random(f"looks {seed}")
    folder.mkdir(parents=True, exist_ok=True)
    for index, (name, class_name) in enumerate(objects):
        picture = look(artist, rng, index, name, class_name)
        half = cv2.resize(picture, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
        write_png(cv2, folder / f"{name}.png", np.clip(half, 0, 255).astype(np.uint8))


def write_surfaces(folder, seed):
    """Floor and wall of this building."""
    import cv2
    import numpy as np

    artist = office_artist()
    rng = random.Random(f"surfaces {seed}")
    folder.mkdir(parents=True, exist_ok=True)
    grey = [rng.randrange(125, 185) + rng.randrange(-12, 12) for _ in range(3)]
    light = [rng.randrange(195, 225) + rng.randrange(-15, 12) for _ in range(3)]
    pictures = {
        "floor": artist.speckle(f"floor {seed}", grey, 16, 5, rng.choice([1, 2, 4])),
        "wall": artist.speckle(f"wall {seed}", light, 6, 5, 0),
    }
    for name, picture in pictures.items():
        write_png(cv2, folder / f"{name}.png", np.clip(picture, 0, 255).astype(np.uint8))


def write_png(cv2, path, picture):
    """@throws OSError  the file cannot be written"""
    if not cv2.imwrite(str(path), picture, [cv2.IMWRITE_PNG_COMPRESSION, 9]):
        raise OSError(f"cannot write {path}")


def objects_text(objects, rng, textures):
    """objects.yaml."""
    sizes = {
        "textbook": lambda: ("box", (rng.uniform(0.05, 0.07), rng.uniform(0.18, 0.22), rng.uniform(0.24, 0.29)), 0.8),
        "printer": lambda: ("box", (0.26, rng.uniform(0.30, 0.34), rng.uniform(0.19, 0.23)), 2.0),
        "mug": lambda: ("cylinder", (rng.uniform(0.10, 0.12), rng.uniform(0.12, 0.14)), 0.3),
        "pot": lambda: ("cylinder", (rng.uniform(0.20, 0.23), rng.uniform(0.16, 0.19)), 0.9),
    }  # fmt: skip
    lines = ["# Written by scripts/make_building.py.", "objects:"]
    for name, class_name in objects:
        shape, size, mass = sizes[class_name]()
        size_text = ", ".join(f"{v:.3g}" for v in size)
        lines.append(
            f"  - {{name: {name}, class: {class_name}, shape: {shape}, size: [{size_text}], mass: {mass}, "
            f"texture: {textures}/{name}.png}}"
        )
    return "\n".join(lines) + "\n"


def assigned(rng, plan, objects):
    """[(object, place)]: most where their class usually is, the others anywhere, not too many in one room."""
    rooms = [place.name for place in plan.places if place.furnished]
    load = {name: 0 for name in rooms}
    result = []
    for name, class_name in objects:
        usual = [room for room in rooms if kind_of(room) in CLASSES[class_name][1]]
        choice = usual if usual and rng.random() < 0.8 else rooms
        free = [r for r in choice if load[r] < MAX_OBJECTS_PER_ROOM]
        free = free or [r for r in rooms if load[r] < MAX_OBJECTS_PER_ROOM]
        if not free:
            raise SystemExit(
                f"make_building.py: {len(objects)} objects are too many for {len(rooms)} rooms"
            )
        room = rng.choice(free)
        load[room] += 1
        result.append((name, room))
    return result


def start_pose(plan, place):
    """The free point nearest to the middle of a place, looking along +x."""
    x0, y0, x1, y1 = place.rectangle
    furniture = [f for f in plan.furniture if f.place == place.name]
    x, y = min(
        (
            (i * layout.RASTER_M, j * layout.RASTER_M)
            for i, j in layout.free_points(place, furniture)
        ),
        key=lambda p: math.hypot(p[0] - (x0 + x1) / 2, p[1] - (y0 + y1) / 2),
    )
    return f"[{x:.2f}, {y:.2f}, 0.0]"


def building_text(args, plan, assignment, tiles):
    """building.yaml."""

    def numbers(values):
        return "[" + ", ".join(f"{v:g}" for v in values) + "]"

    lines = [
        f"# {len([p for p in plan.places if p.furnished])} rooms, layout {args.layout}, seed {args.seed}; "
        "written by scripts/make_building.py. Metres, world frame.",
        f"name: {args.out.name}",
        "walls: {height: 2.0, thickness: 0.1, texture: textures/wall.png}",
        "floor: {texture: textures/floor.png}",
        "places:",
    ]
    lines += [f"  - {{name: {p.name}, rectangle: {numbers(p.rectangle)}}}" for p in plan.places]
    lines.append("doors:")
    lines += [
        f"  - {{between: [{', '.join(d.between)}], center: {numbers(d.center)}, width: {d.width:g}}}"
        for d in plan.doors
    ]
    lines.append("furniture:")
    lines += [
        f"  - {{name: {f.name}, place: {f.place}, size: {numbers(f.size)}, pose: {numbers(f.pose)}, "
        f"texture: {tiles}/{f.texture}.png}}"
        for f in plan.furniture
    ]
    start = next(p for p in plan.places if p.name == "office_1")
    lines += [f"robot: {{start: {start_pose(plan, start)}}}", "objects:"]
    lines += [f"  - {{name: {name}, place: {place}}}" for name, place in assignment]
    return "\n".join(lines) + "\n"


def chain(variable, class_name, prefix, places):
    """Defaults: the first place, if it is not there the second, and so on."""
    text = ""
    for i, place in enumerate(places):
        body = "".join(f", loc({variable}) != {p}" for p in places[:i])
        text += f"  {prefix}{i + 1}({variable}): loc({variable}) = {place} if {class_name}({variable}){body}.\n"
    return text


def usual_chain(plan, class_name, length):
    """The rooms of a class's defaults, in order."""
    kinds = CLASSES[class_name][1]
    rooms = [p.name for p in plan.places if p.furnished]
    usual = sorted(
        (r for r in rooms if kind_of(r) in kinds), key=lambda r: (kinds.index(kind_of(r)), r)
    )
    return usual[:length]


def domain_text(office, plan, objects):
    """domain.kr3: the office's laws on this building's places and objects."""
    by_class: Dict[str, List[str]] = {}
    for name, class_name in objects:
        by_class.setdefault(class_name, []).append(name)
    classes = "".join(f"  {c} = {{{', '.join(names)}}}.\n" for c, names in by_class.items())
    books = usual_chain(plan, "textbook", 2) + ["office_1"]
    defaults = chain("X", "textbook", "d", books)
    for class_name in by_class.keys() - {"textbook"}:
        places = usual_chain(plan, class_name, 2)
        defaults += chain("X", class_name, class_name, places) if places else ""
    defaults = "".join(sorted(defaults.splitlines(keepends=True)))
    laws = office[office.index("fluents") : office.index("defaults")]
    return (
        "% Things are brought from room to room, as in the office; written by scripts/make_building.py.\n\n"
        f"sorts\n  place = {{{', '.join(p.name for p in plan.places)}}}.\n  robot = {{rob1}}.\n{classes}"
        f"  object = {' + '.join(by_class)}.\n  thing = robot + object.\n\n{laws}defaults\n{defaults}"
    )


def scenario_text(plan, objects):
    """scenario.yaml: textbook_1 is to be brought to the study; it is not in the room of the first default."""
    places = usual_chain(plan, "textbook", 2) + ["office_1"]
    records = '  - {kind: init, statement: "loc(rob1) = office_1", value: true}\n'
    for name, _ in objects:
        records += f'  - {{kind: init, statement: "in_hand(rob1, {name})", value: false}}\n'
    return (
        f'initial_records:\n{records}\ngoal: "loc(textbook_1) = study_1 and not in_hand(rob1, textbook_1)"\n\n'
        f"target:\n  object: textbook_1\n  at: {places[1]}\n  goal_place: study_1\n"
        f"  may_be_at: [{', '.join(places)}]\n\nplacements: {{}}\n"
    )


def parse_args():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("out", type=pathlib.Path, help="directory, made if there is none")
    parser.add_argument("--rooms", type=int, required=True, help="at least 5")
    parser.add_argument("--layout", choices=sorted(layout.LAYOUTS), default="wings")
    parser.add_argument("--objects", type=int, default=12, help="at least 4")
    parser.add_argument("--furniture", type=int, default=3, help="pieces a room, at most")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--looks", type=pathlib.Path, help="folder whose objects.yaml and textures are used again"
    )
    args = parser.parse_args()
    if args.rooms < 5 or args.objects < 4 or args.furniture < 1:
        parser.error("at least 5 rooms, 4 objects and 1 piece of furniture a room")
    return args


def main():
    args = parse_args()
    out = args.out = args.out.resolve()
    rng = random.Random(f"{args.layout} {args.rooms} {args.seed}")
    names = room_names(args.rooms)
    rng.shuffle(names)
    plan = layout.LAYOUTS[args.layout](rng, names)
    layout.furnish(plan, rng, args.furniture, 0.7 if args.layout == "hall" else 0.1)
    objects = object_names(args.objects)
    textures = "textures"
    write_surfaces(out / "textures", args.seed)
    if args.looks:
        textures = os.path.relpath(args.looks.resolve() / "textures", out)
        looks_seed = "of " + args.looks.resolve().name
    else:
        looks_seed = "of " + out.name
        write_textures(out / "textures", objects, looks_seed)
    assignment = assigned(rng, plan, objects)
    tiles = os.path.relpath(OFFICE / "textures", out)

    def office(name):
        return (OFFICE / name).read_text(encoding="utf-8")

    files = {
        "building.yaml": building_text(args, plan, assignment, tiles),
        "objects.yaml": objects_text(objects, random.Random(f"sizes {looks_seed}"), textures),
        "domain.kr3": domain_text(office("domain.kr3"), plan, objects),
        "refinement.kr3": office("refinement.kr3"),
        "models.yaml": office("models.yaml"),
        "bindings.yaml": office("bindings.yaml"),
        "learning.yaml": office("learning.yaml"),
        "scenario.yaml": scenario_text(plan, objects),
    }
    for name, text in files.items():
        (out / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
