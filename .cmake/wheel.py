"""Makes a wheel of an installation: wheel.py STAGE FOLDER VERSION. STAGE is what `cmake --install` made of the preset package with a
prefix of its own. Prints the file. The same bytes whenever the same files are packed.

The module goes to site-packages; program, libraries and scenarios go to bin, lib and share of the environment, side by side, where
they find each other. Libraries that not every Linux of this glibc has come along, with their licences."""
import base64
import hashlib
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

STAGE, FOLDER, VERSION = Path(sys.argv[1]).resolve(), Path(sys.argv[2]), sys.argv[3]
OF_HEADERS = ("libcli11-dev", "libeigen3-dev", "nlohmann-json3-dev", "pybind11-dev")  # compiled into ours
# Of every platform manylinux (PEP 600).
OF_SYSTEM = re.compile(r"(linux-vdso|ld-linux-.*|lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s))\.so.*")
METADATA = """Metadata-Version: 2.1
Name: hapbench
Version: {version}
Summary: An offline bench for haptic rendering
License: MIT
Requires-Python: =={major}.{minor}.*
Requires-Dist: numpy (<2)
Requires-Dist: matplotlib
Requires-Dist: scipy
"""


def libraries_of_others():
    """What the program loads besides ours and the system's: names and files."""
    lines = subprocess.run(["ldd", STAGE / "bin" / "hapbench"], capture_output=True, text=True, check=True).stdout.splitlines()
    found = (re.match(r"\s*(\S+) => (/\S+)", line) for line in lines)
    pairs = {match[1]: Path(match[2]).resolve() for match in found if match}
    return {name: file for name, file in pairs.items() if not OF_SYSTEM.fullmatch(name) and not file.is_relative_to(STAGE)}


def package_of(file):
    return subprocess.run(["dpkg", "-S", file], capture_output=True, text=True, check=True).stdout.split(":")[0]


def contents():
    """Paths in the wheel, without its metadata, and the files that go there."""
    packages, data = STAGE / "lib/python3/dist-packages", f"hapbench-{VERSION}.data"
    files = {str(file.relative_to(packages)): file for file in packages.rglob("*")}
    files |= {f"{data}/data/{file.relative_to(STAGE)}": file for top in ("hapbench", "man", "bash-completion")
              for file in (STAGE / "share" / top).rglob("*")}
    # By the name that the loader asks for: a wheel has no links.
    files |= {f"{data}/data/{file.relative_to(STAGE)}": file for file in STAGE.glob("lib/**/libhapbench.so.*")
              if re.fullmatch(r"libhapbench\.so\.\d+\.\d+", file.name)}
    files[f"{data}/scripts/hapbench"] = STAGE / "bin" / "hapbench"
    libraries = libraries_of_others()
    files |= {f"{data}/data/lib/{name}": file for name, file in libraries.items()}
    licences = f"hapbench-{VERSION}.dist-info/licenses"
    files |= {f"{licences}/{package}": Path("/usr/share/doc") / package / "copyright"
              for package in (*map(package_of, libraries.values()), *OF_HEADERS)}
    files[f"{licences}/hapbench"] = STAGE / "share/doc/hapbench/LICENSE"
    return {path: file for path, file in files.items() if file.is_file()}


def pack(wheel, files):
    """Writes the wheel of files, or bytes, at their paths, and the record of them."""
    info, record = f"hapbench-{VERSION}.dist-info", []
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        def add(path, content, mode=0o644):
            entry = zipfile.ZipInfo(path)  # of 1980
            entry.external_attr = (0o100000 | mode) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{path},sha256={digest},{len(content)}\n")

        for path, source in sorted(files.items()):
            if isinstance(source, bytes):
                add(path, source)
            else:
                add(path, source.read_bytes(), 0o755 if os.access(source, os.X_OK) else 0o644)
        archive.writestr(zipfile.ZipInfo(f"{info}/RECORD"), "".join(record) + f"{info}/RECORD,,\n")


def main():
    module = next(STAGE.glob("lib/python3/dist-packages/hapbench/_hapbench.cpython-*.so"))
    python = re.search(r"cpython-(\d)(\d+)", module.name)
    # What runs where it was linked runs with every later glibc: not a promise of older ones.
    glibc = os.confstr("CS_GNU_LIBC_VERSION").split()[1].replace(".", "_")
    tag = "cp{0}-cp{0}-manylinux_{1}_{2}".format(python[1] + python[2], glibc, os.uname().machine)
    info, files = f"hapbench-{VERSION}.dist-info", contents()
    files[f"{info}/METADATA"] = METADATA.format(version=VERSION, major=python[1], minor=python[2]).encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: hapbench\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    wheel = FOLDER / f"hapbench-{VERSION}-{tag}.whl"
    pack(wheel, files)
    print(wheel.resolve())


if __name__ == "__main__":
    main()
