"""scripts/check/docs finds each kind of mistake, and none where there is none."""
import importlib.machinery
import importlib.util
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def load(name, path):
    """A module from a file without an ending."""
    spec = importlib.util.spec_from_loader(name, importlib.machinery.SourceFileLoader(name, str(path)))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


check_docs = load("check_docs", ROOT / "scripts" / "check" / "docs")

SOUND = {
    "README.md": "# A\n\n[index](docs/index.md)\n",
    "docs/index.md": "# Index\n\nThis page lists pages: [one](guides/one.md#a-heading), [web](https://example.org).\n",
    "docs/guides/one.md": "# One\n\nThis page is short.\n\n## A heading\n\n`so many` is code.\n",
    "src/a.h": "// Described in docs/guides/one.md.\n",
}


class CheckDocs(unittest.TestCase):
    def problems(self, changes):
        """What is found in the sound tree with these files changed; None: left out."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            subprocess.run(["git", "init", "-q", folder], check=True)
            for name, text in {**SOUND, **changes}.items():
                if text is not None:
                    (root / name).parent.mkdir(parents=True, exist_ok=True)
                    (root / name).write_text(text, encoding="utf-8")
            return [f"{name}:{line}: {text}" for name, line, text in check_docs.check(root)]

    def assert_found(self, changes, expected):
        found = self.problems(changes)
        self.assertTrue(any(expected in problem for problem in found), found)

    def test_a_sound_tree_has_no_problems(self):
        self.assertEqual(self.problems({}), [])

    def test_a_link_to_a_missing_file_is_found(self):
        self.assert_found({"README.md": "# A\n\n[x](docs/two.md)\n"}, "README.md:3: leads to docs/two.md")

    def test_a_missing_image_is_found(self):
        self.assert_found({"README.md": "# A\n\n![x](docs/images/x.png)\n"}, "leads to docs/images/x.png")

    def test_a_link_to_a_missing_heading_is_found(self):
        self.assert_found({"docs/index.md": "# I\n\n[one](guides/one.md#no-heading)\n"}, "has no such heading")

    def test_a_page_that_no_link_reaches_is_found(self):
        self.assert_found({"docs/guides/two.md": "# Two\n"}, "docs/guides/two.md:1: no link from docs/index.md")

    def test_a_long_line_is_found(self):
        self.assert_found({"docs/guides/one.md": "# One\n\n## A heading\n\n" + "x " * 61 + "\n"}, ":5: 122 characters")

    def test_a_long_page_is_found(self):
        self.assert_found({"docs/guides/one.md": "# One\n\n## A heading\n" + "line\n" * 200}, "the page has 203 lines")

    def test_a_page_without_a_heading_is_found(self):
        self.assert_found({"docs/guides/one.md": "Text.\n\n## A heading\n"}, "begins with no heading")

    def test_outlawed_words_are_found_outside_of_code(self):
        for words in ("three on end", "so many frames", "it is told", "that hangs on it", "0 nor 1", "of .5 m"):
            self.assert_found({"docs/guides/one.md": f"# One\n\n## A heading\n\n{words}\n"}, "docs/guides/one.md:5: '")

    def test_a_moved_page_named_in_a_source_file_is_found(self):
        self.assert_found({"src/a.h": "// docs/formats.md\n"}, "src/a.h:1: names docs/formats.md")

    def test_generated_pages_may_be_long_but_not_missing(self):
        page = "# Settings\n" + 300 * ("word " * 30 + "\n")
        self.assertEqual(self.problems({"docs/index.md": SOUND["docs/index.md"] + "[a](reference/settings.md)\n",
                                        "docs/reference/settings.md": page}), [])
        self.assert_found({"src/a.h": "// docs/reference/cli.md\n"}, "src/a.h:1: names docs/reference/cli.md")


if __name__ == "__main__":
    unittest.main()
