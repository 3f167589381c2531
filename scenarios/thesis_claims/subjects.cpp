#include "scenarios/thesis_claims/subjects.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "results/io/json_text.hpp"
#include "results/summary/provenance.hpp"
#include "scenarios/batch/journal.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/batch/sampling.hpp"
#include "scenarios/batch/statistics.hpp"
#include "scenarios/batch/sweep_points.hpp"
#include "scenarios/description/parts.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/thesis_claims/experiments.hpp"
#include "sim/core/hash.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kSubjects = 6;         ///< D.1.3
constexpr std::size_t kTargetsPerPlace = 3;  ///< of a sample
constexpr double kLargestDifference = 5.0;   ///< beyond, nothing more is learnt
constexpr double kGiveUp = 2.0;              ///< a sample at this distance is not run to its end
constexpr double kKept = 0.05;               ///< the posterior, as a share of the samples
constexpr double kOutOfReach = 2.0;          ///< standard errors of the difference
constexpr const char* kTrialAlgorithms[] = {"shaped_stiffness", "original_averaging"};

constexpr SubjectUnknown kUnknowns[] = {
    {"subjects.0.motor_noise_N", 0.02, 0.15, true,
     "Baweja et al. 2009 (Exp Brain Res 197:35): a force held by eye varies by 4.5 ± 3.1 %, here of 1.4 to 2 N"},
    {"subjects.0.noise_bandwidth_Hz", 6.0, 12.0, false,
     "Lakie et al. 2015 (J Physiol 593:4411): tremor of the hand has its peak between 6 and 12 Hz"},
    {"subjects.0.tilt_noise_rad", 0.001, 0.01, true,
     "Riviere et al. 1997: 49 µm rms at an instrument's tip held still, 133 µm moved; 13 to 50 mm from the fingers"},
    {"subjects.0.reaction_delay_s", 0.12, 0.3, false,
     "Saunders and Knill 2005 (Exp Brain Res 162:458): corrections by eye after 117 to 200 ms; the upper end is ours"},
    {"subjects.0.bandwidth_Hz", 0.2, 1.0, true,
     "McRuer and Jex 1967: crossover near 3 rad/s, 0.5 Hz; half and twice of it"},
    {"subjects.0.press_bandwidth_Hz", 0.2, 1.0, true, "as bandwidth_Hz"},
    {"subjects.0.stiffness_N_per_m", 100.0, 1000.0, true,
     "Hasser and Cutkosky 2002, Fu and Cavusoglu 2012: it grows with the grip; the ends are ours"},
    {"subjects.0.damping_N_s_per_m", 2.0, 20.0, true, "as stiffness_N_per_m"},
    {"subjects.0.press_N", 1.2, 2.2, false, "above the 1 N that is asked for; the limiter passes 2 N"},
    {"task.tolerance_m", 2e-5, 2.5e-4, true, "no radius of the red circle is published; to 0.26 mm two do not overlap"},
    {"task.threshold.cutoff_Hz", 30.0, 3000.0, true, "from what can be read off a gauge to practically every sample"},
    {"task.threshold.grace_s", 0.0, 0.1, false, "none is published"},
};

struct Experiment {
  const char *id, *task;
  std::size_t place;
  bool difference;  ///< the thesis publishes the difference of the algorithms, too
  bool fitted;
};
constexpr Experiment kExperiments[] = {{"D1", "vertical", 1, true, true},
                                       {"D2", "vertical", 0, false, false},
                                       {"D3", "rotational", 0, true, true},
                                       {"D4", "rotational", 1, true, false}};

struct Measure {
  const char* name;  ///< part of the id
  SubjectMean PlaceMetrics::*mean;
};
constexpr Measure kTrialMeasures[] = {{"success", &PlaceMetrics::success_rate},
                                      {"time", &PlaceMetrics::completion_time},
                                      {"force", &PlaceMetrics::model_force},
                                      {"speed", &PlaceMetrics::speed}};

std::string scenario_of(const char* task, const char* algorithm) {
  return fmt::format("{}_peg_in_hole_{}", task, algorithm);
}

/// Numbers of the record have the digits that people read.
std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : "";
}

Json rounded(double value) {
  const std::optional<double> read = finite_number(number(value));
  return read ? Json(*read) : Json();
}

/// The scenario with the sample's subject in it.
LoadedScenario load(const SubjectsPlan& plan, std::size_t sample, const std::string& scenario,
                    std::span<const std::string> more) {
  std::vector<std::string> overrides = {"hand.subjects=[{}]", fmt::format("seed={}", sample + 1)};
  for (std::size_t i = 0; i < std::size(kUnknowns); ++i) {
    overrides.push_back(
        fmt::format("hand.{}={}", kUnknowns[i].field, std::string_view(NumberText(plan.values[sample][i]))));
  }
  overrides.insert(overrides.end(), more.begin(), more.end());
  return plan.evidence.load(scenario, overrides);
}

std::vector<TargetRow> run(const SubjectsPlan& plan, std::size_t sample, const std::string& scenario,
                           std::span<const std::string> more) {
  return run_with_shell(load(plan, sample, scenario, more), plan.block, std::nullopt, false).targets;
}

/// The samples that were run to their end, nearest first.
std::vector<std::size_t> nearest(const std::vector<SubjectSample>& samples) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!std::isnan(samples[i].distance)) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&samples](std::size_t a, std::size_t b) { return samples[a].distance < samples[b].distance; });
  return order;
}

}  // namespace

std::span<const SubjectUnknown> subject_unknowns() {
  return kUnknowns;
}

SubjectsPlan plan_subjects(PublishedNumbers published, std::size_t samples) {
  SubjectsPlan plan{{std::move(published), ResultFiles({}, {})}, {}, nullptr};
  const UnitSample points({SamplingMethod::sobol, samples, kSeed}, std::size(kUnknowns));
  for (std::size_t sample = 0; sample < samples; ++sample) {
    std::vector<double>& values = plan.values.emplace_back();
    for (std::size_t i = 0; i < std::size(kUnknowns); ++i) {
      const SubjectUnknown& u = kUnknowns[i];
      // As subjects.csv has them, so that a row can be run again.
      values.push_back(
          finite_number(number(Range{u.low, u.high, u.logarithmic}.value_at(points.at(sample, i)))).value());
    }
  }
  plan.block = plan.evidence.shell(plan.evidence.load(scenario_of("vertical", kTrialAlgorithms[0])));
  return plan;
}

std::vector<std::string> subject_measures() {
  std::vector<std::string> ids;
  for (const char* algorithm : kTrialAlgorithms) {
    for (const Experiment& e : kExperiments) {
      for (const Measure& m : kTrialMeasures) {
        if (e.fitted) ids.push_back(fmt::format("{}.{}.{}", e.id, m.name, algorithm));
      }
    }
  }
  return ids;
}

double standardised_difference(const PublishedNumbers& published, const std::string& id, double measured) {
  if (std::isnan(measured)) return kLargestDifference;
  const PublishedNumber& p = published[id];
  double variance = static_cast<double>(kSubjects) * p.spread * p.spread + math::square(half_a_digit(p.mean));
  if (id.find(".success.") != std::string::npos) variance += 0.25 / static_cast<double>(kTargetsPerPlace);
  return std::min(std::abs(measured - p.mean) / std::sqrt(variance), kLargestDifference);
}

SubjectSample run_subject(const SubjectsPlan& plan, std::size_t sample) {
  const std::vector<std::string> ids = subject_measures();
  const std::string overrides[] = {"hand.trials=1", fmt::format("hand.task.targets_per_place={}", kTargetsPerPlace)};
  SubjectSample result{std::vector<double>(ids.size(), std::nan("")), std::nan("")};
  double sum = 0.0;
  std::size_t next = 0;
  // Stiffness shaping first: its runs are short, and hands that miss the targets with it are given up soon.
  for (const char* algorithm : kTrialAlgorithms) {
    for (const Experiment& e : kExperiments) {
      if (!e.fitted) continue;
      const auto places = place_metrics(run(plan, sample, scenario_of(e.task, algorithm), overrides));
      for (const Measure& m : kTrialMeasures) {
        const SubjectMean& mean = places.at(e.place).*m.mean;
        if (mean.subjects > 0) result.measured[next] = mean.mean;
        sum += math::square(standardised_difference(plan.evidence.published, ids[next], result.measured[next]));
        ++next;
      }
      if (sum > kGiveUp * kGiveUp * static_cast<double>(ids.size())) return result;
    }
  }
  result.distance = std::sqrt(sum / static_cast<double>(ids.size()));
  return result;
}

namespace {

std::string header() {
  std::vector<std::string> columns = {"sample"};
  for (const SubjectUnknown& u : kUnknowns) columns.emplace_back(u.field);
  for (const std::string& id : subject_measures()) columns.push_back(id);
  return fmt::format("{},distance", fmt::join(columns, ","));
}

std::string row(const SubjectsPlan& plan, std::size_t sample, const SubjectSample& result) {
  std::vector<std::string> cells = {std::to_string(sample)};
  for (const double value : plan.values[sample]) cells.push_back(number(value));
  for (const double value : result.measured) cells.push_back(number(value));
  return fmt::format("{},{}", fmt::join(cells, ","), number(result.distance));
}

SubjectSample read_row(std::string_view text) {
  SubjectSample result;
  const Words cells = parts_of(text, ',');
  for (std::size_t i = 1 + std::size(kUnknowns); i < cells.size(); ++i) {
    result.measured.push_back(finite_number(cells[i]).value_or(std::nan("")));
  }
  result.distance = result.measured.back();
  result.measured.pop_back();
  return result;
}

/// Everything that a sample depends on, not how many there are: more samples go on where fewer ended. Empty for a
/// program that cannot be told from another one.
std::string definition(const SubjectsPlan& plan) {
  const std::string program = provenance().identity();
  if (program.empty()) return "";
  Json content = {{"table", header()}, {"seed", kSeed}, {"program", program}};
  for (const char* algorithm : kTrialAlgorithms) {
    for (const char* task : {"vertical", "rotational"}) {
      const LoadedScenario loaded = plan.evidence.load(scenario_of(task, algorithm));
      content["scenarios"].push_back(scenario_hash(loaded.scenario, loaded.files));
    }
  }
  return "subjects " + hash_text(hash_of(json_text(content)));
}

}  // namespace

SubjectsReport run_subjects(const SubjectsPlan& plan, const fs::path& directory, std::size_t jobs, bool anew,
                            bool progress) {
  const fs::path file = directory / "subjects.journal";
  const std::string title = definition(plan);
  const bool resume = !anew && !title.empty() && Journal::is_of(file, title);
  SubjectsReport report;
  report.samples.resize(plan.samples());
  std::vector<bool> done(plan.samples());
  const auto found = [&](Journal::Place, std::string_view text) {
    const auto sample = whole_number(text.substr(0, text.find(',')));
    if (sample && *sample >= plan.samples()) return;  // of a run of more samples
    if (!sample || row(plan, *sample, read_row(text)) != text)
      fail_in_file(file, fmt::format("got the row \"{}\"; allowed: rows of this plan", text.substr(0, 60)));
    report.samples[*sample] = read_row(text);
    done[*sample] = true;
    ++report.done;
  };
  Journal journal(file, title, resume, found);
  std::vector<std::size_t> left;
  for (std::size_t sample = 0; sample < plan.samples(); ++sample) {
    if (!done[sample]) left.push_back(sample);
  }
  ProgressBar bar("subjects", plan.samples(), progress);
  bar.start_at(report.done);
  const auto work = [&](std::size_t sample) -> Delivery {
    try {
      const std::string text = row(plan, sample, run_subject(plan, sample));
      return [&, sample, text] {
        journal.add(text);
        journal.flush();
        report.samples[sample] = read_row(text);  // rounded, as a resumed one is
        bar.show(++report.done, true);
      };
    } catch (const Stopped&) {
      return {};  // the same command runs it
    }
  };
  parallel_for(left, jobs, work, [] { return StopSignal::received() != 0; });
  if (report.done < plan.samples()) report.signal = StopSignal::received();
  return report;
}

std::string subjects_table(const SubjectsPlan& plan, const std::vector<SubjectSample>& samples) {
  std::string text = header() + "\n";
  for (std::size_t sample = 0; sample < samples.size(); ++sample) text += row(plan, sample, samples[sample]) + "\n";
  return text;
}

namespace {

/// The prior and the posterior of each unknown.
Json unknowns_json(const SubjectsPlan& plan, std::span<const std::size_t> kept) {
  Json all = Json::array();
  for (std::size_t i = 0; i < std::size(kUnknowns); ++i) {
    const SubjectUnknown& u = kUnknowns[i];
    std::vector<double> values;
    for (const std::size_t sample : kept) values.push_back(plan.values[sample][i]);
    all.push_back({{"field", u.field},
                   {"range", {u.low, u.high}},
                   {"scale", u.logarithmic ? "log" : "linear"},
                   {"source", u.source},
                   {"nearest", plan.values[kept[0]][i]},
                   {"q05", rounded(quantile_of(values, 0.05))},
                   {"q50", rounded(quantile_of(values, 0.5))},
                   {"q95", rounded(quantile_of(values, 0.95))}});
  }
  return all;
}

/// The targets of these samples as subjects 0, 1, …
std::vector<TargetRow> run_all(const SubjectsPlan& plan, std::span<const std::size_t> samples, std::size_t jobs,
                               const std::string& scenario, std::span<const std::string> overrides) {
  std::vector<std::vector<TargetRow>> of_each(samples.size());
  for_each_job(samples.size(), {static_cast<unsigned>(jobs), ""}, [&](std::size_t i) {
    of_each[i] = run(plan, samples[i], scenario, overrides);
    for (TargetRow& target : of_each[i]) target.subject = i;
  });
  std::vector<TargetRow> all;
  for (const auto& rows : of_each) all.insert(all.end(), rows.begin(), rows.end());
  return all;
}

TargetTable table_of(const std::vector<TargetRow>& rows) {
  TargetTable table;
  for (const TargetRow& r : rows) {
    table["place"].push_back(static_cast<double>(r.result.place));
    table["subject"].push_back(static_cast<double>(r.subject));
    table["removed"].push_back(r.result.removed ? 1.0 : 0.0);
    table["time_s"].push_back(r.result.time);
    table["model_force_N"].push_back(r.rows_on_target > 0 ? r.model_force : std::nan(""));
    table["speed_m_per_s"].push_back(r.rows_on_target > 0 ? r.speed : std::nan(""));
  }
  return table;
}

/// Adds a row for each published mean.
void compare(const std::vector<TargetRow>& rows, const Experiment& e, const char* algorithm,
             const PublishedNumbers& published, Json& beside) {
  const auto places = place_metrics(rows);
  for (const Measure& m : kTrialMeasures) {
    const std::string id = fmt::format("{}.{}.{}", e.id, m.name, algorithm);
    const PublishedNumber& p = published[id];
    const SubjectMean& mean = places.at(e.place).*m.mean;
    const double allowed = kOutOfReach * math::hypot(p.spread, mean.standard_error) + half_a_digit(p.mean);
    const bool any = mean.subjects > 0;
    beside.push_back({{"id", id},
                      {"fitted", e.fitted},
                      {"published", p.mean},
                      {"published_standard_error", p.spread},
                      {"mean", any ? rounded(mean.mean) : Json()},
                      {"standard_error", any ? rounded(mean.standard_error) : Json()},
                      {"within_reach", any && std::abs(mean.mean - p.mean) <= allowed}});
  }
}

Json verdict_json(const char* id, bool fitted, const Finding& finding) {
  return {{"id", id},
          {"fitted", fitted},
          {"verdict", verdict_name(finding.verdict)},
          {"measured", finding.measured},
          {"why", finding.why}};
}

/// The nearest subject's first try at the target at 3 mm, in spans of time: height of the tip, and least and greatest
/// rendered force along z.
Json trace(const SubjectsPlan& plan, std::size_t sample, const char* algorithm) {
  constexpr double kSpan = 0.05;
  const std::string overrides[] = {"hand.trials=1", "hand.task.targets_per_place=1",
                                   "hand.task.places_m=[[0,0,-0.002]]"};
  Json time = Json::array(), height = Json::array(), least = Json::array(), greatest = Json::array();
  double begin = 0.0, low = 0.0, high = 0.0;
  bool any = false, removed = false;
  const auto add = [&](const StepRecord& r) {
    if (!r.task->results().empty()) removed = r.task->results()[0].removed;
    const double z = r.force.rendered.z();
    low = any ? std::min(low, z) : z;
    high = any ? std::max(high, z) : z;
    any = true;
    if (r.time < begin + kSpan && !r.task->finished()) return;
    time.push_back(rounded(r.time));
    height.push_back(rounded(r.tool.pose.position.z()));
    least.push_back(rounded(low));
    greatest.push_back(rounded(high));
    begin = r.time;
    any = false;
  };
  plan.evidence.for_each_row(load(plan, sample, scenario_of("rotational", algorithm), overrides), add);
  return {{"algorithm", algorithm}, {"removed", removed}, {"time_s", time},
          {"z_m", height},          {"least_N", least},   {"greatest_N", greatest}};
}

}  // namespace

Json subjects_json(const SubjectsPlan& plan, const std::vector<SubjectSample>& samples, std::size_t jobs) {
  const std::vector<std::size_t> order = nearest(samples);
  if (order.size() < kSubjects)
    throw InputError(fmt::format("only {} of {} samples come near the tables; needed are {}: take more samples",
                                 order.size(), samples.size(), kSubjects));
  const auto wanted = static_cast<std::size_t>(kKept * static_cast<double>(samples.size()));
  const std::span kept(order.data(), std::clamp(wanted, kSubjects, order.size()));
  const PublishedNumbers& published = plan.evidence.published;
  const auto run_nearest = [&, subjects = kept.first(kSubjects)](const std::string& scenario,
                                                                 std::span<const std::string> overrides) {
    return run_all(plan, subjects, jobs, scenario, overrides);
  };
  Json beside = Json::array(), verdicts = Json::array();
  for (const char* task : {"vertical", "rotational"}) {
    std::map<std::string, std::vector<TargetRow>> rows;
    for (const char* algorithm : kTrialAlgorithms) rows[algorithm] = run_nearest(scenario_of(task, algorithm), {});
    for (const Experiment& e : kExperiments) {
      if (std::string_view(e.task) != task) continue;
      for (const char* algorithm : kTrialAlgorithms) compare(rows[algorithm], e, algorithm, published, beside);
      const Measured measured = measure_experiment(table_of(rows["original_averaging"]),
                                                   table_of(rows["shaped_stiffness"]), static_cast<double>(e.place));
      verdicts.push_back(verdict_json(e.id, e.fitted, judge_experiment(measured, published, e.id, e.difference)));
    }
  }
  verdicts.push_back(verdict_json("D6", false, judge_pilots(measure_pilots(run_nearest), published)));
  Json chosen = Json::array(), traces = Json::array();
  for (const std::size_t sample : kept.first(kSubjects)) {
    chosen.push_back({{"sample", sample}, {"distance", samples[sample].distance}});
  }
  for (const char* algorithm : kTrialAlgorithms) traces.push_back(trace(plan, kept[0], algorithm));
  return {{"samples", samples.size()},
          {"given_up", samples.size() - order.size()},
          {"posterior", kept.size()},
          {"largest_distance", samples[kept.back()].distance},
          {"seed", kSeed},
          {"targets_per_place", kTargetsPerPlace},
          {"unknowns", unknowns_json(plan, kept)},
          {"subjects", chosen},
          {"beside", beside},
          {"verdicts", verdicts},
          {"traces", traces}};
}

std::string subjects_text(const Json& subjects) {
  std::string text =
      fmt::format("{} samples, {} given up; posterior: the nearest {}, at a distance of {:.3g} to {:.3g}\n",
                  subjects["samples"].get<int>(), subjects["given_up"].get<int>(), subjects["posterior"].get<int>(),
                  subjects["subjects"][0]["distance"].get<double>(), subjects["largest_distance"].get<double>());
  for (const Json& v : subjects["verdicts"]) {
    text += fmt::format("\n{} ({}): {}\n  {}\n  {}\n", v["id"].get<std::string>(),
                        v["fitted"].get<bool>() ? "fitted" : "predicted", v["verdict"].get<std::string>(),
                        v["measured"].get<std::string>(), v["why"].get<std::string>());
  }
  std::string out;
  for (const Json& b : subjects["beside"]) {
    if (!b["within_reach"].get<bool>()) append_item(out, b["id"].get<std::string>(), ", ");
  }
  return text + "\nout of reach, by two standard errors of the difference: " + (out.empty() ? "nothing" : out) + "\n";
}

}  // namespace hapbench
