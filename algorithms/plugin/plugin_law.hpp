#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "algorithms/plugin/hapbench_plugin.h"
#include "algorithms/registry.hpp"

namespace hapbench {

/// A law behind the C interface. It reads the contacts of the step in place. A step adds one indirect call and a check
/// that the answer is finite and that nothing beyond it was written; it does not allocate. What the plugin throws is a
/// fault like an error that it reports.
class PluginLaw final : public SingleSpringLaw {
 public:
  /// `plugin` must outlive the law; `parameters` are in its order.
  PluginLaw(const HapbenchPlugin& plugin, double stiffness, std::vector<double> parameters);
  ~PluginLaw() override;
  PluginLaw(const PluginLaw&) = delete;
  PluginLaw& operator=(const PluginLaw&) = delete;

  void prepare(std::size_t capacity) override;
  void reset() noexcept override;
  /// After a fault the force is NaN until the next reset.
  LawForce evaluate(ContactBuffer& contacts) noexcept override;
  SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept override;
  const char* fault() const noexcept override { return fault_[0] == '\0' ? nullptr : fault_.data(); }

 private:
  LawForce failed(const char* problem) const noexcept;
  LawForce failed(int error) noexcept;
  /// Calls `call`, which runs the plugin's function of that name; an exception is a fault. Returns whether none came.
  template <class Call>
  bool runs(const char* function, const Call& call) const noexcept;
  void destroy() noexcept;

  const HapbenchPlugin& plugin_;
  std::vector<double> parameters_;
  void* law_ = nullptr;
  /// The plugin's weights, between canaries that find writes beyond them.
  std::vector<double> guarded_weights_;
  mutable std::array<char, 256> fault_{};  ///< empty without a fault; `springs` may have one, too
};

/// The entry of the table for a law behind the C interface, from the file `origin`. The plugin must outlive it. Throws
/// std::invalid_argument for a plugin whose functions or documentation are missing.
AlgorithmEntry plugin_entry(const HapbenchPlugin& plugin, AlgorithmOrigin origin);

/// Faults of laws from outside, over all threads.
struct PluginFaults {
  std::uint64_t count = 0;
  std::string first;  ///< text of the first
};
/// The faults since the last call.
PluginFaults take_plugin_faults();

}  // namespace hapbench
