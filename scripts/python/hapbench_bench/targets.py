"""Which benchmarks are compared, and their targets. A target is a promise about the program, so it is a ratio
wherever that is possible: absolute times differ from machine to machine, and on one from hour to hour."""
from dataclasses import dataclass
from typing import Optional

DEADLINE = 1 / 2048  # of a haptic loop [s]


@dataclass(frozen=True)
class Row:
    """A benchmark over another one, both timed in one process with their repetitions interleaved."""

    what: str
    over: str
    at_most: Optional[float] = None
    times: float = 1  # so many of `over`
    wall: bool = False  # works on several cores: the clock on the wall counts, for both

    @property
    def label(self):
        """Short name of the denominator; "…/" stands for the part of the name that both benchmarks share."""
        name = self.over.removeprefix("search/")
        group, _, last = self.over.rpartition("/")
        if group == self.what.rpartition("/")[0]:
            name = f"…/{last}"
        return f"`{name}`" if self.times == 1 else f"{self.times:g} × `{name}`"


def searches(task):
    brute = f"search/brute_force/{task}"
    return [Row(f"search/grid/{task}", brute, 0.023), Row(f"search/neighbour_list/{task}", brute, 0.015)]


def contacts_grow(part):
    """Ten times the contacts at no more than 1.3 times the time each: what the caches cost."""
    return Row(f"growth/{part}/10000", f"growth/{part}/1000", 1.3, times=10)


# The benchmarks of a group are timed together. Brute force tests every point of the shell with every SIMD lane: a ratio to it
# is how much of that work is left.
GROUPS = (
    [*searches("T1"), Row("step/T1", "search/brute_force/T1", 0.009)],
    [
        *searches("T2"),
        Row("step/T2", "search/brute_force/T2", 0.014),
        Row("step/T2_proxy", "step/T2", 2.0),
        Row("ideal_trajectory/row", "step/T2", 3.0),
    ],
    [
        *searches("T3"),
        Row("step/T3", "search/brute_force/T3", 0.028),
        Row("reduction/T3", "step/T3", 0.25),
        Row("largest_depth/T3", "step/T3", 0.03),
        Row("step/unreduced_1000", "search/brute_force/T3", 0.09),
        Row("step/free_air", "search/brute_force/T3", 6e-4),
    ],
    [Row("step/upright_proxy", "step/upright", 4.0)],
    [Row(f"step/{task}_revolved", f"step/{task}", 1.6) for task in ("T1", "T2", "T3")],
    [Row(f"step/{task}_mesh", f"step/{task}", 4.0) for task in ("T1", "T2", "T3")],
    [Row("shell/build", "search/brute_force/T1", 0.35, times=1000, wall=True)],
    [contacts_grow("step"), contacts_grow("law/shaped_stiffness")],
    [Row(f"skip/{what}/taken", f"skip/{what}/off")
     for what in ("clearance", "no_contact", "reduction_of_one", "no_friction", "unwanted_records")],
)

# The step that 99.9 % of a run's are no longer than [s]; those of the three tasks leave the loop a twentieth.
LATENCIES = {"T1": 25e-6, "T2": 25e-6, "T2_proxy": 25e-6, "T3": 25e-6, "unreduced_1000": 25e-6, "upright_proxy": 100e-6}
# Further bytes for each further point of a shell that is built.
BYTES_PER_POINT = 100
SIZES_OF_MEMORY = ("growth/shell/100000", "growth/shell/300000")
# The largest shell, measured with --full only.
LARGEST = 7_000_000
LARGEST_SHELL = 75  # times as long as shell/build
