#pragma once

#include <utility>

namespace hapbench {

/// A reference to a function object that can be called with `Arguments`, for parameters that are called and not kept:
/// unlike std::function it neither copies nor allocates. Valid as long as what it refers to.
template <class... Arguments>
class FunctionRef {
 public:
  template <class Function>
  FunctionRef(const Function& function)  // NOLINT: a lambda stands for itself
      : object_(&function), call_([](const void* object, Arguments... arguments) {
          (*static_cast<const Function*>(object))(std::forward<Arguments>(arguments)...);
        }) {}

  void operator()(Arguments... arguments) const { call_(object_, std::forward<Arguments>(arguments)...); }

 private:
  const void* object_;
  void (*call_)(const void*, Arguments...);
};

}  // namespace hapbench
