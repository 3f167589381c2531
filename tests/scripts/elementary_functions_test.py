"""Our code takes sine, logarithm and their like from sim/core/math.hpp, not from the C library, whose last digits differ.

Looks into the static libraries, so that a call which Eigen or the standard library makes for us is found as well.
"""
import re
import sys
import unittest
from pathlib import Path

from fixture import must

NM, BUILD = sys.argv[2:]
C_FUNCTIONS = re.compile(
    r" U (a?(?:sin|cos|tan)h?|atan2|sincos|exp2?|expm1|log(?:1p|2|10)?|pow|hypot|cbrt|c(?:abs|arg|exp|log|pow|sqrt))[fl]?$", re.M)
# OpenMesh has a cosine among the virtual functions of its mesh, for feature edges, which we do not ask for.
OPENMESH = {("libhapbench_sim_mesh", "cos"), ("libhapbench_scenarios_format", "cos")}


class Library(unittest.TestCase):
    def test_computes_elementary_functions_itself(self):
        archives = sorted(p for p in Path(BUILD).rglob("libhapbench_*.a") if "test_support" not in p.name)
        self.assertTrue(archives, f"no libraries in {BUILD}")
        found = {(archive.stem.removesuffix("_scalar"), name) for archive in archives for name in C_FUNCTIONS.findall(must(NM, "-u", archive))}
        self.assertEqual(found - OPENMESH, set(), "take these from sim/core/math.hpp")
