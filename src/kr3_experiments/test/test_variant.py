"""Other missions in the same building: the goal and the robot's start change together with what the robot knows."""
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from kr3_experiments.domain import load_domain
from kr3_experiments.errors import Kr3Error
from kr3_experiments.variant import furnished_places, with_goal_place, with_start

ROOT = Path(__file__).resolve().parents[3]
DOMAINS = sorted(file.parent.name for file in (ROOT / "domains").glob("*/building.yaml"))


@pytest.fixture(params=DOMAINS)
def domain(request):
    return load_domain(request.param, ROOT)


def test_the_goal_names_the_new_place_only(domain):
    old = domain.target.goal_place
    for place in domain.places:
        changed = with_goal_place(domain, place)
        assert changed.target.goal_place == place
        assert changed.target_fluent() == domain.target_fluent()
        assert with_goal_place(changed, old) == domain


def test_the_robot_starts_in_the_place_and_knows_it(domain):
    for place, area in domain.places.items():
        for seed in range(3):
            changed = with_start(domain, place, seed)
            assert area.contains(*changed.robot_start[:2])
            told = [str(record["statement"]) for record in changed.initial_records]
            before = [str(record["statement"]) for record in domain.initial_records]
            new = set(told) - set(before)
            assert all(statement.endswith(f"= {place}") for statement in new)
            assert len(told) == len(before)
            assert changed == with_start(domain, place, seed)


def test_free_floor_is_clear_of_furniture(domain):
    """Of a box that is turned by a multiple of a right angle, as all are, the border is easily told."""
    building = yaml.safe_load((domain.folder / "building.yaml").read_text(encoding="utf-8"))
    robot_radius = 0.3
    for place in domain.places:
        x, y, _ = with_start(domain, place, 5).robot_start
        for item in building.get("furniture") or []:
            turned = abs(round(item["pose"][2] / 1.5708)) % 2 == 1
            length, width = item["size"][:2]
            half_x, half_y = (width / 2, length / 2) if turned else (length / 2, width / 2)
            apart_x = abs(x - item["pose"][0]) - half_x
            apart_y = abs(y - item["pose"][1]) - half_y
            assert max(apart_x, apart_y) > robot_radius, item["name"]


def test_objects_lie_where_there_is_furniture(domain):
    assert domain.target.goal_place in furnished_places(domain)


def test_unknown_places_are_refused_with_the_known_ones(domain):
    for change in (with_goal_place, lambda of, place: with_start(of, place, 1)):
        with pytest.raises(
            Kr3Error, match="'attic' is no place of the domain(.|\n)*" + domain.target.at
        ):
            change(domain, "attic")


def test_a_start_that_no_record_tells_is_refused(domain):
    silent = replace(domain, initial_records=[])
    with pytest.raises(Kr3Error, match="scenario.yaml: 0 of 'initial_records'(.|\n)*expected one"):
        with_start(silent, domain.target.at, 1)


def test_a_place_without_free_floor_is_refused(tmp_path, domain):
    folder = tmp_path / "domain"
    shutil.copytree(domain.folder, folder, ignore=shutil.ignore_patterns("textures"))
    building = yaml.safe_load((folder / "building.yaml").read_text(encoding="utf-8"))
    area = domain.places[domain.target.at]
    middle = [(area.x_min + area.x_max) / 2, (area.y_min + area.y_max) / 2, 0.0]
    size = [area.x_max - area.x_min, area.y_max - area.y_min, 0.4]
    building.setdefault("furniture", []).append(
        {"name": "block", "place": domain.target.at, "size": size, "pose": middle}
    )
    (folder / "building.yaml").write_text(yaml.safe_dump(building), encoding="utf-8")
    with pytest.raises(Kr3Error, match="building.yaml: no free floor for the robot in"):
        with_start(replace(domain, folder=folder), domain.target.at, 1)


def test_malformed_furniture_is_refused(tmp_path, domain):
    (tmp_path / "building.yaml").write_text("furniture: [{name: desk}]\n", encoding="utf-8")
    with pytest.raises(Kr3Error, match="building.yaml: every entry of 'furniture' needs 'place'"):
        furnished_places(replace(domain, folder=tmp_path))
