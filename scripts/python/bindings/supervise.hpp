#pragma once

#include <pybind11/pybind11.h>

#include <functional>

/// Work without the interpreter, for which several threads of Python may ask at once.
namespace hapbench {

/// Calls `work` on a thread of its own, with the interpreter released, and waits for it, meanwhile looking after
/// signals and progress some times a second. `progress`: None for bars on a terminal, False for none, or a function of
/// (label, done, total). Throws what `work` throws; the error of a Python law, of the progress function or of a signal
/// handler, such as KeyboardInterrupt, ends the work and is raised. These also end what other threads compute at that
/// time. Precondition: the interpreter is held.
void supervise(const pybind11::object& progress, const std::function<void()>& work);

/// Keeps the Python error that is set, unless there is one already, and stops all work. Precondition: the interpreter
/// is held.
void stop_by_python_error();

/// Raises the error that stop_by_python_error kept, if there is one. Precondition: no supervised work is under way.
void raise_python_error();

/// True while there is supervised work. Precondition: the interpreter is held.
bool is_work_under_way();

/// Lets no plugin be loaded while another thread computes, nor another thread begin to compute while one is loaded.
void guard_plugins();

}  // namespace hapbench
