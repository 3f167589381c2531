#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace hapbench {

/// Values that take long to make, for all runs of a process: parsed files, point shells, distance grids. Thread-safe.
/// Keeps the values used last, up to 128 values and 512 MB, but at least two values for each thread of the machine, so
/// that parallel runs do not drop each other's values. A dropped value lives on while a run holds it.
class SharedCache {
 public:
  /// Returns the value of a key. The key must contain everything that the value depends on. If the value is missing,
  /// calls `make`, which returns a std::shared_ptr<const T>; `bytes` returns the value's approximate size. Waits while
  /// another thread makes the value. Passes on exceptions of `make`; the next caller then calls `make` again.
  template <class T, class Make, class Bytes>
  std::shared_ptr<const T> get(const std::string& key, const Make& make, const Bytes& bytes) {
    return std::static_pointer_cast<const T>(get_untyped(key, [&]() -> Made {
      std::shared_ptr<const T> value = make();
      const std::size_t size = bytes(*value);
      return {std::move(value), size};
    }));
  }

  /// Number of values made so far.
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
  static constexpr std::size_t kMost = 128;
  static constexpr std::size_t kMostBytes = std::size_t{512} << 20;

  std::shared_ptr<const void> get_untyped(const std::string& key, const std::function<Made()>& make);
  std::shared_ptr<Entry> entry_of(const std::string& key);
  /// Precondition: the list is locked.
  void drop_oldest();

  mutable std::mutex mutex_;
  std::list<std::shared_ptr<Entry>> entries_;  ///< the one used last first
  std::size_t made_ = 0;
};

/// The one of this process.
SharedCache& shared_cache();

}  // namespace hapbench
