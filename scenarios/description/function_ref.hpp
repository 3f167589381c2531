#pragma once

#include <memory>
#include <type_traits>
#include <utility>

namespace hapbench {

/// A reference to something that can be called with `Arguments`, for parameters that are called and not kept: unlike
/// std::function it neither copies nor allocates. Valid as long as what it refers to.
template <class... Arguments>
class FunctionRef {
 public:
  template <class Function>
  requires(!std::is_same_v<std::decay_t<Function>, FunctionRef>)
      FunctionRef(Function&& function)  // NOLINT: a lambda stands for itself
      : object_(const_cast<void*>(static_cast<const void*>(std::addressof(function)))),
        call_([](void* object, Arguments... arguments) {
          (*static_cast<std::remove_reference_t<Function>*>(object))(std::forward<Arguments>(arguments)...);
        }) {}

  void operator()(Arguments... arguments) const { call_(object_, std::forward<Arguments>(arguments)...); }

 private:
  void* object_;
  void (*call_)(void*, Arguments...);
};

}  // namespace hapbench
