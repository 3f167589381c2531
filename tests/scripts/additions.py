"""Parts that adding_test.py adds to a copy of the source tree. Each part has a largest number of files that it may
change, and its edits."""
import shutil

from fixture import SOURCE


class Tree:
    """A copy of the current source tree."""

    def __init__(self, folder):
        self.folder = shutil.copytree(
            SOURCE,
            folder,
            symlinks=True,
            ignore=shutil.ignore_patterns(".git", "build", "out", "__pycache__"),
        )

    def edit(self, anchor, new):
        """Replaces the text `anchor` by `new`. The anchor must occur exactly once in the sources. Returns the name of
        the file."""
        folders = [
            self.folder / name
            for name in ("sim", "algorithms", "device_model", "results", "scenarios")
        ]
        sources = [file for folder in folders for file in folder.rglob("*.[hc]pp")]
        found = [
            str(file.relative_to(self.folder))
            for file in sources
            for _ in range(file.read_text().count(anchor))
        ]
        if len(found) != 1:
            raise AssertionError(f"{anchor!r} stands in {found}; wanted: one place")
        return self.write(found[0], (self.folder / found[0]).read_text().replace(anchor, new))

    def write(self, name, text):
        (self.folder / name).write_text(text)
        return name


def behind(anchor, new):
    return Tree.edit, anchor, anchor + new


def before(anchor, new):
    return Tree.edit, anchor, new + anchor


# Function that every environment must have. Without it, the code does not compile.
INSIDE = """
static std::unique_ptr<const Solid> make_solid(const RidgeEnvironment& ridge) {
  return make_solid(surface_points(ridge));
}

"""

# For each addition, the largest number of files that it may change, and its edits.
ADDITIONS = {
    "law": (
        3,
        [
            (
                Tree.write,
                "algorithms/laws/halved.cpp",
                """#include "algorithms/registry.hpp"

namespace hapbench {

class Halved final : public ForceLaw {
 public:
  using ForceLaw::ForceLaw;

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    set_weights(contacts, 0.5);
    return weighted_force(contacts, K_);
  }
};

AlgorithmEntry halved_entry() {
  static constexpr ModelInfo kInfo = {.name = "halved",
                                      .summary = "half of all penalty springs",
                                      .formula = "c_i = 1/2",
                                      .source = "a test",
                                      .known_failure = "none that is known",
                                      .parameters = kStiffnessAlone};
  return {.info = &kInfo, .make_law = law_of<Halved>};
}

}  // namespace hapbench
""",
            ),
            behind("              entry(static_coupling)", " entry(halved)"),
        ],
    ),
    "environment": (
        3,
        [
            before(
                "using Environment = std::variant<",
                """struct RidgeEnvironment {
  double height = 0.001;   ///< [m]
  double spacing = 0.0005;  ///< [m]
};
""",
            ),
            behind("using Environment = std::variant<SpringsEnvironment, ", "RidgeEnvironment, "),
            behind(
                """{"springs", "springs that act on the tool's tip, without a surface"},
""",
                """             {"ridge", "a row of points"},
""",
            ),
            before(
                "void describe(Fields& f, Environment& environment) {",
                """static void describe(Fields& f, RidgeEnvironment& ridge) {
  f.number("height_m", ridge.height, kLength, "height of the row");
  f.number("spacing_m", ridge.spacing, kLength, "distance of neighbours");
}

static std::vector<SurfacePoint> surface_points(const RidgeEnvironment& ridge) {
  std::vector<SurfacePoint> points;
  for (int i = -5; i <= 5; ++i) points.push_back({{ridge.spacing * i, 0.0, ridge.height}, Vec3::UnitZ()});
  return points;
}
"""
                + INSIDE,
            ),
        ],
    ),
    "tool": (
        3,
        [
            behind("using ToolFields = std::variant<CylinderFields, ", "TaperFields, "),
            before(
                "using ToolFields = std::variant<",
                """struct TaperFields {
  double width = 0.002;  ///< at the far end [m]
};
""",
            ),
            behind(
                """    {"cylinder", "cylinder with a flat or a round tip, like a drill's stylus"},
""",
                """    {"taper", "a cone that ends in a narrow tip"},
""",
            ),
            before(
                "void describe(Fields& f, ToolFields& tool) {",
                """static void describe(Fields& f, TaperFields& tool) {
  f.number("width_m", tool.width, kLength, "width of the far end");
}

""",
            ),
            before(
                "  std::shared_ptr<const ToolShape> operator()(const RevolvedFields& f) const {\n",
                """  std::shared_ptr<const ToolShape> operator()(const TaperFields& f) const {
    return std::make_shared<Revolved>(std::vector<ProfilePoint>{{-0.01, f.width / 2.0}, {0.0, 0.0005}}, Tip::flat);
  }
""",
            ),
        ],
    ),
    "named file": (
        2,
        [
            behind(
                "struct PushHandFields {\n", "  std::optional<std::string> file;  ///< of notes\n"
            ),
            behind(
                """static void describe(Fields& f, PushHandFields& hand) {
""",
                """  f.if_any(kFileField, hand.file, "a stroke to compare with",
           [](Fields& s, std::string& path) { s.file(path, {FileContent::Kind::stroke}); });
""",
            ),
        ],
    ),
    "device field": (
        2,
        [
            behind(
                "struct ImpedanceDeviceConfig {\n",
                "  double play = 0.0;  ///< of the transmission [m]\n",
            ),
            before(
                '  f.number("viscous_N_s_per_m", device.viscous,',
                '  f.number("play_m", device.play, {0.0, 1.0, "m"}, "play of the transmission");\n',
            ),
        ],
    ),
    "trajectory column": (
        2,
        [
            behind("struct TrajectoryExtras {\n", "  bool speed = false;\n"),
            before(
                "constexpr TrajectoryGroup kGroups[] = {\n",
                """constexpr Column kSpeedColumns[] = {{"speed_m_per_s", "m/s", "norm of its velocity"}};

""",
            ),
            behind(
                "constexpr TrajectoryGroup kGroups[] = {\n",
                """    {&TrajectoryExtras::speed, "speed", "add the tip's speed to trajectory.csv, speed_m_per_s",
     kSpeedColumns,
     [](const StepRecord& r, const InsideObserver*, std::optional<double>* cells) { *cells = r.tool.velocity.norm(); }},
""",
            ),
        ],
    ),
    "command": (
        3,
        [
            (
                Tree.write,
                "scenarios/program/twice.hpp",
                """#pragma once

#include "scenarios/program/command_line.hpp"

namespace hapbench {

void add_twice(CommandLine& line);

}  // namespace hapbench
""",
            ),
            (
                Tree.write,
                "scenarios/program/twice.cpp",
                """#include "scenarios/program/twice.hpp"

#include "scenarios/program/exit_status.hpp"
#include "scenarios/program/output.hpp"

namespace hapbench {

struct TwiceOptions {
  std::string word;
  OutputOptions output;
};

static int twice(const TwiceOptions& options, ProgramContext& context) {
  print(context, options.output, options.word + " " + options.word + "\\n", Json(options.word));
  return kSuccess;
}

void add_twice(CommandLine& line) {
  auto [command, options] = line.command("twice", "Print a word two times", twice);
  command.add("word", options.word, "what to print", {.required = true});
}

}  // namespace hapbench
""",
            ),
            before(
                '#include "scenarios/program/validate.hpp"\n\nnamespace hapbench {',
                '#include "scenarios/program/twice.hpp"\n',
            ),
            behind(
                "constexpr CommandGuide kCommands[] = {",
                '\n    {"look", "twice", "what is a word two times?", add_twice, "twice this"},',
            ),
        ],
    ),
    "metric section": (
        2,
        [
            (
                Tree.write,
                "results/observe/stillness.hpp",
                """#pragma once

#include "results/observe/metric_observer.hpp"

namespace hapbench {

class StillnessObserver final : public MetricObserver {
 public:
  void begin(const TrialParts&) override { *this = {}; }
  void on_step(const StepRecord& record) noexcept override { still_ += record.tool.velocity.isZero(0.0) ? 1.0 : 0.0; }
  void report(Section& s) const override { s.metric("still", "1", "rows in which the tool did not move", still_); }

 private:
  double still_ = 0.0;
};

}  // namespace hapbench
""",
            ),
            before(
                '#include "results/observe/target_metrics.hpp"\n#include "scenarios/scene/six_dof_observer.hpp"\n\n'
                "namespace hapbench {\nnamespace {\n\n"
                "/// A section of the summary: its name, the condition under which a run has it, and its observer.\n",
                '#include "results/observe/stillness.hpp"\n',
            ),
            behind(
                "make<PassivityObserver>, true},\n",
                """    {"stillness", [](const Scenario& s, bool) { return std::size_t{s.record.pose}; },
     make<StillnessObserver>},
""",
            ),
        ],
    ),
}
