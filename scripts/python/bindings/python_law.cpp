#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "algorithms/registry.hpp"
#include "bindings/bindings.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace py = pybind11;

/// The arguments of a law, by their names; `own` stands for the law's own parameters.
enum class Argument { depths, gradients, points, normals, stiffness, own };

/// A force law in Python: a function, or a class whose objects are called.
struct Definition {
  std::string name;
  py::object callable;
  bool is_class = false;
  /// The function's arguments in their order; for an own parameter its index in the table.
  std::vector<std::pair<Argument, std::size_t>> arguments;
};

using SharedDefinition = std::shared_ptr<const Definition>;

/// A numpy array with `width` numbers for each contact, of which laws get a view of the first rows.
class ContactArray {
 public:
  ContactArray(std::size_t capacity, py::ssize_t width) : width_(width), numbers_(shape(capacity)) {}

  double* data() { return numbers_.mutable_data(); }
  /// The view of the first n rows; reused while n stays the same.
  const py::object& view(std::size_t n) {
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

void copy(const double* from, std::size_t n, ContactArray& to) {
  std::copy_n(from, n, to.data());
}

void copy(const double* x, const double* y, const double* z, std::size_t n, ContactArray& to) {
  double* out = to.data();
  for (std::size_t i = 0; i < n; ++i) {
    *out++ = x[i];
    *out++ = y[i];
    *out++ = z[i];
  }
}

class PythonLaw final : public SingleSpringLaw {
 public:
  PythonLaw(SharedDefinition definition, const std::vector<double>& own, double stiffness)
      : SingleSpringLaw(stiffness), definition_(std::move(definition)) {
    const Held held;
    state_ = std::make_unique<State>();
    for (const double value : own) state_->own.push_back(py::float_(value));
    state_->stiffness = py::float_(stiffness);
  }

  ~PythonLaw() override {
    if (!Py_IsInitialized()) {
      static_cast<void>(state_.release());
      return;
    }
    const Held held;
    state_.reset();
  }

  void prepare(std::size_t capacity) override {
    const Held held;
    for (const auto& [argument, place] : definition_->arguments) {
      if (argument < Argument::stiffness && !column(argument))
        column(argument) = std::make_unique<ContactArray>(capacity, argument == Argument::depths ? 1 : 3);
    }
    start();
  }

  void reset() noexcept override {
    ForceLaw::reset();
    start();
  }

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    if (contacts.empty()) return {};
    if (failed_) return no_force(contacts);
    LawForce force;
    failed_ = !runs_in_python([&] { force = force_of(call(contacts), contacts); });
    return failed_ ? no_force(contacts) : force;
  }

 private:
  /// Python objects, which are made and released while the interpreter is held.
  struct State {
    py::object callable;
    std::vector<py::object> own;
    py::object stiffness;
    std::array<std::unique_ptr<ContactArray>, 4> columns;
  };

  std::unique_ptr<ContactArray>& column(Argument argument) {
    return state_->columns[static_cast<std::size_t>(argument)];
  }

  /// Makes a new object of a law that is a class.
  void start() noexcept {
    failed_ = !runs_in_python(
        [this] { state_->callable = definition_->is_class ? definition_->callable() : definition_->callable; });
  }

  /// The answer after an error, which ends the run.
  static LawForce no_force(ContactBuffer& contacts) noexcept {
    set_weights(contacts, 0.0);
    return {Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), Mat3::Zero()};
  }

  py::object call(const ContactBuffer& c) {
    const std::size_t n = c.size();
    std::array<PyObject*, 64> arguments;
    std::size_t count = 0;
    for (const auto& [argument, place] : definition_->arguments) {
      arguments[count++] = this->argument(c, n, argument, place).ptr();
    }
    PyObject* result = PyObject_Vectorcall(state_->callable.ptr(), arguments.data(), count, nullptr);
    if (result == nullptr) throw py::error_already_set();
    return py::reinterpret_steal<py::object>(result);
  }

  const py::object& argument(const ContactBuffer& c, std::size_t n, Argument which, std::size_t place) {
    switch (which) {
      case Argument::depths:
        copy(c.depth.data(), n, *column(which));
        break;
      case Argument::gradients:
        copy(c.ux.data(), c.uy.data(), c.uz.data(), n, *column(which));
        break;
      case Argument::points:
        copy(c.x.data(), c.y.data(), c.z.data(), n, *column(which));
        break;
      case Argument::normals:
        copy(c.nx.data(), c.ny.data(), c.nz.data(), n, *column(which));
        break;
      case Argument::stiffness:
        return state_->stiffness;
      case Argument::own:
        return state_->own[place];
    }
    return column(which)->view(n);
  }

  LawForce force_of(const py::object& answer, ContactBuffer& contacts) {
    gives_weights_ = !py::isinstance<py::tuple>(answer);
    if (!gives_weights_) return given_force(answer, contacts);
    const auto weights = numbers(answer);
    const std::size_t n = contacts.size();
    if (weights.ndim() == 0) {
      set_weights(contacts, require_finite(*weights.data(), "the weight"));
    } else if (weights.ndim() == 1 && static_cast<std::size_t>(weights.size()) == n) {
      const double* values = weights.data();
      for (std::size_t i = 0; i < n; ++i) contacts.weight[i] = require_finite(values[i], "a weight");
    } else {
      throw wrong(py::str("an array of the shape {}").format(weights.attr("shape")), n);
    }
    return weighted_force(contacts, K_);
  }

  LawForce given_force(const py::object& answer, ContactBuffer& contacts) {
    const auto parts = py::reinterpret_borrow<py::tuple>(answer);
    if (parts.size() != 2) throw wrong(py::str("a tuple of {}").format(parts.size()), contacts.size());
    const auto force = numbers(parts[0]), tensor = numbers(parts[1]);
    if (force.ndim() != 1 || force.size() != 3 || tensor.ndim() != 2 || tensor.shape(0) != 3 || tensor.shape(1) != 3)
      throw wrong(py::str("arrays of the shapes {} and {}").format(force.attr("shape"), tensor.attr("shape")),
                  contacts.size());
    LawForce result;
    for (int i = 0; i < 3; ++i) result.spring[i] = require_finite(force.data()[i], "the force");
    for (int i = 0; i < 9; ++i) result.S(i / 3, i % 3) = require_finite(tensor.data()[i], "the stiffness tensor");
    if (result.S != result.S.transpose())
      throw py::value_error(title() + "got a stiffness tensor that is not symmetric");
    set_weights(contacts, 1.0 / static_cast<double>(contacts.size()));
    return result;
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

  SharedDefinition definition_;
  std::unique_ptr<State> state_;
  bool failed_ = false;
};

/// Name, default, minimum, maximum, unit, meaning.
using GivenParameter = std::tuple<std::string, double, double, double, std::string, std::string>;

Argument argument_named(const std::string& name) {
  if (name == "depths") return Argument::depths;
  if (name == "gradients") return Argument::gradients;
  if (name == "points") return Argument::points;
  if (name == "normals") return Argument::normals;
  return name == "stiffness" ? Argument::stiffness : Argument::own;
}

void add_force_law(const std::string& name, const py::object& callable, bool is_class,
                   const std::vector<std::string>& arguments, const std::vector<GivenParameter>& parameters,
                   const std::array<std::string, 4>& texts, const std::string& depth_model, const std::string& file,
                   const std::string& source) {
  if (is_work_under_way()) throw std::runtime_error("a force law cannot be defined while something is computed");
  Definition definition{name, callable, is_class, {}};
  std::vector<OwnParameter> own;
  for (const auto& [own_name, initial, least, greatest, unit, meaning] : parameters)
    own.push_back({.name = own_name.c_str(),
                   .range = {least, greatest, unit.c_str()},
                   .initial = initial,
                   .meaning = meaning.c_str()});
  for (const std::string& argument : arguments) {
    const auto place = std::find_if(parameters.begin(), parameters.end(),
                                    [&](const GivenParameter& p) { return std::get<0>(p) == argument; });
    definition.arguments.emplace_back(argument_named(argument), static_cast<std::size_t>(place - parameters.begin()));
  }
  const DepthModelEntry* fixed = depth_model.empty() ? nullptr : find_depth_model(depth_model);
  if (!depth_model.empty() && fixed == nullptr)
    throw std::invalid_argument("unknown depth model \"" + depth_model + "\"");

  const ModelInfo info = {.name = name.c_str(),
                          .summary = texts[0].c_str(),
                          .formula = texts[1].c_str(),
                          .source = texts[2].c_str(),
                          .known_failure = texts[3].c_str(),
                          .parameters = kStiffnessAlone};
  AlgorithmEntry entry;
  entry.info = &info;
  if (fixed != nullptr) entry.fixed_depth_model = fixed->info->name;
  entry.own_parameters = own;
  entry.origin = {file, hash_text(hash_of(source))};
  entry.make_law = [shared = shared_by_threads(std::move(definition)), name](const RenderingConfig& config) {
    return std::make_unique<PythonLaw>(shared, own_values(config, *find_algorithm(name)), config.stiffness);
  };
  add_algorithm(std::move(entry));
}

}  // namespace

void bind_force_laws(py::module_& module) {
  module.def("add_force_law", add_force_law, py::arg("name"), py::arg("callable"), py::arg("is_class"),
             py::arg("arguments"), py::arg("parameters"), py::arg("texts"), py::arg("depth_model"), py::arg("file"),
             py::arg("source"), "Make an algorithm of a callable; hapbench.force_law checks and fills the arguments.");
}

}  // namespace hapbench
