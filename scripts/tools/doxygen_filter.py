#!/usr/bin/env python3
"""Prints a header as Doxygen reads it: // comments become /// or ///<. Doxyfile's INPUT_FILTER; argument: the file.

The first comment of a file describes the file, and those of its types that have no comment of their own: the first one
repeats it, the others refer to it.
"""
import re
import sys

TRAILING = re.compile(r'^((?:[^"/]|"(?:[^"\\]|\\.)*"|/(?!/))*\S)\s+// (.*)$')
TYPE = re.compile(r"^(?:struct|class|enum class) \w+(?: final)?(?: : [\w:<> ]+)? \{")


def escaped(text):
    return re.sub(r"([@\\<>&#])", r"\\\1", text)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        lines = file.read().split("\n")
    head = []
    while lines and lines[0].startswith("//"):
        head.append(escaped(lines.pop(0)[2:].strip()))
    if not head:
        sys.exit(f"{sys.argv[1]}:1: begins with no comment, which would describe it")
    out = ["/** @file", *head, "*/"]
    described = False  # a type has the file's comment
    above = False      # the last line was a comment about what follows
    trailing = False   # the last line ended with a comment, which // below its column continue
    for line in lines:
        comment = re.match(r"^(\s*)// ?(.*)$", line)
        if comment:
            trailing = trailing and len(comment.group(1)) > 12
            out.append(f"{comment.group(1)}///{'<' if trailing else ''} {escaped(comment.group(2))}")
            above = not trailing
            continue
        if TYPE.match(line) and not above:
            out += ["/** See the description of the file. */"] if described else ["/**", *head, "*/"]
            described = True
        after = TRAILING.match(line)
        out.append(f"{after.group(1)} ///< {escaped(after.group(2))}" if after else line)
        trailing, above = bool(after), False
    print("\n".join(out))


if __name__ == "__main__":
    main()
