"""Ports are checked before a master is started on them."""
import socket

import pytest

from kr3_experiments.errors import Kr3Error
from kr3_experiments.master import free_port, is_master, require_free_port, start_master


@pytest.fixture
def taken_port():
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen()
        yield server.getsockname()[1]


def test_a_free_port_is_free():
    require_free_port(free_port())


def test_a_port_in_use_is_refused_with_the_way_out(taken_port):
    with pytest.raises(Kr3Error, match=f"port {taken_port} is in use by another program; .*--port"):
        require_free_port(taken_port)


def test_a_master_is_not_started_on_a_port_in_use(taken_port, tmp_path):
    with pytest.raises(Kr3Error, match="is in use"):
        start_master(taken_port, tmp_path / "master.log", {})
    assert not (tmp_path / "master.log").exists()


def test_an_impossible_port_is_refused():
    with pytest.raises(Kr3Error, match="port 70000 cannot be used"):
        require_free_port(70000)


def test_whatever_listens_is_not_taken_for_a_master(taken_port):
    assert not is_master(f"http://127.0.0.1:{taken_port}", timeout_s=0.2)
    assert not is_master(f"http://127.0.0.1:{free_port()}", timeout_s=0.2)
