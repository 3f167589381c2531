#ifndef HAPBENCH_RENDERER_HPP
#define HAPBENCH_RENDERER_HPP

#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "hapbench_renderer.h"

namespace hapbench {

/// C++ wrapper (C++11 or later) of the C interface in hapbench_renderer.h, which documents the functions. An object
/// owns a renderer and closes it in the destructor. The constructors throw an exception if the renderer cannot be
/// opened. `step` does not throw.
class Renderer {
 public:
  /// Opens a renderer. Throws std::runtime_error with the error text of hapbench_renderer_open.
  explicit Renderer(const HapbenchSetup& setup) {
    char error[HAPBENCH_ERROR_SIZE];
    renderer_.reset(hapbench_renderer_open(&setup, error));
    if (!renderer_) throw std::runtime_error(error);
  }
  /// Opens a scenario by name, file or text, with overrides such as "time.step_s=0.001".
  Renderer(const std::string& scenario, const HapbenchMount& mount, const std::vector<std::string>& overrides = {},
           std::uint32_t mode = HAPBENCH_IMPEDANCE, std::uint32_t flags = 0)
      : Renderer(setup_of(scenario, mount, pointers(overrides), mode, flags)) {}

  HapbenchOutput step(const HapbenchInput& input) noexcept {
    HapbenchOutput output;
    hapbench_renderer_step(renderer_.get(), &input, &output);
    return output;
  }
  double period() const noexcept { return hapbench_renderer_period(renderer_.get()); }
  std::string inspect() const { return hapbench_renderer_inspect(renderer_.get()); }
  std::string fault() const { return hapbench_renderer_fault(renderer_.get()); }
  std::string log_header() const {
    std::string text(hapbench_renderer_log_header(renderer_.get(), nullptr, 0) + 1, '\0');
    text.resize(hapbench_renderer_log_header(renderer_.get(), &text[0], text.size()));
    return text;
  }
  static std::string log_row(const HapbenchInput& input, const HapbenchOutput& output) {
    char text[HAPBENCH_LOG_ROW_SIZE];
    return std::string(text, hapbench_renderer_log_row(&input, &output, text, sizeof text));
  }

 private:
  struct Close {
    void operator()(HapbenchRenderer* renderer) const noexcept { hapbench_renderer_close(renderer); }
  };

  static std::vector<const char*> pointers(const std::vector<std::string>& texts) {
    std::vector<const char*> list;
    for (const std::string& text : texts) list.push_back(text.c_str());
    list.push_back(nullptr);
    return list;
  }
  /// Returns a setup with pointers to the arguments. The arguments exist until the constructor that uses the setup
  /// returns.
  static HapbenchSetup setup_of(const std::string& scenario, const HapbenchMount& mount,
                                const std::vector<const char*>& overrides, std::uint32_t mode, std::uint32_t flags) {
    HapbenchSetup setup = HAPBENCH_SETUP_INIT;
    setup.mode = mode;
    setup.flags = flags;
    setup.scenario = scenario.c_str();
    setup.overrides = overrides.data();
    setup.mount = mount;
    return setup;
  }

  std::unique_ptr<HapbenchRenderer, Close> renderer_;
};

}  // namespace hapbench
#endif
