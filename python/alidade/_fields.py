"""Puts the meaning of attributes, which stands below each of them in the source, into the documentation of classes."""

from __future__ import annotations

import ast
import inspect
import sys
from typing import Dict, Iterable, List, Tuple

Field = Tuple[str, str, str]
"""name, type, meaning"""


def _fields_in(body: List[ast.stmt], owner: str) -> List[Field]:
    """Annotated attributes of a class (no owner), or of `owner` in a method."""
    fields = []
    for item, after in zip(body, [*body[1:], ast.Pass()]):
        target = item.target if isinstance(item, ast.AnnAssign) else item.targets[0] if isinstance(
            item, ast.Assign) else None
        is_text = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
        meaning = inspect.cleandoc(str(after.value.value)) if is_text else ""  # type: ignore[attr-defined]
        kind = ast.unparse(item.annotation) if isinstance(item, ast.AnnAssign) else ""
        if isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name) and target.value.id == owner:
            name = target.attr
        elif isinstance(target, ast.Name) and not owner and kind:
            name = target.id
        else:
            continue
        if not name.startswith("_"):
            fields.append((name, kind.strip("'\""), meaning))
    return fields


def _classes_of(module: str, known: Dict[str, Dict[str, List[Field]]]) -> Dict[str, List[Field]]:
    """The fields of all classes of a module, by name of the class."""
    if module not in known:
        known[module] = {}
        try:
            tree = ast.parse(inspect.getsource(sys.modules[module]))
        except (OSError, KeyError, TypeError, SyntaxError):  # no source: nothing is told
            return {}
        for node in tree.body:
            if isinstance(node, ast.ClassDef):
                fields = _fields_in(node.body, "")
                for method in node.body:
                    if isinstance(method, ast.FunctionDef) and method.name == "__init__":
                        fields += _fields_in(method.body, "self")
                known[module][node.name] = fields
    return known[module]


def document_fields(classes: Iterable[type]) -> None:
    """Appends the fields of each class, inherited ones first, to its docstring."""
    known: Dict[str, Dict[str, List[Field]]] = {}
    for item in classes:
        fields: List[Field] = []
        for base in reversed(item.__mro__):
            if base.__module__.partition(".")[0] == __package__:
                fields += _classes_of(base.__module__, known).get(base.__name__, [])
        if fields and item.__doc__:
            lines = [f"{name}: {kind}\n    " + " ".join(meaning.split()) if kind else f"{name}: " + meaning
                     for name, kind, meaning in fields]
            item.__doc__ = inspect.cleandoc(item.__doc__) + "\n\nAttributes:\n\n" + "\n".join(lines)
