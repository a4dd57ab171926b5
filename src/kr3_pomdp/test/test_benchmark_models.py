"""The generated benchmark problems: published sizes, distributions, and what the writers write."""

import importlib
import io
import itertools
import math
import sys
from pathlib import Path

import pytest

BENCH = Path(__file__).resolve().parents[1] / "bench"


@pytest.fixture(scope="module", autouse=True)
def bench_on_path():
    sys.path.insert(0, str(BENCH))
    yield
    sys.path.remove(str(BENCH))


def module(name):
    return importlib.import_module(name)


def text(network, kind):
    out = io.StringIO()
    module(f"benchmark_models.{kind}_file").write(network, out)
    return out.getvalue()


SMALL = [
    "Tiger.pomdp",
    "4x3.95.pomdp",
    "RockSample_4_4.pomdp",
    "tiger-grid.pomdp",
    "Hallway.pomdp",
    "Hallway2.pomdp",
    "RoomSearch_4.pomdp",
    "RoomSearch_9.pomdp",
]


@pytest.mark.parametrize("file", [*SMALL, "TagAvoid.pomdp", "RockSample_5_5.pomdp"])
def test_flat_problems_have_the_published_sizes(file):
    problem = module("benchmark_models.catalogue").PROBLEMS[file]
    network = problem.build()
    sizes = (len(network.flat_names()), len(network.actions), len(network.observations))
    assert sizes == problem.sizes


@pytest.mark.parametrize("file", ["RockSample_7_8.pomdpx", "RockSample_11_11.pomdpx"])
def test_factored_problems_have_the_published_sizes(file):
    problem = module("benchmark_models.catalogue").PROBLEMS[file]
    network = problem.build()
    states = math.prod(len(variable.values) for variable in network.variables)
    assert (states, len(network.actions), len(network.observations)) == problem.sizes


@pytest.mark.parametrize("file", SMALL)
def test_both_writers_accept_every_row(file):
    network = module("benchmark_models.catalogue").PROBLEMS[file].build()
    assert "discount: 0.9" in text(network, "flat")
    assert text(network, "network").endswith("</pomdpx>\n")


def test_tiger_is_written_as_published():
    lines = text(module("benchmark_models.tiger").tiger(), "flat").splitlines()
    assert "start: 0.5 0.5" in lines
    assert "T: listen identity" in lines
    assert "O: listen : left : hear_left 0.85" in lines
    assert "R: open_left : left : * : * -100" in lines
    assert "R: listen : * : * : * -1" in lines


def test_a_row_that_is_no_distribution_is_named():
    network_module = module("benchmark_models.network")
    with pytest.raises(ValueError, match="here: found probabilities that sum to 0.9"):
        network_module.check_distribution({"a": 0.9}, ("a",), "here")
    with pytest.raises(ValueError, match="here: unknown value 'b'"):
        network_module.check_distribution({"b": 1.0}, ("a",), "here")
    with pytest.raises(ValueError, match="here: found probability 1.5"):
        network_module.check_distribution({"a": 1.5, "b": -0.5}, ("a", "b"), "here")


def test_merged_states_that_differ_are_refused():
    tiger = module("benchmark_models.tiger").tiger()
    merged = type(tiger)(**{**vars(tiger), "merged": lambda state: "one"})
    with pytest.raises(ValueError, match="listen in one: merged states differ"):
        text(merged, "flat")


def replayed(entries, instance):
    """What a reader makes of the entries: the last one that fits."""
    found = None
    for pattern, value in entries:
        if all(p in ("*", v) for p, v in zip(pattern, instance)):
            found = value
    return found


@pytest.mark.parametrize("seed", range(20))
def test_compressed_tables_read_back_to_what_was_written(seed):
    import random

    rnd = random.Random(seed)
    domains = [tuple(f"v{i}" for i in range(rnd.randint(1, 4))) for _ in range(rnd.randint(0, 4))]
    values = {i: str(rnd.choice([0, 0, 0, 1, 2])) for i in itertools.product(*domains)}
    entries = module("benchmark_models.network_file").compress(domains, values.__getitem__)
    for instance, value in values.items():
        assert replayed(entries, instance) == value


def test_a_check_of_a_rock_tells_less_from_afar():
    rocks = module("benchmark_models.rock_sample")
    field = rocks.PUBLISHED[7, 8]
    assert rocks.accuracy(field, (2, 0), (2, 0)) == 1.0
    assert rocks.accuracy(field, (0, 0), (2, 0)) == pytest.approx(0.966516, abs=1e-6)
    assert rocks.accuracy(rocks.PUBLISHED[4, 4], (0, 0), (3, 1)) == pytest.approx(
        0.521165, abs=1e-6
    )


@pytest.mark.parametrize("size, rocks", [(3, 9), (0, 1), (3, 0)])
def test_impossible_fields_are_refused(size, rocks):
    with pytest.raises(ValueError, match="found"):
        module("benchmark_models.rock_sample").rock_sample(size, rocks)


def test_drawn_fields_repeat_with_their_seed():
    draw = module("benchmark_models.rock_sample").random_field
    assert draw(6, 5, 3) == draw(6, 5, 3)
    assert draw(6, 5, 3) != draw(6, 5, 4)


def test_the_target_flees_from_the_robot():
    network = module("benchmark_models.tag").tag()
    follows = network.transition("north", "target").of
    # In line at the left wall: what would lead into the walls stays.
    assert follows("r0", "t0") == pytest.approx({"t0": 0.6, "t1": 0.2, "t10": 0.2})
    assert follows("r0", "t15") == pytest.approx({"t15": 0.2, "t16": 0.4, "t20": 0.4})
    assert network.transition("tag", "target").of("r3", "t3") == {"tagged": 1.0}
    assert network.transition("tag", "target").of("r0", "t15") == {"t15": 1.0}


def test_a_step_ahead_in_the_maze_is_noisy():
    maze = module("benchmark_models.maze")
    network = maze.maze("Hallway", maze.MAPS["Hallway"])
    # The third cell, facing north: a wall ahead, open cells right, left and behind.
    followed = network.transition("forward", "pose").of("x2y0n")
    assert followed == pytest.approx(
        {"x2y0n": 0.85, "x3y0e": 0.05, "x1y0w": 0.05, "x2y1n": 0.025, "x2y1s": 0.025}
    )
    # The first cell, facing north: walls ahead, left and behind.
    seen = network.observation("stay").of("x0y0n")
    assert seen["walls_1011"] == pytest.approx(0.9**3 * 0.95)
    assert network.observation("stay").of("x2y0s") == {"landmark_a": 1.0}


@pytest.mark.parametrize("rows, message", [(("*?+",), "found '\\?'"), (("***",), "without a goal")])
def test_wrong_maps_are_refused(rows, message):
    with pytest.raises(ValueError, match=message):
        module("benchmark_models.maze").maze("wrong", rows)


@pytest.mark.parametrize("cells", [-4, 1, 5])
def test_rooms_are_square(cells):
    with pytest.raises(ValueError, match=f"found {cells} cells"):
        module("benchmark_models.room_search").room_search(cells)


def test_the_script_writes_a_file_and_refuses_other_endings(tmp_path, capsys):
    main = module("generate_model").main
    path = tmp_path / "room.pomdpx"
    assert main(["room_search", "4", "--output", str(path)]) == 0
    assert path.read_text().startswith("<?xml")
    assert main(["tiger", "--output", str(tmp_path / "tiger.txt")]) == 2
    assert "expected .pomdp or .pomdpx" in capsys.readouterr().err
    assert main(["room_search", "5"]) == 1
    assert "found 5 cells" in capsys.readouterr().err
