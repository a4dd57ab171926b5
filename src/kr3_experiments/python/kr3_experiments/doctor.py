"""`./kr3 doctor`, its second half: what the built workspace can tell (scripts/doctor.sh looks at the machine)."""
import argparse
import os
from typing import List, Tuple

import rospkg

from kr3_experiments.bringup import DEFAULT_PORT, package_config
from kr3_experiments.domain import load_domain, repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.master import is_master, require_free_port
from kr3_experiments.stack_file import load_stack

Finding = Tuple[bool, str]


def add_options(_parser: argparse.ArgumentParser) -> None:
    """The command has none."""


def run(_args: argparse.Namespace) -> int:
    """@return 1 when something would not work"""
    findings = [check_port(), check_address(), *check_domains(), *check_packages()]
    for good, text in findings:
        print(f"  {'ok  ' if good else 'WARN'}  {text}")
    return 0 if all(good for good, _ in findings) else 1


def check_port() -> Finding:
    """Whether ./kr3 up can have its port."""
    if is_master(f"http://127.0.0.1:{DEFAULT_PORT}"):
        return False, f"a ROS master runs on port {DEFAULT_PORT}: ./kr3 up needs another --port"
    try:
        require_free_port(DEFAULT_PORT)
    except Kr3Error as error:
        return False, str(error)
    return True, f"port {DEFAULT_PORT} is free"


def check_address() -> Finding:
    """Whether nodes can be reached from other machines."""
    address = os.environ.get("ROS_IP", "")
    if address.startswith("127."):
        return True, f"ROS_IP={address}: nodes are reached from this machine only"
    return (
        False,
        f"{f'ROS_IP={address}' if address else 'ROS_IP is not set'}: everybody who reaches this machine can command"
        " the robot; ROS 1 has no passwords",
    )


def check_domains() -> List[Finding]:
    """Whether each domain can be brought up."""
    findings: List[Finding] = []
    for folder in sorted((repository_root() / "domains").glob("*/scenario.yaml")):
        name = folder.parent.name
        if not (folder.parent / "building.yaml").exists():
            findings.append((True, f"domain {name}: for kr3_mission only, it has no building.yaml"))
            continue
        try:
            domain = load_domain(name, repository_root())
            domain.require_map()
            domain.require_model()
            findings.append((True, f"domain {name}: scenario, building, map and model are there"))
        except Kr3Error as error:
            findings.append((False, f"domain {name}: {error}"))
    return findings


def check_packages() -> List[Finding]:
    """Whether the workspace has the package of every node."""
    specs = load_stack(package_config("stack.yaml"), None)
    packages = rospkg.RosPack()
    findings: List[Finding] = []
    for spec in specs:
        try:
            packages.get_path(spec.package)
        except rospkg.ResourceNotFound:
            findings.append((False, f"{spec.name}: package {spec.package} is not in the workspace"))
    return findings or [(True, f"{len(specs)} nodes have their packages")]
