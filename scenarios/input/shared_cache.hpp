#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace hapbench {

/// Cache of values that take long to compute: parsed files, point shells, distance grids. All runs of a process share
/// it. Thread-safe. Keeps the most recently used values. When a new key is requested, evicts the least recently used
/// values while the cache has more than 128 values or 512 MiB. It always keeps at least two values for each hardware
/// thread, so that parallel runs do not evict each other's values. An evicted value stays alive while a run holds it.
class SharedCache {
 public:
  /// Returns the value of a key. If the value is missing, calls `make` and caches the result. If another thread
  /// is computing the value, waits for that thread.
  /// @param key must contain everything that the value depends on, and the kind of value, because T is not
  /// checked
  /// @param make returns a std::shared_ptr<const T>; its exceptions are passed on and nothing is cached
  /// @param bytes returns the approximate size of a value in bytes
  template <class T, class Make, class Bytes>
  std::shared_ptr<const T> get(const std::string& key, const Make& make, const Bytes& bytes) {
    return std::static_pointer_cast<const T>(get_untyped(key, [&]() -> Made {
      std::shared_ptr<const T> value = make();
      const std::size_t size = bytes(*value);
      return {std::move(value), size};
    }));
  }

  /// Returns how many values have been computed so far.
  std::size_t made() const {
    const std::lock_guard lock(mutex_);
    return made_;
  }

 private:
  struct Made {
    std::shared_ptr<const void> value;
    std::size_t bytes = 0;
  };
  struct Entry {
    std::string key;
    std::mutex mutex;
    Made made;
  };
  /// Largest number of values. With more than kMaxEntries / 2 hardware threads, the largest number is instead two
  /// values for each hardware thread.
  static constexpr std::size_t kMaxEntries = 128;
  static constexpr std::size_t kMaxBytes = std::size_t{512} << 20;  ///< largest size of all values together [bytes]

  std::shared_ptr<const void> get_untyped(const std::string& key, const std::function<Made()>& make);
  /// Returns the entry of a key and marks it as most recently used. Adds an entry without a value if the key is
  /// new.
  std::shared_ptr<Entry> entry_of(const std::string& key);
  /// Evicts the least recently used entries while the cache exceeds its limits. Precondition: mutex_ is locked.
  void drop_oldest();

  mutable std::mutex mutex_;
  std::list<std::shared_ptr<Entry>> entries_;  ///< most recently used entry first
  std::size_t made_ = 0;
};

/// Returns the cache of this process.
SharedCache& shared_cache();

}  // namespace hapbench
