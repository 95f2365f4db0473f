"""PEP 517 backend of `pip install .`: builds the package with CMake and packs it. Depends on the standard library only,
so that pip does not download build requirements.

Build folder: ALIDADE_BUILD if set, else build/ if it was configured for the same Python, else build/python-TAG.
"""

import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def _version():
    text = (ROOT / "src/alidade/version.h").read_text()
    return re.search(r'ALIDADE_VERSION "([0-9.]+)"', text).group(1)


def _metadata():
    return (f"Metadata-Version: 2.1\nName: alidade\nVersion: {_version()}\n"
            "Summary: Visual SLAM: where the camera is, and what the place looks like\n"
            "License: Apache-2.0\nRequires-Python: >=3.9\nRequires-Dist: numpy\n"
            "Classifier: Programming Language :: Python :: 3\nClassifier: Typing :: Typed\n"
            "Description-Content-Type: text/markdown\n\n" + (ROOT / "docs/guides/python.md").read_text(encoding="utf-8"))


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"


def _is_for_this_python(build):
    """True when a build folder was configured for a Python with the same extension suffix."""
    cache = build / "CMakeCache.txt"
    found = re.search(r"^Python_EXECUTABLE:\w+=(.+)$", cache.read_text(), re.M) if cache.is_file() else None
    if found is None:
        return False
    ask = "import sysconfig; print(sysconfig.get_config_var('EXT_SUFFIX'))"
    said = subprocess.run([found.group(1), "-c", ask], capture_output=True, text=True, check=False)
    return said.stdout.strip() == sysconfig.get_config_var("EXT_SUFFIX")


def _package():
    """Builds the package and returns its folder."""
    if os.environ.get("ALIDADE_BUILD"):
        build = pathlib.Path(os.environ["ALIDADE_BUILD"])
    else:
        build = ROOT / "build"
        if not _is_for_this_python(build):
            build = ROOT / "build" / f"python-{sys.implementation.cache_tag}"
    environment = dict(os.environ)
    environment.pop("PYTHONPATH", None)  # set by pip
    if not _is_for_this_python(build):
        subprocess.run(["cmake", "-S", ROOT, "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DALIDADE_BUILD_APPS=OFF",
                        "-DALIDADE_BUILD_TESTS=OFF", f"-DPython_EXECUTABLE={sys.executable}"],
                       check=True, env=environment)
    built = subprocess.run(["cmake", "--build", build, "--target", "python", "--parallel", str(os.cpu_count() or 1)],
                           check=False, env=environment)
    if built.returncode != 0:
        raise SystemExit("alidade: building failed; `scripts/setup` installs the Debian packages it needs")
    return build / "python" / "alidade"


def _pack(wheel_directory, files):
    """Writes a wheel. `files`: name in the wheel → bytes. Returns the wheel's file name."""
    info = f"alidade-{_version()}.dist-info"
    files = dict(files)
    files[f"{info}/METADATA"] = _metadata().encode()
    files[f"{info}/WHEEL"] = (f"Wheel-Version: 1.0\nGenerator: alidade_build\nRoot-Is-Purelib: false\n"
                              f"Tag: {_tag()}\n").encode()
    files[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    rows = []
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        rows.append(f"{name},sha256={digest},{len(content)}")
    rows.append(f"{info}/RECORD,,")
    files[f"{info}/RECORD"] = ("\n".join(rows) + "\n").encode()
    name = f"alidade-{_version()}-{_tag()}.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in files.items():
            entry = zipfile.ZipInfo(path, (1980, 1, 1, 0, 0, 0))  # for reproducible wheels
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(entry, content)
    return name


def _without_debug_information(library):
    strip = shutil.which("strip")
    if strip is None:
        return library.read_bytes()
    with tempfile.NamedTemporaryFile(suffix=".so") as small:
        subprocess.run([strip, "--strip-unneeded", "-o", small.name, library], check=True)
        return pathlib.Path(small.name).read_bytes()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    del config_settings, metadata_directory
    files = {}
    for path in sorted(_package().iterdir()):
        if path.suffix == ".so":
            files[f"alidade/{path.name}"] = _without_debug_information(path)
        elif path.is_file() and path.suffix in (".py", ".pyi", ".typed") or path.name == "py.typed":
            files[f"alidade/{path.name}"] = path.read_bytes()
    return _pack(wheel_directory, files)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    """An editable install that refers to the build folder; `scripts/build python` updates it."""
    del config_settings, metadata_directory
    return _pack(wheel_directory, {"alidade.pth": f"{_package().parent}\n".encode()})


def build_sdist(sdist_directory, config_settings=None):
    del config_settings
    name = f"alidade-{_version()}"
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], capture_output=True, check=True).stdout
    with tarfile.open(pathlib.Path(sdist_directory) / f"{name}.tar.gz", "w:gz") as archive:
        for path in filter(None, listed.decode().split("\0")):
            archive.add(ROOT / path, f"{name}/{path}", recursive=False)
        with tempfile.NamedTemporaryFile("w", suffix=".txt", encoding="utf-8") as info:
            info.write(_metadata())
            info.flush()
            archive.add(info.name, f"{name}/PKG-INFO")
    return f"{name}.tar.gz"
