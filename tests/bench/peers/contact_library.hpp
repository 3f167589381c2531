#pragma once

#include <algorithm>
#include <cstdio>
#include <exception>
#include <span>

#include "algorithms/peers/hapbench_contacts.h"

/// Contact sources in C++ behind the C interface. No Eigen: the modules are compiled with the flags of their libraries,
/// and a type whose layout depends on flags must not pass between them and the program.
namespace hapbench {

/// The functions of a contact source that is a class with
///
///   Source(const HapbenchSurface& surface, const HapbenchTool& tool);
///   std::size_t contacts_at(const HapbenchPose& pose, std::span<HapbenchContact> room);
///
/// both of which may throw. Contacts without a direction or with a negative depth are left out.
template <class Source>
HapbenchContactSource contact_library(const char* name) {
  HapbenchContactSource library = {};
  library.version = HAPBENCH_CONTACTS_VERSION;
  library.name = name;
  library.create = [](const char*, const HapbenchSurface* surface, const HapbenchTool* tool, char* fault,
                      std::size_t fault_size) -> void* {
    try {
      return new Source(*surface, *tool);
    } catch (const std::exception& error) {
      std::snprintf(fault, fault_size, "%s", error.what());
    } catch (...) {
      std::snprintf(fault, fault_size, "unknown error");
    }
    return nullptr;
  };
  library.destroy = [](void* source) { delete static_cast<Source*>(source); };
  library.contacts_at = [](void* source, const HapbenchPose* pose, HapbenchContact* contacts, std::size_t room,
                           char* fault, std::size_t fault_size) -> std::int64_t {
    try {
      const std::size_t found = static_cast<Source*>(source)->contacts_at(*pose, {contacts, room});
      const auto is_none = [](const HapbenchContact& c) {
        const double *u = c.gradient, length2 = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
        return !(length2 > 0.0 && c.depth >= 0.0);
      };
      return std::remove_if(contacts, contacts + found, is_none) - contacts;
    } catch (const std::exception& error) {
      std::snprintf(fault, fault_size, "%s", error.what());
    } catch (...) {
      std::snprintf(fault, fault_size, "unknown error");
    }
    return -1;
  };
  return library;
}

}  // namespace hapbench

/// Collision libraries that the benchmark asks the questions of our search.
namespace hapbench::bench {

const HapbenchContactSource& bullet();
const HapbenchContactSource& fcl();
const HapbenchContactSource& kd_tree();  ///< CGAL, over the vertices of the surface
const HapbenchContactSource& ode();

}  // namespace hapbench::bench
