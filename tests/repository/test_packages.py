"""Every package has what STYLE asks of a package, and nothing that DESIGN forbids."""
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = sorted(file.parent for file in ROOT.glob("src/*/package.xml"))


def tracked_files():
    """Files that belong to the repository: tracked, or new and not ignored."""
    listing = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    files = [ROOT / line for line in listing.splitlines()]
    return [file for file in files if file.is_file() and not file.is_symlink()]


@pytest.mark.parametrize("package", PACKAGES, ids=lambda package: package.name)
def test_package_has_its_papers(package):
    for name in ("README.md", "CHANGELOG.rst", "CMakeLists.txt"):
        assert (package / name).is_file(), f"{package.name} has no {name}"


@pytest.mark.parametrize("package", PACKAGES, ids=lambda package: package.name)
def test_manifest_names_folder_licence_and_format(package):
    manifest = ElementTree.parse(package / "package.xml").getroot()
    assert manifest.get("format") == "3"
    assert manifest.findtext("name") == package.name
    assert manifest.findtext("license") == "BSD-3-Clause"


def test_there_are_no_launch_files():
    assert [str(file) for file in tracked_files() if file.suffix == ".launch"] == []


def test_no_file_names_a_place_of_one_machine():
    pattern = re.compile(r"(?<![\w.$}/])/(?:work|root|home/\w+)/\w")
    found = []
    for file in tracked_files():
        try:
            text = file.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        found += [f"{file.relative_to(ROOT)}: {match}" for match in pattern.findall(text)]
    assert found == []


@pytest.mark.parametrize(
    "script",
    [ROOT / "kr3", ROOT / ".ci/run", *sorted(ROOT.glob("scripts/*.sh"))],
    ids=lambda script: script.name,
)
def test_shell_script_parses(script):
    subprocess.run(["bash", "-n", str(script)], check=True)
