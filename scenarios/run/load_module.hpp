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

/// A module that the user named, by --module or HAPBENCH_MODULE_PATH.
struct LoadedModule {
  std::filesystem::path file;  ///< absolute path without symbolic links
  std::string algorithm;       ///< name of its force law; empty for a source of contacts
};

/// Permission to load the libraries that scenarios name, for the lifetime of the object. A scenario alone never causes
/// a library to be loaded, because the library's code could do anything: the user must name the library (load_module)
/// or allow all libraries.
class ModulePermission {
 public:
  /// If `all` is true, allows all libraries until the object is destroyed. If `all` is false, the object has no effect.
  explicit ModulePermission(bool all);
  ~ModulePermission();
  ModulePermission(const ModulePermission&) = delete;
  ModulePermission& operator=(const ModulePermission&) = delete;

  /// Returns true if all libraries are allowed.
  static bool allows_all();

 private:
  bool all_;
};

/// Allows all libraries until the process ends, for Python and for tests.
void allow_all_modules();

/// Function called before a new law is loaded. Its result is kept alive until loading has finished. If several
/// threads may load laws, the function must throw InputError while another thread reads the table of
/// algorithms, and its result must keep other threads from reading the table. May be empty if only one thread
/// loads laws.
using LoadingGuard = std::function<std::shared_ptr<void>()>;

/// Loads a module that the user named. If the module is a law, registers it as an algorithm until the program ends. If
/// the module is a source of contacts, scenarios may name its file from then on. Does nothing if the file is already
/// loaded. Must not be called while another thread reads the table of algorithms. Throws InputError if the file is not
/// a usable module.
void load_module(const std::filesystem::path& file, const LoadingGuard& guard = {});

/// Loads every *.so file in the given folders, in the order of file names. `folders` are separated by colons.
/// `what` names the list in error messages. Throws InputError.
void load_modules_in(const std::string& what, const std::string& folders, const LoadingGuard& guard = {});

/// Returns the modules that load_module() has loaded in this process, in the order of loading.
const std::vector<LoadedModule>& loaded_modules();

/// If the user has neither named this library nor allowed all libraries, throws InputError with a message that names
/// the option that gives permission.
void require_module_permission(const std::filesystem::path& file);

/// Checks that a library may be loaded and is an ELF file, without loading it. Throws InputError.
void inspect_module(const std::filesystem::path& file);

/// Loads a library with a source of contacts. Thread-safe. Throws InputError if the user has not permitted the library,
/// or if the library cannot be used.
void require_contacts_in(const std::filesystem::path& file);

/// Creates the contact source of a library for one run. `config`: the scenario's configuration for the library,
/// as JSON text. Thread-safe. Throws InputError if the user has not permitted the library, or if the library cannot be
/// used.
std::unique_ptr<ContactSource> module_contacts(const std::filesystem::path& file, const std::string& config,
                                               const HapbenchRun& run);

}  // namespace hapbench
