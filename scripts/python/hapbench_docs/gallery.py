"""The gallery: pictures of bundled scenes as `hapbench plot` draws them, the page that shows them, and the pictures of the symptoms
that the guide to tuning has, made by the commands that it prints above them."""
import json
import re
import shlex
import textwrap

from hapbench_command import write

from .manuals import ROOT

FOLDER, PAGE = ROOT / "results" / "reference" / "gallery", ROOT / "scenarios" / "GALLERY.md"
GUIDE = ROOT / "scenarios" / "TUNING.md"
# Commands, the last of which plots, and below them the picture.
ILLUSTRATED = re.compile(r"((?:^    hapbench .*\n)+)\n!\[[^]]*\]\([^)]*/gallery/(\w+\.svg)\)", re.M)
SCENES = ("poke_plane", "recorded_stroke", "peg_in_hole_2d_original_averaging", "peg_in_hole_2d_shaped_stiffness",
          "task1_flat_signed_distance", "task2_rotate_signed_distance", "task3_spin_signed_distance", "press_into_hole",
          "corner_normal_projection", "turned_into_wall", "mesh_molar", "drag_molar", "bur_fissure", "pear_in_cavity",
          "cone_in_undercut")
HEAD = """# Gallery

Some of the bundled scenes; `hapbench list` shows all of them. On the left the size of the rendered force over time. On the
right the way of the tool's tip (coloured), a section of the surface through its middle (dots), and outlines of the tool.
`scripts/docs --gallery` draws these pictures from runs and writes this page ({provenance}).
"""


def draw_all(program, scratch):
    """Every picture, and the page that shows them."""
    parts = [HEAD.format(provenance=program.provenance())]
    for name in SCENES:
        folder = scratch / "runs" / name
        program.run(["run", name, "--quiet", "--out", folder], scratch)
        program.run(["plot", folder, "--y", "force,path", "--no-sketch", "--quiet", "--out", FOLDER / f"{name}.svg"], scratch)
        scenario = json.loads((folder / "scenario.effective.json").read_text(encoding="utf-8"))
        parts.append(f"## {name}\n\n{textwrap.fill(scenario['description'], 110)}\n\n![{name}](../results/reference/gallery/{name}.svg)\n\n"
                     f"    hapbench run {name}\n    hapbench plot results/out/{name}\n")
    write(PAGE, "\n".join(parts))
    symptoms = ILLUSTRATED.findall(GUIDE.read_text(encoding="utf-8"))
    for commands, picture in symptoms:
        *runs, plot = (shlex.split(line)[1:] for line in commands.splitlines())
        for words in runs:
            program.run([*words, "--quiet"], scratch)
        program.run([*plot, "--no-sketch", "--quiet", "--out", FOLDER / picture], scratch)
    print(f"drew {len(SCENES)} scenes and {len(symptoms)} symptoms into {FOLDER.relative_to(ROOT)}")
