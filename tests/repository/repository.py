"""What the repository checks share: its files, its packages, the names of its domains."""
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Dict, List, Set

import yaml

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = sorted(file.parent for file in ROOT.glob("src/*/package.xml"))
CPP_SUFFIXES = {".hpp", ".cpp", ".h", ".cc"}

_INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)


def tracked_files() -> List[Path]:
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


def cpp_files(package: Path) -> List[Path]:
    """Every C++ file of a package, tests included."""
    return sorted(file for file in package.rglob("*") if file.suffix in CPP_SUFFIXES)


def core_files(package: Path) -> List[Path]:
    """The C++ files that must know no ROS: headers and sources outside the `ros` folders."""
    files = []
    for file in cpp_files(package):
        parts = file.relative_to(package).parts
        if parts[0] in ("include", "src") and "ros" not in parts:
            files.append(file)
    return files


def includes(file: Path) -> List[str]:
    """What a C++ file includes, as written."""
    return _INCLUDE.findall(file.read_text(encoding="utf-8"))


def manifest(package: Path) -> ElementTree.Element:
    """The package.xml."""
    return ElementTree.parse(package / "package.xml").getroot()


def dependencies(package: Path) -> Set[str]:
    """Packages that code of this one is built or run with; what only tests need is left out."""
    tags = ("depend", "build_depend", "build_export_depend", "exec_depend")
    return {element.text for tag in tags for element in manifest(package).iter(tag)}


def domain_names() -> Dict[str, Set[str]]:
    """Per domain the places and objects of its building, which only its own files may name."""
    names: Dict[str, Set[str]] = {}
    for file in sorted(ROOT.glob("domains/*/building.yaml")):
        building = yaml.safe_load(file.read_text(encoding="utf-8"))
        places = {place["name"] for place in building["places"]}
        objects = {item["name"] for item in building.get("objects", [])}
        names[file.parent.name] = places | objects
    return names
