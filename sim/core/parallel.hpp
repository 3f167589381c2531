#pragma once

/// Parallel loops by oneTBB. The build for WebAssembly has no threads and runs the loops sequentially.
#ifndef __wasm__
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#endif

namespace hapbench {

#ifdef __wasm__
template <class Index, class Body>
void parallel_for(Index first, Index last, const Body& body) {
  for (Index i = first; i < last; ++i) body(i);
}

template <class Work>
auto isolate(const Work& work) {
  return work();
}

#else
/// Calls body(i) for every index from first to last - 1.
using oneapi::tbb::parallel_for;

/// Calls work() and returns its result. While the calling thread waits for a parallel loop inside work(), it runs no
/// tasks that were created outside of work().
using oneapi::tbb::this_task_arena::isolate;

#endif

}  // namespace hapbench
