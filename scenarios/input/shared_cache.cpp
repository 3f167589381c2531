#include "scenarios/input/shared_cache.hpp"

#include <algorithm>
#include <thread>

#include "sim/core/parallel.hpp"

namespace hapbench {

std::shared_ptr<const void> SharedCache::get_untyped(const std::string& key, const std::function<Made()>& make) {
  // Return the value if it is cached. The entry's lock makes other threads wait while one thread computes the
  // value.
  const std::shared_ptr<Entry> entry = entry_of(key);
  const std::lock_guard lock(entry->mutex);
  if (entry->made.value) return entry->made.value;
  // Compute the value. If `make` waits for parallel work, this thread could otherwise start another run, which
  // might request the same key and deadlock at the entry's lock; isolate() prevents this.
  Made made = isolate(make);
  // Store the value.
  const std::lock_guard list_lock(mutex_);
  entry->made = std::move(made);
  ++made_;
  return entry->made.value;
}

std::shared_ptr<SharedCache::Entry> SharedCache::entry_of(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(entries_, key, &Entry::key);
  if (found != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, found);
  } else {
    entries_.push_front(std::make_shared<Entry>());
    entries_.front()->key = key;
    drop_oldest();
  }
  return entries_.front();
}

void SharedCache::drop_oldest() {
  const std::size_t min_entries = 2 * std::max(1u, std::thread::hardware_concurrency());
  std::size_t bytes = 0;
  for (const auto& entry : entries_) bytes += entry->made.bytes;
  while (entries_.size() > min_entries && (entries_.size() > kMaxEntries || bytes > kMaxBytes)) {
    bytes -= entries_.back()->made.bytes;
    entries_.pop_back();
  }
}

SharedCache& shared_cache() {
  static SharedCache cache;
  return cache;
}

}  // namespace hapbench
