#pragma once

/// Loops over indices on all processors, by oneTBB; one after the other without threads, as in a page's worker.
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

/// Calls work(), whose waiting takes up no work of others.
using oneapi::tbb::this_task_arena::isolate;

#endif

}  // namespace hapbench
