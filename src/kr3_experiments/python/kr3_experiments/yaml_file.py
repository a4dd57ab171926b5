"""YAML files that people write."""
from pathlib import Path
from typing import Any, Dict

import yaml

from kr3_experiments.errors import Kr3Error


_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # ten times as fast where libyaml is there


def read_mapping(
    file: Path, expected: str = "expected keys with values", may_be_empty: bool = False
) -> Dict[str, Any]:
    """The keys of a file.

    @param expected  what the file should hold, for the message when it does not
    @throws Kr3Error  it cannot be read, is not YAML (with the line) or holds something else
    """
    try:
        content = yaml.load(file.read_text(encoding="utf-8"), Loader=_LOADER)
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "not UTF-8"
        raise Kr3Error(f"{file}: {why}") from error
    except yaml.YAMLError as error:
        raise Kr3Error(f"{file}: not YAML: {error}") from error
    if content is None and may_be_empty:
        return {}
    if not isinstance(content, dict):
        raise Kr3Error(f"{file}: {expected}")
    return content
