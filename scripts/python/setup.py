"""pip install ./scripts/python: compiles the program hapbench and the Python module _hapbench with CMake, and installs
them with the package.

The wheel contains the package and the files that `cmake --install --component program` installs: the module, the
program in hapbench/bin, and the files of the program in hapbench/share, where the program finds them. The command
hapbench of the Python environment calls the program. All files are in folders of the package, so that pip uninstall
leaves nothing. The wheel is for this machine and this Python: it uses the processor's instructions and the system's
libraries.

HAPBENCH_BUILD_DIR names the build folder (default: build/pip of the source tree). A folder that CMake has already
configured keeps its configuration, so that a build of scripts/build --python (build/release) is not compiled again.
"""
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
BUILD = Path(os.environ.get("HAPBENCH_BUILD_DIR") or SOURCE / "build" / "pip").absolute()
# Folder of the files that setuptools writes; by default it would write them into the source tree.
FILES = BUILD / "pip"
CPU_SECONDS = 420  # processor time of a build from scratch [s], which the processors share
OPTIONS = ("HAPBENCH_BUILD_TESTS=OFF", "HAPBENCH_BUILD_RENDERER=OFF", "HAPBENCH_BUILD_PYTHON=ON")


def print_progress(text):
    """Prints a line on the terminal. pip hides the output of a build, but the file /dev/tty is still available."""
    print(f"hapbench: {text}", file=sys.stderr, flush=True)
    if sys.stderr.isatty():
        return
    try:
        with open("/dev/tty", "w", encoding="utf-8") as terminal:
            print(f"\nhapbench: {text}", file=terminal)
    except OSError:
        pass  # there is no terminal


def run(*words):
    try:
        subprocess.run(words, check=True, cwd=SOURCE)
    except FileNotFoundError:
        sys.exit(f"hapbench: error: there is no {words[0]}; scripts/setup --python installs it")
    except subprocess.CalledProcessError as error:
        sys.exit(f"hapbench: error: {' '.join(map(str, words))}: exit status {error.returncode}")


def compile_program():
    """Builds the program and the module, and returns the folder to which they are installed."""
    if not (BUILD / "CMakeCache.txt").is_file():
        processors = len(os.sched_getaffinity(0))
        minutes = max(1, round(CPU_SECONDS / processors / 60))
        print_progress(f"compiling in {BUILD}, about {minutes} min on {processors} processors")
        options = [*OPTIONS, f"Python_EXECUTABLE={sys.executable}"]
        run("cmake", "--preset", "release", "-B", BUILD, *(f"-D{option}" for option in options))
    run("cmake", "--build", BUILD, "--target", "bin/hapbench", "_hapbench")
    stage = FILES / "stage"
    shutil.rmtree(stage, ignore_errors=True)
    run("cmake", "--install", BUILD, "--component", "program", "--prefix", stage, "--strip")
    return stage


class Compiled(build_ext):
    """Builds the compiled module with CMake, in place of setuptools. Also installs the program and its files beside the
    module."""

    def run(self):
        stage = compile_program()
        package = stage / "lib" / "python3" / "dist-packages" / "hapbench"
        module = package / f"_hapbench{sysconfig.get_config_var('EXT_SUFFIX')}"
        if not module.is_file():
            found = ", ".join(file.name for file in package.glob("_hapbench*")) or "none"
            sys.exit(
                f"hapbench: error: {BUILD} has no module for this Python ({module.name}), but {found}; "
                "set HAPBENCH_BUILD_DIR to another folder"
            )
        target = Path(self.build_lib) / "hapbench"
        shutil.copy2(module, target)
        shutil.copytree(stage / "bin", target / "bin")
        shutil.copytree(stage / "share" / "hapbench", target / "share" / "hapbench")

    def get_outputs(self):
        return []


def version():
    return re.search(
        r"^project\(hapbench VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text(), re.M
    )[1]


if not (SOURCE / "CMakeLists.txt").is_file():
    sys.exit(
        f"hapbench: error: {SOURCE} is not hapbench's source tree; allowed: pip install SOURCE/scripts/python"
    )
shutil.rmtree(FILES, ignore_errors=True)  # removes the modules that an earlier version left there
FILES.mkdir(parents=True)
os.chdir(HERE)
setup(
    version=version(),
    packages=["hapbench"],
    py_modules=["hapbench_program"],
    package_data={"hapbench": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("hapbench._hapbench", [])],
    cmdclass={"build_ext": Compiled},
    options={"build": {"build_base": str(FILES)}, "egg_info": {"egg_base": str(FILES)}},
    zip_safe=False,
)
