#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "device_model/admittance_device.hpp"
#include "device_model/hands/scripted_hands.hpp"
#include "sim/loop/simulation.hpp"
#include "tests/support/setting.hpp"

/// Fake parts of a simulation, so that a test of the simulation loop depends on no other code.
namespace hapbench::test {

/// An environment that has a constant number of contacts, all at the tool's position. With 0 contacts, the tool never
/// touches it.
class FakeSource final : public ContactSource {
 public:
  explicit FakeSource(std::size_t contacts = 0) : contacts_(contacts) {}

  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override {
    contacts.clear();
    for (std::size_t i = 0; i < contacts_; ++i) {
      contacts.push(static_cast<std::uint32_t>(i), pose.position, Vec3::UnitZ());
      contacts.set_gradient(i, -Vec3::UnitZ());
    }
    contacts.pad();
    ++work_.queries;
  }
  std::size_t capacity() const noexcept override { return contacts_; }
  void reset() noexcept override { work_ = {}; }
  const SearchWork& work() const noexcept override { return work_; }

 private:
  std::size_t contacts_;
  SearchWork work_;
};

/// Counts the calls of each function of a FakeAlgorithm.
struct Calls {
  int prepare = 0;
  int reset = 0;
  int compute = 0;
};

/// Renders a force that is a given function of the tool's state, with the stiffness tensor 2 I.
class FakeAlgorithm final : public ForceAlgorithm {
 public:
  using Law = std::function<Vec3(const ToolState&)>;
  explicit FakeAlgorithm(Law law, Calls* calls = nullptr) : law_(std::move(law)), calls_(calls) {}

  void prepare(const Scene&) override {
    if (calls_ != nullptr) ++calls_->prepare;
  }
  void reset() noexcept override {
    if (calls_ != nullptr) ++calls_->reset;
  }
  void compute(const ToolState& tool, ContactBuffer&, RenderedForce& out) noexcept override {
    if (calls_ != nullptr) ++calls_->compute;
    out = {};
    out.spring = out.rendered = law_(tool);
    out.S = 2.0 * Mat3::Identity();
  }
  SpringState spring_state(const ToolState&, const ContactBuffer&) const noexcept override { return {}; }
  ForceJacobian jacobian() const noexcept override { return {}; }

 private:
  Law law_;
  Calls* calls_;
};

/// Keeps the record of every step in `rows`, and its number of rendered contacts in `rendered`. In the kept records,
/// the pointer StepRecord::rendered is null, because the contact buffer does not outlive the step.
class Recorder final : public Observer {
 public:
  explicit Recorder(bool wants_ratio = false) : wants_ratio_(wants_ratio) {}

  bool wants_ratio() const noexcept override { return wants_ratio_; }
  void on_step(const StepRecord& record) noexcept override {
    rows.push_back(record);
    rendered.push_back(record.rendered->size());
    rows.back().rendered = nullptr;
  }

  std::vector<StepRecord> rows;
  std::vector<std::size_t> rendered;

 private:
  bool wants_ratio_;
};

/// Returns the parts for a free tool with the axis -z. The only force on the tool is `law`.
inline SimulationParts fake_parts(FakeAlgorithm::Law law, Calls* calls = nullptr) {
  SimulationParts parts;
  parts.source = std::make_unique<FakeSource>();
  parts.algorithm = std::make_unique<FakeAlgorithm>(std::move(law), calls);
  parts.motion = constant_axis(-Vec3::UnitZ());
  parts.hand = std::make_unique<ForceHand>();
  parts.device = std::make_unique<IdealDevice>(std::nullopt);
  return parts;
}

/// Returns the configuration of a run of `steps` steps in which the tool flies past the origin.
inline SimulationConfig thrown(std::uint64_t steps) {
  SimulationConfig config;
  config.steps = steps;
  config.position = {0.001, 0.0005, 0};
  config.velocity = {0.02, -0.01, 0.03};
  return config;
}

/// A force law without force.
inline Vec3 weightless(const ToolState&) {
  return Vec3::Zero();
}

/// Does one step of the leapfrog integrator. Leapfrog evaluates no further forces within the step.
inline void leapfrog(ToolState& tool, const Vec3& force, double mass, double dt) {
  class NoField final : public ForceField {
   public:
    Vec3 force_at(double, const Vec3&, const Vec3&) noexcept override { return Vec3::Zero(); }
    ForceJacobian jacobian() const noexcept override { return {}; }
  } field;
  kLeapfrog.step(tool, force, mass, dt, field, kEventTolerance);
}

}  // namespace hapbench::test
