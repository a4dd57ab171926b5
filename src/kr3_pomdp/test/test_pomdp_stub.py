"""The type stub of the Python module is what kr3_common's make_stub.py makes of the module."""

import ast
import importlib.util
from pathlib import Path

import pytest

kr3 = pytest.importorskip("kr3_pomdp", reason="the workspace is not built or not sourced")

PACKAGE = Path(__file__).resolve().parents[1]
MAKER = PACKAGE.parent / "kr3_common/python/make_stub.py"
STUB = PACKAGE / "python/kr3_pomdp-stubs/__init__.pyi"


def maker():
    spec = importlib.util.spec_from_file_location("make_stub", MAKER)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_stub_is_the_module():
    made = maker().stub(kr3)
    assert (
        STUB.read_text("utf-8") == made
    ), "make it again: kr3_common/python/make_stub.py kr3_pomdp"


def test_the_stub_has_every_public_name_and_parses():
    tree = ast.parse(STUB.read_text("utf-8"))
    names = {node.name for node in tree.body if hasattr(node, "name")}
    assert names == {name for name in vars(kr3) if not name.startswith("_")}


def test_the_stub_is_where_type_checkers_look():
    installed = Path(kr3.__file__).parent / "kr3_pomdp-stubs"
    assert (installed / "__init__.pyi").read_text("utf-8") == STUB.read_text("utf-8")
    assert (installed / "py.typed").is_file()


def test_every_function_and_attribute_is_documented():
    nodes = [
        node
        for node in ast.walk(ast.parse(STUB.read_text("utf-8")))
        if isinstance(node, (ast.ClassDef, ast.FunctionDef))
        and not node.name.startswith("_")
        and not any(isinstance(d, ast.Attribute) for d in getattr(node, "decorator_list", []))
    ]
    undocumented = [node.name for node in nodes if not ast.get_docstring(node)]
    assert set(undocumented) <= {"name", "value"} | set(enumerations())


def enumerations():
    return [name for name, item in vars(kr3).items() if hasattr(item, "__members__")]
