#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "algorithms/module/hapbench_module.h"
#include "sim/contact/contact_source.hpp"

/// Loads shared libraries with a module (algorithms/module/hapbench_module.h). A library is loaded once and
/// stays loaded. Loading preserves the floating-point modes of the program.
///
/// The lists of loaded libraries belong to the process and not to a ProgramContext. dlopen() gives a process
/// one copy of a library, whose code and static data all contexts share. A loaded law is also entered in the
/// single table of algorithms (algorithms/registry.hpp). If each context had its own list, a second context would
/// load the same law again.
namespace hapbench {

/// A force law that was loaded from a shared library.
struct LoadedLaw {
  std::filesystem::path file;  ///< absolute path
  std::string algorithm;
};

/// Function called before a new law is loaded. Its result is kept alive until loading has finished. If several
/// threads may load laws, the function must throw InputError while another thread reads the table of
/// algorithms, and its result must keep other threads from reading the table. Empty: only one thread loads
/// laws.
using LoadingGuard = std::function<std::shared_ptr<void>()>;

/// Loads a law from `file` and registers it as an algorithm until the program ends. Does nothing if the file is
/// already loaded. Must not be called while another thread reads the table of algorithms. Throws InputError if
/// the file is not a usable law.
void load_law(const std::filesystem::path& file, const LoadingGuard& guard = {});

/// Loads every *.so file in the given folders, in the order of file names. `folders` are separated by colons.
/// `what` names the list in error messages. Throws InputError.
void load_laws_in(const std::string& what, const std::string& folders, const LoadingGuard& guard = {});

/// Returns the laws that this process has loaded, in the order of loading.
const std::vector<LoadedLaw>& loaded_laws();

/// Loads a library with a source of contacts. Thread-safe. Throws InputError if it cannot be used.
void require_contacts_in(const std::filesystem::path& file);

/// Creates the contact source of a library for one run. `config`: the scenario's configuration for the library,
/// as JSON text. Thread-safe. Throws InputError.
std::unique_ptr<ContactSource> module_contacts(const std::filesystem::path& file, const std::string& config,
                                               const HapbenchRun& run);

}  // namespace hapbench
