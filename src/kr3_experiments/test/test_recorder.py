"""Recording profiles are checked, and so is the disk, before anything is written."""
from pathlib import Path

import pytest

from kr3_experiments.errors import Kr3Error
from kr3_experiments.recorder import Recorder, load_profile, require_space

PROFILES = sorted((Path(__file__).resolve().parents[3] / "rosbag").glob("*.yaml"))


class EndedProcess:
    def exit_code(self):
        return 0

    def is_gone(self):
        return True


@pytest.mark.parametrize("file", PROFILES, ids=lambda file: file.name)
def test_our_profiles_load(file):
    profile = load_profile(file)
    assert len(set(profile.topics)) == len(profile.topics)
    assert profile.min_free_mb > profile.stop_below_mb


@pytest.mark.parametrize(
    "text", ["topics: []\nmin_free_mb: 1\nstop_below_mb: 1", "topics: [a]", "[", "topics: 3"]
)
def test_a_malformed_profile_is_refused(tmp_path, text):
    (tmp_path / "p.yaml").write_text(text)
    with pytest.raises(Kr3Error, match="p.yaml"):
        load_profile(tmp_path / "p.yaml")


def test_a_full_disk_is_noticed_before_the_start(tmp_path):
    with pytest.raises(Kr3Error, match="no space for the bag: .* MB are free .* are needed"):
        require_space(tmp_path, 10**12)


def test_a_bag_of_a_mission_that_did_not_end_is_named_partial(tmp_path):
    (tmp_path / "m.bag").write_bytes(b"x")
    recorder = Recorder(EndedProcess(), tmp_path / "m.bag")
    assert recorder.stop(complete=False) == tmp_path / "m.partial.bag"
    assert [file.name for file in tmp_path.iterdir()] == ["m.partial.bag"]


def test_a_bag_that_was_not_closed_is_named_so(tmp_path):
    (tmp_path / "m.bag.active").write_bytes(b"x")
    recorder = Recorder(EndedProcess(), tmp_path / "m.bag")
    assert recorder.stop() == tmp_path / "m.unindexed.bag"


def test_a_complete_bag_keeps_its_name_and_a_missing_one_is_reported(tmp_path):
    (tmp_path / "m.bag").write_bytes(b"x")
    assert Recorder(EndedProcess(), tmp_path / "m.bag").stop() == tmp_path / "m.bag"
    assert Recorder(EndedProcess(), tmp_path / "n.bag").stop() is None
