"""docs/reference/python.md is what its generator prints."""

import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def test_the_reference_page_is_up_to_date():
    done = subprocess.run([sys.executable, "-B", ROOT / "scripts/tools/python_page.py"], capture_output=True, text=True,
                          check=True, env=dict(os.environ, PYTHONPATH=os.pathsep.join(filter(None, sys.path))))
    page = (ROOT / "docs/reference/python.md").read_text(encoding="utf-8")
    assert page == done.stdout, "regenerate it: scripts/docs"
