"""YAML files, read so that an error names its line, and a key that is given twice is refused."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from indentation_files.regular_file import refuse_special
from palpate.errors import InputError

LARGEST, LONGEST = 100_000, 10_000_000  # entries and bytes, far above those of a study; more take minutes to read
EXPONENT = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+$")  # which PyYAML takes for text where a sign or dot lacks
NOT_DECIMAL = re.compile(r"[-+]?(0[\d_]+|[\d_]+(:[\d_.]+)+)$")  # which YAML 1.1 takes for octal or sexagesimal numbers
FROM_RECORDINGS = "give a YAML file; `palpate draft FILE -o FOLDER` writes one from recordings or a vendor's file"


class _Loader(yaml.SafeLoader):
    """PyYAML's safe loader, in which 1e9 is a number, as everywhere else.

    It refuses keys that are repeated or no words, and what YAML 1.1 reads to another base: 030 as 24, 1:30 as 90.
    """

    entries = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        self.entries += 1
        if self.entries > LARGEST:
            raise InputError(f"holds more than {LARGEST} entries", remedy="give a study or a specification")
        return super().compose_node(parent, index)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise yaml.MarkedYAMLError(problem="a key is no word", problem_mark=key.start_mark)
            if not key.tag.endswith((":str", ":int", ":merge")):
                problem = f"key {key.value!r} is read as no text; put it in quotes"
                raise yaml.MarkedYAMLError(problem=problem, problem_mark=key.start_mark)
            if key.value in seen:
                raise yaml.MarkedYAMLError(problem=f"key {key.value!r} is given twice", problem_mark=key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep)

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        if "\0" in node.value:
            raise yaml.MarkedYAMLError(problem="a text holds a zero byte", problem_mark=node.start_mark)
        if node.tag.endswith((":int", ":float")) and NOT_DECIMAL.match(node.value):
            problem = f"{node.value} is not read as a decimal number; write it as one, or text in quotes"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=node.start_mark)
        try:
            return super().construct_object(node, deep)
        except (ValueError, KeyError, AttributeError) as error:
            problem = f"{str(node.value)[:40]!r} is not what it looks like: a number, a date or what its tag says"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=node.start_mark) from error


_Loader.add_implicit_resolver("tag:yaml.org,2002:float", EXPONENT, list("-+.0123456789"))


def _size(node: yaml.Node, known: dict[int, float]) -> float:
    """Return the number of entries below a node, aliases filled in; infinite where it holds itself."""
    if id(node) not in known:
        known[id(node)] = math.inf  # until its entries are counted
        children: list[yaml.Node] = []
        if isinstance(node, yaml.MappingNode):
            children = [child for pair in node.value for child in pair]
        elif isinstance(node, yaml.SequenceNode):
            children = node.value
        known[id(node)] = 1.0 + sum(_size(child, known) for child in children)
    return known[id(node)]


def read_yaml(path: str | Path) -> Any:
    """Return the content of a YAML file.

    Raises
    ------
    InputError
        When the file is missing, is no text, is not valid YAML or gives a key twice; with the line where there is one.
    """
    refuse_special(path)
    named = Path(path).suffix.lower() in (".yaml", ".yml")
    try:
        if os.stat(path).st_size > LONGEST:
            raise InputError(f"is longer than {LONGEST // 10**6} MB", remedy=FROM_RECORDINGS, file=path)
        loader = _Loader(Path(path).read_text(encoding="utf-8"))
        node = loader.get_single_node()
        if node is not None and _size(node, {}) > LARGEST:
            raise InputError(
                f"holds more than {LARGEST} entries once its aliases are filled in", remedy="write it without aliases",
                file=path,
            )  # fmt: skip
        return None if node is None else loader.construct_document(node)
    except InputError as error:
        raise error.located(file=path) from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", remedy="check the path", file=path) from error
    except UnicodeDecodeError as error:
        raise InputError(
            "is not text in UTF-8, as a YAML file is",
            remedy="save it as UTF-8" if named else FROM_RECORDINGS,
            file=path,
        ) from error
    except RecursionError as error:
        raise InputError("is nested too deeply", remedy="correct the brackets or indentation", file=path) from error
    except yaml.YAMLError as error:
        mark, problem = getattr(error, "problem_mark", None), getattr(error, "problem", None)
        raise InputError(
            f"is not valid YAML ({problem})" if problem else "is not valid YAML",
            remedy="correct the keys, indentation or quotes" if named else FROM_RECORDINGS,
            file=path,
            place=f"line {mark.line + 1}" if mark else None,
        ) from error


def plain(values: Any) -> Any:
    """Return mappings, lists and numbers of Python and NumPy as a YAML file would give them."""
    if isinstance(values, Mapping):
        return {key: plain(value) for key, value in values.items()}
    if isinstance(values, np.ndarray | np.generic):
        return values.tolist()
    if isinstance(values, list | tuple):
        return [plain(value) for value in values]
    return str(values) if isinstance(values, Path) else values
