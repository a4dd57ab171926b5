"""Floor plans of made-up buildings: where rooms, corridors, doors and furniture are. Metres, world frame."""

import math
from dataclasses import dataclass, field

WALL_M = 0.1
DOOR_M = 1.0
CORRIDOR_M = 2.0
STUB_M = 0.3  # what an opening between two parts of one hall leaves of the wall on either side
ROOMS_PER_WING = 16
# Radius of the free floor that is asked for: passages are wider than the robot by a cell of its map on either side.
ROBOT_M = 0.42
RASTER_M = 0.1


@dataclass
class Place:
    """A room, a corridor or a zone of a hall; `rectangle` is (x0, y0, x1, y1)."""

    name: str
    rectangle: tuple
    furnished: bool = True


@dataclass
class Door:
    """An opening in the wall between two places."""

    between: tuple
    center: tuple
    width: float


@dataclass
class Furniture:
    """A closed box; `size` is depth, width, height; `pose` its centre and where its front faces."""

    name: str
    place: str
    size: tuple
    pose: tuple
    texture: str

    def distance(self, x, y):
        """From a point to the footprint, m; 0 inside."""
        dx, dy = x - self.pose[0], y - self.pose[1]
        c, s = math.cos(self.pose[2]), math.sin(self.pose[2])
        out_x = max(abs(c * dx + s * dy) - self.size[0] / 2, 0.0)
        out_y = max(abs(c * dy - s * dx) - self.size[1] / 2, 0.0)
        return math.hypot(out_x, out_y)

    def outline(self):
        """Points around the footprint, at most 0.1 m apart."""
        c, s = math.cos(self.pose[2]), math.sin(self.pose[2])
        along = math.ceil(self.size[0] / 0.1)
        across = math.ceil(self.size[1] / 0.1)
        local = [(i / along - 0.5, side) for i in range(along + 1) for side in (-0.5, 0.5)]
        local += [(side, j / across - 0.5) for j in range(across + 1) for side in (-0.5, 0.5)]
        for u, v in local:
            x, y = u * self.size[0], v * self.size[1]
            yield self.pose[0] + c * x - s * y, self.pose[1] + s * x + c * y

    def is_apart(self, other, gap=0.05):
        """Whether two pieces neither overlap nor nearly touch."""
        return all(other.distance(x, y) >= gap for x, y in self.outline()) and all(
            self.distance(x, y) >= gap for x, y in other.outline()
        )

    def before_front(self, distance, along=0.0):
        """The point at a distance before the front edge, `along` to the side of its middle."""
        c, s = math.cos(self.pose[2]), math.sin(self.pose[2])
        forward = self.size[0] / 2 + distance
        return (
            self.pose[0] + c * forward - s * along,
            self.pose[1] + s * forward + c * along,
        )


@dataclass
class Plan:
    """A building without its contents' looks."""

    places: list = field(default_factory=list)
    doors: list = field(default_factory=list)
    furniture: list = field(default_factory=list)

    def add(self, name, x0, y0, x1, y1, furnished=True):
        """One more place."""
        rectangle = tuple(round(v, 3) for v in (x0, y0, x1, y1))
        self.places.append(Place(name, rectangle, furnished))
        return self.places[-1]

    def join(self, a, b, width=None, at=0.5):
        """A door in the wall that two places share: `width`, or all but a stub on either side; `at` in 0 to 1."""
        (ax0, ay0, ax1, ay1), (bx0, by0, bx1, by1) = a.rectangle, b.rectangle
        x0, x1, y0, y1 = max(ax0, bx0), min(ax1, bx1), max(ay0, by0), min(ay1, by1)
        along_x = y1 - y0 < 1e-6
        low, high = (x0, x1) if along_x else (y0, y1)
        width = width or high - low - 2 * STUB_M
        margin = width / 2 + STUB_M
        middle = round(low + margin + at * (high - low - 2 * margin), 3)
        center = (middle, y0) if along_x else (x0, middle)
        self.doors.append(Door((a.name, b.name), center, round(width, 3)))


def touching(a, b):
    """Length of the wall that two places share, m."""
    (ax0, ay0, ax1, ay1), (bx0, by0, bx1, by1) = a.rectangle, b.rectangle
    dx, dy = min(ax1, bx1) - max(ax0, bx0), min(ay1, by1) - max(ay0, by0)
    return max(dx, dy) if min(abs(dx), abs(dy)) < 1e-6 and max(dx, dy) > 0 else 0.0


def shares(rng, total, count, spread=0.15):
    """Splits a length into `count` parts that differ by up to about `spread`; multiples of 5 cm but for the last."""
    weights = [1.0 + rng.uniform(-spread, spread) for _ in range(count)]
    parts = [round(20 * total * w / sum(weights)) / 20 for w in weights[:-1]]
    return parts + [round(total - sum(parts), 3)]


def row(plan, rng, names, corridor, start, length, low, high, along_x=True):
    """Rooms side by side from `start` over `length`, each with a door to the corridor."""
    for name, width in zip(names, shares(rng, length, len(names))):
        end = start + width
        box = (start, low, end, high) if along_x else (low, start, high, end)
        plan.join(plan.add(name, *box), corridor, DOOR_M, rng.uniform(0.1, 0.9))
        start = end


def wings(rng, names):
    """Straight corridors with rooms on both sides; above 16 rooms several, joined by a cross corridor."""
    plan = Plan()
    num_wings = math.ceil(len(names) / ROOMS_PER_WING)
    corridors = []
    y = 0.0
    for wing in range(num_wings):
        rooms = names[wing * len(names) // num_wings : (wing + 1) * len(names) // num_wings]
        south, north = rooms[: (len(rooms) + 1) // 2], rooms[(len(rooms) + 1) // 2 :]
        depth_south, depth_north = rng.choice([3.8, 4.0, 4.4]), rng.choice([3.6, 4.2])
        length = round(max(len(south), 1) * rng.choice([4.0, 4.2, 4.35]), 2)
        y0, y1 = y + depth_south, y + depth_south + CORRIDOR_M
        corridor = plan.add(f"corridor_{wing + 1}", 0.0, y0, length, y1, furnished=False)
        corridors.append(corridor)
        row(plan, rng, south, corridor, 0.0, length, y, y0)
        if north:
            row(plan, rng, north, corridor, 0.0, length, y1, y1 + depth_north)
        y = y1 + depth_north
    if num_wings > 1:
        cross = plan.add("cross_corridor", -CORRIDOR_M, 0.0, 0.0, y, furnished=False)
        for corridor in corridors:
            plan.join(cross, corridor)
    return plan


def ring(rng, names):
    """A corridor around a core of rooms, with rooms outside of it on all four sides."""
    if len(names) < 8:
        raise SystemExit("make_building.py: the ring layout needs at least 8 rooms")
    plan = Plan()
    columns = max(1, round((len(names) - 6) / 4))
    core, outer = names[: 2 * columns], names[2 * columns :]
    west, east, rest = outer[:2], outer[2:4], outer[4:]
    south, north = rest[: (len(rest) + 1) // 2], rest[(len(rest) + 1) // 2 :]
    w = CORRIDOR_M - 0.2
    width = round(max(4.6 * columns, 3.8 * len(south) - 2 * w), 2)
    height = 8.3
    parts = {
        "south": plan.add("corridor_south", -w, -w, width + w, 0.0, furnished=False),
        "north": plan.add("corridor_north", -w, height, width + w, height + w, furnished=False),
        "west": plan.add("corridor_west", -w, 0.0, 0.0, height, furnished=False),
        "east": plan.add("corridor_east", width, 0.0, width + w, height, furnished=False),
    }
    for side in ("west", "east"):
        plan.join(parts[side], parts["south"])
        plan.join(parts[side], parts["north"])
    row(plan, rng, core[:columns], parts["south"], 0.0, width, 0.0, 4.0)
    row(plan, rng, core[columns:], parts["north"], 0.0, width, 4.0, height)
    row(plan, rng, west, parts["west"], 0.0, height, -w - 4.2, -w, along_x=False)
    row(plan, rng, east, parts["east"], 0.0, height, width + w, width + w + 3.9, along_x=False)
    row(plan, rng, south, parts["south"], -w, width + 2 * w, -w - 4.4, -w)
    if north:
        row(plan, rng, north, parts["north"], -w, width + 2 * w, height + w, height + w + 3.8)
    return plan


def hall(rng, names):
    """One hall of zones with wide openings between them, and here and there a partition."""
    plan = Plan()
    rows = max(1, round(math.sqrt(len(names) * 0.8)))
    columns = math.ceil(len(names) / rows)
    width = columns * 5.4
    zones, y = [], 0.0
    for i in range(rows):
        zone_names = names[i * len(names) // rows : (i + 1) * len(names) // rows]
        top = y + rng.choice([4.6, 5.0, 5.5])
        x = 0.0
        for name, part in zip(zone_names, shares(rng, width, len(zone_names), 0.2)):
            zones.append(plan.add(name, x, y, x + part, top))
            x += part
        y = top
    joined = {id(zones[0])}
    borders = [(a, b) for i, a in enumerate(zones) for b in zones[:i] if touching(a, b) > 1.7]
    rng.shuffle(borders)
    later = []
    while borders:  # first a tree, so that every zone can be reached
        a, b = next(pair for pair in borders if len(joined & {id(pair[0]), id(pair[1])}) == 1)
        plan.join(a, b)
        joined |= {id(a), id(b)}
        borders.remove((a, b))
        inside = [pair for pair in borders if {id(pair[0]), id(pair[1])} <= joined]
        later += inside
        borders = [pair for pair in borders if pair not in inside]
    for a, b in later:
        if rng.random() < 0.7:
            plan.join(a, b)
    return plan


LAYOUTS = {"wings": wings, "ring": ring, "hall": hall}


def free_points(place, furniture):
    """Raster points of a place where the robot can stand, walls taken to be on every side."""
    x0, y0, x1, y1 = place.rectangle
    margin = ROBOT_M + WALL_M / 2
    points = set()
    for i in range(math.ceil((x0 + margin) / RASTER_M), math.floor((x1 - margin) / RASTER_M) + 1):
        for j in range(
            math.ceil((y0 + margin) / RASTER_M), math.floor((y1 - margin) / RASTER_M) + 1
        ):
            if all(f.distance(i * RASTER_M, j * RASTER_M) >= ROBOT_M for f in furniture):
                points.add((i, j))
    return points


def connected(points, start):
    """The points that can be reached from `start`."""
    reached, todo = {start}, [start]
    while todo:
        i, j = todo.pop()
        for point in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if point in points and point not in reached:
                reached.add(point)
                todo.append(point)
    return reached


def is_liveable(plan, place, furniture, others):
    """Whether pieces stand apart and the robot gets from every door to much of every quarter and to every front."""
    for i, piece in enumerate(furniture):
        if not all(piece.is_apart(other) for other in furniture[:i] + others):
            return False
    points = free_points(place, furniture)
    if not points:
        return False
    reached = connected(points, min(points))
    x0, y0, x1, y1 = place.rectangle

    def near(x, y, distance):
        return any(math.hypot(i * RASTER_M - x, j * RASTER_M - y) <= distance for i, j in reached)

    for door in plan.doors:
        if place.name not in door.between:
            continue
        x, y = door.center
        inwards = (
            {x0: 0.5, x1: -0.5}.get(x, 0.0) if y not in (y0, y1) else 0.0,
            {y0: 0.5, y1: -0.5}.get(y, 0.0),
        )
        way = [(x + k * inwards[0], y + k * inwards[1]) for k in (-1.0, -0.5, 0.0, 0.5, 1.0)]
        if any(f.distance(*point) < ROBOT_M for f in furniture + others for point in way):
            return False
        if not near(way[-1][0], way[-1][1], RASTER_M):
            return False
    for piece in furniture:
        for k in range(5):
            along = (k / 4 - 0.5) * (piece.size[1] - 0.2)
            x, y = piece.before_front(0.0, along)
            if not near(x, y, 0.6):
                return False
    for quarter in range(4):
        left, low = quarter % 2 * (x1 - x0) / 2 + x0, quarter // 2 * (y1 - y0) / 2 + y0
        right, top = left + (x1 - x0) / 2, low + (y1 - y0) / 2
        inside = [
            1 for i, j in reached if left <= i * RASTER_M <= right and low <= j * RASTER_M <= top
        ]
        if len(inside) * RASTER_M**2 < 0.4:
            return False
    return True


# kind: depth, width, height; the first ones are deep enough for everything
KINDS = {
    "desk": (0.7, 1.4, 0.45),
    "table": (0.6, 1.2, 0.40),
    "counter": (0.6, 1.9, 0.45),
    "sideboard": (0.5, 1.1, 0.36),
    "shelf": (0.4, 1.6, 0.45),
    "rack": (0.4, 1.2, 0.42),
}
DEEP = ("desk", "table", "counter", "sideboard")
WOODS = ("oak", "walnut", "birch", "steel", "stone")


def at_wall(rng, place, size):
    """A pose with the back against a wall drawn at random."""
    x0, y0, x1, y1 = place.rectangle
    depth, width, _ = size
    off = WALL_M / 2 + depth / 2
    side = rng.randrange(4)
    low, high = (x0, x1) if side % 2 == 0 else (y0, y1)
    room = high - low - width - WALL_M
    along = round(low + WALL_M / 2 + width / 2 + rng.random() * max(room, 0.0), 2)
    return [
        (along, round(y0 + off, 3), 1.5708),
        (round(x1 - off, 3), along, 3.14159),
        (along, round(y1 - off, 3), -1.5708),
        (round(x0 + off, 3), along, 0.0),
    ][side]


def on_floor(rng, place, size):
    """A pose somewhere on the floor, at any angle."""
    x0, y0, x1, y1 = place.rectangle
    margin = math.hypot(*size[:2]) / 2 + 0.2
    return (
        round(rng.uniform(x0 + margin, x1 - margin), 2),
        round(rng.uniform(y0 + margin, y1 - margin), 2),
        round(rng.uniform(-math.pi, math.pi), 3),
    )


def furnish(plan, rng, pieces, standing):
    """Puts `pieces` pieces into each furnished place; a share of `standing` stands free on the floor."""
    for place in plan.places:
        if place.furnished:
            plan.furniture += furnished(plan, rng, place, pieces, standing)


def furnished(plan, rng, place, pieces, standing, attempts=400):
    """Furniture of one place, drawn until the robot can live with it; fewer pieces when that does not come about."""
    x0, y0, x1, y1 = place.rectangle
    others = [
        f
        for f in plan.furniture
        if x0 - 2.0 <= f.pose[0] <= x1 + 2.0 and y0 - 2.0 <= f.pose[1] <= y1 + 2.0
    ]
    for attempt in range(attempts):
        furniture = []
        for i in range(max(1, pieces - attempt * pieces // attempts)):
            kind = rng.choice(DEEP if i == 0 else list(KINDS))
            depth, width, height = KINDS[kind]
            size = (depth, round(width * rng.uniform(0.85, 1.15), 2), height)
            pose = (on_floor if rng.random() < standing else at_wall)(rng, place, size)
            name = f"{place.name}_{kind}_{i + 1}"
            furniture.append(Furniture(name, place.name, size, pose, rng.choice(WOODS)))
        if is_liveable(plan, place, furniture, others):
            return furniture
    raise SystemExit(f"make_building.py: no way to furnish {place.name}: {place.rectangle}")
