#include <array>
#include <limits>
#include <stdexcept>
#include <utility>

#include "algorithms/plugin/plugin_call.hpp"
#include "algorithms/stages/force_stage.hpp"

namespace hapbench {
namespace {

/// A force stage behind the C interface. A row adds an indirect call and the check that the answer is finite and that
/// nothing beyond it was written.
class PluginStage final : public ForceStage {
 public:
  PluginStage(const HapbenchForceStage& library, std::string config) : library_(library), config_(std::move(config)) {}
  ~PluginStage() override { destroy(); }
  PluginStage(const PluginStage&) = delete;
  PluginStage& operator=(const PluginStage&) = delete;

  /// Throws std::runtime_error with the library's fault.
  void prepare(const HapbenchStageRun& run) override;
  void reset() noexcept override;
  /// After a fault NaN until the next reset.
  Vec3 force(const HapbenchStageStep& step) noexcept override;
  const char* fault() const noexcept override { return fault_.text(); }

 private:
  void destroy() noexcept;
  Vec3 failed(const char* problem) noexcept;

  const HapbenchForceStage& library_;
  std::string config_;
  void* stage_ = nullptr;
  FaultText fault_;
};

void PluginStage::destroy() noexcept {
  if (stage_ == nullptr) return;
  const PluginCall running(library_.name, "destroy");
  library_.destroy(std::exchange(stage_, nullptr));
}

void PluginStage::prepare(const HapbenchStageRun& run) {
  destroy();
  std::array<char, 200> text{};
  const PluginCall running(library_.name, "create");
  stage_ = library_.create(config_.c_str(), &run, text.data(), text.size());
  text.back() = '\0';
  if (stage_ != nullptr) return;
  failed(text.data());
  throw std::runtime_error(fault());
}

void PluginStage::reset() noexcept {
  fault_.clear();
  if (library_.reset == nullptr) return;
  const PluginCall running(library_.name, "reset");
  library_.reset(stage_);
}

Vec3 PluginStage::failed(const char* problem) noexcept {
  fault_.set(library_.name, problem);
  return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
}

Vec3 PluginStage::force(const HapbenchStageStep& step) noexcept {
  const Vec3 unwritten = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  if (fault() != nullptr) return unwritten;
  Guarded<Vec3> guarded{{}, unwritten, {}};
  std::array<char, 200> text{};
  int error = 0;
  {
    const PluginCall running(library_.name, "force");
    error = library_.force(stage_, &step, guarded.answer.data(), text.data(), text.size());
  }
  text.back() = '\0';
  if (error != 0) return failed(text.data());
  if (!guarded.intact()) return failed("it writes beyond its force");
  return guarded.answer.allFinite() ? guarded.answer : failed("its force is not finite");
}

}  // namespace

std::unique_ptr<ForceStage> make_plugin_stage(const HapbenchForceStage& library, const std::string& config) {
  return std::make_unique<PluginStage>(library, config);
}

}  // namespace hapbench
