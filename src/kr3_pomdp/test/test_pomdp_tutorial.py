"""docs/pomdp_python.md: its blocks run, one after another."""

import re
from pathlib import Path

import pytest

pytest.importorskip("kr3_pomdp", reason="the workspace is not built or not sourced")

PAGE = Path(__file__).resolve().parents[3] / "docs/pomdp_python.md"
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_the_blocks_of_the_tutorial_run(capsys):
    page = PAGE.read_text(encoding="utf-8")
    names = {}
    blocks = list(BLOCK.finditer(page))
    assert len(blocks) >= 7
    for block in blocks:
        line = page.count("\n", 0, block.start()) + 1
        code = "\n" * line + block.group(1)  # so that an error names the page's line
        exec(compile(code, str(PAGE), "exec"), names)  # pylint: disable=exec-used
    printed = capsys.readouterr().out
    assert "state 's0', action 'a0'" in printed
    assert "simulated: " in printed
