"""Makes a wheel of the module dlo: what `pip install .` calls (PEP 517). It needs what builds the
command (.ci/setup python), and nothing of Python but its standard library.

The wheel holds the shared libraries that are not part of every Debian (NLopt, GSL, fmt, oneTBB, pugixml), so
that it works where neither they nor the sources are.
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
import tempfile
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Libraries of the loader and the C++ compiler, which every Python installation has.
EVERYWHERE = re.compile(
    r"^(ld-linux.*|linux-vdso|lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s))\.so"
)


def _project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{python}-{python}-{platform}"


def _metadata():
    project = _project()
    lines = [
        "Metadata-Version: 2.1",
        f"Name: {project['name']}",
        f"Version: {project['version']}",
        f"Summary: {project['description']}",
        f"License: {project['license']['text']}",
        f"Requires-Python: {project['requires-python']}",
        *(f"Requires-Dist: {name}" for name in project["dependencies"]),
        "Description-Content-Type: text/markdown",
        "",
        (ROOT / "compare/python/README.md").read_text(),
    ]
    return "\n".join(lines)


def _wheel():
    return f"Wheel-Version: 1.0\nGenerator: dlo\nRoot-Is-Purelib: false\nTag: {_tag()}\n"


def _run(*command):
    # Output goes to standard error, because pip reads standard output.
    subprocess.run([str(word) for word in command], check=True, stdout=sys.stderr)


def _build(folder, settings):
    """Compiles the module into the folder; results of earlier calls are reused."""
    build = (settings or {}).get("build-dir")
    if build is None:
        # The build folder of the command is used, so that its libraries are not compiled again.
        build = ROOT / "build/release"
        _run(
            "cmake", "--preset", "build", "-S", ROOT, "-DDLO_PYTHON=ON",
            f"-DDLO_PYTHON_EXECUTABLE={sys.executable}",
        )
    _run("cmake", "--build", build, "--target", "dlo_python")
    with tempfile.TemporaryDirectory() as installed:
        _run("cmake", "--install", build, "--component", "python", "--prefix", installed, "--strip")
        (extension,) = pathlib.Path(installed).rglob("_dlo.*.so")
        shutil.copytree(extension.parent, folder / "dlo")


def _bring_libraries(folder):
    """Copies the shared libraries of the extension to its folder, which it searches first."""
    (extension,) = (folder / "dlo").glob("_dlo.*.so")
    listed = subprocess.run(["ldd", extension], check=True, capture_output=True, text=True).stdout
    for name, path in re.findall(r"^\s*(\S+) => (/\S+)", listed, re.MULTILINE):
        if not EVERYWHERE.match(name):
            shutil.copy(path, folder / "dlo" / name)


def _digest(data):
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def _pack(folder, wheel, info):
    record = []
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(folder.rglob("*")):
            if path.is_dir():
                continue
            data = path.read_bytes()
            name = path.relative_to(folder).as_posix()
            archive.write(path, name)
            record.append(f"{name},sha256={_digest(data)},{len(data)}")
        record.append(f"{info}/RECORD,,")
        archive.writestr(f"{info}/RECORD", "\n".join(record) + "\n")


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Makes the wheel in the directory and returns its file name (PEP 517). Setting build-dir: a folder in which
    CMake has been configured with DLO_PYTHON for the same Python, to be used instead of build/release."""
    project = _project()
    info = f"{project['name']}-{project['version']}.dist-info"
    name = f"{project['name']}-{project['version']}-{_tag()}.whl"
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        _build(folder, config_settings)
        _bring_libraries(folder)
        (folder / info).mkdir()
        (folder / info / "METADATA").write_text(_metadata())
        (folder / info / "WHEEL").write_text(_wheel())
        shutil.copy(ROOT / "LICENSE", folder / info / "LICENSE")
        _pack(folder, os.path.join(wheel_directory, name), info)
    return name


def build_sdist(sdist_directory, config_settings=None):
    """Raises NotImplementedError: PEP 517 requires this function, but only the repository has the sources."""
    raise NotImplementedError("dlo is built from a clone of its repository")
