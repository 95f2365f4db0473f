#!/usr/bin/env python3
"""compare.py A B MOST: two trajectories (TUM) have the same frames, places no further apart than MOST, directions no more than MOST radians."""
import math
import sys


def read(path):
    with open(path, encoding="utf-8") as lines:
        return [[float(word) for word in line.split()] for line in lines if not line.startswith("#")]


first, second, most = read(sys.argv[1]), read(sys.argv[2]), float(sys.argv[3])
if len(first) != len(second) or not first or any(a[0] != b[0] for a, b in zip(first, second)):
    sys.exit(f"{len(first)} and {len(second)} poses, or others")
apart = max(math.dist(a[1:4], b[1:4]) for a, b in zip(first, second))
turned = max(2 * min(math.dist(a[4:], b[4:]), math.dist(a[4:], [-x for x in b[4:]])) for a, b in zip(first, second))
print(f"{len(first)} poses: at most {apart:.2e} of the unit and {turned:.2e} radians apart")
sys.exit(apart > most or turned > most)
