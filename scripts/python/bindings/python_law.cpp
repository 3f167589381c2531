#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <tuple>
#include <vector>

#include "algorithms/module/module.hpp"
#include "algorithms/registry.hpp"
#include "bindings/bindings.hpp"
#include "sim/core/hash.hpp"

/// Force laws in Python. Each law is a module (hapbench_module.h) whose functions call a Python callable.
namespace hapbench {
namespace {

namespace py = pybind11;

/// Names of the arguments that give a law its contacts.
constexpr std::string_view kShown[] = {"depths", "gradients", "points", "normals"};

/// Returns the columns of the contacts for the argument kShown[shown].
ContactArray::Columns columns_of(std::size_t shown, const HapbenchContacts& c) {
  const ContactArray::Columns all[] = {{c.depth}, {c.gx, c.gy, c.gz}, {c.x, c.y, c.z}, {c.nx, c.ny, c.nz}};
  return all[shown];
}

/// Name, default, minimum, maximum, unit and meaning of a parameter.
using GivenParameter = std::tuple<std::string, double, double, double, std::string, std::string>;

/// A Python law (a function, or a class whose objects are callable) and its module table.
struct Definition {
  std::string name;
  py::object callable;
  bool is_class = false;
  std::vector<GivenParameter> given;
  std::array<std::string, 4> texts;    ///< summary, formula, source, known failure
  std::vector<std::string> arguments;  ///< each is in kShown, "stiffness", or the name of a parameter
  std::vector<HapbenchParameter> parameters;
  HapbenchModule table = {};

  std::size_t place_of(const std::string& parameter) const {
    const auto same = [&](const GivenParameter& p) { return std::get<0>(p) == parameter; };
    return static_cast<std::size_t>(std::find_if(given.begin(), given.end(), same) - given.begin());
  }
};

/// The interpreter's thread state of the calling thread, which is kept for the lifetime of a law, because
/// creating a state takes longer than a call.
class PersistentThreadState {
 public:
  PersistentThreadState() {
    if (PyGILState_GetThisThreadState() != nullptr) return;
    PyGILState_Ensure();
    state_ = PyEval_SaveThread();
  }
  /// Releases the state, but only on the thread that created it. On another thread, the state stays until the
  /// interpreter ends. Precondition: the interpreter lock is not held.
  void give_back() noexcept {
    if (state_ == nullptr || thread_ != std::this_thread::get_id()) return;
    PyEval_RestoreThread(state_);
    PyGILState_Release(PyGILState_UNLOCKED);
  }

 private:
  std::thread::id thread_ = std::this_thread::get_id();
  PyThreadState* state_ = nullptr;
};

/// A law for one run. Precondition of all members: the interpreter lock is held.
class PythonLaw {
 public:
  PythonLaw(const Definition& definition, const double* values, const HapbenchRun& run) : definition_(&definition) {
    for (const std::string& name : definition.arguments) {
      Argument& argument = arguments_.emplace_back();
      argument.shown = static_cast<std::size_t>(std::ranges::find(kShown, name) - std::begin(kShown));
      if (argument.shown < std::size(kShown)) {
        argument.array.emplace(run.capacity, argument.shown == 0 ? 1 : 3);
      } else {
        argument.number = py::float_(name == "stiffness" ? run.stiffness : values[definition.place_of(name)]);
      }
    }
    passed_.resize(arguments_.size());
    start();
  }

  /// Creates a new object if the law is a class.
  void start() { callable_ = definition_->is_class ? definition_->callable() : definition_->callable; }

  /// Calls the law and stores its answer: weights of the contacts, or a force and a stiffness tensor. Throws
  /// py::value_error for other answers.
  void step(HapbenchContacts& contacts, HapbenchForce& force) {
    const py::object answer = call(contacts);
    if (py::isinstance<py::tuple>(answer)) return take_force(answer, contacts.n, force);
    const auto weights = numbers(answer);
    if (weights.ndim() == 0) {
      std::fill_n(contacts.weight, contacts.n, require_finite(*weights.data(), "the weight"));
    } else if (weights.ndim() == 1 && static_cast<std::size_t>(weights.size()) == contacts.n) {
      const double* values = weights.data();
      for (std::size_t i = 0; i < contacts.n; ++i) contacts.weight[i] = require_finite(values[i], "a weight");
    } else {
      throw wrong(py::str("an array of the shape {}").format(weights.attr("shape")), contacts.n);
    }
  }

 private:
  py::object call(const HapbenchContacts& contacts) {
    for (std::size_t i = 0; i < arguments_.size(); ++i) {
      Argument& a = arguments_[i];
      const py::object& shown = a.array ? a.array->filled(contacts.n, columns_of(a.shown, contacts)) : a.number;
      passed_[i] = shown.ptr();
    }
    PyObject* result = PyObject_Vectorcall(callable_.ptr(), passed_.data(), passed_.size(), nullptr);
    if (result == nullptr) throw py::error_already_set();
    return py::reinterpret_steal<py::object>(result);
  }

  void take_force(const py::object& answer, std::size_t n, HapbenchForce& to) const {
    const auto parts = py::reinterpret_borrow<py::tuple>(answer);
    if (parts.size() != 2) throw wrong(py::str("a tuple of {}").format(parts.size()), n);
    const auto force = numbers(parts[0]), tensor = numbers(parts[1]);
    if (force.ndim() != 1 || force.size() != 3 || tensor.ndim() != 2 || tensor.shape(0) != 3 || tensor.shape(1) != 3)
      throw wrong(py::str("arrays of the shapes {} and {}").format(force.attr("shape"), tensor.attr("shape")), n);
    const double *f = force.data(), *S = tensor.data();
    for (int i = 0; i < 9; ++i) require_finite(S[i], "the stiffness tensor");
    // Replace each pair of opposite entries by its mean. Equal entries keep their bits.
    const double tolerance = largest_asymmetry(S, n);
    const auto mean = [&](int row, int column) {
      const double entry = S[3 * row + column], opposite = S[3 * column + row];
      if (std::abs(entry - opposite) <= tolerance) return std::midpoint(entry, opposite);
      throw py::value_error(title() +
                            std::string(py::str("got a stiffness tensor S that is not symmetric: S[{0}, {1}] = {2} and "
                                                "S[{1}, {0}] = {3}; allowed: differences by rounding, at most {4:.2g}")
                                            .format(row, column, entry, opposite, tolerance)));
    };
    to = {1, {f[0], f[1], f[2]}, {S[0], mean(0, 1), mean(0, 2), S[4], mean(1, 2), S[8]}};
    for (const double value : to.force) require_finite(value, "the force");
  }

  /// Returns the largest difference between opposite entries of the stiffness tensor S that rounding explains, for n
  /// contacts. Both entries are the sum over the contacts of c_i u_ij u_ik, but a law may add and multiply in two
  /// different orders. In either order, at most n + 2 roundings act on each term, so that the error of an entry is at
  /// most (n + 2) e times the sum of |c_i u_ij u_ik|, to first order in the unit roundoff e (Higham, Accuracy and
  /// Stability of Numerical Algorithms, 2nd edition, chapter 3). As |u_ij u_ik| <= 1/2 for a unit vector, this sum is
  /// at most half the sum of |c_i|, which is trace S for weights >= 0. The entries therefore differ by at most (n + 2)
  /// e trace S. Here e = 2^-24, because a law may compute in single precision. If terms cancel each other, trace S is
  /// smaller than the terms, which have the size 1; the factor is therefore at least 1.
  static double largest_asymmetry(const double* S, std::size_t n) {
    constexpr double kRoundoff = 0x1p-24;
    return (static_cast<double>(n) + 2.0) * kRoundoff * std::max(1.0, S[0] + S[4] + S[8]);
  }

  using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
  Numbers numbers(const py::object& value) const {
    Numbers array = Numbers::ensure(value);
    if (array && !value.is_none()) return array;
    PyErr_Clear();
    throw wrong(py::str("{}").format(py::type::of(value).attr("__name__")), 0);
  }

  double require_finite(double value, const char* what) const {
    if (std::isfinite(value)) return value;
    throw py::value_error(title() + what + " is " + std::to_string(value) + "; allowed: finite numbers");
  }

  py::value_error wrong(const std::string& got, std::size_t n) const {
    return py::value_error(title() + "got " + got +
                           "; allowed: one weight for all contacts, an array of one weight for each" +
                           (n > 0 ? " (" + std::to_string(n) + ")" : "") +
                           ", or a tuple of the force (3) and the stiffness tensor in units of K (3, 3)");
  }

  std::string title() const { return "force law \"" + definition_->name + "\": "; }

  const Definition* definition_;
  py::object callable_;
  /// An argument of the law: an array of the contacts or a number.
  struct Argument {
    std::size_t shown = 0;  ///< index in kShown; the size of kShown if the argument is a number
    std::optional<ContactArray> array = {};
    py::object number = {};
  };
  std::vector<Argument> arguments_;
  std::vector<PyObject*> passed_;  ///< the arguments of one call, borrowed from arguments_
};

struct State {
  PersistentThreadState thread;
  std::unique_ptr<PythonLaw> law;
};

void* create(const double* values, const char*, const HapbenchRun* run, char* fault) {
  auto state = std::make_unique<State>();
  const auto& definition = *static_cast<const Definition*>(run->data);
  if (runs_in_python([&] { state->law = std::make_unique<PythonLaw>(definition, values, *run); }, fault))
    return state.release();
  state->thread.give_back();
  return nullptr;
}

int step(void* state, const HapbenchPose*, HapbenchContacts* contacts, HapbenchForce* force, char* fault) {
  return runs_in_python([&] { static_cast<State*>(state)->law->step(*contacts, *force); }, fault) ? 0 : 1;
}

void reset(void* state) {
  std::array<char, HAPBENCH_FAULT_SIZE> fault{};
  if (!runs_in_python([state] { static_cast<State*>(state)->law->start(); }, fault.data()))
    throw std::runtime_error(fault.data());  // this function has no other way to report a fault
}

void destroy(void* given) {
  if (!Py_IsInitialized()) return;  // the interpreter has already destroyed its objects
  const std::unique_ptr<State> state(static_cast<State*>(given));
  {
    const py::gil_scoped_acquire held;
    state->law.reset();
  }
  state->thread.give_back();
}

/// Deletes a definition unless the interpreter has ended. Any thread may release the last reference to it.
void destroy_definition(Definition* definition) {
  if (!Py_IsInitialized()) return;
  const py::gil_scoped_acquire held;
  delete definition;
}

void fill_table(Definition& definition) {
  for (const auto& [name, initial, least, greatest, unit, meaning] : definition.given)
    definition.parameters.push_back({name.c_str(), unit.c_str(), least, greatest, initial, meaning.c_str()});
  const auto& [summary, formula, source, known_failure] = definition.texts;
  definition.table = {.version = HAPBENCH_MODULE_VERSION,
                      .kind = HAPBENCH_LAW,
                      .name = definition.name.c_str(),
                      .summary = summary.c_str(),
                      .formula = formula.c_str(),
                      .source = source.c_str(),
                      .known_failure = known_failure.c_str(),
                      .parameters = definition.parameters.data(),
                      .parameter_count = definition.parameters.size(),
                      .data = &definition,
                      .create = create,
                      .step = step,
                      .reset = reset,
                      .destroy = destroy};
}

void add_force_law(const std::string& name, const py::object& callable, bool is_class,
                   const std::vector<std::string>& arguments, const std::vector<GivenParameter>& parameters,
                   const std::array<std::string, 4>& texts, const std::string& depth_model, const std::string& file,
                   const std::string& source) {
  if (is_call_active()) throw std::runtime_error("a force law cannot be defined while something is computed");
  const DepthModelEntry* fixed = depth_model.empty() ? nullptr : find_depth_model(depth_model);
  if (!depth_model.empty() && fixed == nullptr)
    throw std::invalid_argument("unknown depth model \"" + depth_model + "\"");
  const std::shared_ptr<Definition> definition(
      new Definition{name, callable, is_class, parameters, texts, arguments, {}}, destroy_definition);
  fill_table(*definition);
  try {
    AlgorithmEntry entry = law_entry({{definition, &definition->table}, file}, hash_text(hash_of(source)));
    if (fixed != nullptr) entry.fixed_depth_model = fixed->info->name;
    add_algorithm(std::move(entry));
  } catch (const std::invalid_argument& problem) {
    throw std::invalid_argument("force law \"" + name + "\": " + problem.what());
  }
}

}  // namespace

void bind_force_laws(py::module_& module) {
  module.def("add_force_law", add_force_law, py::arg("name"), py::arg("callable"), py::arg("is_class"),
             py::arg("arguments"), py::arg("parameters"), py::arg("texts"), py::arg("depth_model"), py::arg("file"),
             py::arg("source"), "Make an algorithm of a callable; hapbench.force_law checks and fills the arguments.");
}

}  // namespace hapbench
