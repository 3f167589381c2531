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
namespace hapbench {

/// A loaded shared library with a law.
struct LoadedLaw {
  std::filesystem::path file;  ///< absolute
  std::string algorithm;
};

/// Loads a law and adds it to the algorithms for as long as the program runs, unless it is loaded already. Must not be
/// called while another thread reads the table of algorithms. Throws InputError.
void load_law(const std::filesystem::path& file);

/// Loads every *.so in folders separated by colons, by name; `what` names the list in messages. Throws InputError.
void load_laws_in(const std::string& what, const std::string& folders);

/// Sets the function that is called before a new law is loaded; its result lives until that is done. If several threads
/// may load laws, it throws InputError while others read the table of algorithms, and its result keeps them from it.
void guard_loading(std::function<std::shared_ptr<void>()> guard);

/// The loaded laws, in the order of loading.
const std::vector<LoadedLaw>& loaded_laws();

/// Loads a library of contacts. Thread safe. Throws InputError.
void require_contacts_in(const std::filesystem::path& file);

/// The contacts of a library for a run, with the scenario's `config` as JSON text. Thread safe. Throws InputError.
std::unique_ptr<ContactSource> module_contacts(const std::filesystem::path& file, const std::string& config,
                                               const HapbenchRun& run);

}  // namespace hapbench
