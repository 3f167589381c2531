#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "algorithms/stages/gradient_reduction.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/wording.hpp"
#include "sim/core/random.hpp"

/// Claims of chapter 3: the number of points and what they cost.
namespace hapbench {
namespace {

constexpr const char* kDensities[] = {"signed_distance", "binary"};

// ---- T1, T2, T3: point counts of the tasks, whose raw counts are input. A case for each density.

constexpr double kFewLeft = 0.5;

Measured measure_counts(const Evidence& e, const std::string& task) {
  Measured measured;
  for (const std::string density : kDensities) {
    const std::string name = task + "_" + density;
    const double rows = e.results.number(name, "steps"), contact = e.results.number(name, "metrics.steps_in_contact");
    measured.push_back({density,
                        {{"raw_mean", {e.results.number(name, "metrics.colliding_mean")}},
                         // Over the rows with contact.
                         {"reduced_mean", {e.results.number(name, "metrics.rendered_mean") * rows / contact}},
                         {"reduced_max", {e.results.number(name, "metrics.rendered_max")}}}});
  }
  return measured;
}

std::string counts_text(const Measured& counts) {
  std::string text;
  for (const MeasuredCase& c : counts) {
    text += fmt::format("{}{}: raw {:.1f}, reduced {:.2f}, at most {}", text.empty() ? "" : "; ", c.name, c["raw_mean"],
                        c["reduced_mean"], c["reduced_max"]);
  }
  return text;
}

Finding judge_flat_reduction(const Measured& counts, const PublishedNumbers& published) {
  const bool one = std::all_of(counts.begin(), counts.end(),
                               [&](const MeasuredCase& c) { return c["reduced_max"] == published["T1.reduced"].mean; });
  return {decide(one, false), counts_text(counts),
          one ? "on a flat all gradients are equal, so one point is left" : "more than one point is left on the flat"};
}

/// Near for one of the densities, and never as many as `bound`.
Finding judge_reduced_points(const Measured& counts, const std::vector<Published>& published,
                             std::optional<double> bound) {
  bool near = false, bounded = true, few = true;
  for (const MeasuredCase& c : counts) {
    bool this_near = false;
    for (const Published& p : published) this_near |= std::abs(c["reduced_mean"] - p.mean) <= p.spread;
    const bool this_bounded = !bound || c["reduced_max"] < *bound;
    near |= this_near && this_bounded;
    bounded &= this_bounded;
    few &= c["reduced_mean"] < kFewLeft * c["raw_mean"];
  }
  std::string why = near  ? "the reduced mean of one density lies within a published spread"
                    : few ? "the reduction leaves less than half of the points, but another number than published"
                          : "the reduction leaves more than half of the points";
  if (!bounded) why += fmt::format("; some rows exceed {}", *bound);
  return {decide(near, few), counts_text(counts), why};
}

Finding judge_turning(const Measured& counts, const PublishedNumbers& p) {
  return judge_reduced_points(counts, {p.mean_and_spread("T2.reduced"), p.mean_and_spread("T2.reduced.C3")}, {});
}

Finding judge_spinning(const Measured& counts, const PublishedNumbers& p) {
  return judge_reduced_points(counts, {p.mean_and_spread("T3.reduced"), p.mean_and_spread("T3.reduced.C3")},
                              p["T3.reduced.bound"].at_most);
}

// ---- T4: times of one step's work for 1000 contacts [s].

/// Random contacts round a hole: no two alike.
ContactBuffer thousand_contacts() {
  constexpr std::size_t kContacts = 1000;
  ContactBuffer contacts(kContacts);
  Random random(1);
  for (std::size_t i = 0; i < kContacts; ++i) {
    contacts.push(static_cast<std::uint32_t>(i), Vec3::Zero(), Vec3::UnitZ());
    contacts.set_gradient(i, random.direction());
    contacts.depth[i] = random.uniform(0.0, 1e-4);
  }
  contacts.pad();
  return contacts;
}

/// Three iterations with the n x n matrix of squared inner products, as the thesis writes them.
void shape_with_matrix(ContactBuffer& contacts, std::vector<double>& matrix, std::vector<double>& ratio) {
  const std::size_t n = contacts.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const double product = contacts.gradient(i).dot(contacts.gradient(j));
      matrix[i * n + j] = product * product;
    }
    contacts.weight[i] = 1.0;
  }
  for (int iteration = 0; iteration < 3; ++iteration) {
    for (std::size_t i = 0; i < n; ++i) {
      ratio[i] = 0.0;
      for (std::size_t j = 0; j < n; ++j) ratio[i] += matrix[i * n + j] * contacts.weight[j];
    }
    for (std::size_t i = 0; i < n; ++i) contacts.weight[i] /= ratio[i];
  }
}

Measured measure_deadline(const Evidence&) {
  constexpr int kRepetitions = 20;
  const ContactBuffer all = thousand_contacts();
  ContactBuffer contacts = all;
  std::vector<double> matrix(all.size() * all.size()), ratio(all.size());
  const double dense = seconds_per_call(1, kRepetitions, [&] { shape_with_matrix(contacts, matrix, ratio); });
  const double tensor = seconds_per_call(1, kRepetitions, [&] { shape_weights(contacts, 3); });
  const auto reduction = make_gradient_reduction({});
  reduction->prepare({});
  const double reduced = seconds_per_call(1, kRepetitions, [&] {
    contacts = all;
    reduction->process(contacts);
    shape_weights(contacts, 3);
  });
  return {{"", {{"matrix", {dense}}, {"reduced", {reduced}}, {"tensor", {tensor}}}}};
}

Finding judge_deadline(const Measured& measured, const PublishedNumbers& published) {
  const MeasuredCase& m = measured.at(0);
  const double deadline = published["T4.step"].mean;
  const bool missed = m["matrix"] > deadline, met = m["reduced"] < deadline;
  return {
      decide(missed && met, met),
      fmt::format("1000 contacts: n x n matrix {:.0f} us, reduced first {:.1f} us, tensor without reduction {:.1f} us; "
                  "deadline {:.0f} us",
                  1e6 * m["matrix"], 1e6 * m["reduced"], 1e6 * m["tensor"], 1e6 * deadline),
      missed ? "the matrix form misses the deadline and the reduction meets it; the tensor form needs no reduction"
             : "this machine is fast enough for the matrix form; the reduction meets the deadline, too"};
}

constexpr Claim kClaims[] = {
    {.id = "T1",
     .place = "3.3, Fig. 4, C.2a",
     .claim = "on a flat the reduction always leaves one point",
     .published = "raw 44.8 +- 19.9, reduced 1",
     .rule =
         [](const PublishedNumbers& published) {
           return fmt::format("reproduced: never more than {}", in_words(published["T1.reduced"].mean));
         },
     .measure = [](const Evidence& e) { return measure_counts(e, "task1_flat"); },
     .judge = judge_flat_reduction},
    {.id = "T2",
     .place = "3.3, Fig. 4, C.2b",
     .claim = "turning in the hole, the reduction leaves a few points",
     .published = "raw 37.8 +- 17.7, reduced 6.21 +- 1.7 (C.3: 34.1 +- 19.5, 5.5 +- 1.9)",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format("reproduced: one density within a published spread; in kind: less than {} are left",
                              in_words(kFewLeft));
         },
     .measure = [](const Evidence& e) { return measure_counts(e, "task2_rotate"); },
     .judge = judge_turning},
    {.id = "T3",
     .place = "3.3, Fig. 4, C.2c",
     .claim = "spinning in the hole, fewer than 15 points are left",
     .published = "raw 231.5 +- 116.1, reduced 6.5 +- 2.1 (C.3: 163.7 +- 103.1, 5.2 +- 1.7), below 15",
     .rule =
         [](const PublishedNumbers& published) {
           return fmt::format(
               "reproduced: one density within a published spread and below {}; in kind: less than {} "
               "are left",
               plain(published["T3.reduced.bound"].at_most), in_words(kFewLeft));
         },
     .measure = [](const Evidence& e) { return measure_counts(e, "task3_spin"); },
     .judge = judge_spinning},
    {.id = "T4",
     .place = "2.8, 3.1",
     .claim = "1000 points cannot be rendered in 0.5 ms without the reduction, and can with it",
     .published = "0.5 ms",
     .rule =
         [](const PublishedNumbers&) {
           return std::string("reproduced: the matrix form misses the deadline, the reduction meets it");
         },
     .measure = measure_deadline,
     .judge = judge_deadline,
     .timing = true},
};

}  // namespace

std::span<const Claim> chapter_3_reduction() {
  return kClaims;
}

}  // namespace hapbench
