"""The doctor reads the stack file and the domains that the commands read."""
import pytest

from kr3_experiments import doctor


def test_every_node_of_the_stack_is_looked_for() -> None:
    assert len(doctor.check_packages()) > 0


def test_domains_that_can_be_brought_up_are_told_from_abstract_ones() -> None:
    found = {text.split()[1].rstrip(":"): (good, text) for good, text in doctor.check_domains()}
    assert found["office"][0] and "model are there" in found["office"][1]
    assert found["warehouse"][0] and "no building.yaml" in found["warehouse"][1]


@pytest.mark.parametrize("address, good", [("127.0.0.1", True), ("10.0.0.7", False), ("", False)])
def test_an_address_that_others_reach_is_warned_of(
    monkeypatch: pytest.MonkeyPatch, address: str, good: bool
) -> None:
    monkeypatch.setenv("ROS_IP", address)
    assert doctor.check_address()[0] is good
