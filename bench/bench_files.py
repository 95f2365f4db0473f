"""Files that `alidade-bench … --out FILE.json` writes, as results for bench/pages.py.

Such a file is {benchmark, commit, date, machine: {cpu, cores}, rows: [{case, sensor, profile, metric, value, unit, frames,
seed, source, variant}]}. Rows that differ in their seed only become one with a list of values.
"""

# benchmark -> (table, the field that names the data set, {metric there: (metric here, factor)})
TABLES = {
    "wild": ("wild", "", {
        "start": ("start", 1), "coverage": ("coverage", 1), "maps": ("maps", 1), "false_poses": ("false_poses", 1),
        "ate_rmse": ("ate", 1), "scale_drift": ("scale_drift", 1)}),
    "phone": ("phone", "source", {
        "extract": ("extract", 1), "track": ("track", 1), "map": ("map", 1), "frame": ("frame", 1),
        "frame_mean": ("mean", 1), "cpu": ("cpu", 1), "ate_rmse": ("ate", 1), "coverage": ("coverage", 1),
        "keyframes": ("keyframes", 1)}),
    "semidense": ("depth", "source", {
        "error_median": ("median", 1), "error_p90": ("p90", 1), "within_2": ("within_2", 1), "within_5": ("within_5", 1),
        "within_10": ("within_10", 1), "density": ("density", 1), "density_of_gradients": ("density_gradient", 1),
        "edge_coverage": ("edge_coverage", 1), "cpu": ("cpu_ms", 1)}),
    "surface": ("surface", "", {
        "ate": ("ate", 1), "median": ("median", 1), "p90": ("p90", 1), "complete": ("complete", 1), "free": ("free", 1),
        "walls": ("walls", 1), "walls_free": ("walls_free", 1), "megabytes": ("megabytes", 1), "run": ("run", 1),
        "mesh": ("mesh", 1), "grid": ("grid", 1)}),
    "reliability": ("reliability", "", {
        "predicted": ("predicted", 1), "right": ("right", 1), "poses": ("poses", 1),
        "normalized_rms": ("normalized_rms", 1), "normalized_median": ("normalized_median", 1), "pairs": ("pairs", 1)}),
}


def from_bench(content):
    """The content of such a file, as bench/results/README.md describes results."""
    table, dataset, metrics = TABLES[content["benchmark"]]
    machine = content["machine"]
    no_map = {row["case"] for row in content["rows"] if row["metric"] == "map_expected" and row["value"] == 0}
    rows = {}
    for row in content["rows"]:
        if row["metric"] not in metrics or row["unit"] == "U":
            continue
        if row["case"] in no_map and row["metric"] == "coverage":
            continue                                     # no map is possible: nothing to cover
        metric, factor = metrics[row["metric"]]
        value = None if row["value"] is None else factor * row["value"]
        key = (row["case"], row.get("variant", ""), metric, row.get("sensor", ""))
        kept = rows.setdefault(key, {
            "dataset": row.get(dataset, "synth") if dataset else "synth", "case": row["case"], "metric": metric,
            "sensor": row.get("sensor", ""), "variant": row.get("variant", ""), "unit": row["unit"] or "1", "value": []})
        kept["value"].append(value)
    for row in rows.values():
        if len(row["value"]) == 1:
            row["value"] = row["value"][0]
    return {"table": table, "commit": content["commit"], "date": content["date"],
            "machine": f"{machine['cpu']}, {machine['cores']} cores", "rows": list(rows.values())}
