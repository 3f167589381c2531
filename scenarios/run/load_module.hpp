#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "algorithms/module/hapbench_module.h"
#include "sim/contact/contact_source.hpp"

/// Shared libraries with a module (algorithms/module/hapbench_module.h). A library is loaded once and stays; loading
/// leaves the floating-point modes of the program as they are.
///
/// The lists of loaded libraries belong to the process and not to a ProgramContext. dlopen() gives a process one copy
/// of a library, whose code and static data all hosts then share, and a law that was loaded is in the one table of
/// algorithms (algorithms/registry.hpp). A list for each context would forget both and load a law again.
namespace hapbench {

/// A loaded shared library with a law.
struct LoadedLaw {
  std::filesystem::path file;  ///< absolute
  std::string algorithm;
};

/// Called before a new law is loaded; its result lives until that is done. If several threads may load laws, it throws
/// InputError while others read the table of algorithms, and its result keeps them from it. Empty: one thread loads.
using LoadingGuard = std::function<std::shared_ptr<void>()>;

/// Loads a law and adds it to the algorithms for as long as the program runs, unless it is loaded already. Must not be
/// called while another thread reads the table of algorithms. Throws InputError.
void load_law(const std::filesystem::path& file, const LoadingGuard& guard = {});

/// Loads every *.so in folders separated by colons, by name; `what` names the list in messages. Throws InputError.
void load_laws_in(const std::string& what, const std::string& folders, const LoadingGuard& guard = {});

/// The loaded laws of this process, in the order of loading.
const std::vector<LoadedLaw>& loaded_laws();

/// Loads a library of contacts. Thread safe. Throws InputError.
void require_contacts_in(const std::filesystem::path& file);

/// The contacts of a library for a run, with the scenario's `config` as JSON text. Thread safe. Throws InputError.
std::unique_ptr<ContactSource> module_contacts(const std::filesystem::path& file, const std::string& config,
                                               const HapbenchRun& run);

}  // namespace hapbench
