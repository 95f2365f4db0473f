"""bench/pages.py makes tables of results, and refuses what it does not understand."""
import json
import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench"))
import pages as benchmark_pages  # noqa: E402


def row(**fields):
    """A row of the accuracy table, with what it must have."""
    return {"table": "recordings", "dataset": "A", "sensor": "mono", "metric": "ate", "value": 1.234, "unit": "cm",
            "commit": "abc", "date": "2026-01-01", **fields}


class BenchmarkPages(unittest.TestCase):
    def read(self, *files):
        with tempfile.TemporaryDirectory() as folder:
            for number, content in enumerate(files):
                (pathlib.Path(folder) / f"{number}.json").write_text(json.dumps(content), encoding="utf-8")
            return benchmark_pages.read_results(pathlib.Path(folder))

    def test_a_table_has_a_line_for_each_recording_and_says_where_it_comes_from(self):
        text = benchmark_pages.render("recordings", [row(), row(metric="coverage", value=100), row(dataset="B", value=2)])
        self.assertIn("| A | mono | 1.23 | 100.0 | – |", text)
        self.assertIn("| B | mono | 2.00 | – | – |", text)
        self.assertIn("Commit abc, 2026-01-01.", text)

    def test_of_equal_rows_the_newest_counts(self):
        old, new = row(value=9), row(value=1, date="2026-02-01", commit="def")
        for files in ((old, new), (new, old)):
            rows = self.read(*({"rows": [one]} for one in files))
            self.assertEqual([(one["value"], one["commit"]) for one in rows], [(1, "def")])

    def test_a_file_has_defaults_for_its_rows(self):
        rows = self.read({"commit": "abc", "date": "2026-01-01", "table": "recordings", "unit": "cm",
                          "rows": [{"dataset": "A", "metric": "ate", "value": None}]})
        self.assertEqual(rows[0]["commit"], "abc")
        self.assertIn("| A | – |", benchmark_pages.render("recordings", rows))

    def test_a_row_without_a_commit_or_with_an_unknown_key_is_refused(self):
        for wrong in ({"commit": None}, {"seeds": 3}):
            broken = {key: value for key, value in row(**wrong).items() if value is not None}
            with self.assertRaisesRegex(benchmark_pages.Problem, "0.json, row 0"):
                self.read({"rows": [broken]})

    def test_files_of_the_bench_program_are_read(self):
        def figure(metric, seed, value, case="room", unit=""):
            return {"case": case, "sensor": "mono", "profile": "desktop", "metric": metric, "seed": seed, "value": value,
                    "unit": unit, "frames": 200}
        rows = self.read({"benchmark": "wild", "commit": "abc", "date": "2026-01-01",
                          "machine": {"cpu": "CPU", "cores": 2}, "u_ms": None, "rows": [
                              figure("ate_rmse", 1, 0.6, unit="cm"), figure("ate_rmse", 2, None, unit="cm"),
                              figure("tracked", 1, 200), figure("coverage", 1, 0, "turn"),
                              figure("map_expected", 1, 0, "turn"), figure("false_poses", 1, 0, "turn")]})
        self.assertEqual([(one["case"], one["metric"], one["value"]) for one in rows],
                         [("room", "ate", [0.6, None]), ("turn", "false_poses", 0)])
        self.assertIn("CPU, 2 cores", benchmark_pages.render("wild", rows))

    def test_a_case_is_green_yellow_or_red(self):
        def figures(**values):
            return {name: {"value": value} for name, value in values.items()}
        verdict = benchmark_pages.verdict_of
        self.assertEqual(verdict(figures(false_poses=[0, 0], coverage=[100, 98], maps=[1, 1])), "🟩")
        self.assertEqual(verdict(figures(false_poses=[0, 0], coverage=[100, 80], maps=[1, 1])), "🟨")
        self.assertEqual(verdict(figures(false_poses=[0, 3], coverage=[100, 98], maps=[1, 1])), "🟥")
        self.assertEqual(verdict(figures(false_poses=[0, 0], coverage=[100, None], maps=[1, 0])), "🟥")
        self.assertEqual(verdict(figures(false_poses=[0, 0], maps=[0, 0])), "🟩")

    def test_figures_of_other_systems_stand_beside_ours(self):
        text = benchmark_pages.render("readme", [
            row(dataset="TUM A", variant="Alidade", profile="desktop"),
            row(dataset="TUM A", variant="Alidade", profile="phone", value=9),
            row(dataset="TUM A", table="published_mono", variant="Other", value=2.5, source="[1]")])
        self.assertIn("| Recording | Camera | Alidade | Other |", text)
        self.assertIn("| TUM A | mono | 1.2 | 2.5 |", text)

    def test_the_pages_of_this_tree_are_up_to_date(self):
        for path, text in benchmark_pages.pages(ROOT).items():
            self.assertEqual(path.read_text(encoding="utf-8"), text, f"{path}: run bench/pages.py")


if __name__ == "__main__":
    unittest.main()
