"""Every package has what STYLE asks of a package, and nothing that DESIGN forbids."""
import re
import shutil
import subprocess

import pytest
from repository import PACKAGES, ROOT, manifest, tracked_files


def by_name(path):
    return path.name


@pytest.mark.parametrize("package", PACKAGES, ids=by_name)
def test_package_has_its_papers(package):
    for name in ("README.md", "CHANGELOG.rst", "CMakeLists.txt"):
        assert (package / name).is_file(), f"{package.name} has no {name}"


@pytest.mark.parametrize("package", PACKAGES, ids=by_name)
def test_manifest_names_folder_licence_and_format(package):
    root = manifest(package)
    assert root.get("format") == "3"
    assert root.findtext("name") == package.name
    assert root.findtext("license") == "BSD-3-Clause"


@pytest.mark.parametrize("package", PACKAGES, ids=by_name)
def test_changelog_has_an_entry_to_come(package):
    assert re.search(
        r"^Forthcoming\n-+\n+\* ", (package / "CHANGELOG.rst").read_text(), re.MULTILINE
    )


@pytest.mark.parametrize("package", PACKAGES, ids=by_name)
def test_package_is_linked_into_the_workspace(package):
    link = ROOT / "catkin_ws" / "src" / package.name
    assert link.is_symlink()
    assert str(link.readlink()) == f"../../src/{package.name}"


def test_there_are_no_launch_files():
    assert [str(file) for file in tracked_files() if file.suffix == ".launch"] == []


def test_no_file_names_a_place_of_one_machine():
    pattern = re.compile(r"(?<![\w.$}/])/(?:work|root|home/\w+)/\w[\w/]*")
    found = []
    for file in tracked_files():
        try:
            text = file.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        found += [f"{file.relative_to(ROOT)}: {match}" for match in pattern.findall(text)]
    assert found == []


def test_nothing_is_left_to_do():
    marks = re.compile(r"\b(TO" + r"DO|FIX" + r"ME|X" + r"XX)\b")
    suffixes = {".cpp", ".hpp", ".py", ".sh", ".md", ".txt", ".yaml", ".kr3", ".cmake"}
    found = [
        f"{file.relative_to(ROOT)}: {match}"
        for file in tracked_files()
        if file.suffix in suffixes
        for match in marks.findall(file.read_text(encoding="utf-8"))
    ]
    assert found == []


def test_links_in_documents_lead_somewhere():
    link = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")
    broken = []
    for file in tracked_files():
        if file.suffix != ".md":
            continue
        for target in link.findall(file.read_text(encoding="utf-8")):
            if "://" not in target and not (file.parent / target).exists():
                broken.append(f"{file.relative_to(ROOT)}: {target}")
    assert broken == []


@pytest.mark.parametrize(
    "script",
    [ROOT / "kr3", ROOT / ".ci/run", *sorted(ROOT.glob("scripts/*.sh"))],
    ids=by_name,
)
def test_shell_script_parses(script):
    subprocess.run(["bash", "-n", str(script)], check=True)


def python_files():
    folders = ("src", "tests", "scripts")
    listed = [file for file in tracked_files() if file.relative_to(ROOT).parts[0] in folders]
    return [str(file) for file in listed if file.suffix == ".py"]


@pytest.mark.parametrize(
    "tool", [["black", "--check", "--quiet"], ["flake8"]], ids=lambda tool: tool[0]
)
def test_python_passes(tool):
    if shutil.which(tool[0]) is None:
        pytest.skip(f"{tool[0]} is not installed")
    result = subprocess.run(
        [*tool, *python_files()], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stdout + result.stderr
