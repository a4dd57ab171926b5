"""The type stub of the Python module is what kr3_common's make_stub.py makes of the module."""

import ast
import importlib.util
from pathlib import Path

import pytest

kr3 = pytest.importorskip("kr3_reasoner", reason="the workspace is not built or not sourced")

PACKAGE = Path(__file__).resolve().parents[1]
MAKER = PACKAGE.parent / "kr3_common/python/make_stub.py"
STUB = PACKAGE / "python/kr3_reasoner-stubs/__init__.pyi"


def maker():
    spec = importlib.util.spec_from_file_location("make_stub", MAKER)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_stub_is_the_module():
    made = maker().stub(kr3)
    assert (
        STUB.read_text("utf-8") == made
    ), "make it again: kr3_common/python/make_stub.py kr3_reasoner"


def test_the_stub_has_every_public_name_and_parses():
    tree = ast.parse(STUB.read_text("utf-8"))
    names = {node.name for node in tree.body if hasattr(node, "name")}
    assert names == {name for name in vars(kr3) if not name.startswith("_")}
    assert (STUB.parent / "py.typed").is_file()


def test_the_stub_is_where_type_checkers_look():
    installed = Path(kr3.__file__).parent / "kr3_reasoner-stubs"
    assert (installed / "__init__.pyi").read_text("utf-8") == STUB.read_text("utf-8")
    assert (installed / "py.typed").is_file()
