#!/usr/bin/env python3
"""Prints docs/reference/python.md, from the docstrings of the package `alidade`.

The package must be importable: PYTHONPATH=build/python scripts/tools/python_page.py. scripts/docs calls this, and
python/tests/test_reference_page.py compares the page with it.
"""
import ast
import inspect
import re
import textwrap

import alidade

WIDTH = 100  # columns of code
PROSE = 120  # and of text
HEAD = """# Python reference

This page lists all classes and functions of the package `alidade`. `scripts/docs` generates it from the docstrings; do
not edit it. The guide [Python](../guides/python.md) has examples.

Units and frames, everywhere: meters, seconds, pixels; the center of the top-left pixel is (0, 0). A pose is a (4, 4)
array `T_world_camera`, which maps points from the camera's frame to the world's. Lengths of a monocular map are in
map units. A trajectory is (n, 8): timestamp, tx, ty, tz, qx, qy, qz, qw.
"""
SECTIONS = (
    ("Whole recordings", ("run", "localize", "Result", "Progress")),
    ("Frame by frame", ("Slam", "TrackResult", "FramePose", "Features", "Imu", "Inertial", "Orientation")),
    ("Recordings and cameras", ("open", "Recording", "Frame", "Camera", "Rectifier")),
    ("Maps", ("Map", "MapPart", "KeyFrames", "Points", "Observations", "Cloud", "Localizer", "Placement")),
    ("Evaluation", ("ate", "rpe", "depth_errors", "TrajectoryError", "RelativePoseError", "ErrorStatistics",
                    "DepthErrors", "DepthScore", "read_trajectory", "write_trajectory")),
    ("Settings", ("settings", "describe_setting", "set_threads")),
    ("Errors", ("Error", "UsageError", "InputError", "ArrayError", "NothingMapped", "RunStopped")),
)


def prose(text):
    """Text of a docstring as Markdown: no tags, ``code`` becomes `code`, pages of docs/ become links."""
    text = text.replace("``", "`").replace("<", "&lt;").replace("*", "\\*")
    return re.sub(r"docs/(\w+/([\w-]+\.md))", r"[\2](../\1)", text)


def paragraphs(doc, names):
    """A docstring as Markdown: `name: meaning` of arguments, which follow each other in one or more lines, becomes a
    list."""
    out = []
    for block in re.split(r"\n\s*\n", inspect.cleandoc(doc or "")):
        # Text, name, text, name, text, …
        parts = re.split(r"(?:^|(?<=[.;)]) )((?:\w+, )*\w+): (?=\S)", " ".join(block.split()))
        text = [prose(parts[0].strip())] if parts[0].strip() else []
        items = []
        for name, meaning in zip(parts[1::2], parts[2::2]):
            if all(one in names for one in name.split(", ")):
                items.append(f"- `{name}`: {prose(re.sub(';$', '.', meaning.strip()))}")
            else:
                last = items or text
                last[-1:] = [" ".join(last[-1:] + [f"{name}: {prose(meaning.strip())}"])]
        if items:
            text = [re.sub(";$", ".", one) for one in text]
        out += text
        if items:
            out.append("\n".join(items))
    return "\n\n".join(wrapped(one) for one in out)


def wrapped(text):
    """Lines of at most PROSE columns; items of a list are indented by two."""
    return "\n".join(textwrap.fill(line, PROSE, subsequent_indent="  " if line.startswith("- ") else "",
                                   break_long_words=False, break_on_hyphens=False) for line in text.split("\n"))


def signature(name, function, skip_self):
    """A call as in the source, in lines of at most WIDTH columns."""
    arguments = function.args
    parts = []
    plain = arguments.posonlyargs + arguments.args
    defaults = [None] * (len(plain) - len(arguments.defaults)) + arguments.defaults

    def part(argument, default, prefix=""):
        text = prefix + argument.arg
        if argument.annotation:
            text += ": " + ast.unparse(argument.annotation).strip("'\"")
        if default is not None:
            text += (" = " if argument.annotation else "=") + ast.unparse(default)
        return text

    parts += [part(argument, default) for argument, default in zip(plain, defaults)][1 if skip_self else 0:]
    if arguments.vararg:
        parts.append(part(arguments.vararg, None, "*"))
    elif arguments.kwonlyargs:
        parts.append("*")
    parts += [part(argument, default) for argument, default in zip(arguments.kwonlyargs, arguments.kw_defaults)
              if not argument.arg.startswith("_")]
    if parts and parts[-1] == "*":
        parts.pop()
    if arguments.kwarg:
        parts.append(part(arguments.kwarg, None, "**"))
    result = ""
    if function.returns and function.name != "__init__":
        result = " -> " + ast.unparse(function.returns).strip("'\"")
    text = f"{name}({', '.join(parts)}){result}"
    if len(text) <= WIDTH:
        return text
    lines = textwrap.wrap(", ".join(part.replace(" ", "\0") for part in parts), WIDTH - 4, break_long_words=False,
                          break_on_hyphens=False)
    return f"{name}(\n    " + "\n    ".join(lines).replace("\0", " ") + f"){result}"


def argument_names(function):
    arguments = function.args
    every = arguments.posonlyargs + arguments.args + arguments.kwonlyargs + [arguments.kwarg, arguments.vararg]
    return {argument.arg for argument in every if argument}


def code(text):
    return f"```python\n{text}\n```"


def string_after(body, at):
    """The string that documents the attribute body[at]; empty: none."""
    if at + 1 < len(body) and isinstance(body[at + 1], ast.Expr) and isinstance(body[at + 1].value, ast.Constant):
        return inspect.cleandoc(str(body[at + 1].value.value))
    return ""


def row(name, kind, text):
    cells = (f"`{name}`", f"`{kind}`" if kind else "", prose(" ".join(text.split())))
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def attributes(body, target):
    """Rows of a table: annotated attributes, of a class (target None) or assigned to `target` in a method."""
    rows = []
    for at, item in enumerate(body):
        if isinstance(item, ast.AnnAssign):
            place, kind = item.target, ast.unparse(item.annotation).strip("'\"")
        elif isinstance(item, ast.Assign):
            place, kind = item.targets[0], ""
        else:
            continue
        if isinstance(place, ast.Name) and target is None:
            name = place.id
        elif isinstance(place, ast.Attribute) and isinstance(place.value, ast.Name) and place.value.id == target:
            name = place.attr
        else:
            continue
        if not name.startswith("_"):
            rows.append(row(name, kind, string_after(body, at)))
    return rows


def document_class(name, item):
    tree = ast.parse(textwrap.dedent(inspect.getsource(item))).body[0]
    methods = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    init = next((method for method in methods if method.name == "__init__"), None)
    hidden = init is None or any(argument.arg == "core" for argument in init.args.args)
    bases = [base.__name__ for base in item.__bases__ if base.__name__ in alidade.__all__ or base in (ValueError, TypeError)]
    out = [f"### {name}"]
    if not hidden:
        out.append(code(signature(name, init, True)))
    elif any(method.name == "__post_init__" for method in methods):  # a dataclass that users make
        fields = [node for node in tree.body if isinstance(node, ast.AnnAssign)]
        init = ast.parse("def __init__(" + ", ".join(ast.unparse(field) for field in fields) + "): pass").body[0]
        out.append(code(signature(name, init, False)))
        init = None
    if bases:
        out.append("A " + " and a ".join(f"`{base}`" for base in bases) + ".")
    out.append(paragraphs(ast.get_docstring(tree), argument_names(init) if init else set()))
    rows = attributes(tree.body, None) + (attributes(init.body, "self") if init else [])
    for method in methods:
        decorators = [ast.unparse(decorator) for decorator in method.decorator_list]
        if "property" in decorators and not method.name.startswith("_"):
            rows.append(row(method.name, ast.unparse(method.returns).strip("'\""), ast.get_docstring(method) or ""))
    if rows:
        out.append("| attribute | type | meaning |\n|---|---|---|\n" + "\n".join(rows))
    for method in methods:
        decorators = [ast.unparse(decorator) for decorator in method.decorator_list]
        if method.name.startswith("_") or "property" in decorators or any(".setter" in text for text in decorators):
            continue
        owner = name if {"classmethod", "staticmethod"} & set(decorators) else name.lower()
        out.append(code(signature(f"{owner}.{method.name}", method, "staticmethod" not in decorators)))
        out.append(paragraphs(ast.get_docstring(method), argument_names(method)))
    return out


def document(name):
    item = getattr(alidade, name)
    if inspect.isclass(item):
        return document_class(name, item)
    tree = ast.parse(inspect.getsource(item)).body[0]
    return [f"### {name}", code(signature(f"alidade.{name}", tree, False)),
            paragraphs(item.__doc__, argument_names(tree))]


def page():
    listed = [name for _, names in SECTIONS for name in names]
    if sorted(listed) != sorted(alidade.__all__):
        missing = set(alidade.__all__) ^ set(listed)
        raise SystemExit(f"scripts/tools/python_page.py: SECTIONS and alidade.__all__ differ: {sorted(missing)}")
    out = [HEAD.rstrip()]
    for heading, names in SECTIONS:
        out.append(f"## {heading}")
        for name in names:
            out += [text for text in document(name) if text]
    return "\n\n".join(out) + "\n"


if __name__ == "__main__":
    print(page(), end="")
