#!/usr/bin/env python3
"""Makes docs/benchmarks/*.md, and the table in README.md, from bench/results/*.json.

  bench/pages.py            writes the pages
  bench/pages.py --check    writes nothing; status 1 and the names of pages that are out of date

The text of each page is bench/pages/NAME.md, in which {{table}} stands for a table of TABLES below.
bench/results/README.md describes the JSON files. Standard library only.
"""
import argparse
import json
import pathlib
import sys
from dataclasses import dataclass, field

from bench_files import from_bench

ROOT = pathlib.Path(__file__).resolve().parent.parent
KEYS = ("table", "dataset", "case", "sensor", "profile", "variant", "metric")
REQUIRED = ("table", "dataset", "metric", "value", "unit", "commit", "date")
OPTIONAL = ("case", "sensor", "profile", "variant", "frames", "machine", "source")
README_BEGIN, README_END = "<!-- begin: bench/pages.py -->", "<!-- end: bench/pages.py -->"


class Problem(Exception):
    """Something about the results that a person has to mend."""


@dataclass
class Table:
    """One table of a page: `rows` are fields that name a line, `metrics` the figures in it."""
    rows: dict                                   # field -> heading
    metrics: dict                                # metric -> (heading, format)
    across: str = ""                             # a field with a column for each of its values; one figure or two
    only: dict = field(default_factory=dict)     # field -> value that a row must have
    datasets: tuple = ("",)                      # beginnings of the data sets that are shown
    provenance: bool = True                      # say commit, date and machine
    verdict: bool = False                        # a colour in front of each line (robustness)


RECORDING = {"dataset": "Recording", "sensor": "Camera", "profile": "Profile"}
DEPTH = {
    "median": ("Median, %", ".2f"), "p90": ("90 %, %", ".2f"), "within_2": ("≤ 2 %", ".1f"),
    "within_5": ("≤ 5 %", ".1f"), "within_10": ("≤ 10 %", ".1f"), "density": ("Density, %", ".1f"),
    "density_gradient": ("Of gradient, %", ".1f"), "edge_coverage": ("Edges, %", ".1f"),
    "cpu_ms": ("CPU, ms", ".0f"), "megabytes": ("MB", ".2f")}
PHONE = {
    "extract": ("Extract", ".1f"), "track": ("Track", ".1f"), "map": ("Map", ".1f"), "frame": ("Frame", ".1f"),
    "mean": ("Mean", ".1f"), "cpu": ("CPU", ".1f"), "ate": ("ATE, cm", ".2f"), "coverage": ("Coverage, %", ".0f"),
    "keyframes": ("Keyframes", ".0f")}
WILD = {
    "start": ("First pose", ".0f"), "coverage": ("Coverage, %", ".0f"), "maps": ("Maps", ".0f"),
    "false_poses": ("False poses", ".0f"), "ate": ("ATE, cm", ".1f"), "scale_drift": ("Scale drift", ".2f")}
MESH = {
    "ate": ("ATE, cm", ".1f"), "median": ("Median, cm", ".1f"), "p90": ("90 %, cm", ".1f"), "complete": ("Complete, %", ".0f"),
    "run": ("Run, s", ".0f"), "mesh": ("Mesh, s", ".0f")}
GRID = {
    "free": ("Free, %", ".1f"), "walls": ("Walls, %", ".1f"), "walls_free": ("Missed, %", ".1f"), "grid": ("Grid, s", ".0f")}
PAIR = {"ate_rmse": ("RMSE", ""), "ate_std": ("Std", "")}

TABLES = {
    "recordings": Table({**RECORDING, "frames": "Frames"},
                        {"ate": ("ATE, cm", ".2f"), "coverage": ("Coverage, %", ".1f"), "maps": ("Maps", "")}),
    "readme": Table({"dataset": "Recording", "case": "Part", "sensor": "Camera"}, {"ate": ("ATE, cm", ".1f")},
                    across="variant", only={"profile": "desktop"}, datasets=("TUM", "EuRoC", "KITTI")),
    "calibration": Table({"dataset": "Recording", "case": "Begun at"},
                         {"truth": ("True, px", ""), "focal": ("Found, px", ""), "sigma": ("± px", ""),
                          "ate": ("ATE, cm", ".1f")}),
    "shutter": Table({"dataset": "Recording", "sensor": "Camera"}, {"ate": ("ATE, cm", ".2f")}, across="variant"),
    "phone": Table({"case": "Configuration"}, PHONE),
    "semidense_cost": Table({"dataset": "Recording"},
                            {"without": ("Without, ms", ".1f"), "with": ("With, ms", ".1f"), "ratio": ("Ratio", ".2f"),
                             "behind": ("Behind", ".0f"), "cpu": ("Added CPU per keyframe, ms", ".0f")}),
    "probability": Table({"sensor": "Camera", "case": "Probability"},
                         {"predicted": ("Predicted", ".3f"), "right": ("Right", ".3f"), "poses": ("Poses", ".0f")}),
    "covariance": Table({"sensor": "Camera", "case": "Age of the map"},
                        {"normalized_rms": ("RMS", ".2f"), "normalized_median": ("Median", ".2f"),
                         "pairs": ("Pairs", ".0f")}),
    "wild": Table({"case": "Case"}, WILD, verdict=True),
    "kitchen_people": Table({"case": "People, camera"}, {"ate": ("ATE, cm", ".2f")}, across="variant"),
    "ablation": Table({"sensor": "Camera"}, {"ate": ("ATE, cm", ""), "tracked": ("frames", "")}, across="variant"),
    "latency": Table({"sensor": "Camera"}, {"ate": ("ATE, cm", ".2f")}, across="variant"),
    "rendered_people": Table({"sensor": "Camera"}, {"ate": ("ATE, cm", ".2f")}, across="variant"),
    "masks": Table({"variant": "Mode"}, {"iou": ("IoU", ".2f"), "static": ("Static features, %", ".1f")}),
    "mesh": Table({"case": "Scene", "sensor": "Camera"}, MESH),
    "grid": Table({"case": "Scene", "sensor": "Camera"}, GRID),
    "depth_room": Table({"variant": "Configuration"}, DEPTH, only={"dataset": "synth:room"}),
    "depth_desk": Table({"variant": "Configuration"}, DEPTH, only={"dataset": "synth:desk"}),
    "depth_wall": Table({"variant": "Configuration"}, DEPTH, only={"dataset": "synth:wall"}),
    "depth_kitchen": Table({"variant": "Configuration"}, DEPTH, only={"dataset": "kitchen"}),
    "published_ate": Table({"dataset": "Recording"}, PAIR, across="variant", provenance=False),
    "published_rpe": Table({"dataset": "Recording"}, {"rpe_rmse": ("", ""), "rpe_std": ("", "")}, across="variant",
                           provenance=False),
    "published_rot": Table({"dataset": "Recording"}, {"rot_rmse": ("", ""), "rot_std": ("", "")}, across="variant",
                           provenance=False),
    "published_mono": Table({"dataset": "Recording", "case": "Part", "sensor": "Camera"}, {"ate": ("ATE, cm", "")}, across="variant",
                            provenance=False),
}
# Tables that show rows stored under other tables' names.
ROWS_OF = {"mesh": ["surface"], "grid": ["surface"], "probability": ["reliability"], "covariance": ["reliability"],
           "depth_room": ["depth"], "depth_desk": ["depth"], "depth_wall": ["depth"], "depth_kitchen": ["depth"],
           "readme": ["recordings", "published_mono"]}


def read_results(folder):
    """All rows of bench/results, each with the defaults of its file; of equal keys the newest."""
    rows = {}
    for path in sorted(folder.glob("*.json")):
        content = json.loads(path.read_text(encoding="utf-8"))
        if "benchmark" in content:
            content = from_bench(content)
        defaults = {key: content[key] for key in REQUIRED + OPTIONAL if key in content}
        for number, entry in enumerate(content["rows"]):
            row = {**defaults, **entry}
            unknown = set(row) - set(REQUIRED + OPTIONAL)
            missing = [key for key in REQUIRED if key not in row]
            if unknown or missing:
                raise Problem(f"{path.name}, row {number}: missing {missing}, unknown {sorted(unknown)}")
            key = tuple(row.get(name, "") for name in KEYS)
            if key not in rows or row["date"] >= rows[key]["date"]:
                rows[key] = {**rows.pop(key, {}), **row}
    return list(rows.values())


def text_of(value, form):
    """A figure as it stands in a table; a list has one for each seed."""
    if value is None:
        return "–"
    if isinstance(value, list):
        return " ".join(text_of(one, form) for one in value)
    if isinstance(value, str) or not form:
        return str(value)
    return format(value, form)


def verdict_of(figures):
    """Green: as it should be. Yellow: frames or maps are missing. Red: a wrong pose, or no map."""
    def all_of(name):
        value = figures.get(name, {}).get("value")
        return value if isinstance(value, list) else [value]
    if any(all_of("false_poses")):
        return "🟥"
    if "coverage" not in figures:            # no map is possible here
        return "🟩"
    if None in all_of("coverage"):
        return "🟥"
    return "🟨" if min(all_of("coverage")) < 95 or max(all_of("maps")) > 1 else "🟩"


def provenance_of(rows):
    """The line below a table: with which code, when and where it was measured."""
    seen = sorted({(row["date"], row["commit"], row.get("machine", "")) for row in rows if "source" not in row})
    if len(seen) == 1:
        date, commit, machine = seen[0]
        return f"Commit {commit}, {date}" + (f"; {machine}." if machine else ".")
    commits = ", ".join(dict.fromkeys(commit for _, commit, _ in seen))
    machines = "; ".join(dict.fromkeys(machine for *_, machine in seen if machine))
    return f"Commits {commits}, {seen[0][0]} to {seen[-1][0]}" + (f"; {machines}." if machines else ".")


def render(name, rows):
    """A table of TABLES as Markdown."""
    table = TABLES[name]
    rows = [row for row in rows if row["table"] in ROWS_OF.get(name, [name]) and row["metric"] in table.metrics
            and row["dataset"].startswith(table.datasets)
            and all(row.get(key, value) == value for key, value in table.only.items())]
    first = {}                                   # lines of one data set stand together
    rows.sort(key=lambda row: first.setdefault(row["dataset"], len(first)))
    if not rows:
        raise Problem(f"there are no results for the table {name}")
    columns = list(dict.fromkeys(row.get(table.across, "") for row in rows))
    if table.across:
        heads = columns
    else:
        heads = [heading for heading, _ in table.metrics.values()]
    fields = [key for key in table.rows if any(row.get(key) not in (None, "") for row in rows)]
    lines = {}
    for row in rows:
        line = lines.setdefault(tuple(row.get(key, "") for key in fields), {})
        line.setdefault(row.get(table.across, ""), {})[row["metric"]] = row
    out = ["| " + " | ".join([""] * table.verdict + [table.rows[key] for key in fields] + heads) + " |"]
    out.append("|" + "---|" * (table.verdict + len(fields) + len(heads)))
    for key, cells in lines.items():
        texts = []
        for column in columns:
            figures = [text_of(cells[column][metric]["value"], form) if metric in cells.get(column, {}) else None
                       for metric, (_, form) in table.metrics.items()]
            if table.across:
                given = [figure for figure in figures if figure is not None]
                texts.append(" / ".join(given) if given else "–")
            else:
                texts += ["–" if figure is None else figure for figure in figures]
        mark = [verdict_of(cells[""])] if table.verdict else []
        out.append("| " + " | ".join(mark + [str(part) for part in key] + texts) + " |")
    if table.provenance:
        out += ["", provenance_of(rows)]
    return "\n".join(out)


def pages(root):
    """Every generated file with its text."""
    rows = read_results(root / "bench" / "results")
    made = {}
    for template in sorted((root / "bench" / "pages").glob("*.md")):
        text = template.read_text(encoding="utf-8")
        for name in TABLES:
            if "{{" + name + "}}" in text:
                text = text.replace("{{" + name + "}}", render(name, rows))
        if "{{" in text:
            raise Problem(f"{template.name}: no table is called {text.split('{{')[1].split('}}')[0]}")
        mark = f"<!-- Made by bench/pages.py from bench/pages/{template.name} and bench/results. -->\n"
        made[root / "docs" / "benchmarks" / template.name] = mark + text
    readme = root / "README.md"
    text = readme.read_text(encoding="utf-8")
    if README_BEGIN in text:
        before, rest = text.split(README_BEGIN, 1)
        after = rest.split(README_END, 1)[1]
        made[readme] = before + README_BEGIN + "\n" + render("readme", rows) + "\n" + README_END + after
    return made


def main():
    parser = argparse.ArgumentParser(description="Makes the benchmark pages from bench/results.")
    parser.add_argument("--check", action="store_true", help="only say which pages are out of date")
    check = parser.parse_args().check
    try:
        made = pages(ROOT)
    except Problem as problem:
        sys.exit(f"bench/pages.py: {problem}")
    stale = [path for path, text in made.items()
             if not path.exists() or path.read_text(encoding="utf-8") != text]
    for path in stale:
        if check:
            print(f"{path.relative_to(ROOT)} is out of date: run bench/pages.py")
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(made[path], encoding="utf-8")
            print(f"wrote {path.relative_to(ROOT)}")
    return 1 if check and stale else 0


if __name__ == "__main__":
    sys.exit(main())
