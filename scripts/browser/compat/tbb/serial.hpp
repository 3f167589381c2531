// The parts of oneTBB that the engine uses, on one thread, in the order of the indices.
#pragma once

#include <concepts>

namespace tbb {

template <class Index, class Body>
void parallel_for(Index first, Index last, const Body& body) {
  for (Index i = first; i < last; ++i) body(i);
}

template <class Value>
class enumerable_thread_specific {
 public:
  enumerable_thread_specific() = default;
  template <std::invocable Make>
  explicit enumerable_thread_specific(const Make& make) : value_(make()) {}
  Value& local() { return value_; }

 private:
  Value value_{};
};

namespace this_task_arena {
template <class Work>
auto isolate(const Work& work) {
  return work();
}
}  // namespace this_task_arena

}  // namespace tbb

namespace oneapi {
namespace tbb = ::tbb;
}
