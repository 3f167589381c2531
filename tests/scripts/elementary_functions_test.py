"""Our code takes sine, logarithm and their like from sim/core/math.hpp, not from the C library, whose last digits differ.

Looks into the static libraries, so that a call which Eigen or the standard library makes for us is found as well.
"""

import re
import subprocess
import sys
from pathlib import Path

C_FUNCTIONS = re.compile(
    r" U (a?(?:sin|cos|tan)h?|atan2|sincos|exp2?|expm1|log(?:1p|2|10)?|pow|hypot|cbrt|c(?:abs|arg|exp|log|pow|sqrt))[fl]?$")
# OpenMesh has a cosine among the virtual functions of its mesh, for feature edges, which we do not ask for.
OPENMESH = {("libhapbench_sim_mesh", "cos"), ("libhapbench_scenarios_format", "cos")}


def main() -> None:
    nm, build = sys.argv[2:]
    archives = sorted(p for p in Path(build).rglob("libhapbench_*.a") if "test_support" not in p.name)
    assert archives, f"no libraries in {build}"
    found = []
    for archive in archives:
        listing = subprocess.run([nm, "-u", archive], check=True, capture_output=True, text=True).stdout
        for line in listing.splitlines():
            match = C_FUNCTIONS.search(line)
            if match and (archive.stem.removesuffix("_scalar"), match[1]) not in OPENMESH:
                found.append(f"{archive.name} calls {match[1]}")
    assert not found, "take these from sim/core/math.hpp:\n" + "\n".join(sorted(set(found)))


main()
