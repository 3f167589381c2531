#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "algorithms/peers/hapbench_contacts.h"

/// Shared libraries behind the C interfaces of laws and sources of contacts.
namespace hapbench {

/// A loaded shared library with a law (algorithms/plugin/hapbench_plugin.h).
struct LoadedPlugin {
  std::filesystem::path file;  ///< absolute
  std::string algorithm;
};

/// Loads a plugin and adds its law to the algorithms for as long as the program runs, unless it is loaded already.
/// Restores floating-point modes that loading changes. Must not be called while another thread reads the table of
/// algorithms. Throws InputError.
void load_plugin(const std::filesystem::path& file);

/// Loads every *.so in folders that are separated by colons, in the order of their names. `what` names the list in
/// messages. Throws InputError.
void load_plugins_in(const std::string& what, const std::string& folders);

/// Sets the function that is called before a new plugin is loaded. Its result is kept until the plugin is loaded. If
/// several threads may load plugins, it throws InputError while others read the table of algorithms, and its result
/// keeps them from reading.
void guard_loading(std::function<std::shared_ptr<void>()> guard);

/// The loaded plugins, in the order of loading.
const std::vector<LoadedPlugin>& loaded_plugins();

/// The contact source of a library of the user's own, which is loaded at the first call and stays. Thread safe. Throws
/// InputError.
const HapbenchContactSource& contact_plugin(const std::filesystem::path& file);

}  // namespace hapbench
