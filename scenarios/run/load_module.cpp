#include "scenarios/run/load_module.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>
#include <link.h>

#include <algorithm>
#include <atomic>
#include <cfenv>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "algorithms/module/module.hpp"
#include "scenarios/input/shell_words.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

// Largest accepted size of a library [bytes].
constexpr std::size_t kMaxModuleBytes = std::size_t{1} << 28;

/// Flags for dlopen(). RTLD_DEEPBIND gives the library's own symbols precedence over the program's symbols. Sanitizers
/// do not allow it, because they replace functions in all libraries.
#ifdef HAPBENCH_SANITIZED
constexpr int kDlopenFlags = RTLD_NOW | RTLD_LOCAL;
#else
constexpr int kDlopenFlags = RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND;
#endif

// The variables below belong to the process; load_module.hpp explains why they do not belong to a context.
std::vector<LoadedModule> modules;  ///< loaded modules, in the order of loading
std::atomic<int> allowing = 0;      ///< number of existing ModulePermission objects that allow all modules

/// Maps the file of each loaded library that is a source of contacts to the library's table. The mutex protects the
/// map.
std::mutex contact_modules_mutex;
std::map<fs::path, const HapbenchModule*> contact_modules;

/// Returns the size that a library in the format ELF declares [bytes]: the end of its section table and of its
/// segments. Returns 0 for other formats. dlopen() maps the segments without a check of the size, so that a library
/// that is cut short would end the program with a bus error.
std::size_t declared_size(std::string_view bytes) {
  ElfW(Ehdr) header{};
  if (bytes.size() < sizeof header || !bytes.starts_with(ELFMAG)) return 0;
  std::memcpy(&header, bytes.data(), sizeof header);
  std::size_t size = header.e_shoff + std::size_t{header.e_shnum} * header.e_shentsize;
  for (std::size_t i = 0; i < header.e_phnum; ++i) {
    ElfW(Phdr) segment{};
    const std::size_t at = header.e_phoff + i * header.e_phentsize;
    if (at > bytes.size() || bytes.size() - at < sizeof segment) return std::max(size, at + sizeof segment);
    std::memcpy(&segment, bytes.data() + at, sizeof segment);
    size = std::max<std::size_t>(size, segment.p_offset + segment.p_filesz);
  }
  return size;
}

/// Returns the hash of a file. Called before dlopen(), so that a directory, a pipe, an unreadable file or a library
/// that is cut short causes an InputError.
std::string hash_of_file(const fs::path& file) {
  const std::string bytes = with_file(file, [&] { return read_text_file(file, kMaxModuleBytes); });
  if (const std::size_t size = declared_size(bytes); size > bytes.size())
    fail_in_file(file,
                 fmt::format("is cut short: it has {} of {} bytes; compile or copy it again", bytes.size(), size));
  return hash_text(hash_of(bytes));
}

/// Returns the library's function hapbench_module(), which returns the module's table. Throws InputError if the library
/// has no such function.
decltype(&hapbench_module) entry_point(const fs::path& file, void* library) {
  if (void* symbol = dlsym(library, "hapbench_module")) return reinterpret_cast<decltype(&hapbench_module)>(symbol);
  for (const char* old : {"hapbench_plugin", "hapbench_contacts"}) {
    if (dlsym(library, old) != nullptr)
      fail_in_file(file, fmt::format("is built for {}.h of an earlier version; compile it anew against "
                                     "hapbench_module.h",
                                     old));
  }
  fail_in_file(file, "is not a module: it has no function \"hapbench_module\" (hapbench_module.h)");
}

/// Opens a library and returns its table. The library stays open, because its functions may be called until the
/// program ends. Throws InputError if the library is not a module of this interface version.
const HapbenchModule& opened(const fs::path& file) {
  // Loading a library that was linked with -ffast-math switches off subnormal numbers for this thread and for later
  // threads, which would change the results of every algorithm. The floating-point environment is therefore restored on
  // return.
  std::fenv_t environment{};
  std::fegetenv(&environment);
  const std::unique_ptr<std::fenv_t, int (*)(const std::fenv_t*)> restored(&environment, std::fesetenv);
  // Open the library.
  void* library = dlopen(file.c_str(), kDlopenFlags);
  if (library == nullptr) {
    std::string problem = dlerror();
    const std::string again = file.string() + ": ";
    if (problem.starts_with(again)) problem.erase(0, again.size());
    constexpr std::string_view kSources[] = {".c", ".cc", ".cpp", ".cxx"};
    if (std::ranges::count(kSources, file.extension().string()) > 0)
      problem = "it is source code; allowed: the library that a compiler makes of it (algorithms/WRITE_A_LAW.md)";
    fail_in_file(file, "is not a module: " + problem);
  }
  // Get the table of the module.
  const auto entry = entry_point(file, library);
  const HapbenchModule* table = nullptr;
  try {
    table = entry(HAPBENCH_MODULE_VERSION);
  } catch (...) {
    fail_in_file(file, "throws in \"hapbench_module\"");
  }
  if (table == nullptr)
    fail_in_file(file, fmt::format("does not support version {} of the interface; allowed: built with the "
                                   "hapbench_module.h of this program",
                                   HAPBENCH_MODULE_VERSION));
  // Check version and kind.
  if (table->version != HAPBENCH_MODULE_VERSION)
    fail_in_file(file, fmt::format("is built for version {} of the interface; allowed: {}", table->version,
                                   HAPBENCH_MODULE_VERSION));
  if (table->kind != HAPBENCH_LAW && table->kind != HAPBENCH_CONTACTS)
    fail_in_file(file, fmt::format("its kind is {}; allowed: HAPBENCH_LAW or HAPBENCH_CONTACTS", table->kind));
  return *table;
}

/// Returns the canonical path of a file, so that different links to a file give the same path.
fs::path found_file(const fs::path& given) {
  std::error_code error;
  fs::path file = fs::canonical(given, error);
  if (error) fail_in_file(given, fmt::format("cannot be loaded as a module: {}", error.message()));
  return file;
}

/// Returns a module whose table is owned by its library.
Module module_of(const HapbenchModule& table, const fs::path& file) {
  return {{std::shared_ptr<void>(), &table}, file.filename().string()};
}

/// Returns the table of a library that is a source of contacts. Loads the library at the first call. Throws InputError
/// if the user has not permitted the library, or if the library is not a usable source of contacts. Thread-safe.
const HapbenchModule& contacts_table(const fs::path& file) {
  require_module_permission(file);
  const std::lock_guard lock(contact_modules_mutex);
  const auto found = contact_modules.find(file);
  if (found != contact_modules.end()) return *found->second;
  hash_of_file(file);
  const HapbenchModule& table = opened(file);
  if (table.kind != HAPBENCH_CONTACTS)
    fail_in_file(file, "holds a law, not a source of contacts; name it in --module and in rendering.algorithm");
  if (table.name == nullptr || table.step == nullptr)
    fail_in_file(file, "is not a source of contacts that can be used: its name or its function \"step\" is missing");
  contact_modules.emplace(file, &table);
  return table;
}

/// Registers the law of a loaded library under its name, which must be new, and returns the name. Throws InputError.
std::string registered_law(const HapbenchModule& table, const fs::path& file, std::string hash) {
  try {
    AlgorithmEntry entry = law_entry(module_of(table, file), std::move(hash));
    std::string name = entry.info->name;
    if (const auto other = std::ranges::find(modules, name, &LoadedModule::algorithm); other != modules.end())
      throw std::invalid_argument(fmt::format("\"{}\" is the name of the law in {}", name, other->file.string()));
    add_algorithm(std::move(entry));
    return name;
  } catch (const std::invalid_argument& problem) {
    fail_in_file(file, fmt::format("is not a law that can be used: {}", problem.what()));
  }
}

}  // namespace

ModulePermission::ModulePermission(bool all) : all_(all) {
  if (all_) ++allowing;
}

ModulePermission::~ModulePermission() {
  if (all_) --allowing;
}

bool ModulePermission::allows_all() {
  return allowing > 0;
}

void allow_all_modules() {
  ++allowing;
}

void require_module_permission(const fs::path& given) {
  const fs::path file = found_file(given);
  if (ModulePermission::allows_all() || std::ranges::find(modules, file, &LoadedModule::file) != modules.end()) return;
  fail_in_file(given, fmt::format("is a library whose code would be executed; allowed: with --module {}, or with "
                                  "--allow-modules for every library that a scenario names",
                                  shell_file(file)));
}

void load_module(const fs::path& given, const LoadingGuard& guard) {
  const fs::path file = found_file(given);
  if (std::ranges::find(modules, file, &LoadedModule::file) != modules.end()) return;
  // Load the library while no other thread reads the table of algorithms.
  const std::shared_ptr<void> guarded = guard ? guard() : nullptr;
  std::string hash = hash_of_file(file);
  const HapbenchModule& table = opened(file);
  // Register a law. A source of contacts needs no registration, because scenarios name its file.
  const bool is_law = table.kind == HAPBENCH_LAW;
  modules.push_back({file, is_law ? registered_law(table, file, std::move(hash)) : ""});
}

void load_modules_in(const std::string& what, const std::string& folders, const LoadingGuard& guard) {
  for (const fs::path folder : parts_of(folders, ':')) {
    if (folder.empty()) continue;
    std::error_code error;
    std::vector<fs::path> files;
    for (fs::directory_iterator entry(folder, error), last; !error && entry != last; entry.increment(error))
      if (entry->path().extension() == ".so") files.push_back(entry->path());
    if (error) throw InputError(fmt::format("{}: {}: {}", what, folder.string(), error.message()));
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) load_module(file, guard);
  }
}

const std::vector<LoadedModule>& loaded_modules() {
  return modules;
}

void require_contacts_in(const fs::path& file) {
  contacts_table(found_file(file));
}

void inspect_module(const fs::path& file) {
  require_module_permission(file);
  constexpr std::string_view kElf =
      "\x7f"
      "ELF";
  std::string start(kElf.size(), '\0');
  std::ifstream(found_file(file), std::ios::binary).read(start.data(), static_cast<std::streamsize>(start.size()));
  if (start != kElf) fail_in_file(file, "is not a shared library: it does not begin with the mark of an ELF file");
}

std::unique_ptr<ContactSource> module_contacts(const fs::path& given, const std::string& config,
                                               const HapbenchRun& run) {
  const fs::path file = found_file(given);
  const HapbenchModule& table = contacts_table(file);
  try {
    return std::make_unique<ModuleContacts>(module_of(table, file), config, run);
  } catch (const std::runtime_error& problem) {
    throw InputError(problem.what());
  }
}

}  // namespace hapbench
