"""Records the runs that the replay shows, by calling the program."""
import subprocess
from dataclasses import dataclass
from pathlib import Path

from .json_input import InputError


@dataclass(frozen=True)
class Scene:
    id: str
    title: str
    scenario: str
    algorithms: tuple  # the first two are shown side by side at first
    settings: tuple  # further overrides
    speed: float  # of the replay at first, in units of real time
    note: str


SCENES = (
    Scene("task2_rotate", "Task 2: the drill is rotated in the hole (3-D)", "task2_rotate_signed_distance",
          ("original_averaging", "shaped_stiffness"), ("time.duration_s=6",), 0.5,
          "One period of the tilt, the same hand pressing the drill into the hole."),
    Scene("peg_in_hole_2d", "The peg in a hole of its own width (2-D)", "peg_in_hole_2d_shaped_stiffness",
          ("original_averaging", "shaped_stiffness", "summation", "mean", "exact_shaping"), (), 0.05,
          "The scene of appendix A.1: the peg is tilted at constant speed and nobody holds it."),
)

# Beside the trajectory; every step, for the sound and the peaks.
RECORDED = ("record.contacts=true", "record.stiffness_tensor=true", "record.every=1")

# The bundled expectations are for the scenario's own algorithm; another one may miss them.
SUCCESS, UNEXPECTED_OUTCOME = 0, 3


def record_replays(program: Path, out: Path):
    for scene in SCENES:
        for algorithm in scene.algorithms:
            settings = (*RECORDED, "record.ratio_iterations=[]",
                        f"rendering.algorithm={algorithm}", *scene.settings)
            call(program, "run", scene.scenario, *overrides(settings), "--out", out / scene.id / algorithm)
        call(program, "shell", scene.scenario, "--out", out / scene.id / "shell.csv")


def overrides(settings):
    return [argument for setting in settings for argument in ("--set", setting)]


def rerun_commands(scene):
    """What a reader types to get one recording."""
    settings = " ".join(overrides((*RECORDED, *scene.settings)))
    return [f"hapbench run {scene.scenario} {settings} --set rendering.algorithm={scene.algorithms[0]} --out {scene.id}",
            f"hapbench shell {scene.scenario} --out shell.csv"]


def call(program, *arguments):
    line = [str(program), *map(str, arguments), "--quiet"]
    try:
        done = subprocess.run(line, capture_output=True, text=True, timeout=600, stdin=subprocess.DEVNULL)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise InputError(f"{program}: {error}") from error
    if done.returncode not in (SUCCESS, UNEXPECTED_OUTCOME):
        said = done.stderr.strip().splitlines() or ["no message"]
        raise InputError(f"{program} {arguments[0]} {arguments[1]}: exit status {done.returncode}: {said[-1]}")
