"""docs/semantics_tests.md names tests and histories that exist, and every test that guards a trap."""
import re

from repository import ROOT

PAGE = (ROOT / "docs/semantics_tests.md").read_text(encoding="utf-8")
TESTS = ROOT / "src/kr3_reasoner/test"
GTEST = re.compile(r"^TEST(?:_[FP])?\((\w+), (\w+)\)", re.MULTILINE)


def gtests_in(program):
    return {".".join(name) for name in GTEST.findall((TESTS / f"{program}.cpp").read_text())}


def test_every_test_that_is_named_exists():
    program = None
    for name in re.findall(r"`([\w.]+)`", PAGE):
        if name.endswith("_test"):
            program = name
        elif re.fullmatch(r"[A-Z]\w*\.\w+", name):
            assert name in gtests_in(program), f"{name} is not in {program}"


def test_every_test_of_a_trap_is_named():
    for file in TESTS.glob("*_test.cpp"):
        for name in gtests_in(file.stem):
            assert not name.startswith("Point") or f"`{name}`" in PAGE, f"the page lacks {name}"


def test_every_history_is_named_and_exists():
    section = PAGE[PAGE.index("## Histories") :]
    left = set((TESTS / "histories").glob("*.history"))
    for row in re.findall(r"^\|.*\|(.*)\|$", section, re.MULTILINE)[2:]:
        for name in re.findall(r"`([\w*]+)`", row):
            found = set((TESTS / "histories").glob(f"{name}.history"))
            assert found, name
            left -= found
    assert left == set()
