"""Domains are read with the checks that bring-up relies on; the final check knows a fetched object."""
import re
import shutil
from pathlib import Path

import pytest

from kr3_experiments.domain import load_domain
from kr3_experiments.errors import Kr3Error
from kr3_experiments.ground_truth import check_fetched

ROOT = Path(__file__).resolve().parents[3]
# Others have no building: their missions run in the abstract simulator only.
DOMAINS = sorted(file.parent.name for file in (ROOT / "domains").glob("*/building.yaml"))


@pytest.fixture(params=DOMAINS)
def domain(request):
    return load_domain(request.param, ROOT)


@pytest.fixture
def copied(tmp_path):
    """A copy of the first domain that a test may spoil."""
    shutil.copytree(ROOT / "domains" / DOMAINS[0], tmp_path / "domains" / "copy")
    return tmp_path


def test_every_domain_has_a_scenario_that_fits_its_building(domain):
    assert domain.initial_records
    assert domain.target.at in domain.target.may_be_at
    assert domain.target.goal_place not in domain.target.may_be_at
    assert any(area.contains(*domain.robot_start[:2]) for area in domain.places.values())


def test_placements_name_the_target(domain):
    for place in domain.target.may_be_at:
        assert f"{domain.target.object}={place}" in domain.placements_with_target(place)


def test_an_unknown_place_is_refused_with_the_known_ones(domain):
    with pytest.raises(Kr3Error, match="'nowhere' is no place(.|\n)*" + domain.target.at):
        domain.placements_with_target("nowhere")


def test_an_unknown_domain_is_refused_with_the_known_ones():
    with pytest.raises(Kr3Error, match="no domain 'moon'; there are .*" + DOMAINS[0]):
        load_domain("moon", ROOT)


def test_a_domain_may_lie_outside_the_repository(copied):
    found = load_domain(str(copied / "domains" / "copy"), ROOT)
    assert found.name == "copy"
    assert found.map_file == copied / "domains" / "copy" / "map.bt"


def test_an_unknown_folder_is_refused():
    with pytest.raises(Kr3Error, match="there is no folder './moon'"):
        load_domain("./moon", ROOT)


def test_a_missing_map_says_how_to_build_it(copied):
    (copied / "domains" / "copy" / "map.bt").unlink(missing_ok=True)
    with pytest.raises(Kr3Error, match="there is no map .*map.bt: build it with ./kr3 map copy"):
        load_domain("copy", copied).require_map()


def test_a_missing_model_says_how_to_learn_it(copied):
    (copied / "domains" / "copy" / "perception.yml.gz").unlink(missing_ok=True)
    with pytest.raises(Kr3Error, match="there is no model .*: learn it with ./kr3 train copy"):
        load_domain("copy", copied).require_model()


def test_a_scenario_with_a_foreign_place_is_refused(copied):
    file = copied / "domains" / "copy" / "scenario.yaml"
    goal_place = load_domain("copy", copied).target.goal_place
    file.write_text(file.read_text().replace(f"goal_place: {goal_place}", "goal_place: atlantis"))
    with pytest.raises(Kr3Error, match="'atlantis' is no place of building.yaml"):
        load_domain("copy", copied)


def test_a_scenario_without_a_target_is_refused(copied):
    file = copied / "domains" / "copy" / "scenario.yaml"
    file.write_text("goal: x\ninitial_records: []\n")
    with pytest.raises(Kr3Error, match="scenario.yaml: missing or malformed key 'target'"):
        load_domain("copy", copied)


def centre(area):
    return ((area.x_min + area.x_max) / 2, (area.y_min + area.y_max) / 2, 0.5)


def test_an_object_let_go_in_the_goal_place_is_fetched(domain):
    target = domain.target
    positions = {target.object: centre(domain.places[target.goal_place])}
    assert check_fetched(domain, positions, "").success


def test_an_object_still_held_is_not_fetched(domain):
    target = domain.target
    positions = {target.object: centre(domain.places[target.goal_place])}
    verdict = check_fetched(domain, positions, target.object)
    assert not verdict.success
    assert "still holds" in verdict.reason


def test_an_object_elsewhere_is_not_fetched_and_the_place_is_named(domain):
    positions = {domain.target.object: centre(domain.places[domain.target.at])}
    verdict = check_fetched(domain, positions, "")
    assert not verdict.success
    assert f"in {domain.target.at}, not in {domain.target.goal_place}" in verdict.reason


def test_a_lost_object_is_not_fetched(domain):
    assert not check_fetched(domain, {}, "").success


@pytest.mark.parametrize(
    "old, new, what",
    [
        ("placements:", "placement:", "unknown key 'placement'; known: initial_records, goal"),
        ("  goal_place:", "  place:", "unknown key 'place'; known: object, at"),
        (r"may_be_at: \[.*\]", "may_be_at: office", "found 'office'"),
        (r"may_be_at: \[.*\]", "may_be_at: []", "a list of places"),
    ],
)
def test_a_misspelt_scenario_is_refused(copied, old, new, what):
    file = copied / "domains" / "copy" / "scenario.yaml"
    text, times = re.subn(old, new, file.read_text())
    assert times == 1
    file.write_text(text)
    with pytest.raises(Kr3Error, match=f"scenario.yaml: .*{what}"):
        load_domain("copy", copied)
