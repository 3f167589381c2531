#pragma once

/// Names the plugin whose code is running when the process crashes, exits or cannot be stopped in it.
namespace hapbench {

/// Marks that this thread runs a function of a plugin, from construction to destruction. Costs some nanoseconds; the
/// first on a thread allocates. Calls do not nest. Both texts must outlive the object.
class PluginCall {
 public:
  PluginCall(const char* plugin, const char* function) noexcept;
  ~PluginCall();
  PluginCall(const PluginCall&) = delete;
  PluginCall& operator=(const PluginCall&) = delete;
};

/// From now on a crash (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) or `exit` inside a plugin first writes one line with
/// the plugin's name to standard error. A crash then ends the process as it would have, `exit` with `exit_status`. For
/// programs, not for hosts with handlers of their own.
void name_plugins_that_end_the_process(int exit_status);

/// Writes one line to standard error for each thread that is inside a plugin. May be called in a signal handler.
void write_running_plugins() noexcept;

}  // namespace hapbench
