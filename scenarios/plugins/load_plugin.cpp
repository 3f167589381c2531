#include "scenarios/plugins/load_plugin.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cfenv>
#include <stdexcept>
#include <utility>

#include "algorithms/plugin/plugin_law.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestPlugin = std::size_t{1} << 28;
constexpr const char* kEntryPoint = "hapbench_plugin";

std::vector<LoadedPlugin>& plugins() {
  static std::vector<LoadedPlugin> all;
  return all;
}

std::function<std::shared_ptr<void>()>& loading_guard() {
  static std::function<std::shared_ptr<void>()> guard = [] { return nullptr; };
  return guard;
}

/// A library that is compiled with -ffast-math switches subnormal numbers off for the whole program as it is loaded,
/// which would change the results of every algorithm.
class KeptFloatingPoint {
 public:
  KeptFloatingPoint() { std::fegetenv(&environment_); }
  ~KeptFloatingPoint() { std::fesetenv(&environment_); }
  KeptFloatingPoint(const KeptFloatingPoint&) = delete;
  KeptFloatingPoint& operator=(const KeptFloatingPoint&) = delete;

 private:
  std::fenv_t environment_{};
};

/// Asked before the file is opened: a directory or a pipe is refused here.
std::string hash_of_file(const fs::path& file) {
  try {
    return hash_text(hash_of(read_text_file(file, kLargestPlugin)));
  } catch (const InputError& error) {
    fail_in_file(file, error.problem());
  }
}

/// What the library's one function says. The library stays open: its laws may run at any time.
const HapbenchPlugin& opened(const fs::path& file) {
  const KeptFloatingPoint kept;
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    std::string problem = dlerror();
    const std::string again = file.string() + ": ";
    if (problem.starts_with(again)) problem.erase(0, again.size());
    fail_in_file(file, "is no plugin: " + problem);
  }
  void* symbol = dlsym(library, kEntryPoint);
  if (symbol == nullptr)
    fail_in_file(file, fmt::format("is no plugin: it has no function \"{}\" (hapbench_plugin.h)", kEntryPoint));
  const auto* plugin = reinterpret_cast<decltype(&hapbench_plugin)>(symbol)(HAPBENCH_PLUGIN_VERSION);
  if (plugin == nullptr)
    fail_in_file(file, fmt::format("does not support version {} of the interface; allowed: built with the "
                                   "hapbench_plugin.h of this program",
                                   HAPBENCH_PLUGIN_VERSION));
  if (plugin->version != HAPBENCH_PLUGIN_VERSION)
    fail_in_file(file, fmt::format("is built for version {} of the interface; allowed: {}", plugin->version,
                                   HAPBENCH_PLUGIN_VERSION));
  return *plugin;
}

}  // namespace

void load_plugin(const fs::path& given) {
  std::error_code error;
  const fs::path file = fs::canonical(given, error);
  if (error) fail_in_file(given, "cannot be loaded as a plugin: " + error.message());
  const auto is_this = [&file](const LoadedPlugin& plugin) { return plugin.file == file; };
  if (std::any_of(plugins().begin(), plugins().end(), is_this)) return;
  const std::shared_ptr<void> guarded = loading_guard()();
  const std::string hash = hash_of_file(file);
  const HapbenchPlugin& plugin = opened(file);
  try {
    AlgorithmEntry entry = plugin_entry(plugin, {file.filename().string(), hash});
    const std::string name = entry.info->name;
    for (const LoadedPlugin& other : plugins()) {
      if (other.algorithm == name)
        throw std::invalid_argument(fmt::format("\"{}\" is the name of the law in {}", name, other.file.string()));
    }
    add_algorithm(std::move(entry));
    plugins().push_back({file, name});
  } catch (const std::invalid_argument& problem) {
    fail_in_file(file, fmt::format("is no plugin that can be used: {}", problem.what()));
  }
}

void load_plugins_in(const std::string& what, const std::string& folders) {
  for (std::size_t start = 0; start <= folders.size();) {
    const std::size_t end = std::min(folders.find(':', start), folders.size());
    const fs::path folder = folders.substr(start, end - start);
    start = end + 1;
    if (folder.empty()) continue;
    std::error_code error;
    std::vector<fs::path> files;
    for (fs::directory_iterator entry(folder, error), last; !error && entry != last; entry.increment(error))
      if (entry->path().extension() == ".so") files.push_back(entry->path());
    if (error) throw InputError(fmt::format("{}: {}: {}", what, folder.string(), error.message()));
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) load_plugin(file);
  }
}

void guard_loading(std::function<std::shared_ptr<void>()> guard) {
  loading_guard() = std::move(guard);
}

const std::vector<LoadedPlugin>& loaded_plugins() {
  return plugins();
}

}  // namespace hapbench
