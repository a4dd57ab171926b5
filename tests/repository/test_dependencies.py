"""Dependencies point one way, cores know no ROS, and no domain is wired into code."""
import re

import pytest
from repository import PACKAGES, core_files, cpp_files, dependencies, domain_names, includes

_BASE = {"kr3_msgs", "kr3_common"}
# What each package may depend on, among ours.
ALLOWED = {
    "kr3_msgs": set(),
    "kr3_common": {"kr3_msgs"},
    "kr3_reasoner": _BASE,
    "kr3_pomdp": _BASE,
    "kr3_navigation": _BASE,
    "kr3_perception": _BASE,
    "kr3_sim_ode": _BASE,
    "kr3_refinement": _BASE | {"kr3_reasoner", "kr3_pomdp"},
    "kr3_executive": _BASE
    | {
        "kr3_reasoner",
        "kr3_pomdp",
        "kr3_refinement",
        "kr3_navigation",
        "kr3_perception",
        "kr3_sim_ode",
    },
}
# These sit on top of everything and may depend on all below.
ON_TOP = {"kr3_experiments", "kr3_dashboard"}
# Nodes may talk to the robot's parts, the executive's core may not include them.
ROBOT = {"kr3_navigation", "kr3_perception", "kr3_sim_ode"}

# First parts of include paths that only exist with ROS. OpenCV, Eigen, OctoMap and the like are libraries.
ROS_HEADERS = re.compile(
    r"^(ros|roscpp|rosbag|rosgraph_msgs|actionlib\w*|tf2?_?\w*|cv_bridge|image_transport|\w+_msgs"
    r"|std_srvs|diagnostic_updater|nodelet|pluginlib|dynamic_reconfigure|message_filters)/"
)


def by_name(package):
    return package.name


def ours(names):
    return {name for name in names if name.startswith("kr3_")}


def test_every_package_is_in_the_table():
    unknown = {package.name for package in PACKAGES} - ALLOWED.keys() - ON_TOP
    assert unknown == set(), "say in ALLOWED what it may depend on"


@pytest.mark.parametrize("package", PACKAGES, ids=by_name)
def test_manifest_depends_only_downwards(package):
    if package.name in ON_TOP:
        return
    forbidden = ours(dependencies(package)) - ALLOWED[package.name] - {package.name}
    assert forbidden == set()


@pytest.mark.parametrize("package", PACKAGES, ids=by_name)
def test_code_includes_only_what_the_manifest_declares(package):
    tests = package / "test"
    wrong = []
    for file in cpp_files(package):
        if tests in file.parents:
            continue
        used = {include.split("/")[0] for include in includes(file) if "/" in include}
        for name in ours(used) - dependencies(package) - {package.name}:
            wrong.append(f"{file.relative_to(package)} includes {name}")
    assert wrong == []


@pytest.mark.parametrize("package", PACKAGES, ids=by_name)
def test_cores_include_no_ros(package):
    wrong = [
        f"{file.relative_to(package)} includes {include}"
        for file in core_files(package)
        for include in includes(file)
        if ROS_HEADERS.match(include) or re.match(r"kr3_\w+/ros/", include)
    ]
    assert wrong == []


@pytest.mark.parametrize("package", PACKAGES, ids=by_name)
def test_cores_of_the_robot_are_included_by_nodes_only(package):
    if package.name in ON_TOP:  # simulations in one process put them together
        return
    wrong = [
        f"{file.relative_to(package)} includes {include}"
        for file in core_files(package)
        for include in includes(file)
        if include.split("/")[0] in ROBOT - {package.name}
    ]
    assert wrong == []


@pytest.mark.parametrize("domain", sorted(domain_names()))
def test_no_name_of_a_domain_is_wired_into_cpp(domain):
    # Words that are also ordinary English say nothing when they stand in a comment: only string literals count.
    names = domain_names()[domain]
    literal = re.compile(r'"([^"\\\n]*)"')
    word = re.compile(
        r"\b(" + "|".join(sorted(map(re.escape, names), key=len, reverse=True)) + r")\b"
    )
    found = []
    for package in PACKAGES:
        for file in cpp_files(package):
            if "test" in file.relative_to(package).parts[:-1]:
                continue
            for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), start=1):
                if line.lstrip().startswith("#include"):
                    continue
                for text in literal.findall(line.split("//")[0]):
                    for match in word.findall(text):
                        found.append(f"{file.relative_to(package.parent)}:{number}: {match}")
    assert found == []


def test_python_of_the_stack_names_no_domain():
    names = set().union(*domain_names().values())
    word = re.compile(
        r"\b(" + "|".join(sorted(map(re.escape, names), key=len, reverse=True)) + r")\b"
    )
    found = []
    for package in PACKAGES:
        for folder in ("python", "scripts"):
            for file in sorted((package / folder).rglob("*.py")):
                for match in word.findall(file.read_text(encoding="utf-8")):
                    found.append(f"{file.relative_to(package.parent)}: {match}")
    # The default domain's folder and a formula in a help text are what a person types.
    allowed = {"bringup.py: office", "mapping.py: office", "up.py: office"}
    assert [text for text in found if text.split("/")[-1] not in allowed] == []
