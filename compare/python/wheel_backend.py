"""Makes a wheel of the module dlo by setuptools: what `pip install .` calls (PEP 517). It needs what builds the
command (.ci/setup python).

The wheel holds the shared libraries that are not part of every Debian (NLopt, GSL, fmt, oneTBB, pugixml), so
that it works where neither they nor the sources are.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import setuptools
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Libraries of the loader and the C++ compiler, which every Python installation has.
EVERYWHERE = re.compile(r"^(ld-linux.*|linux-vdso|lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s))\.so")


def _run(*command):
    # Output goes to standard error, because pip reads standard output.
    subprocess.run([str(word) for word in command], check=True, stdout=sys.stderr)


class _Build(build_ext):
    """Installs the package and the shared libraries of its extension, which searches its folder first."""

    build = None  # folder in which CMake has been configured

    def run(self):
        build = self.build
        if build is None:
            # The build folder of the command is used, so that its libraries are not compiled again.
            build = ROOT / "build/release"
            _run("cmake", "--preset", "build", "-S", ROOT, "-DDLO_PYTHON=ON", f"-DDLO_PYTHON_EXECUTABLE={sys.executable}")
        _run("cmake", "--build", build, "--target", "dlo_python")
        package = pathlib.Path(self.build_lib, "dlo")
        with tempfile.TemporaryDirectory() as installed:
            _run("cmake", "--install", build, "--component", "python", "--prefix", installed, "--strip")
            (extension,) = pathlib.Path(installed).rglob("_dlo.*.so")
            shutil.copytree(extension.parent, package)
        listed = subprocess.run(["ldd", package / extension.name], check=True, capture_output=True, text=True).stdout
        for name, path in re.findall(r"^\s*(\S+) => (/\S+)", listed, re.MULTILINE):
            if not EVERYWHERE.match(name):
                shutil.copy(path, package / name)


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Makes the wheel in the directory and returns its file name (PEP 517). Setting build-dir: a folder in which
    CMake has been configured with DLO_PYTHON for the same Python, to be used instead of build/release."""
    _Build.build = (config_settings or {}).get("build-dir")
    with tempfile.TemporaryDirectory() as temporary:
        made = setuptools.setup(
            packages=[],
            ext_modules=[setuptools.Extension("dlo._dlo", [])],
            cmdclass={"build_ext": _Build},
            options={"egg_info": {"egg_base": temporary}, "build": {"build_base": temporary}},
            script_args=["--quiet", "bdist_wheel", "--bdist-dir", f"{temporary}/wheel", "--dist-dir", wheel_directory],
        )
    return pathlib.Path(made.dist_files[0][2]).name


def build_sdist(sdist_directory, config_settings=None):
    """Raises NotImplementedError: PEP 517 requires this function, but only the repository has the sources."""
    raise NotImplementedError("dlo is built from a clone of its repository")
