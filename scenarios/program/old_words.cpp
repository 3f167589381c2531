#include "scenarios/program/old_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

namespace {

struct OldWords {
  std::string_view command;  ///< of options; empty for commands, "*" for options of every command
  std::string_view words;    ///< separated by blanks
  std::string_view instead;
};

/// By command, so that what one command lost stands together.
constexpr OldWords kOldWords[] = {
    {"*", "--memory", "ulimit -d KILOBYTES before the command; without it three quarters of the machine's"},
    {"*", "--plugin", "--module FILE.so, of commands that run laws"},
    {"", "complete completion", "scripts/completion, which prints a completion for bash"},
    {"", "diff", "hapbench report A B --tolerance 0, which says what differs, with status 3"},
    {"", "explain",
     "hapbench run SCENE, which prints what is wrong and writes it to summary.json; hapbench describe diagnosis "
     "lists the rules"},
    {"", "identify", "hapbench import device LOG"},
    {"", "list", "hapbench describe, of a kind hapbench describe KIND; --grep TEXT searches"},
    {"", "man", "hapbench --help, and --help of each command"},
    {"", "merge", "hapbench sweep FOLDER, which joins the tables of the shards in it"},
    {"", "precision",
     "hapbench_accuracy, the benchmark of run time against error (tests/README.md), whose picture scripts/reproduce "
     "draws; hapbench converge SCENE --metric NAME"},
    {"", "shell", "hapbench validate SCENE --points FILE.csv"},
    {"", "stability",
     "hapbench limit spring_stiffness, spring_damping or spring_time_step; for --map other studies (hapbench "
     "describe studies), for --stress hapbench stress, for --search hapbench sweep SCENE --sample lhs:400 --vary "
     "hand.x_N=-5:5"},
    {"", "suite", "hapbench compare GROUP --algorithms all --seeds 5"},
    {"compare", "--check --sure", "hapbench compare SCENE --errors, of one number hapbench converge SCENE"},
    {"compare", "--devices --friction --resolution --vibration",
     "hapbench limit tap_wall tap_corner tap_hole --device all"},
    {"compare", "--html", "hapbench report FOLDER, of the comparison's folder"},
    {"compare", "--no-skip", "hapbench run SCENE --no-skip"},
    {"converge", "--resume", "the same without it: the runs are made again"},
    {"import device", "--duration --force --mass --rate --travel", "--design chirp,force=2,travel=0.08,mass=0.1"},
    {"import stroke", "--list", "hapbench import stroke, without a file"},
    {"import stroke", "--floats --force-by-tool --max-gap --max-speed --sample-rate --shift --tip-axis",
     "--set NAME=VALUE, as max_speed=9 or floats=true; the help has the names"},
    {"new", "--scale", "--extent SIZE, the longest edge of the mesh's box: 12mm, 1.2cm, 0.012m, 0.5in"},
    {"plot", "--no-sketch", "the same without it: plot draws no sketches"},
    {"reproduce", "--robustness",
     "hapbench reproduce --choices results/reference/readings.csv, or of scripts/readings.py 256"},
    {"reproduce", "--subjects", "their record, in the manual of the thesis's claims (scenarios/thesis/README.md)"},
    {"run", "--sure", "hapbench converge SCENE, of the points with --vary environment.spacing_m"},
    {"sweep", "--cpus --dry-run --partition --slurm --time",
     "sbatch --array=0-99 scripts/sweep.sbatch SCENE --vary ... --out FOLDER"},
    {"sweep", "--status", "squeue, and the tables sweep.I_of_N.csv that are in the folder"},
    {"tune", "--max-inside", "--bound inside_max_m=3e-4 [m]"},
    {"tune", "--max-step", "--bound settled_force_step_max_N=0.2"},
    {"tune", "--max-vibration", "--bound force_rms_above_30Hz_N=0.05"},
    {"tune", "--over", "--family hands,seeds,speeds"},
};

}  // namespace

void refuse_old_word(const std::string& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  for (const OldWords& old : kOldWords) {
    const Words words = words_of(old.words);
    if (std::ranges::find(words, name) == words.end() || (old.command != command && old.command != "*")) continue;
    throw InputError(fmt::format("{}\"{}\" is no longer known; instead: {}", command.empty() ? "" : command + ": ",
                                 name, old.instead));
  }
}

}  // namespace hapbench
