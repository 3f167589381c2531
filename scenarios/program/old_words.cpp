#include <fmt/format.h>

#include <string_view>

#include "scenarios/input/input_error.hpp"
#include "scenarios/program/command_line.hpp"

namespace hapbench {
namespace {

struct OldWord {
  std::string_view command;  ///< of an option; empty for a command, "*" for an option of every command
  std::string_view word;
  std::string_view instead;
};

constexpr std::string_view kDevices = "hapbench limit tap_wall tap_corner tap_hole --device all";

constexpr std::string_view kSlurm = "sbatch --array=0-99 scripts/sweep.sbatch SCENE --vary ... --out FOLDER";

constexpr std::string_view kErrors = "hapbench compare SCENE --errors, of one number hapbench converge SCENE";

/// By command, so that what one command lost stands together.
constexpr OldWord kOldWords[] = {
    {"*", "--memory", "ulimit -d KILOBYTES before the command; without it three quarters of what is free"},
    {"*", "--plugin", "the same without it: the command runs no law"},
    {"", "complete", "scripts/completion, which prints a completion for bash"},
    {"", "completion", "scripts/completion, which prints a completion for bash"},
    {"", "diff", "hapbench report A B --tolerance 0, which says what differs, with status 3"},
    {"", "explain",
     "hapbench run SCENE, which prints what is wrong and writes it to summary.json; hapbench describe diagnosis lists the rules"},
    {"", "man", "hapbench --help, and --help of each command"},
    {"", "merge", "hapbench sweep FOLDER, which joins the tables of the shards in it"},
    {"", "precision",
     "hapbench_accuracy, the benchmark of run time against error (tests/README.md), whose picture scripts/reproduce draws; "
     "hapbench converge SCENE --metric NAME"},
    {"", "stability",
     "hapbench limit spring_stiffness, spring_damping or spring_time_step; for --map other studies (hapbench list studies), "
     "for --stress hapbench stress, for --search hapbench sweep SCENE --sample lhs:400 --vary hand.x_N=-5:5"},
    {"", "suite", "hapbench compare GROUP --algorithms all --seeds 5"},
    {"compare", "--check", kErrors},
    {"compare", "--devices", kDevices},
    {"compare", "--friction", kDevices},
    {"compare", "--html", "hapbench report FOLDER, of the comparison's folder"},
    {"compare", "--no-skip", "hapbench run SCENE --no-skip"},
    {"compare", "--resolution", kDevices},
    {"compare", "--sure", kErrors},
    {"compare", "--vibration", kDevices},
    {"converge", "--resume", "the same without it: the runs are made again"},
    {"plot", "--no-sketch", "the same without it: plot draws no sketches"},
    {"reproduce", "--robustness",
     "hapbench reproduce --choices results/reference/readings.csv, or of scripts/readings.py 256"},
    {"reproduce", "--subjects",
     "their record, in the manual of the thesis's claims (scenarios/thesis_claims/README.md)"},
    {"run", "--sure", "hapbench converge SCENE, of the points with --vary environment.spacing_m"},
    {"sweep", "--cpus", kSlurm},
    {"sweep", "--dry-run", kSlurm},
    {"sweep", "--partition", kSlurm},
    {"sweep", "--slurm", kSlurm},
    {"sweep", "--status", "squeue, and the tables sweep.I_of_N.csv that are in the folder"},
    {"sweep", "--time", kSlurm},
};

}  // namespace

void refuse_old_word(const std::string& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  for (const OldWord& old : kOldWords) {
    if (old.word != name || (old.command != command && old.command != "*")) continue;
    throw InputError(fmt::format("{}\"{}\" is no longer known; instead: {}", command.empty() ? "" : command + ": ",
                                 name, old.instead));
  }
}

}  // namespace hapbench
