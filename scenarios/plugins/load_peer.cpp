#include "scenarios/plugins/load_peer.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <mutex>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Names in the module and in what it needs are its own before they are ours. A sanitizer replaces functions of all
/// modules and cannot have that.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kApart = RTLD_NOW | RTLD_LOCAL;
#else
constexpr int kApart = RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND;
#endif

MakePeer* open_peer(const std::string& name) {
  // lib/hapbench lies beside share/hapbench.
  const fs::path prefix = installed_folder(".").parent_path().parent_path();
  const fs::path file = prefix / "lib" / "hapbench" / ("contacts_" + name + ".so");
  std::error_code error;
  if (!fs::exists(file, error)) return nullptr;
  void* module = dlopen(file.c_str(), kApart);
  if (module == nullptr) throw InputError(fmt::format("{}: cannot be loaded: {}", file.string(), dlerror()));
  void* symbol = dlsym(module, kPeerEntryPoint);
  if (symbol == nullptr) throw InputError(fmt::format("{}: has no function \"{}\"", file.string(), kPeerEntryPoint));
  return reinterpret_cast<MakePeer*>(symbol);
}

}  // namespace

MakePeer* find_peer(const std::string& name) {
  static std::mutex mutex;
  static std::map<std::string, MakePeer*> opened;
  const std::lock_guard lock(mutex);
  const auto found = opened.find(name);
  return found != opened.end() ? found->second : opened.emplace(name, open_peer(name)).first->second;
}

std::string peer_package(const std::string& name) {
  return "lib" + name + "-dev";
}

}  // namespace hapbench
