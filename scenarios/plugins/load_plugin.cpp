#include "scenarios/plugins/load_plugin.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cfenv>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "algorithms/plugin/plugin_call.hpp"
#include "algorithms/plugin/plugin_law.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestPlugin = std::size_t{1} << 28;

/// A C interface: a library exports one function, which returns the interface's table of functions for a version.
struct Interface {
  const char* kind;         ///< of a library, in messages
  const char* entry_point;  ///< name of the function
  const char* header;
  std::uint32_t version;
};
constexpr Interface kLaws = {.kind = "plugin",
                             .entry_point = "hapbench_plugin",
                             .header = "hapbench_plugin.h",
                             .version = HAPBENCH_PLUGIN_VERSION};
constexpr Interface kContactSources = {.kind = "source of contacts",
                                       .entry_point = "hapbench_contacts",
                                       .header = "hapbench_contacts.h",
                                       .version = HAPBENCH_CONTACTS_VERSION};
/// Symbols of the library and its dependencies take precedence over ours. Sanitizers replace functions of all
/// libraries, so they exclude that.
#ifdef HAPBENCH_SANITIZED
constexpr int kApart = RTLD_NOW | RTLD_LOCAL;
#else
constexpr int kApart = RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND;
#endif

std::vector<LoadedPlugin>& plugins() {
  static std::vector<LoadedPlugin> all;
  return all;
}

std::function<std::shared_ptr<void>()>& loading_guard() {
  static std::function<std::shared_ptr<void>()> guard = [] { return nullptr; };
  return guard;
}

/// Restores the floating-point environment. Loading a library that was linked with -ffast-math switches off subnormal
/// numbers for the whole program, which would change the results of every algorithm.
class KeptFloatingPoint {
 public:
  KeptFloatingPoint() { std::fegetenv(&environment_); }
  ~KeptFloatingPoint() { std::fesetenv(&environment_); }
  KeptFloatingPoint(const KeptFloatingPoint&) = delete;
  KeptFloatingPoint& operator=(const KeptFloatingPoint&) = delete;

 private:
  std::fenv_t environment_{};
};

/// Also refuses a directory or a pipe before it would be opened as a library.
std::string hash_of_file(const fs::path& file) {
  try {
    return hash_text(hash_of(read_text_file(file, kLargestPlugin)));
  } catch (const InputError& error) {
    fail_in_file(file, error.problem());
  }
}

/// Texts of a plugin go to terminals, pages and JSON. Throws std::invalid_argument for control characters, of which a
/// terminal's commands are made, and for what is no UTF-8.
void require_printable(const AlgorithmEntry& entry) {
  const auto require = [](std::string_view text, const std::string& what) {
    bool printable = true;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const auto byte = static_cast<unsigned char>(text[i]);
      const bool c1 = byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0;
      printable = printable && byte >= 0x20 && byte != 0x7f && !c1;
    }
    // As JSON, in which what is no UTF-8 is the replacement character.
    const std::string shown = Json(std::string(text)).dump(-1, ' ', true, Json::error_handler_t::replace);
    if (!printable || shown.find("\\ufffd") != std::string::npos)
      throw std::invalid_argument(what + " has characters that cannot be printed: " + shown);
  };
  const ModelInfo& info = *entry.info;
  require(info.summary, "its summary");
  require(info.formula, "its formula");
  require(info.source, "its source");
  require(info.known_failure, "its known failure");
  for (const OwnParameter& p : entry.own_parameters) {
    require(p.meaning, fmt::format("the meaning of parameter \"{}\"", p.name));
    require(p.range.unit, fmt::format("the unit of parameter \"{}\"", p.name));
  }
}

/// The table of a library, which stays open because its functions may be called at any time. Throws InputError.
template <class Table>
const Table& opened(const fs::path& file, int flags, const Interface& wanted) {
  const KeptFloatingPoint kept;
  void* library = dlopen(file.c_str(), flags);
  if (library == nullptr) {
    std::string problem = dlerror();
    const std::string again = file.string() + ": ";
    if (problem.starts_with(again)) problem.erase(0, again.size());
    fail_in_file(file, fmt::format("is no {}: {}", wanted.kind, problem));
  }
  void* symbol = dlsym(library, wanted.entry_point);
  if (symbol == nullptr)
    fail_in_file(
        file, fmt::format("is no {}: it has no function \"{}\" ({})", wanted.kind, wanted.entry_point, wanted.header));
  const Table* table = nullptr;
  try {
    table = reinterpret_cast<const Table* (*)(std::uint32_t)>(symbol)(wanted.version);
  } catch (...) {
    fail_in_file(file, fmt::format("throws in \"{}\"", wanted.entry_point));
  }
  if (table == nullptr)
    fail_in_file(file, fmt::format("does not support version {} of the interface; allowed: built with the {} of this "
                                   "program",
                                   wanted.version, wanted.header));
  if (table->version != wanted.version)
    fail_in_file(file,
                 fmt::format("is built for version {} of the interface; allowed: {}", table->version, wanted.version));
  return *table;
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
  const PluginCall loading(file.c_str(), "loading");
  const auto& plugin = opened<HapbenchPlugin>(file, RTLD_NOW | RTLD_LOCAL, kLaws);
  try {
    AlgorithmEntry entry = plugin_entry(plugin, {file.filename().string(), hash});
    require_printable(entry);
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

const HapbenchContactSource& contact_plugin(const fs::path& given) {
  static std::mutex mutex;
  static std::map<fs::path, const HapbenchContactSource*> loaded;
  std::error_code error;
  const fs::path file = fs::canonical(given, error);
  if (error) fail_in_file(given, "cannot be loaded as a source of contacts: " + error.message());
  const std::lock_guard lock(mutex);
  const auto found = loaded.find(file);
  if (found != loaded.end()) return *found->second;
  hash_of_file(file);
  const PluginCall loading(file.c_str(), "loading");
  const auto& t = opened<HapbenchContactSource>(file, kApart, kContactSources);
  if (t.name == nullptr || t.create == nullptr || t.destroy == nullptr || t.contacts_at == nullptr)
    fail_in_file(file, "is no source of contacts that can be used: its name or one of its functions is missing");
  loaded.emplace(file, &t);
  return t;
}

}  // namespace hapbench
