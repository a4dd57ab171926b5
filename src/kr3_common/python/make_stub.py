#!/usr/bin/python3
"""Write the type stub of a built Python module: make_stub.py MODULE > MODULE-stubs/__init__.pyi.

pybind11 puts every signature into a docstring; types, defaults and documentation come from there. The test
test_stub.py of a package compares its file with the module, so it is made anew whenever the module changes.
"""

import importlib
import inspect
import re
import sys
import textwrap

HEADER = '''"""{doc}"""

# Made by kr3_common/python/make_stub.py.

{imports}
'''
MODULES = ("datetime", "numpy.typing")
SPECIAL = ("__len__", "__getitem__")
TYPING = ("Any", "Callable", "ClassVar", "Iterable", "Iterator", "Optional", "Union", "overload")
SIGNATURE = re.compile(r"^(?:\d+\. )?(\w+)\((.*)\) -> (.+)$")


def plain(annotation):
    """A type as pybind11 writes it, as Python writes it today."""
    text = re.sub(r"\bkr3_\w+\.", "", annotation)
    for old, new in (("List[", "list["), ("Dict[", "dict["), ("Tuple[", "tuple[")):
        text = text.replace(old, new)
    text = re.sub(r"numpy\.ndarray\[(numpy\.\w+)\]", r"numpy.typing.NDArray[\1]", text)
    return re.sub(r"(?<![.\w])(object|handle)\b", "Any", text)


def accepted(annotation):
    """The type of an argument: pybind11 makes arrays of what numpy can make arrays of."""
    return re.sub(
        r"numpy\.typing\.NDArray\[numpy\.\w+\]", "numpy.typing.ArrayLike", plain(annotation)
    )


def split_arguments(text):
    """Splits at the commas that are in no brackets."""
    parts, depth, start = [], 0, 0
    for at, char in enumerate(text):
        depth += (char in "[({<") - (char in "])}>" and text[at - 1 : at + 1] != "->")
        if char == "," and depth == 0:
            parts.append(text[start:at].strip())
            start = at + 1
    return [part for part in parts + [text[start:].strip()] if part]


def argument(text):
    """`goal: str`, `options: PlanOptions = ...`."""
    if text == "*":
        return text
    declared, _, default = text.partition(" = ")
    name, _, annotation = declared.partition(": ")
    if name == "self":
        return "self"
    kept = default if re.fullmatch(r"-?[\d.]+|True|False|None|'\w*'|\{\}", default) else "..."
    kind = accepted(annotation)
    if default == "None" and not kind.startswith("Optional["):
        kind = f"Optional[{kind}]"
    return f"{name}: {kind}" + (f" = {kept}" if default else "")


def documented(lines, documentation):
    """A body that is a docstring, or nothing."""
    if not documentation:
        return [lines + " ..."]
    return [lines, *quoted(documentation)]


def quoted(text):
    lines = textwrap.wrap(text, 88)
    if len(lines) == 1 and len(lines[0]) < 85:
        return [f'    """{lines[0]}"""']
    return [f'    """{lines[0]}', *(f"    {line}" for line in lines[1:]), '    """']


def functions(name, item):
    """The stub of a function: one signature, or several that are overloads."""
    text = inspect.getdoc(item) or ""
    lines = text.splitlines()
    numbered = [line for line in lines if re.match(r"^\d+\. ", line)]
    result = []
    for head in numbered or lines[:1]:
        match = SIGNATURE.match(head)
        arguments = ", ".join(argument(part) for part in split_arguments(match.group(2)))
        rest = lines[lines.index(head) + 1 :]
        body = []
        for line in rest:
            if re.match(r"^\d+\. ", line):
                break
            body.append(line)
        documentation = " ".join(line for line in body if line)
        if numbered:
            result.append("@overload")
        result += documented(f"def {name}({arguments}) -> {plain(match.group(3))}:", documentation)
    return result


def attribute(name, item):
    """The stub of a property: read only or not."""
    getter = SIGNATURE.match(
        (item.fget.__doc__ or "").strip().splitlines()[0].replace("(", f"{name}(", 1)
    )
    kind = plain(getter.group(3))
    lines = ["@property", *documented(f"def {name}(self) -> {kind}:", inspect.getdoc(item))]
    if item.fset is not None:
        lines += [f"@{name}.setter", f"def {name}(self, value: {kind}) -> None: ..."]
    return lines


def members(item):
    """The stub of what a class defines itself, in the order of the module."""
    lines = []
    for name, member in vars(item).items():
        if name == "__init__" and SIGNATURE.match((inspect.getdoc(member) or "").split("\n")[0]):
            lines += functions(name, member)
        elif name.startswith("_") and name not in SPECIAL:
            continue
        elif isinstance(member, staticmethod):
            lines += ["@staticmethod", *functions(name, member.__func__)]
        elif isinstance(member, property):
            lines += attribute(name, member)
        elif callable(member):
            lines += functions(name, member)
    return lines


def class_stub(name, item):
    base = item.__mro__[1].__name__
    lines = [f"class {name}" + (":" if base == "pybind11_object" else f"({base}):")]
    lines += quoted((inspect.getdoc(item) or "").splitlines()[0]) if inspect.getdoc(item) else []
    if hasattr(item, "__members__"):
        lines[0] = f"class {name}:"
        lines += [f"    {member}: ClassVar[{name}]" for member in item.__members__]
        lines += ["    @property", "    def name(self) -> str: ...", "    @property"]
        lines += ["    def value(self) -> int: ...", "    def __int__(self) -> int: ..."]
        lines += [f"    __members__: ClassVar[dict[str, {name}]]"]
        return lines
    if issubclass(item, Exception):
        return lines + ["    code: ClassVar[str]"]
    return lines + [f"    {line}" for line in members(item)]


def imports(text):
    """The lines that import what a stub mentions."""
    lines = [f"import {name}" for name in MODULES if f"{name}." in text]
    used = [name for name in TYPING if re.search(rf"\b{name}\b", text)]
    return "\n".join(lines + [f"from typing import {', '.join(used)}"])


def stub(module):
    blocks = []
    for name, item in vars(module).items():
        if name.startswith("_"):
            continue
        block = class_stub(name, item) if inspect.isclass(item) else functions(name, item)
        blocks.append("\n".join(block) + "\n")
    documentation = "\n".join(textwrap.wrap(inspect.getdoc(module), 95))
    header = HEADER.format(doc=documentation, imports=imports("\n".join(blocks)))
    return "\n".join([header, *blocks])


def main():
    sys.stdout.write(stub(importlib.import_module(sys.argv[1])))  # of the workspace that is sourced
    return 0


if __name__ == "__main__":
    sys.exit(main())
