#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scenarios/thesis_claims/evidence.hpp"

/// The subjects of appendix D inferred from Tables A.1 and A.3, and what they do in the rest of it.
///
/// Approximate Bayesian computation by rejection: a Sobol sequence over what the thesis does not say of its subjects
/// and its task, evenly in ranges from the literature; one subject a sample, in both experiments with both algorithms.
/// The distance to the two tables is
///
///   d = sqrt(mean over their 16 means of min(|ours - published| / s, 5)^2),
///   s^2 = 6 SE^2 + (half a printed digit)^2, of a success rate also + 1 / (4 n),
///
/// with SE the published standard error of six subjects' mean, so that sqrt(6) SE is the spread of a single subject,
/// and 1 / (4 n) the largest variance of a rate of n targets. A missing mean counts as 5. Posterior: the nearest
/// samples.
namespace hapbench {

/// A property of the subjects or their task that the thesis does not give, with the range that the literature allows.
struct SubjectUnknown {
  const char* field;  ///< below "hand", as in --set
  double low, high;   ///< in the unit of the field's name
  bool logarithmic;   ///< evenly in the logarithm
  const char* source;
};
std::span<const SubjectUnknown> subject_unknowns();

/// The inputs of an inference. Threads may share a plan.
struct SubjectsPlan {
  Evidence evidence;
  std::vector<std::vector<double>> values;  ///< of each sample, one for each unknown
  std::shared_ptr<const PointShell> block;  ///< the environment of both experiments

  std::size_t samples() const { return values.size(); }
};
SubjectsPlan plan_subjects(PublishedNumbers published, std::size_t samples);

/// The ids of the published means that enter the distance; they are the columns of a sample, too.
std::vector<std::string> subject_measures();

/// One sample's measures, in their order; NaN where there is none.
struct SubjectSample {
  std::vector<double> measured;
  double distance = 0.0;  ///< NaN when it was given up, since it was too large before all was run
};
/// The standardised difference of a measure, in units of s above; at most 5.
double standardised_difference(const PublishedNumbers& published, const std::string& id, double measured);
/// Runs a sample. Depends on plan and number alone. Throws Stopped.
SubjectSample run_subject(const SubjectsPlan& plan, std::size_t sample);

/// The result of run_subjects. Finished samples stand in subjects.journal, so that the same plan, or one of more
/// samples, goes on from there.
struct SubjectsReport {
  std::vector<SubjectSample> samples;
  std::size_t done = 0;
  int signal = 0;  ///< the signal that stopped it, or 0
};
/// The journal is in `directory`; with `anew`, what an interrupted run has left is not used. Numbers depend neither on
/// `jobs` nor on interruptions. Throws InputError, IoError.
SubjectsReport run_subjects(const SubjectsPlan& plan, const std::filesystem::path& directory, std::size_t jobs,
                            bool anew = false, bool progress = false);

/// subjects.csv: sample, the unknowns, the measures, distance.
std::string subjects_table(const SubjectsPlan& plan, const std::vector<SubjectSample>& samples);
/// subjects.json: unknowns with their posterior, the nearest six as subjects of all of appendix D beside what is
/// published, the verdicts on them, and traces of trials of the nearest. Runs them. Throws Stopped, and InputError when
/// fewer than six samples were run to their end.
Json subjects_json(const SubjectsPlan& plan, const std::vector<SubjectSample>& samples, std::size_t jobs);
/// subjects.json as text for a terminal.
std::string subjects_text(const Json& subjects);

}  // namespace hapbench
