#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <thread>
#include <utility>

#include "algorithms/module/module.hpp"
#include "algorithms/registry.hpp"
#include "bindings/bindings.hpp"
#include "sim/core/hash.hpp"

/// A force law in Python is a module (hapbench_module.h) whose functions call it.
namespace hapbench {
namespace {

namespace py = pybind11;

/// The arguments of a law, by their names; `own` stands for the law's own parameters.
enum class Argument { depths, gradients, points, normals, stiffness, own };

/// Name, default, minimum, maximum, unit, meaning.
using GivenParameter = std::tuple<std::string, double, double, double, std::string, std::string>;

/// A function, or a class whose objects are called, and its table.
struct Definition {
  std::string name;
  py::object callable;
  bool is_class = false;
  std::vector<GivenParameter> given;
  std::array<std::string, 4> texts;  ///< summary, formula, source, known failure
  /// The function's arguments in their order; for an own parameter its index in the table.
  std::vector<std::pair<Argument, std::size_t>> arguments;
  std::vector<HapbenchParameter> parameters;
  HapbenchModule table = {};
};

/// The interpreter's state of a thread that Python has not made, for as long as a law lives: making one takes longer
/// than a call.
class KeptThread {
 public:
  KeptThread() {
    if (PyGILState_GetThisThreadState() != nullptr) return;
    PyGILState_Ensure();
    state_ = PyEval_SaveThread();
  }
  /// Precondition: the interpreter is not held. A state of another thread stays until the interpreter ends.
  void give_back() noexcept {
    if (state_ == nullptr || thread_ != std::this_thread::get_id()) return;
    PyEval_RestoreThread(state_);
    PyGILState_Release(PyGILState_UNLOCKED);
  }

 private:
  std::thread::id thread_ = std::this_thread::get_id();
  PyThreadState* state_ = nullptr;
};

/// A numpy array with `width` numbers for each contact, of which laws get a view of the first rows.
class ContactArray {
 public:
  ContactArray(std::size_t capacity, py::ssize_t width) : width_(width), numbers_(shape(capacity)) {}

  /// The view of the first n rows, filled from one array for each column; reused while n stays the same.
  const py::object& filled(std::size_t n, std::initializer_list<const double*> columns) {
    double* out = numbers_.mutable_data();
    for (std::size_t i = 0; i < n; ++i) {
      for (const double* column : columns) *out++ = column[i];
    }
    if (n != rows_) {
      view_ = py::array_t<double>(shape(n), numbers_.data(), numbers_);
      rows_ = n;
    }
    return view_;
  }

 private:
  std::vector<py::ssize_t> shape(std::size_t rows) const {
    const auto n = static_cast<py::ssize_t>(rows);
    return width_ == 1 ? std::vector{n} : std::vector{n, width_};
  }

  py::ssize_t width_;
  py::array_t<double> numbers_;
  py::object view_;
  std::size_t rows_ = std::numeric_limits<std::size_t>::max();
};

/// A law for one run. Precondition of everything: the interpreter is held.
class PythonLaw {
 public:
  PythonLaw(const Definition& definition, const double* values, const HapbenchRun& run)
      : definition_(&definition), stiffness_(run.stiffness) {
    for (std::size_t i = 0; i < definition.given.size(); ++i) own_.emplace_back(values[i]);
    for (const auto& [argument, place] : definition.arguments) {
      if (argument < Argument::stiffness)
        columns_[static_cast<std::size_t>(argument)].emplace(run.capacity, argument == Argument::depths ? 1 : 3);
    }
    start();
  }

  /// Makes a new object of a law that is a class.
  void start() { callable_ = definition_->is_class ? definition_->callable() : definition_->callable; }

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
    std::array<PyObject*, 64> arguments;
    std::size_t count = 0;
    for (const auto& [which, place] : definition_->arguments)
      arguments[count++] = argument(contacts, which, place).ptr();
    PyObject* result = PyObject_Vectorcall(callable_.ptr(), arguments.data(), count, nullptr);
    if (result == nullptr) throw py::error_already_set();
    return py::reinterpret_steal<py::object>(result);
  }

  const py::object& argument(const HapbenchContacts& c, Argument which, std::size_t place) {
    if (which == Argument::stiffness) return stiffness_;
    if (which == Argument::own) return own_[place];
    ContactArray& array = *columns_[static_cast<std::size_t>(which)];
    if (which == Argument::depths) return array.filled(c.n, {c.depth});
    if (which == Argument::gradients) return array.filled(c.n, {c.gx, c.gy, c.gz});
    return which == Argument::points ? array.filled(c.n, {c.x, c.y, c.z}) : array.filled(c.n, {c.nx, c.ny, c.nz});
  }

  void take_force(const py::object& answer, std::size_t n, HapbenchForce& to) const {
    const auto parts = py::reinterpret_borrow<py::tuple>(answer);
    if (parts.size() != 2) throw wrong(py::str("a tuple of {}").format(parts.size()), n);
    const auto force = numbers(parts[0]), tensor = numbers(parts[1]);
    if (force.ndim() != 1 || force.size() != 3 || tensor.ndim() != 2 || tensor.shape(0) != 3 || tensor.shape(1) != 3)
      throw wrong(py::str("arrays of the shapes {} and {}").format(force.attr("shape"), tensor.attr("shape")), n);
    const double *f = force.data(), *S = tensor.data();
    for (int i = 0; i < 9; ++i) require_finite(S[i], "the stiffness tensor");
    if (S[1] != S[3] || S[2] != S[6] || S[5] != S[7])
      throw py::value_error(title() + "got a stiffness tensor that is not symmetric");
    to = {1, {f[0], f[1], f[2]}, {S[0], S[1], S[2], S[4], S[5], S[8]}};
    for (const double value : to.force) require_finite(value, "the force");
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
  std::vector<py::float_> own_;
  py::float_ stiffness_;
  std::array<std::optional<ContactArray>, 4> columns_;
};

struct State {
  KeptThread thread;
  std::unique_ptr<PythonLaw> law;
};

void* create(const double* values, const char*, const HapbenchRun* run, char* fault) {
  auto state = std::make_unique<State>();
  const auto& definition = *static_cast<const Definition*>(run->data);
  if (runs_in_python([&] { state->law = std::make_unique<PythonLaw>(definition, values, *run); }))
    return state.release();
  state->thread.give_back();
  std::snprintf(fault, HAPBENCH_FAULT_SIZE, "an error in Python");
  return nullptr;
}

int step(void* state, const HapbenchPose*, HapbenchContacts* contacts, HapbenchForce* force, char* fault) {
  if (runs_in_python([&] { static_cast<State*>(state)->law->step(*contacts, *force); })) return 0;
  std::snprintf(fault, HAPBENCH_FAULT_SIZE, "an error in Python");
  return 1;
}

void reset(void* state) {
  runs_in_python([state] { static_cast<State*>(state)->law->start(); });
}

void destroy(void* given) {
  if (!Py_IsInitialized()) return;  // the interpreter has destroyed its objects
  const std::unique_ptr<State> state(static_cast<State*>(given));
  {
    const py::gil_scoped_acquire held;
    state->law.reset();
  }
  state->thread.give_back();
}

Argument argument_named(const std::string& name) {
  if (name == "depths") return Argument::depths;
  if (name == "gradients") return Argument::gradients;
  if (name == "points") return Argument::points;
  if (name == "normals") return Argument::normals;
  return name == "stiffness" ? Argument::stiffness : Argument::own;
}

/// Any thread may release the last reference; it is destroyed only while there is an interpreter.
void destroy_definition(Definition* definition) {
  if (!Py_IsInitialized()) return;
  const py::gil_scoped_acquire held;
  delete definition;
}

void fill_table(Definition& definition, const std::vector<std::string>& arguments) {
  for (const auto& [name, initial, least, greatest, unit, meaning] : definition.given)
    definition.parameters.push_back({name.c_str(), unit.c_str(), least, greatest, initial, meaning.c_str()});
  for (const std::string& argument : arguments) {
    const auto place = std::find_if(definition.given.begin(), definition.given.end(),
                                    [&](const GivenParameter& p) { return std::get<0>(p) == argument; });
    definition.arguments.emplace_back(argument_named(argument),
                                      static_cast<std::size_t>(place - definition.given.begin()));
  }
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
  if (is_work_under_way()) throw std::runtime_error("a force law cannot be defined while something is computed");
  const DepthModelEntry* fixed = depth_model.empty() ? nullptr : find_depth_model(depth_model);
  if (!depth_model.empty() && fixed == nullptr)
    throw std::invalid_argument("unknown depth model \"" + depth_model + "\"");
  const std::shared_ptr<Definition> definition(new Definition{name, callable, is_class, parameters, texts, {}, {}},
                                               destroy_definition);
  fill_table(*definition, arguments);
  AlgorithmEntry entry = law_entry({{definition, &definition->table}, file}, hash_text(hash_of(source)));
  if (fixed != nullptr) entry.fixed_depth_model = fixed->info->name;
  add_algorithm(std::move(entry));
}

}  // namespace

void bind_force_laws(py::module_& module) {
  module.def("add_force_law", add_force_law, py::arg("name"), py::arg("callable"), py::arg("is_class"),
             py::arg("arguments"), py::arg("parameters"), py::arg("texts"), py::arg("depth_model"), py::arg("file"),
             py::arg("source"), "Make an algorithm of a callable; hapbench.force_law checks and fills the arguments.");
}

}  // namespace hapbench
